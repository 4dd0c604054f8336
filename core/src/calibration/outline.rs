//! The outline of a silhouette: the convex hull of its contour, which planes through two cameras touch.

use crate::{math::ordered, silhouette::Silhouette, sort};
use alloc::{vec, vec::Vec};
use glam::DVec2;

/// A connected part of a silhouette with less than this share of its area is a speck.
const SPECK: f64 = 0.02;

/// A vertex of the outline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Corner {
    /// Ideal pixel.
    pub(super) pixel: DVec2,
    /// Whether the contour really turns here. At the picture's edge and where nothing is known the silhouette is cut
    /// off.
    pub(super) is_contour: bool,
}

/// The convex hull of a silhouette without specks, counter-clockwise with y up.
pub(super) fn outline(silhouette: &Silhouette) -> Vec<Corner> {
    let kept = large_parts(silhouette);
    let (w, h) = (silhouette.width as usize, silhouette.height as usize);
    let d = silhouette.distances();
    let mut corners = Vec::new();
    silhouette.contour(|pixel, _| {
        let (x, y) = (pixel.x as usize, pixel.y as usize);
        let near = [y * w + x, y * w + x + 1, (y + 1) * w + x, (y + 1) * w + x + 1];
        if near.iter().any(|&i| kept.get(i).is_some_and(|&kept| kept)) {
            corners.push(Corner { pixel: pixel.as_dvec2(), is_contour: true });
        }
    });
    for (i, _) in kept.iter().enumerate().filter(|&(_, &kept)| kept) {
        let (x, y) = (i % w, i / w);
        let edge = x == 0 || y == 0 || x + 1 == w || y + 1 == h;
        let unknown = || [i - 1, i + 1, i - w, i + w].iter().any(|&j| d[j] == Silhouette::UNKNOWN);
        if edge || unknown() {
            corners.push(Corner { pixel: DVec2::new(x as f64, y as f64), is_contour: false });
        }
    }
    convex_hull(&corners)
}

/// Which pixels belong to parts of the silhouette that are no specks.
fn large_parts(silhouette: &Silhouette) -> Vec<bool> {
    let (w, d) = (silhouette.width as usize, silhouette.distances());
    let is_inside = |i: usize| d[i] > 0 && d[i] != Silhouette::UNKNOWN;
    let total = (0..d.len()).filter(|&i| is_inside(i)).count();
    let (mut seen, mut kept) = (vec![false; d.len()], vec![false; d.len()]);
    let (mut part, mut open) = (Vec::new(), Vec::new());
    for start in 0..d.len() {
        if seen[start] || !is_inside(start) {
            continue;
        }
        part.clear();
        open.push(start);
        seen[start] = true;
        while let Some(i) = open.pop() {
            part.push(i);
            let x = i % w;
            let left = (x > 0).then(|| i - 1);
            let right = (x + 1 < w).then_some(i + 1);
            for j in [left, right, i.checked_sub(w), Some(i + w)].into_iter().flatten() {
                if j < d.len() && !seen[j] && is_inside(j) {
                    seen[j] = true;
                    open.push(j);
                }
            }
        }
        if part.len() as f64 >= SPECK * total as f64 {
            part.iter().for_each(|&i| kept[i] = true);
        }
    }
    kept
}

/// Andrew's monotone chain (1979).
fn convex_hull(points: &[Corner]) -> Vec<Corner> {
    // The pixels have been read from numbers of 32 bits.
    let key = |p: DVec2| u64::from(ordered(p.x as f32)) << 32 | u64::from(ordered(p.y as f32));
    let mut order: Vec<(u64, u32)> = points.iter().zip(0..).map(|(point, i)| (key(point.pixel), i)).collect();
    sort::indexed(&mut order);
    let points: Vec<Corner> = order.into_iter().map(|(_, i)| points[i as usize]).collect();
    let turn = |a: &Corner, b: &Corner, c: &Corner| (b.pixel - a.pixel).perp_dot(c.pixel - a.pixel);
    let mut hull: Vec<Corner> = Vec::new();
    let mut chain = |points: &mut dyn Iterator<Item = &Corner>| {
        let start = hull.len();
        for point in points {
            while hull.len() >= start + 2 && !(turn(&hull[hull.len() - 2], &hull[hull.len() - 1], point) > 0.0) {
                hull.pop();
            }
            hull.push(*point);
        }
        hull.pop();
    };
    chain(&mut points.iter());
    chain(&mut points.iter().rev());
    hull
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_outline_of_a_disc_is_the_disc_without_specks() {
        let (w, h) = (120_u32, 100_u32);
        let mut coverage = vec![0_u8; (w * h) as usize];
        for i in 0..w * h {
            let (x, y) = (f64::from(i % w), f64::from(i / w));
            let edge = 30.0 - libm::hypot(x - 60.3, y - 50.7);
            coverage[i as usize] = ((edge + 0.5).clamp(0.0, 1.0) * 255.0) as u8;
        }
        coverage[(5 * w + 5) as usize..][..3].fill(255);
        let silhouette = Silhouette::from_coverage(w, h, &coverage, |_| true).unwrap();
        let corners = outline(&silhouette);
        assert!(corners.len() > 40);
        for corner in corners {
            let radius = (corner.pixel - DVec2::new(60.3, 50.7)).length();
            assert!(corner.is_contour && (radius - 30.0).abs() < 0.15, "{corner:?}");
        }
    }

    #[test]
    fn where_the_picture_ends_the_outline_is_no_contour() {
        let (w, h) = (60_u32, 50_u32);
        let coverage: Vec<u8> = (0..w * h).map(|i| if i % w < 30 && i / w > 20 { 255 } else { 0 }).collect();
        let corners = outline(&Silhouette::from_coverage(w, h, &coverage, |_| true).unwrap());
        assert!(corners.iter().any(|corner| corner.is_contour) && corners.iter().any(|corner| !corner.is_contour));
        for corner in corners {
            let on_edge = corner.pixel.x == 0.0 || corner.pixel.y == f64::from(h) - 1.0;
            assert_eq!(corner.is_contour, !on_edge, "{corner:?}");
        }
    }
}
