//! A frame's clouds and silhouettes.

use crate::{
    boundary::{Growing, Result, write},
    error::Failure,
    frame::{Work, pcmvs_frame, shared},
    mesh::Target,
    status::pcmvs_status::{self, InvalidArgument, WrongOrder},
};
use pcmvs_core::{Point, Stage};
use std::mem::size_of;

/// Which of a frame's clouds. Numbers never change.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum pcmvs_cloud_kind {
    /// On contour generators, after `pcmvs_frame_contours`.
    Frontier = 0,
    /// On the hull where no camera looks, after `pcmvs_frame_contours`.
    Implicit = 1,
    /// One view's points, after `pcmvs_frame_merge`.
    Detected = 2,
    /// All that reaches meshing, after `pcmvs_frame_merge`.
    Merged = 3,
}

/// What makes a point trustworthy. Numbers never change.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum pcmvs_rank {
    /// On the hull where no camera looks.
    Implicit = 0,
    /// Put on the hull because stereo failed.
    Substituted = 1,
    /// Found by stereo.
    Detected = 2,
    /// On a contour generator, certainly on the surface.
    Frontier = 3,
}

/// A point of a cloud.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_point {
    /// x, y, z; add `pcmvs_rig_origin` for the scene's frame.
    pub position: [f32; 3],
    /// Unit normal, outward.
    pub normal: [f32; 3],
    /// How well the neighbouring views agree, from 0 to their number.
    pub fidelity: f32,
    /// Weight in meshing.
    pub weight: f32,
    /// Index of the camera that sees it; -1 for implicit points.
    pub camera: i32,
    /// A `pcmvs_rank`.
    pub rank: u32,
}

/// A view's silhouette in the frame's memory, for the camera without lens distortion. Valid until the next call on the
/// frame that is not const.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_silhouette {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// For each pixel its distance to the contour in 1/64 pixel, positive on the object; 32767 where nothing is known.
    pub distances: *const i16,
}

impl Growing for pcmvs_silhouette {
    const FIRST_SIZE: usize = 8 + size_of::<usize>();
}

impl Work {
    /// A cloud by its number, and the stage that makes it; `camera` chooses among the detected ones.
    pub(crate) fn cloud_of_kind(&self, kind: u32, camera: u32) -> Result<(&[Point], Stage)> {
        let stage = match kind {
            0 | 1 => Stage::Contours,
            2 | 3 => Stage::Merge,
            _ => return Err(Failure::new(InvalidArgument, format!("cloud {kind} is not known"))),
        };
        self.require(stage)?;
        let cloud = match kind {
            0 => &self.frame.intermediates().frontier,
            1 => &self.frame.intermediates().implicit,
            2 => {
                &self.frame.intermediates().detected
                    [self.frame.place(camera as usize).map_err(|e| Failure::from(e).at(stage))?]
            }
            _ => &self.frame.intermediates().merged,
        };
        Ok((cloud, stage))
    }
}

/// Copies a cloud, a `pcmvs_cloud_kind`, to the caller's memory; `camera` chooses among the detected ones. `buffer`,
/// `capacity`, `stride` and `count` as for `pcmvs_frame_copy_mesh`. Presets without a stage have no points of it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_copy_cloud(
    frame: *const pcmvs_frame,
    kind: u32,
    camera: u32,
    buffer: *mut pcmvs_point,
    capacity: usize,
    stride: usize,
    count: *mut usize,
) -> pcmvs_status {
    let copy = |work: &Work| {
        let (cloud, stage) = work.cloud_of_kind(kind, camera)?;
        let order = work.frame.rig().order();
        let point = |p: &Point| pcmvs_point {
            position: p.position.to_array(),
            normal: p.normal.to_array(),
            fidelity: p.fidelity,
            weight: p.weight,
            camera: if p.view == Point::NO_VIEW { -1 } else { order[p.view as usize] as i32 },
            rank: p.rank as u32,
        };
        let target = Target { buffer: buffer.cast(), capacity, stride, count };
        // SAFETY: the caller's promise.
        unsafe { target.fill(cloud.iter().map(point)) }.map_err(|f| f.at(stage))
    };
    // SAFETY: the caller's promise.
    unsafe { shared(frame, copy) }
}

/// Looks at a view's silhouette where it lies, after `pcmvs_frame_hull`. Fails with `PCMVS_STATUS_WRONG_ORDER` for a
/// view that was given none. `size` is `sizeof *silhouette`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_get_silhouette(
    frame: *const pcmvs_frame,
    camera: u32,
    silhouette: *mut pcmvs_silhouette,
    size: usize,
) -> pcmvs_status {
    let look = |work: &Work| {
        work.require(Stage::Hull)?;
        let views = work.frame.views();
        let at = |failure: Failure| failure.of_camera(camera).at(Stage::Views);
        let found = views[work.frame.place(camera as usize).map_err(Failure::from)?].silhouette.as_ref();
        let found = found.ok_or_else(|| at(Failure::new(WrongOrder, "this view was given no silhouette")))?;
        let (width, height, distances) = (found.width, found.height, found.distances().as_ptr());
        let found = pcmvs_silhouette { width, height, distances };
        // SAFETY: the caller's promise.
        unsafe { write(silhouette, size, &found, "silhouette") }.map_err(at)
    };
    // SAFETY: the caller's promise.
    unsafe { shared(frame, look) }
}
