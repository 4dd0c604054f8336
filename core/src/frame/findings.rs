//! What a frame has found out about its views: figures and warnings.

use super::{
    diagnostics::ViewDiagnostics,
    outlying::{Fit, is_outlying},
    state::Frame,
    warning::Warning,
};
use crate::{
    calibration::Finding,
    left_out::LeftOut,
    math::{max, median, ordered},
    params::Method,
    rig::Rig,
    silhouette::ContourFault,
    stage::Stage,
    view::View,
};
use alloc::vec::Vec;
use core::ops::Deref;

/// If the median overlap is smaller than this, the silhouettes as a whole contradict each other. Exact silhouettes
/// overlap to 99.7 %, real ones that were made well to 98 %.
const CONTRADICT_BELOW: f32 = 0.95;
/// They do so only if the hull's outline also lies more than this from half of the contours, in pixels. In small pictures the
/// contour alone is a large part of a silhouette.
const CONTRADICT_PIXELS: f32 = 1.0;
/// Colours differ much if a gain is larger than this or smaller than its inverse. One and a half aperture stops are.
const DIFFERENT_GAIN: f32 = 2.0;

impl<R: Deref<Target = Rig>> Frame<R> {
    /// How well each camera's view agrees with the others, in the order in which the cameras were given. Empty before
    /// [`crate::Stage::Hull`] is complete.
    pub fn diagnostics(&self) -> Vec<ViewDiagnostics> {
        (0..self.cameras()).map_while(|camera| self.diagnostics_of(camera)).collect()
    }

    /// How well one camera's view agrees with the others. `None` before [`crate::Stage::Hull`] is complete, or if there is
    /// no such camera.
    pub fn diagnostics_of(&self, camera: usize) -> Option<ViewDiagnostics> {
        let place = self.rig().place(camera)?;
        let (view, found) = (self.views().get(place)?, self.compared.get(place)?);
        Some(ViewDiagnostics {
            used: view.is_used(),
            silhouette_overlap: found.overlap,
            contour_px: found.contour,
            epipolar_px: self.calibration.epipolar.get(place).copied().flatten(),
        })
    }

    /// Warnings about the rig and about what is complete, in the order of the stages and then of the cameras. After a
    /// stage has failed, those about the views remain.
    pub fn warnings(&self) -> Vec<Warning> {
        let pairs = self.rig().same_place().iter();
        let mut warnings: Vec<Warning> = pairs.map(|&(first, second)| Warning::SamePlace { first, second }).collect();
        let faults = self.contour_faults();
        warnings.extend(faults.iter().map(|&fault| Warning::Contour(fault)));
        let cameras = || (0..self.cameras()).filter_map(|camera| Some((camera as u32, self.rig().place(camera)?)));
        // Masks that are all at fault explain what they lack and exclude: nothing of it tells about single cameras.
        let is_of_all = faults.iter().any(|fault| fault.camera().is_none());
        let blamed = |warning: Warning| match warning {
            Warning::CameraContradicts { camera, overlap, .. } if is_of_all => {
                Some(Warning::SilhouetteSetAside { camera, overlap })
            }
            Warning::SilhouetteCompleted { .. } if is_of_all => None,
            _ => Some(warning),
        };
        for (camera, place) in cameras() {
            // Until the stage is complete, the views are where they arrived.
            warnings.extend(match self.views().get(place) {
                Some(view) => self.of_complete(view, camera).and_then(blamed),
                None => self.incoming[place].lock().as_ref().and_then(|view| of_view(view, camera)),
            });
        }
        // What is known to be wrong with a silhouette explains why it disagrees.
        let of_masks = || faults.iter().filter(|fault| !matches!(fault, ContourFault::Blurred { .. }));
        let is_explained = |warning: &Warning| is_of_all || of_masks().any(|fault| fault.camera() == warning.camera());
        warnings.extend(self.disagreements().into_iter().filter(|warning| !is_explained(warning)));
        if self.require(Stage::Detect).is_ok() && self.params().method == Method::Pcmvs {
            let silent = cameras().filter(|&(_, place)| self.views()[place].is_used() && !self.has_stereo[place]);
            warnings.extend(silent.map(|(camera, _)| Warning::NoStereoPoints { camera }));
        }
        if self.require(Stage::Colour).is_ok() {
            warnings.extend(self.surface_incomplete());
        }
        if self.require(Stage::Colour).is_ok() && self.rig().gains().is_none() {
            let differ = |&(_, gains): &(u32, [f32; 3])| gains.iter().any(|&g| max(g, 1.0 / g) > DIFFERENT_GAIN);
            let of_cameras = (0..).zip(self.gains.iter().copied()).filter(differ);
            warnings.extend(of_cameras.map(|(camera, gains)| Warning::ColoursDiffer { camera, gains }));
        }
        let inconsistent = self.calibration.bias.filter(|&pixels| f64::from(pixels) > Finding::INCONSISTENT);
        warnings.extend(inconsistent.map(|pixels| Warning::CalibrationInconsistent { pixels }));
        warnings
    }

    /// The warning about a view of the complete stage.
    fn of_complete(&self, view: &View, camera: u32) -> Option<Warning> {
        let overlap = self.compared.get(usize::from(view.index)).and_then(|found| found.overlap).unwrap_or(0.0);
        match view.left_out {
            Some(LeftOut::Contradicts) => Some(match self.exchanged_with(view.index) {
                Some(other) => Warning::PicturesExchanged { camera, other },
                None => {
                    let mask_follows = view.edge.is_some_and(|edge| edge.is_followed());
                    Warning::CameraContradicts { camera, overlap, mask_follows }
                }
            }),
            None if view.is_set_aside() => Some(Warning::SilhouetteSetAside { camera, overlap }),
            None if view.restored > 0 => Some(Warning::SilhouetteRestored { camera, pixels: view.restored }),
            None if view.added > 0 => Some(Warning::SilhouetteCompleted { camera, pixels: view.added }),
            _ => of_view(view, camera),
        }
    }

    /// The camera whose picture is exchanged with that of the view at a place.
    fn exchanged_with(&self, place: u16) -> Option<u32> {
        let &[a, b] = self.exchanged.iter().find(|pair| pair.contains(&place))?;
        Some(self.rig().order()[usize::from(if a == place { b } else { a })])
    }

    /// Warnings about silhouettes of used views that disagree with the others.
    fn disagreements(&self) -> Vec<Warning> {
        let fits = self.fits();
        let Some(&Fit { camera: worst, overlap, .. }) = fits.iter().min_by_key(|fit| ordered(fit.overlap)) else {
            return Vec::new();
        };
        let typical = median(fits.iter().map(|fit| fit.overlap)).unwrap_or(overlap);
        let is_outlying = is_outlying(&fits);
        let contradicts = |fit: &Fit| self.agreement.contradicting.contains(&fit.place);
        let named = fits.iter().filter(|fit| contradicts(fit) || is_outlying(fit));
        let warning =
            |&Fit { camera, overlap, .. }: &Fit| Warning::SilhouetteDisagrees { camera, overlap, median: typical };
        let mut named: Vec<Warning> = named.map(warning).collect();
        let is_far =
            median(self.compared.iter().filter_map(|found| found.contour)).is_some_and(|d| d > CONTRADICT_PIXELS);
        if self.agreement.too_many || named.is_empty() && typical < CONTRADICT_BELOW && is_far {
            named.insert(0, Warning::SilhouettesContradict { median: typical, worst, overlap });
        }
        named
    }

    /// Contours along which the pictures show no edge, or a weaker one than beside them, and pictures that are blurred.
    fn contour_faults(&self) -> Vec<ContourFault> {
        let edge = |camera: u32| {
            let view = self.views().get(self.rig().place(camera as usize)?)?;
            let is_shown = matches!(view.left_out, None | Some(LeftOut::Contradicts));
            Some((camera, view.edge.filter(|_| is_shown)?))
        };
        ContourFault::of((0..self.cameras() as u32).filter_map(edge))
    }
}

/// The warning about a view by itself.
fn of_view(view: &View, camera: u32) -> Option<Warning> {
    match (view.left_out, &view.silhouette) {
        (Some(LeftOut::NoPicture), _) => Some(Warning::NoPicture { camera }),
        (Some(LeftOut::EmptySilhouette), _) => Some(Warning::EmptySilhouette { camera }),
        (Some(LeftOut::MaskInverted), _) => Some(Warning::MaskInverted { camera }),
        (Some(LeftOut::BesidePicture), _) => Some(Warning::ObjectBesidePicture { camera }),
        // Found with the hull, together with the overlap.
        (Some(LeftOut::Contradicts), _) => None,
        (None, None) => Some(Warning::NoSilhouette { camera }),
        (None, Some(silhouette)) => silhouette.is_full().then_some(Warning::FullSilhouette { camera }),
    }
}
