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

mod backdrop;
mod blur;
mod body;
mod border;
mod chamfer;
mod colours;
mod histogram;
mod light;
mod likeness;
mod paint;
mod potts;
mod spill;
mod surroundings;

pub(super) use border::is_border;
pub(super) use likeness::Likeness;
pub(super) use paint::Paint;

use alloc::{vec, vec::Vec};
use colours::Colours;

/// The pixels of the object, from how each pixel compares with the paint.
pub(super) fn object(w: usize, h: usize, rgb: &[u8], likeness: &[Likeness]) -> Vec<bool> {
    let colours = Colours::new(w, h, rgb);
    if !border::spans_a_side(w, h, |i| likeness[i] != Likeness::Paint) {
        let other = likeness.iter().map(|&likeness| likeness == Likeness::Other).collect();
        return spill::add(w, &colours, likeness, other);
    }
    let Some(core) = body::find(w, h, &colours, likeness) else { return vec![false; w * h] };
    surroundings::add(w, h, &colours, likeness, core)
}
