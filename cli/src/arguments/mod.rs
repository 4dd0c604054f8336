//! The arguments of the command line: its commands and their options.

mod choices;
mod values;

pub use choices::{Format, MaskSource, PresetName, Source};
pub use values::{FPS_RANGE, List, Quality};

use clap::{Args, Parser, Subcommand};
use std::{num::NonZeroUsize, path::PathBuf};
use values::{parse_fps, parse_list, parse_quality, parse_seconds, parse_texture_size};

/// Multi-view stereo for free-viewpoint video.
#[derive(Debug, Parser)]
#[command(name = "pcmvs", version, about, after_help = EXIT_STATUS)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

const EXIT_STATUS: &str = "Exit status: 0 success, 1 other errors, 2 wrong usage or input, 3 cancelled.";
const CHECK_STATUS: &str =
    "Exit status: 0 nothing is doubtful, 4 something is, 1 other errors, 2 wrong usage or input, 3 cancelled.";

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Reconstruct a closed, coloured mesh for every frame of a scene
    ///
    /// Writes one mesh per frame to OUT, as frame_FFFF.glb (or .ply), with sequence.json and report.json. A file appears
    /// under its final name only when it is complete. A second run makes only the frames that are missing or whose inputs
    /// have changed.
    #[command(after_help = EXIT_STATUS)]
    Reconstruct(Reconstruct),
    /// Check how well the cameras' calibration fits their pictures
    ///
    /// Prints for each camera how well its silhouette fits the hull of all silhouettes, how far its contour and its matches
    /// miss those of the other cameras, its brightness, and by how many frames it is late. Names cameras that were moved or are
    /// out of step, and pictures that are exchanged.
    #[command(after_help = CHECK_STATUS)]
    Check(Check),
    /// Correct the cameras' calibration by their pictures
    ///
    /// Writes SCENE2/scene.json with corrected cameras. Its pictures and masks are those of SCENE. Nothing is written if the
    /// correction does not agree better with matches that it was not made from.
    #[command(after_help = EXIT_STATUS)]
    Refine(Refine),
    /// Convert a calibrated capture to a scene
    ///
    /// Writes SCENE/scene.json, and copies the pictures to SCENE/images and the masks to SCENE/masks.
    #[command(after_help = EXIT_STATUS)]
    Import(Import),
    /// Join the parts of a clip that several runs made, such as those of several machines
    ///
    /// Every part is a result folder of `pcmvs reconstruct` for some frames of the same scene. OUT gets what a single run would
    /// have written. Nothing is left out without a word: a frame that is missing, has failed, has changed, or was made with
    /// other settings is an error that names it.
    #[command(after_help = EXIT_STATUS)]
    Join(Join),
    /// Pack the frames of a clip into one GLB file that ordinary players play
    ///
    /// Reads the frames that OUT/sequence.json lists, in any form. Each of them has its node, and an animation shows one after
    /// the other. Nothing is written if a frame is missing, or of another version or form than the others.
    #[command(after_help = EXIT_STATUS)]
    Pack(Pack),
}

#[derive(Debug, Args)]
pub struct Reconstruct {
    /// Folder that contains scene.json, or the path of scene.json
    pub scene: PathBuf,
    /// Folder for the results
    #[arg(short, long = "output", value_name = "OUT")]
    pub output: PathBuf,
    /// Frames to reconstruct, such as 0,3,10..20 (20 is included) [default: all]
    #[arg(long, value_name = "LIST", value_parser = parse_list)]
    pub frames: Option<List>,
    /// Cameras to use, by their position in scene.json, such as 0,2,4..8 (8 is included) [default: all]
    #[arg(long, value_name = "LIST", value_parser = parse_list)]
    pub cameras: Option<List>,
    /// Set of parameters
    #[arg(long, value_enum, default_value_t = PresetName::Default)]
    pub preset: PresetName,
    /// Overrides one parameter of the preset, given by its path in the library's `Params` and its value as JSON. Not part
    /// of the stable command line, because the parameters may change with any version
    #[arg(long = "set", value_name = "KEY=VALUE", hide = true)]
    pub overrides: Vec<String>,
    #[command(flatten)]
    pub common: Common,
    /// First correct the calibration by the pictures, as `pcmvs refine` does
    #[arg(long)]
    pub refine: bool,
    /// Make every frame by itself. Without this, the mesh of a frame is averaged with those of the frames before and after it,
    /// so that surfaces and colours are steady in time; with --frames these are made besides, and not written. The presets
    /// `paper` and `preview` never average
    #[arg(long)]
    pub alone: bool,
    /// Memory limit per frame in MiB, without its pictures. A frame that needs more fails before it starts
    #[arg(long, value_name = "MIB")]
    pub max_memory: Option<u64>,
    /// Treat warnings as errors: a frame that has any fails, and its mesh is not written
    #[arg(long)]
    pub strict: bool,
    /// Format of the meshes
    #[arg(long, value_enum, default_value_t = Format::Glb)]
    pub format: Format,
    /// Reduce the meshes to at most N triangles. More remain if fewer would move the surface by more than 2 pixels, with a
    /// warning. Only for GLB
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(4..))]
    pub faces: Option<u32>,
    /// Give the meshes a texture of SIZE x SIZE texels instead of colours per vertex. Without SIZE it is as large as the
    /// photographs' detail needs. Only for GLB
    #[arg(long, value_name = "SIZE", num_args = 0..=1, require_equals = true, value_parser = parse_texture_size)]
    pub texture: Option<Option<u32>>,
    /// Compress the meshes to about an eighth: positions and colours with fewer bits, without normals. Players need
    /// EXT_meshopt_compression and KHR_mesh_quantization. Only for GLB
    #[arg(long)]
    pub compress: bool,
    /// Turn the meshes upright in glTF's frame, in which +y is up, by the upward direction in scene.json. Without it they
    /// are in the scene's frame. Only for GLB
    #[arg(long)]
    pub upright: bool,
    /// Also write the point cloud or mesh of each stage to OUT/stages/frame_FFFF/*.ply
    #[arg(long)]
    pub stages: bool,
}

#[derive(Debug, Args)]
pub struct Check {
    /// Folder that contains scene.json, or the path of scene.json
    pub scene: PathBuf,
    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub evidence: Evidence,
    /// Cameras to use, by their position in scene.json, such as 0,2,4..8 (8 is included) [default: all]
    #[arg(long, value_name = "LIST", value_parser = parse_list)]
    pub cameras: Option<List>,
}

#[derive(Debug, Args)]
pub struct Refine {
    /// Folder that contains scene.json, or the path of scene.json
    pub scene: PathBuf,
    /// Folder of the new scene
    #[arg(short, long = "output", value_name = "SCENE2")]
    pub output: PathBuf,
    #[command(flatten)]
    pub evidence: Evidence,
    /// Also correct focal lengths and principal points
    #[arg(long)]
    pub intrinsics: bool,
}

/// What a calibration is judged by.
#[derive(Debug, Args)]
pub struct Evidence {
    /// Frames to use together, such as 0,3,10..20 (20 is included). More than a few take long and add little [default: up to
    /// 4, evenly over the scene]
    #[arg(long, value_name = "LIST", value_parser = parse_list)]
    pub frames: Option<List>,
    #[command(flatten)]
    pub common: Common,
}

/// How pictures are read and worked on.
#[derive(Debug, Args)]
pub struct Common {
    /// Source of the silhouettes: mask files (without one, the alpha channel of the picture), the backdrop's colours in
    /// scene.json, or its clean plates, the pictures of the empty set
    #[arg(long, value_enum, default_value_t = MaskSource::File)]
    pub masks: MaskSource,
    /// Number of threads. It does not change the result [default: all cores]
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
}

#[derive(Debug, Args)]
pub struct Import {
    /// Format of PATH
    #[arg(long, value_enum)]
    pub from: Source,
    /// Middlebury: folder with *_par.txt. COLMAP: folder with cameras and images, .txt or .bin, or a project with that in
    /// sparse/0. OpenCV: YAML, JSON or XML file, or a folder with one such file per camera, or with those of stereo pairs.
    /// transforms: transforms.json or its folder. EasyMocap: folder with intri.yml and extri.yml. Bundler: bundle.out with
    /// list.txt, or their folder. Metashape: XML of cameras. NeuS: cameras_sphere.npz or its folder. anipose: TOML file.
    /// Panoptic: JSON file. MVSNet: folder with cams/*_cam.txt. Kalibr: camchain.yaml. RealityCapture: CSV of camera parameters,
    /// or folder with pictures and their .xmp. Qualisys: .qca.txt or XML of a calibration. ZJU: annots.npy or its folder
    pub path: PathBuf,
    /// Folder of the new scene
    #[arg(short, long = "output", value_name = "SCENE")]
    pub output: PathBuf,
}

#[derive(Debug, Args)]
pub struct Join {
    /// Result folders of `pcmvs reconstruct`
    #[arg(value_name = "PART", required = true)]
    pub parts: Vec<PathBuf>,
    /// Folder for the clip
    #[arg(short, long = "output", value_name = "OUT")]
    pub output: PathBuf,
    /// Frames that the clip must have, such as 0..299 (299 is included) [default: those of the parts, without a gap]
    #[arg(long, value_name = "LIST", value_parser = parse_list)]
    pub frames: Option<List>,
}

#[derive(Debug, Args)]
pub struct Pack {
    /// Folder with sequence.json and the frames, as `pcmvs reconstruct` makes it
    #[arg(value_name = "OUT")]
    pub folder: PathBuf,
    /// The file of the clip; with --manifest, the folder to publish
    #[arg(short, long = "output", value_name = "CLIP.glb")]
    pub output: PathBuf,
    /// Frames per second [default: those of sequence.json]
    #[arg(long, value_name = "N", value_parser = parse_fps)]
    pub fps: Option<f64>,
    /// Frames to pack, in this order, such as 0,3,10..20 (20 is included) [default: all]
    #[arg(long, value_name = "LIST", value_parser = parse_list)]
    pub frames: Option<List>,
    /// Also animate KHR_node_visibility, for players that know it and KHR_animation_pointer. They need not draw hidden frames
    #[arg(long)]
    pub visibility: bool,
    /// Write a folder to publish instead of one file: packed clips, and a sequence.json that lists them. OUT is the quality
    /// `full`
    #[arg(long)]
    pub manifest: bool,
    /// Another quality of the same frames, such as web=OUT_WEB or mobile=OUT_MOBILE. May be given several times, the best first
    #[arg(long = "quality", value_name = "NAME=OUT", value_parser = parse_quality, requires = "manifest")]
    pub qualities: Vec<Quality>,
    /// Divide every quality into files of about this many seconds [default: one file]
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, requires = "manifest")]
    pub segment: Option<f64>,
    /// Sound of the clip, which is copied to the folder
    #[arg(long, value_name = "FILE", requires = "manifest")]
    pub audio: Option<PathBuf>,
    /// Picture to show before the clip plays, which is copied to the folder
    #[arg(long, value_name = "FILE", requires = "manifest")]
    pub poster: Option<PathBuf>,
}
