//! Eq. 3 (§6.1): n_f = n · f. In meshing each normal is scaled by the weight of its point.

use crate::point_cloud::{Point, Rank};

/// Weights of eq. 3. The weight of a detected point is its fidelity f, which is at most the number of neighbouring
/// views if peaks vote as printed; spread peaks can add up to more. Eq. 1 gives no fidelity for the other kinds of
/// points. The paper's values for them are lost; the ones here were found by measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct WeightParams {
    /// Weight of a frontier point whose certainty is 1 ([`crate::contours::Certainty`]).
    pub frontier: f32,
    /// Weight of a point placed on the hull because stereo failed (§4.2).
    pub substituted: f32,
    /// Weight of an implicit point.
    pub implicit: f32,
}

/// Sets the weight of every point. Without parameters all weights are 1.
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
