//! The inputs that the stages after the hull share.

use crate::{hull::VisualHull, progress::Progress, rig::Rig, view::View};

/// Inputs that every stage after the hull reads.
#[derive(Clone, Copy)]
pub struct Context<'a> {
    /// The calibrated cameras.
    pub rig: &'a Rig,
    /// Undistorted pictures and silhouettes, in the rig's order.
    pub views: &'a [View],
    /// The visual hull of these views.
    pub hull: &'a VisualHull,
    /// Receives progress reports and may cancel.
    pub progress: &'a dyn Progress,
}

impl<'a> Context<'a> {
    /// The same inputs with another progress receiver.
    pub(crate) fn reporting_to(self, progress: &'a dyn Progress) -> Self {
        Self { progress, ..self }
    }
}
