//! The working memory of a frame.

use crate::{
    detect::DetectionScratch,
    executor::Pool,
    view::{Buffers, ViewScratch},
    workspace::Workspace,
};

/// Working memory, which a frame can pass on to the next ([`super::Frame::recycle`]). Its content never affects a
/// result.
///
/// The default keeps nothing: stages allocate memory and free it at once, which gives the lowest peak.
#[derive(Default)]
pub struct Memory {
    keeps: bool,
    limit: Option<u64>,
    pub(super) workspace: Workspace,
    /// Buffers for making views.
    pub(super) view_scratch: Pool<ViewScratch>,
    /// Memory of the previous frame's pictures and distances.
    pub(super) buffers: Pool<Buffers>,
    /// Buffers of detection.
    pub(super) detection: Pool<DetectionScratch>,
}

impl Memory {
    /// Memory that is kept for later stages and frames. It is allocated once, but the peak is up to twice as high.
    pub fn kept() -> Self {
        Self { keeps: true, workspace: Workspace::keeping(), ..Self::default() }
    }

    /// Memory for frames that may use at most `limit` bytes (see [`crate::memory`]). A frame that needs more fails with
    /// [`crate::Error::OutOfMemory`] before it allocates them.
    pub fn limited(limit: u64) -> Self {
        Self { limit: Some(limit), ..Self::default() }
    }

    /// The largest number of bytes that a frame may use.
    pub(super) fn limit(&self) -> Option<u64> {
        self.limit
    }

    /// Called when all views have been read. Only a later frame could use their scratch buffers.
    pub(super) fn views_are_made(&mut self) {
        if !self.keeps {
            self.view_scratch.spare().clear();
        }
    }

    /// Called when detection is complete. Only a later frame could use its buffers.
    pub(super) fn detection_is_over(&mut self) {
        if !self.keeps {
            self.detection.spare().clear();
        }
    }
}
