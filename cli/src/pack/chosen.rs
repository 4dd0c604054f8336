//! Which frames of a manifest go into a clip.

use crate::{
    arguments::List,
    manifest::{FILE_NAME, Manifest, ManifestFrame},
};
use pcmvs_scene::Failure;
use std::path::Path;

/// Number of gaps that a message names.
const NAMED: usize = 8;

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
    let gaps = if list.is_none() { gaps(&frames) } else { Vec::new() };
    if !gaps.is_empty() {
        let more = if gaps.len() > NAMED { " and more" } else { "" };
        let named = gaps[..gaps.len().min(NAMED)].join(",");
        return refused(format!(
            "frames {named}{more} are missing: run `pcmvs reconstruct` for them, or name the frames of the clip with --frames"
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

/// The missing indices, as single ones or ranges, if frames follow each other by their smallest step.
fn gaps(frames: &[&ManifestFrame]) -> Vec<String> {
    let pairs = || frames.windows(2).map(|pair| (pair[0].index, pair[1].index));
    let step = pairs().map(|(a, b)| b.saturating_sub(a)).min().unwrap_or(1);
    let gap = |(a, b): (u32, u32)| {
        let (low, high) = (a.checked_add(step)?, b.checked_sub(step)?);
        (low <= high).then(|| if low == high { low.to_string() } else { format!("{low}..{high}") })
    };
    pairs().filter_map(gap).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_that_are_missing_between_others_are_named() {
        let gaps = |indices: &[u32]| {
            let frame =
                |&index: &u32| ManifestFrame { index, time: 0.0, url: String::new(), bytes: 0, sha256: String::new() };
            let frames: Vec<ManifestFrame> = indices.iter().map(frame).collect();
            gaps(&frames.iter().collect::<Vec<_>>())
        };
        assert!(gaps(&[3, 4, 5]).is_empty() && gaps(&[0, 10, 20]).is_empty() && gaps(&[7]).is_empty());
        assert_eq!(gaps(&[0, 1, 3, 4, 9]), ["2", "5..8"]);
        assert_eq!(gaps(&[0, 5, 15, 30]), ["10", "20..25"]);
    }
}
