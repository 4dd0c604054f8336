//! What is wrong with a frame without making it impossible is a warning: on the terminal, in report.json, and an error with
//! `--strict`.

use crate::common::{Capture, HEIGHT, WIDTH, stderr};
use image::{GrayAlphaImage, GrayImage, ImageBuffer, Luma, LumaA, Rgb, RgbImage, Rgba, RgbaImage};
use serde_json::{Value, json};
use std::{fs, path::Path};

fn report(capture: &Capture) -> Value {
    serde_json::from_slice(&fs::read(capture.path("out/report.json")).unwrap()).unwrap()
}

/// Runs, and checks that the only warnings are those with the given codes, each about `cam02` and with the words in its
/// message, in report.json and on the terminal alike. The answer is the report.
#[track_caller]
fn assert_warns(capture: &Capture, codes: &[&str], words: &[&str]) -> Value {
    assert_warns_with(capture, &[], codes, words)
}

/// The same for a run with more arguments.
#[track_caller]
fn assert_warns_with(capture: &Capture, arguments: &[&str], codes: &[&str], words: &[&str]) -> Value {
    let output = capture.run(arguments);
    let (message, report) = (stderr(&output), report(capture));
    assert_eq!(output.status.code(), Some(0), "{message}");
    let warnings = report["warnings"].as_array().unwrap();
    let found: Vec<&str> = warnings.iter().map(|warning| warning["code"].as_str().unwrap()).collect();
    assert_eq!(found, codes);
    for warning in warnings {
        assert_eq!(warning["camera"], "cam02");
        let text = warning["message"].as_str().unwrap();
        assert!(words.iter().all(|word| text.contains(word)), "{text}");
        assert!(message.contains(&format!("warning: {text}\n")), "{text} is missing in {message}");
    }
    report
}

/// Whether each camera of the first frame is used.
fn used(report: &Value) -> Vec<bool> {
    let cameras = report["frames"][0]["cameras"].as_array().unwrap();
    cameras.iter().map(|camera| camera["used"].as_bool().unwrap()).collect()
}

const ALL_BUT_CAM02: [bool; 5] = [true, true, false, true, true];

#[test]
fn a_sound_frame_has_figures_and_no_warnings() {
    let capture = Capture::new(5, 1);
    let report = assert_warns(&capture, &[], &[]);
    assert_eq!(used(&report), [true; 5]);
    for (i, camera) in report["frames"][0]["cameras"].as_array().unwrap().iter().enumerate() {
        assert_eq!(camera["name"], format!("cam{i:02}"));
        // At a radius of 14 pixels, a tenth of a pixel is 1.4 % of the area.
        assert!(camera["silhouette_overlap"].as_f64().is_some_and(|overlap| overlap > 0.95), "{camera}");
        assert!(camera["contour_px"].as_f64().is_some_and(|pixels| pixels < 0.5), "{camera}");
        // Five small pictures have too few matches.
        assert_eq!(camera["epipolar_px"], json!(null));
    }
}

#[test]
fn a_null_picture() {
    let mut capture = Capture::new(5, 2);
    capture.scene["frames"][0]["images"][2] = json!(null);
    let report = assert_warns(&capture, &["no-picture"], &["frame 0", "cam02", "no picture"]);
    assert_eq!(used(&report), ALL_BUT_CAM02);
    assert_eq!(report["frames"][0]["cameras"][2]["silhouette_overlap"], json!(null));
    assert_eq!(report["warnings"][0]["frame"], 0);
}

#[test]
fn a_missing_picture() {
    let capture = Capture::new(5, 1);
    fs::remove_file(capture.path("images/cam02_0.png")).unwrap();
    let words = ["frame 0", "cam02", "images/cam02_0.png", "does not exist", "check the path"];
    assert_eq!(used(&assert_warns(&capture, &["missing-picture"], &words)), ALL_BUT_CAM02);
}

/// Capture programs write empty files, and databases empty paths, for pictures that were dropped.
#[test]
fn an_empty_picture_and_an_empty_path() {
    let capture = Capture::new(5, 1);
    fs::write(capture.path("images/cam02_0.png"), []).unwrap();
    let words = ["frame 0", "cam02", "images/cam02_0.png", "the file is empty", "contributes nothing"];
    assert_eq!(used(&assert_warns(&capture, &["missing-picture"], &words)), ALL_BUT_CAM02);
    let mut capture = Capture::new(5, 1);
    capture.scene["frames"][0]["images"][2] = json!("");
    assert_eq!(used(&assert_warns(&capture, &["missing-picture"], &["the path is empty"])), ALL_BUT_CAM02);
}

/// Masks of 0 and 1, of a palette's dark colour, and of 12 bits in 16 are those of black and white.
#[test]
fn masks_whose_white_is_dark_give_the_same_mesh() {
    let capture = Capture::new(5, 1);
    assert_eq!(capture.run(&[]).status.code(), Some(0));
    // Without contours between pixels.
    let sharp = |camera: usize| {
        let mask = image::open(capture.path(&format!("masks/cam0{camera}_0.png"))).unwrap().into_luma8();
        ImageBuffer::from_fn(WIDTH, HEIGHT, |x, y| Luma([u8::from(mask.get_pixel(x, y)[0] >= 128)]))
    };
    let ones: Vec<GrayImage> = (0..5).map(sharp).collect();
    let run = |write: &dyn Fn(&GrayImage, &Path)| {
        for (camera, ones) in ones.iter().enumerate() {
            write(ones, &capture.path(&format!("masks/cam0{camera}_0.png")));
        }
        fs::remove_dir_all(capture.path("out")).unwrap();
        assert_warns(&capture, &[], &[]);
        fs::read(capture.path("out/frame_0000.glb")).unwrap()
    };
    let white = |ones: &GrayImage, path: &Path| {
        ImageBuffer::from_fn(WIDTH, HEIGHT, |x, y| Luma([255 * ones.get_pixel(x, y)[0]])).save(path).unwrap();
    };
    let usual = run(&white);
    assert!(run(&|ones, path| ones.save(path).unwrap()) == usual, "0 and 1");
    assert!(
        run(&|ones, path| {
            let red = |x, y| Rgb([128 * ones.get_pixel(x, y)[0], 0, 0]);
            RgbImage::from_fn(WIDTH, HEIGHT, red).save(path).unwrap();
        }) == usual,
        "dark red"
    );
    assert!(
        run(&|ones, path| {
            let twelve = |x, y| Luma([4095 * u16::from(ones.get_pixel(x, y)[0])]);
            ImageBuffer::from_fn(WIDTH, HEIGHT, twelve).save(path).unwrap();
        }) == usual,
        "12 bits"
    );
}

#[test]
fn a_missing_mask() {
    let capture = Capture::new(5, 1);
    fs::remove_file(capture.path("masks/cam02_0.png")).unwrap();
    let words = ["frame 0", "cam02", "masks/cam02_0.png", "does not carve"];
    assert_eq!(used(&assert_warns(&capture, &["missing-mask"], &words)), [true; 5]);
}

#[test]
fn a_missing_clean_plate() {
    let capture = Capture::new(5, 1).with_plates();
    fs::remove_file(capture.path("plate_cam02.png")).unwrap();
    let words = ["frame 0", "cam02", "plate_cam02.png", "does not carve"];
    let report = assert_warns_with(&capture, &["--masks", "plates"], &["missing-plate"], &words);
    assert_eq!(used(&report), [true; 5]);
}

#[test]
fn a_null_mask() {
    let mut capture = Capture::new(5, 1);
    capture.scene["frames"][0]["masks"][2] = json!(null);
    assert_eq!(used(&assert_warns(&capture, &["no-silhouette"], &["cam02", "give it a mask"])), [true; 5]);
}

#[test]
fn masks_that_are_black_white_or_inverted() {
    let capture = Capture::new(5, 1);
    let mask = "masks/cam02_0.png";
    capture.mask(mask, 31.5, 0.0);
    assert_eq!(
        used(&assert_warns(&capture, &["empty-silhouette"], &["cam02", mask, "white on the object"])),
        ALL_BUT_CAM02
    );
    capture.mask(mask, 31.5, 1000.0);
    assert_eq!(
        used(&assert_warns(&capture, &["full-silhouette"], &["cam02", mask, "black on the background"])),
        [true; 5]
    );
    capture.mask(mask, 31.5, 14.0);
    capture.inverted_mask(mask);
    assert_eq!(used(&assert_warns(&capture, &["mask-inverted"], &["cam02", mask, "invert it"])), ALL_BUT_CAM02);
}

#[test]
fn an_object_beside_the_picture() {
    let mut capture = Capture::new(5, 1);
    capture.scene["frames"][0]["masks"][2] = json!(null);
    capture.scene["cameras"][2]["K"][0][2] = json!(-100.0);
    assert_eq!(used(&assert_warns(&capture, &["object-beside-picture"], &["cam02", "beside"])), ALL_BUT_CAM02);
}

#[test]
fn two_cameras_at_the_same_place() {
    let mut capture = Capture::new(5, 1);
    capture.scene["cameras"][2] = capture.scene["cameras"][1].clone();
    capture.scene["cameras"][2]["name"] = json!("cam02");
    let report = assert_warns(&capture, &["same-place"], &["cam02", "cam01", "same place"]);
    assert_eq!(report["warnings"][0]["frame"], json!(null));
    assert_eq!(capture.run(&["--strict"]).status.code(), Some(2));
}

#[test]
fn strict_makes_warnings_errors_of_their_frames() {
    let mut capture = Capture::new(5, 2);
    capture.scene["frames"][0]["images"][2] = json!(null);
    // With and without a mesh of an earlier run.
    for before in [false, true] {
        if before {
            assert_eq!(capture.run(&[]).status.code(), Some(0));
        }
        let output = capture.run(&["--strict"]);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains("warning: frame 0: camera `cam02`"), "{message}");
        assert!(message.contains("error: frame 0") && message.contains("--strict"), "{message}");
        assert!(message.contains("1 of 2 frames failed"), "{message}");
        let report = report(&capture);
        assert_eq!((&report["frames"][0]["index"], &report["failures"][0]["index"]), (&json!(1), &json!(0)));
        assert_eq!(report["warnings"][0]["code"], "no-picture");
        if !before {
            assert_eq!(capture.results(), ["frame_0001.glb", "report.json", "sequence.json"]);
        }
    }
}

/// Warnings of frames that are kept are given again, and so are those of frames that this run leaves alone.
#[test]
fn warnings_stay_with_their_frames() {
    let mut capture = Capture::new(5, 2);
    capture.scene["frames"][1]["images"][2] = json!(null);
    let first = assert_warns(&capture, &["no-picture"], &["frame 1"]);
    let again = assert_warns(&capture, &["no-picture"], &["frame 1"]);
    assert_eq!(first["warnings"], again["warnings"]);
    assert!(stderr(&capture.run(&[])).contains("frame 1 has not changed: its mesh is kept"));
    assert_eq!(capture.run(&["--frames", "0"]).status.code(), Some(0));
    assert_eq!(report(&capture)["warnings"], first["warnings"]);
}

/// Bounds of the mesh of the first frame, which is made with these warnings.
#[track_caller]
fn bounds(capture: &Capture, codes: &[&str]) -> Value {
    let output = capture.run(&[]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let report = report(capture);
    let found: Vec<&Value> = report["warnings"].as_array().unwrap().iter().map(|warning| &warning["code"]).collect();
    assert_eq!(found, codes);
    report["frames"][0]["bounds"].clone()
}

/// Cut-outs whose colours say nothing about the object: the alpha channel is the mask.
#[test]
fn the_alpha_channel_is_the_mask() {
    let mut capture = Capture::new(5, 1);
    let expected = bounds(&capture, &[]);
    let inside = |capture: &Capture, i: usize| {
        image::open(capture.path(&format!("masks/cam{i:02}_0.png"))).unwrap().into_luma8()
    };
    // As mask files, with white and with black colours.
    let masks: Vec<_> = (0..5).map(|i| inside(&capture, i)).collect();
    for (i, mask) in masks.iter().enumerate() {
        let colour = if i % 2 == 0 { 255 } else { 0 };
        let path = capture.path(&format!("masks/cam{i:02}_0.png"));
        if i < 3 {
            let cut = |x, y| Rgba([colour, colour, colour, mask.get_pixel(x, y).0[0]]);
            RgbaImage::from_fn(WIDTH, HEIGHT, cut).save(path).unwrap();
        } else {
            let cut = |x, y| LumaA([colour, mask.get_pixel(x, y).0[0]]);
            GrayAlphaImage::from_fn(WIDTH, HEIGHT, cut).save(path).unwrap();
        }
    }
    assert_eq!(bounds(&capture, &[]), expected);
    // As the alpha channel of the photographs, without mask files.
    for (i, mask) in masks.iter().enumerate() {
        let path = capture.path(&format!("images/cam{i:02}_0.png"));
        let photograph = image::open(&path).unwrap().into_rgb8();
        let cut = |x, y| {
            let [r, g, b] = photograph.get_pixel(x, y).0;
            Rgba([r, g, b, mask.get_pixel(x, y).0[0]])
        };
        RgbaImage::from_fn(WIDTH, HEIGHT, cut).save(path).unwrap();
    }
    capture.scene["frames"][0]["masks"] = json!(null);
    assert_eq!(bounds(&capture, &[]), expected);
    // A mask that is given counts, not the alpha channel. These are too narrow for their pictures.
    for i in 0..5 {
        capture.mask(&format!("masks/cam{i:02}_0.png"), 31.5, 7.0);
    }
    capture.scene["frames"][0]["masks"] = json!((0..5).map(|i| format!("masks/cam{i:02}_0.png")).collect::<Vec<_>>());
    let half = bounds(&capture, &["contours-beside-edges"]);
    let width = |bounds: &Value| bounds[1][0].as_f64().unwrap() - bounds[0][0].as_f64().unwrap();
    assert!((0.4..0.6).contains(&(width(&half) / width(&expected))), "{half} {expected}");
}
