//! `pcmvs pack --manifest`: a clip to publish, in several qualities and in segments.

use crate::common::{Capture, names, pcmvs, stderr};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::{fs, path::PathBuf, process::Output, sync::atomic::AtomicBool};

/// A capture with its frames in `out`, and in `web` another quality of them.
fn finished(web: &[&str]) -> Capture {
    let mut capture = Capture::new(8, 5);
    capture.scene["fps"] = json!(10);
    for (arguments, name) in [(web, "web"), (&[][..], "out")] {
        let output = capture.run(arguments);
        assert!(output.status.success(), "{}", stderr(&output));
        if name != "out" {
            fs::rename(capture.path("out"), capture.path(name)).unwrap();
        }
    }
    fs::write(capture.path("song.m4a"), "a song").unwrap();
    capture
}

fn pack(capture: &Capture, to: &str, arguments: &[&str]) -> Output {
    let mut command = pcmvs();
    command.arg("pack").arg(capture.path("out")).arg("-o").arg(capture.path(to)).args(arguments);
    command.output().unwrap()
}

fn quality(capture: &Capture) -> String {
    format!("--quality=web={}", capture.path("web").display())
}

#[test]
fn every_quality_has_segments_that_are_packed_clips() {
    let capture = finished(&["--compress", "--faces=500"]);
    let song: PathBuf = capture.path("song.m4a");
    let arguments = ["--manifest", &quality(&capture), "--segment=0.2", "--audio", song.to_str().unwrap()];
    for _ in 0..2 {
        let output = pack(&capture, "site", &arguments);
        assert!(output.status.success(), "{}", stderr(&output));
    }
    let bytes = |name: &str| fs::read(capture.path("site").join(name)).unwrap();
    let manifest: Value = serde_json::from_slice(&bytes("sequence.json")).unwrap();
    let expected = ["audio.m4a", "full_000.glb", "full_001.glb", "full_002.glb", "sequence.json", "web_000.glb"];
    assert_eq!(names(&capture.path("site"))[..6], expected);
    assert_eq!(
        [&manifest["version"], &manifest["fps"], &manifest["frame_count"], &manifest["duration"]],
        [&json!(2), &json!(10.0), &json!(5), &json!(0.5)]
    );
    let matches = |file: &Value| {
        let bytes = bytes(file["url"].as_str().unwrap());
        let sha256: String = Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!((&file["bytes"], &file["sha256"]), (&json!(bytes.len()), &json!(sha256)));
        bytes
    };
    assert_eq!(matches(&manifest["audio"]), b"a song");
    assert!(manifest["poster"].is_null());
    let qualities = manifest["qualities"].as_array().unwrap();
    for (quality, (name, folder)) in qualities.iter().zip([("full", "out"), ("web", "web")]) {
        assert_eq!(quality["name"], name);
        let single: Value =
            serde_json::from_slice(&fs::read(capture.path(folder).join("sequence.json")).unwrap()).unwrap();
        let number = |manifest: &Value, end: usize, axis: usize| manifest["bounds"][end][axis].as_f64().unwrap();
        for axis in 0..3 {
            assert!(number(&manifest, 0, axis) <= number(&single, 0, axis), "{name}");
            assert!(number(&manifest, 1, axis) >= number(&single, 1, axis), "{name}");
        }
        let mut size = 0;
        for (i, frames) in ["0,1", "2,3", "4"].iter().enumerate() {
            let segment = &quality["segments"][i];
            let listed =
                segment["frames"].as_array().unwrap().iter().map(Value::to_string).collect::<Vec<_>>().join(",");
            assert_eq!(listed, *frames);
            let seconds = |key: &str| (segment[key].as_f64().unwrap() * 10.0).round();
            assert_eq!([seconds("time"), seconds("duration")], [2.0 * i as f64, if i < 2 { 2.0 } else { 1.0 }]);
            let mut single = pcmvs();
            single.arg("pack").arg(capture.path(folder)).arg("-o").arg(capture.path("single.glb"));
            assert!(single.args(["--frames", frames]).status().unwrap().success());
            let packed = matches(segment);
            assert!(packed == fs::read(capture.path("single.glb")).unwrap(), "{name} {frames}");
            size += packed.len();
        }
        assert_eq!((&quality["segments"][3], &quality["bytes"]), (&Value::Null, &json!(size)));
    }
}

#[test]
fn qualities_that_show_something_else_are_refused_and_nothing_is_written() {
    for (web, words) in [(&["--frames=0..3"][..], "other frames"), (&["--upright"], "another `up` or `rotation`")] {
        let capture = finished(web);
        let output = pack(&capture, "site", &["--manifest", &quality(&capture)]);
        assert_eq!(output.status.code(), Some(2));
        let message = stderr(&output);
        assert!(message.contains(words) && message.contains("quality web"), "{message}");
        assert!(!capture.path("site").exists());
    }
}

#[test]
fn other_manifests_are_not_replaced_and_a_failed_run_leaves_none() {
    let capture = finished(&["--faces=500"]);
    let frames = fs::read(capture.path("out/sequence.json")).unwrap();
    for (to, arguments, words) in [
        ("out", &["--manifest"][..], "not that of a published clip"),
        ("song.m4a", &["--manifest"], "is a file"),
        ("site", &["--manifest", "--poster=missing.jpg"], "missing.jpg: cannot be read"),
        ("site", &["--manifest", "--quality=full=web"], "`full`"),
        ("site", &["--manifest", "--segment=0"], "seconds"),
        ("site", &["--audio=song.m4a"], "--manifest"),
    ] {
        let output = pack(&capture, to, arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(stderr(&output).contains(words), "{}", stderr(&output));
        assert!(!capture.path("site").exists());
    }
    assert_eq!(fs::read(capture.path("out/sequence.json")).unwrap(), frames);

    assert!(pack(&capture, "site", &["--manifest"]).status.success());
    assert_eq!(names(&capture.path("site")), ["full.glb", "sequence.json"]);
    let [out, site] = ["out", "site"].map(|name| capture.path(name).into());
    let arguments = ["pcmvs".into(), "pack".into(), out, "--manifest".into(), "-o".into(), site];
    assert_eq!(pcmvs_cli::run(arguments, &AtomicBool::new(true)), 3);
    assert_eq!(names(&capture.path("site")), ["full.glb"]);
}
