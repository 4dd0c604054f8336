//! Takes: frames as a range with patterns, cameras that several takes share, and cameras that are out of step.

mod common;

use common::{Capture, stderr};
use serde_json::{Value, json};
use std::fs;

/// The capture with its frames as a range.
fn with_range(cameras: usize, frames: u32) -> Capture {
    let mut capture = Capture::new(cameras, frames);
    capture.scene["frames"] = json!({ "first": 0, "last": frames - 1 });
    capture.scene["images"] = json!("images/{camera}_{frame}.png");
    capture.scene["masks"] = json!("masks/{camera}_{frame}.png");
    capture
}

/// The meshes of a run that must succeed.
#[track_caller]
fn meshes(capture: &Capture, arguments: &[&str], indices: &[u32]) -> Vec<Vec<u8>> {
    let output = capture.run(arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    indices.iter().map(|index| fs::read(capture.path(&format!("out/frame_{index:04}.glb"))).unwrap()).collect()
}

fn warnings(capture: &Capture) -> Vec<Value> {
    let report: Value = serde_json::from_slice(&fs::read(capture.path("out/report.json")).unwrap()).unwrap();
    report["warnings"].as_array().unwrap().clone()
}

#[test]
fn a_range_with_patterns_makes_the_meshes_of_the_listed_frames() {
    let listed = meshes(&Capture::new(6, 3), &["--frames", "1,2"], &[1, 2]);
    assert_eq!(meshes(&with_range(6, 3), &["--frames", "1,2"], &[1, 2]), listed);
    // The cameras may stand in a file of their own.
    let mut capture = with_range(6, 3);
    let cameras = capture.scene.as_object_mut().unwrap().remove("cameras").unwrap();
    fs::write(capture.path("rig.json"), json!({ "version": 1, "cameras": cameras }).to_string()).unwrap();
    capture.scene["rig"] = json!("rig.json");
    assert_eq!(meshes(&capture, &["--frames", "1,2"], &[1, 2]), listed);
}

#[test]
fn a_picture_that_is_missing_concerns_its_frame_alone() {
    let capture = with_range(6, 3);
    fs::remove_file(capture.path("images/cam04_1.png")).unwrap();
    meshes(&capture, &[], &[0, 1, 2]);
    let found = warnings(&capture);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0]["code"], "missing-picture");
    assert_eq!((&found[0]["frame"], &found[0]["camera"]), (&json!(1), &json!("cam04")));
    assert!(found[0]["message"].as_str().unwrap().contains("images/cam04_1.png"));
    // A frame without pictures fails, and the others do not.
    for camera in 0..6 {
        let _ = fs::remove_file(capture.path(&format!("images/cam{camera:02}_1.png")));
    }
    let output = capture.run(&[]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("frame 1: ") && stderr(&output).contains("1 of 3 frames failed"));
    assert_eq!(
        capture.results(),
        ["frame_0000.glb", "frame_0001.glb", "frame_0002.glb", "report.json", "sequence.json"]
    );
}

#[test]
fn a_frame_that_is_not_in_the_range_is_refused() {
    let output = with_range(4, 2).run(&["--frames", "1,2"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("has no frame 2"), "{}", stderr(&output));
}

#[test]
fn an_offset_brings_a_camera_into_step() {
    let right = meshes(&Capture::new(6, 3), &["--frames", "1"], &[1]);
    let mut capture = with_range(6, 3);
    // Pictures of `cam02` under the number of the frame before.
    for kind in ["images", "masks"] {
        let path = |frame: u32| capture.path(&format!("{kind}/cam02_{frame}.png"));
        for frame in 1..3 {
            fs::rename(path(frame), path(frame - 1)).unwrap();
        }
    }
    assert_ne!(meshes(&capture, &["--frames", "1"], &[1]), right);
    capture.scene["offsets"] = json!({ "cam02": -1 });
    assert_eq!(meshes(&capture, &["--frames", "1"], &[1]), right);
}
