//! A frame's clouds and silhouettes.

use crate::{
    failure::{Failure, Result},
    frame::{pcmvs_frame, shared},
    sized::{Growing, write},
    status::pcmvs_status::{self, InvalidArgument, WrongOrder},
    target::Target,
    work::Work,
};
use pcmvs_core::{Point, Stage};
use std::mem::size_of;

/// The point clouds of a frame. Numbers never change.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum pcmvs_cloud_kind {
    /// Frontier points, from `pcmvs_frame_contours`.
    Frontier = 0,
    /// Implicit points: points of the hull that no camera sees, from `pcmvs_frame_contours`.
    Implicit = 1,
    /// The points of one view, from detection. Available after `pcmvs_frame_merge`.
    Detected = 2,
    /// The merged cloud, which becomes the mesh, from `pcmvs_frame_merge`.
    Merged = 3,
}

/// Kinds of points, from the least to the most trustworthy. Numbers never change.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum pcmvs_rank {
    /// On the hull, seen by no camera.
    Implicit = 0,
    /// Placed on the hull where stereo failed.
    Substituted = 1,
    /// Found by stereo.
    Detected = 2,
    /// A frontier point, which is certainly on the surface.
    Frontier = 3,
}

/// A point of a cloud.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_point {
    /// x, y, z relative to `pcmvs_rig_origin`.
    pub position: [f32; 3],
    /// Unit normal, pointing outwards.
    pub normal: [f32; 3],
    /// How well the neighbouring views agree, from 0 to the number of neighbours.
    pub fidelity: f32,
    /// Weight in meshing.
    pub weight: f32,
    /// Index of the camera that sees the point. -1 for implicit points.
    pub camera: i32,
    /// A `pcmvs_rank`.
    pub rank: u32,
}

/// A view's silhouette in the frame's memory, undistorted. Stays valid until the next call on the frame that takes a
/// non-const `pcmvs_frame *`.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_silhouette {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Signed distance of each pixel to the contour, positive inside the object, in packed rows from the top down. From
    /// -16384 to 16384 it is in 1/64 pixel. Each step beyond that is 4 pixels, rounded towards the contour: a larger d stands
    /// for 256 + 4 (d - 16384) pixels. 32767 where undistortion has no source pixel.
    pub distances: *const i16,
}

impl Growing for pcmvs_silhouette {
    const FIRST_SIZE: usize = 8 + size_of::<usize>();
}

impl Work {
    /// A cloud by its number, and the stage that makes it. `camera` selects one of the detected clouds.
    pub(crate) fn cloud_of_kind(&self, kind: u32, camera: u32) -> Result<(&[Point], Stage)> {
        let stage = match kind {
            0 | 1 => Stage::Contours,
            2 | 3 => Stage::Merge,
            _ => return Err(Failure::new(InvalidArgument, format!("cloud {kind} is not known"))),
        };
        self.require(stage)?;
        let of = self.frame.intermediates();
        let cloud = match kind {
            0 => &of.frontier,
            1 => &of.implicit,
            2 => &of.detected[self.place(camera, stage)?],
            _ => &of.merged,
        };
        Ok((cloud, stage))
    }
}

/// Copies a cloud to the caller's memory. `kind` is a `pcmvs_cloud_kind`; `camera` selects one of the detected clouds and
/// is ignored otherwise. `buffer`, `capacity`, `stride` and `count` are as in `pcmvs_frame_copy_mesh`. A cloud whose stage
/// the preset leaves out is empty.
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
    shared(frame, copy)
}

/// Returns a pointer to a view's silhouette in the frame's memory, once `PCMVS_STAGE_VIEWS` is complete. Fails with
/// `PCMVS_STATUS_WRONG_ORDER` if the view has no silhouette. `size` is `sizeof *silhouette`. It is smaller than the picture,
/// by a power of two, where the picture was read at a lower resolution: with the preset `preview`, or because it is blurred.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_get_silhouette(
    frame: *const pcmvs_frame,
    camera: u32,
    silhouette: *mut pcmvs_silhouette,
    size: usize,
) -> pcmvs_status {
    let get = |work: &Work| {
        work.require(Stage::Views)?;
        let at = |failure: Failure| failure.of_camera(camera).at(Stage::Views);
        let found = work.frame.views()[work.place(camera, Stage::Views)?].silhouette.as_ref();
        let found = found.ok_or_else(|| at(Failure::new(WrongOrder, "this view was given no silhouette")))?;
        let (width, height, distances) = (found.width, found.height, found.distances().as_ptr());
        let found = pcmvs_silhouette { width, height, distances };
        // SAFETY: the caller's promise.
        unsafe { write(silhouette, size, &found, "silhouette") }.map_err(at)
    };
    shared(frame, get)
}
