//! What the calibration stage finds wrong.

use crate::silhouette::ContourFault;
use core::fmt;

/// Something that the pictures contradict. Cameras are numbered as given to [`crate::Rig::new`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Finding {
    /// The calibration as a whole does not fit the pictures.
    CalibrationInconsistent {
        /// Mean over all pairs of neighbouring cameras of how far matches lie from their epipolar lines, in pixels.
        pixels: f64,
    },
    /// One camera has moved since it was calibrated.
    CameraBumped {
        /// Index of the camera.
        camera: u32,
        /// How far it is off in pixels at the object.
        pixels: f64,
        /// Whether it may also be that its focal length or distortion is wrong: the pictures do not tell.
        or_lens: bool,
    },
    /// The focal length of one camera is wrong, or that of all.
    FocalLengthWrong {
        /// Index of the camera; `None` if all focal lengths are wrong by the same factor.
        camera: Option<u32>,
        /// The given focal length over the right one.
        factor: f64,
    },
    /// The distortion of one camera is wrong.
    DistortionWrong {
        /// Index of the camera.
        camera: u32,
        /// By how many pixels the object's picture is off: the root of the mean square.
        pixels: f64,
    },
    /// The pictures of two cameras are exchanged.
    CamerasSwapped {
        /// Index of the first camera.
        first: u32,
        /// Index of the second camera.
        second: u32,
    },
    /// A camera contradicts all others, and no other pose of it agrees with them.
    CameraContradicts {
        /// Index of the camera.
        camera: u32,
        /// How far its contour misses the tangents of the others, in pixels, if it has been measured.
        contour_px: Option<f64>,
    },
    /// A camera's silhouette lacks parts of the object that the other cameras show, wherever the camera stands.
    SilhouetteSetAside {
        /// Index of the camera.
        camera: u32,
        /// Number of frames in which it does,
        frames: u32,
        /// and of frames that were looked at.
        of: u32,
    },
    /// The pictures show the object's edge elsewhere than along the contours of silhouettes, in every frame.
    Contour(ContourFault),
}

impl Finding {
    /// Mean distance of matches from epipolar lines, in pixels, from which a calibration is called inconsistent.
    pub const INCONSISTENT: f64 = 0.4;

    /// Stable name of the kind of finding, in kebab-case.
    pub const fn code(&self) -> &'static str {
        match self {
            Self::CalibrationInconsistent { .. } => "calibration-inconsistent",
            Self::CameraBumped { .. } => "camera-bumped",
            Self::CamerasSwapped { .. } => "cameras-swapped",
            Self::FocalLengthWrong { .. } => "focal-length-wrong",
            Self::DistortionWrong { .. } => "distortion-wrong",
            Self::CameraContradicts { .. } => "camera-contradicts",
            Self::SilhouetteSetAside { .. } => "silhouette-set-aside",
            Self::Contour(fault) => fault.code(),
        }
    }

    /// Indices of the cameras concerned: none, one or two.
    pub const fn cameras(&self) -> [Option<u32>; 2] {
        match self {
            Self::CalibrationInconsistent { .. } => [None, None],
            Self::Contour(fault) => [fault.camera(), None],
            Self::FocalLengthWrong { camera, .. } => [*camera, None],
            Self::CameraBumped { camera, .. }
            | Self::DistortionWrong { camera, .. }
            | Self::CameraContradicts { camera, .. }
            | Self::SilhouetteSetAside { camera, .. } => [Some(*camera), None],
            Self::CamerasSwapped { first, second } => [Some(*first), Some(*second)],
        }
    }
}

impl fmt::Display for Finding {
    /// The finding and the remedy, without the names of the cameras.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::CalibrationInconsistent { pixels } => write!(
                f,
                "the calibration does not fit the pictures: epipolar lines miss matches by {pixels:.2} px. Refine it, or \
                 calibrate again"
            ),
            Self::CameraBumped { pixels, or_lens: true, .. } => write!(
                f,
                "the camera is off by {pixels:.1} px: it has moved since it was calibrated, or its focal length or its \
                 distortion is wrong, which the pictures do not tell apart. Calibrate it again"
            ),
            Self::FocalLengthWrong { camera, factor } => {
                let [whose, than, of_k] = match camera {
                    Some(_) => ["its focal length is", "the camera has", "its"],
                    None => ["the focal lengths of all cameras are", "cameras have", "every"],
                };
                let (long, percent) = (if *factor > 1.0 { "long" } else { "short" }, 100.0 * (factor - 1.0).abs());
                write!(
                    f,
                    "{whose} probably too {long} by about {percent:.1} %: this explains the pictures better than that {than} \
                     moved. Divide fx and fy of {of_k} K by about {factor:.3} and check again, or calibrate again"
                )
            }
            Self::DistortionWrong { pixels, .. } => write!(
                f,
                "the distortion of its lens is probably wrong, by {pixels:.1} px on average: this explains its pictures \
                 better than that the camera has moved. Check the coefficients and their order (k1, k2, p1, p2, k3), or \
                 calibrate again"
            ),
            Self::SilhouetteSetAside { frames, of, .. } => {
                f.write_str("its silhouette lacks parts of the object that the other cameras show")?;
                if *of > 1 {
                    write!(f, ", in {frames} of {of} frames")?;
                }
                f.write_str(": correct its mask")
            }
            Self::CameraBumped { pixels, .. } => write!(
                f,
                "the camera has moved by {pixels:.1} px since it was calibrated. Refine the calibration, or calibrate \
                 again"
            ),
            Self::CamerasSwapped { .. } => write!(
                f,
                "the pictures of the two cameras seem to be exchanged: each silhouette fits the other camera. Exchange \
                 their pictures and masks"
            ),
            Self::Contour(fault) => fault.fmt(f),
            Self::CameraContradicts { contour_px, .. } => {
                write!(f, "its silhouette contradicts those of the other cameras, and no other pose makes it fit")?;
                if let Some(pixels) = contour_px {
                    write!(f, " (their tangents miss its contour by {pixels:.1} px)")?;
                }
                write!(f, ". Check that its picture and mask belong to this camera and to this instant")
            }
        }
    }
}
