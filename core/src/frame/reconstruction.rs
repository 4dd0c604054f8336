//! The result of a frame.

use super::intermediates::Intermediates;
use crate::{point_cloud::Mesh, report::Counts, stage::Stage};
use alloc::vec::Vec;

/// The result of a frame.
#[derive(Debug, Clone)]
pub struct Reconstruction {
    /// The closed, coloured mesh.
    pub mesh: Mesh,
    /// What each camera's red, green and blue were multiplied by for the mesh's colours, in the order of the cameras as
    /// given. [`crate::Rig::with_gains`] fixes them for later frames.
    pub gains: Vec<[f32; 3]>,
    /// What the stages counted.
    pub counts: Counts,
    /// A 64-bit hash of each stage's output, in the order of [`super::ORDER`].
    pub hashes: Vec<(Stage, u64)>,
    /// What the stages passed on.
    pub intermediates: Intermediates,
}
