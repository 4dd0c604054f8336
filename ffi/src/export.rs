//! A frame's results as files' bytes.

use crate::{
    boundary::{Result, Versioned, body, catch, init, read, status},
    error::Failure,
    frame::pcmvs_frame,
    mesh::Target,
    pipeline::Pipeline,
    status::pcmvs_status::{self, InvalidArgument, NullPointer, WriteFailed},
};
use pcmvs_core::export::{glb, ply};
use std::{
    ffi::{c_int, c_void},
    mem::size_of,
};

/// Formats of files. Numbers never change.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum pcmvs_file_format {
    /// Binary glTF 2.0 with linear vertex colours and an unlit material.
    Glb = 0,
    /// Binary little-endian PLY with sRGB vertex colours.
    Ply = 1,
}

/// What a file holds.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_export_options {
    /// Set by `pcmvs_export_options_init`.
    pub struct_size: u32,
    /// A `pcmvs_file_format`.
    pub format: u32,
    /// GLB only: 1 writes normals, 0 leaves them out. 1 by default.
    pub normals: u32,
    /// GLB only: 1 if `up` is given, else 0.
    pub has_up: u32,
    /// GLB only: the scene's upward direction, recorded for players; coordinates stay as they are.
    pub up: [f64; 3],
}

// SAFETY: numbers only, the size first, no padding.
unsafe impl Versioned for pcmvs_export_options {
    const FIRST_SIZE: usize = 40;

    fn defaults() -> Self {
        let format = pcmvs_file_format::Glb as u32;
        Self { struct_size: size_of::<Self>() as u32, format, normals: 1, has_up: 0, up: [0.0; 3] }
    }
}

/// Sets export options to their defaults: GLB with normals. `size` is `sizeof *options`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_export_options_init(options: *mut pcmvs_export_options, size: usize) -> pcmvs_status {
    // SAFETY: the caller's promise.
    unsafe { init(options, size, "options") }
}

/// Takes the next `size` bytes of a file. Return 0 to go on, anything else to fail with `PCMVS_STATUS_WRITE_FAILED`.
/// Called on the thread that made the call, once or more often. It must not throw.
pub type pcmvs_write_fn = Option<unsafe extern "C" fn(user: *mut c_void, data: *const c_void, size: usize) -> c_int>;

impl Pipeline {
    /// # Safety
    /// `options` is NULL or true.
    unsafe fn mesh_file(&self, kind: u32, options: *const pcmvs_export_options) -> Result<Vec<u8>> {
        // SAFETY: the caller's promise.
        let options =
            if options.is_null() { pcmvs_export_options::defaults() } else { unsafe { read(options, "options")? } };
        let (mesh, origin) = (self.mesh_of_kind(kind)?, self.rig.origin());
        if options.normals > 1 || options.has_up > 1 {
            return Err(Failure::new(InvalidArgument, "normals and has_up are 0 or 1"));
        }
        if options.has_up == 1 && options.up.iter().any(|v| !v.is_finite()) {
            return Err(Failure::new(InvalidArgument, "up is not finite"));
        }
        match options.format {
            0 => {
                let up = (options.has_up == 1).then_some(options.up);
                Ok(glb::write(mesh, origin, &glb::Options { normals: options.normals == 1, up }))
            }
            1 => Ok(ply::write_mesh(mesh, origin)),
            other => Err(Failure::new(InvalidArgument, format!("file format {other} is not known"))),
        }
    }
}

/// # Safety
/// The callback is sound.
unsafe fn hand_over(bytes: &[u8], write: pcmvs_write_fn, user: *mut c_void) -> Result<()> {
    let write = write.ok_or_else(|| Failure::new(NullPointer, "`write` is NULL"))?;
    // SAFETY: the caller's promise.
    if unsafe { write(user, bytes.as_ptr().cast(), bytes.len()) } != 0 {
        return Err(Failure::new(WriteFailed, "the write callback refused"));
    }
    Ok(())
}

/// Hands a mesh (`kind` is a `pcmvs_mesh_kind`) as a file's bytes to a callback. `options` may be NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_export_mesh(
    frame: *const pcmvs_frame,
    kind: u32,
    options: *const pcmvs_export_options,
    write: pcmvs_write_fn,
    user: *mut c_void,
) -> pcmvs_status {
    // SAFETY: the caller's promise.
    status(catch(|| unsafe {
        let work = body(frame)?.shared()?;
        if write.is_none() {
            return Err(Failure::new(NullPointer, "`write` is NULL"));
        }
        hand_over(&work.pipeline.mesh_file(kind, options)?, write, user)
    }))
}

/// Writes a mesh as a file's bytes to a buffer of `capacity` bytes; `size`, if not NULL, gets their number. With a NULL
/// `buffer` and a `capacity` of 0 only the number is told, which costs as much as writing: `pcmvs_frame_export_mesh`
/// needs no second call. `options` may be NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_export_mesh_to_buffer(
    frame: *const pcmvs_frame,
    kind: u32,
    options: *const pcmvs_export_options,
    buffer: *mut c_void,
    capacity: usize,
    size: *mut usize,
) -> pcmvs_status {
    // SAFETY: the caller's promise.
    status(catch(|| unsafe {
        let work = body(frame)?.shared()?;
        let target = Target { buffer: buffer.cast(), capacity, stride: 0, count: size };
        target.fill(work.pipeline.mesh_file(kind, options)?.iter().copied())
    }))
}

/// Hands a cloud (as for `pcmvs_frame_copy_cloud`) as a PLY file's bytes to a callback.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_export_cloud(
    frame: *const pcmvs_frame,
    kind: u32,
    camera: u32,
    write: pcmvs_write_fn,
    user: *mut c_void,
) -> pcmvs_status {
    // SAFETY: the caller's promise.
    status(catch(|| unsafe {
        let work = body(frame)?.shared()?;
        if write.is_none() {
            return Err(Failure::new(NullPointer, "`write` is NULL"));
        }
        let cloud = work.pipeline.cloud_of_kind(kind, camera)?.to_vec();
        hand_over(&ply::write_cloud(&cloud, work.pipeline.rig.origin()), write, user)
    }))
}
