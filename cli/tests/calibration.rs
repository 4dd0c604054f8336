//! `pcmvs check`, `pcmvs refine` and `pcmvs reconstruct --refine`.

use crate::common::{Capture, pcmvs, stderr};
use image::RgbImage;
use serde_json::{Value, json};
use std::{fs, process::Output};

/// Turns a camera's given calibration about its vertical axis, by a share of the distance per unit of distance.
fn turn(capture: &mut Capture, camera: usize, by: f64) {
    let number = |v: &Value| v.as_f64().unwrap();
    let (sine, cosine) = (by, 1.0 - 0.5 * by * by);
    let camera = &mut capture.scene["cameras"][camera];
    let rotate = |x: f64, z: f64| (cosine * x + sine * z, cosine * z - sine * x);
    for column in 0..3 {
        let (x, z) = rotate(number(&camera["R"][0][column]), number(&camera["R"][2][column]));
        (camera["R"][0][column], camera["R"][2][column]) = (x.into(), z.into());
    }
    let (x, z) = rotate(number(&camera["t"][0]), number(&camera["t"][2]));
    (camera["t"][0], camera["t"][2]) = (x.into(), z.into());
}

fn run(capture: &Capture, command: &str, arguments: &[&str]) -> Output {
    fs::write(capture.path("scene.json"), capture.scene.to_string()).unwrap();
    pcmvs().arg(command).arg(capture.path("")).args(arguments).output().unwrap()
}

/// Ten cameras with pictures of 320 x 240, of which `cam03` is off by 7 pixels.
fn bumped(frames: u32) -> Capture {
    let mut capture = Capture::enlarged(10, frames, 5);
    turn(&mut capture, 3, 0.023);
    capture
}

/// Moves a camera's only picture, its mask and its principal point to the right.
fn shift(capture: &mut Capture, camera: usize, pixels: i64) {
    for kind in ["images", "masks"] {
        let path = capture.path(&format!("{kind}/cam{camera:02}_0.png"));
        let picture = image::open(&path).unwrap().into_rgb8();
        let from = |x: u32| (i64::from(x) - pixels).rem_euclid(i64::from(picture.width())) as u32;
        let shifted = |x, y| *picture.get_pixel(from(x), y);
        RgbImage::from_fn(picture.width(), picture.height(), shifted).save(path).unwrap();
    }
    let x = &mut capture.scene["cameras"][camera]["K"][0][2];
    *x = (x.as_f64().unwrap() + pixels as f64).into();
}

#[test]
fn a_good_calibration_passes_the_check_and_is_not_rewritten() {
    let capture = Capture::enlarged(10, 1, 5);
    let output = run(&capture, "check", &["--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["cameras"].as_array().unwrap().len(), 10);
    assert_eq!(report["warnings"].as_array().unwrap().len(), 0);
    let out = capture.path("scene2");
    let output = run(&capture, "refine", &["-o", out.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(!out.exists());
}

#[test]
fn a_bumped_camera_is_named_and_the_refined_scene_opens() {
    let capture = bumped(1);
    let output = run(&capture, "check", &["--json"]);
    assert_eq!(output.status.code(), Some(4), "{}", stderr(&output));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["warnings"][0]["code"], "camera-bumped", "{report}");
    assert_eq!(report["warnings"][0]["camera"], "cam03");
    let out = capture.path("deep/scene2");
    let output = run(&capture, "refine", &["-o", out.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let output = pcmvs().arg("check").arg(&out).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}

#[test]
fn a_refined_scene_finds_its_clean_plates() {
    let capture = bumped(1).with_plates();
    let out = capture.path("deep/scene2");
    let output = run(&capture, "refine", &["--masks", "plates", "-o", out.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let output = pcmvs().arg("check").arg(&out).args(["--masks", "plates"]).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(!stderr(&output).contains("warning"), "{}", stderr(&output));
}

#[test]
fn exchanged_pictures_are_named_and_every_file_is_read_once() {
    let mut capture = Capture::enlarged(10, 1, 5);
    shift(&mut capture, 3, 30);
    shift(&mut capture, 6, -30);
    for kind in ["images", "masks"] {
        let list = capture.scene["frames"][0][kind].as_array_mut().unwrap();
        list.swap(3, 6);
    }
    fs::remove_file(capture.path("masks/cam08_0.png")).unwrap();
    let output = run(&capture, "check", &["--json"]);
    assert_eq!(output.status.code(), Some(4), "{}", stderr(&output));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["exchanged"], json!([3, 6]));
    let codes: Vec<_> = report["warnings"].as_array().unwrap().iter().map(|warning| &warning["code"]).collect();
    assert_eq!(codes, ["cameras-swapped"]);
    assert_eq!(stderr(&output).matches("masks/cam08_0.png").count(), 1, "{}", stderr(&output));
}

#[test]
fn reconstruct_corrects_the_cameras_by_the_whole_clip() {
    let mut capture = bumped(2);
    // The order in scene.json does not matter.
    capture.scene["frames"].as_array_mut().unwrap().reverse();
    let made = |arguments: &[&str]| {
        let output = capture.run(arguments);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        serde_json::from_slice::<Value>(&fs::read(capture.path("out/report.json")).unwrap()).unwrap()
    };
    let given = made(&["--frames", "0"]);
    assert_eq!(given["calibration"], Value::Null);
    let first = made(&["--refine", "--frames", "0"]);
    let found = &first["calibration"];
    assert_eq!((&found["frames"], &found["verdict"]), (&json!([0, 1]), &json!("improved")));
    assert_eq!(
        (&found["warnings"][0]["code"], &found["warnings"][0]["camera"]),
        (&json!("camera-bumped"), &json!("cam03"))
    );
    let miss = |report: &Value| report["frames"][0]["cameras"][3]["contour_px"].as_f64().unwrap();
    assert!(miss(&first) < 0.5 * miss(&given), "{} {}", miss(&first), miss(&given));
    // With the same cameras, the second frame belongs to the same clip as the first.
    let second = made(&["--refine", "--frames", "1"]);
    assert_eq!(second["calibration"], first["calibration"]);
    assert_eq!(second["settings"], first["settings"]);
    assert_eq!(second["frames"].as_array().unwrap().len(), 2);
}

#[test]
fn what_the_calibration_finds_is_an_error_with_strict() {
    let capture = bumped(1);
    let output = capture.run(&["--refine", "--strict"]);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("camera `cam03`") && message.contains("--strict"), "{message}");
    assert!(capture.results().is_empty());
}
