//! Wrong input gives exit status 2, a message that names file and remedy, and no file under a final name.

use crate::common::{self, Capture, names, pcmvs};
use image::RgbImage;
use serde_json::json;
use std::{fs, process::Output};

#[track_caller]
fn assert_refused(capture: &Capture, output: &Output, words: &[&str]) {
    common::assert_refused(output, words);
    assert_eq!(capture.results(), [""; 0]);
}

#[test]
fn a_number_that_is_not_finite() {
    for (number, place) in [("NaN", "line"), ("1e999", "line"), ("Infinity", "line")] {
        let mut capture = Capture::new(4, 1);
        capture.scene["cameras"][1]["K"][0][0] = json!(123_456.5);
        let text = serde_json::to_string_pretty(&capture.scene).unwrap().replace("123456.5", number);
        fs::write(capture.path("scene.json"), text).unwrap();
        let output = capture.run_as_written(&[]);
        assert_refused(&capture, &output, &["scene.json", "cam01", place, "finite"]);
    }
}

#[test]
fn a_singular_matrix() {
    let mut capture = Capture::new(4, 1);
    capture.scene["cameras"][2]["K"][1][1] = json!(0.0);
    assert_refused(&capture, &capture.run(&[]), &["scene.json", "cam02", "singular"]);
}

#[test]
fn a_reflected_rotation() {
    let mut capture = Capture::new(4, 1);
    for column in 0..3 {
        let value = capture.scene["cameras"][3]["R"][1][column].as_f64().unwrap();
        capture.scene["cameras"][3]["R"][1][column] = json!(-value);
    }
    assert_refused(&capture, &capture.run(&[]), &["scene.json", "cam03", "reflects", "negate"]);
}

#[test]
fn a_picture_of_another_size() {
    let capture = Capture::new(4, 1);
    RgbImage::new(32, 24).save(capture.path("images/cam01_0.png")).unwrap();
    let words = ["frame 0", "cam01", "images/cam01_0.png", "32 x 24", "64 x 48"];
    assert_refused(&capture, &capture.run(&[]), &words);
}

#[test]
fn a_mask_of_another_size() {
    let capture = Capture::new(4, 1);
    RgbImage::new(32, 24).save(capture.path("masks/cam01_0.png")).unwrap();
    assert_refused(&capture, &capture.run(&[]), &["frame 0", "cam01", "masks/cam01_0.png", "32 x 24"]);
}

#[test]
fn a_file_that_is_no_picture() {
    let capture = Capture::new(4, 1);
    fs::write(capture.path("images/cam02_0.png"), "this is text").unwrap();
    assert_refused(&capture, &capture.run(&[]), &["frame 0", "cam02", "images/cam02_0.png", "neither JPEG nor PNG"]);
}

#[test]
fn a_truncated_picture() {
    let mut capture = Capture::new(4, 1);
    let png = fs::read(capture.path("images/cam00_0.png")).unwrap();
    let jpeg = include_bytes!("data/waves.jpg");
    capture.scene["frames"][0]["images"][1] = json!("images/cut");
    for file in [&png[..], jpeg] {
        // Most JPEG decoders do not notice when only the end is cut off.
        for length in [file.len() / 3, file.len() - 40, file.len() - 2, file.len() - 1] {
            if file[0] == 0xFF || length < file.len() - 12 {
                fs::write(capture.path("images/cut"), &file[..length]).unwrap();
                assert_refused(&capture, &capture.run(&[]), &["frame 0", "cam01", "images/cut", "truncated"]);
            }
        }
    }
}

#[test]
fn masks_that_are_white_on_the_background() {
    let capture = Capture::new(4, 1);
    for i in 0..4 {
        capture.inverted_mask(&format!("masks/cam{i:02}_0.png"));
    }
    assert_refused(
        &capture,
        &capture.run(&[]),
        &["frame 0", "scene.json", "4 of 4", "white on the background: inverted?"],
    );
}

#[test]
fn axes_of_opengl() {
    let mut capture = Capture::new(4, 1);
    for camera in capture.scene["cameras"].as_array_mut().unwrap() {
        for row in 1..3 {
            camera["t"][row] = json!(-camera["t"][row].as_f64().unwrap());
            for column in 0..3 {
                camera["R"][row][column] = json!(-camera["R"][row][column].as_f64().unwrap());
            }
        }
    }
    assert_refused(&capture, &capture.run(&[]), &["scene.json", "look away", "OpenGL (y up, z backward)", "negate"]);
}

#[test]
fn parallel_axes() {
    let mut capture = Capture::new(4, 1);
    for i in 0..4 {
        capture.scene["cameras"][i]["R"] = json!([[1, 0, 0], [0, 0, -1], [0, 1, 0]]);
        capture.scene["cameras"][i]["t"] = json!([0.5 * i as f64, 0, 4]);
    }
    assert_refused(&capture, &capture.run(&[]), &["scene.json", "axes are parallel", "turn the cameras"]);
}

#[test]
fn silhouettes_that_do_not_meet() {
    let capture = Capture::new(4, 1);
    for i in 0..4 {
        capture.mask(&format!("masks/cam{i:02}_0.png"), 4.0, 3.0);
    }
    assert_refused(&capture, &capture.run(&[]), &["frame 0", "scene.json", "hull is empty"]);
}

#[test]
fn too_few_views() {
    let capture = Capture::new(2, 1);
    assert_refused(&capture, &capture.run(&[]), &["scene.json", "2 views", "at least 3"]);
    let capture = Capture::new(4, 1);
    assert_refused(&capture, &capture.run(&["--cameras", "0,1"]), &["scene.json", "2 views", "--cameras"]);
    let mut capture = Capture::new(4, 1);
    capture.scene["frames"][0]["images"][1] = json!(null);
    capture.scene["frames"][0]["masks"][2] = json!(null);
    let words = ["frame 0", "scene.json", "2 of 4 views", "at least 3", "warning: frame 0: camera `cam01`", "`cam02`"];
    assert_refused(&capture, &capture.run(&[]), &words);
}

#[test]
fn a_missing_scene() {
    let capture = Capture::new(4, 1);
    assert_refused(&capture, &capture.run_as_written(&[]), &["scene.json", "cannot be read"]);
}

#[test]
fn a_scene_that_is_not_one() {
    let change = |edit: fn(&mut serde_json::Value), words: &[&str]| {
        let mut capture = Capture::new(4, 1);
        edit(&mut capture.scene);
        assert_refused(&capture, &capture.run(&[]), words);
    };
    change(|s| s["version"] = json!(2), &["scene.json", "version 2"]);
    change(|s| s["version"] = json!(null), &["scene.json", "`version` is missing"]);
    change(|s| s["cameras"][1]["K"] = json!([[1, 0, 0], [0, 1, 0]]), &["cameras[1].K", "cam01", "length 2"]);
    change(|s| s["cameras"][1]["t"] = json!([1, 2, "3"]), &["cameras[1].t[2]", "cam01", "string"]);
    change(|s| drop(s["cameras"][1].as_object_mut().unwrap().remove("R")), &["cameras[1]", "cam01", "missing field"]);
    change(|s| s["cameras"][1]["distortion"] = json!([0, 0, 0, 0, 0, 0.5]), &["cam01", "has 4, 5, 8 or 12"]);
    change(|s| drop(s["frames"][0]["images"].as_array_mut().unwrap().pop()), &["frame 0", "3 images for 4 cameras"]);
    change(|s| drop(s["frames"][0]["masks"].as_array_mut().unwrap().pop()), &["frame 0", "3 masks for 4 cameras"]);
    change(|s| s["frames"] = json!([]), &["no cameras or no frames"]);
    change(|s| s["frames"] = json!([s["frames"][0], s["frames"][0]]), &["frame 0 occurs twice"]);
}

#[test]
fn usage() {
    let capture = Capture::new(4, 1);
    assert_refused(&capture, &capture.run(&["--frames", "5"]), &["--frames 5", "no frame 5"]);
    assert_refused(&capture, &capture.run(&["--cameras", "0,1,9"]), &["--cameras 9", "cameras 0 to 3"]);
    assert_refused(&capture, &capture.run(&["--frames", "3..1"]), &["--frames", "3..1"]);
    assert_refused(&capture, &capture.run(&["--threads", "0"]), &["--threads"]);
    let file = capture.path("scene.json");
    let output = pcmvs().arg("reconstruct").arg(&file).arg("-o").arg(&file).output().unwrap();
    assert_refused(&capture, &output, &["is a file"]);
    assert!(!names(&capture.path("")).iter().any(|name| name.ends_with(".tmp")));
    assert_eq!(pcmvs().arg("--help").output().unwrap().status.code(), Some(0));
    assert_eq!(pcmvs().arg("nonsense").output().unwrap().status.code(), Some(2));
}
