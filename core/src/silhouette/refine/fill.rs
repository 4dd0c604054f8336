//! Coverage of closed loops: the exact area of each pixel inside.

use super::trace::Loops;
use crate::silhouette::refill::refill;
use alloc::vec::Vec;
use glam::Vec2;

/// Coverage in 0..=255 of the area on the right-hand side of closed loops. A pixel is a square around its integer
/// coordinates. What lies beyond the picture is clamped to its edge. A loop that was turned inside out covers nothing.
/// `differences` is a buffer, `out` is overwritten.
pub(super) fn fill(width: usize, height: usize, loops: &Loops, differences: &mut Vec<f32>, out: &mut Vec<u8>) {
    // In each row an edge adds the height that it crosses to all pixels on its right. These are the differences between
    // neighbouring pixels.
    let stride = width + 2;
    refill(differences, stride * height, 0.0);
    for range in loops.ranges() {
        let points = &loops.points[range];
        for (i, &b) in points.iter().enumerate() {
            let a = points[if i == 0 { points.len() - 1 } else { i - 1 }];
            edge(width, height, stride, a, b, differences);
        }
    }
    out.clear();
    for row in differences.chunks_exact(stride) {
        let mut sum = 0.0;
        out.extend(row[..width].iter().map(|d| {
            sum += d;
            (sum.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
        }));
    }
}

fn edge(width: usize, height: usize, stride: usize, a: Vec2, b: Vec2, differences: &mut [f32]) {
    // To coordinates in which pixel 0 spans 0 to 1.
    let (w, h) = (width as f32, height as f32);
    let clamped = |p: Vec2| Vec2::new((p.x + 0.5).clamp(0.0, w), (p.y + 0.5).clamp(0.0, h));
    let (a, b) = (clamped(a), clamped(b));
    if a.y == b.y {
        return;
    }
    let (direction, top, bottom) = if a.y > b.y { (1.0, b, a) } else { (-1.0, a, b) };
    let slope = (bottom.x - top.x) / (bottom.y - top.y);
    for row in top.y as usize..(bottom.y as usize + 1).min(height) {
        let (y0, y1) = (top.y.max(row as f32), bottom.y.min((row + 1) as f32));
        if y1 <= y0 {
            continue;
        }
        let line = &mut differences[row * stride..][..stride];
        let at = |y: f32| (top.x + (y - top.y) * slope).clamp(0.0, w);
        let (mut x0, mut x1) = (at(y0), at(y1));
        if x0 > x1 {
            (x0, x1) = (x1, x0);
        }
        let total = direction * (y1 - y0);
        let (first, last) = (x0 as usize, x1 as usize);
        if first == last {
            // Within one pixel: the part of it on the right is covered, all further pixels are in full.
            let right = total * ((first + 1) as f32 - 0.5 * (x0 + x1));
            line[first] += right;
            line[first + 1] += total - right;
            continue;
        }
        let per_pixel = total / (x1 - x0);
        // Area covered in each pixel: the integral of the height crossed so far.
        let mut before = 0.0;
        for x in first..=last.min(width) {
            let (from, to) = (x0.max(x as f32), x1.min((x + 1) as f32));
            let (crossed, crossing) = (per_pixel * (from - x0), per_pixel * (to - from));
            let area =
                crossed * (to - from) + 0.5 * crossing * (to - from) + (crossed + crossing) * ((x + 1) as f32 - to);
            line[x] += area - before;
            before = area;
        }
        line[(last + 1).min(stride - 1)] += total - before;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: usize = 24;

    /// Sum of the coverage in pixels.
    fn area(polygons: &[Vec<Vec2>]) -> f32 {
        let mut loops = Loops::default();
        for points in polygons {
            loops.points.extend(points);
            loops.ends.push(loops.points.len());
        }
        let mut coverage = Vec::new();
        fill(SIZE, SIZE, &loops, &mut Vec::new(), &mut coverage);
        coverage.iter().map(|&c| f32::from(c) / 255.0).sum()
    }

    /// A square turned by an angle, its inside on the right-hand side.
    fn square(half: f32, angle: f32) -> Vec<Vec2> {
        let corner = |k: usize| {
            let a = angle + k as f32 * core::f32::consts::FRAC_PI_2;
            let reach = half * core::f32::consts::SQRT_2;
            Vec2::new(11.3 + reach * libm::cosf(a), 12.1 + reach * libm::sinf(a))
        };
        (0..4).map(corner).collect()
    }

    #[test]
    fn coverage_sums_to_the_enclosed_area() {
        for k in 0..12 {
            let (outer, mut hole) = (square(6.2, k as f32 * 0.3), square(2.3, k as f32 * 0.7));
            assert!((area(core::slice::from_ref(&outer)) - 12.4 * 12.4).abs() < 0.3, "{k}");
            hole.reverse();
            assert!((area(&[outer, hole]) - 12.4 * 12.4 + 4.6 * 4.6).abs() < 0.3, "{k}");
        }
    }

    #[test]
    fn loops_turned_inside_out_cover_nothing_and_the_picture_clips() {
        let mut inverted = square(5.0, 0.4);
        inverted.reverse();
        assert_eq!(area(core::slice::from_ref(&inverted)), 0.0);
        let most = square(100.0, 0.2);
        assert_eq!(area(core::slice::from_ref(&most)), (SIZE * SIZE) as f32);
    }
}
