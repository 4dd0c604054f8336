//! What surrounds the core of the object and belongs to it: dark hair in front of a dark wall, for example.
//!
//! The wall is learned at some distance from the core. Colours that occur near the core clearly more often than the
//! wall there explains are the object's. A wall may look different just behind the object. What is taken for the object
//! then is carved off by the hull of the other views, while nothing brings back what is missing. In doubt a pixel
//! therefore belongs to the object.

use super::{
    blur::blur,
    body::{CLAMP, PART},
    chamfer::{STEP, distances},
    colours::Colours,
    histogram::{FLOOR, Histogram},
    light::LightField,
    likeness::Likeness,
    potts,
};
use crate::math::{from_ordered, ordered, select};
use crate::silhouette::parts::{Connected, Parts, keep_large};
use alloc::{vec, vec::Vec};

/// Distances from the core as shares of its diagonal: up to the first a pixel may belong to the object, from there to the
/// second is the wall around it. The wall's light is measured from the third on.
const NEAR: f32 = 0.18;
const AROUND: f32 = 0.36;
const LIT: f32 = 0.08;
/// A colour is the object's as far as it is more frequent near the core than this many times its frequency on the wall.
const EXCESS: f32 = 1.5;
/// Quantile of the pixels near the core, by how much more frequent their colours are there than on the wall, that is
/// certainly wall.
const WALL_QUANTILE: f32 = 0.4;
/// Limits of the share of the object's pixels near the core.
const SHARES: [f32; 2] = [0.1, 0.5];
/// Radii of the windows over which the evidence is averaged, in pixels.
const FINE: usize = 1;
const COARSE: usize = 4;
const ROUNDS: usize = 3;
/// Notches in what was added that are up to twice this share of the diagonal wide are closed. So are holes of less than
/// this share of the core's pixels, unless paint covers this share of them.
const NOTCH: f32 = 0.02;
const HOLE: f32 = 0.01;
const PAINTED: f32 = 0.3;

/// Adds to the core what belongs to the object around it.
pub(super) fn add(w: usize, h: usize, colours: &Colours, likeness: &[Likeness], core: Vec<bool>) -> Vec<bool> {
    let diagonal = diagonal(w, &core);
    let distance = distances(w, h, &|i| core[i]);
    let limit = |share: f32| (share * diagonal * STEP as f32) as u32;
    let (near, around, lit) = (limit(NEAR), limit(AROUND), limit(LIT));
    let paint = |i: usize| likeness[i] == Likeness::Paint;
    let light = LightField::fit(w, h, |i| distance[i] > lit && likeness[i] == Likeness::Other, |i| colours.light[i]);
    let bins: Vec<u32> = (0..w * h).map(|i| colours.bin(i, light.at(i)) as u32).collect();
    let bin = |i: usize| bins[i] as usize;
    let beyond = || (0..w * h).filter(|&i| !paint(i) && distance[i] > near);
    let far = Histogram::of_pixels(beyond(), bin);
    let ring = Histogram::of_pixels(beyond().filter(|&i| distance[i] <= around), bin);
    let wall = |bin: usize| far.probability(bin).max(ring.probability(bin));

    // The doubtful pixels.
    let open: Vec<u32> =
        (0..w * h).filter(|&i| distance[i] > 0 && distance[i] <= near && !paint(i)).map(|i| i as u32).collect();
    if open.is_empty() {
        return core;
    }
    let open_pixels = || open.iter().map(|&i| i as usize);
    let all = Histogram::of_pixels(open_pixels(), bin);
    let scale = wall_scale(&all, &wall, open_pixels().map(bin));
    let excess = |bin: usize| {
        let here = all.weights[bin];
        if here > 0.0 { ((here - EXCESS * scale * wall(bin)) / here).max(0.0) } else { 0.0 }
    };
    // At first the colours by their excess, then those of what was found.
    let mut front = Histogram::new(open_pixels().map(|i| (bin(i), excess(bin(i)))));
    let mut object = Vec::new();
    for round in 0..ROUNDS {
        if round > 0 {
            front = Histogram::of_pixels(open_pixels().filter(|&i| object[i]), bin);
        }
        let share = (front.total / open.len() as f32).clamp(SHARES[0], SHARES[1]);
        let mut fine: Vec<f32> = core.iter().map(|&core| if core { CLAMP } else { -CLAMP }).collect();
        for i in open_pixels() {
            let bin = bin(i);
            let ratio = (share * front.probability(bin) + FLOOR) / ((1.0 - share) * wall(bin) + FLOOR);
            fine[i] = libm::logf(ratio).clamp(-CLAMP, CLAMP);
        }
        let mut coarse = fine.clone();
        blur(w, h, &mut fine, FINE);
        blur(w, h, &mut coarse, COARSE);
        let evidence: Vec<f32> = (0..w * h).map(|i| if paint(i) { -CLAMP } else { fine[i] + coarse[i] }).collect();
        object = potts::label(w, h, &evidence);
        keep_large(w, h, &mut object, PART);
    }
    // A gap of the core, as below an arm, is seen through. Only gaps of what was added to it are closed.
    let added = distances(w, h, &|i| object[i] && !core[i]);
    close(w, h, &mut object, limit(NOTCH), |i| added[i] < distance[i] && distance[i] <= near && !paint(i));
    fill(w, h, &mut object, core.iter().filter(|&&c| c).count(), paint);
    object
}

/// Diagonal in pixels of the rectangle around the object.
fn diagonal(w: usize, object: &[bool]) -> f32 {
    let pixels = || (0..object.len()).filter(|&i| object[i]);
    let span = |at: &dyn Fn(usize) -> usize| {
        let (low, high) = pixels().fold((usize::MAX, 0), |(low, high), i| (low.min(at(i)), high.max(at(i))));
        high.saturating_sub(low) as f32
    };
    libm::hypotf(span(&|i| i % w), span(&|i| i / w))
}

/// Number of wall pixels among those near the core: their weight over the wall's probability, in colours that are hardly
/// more frequent near the core.
fn wall_scale(all: &Histogram, wall: &impl Fn(usize) -> f32, bins: impl Iterator<Item = usize>) -> f32 {
    let mut ratios: Vec<u32> = bins.map(|bin| ordered(all.weights[bin] / wall(bin).max(FLOOR))).collect();
    let middle = (WALL_QUANTILE * ratios.len() as f32) as usize;
    let middle = middle.min(ratios.len() - 1);
    from_ordered(select(&mut ratios, middle))
}

/// Closes notches and gaps up to twice `radius` wide, in thirds of a pixel, where `may`.
fn close(w: usize, h: usize, object: &mut [bool], radius: u32, may: impl Fn(usize) -> bool) {
    let out = distances(w, h, &|i| object[i]);
    let deep = distances(w, h, &|i| out[i] > radius);
    for (i, object) in object.iter_mut().enumerate() {
        *object |= deep[i] > radius && may(i);
    }
}

/// Fills small holes through which the paint does not show.
fn fill(w: usize, h: usize, object: &mut [bool], core: usize, paint: impl Fn(usize) -> bool) {
    let parts = Parts::of_side(w, h, object, false, Connected::Sides);
    let mut painted = vec![0u32; parts.list.len()];
    (0..w * h).filter(|&i| paint(i)).filter_map(|i| parts.of(i)).for_each(|part| painted[part] += 1);
    for (i, object) in object.iter_mut().enumerate() {
        if let Some(part) = parts.of(i) {
            let size = parts.list[part].pixels as f32;
            *object = size < HOLE * core as f32 && (painted[part] as f32) < PAINTED * size;
        }
    }
}
