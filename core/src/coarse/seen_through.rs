//! Drops substituted points that other views see through.
//!
//! Where stereo fails, §4.2 takes the hull instead. In a hollow the hull lies before the surface. A view that has detected
//! the surface behind such a point sees through it, so that the object is not there.

use crate::{
    camera::Pinhole,
    error::Result,
    executor::Executor,
    point_cloud::{Point, PointCloud, Rank},
    progress::{self, Progress},
    stage::Stage,
};
use alloc::{vec, vec::Vec};

/// When a substituted point is dropped.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct SeenThroughParams {
    /// A point is dropped if at least this many more views have detected a surface behind it than at it.
    pub views: u32,
    /// A detected surface is at the point if it is within this distance of it, before or behind. In pixels of footprint of
    /// the resolution that is searched.
    pub distance_pixels: f32,
}

/// Removes the substituted points that are seen through. There is one cloud and one camera per view; `distance` is
/// [`SeenThroughParams::distance_pixels`] in scene units.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub(super) fn drop_seen_through(
    clouds: Vec<PointCloud>,
    cameras: &[Pinhole],
    params: &SeenThroughParams,
    distance: f32,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<Vec<PointCloud>> {
    let detected = executor.map(clouds.len(), |view| Detected::new(&cameras[view], &clouds[view]));
    let left = executor.map(clouds.len(), |view| {
        progress::step(progress, Stage::Detect, view as u32, clouds.len() as u32)?;
        let stays = |point: &&Point| {
            point.rank != Rank::Substituted
                || detected.iter().map(|other| other.evidence(point, distance)).sum::<i32>() < params.views as i32
        };
        Ok(clouds[view].iter().filter(stays).copied().collect())
    });
    left.into_iter().collect()
}

/// What a view has detected.
struct Detected<'a> {
    camera: &'a Pinhole,
    /// Depth per pixel, or 0. Empty if nothing was detected.
    depth: Vec<f32>,
}

impl<'a> Detected<'a> {
    fn new(camera: &'a Pinhole, cloud: &[Point]) -> Self {
        let mut depth = Vec::new();
        for point in cloud.iter().filter(|point| point.rank == Rank::Detected) {
            if depth.is_empty() {
                depth = vec![0.0; camera.width as usize * camera.height as usize];
            }
            if let Some((pixel, z)) = camera.pixel(point.position) {
                depth[pixel] = z;
            }
        }
        Self { camera, depth }
    }

    /// 1 if the view sees through a point, -1 if it has detected the surface there, and 0 if it cannot tell. A view cannot
    /// tell of its own substituted points, because it has detected nothing in their pixels.
    fn evidence(&self, point: &Point, distance: f32) -> i32 {
        let Some((pixel, z)) = self.camera.pixel(point.position).filter(|_| !self.depth.is_empty()) else { return 0 };
        // Where nothing was detected, the depth 0 is far before the point.
        let behind = self.depth[pixel] - z;
        i32::from(behind > distance) - i32::from(behind.abs() <= distance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        executor::Serial,
        progress::Silent,
        testing::{pinhole, point, ranked},
    };
    use glam::Vec3;

    const DISTANCE: f32 = 0.1;

    /// Cameras around a wall in the plane z = 0.
    fn cameras(count: u32) -> Vec<Pinhole> {
        (0..count).map(|i| pinhole(Vec3::new(i as f32 - 1.5, 0.0, 4.0), Vec3::ZERO, 64, 64.0)).collect()
    }

    /// The points that are left of one substituted point of view 0, when the others have detected the wall, which lies
    /// `height` behind it. `agreeing` of them have detected a surface at the point itself.
    fn left(views: u32, agreeing: u32, height: f32) -> usize {
        let cameras = cameras(views);
        let substituted = Vec3::new(0.0, 0.0, height);
        let clouds: Vec<PointCloud> = (0..views)
            .map(|i| {
                let camera = &cameras[i as usize];
                let at = match i {
                    0 => return vec![ranked(point(substituted, Vec3::Z, 0, 0.0), Rank::Substituted)],
                    i if i <= agreeing => substituted,
                    // Where the ray through the point meets the wall.
                    _ => camera.centre + (substituted - camera.centre) * (camera.centre.z / (camera.centre.z - height)),
                };
                vec![point(at, Vec3::Z, i as u16, 1.0)]
            })
            .collect();
        let params = SeenThroughParams { views: 2, distance_pixels: 0.0 };
        let left = drop_seen_through(clouds, &cameras, &params, DISTANCE, &Serial, &Silent).expect("nothing cancels");
        assert!(left[1..].iter().all(|cloud| cloud.len() == 1), "detected points stay");
        left[0].len()
    }

    #[test]
    fn a_point_stays_unless_two_more_views_see_through_it_than_see_it() {
        assert_eq!(left(4, 0, 1.0), 0, "three views see through it");
        assert_eq!(left(4, 1, 1.0), 1, "two see through it, and one sees it");
        assert_eq!(left(2, 0, 1.0), 1, "only one sees through it");
        assert_eq!(left(4, 0, 0.5 * DISTANCE), 1, "it lies on the surface");
        assert_eq!(left(4, 0, -1.0), 1, "it lies behind the surface");
    }
}
