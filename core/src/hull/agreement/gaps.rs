//! Thin gaps in the silhouette of a picture that was cut out along its matte, where the other views see a surface.
//!
//! Such a picture shows nothing in its gaps, so that its colours cannot tell whether the matte lacks a stripe of a dress or
//! whether one sees between two legs. The other views can: a gap is closed if stereo among them finds a surface along its
//! rays.

use super::{rays::Rays, stereo::Stereo};
use crate::{
    silhouette::{Connected, Parts, Silhouette, SilhouetteScratch},
    view::View,
};
use alloc::{vec, vec::Vec};

/// Half the width of the widest gap, in pixels.
const REACH: f32 = 12.0;
/// Edge of a square of pixels of which one ray is followed: that of the pixel farthest from the contour.
const SQUARE: usize = 4;
/// Only rays this far outside the contour count, in pixels: patches around others show mostly what is beside the gap.
const DEPTH: f32 = -2.0;
/// How far a patch reaches beyond the gap's edge, in pixels.
const BESIDE: f32 = 1.0;
/// The other views must find a surface on so many of the rays that count, and on this share of them. In captures whose
/// mattes are right, they find it on at most a fourth of the rays of any gap that has 16, for want of texture that differs.
const MIN_FOUND: u32 = 16;
const MIN_SHARE: f32 = 0.3;

/// Marks the pixels of the gaps to be closed. `None` if there is none.
pub(super) fn gaps(
    views: &[View],
    view: &View,
    silhouette: &Silhouette,
    rays: &Rays,
    scratch: &mut SilhouetteScratch,
) -> Option<Vec<bool>> {
    if !view.cut_out {
        return None;
    }
    let (w, h) = (silhouette.width as usize, silhouette.height as usize);
    let (narrow, distances) = (silhouette.narrow(REACH, scratch), silhouette.distances());
    let (columns, rows) = (w.div_ceil(SQUARE), h.div_ceil(SQUARE));
    let pixels = |square: usize| {
        let (x, y) = (square % columns * SQUARE, square / columns * SQUARE);
        let row = move |y: usize| (x..(x + SQUARE).min(w)).map(move |x| y * w + x);
        (y..(y + SQUARE).min(h)).flat_map(row).filter(|&i| narrow[i])
    };
    // Of every square in a gap whose ray meets the hull of the other views, the pixel of the ray.
    let meets = |&i: &usize| rays.meets((i % w) as f32, (i / w) as f32);
    let followed = |square: usize| pixels(square).min_by_key(|&i| distances[i]).filter(meets);
    let followed: Vec<Option<usize>> = (0..columns * rows).map(followed).collect();
    let mut gaps = Parts::default();
    gaps.find(columns, rows, Connected::Corners, |square| followed[square].map(|_| false));

    let stereo = Stereo { views, rays };
    // Of every gap, the number of rays that count, and on how many of them there is a surface.
    let mut counts = vec![(0u32, 0u32); gaps.list.len()];
    for (square, pixel) in followed.iter().enumerate() {
        let (Some(i), Some(gap)) = (*pixel, gaps.of(square)) else { continue };
        let distance = f32::from(distances[i]) / Silhouette::UNITS;
        if distance <= DEPTH {
            let found = stereo.finds_surface((i % w) as f32, (i / w) as f32, BESIDE - distance);
            counts[gap].0 += 1;
            counts[gap].1 += u32::from(found);
        }
    }
    let close = |(rays, found): (u32, u32)| found >= MIN_FOUND && found as f32 >= MIN_SHARE * rays as f32;
    if !counts.iter().any(|&counts| close(counts)) {
        return None;
    }
    let mut added = vec![false; w * h];
    let closed = (0..followed.len()).filter(|&square| gaps.of(square).is_some_and(|gap| close(counts[gap])));
    closed.flat_map(pixels).for_each(|i| added[i] = true);
    Some(added)
}

#[cfg(test)]
mod tests {
    use super::{super::super::carver::carvers, *};
    use crate::testing::{pinhole, ring, silhouette_of};
    use alloc::sync::Arc;
    use glam::Vec3;

    const SIZE: u32 = 240;

    /// Cut-out pictures of balls with a solid texture. The texture's finest waves are some pixels long.
    fn views(balls: &[(Vec3, f32)]) -> Vec<View> {
        let places = ring(31, 4.0, 0.4).enumerate();
        places.map(|(i, from)| photograph(balls, i as u16, from)).collect()
    }

    fn photograph(balls: &[(Vec3, f32)], index: u16, from: Vec3) -> View {
        let camera = pinhole(from, Vec3::ZERO, SIZE, 520.0);
        let level = |i: u32| {
            let ray = camera.ray((i % SIZE) as f32, (i / SIZE) as f32).normalize();
            let hit = balls.iter().filter_map(|&(centre, radius)| {
                let to = centre - camera.centre;
                let along = to.dot(ray);
                let root = radius * radius - (to - ray * along).length_squared();
                (root > 0.0).then(|| along - libm::sqrtf(root))
            });
            let depth = hit.fold(f32::INFINITY, f32::min);
            if depth == f32::INFINITY {
                return 255;
            }
            let p = (camera.centre + ray * depth) * 40.0;
            let waves = [(p.x + 2.1 * p.y, 0.7 * p.z), (1.3 * p.z - p.x, p.y), (2.0 * p.y + p.z, 1.7 * p.x)];
            (120.0 + waves.iter().map(|&(a, b)| 25.0 * libm::sinf(a) * libm::cosf(b)).sum::<f32>()) as u8
        };
        let luma: Vec<u8> = (0..SIZE * SIZE).map(level).collect();
        let rgb = luma.iter().flat_map(|&v| [v; 3]).collect();
        View { rgb, luma, cut_out: true, ..silhouette_of(balls, &camera, index) }
    }

    /// Takes a stripe out of a view's matte and its picture.
    fn cut_stripe(view: &mut View, columns: core::ops::Range<usize>, rows: core::ops::Range<usize>) {
        let w = SIZE as usize;
        let given = view.silhouette.as_ref().expect("it has one").distances();
        let mut coverage: Vec<u8> = given.iter().map(|&d| if d > 0 { 255 } else { 0 }).collect();
        for i in rows.flat_map(|y| columns.clone().map(move |x| y * w + x)) {
            coverage[i] = 0;
            view.luma[i] = 255;
            view.rgb[3 * i..][..3].fill(255);
        }
        let silhouette = Silhouette::from_coverage(SIZE, SIZE, &coverage, |_| true).expect("a contour");
        view.silhouette = Some(Arc::new(silhouette));
    }

    /// The gaps of the first view, in pixels.
    fn closed(views: &[View]) -> Option<usize> {
        let carvers = carvers(views);
        let bounds = (Vec3::splat(-0.9), Vec3::splat(0.9));
        let rays = Rays { carvers: &carvers, own: 0, bounds, footprint: 4.0 / 520.0 };
        let silhouette = views[0].silhouette.as_ref().expect("it has one");
        gaps(views, &views[0], silhouette, &rays, &mut SilhouetteScratch::default())
            .map(|added| added.iter().filter(|&&a| a).count())
    }

    /// A stripe that one matte lacks, of 10 by 80 pixels, is added: the other views see the ball there. If the picture was not
    /// cut out, the stripe is left to its colours.
    #[test]
    fn a_stripe_that_a_matte_lacks_is_closed() {
        let mut views = views(&[(Vec3::ZERO, 0.5)]);
        assert_eq!(closed(&views), None);
        cut_stripe(&mut views[0], 122..132, 80..160);
        let pixels = closed(&views).expect("the stripe is closed");
        assert!((760..=960).contains(&pixels), "{pixels} pixels");
        views[0].cut_out = false;
        assert_eq!(closed(&views), None);
    }

    /// Between two walls of balls one view alone sees a gap of 10 pixels. The hull of the others fills it, but they see no
    /// surface there.
    #[test]
    fn a_gap_that_one_view_alone_sees_stays_open() {
        let places = (0..45).map(|i| Vec3::new(0.15 * (i % 9) as f32 - 0.6, 0.0, 0.15 * (i / 9) as f32 - 0.3));
        let sides = Vec3::new(0.0, 0.24, 0.0);
        let balls: Vec<(Vec3, f32)> = places.flat_map(|p| [(p + sides, 0.2), (p - sides, 0.2)]).collect();
        let views = views(&balls);
        let carvers = carvers(&views);
        let (bounds, footprint) = ((Vec3::splat(-0.9), Vec3::splat(0.9)), 4.0 / 520.0);
        let middle = (SIZE / 2) as f32;
        assert!(Rays { carvers: &carvers, own: 0, bounds, footprint }.meets(middle, middle));
        assert_eq!(closed(&views), None);
    }
}
