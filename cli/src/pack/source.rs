//! The qualities of a clip that are to be published, and which of their frames.

use super::chosen;
use crate::{
    arguments::{List, Pack, Quality},
    manifest::{FILE_NAME, Manifest, ManifestFrame},
};
use pcmvs_scene::Failure;
use std::path::Path;

/// A quality to publish: its frames' folder, and what is in it.
pub struct Source<'a> {
    pub name: &'a str,
    pub folder: &'a Path,
    pub manifest: Manifest,
}

impl<'a> Source<'a> {
    /// Reads the manifests of all qualities, that of OUT first.
    pub fn read_all(options: &'a Pack) -> Result<Vec<Self>, Failure> {
        let best = (Quality::BEST, options.folder.as_path());
        let given = options.qualities.iter().map(|Quality { name, folder }| (name.as_str(), folder.as_path()));
        let mut sources: Vec<Self> = Vec::new();
        for (name, folder) in [best].into_iter().chain(given) {
            if sources.iter().any(|source| source.name == name) {
                return Err(Failure::Input(format!("--quality: `{name}` is given twice: choose another name")));
            }
            sources.push(Source { name, folder, manifest: Manifest::read(folder)? });
        }
        Ok(sources)
    }

    /// The frames of each quality, which must be the same.
    pub fn choose<'b>(sources: &'b [Self], list: Option<&List>) -> Result<Vec<Vec<&'b ManifestFrame>>, Failure> {
        let chosen = sources.iter().map(|source| chosen::frames(&source.manifest, list, source.folder));
        let chosen = chosen.collect::<Result<Vec<Vec<&ManifestFrame>>, Failure>>()?;
        for (source, frames) in sources.iter().zip(&chosen).skip(1) {
            check_alike(&sources[0], &chosen[0], source, frames)?;
        }
        Ok(chosen)
    }
}

/// Refuses a quality that does not show the same as the best one.
fn check_alike(
    best: &Source,
    expected: &[&ManifestFrame],
    other: &Source,
    frames: &[&ManifestFrame],
) -> Result<(), Failure> {
    let indices = |frames: &[&ManifestFrame]| frames.iter().map(|frame| frame.index).collect::<Vec<_>>();
    let frame_of_reference = |manifest: &Manifest| (manifest.up, manifest.rotation);
    let what = if indices(frames) != indices(expected) {
        "other frames"
    } else if other.manifest.fps != best.manifest.fps {
        "another `fps`"
    } else if frame_of_reference(&other.manifest) != frame_of_reference(&best.manifest) {
        "another `up` or `rotation`"
    } else {
        return Ok(());
    };
    Err(Failure::Input(format!(
        "{}: quality {} has {what} than {}: run `pcmvs reconstruct` for both with the same scene, --frames and --upright",
        other.folder.join(FILE_NAME).display(),
        other.name,
        best.folder.join(FILE_NAME).display()
    )))
}
