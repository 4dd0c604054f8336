//! RealityCapture and RealityScan: XMP files beside the pictures, or a CSV file of all cameras.
//!
//! Both have the focal length and the principal point as shares of the larger side of the picture, the principal point from
//! its middle, and the distortion k1 k2 k3 k4 t1 t2. t1 is OpenCV's p2, and t2 its p1.

mod shares;
mod table;
mod xmp;

use super::{notes::Notes, view::ImportedView};
use crate::{failure::Failure, files::Files};
use shares::has_extension;
use std::path::Path;
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
