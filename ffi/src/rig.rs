//! The handle of what does not change between frames.

use crate::{
    boundary::{Opaque, Result, body, catch, free, into_handle, out, read_array, status, write},
    camera::pcmvs_camera,
    error::{Failure, LastFailure, pcmvs_error},
    status::pcmvs_status::{self, Busy, InvalidArgument, WrongOrder},
};
use pcmvs_core::{Camera, Error, Rig};
use std::sync::{Arc, PoisonError, RwLock};

/// Most cameras of a rig.
pub const PCMVS_MOST_CAMERAS: u32 = 1024;

/// A calibrated set of cameras and what follows from it. Shared between any number of frames and threads; may be freed
/// before its frames.
pub struct pcmvs_rig {
    _private: (),
}

/// A rig and its last failure.
pub(crate) struct RigBody {
    rig: RwLock<Option<Arc<Rig>>>,
    failure: LastFailure,
}

impl Opaque for pcmvs_rig {
    type Body = RigBody;
    const TAG: u64 = u64::from_be_bytes(*b"pcmvsrig");
}

/// Runs what needs a rig; why it failed is kept.
///
/// # Safety
/// As for [`body`].
pub(crate) unsafe fn with_rig(rig: *const pcmvs_rig, work: impl FnOnce(&RigBody) -> Result<()>) -> pcmvs_status {
    // SAFETY: the caller's promise.
    match unsafe { body(rig) } {
        Ok(rig) => rig.failure.keep(rig.failure.check().and_then(|()| catch(|| work(rig))), None),
        Err(failure) => failure.status,
    }
}

impl RigBody {
    /// The rig, if cameras have been set.
    pub fn get(&self) -> Result<Arc<Rig>> {
        let rig = self.rig.read().unwrap_or_else(PoisonError::into_inner);
        rig.clone().ok_or_else(|| Failure::new(WrongOrder, "the rig has no cameras yet: call pcmvs_rig_set_cameras"))
    }
}

/// Makes a rig without cameras. Free it with `pcmvs_rig_free`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_rig_new(rig: *mut *mut pcmvs_rig) -> pcmvs_status {
    status(catch(|| {
        let rig = out(rig, "rig")?;
        // SAFETY: the caller's promise.
        unsafe { rig.write(into_handle(RigBody { rig: RwLock::new(None), failure: LastFailure::default() })) };
        Ok(())
    }))
}

/// Frees a rig. NULL does nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_rig_free(rig: *mut pcmvs_rig) -> pcmvs_status {
    // SAFETY: the caller's promise.
    unsafe { free(rig, |_| Ok(())) }
}

/// Gives a rig its cameras: at least three, whose order is that of the views of every frame. Prepares all that frames
/// share. On failure the rig keeps the cameras it had. Frames made before keep their cameras.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_rig_set_cameras(
    rig: *mut pcmvs_rig,
    cameras: *const pcmvs_camera,
    count: usize,
) -> pcmvs_status {
    let prepare = |rig: &RigBody| {
        if count > PCMVS_MOST_CAMERAS as usize {
            let problem = format!("{count} cameras are more than the most, {PCMVS_MOST_CAMERAS}");
            return Err(Failure::new(InvalidArgument, problem));
        }
        // SAFETY: the caller's promise.
        let cameras = unsafe { read_array(cameras, count, "cameras")? };
        let cameras: Vec<Camera> = cameras.into_iter().map(pcmvs_camera::to_core).collect();
        let made = Rig::new(&cameras)?;
        *rig.rig.try_write().map_err(|_| Failure::new(Busy, "the rig is in use"))? = Some(Arc::new(made));
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { with_rig(rig, prepare) }
}

/// Fixes the gains of a rig's cameras: what their red, green and blue are multiplied by when a mesh is coloured, `gains`
/// holds three numbers a camera, `count` is the number of cameras. Without, every frame finds its own, so that colours
/// may differ a little from frame to frame; those of a frame are told by `pcmvs_frame_copy_gains`.
/// `pcmvs_rig_set_cameras` takes them away again. Frames made before keep what they had.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_rig_set_gains(rig: *mut pcmvs_rig, gains: *const f32, count: usize) -> pcmvs_status {
    let fix = |rig: &RigBody| {
        let gains: *const [f32; 3] = out(gains.cast_mut(), "gains")?.cast();
        let old = rig.get()?;
        if count != old.cameras().len() {
            return Err(Error::GainCount { given: count as u32, cameras: old.cameras().len() as u32 }.into());
        }
        // SAFETY: the caller's promise; numbers may lie at any address.
        let gains: Vec<_> = (0..count).map(|i| unsafe { gains.add(i).read_unaligned() }).collect();
        let made = Rig::clone(&old).with_gains(&gains)?;
        *rig.rig.try_write().map_err(|_| Failure::new(Busy, "the rig is in use"))? = Some(Arc::new(made));
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { with_rig(rig, fix) }
}

/// Number of cameras; 0 before they are set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_rig_camera_count(rig: *const pcmvs_rig, count: *mut u32) -> pcmvs_status {
    let tell = |rig: &RigBody| {
        let count = out(count, "count")?;
        let cameras = rig.rig.read().unwrap_or_else(PoisonError::into_inner).as_ref().map_or(0, |r| r.cameras().len());
        // SAFETY: the caller's promise.
        unsafe { count.write(cameras as u32) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { with_rig(rig, tell) }
}

/// World position (x, y, z) that is the origin of the positions in `pcmvs_mesh` and `pcmvs_point`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_rig_origin(rig: *const pcmvs_rig, xyz: *mut f64) -> pcmvs_status {
    let tell = |rig: &RigBody| {
        let rig = rig.get()?;
        let xyz: *mut [f64; 3] = out(xyz, "xyz")?.cast();
        // SAFETY: the caller's promise.
        unsafe { xyz.write(rig.origin().to_array()) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { with_rig(rig, tell) }
}

/// Why the last failed call on this rig, or the last `pcmvs_frame_new` of it, failed. `size` is `sizeof *error`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_rig_error(rig: *const pcmvs_rig, error: *mut pcmvs_error, size: usize) -> pcmvs_status {
    // SAFETY: the caller's promise.
    status(catch(|| unsafe { write(error, size, &body(rig)?.failure.get(), "error") }))
}
