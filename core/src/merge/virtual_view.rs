//! The viewpoints from which conflicts are detected (§5.2): the cameras, and virtual cameras on the sphere through
//! them.

use crate::{
    camera::{Camera, Pinhole},
    lens::Lens,
};
use alloc::vec::Vec;
use glam::{DVec3, Vec3};

/// A real or virtual camera without a picture. It only determines which points project to the same pixel.
pub struct Viewpoint {
    /// The camera.
    pub camera: Pinhole,
}

impl Viewpoint {
    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.camera.width as usize * self.camera.height as usize
    }

    /// Index of the pixel that a point projects to, or `None` outside the picture.
    pub fn pixel(&self, p: Vec3) -> Option<usize> {
        self.camera.pixel(p).map(|(pixel, _)| pixel)
    }
}

/// `count` virtual cameras, evenly distributed on the sphere of radius `distance` around `target`. Each sees a ball of
/// `radius` around the target, with pixels of size `footprint` there. Lengths are in scene units.
pub fn virtual_views(count: u32, target: Vec3, distance: f32, radius: f32, footprint: f32) -> Vec<Viewpoint> {
    let focal = f64::from(distance / footprint);
    let size = (2.2 * radius / footprint) as u32 + 1;
    (0..count)
        .map(|i| {
            // Fibonacci lattice: successive points turn by the golden angle, which is even over the sphere for any
            // count (González, Measurement of Areas on a Sphere Using Fibonacci and Latitude-Longitude Lattices, 2010).
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
            let (sin, cos) = libm::sincos(f64::from(i) * 2.399_963_229_728_653);
            let across = libm::sqrt(1.0 - z * z);
            let toward = DVec3::new(across * cos, across * sin, z);
            let forward = -toward;
            let helper = if forward.z.abs() < 0.9 { DVec3::Z } else { DVec3::X };
            let right = forward.cross(helper).normalize();
            let down = forward.cross(right);
            let centre = target.as_dvec3() + toward * f64::from(distance);
            let camera = Camera {
                width: size,
                height: size,
                k: [[focal, 0.0, 0.5 * f64::from(size)], [0.0, focal, 0.5 * f64::from(size)], [0.0, 0.0, 1.0]],
                lens: Lens::NONE,
                r: [right.to_array(), down.to_array(), forward.to_array()],
                t: [-right.dot(centre), -down.dot(centre), -forward.dot(centre)],
            };
            Viewpoint { camera: Pinhole::new(&camera, DVec3::ZERO) }
        })
        .collect()
}
