//! Classifies a ball in space against all silhouettes (§0).

use super::carver::{Carver, EDGE};
use crate::surface::SLOPE;
use alloc::vec::Vec;
use glam::Vec3;

/// Position of a ball relative to the hull.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Verdict {
    Outside,
    Inside,
    Boundary,
}

/// Classifies a ball against all views. The indices of the views that may carve a part of it are written to `crossing`.
///
/// The second result is the number of silhouettes that contain the whole ball, and the third the number of those that
/// may contain a part of it. A ball for which the third is smaller than `needed` is outside, and so is one that more
/// than `tolerated` views exclude as a whole.
pub(super) fn judge(
    carvers: &[Carver],
    centre: Vec3,
    radius: f32,
    (needed, tolerated): (u32, u32),
    crossing: &mut Vec<u16>,
) -> (Verdict, u32, u32) {
    crossing.clear();
    let (mut containing, mut supporting, mut excluding) = (0, 0, 0);
    for (i, carver) in carvers.iter().enumerate() {
        let q = carver.camera.project(centre);
        let nearest = q.z - radius;
        if q.z <= -radius {
            continue;
        }
        let (w, h) = (carver.camera.width as f32, carver.camera.height as f32);
        if nearest <= 0.0 {
            crossing.push(i as u16);
            supporting += 1;
            continue;
        }
        let r = radius * carver.camera.focal / nearest * SLOPE;
        if q.x + r < 0.0 || q.y + r < 0.0 || q.x - r > w - 1.0 || q.y - r > h - 1.0 {
            continue;
        }
        let edge = r + EDGE;
        let is_known = |(x, y): (f32, f32)| carver.silhouette.sample(q.x + x * r, q.y + y * r).is_some();
        let is_whole = || {
            let within = q.x >= edge && q.y >= edge && q.x + edge <= w - 1.0 && q.y + edge <= h - 1.0;
            within && [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)].into_iter().all(is_known)
        };
        let seen = carver.silhouette.sample(q.x.clamp(0.0, w - 1.0), q.y.clamp(0.0, h - 1.0));
        // Only balls that do not reach the contour are asked whether all of them is seen.
        let whole = seen.is_some_and(|d| d.abs() > r) && is_whole();
        match seen {
            Some(d) if whole && d < -r => {
                excluding += 1;
                if excluding > tolerated {
                    return (Verdict::Outside, 0, 0);
                }
            }
            Some(d) if whole && d > r => containing += 1,
            // The ball crosses the picture's edge. The visible part is background, and nothing is known about the rest.
            Some(d) if d < -2.0 * r => crossing.push(i as u16),
            _ => {
                crossing.push(i as u16);
                supporting += 1;
            }
        }
    }
    supporting += containing;
    let verdict = if supporting < needed {
        Verdict::Outside
    } else if crossing.is_empty() {
        Verdict::Inside
    } else {
        Verdict::Boundary
    };
    (verdict, containing, supporting)
}
