//! Errors of a mesh in footprints, where at least two cameras see the true surface.

use crate::Shot;
use glam::DVec3;
use pcmvs_core::Mesh;
use studio::score::{self, TriangleGrid};

/// Number of points that are measured on each surface.
const SAMPLES: usize = 5000;
/// Largest distance in footprints that is measured. Larger ones count as this.
const FAR: f64 = 10.0;

/// Distances in footprints, ascending, of surface points that at least two cameras see.
#[derive(Debug, Clone)]
pub struct Errors {
    /// From points of the mesh to the truth, if the nearest true point is seen.
    pub accuracy: Vec<f64>,
    /// From points of the truth to the mesh.
    pub completeness: Vec<f64>,
}

impl Errors {
    /// Measures a mesh of the core.
    pub fn new(shot: &Shot, mesh: &Mesh) -> Self {
        let (scene, world) = (shot.truth(), shot.in_world(mesh));
        let footprint = shot.footprint(shot.rig().origin());
        let seen = |p: DVec3, n: DVec3| {
            let seeing = shot.cameras.iter().filter(|c| score::sees(scene, c, p, n));
            seeing.take(2).count() == 2
        };
        let mut accuracy: Vec<f64> = Vec::new();
        for p in world.surface_points(SAMPLES, 0) {
            let (distance, normal) = (scene.distance(p), scene.normal(p));
            if seen(p - normal * distance, normal) {
                accuracy.push(distance.abs() / footprint);
            }
        }
        let grid = TriangleGrid::new(&world, FAR * footprint);
        let truth = score::seen(scene, &shot.cameras, 2, SAMPLES);
        let mut completeness: Vec<f64> =
            truth.iter().map(|(p, _)| grid.distance(*p).map_or(FAR, |d| d / footprint)).collect();
        accuracy.sort_by(f64::total_cmp);
        completeness.sort_by(f64::total_cmp);
        Self { accuracy, completeness }
    }

    /// Fails unless a share of both lies within a bound.
    pub fn assert_within(&self, share: f64, bound: f64, what: &str) {
        let (a, c) = (quantile(&self.accuracy, share), quantile(&self.completeness, share));
        println!("{what}: {share} of the mesh within {a:.3} footprints, of the truth within {c:.3}");
        assert!(a <= bound, "{what}: {share} of the mesh lies within {a:.3} footprints of the truth, not {bound}");
        assert!(c <= bound, "{what}: {share} of the truth lies within {c:.3} footprints of the mesh, not {bound}");
    }
}

/// The quantile of ascending values at a share (0..=1).
pub fn quantile(ascending: &[f64], share: f64) -> f64 {
    ascending[(libm::ceil(share * ascending.len() as f64) as usize).clamp(1, ascending.len()) - 1]
}
