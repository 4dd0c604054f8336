//! Results: files' bytes and the stages' outputs. `steady` averages them with those of neighbouring frames.
//!
//! Arrays are copied once, out of the instance's memory into buffers of their own, so that a worker can transfer them.

use crate::{
    error::Failed,
    executor::executor,
    frame::Frame,
    mesh_arrays::{MeshArrays, floats},
    presets,
    progress::Callback,
    types::{PresetName, ProgressFunction},
    warning::Warning,
};
use glam::DVec3;
use js_sys::{Float32Array, Object, Reflect, Uint8Array, Uint16Array};
use pcmvs_core::{
    Error, Memory, Mesh, Params, PointCloud, Rig, ViewDiagnostics, ViewInput,
    export::{glb, ply},
    reconstruct,
};
use serde::Serialize;
use serde_wasm_bindgen::Serializer;
use wasm_bindgen::prelude::*;

/// A reconstructed frame. Call `free()` when it is no longer needed.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Reconstruction {
    /// Its mesh is the mean once it is averaged with its neighbours.
    pub(crate) result: pcmvs_core::Reconstruction,
    pub(crate) origin: DVec3,
    /// The mesh of the frame alone, unless that is the one of `result`.
    pub(crate) own: Option<Mesh>,
}

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** How well a camera's view agrees with the others. What could not be measured is null. */
export interface ViewReport {
    /** Whether the view takes part in the frame. */
    used: boolean;
    /** Intersection over union of the silhouette and the visual hull's picture, 0..1. */
    silhouetteOverlap: number | null;
    /** Median distance of the hull's outline from the silhouette's contour in pixels. */
    contourPx: number | null;
    /** Median distance in pixels of a few matches with other views from their epipolar lines: how far off the calibration is. */
    epipolarPx: number | null;
}
"#;

#[wasm_bindgen]
extern "C" {
    /// Name of a stage's mesh.
    #[wasm_bindgen(typescript_type = "\"hull\" | \"coarse\" | \"mesh\"")]
    pub type MeshStage;
    /// A direction.
    #[wasm_bindgen(typescript_type = "[number, number, number]")]
    pub type Up;
}

#[wasm_bindgen]
impl Frame {
    /// Reconstructs. `progress(stage, done, total)` is called on the way; when it returns false, an error of code
    /// `cancelled` is thrown. Throws `PcmvsError`.
    pub fn reconstruct(
        &self,
        preset: &PresetName,
        progress: Option<ProgressFunction>,
    ) -> Result<Reconstruction, Failed> {
        run(self.rig(), &self.inputs()?, &presets::params(preset)?, progress)
    }
}

#[wasm_bindgen]
impl Frame {
    /// Reconstructs with the pictures of the frames before and after, which are of the same rig: parts that a camera's silhouette
    /// lacks and those of both other frames have are added to it, if the picture shows them. Without such a part, nothing is
    /// reconstructed, and the result is undefined. `progress` is that of `reconstruct`. Throws `PcmvsError`.
    #[wasm_bindgen(js_name = reconstructBetween)]
    pub fn reconstruct_between(
        &self,
        before: &Frame,
        after: &Frame,
        preset: &PresetName,
        progress: Option<ProgressFunction>,
    ) -> Result<Option<Reconstruction>, Failed> {
        let [own, before, after] = self.inputs_between(before, after)?;
        let (callback, executor) = (Callback::new(progress), executor());
        let mut frame = pcmvs_core::Frame::new(&**self.rig(), presets::params(preset)?, Memory::default());
        frame.keep_views(false);
        let restored = frame.read_views_between(executor, &callback, |camera, give| {
            give(own[camera].as_ref(), [before[camera].as_ref(), after[camera].as_ref()])
        });
        if restored.map_err(|error: Error| callback.failed(&error))? == 0 {
            return Ok(None);
        }
        frame.run_stages(executor, &callback).map_err(|error| callback.failed(&error))?;
        Ok(Some(Reconstruction::new(frame.into_reconstruction(), self.rig().origin())))
    }
}

/// Reconstructs the cameras of a rig.
pub fn run(
    rig: &Rig,
    inputs: &[Option<ViewInput>],
    params: &Params,
    progress: Option<ProgressFunction>,
) -> Result<Reconstruction, Failed> {
    let callback = Callback::new(progress);
    let made = reconstruct(rig, inputs, params, executor(), &callback);
    made.map(|made| Reconstruction::new(made, rig.origin())).map_err(|error| callback.failed(&error))
}

impl Reconstruction {
    pub(crate) fn new(result: pcmvs_core::Reconstruction, origin: DVec3) -> Self {
        Self { result, origin, own: None }
    }

    /// The same without warnings and figures of views, which number the cameras of the reconstruction.
    pub(crate) fn without_findings(mut self) -> Self {
        self.result.warnings.clear();
        self.result.diagnostics.clear();
        self
    }

    fn stage(&self, stage: &MeshStage) -> Result<&Mesh, Failed> {
        match stage.as_string().as_deref() {
            Some("hull") => Ok(&self.result.intermediates.hull),
            Some("coarse") => Ok(&self.result.intermediates.coarse),
            Some("mesh") => Ok(&self.result.mesh),
            _ => Err(Failed::input("a mesh is one of hull, coarse, mesh")),
        }
    }
}

#[wasm_bindgen]
impl Reconstruction {
    /// The mesh as a GLB file. `up` is the scene's upward direction, recorded in the file. Throws `PcmvsError` if it is no
    /// direction.
    pub fn glb(&self, up: Option<Up>) -> Result<Uint8Array, Failed> {
        let up: Option<[f64; 3]> = up.map(|up| serde_wasm_bindgen::from_value(up.into())).transpose()?;
        let options = glb::Options { up, ..glb::Options::default() };
        options.check_up().map_err(Failed::input)?;
        Ok(Uint8Array::new_from_slice(&glb::write(&self.result.mesh, self.origin, &options)))
    }

    /// The mesh as a binary PLY file.
    pub fn ply(&self) -> Uint8Array {
        Uint8Array::new_from_slice(&ply::write_mesh(&self.result.mesh, self.origin))
    }

    /// The merged cloud (§5) as a binary PLY file.
    #[wasm_bindgen(js_name = cloudPly)]
    pub fn cloud_ply(&self) -> Uint8Array {
        Uint8Array::new_from_slice(&ply::write_cloud(&self.result.intermediates.merged, self.origin))
    }

    /// A stage's mesh. `hull` and `coarse` have no colours, and `coarse` is empty without a coarse pass.
    pub fn mesh(&self, stage: MeshStage) -> Result<MeshArrays, Failed> {
        Ok(MeshArrays::of(self.stage(&stage)?))
    }

    /// All views' cleaned clouds (§4).
    pub fn detected(&self) -> Cloud {
        Cloud::of(&self.result.intermediates.detected.concat())
    }

    /// Frontier points, then implicit points (§4.4).
    pub fn contours(&self) -> Cloud {
        let stages = &self.result.intermediates;
        Cloud::of(&[stages.frontier.as_slice(), stages.implicit.as_slice()].concat())
    }

    /// The merged cloud (§5).
    pub fn merged(&self) -> Cloud {
        Cloud::of(&self.result.intermediates.merged)
    }

    /// Vertices of the mesh.
    #[wasm_bindgen(getter)]
    pub fn vertices(&self) -> usize {
        self.result.mesh.positions.len()
    }

    /// Triangles of the mesh.
    #[wasm_bindgen(getter)]
    pub fn triangles(&self) -> usize {
        self.result.mesh.triangles.len()
    }

    /// What may make the result worse although nothing failed.
    #[wasm_bindgen(getter, unchecked_return_type = "Warning[]")]
    pub fn warnings(&self) -> Result<JsValue, Failed> {
        let warnings: Vec<Warning> = self.result.warnings.iter().map(Warning::from).collect();
        Ok(warnings.serialize(&Serializer::json_compatible())?)
    }

    /// How well each camera's view agrees with the others.
    #[wasm_bindgen(getter, unchecked_return_type = "ViewReport[]")]
    pub fn views(&self) -> Result<JsValue, Failed> {
        let views: Vec<ViewReport> = self.result.diagnostics.iter().map(ViewReport::from).collect();
        Ok(views.serialize(&Serializer::json_compatible())?)
    }

    /// A 64-bit hash of each stage's output, hexadecimal, by the stage's name.
    #[wasm_bindgen(
        unchecked_return_type = "Record<Exclude<Stage, \"steady\" | \"form\">, string> & { steady?: string }"
    )]
    pub fn hashes(&self) -> Result<Object, Failed> {
        let hashes = Object::new();
        for (stage, hash) in &self.result.hashes {
            Reflect::set(&hashes, &stage.name().into(), &format!("{hash:016x}").into())?;
        }
        Ok(hashes)
    }
}

/// `ViewReport`.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct ViewReport {
    used: bool,
    silhouette_overlap: Option<f32>,
    contour_px: Option<f32>,
    epipolar_px: Option<f32>,
}

impl From<&ViewDiagnostics> for ViewReport {
    fn from(found: &ViewDiagnostics) -> Self {
        let ViewDiagnostics { used, silhouette_overlap, contour_px, epipolar_px, .. } = *found;
        Self { used, silhouette_overlap, contour_px, epipolar_px }
    }
}

/// Oriented points as arrays, relative to the rig's origin.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Cloud {
    positions: Float32Array,
    normals: Float32Array,
    views: Uint16Array,
    ranks: Uint8Array,
}

impl Cloud {
    fn of(points: &PointCloud) -> Self {
        let vectors = |of: fn(&pcmvs_core::Point) -> glam::Vec3| floats(&points.iter().map(of).collect::<Vec<_>>());
        Self {
            positions: vectors(|p| p.position),
            normals: vectors(|p| p.normal),
            views: Uint16Array::new_from_slice(&points.iter().map(|p| p.view).collect::<Vec<_>>()),
            ranks: Uint8Array::new_from_slice(&points.iter().map(|p| p.rank as u8).collect::<Vec<_>>()),
        }
    }
}

#[wasm_bindgen]
impl Cloud {
    /// x y z of each point.
    #[wasm_bindgen(getter)]
    pub fn positions(&self) -> Float32Array {
        self.positions.clone()
    }

    /// Unit normals, outward.
    #[wasm_bindgen(getter)]
    pub fn normals(&self) -> Float32Array {
        self.normals.clone()
    }

    /// Camera that detected each point, or 65535 for none.
    #[wasm_bindgen(getter)]
    pub fn views(&self) -> Uint16Array {
        self.views.clone()
    }

    /// Kind of each point: 0 implicit, 1 substituted by the hull, 2 detected, 3 frontier.
    #[wasm_bindgen(getter)]
    pub fn ranks(&self) -> Uint8Array {
        self.ranks.clone()
    }
}
