//! The handle of a frame, and its stages.

use crate::{
    boundary::{Opaque, Result, Versioned, body, catch, free, into_handle, out, read, read_array, status, write},
    clock::Clock,
    error::{Failure, LastFailure, pcmvs_error},
    options::pcmvs_options,
    progress::HostProgress,
    rig::{RigBody, pcmvs_rig, with_rig},
    status::pcmvs_status::{self, Busy, InvalidArgument},
    view::{GivenView, pcmvs_view},
};
use pcmvs_core::{Frame, Memory, Rig, Stage, ViewInput};
use std::mem::replace;
use std::sync::{
    Arc, RwLock, TryLockError,
    atomic::{AtomicU32, Ordering},
};

/// One frame on its way from pictures to a mesh, and its results. Used again for frame after frame.
pub struct pcmvs_frame {
    _private: (),
}

/// A frame and its last failure.
pub(crate) struct FrameBody {
    number: AtomicU32,
    work: RwLock<Work>,
    failure: LastFailure,
}

/// What the handle's lock protects.
pub(crate) struct Work {
    options: pcmvs_options,
    pub frame: Frame<Arc<Rig>>,
    pub clock: Clock,
}

impl Work {
    fn new(rig: Arc<Rig>, options: pcmvs_options, memory: Memory) -> Result<Self> {
        Ok(Self { options, frame: Frame::new(rig, options.params()?, memory), clock: Clock::default() })
    }

    /// Begins the next frame. It takes over the working memory of the last one unless either has a limit.
    fn restart(&mut self, options: pcmvs_options) -> Result<()> {
        let rig = Arc::clone(self.frame.rig());
        let next = Self::new(Arc::clone(&rig), options, options.memory())?;
        let last = replace(self, next);
        if options.max_memory == 0 && last.options.max_memory == 0 {
            *self = Self::new(rig, options, last.frame.recycle())?;
        }
        Ok(())
    }

    /// Fails unless a stage is complete.
    pub fn require(&self, stage: Stage) -> Result<()> {
        self.frame.require(stage).map_err(|error| Failure::from(error).at(stage))
    }

    /// Runs all stages.
    fn run_all(&mut self, inputs: &[ViewInput]) -> Result<()> {
        let progress = HostProgress::new(&self.options, &self.clock);
        self.frame.run_all(inputs, &self.options.threads(), &progress).map_err(|error| {
            let failure = Failure::from(error);
            progress.stage().map_or(failure.clone(), |stage| failure.at(stage))
        })
    }

    /// Runs one stage.
    fn step(&mut self, stage: Stage) -> Result<()> {
        let progress = HostProgress::new(&self.options, &self.clock);
        self.frame.step(stage, &self.options.threads(), &progress).map_err(|error| Failure::from(error).at(stage))
    }
}

// SAFETY: the raw pointers in `options` are the host's: it lets them be used on every thread on which it calls.
unsafe impl Send for Work {}
// SAFETY: as above.
unsafe impl Sync for Work {}

impl Opaque for pcmvs_frame {
    type Body = FrameBody;
    const TAG: u64 = u64::from_be_bytes(*b"pcmvsfrm");
}

const BUSY: &str = "the frame is in use by another call: wait until that has returned";

impl FrameBody {
    fn shared(&self, work: impl FnOnce(&Work) -> Result<()>) -> Result<()> {
        self.failure.check()?;
        let guard = self.work.try_read().map_err(|_| Failure::new(Busy, BUSY))?;
        catch(|| work(&guard))
    }

    fn alone<T>(&self, work: impl FnOnce(&mut Work) -> Result<T>) -> Result<T> {
        self.failure.check()?;
        let mut guard = self.work.try_write().map_err(|_| Failure::new(Busy, BUSY))?;
        catch(|| work(&mut guard))
    }

    fn keep(&self, result: Result<()>) -> pcmvs_status {
        self.failure.keep(result, Some(self.number.load(Ordering::Relaxed)))
    }
}

/// Runs a stage that needs the frame for itself.
///
/// # Safety
/// As for [`body`].
unsafe fn step(frame: *mut pcmvs_frame, stage: Stage) -> pcmvs_status {
    // SAFETY: the caller's promise.
    match unsafe { body(frame.cast_const()) } {
        Ok(frame) => frame.keep(frame.alone(|work| work.step(stage))),
        Err(failure) => failure.status,
    }
}

/// Reads results or runs a stage of one view, together with readers and stages of other views.
///
/// # Safety
/// As for [`body`].
pub(crate) unsafe fn shared(frame: *const pcmvs_frame, work: impl FnOnce(&Work) -> Result<()>) -> pcmvs_status {
    // SAFETY: the caller's promise.
    match unsafe { body(frame) } {
        Ok(frame) => frame.keep(frame.shared(work)),
        Err(failure) => failure.status,
    }
}

/// # Safety
/// As for [`read`].
unsafe fn begin(frame: &FrameBody, work: &mut Work, options: *const pcmvs_options) -> Result<()> {
    let given = if options.is_null() {
        pcmvs_options::defaults()
    } else {
        // SAFETY: the caller's promise.
        unsafe { read(options, "options")? }
    };
    given.params()?;
    frame.number.store(given.frame, Ordering::Relaxed);
    work.restart(given)
}

/// Makes a frame of a rig that has its cameras. Free it with `pcmvs_frame_free`. Why it failed is told by
/// `pcmvs_rig_error`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_new(rig: *const pcmvs_rig, frame: *mut *mut pcmvs_frame) -> pcmvs_status {
    let make = |rig: &RigBody| {
        let frame = out(frame, "frame")?;
        let rig = rig.get()?;
        let options = pcmvs_options::defaults();
        let work = Work::new(rig, options, options.memory())?;
        let made = FrameBody { number: AtomicU32::new(0), work: RwLock::new(work), failure: LastFailure::default() };
        // SAFETY: the caller's promise.
        unsafe { frame.write(into_handle(made)) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { with_rig(rig, make) }
}

/// Frees a frame and all that points into it. NULL does nothing. Fails with `PCMVS_STATUS_BUSY` while a call is running.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_free(frame: *mut pcmvs_frame) -> pcmvs_status {
    let idle = |frame: &FrameBody| match frame.work.try_write() {
        Err(TryLockError::WouldBlock) => {
            let failure = Failure::new(Busy, BUSY);
            frame.keep(Err(failure.clone()));
            Err(failure)
        }
        _ => Ok(()),
    };
    // SAFETY: the caller's promise.
    unsafe { free(frame, idle) }
}

/// The whole job in one call: begins a frame and runs all its stages. `views` holds `count` views, one a camera, in the
/// rig's order. `options` may be NULL. On failure no result is there, and the handle can be used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_reconstruct(
    frame: *mut pcmvs_frame,
    views: *const pcmvs_view,
    count: usize,
    options: *const pcmvs_options,
) -> pcmvs_status {
    // SAFETY: the caller's promise.
    let frame: &FrameBody = match unsafe { body(frame.cast_const()) } {
        Ok(frame) => frame,
        Err(failure) => return failure.status,
    };
    let result = frame.alone(|work| {
        // SAFETY: the caller's promise.
        unsafe { begin(frame, work, options)? };
        if count != work.frame.cameras() {
            let problem = format!("{count} views were given for {} cameras: give one each", work.frame.cameras());
            return Err(Failure::new(InvalidArgument, problem));
        }
        let at = |failure: Failure| failure.at(Stage::Views);
        // SAFETY: the caller's promise.
        let views = unsafe { read_array(views, count, "views") }.map_err(at)?;
        // SAFETY: the caller's promise.
        let given = |(i, view)| unsafe { GivenView::new(view) }.map_err(|f| at(f.of_camera(i as u32)));
        let given = views.iter().enumerate().map(given).collect::<Result<Vec<_>>>()?;
        let inputs: Vec<_> = given.iter().map(GivenView::input).collect();
        let made = work.run_all(&inputs);
        if made.is_err() {
            // Nothing is kept of a frame that fails.
            work.restart(work.options)?;
        }
        made
    });
    frame.keep(result)
}

/// Begins a frame to be made stage by stage, and drops the one before. `options` may be NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_begin(frame: *mut pcmvs_frame, options: *const pcmvs_options) -> pcmvs_status {
    // SAFETY: the caller's promise.
    match unsafe { body(frame.cast_const()) } {
        // SAFETY: the caller's promise.
        Ok(frame) => frame.keep(frame.alone(|work| unsafe { begin(frame, work, options) })),
        Err(failure) => failure.status,
    }
}

/// Reads a camera's picture and silhouette. Any number of threads may do this for views of their own.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_view(
    frame: *mut pcmvs_frame,
    camera: u32,
    view: *const pcmvs_view,
) -> pcmvs_status {
    // SAFETY: the caller's promise.
    unsafe {
        shared(frame, |work| {
            let at = |failure: Failure| failure.of_camera(camera).at(Stage::Views);
            let given = read(view, "view").and_then(|view| GivenView::new(&view)).map_err(at)?;
            let progress = HostProgress::new(&work.options, &work.clock);
            work.frame.view(camera as usize, &given.input(), &progress).map_err(|e| Failure::from(e).at(Stage::Views))
        })
    }
}

/// Carves the visual hull, once every camera has its view.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_hull(frame: *mut pcmvs_frame) -> pcmvs_status {
    // SAFETY: the caller's promise.
    unsafe { step(frame, Stage::Hull) }
}

/// Finds the points that the silhouettes alone give.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_contours(frame: *mut pcmvs_frame) -> pcmvs_status {
    // SAFETY: the caller's promise.
    unsafe { step(frame, Stage::Contours) }
}

/// Detects and meshes at half the resolution.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_coarse(frame: *mut pcmvs_frame) -> pcmvs_status {
    // SAFETY: the caller's promise.
    unsafe { step(frame, Stage::Coarse) }
}

/// Detects the points of one view by stereo with its neighbours. Any number of threads may do this for views of their
/// own; the result does not depend on threads or order.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_detect(frame: *mut pcmvs_frame, camera: u32) -> pcmvs_status {
    // SAFETY: the caller's promise.
    unsafe {
        shared(frame, |work| {
            let progress = HostProgress::new(&work.options, &work.clock);
            work.frame.detect(camera as usize, &progress).map_err(|e| Failure::from(e).at(Stage::Detect))
        })
    }
}

/// Merges all points to one cloud, once every view has been detected.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_merge(frame: *mut pcmvs_frame) -> pcmvs_status {
    // SAFETY: the caller's promise.
    unsafe { step(frame, Stage::Merge) }
}

/// Makes a closed mesh of the merged cloud.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_mesh(frame: *mut pcmvs_frame) -> pcmvs_status {
    // SAFETY: the caller's promise.
    unsafe { step(frame, Stage::Mesh) }
}

/// Colours the mesh.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_colour(frame: *mut pcmvs_frame) -> pcmvs_status {
    // SAFETY: the caller's promise.
    unsafe { step(frame, Stage::Colour) }
}

/// Why the last failed call on this frame failed, calls that only read results included; a failure of this function
/// itself changes nothing. `size` is `sizeof *error`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_error(
    frame: *const pcmvs_frame,
    error: *mut pcmvs_error,
    size: usize,
) -> pcmvs_status {
    // SAFETY: the caller's promise.
    status(catch(|| unsafe { write(error, size, &body(frame)?.failure.get(), "error") }))
}
