//! `pcmvs check`, `pcmvs refine` and `pcmvs reconstruct --refine`.

mod common;

use common::{Capture, pcmvs, stderr};
use serde_json::Value;
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

/// Ten cameras with pictures of 320 x 240, of which one is off by 7 pixels.
fn bumped() -> Capture {
    let mut capture = Capture::enlarged(10, 1, 5);
    turn(&mut capture, 3, 0.023);
    capture
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
    let capture = bumped();
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
