//! Working memory of a frame.

use crate::{
    detect::DetectionScratch,
    executor::Pool,
    view::{Buffers, ViewScratch},
    workspace::Workspace,
};

/// Working memory that a frame may hand on to the next ([`super::Frame::recycle`]). Its content does not change a result.
/// The default keeps nothing: stages then ask for memory and free it at once, and the peak is lowest.
#[derive(Default)]
pub struct Memory {
    keeps: bool,
    limit: Option<u64>,
    pub(super) workspace: Workspace,
    /// Buffers for making views.
    pub(super) view_scratch: Pool<ViewScratch>,
    /// Pictures and distances of the frame before.
    pub(super) buffers: Pool<Buffers>,
    /// Buffers of detection.
    pub(super) detection: Pool<DetectionScratch>,
}

impl Memory {
    /// Memory that stages keep for later stages and frames: it is asked for once, but up to twice as much is taken.
    pub fn kept() -> Self {
        Self { keeps: true, workspace: Workspace::keeping(), ..Self::default() }
    }

    /// Memory for a frame that may need at most `limit` bytes ([`crate::memory`]). A frame that needs more fails with
    /// [`crate::Error::OutOfMemory`] before it takes them.
    pub fn limited(limit: u64) -> Self {
        Self { limit: Some(limit), ..Self::default() }
    }

    /// Most bytes that a frame may need.
    pub(super) fn limit(&self) -> Option<u64> {
        self.limit
    }

    /// Views are made: their scratch is of use only to a later frame.
    pub(super) fn views_are_made(&mut self) {
        if !self.keeps {
            self.view_scratch.spare().clear();
        }
    }

    /// Detection is over: its buffers are of use only to a later frame.
    pub(super) fn detection_is_over(&mut self) {
        if !self.keeps {
            self.detection.spare().clear();
        }
    }
}
