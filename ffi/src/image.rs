//! Pictures in the caller's memory.

use crate::{
    failure::{Failure, Result},
    sized::{Growing, Versioned, init},
    status::pcmvs_status::{self, Image, InvalidArgument, NullPointer, Silhouette},
};
use pcmvs_core::{Camera, ImageRef, PixelFormat};
use std::{ffi::c_void, mem::size_of, ptr::null, slice::from_raw_parts};

/// Pixel formats. Numbers never change.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum pcmvs_pixel_format {
    /// One byte per pixel.
    Gray8 = 0,
    /// Red, green, blue: three bytes per pixel.
    Rgb8 = 1,
    /// Blue, green, red: three bytes per pixel.
    Bgr8 = 2,
    /// Red, green, blue and a byte that is ignored.
    Rgba8 = 3,
    /// Blue, green, red and a byte that is ignored.
    Bgra8 = 4,
    /// A plane of luma and a plane of interleaved Cb, Cr at half the width and height. BT.601, video range.
    Nv12 = 5,
    /// Two bytes per pixel in the machine's byte order. 65535 is white.
    Gray16 = 6,
}

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
    /// NV12 only: first byte of the top row of the Cb, Cr plane.
    pub chroma: *const c_void,
    /// NV12 only: bytes from one row of the Cb, Cr plane to the row below it, as for `stride`.
    pub chroma_stride: isize,
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
        }
    }
}

/// Initialises a picture: RGB, packed rows, no size and no data. `size` is `sizeof *image`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_image_init(image: *mut pcmvs_image, size: usize) -> pcmvs_status {
    // SAFETY: the caller's promise.
    unsafe { init(image, size, "image") }
}

/// Rows of bytes from the top down. Rows that the caller stores from the bottom up are copied.
struct Plane<'a> {
    borrowed: &'a [u8],
    copied: Option<Vec<u8>>,
    stride: usize,
}

impl Plane<'_> {
    /// # Safety
    /// `data` is NULL or points to the top row of `rows` rows of `row` bytes that are `stride` bytes apart.
    unsafe fn new(data: *const c_void, rows: usize, row: usize, stride: isize, name: &str) -> Result<Self> {
        if data.is_null() {
            return Err(Failure::new(NullPointer, format!("`{name}` is NULL")));
        }
        let stride = if stride == 0 { row as isize } else { stride };
        let apart = stride.unsigned_abs();
        if apart < row {
            return Err(Failure::new(Image, format!("a stride of {stride} bytes is less than a row of {row}")));
        }
        let bytes =
            apart.checked_mul(rows - 1).and_then(|b| b.checked_add(row)).filter(|&b| isize::try_from(b).is_ok());
        let bytes = bytes.ok_or_else(|| Failure::new(Image, format!("{rows} rows of {row} bytes are too large")))?;
        let data: *const u8 = data.cast();
        // SAFETY: the caller's promise, and the sizes do not overflow.
        Ok(unsafe {
            if stride > 0 {
                Self { borrowed: from_raw_parts(data, bytes), copied: None, stride: apart }
            } else {
                let rows = (0..rows).flat_map(|y| from_raw_parts(data.offset(stride * y as isize), row));
                Self { borrowed: &[], copied: Some(rows.copied().collect()), stride: row }
            }
        })
    }

    fn bytes(&self) -> &[u8] {
        self.copied.as_deref().unwrap_or(self.borrowed)
    }
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

/// Bytes that [`Pixels::new`] copies of a picture of the right size: rows that are stored from the bottom up, and 16 bits to 8.
pub(crate) fn copied(image: &pcmvs_image, of: Calibrated) -> u64 {
    if [image.width, image.height] != of.size {
        return 0;
    }
    let [w, h] = of.size.map(u64::from);
    let plane = |bytes: u64, stride: isize| if stride < 0 { bytes } else { 0 };
    let at = FORMATS.get(image.format as usize).map_or(0, |&(_, pixel)| w * h * pixel as u64);
    let mut bytes = plane(at, image.stride);
    if image.format == pcmvs_pixel_format::Gray16 as u32 {
        bytes += w * h;
    }
    if image.format == pcmvs_pixel_format::Nv12 as u32 {
        bytes += plane(w.div_ceil(2) * 2 * h.div_ceil(2), image.chroma_stride);
    }
    bytes
}

/// Of each [`pcmvs_pixel_format`], the core's format and the bytes of a pixel in the first plane.
const FORMATS: [(PixelFormat, usize); 7] = [
    (PixelFormat::Gray8, 1),
    (PixelFormat::Rgb8, 3),
    (PixelFormat::Bgr8, 3),
    (PixelFormat::Rgba8, 4),
    (PixelFormat::Bgra8, 4),
    (PixelFormat::Nv12, 1),
    (PixelFormat::Gray8, 2),
];

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
        let Some(&(format, pixel)) = FORMATS.get(image.format as usize) else {
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
        // SAFETY: the caller's promise.
        let mut plane =
            unsafe { Plane::new(image.data, height, width * pixel, image.stride, &format!("{name}.data"))? };
        if image.format == pcmvs_pixel_format::Gray16 as u32 {
            let rows = plane.bytes().chunks(plane.stride).map(|row| &row[..2 * width]);
            let eight = |p: &[u8]| ((u32::from(u16::from_ne_bytes([p[0], p[1]])) * 255 + 32767) / 65535) as u8;
            let copied = rows.flat_map(|row| row.chunks_exact(2).map(eight)).collect();
            plane = Plane { borrowed: &[], copied: Some(copied), stride: width };
        }
        let chroma = if format == PixelFormat::Nv12 {
            let (rows, row) = (height.div_ceil(2), width.div_ceil(2) * 2);
            // SAFETY: the caller's promise.
            Some(unsafe { Plane::new(image.chroma, rows, row, image.chroma_stride, &format!("{name}.chroma"))? })
        } else {
            None
        };
        Ok(Self { width: image.width, height: image.height, format, plane, chroma })
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
