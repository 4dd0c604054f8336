//! Options that are one of a few names.

use clap::ValueEnum;
use pcmvs_core::Preset;
use pcmvs_scene::SilhouetteFiles;

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Source {
    /// Whichever of the others PATH contains
    Auto,
    Middlebury,
    Colmap,
    Opencv,
    Transforms,
    Easymocap,
    Bundler,
    Metashape,
    Neus,
    /// Also FreeMoCap and Caliscope
    Anipose,
    Panoptic,
    Mvsnet,
    Kalibr,
    /// Also RealityScan
    Realitycapture,
    Qualisys,
    /// ZJU-MoCap
    Zju,
}

impl Source {
    /// The format, or none if it is to be recognised.
    pub const fn source(self) -> Option<pcmvs_scene::Source> {
        match self {
            Self::Auto => None,
            Self::Middlebury => Some(pcmvs_scene::Source::Middlebury),
            Self::Colmap => Some(pcmvs_scene::Source::Colmap),
            Self::Opencv => Some(pcmvs_scene::Source::Opencv),
            Self::Transforms => Some(pcmvs_scene::Source::Transforms),
            Self::Easymocap => Some(pcmvs_scene::Source::Easymocap),
            Self::Bundler => Some(pcmvs_scene::Source::Bundler),
            Self::Metashape => Some(pcmvs_scene::Source::Metashape),
            Self::Neus => Some(pcmvs_scene::Source::Neus),
            Self::Anipose => Some(pcmvs_scene::Source::Anipose),
            Self::Panoptic => Some(pcmvs_scene::Source::Panoptic),
            Self::Mvsnet => Some(pcmvs_scene::Source::Mvsnet),
            Self::Kalibr => Some(pcmvs_scene::Source::Kalibr),
            Self::Realitycapture => Some(pcmvs_scene::Source::Realitycapture),
            Self::Qualisys => Some(pcmvs_scene::Source::Qualisys),
            Self::Zju => Some(pcmvs_scene::Source::Zju),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MaskSource {
    File,
    Chroma,
    Plates,
}

impl MaskSource {
    /// The files that it reads.
    pub const fn files(self) -> SilhouetteFiles {
        match self {
            Self::File => SilhouetteFiles::Masks,
            Self::Chroma => SilhouetteFiles::None,
            Self::Plates => SilhouetteFiles::Plates,
        }
    }

    pub const fn name(self) -> &'static str {
        match self {
            Self::File => "file",
            Self::Chroma => "chroma",
            Self::Plates => "plates",
        }
    }
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
    /// Best measured quality
    Default,
    /// The method as the paper describes it
    Paper,
    /// The mesh of the visual hull
    Hull,
    /// Fast and coarse
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

    /// Whether frames are averaged with their neighbours.
    pub const fn averages(self) -> bool {
        matches!(self, Self::Default | Self::Hull)
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
