//! Pictures in the caller's memory.

use crate::{
    failure::{Failure, Result},
    pixel_format::pcmvs_pixel_format,
    plane::Plane,
    sized::{Growing, Versioned, init},
    status::pcmvs_status::{self, Image, InvalidArgument, Silhouette},
    ycbcr::{self, pcmvs_ycbcr},
};
use pcmvs_core::{Camera, ImageRef, PixelFormat};
use std::{ffi::c_void, mem::size_of, ptr::null};

/// A picture in the caller's memory. It is read only during the call and never written.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_image {
    /// Set by `pcmvs_image_init`.
    pub struct_size: u32,
    /// A `pcmvs_pixel_format`.
    pub format: u32,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// First byte of the top row.
    pub data: *const c_void,
    /// Bytes from one row to the row below it. Negative if the rows are stored from the bottom up. 0 means packed rows.
    pub stride: isize,
    /// NV12 and P010: first byte of the top row of the Cb, Cr plane. I420: that of the Cb plane.
    pub chroma: *const c_void,
    /// Bytes from one row of that plane to the row below it, as for `stride`.
    pub chroma_stride: isize,
    /// I420 only: first byte of the top row of the Cr plane.
    pub cr: *const c_void,
    /// I420 only: bytes from one row of the Cr plane to the row below it, as for `stride`.
    pub cr_stride: isize,
    /// A `pcmvs_ycbcr`, for formats with luma.
    pub ycbcr: u32,
    /// Zero.
    pub reserved: u32,
}

impl Growing for pcmvs_image {
    const FIRST_SIZE: usize = 16 + 4 * size_of::<usize>();
}

// SAFETY: numbers and raw pointers, the size first, no padding.
unsafe impl Versioned for pcmvs_image {
    fn defaults() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            format: pcmvs_pixel_format::Rgb8 as u32,
            width: 0,
            height: 0,
            data: null(),
            stride: 0,
            chroma: null(),
            chroma_stride: 0,
            cr: null(),
            cr_stride: 0,
            ycbcr: pcmvs_ycbcr::Bt601Video as u32,
            reserved: 0,
        }
    }

    fn reserved_is_zero(&self) -> bool {
        self.reserved == 0
    }
}

/// Initialises a picture: RGB, packed rows, no size and no data. `size` is `sizeof *image`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_image_init(image: *mut pcmvs_image, size: usize) -> pcmvs_status {
    // SAFETY: the caller's promise.
    unsafe { init(image, size, "image") }
}

/// A camera's index, and the width and height of its pictures.
#[derive(Clone, Copy)]
pub(crate) struct Calibrated {
    pub camera: u32,
    pub size: [u32; 2],
}

/// The calibrated sizes of cameras, in their order.
pub(crate) fn calibrated(cameras: &[Camera]) -> Vec<Calibrated> {
    let of = |(camera, c): (u32, &Camera)| Calibrated { camera, size: [c.width, c.height] };
    (0..).zip(cameras).map(of).collect()
}

/// Bytes that [`Pixels::new`] copies of a picture of the right size: rows that are stored from the bottom up, 16 bits to 8, and
/// luma and colour differences to RGB.
pub(crate) fn copied(image: &pcmvs_image, of: Calibrated) -> u64 {
    if [image.width, image.height] != of.size {
        return 0;
    }
    let Some(format) = pcmvs_pixel_format::new(image.format) else { return 0 };
    let [w, h] = of.size.map(u64::from);
    let (row, differences) = format.rows(w as usize);
    let plane = |row: usize, rows: u64, stride: isize| if stride < 0 { row as u64 * rows } else { 0 };
    let strides = [image.chroma_stride, image.cr_stride];
    let of_differences = differences.into_iter().zip(strides);
    let flipped = plane(row, h, image.stride)
        + of_differences.map(|(row, stride)| plane(row.unwrap_or(0), h.div_ceil(2), stride)).sum::<u64>();
    let converted = match format {
        pcmvs_pixel_format::Gray16 => w * h,
        _ if ycbcr::is_converted(format, image.ycbcr) => 3 * w * h,
        _ => 0,
    };
    flipped + converted
}

/// A picture that the core can borrow.
pub(crate) struct Pixels<'a> {
    width: u32,
    height: u32,
    format: PixelFormat,
    plane: Plane<'a>,
    chroma: Option<Plane<'a>>,
}

impl Pixels<'_> {
    /// The camera's size is checked before any byte is read.
    ///
    /// # Safety
    /// The pointers are NULL or point to as many bytes as the description says.
    pub unsafe fn new(image: &pcmvs_image, of: Calibrated, name: &str) -> Result<Self> {
        let (width, height) = (image.width as usize, image.height as usize);
        let Some(format) = pcmvs_pixel_format::new(image.format) else {
            return Err(Failure::new(InvalidArgument, format!("`{name}`: pixel format {} is not known", image.format)));
        };
        if width == 0 || height == 0 {
            return Err(Failure::new(Image, format!("`{name}` is {width} x {height} pixels: it is empty")));
        }
        if [image.width, image.height] != of.size {
            let what = match name {
                "view.image" => "picture",
                "view.mask" => "mask",
                _ => "clean plate",
            };
            let problem = format!(
                "camera {}: the {what} is {width} x {height} pixels but the camera was calibrated at {} x {}: give pictures of the \
                 calibrated size, or scale K",
                of.camera, of.size[0], of.size[1]
            );
            return Err(Failure::new(if name == "view.image" { Image } else { Silhouette }, problem));
        }
        let (row, differences) = format.rows(width);
        // SAFETY: the caller's promise.
        let mut plane = unsafe { Plane::new(image.data, height, row, image.stride, &format!("{name}.data"))? };
        if format == pcmvs_pixel_format::Gray16 {
            let rows = plane.bytes().chunks(plane.stride).map(|row| &row[..2 * width]);
            let eight = |p: &[u8]| ((u32::from(u16::from_ne_bytes([p[0], p[1]])) * 255 + 32767) / 65535) as u8;
            let copied = rows.flat_map(|row| row.chunks_exact(2).map(eight)).collect();
            plane = Plane::of(copied, width);
        }
        let given = [(image.chroma, image.chroma_stride, "chroma"), (image.cr, image.cr_stride, "cr")];
        let mut planes = [None, None];
        for ((plane, row), (data, stride, member)) in planes.iter_mut().zip(differences).zip(given) {
            if let Some(row) = row {
                // SAFETY: the caller's promise.
                *plane =
                    Some(unsafe { Plane::new(data, height.div_ceil(2), row, stride, &format!("{name}.{member}"))? });
            }
        }
        let (width, height, mut core) = (image.width, image.height, format.of_core());
        if ycbcr::is_converted(format, image.ycbcr) {
            let size = [width as usize, height as usize];
            let rgb = ycbcr::to_rgb((format, image.ycbcr), size, &plane, &planes, name)?;
            (plane, planes, core) = (Plane::of(rgb, 3 * size[0]), [None, None], PixelFormat::Rgb8);
        }
        let [chroma, _] = planes;
        Ok(Self { width, height, format: core, plane, chroma })
    }

    /// The picture as the core takes it.
    pub fn view(&self) -> ImageRef<'_> {
        ImageRef {
            data: self.plane.bytes(),
            width: self.width,
            height: self.height,
            stride: self.plane.stride,
            format: self.format,
            chroma: self.chroma.as_ref().map(|plane| (plane.bytes(), plane.stride)),
        }
    }
}
