//! Options with values of their own, and how they are read.

use pcmvs_core::texture::SIZES as TEXTURE_SIZES;
use std::{ops::RangeInclusive, path::PathBuf};

pub(super) fn parse_texture_size(text: &str) -> Result<u32, String> {
    let [smallest, largest] = TEXTURE_SIZES;
    let size = text.parse().ok().filter(|size| (smallest..=largest).contains(size));
    size.ok_or_else(|| format!("`{text}` is no size of a texture: choose {smallest} to {largest}"))
}

/// Frames per second that a clip can have, so that single precision tells its moments apart.
pub const FPS_RANGE: RangeInclusive<f64> = 0.001..=10_000.0;

pub(super) fn parse_fps(text: &str) -> Result<f64, String> {
    let fps = text.parse().ok().filter(|fps| FPS_RANGE.contains(fps));
    let (low, high) = (FPS_RANGE.start(), FPS_RANGE.end());
    fps.ok_or_else(|| format!("`{text}` is no number of frames per second: choose {low} to {high}"))
}

/// A quality of a clip to publish.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Quality {
    /// The beginning of its files' names.
    pub name: String,
    pub folder: PathBuf,
}

impl Quality {
    /// Name of the quality that `OUT` is.
    pub const BEST: &str = "full";
}

pub(super) fn parse_quality(text: &str) -> Result<Quality, String> {
    let (name, folder) =
        text.split_once('=').ok_or_else(|| format!("`{text}` is not a name and a folder: web=OUT_WEB"))?;
    let is_safe = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    if name.is_empty() || !name.chars().all(is_safe) {
        return Err(format!("`{name}` is no name of a quality: use small letters, digits and hyphens"));
    }
    Ok(Quality { name: name.to_owned(), folder: folder.into() })
}

pub(super) fn parse_seconds(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|&seconds: &f64| seconds > 0.0 && seconds.is_finite());
    seconds.ok_or_else(|| format!("`{text}` is no number of seconds, such as 2 or 0.5"))
}

/// Numbers and inclusive ranges, in the order given.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct List(pub Vec<u32>);

/// A longer range is a typing error, because no capture has as many frames.
const MAX_LIST: u32 = 10_000_000;

pub(super) fn parse_list(text: &str) -> Result<List, String> {
    let mut numbers = Vec::new();
    for part in text.split(',') {
        let number = |s: &str| {
            s.trim().parse::<u32>().map_err(|_| format!("`{part}` is neither a number nor a range such as 10..20"))
        };
        let (first, last) = match part.split_once("..") {
            Some((first, last)) => (number(first)?, number(last)?),
            None => (number(part)?, number(part)?),
        };
        if first > last || last - first > MAX_LIST {
            return Err(format!("`{part}` runs backwards or is too long"));
        }
        numbers.extend(first..=last);
    }
    let mut sorted = numbers.clone();
    sorted.sort_unstable();
    match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(format!("{} is listed twice", pair[0])),
        None => Ok(List(numbers)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_hold_numbers_and_inclusive_ranges() {
        assert_eq!(parse_list("0,3,10..12"), Ok(List(vec![0, 3, 10, 11, 12])));
        assert_eq!(parse_list("7"), Ok(List(vec![7])));
        for wrong in ["", "a", "1,,2", "3..1", "-1", "1..", "0,0", "2..4,3", "0..4294967295"] {
            assert!(parse_list(wrong).is_err(), "{wrong}");
        }
    }
}
