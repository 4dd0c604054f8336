//! Which pixels a keyed backdrop leaves to the object (§0).
//!
//! A stage may have more than the painted backdrop: a dark wall above a green floor, for example. Such a wall has no
//! colour that a key could name. It is learned from the picture itself.
//!
//! 1. Each pixel is compared with the local colour of each painted backdrop ([`paint`]). It is backdrop, or similar to
//!    it, or neither.
//! 2. Pixels that are similar to the paint but lie away from it are the object's if its colours explain them better: light
//!    that the backdrop throws on white cloth ([`spill`]).
//! 3. If pixels that are not paint span a side of the picture, they belong to a wall. Colours that are rare at the
//!    picture's border are the object's core ([`body`]); what surrounds the core and is rare on the wall belongs to it,
//!    too ([`surroundings`]).

mod blur;
mod body;
mod chamfer;
mod colours;
mod histogram;
mod light;
mod likeness;
mod paint;
mod parts;
mod potts;
mod spill;
mod surroundings;

pub(super) use likeness::{Likeness, is_border};
pub(super) use paint::{Paint, from_gray};

use ::core::ops::Range;
use alloc::vec::Vec;
use colours::Colours;
use likeness::border;

/// A wall covers at least this share of one side of the border, and of its two corners, which are squares of this share of
/// its length. An object that leaves the picture covers a side's middle. On a dark wall, noise is paint here and there.
const WALL: f32 = 0.5;
const CORNER: f32 = 0.15;

/// The pixels of the object, from how each pixel compares with the paint.
pub(super) fn object(w: usize, h: usize, rgb: &[u8], likeness: &[Likeness]) -> Vec<bool> {
    let other: Vec<bool> = likeness.iter().map(|&l| l == Likeness::Other).collect();
    let colours = Colours::new(w, h, rgb);
    let unpainted: Vec<bool> = likeness.iter().map(|&l| l != Likeness::Paint).collect();
    if !spans_a_side(w, h, &unpainted) {
        return spill::add(w, &colours, likeness, other);
    }
    let Some(core) = body::find(w, h, &colours, likeness) else { return alloc::vec![false; w * h] };
    surroundings::add(w, h, &colours, likeness, core)
}

/// Whether pixels that are not paint cover most of one side of the border and of its corners.
fn spans_a_side(w: usize, h: usize, unpainted: &[bool]) -> bool {
    let covered = |xs: Range<usize>, ys: Range<usize>| {
        let pixels = xs.len() * ys.len();
        let found = ys.map(|y| xs.clone().filter(|x| unpainted[y * w + x]).count()).sum::<usize>();
        found as f32 > WALL * pixels as f32
    };
    let edge = border(w, h);
    let corner = ((CORNER * w.min(h) as f32) as usize).max(1);
    let (left, right, top, bottom) = (0..corner, w - corner..w, 0..corner, h - corner..h);
    let corners = [(&left, &top), (&right, &top), (&left, &bottom), (&right, &bottom)];
    let [lt, rt, lb, rb] = corners.map(|(xs, ys)| covered(xs.clone(), ys.clone()));
    (lt && rt && covered(0..w, 0..edge))
        || (lb && rb && covered(0..w, h - edge..h))
        || (lt && lb && covered(0..edge, 0..h))
        || (rt && rb && covered(w - edge..w, 0..h))
}
