//! Pictures of several instants become a clip, by the usual folders.

use super::{HEIGHT, WIDTH, import, import_with_notes, refused};
use image::RgbImage;
use serde_json::{Value, json};
use std::{fs, path::Path};
use tempfile::TempDir;

/// Three cameras of OpenCV's JSON, whose pictures have these names.
fn capture(image: impl Fn(usize) -> Option<String>, pictures: &[String]) -> TempDir {
    let camera = |i: usize| {
        let mut camera = json!({
            "name": format!("c{i}"), "K": [60, 0, 30, 0, 60, 24, 0, 0, 1], "R": [1, 0, 0, 0, 1, 0, 0, 0, 1], "t": [i, 0, 4],
        });
        if let Some(image) = image(i) {
            camera["image"] = image.into();
        }
        camera
    };
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("rig.json"), json!({ "cameras": [camera(0), camera(1), camera(2)] }).to_string())
        .unwrap();
    for name in pictures {
        picture(&folder.path().join("images").join(name));
    }
    folder
}

fn picture(path: &Path) {
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    RgbImage::new(WIDTH, HEIGHT).save(path).unwrap();
}

fn all(name: impl Fn(usize, usize) -> String, frames: &[usize]) -> Vec<String> {
    (0..3).flat_map(|camera| frames.iter().map(|&frame| name(camera, frame)).collect::<Vec<_>>()).collect()
}

fn frames(scene: &Value) -> usize {
    assert_eq!(scene["cameras"].as_array().unwrap().len(), 3);
    assert_eq!(scene["cameras"][1]["name"], "c1");
    scene["frames"].as_array().unwrap().len()
}

#[test]
fn a_folder_per_camera_or_per_instant_is_a_clip_for_every_format_that_names_pictures() {
    let per_camera = |camera: usize, frame: usize| format!("c{camera}/{frame:06}.png");
    let per_instant = |camera: usize, frame: usize| format!("frame_{frame:02}/c{camera}.png");
    for (image, pictures) in [
        (None, all(per_camera, &[3, 4])),
        (None, all(per_instant, &[3, 4])),
        // The calibration names the pictures of the first instant only.
        (Some(per_camera as fn(usize, usize) -> String), all(per_camera, &[3, 4])),
        (Some(per_instant), all(per_instant, &[3, 4])),
    ] {
        let capture = capture(|i| image.map(|name| format!("images/{}", name(i, 3))), &pictures);
        let (scene, notes) = import_with_notes("opencv", &capture.path().join("rig.json"));
        assert_eq!(frames(&scene), 2, "{notes}");
        assert!(notes.contains("6 pictures with different times are 2 frames of 3 cameras"), "{notes}");
        assert!(!notes.contains("gaps") && !notes.contains("without a picture"), "{notes}");
    }
}

#[test]
fn gaps_and_missing_pictures_are_named() {
    let name = |camera: usize, frame: usize| format!("c{camera}/{frame:06}.png");
    let capture = capture(|_| None, &all(name, &[3, 4, 7, 8]));
    fs::remove_file(capture.path().join("images/c2/000004.png")).unwrap();
    let rig = capture.path().join("rig.json");
    let (scene, notes) = import_with_notes("opencv", &rig);
    assert_eq!(frames(&scene), 4);
    assert!(scene["frames"][1]["images"][2].is_null());
    assert!(notes.contains("have gaps, which frames do not: between 4 and 7"), "{notes}");
    assert!(notes.contains("in some of the 4 frames, and in how many: `c2` 1"), "{notes}");

    picture(&capture.path().join("images/c1/3.png"));
    let message = refused("opencv", &rig);
    assert!(message.contains("has the same number as"), "{message}");
    fs::rename(capture.path().join("images/c1/3.png"), capture.path().join("images/c1/poster.png")).unwrap();
    let message = refused("opencv", &rig);
    assert!(message.contains("poster.png") && message.contains("does not end in the number of a frame"), "{message}");
}

#[test]
fn pictures_beside_each_other_stay_cameras() {
    // Numbers of cameras, and a calibration of different cameras in one folder.
    let name = |camera: usize, _: usize| format!("c{camera}.png");
    assert_eq!(frames(&import("opencv", &capture(|_| None, &all(name, &[0])).path().join("rig.json"))), 1);
    let halves = |camera: usize, _: usize| format!("side{}/c{camera}.png", camera % 2);
    let capture = capture(|i| Some(format!("images/{}", halves(i, 0))), &all(halves, &[0]));
    assert_eq!(frames(&import("opencv", &capture.path().join("rig.json"))), 1);
}

#[test]
fn a_video_in_place_of_pictures_is_named() {
    let capture = capture(|_| None, &[]);
    fs::write(capture.path().join("c0.mp4"), "x").unwrap();
    let message = refused("opencv", &capture.path().join("rig.json"));
    assert!(message.contains("c0.mp4, and no pictures, and the file does not tell their size: write"), "{message}");
}

#[test]
fn colmap_images_of_one_camera_with_one_pose_are_a_clip() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("cameras.txt"), format!("1 PINHOLE {WIDTH} {HEIGHT} 60 60 32 24\n")).unwrap();
    let line =
        |id: usize, camera: usize, frame: usize| format!("{id} 1 0 0 0 {camera} 0 4 1 c{camera}/{frame:03}.png\n\n");
    let registered = |frames: &[usize]| -> String {
        (0..3)
            .flat_map(|camera| frames.iter().map(move |&frame| line(10 * camera + frame + 1, camera, frame)))
            .collect()
    };
    for camera in 0..3 {
        (0..3).for_each(|frame| picture(&folder.path().join(format!("images/c{camera}/{frame:03}.png"))));
    }
    // All registered, and the first only.
    for frames_registered in [&[0, 1, 2][..], &[0]] {
        fs::write(folder.path().join("images.txt"), registered(frames_registered)).unwrap();
        assert_eq!(frames(&import("colmap", folder.path())), 3);
    }
    // Poses that differ are cameras that differ.
    let moved = registered(&[0, 1, 2]).replace("1 0 0 0 1 0 4 1 c1/002", "1 0 0 0 1.5 0 4 1 c1/002");
    fs::write(folder.path().join("images.txt"), moved).unwrap();
    assert_eq!(import("colmap", folder.path())["cameras"].as_array().unwrap().len(), 9);
}
