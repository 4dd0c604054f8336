//! Finds cameras whose pictures are exchanged: each silhouette fits the hull of the others as the other camera sees it.

use super::comparison::compare;
use crate::{
    error::Result,
    executor::Executor,
    point_cloud::Mesh,
    progress::Progress,
    sort::{short, short_by},
    view::View,
};
use alloc::{vec, vec::Vec};

/// Only views whose silhouettes overlap with the hull by less than this are suspected,
const SUSPICIOUS: f32 = 0.95;
/// and at most so many of them, those that overlap least.
const MOST: usize = 8;
/// Exchanged silhouettes overlap with the hull by at least this,
const CONVINCING: f32 = 0.85;
/// and what does not overlap shrinks to at most this share.
const REMAINING: f32 = 0.4;

/// Pairs of places in the rig's order whose silhouettes fit when they are exchanged, the first of each pair in ascending order.
/// Views are suspected if they do not carve although they have a silhouette. `mesh` is the mesh of the hull of the others.
///
/// A silhouette is compared as it is, although lens distortion was undone with the other camera's lens. Cameras with pictures
/// of different sizes cannot be exchanged unnoticed.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn exchanged(
    views: &[View],
    mesh: &Mesh,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<Vec<[u16; 2]>> {
    let not_carving = |view: &&View| (!view.is_used() || view.is_set_aside()) && view.silhouette_as_given().is_some();
    let all: Vec<&View> = views.iter().filter(not_carving).collect();
    let own = overlaps(all.iter().map(|view| in_place_of(view, view)).collect(), mesh, executor, progress)?;
    let mut suspects: Vec<(f32, &View)> = own.into_iter().zip(all).filter(|(own, _)| *own < SUSPICIOUS).collect();
    short_by(&mut suspects, |(a, one), (b, other)| a.total_cmp(b).then(one.index.cmp(&other.index)));
    suspects.truncate(MOST);
    let mut fitting: Vec<(f32, [u16; 2])> = Vec::new();
    for (i, &(own_a, a)) in suspects.iter().enumerate() {
        for &(own_b, b) in &suspects[..i] {
            if (a.camera.width, a.camera.height) != (b.camera.width, b.camera.height) {
                continue;
            }
            let found = overlaps(vec![in_place_of(a, b), in_place_of(b, a)], mesh, executor, progress)?;
            let fits = |found: f32, own: f32| found >= CONVINCING && 1.0 - found <= REMAINING * (1.0 - own);
            // Both silhouettes are taken from the other camera.
            if fits(found[0], own_a) && fits(found[1], own_b) {
                fitting.push((found[0] + found[1], [a.index.min(b.index), a.index.max(b.index)]));
            }
        }
    }
    short_by(&mut fitting, |(a, one), (b, other)| b.total_cmp(a).then(one.cmp(other)));
    let mut pairs: Vec<[u16; 2]> = Vec::new();
    for (_, pair) in fitting {
        if pairs.iter().flatten().all(|place| !pair.contains(place)) {
            pairs.push(pair);
        }
    }
    short(&mut pairs);
    Ok(pairs)
}

/// The first view's camera with the second view's silhouette.
fn in_place_of(camera: &View, silhouette: &View) -> View {
    View::of_silhouette(camera.index, camera.camera, silhouette.silhouette_as_given().cloned())
}

fn overlaps(views: Vec<View>, mesh: &Mesh, executor: &dyn Executor, progress: &dyn Progress) -> Result<Vec<f32>> {
    let found = compare(&views, mesh, executor, progress)?;
    Ok(found.into_iter().map(|found| found.overlap.unwrap_or(0.0)).collect())
}
