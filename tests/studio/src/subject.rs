//! The subjects of the studio.

use crate::{
    figure,
    material::Material,
    part::{Part, Pose, Shape},
    rotation::turn,
    solid::Solid,
};
use glam::{DMat3, DVec3};

/// A subject in the dome.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Subject {
    /// A ball of radius 0.45 m.
    Sphere,
    /// A rotated box of 0.7 x 0.5 x 0.6 m.
    Box,
    /// A leaning torus with radii of 0.42 m and 0.15 m.
    Torus,
    /// A ball and a box that occlude each other from most sides.
    TwoBodies,
    /// A plate, 12 mm thick.
    Plate,
    /// A clothed, dancing person.
    Figure,
    /// The same person on legs that are at rest: trunk, head and arms dance.
    Standing,
}

impl Subject {
    /// The solid at a time in seconds.
    pub fn at(self, time: f64) -> Solid {
        let middle = DVec3::new(0.0, 0.0, 0.9);
        let ball = |c: DVec3, radius: f64| Part::new(Shape::Ball { radius }, Pose::at(c), Material::Stone);
        let cuboid = |c: DVec3, half: DVec3, rotation: DMat3| {
            Part::new(Shape::Cuboid { half }, Pose { rotation, origin: c }, Material::Print)
        };
        let parts = match self {
            Self::Sphere => vec![ball(middle, 0.45)],
            Self::Box => vec![cuboid(middle, DVec3::new(0.35, 0.25, 0.3), turn(0.3, 0.2, 0.5))],
            Self::Torus => {
                let frame = Pose { rotation: turn(0.5, 0.3, 0.0), origin: middle };
                vec![Part::new(Shape::Torus { major: 0.42, minor: 0.15 }, frame, Material::Print)]
            }
            Self::TwoBodies => vec![
                ball(middle + DVec3::new(0.24, 0.03, 0.05), 0.26),
                cuboid(middle + DVec3::new(-0.28, -0.02, 0.0), DVec3::new(0.12, 0.3, 0.4), turn(0.0, 0.0, 0.35)),
            ],
            Self::Plate => vec![cuboid(middle, DVec3::new(0.45, 0.35, 0.006), turn(1.2, 0.25, 0.4))],
            Self::Figure => figure::parts(time, time),
            Self::Standing => figure::parts(time, 0.0),
        };
        Solid::new(parts)
    }
}
