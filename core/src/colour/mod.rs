//! View-independent colours of a mesh (§7): each vertex gets the pixel of the camera that faces it best among those
//! that see it.

mod candidate;
mod depth;
mod fill;
mod gains;
mod point;

use crate::{
    error::Result,
    executor::Executor,
    point_cloud::Mesh,
    progress::{self, Progress},
    silhouette::Uncovered,
    stage::Stage,
    view::View,
    workspace::Workspace,
};
use alloc::{vec, vec::Vec};
pub(crate) use candidate::Candidate;
use candidate::{insert_best, sample_view};
use depth::DepthBuffer;
use glam::Vec3;

pub use gains::GainParams;
pub(crate) use point::PointColours;

/// Parameters of colouring (§7).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct ColourParams {
    /// Solves one gain per camera and channel from overlapping views, unless the rig has fixed gains. Without it the
    /// pictures are used unchanged.
    pub gains: Option<GainParams>,
    /// Number of views that are blended. The paper uses 1.
    pub blended_views: u32,
}

/// What colouring finds out about the views.
#[derive(Debug)]
pub(crate) struct Coloured {
    /// The gains that were used, one per view.
    pub gains: Vec<Vec3>,
    /// What of each view's silhouette the mesh leaves uncovered.
    pub uncovered: Vec<Uncovered>,
}

/// Views whose depth buffers are held at the same time.
const VIEWS_AT_A_TIME: usize = 8;
/// Vertices that one job of an executor works on.
const VERTICES_PER_JOB: usize = 4096;

/// The blending weight of a view is this power of its score.
const BLEND_POWER: i32 = 4;

/// Colours the mesh from the views that see it.
///
/// Each vertex gets the interpolated pixel of the camera whose ray is most opposed to its normal
/// ([`ColourParams::blended_views`] = 1, as in the paper), or a seamless blend of several such views. The colours of
/// vertices that no camera sees are diffused from their surroundings. Colours are sRGB, like the pictures.
///
/// `fixed_gains`, one per view, replace the gains that are otherwise solved here.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub(crate) fn colour(
    mesh: &mut Mesh,
    views: &[View],
    fixed_gains: Option<&[Vec3]>,
    params: &ColourParams,
    workspace: &mut Workspace,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<Coloured> {
    // One step per view, one for the gains and one for blending.
    let step = |done: u32| progress::step(progress, Stage::Colour, done, views.len() as u32 + 2);
    let solved = params.gains.filter(|_| fixed_gains.is_none());
    let blended = params.blended_views.max(1) as usize;
    let kept = kept(blended);
    let mut candidates: Vec<Candidate> = workspace.filled(Candidate::NONE, mesh.positions.len() * kept);
    let mut overlap = gains::Overlap::new(mesh.positions.len(), views.len(), workspace);
    let used: Vec<(u16, &View)> = (0..).zip(views).filter(|(_, view)| view.is_used()).collect();
    let mut buffers: Vec<DepthBuffer> = Vec::new();
    buffers.resize_with(used.len().min(VIEWS_AT_A_TIME), || DepthBuffer::with_workspace(workspace));
    let mut projected = vec![workspace.take()];
    let mut uncovered = vec![Uncovered::default(); views.len()];
    for (n, batch) in used.chunks(VIEWS_AT_A_TIME).enumerate() {
        let done = (n * VIEWS_AT_A_TIME) as u32;
        let rendered = executor.map_parts_with(
            &mut projected,
            buffers.iter_mut().zip(batch),
            |projected, i, (buffer, (_, view))| {
                buffer.render(mesh, &view.camera, projected);
                step(done + i as u32)
            },
        );
        rendered.into_iter().collect::<Result<()>>()?;
        for (&(index, view), buffer) in batch.iter().zip(&buffers) {
            uncovered[usize::from(index)] =
                view.shown().map(|silhouette| buffer.uncovered(silhouette)).unwrap_or_default();
        }
        let parts = candidates.chunks_mut(VERTICES_PER_JOB * kept);
        let found = executor.map_parts(parts, |part, candidates| {
            let mut compared: Vec<gains::Sample> = Vec::new();
            for (&(index, view), buffer) in batch.iter().zip(&buffers) {
                let vertices = part * VERTICES_PER_JOB..mesh.positions.len();
                for (v, candidates) in vertices.zip(candidates.chunks_exact_mut(kept)) {
                    let (position, normal) = (mesh.positions[v], mesh.normals[v]);
                    let pixel = view.camera.project(position);
                    let Some(candidate) = sample_view(view, index, buffer, position, normal, pixel) else { continue };
                    if solved.is_some_and(|params| overlap.compares(v, &candidate, &params)) {
                        compared.push((v as u32, index, candidate.rgb));
                    }
                    insert_best(candidates, candidate);
                }
            }
            step(done + batch.len() as u32)?;
            Ok(compared)
        });
        for compared in found {
            overlap.add(&compared?);
        }
    }
    let gains = match (fixed_gains, &solved) {
        (Some(gains), _) => gains.to_vec(),
        (None, Some(params)) => overlap.solve(params, executor),
        (None, None) => vec![Vec3::ONE; views.len()],
    };
    projected.into_iter().for_each(|projected| workspace.recycle(projected));
    buffers.into_iter().for_each(|buffer| buffer.recycle_into(workspace));
    overlap.recycle_into(workspace);
    step(views.len() as u32 + 1)?;
    let mut seen: Vec<Option<Vec3>> = workspace.filled(None, mesh.positions.len());
    let parts = seen.chunks_mut(VERTICES_PER_JOB).zip(candidates.chunks(VERTICES_PER_JOB * kept));
    executor.map_parts(parts, |_, (seen, candidates)| {
        for (seen, candidates) in seen.iter_mut().zip(candidates.chunks_exact(kept)) {
            *seen = blend(candidates, blended, &gains);
        }
    });
    workspace.recycle(candidates);
    step(views.len() as u32 + 2)?;
    let mut colours = workspace.empty(seen.len());
    fill::fill(mesh, &seen, &mut colours);
    mesh.colours.clear();
    mesh.colours.extend(colours.iter().map(|c| c.to_array().map(|v| libm::roundf(v.clamp(0.0, 255.0)) as u8)));
    workspace.recycle(seen);
    workspace.recycle(colours);
    Ok(Coloured { gains, uncovered })
}

/// How many of the best candidates are kept. Blending also needs the best view that is left out.
fn kept(blended: usize) -> usize {
    if blended == 1 { 1 } else { blended + 1 }
}

/// The colour of a point, or `None` without candidates. The weight of the first view left out is subtracted from all
/// weights, so that the colour does not jump where the order of the views changes.
fn blend(candidates: &[Candidate], blended: usize, gains: &[Vec3]) -> Option<Vec3> {
    let seen = candidates.iter().take_while(|o| o.score > 0.0).count();
    if seen == 0 {
        return None;
    }
    let colour = |o: &Candidate| o.rgb * gains[o.view as usize];
    if blended == 1 {
        return Some(colour(&candidates[0]));
    }
    let weight = |o: &Candidate| (0..BLEND_POWER).fold(1.0, |w, _| w * o.score);
    let left_out = if seen > blended { weight(&candidates[blended]) } else { 0.0 };
    let (mut sum, mut total) = (Vec3::ZERO, 0.0);
    for candidate in &candidates[..seen.min(blended)] {
        // The factor keeps the sum positive if all weights are equal.
        let w = weight(candidate) * 1.001 - left_out;
        sum += colour(candidate) * w;
        total += w;
    }
    Some(sum / total)
}

#[cfg(test)]
mod tests;
