//! Each importer follows the convention of its program: a point that is projected by that program's formula lands on the
//! same pixel through the imported camera.

mod binary;
mod clips;
mod formats;
mod lenses;
mod masks;
mod names;
mod pictures;
mod spellings;
mod text;
mod transforms;

use crate::common::{HEIGHT, WIDTH, names, pcmvs, stderr};
use glam::{DVec2, DVec3};
use image::{GrayImage, RgbImage};
use pcmvs_core::{Camera, Lens};
use serde_json::{Value, json};
use std::{
    env, fs,
    path::{Path, PathBuf},
};
use tempfile::TempDir;

const POINT: DVec3 = DVec3::new(0.3, -0.2, 0.5);

/// A folder with pictures and masks of the given names, and one text file.
fn source(file: &str, text: &str, pictures: &[&str], masks: &[&str]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("images")).unwrap();
    fs::create_dir(folder.path().join("masks")).unwrap();
    for name in pictures {
        RgbImage::new(WIDTH, HEIGHT).save(folder.path().join(name)).unwrap();
    }
    for name in masks {
        GrayImage::new(WIDTH, HEIGHT).save(folder.path().join(name)).unwrap();
    }
    fs::write(folder.path().join(file), text).unwrap();
    folder
}

/// Imports a source and returns scene.json.
fn import(from: &str, path: &Path) -> Value {
    import_with_notes(from, path).0
}

/// Imports a source and returns scene.json and the notes.
fn import_with_notes(from: &str, path: &Path) -> (Value, String) {
    let target = tempfile::tempdir().unwrap();
    let output = pcmvs().args(["import", "--from", from]).arg(path).arg("-o").arg(target.path()).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let scene: Value = serde_json::from_slice(&fs::read(target.path().join("scene.json")).unwrap()).unwrap();
    assert_eq!(scene["version"], 1);
    for frame in scene["frames"].as_array().unwrap() {
        for list in ["images", "masks"] {
            for path in frame[list].as_array().unwrap().iter().filter_map(Value::as_str) {
                assert!(target.path().join(path).is_file(), "{path}");
            }
        }
    }
    (scene, stderr(&output))
}

/// Imports a source that must be refused, and returns the message.
fn refused(from: &str, path: &Path) -> String {
    let target = tempfile::tempdir().unwrap();
    let output = pcmvs().args(["import", "--from", from]).arg(path).arg("-o").arg(target.path()).output().unwrap();
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(!names(target.path()).contains(&"scene.json".to_owned()));
    stderr(&output)
}

fn camera(scene: &Value, index: usize) -> Camera {
    let camera = &scene["cameras"][index];
    let numbers = |key: &str| -> Vec<f64> {
        let list = camera[key].as_array().unwrap().iter();
        list.flat_map(|v| v.as_array().cloned().unwrap_or_else(|| vec![v.clone()]))
            .map(|v| v.as_f64().unwrap())
            .collect()
    };
    let matrix = |key| {
        let n = numbers(key);
        [[n[0], n[1], n[2]], [n[3], n[4], n[5]], [n[6], n[7], n[8]]]
    };
    Camera {
        width: camera["width"].as_u64().unwrap() as u32,
        height: camera["height"].as_u64().unwrap() as u32,
        k: matrix("K"),
        lens: match camera.get("lens") {
            None => Lens::OpenCv(std::array::from_fn(|i| numbers("distortion").get(i).copied().unwrap_or(0.0))),
            Some(_) => Lens::Fisheye(numbers("distortion").try_into().unwrap()),
        },
        r: matrix("R"),
        t: numbers("t").try_into().unwrap(),
    }
}

#[track_caller]
fn assert_sees(scene: &Value, index: usize, pixel: DVec2) {
    let (seen, _) = camera(scene, index).project(POINT).unwrap();
    assert!((seen - pixel).length() < 1e-9, "{seen} instead of {pixel}");
}

/// Rodrigues' formula: `p` turned around the unit `axis`.
fn turn(p: DVec3, axis: DVec3, angle: f64) -> DVec3 {
    p * angle.cos() + axis.cross(p) * angle.sin() + axis * axis.dot(p) * (1.0 - angle.cos())
}

const AXIS: DVec3 = DVec3::new(2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0);
const ANGLE: f64 = 0.7;

#[test]
fn middlebury_is_k_r_t_by_rows() {
    // A quarter turn around z: x' = -y, y' = x.
    let line = "0001.png 100 0 30 0 110 20 0 0 1 0 -1 0 1 0 0 0 0 1 0.1 0.2 3";
    let text = format!("2\n{line}\n{}\n", line.replace("0001", "0002").replace("0.1 0.2 3", "0 0 4"));
    let folder = source("x_par.txt", &text, &["0001.png", "0002.png"], &["masks/0002.png"]);
    let scene = import("middlebury", folder.path());
    let p = DVec3::new(-POINT.y + 0.1, POINT.x + 0.2, POINT.z + 3.0);
    assert_sees(&scene, 0, DVec2::new(100.0 * p.x / p.z + 30.0, 110.0 * p.y / p.z + 20.0));
    assert_eq!(scene["cameras"][1]["name"], "0002");
    assert_eq!(scene["frames"][0]["masks"], json!([null, "masks/0002.png"]));
    fs::write(folder.path().join("x_par.txt"), text.replacen('2', "3", 1)).unwrap();
    assert!(refused("middlebury", folder.path()).contains("announces 3 views"));
}

#[test]
fn middlebury_gives_the_scene_that_belongs_to_the_real_capture() {
    let data = env::var_os("PCMVS_DATA").map(PathBuf::from);
    let Some(capture) = data.map(|data| data.join("dino-sparse-ring")).filter(|capture| capture.is_dir()) else {
        eprintln!("skipped: PCMVS_DATA names no folder with dino-sparse-ring");
        return;
    };
    let scene = import("middlebury", &capture);
    let expected: Value = serde_json::from_slice(&fs::read(capture.join("scene.json")).unwrap()).unwrap();
    assert_eq!(scene["cameras"].as_array().unwrap().len(), 16);
    for i in 0..16 {
        assert_eq!(scene["cameras"][i]["name"], expected["cameras"][i]["name"]);
        assert_eq!(camera(&scene, i), camera(&expected, i));
    }
    assert_eq!(scene["frames"], expected["frames"]);
}

/// COLMAP: quaternion w first, world to camera, the first pixel's centre at (0.5, 0.5).
fn colmap(lens: &str) -> TempDir {
    let (sin, cos) = (ANGLE / 2.0).sin_cos();
    let q = AXIS * sin;
    let pose = format!("{cos} {} {} {} 0.1 -0.2 3", q.x, q.y, q.z);
    let images = format!("# comment\n7 {pose} 3 b.png\n\n9 {pose} 3 a/c d.png\n1 2 -1 3 4 5\n");
    let folder = source("images.txt", &images, &["images/b.png"], &["masks/b.png"]);
    fs::create_dir(folder.path().join("images/a")).unwrap();
    RgbImage::new(WIDTH, HEIGHT).save(folder.path().join("images/a/c d.png")).unwrap();
    fs::write(folder.path().join("cameras.txt"), format!("# comment\n3 {lens}\n")).unwrap();
    folder
}

#[test]
fn colmap_has_w_first_and_half_pixel_centres() {
    let p = turn(POINT, AXIS, ANGLE) + DVec3::new(0.1, -0.2, 3.0);
    let (x, y) = (p.x / p.z, p.y / p.z);
    let r2 = x * x + y * y;
    let size = format!("{WIDTH} {HEIGHT}");
    let (k1, k2, p1, p2, k3) = (0.1, -0.05, 0.01, -0.02, 0.03);
    let radial = |k3: f64| 1.0 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2;
    let tangential = DVec2::new(2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x), p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y);
    let ideal = DVec2::new(x, y);
    let fisheye = |[k1, k2, k3, k4]: [f64; 4]| {
        let angle = r2.sqrt().atan();
        let bent = angle + k1 * angle.powi(3) + k2 * angle.powi(5) + k3 * angle.powi(7) + k4 * angle.powi(9);
        ideal * (bent / r2.sqrt())
    };
    let cases = [
        (format!("SIMPLE_PINHOLE {size} 60 32 24"), 60.0, ideal),
        (format!("PINHOLE {size} 60 70 32 24"), 70.0, ideal),
        (format!("SIMPLE_RADIAL {size} 60 32 24 {k1}"), 60.0, ideal * (1.0 + k1 * r2)),
        (format!("RADIAL {size} 60 32 24 {k1} {k2}"), 60.0, ideal * radial(0.0)),
        (format!("OPENCV {size} 60 70 32 24 {k1} {k2} {p1} {p2}"), 70.0, ideal * radial(0.0) + tangential),
        (
            format!("FULL_OPENCV {size} 60 70 32 24 {k1} {k2} {p1} {p2} {k3} 0 0 0"),
            70.0,
            ideal * radial(k3) + tangential,
        ),
        (
            format!("FULL_OPENCV {size} 60 70 32 24 {k1} {k2} {p1} {p2} {k3} 0.2 -0.1 0.03"),
            70.0,
            ideal * (radial(k3) / (1.0 + 0.2 * r2 - 0.1 * r2 * r2 + 0.03 * r2.powi(3))) + tangential,
        ),
        (format!("SIMPLE_RADIAL_FISHEYE {size} 60 32 24 {k1}"), 60.0, fisheye([k1, 0.0, 0.0, 0.0])),
        (format!("RADIAL_FISHEYE {size} 60 32 24 {k1} {k2}"), 60.0, fisheye([k1, k2, 0.0, 0.0])),
        (format!("OPENCV_FISHEYE {size} 60 70 32 24 {k1} {k2} {k3} 0.01"), 70.0, fisheye([k1, k2, k3, 0.01])),
        (
            format!("THIN_PRISM_FISHEYE {size} 60 70 32 24 {k1} {k2} 0 0 {k3} 0.01 0 0"),
            70.0,
            fisheye([k1, k2, k3, 0.01]),
        ),
    ];
    for (lens, fy, bent) in cases {
        let scene = import("colmap", colmap(&lens).path());
        // COLMAP's pixel, whose origin is the first pixel's corner, half a pixel before its centre.
        let pixel = DVec2::new(60.0 * bent.x + 32.0, fy * bent.y + 24.0);
        assert_sees(&scene, 0, pixel - 0.5);
        assert_eq!(scene["cameras"].as_array().unwrap().len(), 2);
        assert_eq!(scene["cameras"][0]["name"], "a_c d");
        assert_eq!(scene["frames"][0]["masks"], json!([null, "masks/b.png"]));
    }
}

#[test]
fn colmap_lenses_that_cannot_be_expressed_are_refused() {
    let size = format!("{WIDTH} {HEIGHT}");
    let prism = format!("THIN_PRISM_FISHEYE {size} 60 70 32 24 0 0 0 0 0 0 0.1 0");
    let message = refused("colmap", colmap(&prism).path());
    assert!(message.contains("cameras.txt") && message.contains("sx1"), "{message}");
    let message = refused("colmap", colmap(&format!("FOV {size} 60 70 32 24 0.5")).path());
    assert!(message.contains("FOV") && message.contains("undistort"), "{message}");
    let message = refused("colmap", colmap(&format!("OPENCV_FISHEYE {size} 60 70 32 24 0 0 0")).path());
    assert!(message.contains("7 parameters do not fit the model OPENCV_FISHEYE"), "{message}");
    // 25 x 20 pixels around the principal point are all that this lens shows.
    let message = refused("colmap", colmap(&format!("SIMPLE_RADIAL {size} 60 32 24 -3")).path());
    assert!(message.contains("folds the picture") && message.contains("a_c d"), "{message}");
    let message = refused("colmap", colmap("SIMPLE_PINHOLE 65 48 60 32 24").path());
    assert!(message.contains("65 x 48") && message.contains("a_c d"), "{message}");
}

fn opencv_pixel() -> DVec2 {
    let p = turn(POINT, AXIS, ANGLE) + DVec3::new(0.1, -0.2, 3.0);
    let (x, y) = (p.x / p.z, p.y / p.z);
    let r2 = x * x + y * y;
    let radial = 1.0 + 0.1 * r2 - 0.05 * r2 * r2 + 0.03 * r2 * r2 * r2;
    let x2 = x * radial + 2.0 * 0.01 * x * y - 0.02 * (r2 + 2.0 * x * x);
    let y2 = y * radial + 0.01 * (r2 + 2.0 * y * y) + 2.0 * -0.02 * x * y;
    DVec2::new(60.0 * x2 + 32.0, 70.0 * y2 + 24.0)
}

#[test]
fn opencv_yaml_of_one_camera_a_file() {
    let rotation: Vec<String> = [DVec3::X, DVec3::Y, DVec3::Z]
        .map(|row| {
            [DVec3::X, DVec3::Y, DVec3::Z].map(|column| row.dot(turn(column, AXIS, ANGLE)).to_string()).join(", ")
        })
        .into();
    // As cv::FileStorage writes it, including numbers such as `60.`.
    let text = format!(
        "%YAML:1.0\n---\nimage_width: {WIDTH}\nimage_height: {HEIGHT}\n\
         camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n\
         \x20  data: [ 60., 0., 32., 0., 7.0e+01, 24., 0., 0., 1. ]\n\
         distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n\
         \x20  data: [ 1.0e-01, -5.0e-02, 0.01, -0.02,\n       0.03 ]\n\
         R: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ {} ]\n\
         t: !!opencv-matrix\n   rows: 3\n   cols: 1\n   dt: d\n   data: [ 0.1, -0.2, 3. ]\n",
        rotation.join(", ")
    );
    let folder = source("left.yml", &text, &["images/left.png"], &["masks/left.png"]);
    let scene = import("opencv", folder.path());
    assert_sees(&scene, 0, opencv_pixel());
    assert_eq!(scene["frames"][0]["masks"], json!(["masks/left.png"]));

    fs::write(folder.path().join("left.yml"), text.replace("60.", ".nan")).unwrap();
    let message = refused("opencv", folder.path());
    assert!(message.contains("left.yml") && message.contains("finite"), "{message}");
}

#[test]
fn opencv_json_of_several_cameras() {
    let axis = AXIS * ANGLE;
    let matrix = |rows: u32, data: Value| json!({ "type_id": "opencv-matrix", "rows": rows, "cols": 3, "dt": "d", "data": data });
    let camera = json!({
        "K": matrix(3, json!([60.0, 0.0, 32.0, 0.0, 70.0, 24.0, 0.0, 0.0, 1.0])),
        "D": [[0.1, -0.05, 0.01, -0.02, 0.03]],
        "rvec": [[axis.x], [axis.y], [axis.z]],
        "tvec": [0.1, -0.2, 3.0],
    });
    let mut named = camera.clone();
    named["name"] = json!("a");
    named["image"] = json!("images/first.png");
    let pictures = ["images/first.png", "images/a.png", "images/b.png"];
    for file in [json!({ "b": camera, "a": camera }), json!({ "cameras": [camera_as(&camera, "b"), named] })] {
        let folder = source("rig.json", &file.to_string(), &pictures, &[]);
        let scene = import("opencv", &folder.path().join("rig.json"));
        for i in 0..2 {
            assert_sees(&scene, i, opencv_pixel());
        }
        assert_eq!([&scene["cameras"][0]["name"], &scene["cameras"][1]["name"]], ["b", "a"]);
        assert_eq!(scene["frames"][0]["masks"], json!([null, null]));
    }
}

fn camera_as(camera: &Value, name: &str) -> Value {
    let mut camera = camera.clone();
    camera["name"] = json!(name);
    camera
}
