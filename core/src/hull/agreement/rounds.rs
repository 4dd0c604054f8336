//! Carves the hull from the views that agree: views that contradict the others are found, and the hull is carved again
//! without their silhouettes.

use super::{AgreementParams, contradicting, coverage::Coverage};
use crate::{
    error::{Error, Result},
    executor::Executor,
    point_cloud::Mesh,
    progress::Progress,
    rig::MIN_VIEWS,
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

/// Carves, and sets aside the silhouettes that contradict the others ([`View::given`]) in at most `rounds` rounds. Without
/// `params` all are believed. Returns the places in the rig's order of views that are believed although they contradict
/// others, in ascending order.
///
/// # Errors
/// Those of carving.
pub fn carve_agreeing(
    carving: &mut impl Carving,
    params: Option<&AgreementParams>,
    rounds: u32,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<Vec<u16>> {
    let mut carved = carving.carve(executor, progress);
    let silhouettes = carving.parts().0.iter().filter(|view| view.is_used() && view.silhouette.is_some()).count();
    let share = params.map_or(0.0, |params| params.largest_share);
    let mut room = ((share * silhouettes as f32) as usize).min(silhouettes.saturating_sub(MIN_VIEWS as usize));
    let blame = params.map_or(AgreementParams::BLAME, |params| params.blame);
    for round in 0.. {
        let (views, mesh, workspace) = carving.parts();
        match carved {
            Ok(()) => {}
            Err(Error::EmptyHull) if round < rounds => take(mesh).recycle_into(workspace),
            Err(error) => return Err(error),
        }
        let found = contradicting(views, mesh, blame, workspace, executor, progress)?;
        let at_fault = if round < rounds { found.certain.min(room) } else { 0 };
        if at_fault == 0 {
            carved?;
            let mut believed = found.places;
            believed.sort_unstable();
            return Ok(believed);
        }
        room -= at_fault;
        for &place in &found.places[..at_fault] {
            let view = &mut views[usize::from(place)];
            view.given = view.silhouette.take();
        }
        carved = carving.carve(executor, progress);
    }
    unreachable!("the last round returns")
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
