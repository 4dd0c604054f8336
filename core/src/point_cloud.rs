//! Oriented points and meshes: the data that the stages exchange.

use crate::{hash::Hash64, workspace::Workspace};
use alloc::vec::Vec;
use glam::Vec3;

/// The kind of a point, in increasing order of trust (§5: frontier points above all detected points, implicit points
/// below all).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum Rank {
    /// On a part of the hull that no camera sees (§4.4). Only keeps the model complete.
    Implicit = 0,
    /// Placed on the hull because stereo failed (§4.2).
    Substituted = 1,
    /// Found by stereo (§4.1).
    Detected = 2,
    /// On a contour generator and therefore certainly on the surface (§4.4).
    Frontier = 3,
}

/// An oriented point s = (x, n, v, f) of §5.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Position relative to the rig's origin.
    pub position: Vec3,
    /// Outward unit normal.
    pub normal: Vec3,
    /// Fidelity f of eq. 1: at most the number of neighbouring views J if peaks vote as printed
    /// ([`crate::detect::Support::Peaks`]). Spread peaks can add up to more.
    pub fidelity: f32,
    /// Standard deviation of the position along the normal, in pixels of footprint. That of a detected point follows from
    /// its support, that of a frontier point from its contour and its interval. For substituted points it is a constant.
    /// For implicit points it is 0, which meshing takes as exact.
    pub sigma: f32,
    /// Non-negative weight in meshing (eq. 3).
    pub weight: f32,
    /// Index of the detecting view; [`Point::NO_VIEW`] for implicit points.
    pub view: u16,
    /// The kind of point.
    pub rank: Rank,
}

impl Point {
    /// Stands for the view of a point that no view detected.
    pub const NO_VIEW: u16 = u16::MAX;
}

/// Oriented points in a deterministic order.
pub type PointCloud = Vec<Point>;

/// Concatenates several clouds.
pub(crate) fn concat<'a>(clouds: impl Iterator<Item = &'a [Point]> + Clone, workspace: &mut Workspace) -> PointCloud {
    let mut all = workspace.empty(clouds.clone().map(<[Point]>::len).sum());
    clouds.for_each(|cloud| all.extend_from_slice(cloud));
    all
}

/// A closed triangle mesh. Triangles are counter-clockwise as seen from outside.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Positions relative to the rig's origin. Export adds [`crate::Rig::origin`].
    pub positions: Vec<Vec3>,
    /// Outward unit normals, one per position.
    pub normals: Vec<Vec3>,
    /// sRGB colours, one per position. Empty before colouring.
    pub colours: Vec<[u8; 3]>,
    /// Triangles, as indices of positions.
    pub triangles: Vec<[u32; 3]>,
}

/// Hash of points, which depends on their order.
pub fn hash<'a>(points: impl IntoIterator<Item = &'a Point>) -> u64 {
    let mut hash = Hash64::default();
    for p in points {
        p.position.to_array().iter().chain(&p.normal.to_array()).for_each(|&v| hash.number(v));
        hash.number(p.fidelity);
        hash.number(p.sigma);
        hash.number(p.weight);
        hash.word(u64::from(p.view) << 8 | p.rank as u64);
    }
    hash.finish()
}

impl Mesh {
    /// An empty mesh that uses memory of the workspace.
    pub(crate) fn with_workspace(workspace: &mut Workspace) -> Self {
        Self {
            positions: workspace.take(),
            normals: workspace.take(),
            colours: workspace.take(),
            triangles: workspace.take(),
        }
    }

    /// Returns its memory to the workspace.
    pub fn recycle_into(self, workspace: &mut Workspace) {
        let Self { positions, normals, colours, triangles } = self;
        workspace.recycle(positions);
        workspace.recycle(normals);
        workspace.recycle(colours);
        workspace.recycle(triangles);
    }

    /// Hash of positions, normals, colours and triangles.
    pub fn hash(&self) -> u64 {
        self.hash_in(&self.colours)
    }

    /// Hash of positions, normals and triangles: the hash that the mesh had before it was coloured.
    pub fn uncoloured_hash(&self) -> u64 {
        self.hash_in(&[])
    }

    fn hash_in(&self, colours: &[[u8; 3]]) -> u64 {
        let mut hash = Hash64::default();
        for v in self.positions.iter().chain(&self.normals) {
            v.to_array().iter().for_each(|&v| hash.number(v));
        }
        for [r, g, b] in colours {
            hash.word(u64::from(*r) << 16 | u64::from(*g) << 8 | u64::from(*b));
        }
        for t in &self.triangles {
            t.iter().for_each(|&i| hash.word(u64::from(i)));
        }
        hash.finish()
    }
}
