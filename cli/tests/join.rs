//! `pcmvs join`: parts of a clip become what a single run makes.

use crate::common::{Capture, assert_refused, names, pcmvs, stderr};
use serde_json::{Value, json};
use std::{fs, path::Path, process::Output};

const CAMERAS: usize = 6;

/// Reconstructs some frames into a folder of their own.
fn part(capture: &Capture, name: &str, frames: &str, arguments: &[&str]) {
    fs::write(capture.path("scene.json"), capture.scene.to_string()).unwrap();
    let mut command = pcmvs();
    command.arg("reconstruct").arg(capture.path("")).arg("-o").arg(capture.path(name));
    let output = command.args(["--preset", "hull", "--frames", frames]).args(arguments).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
}

fn join(capture: &Capture, parts: &[&str], arguments: &[&str]) -> Output {
    let mut command = pcmvs();
    command.arg("join").args(parts.iter().map(|part| capture.path(part))).arg("-o").arg(capture.path("clip"));
    command.args(arguments).output().unwrap()
}

/// Asserts that the parts are refused with a message that has these words, and that no clip appears.
#[track_caller]
fn refused(capture: &Capture, parts: &[&str], arguments: &[&str], words: &[&str]) {
    assert_refused(&join(capture, parts, arguments), words);
    assert!(!capture.path("clip/sequence.json").exists());
}

fn change(path: &Path, change: impl FnOnce(&mut Value)) {
    let mut value = serde_json::from_slice(&fs::read(path).unwrap()).unwrap();
    change(&mut value);
    fs::write(path, value.to_string()).unwrap();
}

/// Frames 0 to 4 in three parts, of which two have frame 2.
fn parts() -> Capture {
    let mut capture = Capture::new(CAMERAS, 5);
    capture.scene["fps"] = json!(12);
    part(&capture, "a", "0,2", &["--upright"]);
    part(&capture, "b", "3,4", &["--upright"]);
    part(&capture, "c", "1..2", &["--upright"]);
    capture
}

#[test]
fn the_joined_clip_is_that_of_a_single_run() {
    let capture = parts();
    part(&capture, "single", "0..4", &["--upright"]);
    let output = join(&capture, &["a", "b", "c"], &["--frames", "0..4"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let (clip, single) = (capture.path("clip"), capture.path("single"));
    assert_eq!(names(&clip), names(&single));
    for name in names(&clip).iter().filter(|name| *name != "report.json") {
        assert_eq!(fs::read(clip.join(name)).unwrap(), fs::read(single.join(name)).unwrap(), "{name}");
    }
    let report =
        |folder: &Path| -> Value { serde_json::from_slice(&fs::read(folder.join("report.json")).unwrap()).unwrap() };
    let (joined, whole) = (report(&clip), report(&single));
    for key in ["version", "settings", "cameras", "params", "warnings", "failures"] {
        assert_eq!(joined[key], whole[key], "{key}");
    }
    let hashes =
        |report: &Value| report["frames"].as_array().unwrap().iter().map(|f| f["hashes"].clone()).collect::<Vec<_>>();
    assert_eq!(hashes(&joined), hashes(&whole));

    // A run over the joined clip makes nothing again.
    let mut again = pcmvs();
    again.arg("reconstruct").arg(capture.path("")).arg("-o").arg(&clip).args(["--preset", "hull", "--upright"]);
    let output = again.output().unwrap();
    assert_eq!(stderr(&output).matches("has not changed").count(), 5, "{}", stderr(&output));
}

#[test]
fn what_is_missing_or_has_failed_is_named() {
    let capture = parts();
    refused(&capture, &["a", "b"], &[], &["no part has frames 1"]);
    refused(&capture, &["a", "b", "c"], &["--frames", "0..6"], &["no part has frames 5,6"]);
    change(&capture.path("a/report.json"), |report| {
        report["failures"] = json!([{ "index": 1, "error": "cam03: the mask is black" }]);
    });
    refused(&capture, &["a", "b"], &[], &["frame 1 failed there", "cam03: the mask is black"]);
    // Another part has it, or nobody asks for it.
    for (parts, arguments) in [(&["a", "b", "c"][..], &[][..]), (&["a", "b"], &["--frames", "0,2..4"])] {
        let output = join(&capture, parts, arguments);
        assert!(output.status.success(), "{}", stderr(&output));
    }
    refused_without_report(&capture);
}

fn refused_without_report(capture: &Capture) {
    fs::remove_dir_all(capture.path("clip")).unwrap();
    fs::remove_file(capture.path("b/report.json")).unwrap();
    refused(capture, &["a", "b", "c"], &[], &["report.json"]);
}

#[test]
fn parts_of_other_settings_and_changed_frames_are_refused() {
    let capture = parts();
    part(&capture, "other", "1..2", &["--upright", "--cameras", "0..4"]);
    refused(&capture, &["a", "b", "other"], &[], &["other: is of another scene than"]);
    part(&capture, "lying", "1..2", &[]);
    refused(&capture, &["a", "b", "lying"], &[], &["lying: was made by another build of pcmvs, with other options"]);
    change(&capture.path("c/report.json"), |report| report["version"] = json!("0.0.1"));
    refused(&capture, &["a", "b", "c"], &[], &["c: was made by version 0.0.1"]);

    part(&capture, "c2", "1..2", &["--upright"]);
    fs::write(capture.path("c2/frame_0001.glb"), "else").unwrap();
    refused(&capture, &["a", "b", "c2"], &[], &["frame_0001.glb: has changed"]);
    change(&capture.path("c2/report.json"), |report| report["frames"][1]["sha256"] = json!("0"));
    refused(&capture, &["a", "b", "c2"], &[], &["frame 2 is in", "they differ"]);
}

#[test]
fn a_listed_name_never_leads_out_of_the_output() {
    let capture = parts();
    for name in
        ["../frame_0001.glb", "a/frame_0001.glb", "frame_0001.glb/../x.glb", "/frame_0001.glb", "frame_0002.glb"]
    {
        part(&capture, "c", "1..2", &["--upright"]);
        change(&capture.path("c/report.json"), |report| report["frames"][0]["file"] = json!(name));
        refused(
            &capture,
            &["a", "b", "c"],
            &[],
            &["c/report.json", "lists", name, "frame 1 instead of frame_0001.glb"],
        );
        part(&capture, "c", "1..2", &["--upright"]);
        change(&capture.path("c/sequence.json"), |manifest| manifest["frames"][0]["url"] = json!(name));
        refused(&capture, &["a", "b", "c"], &[], &["c/sequence.json", "lists", name]);
    }
}

#[test]
fn a_part_or_another_clip_is_not_overwritten() {
    let capture = parts();
    let to = |output: &str| {
        let mut command = pcmvs();
        command.arg("join").args(["a", "b", "c"].map(|part| capture.path(part))).arg("-o").arg(capture.path(output));
        command.output().unwrap()
    };
    let before = names(&capture.path("b"));
    assert_refused(&to("b"), &["is one of the parts"]);
    assert_eq!(names(&capture.path("b")), before);
    assert_refused(&to("scene.json"), &["is a file"]);
    part(&capture, "clip", "0", &[]);
    assert_refused(&to("clip"), &["holds another clip"]);
}
