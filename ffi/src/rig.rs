//! The handle of what does not change between frames.

use crate::{
    boundary::{catch, out, status},
    camera::pcmvs_camera,
    error::pcmvs_error,
    failure::{Failure, LastFailure, Result},
    handles::{Opaque, body, free, into_handle},
    sized::{read_array, write},
    status::pcmvs_status::{self, InvalidArgument, WrongOrder},
};
use pcmvs_core::{Camera, Error, Rig};
use std::sync::{Arc, PoisonError, RwLock};

/// Maximum number of cameras of a rig.
pub const PCMVS_MAX_CAMERAS: u32 = 1024;

/// A set of calibrated cameras and the data computed from it. A rig may be shared by any number of frames and threads, and
/// may be freed before its frames.
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
}

/// Does work on a rig and keeps its failure.
pub(crate) fn with_rig(rig: *const pcmvs_rig, work: impl FnOnce(&RigBody) -> Result<()>) -> pcmvs_status {
    match body(rig) {
        Ok(rig) => rig.failure.keep(rig.failure.check().and_then(|()| catch(|| work(&rig))), None),
        Err(failure) => failure.status,
    }
}

impl RigBody {
    /// The rig, if cameras have been set.
    pub fn get(&self) -> Result<Arc<Rig>> {
        let rig = self.rig.read().unwrap_or_else(PoisonError::into_inner);
        rig.clone().ok_or_else(|| Failure::new(WrongOrder, "the rig has no cameras yet: call pcmvs_rig_set_cameras"))
    }

    fn set(&self, rig: Rig) {
        *self.rig.write().unwrap_or_else(PoisonError::into_inner) = Some(Arc::new(rig));
    }
}

/// Creates a rig without cameras. Free it with `pcmvs_rig_free`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_rig_new(rig: *mut *mut pcmvs_rig) -> pcmvs_status {
    status(catch(|| {
        let rig = out(rig, "rig")?;
        // SAFETY: the caller's promise.
        unsafe { rig.write(into_handle(RigBody { rig: RwLock::new(None), failure: LastFailure::default() })) };
        Ok(())
    }))
}

/// Frees a rig. NULL is ignored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_rig_free(rig: *mut pcmvs_rig) -> pcmvs_status {
    free(rig, |_| Ok(()))
}

/// Sets the cameras of a rig, 3 to `PCMVS_MAX_CAMERAS`, and computes everything that its frames share. The views of every
/// frame are numbered in the order of `cameras`. On failure the rig keeps the cameras it had. Existing frames keep the
/// cameras with which they were created.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_rig_set_cameras(
    rig: *mut pcmvs_rig,
    cameras: *const pcmvs_camera,
    count: usize,
) -> pcmvs_status {
    let prepare = |rig: &RigBody| {
        if count > PCMVS_MAX_CAMERAS as usize {
            let problem = format!("{count} cameras were given, but a rig can have at most {PCMVS_MAX_CAMERAS}");
            return Err(Failure::new(InvalidArgument, problem));
        }
        // SAFETY: the caller's promise.
        let cameras = unsafe { read_array(cameras, count, "cameras")? };
        let camera = |(i, camera): (usize, pcmvs_camera)| {
            camera.to_core().map_err(|problem| Failure::from(Error::Camera { camera: i as u32, problem }))
        };
        let cameras: Vec<Camera> = cameras.into_iter().enumerate().map(camera).collect::<Result<_>>()?;
        rig.set(Rig::new(&cameras)?);
        Ok(())
    };
    with_rig(rig, prepare)
}

/// Fixes the gains of a rig's cameras: the factors applied to red, green and blue when a mesh is coloured. `gains` holds
/// three floats per camera, `count` is the number of cameras. Without fixed gains every frame estimates its own, and
/// colours may vary slightly from frame to frame. `pcmvs_frame_copy_gains` returns the gains of a frame.
/// `pcmvs_rig_set_cameras` removes fixed gains. Existing frames keep the gains that the rig had when they were created.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_rig_set_gains(rig: *mut pcmvs_rig, gains: *const f32, count: usize) -> pcmvs_status {
    let fix = |rig: &RigBody| {
        let gains: *const [f32; 3] = out(gains.cast_mut(), "gains")?.cast();
        let old = rig.get()?;
        if count != old.cameras().len() {
            return Err(Error::GainCount { given: count as u32, cameras: old.cameras().len() as u32 }.into());
        }
        // SAFETY: the caller's promise; the numbers need no alignment.
        let gains: Vec<_> = (0..count).map(|i| unsafe { gains.add(i).read_unaligned() }).collect();
        rig.set(Rig::clone(&old).with_gains(&gains)?);
        Ok(())
    };
    with_rig(rig, fix)
}

/// Returns the number of cameras, which is 0 before they are set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_rig_camera_count(rig: *const pcmvs_rig, count: *mut u32) -> pcmvs_status {
    let get = |rig: &RigBody| {
        let count = out(count, "count")?;
        let cameras = rig.rig.read().unwrap_or_else(PoisonError::into_inner).as_ref().map_or(0, |r| r.cameras().len());
        // SAFETY: the caller's promise.
        unsafe { count.write(cameras as u32) };
        Ok(())
    };
    with_rig(rig, get)
}

/// Returns the origin of the positions in `pcmvs_mesh` and `pcmvs_point`: x, y, z in the scene's frame. `xyz` has room for
/// three doubles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_rig_origin(rig: *const pcmvs_rig, xyz: *mut f64) -> pcmvs_status {
    let get = |rig: &RigBody| {
        let rig = rig.get()?;
        let xyz: *mut [f64; 3] = out(xyz, "xyz")?.cast();
        // SAFETY: the caller's promise.
        unsafe { xyz.write(rig.origin().to_array()) };
        Ok(())
    };
    with_rig(rig, get)
}

/// Describes the last failed call on a rig, including `pcmvs_frame_new`. If this function itself fails, the description
/// stays as it is. `size` is `sizeof *error`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_rig_error(rig: *const pcmvs_rig, error: *mut pcmvs_error, size: usize) -> pcmvs_status {
    // SAFETY: the caller's promise.
    status(catch(|| unsafe { write(error, size, &pcmvs_error::from(&body(rig)?.failure), "error") }))
}
