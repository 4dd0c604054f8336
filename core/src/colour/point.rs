//! Colours of single points of a surface (§7), for textures.

use super::{
    blend,
    candidate::{Candidate, insert_best, sample_view},
    depth::DepthBuffer,
};
use crate::{executor::Executor, point_cloud::Mesh, view::View};
use alloc::vec::Vec;
use glam::Vec3;

/// Most views that are blended at a point.
const MOST_BLENDED: usize = 7;

/// Gives the colour of any point of a mesh, by the rules by which [`super::colour`] gives those of its vertices.
pub(crate) struct PointColours<'a> {
    views: &'a [View],
    /// What each view sees of the mesh.
    buffers: Vec<DepthBuffer>,
    gains: &'a [Vec3],
    blended: usize,
}

impl<'a> PointColours<'a> {
    /// `gains` has one factor per view.
    pub fn new(mesh: &Mesh, views: &'a [View], gains: &'a [Vec3], blended: u32, executor: &impl Executor) -> Self {
        let buffers = executor.map(views.len(), |i| {
            let mut buffer = DepthBuffer::default();
            if views[i].is_used() {
                buffer.render(mesh, &views[i].camera);
                buffer.forget_vertices();
            }
            buffer
        });
        Self { views, buffers, gains, blended: (blended.max(1) as usize).min(MOST_BLENDED) }
    }

    /// The sRGB colour of a point of the mesh with a normal, or `None` if no view sees it.
    pub fn at(&self, position: Vec3, normal: Vec3) -> Option<Vec3> {
        let mut best = [Candidate { score: 0.0, view: u16::MAX, rgb: Vec3::ZERO }; MOST_BLENDED + 1];
        // Blending also needs the best view that is left out.
        let kept = if self.blended == 1 { 1 } else { self.blended + 1 };
        for (i, (view, buffer)) in self.views.iter().zip(&self.buffers).enumerate() {
            if !view.is_used() {
                continue;
            }
            let pixel = view.camera.project(position);
            if let Some(candidate) = sample_view(view, i as u16, buffer, position, normal, pixel) {
                insert_best(&mut best[..kept], candidate);
            }
        }
        blend(&best[..kept], self.blended, self.gains)
    }
}
