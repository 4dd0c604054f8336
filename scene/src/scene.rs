//! A captured scene, as the host works with it.

use crate::{
    failure::Failure,
    lens::{self, LensModel},
    paths,
};
use pcmvs_core::Camera;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The only version of the format.
pub const VERSION: u32 = 1;
/// Name of the file in a scene folder.
pub const FILE_NAME: &str = "scene.json";

/// A scene with the paths of all its frames. As JSON it is a scene.json that lists them.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Scene {
    /// Version of the format.
    pub version: u32,
    /// Unit of length. It is only copied to manifests.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub units: Option<String>,
    /// Upward direction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub up: Option<[f64; 3]>,
    /// Frames per second.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fps: Option<f64>,
    /// Calibrated cameras.
    pub cameras: Vec<SceneCamera>,
    /// Recorded frames.
    pub frames: Vec<SceneFrame>,
    /// Backdrop.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub background: Option<Background>,
    /// Path of scene.json. Paths in it are relative to its folder.
    #[serde(skip)]
    pub path: PathBuf,
    /// Path of the file with the cameras, if it is another one.
    #[serde(skip)]
    pub rig: Option<PathBuf>,
    /// Whether the paths of pictures are those of videos, which are the same in all frames. The picture of a camera in a frame
    /// is the one with [`SceneCamera::number`], counted from 0.
    #[serde(skip)]
    pub videos: bool,
    /// The same of masks.
    #[serde(skip)]
    pub mask_videos: bool,
    /// The files that the silhouettes are made of.
    #[serde(skip)]
    pub silhouettes: SilhouetteFiles,
}

/// The files besides the pictures that silhouettes are made of.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum SilhouetteFiles {
    /// Masks.
    #[default]
    Masks,
    /// Pictures of the empty set.
    Plates,
    /// None: the pictures are enough.
    None,
}

/// A camera of scene.json. World to pixel is `K · distort(R X + t)`; the centre of the first pixel is at (0, 0).
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct SceneCamera {
    /// Name, for messages.
    pub name: String,
    /// Width of its pictures in pixels.
    pub width: u32,
    /// Height of its pictures in pixels.
    pub height: u32,
    /// Intrinsic matrix by rows.
    #[serde(rename = "K")]
    pub k: [[f64; 3]; 3],
    /// The model of the lens.
    #[serde(default, skip_serializing_if = "LensModel::is_opencv")]
    pub lens: LensModel,
    /// Coefficients of the model in OpenCV's order. Shorter lists of [`LensModel::OpenCv`] are padded with zeros.
    #[serde(default)]
    pub distortion: Vec<f64>,
    /// Rotation by rows, world to camera.
    #[serde(rename = "R")]
    pub r: [[f64; 3]; 3],
    /// Translation, world to camera.
    pub t: [f64; 3],
    /// The whole frames by which its pictures are late in this take: frame f shows its picture f + offset.
    #[serde(skip)]
    pub offset: i32,
}

/// A frame of scene.json.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct SceneFrame {
    /// Number of the frame, unique in the scene.
    pub index: u32,
    /// Paths of the pictures, one per camera, null where a camera has none in this frame.
    pub images: Vec<Option<PathBuf>>,
    /// Paths of the masks, one per camera, null if a camera has none. No list means that there are no masks.
    #[serde(default)]
    pub masks: Option<Vec<Option<PathBuf>>>,
}

/// The backdrop of a scene.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Background {
    /// Its colour in sRGB.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chroma_rgb: Option<[u8; 3]>,
    /// Its colours in sRGB, if it has several. They may repeat `chroma_rgb`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub colours: Vec<[u8; 3]>,
    /// Paths of pictures of the empty set, one per camera, null where a camera has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plates: Option<Vec<Option<PathBuf>>>,
}

impl Background {
    /// All colours, each once.
    pub fn all_colours(&self) -> Vec<[u8; 3]> {
        let mut all: Vec<_> = self.chroma_rgb.into_iter().collect();
        for &colour in &self.colours {
            if !all.contains(&colour) {
                all.push(colour);
            }
        }
        all
    }
}

impl SceneCamera {
    /// A camera with a name.
    pub fn new(name: String, camera: &Camera) -> Self {
        let Camera { width, height, k, lens, r, t } = *camera;
        let (model, distortion) = lens::write(&lens);
        Self { name, width, height, k, lens: model, distortion, r, t, offset: 0 }
    }

    /// The camera as the core takes it.
    pub fn camera(&self) -> Result<Camera, String> {
        let lens = lens::read(self.lens, &self.distortion).map_err(|problem| format!("the distortion {problem}"))?;
        Ok(Camera { width: self.width, height: self.height, k: self.k, lens, r: self.r, t: self.t })
    }

    /// Number of the picture that it shows in a frame. There is none before 0.
    pub fn number(&self, frame: u32) -> Option<u32> {
        frame.checked_add_signed(self.offset)
    }
}

impl SceneFrame {
    /// Path of a camera's picture, as written in scene.json.
    pub fn image(&self, camera: usize) -> Option<&Path> {
        self.images[camera].as_deref()
    }

    /// Path of a camera's mask, as written in scene.json.
    pub fn mask(&self, camera: usize) -> Option<&Path> {
        self.masks.as_ref()?[camera].as_deref()
    }
}

impl Scene {
    /// The cameras as the core takes them.
    pub fn cameras(&self) -> Result<Vec<Camera>, Failure> {
        let camera = |c: &SceneCamera| {
            c.camera().map_err(|problem| {
                Failure::Input(format!("camera `{}`: {}: {problem}", c.name, self.calibration().display()))
            })
        };
        self.cameras.iter().map(camera).collect()
    }

    /// The frame with an index that `--frames` names.
    pub fn frame(&self, index: u32) -> Result<&SceneFrame, Failure> {
        self.frames.iter().find(|frame| frame.index == index).ok_or_else(|| {
            Failure::Input(format!(
                "--frames {index}: {} has no frame {index}, it has {} frames",
                self.path.display(),
                self.frames.len()
            ))
        })
    }

    /// Path of a camera's picture of the empty set, as written in scene.json.
    pub fn plate(&self, camera: usize) -> Option<&Path> {
        self.background.as_ref()?.plates.as_ref()?[camera].as_deref()
    }

    /// Path of the file besides the picture that a camera's silhouette is made of, as written in scene.json.
    pub fn silhouette_file<'s>(&'s self, frame: &'s SceneFrame, camera: usize) -> Option<&'s Path> {
        match self.silhouettes {
            SilhouetteFiles::Masks => frame.mask(camera),
            SilhouetteFiles::Plates => self.plate(camera),
            SilhouetteFiles::None => None,
        }
    }

    /// Keeps only the given cameras, in the order given.
    pub fn select_cameras(&mut self, chosen: &[u32]) -> Result<(), Failure> {
        if let Some(missing) = chosen.iter().find(|&&i| i as usize >= self.cameras.len()) {
            return Err(Failure::Input(format!(
                "--cameras {missing}: {} has cameras 0 to {}",
                self.path.display(),
                self.cameras.len() - 1
            )));
        }
        fn pick<T: Clone>(items: &mut Vec<T>, chosen: &[u32]) {
            *items = chosen.iter().map(|&i| items[i as usize].clone()).collect();
        }
        pick(&mut self.cameras, chosen);
        if let Some(plates) = self.background.as_mut().and_then(|background| background.plates.as_mut()) {
            pick(plates, chosen);
        }
        for frame in &mut self.frames {
            pick(&mut frame.images, chosen);
            if let Some(masks) = &mut frame.masks {
                pick(masks, chosen);
            }
        }
        Ok(())
    }

    /// Keeps only the given frames, or all of them, and sorts them by index.
    pub fn select_frames(&mut self, chosen: Option<&[u32]>) -> Result<(), Failure> {
        if let Some(chosen) = chosen {
            for &index in chosen {
                self.frame(index)?;
            }
            self.frames.retain(|f| chosen.contains(&f.index));
        }
        self.frames.sort_by_key(|f| f.index);
        Ok(())
    }

    /// The file that holds the cameras.
    pub fn calibration(&self) -> &Path {
        self.rig.as_ref().unwrap_or(&self.path)
    }

    /// A path of the scene, relative to the working directory. Both `/` and `\` separate its folders.
    pub fn resolve(&self, path: &Path) -> PathBuf {
        paths::resolve(self.path.parent().unwrap_or(Path::new("")), path)
    }
}
