//! What a frame counted and measured: in total, per stage and per view.

use crate::{
    failure::Failure,
    frame::{pcmvs_frame, shared},
    sized::{Growing, write},
    stage,
    status::pcmvs_status,
    target::Target,
    work::Work,
};
use pcmvs_core::{Point, Rank, Stage, ViewDiagnostics};

/// Stands for a figure of a view that could not be measured.
const NOT_MEASURED: f32 = -1.0;

/// What the stages of a frame counted.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_counts {
    /// Points found by stereo.
    pub detected: u32,
    /// Points placed on the hull where stereo failed.
    pub substituted: u32,
    /// Points removed by the density constraint.
    pub cleaned_density: u32,
    /// Points removed by the PCA constraint, which asks for a locally flat surface.
    pub cleaned_pca: u32,
    /// Points removed by the normal constraint.
    pub cleaned_normal: u32,
    /// Frontier points.
    pub frontier: u32,
    /// Implicit points.
    pub implicit: u32,
    /// Points dropped in merging because of their normals.
    pub dropped_normal: u32,
    /// Points dropped in merging in favour of a neighbour with higher fidelity.
    pub dropped_fidelity: u32,
    /// Points removed because they conflict with another point in a camera's view.
    pub conflicts_cameras: u32,
    /// Points removed because they conflict with another point in a virtual view.
    pub conflicts_virtual: u32,
    /// Implicit points removed because they occlude a valid point.
    pub implicit_removed: u32,
    /// Points of the merged cloud.
    pub merged: u32,
    /// Small components removed from the mesh.
    pub components_dropped: u32,
    /// Vertices of the final mesh.
    pub vertices: u32,
    /// Triangles of the final mesh.
    pub faces: u32,
}

impl Growing for pcmvs_counts {
    const FIRST_SIZE: usize = 64;
}

/// What one stage took and made.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_stage_report {
    /// Wall-clock seconds of all calls that did the stage's work, added up. 0 if the preset leaves the stage out.
    pub seconds: f64,
    /// A hash of the stage's result. It is the same on every machine and with any number of threads.
    pub hash: u64,
}

impl Growing for pcmvs_stage_report {
    const FIRST_SIZE: usize = 16;
}

/// Diagnostics of one camera's view. Members of stages that have not run are zero. Later versions may add members at the
/// end.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_view_report {
    /// 1 if the view has a silhouette and therefore carves the hull, otherwise 0. A view that is not used does not carve, and
    /// neither does a silhouette that is set aside.
    pub carves: u32,
    /// Share of the picture that is inside the silhouette, 0 to 1. 0 without a silhouette.
    pub inside: f32,
    /// Points of the view that stereo found and cleaning kept.
    pub detected: u32,
    /// Points of the view that were placed on the hull where stereo failed, and that cleaning kept.
    pub substituted: u32,
    /// Factors applied to the picture's red, green and blue when the mesh was coloured.
    pub gains: [f32; 3],
    /// Zero.
    pub reserved: u32,
    /// 1 if the view takes part in the frame, otherwise 0: it has no picture, its silhouette is empty or inverted, the
    /// object lies beside it, or it contradicts the other views. A warning of the frame tells which.
    pub used: u32,
    /// Intersection over union of the silhouette and the visual hull's picture, 0 to 1. -1 if it could not be measured: no
    /// silhouette, or one that fills the picture.
    pub silhouette_overlap: f32,
    /// Median distance of the hull's outline in the picture from the silhouette's contour, in pixels. -1 if it could not be
    /// measured: no silhouette, or one that fills the picture.
    pub contour_px: f32,
    /// Median distance of a few matches with other views from their epipolar lines, in pixels: how far off the calibration
    /// is. 0 before `pcmvs_frame_merge`, and -1 if it could not be measured: no stereo, or too few matches.
    pub epipolar_px: f32,
}

impl Growing for pcmvs_view_report {
    const FIRST_SIZE: usize = 32;
}

/// Returns what the stages of a frame counted, once `pcmvs_frame_colour` has run. `size` is `sizeof *counts`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_get_counts(
    frame: *const pcmvs_frame,
    counts: *mut pcmvs_counts,
    size: usize,
) -> pcmvs_status {
    let get = |work: &Work| {
        work.require(Stage::Colour)?;
        let of = work.frame.counts();
        let found = pcmvs_counts {
            detected: of.detected,
            substituted: of.substituted,
            cleaned_density: of.cleaned_density,
            cleaned_pca: of.cleaned_pca,
            cleaned_normal: of.cleaned_normal,
            frontier: of.frontier,
            implicit: of.implicit,
            dropped_normal: of.dropped_normal,
            dropped_fidelity: of.dropped_fidelity,
            conflicts_cameras: of.conflicts_cameras,
            conflicts_virtual: of.conflicts_virtual,
            implicit_removed: of.implicit_removed,
            merged: of.merged,
            components_dropped: of.components_dropped,
            vertices: of.vertices,
            faces: of.faces,
        };
        // SAFETY: the caller's promise.
        unsafe { write(counts, size, &found, "counts") }.map_err(|f| f.at(Stage::Colour))
    };
    shared(frame, get)
}

/// Returns what a stage, a `pcmvs_stage`, took and made. Fails with `PCMVS_STATUS_WRONG_ORDER` if the stage is not
/// complete. `size` is `sizeof *report`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_get_stage_report(
    frame: *const pcmvs_frame,
    stage: u32,
    report: *mut pcmvs_stage_report,
    size: usize,
) -> pcmvs_status {
    let get = |work: &Work| {
        let stage = stage::by_id(stage)?;
        work.require(stage)?;
        let hash = work.frame.hashes().iter().find(|(of, _)| *of == stage).map_or(0, |&(_, hash)| hash);
        let found = pcmvs_stage_report { seconds: work.clock.seconds(stage), hash };
        // SAFETY: the caller's promise.
        unsafe { write(report, size, &found, "report") }.map_err(|f| f.at(stage))
    };
    shared(frame, get)
}

/// Returns diagnostics of one camera's view, once `PCMVS_STAGE_VIEWS` is complete. `size` is `sizeof *report`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_get_view_report(
    frame: *const pcmvs_frame,
    camera: u32,
    report: *mut pcmvs_view_report,
    size: usize,
) -> pcmvs_status {
    let get = |work: &Work| {
        work.require(Stage::Views)?;
        let found = view_report(work, camera, work.place(camera, Stage::Views)?);
        let at = |failure: Failure| failure.of_camera(camera).at(Stage::Views);
        // SAFETY: the caller's promise.
        unsafe { write(report, size, &found, "report") }.map_err(at)
    };
    shared(frame, get)
}

fn view_report(work: &Work, camera: u32, place: usize) -> pcmvs_view_report {
    let frame = &work.frame;
    let view = &frame.views()[place];
    let silhouette = view.silhouette.as_ref();
    let share = |distances: &[i16]| distances.iter().filter(|&&d| d > 0).count() as f32 / distances.len() as f32;
    let inside = silhouette.map_or(0.0, |silhouette| share(silhouette.distances()));
    let is_complete = |stage| frame.require(stage).is_ok();
    let cloud: &[Point] = if is_complete(Stage::Detect) { &frame.intermediates().detected[place] } else { &[] };
    let count = |rank| cloud.iter().filter(|p| p.rank == rank).count() as u32;
    let gains = if is_complete(Stage::Colour) { frame.gains()[camera as usize] } else { [0.0; 3] };
    let diagnostics = frame.diagnostics_of(camera as usize);
    let measured =
        |of: fn(&ViewDiagnostics) -> Option<f32>| diagnostics.map_or(0.0, |found| of(&found).unwrap_or(NOT_MEASURED));
    pcmvs_view_report {
        carves: u32::from(view.is_used() && silhouette.is_some()),
        inside,
        detected: count(Rank::Detected),
        substituted: count(Rank::Substituted),
        gains,
        reserved: 0,
        used: u32::from(view.is_used()),
        silhouette_overlap: measured(|of| of.silhouette_overlap),
        contour_px: measured(|of| of.contour_px),
        epipolar_px: if is_complete(Stage::Merge) { measured(|of| of.epipolar_px) } else { 0.0 },
    }
}

/// Copies the gains with which a frame was coloured, once `pcmvs_frame_colour` has run: three floats per camera, as in
/// `pcmvs_rig_set_gains`. `capacity` and `count` are in cameras; `buffer`, `capacity`, `stride` and `count` are as in
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
        let target = Target { buffer: buffer.cast(), capacity, stride, count };
        // SAFETY: the caller's promise.
        unsafe { target.fill(work.frame.gains().iter().copied()) }.map_err(|f| f.at(Stage::Colour))
    };
    shared(frame, copy)
}
