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
mod lacking;

pub use lacking::{Completed, completed};

use super::{carver::Carver, space::Space};
use crate::{
    camera::Pinhole, error::Result, math::max, point_cloud::Mesh, progress::Progress, silhouette::Silhouette,
    view::View, workspace::Workspace,
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
    /// Largest share of the silhouettes that are set aside. If more are at fault, the calibration as a whole is in question.
    pub largest_share: f32,
}

/// Fewer pixels are never held against a view: in small pictures thin parts of the hull get lost in its grid.
const MIN_PIXELS: f32 = 50.0;

impl AgreementParams {
    /// The value of [`Self::blame`] in the presets. Ordinary noise, mattes and calibration reach half of it.
    pub const BLAME: f32 = 0.08;
}

/// The places in the rig's order of the views whose silhouettes contradict the others, in ascending order. `mesh` is the
/// mesh of the hull of all views that carve it; it is empty if their hull is. `blame` is [`AgreementParams::blame`]. There
/// are at most `most`, the worst.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn contradicting(
    views: &[View],
    mesh: &Mesh,
    blame: f32,
    most: usize,
    workspace: &mut Workspace,
    progress: &dyn Progress,
) -> Result<Vec<u16>> {
    let carvers: Vec<Carver> = views.iter().filter_map(Carver::new).collect();
    let mut uncovered: Vec<Vec<[u16; 2]>> = Vec::with_capacity(carvers.len());
    let (mut coverage, mut contours) = (Coverage::default(), 0);
    for carver in &carvers {
        coverage.draw(mesh, &carver.camera);
        uncovered.push(coverage.uncovered(&carver.silhouette));
        contours += coverage::contour_length(&carver.silhouette);
    }
    let limit = max(blame * contours as f32 / carvers.len().max(1) as f32, MIN_PIXELS);
    // Every uncovered pixel stands for the pixels around it that were not looked at.
    let pixels = uncovered.iter().map(|pixels| pixels.len() as f32 * coverage::PIXELS_PER_SAMPLE).sum::<f32>();
    if most == 0 || pixels < limit {
        return Ok(Vec::new());
    }
    let space = Space::new(&carvers, excluders::TOLERATED, workspace, progress)?;
    let mut verdict = Verdict::new(carvers.len());
    for (own, pixels) in uncovered.iter().enumerate() {
        witness::hear(&carvers, &space, own, pixels, &mut verdict, progress)?;
    }
    space.recycle_into(workspace);
    let mut guilty: Vec<u16> = verdict.guilty(limit, most).into_iter().map(|g| carvers[g as usize].index).collect();
    guilty.sort_unstable();
    Ok(guilty)
}

/// Share of a silhouette's rim that the hull leaves uncovered. `mesh` is the hull's mesh.
pub fn uncovered_share(camera: &Pinhole, silhouette: &Silhouette, mesh: &Mesh) -> f32 {
    let mut coverage = Coverage::default();
    coverage.draw(mesh, camera);
    coverage.uncovered_rim(silhouette)
}

#[cfg(test)]
mod tests;
