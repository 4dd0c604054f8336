//! The result of a frame.

use super::intermediates::Intermediates;
use crate::{point_cloud::Mesh, report::Counts, stage::Stage};
use alloc::vec::Vec;

/// The result of a frame.
#[derive(Debug, Clone)]
pub struct Reconstruction {
    /// The closed, coloured mesh.
    pub mesh: Mesh,
    /// The factors applied to each camera's red, green and blue when the mesh was coloured, in the order in which the
    /// cameras were given. [`crate::Rig::with_gains`] fixes them for later frames.
    pub gains: Vec<[f32; 3]>,
    /// Counts of all stages.
    pub counts: Counts,
    /// A 64-bit hash of each stage's output, in the order of [`super::ORDER`].
    pub hashes: Vec<(Stage, u64)>,
    /// The results of the stages before the final mesh.
    pub intermediates: Intermediates,
}
