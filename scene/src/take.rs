//! Reads scene.json. Its frames are a list of paths, or a range of numbers with patterns of paths; its cameras may be in
//! another file.
//!
//! The browser reads this, and its module has a limited size. Therefore only what is listed is read by types, whose errors
//! name the place in the file. The few other keys are looked up.

use crate::{
    failure::Failure,
    files::Files,
    pattern::{expand, has_frame, patterns},
    scene::{Background, SceneCamera, SceneFrame, VERSION},
    text,
};
use serde::Deserialize;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Most bytes that the paths of a take may need.
const MOST_PATH_BYTES: usize = 1 << 28;

/// A file in the format of scene.json. Unknown keys, such as novel views for scoring or notes, are ignored.
#[derive(Deserialize)]
pub struct Take {
    #[serde(default)]
    pub units: Option<String>,
    #[serde(default)]
    pub up: Option<[f64; 3]>,
    #[serde(default)]
    pub fps: Option<f64>,
    #[serde(default)]
    pub cameras: Option<Vec<SceneCamera>>,
    /// The frames, if they are a list.
    #[serde(default)]
    frames: Option<Vec<SceneFrame>>,
    #[serde(default)]
    pub background: Option<Background>,
    #[serde(skip)]
    keys: Keys,
}

/// The keys that are looked up. Null if they are not there.
#[derive(Default)]
struct Keys {
    rig: Value,
    offsets: Value,
    range: Value,
    images: Value,
    masks: Value,
    videos: Value,
    mask_videos: Value,
}

/// Numbers of frames.
#[derive(Clone, Copy)]
struct Range {
    first: u32,
    last: u32,
    step: u32,
}

impl Take {
    /// Reads a file.
    pub fn read(files: &dyn Files, path: &Path) -> Result<Self, Failure> {
        let bytes = files.read(path).map_err(|e| Failure::unreadable(path, &e))?;
        parse(&bytes).map_err(|problem| Failure::Input(format!("{}: {problem}", path.display())))
    }

    /// The path of the file with the cameras, if it is another one.
    pub fn rig(&self) -> Result<Option<PathBuf>, String> {
        match &self.keys.rig {
            Value::Null => Ok(None),
            Value::String(path) => Ok(Some(PathBuf::from(path))),
            _ => Err(String::from("rig: write the path of a file with `cameras`")),
        }
    }

    /// Gives the cameras their offsets.
    pub fn set_offsets(&self, cameras: &mut [SceneCamera]) -> Result<(), String> {
        let offsets = match &self.keys.offsets {
            Value::Null => return Ok(()),
            Value::Object(offsets) => offsets,
            _ => return Err(String::from("offsets: write { \"camera\": whole frames }")),
        };
        for (name, offset) in offsets {
            let number = offset.as_i64().and_then(|offset| i32::try_from(offset).ok());
            let number =
                number.ok_or_else(|| format!("offsets: {offset} of `{name}` is not a number of whole frames"))?;
            let mut named = cameras.iter_mut().filter(|camera| camera.name == *name);
            match (named.next(), named.next()) {
                (Some(camera), None) => camera.offset = number,
                _ => return Err(format!("offsets: there is not one camera `{name}`: correct the name")),
            }
        }
        Ok(())
    }

    /// Whether the pictures, and whether the masks, are videos.
    pub fn are_videos(&self) -> [bool; 2] {
        [&self.keys.videos, &self.keys.mask_videos].map(|videos| !videos.is_null())
    }

    /// The frames with their paths, those that the cameras' offsets choose.
    pub fn frames(&self, cameras: &[SceneCamera]) -> Result<Vec<SceneFrame>, String> {
        let Keys { images, masks, videos, mask_videos, .. } = &self.keys;
        if let Some(frames) = &self.frames {
            if [images, masks, videos, mask_videos].iter().any(|patterns| !patterns.is_null()) {
                return Err(String::from("`frames` is a list: make it a range, or write all paths in the list"));
            }
            return listed(frames, cameras);
        }
        let range = range(&self.keys.range)?;
        let images = range.patterns(["images", "videos"], [images, videos], cameras)?;
        let masks = range.patterns(["masks", "mask_videos"], [masks, mask_videos], cameras)?;
        if images.is_empty() {
            return Err(String::from(
                "`frames` is a range, but there are no `images` or `videos`: add a pattern of paths",
            ));
        }
        range.frames(cameras, &images, &masks)
    }
}

fn range(value: &Value) -> Result<Range, String> {
    let number = |key: &str, default: u64| match value.get(key) {
        None if default > 0 => Some(default as u32),
        given => u32::try_from(given?.as_u64()?).ok(),
    };
    match (number("first", 0), number("last", 0), number("step", 1)) {
        (Some(first), Some(last), Some(step)) if first <= last && step > 0 => Ok(Range { first, last, step }),
        _ => Err(String::from("frames: write a list, or a range { \"first\": 0, \"last\": 99 } with whole numbers")),
    }
}

impl Range {
    fn count(self) -> usize {
        (self.last - self.first) as usize / self.step as usize + 1
    }

    /// The patterns of pictures or of videos, of which there is one kind. Those of pictures give a path per frame, and those of
    /// videos one for all.
    fn patterns<'v>(
        self,
        keys: [&str; 2],
        [pictures, videos]: [&'v Value; 2],
        cameras: &[SceneCamera],
    ) -> Result<Vec<Option<&'v str>>, String> {
        let are_videos = !videos.is_null();
        if are_videos && !pictures.is_null() {
            return Err(format!("there are both `{}` and `{}`: remove one", keys[0], keys[1]));
        }
        let (key, value) = if are_videos { (keys[1], videos) } else { (keys[0], pictures) };
        let found = patterns(value, cameras).map_err(|problem| format!("{key}: {problem}"))?;
        for pattern in found.iter().flatten() {
            if are_videos && has_frame(pattern) {
                return Err(format!("{key}: `{pattern}`: a video has all frames: take out {{frame}}"));
            }
            if !are_videos && self.count() > 1 && !has_frame(pattern) {
                return Err(format!("{key}: `{pattern}` is the same in all frames: add {{frame}}"));
            }
        }
        Ok(found)
    }

    fn frames(
        self,
        cameras: &[SceneCamera],
        images: &[Option<&str>],
        masks: &[Option<&str>],
    ) -> Result<Vec<SceneFrame>, String> {
        let paths = |patterns: &[Option<&str>], frame: u32| -> Vec<Option<PathBuf>> {
            let path = |(pattern, camera): (&Option<&str>, &SceneCamera)| {
                expand((*pattern)?, &camera.name, camera.number(frame)?).ok().map(PathBuf::from)
            };
            patterns.iter().zip(cameras).map(path).collect()
        };
        let count = self.count();
        // The last numbers are the longest.
        let longest = paths(images, self.last).into_iter().chain(paths(masks, self.last));
        let bytes: usize =
            longest.map(|path| size_of::<Option<PathBuf>>() + path.map_or(0, |path| path.as_os_str().len())).sum();
        if bytes.saturating_mul(count) > MOST_PATH_BYTES {
            return Err(format!(
                "the paths of {count} frames take more than {} MiB: split the take",
                MOST_PATH_BYTES >> 20
            ));
        }
        let frame = |index: u32| SceneFrame {
            index,
            images: paths(images, index),
            masks: (!masks.is_empty()).then(|| paths(masks, index)),
        };
        Ok((self.first..=self.last).step_by(self.step as usize).map(frame).collect())
    }
}

/// The frames of a list, with the pictures that the cameras' offsets choose.
fn listed(frames: &[SceneFrame], cameras: &[SceneCamera]) -> Result<Vec<SceneFrame>, String> {
    let mut indices: Vec<u32> = frames.iter().map(|f| f.index).collect();
    indices.sort_unstable();
    if let Some(pair) = indices.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(format!("frame {} occurs twice: give every frame its own index", pair[0]));
    }
    for frame in frames {
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
    let mut moved = frames.to_vec();
    for frame in &mut moved {
        for (i, camera) in cameras.iter().enumerate().filter(|(_, camera)| camera.offset != 0) {
            let other = camera.number(frame.index).and_then(|number| frames.iter().find(|other| other.index == number));
            frame.images[i] = other.and_then(|other| other.images[i].clone());
            if let Some(masks) = &mut frame.masks {
                masks[i] = other.and_then(|other| other.masks.as_ref()?[i].clone());
            }
        }
    }
    Ok(moved)
}

fn parse(bytes: &[u8]) -> Result<Take, String> {
    let text = text::decode(bytes)?;
    let mut all: Value = serde_json::from_str(text).map_err(|e| syntax_problem(text, &e))?;
    let version = &all["version"];
    if version.is_null() {
        return Err(format!("`version` is missing: write \"version\": {VERSION}"));
    }
    if *version != VERSION {
        return Err(format!("version {version} is unknown: this program reads version {VERSION}"));
    }
    let is_range = all["frames"].is_object();
    let mut take = |key: &str| all.get_mut(key).map(Value::take).unwrap_or_default();
    let keys = Keys {
        rig: take("rig"),
        offsets: take("offsets"),
        range: if is_range { take("frames") } else { Value::Null },
        images: take("images"),
        masks: take("masks"),
        videos: take("videos"),
        mask_videos: take("mask_videos"),
    };
    let take = serde_path_to_error::deserialize(all).map_err(|error| {
        let place = error.path().to_string();
        let camera = camera_name(text, &place).map(|name| format!(" (camera `{name}`)")).unwrap_or_default();
        format!("{place}{camera}: {}", error.inner())
    })?;
    Ok(Take { keys, ..take })
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
    let scene: Value = serde_json::from_str(text).ok()?;
    Some(scene["cameras"][index]["name"].as_str()?.to_owned())
}

#[cfg(test)]
mod tests;
