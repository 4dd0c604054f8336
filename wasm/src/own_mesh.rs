//! Meshes of frames as plain objects, which may be posted to another worker and handed to another module.

use crate::error::Failed;
use glam::{DVec3, Vec3};
use js_sys::{Array, Float32Array, Reflect, Uint8Array, Uint32Array};
use pcmvs_core::Mesh;
use wasm_bindgen::prelude::*;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** The mesh of a frame, with all that averaging and forms need. It can be posted to another worker. */
export interface OwnMesh {
    /** x y z of each vertex, relative to the rig's origin. */
    positions: Float32Array;
    /** Unit normals, outward. */
    normals: Float32Array;
    /** sRGB of each vertex. */
    colours: Uint8Array;
    /** Three vertices per triangle, counter-clockwise seen from outside. */
    triangles: Uint32Array;
    /** World position of the rig's origin. */
    origin: number[];
    /** Size of a pixel at the object, in scene units. */
    footprint: number;
    /** The factors by which each camera's red, green and blue were multiplied, in the rig's order of cameras. */
    gains: Float32Array;
    /** The cameras whose silhouettes the other views have overruled. */
    overruled: Uint32Array;
}
"#;

#[wasm_bindgen]
extern "C" {
    /// `OwnMesh`.
    #[wasm_bindgen(typescript_type = "OwnMesh")]
    pub type OwnMesh;
}

fn wrong(name: &str) -> Failed {
    Failed::input(&format!("`{name}` of a mesh is not as `own()` and `finished()` make it"))
}

/// A property of a mesh, of the type that it must have.
fn property<T: JsCast>(mesh: &OwnMesh, name: &str) -> Result<T, Failed> {
    Reflect::get(mesh, &name.into())?.dyn_into().map_err(|_| wrong(name))
}

pub fn read(mesh: &OwnMesh) -> Result<Mesh, Failed> {
    let positions = vectors(mesh, "positions")?;
    let normals = vectors(mesh, "normals")?;
    let colours = property::<Uint8Array>(mesh, "colours")?.to_vec().as_chunks().0.to_vec();
    let triangles = property::<Uint32Array>(mesh, "triangles")?.to_vec().as_chunks().0.to_vec();
    let count = positions.len();
    for (name, is_right) in [
        ("positions", positions.iter().all(|p| p.is_finite())),
        ("normals", normals.len() == count && normals.iter().all(|n| n.is_finite())),
        ("colours", colours.len() == count),
        ("triangles", triangles.as_flattened().iter().all(|&v| (v as usize) < count)),
    ] {
        if !is_right {
            return Err(wrong(name));
        }
    }
    Ok(Mesh { positions, normals, colours, triangles })
}

fn vectors(mesh: &OwnMesh, name: &str) -> Result<Vec<Vec3>, Failed> {
    Ok(bytemuck::cast_slice(&triples(mesh, name)?).to_vec())
}

/// Numbers in rows of three. Those after the last whole row are left out.
fn triples(mesh: &OwnMesh, name: &str) -> Result<Vec<[f32; 3]>, Failed> {
    Ok(property::<Float32Array>(mesh, name)?.to_vec().as_chunks().0.to_vec())
}

pub fn origin_of(mesh: &OwnMesh) -> Result<DVec3, Failed> {
    let numbers: Vec<f64> = property::<Array>(mesh, "origin")?.iter().filter_map(|v| v.as_f64()).collect();
    let origin: [f64; 3] = numbers.try_into().map_err(|_| wrong("origin"))?;
    Ok(DVec3::from_array(origin))
}

pub fn footprint_of(mesh: &OwnMesh) -> Result<f32, Failed> {
    let footprint = Reflect::get(mesh, &"footprint".into())?.as_f64().map(|value| value as f32);
    footprint.filter(|value| value.is_finite() && *value > 0.0).ok_or_else(|| wrong("footprint"))
}

pub fn gains_of(mesh: &OwnMesh) -> Result<Vec<[f32; 3]>, Failed> {
    triples(mesh, "gains")
}

#[cfg(feature = "reconstruction")]
pub fn overruled_of(mesh: &OwnMesh) -> Result<Vec<u32>, Failed> {
    Ok(property::<Uint32Array>(mesh, "overruled")?.to_vec())
}
