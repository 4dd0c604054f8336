//! One instant's pictures and silhouettes.

use crate::{
    error::Failed,
    photograph::Photograph,
    presets,
    progress::Callback,
    reconstruction::Reconstruction,
    rig::Rig,
    sketch,
    types::{ChromaKeyObject, PresetName, ProgressFunction},
};
use pcmvs_core::{
    ChromaKey, LeftOut, Mask, Params, PixelFormat, Serial, View, ViewInput, calibration, reconstruct,
    silhouette::{ContourParams, NoSilhouette},
};
use pcmvs_scene::Picture;
use std::rc::Rc;
use wasm_bindgen::prelude::*;

/// Where a camera's silhouette comes from.
#[derive(Debug, Clone, Default)]
enum Matte {
    /// The alpha channel of the picture's file, if it has one.
    #[default]
    Alpha,
    Unknown,
    Picture(Picture),
    Key(ChromaKey),
}

/// A camera's picture in this frame.
#[derive(Debug, Clone, Default)]
enum Photo {
    #[default]
    NotYet,
    /// The camera has none.
    Absent,
    Given {
        image: Picture,
        /// The mask in the alpha channel of the picture's file.
        alpha: Option<Picture>,
    },
}

/// What is known of a camera's view.
#[derive(Debug, Clone, Default)]
struct Slot {
    photo: Photo,
    matte: Matte,
}

/// A frame of a rig: a picture and a silhouette for every camera, from which it is reconstructed as often as wanted. Call
/// `free()` when it is no longer needed.
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

    /// Decodes a camera's photograph, JPEG or PNG. Where a PNG is partly transparent, its alpha channel is the mask unless
    /// another one is set. Throws `PcmvsError`.
    #[wasm_bindgen(js_name = setImage)]
    pub fn set_image(&mut self, camera: usize, file: &[u8]) -> Result<(), Failed> {
        let image = decode("image", camera, file)?;
        let alpha = image.alpha();
        self.slot(camera)?.photo = Photo::Given { image, alpha };
        Ok(())
    }

    /// Declares that a camera has no picture in this frame: it contributes nothing, which is a warning of the result.
    #[wasm_bindgen(js_name = setAbsent)]
    pub fn set_absent(&mut self, camera: usize) -> Result<(), Failed> {
        self.slot(camera)?.photo = Photo::Absent;
        Ok(())
    }

    /// Takes a camera's photograph as RGBA pixels by rows, such as a canvas' image data. Alpha is ignored.
    #[wasm_bindgen(js_name = setPixels)]
    pub fn set_pixels(&mut self, camera: usize, rgba: Vec<u8>, width: u32, height: u32) -> Result<(), Failed> {
        let image = Picture::new(rgba, width, height, PixelFormat::Rgba8);
        self.slot(camera)?.photo = Photo::Given { image, alpha: None };
        Ok(())
    }

    /// Decodes a camera's mask, JPEG or PNG, which is white on the object. Of a PNG that is partly transparent, the alpha
    /// channel is the mask. Throws `PcmvsError`.
    #[wasm_bindgen(js_name = setMask)]
    pub fn set_mask(&mut self, camera: usize, file: &[u8]) -> Result<(), Failed> {
        let picture = decode("silhouette", camera, file)?;
        self.slot(camera)?.matte = Matte::Picture(picture.into_mask());
        Ok(())
    }

    /// Takes a camera's mask as one byte per pixel by rows. The object is 255.
    #[wasm_bindgen(js_name = setMaskPixels)]
    pub fn set_mask_pixels(&mut self, camera: usize, gray: Vec<u8>, width: u32, height: u32) -> Result<(), Failed> {
        self.slot(camera)?.matte = Matte::Picture(Picture::new(gray, width, height, PixelFormat::Gray8));
        Ok(())
    }

    /// Finds a camera's silhouette in front of a backdrop of one colour.
    #[wasm_bindgen(js_name = setChromaKey)]
    pub fn set_chroma_key(&mut self, camera: usize, key: ChromaKeyObject) -> Result<(), Failed> {
        let key = key.try_into()?;
        self.slot(camera)?.matte = Matte::Key(key);
        Ok(())
    }

    /// Declares a camera's silhouette unknown, so that the camera does not carve the visual hull.
    #[wasm_bindgen(js_name = clearMask)]
    pub fn clear_mask(&mut self, camera: usize) -> Result<(), Failed> {
        self.slot(camera)?.matte = Matte::Unknown;
        Ok(())
    }

    /// A camera's picture and silhouette without lens distortion, as the stages see them. Throws `PcmvsError`.
    pub fn photograph(&self, camera: usize) -> Result<Photograph, Failed> {
        let absent = || Failed::of_camera("image", "this camera has no picture in this frame", camera);
        let input = self.input(camera)?.ok_or_else(absent)?;
        let view = View::new(&self.rig, camera, &input, Some(&ContourParams::default()));
        let view = view.map_err(|error| Failed::core(&error, None))?;
        if view.left_out == Some(LeftOut::EmptySilhouette) {
            return Err(Failed::of_camera("silhouette", &NoSilhouette::Empty.to_string(), camera));
        }
        Ok(Photograph::new(view))
    }

    /// Reconstructs. `progress(stage, done, total)` is called on the way; when it returns false, an error of code
    /// `cancelled` is thrown. Throws `PcmvsError`.
    pub fn reconstruct(
        &self,
        preset: &PresetName,
        progress: Option<ProgressFunction>,
    ) -> Result<Reconstruction, Failed> {
        let inputs: Vec<Option<ViewInput>> = (0..self.slots.len()).map(|i| self.input(i)).collect::<Result<_, _>>()?;
        run(&self.rig, &inputs, &presets::params(preset)?, progress)
    }

    /// A coarse visual hull from the cameras that have their pictures so far, to be looked at early. Its only stage output
    /// is the hull, and it has neither warnings nor figures of views. Throws `PcmvsError`.
    pub fn sketch(&self) -> Result<Reconstruction, Failed> {
        let has_picture = |&i: &usize| matches!(self.slots[i].photo, Photo::Given { .. });
        let present: Vec<usize> = (0..self.slots.len()).filter(has_picture).collect();
        let inputs: Vec<Option<ViewInput>> = present.iter().map(|&i| self.input(i)).collect::<Result<_, _>>()?;
        let made = sketch::rig_of(&self.rig, &present).and_then(|rig| run(&rig, &inputs, &sketch::params(), None));
        made.map(Reconstruction::without_findings).map_err(|failed| failed.of_cameras(&present))
    }
}

fn run(
    rig: &pcmvs_core::Rig,
    inputs: &[Option<ViewInput>],
    params: &Params,
    progress: Option<ProgressFunction>,
) -> Result<Reconstruction, Failed> {
    let callback = Callback::new(progress);
    let made = reconstruct(rig, inputs, params, &Serial, &callback);
    made.map(|made| Reconstruction::new(made, rig.origin())).map_err(|error| callback.failed(&error))
}

impl Frame {
    /// The rig that it was made with.
    pub(crate) fn rig(&self) -> &Rc<pcmvs_core::Rig> {
        &self.rig
    }

    /// The views of all cameras in the rig's order, for the calibration.
    pub(crate) fn views(&self) -> Result<Vec<View>, Failed> {
        let view = |&camera: &u32| {
            let view = calibration::view(&self.rig, camera as usize, self.input(camera as usize)?.as_ref());
            view.map_err(|error| Failed::core(&error, None))
        };
        self.rig.order().iter().map(view).collect()
    }

    fn slot(&mut self, camera: usize) -> Result<&mut Slot, Failed> {
        let count = self.slots.len();
        self.slots.get_mut(camera).ok_or_else(|| no_camera(count))
    }

    /// A camera's view, or `None` if it has no picture in this frame.
    fn input(&self, camera: usize) -> Result<Option<ViewInput<'_>>, Failed> {
        let slot = self.slots.get(camera).ok_or_else(|| no_camera(self.slots.len()))?;
        let (image, alpha) = match &slot.photo {
            Photo::NotYet => return Err(Failed::of_camera("image", "this camera has no picture yet", camera)),
            Photo::Absent => return Ok(None),
            Photo::Given { image, alpha } => (image, alpha),
        };
        let mask = match (&slot.matte, alpha) {
            (Matte::Picture(picture), _) | (Matte::Alpha, Some(picture)) => Mask::Given(picture.view()),
            (Matte::Key(key), _) => Mask::ChromaKey(*key),
            (Matte::Alpha | Matte::Unknown, _) => Mask::Unknown,
        };
        Ok(Some(ViewInput { image: image.view(), mask }))
    }
}

/// A camera's number is not one of the rig's `count`.
fn no_camera(count: usize) -> Failed {
    Failed::input(&format!("there are cameras 0 to {}", count - 1))
}

fn decode(code: &'static str, camera: usize, file: &[u8]) -> Result<Picture, Failed> {
    Picture::decode(file).map_err(|problem| Failed::of_camera(code, &problem, camera))
}
