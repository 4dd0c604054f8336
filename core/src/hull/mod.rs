//! Visual hull (§0): the space that every silhouette allows.
//!
//! The hull is the set where the signed distance of [`VisualHull::signed_distance`] is positive: the least, over the
//! views that see a point, of the distance from its projection to the silhouette's contour. That function is exact to
//! the contour's own precision; a sparse grid of its values round the surface only says where to look.

mod carve;
mod ray;
mod search;

pub use ray::Interval;

use crate::{
    camera::Pinhole,
    error::Result,
    grid::{BLOCK, BLOCK_NODES, SparseGrid},
    math::{floor, max, min},
    mesh::{Envelope, marching_cubes},
    params::HullParams,
    point_cloud::Mesh,
    progress::Progress,
    silhouette::Silhouette,
    view::View,
    workspace::Workspace,
};
use alloc::vec::Vec;
use core::mem::take;
use glam::Vec3;

/// Fewest silhouettes that must see a point for it to belong to the object.
const LEAST_SILHOUETTES: u32 = 2;

/// Signed distances are clamped to this many voxels: beyond, only the sign matters.
const FAR: f32 = 64.0;

/// A view that carves.
#[derive(Clone, Copy)]
struct Carver<'a> {
    camera: Pinhole,
    silhouette: &'a Silhouette,
    /// Index of the view in the rig.
    index: u16,
}

impl Carver<'_> {
    /// Distance in scene units from a point's projection to the contour, positive inside; `None` if unseen.
    #[inline]
    fn distance(&self, p: Vec3) -> Option<f32> {
        let q = self.camera.project(p);
        if q.z <= 0.0 {
            return None;
        }
        self.silhouette.sample(q.x, q.y).map(|d| d * self.camera.footprint(q.z))
    }
}

/// The visual hull of one frame.
pub struct VisualHull<'a> {
    carvers: Vec<Carver<'a>>,
    grid: SparseGrid,
    values: Vec<f32>,
    /// For each stored block where its carvers start in `carver_lists`, then one end.
    list_starts: Vec<u32>,
    /// For each stored block how many of its carvers must see a point for it to be the object's.
    needed: Vec<u32>,
    /// Indices into `carvers` of those whose contour passes a block.
    carver_lists: Vec<u16>,
    least_silhouettes: u32,
    lower: Vec3,
    upper: Vec3,
    footprint: f32,
}

impl<'a> VisualHull<'a> {
    /// Carves the hull.
    ///
    /// # Errors
    /// [`crate::Error::EmptyHull`] if no point lies inside all silhouettes that see it, [`crate::Error::TooFewViews`]
    /// if fewer than three views have a silhouette, [`crate::Error::Cancelled`].
    pub fn new(views: &'a [View], params: &HullParams, progress: &dyn Progress) -> Result<Self> {
        Self::in_memory(views, params, &mut Workspace::default(), progress)
    }

    /// [`Self::new`] with memory to use.
    ///
    /// # Errors
    /// As for [`Self::new`].
    pub fn in_memory(
        views: &'a [View],
        params: &HullParams,
        workspace: &mut Workspace,
        progress: &dyn Progress,
    ) -> Result<Self> {
        carve::carve(views, params, workspace, progress)
    }

    /// Hands its memory back; it is of no use afterwards.
    pub fn keep_in(&mut self, workspace: &mut Workspace) {
        workspace.keep(take(&mut self.values));
        workspace.keep(take(&mut self.list_starts));
        workspace.keep(take(&mut self.needed));
        workspace.keep(take(&mut self.carver_lists));
    }

    /// Signed distance to the hull's surface in scene units, positive inside: exact in sign, a lower bound inside.
    pub fn signed_distance(&self, p: Vec3) -> f32 {
        self.signed_distance_without(p, u16::MAX)
    }

    /// As [`Self::signed_distance`], over all views but one.
    pub fn signed_distance_without(&self, p: Vec3, view: u16) -> f32 {
        self.nearest_contour(p, view).0
    }

    /// [`Self::signed_distance_without`], and the view that it comes from.
    fn nearest_contour(&self, p: Vec3, view: u16) -> (f32, Option<&Carver<'a>>) {
        let slot = self.slot(p);
        if slot < SparseGrid::INSIDE {
            let list = self.block_carvers(slot as usize);
            least(list.iter().map(|&c| &self.carvers[c as usize]), p, view, self.grid.voxel, self.needed[slot as usize])
        } else {
            // Whatever single views say, the block as a whole was judged.
            let (d, from) = least(self.carvers.iter(), p, view, self.grid.voxel, self.least_silhouettes);
            (if slot == SparseGrid::INSIDE { max(d, self.grid.voxel) } else { min(d, -self.grid.voxel) }, from)
        }
    }

    /// Outward unit normal of the hull's surface near a point.
    pub fn normal(&self, p: Vec3) -> Vec3 {
        let h = 0.5 * self.footprint;
        let d = |axis: Vec3| self.signed_distance(p - axis * h) - self.signed_distance(p + axis * h);
        Vec3::new(d(Vec3::X), d(Vec3::Y), d(Vec3::Z)).normalize_or_zero()
    }

    /// Corners of the hull's bounding box.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        (self.lower, self.upper)
    }

    /// L = V^(1/3), V the volume of the bounding box: the method's unit of length.
    pub fn length(&self) -> f32 {
        let s = self.upper - self.lower;
        libm::cbrtf(s.x * s.y * s.z)
    }

    /// Median over the views of a pixel's size at the object.
    pub fn footprint(&self) -> f32 {
        self.footprint
    }

    /// The grid and the signed distance at its nodes.
    pub fn field(&self) -> (&SparseGrid, &[f32]) {
        (&self.grid, &self.values)
    }

    /// The hull's surface as a closed mesh.
    pub fn mesh(&self, workspace: &mut Workspace) -> Mesh {
        marching_cubes(&self.grid, &self.values, 0.0, [self.grid.voxel, -self.grid.voxel], workspace)
    }

    /// The grid's block at a point.
    fn slot(&self, p: Vec3) -> u32 {
        let q = (p - self.grid.origin) / (self.grid.voxel * BLOCK as f32);
        self.grid.slot(floor(q.x), floor(q.y), floor(q.z))
    }

    fn block_carvers(&self, slot: usize) -> &[u16] {
        &self.carver_lists[self.list_starts[slot] as usize..self.list_starts[slot + 1] as usize]
    }

    /// Signed distance from the grid, trilinear: fast, for searching.
    #[inline]
    pub(crate) fn coarse(&self, p: Vec3) -> f32 {
        self.grid.interpolate(&self.values, p, -self.grid.voxel, self.grid.voxel)
    }
}

impl Envelope for VisualHull<'_> {
    fn bounds(&self) -> (Vec3, Vec3) {
        self.bounds()
    }

    /// From the grid near the surface: meshing asks for it at every node.
    fn signed_distance(&self, p: Vec3) -> f32 {
        if self.slot(p) < SparseGrid::INSIDE { self.coarse(p) } else { self.signed_distance(p) }
    }
}

/// The signed distance at the places of a walk. A view that sees one place clearly outside mostly does so for the next
/// as well, and one that does is enough.
pub(crate) struct Walk<'h, 'a> {
    hull: &'h VisualHull<'a>,
    without: u16,
    excluding: Option<&'h Carver<'a>>,
}

impl<'h, 'a> Walk<'h, 'a> {
    /// Over all views but one.
    pub(crate) fn new(hull: &'h VisualHull<'a>, without: u16) -> Self {
        Self { hull, without, excluding: None }
    }

    /// [`VisualHull::signed_distance_without`]; where that is below `-clear`, a larger value that is below too.
    #[inline]
    pub(crate) fn signed_distance(&mut self, p: Vec3, clear: f32) -> f32 {
        if let Some(d) = self.excluding.and_then(|carver| carver.distance(p)).filter(|&d| d < -clear) {
            return d;
        }
        let (d, from) = self.hull.nearest_contour(p, self.without);
        self.excluding = from;
        d
    }
}

/// The least distance over some views and whose it is; outside where fewer than `needed` of them see the point.
fn least<'c, 'a: 'c>(
    carvers: impl Iterator<Item = &'c Carver<'a>>,
    p: Vec3,
    without: u16,
    voxel: f32,
    needed: u32,
) -> (f32, Option<&'c Carver<'a>>) {
    let (mut nearest, mut from, mut seen) = (FAR * voxel, None, 0);
    for carver in carvers {
        if carver.index != without
            && let Some(d) = carver.distance(p)
        {
            if d < nearest {
                (nearest, from) = (d, Some(carver));
            }
            seen += 1;
        }
    }
    (if seen < needed { min(nearest, -voxel) } else { nearest }, from)
}

/// Position of a node of a stored block.
fn block_node(grid: &SparseGrid, slot: usize, local: usize) -> Vec3 {
    debug_assert!(local < BLOCK_NODES);
    let [x, y, z] = grid.blocks[slot].map(|v| i32::from(v) * BLOCK as i32);
    let l = local as i32;
    let (b, m) = (BLOCK.trailing_zeros(), BLOCK as i32 - 1);
    grid.node(x + (l & m), y + ((l >> b) & m), z + (l >> (2 * b)))
}
