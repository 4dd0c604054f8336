//! scene.json as it is written: frames may be listed, or be a range of numbers with patterns of paths.

use crate::{
    failure::Failure,
    files::Files,
    pattern::{Pattern, Patterns},
    scene::{Background, FILE_NAME, SceneCamera, SceneFrame, VERSION},
    text,
};
use serde::{
    Deserialize, Deserializer, Serialize,
    de::{
        DeserializeOwned, MapAccess, SeqAccess, Visitor,
        value::{MapAccessDeserializer, SeqAccessDeserializer},
    },
};
use std::{
    collections::BTreeMap,
    fmt,
    path::{Path, PathBuf},
};

/// Most bytes that the paths of a take may need.
const MOST_PATH_BYTES: usize = 1 << 28;

/// The content of scene.json. Unknown keys, such as novel views for scoring or notes, are ignored.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Document {
    /// Version of the format.
    pub version: u32,
    /// Unit of length.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub units: Option<String>,
    /// Upward direction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub up: Option<[f64; 3]>,
    /// Frames per second.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fps: Option<f64>,
    /// Path of a file with the cameras, which several takes may share.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rig: Option<PathBuf>,
    /// The cameras, unless there is a `rig`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cameras: Option<Vec<SceneCamera>>,
    /// By the name of a camera, the whole frames by which it is late: frame f shows its picture f + offset.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub offsets: BTreeMap<String, i32>,
    /// The frames.
    pub frames: Frames,
    /// Paths of the pictures, if the frames are a range.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub images: Option<Patterns>,
    /// Paths of the masks, if the frames are a range.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub masks: Option<Patterns>,
    /// Backdrop.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub background: Option<Background>,
}

/// The frames of scene.json.
#[derive(Debug, Clone, Serialize)]
#[serde(untagged)]
pub enum Frames {
    /// Each with its own paths.
    List(Vec<SceneFrame>),
    /// Numbers, with which the patterns give the paths.
    Range(Range),
}

/// Numbers of frames.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Range {
    /// The first frame.
    pub first: u32,
    /// The last frame, included.
    pub last: u32,
    /// From one frame to the next.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub step: u32,
}

const fn one() -> u32 {
    1
}

const fn is_one(step: &u32) -> bool {
    *step == 1
}

impl<'de> Deserialize<'de> for Frames {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = Frames;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a list of frames, or a range such as { \"first\": 0, \"last\": 99 }")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Frames, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(list)).map(Frames::List)
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Frames, A::Error> {
                Range::deserialize(MapAccessDeserializer::new(map)).map(Frames::Range)
            }
        }
        deserializer.deserialize_any(Either)
    }
}

/// A file with the cameras of several takes, and what belongs to them. A scene.json with `cameras` is one.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RigDocument {
    /// Version of the format, as of scene.json.
    pub version: u32,
    /// Unit of length of the takes that state none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub units: Option<String>,
    /// Upward direction of the takes that state none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub up: Option<[f64; 3]>,
    /// The cameras.
    pub cameras: Vec<SceneCamera>,
}

/// Reads a file in the format of scene.json.
pub fn read<T: DeserializeOwned>(files: &dyn Files, path: &Path) -> Result<T, Failure> {
    let bytes = files.read(path).map_err(|e| Failure::unreadable(path, &e))?;
    parse(&bytes).map_err(|problem| Failure::Input(format!("{}: {problem}", path.display())))
}

impl Document {
    /// Reads a scene as it is written. `path` is its folder or its scene.json. Also returns the path of the file.
    pub fn load(files: &dyn Files, path: &Path) -> Result<(Self, PathBuf), Failure> {
        let path = if files.is_folder(path) { path.join(FILE_NAME) } else { path.to_path_buf() };
        Ok((read(files, &path)?, path))
    }

    /// Makes all paths start in another folder, which leads to that of the document.
    pub fn move_to(&mut self, lead: &Path) {
        let of_frame = |frame: &mut SceneFrame| {
            frame
                .images
                .iter_mut()
                .chain(frame.masks.iter_mut().flatten())
                .flatten()
                .for_each(|path| *path = lead.join(&*path));
        };
        if let Frames::List(frames) = &mut self.frames {
            frames.iter_mut().for_each(of_frame);
        }
        let plates = self.background.iter_mut().flat_map(|background| background.plates.iter_mut().flatten()).flatten();
        plates.chain(&mut self.rig).for_each(|path| *path = lead.join(&*path));
        for patterns in [&mut self.images, &mut self.masks].into_iter().flatten() {
            patterns.move_to(lead);
        }
    }

    /// The frames with their paths. The paths are those of the cameras' offsets.
    pub(crate) fn frames(&self, cameras: &[SceneCamera]) -> Result<Vec<SceneFrame>, String> {
        let patterns = [("images", &self.images), ("masks", &self.masks)];
        match &self.frames {
            Frames::List(frames) => match patterns.iter().find(|(_, patterns)| patterns.is_some()) {
                Some((key, _)) => Err(format!(
                    "`{key}` is a pattern, but `frames` is a list: write \"frames\": {{ \"first\": 0, \"last\": 99 }}, or list \
                     the paths in the frames alone"
                )),
                None => listed(frames, cameras),
            },
            Frames::Range(range) => {
                let [images, masks] = patterns.map(|(key, patterns)| {
                    let each = patterns.as_ref().map(|patterns| patterns.each(cameras.len())).transpose();
                    each.map_err(|problem| format!("{key}: {problem}"))
                });
                let images = images?.ok_or(
                    "`frames` is a range, but there are no `images`: add \"images\": \"{camera}/{frame:06}.jpg\" with your names",
                )?;
                range.frames(cameras, &images, masks?.as_deref())
            }
        }
    }
}

impl Range {
    fn frames(
        self,
        cameras: &[SceneCamera],
        images: &[Option<Pattern>],
        masks: Option<&[Option<Pattern>]>,
    ) -> Result<Vec<SceneFrame>, String> {
        let Self { first, last, step } = self;
        if first > last || step == 0 {
            return Err(format!(
                "frames: from {first} to {last} by {step} there are none: correct first, last or step"
            ));
        }
        let count = (last - first) as usize / step as usize + 1;
        let all = || images.iter().zip(cameras).chain(masks.unwrap_or_default().iter().zip(cameras));
        if let Some((_, camera)) =
            all().find(|(pattern, _)| count > 1 && pattern.as_ref().is_some_and(|p| !p.has_frame()))
        {
            return Err(format!(
                "camera `{}`: its pattern gives the same file for all {count} frames: add {{frame}} or {{frame:06}}",
                camera.name
            ));
        }
        let sizes = all().map(|(pattern, camera)| {
            let length = pattern.as_ref().map_or(0, |pattern| pattern.longest(&camera.name));
            length.saturating_add(size_of::<Option<PathBuf>>())
        });
        if sizes.fold(0, usize::saturating_add).saturating_mul(count) > MOST_PATH_BYTES {
            return Err(format!(
                "frames: the paths of {count} frames of {} cameras take more than {} MiB: split the take",
                cameras.len(),
                MOST_PATH_BYTES >> 20
            ));
        }
        let paths = |patterns: &[Option<Pattern>], frame: u32| {
            let path = |(pattern, camera): (&Option<Pattern>, &SceneCamera)| {
                Some(pattern.as_ref()?.path(&camera.name, camera.number(frame)?))
            };
            patterns.iter().zip(cameras).map(path).collect()
        };
        let frame = |index: u32| SceneFrame {
            index,
            images: paths(images, index),
            masks: masks.map(|masks| paths(masks, index)),
        };
        Ok((first..=last).step_by(step as usize).map(frame).collect())
    }
}

/// The frames of a list, with the pictures that the cameras' offsets choose.
fn listed(frames: &[SceneFrame], cameras: &[SceneCamera]) -> Result<Vec<SceneFrame>, String> {
    let mut by_index = BTreeMap::new();
    for frame in frames {
        if by_index.insert(frame.index, frame).is_some() {
            return Err(format!("frame {} occurs twice: give every frame its own index", frame.index));
        }
        let masks = frame.masks.as_ref().map_or(cameras.len(), Vec::len);
        for (what, count) in [("images", frame.images.len()), ("masks", masks)] {
            if count != cameras.len() {
                return Err(format!(
                    "frame {}: {count} {what} for {} cameras: list one per camera, in the order of the cameras, null where \
                     there is none",
                    frame.index,
                    cameras.len(),
                ));
            }
        }
    }
    let moved = |frame: &SceneFrame| {
        let mut moved = frame.clone();
        for (i, camera) in cameras.iter().enumerate().filter(|(_, camera)| camera.offset != 0) {
            let other = camera.number(frame.index).and_then(|number| by_index.get(&number));
            moved.images[i] = other.and_then(|other| other.images[i].clone());
            if let Some(masks) = &mut moved.masks {
                masks[i] = other.and_then(|other| other.masks.as_ref()?[i].clone());
            }
        }
        moved
    };
    Ok(frames.iter().map(moved).collect())
}

fn parse<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
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

#[cfg(test)]
mod tests;
