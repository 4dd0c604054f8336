//! Colours of single points of a surface (§7), for textures.

use super::{
    blend,
    candidate::{Candidate, insert_best, sample_view},
    depth::DepthBuffer,
    kept,
};
use crate::{executor::Executor, point_cloud::Mesh, view::View};
use alloc::vec::Vec;
use glam::Vec3;

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
    pub fn new(mesh: &Mesh, views: &'a [View], gains: &'a [Vec3], blended: u32, executor: &dyn Executor) -> Self {
        let buffers = executor.map_with(&mut Vec::new(), views.len(), |projected, i| {
            let mut buffer = DepthBuffer::default();
            if views[i].is_used() {
                buffer.render(mesh, &views[i].camera, projected);
            }
            buffer
        });
        Self { views, buffers, gains, blended: blended.max(1) as usize }
    }

    /// The sRGB colour of a point of the mesh with a normal, or `None` if no view sees it. `best` is overwritten.
    pub fn at(&self, position: Vec3, normal: Vec3, best: &mut Vec<Candidate>) -> Option<Vec3> {
        best.clear();
        best.resize(kept(self.blended), Candidate::NONE);
        for (i, (view, buffer)) in self.views.iter().zip(&self.buffers).enumerate() {
            if !view.is_used() {
                continue;
            }
            let pixel = view.camera.project(position);
            if let Some(candidate) = sample_view(view, i as u16, buffer, position, normal, pixel) {
                insert_best(best, candidate);
            }
        }
        blend(best, self.blended, self.gains)
    }
}
