//! Ground truth: a solid given by a signed distance function with colours.

use crate::{noise::Random, part::Part};
use glam::DVec3;

/// A solid at one instant. Lengths are in metres, z is up, the floor is at z = 0. Distances are negative inside.
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    parts: Vec<Part>,
    /// Distance from each part within which it changes the surface, because it blends with the parts before and after it.
    influence: Vec<f64>,
    centre: DVec3,
    radius: f64,
}

/// A set of parts, one bit per part.
pub type Parts = u64;

/// Reach of ambient occlusion in metres.
pub(crate) const OCCLUSION: f64 = 0.03;

/// The minimum of two distances, smooth where they differ by less than `width`. Its gradient is a mean of theirs, so that
/// its slope is at most 1. Where they differ by more it is the exact minimum.
fn smooth_min(a: f64, b: f64, width: f64) -> f64 {
    let apart = if a < b { b - a } else { a - b };
    let least = if a < b { a } else { b };
    if apart >= width {
        return least;
    }
    let h = width - apart;
    least - h * h / (4.0 * width)
}

impl Solid {
    /// A solid of up to 64 parts. Each blends with the parts before it over its own `blend`.
    pub fn new(parts: Vec<Part>) -> Self {
        assert!(!parts.is_empty() && parts.len() <= 64, "a solid has 1 to 64 parts, not {}", parts.len());
        let centre = parts.iter().map(|p| p.centre).sum::<DVec3>() / parts.len() as f64;
        let radius = parts.iter().map(|p| (p.centre - centre).length() + p.radius + p.blend).fold(0.0, f64::max);
        let mut widest = 0.0_f64;
        let mut influence: Vec<f64> = parts
            .iter()
            .rev()
            .map(|p| {
                widest = widest.max(p.blend);
                // A blend reaches as far as its width. Together with the next one it bulges by up to two quarters of it.
                1.5 * widest + 0.002
            })
            .collect();
        influence.reverse();
        Self { parts, influence, centre, radius }
    }

    /// All parts.
    pub fn all(&self) -> Parts {
        u64::MAX >> (64 - self.parts.len())
    }

    /// Centre and radius of a bounding ball.
    pub fn ball(&self) -> (DVec3, f64) {
        (self.centre, self.radius)
    }

    /// The parts that can change where rays from `origin` hit the surface: those within `reach` of rays that lie within
    /// `spread` (at unit distance) of a unit direction.
    pub fn near(&self, origin: DVec3, direction: DVec3, spread: f64, reach: f64) -> Parts {
        let mut parts = 0;
        for (i, part) in self.parts.iter().enumerate() {
            let to = part.centre - origin;
            let along = to.dot(direction).max(0.0);
            let off = (to - direction * along).length();
            if off <= part.radius + self.influence[i] + (along + part.radius) * spread + reach {
                parts |= 1 << i;
            }
        }
        parts
    }

    /// A function of the given parts with slope at most 1 that is zero on the surface and negative inside: a safe step for
    /// sphere tracing. Without blends, relief and stretching it is the exact distance.
    pub fn bound(&self, p: DVec3, parts: Parts) -> f64 {
        let mut least = f64::MAX;
        let mut rest = parts;
        while rest != 0 {
            let part = &self.parts[rest.trailing_zeros() as usize];
            rest &= rest - 1;
            let reach = part.radius + least + part.blend;
            let off = (p - part.centre).length_squared();
            // The bound of a part is never less than the distance to its ball, so skipping it does not change the result.
            if reach <= 0.0 || off >= reach * reach {
                continue;
            }
            least = smooth_min(least, part.bound(p, libm::sqrt(off)), part.blend);
        }
        least
    }

    /// Signed distance to the surface, negative inside. It is exact for all subjects but the figure, for which it is correct
    /// to first order near the surface (bound / |gradient|).
    pub fn distance(&self, p: DVec3) -> f64 {
        let bound = self.bound(p, self.all());
        if self.parts.iter().all(Part::is_exact) {
            return bound;
        }
        bound / self.gradient(p, self.all()).length().max(0.1)
    }

    /// Gradient of [`Self::bound`] by finite differences over the corners of a tetrahedron.
    pub fn gradient(&self, p: DVec3, parts: Parts) -> DVec3 {
        const STEP: f64 = 1e-5;
        let corners = [
            DVec3::new(1.0, 1.0, 1.0),
            DVec3::new(1.0, -1.0, -1.0),
            DVec3::new(-1.0, 1.0, -1.0),
            DVec3::new(-1.0, -1.0, 1.0),
        ];
        corners.into_iter().map(|c| c * self.bound(p + c * STEP, parts)).sum::<DVec3>() / (4.0 * STEP)
    }

    /// A surface point as a point of the part that it belongs to, by the part's index and in its frame. `None` where parts
    /// blend.
    pub fn material(&self, p: DVec3) -> Option<(usize, DVec3)> {
        let own = |part: usize| self.bound(p, 1 << part).abs();
        let part = (0..self.parts.len()).min_by(|&a, &b| own(a).total_cmp(&own(b)))?;
        let blended = (self.bound(p, self.all()) - self.bound(p, 1 << part)).abs() > 1e-5;
        (!blended).then(|| (part, self.parts[part].to_local(p)))
    }

    /// Where a point of a part is in the world: the inverse of [`Self::material`], at any time.
    pub fn place(&self, (part, p): (usize, DVec3)) -> DVec3 {
        self.parts[part].to_world(p)
    }

    /// Outward unit normal.
    pub fn normal(&self, p: DVec3) -> DVec3 {
        self.gradient(p, self.all()).normalize_or_zero()
    }

    /// Colour of a surface point without light, display values in 0..1.
    pub fn colour(&self, p: DVec3) -> [f64; 3] {
        self.colour_of(p, self.all())
    }

    pub(crate) fn colour_of(&self, p: DVec3, parts: Parts) -> [f64; 3] {
        self.parts[self.nearest(p, parts)].colour(p)
    }

    /// Index of the part that a point belongs to.
    pub(crate) fn nearest(&self, p: DVec3, parts: Parts) -> usize {
        let (mut best, mut least) = (parts.trailing_zeros() as usize, f64::MAX);
        let mut rest = parts;
        while rest != 0 {
            let i = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            let part = &self.parts[i];
            let off = (p - part.centre).length();
            if off - part.radius >= least {
                continue;
            }
            let d = part.bound(p, off);
            if d < least {
                (best, least) = (i, d);
            }
        }
        best
    }

    /// Share of the surroundings that a surface point sees.
    pub(crate) fn openness(&self, p: DVec3, normal: DVec3, parts: Parts) -> f64 {
        let mut closed = 0.0;
        for (share, reach) in [(0.5, OCCLUSION), (0.5, 0.4 * OCCLUSION)] {
            closed += share * (1.0 - (self.bound(p + normal * reach, parts) / reach).clamp(0.0, 1.0));
        }
        1.0 - 0.6 * closed
    }

    /// Distance along a ray (unit direction) to the first surface point between `from` and `to`.
    pub fn trace(&self, origin: DVec3, direction: DVec3, from: f64, to: f64, parts: Parts) -> Option<f64> {
        let mut t = from;
        while t < to {
            let d = self.bound(origin + direction * t, parts);
            // 1e-5 of the distance is a hundredth of a pixel if the picture is 1024 pixels wide.
            if d < 1e-5 * t {
                return Some(t);
            }
            t += d;
        }
        None
    }

    /// Points uniformly distributed over the surface, with their normals: the intersections with random lines
    /// (Cauchy-Crofton). The same seed gives the same points.
    pub fn surface_points(&self, count: usize, seed: u64) -> Vec<(DVec3, DVec3)> {
        let mut random = Random::new(seed, 1);
        let mut points = Vec::with_capacity(count);
        while points.len() < count {
            let direction = random.direction();
            let u = direction.any_orthonormal_vector();
            let v = direction.cross(u);
            let (a, b) = (random.signed(), random.signed());
            if a * a + b * b > 1.0 {
                continue;
            }
            let start = self.centre + (u * a + v * b - direction) * self.radius;
            self.crossings(start, direction, &mut points);
        }
        points.truncate(count);
        points
    }

    /// All points where a line through the bounding ball crosses the surface.
    fn crossings(&self, start: DVec3, direction: DVec3, points: &mut Vec<(DVec3, DVec3)>) {
        const STEP: f64 = 2e-4;
        let parts = self.near(start, direction, 0.0, 0.0);
        let at = |t: f64| self.bound(start + direction * t, parts);
        let (mut t, mut d) = (0.0, at(0.0));
        while t < 2.0 * self.radius {
            let next = t + libm::fabs(d).max(STEP);
            let e = at(next);
            if (d < 0.0) != (e < 0.0) {
                let (mut lo, mut hi) = (t, next);
                for _ in 0..40 {
                    let middle = 0.5 * (lo + hi);
                    if (at(middle) < 0.0) == (d < 0.0) { lo = middle } else { hi = middle }
                }
                let p = start + direction * lo;
                points.push((p, self.normal(p)));
            }
            (t, d) = (next, e);
        }
    }
}
