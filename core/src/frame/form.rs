//! Forms of a finished frame: the mesh as it is, with fewer triangles, or with a texture.

use super::state::{Frame, no_hull};
use crate::{
    error::{Error, Result},
    executor::Executor,
    memory,
    point_cloud::Mesh,
    progress::{Part, Progress},
    rig::Rig,
    simplify::{SimplifyParams, simplify},
    stage::Stage,
    texture::{self, Texture, TextureParams, texture},
};
use alloc::{borrow::Cow, format, vec, vec::Vec};
use core::ops::Deref;
use glam::Vec3;

/// Which form of a mesh is made. The default is the mesh as it is.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FormParams {
    /// Largest number of triangles. More remain if fewer would move the surface by more than
    /// [`SimplifyParams::error_pixels`], or change its topology.
    pub faces: Option<u32>,
    /// Makes a texture, which replaces the colours of vertices.
    pub texture: Option<TextureParams>,
}

/// A form of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Form {
    /// The surface. It is closed if vertices at the same position are taken as one: with a texture, vertices at a border of
    /// charts are there once per chart.
    pub mesh: Mesh,
    /// The texture, if one was asked for.
    pub texture: Option<Texture>,
}

impl Form {
    /// The form of a mesh without a texture, which needs no frame. `footprint` is the size of a pixel at the object, in scene
    /// units.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn untextured(mesh: &Mesh, faces: Option<u32>, footprint: f32, progress: &dyn Progress) -> Result<Self> {
        let reduced = |progress: &dyn Progress| match faces {
            None => Ok(mesh.clone()),
            Some(faces) => simplify(mesh, &SimplifyParams::new(faces, footprint), progress),
        };
        progress.on_stage_start(Stage::Form);
        let mesh = reduced(&Part { of: progress, stage: Stage::Form, part: 0, parts: 1 });
        progress.on_stage_end(Stage::Form);
        Ok(Self { mesh: mesh?, texture: None })
    }

    /// The same form with its vertices in another order, as compression and drawing prefer it. `places` has the new number of each
    /// vertex, or `u32::MAX` for one that no triangle uses, which is dropped. `triangles` have the new numbers.
    #[must_use]
    pub fn reordered(mut self, places: &[u32], triangles: Vec<[u32; 3]>) -> Self {
        let Mesh { positions, normals, colours, .. } = &self.mesh;
        let mesh = Mesh {
            positions: reordered(positions, places),
            normals: reordered(normals, places),
            colours: reordered(colours, places),
            triangles,
        };
        if let Some(texture) = &mut self.texture {
            texture.uvs = reordered(&texture.uvs, places);
        }
        Self { mesh, ..self }
    }
}

/// Items of vertices at their new places.
fn reordered<T: Copy + Default>(items: &[T], places: &[u32]) -> Vec<T> {
    let used = places.iter().filter(|&&place| place != u32::MAX).count();
    let mut out = vec![T::default(); if items.is_empty() { 0 } else { used }];
    for (&item, &place) in items.iter().zip(places) {
        if let Some(slot) = out.get_mut(place as usize) {
            *slot = item;
        }
    }
    out
}

impl<R: Deref<Target = Rig> + Sync> Frame<R> {
    /// Makes a form of the finished mesh. The frame stays as it is, so that any number of forms can be made of it.
    ///
    /// # Errors
    /// [`crate::Error::WrongOrder`] if [`Stage::Colour`] is not complete, [`crate::Error::Form`],
    /// [`crate::Error::OutOfMemory`], and [`crate::Error::Cancelled`].
    pub fn form(&self, params: &FormParams, executor: &dyn Executor, progress: &dyn Progress) -> Result<Form> {
        self.require(Stage::Colour)?;
        self.form_of(self.mesh(), &self.gains, params, executor, progress)
    }

    /// Makes a form of a mesh that was finished elsewhere from the same pictures with the same parameters, perhaps by
    /// averaging. `gains` are its [`Frame::gains`]. The frame needs its views and the hull only, see [`Frame::carve`].
    ///
    /// # Errors
    /// [`crate::Error::WrongOrder`] if [`Stage::Hull`] is not complete, [`crate::Error::Form`],
    /// [`crate::Error::OutOfMemory`], and [`crate::Error::Cancelled`].
    pub fn form_of(
        &self,
        mesh: &Mesh,
        gains: &[[f32; 3]],
        params: &FormParams,
        executor: &dyn Executor,
        progress: &dyn Progress,
    ) -> Result<Form> {
        self.require(Stage::Hull)?;
        progress.on_stage_start(Stage::Form);
        let form = self.make_form(mesh, gains, params, executor, progress);
        progress.on_stage_end(Stage::Form);
        form
    }

    fn make_form(
        &self,
        mesh: &Mesh,
        gains: &[[f32; 3]],
        params: &FormParams,
        executor: &dyn Executor,
        progress: &dyn Progress,
    ) -> Result<Form> {
        let hull = self.hull.as_ref().ok_or_else(no_hull)?;
        let footprint = hull.footprint();
        let within_memory = |mesh: &Mesh, size: u32| {
            let frame =
                || memory::needed(self.views(), hull, &self.intermediates.hull, &self.params, self.kept.whole_views);
            memory::check_form(frame, &self.windows, mesh, size, self.memory.limit())
        };
        let steps = u32::from(params.faces.is_some()) + u32::from(params.texture.is_some());
        let part = |part| Part { of: progress, stage: Stage::Form, part, parts: steps };
        let mesh = match params.faces {
            None => Cow::Borrowed(mesh),
            Some(faces) => {
                within_memory(mesh, 0)?;
                let defaults = SimplifyParams::new(faces, footprint);
                // A texture has its own colours, so that those of the vertices need not be kept.
                let colour_pixels = if params.texture.is_some() { 0.0 } else { defaults.colour_pixels };
                let params = SimplifyParams { colour_pixels, ..defaults };
                Cow::Owned(simplify(mesh, &params, &part(0))?)
            }
        };
        let Some(params) = &params.texture else {
            return Ok(Form { mesh: mesh.into_owned(), texture: None });
        };
        if gains.len() != self.cameras() {
            let problem = format!("there are gains of {} cameras instead of {}", gains.len(), self.cameras());
            return Err(Error::Form { problem });
        }
        // The frame keeps its gains in the order in which the cameras were given.
        let gains: Vec<Vec3> = self.rig.order().iter().map(|&camera| gains[camera as usize].into()).collect();
        let progress = part(steps - 1);
        let size = texture::size(&mesh, footprint, params)?;
        within_memory(&mesh, size)?;
        let (mesh, texture) =
            texture(&mesh, &self.windows, &gains, size, self.params.colour.blended_views, executor, &progress)?;
        Ok(Form { mesh, texture: Some(texture) })
    }
}
