//! The mean of a frame and its neighbours in time, which may come from other workers.

use crate::{
    error::Failed,
    executor::executor,
    mesh_arrays::MeshArrays,
    own_mesh::{OwnMesh, footprint_of, gains_of, origin_of, overruled_of, read},
    progress::Callback,
    reconstruction::Reconstruction,
    types::ProgressFunction,
};
use js_sys::{Array, Float32Array, Object, Reflect, Uint32Array};
use pcmvs_core::{
    Counts, Mesh, Progress, Stage,
    frame::Intermediates,
    lost_part::{Beside, may_have_lost_part},
    steady::{SteadyParams, steady},
};
use std::mem::replace;
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
impl Reconstruction {
    /// The mesh of the frame alone, as it was before `steady`.
    pub fn own(&self) -> Result<OwnMesh, Failed> {
        self.object(self.own_mesh())
    }

    /// The finished mesh: the mean after `steady`, otherwise that of the frame alone. `pcmvs/forms` makes forms of it.
    pub fn finished(&self) -> Result<OwnMesh, Failed> {
        self.object(&self.result.mesh)
    }

    /// The frame whose `own()` or `finished()` mesh this is, without its stages, warnings, figures of views and hashes. Throws `PcmvsError`.
    #[wasm_bindgen(js_name = ofMesh)]
    pub fn of_mesh(mesh: &OwnMesh) -> Result<Reconstruction, Failed> {
        let result = pcmvs_core::Reconstruction {
            mesh: read(mesh)?,
            footprint: footprint_of(mesh)?,
            gains: gains_of(mesh)?,
            counts: Counts::default(),
            hashes: Vec::new(),
            warnings: Vec::new(),
            diagnostics: Vec::new(),
            overruled: overruled_of(mesh)?,
            intermediates: Intermediates::default(),
        };
        Ok(Self::new(result, origin_of(mesh)?))
    }

    /// Whether the frame may have lost a part, such as an arm, that the frames before and after it have, because many or all of
    /// its masks lack it. `before` and `after` are their `own()` meshes. If so, make it again by `reconstructBetween` of its
    /// `Frame`. No pictures are read, and the answer is nearly always false. Throws `PcmvsError`.
    #[wasm_bindgen(js_name = mayHaveLostPart)]
    pub fn may_have_lost_part(&self, before: &OwnMesh, after: &OwnMesh) -> Result<bool, Failed> {
        self.check_neighbours(&[before, after])?;
        let (meshes, overruled) = ([read(before)?, read(after)?], [overruled_of(before)?, overruled_of(after)?]);
        let own = Beside { mesh: self.own_mesh(), overruled: &self.result.overruled };
        let beside = [0, 1].map(|i| Beside { mesh: &meshes[i], overruled: &overruled[i] });
        Ok(may_have_lost_part(own, beside, executor()))
    }

    /// Averages the mesh with the `own()` meshes of neighbouring frames of the same rig, such as the one before and the one
    /// after it, along surfaces that move with the subject, so that surfaces and colours are steady in time. Files and
    /// `mesh("mesh")` then have the mean. A later call replaces it. The command line averages each frame with the one before
    /// and then the one after it, with presets `default` and `hull`. `progress` is that of `reconstruct`. Throws `PcmvsError`.
    pub fn steady(&mut self, neighbours: Vec<OwnMesh>, progress: Option<ProgressFunction>) -> Result<(), Failed> {
        self.check_neighbours(&neighbours.iter().collect::<Vec<_>>())?;
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
    fn check_neighbours(&self, neighbours: &[&OwnMesh]) -> Result<(), Failed> {
        for neighbour in neighbours {
            if origin_of(neighbour)? != self.origin {
                return Err(Failed::input("a neighbour has other cameras: use frames of the same rig"));
            }
        }
        Ok(())
    }

    fn own_mesh(&self) -> &Mesh {
        self.own.as_ref().unwrap_or(&self.result.mesh)
    }

    fn object(&self, mesh: &Mesh) -> Result<OwnMesh, Failed> {
        let MeshArrays { positions, normals, colours, triangles } = MeshArrays::of(mesh);
        let origin = self.origin.to_array().map(JsValue::from);
        let made = Object::new();
        for (name, value) in [
            ("positions", positions.into()),
            ("normals", normals.into()),
            ("colours", colours.into()),
            ("triangles", triangles.into()),
            ("origin", Array::from_iter(origin).into()),
            ("footprint", JsValue::from(self.result.footprint)),
            ("gains", Float32Array::new_from_slice(self.result.gains.as_flattened()).into()),
            ("overruled", Uint32Array::new_from_slice(&self.result.overruled).into()),
        ] {
            Reflect::set(&made, &name.into(), &value)?;
        }
        Ok(made.unchecked_into())
    }
}
