//! Finds where the hull's surface is, coarse to fine, and evaluates the signed distance on a band of blocks round it.

use super::search::Search;
use super::{Carver, VisualHull, block_node, least};
use crate::{
    error::{Error, Result},
    grid::{BLOCK, BLOCK_NODES, SparseGrid},
    params::HullParams,
    progress::{self, Progress, Stage},
    rig::LEAST_VIEWS,
    view::View,
    workspace::Workspace,
};
use alloc::vec::Vec;
use glam::Vec3;

/// A pixel's distance grows by at most this factor over the ideal when a point moves: obliquity of rays off the axis.
const OBLIQUITY: f32 = 1.3;

/// What the silhouettes say about a ball.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Verdict {
    Outside,
    Inside,
    Boundary,
}

/// Judges a ball against all views; indices of those that may carve a part of it go to `crossing`. The second value
/// is how many silhouettes see the whole ball as theirs, the third how many may see some of it so.
pub(super) fn judge(
    carvers: &[Carver],
    centre: Vec3,
    radius: f32,
    needed: u32,
    crossing: &mut Vec<u16>,
) -> (Verdict, u32, u32) {
    crossing.clear();
    let (mut containing, mut supporting) = (0, 0);
    for (i, carver) in carvers.iter().enumerate() {
        let q = carver.camera.project(centre);
        let nearest = q.z - radius;
        if q.z <= -radius {
            continue;
        }
        let (w, h) = (carver.camera.width as f32, carver.camera.height as f32);
        if nearest <= 0.0 {
            crossing.push(i as u16);
            supporting += 1;
            continue;
        }
        let r = radius * carver.camera.focal / nearest * OBLIQUITY;
        if q.x + r < 0.0 || q.y + r < 0.0 || q.x - r > w - 1.0 || q.y - r > h - 1.0 {
            continue;
        }
        let whole = q.x >= r && q.y >= r && q.x + r <= w - 1.0 && q.y + r <= h - 1.0;
        let corner = |dx: f32, dy: f32| carver.silhouette.sample(q.x + dx * r, q.y + dy * r).is_some();
        let whole = whole && corner(-1.0, -1.0) && corner(1.0, -1.0) && corner(-1.0, 1.0) && corner(1.0, 1.0);
        match carver.silhouette.sample(q.x.clamp(0.0, w - 1.0), q.y.clamp(0.0, h - 1.0)) {
            Some(d) if whole && d < -r => return (Verdict::Outside, 0, 0),
            Some(d) if whole && d > r => containing += 1,
            // At the picture's edge: what this view sees of the ball is background, of the rest it knows nothing.
            Some(d) if d < -2.0 * r => crossing.push(i as u16),
            _ => {
                crossing.push(i as u16);
                supporting += 1;
            }
        }
    }
    supporting += containing;
    let verdict = if supporting < needed {
        Verdict::Outside
    } else if crossing.is_empty() {
        Verdict::Inside
    } else {
        Verdict::Boundary
    };
    (verdict, containing, supporting)
}

pub(super) fn carve<'a>(
    views: &'a [View],
    params: &HullParams,
    workspace: &mut Workspace,
    progress: &dyn Progress,
) -> Result<VisualHull<'a>> {
    let carvers: Vec<Carver> = views
        .iter()
        .filter_map(|v| Some(Carver { camera: v.camera, silhouette: v.silhouette.as_ref()?, index: v.index }))
        .collect();
    if (carvers.len() as u32) < LEAST_VIEWS {
        return Err(Error::TooFewViews { given: carvers.len() as u32, needed: LEAST_VIEWS });
    }
    let search = Search::new(&carvers, workspace, progress)?;
    let (lower, upper) = (search.lower, search.upper);
    let footprint = footprint(&carvers, (lower + upper) * 0.5);
    let voxel = footprint * params.voxel_pixels;
    let edge = voxel * BLOCK as f32;
    // A node's margin on every side, so that the band closes inside the grid.
    let origin = lower - Vec3::splat(edge);
    let size = (upper - lower) / edge;
    let dims = [size.x, size.y, size.z].map(|s| libm::ceilf(s) as u32 + 2);

    // A block answers for its nodes and for the cells up to the next block's first nodes.
    let radius = 0.5 * edge * 1.7320508 + voxel;
    let most = dims.iter().product::<u32>() as usize;
    let (mut list_starts, mut needed) = (workspace.empty(most + 1), workspace.empty(most));
    let mut carver_lists = workspace.growing();
    list_starts.push(0);
    let mut crossing = Vec::new();
    let mut cancelled = Ok(());
    let grid = SparseGrid::new(origin, voxel, dims, |[x, y, z]| {
        if x == 0 && y == 0 && cancelled.is_ok() {
            cancelled = progress::step(progress, Stage::Hull, z, 2 * dims[2]);
        }
        if cancelled.is_err() {
            return SparseGrid::OUTSIDE;
        }
        let centre = origin + Vec3::new(x as f32 + 0.5, y as f32 + 0.5, z as f32 + 0.5) * edge;
        if !search.touches(centre, 0.5 * edge + voxel) {
            return SparseGrid::OUTSIDE;
        }
        let (verdict, containing, _) = judge(&carvers, centre, radius, search.needed, &mut crossing);
        match verdict {
            Verdict::Outside => SparseGrid::OUTSIDE,
            Verdict::Inside => SparseGrid::INSIDE,
            Verdict::Boundary => {
                carver_lists.extend_from_slice(&crossing);
                list_starts.push(carver_lists.len() as u32);
                needed.push(search.needed.saturating_sub(containing));
                0
            }
        }
    });
    cancelled?;
    let least_silhouettes = search.needed;
    workspace.keep(search.cells);

    let values = workspace.empty(grid.blocks.len() * BLOCK_NODES);
    let mut hull = VisualHull {
        carvers,
        grid,
        values,
        list_starts,
        carver_lists,
        needed,
        least_silhouettes,
        lower,
        upper,
        footprint,
    };
    let blocks = hull.grid.blocks.len();
    let (mut lower, mut upper) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for slot in 0..blocks {
        if slot % 256 == 0 {
            progress::step(progress, Stage::Hull, (blocks + slot) as u32, 2 * blocks as u32)?;
        }
        for local in 0..BLOCK_NODES {
            let p = block_node(&hull.grid, slot, local);
            let list = hull.block_carvers(slot).iter().map(|&c| &hull.carvers[c as usize]);
            let d = least(list, p, u16::MAX, voxel, hull.needed[slot]).0.clamp(-4.0 * voxel, 4.0 * voxel);
            if d > 0.0 {
                (lower, upper) = (lower.min(p), upper.max(p));
            }
            hull.values.push(d);
        }
    }
    if lower.x > upper.x {
        return Err(Error::EmptyHull);
    }
    (hull.lower, hull.upper) = (lower - Vec3::splat(voxel), upper + Vec3::splat(voxel));
    Ok(hull)
}

/// Median over the views of a pixel's size at a point.
fn footprint(carvers: &[Carver], p: Vec3) -> f32 {
    // Bits of positive numbers have their order.
    let mut sizes: Vec<u32> = carvers
        .iter()
        .filter_map(|c| {
            let depth = c.camera.depth(p);
            (depth > 0.0).then(|| c.camera.footprint(depth).to_bits())
        })
        .collect();
    sizes.sort_unstable();
    f32::from_bits(sizes[sizes.len() / 2])
}
