//! Agisoft Metashape's XML of cameras. Poses are camera to chunk with x right, y down, z forward. A sensor has f, cx and cy
//! from the middle of the picture, b1 and b2 (aspect and skew), k1 to k4, p1 and p2, which OpenCV has in the other order.
//! Cameras may be in groups, whose labels are the folders of their pictures.
//! The transform of the component or the chunk leads to the world and is applied. A chunk may have several frames, whose
//! cameras have the poses of the chunk and pictures of their own.

use super::{
    found::Found,
    names::name_of,
    notes::Notes,
    projects,
    source::{failure, read_text},
    values::{self, to_array},
    view::ImportedView,
};
use crate::{failure::Failure, files::Files};
use glam::{DMat3, DVec3};
use pcmvs_core::Lens;
use roxmltree::{Document, Node};
use std::{
    collections::BTreeMap,
    path::{Component, Path, PathBuf},
};

/// Coefficients that are read.
const COEFFICIENTS: [&str; 12] = ["f", "cx", "cy", "b1", "b2", "k1", "k2", "k3", "k4", "p1", "p2", "resolution"];

/// Reads the file.
pub fn read(files: &dyn Files, path: &Path, notes: &mut Notes) -> Result<Vec<ImportedView>, Failure> {
    let wrong = |problem: String| Failure::Input(format!("{}: {problem}", path.display()));
    projects::refuse(path)?;
    let text = read_text(files, path)?;
    let document = Document::parse(&text).map_err(|e| wrong(format!("{e}: correct that line")))?;
    let chunks: Vec<Node> = document.root_element().children().filter(|node| node.has_tag_name("chunk")).collect();
    let [chunk] = chunks[..] else {
        return Err(wrong(format!("has {} chunks: export the cameras of one chunk", chunks.len())));
    };
    let folder = path.parent().unwrap_or(Path::new(""));
    let usual = [folder.to_path_buf(), folder.join("images")];
    let (count, photos) = frames(chunk).map_err(wrong)?;
    let mut views = Vec::new();
    let (mut without, mut disabled) = (Vec::new(), Vec::new());
    // The frames of a chunk have cameras, too, which only name their photos.
    let list = child(chunk, "cameras").into_iter().flat_map(|list| list.descendants());
    let cameras: Vec<Node> = list.filter(|node| node.has_tag_name("camera")).collect();
    let mut repeated = BTreeMap::new();
    for label in cameras.iter().filter_map(|camera| camera.attribute("label")) {
        *repeated.entry(label).or_insert(0) += 1;
    }
    for camera in cameras {
        let label = camera.attribute("label").filter(|label| !label.is_empty()).ok_or_else(|| {
            let id = camera.attribute("id").unwrap_or_default();
            wrong(format!(
                "the camera with the id `{id}` has no label: give it the name of its picture, and export again"
            ))
        })?;
        let group = group(camera);
        let name = if repeated[label] > 1 { name_of(&format!("{group}/{label}")) } else { name_of(label) };
        let folders = in_group(&usual, &group);
        if matches!(camera.attribute("enabled"), Some("false" | "0")) {
            disabled.push(name);
            continue;
        }
        let of_camera = |problem: String| failure(path, &name, &problem);
        let Some(transform) = child(camera, "transform") else {
            if camera.attribute("master_id").is_some() {
                return Err(of_camera(String::from(
                    "has its pose in a multi-camera system, which is not read: add the photos as single cameras, align them \
                     again and export",
                )));
            }
            without.push(name);
            continue;
        };
        let found = view(chunk, camera, transform, label, &name, notes).map_err(of_camera)?;
        let Some(photos) = camera.attribute("id").and_then(|id| photos.get(id)) else {
            views.extend(found.views(files, path, &folders, notes)?);
            continue;
        };
        for &(photo, time) in photos {
            let of_frame = Found { picture: photo.to_owned(), ..found.clone() };
            let own = of_frame.views(files, path, &folders, notes)?;
            views.extend(own.into_iter().map(|view| ImportedView { time: Some(time), ..view }));
        }
    }
    if count > 1 && photos.is_empty() {
        notes.add(format!(
            "{}: the chunk has {count} frames, but the export does not name their pictures: put them in a folder per camera, \
             such as `images/LABEL/000001.jpg`, or in a folder per frame, such as `frame_0001/LABEL.jpg`",
            path.display()
        ));
    }
    for (names, problem) in [(without, "are not aligned"), (disabled, "are disabled")] {
        if !names.is_empty() {
            notes.add(format!("{}: cameras that {problem} and are left out: {}", path.display(), names.join(", ")));
        }
    }
    Ok(views)
}

/// The labels of the groups around a camera, as a path. Where photos of several folders were added, the groups are the folders.
fn group(camera: Node) -> String {
    let groups = camera.ancestors().filter(|node| node.has_tag_name("group"));
    let mut labels: Vec<&str> = groups.filter_map(|group| group.attribute("label")).collect();
    labels.reverse();
    labels.join("/")
}

/// Folders in which the pictures of a group are searched: its own, then the usual ones.
fn in_group(usual: &[PathBuf], group: &str) -> Vec<PathBuf> {
    // A label is any text, and must not lead elsewhere.
    let inside = Path::new(group).components().all(|part| matches!(part, Component::Normal(_)));
    let own = usual.iter().filter(|_| inside && !group.is_empty()).map(|folder| folder.join(group));
    own.chain(usual.iter().cloned()).collect()
}

/// The photos of cameras, by their ids: paths, and the numbers of the frames.
type Photos<'a> = BTreeMap<&'a str, Vec<(&'a str, f64)>>;

/// The number of frames of a chunk and, if there are several, their photos.
fn frames<'a>(chunk: Node<'a, 'a>) -> Result<(usize, Photos<'a>), String> {
    let frames = child(chunk, "frames").into_iter().flat_map(|node| node.children());
    let frames: Vec<Node> = frames.filter(|node| node.has_tag_name("frame")).collect();
    let mut photos = Photos::new();
    for frame in frames.iter().filter(|_| frames.len() > 1) {
        let id = frame.attribute("id").unwrap_or_default();
        let number = id
            .parse::<u32>()
            .map_err(|_| format!("a frame has the id `{id}`, which is not a number: export it again"))?;
        for camera in frame.descendants().filter(|node| node.has_tag_name("camera")) {
            let photo = child(camera, "photo").and_then(|photo| photo.attribute("path"));
            if let (Some(id), Some(photo)) = (camera.attribute("camera_id"), photo) {
                photos.entry(id).or_default().push((photo, f64::from(number)));
            }
        }
    }
    Ok((frames.len(), photos))
}

fn child<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    node.children().find(|child| child.has_tag_name(name))
}

fn numbers<const N: usize>(node: Node) -> Result<[f64; N], String> {
    let name = node.tag_name().name();
    let number = |word: &str| match word.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(format!("{name}: `{word}` is not a finite number")),
    };
    let list: Vec<f64> = node.text().unwrap_or_default().split_whitespace().map(number).collect::<Result<_, _>>()?;
    to_array(&list, name)
}

fn view<'a>(
    chunk: Node<'a, 'a>,
    camera: Node<'a, 'a>,
    transform: Node<'a, 'a>,
    label: &str,
    name: &str,
    notes: &mut Notes,
) -> Result<Found, String> {
    if child(camera, "orientation").is_some_and(|node| node.text().is_some_and(|text| text.trim() != "1")) {
        return Err(String::from("its picture is turned (`orientation`): export the cameras with turned pictures"));
    }
    if child(camera, "rolling_shutter").is_some() {
        return Err(String::from(
            "is corrected for a rolling shutter, which a scene cannot hold: align without that correction and export again",
        ));
    }
    let sensor = sensor(chunk, camera)?;
    let m: [f64; 16] = numbers(transform)?;
    if m[12..] != [0.0, 0.0, 0.0, 1.0] {
        return Err(String::from("transform must have 0 0 0 1 in its last row"));
    }
    // The columns are the camera's axes.
    let axes = DMat3::from_cols_array(&[m[0], m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10]]);
    let centre = DVec3::new(m[3], m[7], m[11]);
    let world = to_world(chunk, camera)?;
    if let Some((_, _, scale)) = world {
        notes.add(format!("the transform of the chunk is applied, with its scale of {scale}"));
    }
    let (turn, shift, scale) = world.unwrap_or((DMat3::IDENTITY, DVec3::ZERO, 1.0));
    let r = (turn * axes).transpose();
    let t = -(r * (turn * centre * scale + shift));
    let (size, k, lens) = intrinsics(sensor)?;
    Ok(Found {
        name: name.to_owned(),
        picture: label.to_owned(),
        size: Some(size),
        k,
        lens,
        r: r.transpose().to_cols_array_2d(),
        t: t.to_array(),
    })
}

fn sensor<'a>(chunk: Node<'a, 'a>, camera: Node<'a, 'a>) -> Result<Node<'a, 'a>, String> {
    let id = camera.attribute("sensor_id").ok_or("has no sensor_id")?;
    let found = chunk.descendants().find(|node| node.has_tag_name("sensor") && node.attribute("id") == Some(id));
    found.ok_or_else(|| format!("there is no sensor {id}: export the cameras again"))
}

/// Rotation, translation and scale from the chunk's axes to the world's: those of the camera's component, or of the chunk.
fn to_world<'a>(chunk: Node<'a, 'a>, camera: Node<'a, 'a>) -> Result<Option<(DMat3, DVec3, f64)>, String> {
    let component = camera.attribute("component_id").and_then(|id| {
        chunk.descendants().find(|node| node.has_tag_name("component") && node.attribute("id") == Some(id))
    });
    let transform = component.and_then(|node| child(node, "transform")).or_else(|| child(chunk, "transform"));
    let Some(transform) = transform else { return Ok(None) };
    let rotation = match child(transform, "rotation") {
        Some(node) => DMat3::from_cols_array(&numbers(node)?).transpose(),
        None => DMat3::IDENTITY,
    };
    let translation = child(transform, "translation").map(numbers::<3>).transpose()?.unwrap_or([0.0; 3]);
    let [scale] = child(transform, "scale").map(numbers).transpose()?.unwrap_or([1.0]);
    if !(scale > 0.0) {
        return Err(format!("the scale of the chunk's transform is {scale}: it must be positive"));
    }
    Ok(Some((rotation, DVec3::from_array(translation), scale)))
}

type Intrinsics = ([u32; 2], [[f64; 3]; 3], Lens);

fn intrinsics(sensor: Node) -> Result<Intrinsics, String> {
    let mut calibrations = sensor.children().filter(|node| node.has_tag_name("calibration"));
    let all: Vec<Node> = calibrations.by_ref().collect();
    let adjusted = all.iter().find(|node| node.attribute("class") == Some("adjusted")).or(all.first());
    let calibration = *adjusted.ok_or("its sensor has no calibration: align the cameras and export them again")?;
    for node in calibration.children().filter(Node::is_element) {
        let name = node.tag_name().name();
        let [value] = if COEFFICIENTS.contains(&name) { [0.0] } else { numbers(node)? };
        if value != 0.0 {
            return Err(format!("its sensor has `{name}` = {value}, which is not supported: calibrate without it"));
        }
    }
    let of = |name: &str| -> Result<f64, String> {
        let found = calibration.children().find(|node| node.has_tag_name(name));
        found.map_or(Ok(0.0), |node| numbers(node).map(|[value]| value))
    };
    let resolution = calibration.children().chain(sensor.children()).find(|node| node.has_tag_name("resolution"));
    let side = |name: &str| resolution.and_then(|node| node.attribute(name)?.trim().parse::<f64>().ok());
    let (Some(width), Some(height)) = (side("width"), side("height")) else {
        return Err(String::from("its sensor has no resolution: export the cameras again"));
    };
    let (f, b1, b2) = (of("f")?, of("b1")?, of("b2")?);
    // From the middle of the picture; the first pixel's centre is at (0.5, 0.5).
    let (cx, cy) = (0.5 * width + of("cx")? - 0.5, 0.5 * height + of("cy")? - 0.5);
    let [k1, k2, k3, k4, p1, p2] = [of("k1")?, of("k2")?, of("k3")?, of("k4")?, of("p1")?, of("p2")?];
    let kind = calibration.attribute("type").or(sensor.attribute("type")).unwrap_or("frame");
    let lens = match kind {
        "frame" if k4 != 0.0 => {
            return Err(format!("its sensor has k4 = {k4}, which OpenCV's model does not have: calibrate without K4"));
        }
        "frame" => Lens::brown([k1, k2, p2, p1, k3]),
        "fisheye" | "equidistant_fisheye" if [p1, p2] == [0.0; 2] => Lens::Fisheye([k1, k2, k3, k4]),
        "fisheye" | "equidistant_fisheye" => {
            return Err(String::from("p1 or p2 of a fisheye is not supported: calibrate without P1 and P2"));
        }
        other => {
            return Err(format!(
                "sensors of type `{other}` are not supported: undistort the photos in Metashape and export their cameras"
            ));
        }
    };
    Ok((values::size(width, height)?, [[f + b1, b2, cx], [0.0, f, cy], [0.0, 0.0, 1.0]], lens))
}
