//! Carves the hull from the views that agree: views that contradict the others are found, and the hull is carved again
//! without their silhouettes.

use super::{AgreementParams, contradicting, coverage::Coverage};
use crate::{
    error::{Error, Result},
    executor::Executor,
    point_cloud::Mesh,
    progress::Progress,
    rig::MIN_VIEWS,
    sort::short,
    view::View,
    workspace::Workspace,
};
use alloc::vec::Vec;
use core::mem::take;

/// What is carved.
pub trait Carving {
    /// Carves the hull from the silhouettes that the views have now.
    ///
    /// # Errors
    /// [`Error::EmptyHull`], after which the hull is carved again if a silhouette is at fault, and others.
    fn carve(&mut self, executor: &dyn Executor, progress: &dyn Progress) -> Result<()>;

    /// The views, the mesh of the hull, and working memory.
    fn parts(&mut self) -> (&mut [View], &mut Mesh, &mut Workspace);
}

/// So large a share of the silhouettes is set aside even if some of the rest still contradict the others. More of them are only
/// if the rest agree.
const UNCONFIRMED: f32 = 0.25;
/// More are set aside only if the hull lacks more than this share of half of the silhouettes, and in at most so many more rounds.
const SEVERE: f32 = 0.05;
const FURTHER_ROUNDS: u32 = 2;

/// What is known about the silhouettes that were carved.
#[derive(Debug, Default)]
pub struct Agreement {
    /// Places in the rig's order of views that are believed although they contradict others, in ascending order.
    pub contradicting: Vec<u16>,
    /// Whether more views are at fault than may be set aside, and the hull lacks much of what the silhouettes show: it is not
    /// known which ones are.
    pub too_many: bool,
}

/// Carves, and sets aside the silhouettes that contradict the others ([`View::given`]) in at most `rounds` rounds, and a few more
/// if many do. Without `params` all are believed.
///
/// # Errors
/// Those of carving.
pub fn carve_agreeing(
    carving: &mut dyn Carving,
    params: Option<&AgreementParams>,
    rounds: u32,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<Agreement> {
    let silhouettes = carving.parts().0.iter().filter(|view| view.is_used() && view.silhouette.is_some()).count();
    let share = params.map_or(0.0, |params| params.largest_share);
    let most = |share: f32| ((share * silhouettes as f32) as usize).min(silhouettes.saturating_sub(MIN_VIEWS as usize));
    let (unconfirmed, all) = (most(share.min(UNCONFIRMED)), most(share));
    let blame = params.map_or(AgreementParams::BLAME, |params| params.blame);
    let mut set_aside: Vec<u16> = Vec::new();
    let (mut room, mut rounds_left, mut too_many) = (unconfirmed, rounds, false);
    loop {
        let carved = carving.carve(executor, progress);
        let (views, mesh, workspace) = carving.parts();
        match carved {
            Ok(()) => {}
            Err(Error::EmptyHull) if rounds_left > 0 => take(mesh).recycle_into(workspace),
            Err(error) => return Err(error),
        }
        let found = contradicting(views, mesh, blame, workspace, executor, progress)?;
        let is_severe = found.certain > 0 && found.lacking > SEVERE;
        if is_severe && set_aside.len() == unconfirmed && room < all && !too_many {
            (room, rounds_left) = (all, FURTHER_ROUNDS);
        }
        let at_fault = if rounds_left > 0 { found.certain.min(room - set_aside.len()) } else { 0 };
        if at_fault == 0 {
            too_many |= is_severe;
            if found.certain > 0 && set_aside.len() > unconfirmed {
                // The rest do not agree either.
                for place in set_aside.drain(unconfirmed..) {
                    let view = &mut views[usize::from(place)];
                    view.silhouette = view.given.take();
                }
                (room, rounds_left, too_many) = (unconfirmed, 1, true);
                continue;
            }
            carved?;
            let mut contradicting = found.places;
            short(&mut contradicting);
            return Ok(Agreement { contradicting, too_many });
        }
        rounds_left -= 1;
        for &place in &found.places[..at_fault] {
            let view = &mut views[usize::from(place)];
            view.given = view.silhouette.take();
        }
        set_aside.extend(&found.places[..at_fault]);
    }
}

/// Places in the rig's order of the views that are set aside and whose silhouettes, besides lacking something, show what the
/// hull of the others does not have: their cameras are not where the calibration says, or their pictures are of another
/// instant. `mesh` is the hull's mesh.
pub fn apart(views: &[View], mesh: &Mesh, params: &AgreementParams, executor: &dyn Executor) -> Vec<u16> {
    let is_apart = |coverage: &mut Coverage, view: &View| {
        let silhouette = view.given.as_deref().filter(|_| view.is_set_aside());
        silhouette.is_some_and(|silhouette| {
            coverage.draw(mesh, &view.camera);
            coverage.uncovered_rim(silhouette) > params.uncovered
        })
    };
    let apart = executor.map_with(&mut Vec::new(), views.len(), |coverage, place| is_apart(coverage, &views[place]));
    (0..views.len() as u16).filter(|&place| apart[usize::from(place)]).collect()
}
