//! §5.1: downsampling. Makes the sampling as uniform as possible and keeps the points of highest fidelity.

use crate::neighbour_grid::NeighbourGrid;
use crate::{
    point_cloud::{Point, PointCloud, Rank},
    report::Counts,
};
use glam::Vec3;

/// Parameters of downsampling (§5.1).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct DownsampleParams {
    /// ρ: radius of a neighbourhood in pixels of footprint.
    pub radius_pixels: f32,
    /// α of eq. 2: smallest cosine between a normal and the mean normal of its neighbourhood.
    pub normal_agreement: f32,
    /// Points with at least this fidelity are always kept. A fraction of the number of neighbouring views.
    pub keep_above: f32,
}

/// Downsamples the merged cloud. All frontier and implicit points are kept. If fidelities are equal the earlier point
/// wins.
pub fn downsample(cloud: &[Point], radius: f32, keep_above: f32, agreement: f32, counts: &mut Counts) -> PointCloud {
    let grid = NeighbourGrid::new(cloud.iter().map(|p| p.position), radius);
    let mut kept = PointCloud::new();
    for (i, s) in cloud.iter().enumerate() {
        if matches!(s.rank, Rank::Frontier | Rank::Implicit) || s.fidelity >= keep_above {
            kept.push(*s);
            continue;
        }
        let mut mean = Vec3::ZERO;
        let mut best = true;
        grid.near(s.position, radius, |j| {
            let other = &cloud[j];
            if other.rank == Rank::Implicit || (other.position - s.position).length_squared() > radius * radius {
                return;
            }
            mean += other.normal;
            let higher = (other.rank, other.fidelity) > (s.rank, s.fidelity)
                || ((other.rank, other.fidelity) == (s.rank, s.fidelity) && j < i);
            best &= other.view == s.view || !higher;
        });
        // Eq. 2: n · (Σ n_i / |Σ n_i|) < α.
        if s.normal.dot(mean) < agreement * mean.length() {
            counts.dropped_normal += 1;
        } else if !best {
            counts.dropped_fidelity += 1;
        } else {
            kept.push(*s);
        }
    }
    kept
}
