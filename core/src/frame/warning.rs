//! What a host should know about a frame although it did not fail.

use crate::silhouette::ContourFault;
use alloc::{
    format,
    string::{String, ToString},
};
use core::fmt;

/// Names the command that measures more about a camera than a frame does.
const CHECK: &str = " (`pcmvs check` tells more)";

/// Something in a frame that may make its result worse. Cameras are numbered as given to [`crate::Rig::new`].
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
    /// A camera's silhouette lacks parts of the object that the other cameras show. It is not used.
    SilhouetteSetAside {
        /// Index of the camera.
        camera: u32,
        /// Overlap of the silhouette with the hull of the others, 0 to 1.
        overlap: f32,
    },
    /// A camera's silhouette had holes or lacked parts that the other cameras show. They have been added.
    SilhouetteCompleted {
        /// Index of the camera.
        camera: u32,
        /// Number of pixels that were added.
        pixels: u32,
    },
    /// A camera's silhouette lacked parts that its silhouettes in the frames before and after have and its picture shows. They
    /// have been added.
    SilhouetteRestored {
        /// Index of the camera.
        camera: u32,
        /// Number of pixels that were added.
        pixels: u32,
    },
    /// A camera's picture contradicts the other cameras. It is not used.
    CameraContradicts {
        /// Index of the camera.
        camera: u32,
        /// Overlap of the silhouette with the hull of the others, 0 to 1.
        overlap: f32,
        /// Whether its mask follows the object's edge in its picture, so that not the mask is at fault.
        mask_follows: bool,
    },
    /// A camera's picture is that of another camera, and the other way round. Neither is used.
    PicturesExchanged {
        /// Index of the camera.
        camera: u32,
        /// Index of the other camera.
        other: u32,
    },
    /// A camera's silhouette excludes what several others show, or fits the others far worse than theirs do, so that it or
    /// the camera's calibration is at fault.
    SilhouetteDisagrees {
        /// Index of the camera.
        camera: u32,
        /// Its overlap with the hull of all silhouettes, 0 to 1.
        overlap: f32,
        /// The median overlap of all cameras.
        median: f32,
    },
    /// The silhouettes contradict each other without one that is at fault: their median overlap with their hull is small.
    SilhouettesContradict {
        /// The median overlap, 0 to 1.
        median: f32,
        /// Index of the camera whose silhouette overlaps least.
        worst: u32,
        /// Its overlap.
        overlap: f32,
    },
    /// The pictures show the object's edge elsewhere than along the contours of silhouettes.
    Contour(ContourFault),
    /// The calibration as a whole does not fit the pictures.
    CalibrationInconsistent {
        /// Mean over all pairs of neighbouring cameras of how far matches lie from their epipolar lines, in pixels.
        pixels: f32,
    },
    /// Stereo has found no point in a camera's picture.
    NoStereoPoints {
        /// Index of the camera.
        camera: u32,
    },
    /// The surface lacks parts that silhouettes show and the hull has.
    SurfaceIncomplete {
        /// Index of the camera of whose silhouette it lacks the largest share.
        camera: u32,
        /// Number of pixels of this silhouette that it lacks.
        pixels: u32,
        /// Their share of the silhouette, 0 to 1.
        share: f32,
        /// Number of silhouettes of which it lacks more than 1 %, with this one.
        views: u32,
    },
    /// A camera's colours differ much from those in which the others show the same surface.
    ColoursDiffer {
        /// Index of the camera.
        camera: u32,
        /// The factors of red, green and blue that make them agree.
        gains: [f32; 3],
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
            Self::SilhouetteSetAside { .. } => "silhouette-set-aside",
            Self::SilhouetteCompleted { .. } => "silhouette-completed",
            Self::SilhouetteRestored { .. } => "silhouette-restored",
            Self::CameraContradicts { .. } => "camera-contradicts",
            Self::PicturesExchanged { .. } => "cameras-swapped",
            Self::SilhouetteDisagrees { .. } => "silhouette-disagrees",
            Self::SilhouettesContradict { .. } => "silhouettes-contradict",
            Self::Contour(fault) => fault.code(),
            Self::CalibrationInconsistent { .. } => "calibration-inconsistent",
            Self::NoStereoPoints { .. } => "no-stereo-points",
            Self::SurfaceIncomplete { .. } => "surface-incomplete",
            Self::ColoursDiffer { .. } => "colours-differ",
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
            | Self::SilhouetteSetAside { camera, .. }
            | Self::SilhouetteCompleted { camera, .. }
            | Self::SilhouetteRestored { camera, .. }
            | Self::CameraContradicts { camera, .. }
            | Self::PicturesExchanged { camera, .. }
            | Self::SilhouetteDisagrees { camera, .. }
            | Self::SurfaceIncomplete { camera, .. }
            | Self::ColoursDiffer { camera, .. }
            | Self::NoStereoPoints { camera } => Some(*camera),
            Self::Contour(fault) => fault.camera(),
            Self::SilhouettesContradict { .. } | Self::CalibrationInconsistent { .. } => None,
        }
    }

    /// Whether the warning is about the cameras alone, so that it holds for every frame.
    pub const fn is_about_rig(&self) -> bool {
        matches!(self, Self::SamePlace { .. })
    }

    /// What is wrong and what to do, with the cameras as `name` calls them. It begins with [`Self::camera`].
    pub fn explain(&self, name: impl Fn(u32) -> String) -> String {
        match self.camera() {
            Some(camera) => format!("{}: {}", name(camera), self.problem(&name)),
            None => self.problem(&name),
        }
    }

    /// [`Self::explain`] without the camera that the warning is about.
    pub fn problem(&self, name: impl Fn(u32) -> String) -> String {
        match self {
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
            Self::SilhouetteSetAside { overlap, .. } => format!(
                "its silhouette lacks parts of the object that the other views show, and agrees with them to {:.1} %, so that \
                 it is not used: correct its mask. If the mask is complete, check the calibration{CHECK}",
                100.0 * overlap
            ),
            Self::SilhouetteCompleted { pixels, .. } => format!(
                "its silhouette lacked {pixels} pixels that the other views show as object; they have been added: look for \
                 holes in its mask"
            ),
            Self::SilhouetteRestored { pixels, .. } => format!(
                "its silhouette lacked {pixels} pixels that belong to the object in the frames before and after, and that its \
                 picture shows; they have been added: correct its mask"
            ),
            Self::CameraContradicts { overlap, mask_follows, .. } => format!(
                "its picture contradicts the other views, which it agrees with to {:.1} %, so that it is not used: {} whether \
                 the camera was moved since its calibration, has another focal length, was exchanged with another one, or is \
                 out of step{CHECK}",
                100.0 * overlap,
                if *mask_follows { "its mask follows its picture, so check" } else { "check its mask, and" }
            ),
            Self::PicturesExchanged { other, .. } => format!(
                "its picture seems to be exchanged with that of {}: each silhouette fits the other camera, so that neither is \
                 used. Exchange their pictures and masks",
                name(*other)
            ),
            Self::SilhouetteDisagrees { overlap, median, .. } => {
                let reason = if overlap < median {
                    format!(
                        "it overlaps with the hull to {:.1} % (median of all: {:.1} %)",
                        100.0 * overlap,
                        100.0 * median
                    )
                } else {
                    String::from("it excludes places that several of them show as object")
                };
                format!(
                    "its silhouette disagrees with the other views: {reason}: check whether its mask lacks a part, whether the \
                     camera was moved since its calibration, and whether its picture is of the same instant and of this camera{CHECK}"
                )
            }
            Self::SilhouettesContradict { median, worst, overlap } => format!(
                "the silhouettes contradict each other: half of them agree with the others to less than {:.1} %, and {} to \
                 {:.1} % only. Parts of the object may be missing. Check masks and calibration, and that pictures and cameras \
                 are in the same order; the camera at fault may be another one",
                100.0 * median,
                name(*worst),
                100.0 * overlap
            ),
            Self::Contour(fault) => fault.to_string(),
            Self::CalibrationInconsistent { pixels } => format!(
                "the calibration does not fit the pictures: epipolar lines miss matches by {pixels:.2} px, so that the surface \
                 is off by as much. Refine the calibration, or calibrate again"
            ),
            Self::NoStereoPoints { .. } => "stereo found no point in the view: check that the picture shows the object and \
                                            belongs to this camera, and that neighbouring cameras see the same side of the \
                                            object"
                .into(),
            Self::SurfaceIncomplete { pixels, share, views, .. } => format!(
                "the surface lacks {pixels} pixels that its silhouette and the hull show ({:.1} % of the silhouette){}: \
                 either stereo has matched wrongly there, so that a part of the object is torn, or masks show background \
                 there. Look at the mesh and the mask from this camera. If the mask is right, more cameras around that part \
                 or more light help, and preset hull keeps it",
                100.0 * share,
                match views {
                    1 => String::new(),
                    2 => String::from(", and parts of another silhouette"),
                    _ => format!(", and parts of {} other silhouettes", views - 1),
                }
            ),
            Self::ColoursDiffer { gains: [red, green, blue], .. } => format!(
                "its colours differ from those of the other views: red, green and blue agree when multiplied by {red:.2}, \
                 {green:.2} and {blue:.2}. Check its exposure and white balance, and the order of its channels"
            ),
        }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.explain(|camera| format!("camera {camera}")))
    }
}
