//! Forms of a finished mesh: with fewer triangles, with a texture, or both.

use crate::{
    failure::{Failure, Result},
    frame::{exclusive, pcmvs_frame, shared},
    sized::{Growing, Versioned, init, read, write},
    status::pcmvs_status::{self, InvalidArgument, WrongOrder},
    work::Work,
};
use pcmvs_core::{FormParams, Stage, TextureParams};
use std::mem::size_of;

/// Which form of the finished mesh to make.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_form_options {
    /// Set by `pcmvs_form_options_init`.
    pub struct_size: u32,
    /// Largest number of triangles. More remain if fewer would change the surface visibly. 0, the default, keeps them all.
    pub faces: u32,
    /// 1 to make a texture, which replaces the colours of vertices. The default is 0.
    pub texture: u32,
    /// Texels along a side of the texture, 64 to 16384. 0, the default, chooses the smallest power of two that keeps the detail
    /// of the photographs, at most 8192.
    pub texture_size: u32,
}

impl Growing for pcmvs_form_options {
    const FIRST_SIZE: usize = 16;
}

// SAFETY: numbers only, the size first, no padding.
unsafe impl Versioned for pcmvs_form_options {
    fn defaults() -> Self {
        Self { struct_size: size_of::<Self>() as u32, faces: 0, texture: 0, texture_size: 0 }
    }
}

/// The texture of a form, in the frame's memory. The picture stays valid until the next call on the frame that takes a
/// non-const `pcmvs_frame *`.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_texture {
    /// Width in texels.
    pub width: u32,
    /// Height in texels.
    pub height: u32,
    /// Red, green and blue of each texel in sRGB, in packed rows from the top down.
    pub texels: *const u8,
}

impl Growing for pcmvs_texture {
    const FIRST_SIZE: usize = 8 + size_of::<usize>();
}

/// Initialises form options with their defaults: the mesh as it is. `size` is `sizeof *options`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_form_options_init(options: *mut pcmvs_form_options, size: usize) -> pcmvs_status {
    // SAFETY: the caller's promise.
    unsafe { init(options, size, "options") }
}

fn params(options: &pcmvs_form_options) -> Result<FormParams> {
    let refused = |problem: &str| Err(Failure::new(InvalidArgument, problem));
    match options {
        pcmvs_form_options { texture: 2.., .. } => refused("texture must be 0 or 1"),
        pcmvs_form_options { texture: 0, texture_size: 1.., .. } => refused("texture_size is set, but texture is 0"),
        _ => {
            let given = |number: u32| Some(number).filter(|&number| number > 0);
            let texture = TextureParams { size: given(options.texture_size) };
            Ok(FormParams { faces: given(options.faces), texture: (options.texture == 1).then_some(texture) })
        }
    }
}

/// Makes a form of the finished mesh, in the place of the last one. Read it as `PCMVS_MESH_KIND_FORM`, its texture with
/// `pcmvs_frame_get_texture`, and write it with `pcmvs_frame_export_mesh`. Any number of forms can be made one after the other;
/// the finished mesh stays as it is. Fails with `PCMVS_STATUS_WRONG_ORDER` until the frame is complete. On failure there is no
/// form. The next frame, and running a stage again, discard it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_form(frame: *mut pcmvs_frame, options: *const pcmvs_form_options) -> pcmvs_status {
    exclusive(frame, |_, work| {
        // SAFETY: the caller's promise.
        let options = unsafe { read(options, "options") };
        work.make_form(options.and_then(|options| params(&options)))
    })
}

/// Returns the texture of the form that was made last, without copying it. Fails with `PCMVS_STATUS_WRONG_ORDER` if there is
/// none. `size` is `sizeof *texture`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_get_texture(
    frame: *const pcmvs_frame,
    texture: *mut pcmvs_texture,
    size: usize,
) -> pcmvs_status {
    let get = |work: &Work| {
        let none = || Failure::new(WrongOrder, "the form has no texture: set `texture` in its options");
        let found = work.form()?.texture.as_ref().ok_or_else(none).map_err(|failure| failure.at(Stage::Form))?;
        let view = pcmvs_texture { width: found.size, height: found.size, texels: found.texels.as_ptr() };
        // SAFETY: the caller's promise.
        unsafe { write(texture, size, &view, "texture") }.map_err(|failure| failure.at(Stage::Form))
    };
    shared(frame, get)
}
