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

/// Where a view's silhouette has a ball.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Seen {
    /// Beside the picture or behind the camera: the view says nothing.
    Nowhere,
    Outside,
    Inside,
    /// The contour may pass it.
    Partly,
    /// It crosses the picture's edge. Its visible part is background, and nothing is known about the rest.
    PartlyOutside,
}

impl Seen {
    fn new(carver: &Carver, centre: Vec3, radius: f32) -> Self {
        let q = carver.camera.project(centre);
        let nearest = q.z - radius;
        if q.z <= -radius {
            return Self::Nowhere;
        }
        let (w, h) = (carver.camera.width as f32, carver.camera.height as f32);
        if nearest <= 0.0 {
            return Self::Partly;
        }
        let r = radius * carver.camera.focal / nearest * SLOPE;
        if q.x + r < 0.0 || q.y + r < 0.0 || q.x - r > w - 1.0 || q.y - r > h - 1.0 {
            return Self::Nowhere;
        }
        let is_known = |(x, y): (f32, f32)| carver.silhouette.sample(q.x + x * r, q.y + y * r).is_some();
        let is_whole = || {
            let edge = r + EDGE;
            let within = q.x >= edge && q.y >= edge && q.x + edge <= w - 1.0 && q.y + edge <= h - 1.0;
            within && [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)].into_iter().all(is_known)
        };
        match carver.silhouette.sample(q.x.clamp(0.0, w - 1.0), q.y.clamp(0.0, h - 1.0)) {
            Some(d) if d.abs() > r && is_whole() => {
                if d < 0.0 {
                    Self::Outside
                } else {
                    Self::Inside
                }
            }
            Some(d) if d < -2.0 * r => Self::PartlyOutside,
            _ => Self::Partly,
        }
    }
}

/// Classifies a ball against all views. The indices of the views that may carve a part of it are written to `crossing`.
///
/// The second result is the number of silhouettes that contain the whole ball, and the third the number of those that
/// may contain a part of it. A ball for which the third is smaller than `needed` is outside, and so is one that more
/// than `tolerated` views exclude as a whole.
///
/// `suspect` is the index of the view that is asked first, if one is enough. It becomes that of the view that excludes the
/// ball: it mostly excludes the next one, too.
pub(super) fn judge(
    carvers: &[Carver],
    centre: Vec3,
    radius: f32,
    (needed, tolerated): (u32, u32),
    suspect: &mut usize,
    crossing: &mut Vec<u16>,
) -> (Verdict, u32, u32) {
    crossing.clear();
    let excludes = |carver: &Carver| Seen::new(carver, centre, radius) == Seen::Outside;
    if tolerated == 0 && carvers.get(*suspect).is_some_and(excludes) {
        return (Verdict::Outside, 0, 0);
    }
    let (mut containing, mut supporting, mut excluding) = (0, 0, 0);
    for (i, carver) in carvers.iter().enumerate() {
        match Seen::new(carver, centre, radius) {
            Seen::Nowhere => {}
            Seen::Outside => {
                excluding += 1;
                if excluding > tolerated {
                    *suspect = i;
                    return (Verdict::Outside, 0, 0);
                }
            }
            Seen::Inside => containing += 1,
            Seen::Partly => {
                crossing.push(i as u16);
                supporting += 1;
            }
            Seen::PartlyOutside => crossing.push(i as u16),
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
