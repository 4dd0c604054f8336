//! Marching cubes: closed and manifold for any field, right side out, near the true surface.
#![allow(clippy::disallowed_methods, clippy::disallowed_types, reason = "no result depends on the tests' own numbers")]

mod common;

use common::{Random, assert_manifold, volume};
use glam::Vec3;
use pcmvs_core::grid::{BLOCK_NODES, SparseGrid};
use pcmvs_core::surface::{Unstored, marching_cubes};
use pcmvs_core::{Mesh, Serial, Workspace};

/// A grid of random stored, inside and outside blocks.
fn random_grid(random: &mut Random, dims: [u32; 3]) -> SparseGrid {
    SparseGrid::new(Vec3::new(-1.0, 2.0, 0.5), 0.25, dims, |_| match random.below(4) {
        0 => SparseGrid::INSIDE,
        1 => SparseGrid::OUTSIDE,
        _ => 0,
    })
}

/// The surface `iso` of a field. Blocks that are not stored have one of two values, inside or outside.
fn extract(grid: &SparseGrid, values: &[f32], iso: f32, [inside, outside]: [f32; 2]) -> Mesh {
    marching_cubes(grid, values, iso, Unstored { inside, outside }, &mut Workspace::default(), &Serial)
}

#[test]
fn random_fields_give_closed_manifolds() {
    let mut random = Random::new(7);
    for round in 0..40 {
        let grid = random_grid(&mut random, [3, 2, 3]);
        let share = [2, 3, 5, 10][round % 4];
        let values: Vec<f32> = (0..grid.blocks.len() * BLOCK_NODES)
            .map(|_| if random.below(share) == 0 { random.unit() } else { -random.unit() })
            .collect();
        let mesh = extract(&grid, &values, 0.0, [1.0, -1.0]);
        assert!(!mesh.triangles.is_empty());
        assert_manifold(&mesh);
    }
}

#[test]
fn values_equal_to_iso_or_not_finite_do_no_harm() {
    let mut random = Random::new(11);
    let special = [0.5, 0.5, 1.0, 0.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e-40, f32::MAX, f32::MIN];
    for _ in 0..20 {
        let grid = random_grid(&mut random, [2, 2, 2]);
        let values: Vec<f32> =
            (0..grid.blocks.len() * BLOCK_NODES).map(|_| special[random.below(special.len())]).collect();
        assert_manifold(&extract(&grid, &values, 0.5, [1.0, 0.0]));
    }
}

/// All 256 cubes, each in random surroundings.
#[test]
fn every_case_closes_with_its_neighbours() {
    let mut random = Random::new(3);
    let grid = SparseGrid::new(Vec3::ZERO, 1.0, [1, 1, 1], |_| 0);
    for case in 0..256 {
        for _ in 0..4 {
            let mut values: Vec<f32> = (0..BLOCK_NODES).map(|_| random.unit() - 0.5).collect();
            for corner in 0..8 {
                let (x, y, z) = (3 + (corner & 1), 3 + (corner >> 1 & 1), 3 + (corner >> 2));
                let size = 0.01 + random.unit();
                values[(z * 8 + y) * 8 + x] = if case >> corner & 1 == 1 { size } else { -size };
            }
            assert_manifold(&extract(&grid, &values, 0.0, [1.0, -1.0]));
        }
    }
}

#[test]
fn a_grid_that_is_all_inside_becomes_its_box() {
    let grid = SparseGrid::new(Vec3::ZERO, 1.0, [2, 1, 1], |_| SparseGrid::INSIDE);
    let mesh = extract(&grid, &[], 0.5, [1.0, 0.0]);
    assert_manifold(&mesh);
    // 16 x 8 x 8 nodes, half a voxel around them, less the bevel at edges and corners.
    let volume = volume(&mesh);
    assert!((960.0..1024.0).contains(&volume), "{volume}");
}

#[test]
fn a_sphere_is_met_in_position_normal_and_volume() {
    let (radius, centre) = (20.3, Vec3::splat(32.2));
    let mut grid = SparseGrid::new(Vec3::ZERO, 1.0, [8, 8, 8], |[x, y, z]| {
        let d = radius - (Vec3::new(x as f32, y as f32, z as f32) * 8.0 + 3.5 - centre).length();
        if d > 9.0 {
            SparseGrid::INSIDE
        } else if d < -9.0 {
            SparseGrid::OUTSIDE
        } else {
            0
        }
    });
    let mut values = Vec::new();
    for block in &grid.blocks {
        for i in 0..BLOCK_NODES {
            let node = [i & 7, i >> 3 & 7, i >> 6];
            let p = Vec3::from_array(core::array::from_fn(|k| (8 * block[k] as usize + node[k]) as f32));
            values.push(radius - (p - centre).length());
        }
    }
    grid.origin = Vec3::splat(-5.0);
    let centre = centre + grid.origin;
    let mesh = extract(&grid, &values, 0.0, [10.0, -10.0]);
    assert_manifold(&mesh);
    for (&p, &n) in mesh.positions.iter().zip(&mesh.normals) {
        assert!(((p - centre).length() - radius).abs() < 0.02);
        assert!((p - centre).normalize().dot(n) > 0.9999);
    }
    let exact = 4.0 / 3.0 * core::f32::consts::PI * radius.powi(3);
    let found = volume(&mesh) as f32;
    assert!((0.99..1.0).contains(&(found / exact)), "{found} of {exact}");
}
