//! Recognises the formats of the feature `formats`.

use super::{
    bundler, formats::Source, json, kalibr, mvsnet, neus, panoptic, projects, qualisys, realitycapture,
    source::read_text, zju,
};
use crate::{failure::Failure, files::Files};
use std::path::{Path, PathBuf};

/// The format of a file, if it is one of these. `name` is in lower case.
pub fn of_file(files: &dyn Files, path: &Path, name: &str) -> Result<Option<Source>, Failure> {
    let has = |words: &[&str]| read_text(files, path).map(|text| words.iter().all(|word| text.contains(word)));
    let ends = |end: &str| name.ends_with(end);
    projects::refuse(path)?;
    Ok(if ends(".out") {
        Some(Source::Bundler)
    } else if ends(".npz") {
        Some(Source::Neus)
    } else if ends(".npy") {
        Some(Source::Zju)
    } else if ends(mvsnet::END) {
        Some(Source::Mvsnet)
    } else if ends(".toml") {
        has(&["matrix", "distortions"])?.then_some(Source::Anipose)
    } else if ends(".csv") {
        realitycapture::is_csv(&read_text(files, path)?).then_some(Source::Realitycapture)
    } else if ends(".xml") {
        let text = read_text(files, path)?;
        let is_metashape = ["<document", "<chunk", "<sensors"].iter().all(|word| text.contains(word));
        let other = || qualisys::is_calibration(&text).then_some(Source::Qualisys);
        is_metashape.then_some(Source::Metashape).or_else(other)
    } else if ends(".txt") || ends(".qca") {
        // Other programs' files may be in another encoding.
        read_text(files, path).is_ok_and(|text| qualisys::is_calibration(&text)).then_some(Source::Qualisys)
    } else if ends(".xmp") {
        has(&[realitycapture::NAMESPACE])?.then_some(Source::Realitycapture)
    } else if ends(".yml") || ends(".yaml") {
        has(&[kalibr::CHAIN])?.then_some(Source::Kalibr)
    } else if ends(".json") {
        let is_panoptic = |text: String| json::parse(&text).is_ok_and(|value| panoptic::is_panoptic(&value));
        read_text(files, path).map(is_panoptic)?.then_some(Source::Panoptic)
    } else {
        None
    })
}

/// The formats that a folder contains, and their paths.
pub fn of_folder(files: &dyn Files, folder: &Path, entries: &[PathBuf]) -> Vec<(Source, PathBuf)> {
    let mut found = Vec::new();
    if let Some(file) = bundler::file(files, folder) {
        found.push((Source::Bundler, file));
    }
    if !mvsnet::files_of(files, folder).is_empty() {
        found.push((Source::Mvsnet, folder.to_path_buf()));
    }
    if neus::FILES.iter().any(|name| files.is_file(&folder.join(name))) {
        found.push((Source::Neus, folder.to_path_buf()));
    }
    if files.is_file(&folder.join(zju::FILE)) {
        found.push((Source::Zju, folder.to_path_buf()));
    }
    // Cameras write XMP files, too.
    let xmp = realitycapture::xmp_files(files, folder);
    if xmp.iter().any(|path| matches!(of_file(files, path, ".xmp"), Ok(Some(_)))) {
        found.push((Source::Realitycapture, folder.to_path_buf()));
    }
    for path in entries.iter().filter(|path| files.is_file(path)) {
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
        let looked_into = [".csv", ".toml", ".xml", ".yml", ".yaml"].iter().any(|end| name.ends_with(end))
            || qualisys::is_usual_name(&name)
            || name.starts_with("calibration") && name.ends_with(".json");
        if looked_into && let Ok(Some(source)) = of_file(files, path, &name) {
            found.push((source, path.clone()));
        }
    }
    found
}

/// The file that a path stands for, for a format that is one file: itself, or the only one of a folder.
pub fn only_file(files: &dyn Files, source: Source, path: &Path) -> Result<PathBuf, Failure> {
    let is_one_file =
        matches!(source, Source::Metashape | Source::Anipose | Source::Panoptic | Source::Kalibr | Source::Qualisys);
    if !is_one_file || !files.is_folder(path) {
        return Ok(path.to_path_buf());
    }
    let entries = files.list(path).map_err(|e| Failure::unreadable(path, &e))?;
    let found: Vec<PathBuf> =
        of_folder(files, path, &entries).into_iter().filter(|(of, _)| *of == source).map(|(_, file)| file).collect();
    if found.is_empty() {
        projects::refuse_folder(files, &entries)?;
    }
    match &found[..] {
        [file] => Ok(file.clone()),
        _ => Err(Failure::Input(format!(
            "{}: contains {} files of the format {}: name the file itself",
            path.display(),
            if found.is_empty() { "no" } else { "several" },
            source.name()
        ))),
    }
}
