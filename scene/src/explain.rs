//! The core's errors and warnings with the names of cameras and files.

use crate::{
    failure::Failure,
    scene::{Scene, SceneFrame},
};
use pcmvs_core::{Error, Warning};
use std::path::Path;

impl Scene {
    /// A camera in messages.
    fn camera(&self, index: u32) -> String {
        self.cameras.get(index as usize).map_or_else(|| format!("camera {index}"), |c| format!("camera `{}`", c.name))
    }

    /// Camera and file in messages. Without a file it is scene.json.
    fn place(&self, camera: u32, file: Option<&Path>) -> String {
        let path = file.map_or_else(|| self.path.clone(), |file| self.resolve(file));
        format!("{}: {}", self.camera(camera), path.display())
    }

    /// Frame, camera and file of a picture or mask, for messages.
    pub fn place_of(&self, frame: &SceneFrame, camera: usize, file: &Path) -> String {
        format!("frame {}: {}", frame.index, self.place(camera as u32, Some(file)))
    }

    /// Adds the names of camera and file to an error of the core. `frame` is `None` for errors of the rig.
    pub fn explain(&self, error: &Error, frame: Option<&SceneFrame>) -> Failure {
        let of_frame = frame.map(|f| format!("frame {}: ", f.index)).unwrap_or_default();
        let image = |camera: u32| frame.and_then(|f| f.image(camera as usize));
        Failure::Input(match error {
            Error::Cancelled => return Failure::Cancelled,
            Error::Camera { camera, problem } => format!("{of_frame}{}: {problem}", self.place(*camera, None)),
            Error::Image { camera, problem } => format!("{of_frame}{}: {problem}", self.place(*camera, image(*camera))),
            Error::Silhouette { camera, problem } => {
                // Without a mask file the silhouette comes from the picture.
                let mask = frame.and_then(|f| f.mask(*camera as usize)).or(image(*camera));
                format!("{of_frame}{}: {problem}", self.place(*camera, mask))
            }
            Error::TooFewViews { given, needed } => {
                let path = self.path.display();
                match frame {
                    None => format!(
                        "{path}: {given} views given: at least {needed} are needed: add cameras, or run without --cameras"
                    ),
                    Some(_) => format!(
                        "{of_frame}{path}: {given} of {} views can be used: at least {needed} are needed, each with a \
                         picture and a silhouette: give masks that are white on the object, pictures with an alpha \
                         channel, or the backdrop's colour and --masks chroma",
                        self.cameras.len()
                    ),
                }
            }
            Error::EmptyHull | Error::NoSurface | Error::Cameras { .. } | Error::MasksInverted { .. } => {
                format!("{of_frame}{}: {error}", self.path.display())
            }
            _ => return Failure::Other(format!("{of_frame}{}: {error}", self.path.display())),
        })
    }

    /// A warning of the core with the names of frame, camera and file. `frame` is `None` for warnings about the rig.
    pub fn explain_warning(&self, warning: &Warning, frame: Option<&SceneFrame>) -> String {
        let file = warning.camera().zip(frame).and_then(|(camera, frame)| {
            let (image, mask) = (frame.image(camera as usize), frame.mask(camera as usize));
            match warning {
                Warning::EmptySilhouette { .. }
                | Warning::FullSilhouette { .. }
                | Warning::MaskInverted { .. }
                | Warning::SilhouetteSetAside { .. }
                | Warning::SilhouetteCompleted { .. }
                | Warning::SilhouetteDisagrees { .. } => mask.or(image),
                Warning::CameraContradicts { .. } | Warning::NoStereoPoints { .. } => image,
                _ => None,
            }
        });
        let of_frame = frame.map(|f| format!("frame {}: ", f.index)).unwrap_or_default();
        let name = |camera| match warning.camera() {
            Some(own) if own == camera => self.place(camera, file),
            _ => self.camera(camera),
        };
        format!("{of_frame}{}", warning.explain(name))
    }
}
