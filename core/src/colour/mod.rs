//! View-independent colours of a mesh (§7): each vertex gets the pixel of the camera that faces it best among those
//! that see it.

mod candidate;
mod depth;
mod fill;
mod gains;
mod point;

use crate::{
    error::Result,
    point_cloud::Mesh,
    progress::{self, Progress},
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

/// The blending weight of a view is this power of its score.
const BLEND_POWER: i32 = 4;

/// Colours the mesh from the views that see it.
///
/// Each vertex gets the interpolated pixel of the camera whose ray is most opposed to its normal
/// ([`ColourParams::blended_views`] = 1, as in the paper), or a seamless blend of several such views. The colours of
/// vertices that no camera sees are diffused from their surroundings. Colours are sRGB, like the pictures.
///
/// `fixed_gains`, one per view, replace the gains that are otherwise solved here. Returns the gains that were used.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn colour(
    mesh: &mut Mesh,
    views: &[View],
    fixed_gains: Option<&[Vec3]>,
    params: &ColourParams,
    workspace: &mut Workspace,
    progress: &dyn Progress,
) -> Result<Vec<Vec3>> {
    // One step per view, one for the gains and one for blending.
    let step = |done: u32| progress::step(progress, Stage::Colour, done, views.len() as u32 + 2);
    let solved = params.gains.filter(|_| fixed_gains.is_none());
    let blended = params.blended_views.max(1) as usize;
    let kept = kept(blended);
    let mut candidates: Vec<Candidate> = workspace.filled(Candidate::NONE, mesh.positions.len() * kept);
    let mut overlap = gains::Overlap::new(mesh.positions.len(), views.len(), workspace);
    let mut buffer = DepthBuffer::with_workspace(workspace);
    for (i, view) in views.iter().enumerate() {
        if view.is_used() {
            buffer.render(mesh, &view.camera);
            for (v, (&position, &normal)) in mesh.positions.iter().zip(&mesh.normals).enumerate() {
                let Some(candidate) = sample_view(view, i as u16, &buffer, position, normal, buffer.projected(v))
                else {
                    continue;
                };
                if let Some(params) = &solved {
                    overlap.add(v, i, &candidate, params);
                }
                insert_best(&mut candidates[v * kept..][..kept], candidate);
            }
        }
        step(i as u32 + 1)?;
    }
    let gains = match (fixed_gains, &solved) {
        (Some(gains), _) => gains.to_vec(),
        (None, Some(params)) => overlap.solve(params, workspace),
        (None, None) => vec![Vec3::ONE; views.len()],
    };
    buffer.recycle_into(workspace);
    overlap.recycle_into(workspace);
    step(views.len() as u32 + 1)?;
    let mut seen: Vec<Option<Vec3>> = workspace.empty(mesh.positions.len());
    seen.extend(candidates.chunks_exact(kept).map(|candidates| blend(candidates, blended, &gains)));
    workspace.recycle(candidates);
    step(views.len() as u32 + 2)?;
    let mut colours = workspace.empty(seen.len());
    fill::fill(mesh, &seen, &mut colours);
    mesh.colours.clear();
    mesh.colours.extend(colours.iter().map(|c| c.to_array().map(|v| libm::roundf(v.clamp(0.0, 255.0)) as u8)));
    workspace.recycle(seen);
    workspace.recycle(colours);
    Ok(gains)
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
