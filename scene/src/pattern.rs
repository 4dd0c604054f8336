//! Paths of all frames and cameras as one line: `cam{camera}/{frame:06}.jpg`.

use serde::{
    Deserialize, Deserializer, Serialize,
    de::{SeqAccess, Visitor, value::SeqAccessDeserializer},
};
use std::{
    fmt,
    path::{MAIN_SEPARATOR, Path, PathBuf},
};

/// Most digits to which the number of a frame is padded.
const MOST_DIGITS: usize = 20;

/// A pattern for all cameras, or one per camera.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum Patterns {
    /// The pattern of all cameras.
    Shared(String),
    /// One per camera, in the order of the cameras, null where a camera has none.
    PerCamera(Vec<Option<String>>),
}

impl<'de> Deserialize<'de> for Patterns {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = Patterns;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a pattern such as \"{camera}/{frame:06}.jpg\", or a list of one per camera")
            }

            fn visit_str<E>(self, text: &str) -> Result<Patterns, E> {
                Ok(Patterns::Shared(text.to_owned()))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Patterns, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(list)).map(Patterns::PerCamera)
            }
        }
        deserializer.deserialize_any(Either)
    }
}

impl Patterns {
    /// The pattern of each of a number of cameras. A pattern that they share must name the camera.
    pub(crate) fn each(&self, cameras: usize) -> Result<Vec<Option<Pattern>>, String> {
        match self {
            Self::Shared(text) => {
                let pattern = Pattern::parse(text)?;
                if cameras > 1 && !pattern.0.contains(&Part::Camera) {
                    return Err(format!(
                        "`{text}` would be the same for all cameras: add {{camera}}, or list one per camera"
                    ));
                }
                Ok(vec![Some(pattern); cameras])
            }
            Self::PerCamera(list) if list.len() != cameras => Err(format!(
                "{} patterns for {cameras} cameras: list one per camera, in the order of the cameras, null where there is none",
                list.len()
            )),
            Self::PerCamera(list) => list.iter().map(|text| text.as_deref().map(Pattern::parse).transpose()).collect(),
        }
    }

    /// Makes the patterns start in another folder, which is literal.
    pub(crate) fn move_to(&mut self, lead: &Path) {
        let moved = |text: &mut String| {
            if Path::new(text).is_absolute() {
                return;
            }
            let lead = lead.to_string_lossy().replace('{', "{{").replace('}', "}}");
            *text = if lead.is_empty() { text.clone() } else { format!("{lead}{MAIN_SEPARATOR}{text}") };
        };
        match self {
            Self::Shared(text) => moved(text),
            Self::PerCamera(list) => list.iter_mut().flatten().for_each(moved),
        }
    }
}

/// A path with places for the name of the camera and the number of the frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Pattern(Vec<Part>);

#[derive(Debug, Clone, PartialEq, Eq)]
enum Part {
    Text(String),
    Camera,
    /// The number, padded with zeros to this many digits.
    Frame(usize),
}

impl Pattern {
    /// Reads `{camera}`, `{frame}` and `{frame:06}`. A literal brace is written twice.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let mut parts = Vec::new();
        let mut literal = String::new();
        let mut rest = text;
        while let Some(at) = rest.find(['{', '}']) {
            literal.push_str(&rest[..at]);
            let (brace, after) = rest[at..].split_at(1);
            if let Some(doubled) = after.strip_prefix(brace) {
                literal.push_str(brace);
                rest = doubled;
                continue;
            }
            let place = after.split_once('}').filter(|_| brace == "{");
            let Some((part, end)) = place.and_then(|(name, end)| Some((part(name)?, end))) else {
                return Err(format!(
                    "`{text}`: the brace before `{after}` is not understood: write {{camera}}, {{frame}} or {{frame:06}}, and a \
                     literal brace twice"
                ));
            };
            parts.push(Part::Text(std::mem::take(&mut literal)));
            parts.push(part);
            rest = end;
        }
        literal.push_str(rest);
        parts.push(Part::Text(literal));
        parts.retain(|part| !matches!(part, Part::Text(text) if text.is_empty()));
        Ok(Self(parts))
    }

    /// Whether the path depends on the frame.
    pub(crate) fn has_frame(&self) -> bool {
        self.0.iter().any(|part| matches!(part, Part::Frame(_)))
    }

    /// No path of this camera is longer, in bytes.
    pub(crate) fn longest(&self, camera: &str) -> usize {
        let length = |part: &Part| match part {
            Part::Text(text) => text.len(),
            Part::Camera => camera.len(),
            Part::Frame(_) => MOST_DIGITS,
        };
        self.0.iter().map(length).fold(0, usize::saturating_add)
    }

    /// The path of a camera's picture in a frame.
    pub(crate) fn path(&self, camera: &str, frame: u32) -> PathBuf {
        let mut path = String::new();
        for part in &self.0 {
            match part {
                Part::Text(text) => path.push_str(text),
                Part::Camera => path.push_str(camera),
                Part::Frame(digits) => path.push_str(&format!("{frame:0digits$}")),
            }
        }
        PathBuf::from(path)
    }
}

/// What stands between two braces.
fn part(name: &str) -> Option<Part> {
    match name {
        "camera" => Some(Part::Camera),
        "frame" => Some(Part::Frame(0)),
        _ => {
            let digits = name.strip_prefix("frame:0")?.parse().ok()?;
            (1..=MOST_DIGITS).contains(&digits).then_some(Part::Frame(digits))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(pattern: &str, frame: u32) -> String {
        Pattern::parse(pattern).unwrap().path("left", frame).to_string_lossy().into_owned()
    }

    #[test]
    fn patterns_hold_the_camera_and_the_number_of_the_frame() {
        assert_eq!(path("cam{camera}/{frame:06}.jpg", 42), "camleft/000042.jpg");
        assert_eq!(path("{frame}_{camera}_{frame:02}", 123), "123_left_123");
        assert_eq!(path("plain.png", 1), "plain.png");
        assert_eq!(path("{{{camera}}}/{{frame}}", 1), "{left}/{frame}");
    }

    #[test]
    fn braces_that_mean_nothing_are_refused() {
        for wrong in
            ["{cam}", "{frame", "frame}", "{frame:6}", "{frame:0}", "{frame:021}", "{}", "a{", "}", "{frame:0x}"]
        {
            assert!(Pattern::parse(wrong).unwrap_err().contains(wrong), "{wrong}");
        }
    }

    #[test]
    fn cameras_do_not_share_a_picture() {
        let shared = Patterns::Shared(String::from("{frame}.jpg"));
        assert!(shared.each(2).unwrap_err().contains("{camera}"));
        assert_eq!(shared.each(1).unwrap().len(), 1);
        let list = Patterns::PerCamera(vec![None, Some(String::from("a/{frame}.jpg"))]);
        assert_eq!(list.each(2).unwrap().iter().map(Option::is_some).collect::<Vec<_>>(), [false, true]);
        assert!(list.each(3).unwrap_err().contains("2 patterns for 3 cameras"));
    }

    #[test]
    fn a_folder_before_a_pattern_is_literal() {
        let mut patterns = Patterns::Shared(String::from("{camera}.jpg"));
        patterns.move_to(Path::new("take {1}"));
        let pattern = patterns.each(1).unwrap()[0].clone().unwrap();
        assert_eq!(pattern.path("left", 0), Path::new("take {1}").join("left.jpg"));
    }
}
