//! A tiny capture on disk, and the command that runs on it.

use glam::{DMat3, DVec2, DVec3};
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
const WALL: Rgb<u8> = Rgb([20, 20, 20]);

/// A textured unit ball at the origin, seen by a ring of cameras.
pub struct Capture {
    folder: TempDir,
    /// scene.json, written by [`Capture::run`].
    pub scene: Value,
}

impl Capture {
    pub fn new(cameras: usize, frames: u32) -> Self {
        Self::enlarged(cameras, frames, 1)
    }

    /// The same capture with pictures that are this many times as wide and high.
    pub fn enlarged(cameras: usize, frames: u32, scale: u32) -> Self {
        let (width, height, focal) = (WIDTH * scale, HEIGHT * scale, FOCAL * f64::from(scale));
        let middle = DVec2::new(f64::from(width - 1), f64::from(height - 1)) / 2.0;
        let folder = tempfile::tempdir().unwrap();
        for name in ["images", "masks"] {
            fs::create_dir(folder.path().join(name)).unwrap();
        }
        let mut list = Vec::new();
        for i in 0..cameras {
            let angle = i as f64 / cameras as f64 * std::f64::consts::TAU;
            let up = if i % 2 == 0 { 1.5 } else { -1.5 };
            let centre = DVec3::new(4.0 * angle.cos(), 4.0 * angle.sin(), up);
            let forward = -centre.normalize();
            let right = forward.cross(DVec3::Z).normalize();
            let rotation = DMat3::from_cols(right, forward.cross(right), forward);
            let t = -(rotation.transpose() * centre);
            list.push(json!({
                "name": format!("cam{i:02}"), "width": width, "height": height,
                "K": [[focal, 0.0, middle.x], [0.0, focal, middle.y], [0.0, 0.0, 1.0]],
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
                let camera = &capture.scene["cameras"][i];
                let look = |x, y| (DVec2::new(f64::from(x), f64::from(y)) - middle) / focal;
                let picture = RgbImage::from_fn(width, height, |x, y| colour(camera, look(x, y), frame));
                picture.save(capture.path(&path("images", i, frame))).unwrap();
                let radius = 14.0 / FOCAL;
                let inside = |x, y| if look(x, y).length() < radius { 255 } else { 0 };
                let mask = GrayImage::from_fn(width, height, |x, y| Luma([inside(x, y)]));
                mask.save(capture.path(&path("masks", i, frame))).unwrap();
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

    /// Writes the mask of the ball inverted.
    pub fn inverted_mask(&self, relative: &str) {
        let mut mask = image::open(self.path(relative)).unwrap().into_luma8();
        mask.pixels_mut().for_each(|pixel| pixel.0[0] = 255 - pixel.0[0]);
        mask.save(self.path(relative)).unwrap();
    }

    /// Takes the masks away, and adds pictures of the empty set.
    pub fn with_plates(mut self) -> Self {
        let cameras = self.scene["cameras"].as_array().unwrap();
        let plates = cameras.iter().map(|camera| {
            let path = format!("plate_{}.png", camera["name"].as_str().unwrap());
            let [width, height] = ["width", "height"].map(|size| camera[size].as_u64().unwrap() as u32);
            RgbImage::from_pixel(width, height, WALL).save(self.path(&path)).unwrap();
            path
        });
        self.scene["background"] = json!({ "plates": plates.collect::<Vec<_>>() });
        for frame in self.scene["frames"].as_array_mut().unwrap() {
            frame["masks"] = Value::Null;
        }
        self
    }

    /// Runs `pcmvs reconstruct` with more arguments. The results go to `out`.
    pub fn run(&self, arguments: &[&str]) -> Output {
        fs::write(self.path("scene.json"), serde_json::to_string_pretty(&self.scene).unwrap()).unwrap();
        self.run_as_written(arguments)
    }

    /// The same, with scene.json as it is on disk.
    pub fn run_as_written(&self, arguments: &[&str]) -> Output {
        let (scene, out) = (self.folder.path(), self.path("out"));
        let mut command = pcmvs();
        command.arg("reconstruct").arg(scene).arg("-o").arg(out).args(arguments);
        if !arguments.contains(&"--preset") {
            command.args(["--preset", "hull"]);
        }
        command.output().unwrap()
    }

    /// Names of the files in `out`, sorted.
    pub fn results(&self) -> Vec<String> {
        names(&self.path("out"))
    }
}

/// Colour of the ball or of the wall behind it, by normalised image coordinates.
fn colour(camera: &Value, look: DVec2, frame: u32) -> Rgb<u8> {
    let number = |v: &Value| v.as_f64().unwrap();
    let row = |v: &Value| DVec3::new(number(&v[0]), number(&v[1]), number(&v[2]));
    let back = DMat3::from_cols(row(&camera["R"][0]), row(&camera["R"][1]), row(&camera["R"][2]));
    let centre = -(back * row(&camera["t"]));
    let ray = back * look.extend(1.0).normalize();
    let (along, radius) = (-centre.dot(ray), 0.97);
    let inside = along * along - centre.length_squared() + radius * radius;
    if inside < 0.0 {
        return WALL;
    }
    let p = centre + ray * (along - inside.sqrt()) + DVec3::splat(f64::from(frame));
    let wave = |axis: DVec3| (128.0 + 100.0 * (axis.dot(p)).sin()) as u8;
    Rgb([wave(DVec3::new(9.0, 5.0, -7.0)), wave(DVec3::new(-4.0, 8.0, 9.0)), wave(DVec3::new(6.0, -8.0, 6.0))])
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

/// Asserts that a command has refused its input, with a message that has these words.
#[track_caller]
pub fn assert_refused(output: &Output, words: &[&str]) {
    let message = stderr(output);
    assert_eq!(output.status.code(), Some(2), "{message}");
    for word in words {
        assert!(message.contains(word), "`{word}` is missing in: {message}");
    }
    assert!(!message.contains("panicked"), "{message}");
}

/// A GLB file: its JSON and its binary chunk.
pub fn parts(bytes: &[u8]) -> (Value, &[u8]) {
    let length = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    let end = 20 + length(12);
    (serde_json::from_slice(&bytes[20..end]).unwrap(), &bytes[end + 8..])
}

/// The bytes of a buffer view, decompressed.
pub fn view(json: &Value, binary: &[u8], index: &Value) -> Vec<u8> {
    let view = &json["bufferViews"][index.as_u64().unwrap() as usize];
    let packed = &view["extensions"]["EXT_meshopt_compression"];
    let number = |of: &Value, key: &str| of[key].as_u64().unwrap_or(0) as usize;
    if packed.is_null() {
        return binary[number(view, "byteOffset")..][..number(view, "byteLength")].to_vec();
    }
    let stored = &binary[number(packed, "byteOffset")..][..number(packed, "byteLength")];
    let (count, stride) = (number(packed, "count"), number(packed, "byteStride"));
    let bytes = match (packed["mode"].as_str().unwrap(), stride) {
        ("TRIANGLES", 2) => {
            meshopt::decode_index_buffer::<u16>(stored, count).unwrap().iter().flat_map(|i| i.to_le_bytes()).collect()
        }
        ("TRIANGLES", 4) => {
            meshopt::decode_index_buffer::<u32>(stored, count).unwrap().iter().flat_map(|i| i.to_le_bytes()).collect()
        }
        ("ATTRIBUTES", 4) => meshopt::decode_vertex_buffer::<[u8; 4]>(stored, count).unwrap().concat(),
        ("ATTRIBUTES", 8) => meshopt::decode_vertex_buffer::<[u8; 8]>(stored, count).unwrap().concat(),
        ("ATTRIBUTES", 12) => meshopt::decode_vertex_buffer::<[u8; 12]>(stored, count).unwrap().concat(),
        other => panic!("{other:?}"),
    };
    assert_eq!(bytes.len(), number(view, "byteLength"));
    bytes
}
