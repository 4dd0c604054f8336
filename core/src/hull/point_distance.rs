//! The signed distance at one point (§0), from eight views at a time.

use super::carver::{Carver, EDGE, FAR, interpolate, square};
use crate::{
    math::min,
    simd::{Work, truncate},
};
use alloc::vec::Vec;
use glam::Vec3;

/// Views in a group, which vectors hold.
const LANES: usize = 8;
/// One value per view of a group.
type Lanes<T = f32> = [T; LANES];

/// What projecting into eight views needs, one value per view. A group that is not full sees nothing in its other lanes.
#[derive(Clone, Default)]
pub(super) struct Group {
    /// Rows of K·R, and K·(R·origin + t) ([`crate::camera::Pinhole::projection`]).
    rows: [[Lanes; 3]; 3],
    offset: [Lanes; 3],
    focal: Lanes,
    /// The last column and row in which a silhouette is believed.
    right: Lanes,
    bottom: Lanes,
    /// Width of the silhouette in pixels.
    width: Lanes<u32>,
    station: Lanes<u32>,
}

impl Group {
    /// The views in groups, in their order.
    pub fn all(carvers: &[Carver]) -> Vec<Self> {
        let group = |carvers: &[Carver]| {
            let mut group = Self::default();
            for (i, carver) in carvers.iter().enumerate() {
                let camera = &carver.camera;
                let (rows, offset) = camera.projection();
                for axis in 0..3 {
                    group.offset[axis][i] = offset[axis];
                    for column in 0..3 {
                        group.rows[axis][column][i] = rows[axis][column];
                    }
                }
                group.focal[i] = camera.focal;
                (group.right[i], group.bottom[i]) = carver.believed();
                (group.width[i], group.station[i]) = (carver.silhouette.width, u32::from(carver.station));
            }
            group
        };
        carvers.chunks(LANES).map(group).collect()
    }
}

/// Finds the smallest of some views' distances at a point, and the view that it comes from. A point that fewer than `needed`
/// of these views see is outside.
pub(super) struct PointDistance<'a> {
    pub carvers: &'a [Carver],
    /// The same views, in groups.
    pub groups: &'a [Group],
    /// Indices of some views in `carvers`, ascending. `None` for all.
    pub list: Option<&'a [u16]>,
    /// Spacing of the hull's grid in scene units.
    pub voxel: f32,
    pub p: Vec3,
    /// Views at this station are excluded.
    pub without: u16,
    pub needed: u32,
    /// A point that some views exclude by more than this, in scene units, is not looked at in the others. The result is then
    /// one of these views' distances. With infinity it is always the smallest.
    pub clear: f32,
}

impl<'a> Work for PointDistance<'a> {
    type Output = (f32, Option<&'a Carver>);

    #[inline(always)]
    fn run(self) -> Self::Output {
        let mut nearest = Nearest { distance: FAR * self.voxel, from: None, seen: 0 };
        let mut list = self.list;
        for group in 0..self.groups.len() {
            let mut chosen = u32::MAX;
            if let Some(rest) = &mut list {
                chosen = 0;
                while let Some((&c, others)) = rest.split_first() {
                    if usize::from(c) / LANES != group {
                        break;
                    }
                    (chosen, *rest) = (chosen | 1 << (usize::from(c) % LANES), others);
                }
            }
            if chosen != 0 {
                self.add(group, chosen, &mut nearest);
            }
            if nearest.distance < -self.clear {
                // However many of the others see it.
                nearest.seen = u32::MAX;
                break;
            }
        }
        let Nearest { distance, from, seen } = nearest;
        (if seen < self.needed { min(distance, -self.voxel) } else { distance }, from)
    }
}

/// The smallest distance so far.
struct Nearest<'a> {
    distance: f32,
    from: Option<&'a Carver>,
    /// Number of views that see the point.
    seen: u32,
}

impl<'a> PointDistance<'a> {
    /// Takes the minimum with the distances ([`Carver::distance`]) of those views of a group whose bits are set in `chosen`.
    #[inline(always)]
    fn add(&self, group: usize, chosen: u32, nearest: &mut Nearest<'a>) {
        let carvers = &self.carvers[group * LANES..];
        let Group { rows, offset, focal, right, bottom, width, station } = &self.groups[group];
        let mut q = [Lanes::default(); 3];
        let (mut fx, mut fy) = (Lanes::default(), Lanes::default());
        let (mut within, mut pixel) = (Lanes::<u32>::default(), Lanes::<u32>::default());
        for i in 0..LANES {
            for axis in 0..3 {
                let [x, y, z] = &rows[axis];
                q[axis][i] = Vec3::new(x[i], y[i], z[i]).dot(self.p) + offset[axis][i];
            }
            let [x, y, depth] = &mut q;
            (x[i], y[i]) = (x[i] / depth[i], y[i] / depth[i]);
            let is_within =
                (depth[i] > 0.0) & (x[i] >= EDGE) & (y[i] >= EDGE) & (x[i] <= right[i]) & (y[i] <= bottom[i]);
            let is_chosen = (chosen >> i & 1 != 0) & (station[i] != u32::from(self.without));
            within[i] = u32::from(is_within & is_chosen);
            let (column, row) = (truncate(x[i]), truncate(y[i]));
            (fx[i], fy[i]) = (x[i] - column as f32, y[i] - row as f32);
            // Not read for views that do not see the point, whose numbers may be too large.
            pixel[i] = (row as u32).wrapping_mul(width[i]).wrapping_add(column as u32);
        }
        let depth = q[2];
        // Reads the four pixels around each position, two per word. Only this loop cannot be vectorised.
        let (mut upper, mut lower) = (Lanes::<u32>::default(), Lanes::<u32>::default());
        for i in 0..LANES {
            if within[i] != 0 {
                [upper[i], lower[i]] = square(&carvers[i].silhouette, width[i] as usize, pixel[i]);
            }
        }
        let (mut distance, mut seen) = (Lanes::default(), Lanes::<u32>::default());
        for i in 0..LANES {
            let (pixels, is_known) = interpolate([upper[i], lower[i]], fx[i], fy[i]);
            distance[i] = pixels * (depth[i] / focal[i]);
            seen[i] = u32::from(is_known) & within[i];
        }
        for i in 0..LANES {
            nearest.seen += seen[i];
            if (seen[i] != 0) & (distance[i] < nearest.distance) {
                (nearest.distance, nearest.from) = (distance[i], Some(&carvers[i]));
            }
        }
    }
}
