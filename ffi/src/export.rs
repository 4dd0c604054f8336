//! A frame's results as files.

use crate::{
    compress::Meshopt,
    failure::{Failure, Result},
    frame::{pcmvs_frame, shared},
    sized::{Growing, Versioned, init, read},
    status::pcmvs_status::{self, InvalidArgument, NullPointer, WriteFailed},
    target::Target,
    work::Work,
};
use pcmvs_core::{
    Form, Stage,
    export::{glb, ply},
};
use std::{
    ffi::{c_int, c_uchar, c_uint, c_void},
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
///
/// GLB files can be compressed by meshoptimizer (EXT_meshopt_compression), which the library does not contain. To compress,
/// link meshoptimizer 1.0 or later and set each of the members `meshopt_...` to its function of the same name. By default
/// they are NULL, and files are not compressed. If some are NULL and others not, exporting fails with
/// `PCMVS_STATUS_NULL_POINTER`, and if one gives a result that meshoptimizer does not give, with
/// `PCMVS_STATUS_INVALID_ARGUMENT`. They are called on the thread that made the call. With `compact` = 1 and `normals` = 0 the
/// file is that of the command line's `--compress`. Its vertices and triangles are in another order than those that
/// `pcmvs_frame_get_mesh` gives.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
#[allow(non_snake_case, reason = "the names are meshoptimizer's")]
pub struct pcmvs_export_options {
    /// Set by `pcmvs_export_options_init`.
    pub struct_size: u32,
    /// A `pcmvs_file_format`.
    pub format: u32,
    /// 1, the default, to write normals, 0 to leave them out. PLY files always have them: 0 is refused.
    pub normals: u32,
    /// 1 if `up` is set, otherwise 0. The default is 0.
    pub has_up: u32,
    /// The scene's upward direction, which GLB files record for players. Coordinates are not changed. PLY files have no place
    /// for it.
    pub up: [f64; 3],
    /// GLB only: 1 to turn the mesh's node so that `up` becomes glTF's +y, which players show upright. Needs `has_up`.
    /// Otherwise 0, the default: the file is in the scene's frame. PLY files are always in that frame: 1 is refused.
    pub upright: u32,
    /// GLB only: 1 to write integers of few bits instead of single-precision numbers (KHR_mesh_quantization). The default is 0.
    /// For PLY files 1 is refused.
    pub compact: u32,
    /// Quality of a texture's JPEG picture, 1 to 100. The default is 90. It changes nothing in files without a texture.
    pub jpeg_quality: u32,
    /// Zero.
    pub reserved: u32,
    /// Sorts triangles so that neighbours follow each other.
    pub meshopt_optimizeVertexCacheStrip: Option<
        unsafe extern "C-unwind" fn(
            destination: *mut c_uint,
            indices: *const c_uint,
            index_count: usize,
            vertex_count: usize,
        ),
    >,
    /// Puts vertices in the order in which triangles use them.
    pub meshopt_optimizeVertexFetchRemap: Option<
        unsafe extern "C-unwind" fn(
            destination: *mut c_uint,
            indices: *const c_uint,
            index_count: usize,
            vertex_count: usize,
        ) -> usize,
    >,
    /// Largest size of encoded vertices, in bytes.
    pub meshopt_encodeVertexBufferBound:
        Option<unsafe extern "C-unwind" fn(vertex_count: usize, vertex_size: usize) -> usize>,
    /// Encodes vertices.
    pub meshopt_encodeVertexBufferLevel: Option<
        unsafe extern "C-unwind" fn(
            buffer: *mut c_uchar,
            buffer_size: usize,
            vertices: *const c_void,
            vertex_count: usize,
            vertex_size: usize,
            level: c_int,
            version: c_int,
        ) -> usize,
    >,
    /// Largest size of encoded triangles, in bytes.
    pub meshopt_encodeIndexBufferBound:
        Option<unsafe extern "C-unwind" fn(index_count: usize, vertex_count: usize) -> usize>,
    /// Encodes triangles.
    pub meshopt_encodeIndexBuffer: Option<
        unsafe extern "C-unwind" fn(
            buffer: *mut c_uchar,
            buffer_size: usize,
            indices: *const c_uint,
            index_count: usize,
        ) -> usize,
    >,
}

impl pcmvs_export_options {
    /// The functions of meshoptimizer, if they are set.
    fn meshopt(&self) -> Result<Option<Meshopt>> {
        Meshopt::new(
            self.meshopt_optimizeVertexCacheStrip,
            self.meshopt_optimizeVertexFetchRemap,
            self.meshopt_encodeVertexBufferBound,
            self.meshopt_encodeVertexBufferLevel,
            self.meshopt_encodeIndexBufferBound,
            self.meshopt_encodeIndexBuffer,
        )
    }
}

impl Growing for pcmvs_export_options {
    const FIRST_SIZE: usize = 40;
}

// SAFETY: numbers and nullable function pointers, the size first, no padding.
unsafe impl Versioned for pcmvs_export_options {
    fn defaults() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            format: pcmvs_file_format::Glb as u32,
            normals: 1,
            has_up: 0,
            up: [0.0; 3],
            upright: 0,
            compact: 0,
            jpeg_quality: 90,
            reserved: 0,
            meshopt_optimizeVertexCacheStrip: None,
            meshopt_optimizeVertexFetchRemap: None,
            meshopt_encodeVertexBufferBound: None,
            meshopt_encodeVertexBufferLevel: None,
            meshopt_encodeIndexBufferBound: None,
            meshopt_encodeIndexBuffer: None,
        }
    }

    fn reserved_is_zero(&self) -> bool {
        self.reserved == 0
    }
}

/// Options that have no effect on PLY files are refused, so that nobody waits for it.
fn check_ply(
    options: &pcmvs_export_options,
    is_compressed: bool,
    is_textured: bool,
) -> std::result::Result<(), &'static str> {
    let refused = [
        (is_compressed, "PLY files are not compressed: write a GLB, or set no function of meshoptimizer"),
        (is_textured, "PLY files have no texture: write a GLB, or make a form without one"),
        (
            options.upright == 1,
            "upright is for GLB files, and a PLY is in the scene's frame: write a GLB, or set upright to 0",
        ),
        (options.compact == 1, "compact is for GLB files: write a GLB, or set compact to 0"),
        (options.normals == 0, "normals is 0, but PLY files have normals: write a GLB, or set normals to 1"),
    ];
    refused.into_iter().find(|&(is_asked, _)| is_asked).map_or(Ok(()), |(_, problem)| Err(problem))
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
        if [options.normals, options.has_up, options.upright, options.compact].iter().any(|&switch| switch > 1) {
            return refused("normals, has_up, upright and compact must be 0 or 1".to_owned());
        }
        if options.upright > options.has_up {
            return refused("upright needs the upward direction: set has_up and up".to_owned());
        }
        if !(1..=100).contains(&options.jpeg_quality) {
            return refused(format!("jpeg_quality is {}: it is 1 to 100", options.jpeg_quality));
        }
        let meshopt = options.meshopt().map_err(|failure| failure.at(stage))?;
        let textured = (stage == Stage::Form).then(|| self.form()).transpose()?.filter(|form| form.texture.is_some());
        let origin = self.frame.rig().origin();
        let glb_options = glb::Options {
            normals: options.normals == 1,
            up: (options.has_up == 1).then_some(options.up),
            upright: options.upright == 1,
            compact: options.compact == 1,
            jpeg_quality: options.jpeg_quality as u8,
        };
        if let Err(problem) = glb_options.check_up() {
            return refused(problem.to_owned());
        }
        let file = match options.format {
            0 => {
                let options = glb_options;
                match (meshopt, textured) {
                    (Some(meshopt), _) => {
                        let form = textured.cloned().unwrap_or_else(|| Form { mesh: mesh.clone(), texture: None });
                        meshopt.compressed(form, origin, &options).map_err(|failure| failure.at(stage))?
                    }
                    (None, Some(form)) => glb::write_form(form, origin, &options, None),
                    (None, None) => glb::write(mesh, origin, &options),
                }
            }
            1 => match check_ply(&options, meshopt.is_some(), textured.is_some()) {
                Ok(()) => ply::write_mesh(mesh, origin),
                Err(problem) => return refused(problem.to_owned()),
            },
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
