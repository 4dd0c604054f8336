//! The input of a frame from one camera: a picture and a silhouette.

use crate::{
    failure::{Failure, Result},
    image::{Calibrated, Pixels, copied, pcmvs_image},
    sized::{Growing, Versioned, init, read},
    status::pcmvs_status::{self, InvalidArgument},
};
use pcmvs_core::{ChromaKey, Mask, ViewInput};
use std::{mem::size_of, ptr::null};

/// Parameters that separate the object from a backdrop of one colour. The backdrop need not be evenly lit.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_chroma_key {
    /// Set by `pcmvs_chroma_key_init`.
    pub struct_size: u32,
    /// Approximate colour of the backdrop: red, green, blue in sRGB. The fourth byte is zero.
    pub rgb: [u8; 4],
    /// Tolerance in hue, 0 to 1. A pixel belongs to the backdrop if the angle between its colour and the local backdrop's is
    /// smaller than this share of the angle between the backdrop's colour and grey.
    pub tolerance: f32,
    /// Darkest shadow on the backdrop that is recognised, as a share of the local brightness.
    pub darkest_shadow: f32,
    /// Parts of the object that cover less than this share of the picture are removed.
    pub smallest_part: f32,
    /// Holes in the object that cover less than this share of the picture are filled.
    pub smallest_hole: f32,
}

impl Growing for pcmvs_chroma_key {
    const FIRST_SIZE: usize = 24;
}

// SAFETY: numbers only, the size first, no padding.
unsafe impl Versioned for pcmvs_chroma_key {
    fn defaults() -> Self {
        let ChromaKey { rgb: [r, g, b], tolerance, darkest_shadow, smallest_part, smallest_hole, .. } =
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

    fn reserved_is_zero(&self) -> bool {
        self.rgb[3] == 0
    }
}

/// Initialises a chroma key for a green backdrop. `size` is `sizeof *key`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_chroma_key_init(key: *mut pcmvs_chroma_key, size: usize) -> pcmvs_status {
    // SAFETY: the caller's promise.
    unsafe { init(key, size, "key") }
}

/// One camera's picture and the source of its silhouette. At most one of `mask`, `clean_plate` and `chroma_key` may be set.
/// If none is set, the view has no silhouette and does not carve the hull. If `image` is not set either, the camera has no
/// picture in this frame: the view contributes nothing, which is a warning of the frame.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_view {
    /// Set by `pcmvs_view_init`.
    pub struct_size: u32,
    /// Zero.
    pub reserved: u32,
    /// The picture. It has the size for which the camera was calibrated. NULL if the camera has none in this frame.
    pub image: *const pcmvs_image,
    /// A mask of the same size, white on the object and black elsewhere. Grey values are coverage; the contour is where the
    /// coverage is one half. May be NULL.
    pub mask: *const pcmvs_image,
    /// A picture that the same camera took without the object. May be NULL.
    pub clean_plate: *const pcmvs_image,
    /// Parameters of a backdrop of one colour. May be NULL.
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

    fn reserved_is_zero(&self) -> bool {
        self.reserved == 0
    }
}

/// Initialises a view without a picture. `size` is `sizeof *view`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_view_init(view: *mut pcmvs_view, size: usize) -> pcmvs_status {
    // SAFETY: the caller's promise.
    unsafe { init(view, size, "view") }
}

/// A view whose structs have been read and checked.
pub(crate) struct GivenView<'a> {
    /// `None` if the camera has no picture.
    given: Option<(Pixels<'a>, GivenSilhouette<'a>)>,
}

enum GivenSilhouette<'a> {
    Unknown,
    Mask(Pixels<'a>),
    CleanPlate(Pixels<'a>),
    ChromaKey(ChromaKey),
}

impl GivenView<'_> {
    /// # Safety
    /// Pointers are NULL or point to as many bytes as the structs say, for as long as the value lives.
    pub unsafe fn new(view: &pcmvs_view, of: Calibrated) -> Result<Self> {
        let pcmvs_view { image, mask, clean_plate, chroma_key, .. } = *view;
        let given = [mask.is_null(), clean_plate.is_null(), chroma_key.is_null()];
        if given.iter().filter(|&&null| !null).count() > 1 {
            let problem = "the view has more than one of mask, clean plate and chroma key: give one";
            return Err(Failure::new(InvalidArgument, problem));
        }
        if image.is_null() && given.iter().all(|&null| null) {
            return Ok(Self { given: None });
        }
        // SAFETY: the caller's promise.
        let pixels = |image: *const pcmvs_image, name| unsafe { Pixels::new(&read(image, name)?, of, name) };
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
            GivenSilhouette::ChromaKey(ChromaKey {
                rgb,
                tolerance,
                darkest_shadow,
                smallest_part,
                smallest_hole,
                ..ChromaKey::default()
            })
        } else {
            GivenSilhouette::Unknown
        };
        Ok(Self { given: Some((image, silhouette)) })
    }

    /// Bytes that [`Self::new`] copies.
    ///
    /// # Safety
    /// As for [`Self::new`].
    pub unsafe fn copied(view: &pcmvs_view, of: Calibrated) -> u64 {
        // SAFETY: the caller's promise. What cannot be read is refused later.
        let bytes = |image: *const pcmvs_image| unsafe { read(image, "") }.map_or(0, |image| copied(&image, of));
        [view.image, view.mask, view.clean_plate].into_iter().filter(|image| !image.is_null()).map(bytes).sum()
    }

    /// The view as the core takes it. `None` if the camera has no picture.
    pub fn input(&self) -> Option<ViewInput<'_>> {
        let (image, silhouette) = self.given.as_ref()?;
        let mask = match silhouette {
            GivenSilhouette::Unknown => Mask::Unknown,
            GivenSilhouette::Mask(mask) => Mask::Given(mask.view()),
            GivenSilhouette::CleanPlate(plate) => Mask::CleanPlate(plate.view()),
            GivenSilhouette::ChromaKey(key) => Mask::ChromaKey(*key),
        };
        Some(ViewInput { image: image.view(), mask })
    }
}
