//! What a frame may know of a neighbouring frame.

use crate::point_cloud::Mesh;
use alloc::sync::Arc;

/// Knowledge from a frame before or after.
#[derive(Debug, Clone)]
pub struct Prior {
    /// A surface in the rig's internal frame (relative to [`crate::Rig::origin`]) that guides detection instead of the
    /// coarse pass. Detection searches only within [`crate::detect::DetectionParams::band_pixels`] around it, so that it
    /// must be that close to this frame's surface: give it only for what has hardly moved.
    pub surface: Arc<Mesh>,
}
