//! The cameras.

use crate::{error::Failed, types::CameraList};
use pcmvs_core::Camera;
use pcmvs_scene::SceneCamera;
use std::rc::Rc;
use wasm_bindgen::prelude::*;

/// A calibrated set of cameras, checked.
#[wasm_bindgen]
#[derive(Debug, Clone)]
pub struct Rig {
    pub(crate) rig: Rc<pcmvs_core::Rig>,
}

#[wasm_bindgen]
impl Rig {
    /// Takes cameras as in scene.json. Throws `PcmvsError`.
    #[wasm_bindgen(constructor)]
    pub fn new(cameras: CameraList) -> Result<Rig, Failed> {
        let cameras: Vec<SceneCamera> = serde_wasm_bindgen::from_value(cameras.into())?;
        let camera = |(i, camera): (usize, &SceneCamera)| {
            camera.camera().map_err(|problem| Failed::new("camera", &problem, Some(i as u32), None))
        };
        let cameras: Vec<Camera> = cameras.iter().enumerate().map(camera).collect::<Result<_, _>>()?;
        let rig = pcmvs_core::Rig::new(&cameras).map_err(|error| Failed::core(&error, None))?;
        Ok(Self { rig: Rc::new(rig) })
    }

    /// Number of cameras.
    #[wasm_bindgen(getter)]
    pub fn cameras(&self) -> usize {
        self.rig.cameras().len()
    }

    /// World position that stages' outputs are relative to, x y z.
    #[wasm_bindgen(getter)]
    pub fn origin(&self) -> Vec<f64> {
        self.rig.origin().to_array().to_vec()
    }
}
