//! A camera whose calibration is being adjusted, in double precision and relative to the rig's origin.

use crate::{
    camera::{Camera, Pinhole, matrix},
    lens::Lens,
};
use glam::{DMat2, DMat3, DVec2, DVec3};

/// Parameters per camera: turn about its own x, y and z axes (radians), shift along them (scene units), logarithm of the
/// change of its focal length, and shift of its principal point (pixels).
pub(super) const PARAMETERS: usize = 9;
/// Index of the first parameter of the shift.
pub(super) const SHIFT: usize = 3;
/// Index of the focal length's parameter.
pub(super) const FOCAL: usize = 6;

/// One camera: `x = K · distort(R X + t)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Model {
    given: Camera,
    r: DMat3,
    t: DVec3,
    k: [[f64; 3]; 3],
}

/// A projected point and its derivatives.
pub(super) struct Projection {
    pub(super) pixel: DVec2,
    /// Derivative by each parameter of the camera.
    pub(super) by_camera: [DVec2; PARAMETERS],
    /// Derivative by each coordinate of the point.
    pub(super) by_point: [DVec2; 3],
}

/// The rotation by a vector's length about its direction (Rodrigues' formula).
pub(super) fn rotation(by: DVec3) -> DMat3 {
    let angle = by.length();
    if angle < 1e-300 {
        return DMat3::IDENTITY;
    }
    let a = by / angle;
    let (sine, cosine) = libm::sincos(angle);
    let cross = DMat3::from_cols(DVec3::new(0.0, a.z, -a.y), DVec3::new(-a.z, 0.0, a.x), DVec3::new(a.y, -a.x, 0.0));
    DMat3::IDENTITY + cross * sine + cross * cross * (1.0 - cosine)
}

/// The inverse of [`rotation`], for angles below a half turn.
pub(super) fn rotation_vector(r: &DMat3) -> DVec3 {
    let twice_sine = DVec3::new(r.y_axis.z - r.z_axis.y, r.z_axis.x - r.x_axis.z, r.x_axis.y - r.y_axis.x);
    let (sine, cosine) = (0.5 * twice_sine.length(), 0.5 * (r.x_axis.x + r.y_axis.y + r.z_axis.z - 1.0));
    let angle = libm::atan2(sine, cosine);
    twice_sine * if sine > 1e-12 { 0.5 * angle / sine } else { 0.5 }
}

impl Model {
    /// The camera as it is given.
    pub(super) fn new(given: &Camera, origin: DVec3) -> Self {
        let r = matrix(&given.r);
        Self { given: *given, r, t: r * origin + DVec3::from_array(given.t), k: given.k }
    }

    /// The camera in world coordinates.
    pub(super) fn camera(&self, origin: DVec3) -> Camera {
        let t = self.t - self.r * origin;
        Camera { k: self.k, r: self.r.transpose().to_cols_array_2d(), t: t.to_array(), ..self.given }
    }

    /// The camera of the undistorted picture, which was made with the given focal length and principal point.
    pub(super) fn pinhole(&self) -> Pinhole {
        Pinhole::new(&Camera { k: self.given.k, ..self.camera(DVec3::ZERO) }, DVec3::ZERO)
    }

    /// The same camera with its parameters changed by `step`.
    pub(super) fn moved(&self, step: &[f64; PARAMETERS]) -> Self {
        let turn = rotation(DVec3::new(step[0], step[1], step[2]));
        let zoom = libm::exp(step[FOCAL]);
        let mut k = self.k;
        k[0][0] *= zoom;
        k[0][1] *= zoom;
        k[1][1] *= zoom;
        k[0][2] += step[FOCAL + 1];
        k[1][2] += step[FOCAL + 2];
        let t = turn * self.t + DVec3::new(step[SHIFT], step[SHIFT + 1], step[SHIFT + 2]);
        Self { r: turn * self.r, t, k, ..*self }
    }

    /// The same camera with its lens's first radial coefficient changed.
    pub(super) fn distorted(&self, by: f64) -> Self {
        let mut given = self.given;
        match &mut given.lens {
            Lens::OpenCv([k1, ..]) | Lens::Fisheye([k1, ..]) => *k1 += by,
        }
        Self { given, ..*self }
    }

    /// How far the parameters are from those of another model of the same camera. The shift is that of the centre.
    pub(super) fn deviation(&self, from: &Self) -> [f64; PARAMETERS] {
        let turn = rotation_vector(&(self.r * from.r.transpose()));
        let shift = from.r * (from.centre() - self.centre());
        let zoom = libm::log(self.k[0][0] / from.k[0][0]);
        let principal = [self.k[0][2] - from.k[0][2], self.k[1][2] - from.k[1][2]];
        [turn.x, turn.y, turn.z, shift.x, shift.y, shift.z, zoom, principal[0], principal[1]]
    }

    /// Centre of projection.
    pub(super) fn centre(&self) -> DVec3 {
        -(self.r.transpose() * self.t)
    }

    /// Width of the picture in pixels.
    pub(super) fn width(&self) -> f64 {
        f64::from(self.given.width)
    }

    /// Mean focal length in pixels.
    pub(super) fn focal(&self) -> f64 {
        libm::sqrt(self.k[0][0] * self.k[1][1])
    }

    /// Pixel of the real picture that shows a point, or `None` if the point is behind the camera.
    pub(super) fn project(&self, point: DVec3) -> Option<DVec2> {
        let c = self.r * point + self.t;
        if !(c.z > 0.0) {
            return None;
        }
        Some(self.pixel_of(self.given.lens.distort(DVec2::new(c.x / c.z, c.y / c.z))))
    }

    fn pixel_of(&self, p: DVec2) -> DVec2 {
        let k = &self.k;
        DVec2::new(k[0][0] * p.x + k[0][1] * p.y + k[0][2], k[1][1] * p.y + k[1][2])
    }

    /// [`Self::project`] with its derivatives.
    pub(super) fn linearise(&self, point: DVec3) -> Option<Projection> {
        let c = self.r * point + self.t;
        if !(c.z > 0.0) {
            return None;
        }
        let (x, y) = (c.x / c.z, c.y / c.z);
        let k = &self.k;
        let real = self.given.lens.distort(DVec2::new(x, y));
        let lens = self.given.lens.derivative(DVec2::new(x, y));
        let to_pixel = DMat2::from_cols(DVec2::new(k[0][0], 0.0), DVec2::new(k[0][1], k[1][1])) * lens;
        let (along_x, along_y) = (to_pixel.x_axis / c.z, to_pixel.y_axis / c.z);
        let along_z = -(along_x * x + along_y * y);
        let by = |v: DVec3| along_x * v.x + along_y * v.y + along_z * v.z;
        let zoom = DVec2::new(k[0][0] * real.x + k[0][1] * real.y, k[1][1] * real.y);
        Some(Projection {
            pixel: self.pixel_of(real),
            by_camera: [
                by(DVec3::X.cross(c)),
                by(DVec3::Y.cross(c)),
                by(DVec3::Z.cross(c)),
                along_x,
                along_y,
                along_z,
                zoom,
                DVec2::X,
                DVec2::Y,
            ],
            by_point: [by(self.r.x_axis), by(self.r.y_axis), by(self.r.z_axis)],
        })
    }

    /// Normalised position, without distortion, of a pixel of the real picture.
    pub(super) fn normalise(&self, pixel: DVec2) -> DVec2 {
        let k = &self.k;
        let y = (pixel.y - k[1][2]) / k[1][1];
        self.given.lens.undistort(DVec2::new((pixel.x - k[0][2] - k[0][1] * y) / k[0][0], y))
    }

    /// Normalised position of an ideal pixel, which is a pixel of the undistorted picture. Undistorted pictures are made
    /// with the given calibration.
    fn normalise_ideal(&self, pixel: DVec2) -> DVec2 {
        self.normalise(self.real_of_ideal(pixel))
    }

    /// Pixel of the real picture that an ideal pixel was resampled from.
    pub(super) fn real_of_ideal(&self, pixel: DVec2) -> DVec2 {
        if self.given.lens.is_distorted() { self.given.distort_pixel(pixel) } else { pixel }
    }

    /// Direction of an ideal pixel's ray in the rig's axes, of unit depth.
    pub(super) fn ray_of_ideal(&self, pixel: DVec2) -> DVec3 {
        self.r.transpose() * self.normalise_ideal(pixel).extend(1.0)
    }

    /// Direction of a pixel's ray in the rig's axes, of unit depth.
    pub(super) fn ray(&self, pixel: DVec2) -> DVec3 {
        self.r.transpose() * self.normalise(pixel).extend(1.0)
    }

    /// Distance in pixels of a pixel of this camera from the epipolar line of a ray from another centre.
    pub(super) fn epipolar_distance(&self, pixel: DVec2, from: DVec3, ray: DVec3) -> f64 {
        self.distance_from_plane(self.normalise(pixel), from, ray)
    }

    /// [`Self::epipolar_distance`] of an ideal pixel.
    pub(super) fn ideal_epipolar_distance(&self, pixel: DVec2, from: DVec3, ray: DVec3) -> f64 {
        self.distance_from_plane(self.normalise_ideal(pixel), from, ray)
    }

    fn distance_from_plane(&self, normalised: DVec2, from: DVec3, ray: DVec3) -> f64 {
        let line = self.r * (from - self.centre()).cross(ray);
        let across = libm::sqrt(line.x * line.x + line.y * line.y);
        self.focal() * line.dot(normalised.extend(1.0)) / across
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::camera;
    use glam::Vec3;

    /// The same camera with each kind of lens.
    fn distorted() -> [Model; 3] {
        let lenses = [
            Lens::brown([-0.21, 0.08, 0.002, -0.001, 0.01]),
            Lens::OpenCv([-0.1, 0.03, 0.002, 0.001, -0.004, 0.05, -0.02, 0.003, 0.004, -0.002, -0.003, 0.001]),
            Lens::Fisheye([-0.03, 0.02, -0.01, 0.003]),
        ];
        lenses.map(|lens| {
            let camera = camera(Vec3::new(3.0, -2.0, 1.0), Vec3::new(0.1, 0.2, 0.0), 640, 800.0);
            Model::new(&Camera { lens, ..camera }, DVec3::new(0.3, 0.1, -0.2))
        })
    }

    #[test]
    fn derivatives_are_those_of_the_projection() {
        distorted().into_iter().for_each(check_derivatives);
    }

    fn check_derivatives(model: Model) {
        let point = DVec3::new(0.2, 0.4, 0.3);
        let at = model.linearise(point).unwrap();
        assert_eq!(Some(at.pixel), model.project(point));
        let h = 1e-6;
        for k in 0..PARAMETERS {
            let moved = |by: f64| {
                let mut step = [0.0; PARAMETERS];
                step[k] = by;
                model.moved(&step).project(point).unwrap()
            };
            let slope = (moved(h) - moved(-h)) / (2.0 * h);
            assert!((slope - at.by_camera[k]).length() < 1e-4 * (1.0 + slope.length()), "parameter {k}");
        }
        for (k, axis) in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().enumerate() {
            let moved = |by: f64| model.project(point + axis * by).unwrap();
            let slope = (moved(h) - moved(-h)) / (2.0 * h);
            assert!((slope - at.by_point[k]).length() < 1e-4 * (1.0 + slope.length()), "coordinate {k}");
        }
    }

    #[test]
    fn deviations_are_the_steps_that_were_made() {
        let [model, ..] = distorted();
        let turned = model.moved(&[0.01, -0.02, 0.03, 0.0, 0.0, 0.0, 0.004, 1.0, -2.0]).deviation(&model);
        for (found, made) in turned.into_iter().zip([0.01, -0.02, 0.03, 0.0, 0.0, 0.0, 0.004, 1.0, -2.0]) {
            assert!((found - made).abs() < 1e-12);
        }
        let shifted = model.moved(&[0.0, 0.0, 0.0, 0.1, 0.2, -0.3, 0.0, 0.0, 0.0]).deviation(&model);
        for (found, made) in shifted.into_iter().zip([0.0, 0.0, 0.0, 0.1, 0.2, -0.3, 0.0, 0.0, 0.0]) {
            assert!((found - made).abs() < 1e-12);
        }
    }

    #[test]
    fn rays_lead_back_to_their_pixels() {
        for model in distorted() {
            let pixel = DVec2::new(81.5, 500.25);
            let point = model.centre() + model.ray(pixel) * 3.0;
            assert!((model.project(point).unwrap() - pixel).length() < 1e-9);
            let other = Model::new(&camera(Vec3::new(-2.0, -3.0, 0.5), Vec3::ZERO, 640, 800.0), DVec3::ZERO);
            let seen = other.project(point).unwrap();
            assert!(other.epipolar_distance(seen, model.centre(), model.ray(pixel)).abs() < 1e-6);
        }
    }

    #[test]
    fn the_given_camera_comes_back_in_world_coordinates() {
        let origin = DVec3::new(0.3, 0.1, -0.2);
        for model in distorted() {
            let camera = model.camera(origin);
            let world = DVec3::new(0.5, 0.4, 0.1);
            let (pixel, _) = camera.project(world).unwrap();
            assert!((model.project(world - origin).unwrap() - pixel).length() < 1e-9);
            // Adjusting a camera leaves its lens alone.
            let moved = model.moved(&[0.01, -0.02, 0.03, 0.1, 0.0, 0.0, 0.004, 1.0, -2.0]).camera(origin);
            assert_eq!(moved.lens, camera.lens);
            assert_ne!(moved.k, camera.k);
        }
    }
}
