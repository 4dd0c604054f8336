//! What a host should know about a frame although it did not fail.

use super::state::Frame;
use crate::{left_out::LeftOut, math::ordered, params::Method, point_cloud::Rank, rig::Rig, stage::Stage, view::View};
use alloc::{format, string::String, vec, vec::Vec};
use core::{fmt, ops::Deref};

/// A silhouette disagrees with the others if its overlap with the hull lacks more than this many times what the others'
/// lack (their median), and more than [`DISAGREES_BY`] besides.
const DISAGREES_TIMES: f32 = 2.0;
/// Share of the silhouette, see [`DISAGREES_TIMES`].
const DISAGREES_BY: f32 = 0.03;

/// Something in a frame that may make its result worse. Cameras are numbered as given to [`Rig::new`].
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// Two cameras stand at the same place, so that they have no parallax to each other.
    SamePlace {
        /// Index of the first camera at this place.
        first: u32,
        /// Index of another one.
        second: u32,
    },
    /// A camera has no picture in this frame.
    NoPicture {
        /// Index of the camera.
        camera: u32,
    },
    /// No pixel of a camera's silhouette belongs to the object.
    EmptySilhouette {
        /// Index of the camera.
        camera: u32,
    },
    /// Every pixel of a camera's silhouette belongs to the object, so that it does not carve the hull.
    FullSilhouette {
        /// Index of the camera.
        camera: u32,
    },
    /// A camera has no silhouette, so that it does not carve the hull.
    NoSilhouette {
        /// Index of the camera.
        camera: u32,
    },
    /// A camera's mask is white on the background.
    MaskInverted {
        /// Index of the camera.
        camera: u32,
    },
    /// The object lies beside a camera's picture, or behind the camera.
    ObjectBesidePicture {
        /// Index of the camera.
        camera: u32,
    },
    /// A camera's silhouette overlaps with the hull of all silhouettes clearly less than those of the other cameras do.
    SilhouetteDisagrees {
        /// Index of the camera.
        camera: u32,
        /// Its overlap, 0 to 1.
        overlap: f32,
        /// The median overlap of all cameras.
        median: f32,
    },
    /// Stereo has found no point in a camera's picture.
    NoStereoPoints {
        /// Index of the camera.
        camera: u32,
    },
}

impl Warning {
    /// Stable name of the kind of warning, in kebab-case.
    pub const fn code(&self) -> &'static str {
        match self {
            Self::SamePlace { .. } => "same-place",
            Self::NoPicture { .. } => "no-picture",
            Self::EmptySilhouette { .. } => "empty-silhouette",
            Self::FullSilhouette { .. } => "full-silhouette",
            Self::NoSilhouette { .. } => "no-silhouette",
            Self::MaskInverted { .. } => "mask-inverted",
            Self::ObjectBesidePicture { .. } => "object-beside-picture",
            Self::SilhouetteDisagrees { .. } => "silhouette-disagrees",
            Self::NoStereoPoints { .. } => "no-stereo-points",
        }
    }

    /// Index of the camera that the warning is about, if it is about one. If two cameras are concerned it is the later one.
    pub const fn camera(&self) -> Option<u32> {
        match self {
            Self::SamePlace { second, .. } => Some(*second),
            Self::NoPicture { camera }
            | Self::EmptySilhouette { camera }
            | Self::FullSilhouette { camera }
            | Self::NoSilhouette { camera }
            | Self::MaskInverted { camera }
            | Self::ObjectBesidePicture { camera }
            | Self::SilhouetteDisagrees { camera, .. }
            | Self::NoStereoPoints { camera } => Some(*camera),
        }
    }

    /// Whether the warning is about the cameras alone, so that it holds for every frame.
    pub const fn is_about_rig(&self) -> bool {
        matches!(self, Self::SamePlace { .. })
    }

    /// What is wrong and what to do, with the cameras as `name` calls them.
    pub fn explain(&self, name: impl Fn(u32) -> String) -> String {
        let problem = match self {
            Self::SamePlace { first, .. } => format!(
                "it stands at the same place as {}: the two have no parallax to each other, so that one adds little to the \
                 other. If that is not so, correct their R and t",
                name(*first)
            ),
            Self::NoPicture { .. } => "it has no picture in this frame and contributes nothing to it".into(),
            Self::EmptySilhouette { .. } => "its silhouette is empty, so that the view contributes nothing: give a mask that \
                                             is white on the object, or null if nothing is known"
                .into(),
            Self::FullSilhouette { .. } => "its silhouette fills the picture, so that the view does not carve the hull: give \
                                            a mask that is black on the background"
                .into(),
            Self::NoSilhouette { .. } => "the view has no silhouette and does not carve the hull: give it a mask, a clean \
                                          plate or a chroma key"
                .into(),
            Self::MaskInverted { .. } => "its mask is white on the background, so that the view contributes nothing: invert \
                                          it, so that it is white on the object"
                .into(),
            Self::ObjectBesidePicture { .. } => "the object lies beside its picture, so that the view contributes nothing: \
                                                 if the picture does show the object, check the camera's calibration"
                .into(),
            Self::SilhouetteDisagrees { overlap, median, .. } => format!(
                "its silhouette agrees with the other views to {:.1} % (median of all: {:.1} %): check its mask, whether the \
                 camera was moved since its calibration, and whether its picture is of the same instant",
                100.0 * overlap,
                100.0 * median
            ),
            Self::NoStereoPoints { .. } => "stereo found no point in the view: check that the picture shows the object and \
                                            belongs to this camera, and that neighbouring cameras see the same side of the \
                                            object"
                .into(),
        };
        match self.camera() {
            Some(camera) => format!("{}: {problem}", name(camera)),
            None => problem,
        }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.explain(|camera| format!("camera {camera}")))
    }
}

impl<R: Deref<Target = Rig>> Frame<R> {
    /// Warnings about the rig and about what is complete, in the order of the stages and then of the cameras. After a
    /// stage has failed, those about the views remain.
    pub fn warnings(&self) -> Vec<Warning> {
        let pairs = self.rig().same_place().iter();
        let mut warnings: Vec<Warning> = pairs.map(|&(first, second)| Warning::SamePlace { first, second }).collect();
        let cameras = || (0..self.cameras()).filter_map(|camera| Some((camera as u32, self.rig().place(camera)?)));
        for (camera, place) in cameras() {
            // Until the stage is complete, the views are where they arrived.
            warnings.extend(match self.views().get(place) {
                Some(view) => of_view(view, camera),
                None => self.incoming[place].lock().as_ref().and_then(|view| of_view(view, camera)),
            });
        }
        let disagreeing = self.disagreeing();
        warnings.extend(cameras().filter_map(|(camera, place)| {
            let &(_, overlap, median) = disagreeing.iter().find(|found| found.0 == place)?;
            Some(Warning::SilhouetteDisagrees { camera, overlap, median })
        }));
        if self.require(Stage::Detect).is_ok() && self.params().method == Method::Pcmvs {
            let has_stereo =
                |place: usize| self.intermediates().detected[place].iter().any(|p| p.rank == Rank::Detected);
            let silent = cameras().filter(|&(_, place)| self.views()[place].is_used() && !has_stereo(place));
            warnings.extend(silent.map(|(camera, _)| Warning::NoStereoPoints { camera }));
        }
        warnings
    }

    /// The used views whose silhouettes disagree with the others: place, overlap and the median overlap.
    fn disagreeing(&self) -> Vec<(usize, f32, f32)> {
        let views = self.views().iter().zip(&self.compared).enumerate();
        let used = views.filter(|(_, (view, _))| view.is_used());
        let overlaps: Vec<(usize, f32)> =
            used.filter_map(|(place, (_, found))| Some((place, found.overlap?))).collect();
        let mut sorted: Vec<f32> = overlaps.iter().map(|&(_, overlap)| overlap).collect();
        sorted.sort_unstable_by_key(|&overlap| ordered(overlap));
        let Some(&median) = sorted.get(sorted.len() / 2) else { return vec![] };
        let least = 1.0 - DISAGREES_TIMES * (1.0 - median) - DISAGREES_BY;
        overlaps.into_iter().filter(|&(_, o)| o < least).map(|(place, o)| (place, o, median)).collect()
    }
}

/// The warning about a view by itself.
fn of_view(view: &View, camera: u32) -> Option<Warning> {
    match (view.left_out, &view.silhouette) {
        (Some(LeftOut::NoPicture), _) => Some(Warning::NoPicture { camera }),
        (Some(LeftOut::EmptySilhouette), _) => Some(Warning::EmptySilhouette { camera }),
        (Some(LeftOut::MaskInverted), _) => Some(Warning::MaskInverted { camera }),
        (Some(LeftOut::BesidePicture), _) => Some(Warning::ObjectBesidePicture { camera }),
        (None, None) => Some(Warning::NoSilhouette { camera }),
        (None, Some(silhouette)) => silhouette.is_full().then_some(Warning::FullSilhouette { camera }),
    }
}
