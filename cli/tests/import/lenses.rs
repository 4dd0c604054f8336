//! A lens that a scene cannot hold is an error that names file, camera, model and remedy.

use super::{HEIGHT, WIDTH, import, import_with_notes, refused, source};
use serde_json::{Value, json};

/// One OpenCV camera with more keys.
fn opencv(more: &Value) -> Value {
    let mut camera = json!({
        "image": "images/a.png", "K": [60, 0, 32, 0, 60, 24, 0, 0, 1], "R": [1, 0, 0, 0, 1, 0, 0, 0, 1], "t": [0, 0, 3],
    });
    camera.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
    camera
}

fn refused_opencv(file: &Value, key: &str) {
    let folder = source("left.json", &file.to_string(), &["images/a.png"], &[]);
    let message = refused("opencv", folder.path());
    assert!(message.contains("left.json") && message.contains(key) && message.contains("undistort"), "{message}");
}

#[test]
fn opencv_lenses_that_cannot_be_expressed_are_refused() {
    let four = json!([-0.03, 0.02, -0.03, 0.01]);
    for (more, key) in [
        (json!({ "D": four, "model": "omnidirectional" }), "model"),
        (json!({ "D": four, "lens": { "model": "spherical" } }), "lens: model"),
        (json!({ "D": four, "lens_type": "Fisheye 8 mm" }), "lens_type"),
        (json!({ "D": four, "fisheye_params": [1, 2] }), "fisheye_params"),
        (json!({ "D": four, "xi": 1.2 }), "xi"),
        (json!({ "D": four, "xi": { "rows": 1, "cols": 1, "dt": "d", "data": [1.2] } }), "xi"),
        (json!({ "D": [0.1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.01] }), "tilted"),
        (json!({ "D": [0.1, 0, 0, 0, 0, 0.2, 0] }), "7 numbers"),
        (json!({ "D": [0.1, 0.2, 0, 0, 0.3], "fisheye": true }), "a fisheye has 4"),
        (json!({ "k1": 0.1, "p1": 0.1, "fisheye": true }), "p1"),
        (json!({ "k1": 0.1, "k4": 0.1 }), "k4"),
        (json!({ "k1": 0.1, "tau_x": 0.1 }), "tau_x"),
    ] {
        let folder = source("left.json", &opencv(&more).to_string(), &["images/a.png"], &[]);
        let message = refused("opencv", folder.path());
        assert!(message.contains("camera `left`"), "{message}");
        refused_opencv(&opencv(&more), key);
        // Beside the cameras, it holds for all of them.
        let mut file = more.clone();
        file["cameras"] = json!([opencv(&json!({}))]);
        refused_opencv(&file, key);
    }
}

#[test]
fn opencv_lenses_are_read() {
    let four = json!([-0.03, 0.02, -0.03, 0.01]);
    let fisheye = [
        json!({ "D": four, "distortion_model": "equidistant" }),
        json!({ "D": four, "distortion_model": "fisheye", "camera_model": "pinhole" }),
        json!({ "D": four, "fisheye_model": 1 }),
        json!({ "D": four, "fisheye": true }),
        json!({ "D": four, "isFisheye": "true" }),
        json!({ "D": four, "calibration_method": "fisheye" }),
        json!({ "D": four, "camera_model": "KANNALA_BRANDT" }),
        json!({ "D": four, "model": "KB4" }),
        json!({ "D": four, "lens": { "model": "fisheye" } }),
        json!({ "k1": -0.03, "k2": 0.02, "k3": -0.03, "k4": 0.01, "fisheye": 1, "p1": 0 }),
    ];
    let rational = [
        json!({ "D": [0.1, 0.2, 0.01, 0.02, 0.3, 0.1, -0.2, 0.3] }),
        json!({ "D": [0.1, 0.2, 0.01, 0.02, 0.3, 0.1, -0.2, 0.3, 0, 0, 0, 0], "distortion_model": "rational_polynomial" }),
        json!({ "k1": 0.1, "k2": 0.2, "p1": 0.01, "p2": 0.02, "k3": 0.3, "k4": 0.1, "k5": -0.2, "k6": 0.3 }),
    ];
    let prism = json!({ "D": [0.1, 0.2, 0.01, 0.02, 0.3, 0.1, -0.2, 0.3, 1e-3, 2e-3, 3e-3, 4e-3, 0, 0] });
    let expected = [four.clone(), rational[0]["D"].clone(), json!(prism["D"].as_array().unwrap()[..12])];
    let cases = [fisheye.to_vec(), rational.to_vec(), vec![prism]];
    for (i, (cases, expected)) in cases.into_iter().zip(expected).enumerate() {
        for more in cases {
            // Beside the cameras, it holds for all of them.
            let mut shared = more.clone();
            shared["cameras"] = json!([opencv(&json!({ "name": "left" }))]);
            for file in [opencv(&more), shared] {
                let folder = source("left.json", &file.to_string(), &["images/a.png"], &[]);
                let camera = &import("opencv", folder.path())["cameras"][0];
                assert_eq!(camera.get("lens"), (i == 0).then_some(&json!("fisheye")), "{file}");
                assert_eq!(camera["distortion"], expected, "{file}");
            }
        }
    }
    let contradiction = json!({ "D": four, "fisheye": true, "distortion_model": "plumb_bob" });
    let folder = source("left.json", &opencv(&contradiction).to_string(), &["images/a.png"], &[]);
    assert!(refused("opencv", folder.path()).contains("name different lenses"));
}

#[test]
fn opencv_coefficients_that_are_zero_change_nothing() {
    let list = json!([0.1, -0.05, 0.01, -0.02]);
    let expected = json!([0.1, -0.05, 0.01, -0.02, 0.0]);
    for more in [
        json!({ "D": list, "distortion_model": "plumb_bob", "fisheye_model": 0, "fisheye": false, "xi": 0 }),
        json!({ "D": [0.1, -0.05, 0.01, -0.02, 0, 0, 0, 0], "distortion_model": "rational_polynomial" }),
        json!({ "D": [0.1, -0.05, 0.01, -0.02, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0] }),
        json!({ "k1": 0.1, "k2": -0.05, "p1": 0.01, "p2": -0.02, "k3": 0, "k4": 0, "s1": 0 }),
        json!({ "D": list, "model": "Blackfly S", "camera_model": null }),
    ] {
        let folder = source("left.json", &opencv(&more).to_string(), &["images/a.png"], &[]);
        assert_eq!(import("opencv", folder.path())["cameras"][0]["distortion"], expected, "{more}");
    }
    let folder = source("left.json", &opencv(&json!({ "D": [0.1, 0.2, 0.3] })).to_string(), &["images/a.png"], &[]);
    assert!(refused("opencv", folder.path()).contains("D has 3 numbers"));
}

#[test]
fn opencv_keys_that_look_like_calibration_are_not_ignored() {
    for key in ["P", "camera_pose", "k7", "focal_mm", "extrinsics"] {
        let more = json!({ key: [1, 2, 3] });
        let folder = source("left.json", &opencv(&more).to_string(), &["images/a.png"], &[]);
        let message = refused("opencv", folder.path());
        assert!(message.contains(&format!("`{key}`")) && message.contains("camera `left`"), "{message}");
    }
    let more = json!({ "avg_reprojection_error": 0.2, "rectification_matrix": [1], "rvec": [0, 0, 0], "exposure": 3 });
    let folder = source("left.json", &opencv(&more).to_string(), &["images/a.png"], &[]);
    let (_, notes) = import_with_notes("opencv", folder.path());
    assert!(notes.contains("ignored: `avg_reprojection_error`, `rectification_matrix`, `exposure`"), "{notes}");
    assert!(notes.contains("`R` is used, and `rvec` ignored"), "{notes}");
    // A pose for all cameras would be that of a stereo pair.
    let file = json!({ "R": [1, 0, 0, 0, 1, 0, 0, 0, 1], "cameras": [opencv(&json!({}))] });
    let folder = source("left.json", &file.to_string(), &["images/a.png"], &[]);
    assert!(refused("opencv", folder.path()).contains("`R` stands beside the cameras"));
}

#[test]
fn transforms_of_other_lenses_are_refused() {
    let file = |shared: &Value, own: &Value| {
        let mut frame = json!({
            "file_path": "images/a.png", "transform_matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 3], [0, 0, 0, 1]],
        });
        frame.as_object_mut().unwrap().extend(own.as_object().unwrap().clone());
        let mut file = json!({ "w": WIDTH, "h": HEIGHT, "fl_x": 60, "frames": [frame] });
        file.as_object_mut().unwrap().extend(shared.as_object().unwrap().clone());
        source("transforms.json", &file.to_string(), &["images/a.png"], &[])
    };
    let none = json!({});
    for (more, key) in [
        (json!({ "is_fisheye": true, "p1": 0.1 }), "p1"),
        (json!({ "camera_model": "THIN_PRISM_FISHEYE" }), "camera_model"),
        (json!({ "camera_model": "EQUIRECTANGULAR" }), "camera_model"),
        (json!({ "camera_model": "ORTHOPHOTO" }), "camera_model"),
        (json!({ "k4": 0.01 }), "k4"),
        (json!({ "ftheta_p1": 0.01 }), "ftheta_p1"),
        (json!({ "latlong": true }), "latlong"),
        (json!({ "rolling_shutter": [0, 0.1, 0, 0] }), "rolling_shutter"),
        (json!({ "distortion_params": [0, 0, 0, 0.1, 0, 0] }), "distortion_params"),
        (json!({ "distortion_params": [0, 0, 0, 0.1, 0, 0.1], "is_fisheye": true }), "distortion_params"),
    ] {
        for folder in [file(&more, &none), file(&none, &more)] {
            let message = refused("transforms", folder.path());
            assert!(message.contains("transforms.json") && message.contains(key), "{message}");
            assert!(message.contains("undistort the pictures first"), "{message}");
        }
        assert!(refused("transforms", file(&none, &more).path()).contains("camera `images_a`"));
    }
    let fine = json!({
        "is_fisheye": false, "k1": 0.1, "k4": 0, "k5": 0.0, "k6": null, "rolling_shutter": [0, 0, 0, 0], "camera_model": "OPENCV",
    });
    for folder in [file(&fine, &none), file(&none, &fine)] {
        let scene = import("transforms", folder.path());
        assert_eq!(scene["cameras"][0]["distortion"], json!([0.1, 0.0, 0.0, 0.0, 0.0]));
    }
    for (more, lens, expected) in [
        (json!({ "is_fisheye": true }), Some("fisheye"), json!([0.0, 0.0, 0.0, 0.0])),
        (json!({ "is_fisheye": 1, "k1": 0.1 }), Some("fisheye"), json!([0.1, 0.0, 0.0, 0.0])),
        (json!({ "camera_model": "OPENCV_FISHEYE", "k4": 0.2 }), Some("fisheye"), json!([0.0, 0.0, 0.0, 0.2])),
        (
            json!({ "camera_model": "FISHEYE", "distortion_params": [0.1, 0.2, 0.3, 0.4, 0, 0] }),
            Some("fisheye"),
            json!([0.1, 0.2, 0.3, 0.4]),
        ),
        (json!({ "k4": 0.1, "k5": 0.01, "k6": 0 }), None, json!([0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.01, 0.0])),
    ] {
        for folder in [file(&more, &none), file(&none, &more)] {
            let camera = &import("transforms", folder.path())["cameras"][0];
            assert_eq!(camera.get("lens").and_then(Value::as_str), lens, "{more}");
            assert_eq!(camera["distortion"], expected, "{more}");
        }
    }
    // What a frame says has precedence.
    let folder = file(&json!({ "camera_model": "OPENCV_FISHEYE" }), &json!({ "camera_model": "OPENCV", "k1": 0.1 }));
    assert_eq!(import("transforms", folder.path())["cameras"][0]["distortion"], json!([0.1, 0.0, 0.0, 0.0, 0.0]));
    // nerfstudio's list has another order than OpenCV's.
    let scene =
        import("transforms", file(&json!({ "distortion_params": [1e-1, 2e-2, 3e-3, 0, 4e-4, 5e-5] }), &none).path());
    assert_eq!(scene["cameras"][0]["distortion"], json!([1e-1, 2e-2, 4e-4, 5e-5, 3e-3]));
}
