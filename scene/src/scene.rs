//! A captured scene: scene.json, read strictly.

use crate::{failure::Failure, files::Files};
use pcmvs_core::{Camera, Error};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The only version of the format so far.
pub const VERSION: u32 = 1;
/// Name of the file in a scene's folder.
pub const FILE_NAME: &str = "scene.json";

/// scene.json. Keys that are not listed (novel views for scoring, notes) are ignored.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Scene {
    /// Version of the format.
    pub version: u32,
    /// Unit of length, for people and manifests.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub units: Option<String>,
    /// Upward direction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub up: Option<[f64; 3]>,
    /// Frames a second of the clip.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fps: Option<f64>,
    /// Calibrated cameras.
    pub cameras: Vec<SceneCamera>,
    /// Recorded frames.
    pub frames: Vec<SceneFrame>,
    /// What is behind the object.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub background: Option<Background>,
    /// Where it was read: paths inside are relative to this file's folder.
    #[serde(skip)]
    pub path: PathBuf,
}

/// A camera of scene.json: world to pixel is `K · distort(R X + t)`, the first pixel's centre at (0, 0).
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct SceneCamera {
    /// Name, for people and messages.
    pub name: String,
    /// Pixels in a row of its pictures.
    pub width: u32,
    /// Rows of its pictures.
    pub height: u32,
    /// Intrinsic matrix by rows.
    #[serde(rename = "K")]
    pub k: [[f64; 3]; 3],
    /// k1 k2 p1 p2 k3, shorter lists are filled with zeros.
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
    /// Number of the frame, its own.
    pub index: u32,
    /// Picture paths, one a camera.
    pub images: Vec<PathBuf>,
    /// Mask paths, one a camera, null where there is none; no list: none at all.
    #[serde(default)]
    pub masks: Option<Vec<Option<PathBuf>>>,
}

/// What is behind the object.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Background {
    /// The backdrop's colour, sRGB.
    #[serde(default)]
    pub chroma_rgb: Option<[u8; 3]>,
}

impl SceneCamera {
    /// The core's camera.
    pub fn camera(&self) -> Result<Camera, String> {
        let (given, beyond) = self.distortion.split_at(self.distortion.len().min(5));
        if beyond.iter().any(|&v| v != 0.0) {
            return Err(String::from(
                "the distortion has coefficients beyond k1 k2 p1 p2 k3: calibrate without the rational model",
            ));
        }
        let mut distortion = [0.0; 5];
        distortion[..given.len()].copy_from_slice(given);
        Ok(Camera { width: self.width, height: self.height, k: self.k, distortion, r: self.r, t: self.t })
    }
}

impl SceneFrame {
    /// Path of a camera's mask, as written in the scene.
    pub fn mask(&self, camera: usize) -> Option<&Path> {
        self.masks.as_ref()?[camera].as_deref()
    }
}

impl Scene {
    /// Reads `path`, a scene's folder or its scene.json.
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
        let text = std::str::from_utf8(bytes).map_err(|_| String::from("this is not UTF-8 text: save it as UTF-8"))?;
        let head: Head = serde_json::from_str(text).map_err(|e| syntax_problem(text, &e))?;
        match head.version {
            Some(version) if version == VERSION => {}
            Some(other) => {
                return Err(format!("version {other} is not known: this program reads version {VERSION}"));
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
            return Err(String::from("there are no cameras or no frames: list both"));
        }
        if self.fps.is_some_and(|fps| fps <= 0.0) {
            return Err(String::from("fps must be above zero: leave it out if it is not known"));
        }
        let mut indices: Vec<u32> = self.frames.iter().map(|f| f.index).collect();
        indices.sort_unstable();
        if let Some(pair) = indices.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(format!("frame {} is there twice: give every frame an index of its own", pair[0]));
        }
        for frame in &self.frames {
            let masks = frame.masks.as_ref().map_or(self.cameras.len(), Vec::len);
            for (what, count) in [("images", frame.images.len()), ("masks", masks)] {
                if count != self.cameras.len() {
                    return Err(format!(
                        "frame {}: {count} {what} for {} cameras: list one a camera, in the cameras' order{}",
                        frame.index,
                        self.cameras.len(),
                        if what == "masks" { ", null where there is none" } else { "" }
                    ));
                }
            }
        }
        Ok(())
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
        for frame in &mut self.frames {
            pick(&mut frame.images, chosen);
            if let Some(masks) = &mut frame.masks {
                pick(masks, chosen);
            }
        }
        Ok(())
    }

    /// Keeps only the given frames; all frames end up in the order of their indices.
    pub fn select_frames(&mut self, chosen: Option<&[u32]>) -> Result<(), Failure> {
        if let Some(chosen) = chosen {
            if let Some(missing) = chosen.iter().find(|i| !self.frames.iter().any(|f| f.index == **i)) {
                return Err(Failure::Input(format!(
                    "--frames {missing}: {} has no frame {missing}, it has {} frames",
                    self.path.display(),
                    self.frames.len()
                )));
            }
            self.frames.retain(|f| chosen.contains(&f.index));
        }
        self.frames.sort_by_key(|f| f.index);
        Ok(())
    }

    /// A path of the scene, seen from the working directory.
    pub fn resolve(&self, path: &Path) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(path)
    }

    /// A camera's name in messages.
    fn camera(&self, index: u32) -> String {
        self.cameras.get(index as usize).map_or_else(|| format!("camera {index}"), |c| format!("camera `{}`", c.name))
    }

    /// What the core found wrong, with the names of camera and file. `frame` is absent for what concerns the cameras.
    pub fn explain(&self, error: &Error, frame: Option<&SceneFrame>) -> Failure {
        let of_frame = frame.map(|f| format!("frame {}: ", f.index)).unwrap_or_default();
        let place = |camera: u32, file: Option<&Path>| {
            let path = file.map_or_else(|| self.path.clone(), |file| self.resolve(file));
            format!("{of_frame}{}: {}", self.camera(camera), path.display())
        };
        let image = |camera: u32| frame.map(|f| f.images[camera as usize].as_path());
        Failure::Input(match error {
            Error::Cancelled => return Failure::Cancelled,
            Error::Camera { camera, problem } => format!("{}: {problem}", place(*camera, None)),
            Error::Image { camera, problem } => format!("{}: {problem}", place(*camera, image(*camera))),
            Error::Silhouette { camera, problem } => {
                // A silhouette without a mask file was made from the picture.
                let mask = frame.and_then(|f| f.mask(*camera as usize)).or(image(*camera));
                format!("{}: {problem}", place(*camera, mask))
            }
            Error::DuplicateCamera { first, second } => format!(
                "{}: {} and {} stand at the same place and look the same way: remove one of them",
                self.path.display(),
                self.camera(*first),
                self.camera(*second)
            ),
            Error::TooFewViews { .. } => {
                format!("{}: {error}: add cameras, or leave out --cameras", self.path.display())
            }
            Error::EmptyHull | Error::NoSurface => format!("{of_frame}{}: {error}", self.path.display()),
            _ => return Failure::Other(format!("{of_frame}{}: {error}", self.path.display())),
        })
    }
}

fn syntax_problem(text: &str, error: &serde_json::Error) -> String {
    let line = text.lines().nth(error.line().saturating_sub(1)).unwrap_or_default();
    let number = ["NaN", "nan", "Infinity", "inf"].iter().any(|word| line.contains(word))
        || error.to_string().contains("out of range");
    let remedy = if number {
        "only finite numbers are allowed, calibrate this camera again"
    } else {
        "this is not valid JSON, correct that line"
    };
    let camera = last_name_before(text, error.line()).map(|name| format!(" (after the name `{name}`)"));
    format!("{error}{}: {remedy}", camera.unwrap_or_default())
}

/// The last `"name": "..."` up to a line: where the syntax is broken, nothing better tells which camera it is.
fn last_name_before(text: &str, line: usize) -> Option<&str> {
    let end: usize = text.split_inclusive('\n').take(line).map(str::len).sum();
    let (_, after) = text[..end].rsplit_once("\"name\"")?;
    after.split('"').nth(1)
}

/// The camera's name at a place such as `cameras[3].K[0]`.
fn camera_name(text: &str, place: &str) -> Option<String> {
    let index: usize = place.strip_prefix("cameras[")?.split(']').next()?.parse().ok()?;
    let scene: serde_json::Value = serde_json::from_str(text).ok()?;
    Some(scene["cameras"][index]["name"].as_str()?.to_owned())
}
