//! Point cloud merging (§5): combines the clouds of all views, downsamples them (§5.1) and removes conflicts (§5.2).

mod conflict;
mod downsample;
mod virtual_view;

pub use conflict::ConflictParams;
pub use downsample::DownsampleParams;

use crate::{context::Context, error::Result, point_cloud::PointCloud, progress, report::Counts, stage::Stage};
use alloc::vec::Vec;
use virtual_view::Viewpoint;

/// Parameters of merging (§5).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct MergingParams {
    /// Downsampling (§5.1).
    pub downsample: Option<DownsampleParams>,
    /// Conflict cleaning (§5.2).
    pub conflicts: Option<ConflictParams>,
}

/// Merges the points of all views and kinds. `neighbours` is J, the number of neighbouring views.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn merge(
    context: Context,
    cloud: PointCloud,
    neighbours: u32,
    params: &MergingParams,
    counts: &mut Counts,
) -> Result<PointCloud> {
    let Context { views, hull, progress, .. } = context;
    progress::step(progress, Stage::Merge, 0, 1)?;
    let footprint = hull.footprint();
    let mut cloud = match &params.downsample {
        Some(p) => downsample::downsample(
            &cloud,
            p.radius_pixels * footprint,
            p.keep_above * neighbours as f32,
            p.normal_agreement,
            counts,
        ),
        None => cloud,
    };
    if let Some(p) = &params.conflicts {
        let (lower, upper) = hull.bounds();
        let target = (lower + upper) * 0.5;
        let mut viewpoints: Vec<Viewpoint> =
            views.iter().filter(|v| v.is_used()).map(|v| Viewpoint { camera: v.camera }).collect();
        let cameras = viewpoints.len();
        let distances = viewpoints.iter().map(|v| (v.camera.centre - target).length());
        let distance = distances.fold(0.0, |s: f32, d| s + d) / cameras as f32;
        let radius = 0.5 * (upper - lower).length();
        viewpoints.extend(virtual_view::virtual_views(p.virtual_views, target, distance, radius, footprint));
        let total = viewpoints.len() as u32;
        conflict::clean_conflicts(&mut cloud, &viewpoints, cameras, p.distance_pixels * footprint, counts, |done| {
            progress::step(progress, Stage::Merge, done as u32, total)
        })?;
    }
    counts.merged = cloud.len() as u32;
    Ok(cloud)
}

#[cfg(test)]
mod tests;
