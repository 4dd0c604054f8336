//! One camera's picture and silhouette of one frame, undistorted.

use crate::{
    camera::Pinhole,
    error::{Error, Result},
    hash::Hash64,
    image::{ImageRef, luma},
    rig::Rig,
    silhouette::{ChromaKey, Silhouette, chroma, clean_plate},
};
use alloc::{format, vec::Vec};

/// Where a view's silhouette comes from.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub enum Mask<'a> {
    /// Nothing is known: the view carves nothing.
    Unknown,
    /// A picture that is white on the object; its bilinear half-level is the contour.
    Given(ImageRef<'a>),
    /// The object stands before a backdrop of one colour.
    ChromaKey(ChromaKey),
    /// The same camera's picture of the empty set.
    CleanPlate(ImageRef<'a>),
}

/// A camera's picture of one frame as the host gives it.
#[derive(Debug, Clone, Copy)]
pub struct ViewInput<'a> {
    /// The photograph, of the camera's calibrated size.
    pub image: ImageRef<'a>,
    /// The silhouette.
    pub mask: Mask<'a>,
}

/// A camera's picture and silhouette, resampled to the camera without distortion.
#[derive(Debug, Clone)]
pub struct View {
    /// Place of the camera in [`Rig::order`].
    pub index: u16,
    /// The camera.
    pub camera: Pinhole,
    /// Packed sRGB, row after row.
    pub rgb: Vec<u8>,
    /// Luma, row after row.
    pub luma: Vec<u8>,
    /// The silhouette, if one is known.
    pub silhouette: Option<Silhouette>,
}

impl View {
    /// Mixes picture and silhouette into a hash.
    pub(crate) fn hash(&self, mut hash: Hash64) -> Hash64 {
        for p in self.rgb.chunks(8) {
            hash.word(p.iter().fold(0, |word, &b| word << 8 | u64::from(b)));
        }
        for d in self.silhouette.iter().flat_map(|s| s.distances()).copied().collect::<Vec<_>>().chunks(4) {
            hash.word(d.iter().fold(0, |word, &d| word << 16 | u64::from(d as u16)));
        }
        hash
    }

    /// Reads the picture and silhouette of a camera, given by its index in the rig.
    ///
    /// # Errors
    /// [`Error::Image`] and [`Error::Silhouette`] name the camera and what does not fit.
    pub fn new(rig: &Rig, index: usize, input: &ViewInput) -> Result<Self> {
        let camera = &rig.cameras()[index];
        let fail = |problem| Error::Image { camera: index as u32, problem };
        input.image.check().map_err(fail)?;
        if (input.image.width, input.image.height) != (camera.width, camera.height) {
            return Err(fail(format!(
                "the picture is {} x {} pixels but the camera was calibrated at {} x {}: \
                 give pictures of the calibrated size or scale K",
                input.image.width, input.image.height, camera.width, camera.height
            )));
        }
        let undistortion = rig.undistortion(index);
        let mut rgb = input.image.to_rgb();
        let unusable = |problem| Error::Silhouette { camera: index as u32, problem };
        let coverage = match &input.mask {
            Mask::Unknown => None,
            Mask::Given(mask) => {
                mask.check().map_err(unusable)?;
                if (mask.width, mask.height) != (camera.width, camera.height) {
                    return Err(unusable(format!(
                        "the mask is {} x {} pixels but the camera was calibrated at {} x {}",
                        mask.width, mask.height, camera.width, camera.height
                    )));
                }
                Some(mask.to_gray())
            }
            Mask::ChromaKey(key) => Some(chroma::coverage(&input.image, &rgb, key).map_err(unusable)?),
            Mask::CleanPlate(plate) => Some(clean_plate::coverage(&input.image, &rgb, plate).map_err(unusable)?),
        };
        if let Some(undistortion) = undistortion {
            rgb = undistortion.rgb(&rgb);
        }
        let silhouette = coverage.map(|coverage| {
            let (w, h) = (camera.width, camera.height);
            match undistortion {
                None => Silhouette::from_coverage(w, h, &coverage, |_| true),
                Some(undistortion) => {
                    let (coverage, known) = undistortion.coverage(&coverage);
                    Silhouette::from_coverage(w, h, &coverage, |i| known[i])
                }
            }
            .map_err(unusable)
        });
        let luma = rgb.chunks_exact(3).map(|p| luma([p[0], p[1], p[2]])).collect();
        let silhouette = silhouette.transpose()?;
        let place = rig.order().iter().position(|&i| i as usize == index);
        Ok(Self { index: place.unwrap_or(index) as u16, camera: rig.pinholes()[index], rgb, luma, silhouette })
    }
}
