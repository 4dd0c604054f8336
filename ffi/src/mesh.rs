//! A frame's meshes.

use crate::{
    failure::{Failure, Result},
    frame::{pcmvs_frame, shared},
    sized::{Growing, write},
    status::pcmvs_status::{self, InvalidArgument, WrongOrder},
    target::Target,
    work::Work,
};
use pcmvs_core::{Mesh, Stage};
use std::{ffi::c_void, mem::size_of, ptr::null};

/// The meshes of a frame. Numbers never change.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum pcmvs_mesh_kind {
    /// The result: closed and manifold, from `pcmvs_frame_mesh`. It has colours after `pcmvs_frame_colour`.
    Final = 0,
    /// The visual hull, from `pcmvs_frame_hull`.
    Hull = 1,
    /// The mesh of the coarse pass, from `pcmvs_frame_coarse`. Empty if the preset has no coarse pass.
    Coarse = 2,
    /// The form of the result that `pcmvs_frame_form` made last. With a texture, a vertex at a border of charts is there once
    /// per chart, at the same position.
    Form = 3,
}

/// Attributes of a mesh that can be copied. Numbers never change. Later versions may add attributes; a library that does not
/// know an attribute fails with `PCMVS_STATUS_INVALID_ARGUMENT`.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum pcmvs_attribute {
    /// Per vertex: x, y, z in the scene's frame. Three floats.
    Position = 0,
    /// Per vertex: unit normal, pointing outwards. Three floats.
    Normal = 1,
    /// Per vertex: red, green, blue in sRGB. Three bytes.
    Colour = 2,
    /// Per triangle: its three vertices, counter-clockwise seen from outside. Three `uint32_t`.
    Triangle = 3,
    /// Per vertex of a form with a texture: texture coordinates. (0, 0) is the upper left corner of the picture and (1, 1) the
    /// lower right one. Two floats.
    TextureCoordinates = 4,
}

/// A mesh in the frame's memory. The arrays are packed and stay valid until the next call on the frame that takes a
/// non-const `pcmvs_frame *`. Later versions may add members at the end.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_mesh {
    /// Number of vertices.
    pub vertex_count: u32,
    /// Number of triangles.
    pub triangle_count: u32,
    /// x, y, z per vertex, relative to `origin`.
    pub positions: *const f32,
    /// Unit normal per vertex, pointing outwards.
    pub normals: *const f32,
    /// Red, green, blue per vertex in sRGB. NULL if the mesh has no colours.
    pub colours: *const u8,
    /// Three vertices per triangle, counter-clockwise seen from outside.
    pub triangles: *const u32,
    /// The origin of `positions` in the scene's frame.
    pub origin: [f64; 3],
    /// Texture coordinates per vertex, two floats each. NULL if the mesh has none. See `pcmvs_frame_get_texture`.
    pub texture_coordinates: *const f32,
}

impl Growing for pcmvs_mesh {
    const FIRST_SIZE: usize = 8 + 4 * size_of::<usize>() + 24;
}

impl Work {
    /// A mesh by its number, and the stage that makes it.
    pub(crate) fn mesh_of_kind(&self, kind: u32) -> Result<(&Mesh, Stage)> {
        let (stage, mesh) = match kind {
            0 => (Stage::Mesh, self.frame.mesh()),
            1 => (Stage::Hull, &self.frame.intermediates().hull),
            2 => (Stage::Coarse, &self.frame.intermediates().coarse),
            3 => return Ok((&self.form()?.mesh, Stage::Form)),
            _ => return Err(Failure::new(InvalidArgument, format!("mesh {kind} is not known"))),
        };
        self.require(stage).map(|()| (mesh, stage))
    }

    /// Texture coordinates of a mesh by its number.
    fn texture_coordinates(&self, kind: u32) -> Option<&[[f32; 2]]> {
        // Describing a missing form would allocate, which reading other meshes must not.
        let form = if kind == pcmvs_mesh_kind::Form as u32 { self.form().ok()? } else { return None };
        form.texture.as_ref().map(|texture| texture.uvs.as_slice())
    }
}

/// Returns pointers to a mesh in the frame's memory, without copying it. `kind` is a `pcmvs_mesh_kind`. `size` is
/// `sizeof *mesh`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_get_mesh(
    frame: *const pcmvs_frame,
    kind: u32,
    mesh: *mut pcmvs_mesh,
    size: usize,
) -> pcmvs_status {
    let get = |work: &Work| {
        let (found, stage) = work.mesh_of_kind(kind)?;
        let view = pcmvs_mesh {
            vertex_count: found.positions.len() as u32,
            triangle_count: found.triangles.len() as u32,
            positions: found.positions.as_ptr().cast(),
            normals: found.normals.as_ptr().cast(),
            colours: if found.colours.is_empty() { null() } else { found.colours.as_ptr().cast() },
            triangles: found.triangles.as_ptr().cast(),
            origin: work.frame.rig().origin().to_array(),
            texture_coordinates: work.texture_coordinates(kind).map_or(null(), |uvs| uvs.as_ptr().cast()),
        };
        // SAFETY: the caller's promise.
        unsafe { write(mesh, size, &view, "mesh") }.map_err(|f| f.at(stage))
    };
    shared(frame, get)
}

/// Copies one attribute of a mesh to the caller's memory. `kind` is a `pcmvs_mesh_kind`, `attribute` a `pcmvs_attribute`.
/// `buffer` has room for `capacity` elements, which start `stride` bytes apart; a `stride` of 0 means that they are packed.
/// The bytes between elements are not written. `count` receives the number of elements and may be NULL. With a NULL
/// `buffer` and a `capacity` of 0 the function only writes `count`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_copy_mesh(
    frame: *const pcmvs_frame,
    kind: u32,
    attribute: u32,
    buffer: *mut c_void,
    capacity: usize,
    stride: usize,
    count: *mut usize,
) -> pcmvs_status {
    let copy = |work: &Work| {
        let (mesh, stage) = work.mesh_of_kind(kind)?;
        let target = Target { buffer: buffer.cast(), capacity, stride, count };
        // SAFETY: the caller's promise.
        let copied = unsafe {
            match attribute {
                0 => {
                    let origin = work.frame.rig().origin();
                    // Rounded as in files.
                    let scene = |p: &glam::Vec3| (origin + p.as_dvec3()).to_array().map(|v| v as f32 + 0.0);
                    target.fill(mesh.positions.iter().map(scene))
                }
                1 => target.fill(mesh.normals.iter().map(|n| n.to_array())),
                2 if mesh.colours.len() != mesh.positions.len() => {
                    return Err(Failure::new(WrongOrder, "this mesh has no colours").at(Stage::Colour));
                }
                2 => target.fill(mesh.colours.iter().copied()),
                3 => target.fill(mesh.triangles.iter().copied()),
                4 => match work.texture_coordinates(kind) {
                    Some(uvs) => target.fill(uvs.iter().copied()),
                    None => {
                        let problem = "this mesh has no texture: make a form with one by pcmvs_frame_form";
                        return Err(Failure::new(WrongOrder, problem).at(Stage::Form));
                    }
                },
                _ => Err(Failure::new(InvalidArgument, format!("attribute {attribute} is not known"))),
            }
        };
        copied.map_err(|f| f.at(stage))
    };
    shared(frame, copy)
}
