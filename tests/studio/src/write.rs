//! A capture as a scene folder: `scene.json`, `images/`, `masks/`.

use crate::{
    backdrop::CHROMA_RGB,
    capture::{Capture, CapturedFrame},
};
use image::{ColorType, ImageFormat};
use pcmvs_core::Camera;
use serde::{Deserialize, Serialize};
use std::{fs, io, path::Path};

/// The contents of `scene.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SceneFile {
    /// Version of the format.
    pub version: u32,
    /// Unit of length.
    pub units: String,
    /// Upward axis.
    pub up: [f64; 3],
    /// Calibrated cameras.
    pub cameras: Vec<CameraEntry>,
    /// Recorded frames.
    pub frames: Vec<FrameEntry>,
    /// What is behind the subject.
    pub background: Background,
}

/// A camera of `scene.json`; world to pixel is `K · distort(R X + t)`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CameraEntry {
    /// Name.
    pub name: String,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Intrinsic matrix by rows.
    #[serde(rename = "K")]
    pub k: [[f64; 3]; 3],
    /// OpenCV's k1, k2, p1, p2, k3.
    pub distortion: [f64; 5],
    /// Rotation by rows, world to camera.
    #[serde(rename = "R")]
    pub r: [[f64; 3]; 3],
    /// Translation, world to camera.
    pub t: [f64; 3],
}

impl CameraEntry {
    /// The entry of a camera.
    pub fn new(name: &str, camera: &Camera) -> Self {
        let Camera { width, height, k, distortion, r, t } = *camera;
        Self { name: name.to_owned(), width, height, k, distortion, r, t }
    }

    /// The camera of an entry.
    pub fn camera(&self) -> Camera {
        let Self { width, height, k, distortion, r, t, .. } = *self;
        Camera { width, height, k, distortion, r, t }
    }
}

/// A frame of `scene.json`: paths relative to the folder, in the cameras' order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FrameEntry {
    /// Number of the frame.
    pub index: u32,
    /// A picture a camera.
    pub images: Vec<String>,
    /// A mask a camera, null where nothing is known.
    pub masks: Vec<Option<String>>,
}

/// The backdrop of `scene.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Background {
    /// Its colour in even light.
    pub chroma_rgb: [u8; 3],
}

impl Capture {
    /// What `scene.json` says about this capture.
    pub fn scene_file(&self) -> SceneFile {
        let frames = self.frames.iter().enumerate().map(|(i, frame)| self.frame_entry(i, frame)).collect();
        self.scene_file_of(frames)
    }

    fn scene_file_of(&self, frames: Vec<FrameEntry>) -> SceneFile {
        SceneFile {
            version: 1,
            units: "m".to_owned(),
            up: [0.0, 0.0, 1.0],
            cameras: self.names.iter().zip(&self.cameras).map(|(name, c)| CameraEntry::new(name, c)).collect(),
            frames,
            background: Background { chroma_rgb: CHROMA_RGB },
        }
    }

    fn frame_entry(&self, index: usize, frame: &CapturedFrame) -> FrameEntry {
        let path = |folder: &str, name: &str| format!("{folder}/{name}_{index:04}.png");
        FrameEntry {
            index: index as u32,
            images: self.names.iter().map(|name| path("images", name)).collect(),
            masks: self.names.iter().zip(&frame.masks).map(|(n, m)| m.as_ref().map(|_| path("masks", n))).collect(),
        }
    }

    /// Writes the pictures and masks of a frame and returns its entry.
    ///
    /// # Errors
    /// Whatever the file system says.
    pub fn write_frame(&self, folder: &Path, index: usize, frame: &CapturedFrame) -> io::Result<FrameEntry> {
        let entry = self.frame_entry(index, frame);
        for name in ["images", "masks"] {
            fs::create_dir_all(folder.join(name))?;
        }
        let save = |path: &str, data: &[u8], width: u32, height: u32, kind: ColorType| {
            image::save_buffer_with_format(folder.join(path), data, width, height, kind, ImageFormat::Png)
                .map_err(io::Error::other)
        };
        for (i, picture) in frame.images.iter().enumerate() {
            if picture.rgb.is_empty() {
                continue; // a missing picture is named, but there is no file
            }
            save(&entry.images[i], &picture.rgb, picture.width, picture.height, ColorType::Rgb8)?;
            if let (Some(path), Some(mask)) = (&entry.masks[i], &frame.masks[i]) {
                save(path, mask, picture.width, picture.height, ColorType::L8)?;
            }
        }
        Ok(entry)
    }

    /// Writes `scene.json` for the given frames: last, so that a folder that has it is whole.
    ///
    /// # Errors
    /// Whatever the file system says.
    pub fn write_scene_file(&self, folder: &Path, frames: Vec<FrameEntry>) -> io::Result<()> {
        let text = serde_json::to_string_pretty(&self.scene_file_of(frames))?;
        fs::write(folder.join("scene.json"), text + "\n")
    }

    /// Writes the capture as a scene folder.
    ///
    /// # Errors
    /// Whatever the file system says.
    pub fn write(&self, folder: &Path) -> io::Result<()> {
        let entries = self.frames.iter().enumerate().map(|(i, frame)| self.write_frame(folder, i, frame));
        let entries = entries.collect::<io::Result<Vec<_>>>()?;
        self.write_scene_file(folder, entries)
    }
}
