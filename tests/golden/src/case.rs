//! The captures, rendered by the studio.

use crate::CaptureFile;
use studio::{Capture, Faults, Ring, Subject};

/// A capture and how it is reconstructed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// Its name in `golden.txt`.
    pub name: &'static str,
    /// Name of the preset.
    pub preset: &'static str,
    /// Cameras on the ring.
    pub views: u32,
    /// Width and height of the pictures in pixels.
    pub size: (u32, u32),
}

/// Small enough for emulators.
pub const SMALL: [Case; 2] = [
    Case { name: "small", preset: "default", views: 10, size: (128, 96) },
    Case { name: "small-paper", preset: "paper", views: 10, size: (128, 96) },
];

/// As large as real captures.
pub const LARGE: Case = Case { name: "large", preset: "default", views: 20, size: (1024, 768) };

impl Case {
    /// Renders the figure with faults of real captures: lens distortion, noise and different gains.
    pub fn render(&self) -> CaptureFile {
        let ring = Ring { count: self.views, distortion: [-0.1, 0.05, 0.001, -0.001, 0.0], ..Ring::default() };
        let faults = Faults { noise: 1.5, gain: 0.04, ..Faults::default() };
        let mut capture = Capture::still(Subject::Figure, &ring.sized(self.size.0, self.size.1).cameras(), &faults);
        let frame = capture.frames.remove(0);
        CaptureFile {
            cameras: capture.cameras,
            pictures: frame.images.into_iter().map(|picture| picture.rgb).collect(),
            masks: frame.masks.into_iter().flatten().collect(),
        }
    }
}
