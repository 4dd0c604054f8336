//! The same four cameras in the format of every program, written here by the formulas of that program. The imported cameras
//! see points at the corners of the pictures where that program sees them.

#[path = "formats/anipose.rs"]
mod anipose;
#[path = "formats/bundler.rs"]
mod bundler;
#[path = "formats/easymocap.rs"]
mod easymocap;
#[path = "formats/kalibr.rs"]
mod kalibr;
#[path = "formats/metashape.rs"]
mod metashape;
#[path = "formats/mvsnet.rs"]
mod mvsnet;
#[path = "formats/neus.rs"]
mod neus;
#[path = "formats/panoptic.rs"]
mod panoptic;
#[path = "formats/qualisys.rs"]
mod qualisys;
#[path = "formats/realitycapture.rs"]
mod realitycapture;
#[path = "formats/realitycapture_csv.rs"]
mod realitycapture_csv;
#[path = "formats/round_trip.rs"]
mod round_trip;
#[path = "formats/stereo.rs"]
mod stereo;
#[path = "formats/written.rs"]
mod written;
#[path = "formats/zju.rs"]
mod zju;

use super::{HEIGHT, WIDTH, camera, import, import_with_notes};
use glam::{DMat3, DVec2, DVec3};
use image::RgbImage;
use std::{fs, path::Path};
use tempfile::TempDir;

const COUNT: usize = 4;
/// Focal lengths, and a principal point off the middle.
const FOCAL: DVec2 = DVec2::new(61.0, 63.5);
const PRINCIPAL: DVec2 = DVec2::new(30.25, 24.75);
/// k1 k2 p1 p2 k3 in OpenCV's order.
const BROWN: [f64; 5] = [-0.11, 0.03, 0.002, -0.003, 0.004];
const FISHEYE: [f64; 4] = [-0.03, 0.02, -0.01, 0.003];

/// A camera without its lens: OpenCV's K, and its pose, world to camera.
#[derive(Clone)]
struct Pinhole {
    size: [u32; 2],
    focal: DVec2,
    principal: DVec2,
    r: DMat3,
    t: DVec3,
}

impl Pinhole {
    /// K by rows.
    fn k(&self) -> [f64; 9] {
        [self.focal.x, 0.0, self.principal.x, 0.0, self.focal.y, self.principal.y, 0.0, 0.0, 1.0]
    }

    /// The camera's place in the world.
    fn centre(&self) -> DVec3 {
        -(self.r.transpose() * self.t)
    }
}

fn pinholes() -> Vec<Pinhole> {
    let pinhole = |i: usize| {
        let angle = i as f64 * 1.4 + 0.2;
        let centre = DVec3::new(3.0 * angle.cos(), 3.0 * angle.sin(), 0.8 + 0.3 * i as f64);
        let forward = (DVec3::new(0.1, -0.2, 0.1 * i as f64) - centre).normalize();
        let right = forward.cross(DVec3::new(0.1, 0.2, 1.0)).normalize();
        let r = DMat3::from_cols(right, forward.cross(right), forward).transpose();
        Pinhole { size: [WIDTH, HEIGHT], focal: FOCAL, principal: PRINCIPAL, r, t: -(r * centre) }
    };
    (0..COUNT).map(pinhole).collect()
}

/// Points that the cameras see near the corners and in the middle of their pictures.
fn points(pose: &Pinhole) -> Vec<DVec3> {
    let rays = [(0.0, 0.0), (-0.45, -0.35), (0.5, -0.34), (-0.44, 0.36), (0.47, 0.33)];
    rays.map(|(x, y)| pose.r.transpose() * (DVec3::new(x, y, 1.0) * 2.7 - pose.t)).into()
}

fn brown(p: DVec2, [k1, k2, p1, p2, k3]: [f64; 5]) -> DVec2 {
    let (x, y, r2) = (p.x, p.y, p.length_squared());
    let radial = 1.0 + k1 * r2 + k2 * r2.powi(2) + k3 * r2.powi(3);
    p * radial + DVec2::new(2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x), p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y)
}

fn fisheye(p: DVec2, [k1, k2, k3, k4]: [f64; 4]) -> DVec2 {
    let angle = p.length().atan();
    let bent = angle + k1 * angle.powi(3) + k2 * angle.powi(5) + k3 * angle.powi(7) + k4 * angle.powi(9);
    if angle == 0.0 { p } else { p * (bent / p.length()) }
}

/// OpenCV's pixel with a distortion.
fn opencv(pose: &Pinhole, point: DVec3, bend: impl Fn(DVec2) -> DVec2) -> DVec2 {
    let c = pose.r * point + pose.t;
    pose.focal * bend(DVec2::new(c.x / c.z, c.y / c.z)) + pose.principal
}

/// A folder with pictures of these names, and text files.
fn folder(pictures: &[String], texts: &[(&str, &str)]) -> TempDir {
    sized_folder([WIDTH, HEIGHT], pictures, texts)
}

/// The same with pictures of a size.
fn sized_folder([width, height]: [u32; 2], pictures: &[String], texts: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for name in pictures {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        RgbImage::new(width, height).save(path).unwrap();
    }
    for (name, text) in texts {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    folder
}

fn images(name: impl Fn(usize) -> String) -> Vec<String> {
    (0..COUNT).map(|i| format!("images/{}.png", name(i))).collect()
}

/// Imports by name, by recognition of the folder and of the file, with a byte-order mark and with other line ends. All give
/// the same cameras, which see what `pixel` says.
fn check(format: &str, folder: &Path, files: &[&str], pixel: impl Fn(&Pinhole, DVec3) -> DVec2) -> String {
    let (scene, notes) = import_with_notes(format, folder);
    assert_eq!(scene["cameras"].as_array().unwrap().len(), COUNT, "{format}");
    for (i, pose) in pinholes().iter().enumerate() {
        let camera = camera(&scene, i);
        for point in points(pose) {
            let seen = camera.project(point).expect("it is in front").0;
            let off = (seen - pixel(pose, point)).length();
            assert!(off < 1e-6, "{format}: camera {i} is {off} px off at {seen}");
        }
    }
    assert_eq!(import("auto", folder), scene, "{format}");
    let first = folder.join(files[0]);
    assert_eq!(import("auto", &first), scene, "{format}");
    assert_eq!(import(format, &first), scene, "{format}");
    for change in [|text: &str| format!("\u{feff}{text}"), |text: &str| text.replace('\n', "\r\n")] {
        for file in files {
            let path = folder.join(file);
            let Ok(text) = fs::read_to_string(&path) else { continue };
            fs::write(&path, change(text.trim_start_matches('\u{feff}'))).unwrap();
        }
        assert_eq!(import(format, folder), scene, "{format}");
    }
    notes
}

fn list(numbers: impl IntoIterator<Item = f64>) -> String {
    numbers.into_iter().map(|v| format!("{v:?}")).collect::<Vec<_>>().join(", ")
}

/// Numbers of a matrix by rows.
fn by_rows(m: &DMat3) -> [f64; 9] {
    m.transpose().to_cols_array()
}

/// Rodrigues' vector of a rotation.
fn rodrigues(r: &DMat3) -> DVec3 {
    let (axis, angle) = glam::DQuat::from_mat3(r).to_axis_angle();
    axis * angle
}
