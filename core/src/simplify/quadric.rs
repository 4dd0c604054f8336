//! The quadric error of a vertex: how far a position lies from the planes of triangles, and how far colours at that
//! position lie from theirs.
//!
//! Garland & Heckbert, Surface simplification using quadric error metrics, 1997; for colours Hoppe, New quadric metric for
//! simplifying meshes with appearance attributes, 1999.

use glam::DVec3;

/// How much the distance from the original vertices counts compared with that from the planes of the triangles. It makes the
/// best position unique where the surface is flat.
const TETHER: f64 = 1e-4;
/// Height of a triangle, in pixels of footprint, below which its colours count less: the gradient in a sliver says little.
const THINNEST: f64 = 0.5;

/// Sum over triangles, weighted by their area, of the squared distance from a triangle's plane and of the squared
/// differences from its three linear functions of colour. All lengths are in pixels of footprint. Positions are relative to
/// the vertex that the quadric belongs to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Quadric {
    /// Symmetric matrix of the second order: xx, xy, xz, yy, yz, zz.
    a: [f64; 6],
    /// Half of the gradient at the origin.
    b: DVec3,
    /// The error at the origin with colour 0.
    c: f64,
    /// Sum of the weights.
    weight: f64,
    /// For each channel, the sum of the gradients of the linear functions and of their values at the origin.
    slopes: [DVec3; 3],
    levels: DVec3,
}

/// A quadric in single precision.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stored([f32; 23]);

impl Quadric {
    pub(super) const ZERO: Self =
        Self { a: [0.0; 6], b: DVec3::ZERO, c: 0.0, weight: 0.0, slopes: [DVec3::ZERO; 3], levels: DVec3::ZERO };

    /// Adds the outer product of a vector to the matrix.
    fn add_square(&mut self, v: DVec3, weight: f64) {
        let w = v * weight;
        for (sum, term) in self.a.iter_mut().zip([w.x * v.x, w.x * v.y, w.x * v.z, w.y * v.y, w.y * v.z, w.z * v.z]) {
            *sum += term;
        }
    }

    /// The part of a triangle's quadric that belongs to each of its corners, a third, relative to the first of them. Colours
    /// are lengths. A triangle without area has none.
    pub(super) fn of_triangle(corners: [DVec3; 3], colours: Option<[DVec3; 3]>) -> Self {
        let mut quadric = Self::ZERO;
        let (p, q) = (corners[1] - corners[0], corners[2] - corners[0]);
        let cross = p.cross(q);
        let double = cross.length();
        if !(double > 0.0) {
            return quadric;
        }
        let normal = cross / double;
        let w = double / 6.0;
        quadric.weight = w;
        quadric.add_square(normal, w);
        if let Some([s, t, r]) = colours {
            // The gradient g solves g·p = t - s, g·q = r - s by least squares, with a term that keeps it small.
            let e = THINNEST * THINNEST;
            let (pp, pq, qq) = (p.dot(p) + e, p.dot(q), q.dot(q) + e);
            let det = pp * qq - pq * pq;
            let centre = (p + q) / 3.0;
            let mean = (s + t + r) / 3.0;
            let (ds, dr) = ((t - s).to_array(), (r - s).to_array());
            let mut levels = [0.0; 3];
            for j in 0..3 {
                let g = (p * (ds[j] * qq - dr[j] * pq) + q * (dr[j] * pp - ds[j] * pq)) / det;
                let level = mean[j] - g.dot(centre);
                quadric.add_square(g, w);
                quadric.b += g * (level * w);
                quadric.c += level * level * w;
                quadric.slopes[j] = g * w;
                levels[j] = level * w;
            }
            quadric.levels = DVec3::from_array(levels);
        }
        quadric
    }

    /// Adds a little of the squared distance from the origin.
    pub(super) fn tethered(mut self) -> Self {
        for i in [0, 3, 5] {
            self.a[i] += TETHER * self.weight;
        }
        self
    }

    /// Moves the origin.
    pub(super) fn relative_to(mut self, t: DVec3) -> Self {
        let at = self.times(t);
        self.c += 2.0 * self.b.dot(t) + at.dot(t);
        self.b += at;
        let [r, g, b] = self.slopes;
        self.levels += DVec3::new(r.dot(t), g.dot(t), b.dot(t));
        self
    }

    /// The sum of two quadrics with the same origin.
    pub(super) fn plus(mut self, other: &Self) -> Self {
        for (sum, term) in self.a.iter_mut().zip(other.a) {
            *sum += term;
        }
        self.b += other.b;
        self.c += other.c;
        self.weight += other.weight;
        for (sum, term) in self.slopes.iter_mut().zip(other.slopes) {
            *sum += term;
        }
        self.levels += other.levels;
        self
    }

    fn times(&self, x: DVec3) -> DVec3 {
        let [xx, xy, xz, yy, yz, zz] = self.a;
        DVec3::new(xx * x.x + xy * x.y + xz * x.z, xy * x.x + yy * x.y + yz * x.z, xz * x.x + yz * x.y + zz * x.z)
    }

    /// The quadric of positions alone, with the best colour for each position.
    pub(super) fn with_best_colours(mut self) -> Self {
        let levels = self.levels.to_array();
        for j in 0..3 {
            self.add_square(self.slopes[j], -1.0 / self.weight);
            self.b -= self.slopes[j] * (levels[j] / self.weight);
            self.c -= levels[j] * levels[j] / self.weight;
        }
        self
    }

    /// The colour of least error at the origin.
    pub(super) fn colour_at_origin(&self) -> DVec3 {
        self.levels / self.weight
    }

    /// The error of a position.
    pub(super) fn error(&self, x: DVec3) -> f64 {
        self.c + 2.0 * self.b.dot(x) + self.times(x).dot(x)
    }

    /// The position of least error among those with `along · x = at`: those that keep the volume. None if the quadric has no
    /// minimum.
    pub(super) fn minimum(&self, along: DVec3, at: f64) -> Option<DVec3> {
        let solver = Cholesky::new(&self.a)?;
        let free = -solver.solve(self.b);
        let step = solver.solve(along);
        let reach = step.dot(along);
        let moved = if reach > 0.0 { free + step * ((at - along.dot(free)) / reach) } else { free };
        moved.is_finite().then_some(moved)
    }
}

/// The factors of a symmetric positive definite matrix: A = L D Lᵀ.
struct Cholesky {
    l: [f64; 3],
    d: [f64; 3],
}

impl Cholesky {
    fn new(&[xx, xy, xz, yy, yz, zz]: &[f64; 6]) -> Option<Self> {
        let (l10, l20) = (xy / xx, xz / xx);
        let d1 = yy - l10 * xy;
        let l21 = (yz - l20 * xy) / d1;
        let d2 = zz - l20 * xz - l21 * l21 * d1;
        (xx > 0.0 && d1 > 0.0 && d2 > 0.0).then_some(Self { l: [l10, l20, l21], d: [xx, d1, d2] })
    }

    fn solve(&self, v: DVec3) -> DVec3 {
        let [l10, l20, l21] = self.l;
        let y = v.y - l10 * v.x;
        let z = (v.z - l20 * v.x - l21 * y) / self.d[2];
        let y = y / self.d[1] - l21 * z;
        DVec3::new(v.x / self.d[0] - l10 * y - l20 * z, y, z)
    }
}

impl From<Quadric> for Stored {
    fn from(q: Quadric) -> Self {
        let [r, g, b] = q.slopes.map(|v| v.to_array());
        let parts: [&[f64]; 7] = [&q.a, &q.b.to_array(), &[q.c, q.weight], &r, &g, &b, &q.levels.to_array()];
        let mut stored = [0.0; 23];
        for (to, &from) in stored.iter_mut().zip(parts.into_iter().flatten()) {
            *to = from as f32;
        }
        Self(stored)
    }
}

impl From<&Stored> for Quadric {
    fn from(stored: &Stored) -> Self {
        let v = stored.0.map(f64::from);
        let vector = |i: usize| DVec3::new(v[i], v[i + 1], v[i + 2]);
        Self {
            a: [v[0], v[1], v[2], v[3], v[4], v[5]],
            b: vector(6),
            c: v[9],
            weight: v[10],
            slopes: [vector(11), vector(14), vector(17)],
            levels: vector(20),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [DVec3; 3] = [DVec3::new(1.0, 2.0, 0.5), DVec3::new(4.0, 2.5, 1.0), DVec3::new(2.0, 6.0, -1.0)];
    const COLOURS: [DVec3; 3] = [DVec3::new(1.0, 0.0, 2.0), DVec3::new(0.5, 1.0, 2.0), DVec3::new(0.0, -1.0, 3.0)];

    fn quadric(colours: bool) -> Quadric {
        Quadric::of_triangle(CORNERS.map(|c| c - CORNERS[0]), colours.then_some(COLOURS)).relative_to(-CORNERS[0])
    }

    #[test]
    fn the_error_is_the_squared_distance_from_the_plane_times_a_third_of_the_area() {
        let cross = (CORNERS[1] - CORNERS[0]).cross(CORNERS[2] - CORNERS[0]);
        for p in [DVec3::ZERO, DVec3::new(3.0, -2.0, 5.0), CORNERS[1]] {
            let height = cross.normalize().dot(p - CORNERS[0]);
            let expected = height * height * cross.length() / 6.0;
            let found = quadric(false).with_best_colours().error(p);
            assert!((found - expected).abs() < 1e-9, "{found} for {expected}");
            // One triangle has a colour for every point of its plane, but few of other places have its colours.
            let coloured = quadric(true).with_best_colours().error(p);
            assert!((coloured - expected).abs() < 1e-9, "{coloured} for {expected}");
        }
    }

    #[test]
    fn colours_are_linear_in_a_triangle() {
        for (corner, colour) in CORNERS.into_iter().zip(COLOURS) {
            let found = quadric(true).relative_to(corner).colour_at_origin();
            // The gradients of triangles that are not slivers are hardly made smaller.
            assert!((found - colour).length() < 0.1, "{found} for {colour}");
        }
    }

    #[test]
    fn a_step_of_colour_costs() {
        let flat = |x: f64, colour: f64| {
            let corners = [DVec3::new(x, 0.0, 0.0), DVec3::new(x + 4.0, 0.0, 0.0), DVec3::new(x, 4.0, 0.0)];
            Quadric::of_triangle(corners.map(|c| c - corners[0]), Some([DVec3::splat(colour); 3]))
                .relative_to(-corners[0])
        };
        let error =
            |colour: f64| flat(0.0, 1.0).plus(&flat(4.0, colour)).with_best_colours().error(DVec3::ONE.with_z(0.0));
        assert!(error(1.0).abs() < 1e-9);
        // Half of the difference on either side, squared, in three channels, over two thirds of an area of 8.
        assert!((error(2.0) - 0.25 * 3.0 * 16.0 / 3.0).abs() < 1e-9, "{}", error(2.0));
    }

    #[test]
    fn the_minimum_keeps_to_its_plane() {
        let mut sum = Quadric::ZERO;
        for (at, along) in [(1.0, DVec3::X), (2.0, DVec3::Y), (-3.0, DVec3::Z)] {
            let side = along.any_orthonormal_vector();
            let corners = [along * at, along * at + side, along * at + along.cross(side)];
            let part = Quadric::of_triangle(corners.map(|c| c - corners[0]), None);
            sum = sum.plus(&part.relative_to(-corners[0]));
        }
        let corner = DVec3::new(1.0, 2.0, -3.0);
        let free = sum.minimum(DVec3::ZERO, 0.0).expect("three planes meet");
        assert!((free - corner).length() < 1e-9, "{free}");
        let held = sum.minimum(DVec3::new(1.0, 1.0, 0.0), 5.0).expect("three planes meet");
        assert!((held - corner - DVec3::new(1.0, 1.0, 0.0)).length() < 1e-9, "{held}");
        let plane = quadric(false);
        assert!(plane.minimum(DVec3::ZERO, 0.0).is_none_or(|p| p.is_finite()));
        assert!(plane.tethered().minimum(DVec3::ZERO, 0.0).is_some(), "it has one where the surface is flat");
    }

    #[test]
    fn moving_the_origin_changes_no_error() {
        let (q, t, p) = (quadric(true).tethered(), DVec3::new(0.3, -2.0, 1.0), DVec3::new(-1.0, 0.5, 2.0));
        let (here, there) = (q.with_best_colours().error(p), q.relative_to(t).with_best_colours().error(p - t));
        assert!((here - there).abs() < 1e-9, "{here} and {there}");
        let stored = Quadric::from(&Stored::from(q));
        assert!((stored.with_best_colours().error(p) / here - 1.0).abs() < 1e-4);
    }
}
