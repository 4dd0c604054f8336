//! RealityCapture and RealityScan: XMP files beside the pictures, or a CSV file of all cameras.
//!
//! Both have the focal length and the principal point as shares of the larger side of the picture, the principal point from
//! its middle, and the distortion k1 k2 k3 k4 t1 t2. t1 is OpenCV's p2, and t2 its p1.

mod table;
mod xmp;

use super::{notes::Notes, view::ImportedView};
use crate::{failure::Failure, files::Files};
use pcmvs_core::Lens;
use std::path::{Path, PathBuf};
pub use table::is_csv;
pub use xmp::{NAMESPACE, files_of as xmp_files};

/// Reads a CSV file, or a folder with one, or a folder with XMP files, for which one of them stands, too.
pub fn read(files: &dyn Files, path: &Path, notes: &mut Notes) -> Result<Vec<ImportedView>, Failure> {
    let wrong = |problem: &str| Failure::Input(format!("{}: {problem}", path.display()));
    if !files.is_folder(path) {
        return if has_extension(path, "csv") {
            table::read(files, path, notes)
        } else {
            xmp::read(files, path, notes)
        };
    }
    let tables = table::files_of(files, path);
    match &tables[..] {
        [] => xmp::read(files, path, notes),
        [file] if xmp_files(files, path).is_empty() => table::read(files, file, notes),
        [_] => Err(wrong("contains cameras in .csv and in .xmp: name the .csv, or one of the .xmp for all of them")),
        _ => Err(wrong("contains several .csv with cameras: name the file itself")),
    }
}

fn has_extension(path: &Path, wanted: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
}

fn entries_with(files: &dyn Files, folder: &Path, extension: &str) -> Vec<PathBuf> {
    let entries = if files.is_folder(folder) { files.list(folder).unwrap_or_default() } else { Vec::new() };
    entries.into_iter().filter(|path| has_extension(path, extension)).collect()
}

/// A principal point in pixels, where the first pixel's centre is at 0, from its share of the larger side.
fn principal(share: f64, larger: f64, side: u32) -> f64 {
    share * larger + 0.5 * f64::from(side) - 0.5
}

/// OpenCV's lens with Brown's coefficients. It has no k4.
fn brown([k1, k2, k3, k4, t1, t2]: [f64; 6]) -> Option<Lens> {
    (k4 == 0.0).then(|| Lens::brown([k1, k2, t2, t1, k3]))
}
