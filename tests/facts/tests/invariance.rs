//! Changes of the input that must not change the result.

use facts::{Shot, errors::quantile, threads, topology::assert_sound};
use glam::{DMat3, DVec3};
use pcmvs_core::{Camera, Params, Preset, Reconstruction, Rig, Silent};
use std::sync::LazyLock;
use studio::{Subject, TriangleMesh, score::TriangleGrid};

static SHOT: LazyLock<Shot> = LazyLock::new(|| Shot::small(Subject::TwoBodies, 10));
static RESULT: LazyLock<Reconstruction> =
    LazyLock::new(|| SHOT.reconstruct(&Params::preset(Preset::Default)).expect("the scene is sound"));

#[test]
fn the_same_again_gives_the_same_bytes() {
    for preset in [Preset::Default, Preset::Paper, Preset::Hull] {
        let [a, b] = [(); 2].map(|()| SHOT.reconstruct(&Params::preset(preset)).expect("the scene is sound"));
        assert_eq!(a.hashes, b.hashes, "{preset:?}");
        assert!(a.mesh == b.mesh, "{preset:?}");
        assert_eq!(a.counts, b.counts, "{preset:?}");
    }
}

#[test]
fn threads_give_the_same_bytes() {
    for count in [2, 5] {
        let result = SHOT.reconstruct_with(&Params::preset(Preset::Default), &threads(count), &Silent);
        let result = result.expect("the scene is sound");
        assert_eq!(result.hashes, RESULT.hashes, "{count} threads");
        assert!(result.mesh == RESULT.mesh, "{count} threads");
        assert_eq!(result.counts, RESULT.counts, "{count} threads");
    }
}

/// The order of the cameras does not matter.
#[test]
fn the_order_of_the_cameras_changes_nothing() {
    for order in [[9, 8, 7, 6, 5, 4, 3, 2, 1, 0], [4, 0, 7, 2, 9, 5, 1, 8, 6, 3]] {
        let shot = SHOT.of_cameras(&order);
        assert_eq!(shot.rig().origin(), SHOT.rig().origin());
        let result = shot.reconstruct(&Params::preset(Preset::Default)).expect("the scene is sound");
        assert!(result.mesh.positions == RESULT.mesh.positions, "{order:?}: positions differ");
        assert!(result.mesh.triangles == RESULT.mesh.triangles, "{order:?}: triangles differ");
        assert!(result.mesh == RESULT.mesh, "{order:?}: normals or colours differ");
    }
}

/// Numbers are rounded differently in other units, so that a few of the points with little support come and go. Nearly all of
/// the surface stays within this many footprints.
const CHANGED_LITTLE: f64 = 0.05;

/// A change of the world's units, axes and origin: X' = scale · rotation · X + shift.
#[derive(Clone, Copy)]
struct Change {
    scale: f64,
    rotation: DMat3,
    shift: DVec3,
}

impl Change {
    const NONE: Self = Self { scale: 1.0, rotation: DMat3::IDENTITY, shift: DVec3::ZERO };

    fn camera(&self, camera: &Camera) -> Camera {
        // x = R X + t times the scale: R' = R · rotationᵀ, t' = scale · t - R' · shift.
        let r = DMat3::from_cols_array_2d(&camera.r).transpose() * self.rotation.transpose();
        let t = DVec3::from_array(camera.t) * self.scale - r * self.shift;
        Camera { r: r.transpose().to_cols_array_2d(), t: t.to_array(), ..*camera }
    }

    fn undo(&self, p: DVec3) -> DVec3 {
        self.rotation.transpose() * (p - self.shift) / self.scale
    }

    /// Distances in footprints between the result in the changed world and the original one, ascending.
    fn differences(&self) -> Vec<f64> {
        let chosen: Vec<usize> = (0..SHOT.cameras.len()).collect();
        let mut shot = SHOT.of_cameras(&chosen);
        shot.cameras.iter_mut().for_each(|c| *c = self.camera(c));
        let rig = Rig::new(&shot.cameras).expect("the cameras are as sound as before");
        let result = shot.reconstruct(&Params::preset(Preset::Default)).expect("the scene is sound");
        assert_sound(&result.mesh, "changed");
        let mut there = TriangleMesh::of_core(&result.mesh.positions, &result.mesh.triangles, rig.origin());
        there.vertices.iter_mut().for_each(|v| *v = self.undo(*v));
        let here = SHOT.in_world(&RESULT.mesh);
        let footprint = SHOT.footprint(SHOT.rig().origin());
        let mut differences = Vec::new();
        for (from, to) in [(&here, &there), (&there, &here)] {
            let grid = TriangleGrid::new(to, 4.0 * footprint);
            differences
                .extend(from.surface_points(3000, 0).iter().map(|p| grid.distance(*p).map_or(4.0, |d| d / footprint)));
        }
        differences.sort_by(f64::total_cmp);
        let [half, most, worst] = [0.5, 0.95, 1.0].map(|share| quantile(&differences, share));
        println!("0.5, 0.95 and all within {half:.4}, {most:.4}, {worst:.3} footprints");
        differences
    }
}

/// The unit of length does not matter.
#[test]
fn units_do_not_matter() {
    for scale in [1000.0, 0.001] {
        let differences = Change { scale, ..Change::NONE }.differences();
        assert!(quantile(&differences, 0.95) < CHANGED_LITTLE, "{scale}");
        assert!(quantile(&differences, 1.0) < 2.0, "{scale}");
    }
}

/// The origin of the world does not matter.
#[test]
fn the_origin_does_not_matter() {
    let differences = Change { shift: DVec3::new(100.0, -50.0, 20.0), ..Change::NONE }.differences();
    assert!(quantile(&differences, 0.95) < CHANGED_LITTLE);
    assert!(quantile(&differences, 1.0) < 2.0);
}

/// The axes of the world do not matter, apart from the grids, which are aligned to them.
#[test]
fn the_axes_do_not_matter() {
    let rotation = DMat3::from_euler(glam::EulerRot::ZYX, 0.6, -0.4, 1.1);
    let differences = Change { rotation, ..Change::NONE }.differences();
    assert!(quantile(&differences, 0.5) < 0.08);
    assert!(quantile(&differences, 0.95) < 0.5);
}
