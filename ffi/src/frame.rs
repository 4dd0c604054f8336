//! The handle of a frame, and its stages: a lock and a status around the core's frame.

use crate::{
    boundary::{catch, out, status},
    error::pcmvs_error,
    failure::{Failure, Result},
    handles::{Opaque, body, free, into_handle},
    image::calibrated,
    locked::Locked,
    options::pcmvs_options,
    rig::{RigBody, pcmvs_rig, with_rig},
    sized::{Versioned, read, read_array, write},
    stage,
    status::pcmvs_status::{self, InvalidArgument},
    view::{GivenView, pcmvs_view},
    work::Work,
};
use pcmvs_core::{
    Stage,
    frame::{ORDER, position},
};
use std::sync::atomic::{AtomicU32, Ordering};

/// A frame: it takes one picture per camera and turns them into a mesh stage by stage. The handle holds the results and
/// can be used for any number of frames, one after the other.
pub struct pcmvs_frame {
    _private: (),
}

/// A frame and its number.
pub(crate) struct FrameBody {
    number: AtomicU32,
    work: Locked<Work>,
}

impl Opaque for pcmvs_frame {
    type Body = FrameBody;
}

impl FrameBody {
    fn keep(&self, result: Result<()>) -> pcmvs_status {
        self.work.keep(result, Some(self.number.load(Ordering::Relaxed)))
    }
}

/// Reads results or does the work of one view. Other such calls may run at the same time.
pub(crate) fn shared(frame: *const pcmvs_frame, work: impl FnOnce(&Work) -> Result<()>) -> pcmvs_status {
    match body(frame) {
        Ok(frame) => frame.keep(frame.work.shared(work)),
        Err(failure) => failure.status,
    }
}

/// Reads a frame during a call on another one, which keeps the failure.
pub(crate) fn content(frame: *const pcmvs_frame, work: impl FnOnce(&Work) -> Result<()>) -> Result<()> {
    body(frame)?.work.shared(work)
}

/// Does work that needs the frame for itself.
pub(crate) fn exclusive(
    frame: *mut pcmvs_frame,
    work: impl FnOnce(&FrameBody, &mut Work) -> Result<()>,
) -> pcmvs_status {
    match body(frame.cast_const()) {
        Ok(frame) => frame.keep(frame.work.exclusive(|guarded| work(&frame, guarded))),
        Err(failure) => failure.status,
    }
}

/// Runs the stages from `first` to `last`, and before them those that have not run yet.
fn run(frame: *mut pcmvs_frame, first: Stage, last: Stage) -> pcmvs_status {
    exclusive(frame, |_, work| work.run(first, last))
}

/// Begins the next frame. On failure nothing changes.
///
/// # Safety
/// As for [`read`].
unsafe fn begin(frame: &FrameBody, work: &mut Work, options: *const pcmvs_options) -> Result<()> {
    let given = if options.is_null() {
        pcmvs_options::defaults()
    } else {
        // SAFETY: the caller's promise.
        unsafe { read(options, "options")? }
    };
    work.restart(given)?;
    frame.number.store(given.frame, Ordering::Relaxed);
    Ok(())
}

/// Creates a frame for a rig whose cameras have been set. Free it with `pcmvs_frame_free`. If this fails,
/// `pcmvs_rig_error` says why.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_new(rig: *const pcmvs_rig, frame: *mut *mut pcmvs_frame) -> pcmvs_status {
    let make = |rig: &RigBody| {
        let frame = out(frame, "frame")?;
        let work = Work::new(rig.get()?, pcmvs_options::defaults())?;
        let made = FrameBody { number: AtomicU32::new(0), work: Locked::new("the frame", work) };
        // SAFETY: the caller's promise.
        unsafe { frame.write(into_handle(made)) };
        Ok(())
    };
    with_rig(rig, make)
}

/// Frees a frame and everything that pointers obtained from it point to. NULL is ignored. Fails with `PCMVS_STATUS_BUSY`
/// while a call on the frame is running.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_free(frame: *mut pcmvs_frame) -> pcmvs_status {
    let idle = |frame: &FrameBody| {
        frame.work.idle().inspect_err(|busy| {
            frame.keep(Err(busy.clone()));
        })
    };
    free(frame, idle)
}

/// Begins a frame and runs all of its stages. `views` holds one view per camera, in the order in which the cameras were
/// given to `pcmvs_rig_set_cameras`, and `count` must be the number of cameras. `options` may be NULL. On failure the
/// frame has no results, not even those of the frame before; the handle can be used again. Only if the call could not begin
/// (`PCMVS_STATUS_BUSY`) nothing changes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_reconstruct(
    frame: *mut pcmvs_frame,
    views: *const pcmvs_view,
    count: usize,
    options: *const pcmvs_options,
) -> pcmvs_status {
    let reconstruct = |frame: &FrameBody, work: &mut Work| {
        // SAFETY: the caller's promise.
        if let Err(failure) = unsafe { begin(frame, work, options) } {
            work.reset()?;
            return Err(failure);
        }
        if count != work.frame.cameras() {
            let problem = format!("{count} views were given for {} cameras: give one per camera", work.frame.cameras());
            return Err(Failure::new(InvalidArgument, problem));
        }
        let at = |failure: Failure| failure.at(Stage::Views);
        // SAFETY: the caller's promise.
        let views = unsafe { read_array(views, count, "views") }.map_err(at)?;
        let sizes = calibrated(work.frame.rig().cameras());
        // SAFETY: the caller's promise.
        work.hold(views.iter().zip(&sizes).map(|(view, &size)| unsafe { GivenView::copied(view, size) }).sum())?;
        // SAFETY: the caller's promise.
        let given = |(i, view)| unsafe { GivenView::new(view, sizes[i]) }.map_err(|f| at(f.of_camera(i as u32)));
        let given = views.iter().enumerate().map(given).collect::<Result<Vec<_>>>()?;
        let inputs: Vec<_> = given.iter().map(GivenView::input).collect();
        let result = work.run_all(&inputs);
        if result.is_err() {
            work.reset()?;
        }
        result
    };
    exclusive(frame, reconstruct)
}

/// Begins a frame that is to be made stage by stage, and discards the results of the one before. `options` may be NULL. On
/// failure nothing changes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_begin(frame: *mut pcmvs_frame, options: *const pcmvs_options) -> pcmvs_status {
    // SAFETY: the caller's promise.
    exclusive(frame, |frame, work| unsafe { begin(frame, work, options) })
}

/// Reads the picture and silhouette of one camera, or takes note that it has none in this frame. A second call for the
/// same camera replaces them, until the stage `PCMVS_STAGE_VIEWS` is complete. May be called on several threads at once,
/// for different cameras.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_view(
    frame: *mut pcmvs_frame,
    camera: u32,
    view: *const pcmvs_view,
) -> pcmvs_status {
    let read_view = |work: &Work| {
        let at = |failure: Failure| failure.of_camera(camera).at(Stage::Views);
        let size = work.calibrated(camera)?;
        // SAFETY: the caller's promise.
        let view = unsafe { read(view, "view") }.map_err(at)?;
        // SAFETY: the caller's promise.
        work.check_copies(unsafe { GivenView::copied(&view, size) }).map_err(at)?;
        // SAFETY: the caller's promise.
        let given = unsafe { GivenView::new(&view, size) }.map_err(at)?;
        work.view(camera, given.input().as_ref())
    };
    shared(frame, read_view)
}

/// Runs one stage, a `pcmvs_stage`. The stages before it that have not run yet run first; detection then covers the views
/// for which `pcmvs_frame_detect` has not been called. Only the views must be there: every camera needs its
/// `pcmvs_frame_view`. Running a stage again discards the results of the stages after it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_step(frame: *mut pcmvs_frame, stage: u32) -> pcmvs_status {
    let step = |_: &FrameBody, work: &mut Work| {
        let stage = stage::by_id(stage)?;
        work.run(stage, stage)
    };
    exclusive(frame, step)
}

/// Carves the visual hull. The same as `pcmvs_frame_step` with `PCMVS_STAGE_HULL`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_hull(frame: *mut pcmvs_frame) -> pcmvs_status {
    run(frame, Stage::Hull, Stage::Hull)
}

/// Finds the points that follow from the silhouettes alone. The same as `pcmvs_frame_step` with `PCMVS_STAGE_CONTOURS`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_contours(frame: *mut pcmvs_frame) -> pcmvs_status {
    run(frame, Stage::Contours, Stage::Contours)
}

/// Detects and meshes at reduced resolution, then runs every further stage that comes before detection. After it,
/// `pcmvs_frame_detect` can be called.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_coarse(frame: *mut pcmvs_frame) -> pcmvs_status {
    run(frame, Stage::Coarse, ORDER[position(Stage::Detect) - 1])
}

/// Detects the points of one camera's view by stereo with its neighbours. Fails with `PCMVS_STATUS_WRONG_ORDER` until all
/// stages before detection are complete, which `pcmvs_frame_coarse` ensures. May be called on several threads at once,
/// for different cameras; the result does not depend on threads or order.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_detect(frame: *mut pcmvs_frame, camera: u32) -> pcmvs_status {
    shared(frame, |work| work.detect(camera))
}

/// Merges all points into one cloud. The same as `pcmvs_frame_step` with `PCMVS_STAGE_MERGE`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_merge(frame: *mut pcmvs_frame) -> pcmvs_status {
    run(frame, Stage::Merge, Stage::Merge)
}

/// Turns the merged cloud into a closed mesh. The same as `pcmvs_frame_step` with `PCMVS_STAGE_MESH`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_mesh(frame: *mut pcmvs_frame) -> pcmvs_status {
    run(frame, Stage::Mesh, Stage::Mesh)
}

/// Colours the mesh, then runs every stage after that. After it the frame is complete.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_colour(frame: *mut pcmvs_frame) -> pcmvs_status {
    run(frame, Stage::Colour, ORDER[ORDER.len() - 1])
}

/// Describes the last failed call on a frame, including calls that only read results. If this function itself fails,
/// the description stays as it is. `size` is `sizeof *error`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_error(
    frame: *const pcmvs_frame,
    error: *mut pcmvs_error,
    size: usize,
) -> pcmvs_status {
    // SAFETY: the caller's promise.
    status(catch(|| unsafe { write(error, size, &pcmvs_error::from(body(frame)?.work.failure()), "error") }))
}
