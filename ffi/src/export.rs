//! A frame's results as files.

use crate::{
    failure::{Failure, Result},
    frame::{pcmvs_frame, shared},
    sized::{Growing, Versioned, init, read},
    status::pcmvs_status::{self, InvalidArgument, NullPointer, WriteFailed},
    target::Target,
    work::Work,
};
use pcmvs_core::{
    Stage,
    export::{glb, ply},
};
use std::{
    ffi::{c_int, c_void},
    mem::size_of,
};

/// File formats. Numbers never change.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum pcmvs_file_format {
    /// Binary glTF 2.0 with linear vertex colours and an unlit material.
    Glb = 0,
    /// Binary little-endian PLY with sRGB vertex colours.
    Ply = 1,
}

/// Options for exporting a mesh.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_export_options {
    /// Set by `pcmvs_export_options_init`.
    pub struct_size: u32,
    /// A `pcmvs_file_format`.
    pub format: u32,
    /// GLB only: 1 to write normals, 0 to leave them out. The default is 1.
    pub normals: u32,
    /// GLB only: 1 if `up` is set, otherwise 0. The default is 0.
    pub has_up: u32,
    /// GLB only: the scene's upward direction, which is recorded for players. Coordinates are not changed.
    pub up: [f64; 3],
}

impl Growing for pcmvs_export_options {
    const FIRST_SIZE: usize = 40;
}

// SAFETY: numbers only, the size first, no padding.
unsafe impl Versioned for pcmvs_export_options {
    fn defaults() -> Self {
        let format = pcmvs_file_format::Glb as u32;
        Self { struct_size: size_of::<Self>() as u32, format, normals: 1, has_up: 0, up: [0.0; 3] }
    }
}

/// Initialises export options with their defaults: GLB with normals. `size` is `sizeof *options`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_export_options_init(options: *mut pcmvs_export_options, size: usize) -> pcmvs_status {
    // SAFETY: the caller's promise.
    unsafe { init(options, size, "options") }
}

/// Receives the next `size` bytes of a file. Return 0 to continue, or any other value to make the export fail with
/// `PCMVS_STATUS_WRITE_FAILED`. Called one or more times, on the thread that made the call. It must not throw. It may call
/// functions that take a `const pcmvs_frame *`; others fail with `PCMVS_STATUS_BUSY`.
pub type pcmvs_write_fn = Option<unsafe extern "C" fn(user: *mut c_void, data: *const c_void, size: usize) -> c_int>;

impl Work {
    /// A mesh as a file's bytes, and the stage that makes it.
    ///
    /// # Safety
    /// `options` is NULL or points to as many bytes as its `struct_size` says.
    unsafe fn mesh_file(&self, kind: u32, options: *const pcmvs_export_options) -> Result<(Vec<u8>, Stage)> {
        let (mesh, stage) = self.mesh_of_kind(kind)?;
        let options = if options.is_null() {
            pcmvs_export_options::defaults()
        } else {
            // SAFETY: the caller's promise.
            unsafe { read(options, "options") }.map_err(|f| f.at(stage))?
        };
        let refused = |problem: String| Err(Failure::new(InvalidArgument, problem).at(stage));
        if options.normals > 1 || options.has_up > 1 {
            return refused("normals and has_up must be 0 or 1".to_owned());
        }
        if options.has_up == 1 && options.up.iter().any(|v| !v.is_finite()) {
            return refused("up is not finite".to_owned());
        }
        let file = match options.format {
            0 => {
                let up = (options.has_up == 1).then_some(options.up);
                glb::write(
                    mesh,
                    self.frame.rig().origin(),
                    &glb::Options { normals: options.normals == 1, up, ..Default::default() },
                )
            }
            1 => ply::write_mesh(mesh, self.frame.rig().origin()),
            other => return refused(format!("file format {other} is not known")),
        };
        Ok((file, stage))
    }
}

/// Makes a file and passes it to the callback.
///
/// # Safety
/// `write` may be called with `user`.
unsafe fn hand_over(
    write: pcmvs_write_fn,
    user: *mut c_void,
    file: impl FnOnce() -> Result<(Vec<u8>, Stage)>,
) -> Result<()> {
    let write = write.ok_or_else(|| Failure::new(NullPointer, "`write` is NULL"))?;
    let (bytes, stage) = file()?;
    // SAFETY: the caller's promise.
    if unsafe { write(user, bytes.as_ptr().cast(), bytes.len()) } != 0 {
        return Err(Failure::new(WriteFailed, "the write callback returned an error").at(stage));
    }
    Ok(())
}

/// Writes a mesh as a file to a callback. `kind` is a `pcmvs_mesh_kind`. `options` may be NULL. `user` is passed to `write`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_export_mesh(
    frame: *const pcmvs_frame,
    kind: u32,
    options: *const pcmvs_export_options,
    write: pcmvs_write_fn,
    user: *mut c_void,
) -> pcmvs_status {
    // SAFETY: the caller's promise.
    shared(frame, |work| unsafe { hand_over(write, user, || work.mesh_file(kind, options)) })
}

/// Writes a mesh as a file to a buffer of `capacity` bytes. `size` receives the file's size in bytes and may be NULL. With
/// a NULL `buffer` and a `capacity` of 0 the function only writes `size`. That takes as long as writing the file;
/// `pcmvs_frame_export_mesh` needs one call only. `options` may be NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_export_mesh_to_buffer(
    frame: *const pcmvs_frame,
    kind: u32,
    options: *const pcmvs_export_options,
    buffer: *mut c_void,
    capacity: usize,
    size: *mut usize,
) -> pcmvs_status {
    let copy = |work: &Work| {
        let target = Target { buffer: buffer.cast(), capacity, stride: 0, count: size };
        // SAFETY: the caller's promise.
        unsafe {
            let (file, stage) = work.mesh_file(kind, options)?;
            target.fill(file.iter().copied()).map_err(|f| f.at(stage))
        }
    };
    shared(frame, copy)
}

/// Writes a cloud as a PLY file to a callback. `kind` and `camera` are as in `pcmvs_frame_copy_cloud`. `user` is passed to
/// `write`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_export_cloud(
    frame: *const pcmvs_frame,
    kind: u32,
    camera: u32,
    write: pcmvs_write_fn,
    user: *mut c_void,
) -> pcmvs_status {
    let file = |work: &Work| {
        let (cloud, stage) = work.cloud_of_kind(kind, camera)?;
        Ok((ply::write_cloud(&cloud.to_vec(), work.frame.rig().origin()), stage))
    };
    // SAFETY: the caller's promise.
    shared(frame, |work| unsafe { hand_over(write, user, || file(work)) })
}
