//! Forms of finished meshes: fewer triangles, a texture, and compact files.

use crate::{
    compress::{Meshopt, MeshoptEncoder},
    error::Failed,
    frame::Frame,
    mesh_arrays::MeshArrays,
    own_mesh::{OwnMesh, footprint_of, gains_of, origin_of, read},
    presets,
    progress::Callback,
    types::{PresetName, ProgressFunction},
    warning::Warning,
};
use glam::{DQuat, DVec3};
use js_sys::{Float32Array, Reflect, Uint8Array};
use pcmvs_core::{
    Error, FormParams, Memory, Mesh, Params, Progress, Serial, TextureParams,
    export::{bounds, glb},
};
use serde::{Deserialize, Serialize};
use serde_wasm_bindgen::Serializer;
use wasm_bindgen::prelude::*;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** Which form of a mesh is made. */
export interface FormOptions {
    /** Largest number of triangles. More remain if fewer would change the surface visibly. */
    faces?: number;
    /** A texture instead of colours of vertices: true for a size that keeps the detail of the photographs, or the texels along
     * a side. */
    texture?: boolean | number;
}

/** How a form's file is written. */
export interface GlbOptions {
    /** The scene's upward direction. It is recorded in the file. */
    up?: [number, number, number] | null;
    /** Turns the mesh so that `up` is +y, as players expect. */
    upright?: boolean;
    /** Makes the file small. The encoder is that of the npm package `meshoptimizer`. */
    compress?: MeshoptEncoder;
}

/** Where a form's file has its mesh. */
export interface Placement {
    /** The upward direction in the file's frame. */
    up: [number, number, number] | null;
    /** Quaternion x, y, z, w that turns the scene's frame to that of the file; null if they are the same. */
    rotation: [number, number, number, number] | null;
    /** Smallest and largest coordinates in the file's frame; null without a mesh. */
    bounds: [[number, number, number], [number, number, number]] | null;
}
"#;

#[wasm_bindgen]
extern "C" {
    /// `FormOptions`.
    #[wasm_bindgen(typescript_type = "FormOptions")]
    pub type FormOptions;
    /// `GlbOptions`.
    #[wasm_bindgen(typescript_type = "GlbOptions")]
    pub type GlbOptions;
}

/// `FormOptions`.
#[derive(Deserialize)]
struct Asked {
    faces: Option<u32>,
    texture: Option<AskedTexture>,
}

/// Whether there is to be a texture, or how large it is.
#[derive(Deserialize)]
#[serde(untagged)]
enum AskedTexture {
    Wanted(bool),
    Size(u32),
}

/// `GlbOptions` without the encoder.
#[derive(Deserialize)]
struct Written {
    up: Option<[f64; 3]>,
    upright: Option<bool>,
}

/// `Placement`.
#[derive(Serialize)]
struct Placement {
    up: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    bounds: Option<[[f64; 3]; 2]>,
}

/// A form of a finished mesh. Call `free()` when it is no longer needed.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Form {
    form: pcmvs_core::Form,
    origin: DVec3,
    /// The number of triangles that was asked for.
    faces: Option<u32>,
}

#[wasm_bindgen]
impl Frame {
    /// Makes a form of a mesh that `pcmvs` has made from the same cameras and pictures: its `finished()`. `preset` is the one
    /// that it was made with. Pictures are needed for a texture only. `progress` is that of `reconstruct`. Throws `PcmvsError`.
    pub fn form(
        &self,
        preset: &PresetName,
        mesh: &OwnMesh,
        options: FormOptions,
        progress: Option<ProgressFunction>,
    ) -> Result<Form, Failed> {
        self.make_form(None, preset, mesh, options, progress)
    }

    /// `form` of a mesh that `reconstructBetween` has made, or that was averaged from it: a texture takes the colours of parts
    /// that came back from the same pictures. `before` and `after` are the frames beside it, with their pictures.
    #[wasm_bindgen(js_name = formBetween)]
    pub fn form_between(
        &self,
        before: &Frame,
        after: &Frame,
        preset: &PresetName,
        mesh: &OwnMesh,
        options: FormOptions,
        progress: Option<ProgressFunction>,
    ) -> Result<Form, Failed> {
        self.make_form(Some([before, after]), preset, mesh, options, progress)
    }
}

impl Frame {
    fn make_form(
        &self,
        beside: Option<[&Frame; 2]>,
        preset: &PresetName,
        mesh: &OwnMesh,
        options: FormOptions,
        progress: Option<ProgressFunction>,
    ) -> Result<Form, Failed> {
        let asked: Asked = serde_wasm_bindgen::from_value(options.into())?;
        let origin = origin_of(mesh)?;
        if origin != self.rig().origin() {
            return Err(Failed::input("the mesh is of other cameras: make the frame with the rig of the mesh"));
        }
        // Of a form without a texture the preset is only checked.
        let preset = presets::params(preset)?;
        let callback = Callback::new(progress);
        let texture = match asked.texture {
            None | Some(AskedTexture::Wanted(false)) => None,
            Some(AskedTexture::Wanted(true)) => Some(TextureParams { size: None }),
            Some(AskedTexture::Size(size)) => Some(TextureParams { size: Some(size) }),
        };
        let params = FormParams { faces: asked.faces, texture };
        let finished = read(mesh)?;
        let form = if params.texture.is_some() {
            self.textured(beside, &preset, &finished, &gains_of(mesh)?, &params, &callback)?
        } else {
            pcmvs_core::Form::untextured(&finished, params.faces, footprint_of(mesh)?, &callback)
        };
        Ok(Form { form: form.map_err(|error| callback.failed(&error))?, origin, faces: params.faces })
    }

    /// The outer error is about the pictures as JavaScript gave them.
    fn textured(
        &self,
        beside: Option<[&Frame; 2]>,
        preset: &Params,
        mesh: &Mesh,
        gains: &[[f32; 3]],
        params: &FormParams,
        progress: &dyn Progress,
    ) -> Result<Result<pcmvs_core::Form, Error>, Failed> {
        let mut frame = pcmvs_core::Frame::new(&**self.rig(), *preset, Memory::default());
        frame.keep_views(false);
        let read = match beside {
            None => {
                let own = self.inputs()?;
                frame.read_views(&Serial, progress, |camera, give| give(own[camera].as_ref()))
            }
            Some([before, after]) => {
                let [own, before, after] = self.inputs_between(before, after)?;
                let read = frame.read_views_between(&Serial, progress, |camera, give| {
                    give(own[camera].as_ref(), [before[camera].as_ref(), after[camera].as_ref()])
                });
                read.map(|_: u32| ())
            }
        };
        let carved = read.and_then(|()| frame.carve(&Serial, progress));
        Ok(carved.and_then(|()| frame.form_of(mesh, gains, params, &Serial, progress)))
    }
}

#[wasm_bindgen]
impl Form {
    /// The form as a GLB file. Throws `PcmvsError`, or what the encoder throws.
    pub fn glb(&self, options: Option<GlbOptions>) -> Result<Uint8Array, Failed> {
        let encoder = encoder(options.as_ref())?;
        let written = written(options, encoder.is_some())?;
        let Some(encoder) = encoder else {
            return Ok(Uint8Array::new_from_slice(&glb::write_form(&self.form, self.origin, &written, None)));
        };
        let meshopt = Meshopt::new(&encoder);
        let sorted = meshopt.sort(&self.form)?;
        let bytes = glb::write_form(&sorted, self.origin, &written, Some(&meshopt));
        Ok(Uint8Array::new_from_slice(&meshopt.checked(bytes)?))
    }

    /// Where a file of the same options has the mesh, as a clip's manifest states it.
    #[wasm_bindgen(unchecked_return_type = "Placement")]
    pub fn placement(&self, options: Option<GlbOptions>) -> Result<JsValue, Failed> {
        let options = written(options, false)?;
        let rotation = options.rotation();
        let bounds = bounds(&self.form.mesh, self.origin).map(|bounds| turned(bounds, rotation));
        let placement = Placement { up: options.up_in_file(), rotation, bounds };
        Ok(placement.serialize(&Serializer::json_compatible())?)
    }

    /// The mesh. Vertices at a border of the texture's charts are there once per chart.
    pub fn mesh(&self) -> MeshArrays {
        MeshArrays::of(&self.form.mesh)
    }

    /// Texture coordinates u v of each vertex; (0, 0) is the upper left corner. Undefined without a texture.
    pub fn uvs(&self) -> Option<Float32Array> {
        self.form.texture.as_ref().map(|texture| Float32Array::new_from_slice(texture.uvs.as_flattened()))
    }

    /// The texture's sRGB texels in reading order, three bytes each. Undefined without a texture.
    pub fn texels(&self) -> Option<Uint8Array> {
        self.form.texture.as_ref().map(|texture| Uint8Array::new_from_slice(&texture.texels))
    }

    /// Texels along a side of the texture, or 0 without one.
    #[wasm_bindgen(getter, js_name = textureSize)]
    pub fn texture_size(&self) -> u32 {
        self.form.texture.as_ref().map_or(0, |texture| texture.size)
    }

    /// Vertices of the mesh.
    #[wasm_bindgen(getter)]
    pub fn vertices(&self) -> usize {
        self.form.mesh.positions.len()
    }

    /// Triangles of the mesh.
    #[wasm_bindgen(getter)]
    pub fn triangles(&self) -> usize {
        self.form.mesh.triangles.len()
    }

    /// What is not as it was asked for.
    #[wasm_bindgen(getter, unchecked_return_type = "Warning[]")]
    pub fn warnings(&self) -> Result<JsValue, Failed> {
        let made = self.triangles();
        let too_many = self.faces.filter(|&asked| made > asked as usize).map(|asked| Warning {
            code: "too-many-faces",
            camera: None,
            message: format!(
                "{made} triangles remain instead of {asked}, because fewer would change the surface visibly: ask for more, or \
                 take this file as it is"
            ),
        });
        Ok(too_many.into_iter().collect::<Vec<_>>().serialize(&Serializer::json_compatible())?)
    }
}

fn encoder(options: Option<&GlbOptions>) -> Result<Option<MeshoptEncoder>, Failed> {
    let Some(options) = options else { return Ok(None) };
    let given = Reflect::get(options, &"compress".into())?;
    Ok((!given.is_undefined() && !given.is_null()).then(|| given.unchecked_into()))
}

/// The options of a file.
fn written(options: Option<GlbOptions>, compress: bool) -> Result<glb::Options, Failed> {
    let Written { up, upright } = match options {
        Some(options) => serde_wasm_bindgen::from_value(options.into())?,
        None => Written { up: None, upright: None },
    };
    let upright = upright.unwrap_or(false);
    if upright && up.is_none() {
        return Err(Failed::input("`up` is missing, which `upright` needs: give the scene's upward direction"));
    }
    // The material is unlit, so that only hosts that light the mesh themselves need normals.
    let options = glb::Options { normals: !compress, up, upright, compact: compress, ..glb::Options::default() };
    options.check_up().map_err(Failed::input)?;
    Ok(options)
}

/// Bounds of a box that is turned by a quaternion.
fn turned(bounds: [[f64; 3]; 2], rotation: Option<[f64; 4]>) -> [[f64; 3]; 2] {
    let Some(rotation) = rotation.map(DQuat::from_array) else { return bounds };
    let corner = |i: usize| rotation * DVec3::from_array([0, 1, 2].map(|axis| bounds[i >> axis & 1][axis]));
    let corners: [DVec3; 8] = std::array::from_fn(corner);
    let of = |pick: fn(DVec3, DVec3) -> DVec3| corners.into_iter().reduce(pick).unwrap_or(DVec3::ZERO).to_array();
    [of(DVec3::min), of(DVec3::max)]
}
