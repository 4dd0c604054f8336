//! Text as editors, scripts and other systems write it, and the names of pictures in it.

use super::{HEIGHT, WIDTH, colmap, import, import_with_notes, refused, source};
use image::RgbImage;
use serde_json::{Value, json};
use std::{fs, path::Path};

/// Rewrites all text files of a folder as an editor on another system might.
fn rewrite(folder: &Path, change: fn(&str) -> String) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() && path.extension().is_some_and(|extension| extension != "png") {
            let text = fs::read_to_string(&path).unwrap();
            fs::write(&path, change(&text)).unwrap();
        }
    }
}

/// A camera of every format, with the expected scene.
fn every_format() -> [(&'static str, tempfile::TempDir); 4] {
    let lens = format!("OPENCV {WIDTH} {HEIGHT} 60 70 32 24 0.1 -0.05 0.01 -0.02");
    let line = "0001.png 100 0 30 0 110 20 0 0 1 0 -1 0 1 0 0 0 0 1 0.1 0.2 3";
    let yaml = "%YAML:1.0\n---\ncam_a:\n   K: [ 60., 0., 32., 0.,\n      70., 24., 0., 0., 1. ]\n   R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n   t: [0.1, -0.2, 3.]\n";
    let frame = json!({ "file_path": "images/a", "transform_matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 3]] });
    let transforms = serde_json::to_string_pretty(&json!({ "fl_x": 60, "frames": [frame] })).unwrap();
    [
        ("colmap", colmap(&lens)),
        ("middlebury", source("x_par.txt", &format!("1\n{line}\n"), &["0001.png"], &[])),
        ("opencv", source("x.yml", yaml, &["images/cam_a.png"], &[])),
        ("transforms", source("transforms.json", &transforms, &["images/a.png"], &[])),
    ]
}

#[test]
fn byte_order_marks_line_ends_and_tabs_change_nothing() {
    let changes: [fn(&str) -> String; 5] = [
        |text| format!("\u{feff}{text}"),
        |text| text.replace('\n', "\r\n"),
        |text| text.replace(": ", ":\t").replace(", ", ",\t"),
        |text| text.replace("   ", "\t"),
        |text| {
            if text.contains(['{', ':']) {
                text.to_owned()
            } else {
                text.replace(' ', "\t").replace("c\td.png", "c d.png")
            }
        },
    ];
    for change in changes {
        for (format, folder) in every_format() {
            let expected = import(format, folder.path());
            rewrite(folder.path(), change);
            assert_eq!(import(format, folder.path()), expected, "{format}");
        }
    }
}

#[test]
fn colmap_lines_of_points_may_be_empty_missing_or_double_spaced() {
    let lens = format!("SIMPLE_PINHOLE {WIDTH} {HEIGHT} 60 32 24");
    let folder = colmap(&lens);
    let file = folder.path().join("images.txt");
    let expected = import("colmap", folder.path());
    let text = fs::read_to_string(&file).unwrap();
    let images: Vec<&str> = text.lines().filter(|line| line.contains(".png")).collect();
    let [b, cd] = images[..] else { panic!("two images") };
    for variant in [
        format!("{b}\n{cd}\n"),
        format!("{b}\n{cd}"),
        format!("\n\n{b}\n\n\n\n{cd}\n\n"),
        format!("# a\n{b}\n# b\n1 2 -1\n  # c\n{cd}\n# d\n\n"),
        format!("{b}\n\n1 2 -1 3.5 4e2 7\n\n{cd}\n\n1 2 -1\n"),
    ] {
        fs::write(&file, &variant).unwrap();
        assert_eq!(import("colmap", folder.path()), expected, "{variant}");
    }
    for wrong in [format!("{b}\n1 2 -1\n1 2 -1\n"), b.replace(" b.png", "")] {
        fs::write(&file, &wrong).unwrap();
        assert!(refused("colmap", folder.path()).contains("is not an image"), "{wrong}");
    }
    fs::write(&file, format!("# Number of images: 3, mean observations per image: 0\n{text}")).unwrap();
    let (_, notes) = import_with_notes("colmap", folder.path());
    assert!(notes.contains("announces 3 images, but there are 2"), "{notes}");
    fs::write(folder.path().join("cameras.txt"), format!("3 {lens}\n3 {lens}\n")).unwrap();
    assert!(refused("colmap", folder.path()).contains("camera 3: occurs twice"));
}

#[test]
fn pictures_are_found_with_dots_backslashes_and_extensions_in_any_case() {
    let frame = |path: &str, x: i32| json!({ "file_path": path, "transform_matrix": [[1, 0, 0, x], [0, 1, 0, 0], [0, 0, 1, 3]] });
    let names = ["cam.00", "cam.01", "sub\\cam.02", ".\\sub\\cam.03.png", "d.JPG", "e.jpeg"];
    let frames: Vec<Value> = names.iter().zip(0..).map(|(name, x)| frame(name, x)).collect();
    let text = json!({ "fl_x": 60, "frames": frames }).to_string();
    let folder = source("transforms.json", &text, &[], &["masks/cam.01.png"]);
    fs::create_dir(folder.path().join("sub")).unwrap();
    let disk = ["cam.00.png", "cam.01.JPG", "sub/cam.02.JPEG", "sub/cam.03.PNG", "d.jpg", "e.JPEG"];
    for name in disk {
        let format =
            if name.to_lowercase().ends_with("png") { image::ImageFormat::Png } else { image::ImageFormat::Jpeg };
        RgbImage::new(WIDTH, HEIGHT).save_with_format(folder.path().join(name), format).unwrap();
    }
    let scene = import("transforms", folder.path());
    let cameras: Vec<&Value> = scene["cameras"].as_array().unwrap().iter().map(|camera| &camera["name"]).collect();
    assert_eq!(cameras, ["cam.00", "cam.01", "sub_cam.02", "sub_cam.03", "d", "e"]);
    let expected = ["cam.00.png", "cam.01.jpg", "sub_cam.02.jpeg", "sub_cam.03.png", "d.jpg", "e.jpeg"];
    assert_eq!(scene["frames"][0]["images"], json!(expected.map(|name| format!("images/{name}"))));
    assert_eq!(scene["frames"][0]["masks"], json!([null, "masks/cam.01.png", null, null, null, null]));
}

#[test]
fn auto_recognises_every_format() {
    for (format, folder) in every_format() {
        let expected = import(format, folder.path());
        assert_eq!(import("auto", folder.path()), expected, "{format}");
        let mut entries = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().path());
        let file = entries.find(|path| path.is_file() && path.extension().is_some_and(|e| e != "png")).unwrap();
        assert_eq!(import("auto", &file), expected, "{format}");
    }
    let [_, _, (_, opencv), (_, transforms)] = every_format();
    fs::copy(opencv.path().join("x.yml"), transforms.path().join("x.yml")).unwrap();
    let message = refused("auto", transforms.path());
    assert!(message.contains("--from transforms or --from opencv"), "{message}");
    assert!(refused("auto", &transforms.path().join("masks")).contains("no calibration was recognised"));
}

#[test]
fn scene_json_may_have_a_byte_order_mark_and_other_line_ends() {
    let [.., (format, folder)] = every_format();
    let scene = tempfile::tempdir().unwrap();
    let output = crate::common::pcmvs()
        .args(["import", "--from", format])
        .arg(folder.path())
        .arg("-o")
        .arg(scene.path())
        .output();
    assert_eq!(output.unwrap().status.code(), Some(0));
    let file = scene.path().join("scene.json");
    let cameras = || pcmvs_scene::Scene::load(&pcmvs_scene::Disk, scene.path()).unwrap().cameras().unwrap();
    let expected = cameras();
    let text = fs::read_to_string(&file).unwrap();
    fs::write(&file, format!("\u{feff}{}", text.replace('\n', "\r\n").replace("  ", "\t"))).unwrap();
    assert_eq!(cameras(), expected);
}
