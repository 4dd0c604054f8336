//! The signed distance at the nodes of a block (§0), in rows of nodes that fit into vectors.

use super::{
    carver::{Carver, EDGE, FAR, interpolate, square},
    visual_hull::VisualHull,
};
use crate::{
    grid::{BLOCK, BLOCK_NODES},
    math::min,
    simd::{Work, truncate},
};
use glam::Vec3;

/// One value per node of a row along x.
type Row<T = f32> = [T; BLOCK];

/// Evaluates [`VisualHull::signed_distance`] at all nodes of a stored block. It goes through the block view by view, so that
/// a silhouette is read in one small place after the other.
pub(super) struct BlockDistances<'a> {
    pub hull: &'a VisualHull,
    pub slot: usize,
    /// Receives the distances, x fastest.
    pub values: &'a mut [f32; BLOCK_NODES],
}

impl Work for BlockDistances<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let (hull, grid) = (self.hull, &self.hull.grid);
        let [x, y, z] = grid.blocks[self.slot].map(|v| i32::from(v) * BLOCK as i32);
        let mut xs = Row::default();
        for (i, px) in xs.iter_mut().enumerate() {
            *px = grid.node(x + i as i32, y, z).x;
        }
        let mut seen = [Row::<u32>::default(); BLOCK * BLOCK];
        self.values.fill(FAR * grid.voxel);
        let rows = self.values.as_chunks_mut::<BLOCK>().0;
        for &c in hull.block_carvers(self.slot) {
            let carver = &hull.carvers[c as usize];
            for (i, (nearest, seen)) in rows.iter_mut().zip(&mut seen).enumerate() {
                let first = grid.node(x, y + (i % BLOCK) as i32, z + (i / BLOCK) as i32);
                add_view(carver, &xs, first, nearest, seen);
            }
        }
        let needed = hull.needed[self.slot];
        for (nearest, seen) in rows.iter_mut().zip(&seen) {
            for i in 0..BLOCK {
                nearest[i] = if seen[i] < needed { min(nearest[i], -grid.voxel) } else { nearest[i] };
            }
        }
    }
}

/// Takes the minimum with a view's distance at a row of nodes and counts the view where it sees the node
/// ([`Carver::distance`]). The row's first node is at `first`, and `xs` are the coordinates of all along x.
#[inline(always)]
fn add_view(carver: &Carver, xs: &Row, first: Vec3, nearest: &mut Row, seen: &mut Row<u32>) {
    let (camera, silhouette) = (&carver.camera, &*carver.silhouette);
    let ([across, down, ahead], offset) = camera.projection();
    let width = silhouette.width as usize;
    let (right, bottom) = carver.believed();
    let (mut fx, mut fy, mut depth) = (Row::default(), Row::default(), Row::default());
    let (mut within, mut pixel) = (Row::<u32>::default(), Row::<u32>::default());
    let mut any = 0;
    for i in 0..BLOCK {
        let p = Vec3::new(xs[i], first.y, first.z);
        depth[i] = ahead.dot(p) + offset.z;
        let (u, v) = ((across.dot(p) + offset.x) / depth[i], (down.dot(p) + offset.y) / depth[i]);
        let is_within = (depth[i] > 0.0) & (u >= EDGE) & (v >= EDGE) & (u <= right) & (v <= bottom);
        within[i] = u32::from(is_within);
        any |= within[i];
        // Positions elsewhere are replaced by one that can be read.
        let (u, v) = (if is_within { u } else { EDGE }, if is_within { v } else { EDGE });
        let (x, y) = (truncate(u), truncate(v));
        (fx[i], fy[i]) = (u - x as f32, v - y as f32);
        pixel[i] = y as u32 * width as u32 + x as u32;
    }
    if any == 0 {
        return;
    }
    // Reads the four pixels around each position, two per word. Only this loop cannot be vectorised.
    let (mut upper, mut lower) = (Row::<u32>::default(), Row::<u32>::default());
    for i in 0..BLOCK {
        [upper[i], lower[i]] = square(silhouette, width, pixel[i]);
    }
    for i in 0..BLOCK {
        let (pixels, is_known) = interpolate([upper[i], lower[i]], fx[i], fy[i]);
        let distance = pixels * camera.footprint(depth[i]);
        let is_seen = is_known & (within[i] != 0);
        nearest[i] = if is_seen & (distance < nearest[i]) { distance } else { nearest[i] };
        seen[i] += u32::from(is_seen);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        hull::{HullParams, point_distance::PointDistance},
        progress::Silent,
        simd::Simd,
        testing::{pinhole, ring, silhouette_of},
    };
    use alloc::vec::Vec;

    /// The smallest distance of the listed views but those at the station `without`, one view after the other.
    fn smallest(hull: &VisualHull, list: &[u16], p: Vec3, without: u16, needed: u32) -> f32 {
        let carvers = list.iter().map(|&c| &hull.carvers[c as usize]).filter(|carver| carver.station != without);
        let distances: Vec<f32> = carvers.filter_map(|carver| carver.distance(p)).collect();
        let nearest = distances.iter().copied().fold(FAR * hull.grid.voxel, min);
        if (distances.len() as u32) < needed { min(nearest, -hull.grid.voxel) } else { nearest }
    }

    #[test]
    fn blocks_and_single_points_have_the_smallest_of_the_views_distances() {
        // The pictures of the longer lenses cut the ball off, so that parts of blocks lie beside them.
        let views: Vec<_> = (ring(11, 4.0, 1.0).enumerate())
            .map(|(i, from)| {
                let camera = pinhole(from, Vec3::ZERO, 96, [150.0, 260.0][i % 2]);
                silhouette_of(&[(Vec3::ZERO, 0.9)], &camera, i as u16)
            })
            .collect();
        let hull = VisualHull::new(&views, &HullParams { voxel_pixels: 1.5 }, &Silent).expect("a hull");
        let (mut values, mut cut, mut stopped) = ([0.0; BLOCK_NODES], 0, 0);
        for slot in 0..hull.grid.blocks.len() {
            let [x, y, z] = hull.grid.blocks[slot].map(|v| i32::from(v) * BLOCK as i32);
            let (list, needed) = (hull.block_carvers(slot), hull.needed[slot]);
            for simd in [Simd::Baseline, Simd::detect()] {
                simd.run(BlockDistances { hull: &hull, slot, values: &mut values });
                for (i, value) in (0..).zip(values) {
                    let p = hull.grid.node(x + i % 8, y + i / 8 % 8, z + i / 64);
                    let expected = smallest(&hull, list, p, u16::MAX, needed);
                    assert_eq!(value.to_bits(), expected.to_bits(), "node {i} of block {slot}");
                    cut += u32::from(list.iter().any(|&c| hull.carvers[c as usize].distance(p).is_none()));
                    for (without, clear) in [(u16::MAX, f32::INFINITY), (3, f32::INFINITY), (3, 0.02)] {
                        let found = PointDistance {
                            carvers: &hull.carvers,
                            groups: &hull.groups,
                            list: Some(list),
                            voxel: hull.grid.voxel,
                            p,
                            without,
                            needed,
                            clear,
                        };
                        let (found, from) = simd.run(found);
                        let expected = smallest(&hull, list, p, without, needed);
                        let is_clear = expected <= found && found < -clear;
                        assert!(
                            is_clear || found.to_bits() == expected.to_bits(),
                            "node {i} of block {slot} without {without}: {found} instead of {expected}"
                        );
                        stopped += u32::from(found != expected);
                        // A point that too few views see is outside, however far inside their silhouettes it lies.
                        let is_its = |from: &Carver| from.station != without && from.distance(p) >= Some(found);
                        assert!(from.is_none_or(is_its));
                    }
                }
            }
        }
        assert!(cut > 1000, "{cut} nodes lie beside a picture");
        assert!(stopped > 100, "at {stopped} points some views were enough");
    }
}
