//! Which frames of a manifest go into a clip.

use crate::{
    arguments::List,
    manifest::{FILE_NAME, Manifest, ManifestFrame, gaps},
};
use pcmvs_scene::Failure;
use std::path::Path;

/// The frames of a list in its order, or all frames, of which none may be missing.
pub fn frames<'a>(
    manifest: &'a Manifest,
    list: Option<&List>,
    folder: &Path,
) -> Result<Vec<&'a ManifestFrame>, Failure> {
    let refused = |what: String| Err(Failure::Input(format!("{}: {what}", folder.join(FILE_NAME).display())));
    let frames: Vec<&ManifestFrame> = match list {
        None => manifest.frames.iter().collect(),
        Some(List(list)) => {
            let found = |index: u32| manifest.frames.iter().find(|frame| frame.index == index);
            let missing: Vec<String> = list.iter().filter(|&&i| found(i).is_none()).map(u32::to_string).collect();
            if !missing.is_empty() {
                let missing = missing.join(",");
                return refused(format!(
                    "has no frames {missing}: run `pcmvs reconstruct` for them, or leave them out of --frames"
                ));
            }
            list.iter().filter_map(|&index| found(index)).collect()
        }
    };
    if frames.is_empty() {
        return refused("lists no frames: run `pcmvs reconstruct`".to_owned());
    }
    let indices: Vec<u32> = frames.iter().map(|frame| frame.index).collect();
    if list.is_none()
        && let Some(missing) = gaps(&indices)
    {
        return refused(format!(
            "frames {missing} are missing: run `pcmvs reconstruct` for them, or name the frames of the clip with --frames"
        ));
    }
    if let Some(other) = frames.iter().find(|frame| !frame.url.ends_with(".glb")) {
        let (index, url) = (other.index, &other.url);
        return refused(format!(
            "frame {index} is {url}, and only GLB files can be packed: run `pcmvs reconstruct` for GLB"
        ));
    }
    Ok(frames)
}
