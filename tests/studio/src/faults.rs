//! Faults of real captures, each of which can be switched on by itself.

use crate::{
    blur::gaussian,
    contour,
    masks::{self, Spots},
    mosaic,
    noise::Random,
    picture::Picture,
    render::Render,
    rotation::turn,
};
use glam::{DMat3, DVec3};
use image::{ImageFormat, RgbImage, codecs::jpeg::JpegEncoder};
use pcmvs_core::Camera;

/// Faults of a capture. The default has none. Lens distortion is a property of the cameras, see [`crate::Ring`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Faults {
    /// Standard deviation of the sensor noise in 8-bit levels, independent per channel and per pixel of the sensor.
    pub noise: f64,
    /// The sensor reads one colour per pixel through a Bayer mosaic, with the noise, and the others are interpolated. See
    /// [`mosaic::demosaic`]. Pictures must have at least 2 x 2 pixels.
    pub mosaic: bool,
    /// Largest deviation of a camera's gain from 1. Each channel deviates by up to half of it in addition.
    pub gain: f64,
    /// Standard deviation in pixels of a Gaussian blur of the pictures, as of a lens out of focus. Masks stay sharp.
    pub blur: f64,
    /// Rotation of the given calibration against the true one, in pixels at the principal point.
    pub calibration: f64,
    /// Single cameras whose given calibration is turned in addition, by index, and by how many pixels right and down.
    pub bumped: Vec<(usize, [f64; 2])>,
    /// Largest difference of a camera's clock in seconds.
    pub clock: f64,
    /// Indices of cameras without masks.
    pub unmasked: Vec<usize>,
    /// Indices of cameras without pictures. Their pictures are empty in memory and have no file.
    pub missing: Vec<usize>,
    /// Makes masks black and white, up to this many pixels too wide, with jagged edges of that size. 0 is exact.
    pub coarse_masks: u32,
    /// Makes masks black and white instead of soft.
    pub binary_masks: bool,
    /// Distance in pixels by which the masks' contours lie outside the true ones, inside if negative.
    pub wider_masks: f64,
    /// Root mean square in pixels of smooth errors of the masks' contours, anew in every mask. See [`contour::displaced`].
    pub contour_error: f64,
    /// Holes in every mask.
    pub holes: Spots,
    /// Specks in the background of every mask.
    pub specks: Spots,
    /// Quality (1..=100) of the JPEG compression of the pictures.
    pub jpeg: Option<u8>,
    /// Seed of everything random.
    pub seed: u64,
}

/// Streams of random numbers, so that faults do not influence each other.
#[derive(Clone, Copy)]
enum Stream {
    Gain = 1,
    Noise,
    Calibration,
    Clock,
    Contours,
    Holes,
    Specks,
}

impl Faults {
    fn random(&self, stream: Stream, camera: usize, frame: usize) -> Random {
        Random::new(self.seed, ((stream as u64) << 48) | ((camera as u64) << 24) | frame as u64)
    }

    /// The given calibration of a camera.
    pub fn calibrated(&self, camera: &Camera, index: usize) -> Camera {
        let mut shift = [0.0; 2];
        if self.calibration != 0.0 {
            let (sine, cosine) =
                libm::sincos(core::f64::consts::PI * self.random(Stream::Calibration, index, 0).signed());
            shift = [self.calibration * cosine, self.calibration * sine];
        }
        for (_, [x, y]) in self.bumped.iter().filter(|(bumped, _)| *bumped == index) {
            shift = [shift[0] + x, shift[1] + y];
        }
        if shift == [0.0; 2] {
            return *camera;
        }
        let [x, y] = shift;
        let (fx, fy) = (camera.k[0][0], camera.k[1][1]);
        let by = turn(-libm::atan(y / fy), libm::atan(x / fx), 0.0);
        // Columns of the row-major array's matrix are its rows, so `turned` is Rᵀ · byᵀ with world directions as rows.
        let turned = DMat3::from_cols_array_2d(&camera.r) * by.transpose();
        Camera { r: turned.to_cols_array_2d(), t: (by * DVec3::from_array(camera.t)).to_array(), ..*camera }
    }

    /// Difference of a camera's clock in seconds.
    pub fn clock_of(&self, camera: usize) -> f64 {
        self.clock * self.random(Stream::Clock, camera, 0).signed()
    }

    /// Gain of each channel of a camera.
    pub fn gains_of(&self, camera: usize) -> [f64; 3] {
        let mut random = self.random(Stream::Gain, camera, 0);
        let all = 1.0 + self.gain * random.signed();
        [(); 3].map(|()| all * (1.0 + 0.5 * self.gain * random.signed()))
    }

    /// The picture that a sensor reads.
    pub fn picture(&self, render: &Render, width: u32, height: u32, camera: usize, frame: usize) -> Picture {
        if self.missing.contains(&camera) {
            return Picture::default();
        }
        let gains = self.gains_of(camera);
        let mut random = self.random(Stream::Noise, camera, frame);
        let mut noise = || if self.noise > 0.0 { self.noise * random.normal() } else { 0.0 };
        let sharp = &render.rgb;
        let blurred = if self.blur > 0.0 { &blur(sharp, width, height, self.blur) } else { sharp };
        let mut rgb = Vec::with_capacity(sharp.len() * 3);
        if self.mosaic {
            let mut samples = Vec::with_capacity(sharp.len());
            for (i, pixel) in blurred.iter().enumerate() {
                let channel = mosaic::channel(i % width as usize, i / width as usize);
                samples.push((255.0 * pixel[channel] * gains[channel] + noise()).clamp(0.0, 255.0));
            }
            rgb.extend(mosaic::demosaic(&samples, width, height).iter().flatten().map(|value| (value + 0.5) as u8));
        } else {
            for pixel in blurred {
                for (value, gain) in pixel.iter().zip(gains) {
                    rgb.push((255.0 * value * gain + noise() + 0.5).clamp(0.0, 255.0) as u8);
                }
            }
        }
        let picture = Picture { width, height, rgb };
        match self.jpeg {
            None => picture,
            Some(quality) => through_jpeg(&picture, quality),
        }
    }

    /// The mask of a picture, white on the subject. `coverage` is the exact share of each pixel that the subject covers.
    pub fn mask(&self, coverage: &[f64], width: u32, height: u32, camera: usize, frame: usize) -> Option<Vec<u8>> {
        if self.unmasked.contains(&camera) || self.missing.contains(&camera) {
            return None;
        }
        let displaced = (self.wider_masks != 0.0 || self.contour_error > 0.0).then(|| {
            let mut random = self.random(Stream::Contours, camera, frame);
            contour::displaced(coverage, width, height, self.wider_masks, self.contour_error, &mut random)
        });
        let coverage = displaced.as_deref().unwrap_or(coverage);
        let black_and_white = |v: &f64| if *v >= 0.5 { 255 } else { 0 };
        let mut mask = if self.coarse_masks > 0 {
            let exact: Vec<u8> = coverage.iter().map(black_and_white).collect();
            masks::coarse(&exact, width, height, self.coarse_masks)
        } else if self.binary_masks {
            coverage.iter().map(black_and_white).collect()
        } else {
            coverage.iter().map(|v| (255.0 * v + 0.5) as u8).collect()
        };
        if self.holes.count > 0 {
            masks::punch_holes(&mut mask, width, self.holes, &mut self.random(Stream::Holes, camera, frame));
        }
        if self.specks.count > 0 {
            masks::add_specks(&mut mask, width, self.specks, &mut self.random(Stream::Specks, camera, frame));
        }
        Some(mask)
    }
}

fn blur(rgb: &[[f64; 3]], width: u32, height: u32, sigma: f64) -> Vec<[f64; 3]> {
    let plane = |c: usize| gaussian(&rgb.iter().map(|p| p[c]).collect::<Vec<_>>(), width, height, sigma);
    let [red, green, blue] = [0, 1, 2].map(plane);
    (0..rgb.len()).map(|i| [red[i], green[i], blue[i]]).collect()
}

fn through_jpeg(picture: &Picture, quality: u8) -> Picture {
    let mut bytes = Vec::new();
    let image = RgbImage::from_raw(picture.width, picture.height, picture.rgb.clone()).expect("sizes agree");
    image.write_with_encoder(JpegEncoder::new_with_quality(&mut bytes, quality)).expect("memory can be written");
    let back = image::load_from_memory_with_format(&bytes, ImageFormat::Jpeg).expect("it was just encoded");
    Picture { rgb: back.into_rgb8().into_raw(), ..*picture }
}
