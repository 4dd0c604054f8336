//! Eq. 3: what a point counts for.

use super::super::{WeightParams, weigh};
use crate::{
    point_cloud::Rank,
    testing::{point, ranked},
};
use glam::Vec3;

const PARAMS: WeightParams = WeightParams { frontier: 16.0, substituted: 0.3, implicit: 0.1 };

/// A detected point weighs its fidelity, whatever it weighed before; those without a fidelity of eq. 1 what is set.
#[test]
fn a_normal_counts_by_its_points_fidelity() {
    let ranks = [Rank::Detected, Rank::Frontier, Rank::Substituted, Rank::Implicit];
    for fidelity in [0.0, 0.5, 3.0] {
        let mut cloud = ranks.map(|rank| ranked(point(Vec3::ZERO, Vec3::Z, 0, fidelity), rank));
        weigh(&mut cloud, Some(&PARAMS));
        assert_eq!(cloud.map(|p| p.weight), [fidelity, 16.0 * fidelity, 0.3, 0.1]);
        weigh(&mut cloud, None);
        assert_eq!(cloud.map(|p| p.weight), [1.0; 4]);
    }
}
