//! Recognises the program that wrote a calibration.

use super::{colmap, easymocap, formats::Source, json, opencv, opencv_storage, source, transforms};
#[cfg(feature = "formats")]
use super::{further, projects};
use crate::{failure::Failure, files::Files};
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

/// What is recognised, for messages.
#[cfg(feature = "formats")]
pub const KNOWN: &str = "Middlebury's *_par.txt, a COLMAP model (cameras and images, .txt or .bin), transforms.json, \
                         EasyMocap's intri.yml and extri.yml, bundle.out, Metashape's .xml, cameras_sphere.npz, \
                         anipose's .toml, Panoptic's calibration_*.json, MVSNet's *_cam.txt, Kalibr's camchain.yaml, \
                         RealityCapture's .csv or .xmp, Qualisys' .qca.txt, ZJU-MoCap's annots.npy, or OpenCV \
                         calibrations (.yml, .yaml, .json, .xml)";
/// What is recognised, for messages.
#[cfg(not(feature = "formats"))]
pub const KNOWN: &str = "Middlebury's *_par.txt, a COLMAP model (cameras and images, .txt or .bin), transforms.json, \
                         EasyMocap's intri.yml and extri.yml, or OpenCV calibrations (.yml, .yaml, .json)";

/// Most JSON files that are looked into. Folders of poses or keypoints have one per frame.
const MOST_JSON: usize = 100;

/// The program whose calibration a path names. A folder with calibrations of several programs is an error.
pub fn recognise(files: &dyn Files, path: &Path) -> Result<Source, Failure> {
    if !files.is_folder(path) {
        return of_file(files, path);
    }
    let entries = files.list(path).map_err(|e| Failure::unreadable(path, &e))?;
    let mut found = of_folder(files, path, &entries);
    found.dedup_by_key(|(source, _)| *source);
    let wrong = |problem: String| Failure::Input(format!("{}: {problem}", path.display()));
    #[cfg(feature = "formats")]
    if found.is_empty() {
        projects::refuse_folder(files, &entries)?;
    }
    match (found.pop(), &found[..]) {
        (None, _) => Err(wrong(format!("no calibration was recognised: name {KNOWN}, or give its format with --from"))),
        (Some((source, _)), []) => Ok(source),
        (Some((last, _)), others) => {
            let names: Vec<&str> = others.iter().map(|(source, _)| source.name()).chain([last.name()]).collect();
            Err(wrong(format!("there are several calibrations: choose one with --from {}", names.join(" or --from "))))
        }
    }
}

fn of_file(files: &dyn Files, path: &Path) -> Result<Source, Failure> {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    let ends = |ends: &[&str]| ends.iter().any(|end| name.ends_with(end));
    #[cfg(feature = "formats")]
    if let Some(source) = further::of_file(files, path, &name)? {
        return Ok(source);
    }
    if ends(&["_par.txt"]) {
        Ok(Source::Middlebury)
    } else if ["cameras.txt", "cameras.bin", "images.txt", "images.bin"].contains(&name.as_str()) {
        Ok(Source::Colmap)
    } else if easymocap::part_of(path).is_some() {
        Ok(Source::Easymocap)
    } else if ends(&[".yml", ".yaml"]) || ends(&[".xml"]) && opencv_storage::is_xml(files, path) {
        Ok(Source::Opencv)
    } else if ends(&[".json"]) {
        let text = source::read_text(files, path)?;
        let value = json::parse(&text).map_err(|problem| Failure::Input(format!("{}: {problem}", path.display())))?;
        Ok(if value.get("frames").is_some() { Source::Transforms } else { Source::Opencv })
    } else {
        Err(Failure::Input(format!(
            "{}: is not recognised: name {KNOWN}, or give its format with --from",
            path.display()
        )))
    }
}

/// The programs whose calibrations a folder contains, and their paths. The most specific comes first.
pub fn of_folder(files: &dyn Files, folder: &Path, entries: &[PathBuf]) -> Vec<(Source, PathBuf)> {
    let name = |path: &PathBuf| path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    let any = |test: &dyn Fn(&str) -> bool| entries.iter().find(|path| test(&name(path)));
    let mut found = Vec::new();
    if let Some(path) = any(&|name| name.ends_with("_par.txt")) {
        found.push((Source::Middlebury, path.clone()));
    }
    if colmap::model_folders(folder).iter().any(|model| colmap::is_model(files, model)) {
        found.push((Source::Colmap, folder.to_path_buf()));
    }
    if any(&|name| name == "transforms.json" || transforms::is_split(name)).is_some() {
        found.push((Source::Transforms, folder.to_path_buf()));
    }
    #[cfg(feature = "formats")]
    found.extend(further::of_folder(files, folder, entries));
    let parts: BTreeSet<&str> = entries.iter().filter_map(|path| easymocap::part_of(path)).collect();
    if parts.len() == 2 {
        found.push((Source::Easymocap, folder.to_path_buf()));
    }
    // Other programs' files have the same extensions.
    let others: Vec<&PathBuf> = found.iter().map(|(_, path)| path).collect();
    let is_opencv = |path: &&PathBuf| {
        let name = name(path);
        let ends = |end: &str| name.ends_with(end);
        let own = ends(".yml") || ends(".yaml") || ends(".xml") && opencv_storage::is_xml(files, path);
        own && !others.contains(path) && easymocap::part_of(path).is_none()
    };
    if entries.iter().any(|path| is_opencv(&path)) {
        found.push((Source::Opencv, folder.to_path_buf()));
    }
    // Many programs write JSON, so that only what it contains tells.
    let is_json = |path: &&PathBuf| name(path).ends_with(".json") && files.is_file(path);
    let mut json = entries.iter().filter(is_json).take(MOST_JSON);
    if found.is_empty() && json.any(|path| opencv::is_camera_file(files, path)) {
        found.push((Source::Opencv, folder.to_path_buf()));
    }
    found
}
