//! Parts of solids: a shape in a local frame, with relief and material.

use crate::{
    material::Material,
    noise::{self, STEEPEST},
};
use glam::{DMat3, DVec3};

/// A shape in its own frame, with an exact signed distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// A ball around the origin.
    Ball {
        /// Radius.
        radius: f64,
    },
    /// A box around the origin.
    Cuboid {
        /// Half its sides.
        half: DVec3,
    },
    /// A torus around the z axis.
    Torus {
        /// Radius of the centre line.
        major: f64,
        /// Radius of the tube.
        minor: f64,
    },
    /// The convex hull of two balls, one at the origin and one at (0, 0, -length).
    RoundCone(RoundCone),
}

/// The convex hull of a ball at the origin and one at (0, 0, -length).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoundCone {
    length: f64,
    top: f64,
    bottom: f64,
    /// Sine and cosine of the angle by which the normal of the flank leans towards the narrower end.
    sine: f64,
    cosine: f64,
}

impl RoundCone {
    /// From the distance of the centres, and the radii at the origin and at the other end. The distance must be larger than
    /// the difference of the radii.
    pub fn new(length: f64, top: f64, bottom: f64) -> Self {
        assert!(libm::fabs(top - bottom) < length, "one ball contains the other: {top}, {bottom}, {length}");
        let sine = (top - bottom) / length;
        Self { length, top, bottom, sine, cosine: libm::sqrt(1.0 - sine * sine) }
    }

    fn distance(&self, p: DVec3) -> f64 {
        // The flank is a straight line in the half plane of radius and depth.
        let (r, z) = (libm::sqrt(p.x * p.x + p.y * p.y), -p.z);
        let along = self.cosine * z - self.sine * r;
        if along < 0.0 {
            libm::sqrt(r * r + z * z) - self.top
        } else if along > self.cosine * self.length {
            let z = z - self.length;
            libm::sqrt(r * r + z * z) - self.bottom
        } else {
            self.cosine * r + self.sine * z - self.top
        }
    }
}

impl Shape {
    fn distance(&self, p: DVec3) -> f64 {
        match *self {
            Self::Ball { radius } => p.length() - radius,
            Self::Cuboid { half } => {
                let q = p.abs() - half;
                q.max(DVec3::ZERO).length() + q.max_element().min(0.0)
            }
            Self::Torus { major, minor } => {
                let ring = libm::sqrt(p.x * p.x + p.y * p.y) - major;
                libm::sqrt(ring * ring + p.z * p.z) - minor
            }
            Self::RoundCone(cone) => cone.distance(p),
        }
    }

    /// Centre and radius of a ball around it.
    fn ball(&self) -> (DVec3, f64) {
        match *self {
            Self::Ball { radius } => (DVec3::ZERO, radius),
            Self::Cuboid { half } => (DVec3::ZERO, half.length()),
            Self::Torus { major, minor } => (DVec3::ZERO, major + minor),
            Self::RoundCone(RoundCone { length, top, bottom, .. }) => {
                let radius = 0.5 * (length + top + bottom);
                (DVec3::new(0.0, 0.0, top - radius), radius)
            }
        }
    }
}

/// A position and orientation: local to world is `rotation · p + origin`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Local to world.
    pub rotation: DMat3,
    /// The local origin in the world.
    pub origin: DVec3,
}

impl Pose {
    /// The axes of the world at a point.
    pub fn at(origin: DVec3) -> Self {
        Self { rotation: DMat3::IDENTITY, origin }
    }

    /// A pose given relative to this one.
    pub fn then(&self, offset: DVec3, rotation: DMat3) -> Self {
        Self { rotation: self.rotation * rotation, origin: self.to_world(offset) }
    }

    /// World position of a local point.
    pub fn to_world(&self, p: DVec3) -> DVec3 {
        self.rotation * p + self.origin
    }

    /// Local position of a world point.
    pub fn to_local(&self, p: DVec3) -> DVec3 {
        let d = p - self.origin;
        DVec3::new(self.rotation.x_axis.dot(d), self.rotation.y_axis.dot(d), self.rotation.z_axis.dot(d))
    }
}

/// Folds: smooth noise that displaces the surface along its normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relief {
    /// Largest displacement, outward or inward.
    pub height: f64,
    /// Folds per metre along the local axes.
    pub density: DVec3,
    /// Lipschitz constant of a distance that has this relief.
    slope: f64,
}

impl Relief {
    /// Folds of a height, with a size along each local axis.
    pub fn new(height: f64, size: DVec3) -> Self {
        let density = DVec3::ONE / size;
        Self { height, density, slope: 1.0 + height * STEEPEST * density.length() }
    }
}

/// A shape with a material that moves with it.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    shape: Shape,
    frame: Pose,
    /// The frame of the colours.
    cloth: Pose,
    scale: DVec3,
    /// Distance over which it blends with the parts before it. 0 is a plain union.
    pub blend: f64,
    relief: Option<Relief>,
    /// Material.
    pub material: Material,
    seed: u32,
    /// Centre of a bounding ball.
    pub centre: DVec3,
    /// Radius of the bounding ball.
    pub radius: f64,
}

impl Part {
    /// A rigid body.
    pub fn new(shape: Shape, frame: Pose, material: Material) -> Self {
        let (scale, centre) = (DVec3::ONE, frame.origin);
        let part = Self {
            shape,
            frame,
            cloth: frame,
            scale,
            blend: 0.0,
            relief: None,
            material,
            seed: 0,
            centre,
            radius: 0.0,
        };
        part.bounded()
    }

    /// A point of the world in the frame that moves with the part.
    pub fn to_local(&self, p: DVec3) -> DVec3 {
        self.frame.to_local(p)
    }

    /// A point of the frame that moves with the part in the world.
    pub fn to_world(&self, p: DVec3) -> DVec3 {
        self.frame.to_world(p)
    }

    fn bounded(mut self) -> Self {
        let (centre, radius) = self.shape.ball();
        self.centre = self.frame.to_world(centre * self.scale);
        self.radius = radius * self.scale.max_element() + self.relief.map_or(0.0, |r| r.height);
        self
    }

    /// Stretches the shape along its local axes.
    pub fn scaled(mut self, x: f64, y: f64, z: f64) -> Self {
        self.scale = DVec3::new(x, y, z);
        self.bounded()
    }

    /// Blends with the parts before it over a distance.
    pub fn blended(mut self, distance: f64) -> Self {
        self.blend = distance;
        self
    }

    /// Adds folds.
    pub fn folded(mut self, height: f64, size: DVec3) -> Self {
        self.relief = Some(Relief::new(height, size));
        self.bounded()
    }

    /// Uses another frame for its colours, so that the texture continues over neighbouring parts.
    pub fn cut_from(mut self, cloth: &Pose) -> Self {
        self.cloth = *cloth;
        self
    }

    /// Chooses another pattern for folds and texture.
    pub fn seeded(mut self, seed: u32) -> Self {
        self.seed = seed;
        self
    }

    /// Whether [`Self::bound`] is the exact distance.
    pub fn is_exact(&self) -> bool {
        self.scale == DVec3::ONE && self.relief.is_none() && self.blend == 0.0
    }

    /// A function with slope at most 1 that is zero on the surface and negative inside. `to_centre` is the distance of the
    /// point from the centre of the bounding ball.
    #[inline]
    pub fn bound(&self, p: DVec3, to_centre: f64) -> f64 {
        let local = self.frame.to_local(p);
        let plain = if self.scale == DVec3::ONE {
            self.shape.distance(local)
        } else {
            self.shape.distance(local / self.scale) * self.scale.min_element()
        };
        let rough = match &self.relief {
            None => plain,
            // Both branches have slope at most 1. Far from the folds the first is larger, and the noise is not needed.
            Some(relief) => {
                let slope = relief.slope;
                let outer = plain - relief.height;
                if outer * slope >= plain + relief.height {
                    outer
                } else {
                    let fold = noise::value(local * relief.density, self.seed);
                    outer.max((plain - relief.height * fold) / slope)
                }
            }
        };
        if self.is_exact() { rough } else { rough.max(to_centre - self.radius) }
    }

    /// Colour of a surface point, display values in 0..1.
    pub fn colour(&self, p: DVec3) -> [f64; 3] {
        self.material.colour(self.cloth.to_local(p), self.seed)
    }
}
