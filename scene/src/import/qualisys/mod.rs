//! Calibrations of Qualisys Track Manager (QTM), XML in files .qca.txt, .xml or .txt.
//!
//! Qualisys does not publish the convention. It is known from files and videos that others published with programs that draw
//! points into the videos. x, y and z are the camera's centre in millimetres. r11 r12 r13, r21 r22 r23 and r31 r32 r33 are its
//! axes in the world: x right, y up, z backward. The intrinsics are in sub-pixels ([`pixels`]). The distortion is OpenCV's, for x
//! right and y down, and has no unit. The file describes what the camera stores, however QTM turns its view.

mod pixels;

use super::{
    found::{Found, pictures},
    keys::{listed, unread},
    lens,
    names::name_of,
    notes::Notes,
    source::{failure, picture_size, read_text},
    values::{self, is_neutral, text},
    video_names,
    view::ImportedView,
};
use crate::{failure::Failure, files::Files, lens::LensModel};
use glam::DVec3;
use pcmvs_core::Lens;
use pixels::{Area, Sensor};
use roxmltree::{Document, Node};
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};

/// Millimetres in a metre.
const MILLIMETRES: f64 = 1000.0;
/// Ends of the files' names besides .xml, in lower case.
const ENDS: [&str; 2] = [".qca.txt", ".qca"];

const TOP: &[&str] = &["cameras", "calibrated"];
/// How the calibration was made, and how well.
const ABOUT: &[&str] = &[
    "results",
    "source",
    "created",
    "qtm-version",
    "type",
    "wandLength",
    "maximumFrames",
    "lengthOfCalibration",
    "shortArmEnd",
    "longArmEnd",
    "longArmMiddle",
    "refit-residual",
];
const CAMERA: &[&str] = &[
    "serial",
    "active",
    "calibrated",
    "model",
    "viewrotation",
    "fov_video",
    "fov_video_max",
    "transform",
    "intrinsic",
];
/// How well a camera was calibrated, and the part of the sensor in which it finds markers.
const ABOUT_CAMERA: &[&str] =
    &["message", "point-count", "avg-residual", "video_resolution", "fov_marker", "fov_marker_max"];
const TRANSFORM: &[&str] = &["x", "y", "z", "r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33"];
const INTRINSIC: &[&str] = &[
    // In millimetres, which say nothing without the size of the sensor.
    "focallength",
    "sensorMinU",
    "sensorMaxU",
    "sensorMinV",
    "sensorMaxV",
    "focalLengthU",
    "focalLengthV",
    "centerPointU",
    "centerPointV",
    "skew",
    "radialDistortion1",
    "radialDistortion2",
    "radialDistortion3",
    "tangentalDistortion1",
    "tangentalDistortion2",
];
const AREA: &[&str] = &["left", "top", "right", "bottom"];

type Object = Map<String, Value>;

/// Whether a text is such a calibration, or one that Theia3D wrote in the same form.
pub fn is_calibration(text: &str) -> bool {
    text.contains("<calibration") && text.contains("focalLengthU")
}

/// Whether a file of this name, in lower case, is looked into if it is in a folder. Any other .txt may be large.
pub fn is_usual_name(name: &str) -> bool {
    ENDS.iter().any(|end| name.ends_with(end)) || name.ends_with(".txt") && name.contains("calib")
}

/// Reads the file.
pub fn read(files: &dyn Files, path: &Path, notes: &mut Notes) -> Result<Vec<ImportedView>, Failure> {
    let wrong = |problem: String| Failure::Input(format!("{}: {problem}", path.display()));
    let text = read_text(files, path)?;
    let document = Document::parse(&text).map_err(|e| wrong(format!("{e}: correct that line")))?;
    let cameras = cameras(&document, path, notes).map_err(wrong)?;
    let mut views = Vec::new();
    let mut unused = Unused::default();
    for (i, camera) in cameras.iter().enumerate() {
        let keys = keys(*camera, "").map_err(wrong)?;
        let name = keys.get("serial").and_then(text_of).map(|serial| name_of(&serial)).filter(|name| !name.is_empty());
        let name = name.ok_or_else(|| {
            wrong(format!(
                "camera {} of {} has no `serial`: export the calibration from QTM again",
                i + 1,
                cameras.len()
            ))
        })?;
        let folders = folders(path.parent().unwrap_or(Path::new("")), &name);
        if !unused.takes(&name, &keys, files, &folders)? {
            let found = view(files, path, &folders, &name, &keys, notes)?;
            views.extend(found.views(files, path, &folders, notes)?);
        }
    }
    if views.is_empty() && !unused.without.is_empty() {
        return Err(wrong(format!(
            "none of its cameras has pictures or a video: put a folder of pictures per camera, or a video, in `images`, named \
             after its serial number, such as {}",
            unused.without[0]
        )));
    }
    unused.note(path, notes);
    notes.add(format!("{}: positions are in millimetres, and the scene in metres", path.display()));
    notes.add(format!(
        "{}: principal points are taken to count from the left and the upper edge of the first pixel. Qualisys does not publish \
         that: if they count from its centre, all of them are half a pixel off",
        path.display()
    ));
    Ok(views)
}

/// Cameras that are left out.
#[derive(Default)]
struct Unused {
    inactive: Vec<String>,
    uncalibrated: Vec<String>,
    without: Vec<String>,
}

impl Unused {
    /// Whether a camera is one of these. Cameras for markers have no pictures.
    fn takes(&mut self, name: &str, keys: &Object, files: &dyn Files, folders: &[PathBuf]) -> Result<bool, Failure> {
        let says_no = |key: &str| keys.get(key).is_some_and(is_neutral);
        let has_video = || video_names::find(files, folders, &[name]).map_or(true, |video| video.is_some());
        let list = if says_no("active") {
            &mut self.inactive
        } else if says_no("calibrated") {
            &mut self.uncalibrated
        } else if pictures(files, folders, name)?.is_empty() && !has_video() {
            &mut self.without
        } else {
            return Ok(false);
        };
        let model = keys.get("model").and_then(text_of).map(|model| format!(" ({model})"));
        list.push(format!("`{name}`{}", model.unwrap_or_default()));
        Ok(true)
    }

    fn note(self, path: &Path, notes: &mut Notes) {
        for (names, problem) in [
            (self.inactive, "are not active"),
            (self.uncalibrated, "are not calibrated"),
            (self.without, "have neither pictures nor a video"),
        ] {
            if !names.is_empty() {
                notes.add(format!("{}: cameras that {problem} and are left out: {}", path.display(), names.join(", ")));
            }
        }
    }
}

/// Where the pictures and the video of a camera may be.
fn folders(folder: &Path, name: &str) -> [PathBuf; 4] {
    [folder.to_path_buf(), folder.join("images"), folder.join(name), folder.join("videos").join(name)]
}

/// The elements of the cameras. The calibration may be a part of QTM's settings.
fn cameras<'a>(document: &'a Document<'a>, path: &Path, notes: &mut Notes) -> Result<Vec<Node<'a, 'a>>, String> {
    let all: Vec<Node> = document.descendants().filter(|node| node.has_tag_name("calibration")).collect();
    let [calibration] = all[..] else {
        return Err(format!("has {} elements `calibration`: name a file with one", all.len()));
    };
    let keys_of_all = keys(calibration, "")?;
    let mut ignored = unread_of(&keys_of_all, &[TOP, ABOUT])?;
    if keys_of_all.get("calibrated").is_some_and(is_neutral) {
        return Err(String::from("says that nothing is calibrated: calibrate in QTM, and export again"));
    }
    let list = calibration.children().find(|node| node.has_tag_name("cameras"));
    let list = list.ok_or("has no element `cameras`: export the calibration from QTM again")?;
    let beside = keys(list, "camera")?;
    ignored.extend(unread_of(&beside, &[])?);
    note_ignored(&ignored, path, notes);
    Ok(list.children().filter(|node| node.has_tag_name("camera")).collect())
}

/// Keys that are not read. Those that name another lens are errors, too.
fn unread_of<'a>(keys: &'a Object, known: &[&[&str]]) -> Result<Vec<&'a str>, String> {
    match lens::model(keys)? {
        Some(LensModel::Fisheye) => Err(format!("names a fisheye, whose convention is not known: {}", lens::REMEDY)),
        _ => unread(keys, known, &[]),
    }
}

fn note_ignored(ignored: &[&str], path: &Path, notes: &mut Notes) {
    if !ignored.is_empty() {
        notes.add(format!("{}: ignored: {}", path.display(), listed(ignored.iter().copied())));
    }
}

/// The attributes of an element, and the elements in it, but not those of the name `except`. Of the elements it has their
/// attributes and the names of the elements in them.
fn keys(node: Node, except: &str) -> Result<Object, String> {
    let own = |node: Node| -> Object {
        node.attributes().map(|attribute| (attribute.name().to_owned(), attribute.value().into())).collect()
    };
    let mut all = own(node);
    for child in node.children().filter(|child| child.is_element() && !child.has_tag_name(except)) {
        let name = child.tag_name().name();
        let mut inner = own(child);
        let below = child.children().filter(Node::is_element);
        inner.extend(below.map(|node| (node.tag_name().name().to_owned(), Value::Bool(true))));
        if all.insert(name.to_owned(), inner.into()).is_some() {
            return Err(format!("`{}` has `{name}` twice: remove the one that is wrong", node.tag_name().name()));
        }
    }
    Ok(all)
}

/// A text that is not empty.
fn text_of(value: &Value) -> Option<String> {
    text(value).map(|text| text.trim().to_owned()).filter(|text| !text.is_empty())
}

/// The camera of an element with pictures.
fn view(
    files: &dyn Files,
    path: &Path,
    folders: &[PathBuf],
    name: &str,
    keys: &Object,
    notes: &mut Notes,
) -> Result<Found, Failure> {
    let of_camera = |problem: String| failure(path, name, &problem);
    note_ignored(&unread_of(keys, &[CAMERA, ABOUT_CAMERA]).map_err(of_camera)?, path, notes);
    let first = pictures(files, folders, name)?.into_iter().next();
    let picture = first.map(|(image, _)| picture_size(files, &image, name)).transpose()?;
    camera(name, keys, picture, notes).map_err(of_camera)
}

fn camera(name: &str, keys: &Object, picture: Option<[u32; 2]>, notes: &mut Notes) -> Result<Found, String> {
    let transform = element(keys, "transform", TRANSFORM)?;
    let intrinsic = element(keys, "intrinsic", INTRINSIC)?;
    let of = |key: &str| number(intrinsic, key);
    for key in ["skew", "sensorMinU", "sensorMinV"] {
        let value = of(key)?;
        if value != 0.0 {
            return Err(format!("{key} is {value}, which is not understood, because all known files have 0 there"));
        }
    }
    let area = |name: &str| keys.get(name).map(|_| area_of(keys, name)).transpose();
    let sensor = Sensor {
        last: [of("sensorMaxU")?, of("sensorMaxV")?],
        whole: area("fov_video_max")?,
        video: area("fov_video")?,
    };
    let pixels = sensor.pixels(picture)?;
    note_pixels(name, &pixels, keys, notes)?;
    let k = [
        [pixels.length(0, of("focalLengthU")?), 0.0, pixels.place(0, of("centerPointU")?)],
        [0.0, pixels.length(1, of("focalLengthV")?), pixels.place(1, of("centerPointV")?)],
        [0.0, 0.0, 1.0],
    ];
    let [k1, k2, k3] = [of("radialDistortion1")?, of("radialDistortion2")?, of("radialDistortion3")?];
    let [p1, p2] = [of("tangentalDistortion1")?, of("tangentalDistortion2")?];
    let vector = |names: [&str; 3]| -> Result<DVec3, String> {
        let [x, y, z] = names.map(|key| number(transform, key));
        Ok(DVec3::new(x?, y?, z?))
    };
    let centre = vector(["x", "y", "z"])? / MILLIMETRES;
    let [right, up, back] = [["r11", "r12", "r13"], ["r21", "r22", "r23"], ["r31", "r32", "r33"]].map(vector);
    let (right, down, forward) = (right?, -up?, -back?);
    let t = -DVec3::new(right.dot(centre), down.dot(centre), forward.dot(centre));
    Ok(Found {
        name: name.to_owned(),
        picture: name.to_owned(),
        size: Some(pixels.size),
        k,
        lens: Lens::brown([k1, k2, p1, p2, k3]),
        r: [right.to_array(), down.to_array(), forward.to_array()],
        t: t.to_array(),
    })
}

/// Notes what the pictures are taken to show of the sensor.
fn note_pixels(name: &str, pixels: &pixels::Pixels, keys: &Object, notes: &mut Notes) -> Result<(), String> {
    let [width, height] = pixels.size;
    // The same for many cameras, and therefore without their names.
    if !pixels.is_full_size() {
        notes.add(format!(
            "pictures of {width} x {height} pixels are taken to show all of `fov_video`: focal lengths and principal points are \
             scaled to them"
        ));
    }
    if !pixels.is_from_the_corner() {
        let [left, top] = pixels.first;
        notes.add(format!(
            "pictures of {width} x {height} pixels are taken to begin at the pixel ({left}, {top}) of the sensor, as `fov_video` \
             has it"
        ));
    }
    let turned =
        keys.get("viewrotation").map(|value| values::number("viewrotation", value)).transpose()?.unwrap_or(0.0);
    if ![0.0, 90.0, 180.0, 270.0].contains(&turned) {
        return Err(format!("viewrotation is {turned}, which is not understood: it must be 0, 90, 180 or 270"));
    }
    if turned != 0.0 {
        notes.add(format!(
            "camera `{name}`: QTM shows its view turned by {turned}°, but its pictures are taken to be as the camera stored \
             them: turn them back if they are not"
        ));
    }
    Ok(())
}

/// The attributes of an element of a camera.
fn element<'a>(keys: &'a Object, name: &str, known: &[&str]) -> Result<&'a Object, String> {
    let element = keys.get(name).and_then(Value::as_object);
    let element = element.ok_or_else(|| format!("has no `{name}`: export the calibration from QTM again"))?;
    match element.keys().find(|key| !known.contains(&key.as_str())) {
        Some(key) => Err(format!("`{key}` of `{name}` is not understood: export the calibration from QTM again")),
        None => Ok(element),
    }
}

fn area_of(keys: &Object, name: &str) -> Result<Area, String> {
    let area = element(keys, name, AREA)?;
    let [left, top, right, bottom] = ["left", "top", "right", "bottom"].map(|key| number(area, key));
    Ok(Area { first: [left?, top?], last: [right?, bottom?] })
}

fn number(element: &Object, key: &str) -> Result<f64, String> {
    let value = element.get(key).ok_or_else(|| format!("`{key}` is missing: export the calibration from QTM again"))?;
    values::number(key, value)
}
