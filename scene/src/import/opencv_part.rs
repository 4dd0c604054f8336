//! What a file has of a stereo pair.

use super::{
    essential,
    keys::listed,
    lens::plain,
    marks::{self, Mark},
    notes::Notes,
    opencv_keys::{K, Object, ROTATION, SIZE, SIZE_PARTS, TRANSLATION, as_map, check_matrices},
    values::{find, numbers, to_array},
    view::rotation,
};
use crate::failure::Failure;
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};

/// Keys of a lens without their marks, in lower-case letters.
const MARKED_K: &[&str] =
    &["m", "k", "cm", "mtx", "cameramatrix", "cammatrix", "intrinsicmatrix", "intrinsic", "intrinsics"];
const MARKED_DISTORTION: &[&str] = &[
    "d",
    "dc",
    "dist",
    "distcoeff",
    "distcoeffs",
    "distcoefs",
    "distortion",
    "distortioncoeffs",
    "distortioncoefficients",
];
const ESSENTIAL: &[&str] = &["e", "essential", "essentialmatrix"];
/// What else follows from the lenses and the pose: the fundamental matrix, and the rectification.
const DERIVED: &[&str] = &["f", "q", "fundamental", "fundamentalmatrix"];
const MARKED_DERIVED: &[&str] = &[
    "r",
    "p",
    "rect",
    "rectification",
    "rectificationmatrix",
    "projection",
    "projectionmatrix",
    "newcameramatrix",
    "newcameramtx",
];
/// Translations with marks: poses of single cameras, which a pair does not have.
const MARKED_TRANSLATION: &[&str] = &["t", "tvec", "translation"];

/// What a file has of a pair.
pub struct Part {
    pub file: PathBuf,
    /// The keys of each lens, in their usual spelling.
    pub lenses: Vec<(Mark, Object)>,
    /// Whether the marks are those of keys or maps, not that of the file's name.
    pub is_marked: bool,
    pub pose: Option<[Value; 2]>,
    pub rest: Object,
}

impl Part {
    /// What a file has of a pair. Cameras with poses of their own are none.
    pub fn new(file: &Path, value: &Value) -> Option<Self> {
        let top = value.as_object()?;
        let mut part = Self {
            file: file.to_path_buf(),
            lenses: Vec::new(),
            is_marked: true,
            pose: find(top, ROTATION).zip(find(top, TRANSLATION)).map(|((_, r), (_, t))| [r.clone(), t.clone()]),
            rest: Map::new(),
        };
        for (key, value) in top {
            match lens_key(key, value) {
                Some((mark, own)) => part.add(mark, own),
                None if part.pose.is_some() && [ROTATION, TRANSLATION].concat().contains(&key.as_str()) => {}
                None => {
                    part.rest.insert(key.clone(), value.clone());
                }
            }
        }
        if part.lenses.iter().any(|(_, own)| own.contains_key("K")) {
            return Some(part);
        }
        // Coefficients with marks are no lens without K.
        let has_pose = |object: &Object| [ROTATION, TRANSLATION].iter().any(|keys| find(object, keys).is_some());
        let has_cameras = top.contains_key("cameras") || top.values().filter_map(Value::as_object).any(has_pose);
        match (find(top, K), has_pose(top)) {
            _ if has_cameras => None,
            (Some(_), false) => {
                let mark = marks::of_camera(&file.file_stem()?.to_string_lossy())?;
                Some(Self { lenses: vec![(mark, top.clone())], is_marked: false, rest: Map::new(), ..part })
            }
            (None, true) => part.pose.is_some().then_some(part),
            _ => None,
        }
    }

    fn add(&mut self, mark: Mark, own: Object) {
        match self.lenses.iter_mut().find(|(other, _)| *other == mark) {
            Some((_, keys)) => keys.extend(own),
            None => self.lenses.push((mark, own)),
        }
    }

    pub fn is_complete(&self) -> bool {
        self.lenses.len() > 1 && self.pose.is_some()
    }

    pub fn wrong(&self, problem: &str) -> Failure {
        Failure::Input(format!("{}: {problem}", self.file.display()))
    }

    /// Adds what another file has of the same pair.
    pub fn join(&mut self, other: Self) -> Result<(), Failure> {
        let both = |what: &str| {
            let problem = format!("has {what} of a stereo pair, and so has {}", other.file.display());
            self.wrong(&format!("{problem}: keep one pair in the folder, or all of each pair in one file"))
        };
        for (mark, own) in &other.lenses {
            if self.lenses.iter().any(|(known, keys)| known == mark && keys != own) {
                return Err(both("a lens"));
            }
        }
        if self.pose.is_some() && other.pose.is_some() && self.pose != other.pose {
            return Err(both("R and T"));
        }
        for (mark, own) in other.lenses {
            self.add(mark, own);
        }
        if other.pose.is_some() {
            (self.pose, self.file) = (other.pose, other.file);
        }
        for (key, value) in other.rest {
            let of_size = SIZE.iter().chain(SIZE_PARTS).any(|&size| size == key);
            match self.rest.get(&key) {
                Some(known) if of_size && *known != value => {
                    return Err(self.wrong(&format!("`{key}` is another one than in the other file: correct it")));
                }
                Some(_) => {}
                None => {
                    self.rest.insert(key, value);
                }
            }
        }
        Ok(())
    }

    /// The calibration of these cameras, which have poses, with what all of them share.
    pub fn with_cameras(self, cameras: impl IntoIterator<Item = Object>) -> (PathBuf, Value) {
        let mut top = self.rest;
        top.insert(String::from("cameras"), cameras.into_iter().map(Value::Object).collect());
        (self.file, top.into())
    }

    /// The two lenses, that of the first camera first.
    pub fn pair(&self) -> Result<[(Mark, &Object); 2], Failure> {
        let mut lenses: Vec<_> = self.lenses.iter().map(|(mark, own)| (*mark, own)).collect();
        lenses.sort_by_key(|(mark, _)| *mark);
        match lenses[..] {
            [(Mark::Left, first), (Mark::Right, second)] => Ok([(Mark::Left, first), (Mark::Right, second)]),
            [(Mark::Number(a @ 0..=1), first), (Mark::Number(b), second)] if b == a + 1 => {
                Ok([(Mark::Number(a), first), (Mark::Number(b), second)])
            }
            _ => Err(self.wrong(
                "has lenses of a stereo pair, but not those of its first and its second camera: mark them by `1` and `2` or \
                 `left` and `right`, such as M1 D1 M2 D2",
            )),
        }
    }

    /// Refuses an essential matrix that does not follow from R and T.
    fn check_essential(&self) -> Result<(), Failure> {
        let essential = self.rest.iter().find(|(key, _)| ESSENTIAL.contains(&plain(key).as_str()));
        let (Some((_, e)), Some([r, t])) = (essential, &self.pose) else { return Ok(()) };
        let check = || {
            // What is no matrix is refused later, and so are R and T that are no pose.
            let Ok(Ok(e)) = numbers(e).map(<[f64; 9]>::try_from) else { return Ok(()) };
            essential::check(&e, rotation(&numbers(r)?)?, to_array(&numbers(t)?, "T")?.into())
        };
        check().map_err(|problem| self.wrong(&problem))
    }

    /// Removes what follows from the pair, and notes it. What contradicts the pair, or may be another camera or another pose, is
    /// an error.
    pub fn drop_derived(&mut self, notes: &mut Notes) -> Result<(), Failure> {
        self.check_essential()?;
        let of_matrix = |value: &Value| numbers(value).is_ok_and(|numbers| numbers.len() >= 9);
        let is_marked =
            |key: &str, known: &[&str]| marks::split(key).is_some_and(|(base, _)| known.contains(&base.as_str()));
        let is_derived = |key: &str, value: &Value| {
            let is_known = [ESSENTIAL, DERIVED].concat().contains(&plain(key).as_str());
            of_matrix(value) && (is_known || is_marked(key, MARKED_DERIVED))
        };
        let poses = self.rest.keys().find(|key| is_marked(key, MARKED_TRANSLATION));
        if let Some(key) = poses {
            return Err(self.wrong(&format!(
                "`{key}` looks like the pose of a single camera, but R and T are those of a stereo pair: remove those that are \
                 not meant"
            )));
        }
        let (derived, rest): (Object, Object) =
            std::mem::take(&mut self.rest).into_iter().partition(|(key, value)| is_derived(key, value));
        if !derived.is_empty() {
            let keys = listed(derived.keys().map(String::as_str));
            let file = self.file.display();
            notes.add(format!("{file}: ignored, because it follows from the lenses, R and T: {keys}"));
        }
        self.rest = rest;
        check_matrices(&self.rest).map_err(|problem| self.wrong(&problem))
    }
}

/// The lens to which a key belongs, and its part of the lens.
fn lens_key(key: &str, value: &Value) -> Option<(Mark, Object)> {
    let (base, mark) = marks::split(key)?;
    let is_map = as_map(value).is_some_and(|map| {
        let has = |keys: &[&str]| find(map, keys).is_some();
        has(K) && !has(ROTATION) && !has(TRANSLATION)
    });
    if is_map {
        marks::of_camera(key)?;
        let mut own = value.as_object()?.clone();
        if let Some((spelled, k)) = find(&own, K).map(|(spelled, k)| (spelled, k.clone())) {
            own.remove(&spelled);
            own.insert(String::from("K"), k);
        }
        return Some((mark, own));
    }
    let named = |known: &[&str]| {
        let of_camera = ["camera", "cam"].iter().find_map(|word| {
            base.strip_prefix(word).or_else(|| base.strip_suffix(word)).filter(|rest| known.contains(rest))
        });
        known.contains(&base.as_str()) || of_camera.is_some()
    };
    let count = numbers(value).map_or(0, |numbers| numbers.len());
    let usual = if named(MARKED_K) && count == 9 {
        "K"
    } else if named(MARKED_DISTORTION) && count > 3 {
        "D"
    } else {
        return None;
    };
    Some((mark, Object::from_iter([(usual.to_owned(), value.clone())])))
}

/// Whether a file has a marked lens.
pub fn has_lens(value: &Value) -> bool {
    Part::new(Path::new(""), value).is_some_and(|part| part.is_marked && !part.lenses.is_empty())
}

/// The pose of the camera that makes the world.
pub fn identity() -> [(String, Value); 2] {
    [(String::from("R"), json!([1, 0, 0, 0, 1, 0, 0, 0, 1])), (String::from("t"), json!([0, 0, 0]))]
}
