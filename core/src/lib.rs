//! PCMVS: multi-view stereo for free-viewpoint video.
#![no_std]

extern crate alloc;

pub mod camera;
pub mod error;
pub mod grid;
pub mod hash;
pub mod image;
pub mod params;
pub mod point_cloud;
pub mod progress;
pub mod rig;
pub mod silhouette;
pub mod view;

pub use camera::{Camera, Pinhole};
pub use error::{Error, Result};
pub use image::{ImageRef, PixelFormat};
pub use params::{Params, Preset};
pub use point_cloud::{Mesh, Point, PointCloud, Rank};
pub use progress::{Executor, Progress, Serial, Silent, Stage};
pub use rig::Rig;
pub use view::{Mask, View, ViewInput};
