//! The green backdrop: a floor and a round wall, unevenly lit.

use crate::noise;
use glam::DVec3;

/// Radius of the wall in metres. The cameras stand inside.
const WALL: f64 = 6.0;

/// Colour of the backdrop's paint in even light, 8-bit display values.
pub const CHROMA_RGB: [u8; 3] = [46, 158, 66];

/// Display values in 0..1 of the backdrop that a ray hits.
pub fn colour(origin: DVec3, direction: DVec3) -> [f64; 3] {
    let floor = if direction.z < -1e-9 { -origin.z / direction.z } else { f64::MAX };
    let across = origin.x * direction.x + origin.y * direction.y;
    let flat = (direction.x * direction.x + direction.y * direction.y).max(1e-12);
    let room = WALL * WALL - origin.x * origin.x - origin.y * origin.y;
    let wall = (libm::sqrt((across * across + flat * room).max(0.0)) - across) / flat;
    let p = origin + direction * floor.min(wall);
    let cloudy = 1.0 + 0.07 * noise::value(p / 1.7, 901) + 0.025 * noise::value(p / 0.6, 902);
    let from_middle = libm::sqrt(p.x * p.x + p.y * p.y);
    let light = if floor < wall {
        // The subject shades the floor around its feet.
        let shadow = (1.0 - from_middle / 0.6).max(0.0);
        1.06 - 0.05 * from_middle - 0.35 * shadow * shadow
    } else {
        0.70 + 0.10 * p.z
    };
    CHROMA_RGB.map(|v| (f64::from(v) / 255.0 * light * cloudy).clamp(0.0, 1.0))
}
