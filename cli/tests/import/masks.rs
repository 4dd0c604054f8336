//! Masks are found in folders that repeat those of the pictures, and never stand for two cameras.

use super::{HEIGHT, WIDTH, import, refused, source};
use image::{GrayImage, RgbImage};
use serde_json::{Value, json};
use std::{fs, path::Path};

/// A capture with two pictures of the same name in different folders, and these masks.
fn capture(masks: &[&str], keys: Value) -> tempfile::TempDir {
    let frame = |(i, path): (usize, &str)| {
        let mut frame = json!({ "file_path": path, "transform_matrix": [[1, 0, 0, i], [0, 1, 0, 0], [0, 0, 1, 3]] });
        frame.as_object_mut().unwrap().extend(keys.as_object().unwrap().clone());
        frame
    };
    let frames: Vec<Value> = ["images/left/0.png", "images/right/0.png"].into_iter().enumerate().map(frame).collect();
    let folder = source("transforms.json", &json!({ "fl_x": 60, "frames": frames }).to_string(), &[], &[]);
    let make = |path: &str| {
        let path = folder.path().join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        path
    };
    for path in ["images/left/0.png", "images/right/0.png"] {
        RgbImage::new(WIDTH, HEIGHT).save(make(path)).unwrap();
    }
    for (path, value) in masks.iter().zip(1..) {
        GrayImage::from_pixel(WIDTH, HEIGHT, image::Luma([value])).save(make(path)).unwrap();
    }
    folder
}

#[test]
fn masks_repeat_the_folders_of_the_pictures() {
    for masks in [
        ["masks/left/0.png", "masks/right/0.png"],
        ["masks/left/0.png.png", "masks/right/0.png.png"],
        ["masks/images/left/0.png", "masks/images/right/0.png"],
        ["images/masks/left/0.png", "images/masks/right/0.PNG"],
        ["images/left/masks/0.png", "images/right/masks/0.png"],
    ] {
        let scene = import("transforms", capture(&masks, json!({})).path());
        assert_eq!(
            scene["frames"][0]["masks"],
            json!(["masks/images_left_0.png", "masks/images_right_0.png"]),
            "{masks:?}"
        );
    }
    // A mask for one camera only. The one in the folder of all masks has the name of both pictures.
    let scene = import("transforms", capture(&["masks/left/0.png"], json!({})).path());
    assert_eq!(scene["frames"][0]["masks"], json!(["masks/images_left_0.png", null]));
    let message = refused("transforms", capture(&["masks/0.png"], json!({})).path());
    assert!(message.contains("would be the mask of camera `images_left_0` too"), "{message}");
}

#[test]
fn a_mask_that_is_named_must_exist_and_fit() {
    let message = refused("transforms", capture(&[], json!({ "mask_path": "masks/gone.png" })).path());
    assert!(message.contains("its mask `masks/gone.png` is missing"), "{message}");
    let folder = capture(&["masks/left/0.png"], json!({}));
    GrayImage::new(WIDTH, HEIGHT + 1).save(folder.path().join("masks/left/0.png")).unwrap();
    let message = refused("transforms", folder.path());
    assert!(
        message.contains("the mask is 64 x 49 pixels")
            && message.contains(&*Path::new("left").join("0.png").to_string_lossy()),
        "{message}"
    );
}
