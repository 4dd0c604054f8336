//! What a frame took and counted.

use crate::{
    boundary::{Growing, write},
    frame::{Work, pcmvs_frame, shared},
    mesh::Target,
    status::{PCMVS_STAGE_COUNT, pcmvs_status},
};
use pcmvs_core::{Stage, frame::ORDER};

/// What a frame took and counted.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_report {
    /// Seconds of each stage, over all threads.
    pub seconds: [f64; PCMVS_STAGE_COUNT as usize],
    /// A hash of each stage's result, the same on every machine.
    pub hashes: [u64; PCMVS_STAGE_COUNT as usize],
    /// Points found by stereo.
    pub detected: u32,
    /// Points put on the hull because stereo failed.
    pub substituted: u32,
    /// Points removed by the density constraint.
    pub cleaned_density: u32,
    /// Points removed by the flatness constraint.
    pub cleaned_pca: u32,
    /// Points removed by the normal constraint.
    pub cleaned_normal: u32,
    /// Frontier points.
    pub frontier: u32,
    /// Implicit points.
    pub implicit: u32,
    /// Points dropped in merging for their normals.
    pub dropped_normal: u32,
    /// Points dropped in merging for better neighbours.
    pub dropped_fidelity: u32,
    /// Conflicts removed in the cameras' views.
    pub conflicts_cameras: u32,
    /// Conflicts removed in virtual views.
    pub conflicts_virtual: u32,
    /// Implicit points removed because they hide a valid point.
    pub implicit_removed: u32,
    /// Points that reached meshing.
    pub merged: u32,
    /// Stray components dropped from the mesh.
    pub components_dropped: u32,
    /// Vertices of the mesh.
    pub vertices: u32,
    /// Triangles of the mesh.
    pub faces: u32,
}

impl Growing for pcmvs_report {
    const FIRST_SIZE: usize = 192;
}

/// Tells what the frame took and counted, when all its stages have run. `size` is `sizeof *report`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_get_report(
    frame: *const pcmvs_frame,
    report: *mut pcmvs_report,
    size: usize,
) -> pcmvs_status {
    let tell = |work: &Work| {
        work.require(Stage::Colour)?;
        let counts = work.frame.counts();
        let (mut seconds, mut hashes) = ([0.0; ORDER.len()], [0; ORDER.len()]);
        for &(stage, hash) in work.frame.hashes() {
            let id = stage.id() as usize;
            (seconds[id], hashes[id]) = (work.clock.seconds(stage), hash);
        }
        let found = pcmvs_report {
            seconds,
            hashes,
            detected: counts.detected,
            substituted: counts.substituted,
            cleaned_density: counts.cleaned_density,
            cleaned_pca: counts.cleaned_pca,
            cleaned_normal: counts.cleaned_normal,
            frontier: counts.frontier,
            implicit: counts.implicit,
            dropped_normal: counts.dropped_normal,
            dropped_fidelity: counts.dropped_fidelity,
            conflicts_cameras: counts.conflicts_cameras,
            conflicts_virtual: counts.conflicts_virtual,
            implicit_removed: counts.implicit_removed,
            merged: counts.merged,
            components_dropped: counts.components_dropped,
            vertices: counts.vertices,
            faces: counts.faces,
        };
        // SAFETY: the caller's promise.
        unsafe { write(report, size, &found, "report") }.map_err(|f| f.at(Stage::Colour))
    };
    // SAFETY: the caller's promise.
    unsafe { shared(frame, tell) }
}

/// Copies the gains with which the frame was coloured, when all its stages have run: for each camera three floats, as for
/// `pcmvs_rig_set_gains`. `buffer` has room for `capacity` cameras; `buffer`, `capacity`, `stride` and `count` as for
/// `pcmvs_frame_copy_mesh`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_copy_gains(
    frame: *const pcmvs_frame,
    buffer: *mut f32,
    capacity: usize,
    stride: usize,
    count: *mut usize,
) -> pcmvs_status {
    let copy = |work: &Work| {
        work.require(Stage::Colour)?;
        let gains = work.frame.gains();
        let target = Target { buffer: buffer.cast(), capacity, stride, count };
        // SAFETY: the caller's promise.
        unsafe { target.fill(gains.iter().copied()) }.map_err(|f| f.at(Stage::Colour))
    };
    // SAFETY: the caller's promise.
    unsafe { shared(frame, copy) }
}
