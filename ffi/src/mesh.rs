//! A frame's meshes.

use crate::{
    boundary::{Growing, Result, out, write},
    error::Failure,
    frame::{Work, pcmvs_frame, shared},
    status::pcmvs_status::{self, BufferTooSmall, InvalidArgument, WrongOrder},
};
use pcmvs_core::{Mesh, Stage};
use std::{
    ffi::c_void,
    mem::size_of,
    ptr::{copy_nonoverlapping, null},
};

/// Which of a frame's meshes. Numbers never change.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum pcmvs_mesh_kind {
    /// The result: closed, manifold, with colours once `pcmvs_frame_colour` has run.
    Final = 0,
    /// The visual hull, after `pcmvs_frame_hull`.
    Hull = 1,
    /// The coarse pass' mesh, after `pcmvs_frame_coarse`; empty where the preset has none.
    Coarse = 2,
}

/// What of a mesh is copied. Numbers never change.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum pcmvs_attribute {
    /// Per vertex: x, y, z in the scene's frame, three floats.
    Position = 0,
    /// Per vertex: unit normal, outward, three floats.
    Normal = 1,
    /// Per vertex: red, green, blue in sRGB, three bytes.
    Colour = 2,
    /// Per triangle: its corners' vertices, counter-clockwise seen from outside, three `uint32_t`.
    Triangle = 3,
}

/// A mesh in the frame's memory: packed arrays, valid until the next call on the frame that is not const.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_mesh {
    /// Number of vertices.
    pub vertex_count: u32,
    /// Number of triangles.
    pub triangle_count: u32,
    /// x, y, z of each vertex; add `origin` for the scene's frame.
    pub positions: *const f32,
    /// Unit normal of each vertex, outward.
    pub normals: *const f32,
    /// Red, green, blue of each vertex in sRGB; NULL without colours.
    pub colours: *const u8,
    /// Three vertices a triangle, counter-clockwise seen from outside.
    pub triangles: *const u32,
    /// World position of the positions' origin.
    pub origin: [f64; 3],
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
            _ => return Err(Failure::new(InvalidArgument, format!("mesh {kind} is not known"))),
        };
        self.require(stage).map(|()| (mesh, stage))
    }
}

/// Looks at a mesh (`kind` is a `pcmvs_mesh_kind`) where it lies. `size` is `sizeof *mesh`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_get_mesh(
    frame: *const pcmvs_frame,
    kind: u32,
    mesh: *mut pcmvs_mesh,
    size: usize,
) -> pcmvs_status {
    let look = |work: &Work| {
        let (found, stage) = work.mesh_of_kind(kind)?;
        let view = pcmvs_mesh {
            vertex_count: found.positions.len() as u32,
            triangle_count: found.triangles.len() as u32,
            positions: found.positions.as_ptr().cast(),
            normals: found.normals.as_ptr().cast(),
            colours: if found.colours.is_empty() { null() } else { found.colours.as_ptr().cast() },
            triangles: found.triangles.as_ptr().cast(),
            origin: work.frame.rig().origin().to_array(),
        };
        // SAFETY: the caller's promise.
        unsafe { write(mesh, size, &view, "mesh") }.map_err(|f| f.at(stage))
    };
    // SAFETY: the caller's promise.
    unsafe { shared(frame, look) }
}

/// Copies one attribute of a mesh, a `pcmvs_attribute`, to the caller's memory. `buffer` has room for `capacity`
/// elements that lie `stride` bytes apart (0: no padding); what lies between them is left alone. `count`, if not NULL,
/// gets the number of elements. With a NULL `buffer` and a `capacity` of 0 only the number is told.
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
                    // As files hold them.
                    let scene = |p: &glam::Vec3| (origin + p.as_dvec3()).to_array().map(|v| v as f32 + 0.0);
                    target.fill(mesh.positions.iter().map(scene))
                }
                1 => target.fill(mesh.normals.iter().map(|n| n.to_array())),
                2 if mesh.colours.len() != mesh.positions.len() => {
                    return Err(Failure::new(WrongOrder, "this mesh has no colours").at(Stage::Colour));
                }
                2 => target.fill(mesh.colours.iter().copied()),
                3 => target.fill(mesh.triangles.iter().copied()),
                _ => Err(Failure::new(InvalidArgument, format!("attribute {attribute} is not known"))),
            }
        };
        copied.map_err(|f| f.at(stage))
    };
    // SAFETY: the caller's promise.
    unsafe { shared(frame, copy) }
}

/// The caller's memory for elements.
pub(crate) struct Target {
    pub buffer: *mut u8,
    pub capacity: usize,
    pub stride: usize,
    pub count: *mut usize,
}

impl Target {
    /// # Safety
    /// The buffer has room for `capacity` elements, `count` is NULL or writable.
    pub unsafe fn fill<T: Copy>(&self, elements: impl ExactSizeIterator<Item = T>) -> Result<()> {
        let length = elements.len();
        let stride = if self.stride == 0 { size_of::<T>() } else { self.stride };
        if self.buffer.is_null() && (self.capacity > 0 || self.count.is_null()) {
            out(self.buffer, "buffer")?;
        }
        if stride < size_of::<T>() {
            let problem = format!("a stride of {stride} bytes is less than an element of {}", size_of::<T>());
            return Err(Failure::new(InvalidArgument, problem));
        }
        if !self.buffer.is_null() {
            if self.capacity < length {
                let problem = format!(
                    "there is room for {} elements, but there are {length}: ask for their number with a NULL buffer",
                    self.capacity
                );
                return Err(Failure::new(BufferTooSmall, problem));
            }
            for (i, element) in elements.enumerate() {
                // SAFETY: `i` is below the capacity. Elements may lie at any address.
                unsafe {
                    copy_nonoverlapping((&raw const element).cast(), self.buffer.add(i * stride), size_of::<T>())
                };
            }
        }
        if !self.count.is_null() {
            // SAFETY: the caller's promise.
            unsafe { self.count.write(length) };
        }
        Ok(())
    }
}
