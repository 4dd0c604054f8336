//! The cameras.

use crate::{
    error::Failed,
    presets,
    types::{CameraList, PresetName},
};
use pcmvs_core::{Camera, memory};
use pcmvs_scene::SceneCamera;
use std::rc::Rc;
use wasm_bindgen::prelude::*;

/// Bytes of memory of a module without a frame: its data, its stack, a decoder.
const MODULE: f64 = 16e6;
/// Bytes per pixel of the pictures that a frame holds: red, green, blue and mask.
const PICTURES_PER_PIXEL: f64 = 4.0;

/// A calibrated set of cameras, checked.
#[wasm_bindgen]
#[derive(Debug, Clone)]
pub struct Rig {
    pub(crate) rig: Rc<pcmvs_core::Rig>,
    /// The cameras' names.
    #[cfg(feature = "calibration")]
    pub(crate) names: Rc<[String]>,
}

#[wasm_bindgen]
impl Rig {
    /// Takes cameras as in scene.json. Throws `PcmvsError`.
    #[wasm_bindgen(constructor)]
    pub fn new(cameras: CameraList) -> Result<Rig, Failed> {
        let given: Vec<SceneCamera> = serde_wasm_bindgen::from_value(cameras.into())?;
        let camera = |(i, camera): (usize, &SceneCamera)| {
            camera.camera().map_err(|problem| Failed::of_camera("camera", &problem, i))
        };
        let cameras: Vec<Camera> = given.iter().enumerate().map(camera).collect::<Result<_, _>>()?;
        let rig = pcmvs_core::Rig::new(&cameras).map_err(|error| Failed::core(&error, None))?;
        Ok(Self {
            rig: Rc::new(rig),
            #[cfg(feature = "calibration")]
            names: given.into_iter().map(|camera| camera.name).collect(),
        })
    }

    /// Number of cameras.
    #[wasm_bindgen(getter)]
    pub fn cameras(&self) -> usize {
        self.rig.cameras().len()
    }

    /// Bytes of memory that a module is expected to need for a frame of this rig with its pictures. With `between`, the frame is
    /// made with the pictures of the frames before and after it (`reconstructBetween`), which are there, too.
    pub fn memory(&self, preset: &PresetName, between: Option<bool>) -> Result<f64, Failed> {
        let pixels: f64 = self.rig.cameras().iter().map(|c| f64::from(c.width) * f64::from(c.height)).sum();
        let params = presets::params(preset)?;
        let frame = memory::expected(&self.rig, &params);
        let (frames, reading) =
            if between == Some(true) { (3.0, memory::between(&self.rig, &params)) } else { (1.0, 0) };
        Ok(MODULE + frames * PICTURES_PER_PIXEL * pixels + (frame + reading) as f64)
    }

    /// World position to which stages' outputs are relative, x y z.
    #[wasm_bindgen(getter)]
    pub fn origin(&self) -> Vec<f64> {
        self.rig.origin().to_array().to_vec()
    }
}
