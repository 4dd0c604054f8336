//! The contour from the photograph. A matte gives the object's outline roughly, the picture gives it exactly.
//!
//! 1. Small holes and specks are kept or removed by their colours ([`islands`], [`likelihoods`]).
//! 2. Where local colour models of both sides ([`colour_model`]) contradict the matte clearly, its contour moves by whole
//!    pixels ([`labels`]). This handles mattes that are off by several pixels and fingers that grew together. Colours count
//!    only as far as they tell the sides apart ([`confusion`]).
//! 3. The contour is traced ([`trace`]). Along its normals the picture assigns a cost to every offset ([`profile`]), and
//!    so does the matte, whose bias and precision are measured where the picture is clear ([`fusion`]). The most
//!    probable offsets are a shortest path around each loop ([`path`]).
//! 4. The moved loops are rasterised as coverage ([`fill`]). The standard deviation of every piece of the contour is kept
//!    ([`uncertainty`]).
//!
//! Where both sides look alike, the matte's contour stays, corrected by the matte's bias.

mod colour_model;
mod confusion;
mod fill;
mod fusion;
mod islands;
mod labels;
mod likelihoods;
mod moved;
mod patch;
mod path;
mod profile;
mod trace;
mod uncertainty;

#[cfg(test)]
mod tests;

pub(crate) use moved::Moved;
pub use uncertainty::Uncertainty;

use super::distance::{SilhouetteScratch, signed_distance};
use alloc::{collections::VecDeque, vec::Vec};
use colour_model::{ColourModel, Trust};
use confusion::Confusion;
use fusion::Fusion;
use likelihoods::Likelihoods;
use patch::Patch;
use profile::Profiles;
use trace::Loops;
use uncertainty::Passed;

/// Pixels to learn colours from while the contour is known only roughly: preferably those deep on their side.
const ROUGH: Trust = Trust { from: 0.5, growth: 2.5, full: 5.0, to: 14.0 };
/// Pixels to learn colours from once the contour is known to about a pixel.
const NEAR: Trust = Trust { from: 1.25, growth: 3.0, full: 3.0, to: 9.0 };
/// Largest number of rounds in which the contour may move by the reach. Fewer than [`SETTLED`] pixels that moved by more
/// than half of it end the rounds.
const ROUNDS: usize = 6;
const SETTLED: usize = 12;

/// A matte with more points of contour than one in this many pixels is noise. It is left as it is, which also limits the
/// memory that refinement takes.
const MIN_PIXELS_PER_POINT: usize = 5;

/// How the picture moves a matte's contour.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct ContourParams {
    /// Largest distance in pixels by which the contour moves at a time. Where it moved by more than half of that, the
    /// search is repeated from there.
    pub reach_pixels: f32,
}

impl Default for ContourParams {
    fn default() -> Self {
        Self { reach_pixels: 4.5 }
    }
}

/// Buffers for refining one contour after another. Steps that do not overlap share them.
#[derive(Debug, Default)]
pub(crate) struct RefineScratch {
    /// Buffers of the distance.
    pub distance: SilhouetteScratch,
    /// The patch's coverage: the matte with its changes so far, at last the refined one.
    coverage: Vec<u8>,
    /// Signed distance to the matte's contour, and to the contour so far.
    given: Vec<i16>,
    near: Vec<i16>,
    colours: Likelihoods,
    islands: islands::Buffers,
    open: VecDeque<u32>,
    model: ColourModel,
    planes: [Vec<f32>; 2],
    alphas: Vec<u8>,
    confusion: Confusion,
    moved: Vec<bool>,
    trace: trace::Buffers,
    loops: Loops,
    fusion: Fusion,
    passed: Vec<Passed>,
}

/// Moves the half-level contour of a matte's `coverage` to where the picture, packed sRGB, has it. Pixels that are not
/// `known` stay. Returns how certain the contour is, in the memory of `old`, and how far it has moved. Without a contour, or
/// with one that is noise, nothing changes.
pub(crate) fn refine(
    width: usize,
    rgb: &[u8],
    coverage: &mut [u8],
    known: &dyn Fn(usize) -> bool,
    params: &ContourParams,
    scratch: &mut RefineScratch,
    old: Uncertainty,
) -> Option<(Uncertainty, Moved)> {
    let height = coverage.len() / width;
    let patch = Patch::around(width, height, rgb, coverage)?;
    let (w, h) = (patch.width, patch.height);
    let RefineScratch { distance, coverage: matte, given, near, colours, islands, open, model, planes, .. } = scratch;
    let RefineScratch { alphas, confusion, moved, trace, loops, fusion, passed, .. } = scratch;
    matte.clear();
    for y in 0..h {
        matte.extend_from_slice(&coverage[patch.index(0, y)..][..w]);
    }
    signed_distance(w, h, matte, &|_| true, distance, given);
    colours.count(&patch, given);
    if islands::settle(&patch, given, colours, matte, islands) {
        signed_distance(w, h, matte, &|_| true, distance, given);
    }

    near.clone_from(given);
    for _ in 0..ROUNDS {
        model.learn(&patch, near, colours, ROUGH);
        let buffers = labels::Buffers { planes, alphas, confusion, moved, open };
        let far = labels::relabel(&patch, near, model, params.reach_pixels, matte, buffers);
        signed_distance(w, h, matte, &|_| true, distance, near);
        if far < SETTLED {
            break;
        }
    }

    model.learn(&patch, near, colours, NEAR);
    trace::trace(w, h, near, trace, loops);
    if loops.points.len() > patch.len() / MIN_PIXELS_PER_POINT {
        return None;
    }
    let profiles = Profiles::new(&patch, near, model, planes);
    fusion.settle(loops, &profiles, given);
    let by = Moved::new(loops, &profiles, given);
    fill::fill(w, h, loops, &mut planes[0], matte);
    for y in 0..h {
        for x in 0..w {
            let i = patch.index(x, y);
            if known(i) {
                coverage[i] = matte[y * w + x];
            }
        }
    }
    Some((Uncertainty::new(&patch, height, loops, &fusion.variances, old, passed), by))
}
