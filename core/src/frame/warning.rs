//! What a host should know about a frame although it did not fail.

use super::state::Frame;
use crate::{params::Method, point_cloud::Rank, rig::Rig, stage::Stage};
use core::{fmt, ops::Deref};

/// Something in a frame that may make its result worse. Cameras are numbered as given to [`Rig::new`].
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// A camera has no silhouette, so that it does not carve the hull.
    NoSilhouette {
        /// Index of the camera.
        camera: u32,
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
            Self::NoSilhouette { .. } => "no-silhouette",
            Self::NoStereoPoints { .. } => "no-stereo-points",
        }
    }

    /// Index of the camera that the warning is about, if it is about one.
    pub const fn camera(&self) -> Option<u32> {
        match self {
            Self::NoSilhouette { camera } | Self::NoStereoPoints { camera } => Some(*camera),
        }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::NoSilhouette { camera } => write!(
                f,
                "camera {camera}: the view has no silhouette and does not carve the hull: give it a mask, a clean plate \
                 or a chroma key"
            ),
            Self::NoStereoPoints { camera } => write!(
                f,
                "camera {camera}: stereo found no point in the view: check that the picture shows the object and belongs \
                 to this camera, and that neighbouring cameras see the same side of the object"
            ),
        }
    }
}

impl<R: Deref<Target = Rig>> Frame<R> {
    /// Warnings about the stages that are complete, in the order of the stages and then of the cameras.
    pub fn warnings(&self) -> impl Iterator<Item = Warning> + '_ {
        let is_complete = |stage| self.require(stage).is_ok();
        let cameras = move || (0..self.cameras()).filter_map(|camera| Some((camera as u32, self.rig().place(camera)?)));
        let has_views = is_complete(Stage::Views);
        let has_points = is_complete(Stage::Detect) && self.params().method == Method::Pcmvs;
        let carves = |place: usize| self.views()[place].silhouette.is_some();
        let has_stereo = |place: usize| self.intermediates().detected[place].iter().any(|p| p.rank == Rank::Detected);
        let silhouettes = cameras().filter(move |&(_, place)| has_views && !carves(place));
        let points = cameras().filter(move |&(_, place)| has_points && !has_stereo(place));
        let silhouettes = silhouettes.map(|(camera, _)| Warning::NoSilhouette { camera });
        silhouettes.chain(points.map(|(camera, _)| Warning::NoStereoPoints { camera }))
    }
}
