use super::*;
use crate::scene::{SceneCamera, VERSION};
use image::{ColorType, ImageEncoder, codecs::png::PngEncoder};
use pcmvs_core::{Camera, Lens, Serial};
use std::path::PathBuf;

/// Files of 2 x 1 pixels, whose name is the level of the second one.
struct Levels;

fn png(level: u16) -> Vec<u8> {
    let mut file = Vec::new();
    let pixels = [0, level].map(u16::to_ne_bytes).concat();
    PngEncoder::new(&mut file).write_image(&pixels, 2, 1, ColorType::L16.into()).unwrap();
    file
}

impl Files for Levels {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        Ok(png(path.file_stem().unwrap().to_str().unwrap().parse().unwrap()))
    }

    fn is_file(&self, _: &Path) -> bool {
        true
    }

    fn is_folder(&self, _: &Path) -> bool {
        false
    }

    fn list(&self, _: &Path) -> io::Result<Vec<PathBuf>> {
        Ok(Vec::new())
    }
}

/// How many pictures are decoded once the levels are known, and the second pixel of each picture.
fn read(levels: &[u16]) -> (usize, Vec<u8>) {
    let rows = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let camera = Camera { width: 2, height: 1, k: rows, lens: Lens::NONE, r: rows, t: [0.0; 3] };
    let images = levels.iter().map(|level| Some(PathBuf::from(format!("{level}.png")))).collect();
    let cameras = levels.iter().map(|level| SceneCamera::new(level.to_string(), &camera)).collect();
    let frames = vec![SceneFrame { index: 0, images, masks: None }];
    let scene = Scene { version: VERSION, cameras, frames, ..Scene::default() };
    let files = FrameFiles::read(&Levels, &NoVideos, &scene, &scene.frames[0], Silhouettes::Files).ok().unwrap();
    let views = files.into_views(&Serial);
    let is_decoded = |view: &&Mutex<Option<ViewFiles>>| {
        let view = view.lock().unwrap();
        matches!(view.as_ref().unwrap().image, Some(Content::Decoded(_)))
    };
    let decoded = views.views.iter().filter(is_decoded).count();
    let last = |camera: usize| *views.decode(camera).ok().unwrap().unwrap().image.pixels().last().unwrap();
    (decoded, (0..levels.len()).map(last).collect())
}

#[test]
fn pictures_of_12_bits_are_decoded_once_and_only_darker_ones_again() {
    let of = |level: u16, white: u16| levels::to_byte(level, white);
    assert_eq!(read(&[3000, 2000, 4000]), (3, [3000, 2000, 4000].map(|level| of(level, 4095)).to_vec()));
    // Alone, the first would have 10 bits.
    assert_eq!(read(&[800, 3000, 4000]), (2, [800, 3000, 4000].map(|level| of(level, 4095)).to_vec()));
    // One picture of all bits tells those of the others.
    assert_eq!(read(&[60000, 3000, 5000]), (1, [60000, 3000, 5000].map(|level| of(level, u16::MAX)).to_vec()));
    assert_eq!(read(&[0, 0]), (2, vec![0, 0]));
}
