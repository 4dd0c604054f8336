//! Meshes as arrays.

use js_sys::{Float32Array, Uint8Array, Uint32Array};
use pcmvs_core::Mesh;
use wasm_bindgen::prelude::*;

/// Vectors one after the other.
pub fn floats(vectors: &[glam::Vec3]) -> Float32Array {
    Float32Array::new_from_slice(bytemuck::cast_slice(vectors))
}

/// A mesh as arrays, relative to the rig's origin.
#[wasm_bindgen]
#[derive(Debug)]
pub struct MeshArrays {
    pub(crate) positions: Float32Array,
    pub(crate) normals: Float32Array,
    pub(crate) colours: Uint8Array,
    pub(crate) triangles: Uint32Array,
}

impl MeshArrays {
    pub(crate) fn of(mesh: &Mesh) -> Self {
        Self {
            positions: floats(&mesh.positions),
            normals: floats(&mesh.normals),
            colours: Uint8Array::new_from_slice(mesh.colours.as_flattened()),
            triangles: Uint32Array::new_from_slice(mesh.triangles.as_flattened()),
        }
    }
}

#[wasm_bindgen]
impl MeshArrays {
    /// x y z of each vertex.
    #[wasm_bindgen(getter)]
    pub fn positions(&self) -> Float32Array {
        self.positions.clone()
    }

    /// Unit normals, outward.
    #[wasm_bindgen(getter)]
    pub fn normals(&self) -> Float32Array {
        self.normals.clone()
    }

    /// sRGB of each vertex; empty without colours.
    #[wasm_bindgen(getter)]
    pub fn colours(&self) -> Uint8Array {
        self.colours.clone()
    }

    /// Three vertices per triangle, counter-clockwise seen from outside.
    #[wasm_bindgen(getter)]
    pub fn triangles(&self) -> Uint32Array {
        self.triangles.clone()
    }
}
