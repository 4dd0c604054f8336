//! The core's errors and warnings with the names of cameras and files.

use crate::{
    failure::Failure,
    scene::{Scene, SceneFrame},
};
use pcmvs_core::{Error, Warning, silhouette::ContourFault};
use std::path::Path;

impl Scene {
    /// A camera in messages.
    fn camera(&self, index: u32) -> String {
        self.cameras.get(index as usize).map_or_else(|| format!("camera {index}"), |c| format!("camera `{}`", c.name))
    }

    /// Camera and file in messages. Without a file it is that of the cameras.
    fn place(&self, camera: u32, file: Option<&Path>) -> String {
        let path = file.map_or_else(|| self.calibration().to_path_buf(), |file| self.resolve(file));
        format!("{}: {}", self.camera(camera), path.display())
    }

    /// Frame, camera and file of a picture or mask, for messages.
    pub fn place_of(&self, frame: &SceneFrame, camera: usize, file: &Path) -> String {
        format!("frame {}: {}", frame.index, self.place(camera as u32, Some(file)))
    }

    /// The file that a camera's silhouette is made of: without another one, the picture.
    fn made_of<'s>(&'s self, frame: &'s SceneFrame, camera: usize) -> Option<&'s Path> {
        self.silhouette_file(frame, camera).or(frame.image(camera))
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
                let file = frame.and_then(|f| self.made_of(f, *camera as usize));
                format!("{of_frame}{}: {problem}", self.place(*camera, file))
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
            Error::Cameras { .. } => format!("{of_frame}{}: {error}", self.calibration().display()),
            Error::EmptyHull | Error::NoSurface | Error::MasksInverted { .. } => {
                format!("{of_frame}{}: {error}", self.path.display())
            }
            _ => return Failure::Other(format!("{of_frame}{}: {error}", self.path.display())),
        })
    }

    /// A warning of the core with the names of frame, camera and file. `frame` is `None` for warnings about the rig.
    pub fn explain_warning(&self, warning: &Warning, frame: Option<&SceneFrame>) -> String {
        let file = warning.camera().zip(frame).and_then(|(camera, frame)| {
            let camera = camera as usize;
            match warning {
                Warning::Contour(ContourFault::Blurred { .. }) => frame.image(camera),
                Warning::EmptySilhouette { .. }
                | Warning::FullSilhouette { .. }
                | Warning::MaskInverted { .. }
                | Warning::SilhouetteSetAside { .. }
                | Warning::SilhouetteCompleted { .. }
                | Warning::SilhouetteRestored { .. }
                | Warning::SilhouetteDisagrees { .. }
                | Warning::SurfaceIncomplete { .. }
                | Warning::Contour(_) => self.made_of(frame, camera),
                Warning::CameraContradicts { .. }
                | Warning::PicturesExchanged { .. }
                | Warning::ColoursDiffer { .. }
                | Warning::NoStereoPoints { .. } => frame.image(camera),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Background, SilhouetteFiles, VERSION};
    use std::path::PathBuf;

    #[test]
    fn messages_about_a_silhouette_name_the_file_that_it_was_made_of() {
        let path = |text: &str| Some(PathBuf::from(text));
        let frame = SceneFrame { index: 3, images: vec![path("image.png")], masks: Some(vec![path("mask.png")]) };
        let background = Background { chroma_rgb: None, colours: Vec::new(), plates: Some(vec![path("plate.png")]) };
        let mut scene = Scene {
            version: VERSION,
            background: Some(background),
            path: PathBuf::from("folder/scene.json"),
            ..Scene::default()
        };
        let error = Error::Silhouette { camera: 0, problem: String::from("wrong") };
        for (silhouettes, file) in [
            (SilhouetteFiles::Masks, "mask.png"),
            (SilhouetteFiles::Plates, "plate.png"),
            (SilhouetteFiles::None, "image.png"),
        ] {
            scene.silhouettes = silhouettes;
            let warning = scene.explain_warning(&Warning::EmptySilhouette { camera: 0 }, Some(&frame));
            let Failure::Input(failure) = scene.explain(&error, Some(&frame)) else { panic!("the input is at fault") };
            for message in [warning, failure] {
                assert!(message.starts_with("frame 3: camera 0: ") && message.contains(file), "{file}: {message}");
            }
        }
        // A camera without the file has its silhouette from the picture.
        let bare = SceneFrame { masks: None, ..frame };
        scene.silhouettes = SilhouetteFiles::Masks;
        let Failure::Input(failure) = scene.explain(&error, Some(&bare)) else { panic!("the input is at fault") };
        assert!(failure.contains("image.png"), "{failure}");
    }
}
