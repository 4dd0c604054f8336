//! §5.2: conflict cleaning. Of two points that claim to be the surface in the same pixel, the less certain one is
//! removed.

use super::virtual_view::Viewpoint;
use crate::{
    error::Result,
    point_cloud::{Point, PointCloud, Rank},
    report::Counts,
};
use alloc::{vec, vec::Vec};

/// Parameters of conflict cleaning (§5.2).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct ConflictParams {
    /// ε: points farther apart than this do not conflict, in pixels of footprint.
    pub distance_pixels: f32,
    /// Number of virtual views that are tested besides the cameras.
    pub virtual_views: u32,
}

/// The end of a linked list.
const NONE: u32 = u32::MAX;

/// Removes conflicting points, as seen from each viewpoint in turn. The first `cameras` viewpoints are cameras. Points
/// closer than `distance` scene units can conflict. `step` is called before each viewpoint with its index.
pub fn clean_conflicts(
    cloud: &mut PointCloud,
    viewpoints: &[Viewpoint],
    cameras: usize,
    distance: f32,
    counts: &mut Counts,
    mut step: impl FnMut(usize) -> Result<()>,
) -> Result<()> {
    let mut next = vec![NONE; cloud.len()];
    let mut seen: Vec<(u32, f32)> = Vec::new();
    let mut dead = vec![false; cloud.len()];
    for (v, viewpoint) in viewpoints.iter().enumerate() {
        step(v)?;
        let mut first = vec![NONE; viewpoint.pixels()];
        // For each pixel a linked list of the points that face the viewpoint (criterion 4).
        for (i, s) in cloud.iter().enumerate().rev() {
            if dead[i] || s.normal.dot(viewpoint.camera.centre - s.position) <= 0.0 {
                continue;
            }
            if let Some(pixel) = viewpoint.pixel(s.position) {
                next[i] = first[pixel];
                first[pixel] = i as u32;
            }
        }
        for &head in first.iter().filter(|&&head| head != NONE) {
            seen.clear();
            let mut i = head;
            while i != NONE {
                seen.push((i, viewpoint.camera.depth(cloud[i as usize].position)));
                i = next[i as usize];
            }
            for &(i, depth) in &seen {
                let s = &cloud[i as usize];
                let loses = if s.rank == Rank::Implicit {
                    // An implicit point must not occlude a valid point, however far behind it is.
                    seen.iter().any(|&(j, behind)| cloud[j as usize].rank != Rank::Implicit && behind > depth)
                } else {
                    seen.iter().any(|&(j, _)| beats(&cloud[j as usize], s, distance))
                };
                if loses {
                    dead[i as usize] = true;
                    match (s.rank, v < cameras) {
                        (Rank::Implicit, _) => counts.implicit_removed += 1,
                        (_, true) => counts.conflicts_cameras += 1,
                        (_, false) => counts.conflicts_virtual += 1,
                    }
                }
            }
        }
    }
    let mut dead = dead.into_iter();
    cloud.retain(|_| dead.next() == Some(false));
    Ok(())
}

/// Whether two points in one pixel conflict (criteria 2 and 3) and the first is the more certain one.
fn beats(winner: &Point, loser: &Point, distance: f32) -> bool {
    winner.rank != Rank::Implicit
        && winner.view != loser.view
        && (winner.rank, winner.fidelity) > (loser.rank, loser.fidelity)
        && (winner.position - loser.position).length_squared() < distance * distance
}
