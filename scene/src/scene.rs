//! A captured scene: the strict reader of scene.json.

use crate::{
    failure::Failure,
    files::Files,
    lens::{self, LensModel},
    text,
};
use pcmvs_core::Camera;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The only version of the format.
pub const VERSION: u32 = 1;
/// Name of the file in a scene folder.
pub const FILE_NAME: &str = "scene.json";

/// The content of scene.json. Unknown keys, such as novel views for scoring or notes, are ignored.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Scene {
    /// Version of the format.
    pub version: u32,
    /// Unit of length. It is only copied to manifests.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub units: Option<String>,
    /// Upward direction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub up: Option<[f64; 3]>,
    /// Frames per second.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fps: Option<f64>,
    /// Calibrated cameras.
    pub cameras: Vec<SceneCamera>,
    /// Recorded frames.
    pub frames: Vec<SceneFrame>,
    /// Backdrop.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub background: Option<Background>,
    /// Path of scene.json. Paths in it are relative to its folder.
    #[serde(skip)]
    pub path: PathBuf,
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
        Self { name, width, height, k, lens: model, distortion, r, t }
    }

    /// The camera as the core takes it.
    pub fn camera(&self) -> Result<Camera, String> {
        let lens = lens::read(self.lens, &self.distortion).map_err(|problem| format!("the distortion {problem}"))?;
        Ok(Camera { width: self.width, height: self.height, k: self.k, lens, r: self.r, t: self.t })
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
    /// Reads a scene. `path` is its folder or its scene.json.
    pub fn load(files: &dyn Files, path: &Path) -> Result<Self, Failure> {
        let path = if files.is_folder(path) { path.join(FILE_NAME) } else { path.to_path_buf() };
        let bytes = files.read(&path).map_err(|e| Failure::unreadable(&path, &e))?;
        let scene = Self::parse(&bytes).and_then(|scene| scene.check().map(|()| scene));
        scene
            .map(|scene| Self { path: path.clone(), ..scene })
            .map_err(|problem| Failure::Input(format!("{}: {problem}", path.display())))
    }

    fn parse(bytes: &[u8]) -> Result<Self, String> {
        #[derive(Deserialize)]
        struct Head {
            version: Option<serde_json::Value>,
        }
        let text = text::decode(bytes)?;
        let head: Head = serde_json::from_str(text).map_err(|e| syntax_problem(text, &e))?;
        match head.version {
            Some(version) if version == VERSION => {}
            Some(other) => {
                return Err(format!("version {other} is unknown: this program reads version {VERSION}"));
            }
            None => return Err(format!("`version` is missing: write \"version\": {VERSION}")),
        }
        let reader = &mut serde_json::Deserializer::from_str(text);
        serde_path_to_error::deserialize(reader).map_err(|error| {
            let place = error.path().to_string();
            if error.inner().is_syntax() {
                return format!("{place}: {}", syntax_problem(text, error.inner()));
            }
            let camera = camera_name(text, &place).map(|name| format!(" (camera `{name}`)")).unwrap_or_default();
            format!("{place}{camera}: {}", error.inner())
        })
    }

    fn check(&self) -> Result<(), String> {
        if self.cameras.is_empty() || self.frames.is_empty() {
            return Err(String::from("there are no cameras or no frames: add both"));
        }
        if self.fps.is_some_and(|fps| fps <= 0.0) {
            return Err(String::from("fps must be greater than 0: remove it if it is unknown"));
        }
        let mut indices: Vec<u32> = self.frames.iter().map(|f| f.index).collect();
        indices.sort_unstable();
        if let Some(pair) = indices.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(format!("frame {} occurs twice: give every frame its own index", pair[0]));
        }
        if let Some(plates) = self.background.as_ref().and_then(|background| background.plates.as_ref())
            && plates.len() != self.cameras.len()
        {
            return Err(format!(
                "background.plates: {} plates for {} cameras: list one per camera, in the order of the cameras, null where \
                 there is none",
                plates.len(),
                self.cameras.len()
            ));
        }
        for frame in &self.frames {
            let masks = frame.masks.as_ref().map_or(self.cameras.len(), Vec::len);
            for (what, count) in [("images", frame.images.len()), ("masks", masks)] {
                if count != self.cameras.len() {
                    return Err(format!(
                        "frame {}: {count} {what} for {} cameras: list one per camera, in the order of the cameras, null \
                         where there is none",
                        frame.index,
                        self.cameras.len(),
                    ));
                }
            }
        }
        Ok(())
    }

    /// The cameras as the core takes them.
    pub fn cameras(&self) -> Result<Vec<Camera>, Failure> {
        let camera = |c: &SceneCamera| {
            c.camera()
                .map_err(|problem| Failure::Input(format!("camera `{}`: {}: {problem}", c.name, self.path.display())))
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

    /// All paths of pictures, masks and clean plates.
    pub fn paths_mut(&mut self) -> impl Iterator<Item = &mut PathBuf> {
        let frames = self.frames.iter_mut();
        let of_frames = frames.flat_map(|frame| frame.images.iter_mut().chain(frame.masks.iter_mut().flatten()));
        let plates = self.background.iter_mut().flat_map(|background| background.plates.iter_mut().flatten());
        of_frames.chain(plates).flatten()
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

    /// A path of the scene, relative to the working directory.
    pub fn resolve(&self, path: &Path) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(path)
    }
}

fn syntax_problem(text: &str, error: &serde_json::Error) -> String {
    let line = text.lines().nth(error.line().saturating_sub(1)).unwrap_or_default();
    let number = ["NaN", "nan", "Infinity", "inf"].iter().any(|word| line.contains(word))
        || error.to_string().contains("out of range");
    let remedy = if number {
        "only finite numbers are allowed: calibrate this camera again"
    } else {
        "the file is not valid JSON: correct that line"
    };
    let camera = last_name_before(text, error.line()).map(|name| format!(" (after the name `{name}`)"));
    format!("{error}{}: {remedy}", camera.unwrap_or_default())
}

/// The last `"name": "..."` up to a line. Where the syntax is broken, it is the best hint at the camera.
fn last_name_before(text: &str, line: usize) -> Option<&str> {
    let end: usize = text.split_inclusive('\n').take(line).map(str::len).sum();
    let (_, after) = text[..end].rsplit_once("\"name\"")?;
    after.split('"').nth(1)
}

/// Name of the camera at a path such as `cameras[3].K[0]`.
fn camera_name(text: &str, place: &str) -> Option<String> {
    let index: usize = place.strip_prefix("cameras[")?.split(']').next()?.parse().ok()?;
    let scene: serde_json::Value = serde_json::from_str(text).ok()?;
    Some(scene["cameras"][index]["name"].as_str()?.to_owned())
}
