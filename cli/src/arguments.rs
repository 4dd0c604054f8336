//! The command line's grammar.

use clap::{Args, Parser, Subcommand, ValueEnum};
use pcmvs_core::Preset;
use std::{num::NonZeroUsize, path::PathBuf};

/// Multi-view stereo for free-viewpoint video.
#[derive(Debug, Parser)]
#[command(name = "pcmvs", version, about, after_help = EXIT_STATUS)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

const EXIT_STATUS: &str = "Exit status: 0 ok, 2 bad usage or input, 3 cancelled, 1 anything else.";

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Make a closed, coloured mesh of every frame of a scene
    ///
    /// OUT gets frame_FFFF.glb (or .ply), sequence.json and report.json. Files appear under their final names only when
    /// complete; run again, it continues with the frames that are missing or whose inputs have changed.
    #[command(after_help = EXIT_STATUS)]
    Reconstruct(Reconstruct),
    /// Convert a calibrated capture to a scene
    ///
    /// Writes SCENE/scene.json and copies the pictures to SCENE/images, the masks to SCENE/masks.
    #[command(after_help = EXIT_STATUS)]
    Import(Import),
}

#[derive(Debug, Args)]
pub struct Reconstruct {
    /// Folder with scene.json, or that file
    pub scene: PathBuf,
    /// Folder for the results
    #[arg(short, long = "output", value_name = "OUT")]
    pub output: PathBuf,
    /// Frames to make, as 0,3,10..20 (20 is included) [default: all]
    #[arg(long, value_name = "LIST", value_parser = parse_list)]
    pub frames: Option<List>,
    /// Cameras to use, by their place in scene.json, as 0,2,4..8 (8 is included) [default: all]
    #[arg(long, value_name = "LIST", value_parser = parse_list)]
    pub cameras: Option<List>,
    /// Set of parameters
    #[arg(long, value_enum, default_value_t = PresetName::Default)]
    pub preset: PresetName,
    /// A parameter that differs from the preset's: its path in the library's `Params` and its value as JSON. Not part of
    /// the stable command line: the parameters may change with any version
    #[arg(long = "set", value_name = "KEY=VALUE", hide = true)]
    pub overrides: Vec<String>,
    /// Where silhouettes come from: mask files, or the backdrop's colour in scene.json
    #[arg(long, value_enum, default_value_t = MaskSource::File)]
    pub masks: MaskSource,
    /// Threads over frames and views; the result does not depend on it [default: all cores]
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Most memory that a frame may need, in MiB, beside its pictures: one that needs more fails at once
    #[arg(long, value_name = "MIB")]
    pub max_memory: Option<u64>,
    /// Format of the meshes
    #[arg(long, value_enum, default_value_t = Format::Glb)]
    pub format: Format,
    /// Also write each stage's cloud or mesh as OUT/stages/frame_FFFF/*.ply
    #[arg(long)]
    pub stages: bool,
}

#[derive(Debug, Args)]
pub struct Import {
    /// What PATH is
    #[arg(long, value_enum)]
    pub from: Source,
    /// Middlebury: folder with *_par.txt; COLMAP: folder with cameras.txt and images.txt; OpenCV: YAML or JSON file, or a folder of
    /// one such file a camera; transforms: transforms.json or its folder
    pub path: PathBuf,
    /// Folder for the scene
    #[arg(short, long = "output", value_name = "SCENE")]
    pub output: PathBuf,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Source {
    Middlebury,
    Colmap,
    Opencv,
    Transforms,
}

impl Source {
    pub const fn source(self) -> pcmvs_scene::Source {
        match self {
            Self::Middlebury => pcmvs_scene::Source::Middlebury,
            Self::Colmap => pcmvs_scene::Source::Colmap,
            Self::Opencv => pcmvs_scene::Source::Opencv,
            Self::Transforms => pcmvs_scene::Source::Transforms,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MaskSource {
    File,
    Chroma,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    Glb,
    Ply,
}

impl Format {
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Glb => "glb",
            Self::Ply => "ply",
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PresetName {
    /// What measures best
    Default,
    /// The paper's method as printed
    Paper,
    /// The visual hull's own mesh
    Hull,
    /// Quick and coarse
    Preview,
}

impl PresetName {
    pub const fn preset(self) -> Preset {
        match self {
            Self::Default => Preset::Default,
            Self::Paper => Preset::Paper,
            Self::Hull => Preset::Hull,
            Self::Preview => Preset::Preview,
        }
    }

    pub const fn name(self) -> &'static str {
        match self {
            Self::Default => "default",
            Self::Paper => "paper",
            Self::Hull => "hull",
            Self::Preview => "preview",
        }
    }
}

/// Numbers and inclusive ranges, in the order given.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct List(pub Vec<u32>);

/// More numbers than any capture has frames: a slip of the finger, not a list.
const LONGEST_LIST: u32 = 10_000_000;

fn parse_list(text: &str) -> Result<List, String> {
    let mut numbers = Vec::new();
    for part in text.split(',') {
        let number = |s: &str| {
            s.trim().parse::<u32>().map_err(|_| format!("`{part}` is neither a number nor a range such as 10..20"))
        };
        let (first, last) = match part.split_once("..") {
            Some((first, last)) => (number(first)?, number(last)?),
            None => (number(part)?, number(part)?),
        };
        if first > last || last - first > LONGEST_LIST {
            return Err(format!("`{part}` runs backwards or is far too long"));
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
