//! XMP files that RealityCapture and RealityScan write beside pictures. Rotation is world to camera with x right, y down,
//! z forward, and the position is the camera's centre. The focal length is in 36ths of the picture's larger side.

use super::{
    super::{
        keys::{listed, unread},
        notes::Notes,
        source::{failure, find_picture, picture_size, read_text, without_extension},
        values::to_array,
        view::{ImportedView, rows},
    },
    shares::{brown, entries_with, principal},
};
use crate::{failure::Failure, files::Files};
use glam::{DMat3, DVec3};
use pcmvs_core::{Camera, Lens};
use roxmltree::Document;
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};

/// The namespace of the entries, in every version.
pub const NAMESPACE: &str = "http://www.capturingreality.com/ns/xcr/";
const READ: &[&str] = &[
    "Rotation",
    "Position",
    "FocalLength35mm",
    "PrincipalPointU",
    "PrincipalPointV",
    "Skew",
    "AspectRatio",
    "DistortionModel",
    "DistortionCoeficients",
];
/// How the program came to the calibration, and groups of cameras that share one.
const HARMLESS: &[&str] = &[
    "Version",
    "PosePrior",
    "Coordinates",
    "CalibrationPrior",
    "CalibrationGroup",
    "DistortionGroup",
    "InTexturing",
    "InMeshing",
    "InColoring",
    "Rig",
    "RigInstance",
    "RigPoseIndex",
    "ExportCoordinateSystemType",
];

/// The files of a folder, or of its folder `images`.
pub fn files_of(files: &dyn Files, path: &Path) -> Vec<PathBuf> {
    let of = |folder: &Path| entries_with(files, folder, "xmp");
    let own = of(path);
    if own.is_empty() { of(&path.join("images")) } else { own }
}

/// Reads all files of a folder. One of the files stands for its folder.
pub fn read(files: &dyn Files, path: &Path, notes: &mut Notes) -> Result<Vec<ImportedView>, Failure> {
    let path = if files.is_folder(path) { path } else { path.parent().unwrap_or(Path::new("")) };
    let all = files_of(files, path);
    if all.is_empty() {
        return Err(Failure::Input(format!(
            "{}: contains neither a .csv of camera parameters with its header nor .xmp: name the file, or the folder of the pictures",
            path.display()
        )));
    }
    all.iter().map(|file| view(files, file, notes)).collect()
}

fn view(files: &dyn Files, file: &Path, notes: &mut Notes) -> Result<ImportedView, Failure> {
    let full = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let stem = full.rsplit_once('.').map_or(full.as_str(), |(stem, _)| stem);
    // Some programs add .xmp to the whole name of the picture.
    let name = without_extension(stem).to_owned();
    let wrong = |problem: String| failure(file, &name, &problem);
    let folder = [file.parent().unwrap_or(Path::new("")).to_path_buf()];
    let image = find_picture(files, &folder, &name)
        .ok_or_else(|| wrong(format!("its picture `{name}` is missing: put it beside this file")))?;
    let entries = entries(&read_text(files, file)?).map_err(wrong)?;
    let ignored = unread(&entries, &[READ, HARMLESS], &[]).map_err(wrong)?;
    if !ignored.is_empty() {
        notes.add(format!("ignored of every .xmp: {}", listed(ignored)));
    }
    let size = picture_size(files, &image, &name)?;
    let camera = camera(&entries, size).map_err(wrong)?;
    Ok(ImportedView { name: name.clone(), camera, file: file.to_path_buf(), image, mask: None, time: None })
}

/// The entries of the file, which may be attributes or elements, by name.
fn entries(text: &str) -> Result<Map<String, Value>, String> {
    let document = Document::parse(text).map_err(|e| format!("{e}: correct that line"))?;
    let own = |namespace: Option<&str>| namespace.is_some_and(|name| name.starts_with(NAMESPACE));
    let mut entries = Map::new();
    for node in document.descendants().filter(|node| node.is_element()) {
        let attributes = node.attributes().filter(|attribute| own(attribute.namespace()));
        let mut found: Vec<(&str, &str)> = attributes.map(|attribute| (attribute.name(), attribute.value())).collect();
        if own(node.tag_name().namespace()) {
            found.push((node.tag_name().name(), node.text().unwrap_or_default()));
        }
        for (name, value) in found {
            if entries.insert(name.to_owned(), value.into()).is_some_and(|other| other != value) {
                return Err(format!("`{name}` occurs twice: remove the one that is wrong"));
            }
        }
    }
    Ok(entries)
}

fn numbers<const N: usize>(entries: &Map<String, Value>, name: &str) -> Result<Option<[f64; N]>, String> {
    let Some(text) = entries.get(name).and_then(Value::as_str) else { return Ok(None) };
    let number = |word: &str| match word.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(format!("{name}: `{word}` is not a finite number")),
    };
    let list: Vec<f64> = text.split_whitespace().map(number).collect::<Result<_, _>>()?;
    to_array(&list, name).map(Some)
}

fn camera(entries: &Map<String, Value>, [width, height]: [u32; 2]) -> Result<Camera, String> {
    let missing =
        |name: &str| format!("`{name}` is missing: export the registration with camera poses and calibration");
    let single = |name: &str, otherwise: f64| Ok::<f64, String>(numbers(entries, name)?.map_or(otherwise, |[v]| v));
    let larger = f64::from(width.max(height));
    let [f] = numbers(entries, "FocalLength35mm")?.ok_or_else(|| missing("FocalLength35mm"))?;
    if single("Skew", 0.0)? != 0.0 || single("AspectRatio", 1.0)? != 1.0 {
        return Err(String::from("Skew or AspectRatio is not supported: calibrate without them"));
    }
    let focal = f / 36.0 * larger;
    let k = [
        [focal, 0.0, principal(single("PrincipalPointU", 0.0)?, larger, width)],
        [0.0, focal, principal(single("PrincipalPointV", 0.0)?, larger, height)],
        [0.0, 0.0, 1.0],
    ];
    let r = rows(numbers(entries, "Rotation")?.ok_or_else(|| missing("Rotation"))?);
    let centre = DVec3::from_array(numbers(entries, "Position")?.ok_or_else(|| missing("Position"))?);
    let t = -(DMat3::from_cols_array_2d(&r).transpose() * centre);
    Ok(Camera { width, height, k, lens: lens(entries)?, r, t: t.to_array() })
}

/// The distortion k1 k2 k3 k4 t1 t2. A model that does not have a coefficient writes zero.
fn lens(entries: &Map<String, Value>) -> Result<Lens, String> {
    let coefficients: [f64; 6] = numbers(entries, "DistortionCoeficients")?.unwrap_or([0.0; 6]);
    let model = entries.get("DistortionModel").and_then(Value::as_str).unwrap_or_default();
    let is_brown = ["brown3", "brown4", "brown3t2", "brown4t2"].contains(&model);
    let known = coefficients == [0.0; 6] || is_brown;
    known.then(|| brown(coefficients)).flatten().ok_or_else(|| {
        format!(
            "the distortion model `{model}` with these coefficients is not supported: choose Brown3, with or without \
             tangential distortion, in the settings of the alignment, align again and export"
        )
    })
}
