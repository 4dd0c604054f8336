//! The handle of a calibration: a lock around some frames of a take.

use crate::{
    boundary::{catch, out, status},
    calibration_options::pcmvs_calibration_options,
    clock::Clock,
    error::pcmvs_error,
    failure::{Failure, Result},
    handles::{Opaque, body, free, into_handle},
    locked::Locked,
    rig::{RigBody, pcmvs_rig, with_rig},
    sized::{Versioned, read, read_array, write},
    status::pcmvs_status::{self, InvalidArgument},
    take::Take,
    view::{GivenView, pcmvs_view},
};
use pcmvs_core::Stage;

/// Checks the cameras of a rig by some frames of a take, and refines them. A rig does not move during a take, so that a few
/// frames in which the person stands differently say more than one. Create it, add frames, run it, and read what was found:
/// `pcmvs_calibration_get_report` for the whole, `pcmvs_calibration_get_camera_report` for each camera,
/// `pcmvs_calibration_get_warning` for what is wrong, and `pcmvs_calibration_get_camera` for the refined cameras, of which a
/// new rig can be made.
pub struct pcmvs_calibration {
    _private: (),
}

impl Opaque for pcmvs_calibration {
    type Body = Locked<Take>;
}

/// Reads results. Other such calls may run at the same time.
pub(crate) fn shared(calibration: *const pcmvs_calibration, work: impl FnOnce(&Take) -> Result<()>) -> pcmvs_status {
    match body(calibration) {
        Ok(take) => take.keep(take.shared(work), None),
        Err(failure) => failure.status,
    }
}

/// Does work that needs the calibration for itself. It notes the number of the frame to which a failure belongs.
fn exclusive(
    calibration: *mut pcmvs_calibration,
    work: impl FnOnce(&mut Take, &mut Option<u32>) -> Result<()>,
) -> pcmvs_status {
    match body(calibration.cast_const()) {
        Ok(take) => {
            let mut frame = None;
            let result = take.exclusive(|take| work(take, &mut frame));
            take.keep(result, frame)
        }
        Err(failure) => failure.status,
    }
}

/// # Safety
/// As for [`read`].
unsafe fn options_or_default(options: *const pcmvs_calibration_options) -> Result<pcmvs_calibration_options> {
    if options.is_null() {
        return Ok(pcmvs_calibration_options::defaults());
    }
    // SAFETY: the caller's promise.
    unsafe { read(options, "options") }
}

/// Creates a calibration without frames for a rig whose cameras have been set. Free it with `pcmvs_calibration_free`. It
/// keeps the cameras that the rig has now, and the rig may be freed before it. If this fails, `pcmvs_rig_error` says why.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_calibration_new(
    rig: *const pcmvs_rig,
    calibration: *mut *mut pcmvs_calibration,
) -> pcmvs_status {
    let make = |rig: &RigBody| {
        let calibration = out(calibration, "calibration")?;
        let made = Locked::new("the calibration", Take::new(rig.get()?));
        // SAFETY: the caller's promise.
        unsafe { calibration.write(into_handle(made)) };
        Ok(())
    };
    with_rig(rig, make)
}

/// Frees a calibration. NULL is ignored. Fails with `PCMVS_STATUS_BUSY` while a call on the calibration is running.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_calibration_free(calibration: *mut pcmvs_calibration) -> pcmvs_status {
    let idle = |take: &Locked<Take>| {
        take.idle().inspect_err(|busy| {
            take.keep(Err(busy.clone()), None);
        })
    };
    free(calibration, idle)
}

/// Adds a frame of the take: reads its pictures and silhouettes, which the caller may change or free afterwards. `views` holds
/// one view per camera, in the order in which the cameras were given to `pcmvs_rig_set_cameras`, and `count` must be the
/// number of cameras. A camera without picture in this frame contributes nothing to it. Matching works inside the
/// silhouettes, so that a view without one contributes little. `options` may be NULL; only its threads and its progress are
/// used. The calibration keeps about three bytes per pixel of every view. Results from before are discarded. On failure
/// nothing is added.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_calibration_add_frame(
    calibration: *mut pcmvs_calibration,
    views: *const pcmvs_view,
    count: usize,
    options: *const pcmvs_calibration_options,
) -> pcmvs_status {
    let add = |take: &mut Take, frame: &mut Option<u32>| {
        *frame = Some(take.frames());
        // SAFETY: the caller's promise.
        let options = unsafe { options_or_default(options)? };
        options.params()?;
        if count != take.cameras() {
            let problem = format!("{count} views were given for {} cameras: give one per camera", take.cameras());
            return Err(Failure::new(InvalidArgument, problem));
        }
        let at = |failure: Failure| failure.at(Stage::Views);
        // SAFETY: the caller's promise.
        let views = unsafe { read_array(views, count, "views") }.map_err(at)?;
        let sizes = take.calibrated();
        // SAFETY: the caller's promise.
        let given = |(i, view)| unsafe { GivenView::new(view, sizes[i]) }.map_err(|f| at(f.of_camera(i as u32)));
        let given = views.iter().enumerate().map(given).collect::<Result<Vec<_>>>()?;
        let inputs: Vec<_> = given.iter().map(GivenView::input).collect();
        let clock = Clock::default();
        let progress = options.progress(&clock);
        take.add(&inputs, &options.threads(), &progress).map_err(|failure| progress.explain(failure))
    };
    exclusive(calibration, add)
}

/// Checks and refines the cameras by all frames that have been added. `options` may be NULL. More frames can be added
/// afterwards, and the call can be repeated. On failure the calibration keeps its frames and has no results.
///
/// If two cameras' pictures are exchanged, the warning "cameras-swapped" and `pcmvs_calibration_report` name them. Their
/// views were read with each other's lens, so that no refinement can make up for it: exchange their pictures and masks, and
/// add the frames to a new calibration.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_calibration_run(
    calibration: *mut pcmvs_calibration,
    options: *const pcmvs_calibration_options,
) -> pcmvs_status {
    let run = |take: &mut Take, _: &mut Option<u32>| {
        // SAFETY: the caller's promise.
        let options = unsafe { options_or_default(options)? };
        let clock = Clock::default();
        let progress = options.progress(&clock);
        take.run(&options.params()?, &options.threads(), &progress).map_err(|failure| progress.explain(failure))
    };
    exclusive(calibration, run)
}

/// Describes the last failed call on a calibration, including calls that only read results. If this function itself fails,
/// the description stays as it is. `size` is `sizeof *error`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_calibration_error(
    calibration: *const pcmvs_calibration,
    error: *mut pcmvs_error,
    size: usize,
) -> pcmvs_status {
    // SAFETY: the caller's promise.
    status(catch(|| unsafe { write(error, size, &pcmvs_error::from(body(calibration)?.failure()), "error") }))
}
