//! The neighbour grid finds what a k-d tree finds.

use super::NeighbourGrid;
use crate::testing::law;
use alloc::{vec, vec::Vec};
use glam::Vec3;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use proptest::prelude::*;

/// Indices of the points within a radius, by the grid.
fn by_grid(points: &[Vec3], queries: &[Vec3], radius: f32) -> Vec<Vec<u64>> {
    let grid = NeighbourGrid::new(points.iter().copied(), radius);
    let within = |&q: &Vec3| {
        let mut found = Vec::new();
        grid.near(q, radius, |i| {
            if (points[i] - q).length_squared() <= radius * radius {
                found.push(i as u64);
            }
        });
        found.sort_unstable();
        found
    };
    queries.iter().map(within).collect()
}

/// The same by kiddo.
fn by_tree(points: &[Vec3], queries: &[Vec3], radius: f32) -> Vec<Vec<u64>> {
    let points: Vec<[f32; 3]> = points.iter().map(Vec3::to_array).collect();
    let tree: ImmutableKdTree<f32, 3> = ImmutableKdTree::new_from_slice(&points);
    let within = |q: &Vec3| {
        let found = tree.within_unsorted::<SquaredEuclidean>(&q.to_array(), radius * radius);
        let mut found: Vec<u64> = found.iter().map(|n| n.item).collect();
        found.sort_unstable();
        found
    };
    queries.iter().map(within).collect()
}

/// Clouds of several kinds, and a radius.
fn cloud() -> impl Strategy<Value = (Vec<Vec3>, f32)> {
    let spread = prop::collection::vec(prop::array::uniform3(-5.0..5.0f32), 1..300);
    let kind = 0..5;
    (spread, kind, 0.2..2.0f32, -1000.0..1000.0f32).prop_map(|(points, kind, radius, shift)| {
        let shape = |(i, p): (usize, [f32; 3])| -> Vec3 {
            let p = Vec3::from_array(p);
            match kind {
                0 => p,
                // On a lattice: many equal coordinates, and distances that are exactly the radius.
                1 => Vec3::from_array((p / radius).to_array().map(libm::roundf)) * radius,
                // In a plane, and far from the origin.
                2 => Vec3::new(p.x, shift, p.y),
                // In clusters with few points between, in a box so large that cells must grow.
                3 => {
                    if i % 9 == 0 {
                        p * 400.0
                    } else {
                        p * 0.1
                    }
                }
                // All in one place.
                _ => Vec3::splat(shift),
            }
        };
        (points.into_iter().enumerate().map(shape).collect(), radius)
    })
}

proptest! {
    #![proptest_config(law(300))]

    /// From the points themselves and from anywhere else, inside the cloud's box and outside.
    #[test]
    fn the_grid_finds_what_a_tree_finds(
        (points, radius) in cloud(),
        anywhere in prop::collection::vec(prop::array::uniform3(-8.0..8.0f32), 20),
    ) {
        let mut queries = points.clone();
        queries.extend(anywhere.iter().map(|&p| points[0] + Vec3::from_array(p)));
        prop_assert_eq!(by_grid(&points, &queries, radius), by_tree(&points, &queries, radius));
    }
}

#[test]
fn nothing_is_near_in_an_empty_grid() {
    assert_eq!(by_grid(&[], &[Vec3::ZERO], 1.0), [Vec::<u64>::new()]);
}

/// Cells grow with the box and not with the number of points, or one stray point would ask for all memory.
#[test]
fn a_stray_point_far_away_costs_nothing() {
    let points = [Vec3::ZERO, Vec3::splat(0.5), Vec3::splat(1e6)];
    assert_eq!(by_grid(&points, &points, 1.0), [vec![0, 1], vec![0, 1], vec![2]]);
}
