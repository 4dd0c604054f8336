//! What a camera gives for a frame: picture and silhouette.

use crate::{
    boundary::{Growing, Result, Versioned, init, read},
    error::Failure,
    image::{Pixels, pcmvs_image},
    status::pcmvs_status::{self, InvalidArgument},
};
use pcmvs_core::{ChromaKey, Mask, ViewInput};
use std::{mem::size_of, ptr::null};

/// How to tell an object from a backdrop of one colour, evenly lit or not.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_chroma_key {
    /// Set by `pcmvs_chroma_key_init`.
    pub struct_size: u32,
    /// About the backdrop's colour: red, green, blue in sRGB, then zero.
    pub rgb: [u8; 4],
    /// A pixel is backdrop if its colour is turned from the local backdrop's by less than this share (0 to 1) of the
    /// angle between the backdrop's colour and gray.
    pub tolerance: f32,
    /// Shadows on the backdrop are recognised down to this share of its local brightness.
    pub darkest_shadow: f32,
    /// Parts of the object smaller than this share of the picture are removed.
    pub smallest_part: f32,
    /// Holes in the object smaller than this share of the picture are filled.
    pub smallest_hole: f32,
}

impl Growing for pcmvs_chroma_key {
    const FIRST_SIZE: usize = 24;
}

// SAFETY: numbers only, the size first, no padding.
unsafe impl Versioned for pcmvs_chroma_key {
    fn defaults() -> Self {
        let ChromaKey { rgb: [r, g, b], tolerance, darkest_shadow, smallest_part, smallest_hole } =
            ChromaKey::default();
        Self {
            struct_size: size_of::<Self>() as u32,
            rgb: [r, g, b, 0],
            tolerance,
            darkest_shadow,
            smallest_part,
            smallest_hole,
        }
    }
}

/// Sets a chroma key to the usual green. `size` is `sizeof *key`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_chroma_key_init(key: *mut pcmvs_chroma_key, size: usize) -> pcmvs_status {
    // SAFETY: the caller's promise.
    unsafe { init(key, size, "key") }
}

/// A camera's picture of one frame and where its silhouette comes from. At most one of `mask`, `clean_plate` and
/// `chroma_key` is given; with none of them the view carves nothing.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_view {
    /// Set by `pcmvs_view_init`.
    pub struct_size: u32,
    /// Zero.
    pub reserved: u32,
    /// The picture, of the camera's calibrated size.
    pub image: *const pcmvs_image,
    /// A picture of the same size that is white on the object and black elsewhere, or NULL. Gray values are coverage:
    /// the contour runs where it is one half.
    pub mask: *const pcmvs_image,
    /// The same camera's picture of the empty set, or NULL.
    pub clean_plate: *const pcmvs_image,
    /// The backdrop's colour, or NULL.
    pub chroma_key: *const pcmvs_chroma_key,
}

impl Growing for pcmvs_view {
    const FIRST_SIZE: usize = 8 + 4 * size_of::<usize>();
}

// SAFETY: numbers and raw pointers, the size first, no padding.
unsafe impl Versioned for pcmvs_view {
    fn defaults() -> Self {
        let size = size_of::<Self>() as u32;
        Self { struct_size: size, reserved: 0, image: null(), mask: null(), clean_plate: null(), chroma_key: null() }
    }
}

/// Sets a view to nothing. `size` is `sizeof *view`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_view_init(view: *mut pcmvs_view, size: usize) -> pcmvs_status {
    // SAFETY: the caller's promise.
    unsafe { init(view, size, "view") }
}

/// A view whose description has been read and checked.
pub(crate) struct GivenView<'a> {
    image: Pixels<'a>,
    silhouette: GivenSilhouette<'a>,
}

enum GivenSilhouette<'a> {
    Unknown,
    Mask(Pixels<'a>),
    CleanPlate(Pixels<'a>),
    ChromaKey(ChromaKey),
}

impl GivenView<'_> {
    /// # Safety
    /// Pointers are NULL or true, for as long as the value lives.
    pub unsafe fn new(view: &pcmvs_view) -> Result<Self> {
        let pcmvs_view { image, mask, clean_plate, chroma_key, .. } = *view;
        let given = [mask.is_null(), clean_plate.is_null(), chroma_key.is_null()];
        if given.iter().filter(|&&null| !null).count() > 1 {
            let problem = "a view has more than one of mask, clean plate and chroma key: give one";
            return Err(Failure::new(InvalidArgument, problem));
        }
        // SAFETY: the caller's promise.
        let pixels = |image: *const pcmvs_image, name| unsafe { Pixels::new(&read(image, name)?, name) };
        let image = pixels(image, "view.image")?;
        let silhouette = if !mask.is_null() {
            GivenSilhouette::Mask(pixels(mask, "view.mask")?)
        } else if !clean_plate.is_null() {
            GivenSilhouette::CleanPlate(pixels(clean_plate, "view.clean_plate")?)
        } else if !chroma_key.is_null() {
            // SAFETY: the caller's promise.
            let key = unsafe { read(chroma_key, "view.chroma_key")? };
            let [r, g, b, _] = key.rgb;
            let pcmvs_chroma_key { tolerance, darkest_shadow, smallest_part, smallest_hole, .. } = key;
            let rgb = [r, g, b];
            GivenSilhouette::ChromaKey(ChromaKey { rgb, tolerance, darkest_shadow, smallest_part, smallest_hole })
        } else {
            GivenSilhouette::Unknown
        };
        Ok(Self { image, silhouette })
    }

    /// As the core takes it.
    pub fn input(&self) -> ViewInput<'_> {
        let mask = match &self.silhouette {
            GivenSilhouette::Unknown => Mask::Unknown,
            GivenSilhouette::Mask(mask) => Mask::Given(mask.view()),
            GivenSilhouette::CleanPlate(plate) => Mask::CleanPlate(plate.view()),
            GivenSilhouette::ChromaKey(key) => Mask::ChromaKey(*key),
        };
        ViewInput { image: self.image.view(), mask }
    }
}
