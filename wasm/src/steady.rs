//! The mean of a frame and its neighbours in time, which may come from other workers.

use crate::{
    error::Failed,
    executor::executor,
    progress::Callback,
    reconstruction::{MeshArrays, Reconstruction},
    types::ProgressFunction,
};
use glam::{DVec3, Vec3};
use js_sys::{Array, Float32Array, Object, Reflect, Uint8Array, Uint32Array};
use pcmvs_core::{
    Counts, Mesh, Progress, Stage,
    frame::Intermediates,
    steady::{SteadyParams, steady},
};
use std::mem::replace;
use wasm_bindgen::prelude::*;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** The mesh of a frame alone, with all that averaging needs. It can be posted to another worker. */
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
}
"#;

#[wasm_bindgen]
extern "C" {
    /// `OwnMesh`.
    #[wasm_bindgen(typescript_type = "OwnMesh")]
    pub type OwnMesh;
}

#[wasm_bindgen]
impl Reconstruction {
    /// The mesh of the frame alone, as it was before `steady`.
    pub fn own(&self) -> Result<OwnMesh, Failed> {
        let MeshArrays { positions, normals, colours, triangles } = MeshArrays::of(self.own_mesh());
        let origin = self.origin.to_array().map(JsValue::from);
        let made = Object::new();
        for (name, value) in [
            ("positions", positions.into()),
            ("normals", normals.into()),
            ("colours", colours.into()),
            ("triangles", triangles.into()),
            ("origin", Array::from_iter(origin).into()),
            ("footprint", JsValue::from(self.result.footprint)),
        ] {
            Reflect::set(&made, &name.into(), &value)?;
        }
        Ok(made.unchecked_into())
    }

    /// The frame whose `own()` mesh this is, without its stages, warnings, figures of views and hashes. Throws `PcmvsError`.
    #[wasm_bindgen(js_name = ofMesh)]
    pub fn of_mesh(mesh: &OwnMesh) -> Result<Reconstruction, Failed> {
        let result = pcmvs_core::Reconstruction {
            mesh: read(mesh)?,
            footprint: footprint_of(mesh)?,
            gains: Vec::new(),
            counts: Counts::default(),
            hashes: Vec::new(),
            warnings: Vec::new(),
            diagnostics: Vec::new(),
            intermediates: Intermediates::default(),
        };
        Ok(Self::new(result, origin_of(mesh)?))
    }

    /// Averages the mesh with the `own()` meshes of neighbouring frames of the same rig, such as the one before and the one
    /// after it, along surfaces that move with the subject, so that surfaces and colours are steady in time. Files and
    /// `mesh("mesh")` then have the mean. A later call replaces it. The command line averages each frame with the one before
    /// and then the one after it, with presets `default` and `hull`. `progress` is that of `reconstruct`. Throws `PcmvsError`.
    pub fn steady(&mut self, neighbours: Vec<OwnMesh>, progress: Option<ProgressFunction>) -> Result<(), Failed> {
        for neighbour in &neighbours {
            if origin_of(neighbour)? != self.origin {
                return Err(Failed::input("a neighbour has other cameras: use frames of the same rig"));
            }
        }
        let meshes = neighbours.iter().map(read).collect::<Result<Vec<Mesh>, Failed>>()?;
        let meshes: Vec<&Mesh> = meshes.iter().collect();
        let mut mean = self.own_mesh().clone();
        let callback = Callback::new(progress);
        callback.on_stage_start(Stage::Steady);
        let done = steady(&mut mean, &meshes, self.result.footprint, &SteadyParams::DEFAULT, executor(), &callback);
        callback.on_stage_end(Stage::Steady);
        done.map_err(|error| callback.failed(&error))?;
        self.result.hashes.retain(|&(stage, _)| stage != Stage::Steady);
        self.result.hashes.push((Stage::Steady, mean.hash()));
        let replaced = replace(&mut self.result.mesh, mean);
        self.own.get_or_insert(replaced);
        Ok(())
    }
}

impl Reconstruction {
    fn own_mesh(&self) -> &Mesh {
        self.own.as_ref().unwrap_or(&self.result.mesh)
    }
}

fn wrong(name: &str) -> Failed {
    Failed::input(&format!("`{name}` of a mesh is not as `own()` makes it"))
}

/// A property of a mesh, of the type that it must have.
fn property<T: JsCast>(mesh: &OwnMesh, name: &str) -> Result<T, Failed> {
    Reflect::get(mesh, &name.into())?.dyn_into().map_err(|_| wrong(name))
}

fn read(mesh: &OwnMesh) -> Result<Mesh, Failed> {
    let floats = |name| Ok::<_, Failed>(property::<Float32Array>(mesh, name)?.to_vec());
    let positions = rows(&floats("positions")?).map(Vec3::from_array).collect::<Vec<_>>();
    let normals = rows(&floats("normals")?).map(Vec3::from_array).collect::<Vec<_>>();
    let colours: Vec<[u8; 3]> = rows(&property::<Uint8Array>(mesh, "colours")?.to_vec()).collect();
    let triangles: Vec<[u32; 3]> = rows(&property::<Uint32Array>(mesh, "triangles")?.to_vec()).collect();
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

fn rows<T: Copy>(values: &[T]) -> impl Iterator<Item = [T; 3]> + '_ {
    values.chunks_exact(3).map(|row| [row[0], row[1], row[2]])
}

fn origin_of(mesh: &OwnMesh) -> Result<DVec3, Failed> {
    let numbers: Vec<f64> = property::<Array>(mesh, "origin")?.iter().filter_map(|v| v.as_f64()).collect();
    let origin: [f64; 3] = numbers.try_into().map_err(|_| wrong("origin"))?;
    Ok(DVec3::from_array(origin))
}

fn footprint_of(mesh: &OwnMesh) -> Result<f32, Failed> {
    let footprint = Reflect::get(mesh, &"footprint".into())?.as_f64().map(|value| value as f32);
    footprint.filter(|value| value.is_finite() && *value > 0.0).ok_or_else(|| wrong("footprint"))
}
