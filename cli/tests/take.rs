//! Takes: frames as a range with patterns, cameras that several takes share, and cameras that are out of step.

use crate::common::{Capture, HEIGHT, WIDTH, pcmvs, stderr};
use image::{GrayImage, Luma};
use serde_json::{Value, json};
use std::fs;

/// The capture with its frames as a range.
fn with_range(cameras: usize, frames: u32) -> Capture {
    enlarged_with_range(cameras, frames, 1)
}

/// The same with pictures that are this many times as wide and high.
fn enlarged_with_range(cameras: usize, frames: u32, scale: u32) -> Capture {
    let mut capture = Capture::enlarged(cameras, frames, scale);
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
    let one = &["--frames", "1", "--alone"];
    let right = meshes(&Capture::new(6, 3), one, &[1]);
    let mut capture = with_range(6, 3);
    // Pictures of `cam02` under the number of the frame before.
    for kind in ["images", "masks"] {
        let path = |frame: u32| capture.path(&format!("{kind}/cam02_{frame}.png"));
        for frame in 1..3 {
            fs::rename(path(frame), path(frame - 1)).unwrap();
        }
    }
    assert!(meshes(&capture, one, &[1]) != right);
    capture.scene["offsets"] = json!({ "cam02": -1 });
    assert!(meshes(&capture, one, &[1]) == right);
}

/// A capture whose silhouettes are those of a ball that moves by some pixels per frame. Those of `cam03` are late by a frame.
fn moving(speed: f64) -> Capture {
    const SCALE: u32 = 3;
    let capture = Capture::enlarged(8, 6, SCALE);
    let number = |v: &Value| v.as_f64().unwrap();
    for (i, camera) in capture.scene["cameras"].as_array().unwrap().iter().enumerate() {
        for frame in 0..6 {
            let time = f64::from(frame) - if i == 3 { 1.0 } else { 0.0 };
            let centre = [0.2 * speed * (time - 2.0), 0.1 * speed * (time - 2.0), 0.0];
            let seen = |row: usize| -> f64 {
                number(&camera["t"][row]) + (0..3).map(|i| number(&camera["R"][row][i]) * centre[i]).sum::<f64>()
            };
            let (depth, focal) = (seen(2), number(&camera["K"][0][0]));
            let [x, y] = [0, 1].map(|axis| number(&camera["K"][axis][2]) + focal * seen(axis) / depth);
            let radius = focal / depth;
            let inside = |u: u32, v: u32| (f64::from(u) - x).powi(2) + (f64::from(v) - y).powi(2) < radius * radius;
            let mask =
                GrayImage::from_fn(WIDTH * SCALE, HEIGHT * SCALE, |u, v| Luma([if inside(u, v) { 255 } else { 0 }]));
            mask.save(capture.path(&format!("masks/cam{i:02}_{frame}.png"))).unwrap();
        }
    }
    capture
}

/// The report of `pcmvs check`, and what it prints.
fn checked(capture: &Capture) -> (Value, String) {
    fs::write(capture.path("scene.json"), capture.scene.to_string()).unwrap();
    let output = pcmvs().arg("check").arg(capture.path("")).arg("--json").output().unwrap();
    (serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", stderr(&output))), stderr(&output))
}

fn time_offsets(report: &Value) -> Vec<&Value> {
    report["cameras"].as_array().unwrap().iter().map(|camera| &camera["time_offset"]).collect()
}

#[test]
fn the_check_finds_a_camera_that_is_late_and_what_brings_it_into_step() {
    let mut capture = moving(1.0);
    let (report, printed) = checked(&capture);
    assert_eq!(time_offsets(&report), [0, 0, 0, 1, 0, 0, 0, 0], "{printed}");
    let first = &report["warnings"][0];
    assert_eq!((&first["code"], &first["camera"]), (&json!("out-of-step"), &json!("cam03")));
    assert!(printed.contains(r#""offsets": {"cam03":1}"#), "{printed}");
    capture.scene["offsets"] = json!({ "cam03": 1 });
    let (report, printed) = checked(&capture);
    assert_eq!(time_offsets(&report), [0; 8], "{printed}");
    assert!(!printed.contains("frame behind"), "{printed}");
}

#[test]
fn frames_in_which_nothing_moves_do_not_tell_who_is_in_step() {
    let (report, printed) = checked(&moving(0.0));
    assert_eq!(time_offsets(&report), [&Value::Null; 8]);
    assert!(printed.contains("do not tell of 8 of 8 cameras"), "{printed}");
}

#[test]
fn a_change_remakes_the_frames_that_it_touches() {
    let mut capture = with_range(5, 4);
    let kept = |capture: &Capture, arguments: &[&str]| {
        let output = capture.run(arguments);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let message = stderr(&output);
        (0..4).filter(|index| message.contains(&format!("frame {index} has not changed"))).collect::<Vec<_>>()
    };
    assert_eq!(kept(&capture, &[]), [0; 0]);
    fs::copy(capture.path("images/cam01_0.png"), capture.path("images/cam01_2.png")).unwrap();
    // The frames before and after are averaged with it.
    assert_eq!(kept(&capture, &[]), [0], "a picture");
    capture.mask("masks/cam03_1.png", 31.5, 13.0);
    assert_eq!(kept(&capture, &[]), [3], "a mask");
    fs::remove_file(capture.path("masks/cam00_3.png")).unwrap();
    assert_eq!(kept(&capture, &[]), [0, 1], "a mask that is no longer there");
    // For cam04, frame f now shows what frame f + 1 showed. There is no picture 4.
    capture.scene["offsets"] = json!({ "cam04": 1 });
    assert_eq!(kept(&capture, &[]), [0; 0], "an offset");
    capture.scene["fps"] = json!(50);
    capture.scene["frames"] = json!({ "first": 1, "last": 3 });
    // Frame 1 has no frame before it any more. Its mask is bad, so that frame 2 has looked at frame 0.
    let report: Value = serde_json::from_slice(&fs::read(capture.path("out/report.json")).unwrap()).unwrap();
    let looked_at: Vec<&Value> = (0..4).map(|frame| &report["frames"][frame]["beyond"]).collect();
    assert_eq!(looked_at, [&Value::Null, &Value::Null, &json!([0]), &Value::Null]);
    assert_eq!(kept(&capture, &[]), [3], "what no other mesh depends on");
    capture.scene["cameras"][2]["t"][0] = json!(capture.scene["cameras"][2]["t"][0].as_f64().unwrap() + 1e-3);
    assert_eq!(kept(&capture, &[]), [0; 0], "a camera");
    assert_eq!(kept(&capture, &["--set", "hull.voxel_pixels=1.7"]), [0; 0], "a parameter");
    assert_eq!(kept(&capture, &["--set", "hull.voxel_pixels=1.7"]), [1, 2, 3]);
}

/// A capture whose silhouettes differ from frame to frame.
fn flickering(frames: u32) -> Capture {
    let capture = with_range(6, frames);
    for frame in 0..frames {
        for camera in 0..6 {
            let radius = 12.0 + ((3 * frame + 5 * camera) % 7) as f32 / 14.0;
            capture.mask(&format!("masks/cam{camera:02}_{frame}.png"), 31.5, radius);
        }
    }
    capture
}

#[test]
fn a_frame_is_averaged_with_those_before_and_after_it() {
    let capture = flickering(5);
    let all = [0, 1, 2, 3, 4];
    let averaged = meshes(&capture, &["--threads", "1"], &all);
    // The bytes do not depend on what else is made, nor on threads.
    for arguments in [&["--frames", "2"][..], &["--frames", "2,3", "--threads", "3"]] {
        fs::remove_dir_all(capture.path("out")).unwrap();
        assert!(meshes(&capture, arguments, &[2])[0] == averaged[2], "{arguments:?}");
        assert!(!capture.path("out/frame_0001.glb").exists());
    }
    let alone = meshes(&capture, &["--alone"], &all);
    assert!(all.into_iter().all(|frame| alone[frame as usize] != averaged[frame as usize]));
    for preset in ["paper", "preview"] {
        let single = meshes(&capture, &["--preset", preset, "--alone"], &all);
        assert!(meshes(&capture, &["--preset", preset], &all) == single, "{preset}");
    }
    // Frames with a gap between them are no neighbours.
    let mut gap = flickering(5);
    gap.scene["frames"] = json!([{ "index": 0 }, { "index": 2 }, { "index": 4 }]);
    let frames = gap.scene["frames"].as_array_mut().unwrap();
    for frame in frames {
        for kind in ["images", "masks"] {
            let path = |camera: u32| format!("{kind}/cam{camera:02}_{}.png", frame["index"]);
            let paths: Vec<String> = (0..6).map(path).collect();
            frame[kind] = json!(paths);
        }
    }
    for key in ["images", "masks"] {
        gap.scene.as_object_mut().unwrap().remove(key);
    }
    assert!(meshes(&gap, &[], &[2])[0] == alone[2]);
}

#[test]
fn a_frame_whose_neighbour_fails_is_made_without_it() {
    let capture = flickering(4);
    let whole = meshes(&capture, &[], &[0, 1, 2, 3]);
    let picture = capture.path("images/cam03_1.png");
    let bytes = fs::read(&picture).unwrap();
    fs::write(&picture, "this is text").unwrap();
    let output = capture.run(&[]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    let made = |frame: u32| fs::read(capture.path(&format!("out/frame_{frame:04}.glb"))).unwrap();
    assert!(made(0) != whole[0] && made(2) != whole[2] && made(3) == whole[3]);
    // Also if only the neighbour is asked for, and not without a word.
    let without = made(2);
    fs::remove_dir_all(capture.path("out")).unwrap();
    let output = capture.run(&["--frames", "2"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let message = stderr(&output);
    assert!(message.contains("frame 1: camera `cam03`") && message.contains("averaged without it"), "{message}");
    assert!(made(2) == without);
    // Once it can be made, its neighbours are made again.
    fs::write(&picture, bytes).unwrap();
    assert!(meshes(&capture, &[], &[0, 1, 2, 3]) == whole);
}

/// A ball of few colours, such as a limb has, before a wall that is not as plain as that of pictures that are cut out.
fn before_a_wall(frames: u32) -> Capture {
    let capture = enlarged_with_range(8, frames, 3);
    for name in (0..8).flat_map(|camera| (0..frames).map(move |frame| format!("cam{camera:02}_{frame}.png"))) {
        let path = capture.path(&format!("images/{name}"));
        let mut picture = image::open(&path).unwrap().into_rgb8();
        let mask = image::open(capture.path(&format!("masks/{name}"))).unwrap().into_luma8();
        for (x, y, pixel) in picture.enumerate_pixels_mut() {
            let [shade, ..] = pixel.0;
            let colour = [200 + shade / 8, 140 + shade / 8, 110 + shade / 8];
            let wall = 40 + ((7 * x + 13 * y) % 11) as u8;
            pixel.0 = if mask.get_pixel(x, y).0[0] > 0 { colour } else { [wall; 3] };
        }
        picture.save(&path).unwrap();
    }
    capture
}

/// Takes the upper part of the ball out of all masks of a frame.
fn erase_top(capture: &Capture, frame: u32) {
    for camera in 0..8 {
        let path = capture.path(&format!("masks/cam{camera:02}_{frame}.png"));
        let mut mask = image::open(&path).unwrap().into_luma8();
        mask.enumerate_pixels_mut().filter(|(_, y, _)| *y < 60).for_each(|(_, _, pixel)| pixel.0[0] = 0);
        mask.save(&path).unwrap();
    }
}

/// The highest coordinate of a frame that is alone in the report or stands there in its order.
fn highest(capture: &Capture, frame: u32) -> f64 {
    let report: Value = serde_json::from_slice(&fs::read(capture.path("out/report.json")).unwrap()).unwrap();
    let frames = report["frames"].as_array().unwrap();
    let found = frames.iter().find(|found| found["index"] == json!(frame)).expect("the frame was made");
    found["bounds"][1][2].as_f64().unwrap()
}

/// The upper part of the ball is missing in all masks of one frame, and shown by all of its pictures.
#[test]
fn a_part_that_the_masks_of_one_frame_lack_comes_back_from_the_frames_beside_it() {
    let (capture, all) = (before_a_wall(4), [0, 1, 2, 3]);
    let complete = meshes(&capture, &["--threads", "1"], &all);
    assert_eq!(warnings(&capture), [Value::Null; 0]);
    let top = highest(&capture, 2);
    erase_top(&capture, 2);
    let alone = meshes(&capture, &["--alone"], &[2]);
    assert!(highest(&capture, 2) < top - 0.2, "{} instead of {top}", highest(&capture, 2));
    // The terminal tells of what was written, and nothing of the attempt before.
    let output = capture.run(&["--threads", "1"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let message = stderr(&output);
    assert!(message.contains("frame 2 is made again"), "{message}");
    let said = message.matches("warning: ").count();
    assert_eq!(said, warnings(&capture).len(), "{message}");
    assert_eq!(message.matches("in the frames before and after").count(), said, "{message}");
    let restored = meshes(&capture, &["--threads", "1"], &all);
    assert!((highest(&capture, 2) - top).abs() < 0.1, "{} instead of {top}", highest(&capture, 2));
    assert!(restored[2] != alone[0]);
    assert!(restored[0] == complete[0], "a frame that is not beside it has changed");
    let found = warnings(&capture);
    assert!(found.len() >= 6, "{found:?}");
    for warning in found {
        assert_eq!((&warning["code"], &warning["frame"]), (&json!("silhouette-restored"), &json!(2)));
        assert!(warning["message"].as_str().unwrap().contains("_2.png"));
    }
    for arguments in [&["--threads", "2"][..], &["--frames", "2"]] {
        fs::remove_dir_all(capture.path("out")).unwrap();
        assert!(meshes(&capture, arguments, &[2])[0] == restored[2], "{arguments:?}");
    }
}

/// The upper part of the ball is missing in all masks of two frames in a row.
#[test]
fn a_part_that_the_masks_of_two_frames_lack_comes_back_from_the_frames_around_them() {
    let (capture, all) = (before_a_wall(6), [0, 1, 2, 3, 4, 5]);
    let complete = meshes(&capture, &["--threads", "1"], &all);
    let tops = [2, 3].map(|frame| highest(&capture, frame));
    [2, 3].iter().for_each(|&frame| erase_top(&capture, frame));
    let restored = meshes(&capture, &["--threads", "1"], &all);
    for (frame, top) in [2, 3].into_iter().zip(tops) {
        let found = highest(&capture, frame);
        assert!((found - top).abs() < 0.1, "frame {frame}: {found} instead of {top}");
    }
    for frame in [0, 5] {
        assert!(restored[frame] == complete[frame], "frame {frame} is not beside a frame that has changed");
    }
    let found = warnings(&capture);
    for frame in [2, 3] {
        let of_frame =
            |warning: &&Value| warning["frame"] == json!(frame) && warning["code"] == json!("silhouette-restored");
        assert!(found.iter().filter(of_frame).count() >= 6, "{found:?}");
    }
    // The same bytes in other orders of the work, and if the frames around are not asked for.
    fs::remove_dir_all(capture.path("out")).unwrap();
    assert!(meshes(&capture, &["--threads", "3"], &all) == restored);
    for frame in [2, 3] {
        fs::remove_dir_all(capture.path("out")).unwrap();
        let output = capture.run(&["--frames", &frame.to_string()]);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(0), "{message}");
        let other = if frame == 2 { 4 } else { 1 };
        assert!(message.contains(&format!("frame {other} is made, too")), "{message}");
        assert!(fs::read(capture.path(&format!("out/frame_{frame:04}.glb"))).unwrap() == restored[frame]);
    }
    // A rerun keeps the frame, unless a frame changes that it has looked at.
    let again = || stderr(&capture.run(&["--frames", "3"]));
    assert!(again().contains("frame 3 has not changed"));
    erase_top(&capture, 5);
    assert!(again().contains("frame 3 has not changed"), "frame 5 was not looked at");
    erase_top(&capture, 1);
    assert!(!again().contains("frame 3 has not changed"), "frame 1 was looked at");
}
