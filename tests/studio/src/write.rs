//! Writes a capture as a scene folder: `scene.json`, `images/`, `masks/`.

use crate::{
    backdrop::CHROMA_RGB,
    capture::{Capture, CapturedFrame},
};
use image::{ColorType, ImageFormat};
use pcmvs_scene::{Background, FILE_NAME, Scene, SceneCamera, SceneFrame, VERSION};
use std::{
    fs, io,
    path::{Path, PathBuf},
};

impl Capture {
    /// The content of this capture's `scene.json`.
    pub fn scene(&self) -> Scene {
        self.scene_of(self.frames.iter().enumerate().map(|(i, frame)| self.scene_frame(i, frame)).collect())
    }

    fn scene_of(&self, frames: Vec<SceneFrame>) -> Scene {
        Scene {
            version: VERSION,
            units: Some("m".to_owned()),
            up: Some([0.0, 0.0, 1.0]),
            cameras: self
                .names
                .iter()
                .zip(&self.cameras)
                .map(|(name, camera)| SceneCamera::new(name.clone(), camera))
                .collect(),
            frames,
            background: Some(Background { chroma_rgb: Some(CHROMA_RGB), colours: Vec::new(), plates: None }),
            ..Scene::default()
        }
    }

    fn scene_frame(&self, index: usize, frame: &CapturedFrame) -> SceneFrame {
        let path = |folder: &str, name: &str| PathBuf::from(format!("{folder}/{name}_{index:04}.png"));
        let mask = |(name, mask): (&String, &Option<Vec<u8>>)| mask.as_ref().map(|_| path("masks", name));
        SceneFrame {
            index: index as u32,
            images: self.names.iter().map(|name| Some(path("images", name))).collect(),
            masks: Some(self.names.iter().zip(&frame.masks).map(mask).collect()),
        }
    }

    /// Writes the pictures and masks of a frame and returns its entry.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn write_frame(&self, folder: &Path, index: usize, frame: &CapturedFrame) -> io::Result<SceneFrame> {
        let entry = self.scene_frame(index, frame);
        for name in ["images", "masks"] {
            fs::create_dir_all(folder.join(name))?;
        }
        let save = |path: &Path, data: &[u8], width: u32, height: u32, kind: ColorType| {
            image::save_buffer_with_format(folder.join(path), data, width, height, kind, ImageFormat::Png)
                .map_err(io::Error::other)
        };
        for (i, picture) in frame.images.iter().enumerate() {
            // scene.json names a missing picture, but it has no file.
            let Some(path) = entry.image(i).filter(|_| !picture.rgb.is_empty()) else { continue };
            save(path, &picture.rgb, picture.width, picture.height, ColorType::Rgb8)?;
            if let (Some(path), Some(mask)) = (entry.mask(i), &frame.masks[i]) {
                save(path, mask, picture.width, picture.height, ColorType::L8)?;
            }
        }
        Ok(entry)
    }

    /// Writes `scene.json` for the given frames. It is written last, so that a folder that contains it is complete.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn write_scene_file(&self, folder: &Path, frames: Vec<SceneFrame>) -> io::Result<()> {
        let text = serde_json::to_string_pretty(&self.scene_of(frames))?;
        fs::write(folder.join(FILE_NAME), text + "\n")
    }

    /// Writes the capture as a scene folder.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn write(&self, folder: &Path) -> io::Result<()> {
        let entries = self.frames.iter().enumerate().map(|(i, frame)| self.write_frame(folder, i, frame));
        let entries = entries.collect::<io::Result<Vec<_>>>()?;
        self.write_scene_file(folder, entries)
    }
}
