//! Point cloud merging (§5): the clouds of all views to one, thinned and without contradictions.

mod conflict;
mod downsample;
mod neighbour_grid;
mod virtual_view;

pub use conflict::ConflictParams;
pub use downsample::DownsampleParams;

use crate::{
    camera::Pinhole,
    error::Result,
    hull::VisualHull,
    params::MergingParams,
    point_cloud::PointCloud,
    progress::{self, Progress, Stage},
    report::Counts,
};
use alloc::vec::Vec;
use virtual_view::Eye;

/// Merges points of all views and kinds. `neighbours` is J, the largest fidelity.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn merge(
    cloud: PointCloud,
    hull: &VisualHull,
    cameras: &[Pinhole],
    neighbours: u32,
    params: &MergingParams,
    counts: &mut Counts,
    progress: &dyn Progress,
) -> Result<PointCloud> {
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
        let distances = cameras.iter().map(|c| (c.centre - target).length());
        let distance = distances.fold(0.0, |s: f32, d| s + d) / cameras.len() as f32;
        let radius = 0.5 * (upper - lower).length();
        let mut eyes: Vec<Eye> = cameras.iter().map(|&camera| Eye { camera }).collect();
        eyes.extend(virtual_view::virtual_views(p.virtual_views, target, distance, radius, footprint));
        let total = eyes.len() as u32;
        conflict::clean_conflicts(&mut cloud, &eyes, cameras.len(), p.distance_pixels * footprint, counts, |done| {
            progress::step(progress, Stage::Merge, done as u32, total)
        })?;
    }
    if !params.fidelity_weights {
        cloud.iter_mut().for_each(|p| p.weight = 1.0);
    }
    counts.merged = cloud.len() as u32;
    Ok(cloud)
}
