//! What a frame can take over from a neighbouring frame.

use crate::point_cloud::Mesh;
use alloc::sync::Arc;

/// Knowledge from a previous or following frame.
#[derive(Debug, Clone)]
pub struct Prior {
    /// A surface that guides detection in place of the coarse pass. Its positions are relative to
    /// [`crate::Rig::origin`].
    ///
    /// Detection searches only within [`crate::detect::DetectionParams::band_pixels`] of this surface. The surface of
    /// the frame must lie within that band, so set a prior only if the subject has hardly moved.
    pub surface: Arc<Mesh>,
}
