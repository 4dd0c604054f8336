//! Eq. 3 (§6.1): n_f = n · f. In meshing a normal counts as much as its point can be trusted.

use crate::point_cloud::{Point, Rank};

/// Weights of eq. 3. A detected point weighs its fidelity f, which is at most the number of neighbouring views. Points of
/// the other kinds have no fidelity from eq. 1; the paper's values for them are lost, these are measured.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct WeightParams {
    /// Weight of a frontier point whose contact is certain.
    pub frontier: f32,
    /// Weight of a point put on the hull because stereo failed (§4.2).
    pub substituted: f32,
    /// Weight of an implicit point.
    pub implicit: f32,
}

/// Sets the weight of every point. Without parameters all weigh the same.
pub fn weigh(cloud: &mut [Point], params: Option<&WeightParams>) {
    for point in cloud {
        point.weight = params.map_or(1.0, |params| match point.rank {
            Rank::Frontier => point.fidelity * params.frontier,
            Rank::Detected => point.fidelity,
            Rank::Substituted => params.substituted,
            Rank::Implicit => params.implicit,
        });
    }
}
