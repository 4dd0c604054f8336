//! §5.1: as uniform as possible a sampling, keeping the points of highest fidelity.

use super::neighbour_grid::NeighbourGrid;
use crate::{
    point_cloud::{Point, PointCloud, Rank},
    report::Counts,
};
use glam::Vec3;

/// Downsampling of §5.1.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct DownsampleParams {
    /// ρ: radius of a neighbourhood in pixels of footprint.
    pub radius_pixels: f32,
    /// α of eq. 2: least cosine between a normal and the neighbourhood's mean.
    pub normal_agreement: f32,
    /// Points of at least this fidelity, as a share of the number of neighbouring views, always stay.
    pub keep_above: f32,
}

/// Thins the merged cloud. Frontier and implicit points all stay; ties of fidelity go to the earlier point.
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
