//! Whether the surface lacks what the silhouettes show.

use super::{state::Frame, warning::Warning};
use crate::{raster::Raster, rig::Rig, silhouette::Uncovered};
use core::ops::Deref;

/// The surface lacks a part if it leaves more than this share of a silhouette uncovered, well inside its contour. Complete
/// surfaces of real captures leave up to 0.4 %, in holes that masks lack.
const LACKING: f32 = 0.01;

impl<R: Deref<Target = Rig>> Frame<R> {
    /// Looks closer at the views of whose silhouettes the surface seems to lack much. What the hull does not cover either, other
    /// silhouettes exclude, so that these are at fault. `uncovered` are those of the surface, in the rig's order.
    pub(super) fn find_lacking(&mut self, uncovered: &[Uncovered]) {
        self.lacking.clear();
        let [mut surface, mut hull] = [Raster::default(), Raster::default()];
        for (view, uncovered) in self.windows.iter().zip(uncovered) {
            let Some(silhouette) = view.shown().filter(|_| uncovered.share() > LACKING) else { continue };
            surface.render(&self.mesh, &view.camera);
            hull.render(&self.intermediates.hull, &view.camera);
            let is_lacking = |at: usize| surface.inverse[at] == 0.0 && hull.inverse[at] > 0.0;
            let lacking = Uncovered::count(silhouette, &|x, y| !is_lacking(y * surface.width + x));
            if lacking.share() > LACKING {
                self.lacking.push((view.index, lacking));
            }
        }
    }

    /// The warning about the view of whose silhouette the surface lacks most.
    pub(super) fn surface_incomplete(&self) -> Option<Warning> {
        let views = self.lacking.len() as u32;
        // Of equal ones the first.
        let mut worst = self.lacking.first()?;
        for other in &self.lacking {
            if other.1.share() > worst.1.share() {
                worst = other;
            }
        }
        let &(place, lacking) = worst;
        let camera = self.rig().order()[usize::from(place)];
        Some(Warning::SurfaceIncomplete { camera, pixels: lacking.pixels, share: lacking.share(), views })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        frame::Memory,
        params::{Params, Preset},
        point_cloud::Mesh,
        testing::{both, camera, pinhole, ring, silhouette_of, sphere},
    };
    use alloc::vec::Vec;
    use glam::Vec3;

    const BODY: (Vec3, f32) = (Vec3::ZERO, 0.5);
    const PART: (Vec3, f32) = (Vec3::new(0.0, 0.0, 0.6), 0.2);
    const CAMERAS: u32 = 6;

    /// The warning where `shown` are the balls of the silhouettes, and `hull` and `mesh` the meshes.
    fn warning(shown: &[(Vec3, f32)], hull: Mesh, mesh: Mesh) -> Option<Warning> {
        let places = || ring(CAMERAS, 4.0, 0.5);
        let cameras: Vec<_> = places().map(|from| camera(from, Vec3::ZERO, 120, 300.0)).collect();
        let rig = Rig::new(&cameras).expect("a ring");
        let mut frame = Frame::new(&rig, Params::preset(Preset::Default), Memory::default());
        frame.windows = (0..)
            .zip(places())
            .map(|(index, from)| silhouette_of(shown, &pinhole(from, Vec3::ZERO, 120, 300.0), index))
            .collect();
        (frame.mesh, frame.intermediates.hull) = (mesh, hull);
        let uncovered: Vec<Uncovered> = frame
            .windows
            .iter()
            .map(|view| {
                let mut raster = Raster::default();
                raster.render(&frame.mesh, &view.camera);
                let silhouette = view.silhouette.as_ref().expect("it has one");
                Uncovered::count(silhouette, &|x, y| raster.inverse[y * raster.width + x] > 0.0)
            })
            .collect();
        frame.find_lacking(&uncovered);
        frame.surface_incomplete()
    }

    fn ball((centre, radius): (Vec3, f32)) -> Mesh {
        sphere(centre, radius)
    }

    #[test]
    fn a_lost_part_is_named_and_the_view_that_shows_most_of_it() {
        let whole = || both(ball(BODY), &ball(PART));
        let Some(Warning::SurfaceIncomplete { share, views, .. }) = warning(&[BODY, PART], whole(), ball(BODY)) else {
            panic!("the part is missing");
        };
        assert_eq!(views, CAMERAS, "all views show it");
        assert!((0.02..0.15).contains(&share), "{share}");
        assert_eq!(warning(&[BODY, PART], whole(), whole()), None, "nothing is missing");
    }

    #[test]
    fn what_the_hull_lacks_is_no_fault_of_the_surface() {
        assert_eq!(warning(&[BODY, PART], ball(BODY), ball(BODY)), None);
    }
}
