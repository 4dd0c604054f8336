//! One instant's pictures and silhouettes.

use crate::{
    error::Failed,
    progress::Callback,
    reconstruction::Reconstruction,
    rig::Rig,
    types::{ChromaKeyObject, PresetName, ProgressFunction},
};
use js_sys::{Function, Uint8Array, Uint8ClampedArray};
use pcmvs_core::{
    Camera, ChromaKey, Error, ImageRef, Mask, Params, PixelFormat, Preset, Progress, Serial, View, ViewInput,
    colour::ColourParams,
    hull::HullParams,
    reconstruct,
    silhouette::{ContourParams, Silhouette},
};
use pcmvs_scene::Picture;
use serde::Deserialize;
use std::rc::Rc;
use wasm_bindgen::prelude::*;

/// A key as JavaScript writes it: what is left out is the default.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Key {
    rgb: [u8; 3],
    tolerance: Option<f32>,
    darkest_shadow: Option<f32>,
    smallest_part: Option<f32>,
    smallest_hole: Option<f32>,
}

impl From<Key> for ChromaKey {
    fn from(key: Key) -> Self {
        let usual = Self::default();
        Self {
            rgb: key.rgb,
            tolerance: key.tolerance.unwrap_or(usual.tolerance),
            darkest_shadow: key.darkest_shadow.unwrap_or(usual.darkest_shadow),
            smallest_part: key.smallest_part.unwrap_or(usual.smallest_part),
            smallest_hole: key.smallest_hole.unwrap_or(usual.smallest_hole),
        }
    }
}

#[derive(Debug, Clone, Default)]
enum Matte {
    #[default]
    Unknown,
    Picture(Picture),
    Key(ChromaKey),
}

#[derive(Debug, Clone, Default)]
struct Slot {
    image: Option<Picture>,
    matte: Matte,
}

/// A frame of a rig: a picture and a silhouette for every camera, then as many reconstructions as wanted.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Frame {
    rig: Rc<pcmvs_core::Rig>,
    slots: Vec<Slot>,
}

#[wasm_bindgen]
impl Frame {
    /// A frame without pictures.
    #[wasm_bindgen(constructor)]
    pub fn new(rig: &Rig) -> Frame {
        Self { rig: Rc::clone(&rig.rig), slots: vec![Slot::default(); rig.rig.cameras().len()] }
    }

    /// Decodes a camera's photograph, JPEG or PNG. Throws `PcmvsError`.
    #[wasm_bindgen(js_name = setImage)]
    pub fn set_image(&mut self, camera: usize, file: &[u8]) -> Result<(), Failed> {
        let picture = decode("image", camera, file)?;
        self.slot(camera)?.image = Some(picture);
        Ok(())
    }

    /// Takes a camera's photograph as RGBA pixels, row after row (a canvas' image data); alpha is ignored.
    #[wasm_bindgen(js_name = setPixels)]
    pub fn set_pixels(&mut self, camera: usize, rgba: Vec<u8>, width: u32, height: u32) -> Result<(), Failed> {
        self.slot(camera)?.image = Some(Picture::new(rgba, width, height, PixelFormat::Rgba8));
        Ok(())
    }

    /// Decodes a camera's mask, JPEG or PNG: white is the object. Throws `PcmvsError`.
    #[wasm_bindgen(js_name = setMask)]
    pub fn set_mask(&mut self, camera: usize, file: &[u8]) -> Result<(), Failed> {
        let picture = decode("silhouette", camera, file)?;
        self.slot(camera)?.matte = Matte::Picture(picture);
        Ok(())
    }

    /// Takes a camera's mask as one byte a pixel, row after row: 255 is the object.
    #[wasm_bindgen(js_name = setMaskPixels)]
    pub fn set_mask_pixels(&mut self, camera: usize, gray: Vec<u8>, width: u32, height: u32) -> Result<(), Failed> {
        self.slot(camera)?.matte = Matte::Picture(Picture::new(gray, width, height, PixelFormat::Gray8));
        Ok(())
    }

    /// A camera's silhouette comes from a backdrop of one colour.
    #[wasm_bindgen(js_name = setChromaKey)]
    pub fn set_chroma_key(&mut self, camera: usize, key: ChromaKeyObject) -> Result<(), Failed> {
        let key: Key = serde_wasm_bindgen::from_value(key.into())?;
        self.slot(camera)?.matte = Matte::Key(key.into());
        Ok(())
    }

    /// Nothing is known of a camera's silhouette: the camera carves nothing.
    #[wasm_bindgen(js_name = clearMask)]
    pub fn clear_mask(&mut self, camera: usize) -> Result<(), Failed> {
        self.slot(camera)?.matte = Matte::Unknown;
        Ok(())
    }

    /// A camera's picture and silhouette without lens distortion, as the stages see them. Throws `PcmvsError`.
    pub fn photograph(&self, camera: usize) -> Result<Photograph, Failed> {
        let input = self.input(camera)?;
        let view = View::new(&self.rig, camera, &input, Some(&ContourParams::default()))
            .map_err(|error| Failed::core(&error, None))?;
        Ok(Photograph { view })
    }

    /// Reconstructs. `progress(stage, done, total)` is called on the way; when it returns false, an error of code
    /// `cancelled` is thrown. Throws `PcmvsError`.
    pub fn reconstruct(
        &self,
        preset: PresetName,
        progress: Option<ProgressFunction>,
    ) -> Result<Reconstruction, Failed> {
        let preset = match preset.as_string().as_deref() {
            Some("default") => Preset::Default,
            Some("paper") => Preset::Paper,
            Some("hull") => Preset::Hull,
            Some("preview") => Preset::Preview,
            _ => return Err(Failed::new("input", "a preset is one of default, paper, hull, preview", None, None)),
        };
        let all: Vec<usize> = (0..self.slots.len()).collect();
        self.run(&self.rig, &all, &Params::preset(preset), progress)
    }

    /// A coarse visual hull from the cameras that have their pictures so far: something to look at early. Its `stages`
    /// are empty but for the hull. Throws `PcmvsError`.
    pub fn sketch(&self) -> Result<Reconstruction, Failed> {
        let mut params = Params::preset(Preset::Hull);
        params.hull = HullParams { voxel_pixels: 4.0 };
        params.colour = ColourParams { gains: None, blended_views: 1 };
        let there: Vec<usize> = (0..self.slots.len()).filter(|&i| self.slots[i].image.is_some()).collect();
        let cameras: Vec<Camera> = there.iter().map(|&i| self.rig.cameras()[i]).collect();
        let rig = pcmvs_core::Rig::new(&cameras).map_err(|error| Failed::core(&error, None))?;
        self.run(&rig, &there, &params, None)
    }
}

impl Frame {
    /// With the chosen cameras, which `rig` has.
    fn run(
        &self,
        rig: &pcmvs_core::Rig,
        chosen: &[usize],
        params: &Params,
        progress: Option<ProgressFunction>,
    ) -> Result<Reconstruction, Failed> {
        let inputs: Vec<ViewInput> = chosen.iter().map(|&i| self.input(i)).collect::<Result<_, _>>()?;
        let callback = Callback::new(progress.map(|f| f.unchecked_into::<Function>()));
        let sink: &dyn Progress = &callback;
        match reconstruct(rig, &inputs, params, &Serial, sink) {
            Ok(result) => Ok(Reconstruction::new(result, rig.origin())),
            Err(mut error) => Err(match callback.thrown() {
                Some(thrown) => thrown.into(),
                None => {
                    if let Error::Camera { camera, .. }
                    | Error::Image { camera, .. }
                    | Error::Silhouette { camera, .. } = &mut error
                    {
                        *camera = chosen[*camera as usize] as u32;
                    }
                    Failed::core(&error, callback.stage())
                }
            }),
        }
    }

    fn slot(&mut self, camera: usize) -> Result<&mut Slot, Failed> {
        let count = self.slots.len();
        let missing = || Failed::new("input", &format!("there are cameras 0 to {}", count - 1), None, None);
        self.slots.get_mut(camera).ok_or_else(missing)
    }

    fn input(&self, camera: usize) -> Result<ViewInput<'_>, Failed> {
        let slot = self.slots.get(camera);
        let image = slot.and_then(|slot| slot.image.as_ref());
        let missing = || Failed::new("image", "this camera has no picture yet", Some(camera as u32), None);
        let (slot, image) = slot.zip(image).ok_or_else(missing)?;
        let mask = match &slot.matte {
            Matte::Unknown => Mask::Unknown,
            Matte::Picture(picture) => Mask::Given(picture.view()),
            Matte::Key(key) => Mask::ChromaKey(*key),
        };
        let image: ImageRef = image.view();
        Ok(ViewInput { image, mask })
    }
}

fn decode(code: &str, camera: usize, file: &[u8]) -> Result<Picture, Failed> {
    Picture::decode(file).map_err(|problem| Failed::new(code, &problem, Some(camera as u32), None))
}

/// A camera's picture and silhouette without lens distortion.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Photograph {
    view: View,
}

#[wasm_bindgen]
impl Photograph {
    /// Pixels in a row.
    #[wasm_bindgen(getter)]
    pub fn width(&self) -> u32 {
        self.view.camera.width
    }

    /// Rows.
    #[wasm_bindgen(getter)]
    pub fn height(&self) -> u32 {
        self.view.camera.height
    }

    /// Opaque RGBA, row after row: fit for `ImageData`.
    pub fn pixels(&self) -> Uint8ClampedArray {
        let rgba: Vec<u8> = self.view.rgb.chunks_exact(3).flat_map(|p| [p[0], p[1], p[2], 255]).collect();
        Uint8ClampedArray::new_from_slice(&rgba)
    }

    /// One byte a pixel: 255 inside the silhouette, 0 outside, between them on the contour; where nothing is known
    /// 255. Undefined without a silhouette.
    pub fn silhouette(&self) -> Option<Uint8Array> {
        let silhouette = self.view.silhouette.as_ref()?;
        let inside = |&d: &i16| match d {
            Silhouette::UNKNOWN => 255,
            d => ((f32::from(d) / Silhouette::UNITS + 0.5).clamp(0.0, 1.0) * 255.0) as u8,
        };
        let bytes: Vec<u8> = silhouette.distances().iter().map(inside).collect();
        Some(Uint8Array::new_from_slice(&bytes))
    }
}
