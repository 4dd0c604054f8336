//! A capture: cameras, and the pictures and masks of every frame.

use crate::{faults::Faults, picture::Picture, render::render, solid::Solid, subject::Subject};
use pcmvs_core::{Camera, ImageRef, PixelFormat};

/// What all cameras recorded at one instant, in the order of the cameras.
#[derive(Debug, Clone)]
pub struct CapturedFrame {
    /// Time in seconds.
    pub time: f64,
    /// One picture per camera.
    pub images: Vec<Picture>,
    /// One mask per camera, of the size of its picture, 255 on the subject; `None` for a camera without a mask.
    pub masks: Vec<Option<Vec<u8>>>,
    /// The ground truth.
    pub truth: Solid,
}

impl CapturedFrame {
    /// A camera's mask as the core takes it.
    pub fn mask(&self, camera: usize) -> Option<ImageRef<'_>> {
        let Picture { width, height, .. } = self.images[camera];
        self.masks[camera].as_ref().map(|m| ImageRef::packed(m, width, height, PixelFormat::Gray8))
    }

    /// Gives exact masks the faults that they would have if this had been recorded with them as frame number `frame`.
    pub fn spoil_masks(&mut self, faults: &Faults, frame: usize) {
        for (camera, (mask, picture)) in self.masks.iter_mut().zip(&self.images).enumerate() {
            if let Some(exact) = mask {
                let coverage: Vec<f64> = exact.iter().map(|v| f64::from(*v) / 255.0).collect();
                *mask = faults.mask(&coverage, picture.width, picture.height, camera, frame);
            }
        }
    }

    /// Exchanges what two cameras recorded.
    pub fn exchange(&mut self, a: usize, b: usize) {
        self.images.swap(a, b);
        self.masks.swap(a, b);
    }

    /// Replaces what a camera recorded by what it records of the subject at another time in seconds, without faults.
    /// `truth` is its true calibration. The frame's ground truth stays.
    pub fn retake(&mut self, camera: usize, truth: &Camera, subject: Subject, time: f64) {
        let mut other = record(subject, &[*truth], 0, time, &Faults::default());
        self.images[camera] = other.images.remove(0);
        self.masks[camera] = other.masks.remove(0);
    }
}

/// The recording of a dome, with its ground truth.
#[derive(Debug, Clone)]
pub struct Capture {
    /// The given calibration, with the errors of [`Faults::calibration`] and [`Faults::bumped`].
    pub cameras: Vec<Camera>,
    /// The true calibration.
    pub true_cameras: Vec<Camera>,
    /// Names of the cameras.
    pub names: Vec<String>,
    /// Recorded frames.
    pub frames: Vec<CapturedFrame>,
}

impl Capture {
    /// A capture without frames.
    pub fn empty(cameras: &[Camera], faults: &Faults) -> Self {
        Self {
            cameras: cameras.iter().enumerate().map(|(i, c)| faults.calibrated(c, i)).collect(),
            true_cameras: cameras.to_vec(),
            names: (0..cameras.len()).map(|i| format!("cam{i:02}")).collect(),
            frames: Vec::new(),
        }
    }

    /// Records a subject at the given times in seconds.
    pub fn new(subject: Subject, cameras: &[Camera], times: &[f64], faults: &Faults) -> Self {
        let mut capture = Self::empty(cameras, faults);
        for (i, &time) in times.iter().enumerate() {
            capture.frames.push(record(subject, cameras, i, time, faults));
        }
        capture
    }

    /// Records a subject once, at time 0.
    pub fn still(subject: Subject, cameras: &[Camera], faults: &Faults) -> Self {
        Self::new(subject, cameras, &[0.0], faults)
    }
}

/// Records one frame. `cameras` are the true ones.
pub fn record(subject: Subject, cameras: &[Camera], frame: usize, time: f64, faults: &Faults) -> CapturedFrame {
    let mut out = CapturedFrame { time, images: Vec::new(), masks: Vec::new(), truth: subject.at(time) };
    for (i, camera) in cameras.iter().enumerate() {
        let picture = render(&subject.at(time + faults.clock_of(i)), camera);
        out.images.push(faults.picture(&picture, camera.width, camera.height, i, frame));
        out.masks.push(faults.mask(&picture.coverage, camera.width, camera.height, i, frame));
    }
    out
}
