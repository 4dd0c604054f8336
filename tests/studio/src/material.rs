//! Materials: procedural colours in the frame of a part, so that they move with it.

use crate::noise;
use glam::DVec3;

type Rgb = [f64; 3];

const BLACK: Rgb = [0.075, 0.075, 0.085];

/// A procedural texture. Positions are in metres in the frame of the part (x forward, y left, z up for the figure).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Material {
    /// Printed cloth in three colours with details from 8 mm to 12 cm.
    Print,
    /// Coarsely printed grey stone, for the simple bodies.
    Stone,
    /// Denim, worn pale in patches, dyed black above 13 cm below the origin.
    Denim,
    /// Black cloth without texture.
    Black,
    /// Skin with very little texture.
    Skin,
    /// A face that looks along x, relative to the centre of the head.
    Face,
    /// Hair with dark strands along z.
    Hair,
    /// Leather.
    Leather,
    /// Rubber of a sole.
    Rubber,
}

fn blend(a: Rgb, b: Rgb, t: f64) -> Rgb {
    let t = t.clamp(0.0, 1.0);
    [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t]
}

fn shade(c: Rgb, factor: f64) -> Rgb {
    c.map(|v| v * factor)
}

/// A smooth step from 0 to 1 of the given width, centred at zero.
fn step(v: f64, width: f64) -> f64 {
    let t = (v / width + 0.5).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Noise in [-1, 1] of three octaves, the largest of `size` metres.
fn octaves(p: DVec3, size: f64, seed: u32) -> f64 {
    let n = |size: f64, seed: u32| noise::value(p / size, seed);
    0.5 * n(size, seed) + 0.3 * n(size * 0.45, seed + 1) + 0.2 * n(size * 0.2, seed + 2)
}

/// Smooth membership (0..1) of a point in an ellipse of the face.
fn spot(y: f64, z: f64, (cy, cz): (f64, f64), (ry, rz): (f64, f64)) -> f64 {
    let (a, b) = ((y - cy) / ry, (z - cz) / rz);
    step(1.0 - (a * a + b * b), 0.8)
}

impl Material {
    /// Display values in 0..1 at a local position.
    pub fn colour(self, p: DVec3, seed: u32) -> Rgb {
        let seed = seed * 31;
        match self {
            Self::Print => {
                let fine = octaves(p, 0.028, seed + 11);
                let motif = noise::value(p / 0.036, seed + 20) + 0.6 * noise::value(p / 0.015, seed + 21);
                let patch = noise::value(p / 0.075, seed + 22) + 0.5 * noise::value(p / 0.03, seed + 23);
                let ground = blend([0.80, 0.72, 0.56], [0.66, 0.22, 0.18], step(patch, 0.25));
                shade(blend(ground, [0.13, 0.21, 0.42], step(motif - 0.30, 0.15)), 1.0 + 0.6 * fine)
            }
            Self::Stone => {
                let n = octaves(p, 0.09, seed + 31) + 0.7 * octaves(p, 0.035, seed + 41);
                blend([0.30, 0.25, 0.24], [0.80, 0.74, 0.66], 0.5 + 0.8 * n)
            }
            Self::Denim => {
                let worn = 0.5 + 0.9 * octaves(p, 0.08, seed + 51);
                let weave = octaves(p * DVec3::new(1.0, 1.0, 0.7), 0.022, seed + 61);
                let denim = shade(blend([0.10, 0.14, 0.25], [0.42, 0.50, 0.64], worn), 1.0 + 0.6 * weave);
                blend(BLACK, denim, step(-p.z - 0.13, 0.14))
            }
            Self::Black => BLACK,
            Self::Skin => shade([0.80, 0.60, 0.50], 1.0 + 0.05 * noise::value(p / 0.03, seed + 71)),
            Self::Face => face(p, seed),
            Self::Hair => {
                let strands = octaves(p * DVec3::new(1.0, 1.0, 0.18), 0.014, seed + 81);
                shade([0.24, 0.15, 0.09], 1.0 + 0.7 * strands)
            }
            Self::Leather => shade([0.34, 0.20, 0.13], 1.0 + 0.4 * octaves(p, 0.03, seed + 91)),
            Self::Rubber => [0.80, 0.79, 0.76],
        }
    }
}

fn face(p: DVec3, seed: u32) -> Rgb {
    let skin = shade([0.82, 0.62, 0.52], 1.0 + 0.05 * noise::value(p / 0.03, seed + 101));
    if p.x < 0.02 {
        return skin;
    }
    let y = if p.y < 0.0 { -p.y } else { p.y };
    let mut c = blend(skin, [0.86, 0.50, 0.45], 0.5 * spot(y, p.z, (0.042, -0.025), (0.022, 0.02)));
    c = blend(c, [0.92, 0.90, 0.88], spot(y, p.z, (0.033, 0.018), (0.017, 0.009)));
    c = blend(c, [0.16, 0.10, 0.07], spot(y, p.z, (0.033, 0.018), (0.008, 0.008)));
    c = blend(c, [0.22, 0.14, 0.09], spot(y, p.z + 0.12 * y, (0.034, 0.046), (0.022, 0.006)));
    blend(c, [0.66, 0.26, 0.25], spot(y, p.z - 9.0 * y * y, (0.0, -0.061), (0.027, 0.008)))
}
