//! Whether the picture shows the object's edge along a silhouette's contour, or elsewhere.
//!
//! The object's outline is an edge of the picture. The strength of the picture's edges, as a mean over all pixels at the same
//! distance from the contour, has a sharp peak at the contour. With a mask that is too wide the peak lies inside, and with one
//! that is too narrow outside. Texture and backdrop have edges at all distances and make no peak.

use super::{Silhouette, refine::Moved};
use crate::{
    math::{max, min, sqrt},
    sort::short_by,
};

/// Largest distance from the contour that is looked at, in pixels.
const REACH: usize = 24;
/// The contour's own edge lies within so many pixels of it.
const OWN: usize = 2;
/// From this distance on, an edge is another one, in pixels. Between the two is the flank of the contour's own.
const OTHER: usize = 4;
/// Distances with fewer pixels than those at the contour over this count for nothing, as in the middle of thin limbs.
const FEWER: f32 = 4.0;
/// Least number of distances that tell what is usual on a side.
const LEAST: usize = 3;
/// A picture shows no edge along a contour if what is usual around it is stronger than this share of its own edge.
const WITHOUT: f32 = 0.35;
/// Least strength of an edge to compare with, in grey levels per pixel.
const FAINT: f32 = 1.0;

/// What a picture shows around a silhouette's contour.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ContourEdge {
    /// Distance from the contour to the strongest other edge that runs along it, in pixels of the picture as it was given,
    /// positive inside.
    pub other: f32,
    /// How far that edge stands out from what is usual around it, over how far the contour's own edge does. Good contours
    /// have less than 0.15.
    pub strength: f32,
    /// Strength of the edges that are usual on both sides, over that of the contour's own edge. Good contours have less than
    /// 0.1, and those that have nothing to do with the picture about 1.
    pub usual: f32,
    /// How far the picture has moved the contour of the mask, the median in pixels of the picture as it was given, positive
    /// inwards.
    pub moved: f32,
    /// Shares of the contour that the picture has moved by more than two pixels of the picture as it was read: inwards, and
    /// outwards.
    pub far: [f32; 2],
    /// Width of the contour's own edge at half its height, in pixels of the picture as it was given. In focus it is 2 or 3,
    /// and a lens out of focus or a moving camera makes it wide.
    pub width: f32,
}

/// Mean strength of the edges at every distance from the contour, in grey levels per pixel.
struct Profile {
    /// By distance in pixels, from `-REACH` to `REACH`.
    means: [f32; 2 * REACH + 1],
    counts: [f32; 2 * REACH + 1],
}

impl ContourEdge {
    /// That of a picture, packed sRGB, that was read at an octave and has moved the mask's contour. `None` if too little of
    /// it lies around the contour.
    pub(crate) fn new(rgb: &[u8], silhouette: &Silhouette, octave: u32, moved: Moved) -> Option<Self> {
        let profile = Profile::new(rgb, silhouette);
        let own = profile.own()?;
        let sides = [true, false].map(|inside| profile.side(inside, own));
        // The contour's edge is as wide as it stands out on both sides: texture of the object is no part of it.
        let texture = sides.iter().flatten().map(|side| side.usual).fold(0.0, max) * max(own[0], FAINT);
        let found = match sides {
            // Only both sides together tell that there is no edge.
            [Some(a), Some(b)] => Self { usual: min(a.usual, b.usual), ..if b.strength > a.strength { b } else { a } },
            [side, None] | [None, side] => Self { usual: 0.0, ..side? },
        };
        let scale = (1u32 << octave) as f32;
        Some(Self {
            other: found.other * scale,
            moved: moved.median * scale,
            far: moved.far,
            width: profile.width(texture) * scale,
            ..found
        })
    }

    /// Whether the picture shows an edge along the contour.
    pub fn is_along(&self) -> bool {
        self.usual <= WITHOUT
    }
}

impl Profile {
    fn new(rgb: &[u8], silhouette: &Silhouette) -> Self {
        let mut profile = Self { means: [0.0; 2 * REACH + 1], counts: [0.0; 2 * REACH + 1] };
        let (w, h) = (silhouette.width as usize, silhouette.height as usize);
        let d = silhouette.distances();
        let limit = (REACH as f32 * Silhouette::UNITS) as u16;
        for y in 1..h - 1 {
            for i in y * w + 1..(y + 1) * w - 1 {
                if d[i].unsigned_abs() > limit {
                    continue;
                }
                // Twice the gradient of the distance, of length 2 except where pieces of the contour are equally near, or
                // where the distance is not known.
                let across = |step: usize| (f32::from(d[i + step]) - f32::from(d[i - step])) / Silhouette::UNITS;
                let normal = [across(1), across(w)];
                let length = sqrt(normal[0] * normal[0] + normal[1] * normal[1]);
                if !(1.0..3.0).contains(&length) {
                    continue;
                }
                let strength = |c: usize| {
                    let change = |step: usize| f32::from(rgb[3 * (i + step) + c]) - f32::from(rgb[3 * (i - step) + c]);
                    (change(1) * normal[0] + change(w) * normal[1]).abs()
                };
                let bin = (f32::from(d[i]) / Silhouette::UNITS + REACH as f32 + 0.5) as usize;
                // The mean of three channels, over two pixels.
                profile.means[bin] += (strength(0) + strength(1) + strength(2)) / (6.0 * length);
                profile.counts[bin] += 1.0;
            }
        }
        profile.means.iter_mut().zip(&profile.counts).for_each(|(mean, count)| *mean /= max(*count, 1.0));
        profile
    }

    /// Strength of the contour's own edge, and the mean number of its pixels per distance.
    fn own(&self) -> Option<[f32; 2]> {
        let near = REACH - OWN..=REACH + OWN;
        let count = self.counts[near.clone()].iter().sum::<f32>() / (2 * OWN + 1) as f32;
        let strongest = self.means[near].iter().copied().fold(0.0, max);
        (count > 0.0).then_some([strongest, count])
    }

    /// Width of the contour's own edge in pixels: so many neighbouring distances have more than half of its height above what
    /// is usual, in grey levels per pixel.
    fn width(&self, usual: f32) -> f32 {
        let mut top = REACH - OWN;
        (top..=REACH + OWN).for_each(|at| {
            if self.means[at] > self.means[top] {
                top = at
            }
        });
        let is_high = |mean: &&f32| **mean > (self.means[top] + usual) / 2.0;
        let inside = self.means[top..].iter().take_while(is_high).count();
        let outside = self.means[..top].iter().rev().take_while(is_high).count();
        (inside + outside) as f32
    }

    /// The strongest edge on one side of the contour, and what is usual there. The flank of the contour's own edge, which is
    /// wide in a picture out of focus, is no other edge: an edge is stronger than what is nearer to the contour.
    fn side(&self, inside: bool, [own, count]: [f32; 2]) -> Option<ContourEdge> {
        let bin = |distance: usize| if inside { REACH + distance } else { REACH - distance };
        let seen = (OTHER..=REACH).filter(|&distance| FEWER * self.counts[bin(distance)] >= count);
        // Without a vector, because views are read without allocations.
        let (mut sorted, mut found) = ([0.0; REACH], 0);
        let mut strongest = None;
        for distance in seen {
            let mean = self.means[bin(distance)];
            sorted[found] = mean;
            found += 1;
            let is_peak = mean > self.means[bin(distance - 1)];
            if is_peak && strongest.is_none_or(|before| mean > self.means[bin(before)]) {
                strongest = Some(distance);
            }
        }
        if found < LEAST {
            return None;
        }
        short_by(&mut sorted[..found], f32::total_cmp);
        let usual = sorted[found / 2];
        let other = strongest.unwrap_or(OTHER);
        let height = strongest.map_or(0.0, |distance| self.means[bin(distance)] - usual);
        Some(ContourEdge {
            other: if inside { other as f32 } else { -(other as f32) },
            strength: height / max(own - usual, FAINT),
            usual: usual / max(own, FAINT),
            ..ContourEdge::default()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    const SIZE: u32 = 160;

    /// What a picture of a patterned disc of radius 50 before a patterned backdrop shows around the contour of another disc.
    fn around(radius: f32) -> ContourEdge {
        around_edge(radius, 0.0)
    }

    /// The same, where the disc's edge is a ramp that is so many pixels wide.
    fn around_edge(radius: f32, ramp: f32) -> ContourEdge {
        let distance = |i: u32| libm::hypotf((i % SIZE) as f32 - 79.3, (i / SIZE) as f32 - 80.1);
        let pattern = |i: u32| ((i % SIZE / 5 + i / SIZE / 4) % 2 * 12) as u8;
        let inside = |i: u32| ((50.0 - distance(i)) / max(ramp, 1e-3) + 0.5).clamp(0.0, 1.0);
        let level = |i: u32| pattern(i) + (60.5 + 90.0 * inside(i)) as u8;
        let rgb: Vec<u8> = (0..SIZE * SIZE).flat_map(|i| [level(i); 3]).collect();
        let mask: Vec<u8> = (0..SIZE * SIZE).map(|i| if distance(i) < radius { 255 } else { 0 }).collect();
        let silhouette = Silhouette::from_coverage(SIZE, SIZE, &mask, |_| true).expect("there is a disc");
        ContourEdge::new(&rgb, &silhouette, 0, Moved::default()).expect("there is room on both sides")
    }

    #[test]
    fn a_contour_along_the_edge_has_no_other() {
        let found = around(50.0);
        assert!(found.strength < 0.15 && found.usual < 0.2, "{found:?}");
    }

    #[test]
    fn the_edge_beside_a_contour_is_found_on_its_side() {
        for off in [-18.0, -7.0, 7.0, 18.0] {
            let found = around(50.0 + off);
            assert!(found.strength > 2.0 && (found.other - off).abs() < 1.1, "{off}: {found:?}");
        }
    }

    #[test]
    fn a_blurred_edge_is_wide_and_not_another_one() {
        for ramp in [0.0, 6.0, 12.0] {
            let found = around_edge(50.0, ramp);
            assert!((found.width - max(ramp, 2.0)).abs() <= 2.0 && found.strength < 0.15, "{ramp}: {found:?}");
        }
    }

    #[test]
    fn a_contour_far_from_any_edge_is_no_stronger_than_what_is_usual() {
        let found = around(20.0);
        assert!(found.usual > 0.5, "{found:?}");
    }
}
