//! §4.2: substitution. Where stereo has failed, the first point of the hull on the ray is used.
//!
//! Shading gives concave parts texture, so that a pixel without texture more probably lies on the hull.

use super::depth::DepthMap;
use crate::{point_cloud::Rank, report::Counts};
use alloc::vec::Vec;

/// Parameters of substitution (§4.2).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct SubstitutionParams {
    /// Stereo has failed where the fidelity is less than this fraction of the number of views that were compared. The paper
    /// uses 1/4.
    pub below: f32,
}

/// Replaces failed depths by those of the guide surface, and sets the rank of every pixel's point.
///
/// `guide` is the depth of the guide surface per pixel, or 0 where nothing was searched. Without parameters failed pixels
/// get no point.
pub fn substitute(
    map: &mut DepthMap,
    guide: &[f32],
    params: Option<&SubstitutionParams>,
    rank: &mut Vec<Rank>,
    counts: &mut Counts,
) {
    let below = params.map_or(0.0, |params| params.below);
    rank.clear();
    rank.resize(map.depth.len(), Rank::Detected);
    for i in 0..map.depth.len() {
        if guide[i] <= 0.0 {
            continue;
        }
        if map.depth[i] > 0.0 && map.fidelity[i] >= below * f32::from(map.compared[i]) {
            counts.detected += 1;
        } else if params.is_some() {
            counts.substituted += 1;
            rank[i] = Rank::Substituted;
            map.depth[i] = guide[i];
            map.fidelity[i] = 0.0;
        } else {
            map.depth[i] = 0.0;
        }
    }
}
