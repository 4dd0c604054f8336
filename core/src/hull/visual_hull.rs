//! The visual hull (§0) and its signed distance.

use super::{
    carver::Carver,
    point_distance::{Group, PointDistance},
};
use crate::{
    executor::Executor,
    grid::{BLOCK, SparseGrid},
    math::{floor, max, min},
    point_cloud::Mesh,
    simd::Simd,
    surface::{Envelope, Unstored, marching_cubes},
    view::View,
    window::Window,
    workspace::Workspace,
};
use alloc::{sync::Arc, vec::Vec};
use glam::Vec3;

/// The visual hull of one frame.
pub struct VisualHull {
    pub(super) carvers: Vec<Carver>,
    /// The same views, in groups.
    pub(super) groups: Vec<Group>,
    pub(super) simd: Simd,
    pub(super) grid: SparseGrid,
    pub(super) values: Vec<f32>,
    /// For each stored block, the start of its list in `carver_lists`; then the total length.
    pub(super) list_starts: Vec<u32>,
    /// For each stored block, how many carvers of its list must see a point that belongs to the object.
    pub(super) needed: Vec<u32>,
    /// Lists of indices into `carvers`: the carvers whose contour may pass a block.
    pub(super) carver_lists: Vec<u16>,
    pub(super) lower: Vec3,
    pub(super) upper: Vec3,
    pub(super) footprint: f32,
}

impl VisualHull {
    /// Returns its memory to a workspace.
    pub fn recycle_into(self, workspace: &mut Workspace) {
        workspace.recycle(self.values);
        workspace.recycle(self.list_starts);
        workspace.recycle(self.needed);
        workspace.recycle(self.carver_lists);
    }

    /// Whether the silhouette that carves is also that of its view, for each view that carves. `views` are all views in the
    /// rig's order.
    pub(crate) fn shared_silhouettes(&self, views: &[View]) -> Vec<bool> {
        let is_shared = |carver: &Carver| {
            let own = views[usize::from(carver.index)].silhouette.as_ref();
            own.is_some_and(|own| Arc::ptr_eq(own, &carver.silhouette))
        };
        self.carvers.iter().map(is_shared).collect()
    }

    /// Reads the silhouettes in windows from now on, all of which contain the hull. `windows` and the views cut to them are in
    /// the rig's order, `shared` is from [`Self::shared_silhouettes`] before they were cut.
    pub(crate) fn look_through(&mut self, windows: &[Window], cut: &[View], shared: &[bool]) {
        for (carver, &shared) in self.carvers.iter_mut().zip(shared) {
            let view = &cut[usize::from(carver.index)];
            carver.camera = view.camera;
            carver.silhouette = match &view.silhouette {
                Some(silhouette) if shared => Arc::clone(silhouette),
                _ => Arc::new(carver.silhouette.window(&windows[usize::from(carver.index)])),
            };
        }
        self.groups = Group::all(&self.carvers);
    }

    /// Signed distance to the hull's surface in scene units, positive inside. Its sign is exact. It is measured in
    /// pictures and scaled by the footprint, so that its slope can reach [`crate::surface::SLOPE`].
    pub fn signed_distance(&self, p: Vec3) -> f32 {
        self.nearest_contour(p, u16::MAX, f32::INFINITY).0
    }

    /// [`Self::signed_distance`] over all views except one, and except those at the same place as it.
    pub fn signed_distance_without(&self, p: Vec3, view: u16) -> f32 {
        self.nearest_contour(p, self.station(view), f32::INFINITY).0
    }

    /// The station of a view: the smallest index of a view at its place.
    pub(super) fn station(&self, view: u16) -> u16 {
        self.carvers.iter().find(|carver| carver.index == view).map_or(view, |carver| carver.station)
    }

    /// Signed distance over all views except those at a station, and the view that it comes from. If the distance is less
    /// than `-clear`, the result may be a larger one that is also less than `-clear`.
    pub(super) fn nearest_contour(&self, p: Vec3, without: u16, clear: f32) -> (f32, Option<&Carver>) {
        let (slot, voxel) = (self.slot(p), self.grid.voxel);
        let (list, needed) = match slot {
            // The block as a whole was classified as inside or outside, so that the sign is known.
            SparseGrid::INSIDE | SparseGrid::OUTSIDE => (None, 0),
            stored => (Some(self.block_carvers(stored as usize)), self.needed[stored as usize]),
        };
        let (carvers, groups) = (&self.carvers[..], &self.groups[..]);
        let (d, from) = self.simd.run(PointDistance { carvers, groups, list, voxel, p, without, needed, clear });
        let d = match slot {
            SparseGrid::INSIDE => max(d, voxel),
            SparseGrid::OUTSIDE => min(d, -voxel),
            _ => d,
        };
        (d, from)
    }

    /// Outward unit normal of the hull's surface near a point.
    pub fn normal(&self, p: Vec3) -> Vec3 {
        let h = 0.5 * self.footprint;
        let d = |axis: Vec3| self.signed_distance(p - axis * h) - self.signed_distance(p + axis * h);
        Vec3::new(d(Vec3::X), d(Vec3::Y), d(Vec3::Z)).normalize_or_zero()
    }

    /// Lower and upper corner of the hull's bounding box.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        (self.lower, self.upper)
    }

    /// The footprint: the size of a pixel at the object in scene units, as the median over the views.
    pub fn footprint(&self) -> f32 {
        self.footprint
    }

    /// The sparse grid and the signed distance at its nodes.
    pub fn field(&self) -> (&SparseGrid, &[f32]) {
        (&self.grid, &self.values)
    }

    /// The hull's surface as a closed mesh.
    pub fn mesh(&self, workspace: &mut Workspace, executor: &dyn Executor) -> Mesh {
        let unstored = Unstored { inside: self.grid.voxel, outside: -self.grid.voxel };
        marching_cubes(&self.grid, &self.values, 0.0, unstored, workspace, executor)
    }

    /// Slot of the block at a point.
    fn slot(&self, p: Vec3) -> u32 {
        let q = (p - self.grid.origin) / (self.grid.voxel * BLOCK as f32);
        self.grid.slot(floor(q.x), floor(q.y), floor(q.z))
    }

    pub(super) fn block_carvers(&self, slot: usize) -> &[u16] {
        &self.carver_lists[self.list_starts[slot] as usize..self.list_starts[slot + 1] as usize]
    }

    /// Signed distance by trilinear interpolation of the grid: fast but less accurate.
    #[inline]
    pub(crate) fn coarse(&self, p: Vec3) -> f32 {
        self.grid.interpolate(&self.values, p, -self.grid.voxel, self.grid.voxel)
    }
}

impl Envelope for VisualHull {
    fn bounds(&self) -> (Vec3, Vec3) {
        self.bounds()
    }

    fn signed_distance(&self, p: Vec3) -> f32 {
        self.distance_until(p, f32::INFINITY)
    }

    /// Uses the grid near the surface, because meshing needs the distance at every node.
    fn distance_until(&self, p: Vec3, clear: f32) -> f32 {
        let cell = self.grid.cell(p);
        if self.grid.slot_of(&cell) < SparseGrid::INSIDE {
            self.grid.interpolate_in(&self.values, &cell, -self.grid.voxel, self.grid.voxel)
        } else {
            self.nearest_contour(p, u16::MAX, clear).0
        }
    }
}
