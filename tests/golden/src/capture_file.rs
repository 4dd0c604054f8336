//! A capture in one file, so that all machines read the same numbers.

use pcmvs_core::{Camera, ImageRef, Lens, Mask, PixelFormat, ViewInput};

/// One frame: calibration, picture and mask of every camera.
#[derive(Debug, Clone, PartialEq)]
pub struct CaptureFile {
    /// Calibration.
    pub cameras: Vec<Camera>,
    /// Packed sRGB pictures, one per camera.
    pub pictures: Vec<Vec<u8>>,
    /// Masks, one per camera, white on the subject.
    pub masks: Vec<Vec<u8>>,
}

impl CaptureFile {
    /// Pictures and masks as the core takes them.
    pub fn inputs(&self) -> Vec<ViewInput<'_>> {
        let input = |(i, camera): (usize, &Camera)| ViewInput {
            image: ImageRef::packed(&self.pictures[i], camera.width, camera.height, PixelFormat::Rgb8),
            mask: Mask::Given(ImageRef::packed(&self.masks[i], camera.width, camera.height, PixelFormat::Gray8)),
        };
        self.cameras.iter().enumerate().map(input).collect()
    }

    /// The bytes of the file: each camera with its picture and mask, little-endian.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        for (i, camera) in self.cameras.iter().enumerate() {
            for size in [camera.width, camera.height] {
                bytes.extend(size.to_le_bytes());
            }
            let numbers =
                camera.k.iter().flatten().chain(&camera.lens.coefficients()[..5]).chain(camera.r.iter().flatten());
            for number in numbers.chain(&camera.t) {
                bytes.extend(number.to_le_bytes());
            }
            bytes.extend(&self.pictures[i]);
            bytes.extend(&self.masks[i]);
        }
        bytes
    }

    /// Reads the bytes of [`Self::to_bytes`]; `None` if they are truncated.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let mut rest = Rest(bytes);
        let mut capture = Self { cameras: Vec::new(), pictures: Vec::new(), masks: Vec::new() };
        while !rest.0.is_empty() {
            let [width, height] = [rest.size()?, rest.size()?];
            let camera = Camera {
                width,
                height,
                k: [rest.numbers()?, rest.numbers()?, rest.numbers()?],
                lens: Lens::brown(rest.numbers()?),
                r: [rest.numbers()?, rest.numbers()?, rest.numbers()?],
                t: rest.numbers()?,
            };
            let pixels = (width * height) as usize;
            capture.pictures.push(rest.take(3 * pixels)?.to_vec());
            capture.masks.push(rest.take(pixels)?.to_vec());
            capture.cameras.push(camera);
        }
        Some(capture)
    }
}

/// The bytes that are not yet read.
struct Rest<'a>(&'a [u8]);

impl Rest<'_> {
    fn take(&mut self, count: usize) -> Option<&[u8]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    fn size(&mut self) -> Option<u32> {
        self.take(4)?.try_into().ok().map(u32::from_le_bytes)
    }

    fn numbers<const N: usize>(&mut self) -> Option<[f64; N]> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = f64::from_le_bytes(self.take(8)?.try_into().ok()?);
        }
        Some(numbers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_reads_back() {
        let camera = Camera {
            width: 2,
            height: 1,
            k: [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]],
            lens: Lens::brown([0.1, 0.2, 0.3, 0.4, 0.5]),
            r: [[-1.0, -2.0, -3.0], [-4.0, -5.0, -6.0], [-7.0, -8.0, -9.0]],
            t: [f64::MIN_POSITIVE, 1.0 / 3.0, 1e300],
        };
        let pictures = vec![vec![1, 2, 3, 4, 5, 6], vec![6, 5, 4, 3, 2, 1]];
        let capture = CaptureFile { cameras: vec![camera; 2], pictures, masks: vec![vec![0, 255], vec![255, 0]] };
        let bytes = capture.to_bytes();
        assert_eq!(CaptureFile::from_bytes(&bytes), Some(capture));
        assert_eq!(CaptureFile::from_bytes(&bytes[..bytes.len() - 1]), None);
    }
}
