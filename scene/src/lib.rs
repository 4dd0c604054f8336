//! Captured scenes: scene.json, calibrations of other programs, and pictures as the core takes them.
//!
//! All files are read through [`Files`], so that the command line, Python and the browser read a capture in the same way, bit
//! for bit.

#[cfg(feature = "meshopt")]
pub mod compress;
mod document;
mod explain;
mod failure;
mod files;
mod import;
mod inputs;
mod lens;
mod levels;
mod load;
mod open;
pub mod output;
mod paths;
mod pattern;
mod pictures;
mod png_file;
mod scene;
mod take;
mod text;
#[cfg(feature = "threads")]
mod threads;

pub use document::Document;
pub use failure::Failure;
pub use files::{Disk, Files};
pub use import::{Imported, Source, import, is_picture, is_video, recognise};
pub use inputs::{DecodedView, FrameFiles, MissingFile, NoVideos, Pictures, Silhouettes, UndecodedViews, Videos};
pub use lens::LensModel;
pub use open::open;
pub use paths::written as written_path;
pub use pictures::Picture;
pub use scene::{Background, FILE_NAME, Scene, SceneCamera, SceneFrame, SilhouetteFiles, VERSION};
#[cfg(feature = "threads")]
pub use threads::{Thread, Threads, thread_count};
