//! Views that disagree (not in the paper, which names the dependence on silhouettes as its weakness in §7.8).
//!
//! If all silhouettes and cameras are right, the hull covers every silhouette. Where it leaves a pixel of a silhouette
//! uncovered, some other silhouette wrongly excludes the space along that pixel's ray: its matte lacks a part, or its
//! camera is not where the calibration says. The views that exclude the most plausible places of the ray are to blame
//! ([`exclusion`]). A view that is to blame for many pixels of many other views is at fault ([`blame`]).

mod blame;
mod colours;
mod coverage;
mod excluders;
mod exclusion;
mod gaps;
mod lacking;
mod rays;
mod rounds;
mod stereo;

pub use lacking::{Completed, completed};
pub use rounds::{Agreement, Carving, apart, carve_agreeing};

use super::{carver::carvers, space::Space};
use crate::{
    error::Result,
    executor::Executor,
    math::{max, median},
    point_cloud::Mesh,
    progress::{self, Progress},
    silhouette::beyond_usual,
    stage::Stage,
    view::View,
    workspace::Workspace,
};
use alloc::vec::Vec;
use blame::Blame;
use coverage::Coverage;

/// Parameters of the agreement of views.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct AgreementParams {
    /// A view is at fault if the other views have at least this many uncovered pixels because of it, as a fraction of
    /// the mean length of a silhouette's contour. The two views with the most such pixels do not count, so that a matte
    /// that shows too much puts the blame on nobody.
    pub blame: f32,
    /// The camera of such a view is at fault, and not only its matte, if the hull of the others leaves more than this share
    /// of its own silhouette's rim uncovered.
    pub uncovered: f32,
    /// Largest share of the silhouettes that are set aside, less than half. If more are at fault, the calibration as a whole
    /// is in question.
    pub largest_share: f32,
}

/// Fewer pixels are never held against a view: in small pictures thin parts of the hull get lost in its grid.
const MIN_PIXELS: f32 = 50.0;

impl AgreementParams {
    /// The value of [`Self::blame`] in the presets. Ordinary noise, mattes and calibration reach half of it.
    pub const BLAME: f32 = 0.08;
}

/// A view that is believed is named if at least this share of the pixels speak against it that would be needed to set it
/// aside.
const NAMED: f32 = 0.6;

/// Views whose silhouettes contradict the others.
#[derive(Debug, Default)]
pub struct Contradicting {
    /// Their places in the rig's order, the worst one first.
    pub places: Vec<u16>,
    /// How many of them, from the first on, are at fault. The others are doubtful.
    pub certain: usize,
    /// Share of a silhouette that the hull does not cover, the median of all views.
    pub lacking: f32,
}

/// Finds the views whose silhouettes contradict the others. `mesh` is the mesh of the hull of all views that carve it; it is
/// empty if their hull is. `blame` is [`AgreementParams::blame`].
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn contradicting(
    views: &[View],
    mesh: &Mesh,
    blame: f32,
    workspace: &mut Workspace,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<Contradicting> {
    let carvers = carvers(views);
    let count = carvers.len() as u32;
    // In pixels of the carvers.
    let edges = views.iter().filter(|view| view.is_used()).filter_map(|view| view.edge);
    let octave = views.iter().map(|view| view.octave).max().unwrap_or(0);
    let off = beyond_usual(edges) / (1u32 << octave) as f32;
    let drawn = executor.map_with(&mut Vec::<Coverage>::new(), carvers.len(), |coverage, i| {
        progress::step(progress, Stage::Hull, i as u32, count)?;
        coverage.draw(mesh, &carvers[i].camera);
        let silhouette = &carvers[i].silhouette;
        // A silhouette that does not follow its picture accuses nobody.
        let is_believed = views[usize::from(carvers[i].index)].edge.is_none_or(|edge| edge.is_along());
        let uncovered = if is_believed { coverage.uncovered(silhouette, off) } else { Vec::new() };
        let share = uncovered.len() as f32 * coverage::PIXELS_PER_SAMPLE / coverage::area(silhouette).max(1) as f32;
        Ok((uncovered, (coverage::contour_length(silhouette), share)))
    });
    let (uncovered, of_views): (Vec<_>, Vec<_>) = drawn.into_iter().collect::<Result<Vec<_>>>()?.into_iter().unzip();
    let contours: u32 = of_views.iter().map(|(length, _)| length).sum();
    let limit = |share: f32| max(share * blame * contours as f32 / carvers.len().max(1) as f32, MIN_PIXELS);
    // Every uncovered pixel stands for the pixels around it that were not looked at.
    let pixels = uncovered.iter().map(|pixels| pixels.len() as f32 * coverage::PIXELS_PER_SAMPLE).sum::<f32>();
    if pixels < limit(NAMED) {
        return Ok(Contradicting::default());
    }
    let space = Space::new(&carvers, excluders::TOLERATED, workspace, executor, progress)?;
    let followed = executor
        .map(carvers.len(), |own| exclusion::follow_rays(&carvers, &space, own, &uncovered[own], off, progress));
    let mut blame = Blame::new(carvers.len());
    for (own, followed) in followed.into_iter().enumerate() {
        let (weight, sets) = followed?;
        sets.into_iter().for_each(|sets| blame.add(own as u16, weight, sets));
    }
    space.recycle_into(workspace);
    let found = blame.at_fault(limit(NAMED), carvers.len());
    let certain = found.iter().take_while(|&&(_, pixels)| pixels >= limit(1.0)).count();
    let places = found.iter().map(|&(view, _)| carvers[usize::from(view)].index).collect();
    let lacking = median(of_views.iter().map(|&(_, share)| share)).unwrap_or(0.0);
    Ok(Contradicting { places, certain, lacking })
}

#[cfg(test)]
mod tests;
