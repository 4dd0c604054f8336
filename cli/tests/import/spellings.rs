//! Calibrations of OpenCV in XML, JSON and other spellings, and what may be a camera and is not understood.

use super::{ANGLE, AXIS, HEIGHT, WIDTH, assert_sees, import, import_with_notes, opencv_pixel, refused, source};
use serde_json::{Value, json};
use std::fs;

const PICTURES: [&str; 3] = ["images/a.png", "images/b.png", "images/c.png"];

/// A camera that sees the point at [`opencv_pixel`], by these keys for K, distortion, rotation and translation.
fn camera([k, d, r, t]: [&str; 4]) -> Value {
    json!({
        k: [60.0, 0.0, 32.0, 0.0, 70.0, 24.0, 0.0, 0.0, 1.0], d: [0.1, -0.05, 0.01, -0.02, 0.03],
        r: (AXIS * ANGLE).to_array(), t: [0.1, -0.2, 3.0], "image_width": WIDTH, "image_height": HEIGHT,
    })
}

const USUAL: [&str; 4] = ["K", "D", "rvec", "tvec"];

#[test]
fn xml_is_read_as_opencv_writes_it() {
    let matrix = |name: &str, rows: usize, data: &str| {
        let columns = data.split_whitespace().count() / rows;
        format!(
            "<{name} type_id=\"opencv-matrix\">\n  <rows>{rows}</rows>\n  <cols>{columns}</cols>\n  <dt>d</dt>\n  <data>\n    {data}</data></{name}>\n"
        )
    };
    let axis = AXIS * ANGLE;
    let text = format!(
        "<?xml version=\"1.0\"?>\n<opencv_storage>\n<image_width>{WIDTH}</image_width>\n<image_height>{HEIGHT}</image_height>\n{}{}{}{}</opencv_storage>\n",
        matrix("camera_matrix", 3, "60. 0. 32. 0. 7.0e+01 24. 0. 0. 1."),
        matrix("distortion_coefficients", 5, "1.0e-01 -5.0e-02 0.01 -0.02\n 0.03"),
        matrix("rvec", 3, &format!("{} {} {}", axis.x, axis.y, axis.z)),
        matrix("tvec", 3, "0.1 -0.2 3."),
    );
    let folder = source("a.xml", &text, &PICTURES, &[]);
    fs::write(folder.path().join("b.XML"), &text).unwrap();
    // Not a calibration, and not of OpenCV.
    fs::write(folder.path().join("notes.xml"), "<notes/>").unwrap();
    for from in ["opencv", "auto"] {
        let scene = import(from, folder.path());
        assert_eq!(scene["cameras"].as_array().unwrap().len(), 2);
        assert_sees(&scene, 0, opencv_pixel());
        assert_sees(&scene, 1, opencv_pixel());
        assert_eq!(import(from, &folder.path().join("a.xml"))["cameras"], json!([scene["cameras"][0]]));
    }
    fs::write(folder.path().join("b.XML"), text.replace("camera_matrix", "<")).unwrap();
    assert!(refused("opencv", folder.path()).contains("b.XML"));
}

#[test]
fn a_folder_of_json_is_recognised() {
    let folder = source("a.json", &camera(USUAL).to_string(), &PICTURES, &[]);
    fs::write(folder.path().join("b.json"), camera(USUAL).to_string()).unwrap();
    fs::write(folder.path().join("keypoints.json"), "{ \"people\": [] }").unwrap();
    assert_eq!(import("auto", folder.path())["cameras"].as_array().unwrap().len(), 2);
}

#[test]
fn letter_case_and_underscores_of_keys_do_not_matter() {
    for keys in [
        ["Camera_Matrix", "Distortion_Coefficients", "Rotation_Vector", "Translation_Vector"],
        ["CameraMatrix", "DistCoeffs", "Rvec", "Tvec"],
        ["CAMERA_MATRIX", "DISTORTION", "rotationVector", "TranslationVector"],
        ["k_", "D", "R", "T"],
    ] {
        let folder = source("a.json", &camera(keys).to_string(), &PICTURES, &[]);
        if keys[0] == "k_" {
            assert!(refused("opencv", folder.path()).contains("none of the keys"));
        } else {
            assert_sees(&import("opencv", folder.path()), 0, opencv_pixel());
        }
    }
    let mut twice = camera(USUAL);
    twice["camera_matrix"] = json!([1, 0, 0, 0, 1, 0, 0, 0, 1]);
    twice["Camera_Matrix"] = json!([2, 0, 0, 0, 1, 0, 0, 0, 1]);
    let folder = source("a.json", &twice.to_string(), &PICTURES, &[]);
    assert!(refused("opencv", folder.path()).contains("looks like calibration"));
}

#[test]
fn what_may_be_a_camera_is_not_dropped() {
    let odd = json!({ "KK": [[60, 0, 32], [0, 70, 24], [0, 0, 1]], "place": 3 });
    let nested = json!({ "intrinsic": [60, 70, 32, 24], "extrinsic": [0, 0, 0, 1, 2, 3] });
    let stereo = json!({ "M1": 1, "D1": 2, "M2": 3, "D2": 4, "R": [0, 0, 0], "T": [1, 0, 0] });
    for (other, problem) in [
        (&odd, "`KK` is a matrix that is not understood"),
        (&nested, "looks like calibration"),
        (&stereo, "of a stereo pair"),
    ] {
        // In a file of its own, and in the file of all cameras.
        let folder = source("a.json", &camera(USUAL).to_string(), &PICTURES, &[]);
        fs::write(folder.path().join("b.json"), other.to_string()).unwrap();
        let message = refused("opencv", folder.path());
        assert!(message.contains("b.json") && message.contains(problem), "{message}");
        if *other != stereo {
            let all = json!({ "a": camera(USUAL), "b": other });
            let message = refused("opencv", source("rig.json", &all.to_string(), &PICTURES, &[]).path());
            assert!(message.contains("rig.json: b: ") && message.contains(problem), "{message}");
        }
    }
    // What is none is ignored with a word.
    let folder = source("a.json", &camera(USUAL).to_string(), &PICTURES, &[]);
    fs::write(folder.path().join("b.json"), "{ \"operator\": \"x\", \"meta\": { \"day\": [1, 2, 3] } }").unwrap();
    assert!(import_with_notes("opencv", folder.path()).1.contains("b.json: contains no camera and is ignored"));
}

#[test]
fn flags_of_opencvs_fisheye_name_the_lens() {
    let mut fisheye = camera(USUAL);
    fisheye["D"] = json!([-0.03, 0.02, -0.01, 0.003]);
    fisheye["flags"] = json!("fisheye::CALIB_FIX_SKEW + fisheye::CALIB_RECOMPUTE_EXTRINSIC");
    let folder = source("a.json", &fisheye.to_string(), &PICTURES, &[]);
    assert_eq!(import("opencv", folder.path())["cameras"][0]["lens"], "fisheye");
}

/// transforms.json of a ring that is given with OpenCV's axes instead of OpenGL's, so that all cameras look outwards.
#[test]
fn poses_that_will_be_refused_and_keys_that_name_a_convention_are_told() {
    let frame = |i: usize| {
        let (s, c) = (1.4 * i as f64).sin_cos();
        // Columns: x to the right, y down, z towards the middle, and the centre.
        json!({ "file_path": PICTURES[i], "transform_matrix":
            [[-s, 0, -c, 3.0 * c], [c, 0, -s, 3.0 * s], [0, -1, 0, 0], [0, 0, 0, 1]] })
    };
    let mut file = json!({ "fl_x": 60, "frames": [frame(0), frame(1), frame(2)] });
    let folder = source("transforms.json", &file.to_string(), &PICTURES, &[]);
    let (_, notes) = import_with_notes("transforms", folder.path());
    assert!(notes.contains("these cameras will be refused when a frame is made"), "{notes}");
    assert!(notes.contains("there are no masks: put them in `masks`"), "{notes}");
    for (key, value) in
        [("is_opencv", json!(true)), ("coord_system", json!("OpenCV")), ("orientation", json!("opencv"))]
    {
        file[key] = value;
        let folder = source("transforms.json", &file.to_string(), &PICTURES, &[]);
        let message = refused("transforms", folder.path());
        assert!(message.contains(&format!("`{key}` looks like calibration")), "{message}");
        file.as_object_mut().unwrap().remove(key);
    }
}
