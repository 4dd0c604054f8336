//! One instant's pictures and silhouettes.

use crate::{error::Failed, rig::Rig, types::ChromaKeyObject};
use pcmvs_core::{ChromaKey, Mask, PixelFormat, ViewInput};
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
        /// The file, if its levels depend on the other pictures of the frame.
        file: Option<Vec<u8>>,
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
    /// another one is set. Of PNGs of 16 bits, the brightest pixel of all pictures of the frame tells whether 8, 10, 12 or 16
    /// bits are used. Throws `PcmvsError`.
    #[wasm_bindgen(js_name = setImage)]
    pub fn set_image(&mut self, camera: usize, file: &[u8]) -> Result<(), Failed> {
        let image = decode("image", camera, file, 0)?;
        let file = Picture::has_16_bits(file).then(|| file.to_vec());
        let alpha = image.alpha();
        self.slot(camera)?.photo = Photo::Given { image, alpha, file };
        self.agree_on_levels()
    }

    /// Declares that a camera has no picture in this frame: it contributes nothing, which is a warning of the result.
    #[wasm_bindgen(js_name = setAbsent)]
    pub fn set_absent(&mut self, camera: usize) -> Result<(), Failed> {
        self.slot(camera)?.photo = Photo::Absent;
        self.agree_on_levels()
    }

    /// Takes a camera's photograph as RGBA pixels by rows, such as a canvas' image data. Alpha is ignored.
    #[wasm_bindgen(js_name = setPixels)]
    pub fn set_pixels(&mut self, camera: usize, rgba: Vec<u8>, width: u32, height: u32) -> Result<(), Failed> {
        let image = Picture::new(rgba, width, height, PixelFormat::Rgba8);
        self.slot(camera)?.photo = Photo::Given { image, alpha: None, file: None };
        self.agree_on_levels()
    }

    /// Decodes a camera's mask, JPEG or PNG, which is white on the object. Of a PNG that is partly transparent, the alpha
    /// channel is the mask. Throws `PcmvsError`.
    #[wasm_bindgen(js_name = setMask)]
    pub fn set_mask(&mut self, camera: usize, file: &[u8]) -> Result<(), Failed> {
        let picture = decode("silhouette", camera, file, 0)?;
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
}

impl Frame {
    /// The rig that it was made with.
    pub(crate) fn rig(&self) -> &Rc<pcmvs_core::Rig> {
        &self.rig
    }

    /// A camera's view, or `None` if it has no picture in this frame.
    pub(crate) fn input(&self, camera: usize) -> Result<Option<ViewInput<'_>>, Failed> {
        let slot = self.slots.get(camera).ok_or_else(|| no_camera(self.slots.len()))?;
        let (image, alpha) = match &slot.photo {
            Photo::NotYet => return Err(Failed::of_camera("image", "this camera has no picture yet", camera)),
            Photo::Absent => return Ok(None),
            Photo::Given { image, alpha, .. } => (image, alpha),
        };
        let mask = match (&slot.matte, alpha) {
            (Matte::Picture(picture), _) | (Matte::Alpha, Some(picture)) => Mask::Given(picture.view()),
            (Matte::Key(key), _) => Mask::ChromaKey(*key),
            (Matte::Alpha | Matte::Unknown, _) => Mask::Unknown,
        };
        Ok(Some(ViewInput { image: image.view(), mask }))
    }

    /// The views of all cameras.
    pub(crate) fn inputs(&self) -> Result<Vec<Option<ViewInput<'_>>>, Failed> {
        (0..self.slots.len()).map(|camera| self.input(camera)).collect()
    }

    /// The views of all cameras of the frame, of the one before and of the one after, which must be of the same rig.
    pub(crate) fn inputs_between<'a>(
        &'a self,
        before: &'a Self,
        after: &'a Self,
    ) -> Result<[Vec<Option<ViewInput<'a>>>; 3], Failed> {
        let count = self.rig.cameras().len();
        for other in [before, after] {
            if other.rig.cameras().len() != count || other.rig.origin() != self.rig.origin() {
                return Err(Failed::input("a neighbour has other cameras: use frames of the same rig"));
            }
        }
        Ok([self.inputs()?, before.inputs()?, after.inputs()?])
    }

    /// Whether a camera's picture has been given.
    #[cfg(feature = "reconstruction")]
    pub(crate) fn has_picture(&self, camera: usize) -> bool {
        matches!(self.slots[camera].photo, Photo::Given { .. })
    }

    /// Decodes those pictures of 16 bits again whose range of levels is not that of all pictures.
    fn agree_on_levels(&mut self) -> Result<(), Failed> {
        let own = |slot: &Slot| match &slot.photo {
            Photo::Given { image, .. } => image.brightest(),
            _ => 0,
        };
        let brightest = self.slots.iter().map(own).max().unwrap_or(0);
        for (camera, slot) in self.slots.iter_mut().enumerate() {
            if let Photo::Given { image, file: Some(file), .. } = &mut slot.photo
                && !image.is_right_among(brightest)
            {
                *image = decode("image", camera, file, brightest)?;
            }
        }
        Ok(())
    }

    fn slot(&mut self, camera: usize) -> Result<&mut Slot, Failed> {
        let count = self.slots.len();
        self.slots.get_mut(camera).ok_or_else(|| no_camera(count))
    }
}

/// A camera's number is not one of the rig's `count`.
fn no_camera(count: usize) -> Failed {
    Failed::input(&format!("there are cameras 0 to {}", count - 1))
}

/// Decodes a file among pictures whose brightest pixel has a level.
fn decode(code: &'static str, camera: usize, file: &[u8], brightest: u16) -> Result<Picture, Failed> {
    Picture::decode_among(file, brightest).map_err(|problem| Failed::of_camera(code, &problem, camera))
}
