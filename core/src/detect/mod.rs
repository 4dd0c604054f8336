//! Point cloud detection (§4), one view at a time.

mod clean;
mod depth;
mod frontier;
mod implicit;
mod level;
mod neighbours;
mod range;
mod sweep;
mod vote;

pub(crate) use neighbours::neighbours;

pub use clean::CleanParams;
pub use depth::SearchParams;
pub use frontier::{FrontierParams, frontier};
pub use implicit::implicit;
pub use level::Level;
pub use vote::VoteParams;

use crate::{
    error::Result,
    hull::VisualHull,
    params::DetectionParams,
    point_cloud::{Mesh, PointCloud, Rank},
    progress::{Progress, Stage},
    raster::{Crossings, Raster},
    report::Counts,
    rig::Rig,
};
use alloc::vec::Vec;
use depth::DepthMap;
use range::SearchRange;

/// The surface that a search starts from.
#[derive(Clone, Copy)]
pub enum Guide<'a> {
    /// The hull's mesh: the search runs through all of it.
    Hull(&'a Mesh),
    /// A mesh found before: the search stays near it.
    Surface(&'a Mesh),
}

/// Buffers of a view's detection, for one view after another; what they hold does not matter.
#[derive(Default)]
pub struct Scratch {
    raster: Raster,
    crossings: Crossings,
    range: SearchRange,
    depth: depth::Scratch,
    map: DepthMap,
    rank: Vec<Rank>,
    clean: clean::Scratch,
}

/// Detects the points of one view: §4.1 to §4.3.
///
/// `levels` are all views at the resolution that `params` asks for. `progress` is asked once a row of tiles and cancels.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn detect(
    rig: &Rig,
    view: usize,
    levels: &[Level],
    hull: &VisualHull,
    guide: Guide,
    params: &DetectionParams,
    scratch: &mut Scratch,
    progress: &dyn Progress,
) -> Result<(PointCloud, Counts)> {
    let Scratch { raster, crossings, range, depth, map, rank, clean } = scratch;
    let level = &levels[view];
    let neighbours = rig.neighbours(view, params.search.neighbours);
    let neighbours: Vec<&Level> = neighbours.iter().map(|&j| &levels[j as usize]).collect();
    match guide {
        Guide::Hull(mesh) => {
            crossings.find(mesh, &level.camera);
            range.set_in_hull(level, crossings);
        }
        Guide::Surface(mesh) => {
            raster.render(mesh, &level.camera);
            range.set_round_surface(level, raster, params.band_pixels * hull.footprint());
        }
    }
    let tick = |_, _| crate::progress::step(progress, Stage::Detect, view as u32, levels.len() as u32);
    depth::depth_map(level, &neighbours, range, &params.search, depth, map, tick)?;

    let mut counts = Counts::default();
    let weakest = params.substitute_below * params.search.neighbours as f32;
    rank.clear();
    rank.resize(map.depth.len(), Rank::Detected);
    for i in 0..map.depth.len() {
        if range.guide[i] <= 0.0 {
            continue;
        }
        if map.depth[i] > 0.0 && map.fidelity[i] >= weakest {
            counts.detected += 1;
        } else {
            // §4.2: stereo has failed, and what has no texture more probably lies on the hull.
            counts.substituted += 1;
            rank[i] = Rank::Substituted;
            map.depth[i] = if params.substitute { range.guide[i] } else { 0.0 };
            map.fidelity[i] = 0.0;
        }
    }
    let mut cloud = clean::clean(level, map, rank, view as u16, &params.clean, clean, &mut counts);
    for point in &mut cloud {
        point.weight = match point.rank {
            Rank::Substituted => params.substituted_weight,
            _ => point.fidelity,
        };
    }
    Ok((cloud, counts))
}

#[cfg(test)]
mod tests;
