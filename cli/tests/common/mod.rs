//! A tiny capture on disk, and the command run on it.
#![allow(dead_code, reason = "each test uses its part")]

use glam::{DMat3, DVec3};
use image::{GrayImage, Luma, Rgb, RgbImage};
use serde_json::{Value, json};
use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
};
use tempfile::TempDir;

pub const WIDTH: u32 = 64;
pub const HEIGHT: u32 = 48;
const FOCAL: f64 = 60.0;

/// A textured unit ball at the origin, seen by a ring of cameras.
pub struct Capture {
    folder: TempDir,
    /// scene.json, written by [`Capture::run`].
    pub scene: Value,
}

impl Capture {
    pub fn new(cameras: usize, frames: u32) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for name in ["images", "masks"] {
            fs::create_dir(folder.path().join(name)).unwrap();
        }
        let mut list = Vec::new();
        for i in 0..cameras {
            let angle = i as f64 / cameras as f64 * std::f64::consts::TAU;
            let height = if i % 2 == 0 { 1.5 } else { -1.5 };
            let centre = DVec3::new(4.0 * angle.cos(), 4.0 * angle.sin(), height);
            let forward = -centre.normalize();
            let right = forward.cross(DVec3::Z).normalize();
            let rotation = DMat3::from_cols(right, forward.cross(right), forward);
            let t = -(rotation.transpose() * centre);
            list.push(json!({
                "name": format!("cam{i:02}"), "width": WIDTH, "height": HEIGHT,
                "K": [[FOCAL, 0.0, 31.5], [0.0, FOCAL, 23.5], [0.0, 0.0, 1.0]],
                "distortion": [0, 0, 0, 0, 0],
                "R": rotation.to_cols_array_2d(), "t": t.to_array(),
            }));
        }
        let path = |kind: &str, i: usize, frame: u32| format!("{kind}/cam{i:02}_{frame}.png");
        let frame = |frame: u32| {
            let list = |kind| (0..cameras).map(|i| path(kind, i, frame)).collect::<Vec<_>>();
            json!({ "index": frame, "images": list("images"), "masks": list("masks") })
        };
        let frames_json: Vec<Value> = (0..frames).map(frame).collect();
        let scene = json!({ "version": 1, "units": "m", "up": [0, 0, 1], "cameras": list, "frames": frames_json });
        let capture = Self { folder, scene };
        for frame in 0..frames {
            for i in 0..cameras {
                let picture = RgbImage::from_fn(WIDTH, HEIGHT, |x, y| {
                    let v = (x * 37 + y * 91 + (x * y) % 23 * 5 + frame) as u8;
                    Rgb([v, v.wrapping_mul(3), 255 - v])
                });
                picture.save(capture.path(&path("images", i, frame))).unwrap();
                capture.mask(&path("masks", i, frame), 31.5, 14.0);
            }
        }
        capture
    }

    pub fn path(&self, relative: &str) -> PathBuf {
        self.folder.path().join(relative)
    }

    /// Writes a mask: a disc of this radius around column `x` of the middle row.
    pub fn mask(&self, relative: &str, x: f32, radius: f32) {
        let mask = GrayImage::from_fn(WIDTH, HEIGHT, |u, v| {
            let distance = (u as f32 - x).hypot(v as f32 - 23.5);
            Luma([if distance < radius { 255 } else { 0 }])
        });
        mask.save(self.path(relative)).unwrap();
    }

    /// `pcmvs reconstruct` with more arguments; the results go to `out`.
    pub fn run(&self, arguments: &[&str]) -> Output {
        fs::write(self.path("scene.json"), serde_json::to_string_pretty(&self.scene).unwrap()).unwrap();
        self.run_as_written(arguments)
    }

    /// The same with scene.json as it is on disk.
    pub fn run_as_written(&self, arguments: &[&str]) -> Output {
        let (scene, out) = (self.folder.path(), self.path("out"));
        let mut command = pcmvs();
        command.arg("reconstruct").arg(scene).arg("-o").arg(out).args(["--preset", "hull"]).args(arguments);
        command.output().unwrap()
    }

    /// Names of the files in `out`, sorted.
    pub fn results(&self) -> Vec<String> {
        names(&self.path("out"))
    }
}

/// The command.
pub fn pcmvs() -> Command {
    Command::new(env!("CARGO_BIN_EXE_pcmvs"))
}

pub fn names(folder: &Path) -> Vec<String> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}
