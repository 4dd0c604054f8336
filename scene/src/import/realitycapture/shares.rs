//! What both kinds of files have in common.

use crate::files::Files;
use pcmvs_core::Lens;
use std::path::{Path, PathBuf};

pub fn has_extension(path: &Path, wanted: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
}

pub fn entries_with(files: &dyn Files, folder: &Path, extension: &str) -> Vec<PathBuf> {
    let entries = if files.is_folder(folder) { files.list(folder).unwrap_or_default() } else { Vec::new() };
    entries.into_iter().filter(|path| has_extension(path, extension)).collect()
}

/// A principal point in pixels, where the first pixel's centre is at 0, from its share of the larger side.
pub fn principal(share: f64, larger: f64, side: u32) -> f64 {
    share * larger + 0.5 * f64::from(side) - 0.5
}

/// OpenCV's lens with Brown's coefficients. It has no k4.
pub fn brown([k1, k2, k3, k4, t1, t2]: [f64; 6]) -> Option<Lens> {
    (k4 == 0.0).then(|| Lens::brown([k1, k2, t2, t1, k3]))
}
