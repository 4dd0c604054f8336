//! Files that studios have beside their calibrations and that are not read: projects of other programs, and formats that do
//! not say enough. A message tells what to export instead.

use crate::{failure::Failure, files::Files};
use std::path::{Path, PathBuf};

const OF_METASHAPE: &str = "export its cameras as XML (File, Export, Export Cameras) and name that file";
/// Ends of file names in lower case, what such a file is, and what to do.
const PROJECTS: [(&str, &str, &str); 6] = [
    (".psx", "a project of Metashape", OF_METASHAPE),
    (".psz", "a project of Metashape", OF_METASHAPE),
    (".rcproj", "a project of RealityCapture", "export the registration as XMP files or as a CSV of camera parameters"),
    ("database.db", "COLMAP's database, which has no poses", "name the folder of the model, such as sparse/0"),
    (".nvm", "a model of VisualSFM", "open it in COLMAP and export it as a COLMAP or Bundler model"),
    ("poses_bounds.npy", "LLFF's poses, which have no distortion", "import the COLMAP model that they were made of"),
];

/// Refuses such a file by its name.
pub fn refuse(path: &Path) -> Result<(), Failure> {
    let name = name(path);
    match PROJECTS.iter().find(|(end, ..)| name.ends_with(end)) {
        Some((_, what, remedy)) => Err(Failure::Input(format!("{}: is {what}: {remedy}", path.display()))),
        None => Ok(()),
    }
}

/// Refuses a folder that contains such a file, and nothing that is read.
pub fn refuse_folder(files: &dyn Files, entries: &[PathBuf]) -> Result<(), Failure> {
    for path in entries.iter().filter(|path| files.is_file(path)) {
        refuse(path)?;
    }
    Ok(())
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().to_lowercase()
}
