//! The zero line of a signed distance as closed loops.

use crate::silhouette::refill::refill;
use alloc::vec::Vec;
use core::{iter::once, ops::Range};
use glam::Vec2;

/// Distance between the points of a loop in pixels.
pub(super) const STEP: f32 = 0.8;

/// Steps up, right, down and left.
const STEPS: [[i32; 2]; 4] = [[0, -1], [1, 0], [0, 1], [-1, 0]];

/// Closed loops of points.
#[derive(Debug, Default)]
pub(super) struct Loops {
    /// The points of all loops.
    pub points: Vec<Vec2>,
    /// Where each loop ends in `points`.
    pub ends: Vec<usize>,
}

impl Loops {
    /// The places of each loop's points.
    pub fn ranges(&self) -> impl Iterator<Item = Range<usize>> {
        let starts = once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| start..end)
    }
}

/// Buffers of [`trace`].
#[derive(Debug, Default)]
pub(super) struct Buffers {
    visited: Vec<bool>,
    /// Where one loop crosses the edges between pixels.
    crossings: Vec<Vec2>,
}

/// Closed loops of points about [`STEP`] pixels apart, with the object on the right-hand side. Beyond the patch there is
/// nothing: where the object is cut off by its edge a loop runs a little outside.
pub(super) fn trace(width: usize, height: usize, distance: &[i16], buffers: &mut Buffers, loops: &mut Loops) {
    let (w, h) = (width as i32, height as i32);
    let value = |p: [i32; 2]| {
        let within = p[0] >= 0 && p[1] >= 0 && p[0] < w && p[1] < h;
        if within { distance[(p[1] * w + p[0]) as usize] } else { i16::MIN }
    };
    let Buffers { visited, crossings } = buffers;
    refill(visited, (width + 1) * height, false);
    loops.points.clear();
    loops.ends.clear();
    for y in 0..h {
        for x in -1..w {
            // Every loop somewhere goes up between a pixel outside and one inside on its right.
            if value([x, y]) > 0 || value([x + 1, y]) <= 0 || visited[(y * (w + 1) + x + 1) as usize] {
                continue;
            }
            crossings.clear();
            let (mut outer, mut inner, mut heading) = ([x, y], [x + 1, y], 0);
            loop {
                if heading == 0 {
                    let seen = &mut visited[(outer[1] * (w + 1) + outer[0] + 1) as usize];
                    if *seen {
                        break;
                    }
                    *seen = true;
                }
                crossings.push(crossing(outer, inner, value(outer), value(inner)));
                let ahead = |p: [i32; 2]| [p[0] + STEPS[heading][0], p[1] + STEPS[heading][1]];
                let (next_outer, next_inner) = (ahead(outer), ahead(inner));
                if value(next_inner) <= 0 {
                    outer = next_inner;
                    heading = (heading + 1) % 4;
                } else if value(next_outer) <= 0 {
                    (outer, inner) = (next_outer, next_inner);
                } else {
                    inner = next_outer;
                    heading = (heading + 3) % 4;
                }
            }
            resample(crossings, &mut loops.points);
            loops.ends.push(loops.points.len());
        }
    }
}

/// Where the zero line crosses the edge between two pixels. Beyond the patch it keeps clear of its pixels' corners.
fn crossing(outer: [i32; 2], inner: [i32; 2], a: i16, b: i16) -> Vec2 {
    let vector = |p: [i32; 2]| Vec2::new(p[0] as f32, p[1] as f32);
    let t = if a == i16::MIN { -0.5 } else { (0.5 - f32::from(a)) / (f32::from(b) - f32::from(a)) };
    vector(outer) + (vector(inner) - vector(outer)) * t
}

/// Appends points at equal distances along a closed polygon.
fn resample(points: &[Vec2], out: &mut Vec<Vec2>) {
    let n = points.len();
    let length: f32 = (0..n).map(|i| points[i].distance(points[(i + 1) % n])).sum();
    let count = ((length / STEP + 0.5) as usize).max(3);
    let step = length / count as f32;
    let (mut i, mut start) = (0, 0.0);
    for k in 0..count {
        let at = k as f32 * step;
        loop {
            let (a, b) = (points[i], points[(i + 1) % n]);
            let piece = a.distance(b);
            if at <= start + piece || i + 1 == n {
                out.push(a.lerp(b, if piece > 0.0 { ((at - start) / piece).min(1.0) } else { 0.0 }));
                break;
            }
            start += piece;
            i += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_has_two_loops_on_its_circles() {
        const SIZE: usize = 60;
        let centre = Vec2::new(29.3, 30.6);
        let at = |i: usize| Vec2::new((i % SIZE) as f32, (i / SIZE) as f32).distance(centre);
        let distance: Vec<i16> = (0..SIZE * SIZE).map(|i| (64.0 * (5.0 - libm::fabsf(at(i) - 15.0))) as i16).collect();
        let mut loops = Loops::default();
        trace(SIZE, SIZE, &distance, &mut Buffers::default(), &mut loops);
        assert_eq!(loops.ends.len(), 2);
        for (range, radius) in loops.ranges().zip([20.0, 10.0]) {
            let points = &loops.points[range];
            let length = 2.0 * core::f32::consts::PI * radius;
            assert!((points.len() as f32 * STEP - length).abs() < 0.05 * length, "{} points", points.len());
            for (i, p) in points.iter().enumerate() {
                assert!((p.distance(centre) - radius).abs() < 0.15, "{p} is not on the circle of radius {radius}");
                // The object is on the right-hand side: inside the outer circle, outside the inner one.
                let along = points[(i + 1) % points.len()] - *p;
                let right = Vec2::new(-along.y, along.x).normalize_or_zero();
                let inwards = (centre - *p).normalize_or_zero() * if radius > 15.0 { 1.0 } else { -1.0 };
                assert!(right.dot(inwards) > 0.9, "{p}");
            }
        }
    }
}
