//! The result of a frame.

use super::{diagnostics::ViewDiagnostics, intermediates::Intermediates, warning::Warning};
use crate::{point_cloud::Mesh, report::Counts, stage::Stage};
use alloc::vec::Vec;

/// The result of a frame.
#[derive(Debug, Clone)]
pub struct Reconstruction {
    /// The closed, coloured mesh.
    pub mesh: Mesh,
    /// Size of a pixel at the object, in scene units. [`crate::steady::steady`] needs it.
    pub footprint: f32,
    /// The factors applied to each camera's red, green and blue when the mesh was coloured, in the order in which the
    /// cameras were given. [`crate::Rig::with_gains`] fixes them for later frames.
    pub gains: Vec<[f32; 3]>,
    /// Counts of all stages.
    pub counts: Counts,
    /// A 64-bit hash of each stage's output, in the order of [`super::ORDER`].
    pub hashes: Vec<(Stage, u64)>,
    /// What may make the result worse although nothing failed.
    pub warnings: Vec<Warning>,
    /// How well each camera's view agrees with the others, in the order in which the cameras were given.
    pub diagnostics: Vec<ViewDiagnostics>,
    /// The cameras whose silhouettes the other views have overruled ([`crate::Frame::overruled`]).
    pub overruled: Vec<u32>,
    /// The results of the stages before the final mesh.
    pub intermediates: Intermediates,
}
