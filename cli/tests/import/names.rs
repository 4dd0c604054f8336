//! Camera names become file names, and none leads out of the scene.

use super::{HEIGHT, WIDTH, import, import_with_notes, refused, source};
use crate::common::{pcmvs, stderr};
use image::RgbImage;
use serde_json::{Value, json};
use std::{collections::BTreeSet, fs, path::Path};

/// OpenCV cameras of these names, which share one picture and one mask.
fn rig(names: &[&str]) -> tempfile::TempDir {
    let camera = |(i, name): (usize, &&str)| {
        json!({
            "name": name, "image": "images/p.png", "mask": "masks/p.png", "K": [60, 0, 32, 0, 60, 24, 0, 0, 1],
            "R": [1, 0, 0, 0, 1, 0, 0, 0, 1], "t": [i, 0, 3],
        })
    };
    let cameras: Vec<Value> = names.iter().enumerate().map(camera).collect();
    source("rig.json", &json!({ "cameras": cameras }).to_string(), &["images/p.png"], &["masks/p.png"])
}

/// All files below a folder.
fn tree(folder: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let files =
        entries.flat_map(|path| if path.is_dir() { tree(&path) } else { [path.to_string_lossy().into_owned()].into() });
    files.collect()
}

#[test]
fn no_name_leads_out_of_the_scene() {
    let outside = tempfile::tempdir().unwrap();
    let absolute = outside.path().join("absolute").to_string_lossy().into_owned();
    let names = [
        "../../../up",
        &absolute,
        "..\\..\\back",
        "C:\\drive",
        "..",
        "",
        ".hidden",
        "a/b",
        "a\nb",
        "NUL",
        "con.png",
        "x.",
    ];
    let folder = rig(&names);
    let scene = outside.path().join("a/b/scene");
    let output =
        pcmvs().args(["import", "--from", "opencv"]).arg(folder.path()).arg("-o").arg(&scene).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let expected = ["up", "back", "C__drive", "camera", "camera_2", "hidden", "a_b", "a_b_2", "_NUL", "_con.png", "x"];
    let written = tree(outside.path());
    assert_eq!(written.len(), 2 * names.len() + 1);
    for name in expected {
        for list in ["images", "masks"] {
            let file = scene.join(list).join(format!("{name}.png"));
            assert!(written.contains(&*file.to_string_lossy()), "{name}: {written:?}");
        }
    }
    assert!(written.iter().all(|path| Path::new(path).starts_with(&scene)), "{written:?}");
    assert!(stderr(&output).contains("note: camera `../../../up` is called `up`"), "{}", stderr(&output));
}

#[test]
fn names_that_differ_only_in_case_get_files_of_their_own() {
    let (scene, notes) = import_with_notes("opencv", rig(&["Cam", "cam", "CAM"]).path());
    let names: Vec<&Value> = scene["cameras"].as_array().unwrap().iter().map(|camera| &camera["name"]).collect();
    assert_eq!(names, ["Cam", "cam_2", "CAM_3"]);
    assert_eq!(scene["frames"][0]["images"], json!(["images/Cam.png", "images/cam_2.png", "images/CAM_3.png"]));
    assert!(notes.contains("`CAM` is called `CAM_3`"), "{notes}");
    assert!(refused("opencv", rig(&["a", "b", "a"]).path()).contains("camera `a`"));
}

#[test]
fn numbers_are_names_as_they_are_written() {
    let lens = "K: [60, 0, 32, 0, 60, 24, 0, 0, 1]\nR: [1, 0, 0, 0, 1, 0, 0, 0, 1]";
    let yaml = format!("name: 007\n{lens}\nt: [0, 0, 3]\n");
    let folder = source("x.yml", &yaml, &["images/007.png"], &[]);
    assert_eq!(import("opencv", folder.path())["cameras"][0]["name"], "007");

    let camera = json!({ "K": [60, 0, 32, 0, 60, 24, 0, 0, 1], "R": [1, 0, 0, 0, 1, 0, 0, 0, 1], "t": [0, 0, 3] });
    let mut second = camera.clone();
    second["name"] = json!(12);
    let file = json!({ "cameras": { "3": camera, "x": second } }).to_string();
    let folder = source("x.json", &file, &["images/3.png", "images/12.png"], &[]);
    let scene = import("opencv", folder.path());
    assert_eq!([&scene["cameras"][0]["name"], &scene["cameras"][1]["name"]], ["3", "12"]);

    let indent = |text: &str| text.lines().map(|line| format!("   {line}\n")).collect::<String>();
    let yaml =
        format!("%YAML:1.0\n---\n0:\n{}1:\n{}", indent(&yaml.replace("007", "a")), indent(&yaml.replace("007", "01")));
    let folder = source("x.yml", &yaml, &["images/a.png", "images/01.png"], &[]);
    let scene = import("opencv", folder.path());
    assert_eq!([&scene["cameras"][0]["name"], &scene["cameras"][1]["name"]], ["a", "01"]);
}

#[test]
fn a_file_that_is_there_already_is_not_replaced() {
    // The scene is made in the folder of its source, where camera `q` would replace the picture of another camera.
    let folder = rig(&["q"]);
    let other = folder.path().join("images/q.png");
    RgbImage::from_pixel(WIDTH, HEIGHT, image::Rgb([9, 9, 9])).save(&other).unwrap();
    let before = fs::read(&other).unwrap();
    let import =
        || pcmvs().args(["import", "--from", "opencv"]).arg(folder.path()).arg("-o").arg(folder.path()).output();
    let output = import().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("q.png: exists already"), "{}", stderr(&output));
    assert_eq!(fs::read(&other).unwrap(), before);
    fs::copy(folder.path().join("images/p.png"), &other).unwrap();
    assert_eq!(import().unwrap().status.code(), Some(0));
}
