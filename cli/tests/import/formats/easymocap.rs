//! EasyMocap's intri.yml and extri.yml.

use super::super::{HEIGHT, WIDTH, import, import_with_notes, refused};
use super::{
    BROWN, COUNT, FISHEYE, Pinhole, brown, by_rows, check, fisheye, folder, images, list, opencv, pinholes, rodrigues,
};
use image::GrayImage;
use std::{fmt::Write as _, fs};

/// intri.yml and extri.yml.
pub fn easymocap(cameras: &[Pinhole], lens: &[f64]) -> [String; 2] {
    let names = (0..cameras.len()).map(|i| format!("  - \"0{i}\"\n")).collect::<String>();
    let matrix = |key: String, rows: usize, data: &[f64]| {
        let columns = data.len() / rows;
        let data = list(data.iter().copied());
        format!("{key}: !!opencv-matrix\n  rows: {rows}\n  cols: {columns}\n  dt: d\n  data: [{data}]\n")
    };
    let mut files = [(); 2].map(|()| format!("%YAML:1.0\n---\nnames:\n{names}"));
    for (i, pose) in cameras.iter().enumerate() {
        let [width, height] = pose.size;
        files[0] += &matrix(format!("K_0{i}"), 3, &pose.k());
        files[0] += &matrix(format!("dist_0{i}"), 1, lens);
        let _ = write!(files[0], "H_0{i}: {height}\nW_0{i}: {width}\n");
        files[1] += &matrix(format!("R_0{i}"), 3, &rodrigues(&pose.r).to_array());
        files[1] += &matrix(format!("Rot_0{i}"), 3, &by_rows(&pose.r));
        files[1] += &matrix(format!("T_0{i}"), 3, &pose.t.to_array());
        let _ = write!(files[1], "n_0{i}: 0.1\nf_0{i}: 9.0\n");
    }
    files
}

#[test]
fn easymocap_is_opencv_in_two_files() {
    let [intri, extri] = easymocap(&pinholes(), &BROWN);
    let texts = [("intri.yml", intri.as_str()), ("extri.yml", extri.as_str())];
    let of = |pictures: &[String], texts: &[(&str, &str)]| folder(pictures, texts);
    let capture = of(&images(|i| format!("0{i}")), &texts);
    let notes = check("easymocap", capture.path(), &["intri.yml", "extri.yml"], |pose, point| {
        opencv(pose, point, |p| brown(p, BROWN))
    });
    assert!(notes.contains("ignored of every camera: `n`, `f`"), "{notes}");

    // A folder per camera is a clip.
    let clip: Vec<String> =
        (0..COUNT).flat_map(|i| [3, 4].map(|frame| format!("images/0{i}/00000{frame}.png"))).collect();
    let capture = of(&clip, &texts);
    fs::create_dir_all(capture.path().join("masks/01")).unwrap();
    GrayImage::new(WIDTH, HEIGHT).save(capture.path().join("masks/01/000004.png")).unwrap();
    let scene = import("auto", capture.path());
    assert_eq!(scene["cameras"][1]["name"], "01");
    assert_eq!(scene["frames"].as_array().unwrap().len(), 2);
    assert_eq!(scene["frames"][1]["masks"], serde_json::json!([null, "masks/01_0001.png", null, null]));

    // A lens that is named for all cameras.
    let fish = intri.replace(&list(BROWN), &list(FISHEYE)).replace("names:", "fisheye: 1\nnames:");
    let capture = of(&images(|i| format!("0{i}")), &[("Intri.yaml", &fish), ("EXTRI.yml", &extri)]);
    check("easymocap", capture.path(), &["Intri.yaml", "EXTRI.yml"], |pose, point| {
        opencv(pose, point, |p| fisheye(p, FISHEYE))
    });
    let few = [("intri.yml", &*intri.replace("  - \"03\"\n", "")), ("extri.yml", &*extri.replace("  - \"03\"\n", ""))];
    let (scene, notes) = import_with_notes("easymocap", of(&images(|i| format!("0{i}")), &few).path());
    assert_eq!(scene["cameras"].as_array().unwrap().len(), COUNT - 1);
    assert!(notes.contains("are left out, because `names` does not have them: `03`"), "{notes}");

    for (file, from, to, problem) in [
        ("intri.yml", "K_02", "X_02", "`K_02` is missing"),
        ("extri.yml", "T_01", "U_01", "`T_01` is missing"),
        ("extri.yml", "- \"03\"", "- \"04\"", "`R_04` is missing"),
        ("intri.yml", "dist_02", "distortion_02", "`distortion` looks like calibration"),
        ("intri.yml", "names:", "focal: 3\nnames:", "`focal` looks like calibration"),
        (
            "extri.yml",
            "R_00: !!opencv-matrix\n  rows: 3\n  cols: 1\n  dt: d\n  data: [",
            "R_00: !!opencv-matrix\n  rows: 3\n  cols: 1\n  dt: d\n  data: [1",
            "different rotations",
        ),
    ] {
        let changed =
            texts.map(|(name, text)| (name, if name == file { text.replace(from, to) } else { text.to_owned() }));
        let changed: Vec<(&str, &str)> = changed.iter().map(|(name, text)| (*name, text.as_str())).collect();
        let message = refused("easymocap", of(&images(|i| format!("0{i}")), &changed).path());
        assert!(message.contains(problem), "{message}");
    }
}
