//! Noise from integer hashes, with the same numbers on every machine.

use glam::DVec3;

/// Mixes a word so that every bit of the result depends on every bit of the input.
pub fn mix(mut v: u64) -> u64 {
    v = (v ^ (v >> 32)).wrapping_mul(0xd6e8_feb8_6659_fd93);
    v = (v ^ (v >> 32)).wrapping_mul(0xd6e8_feb8_6659_fd93);
    v ^ (v >> 32)
}

/// A stream of random numbers from a seed.
#[derive(Debug, Clone)]
pub struct Random(u64);

impl Random {
    /// A stream of a seed. Streams of different `(seed, stream)` are unrelated.
    pub fn new(seed: u64, stream: u64) -> Self {
        Self(mix(mix(seed ^ 0x9e37_79b9_7f4a_7c15).wrapping_add(stream)))
    }

    /// The next word.
    pub fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        mix(self.0)
    }

    /// Uniform in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        (self.word() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform in [-1, 1).
    pub fn signed(&mut self) -> f64 {
        2.0 * self.uniform() - 1.0
    }

    /// Approximately normal with mean 0 and standard deviation 1: a sum of four uniform numbers, never beyond ±3.5.
    pub fn normal(&mut self) -> f64 {
        let word = self.word();
        let sum: u64 = (0..4).map(|i| (word >> (16 * i)) & 0xffff).sum();
        (sum as f64 / 65536.0 - 2.0 + 2.0 / 65536.0) * libm::sqrt(3.0)
    }

    /// Uniform on the unit sphere.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let v = DVec3::new(self.signed(), self.signed(), self.signed());
            let l2 = v.length_squared();
            if l2 > 1e-4 && l2 <= 1.0 {
                return v / libm::sqrt(l2);
            }
        }
    }
}

/// Steepest slope of [`value`] along one axis: neighbouring lattice values differ by up to 2, and the slope of the fade is
/// up to 1.5.
pub const STEEPEST: f64 = 3.0;

fn cell(x: f64) -> (i32, f64) {
    let i = x as i32;
    let i = if x < f64::from(i) { i - 1 } else { i };
    (i, x - f64::from(i))
}

fn lattice(x: i32, y: i32, z: i32, seed: u32) -> f64 {
    let mut h = (x as u32).wrapping_mul(0x8da6_b343)
        ^ (y as u32).wrapping_mul(0xd816_3841)
        ^ (z as u32).wrapping_mul(0xcb1a_b31f)
        ^ seed.wrapping_mul(0x9e37_79b1);
    h = (h ^ (h >> 16)).wrapping_mul(0x7feb_352d);
    h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
    f64::from((h ^ (h >> 16)) >> 8) / f64::from(1_u32 << 23) - 1.0
}

/// Smooth noise in [-1, 1] on a lattice of unit cells, with continuous first derivatives.
pub fn value(p: DVec3, seed: u32) -> f64 {
    let ((ix, x), (iy, y), (iz, z)) = (cell(p.x), cell(p.y), cell(p.z));
    let fade = |t: f64| t * t * (3.0 - 2.0 * t);
    let (x, y, z) = (fade(x), fade(y), fade(z));
    let lerp = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let row = |dy: i32, dz: i32| lerp(lattice(ix, iy + dy, iz + dz, seed), lattice(ix + 1, iy + dy, iz + dz, seed), x);
    lerp(lerp(row(0, 0), row(1, 0), y), lerp(row(0, 1), row(1, 1), y), z)
}
