//! Cameras around the zero of the scene.
#![allow(clippy::disallowed_methods, reason = "no result depends on the targets' own numbers")]

use pcmvs_core::{Camera, Lens};

/// `count` cameras at a distance of 3 that look at the zero, with pictures of `size` x `size` pixels.
pub fn ring(count: u32, size: u32) -> Vec<Camera> {
    let camera = |i: u32| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(count)).sin_cos();
        let (focal, middle) = (1.5 * f64::from(size), 0.5 * f64::from(size - 1));
        // Looks along -(cos, sin, 0), with z of the scene upwards.
        let r = [[-sin, cos, 0.0], [0.0, 0.0, -1.0], [-cos, -sin, 0.0]];
        let k = [[focal, 0.0, middle], [0.0, focal, middle], [0.0, 0.0, 1.0]];
        Camera { width: size, height: size, k, lens: Lens::NONE, r, t: [0.0, 0.0, 3.0] }
    };
    (0..count).map(camera).collect()
}
