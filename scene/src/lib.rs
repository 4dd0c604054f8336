//! Captured scenes: scene.json, other programs' calibrations, and their pictures as the core takes them.
//!
//! Nothing here opens a file by itself: all reading goes through [`Files`], so that the command line and the browser
//! read a capture alike, to the last bit.

mod failure;
mod files;
mod import;
mod open;
mod pictures;
mod scene;

pub use failure::Failure;
pub use files::{Disk, Files};
pub use import::{Source, import};
pub use open::open;
pub use pictures::Picture;
pub use scene::{Background, FILE_NAME, Scene, SceneCamera, SceneFrame, VERSION};
