//! A camera's picture and silhouette without lens distortion.

use crate::{error::Failed, frame::Frame};
use js_sys::Uint8ClampedArray;
use pcmvs_core::{
    LeftOut, View,
    silhouette::{ContourParams, NoSilhouette, Silhouette},
};
use wasm_bindgen::prelude::*;
use web_sys::ImageData;

/// A camera's picture and silhouette without lens distortion, for a canvas. Call `free()` when it is no longer needed.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Photograph {
    view: View,
}

#[wasm_bindgen]
impl Frame {
    /// A camera's picture and silhouette without lens distortion, as the stages see them. Throws `PcmvsError`.
    pub fn photograph(&self, camera: usize) -> Result<Photograph, Failed> {
        let absent = || Failed::of_camera("image", "this camera has no picture in this frame", camera);
        let input = self.input(camera)?.ok_or_else(absent)?;
        let view = View::new(self.rig(), camera, &input, Some(&ContourParams::default()));
        let view = view.map_err(|error| Failed::core(&error, None))?;
        if view.left_out == Some(LeftOut::EmptySilhouette) {
            return Err(Failed::of_camera("silhouette", &NoSilhouette::Empty.to_string(), camera));
        }
        Ok(Photograph { view })
    }
}

impl Photograph {
    fn image(&self, rgba: &[u8]) -> Result<ImageData, Failed> {
        let camera = &self.view.camera;
        // A copy, because image data keeps the array that it is given, and the instance's memory is used again.
        let copy = Uint8ClampedArray::new_from_slice(rgba);
        Ok(ImageData::new_with_js_u8_clamped_array_and_sh(&copy, camera.width, camera.height)?)
    }
}

#[wasm_bindgen]
impl Photograph {
    /// The opaque picture.
    pub fn picture(&self) -> Result<ImageData, Failed> {
        let rgba: Vec<u8> = self.view.rgb.chunks_exact(3).flat_map(|p| [p[0], p[1], p[2], 255]).collect();
        self.image(&rgba)
    }

    /// The silhouette as an overlay in one colour, or undefined without a silhouette. It is opaque inside the silhouette
    /// and where nothing is known, transparent outside, and in between on the contour.
    pub fn silhouette(&self, red: u8, green: u8, blue: u8) -> Result<Option<ImageData>, Failed> {
        let Some(silhouette) = &self.view.silhouette else { return Ok(None) };
        let alpha = |distance: i16| match distance {
            Silhouette::UNKNOWN => 255,
            distance => ((f32::from(distance) / Silhouette::UNITS + 0.5).clamp(0.0, 1.0) * 255.0) as u8,
        };
        let distances = silhouette.distances().iter();
        let rgba: Vec<u8> = distances.flat_map(|&distance| [red, green, blue, alpha(distance)]).collect();
        self.image(&rgba).map(Some)
    }
}
