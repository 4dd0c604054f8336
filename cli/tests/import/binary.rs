//! COLMAP's binary model gives the same scene as its text.

use super::{HEIGHT, WIDTH, colmap, import, import_with_notes, refused};
use std::fs;

/// Bytes of a binary file. Numbers are little-endian.
#[derive(Default)]
pub struct Bytes(pub Vec<u8>);

impl Bytes {
    pub fn u32(mut self, value: u32) -> Self {
        self.0.extend(value.to_le_bytes());
        self
    }

    pub fn u64(mut self, value: u64) -> Self {
        self.0.extend(value.to_le_bytes());
        self
    }

    pub fn f64s(mut self, values: &[f64]) -> Self {
        self.0.extend(values.iter().flat_map(|v| v.to_le_bytes()));
        self
    }

    pub fn text(mut self, text: &str) -> Self {
        self.0.extend(text.bytes().chain([0]));
        self
    }
}

/// A camera of OPENCV's model, number 4, or of another.
fn cameras(model: u32) -> Vec<u8> {
    let head = Bytes::default().u64(1).u32(3).u32(model).u64(u64::from(WIDTH)).u64(u64::from(HEIGHT));
    head.f64s(&[60.0, 70.0, 32.0, 24.0, 0.1, -0.05, 0.01, -0.02]).0
}

#[test]
fn binary_models_are_read_like_text() {
    let folder = colmap(&format!("OPENCV {WIDTH} {HEIGHT} 60 70 32 24 0.1 -0.05 0.01 -0.02"));
    let expected = import("colmap", folder.path());
    // The pose of the text.
    let text = fs::read_to_string(folder.path().join("images.txt")).unwrap();
    let line = text.lines().find(|line| line.contains("b.png")).unwrap();
    let pose: Vec<f64> = line.split(' ').skip(1).take(7).map(|word| word.parse().unwrap()).collect();
    let image = |bytes: Bytes, id: u32, name: &str| bytes.u32(id).f64s(&pose).u32(3).text(name);
    let images = image(Bytes::default().u64(2), 7, "b.png").u64(0);
    let images = image(images, 9, "a/c d.png").u64(2).f64s(&[1.0, 2.0]).u64(u64::MAX).f64s(&[3.0, 4.0]).u64(5).0;

    let model = folder.path().join("sparse/0");
    fs::create_dir_all(&model).unwrap();
    for name in ["cameras.txt", "images.txt"] {
        fs::rename(folder.path().join(name), model.join(name)).unwrap();
    }
    fs::write(model.join("cameras.bin"), cameras(4)).unwrap();
    fs::write(model.join("images.bin"), &images).unwrap();
    let (scene, notes) = import_with_notes("colmap", folder.path());
    assert_eq!(scene, expected);
    assert!(notes.contains("the text model is read, and the binary one beside it ignored"), "{notes}");
    for name in ["cameras.txt", "images.txt"] {
        fs::remove_file(model.join(name)).unwrap();
    }
    fs::write(model.join("rigs.bin"), "").unwrap();
    let (scene, notes) = import_with_notes("colmap", folder.path());
    assert_eq!(scene, expected);
    assert!(notes.contains("rigs and frames are ignored"), "{notes}");
    assert_eq!(import("auto", folder.path()), expected);
    assert_eq!(import("colmap", &model.join("cameras.bin")), expected);

    for end in 0..images.len() {
        fs::write(model.join("images.bin"), &images[..end]).unwrap();
        if end % 7 == 0 || end + 1 == images.len() {
            assert!(refused("colmap", folder.path()).contains("images.bin: the file is truncated"), "{end}");
        }
    }
    fs::write(model.join("images.bin"), [&images[..], &[0]].concat()).unwrap();
    assert!(refused("colmap", folder.path()).contains("more bytes than the file announces"));
    fs::write(model.join("images.bin"), &images).unwrap();
    fs::write(model.join("cameras.bin"), cameras(5)).unwrap();
    let fisheye = &import("colmap", folder.path())["cameras"][0];
    assert_eq!(fisheye["lens"], "fisheye");
    assert_eq!(fisheye["distortion"], serde_json::json!([0.1, -0.05, 0.01, -0.02]));
    fs::write(model.join("cameras.bin"), cameras(99)).unwrap();
    assert!(refused("colmap", folder.path()).contains("camera 3: the model number 99 is unknown"));
}
