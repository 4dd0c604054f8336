//! The dialects of transforms.json.

use super::{ANGLE, AXIS, HEIGHT, POINT, WIDTH, assert_sees, import, import_with_notes, refused, source, turn};
use glam::{DVec2, DVec3};
use serde_json::{Value, json};
use std::fs;
use tempfile::TempDir;

/// A camera that looks from 3 behind the point, 0.4 to its right and 0.2 below it.
fn matrix() -> Value {
    // The camera's axes in the world, OpenGL: right, up, backward.
    let [right, up, back] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| turn(axis, AXIS, ANGLE));
    let centre = POINT + back * 3.0 + right * 0.4 - up * 0.2;
    let row = |pick: fn(DVec3) -> f64| json!([pick(right), pick(up), pick(back), pick(centre)]);
    json!([row(|v| v.x), row(|v| v.y), row(|v| v.z), [0, 0, 0, 1]])
}

/// The pixel of the point, which is 3 ahead, 0.4 to the left and 0.2 up. Smaller rows are further up. (cx, cy) counts from
/// the centre of the first pixel.
fn seen(fx: f64, fy: f64, cx: f64, cy: f64) -> DVec2 {
    DVec2::new(fx * -0.4 / 3.0 + cx, -fy * 0.2 / 3.0 + cy)
}

/// A capture with a file of these keys, and one frame with these keys.
fn capture(shared: &Value, own: &Value) -> TempDir {
    let mut frame = json!({ "file_path": "images/a.png", "transform_matrix": matrix() });
    frame.as_object_mut().unwrap().extend(own.as_object().unwrap().clone());
    let mut file = json!({ "frames": [frame] });
    file.as_object_mut().unwrap().extend(shared.as_object().unwrap().clone());
    source("transforms.json", &file.to_string(), &["images/a.png"], &[])
}

#[test]
fn transforms_are_camera_to_world_with_opengl_axes() {
    let matrix = matrix();
    let pictures = ["images/a.png", "images/b.png"];
    let file = json!({
        "fl_x": 60.0, "fl_y": 70.0, "cx": 30.0, "cy": 20.0, "w": WIDTH, "h": HEIGHT,
        "frames": [
            { "file_path": "./images/a.png", "transform_matrix": matrix },
            { "file_path": "images/b", "transform_matrix": matrix, "fl_x": 80.0, "mask_path": "masks/other.png" },
        ],
    });
    let folder = source("transforms.json", &file.to_string(), &pictures, &["masks/a.png", "masks/other.png"]);
    let scene = import("transforms", folder.path());
    assert_sees(&scene, 0, seen(60.0, 70.0, 29.5, 19.5));
    assert_sees(&scene, 1, seen(80.0, 70.0, 29.5, 19.5));
    assert_eq!(scene["frames"][0]["masks"], json!(["masks/images_a.png", "masks/images_b.png"]));

    // Blender gives only the angle of view, and the axis goes through the centre of the picture.
    let angle = 0.9_f64;
    let file = json!({ "camera_angle_x": angle, "frames": [{ "file_path": "images/a", "transform_matrix": matrix }] });
    let folder = source("transforms.json", &file.to_string(), &pictures, &[]);
    let focal = f64::from(WIDTH) / 2.0 / (angle / 2.0).tan();
    assert_sees(&import("transforms", folder.path()), 0, seen(focal, focal, 31.5, 23.5));
}

#[test]
fn a_matrix_per_frame_has_the_centre_of_the_first_pixel_at_zero() {
    let none = json!({});
    let k = json!([[60.0, 0.0, 30.0], [0.0, 70.0, 20.0], [0.0, 0.0, 1.0]]);
    for own in [
        json!({ "K": k }),
        json!({ "intrinsic": k }),
        json!({ "intrinsics": [60.0, 0.0, 30.0, 0.0, 70.0, 20.0, 0.0, 0.0, 1.0] }),
        json!({ "intrinsics": [60.0, 70.0, 30.0, 20.0] }),
        json!({ "intrinsics": { "fx": 60.0, "fy": 70.0, "cx": 30.0, "cy": 20.0 } }),
        json!({ "intrinsic_matrix": [[60, 0, 30, 0], [0, 70, 20, 0], [0, 0, 1, 0], [0, 0, 0, 1]] }),
        // Both conventions beside each other, half a pixel apart.
        json!({ "K": k, "fl_x": 60.0, "fl_y": 70.0, "cx": 30.5, "cy": 20.5 }),
    ] {
        for folder in [
            capture(&none, &own),
            capture(&own, &none),
            capture(&json!({ "fl_x": 99, "cx": 5, "camera_angle_x": 1 }), &own),
        ] {
            let (scene, notes) = import_with_notes("transforms", folder.path());
            assert_sees(&scene, 0, seen(60.0, 70.0, 30.0, 20.0));
            assert!(notes.contains("a matrix K is taken as OpenCV's"), "{notes}");
        }
    }
    // A skew of 6 pixels moves the point by 6 times its height, 0.2 / 3 upwards.
    let skewed = json!({ "K": [[60.0, 6.0, 30.0], [0.0, 70.0, 20.0], [0.0, 0.0, 1.0]] });
    let expected = seen(60.0, 70.0, 30.0, 20.0) - DVec2::new(6.0 * 0.2 / 3.0, 0.0);
    assert_sees(&import("transforms", capture(&none, &skewed).path()), 0, expected);
    for (own, problem) in [
        (json!({ "K": [[60, 0], [0, 70]] }), "K must be a matrix"),
        (json!({ "K": [[60, 0, 0], [0, 70, 0], [30, 20, 1]] }), "transforms.json: K must be upper triangular"),
        (json!({ "K": [[60, 0, 30, 1], [0, 70, 20, 0], [0, 0, 1, 0]] }), "K must be a matrix"),
        (json!({ "K": [[0.9, 0, 0.5], [0, 1.2, 0.5], [0, 0, 1]] }), "in pixels"),
        (json!({ "K": k, "fl_x": 65 }), "contradict"),
        (json!({ "intrinsics": { "fx": 60, "fy": 70, "cx": 30, "cy": 20, "k1": 0.1 } }), "`k1`"),
        (json!({}), "focal length is missing"),
    ] {
        let message = refused("transforms", capture(&none, &own).path());
        assert!(message.contains(problem) && message.contains("camera `images_a`"), "{message}");
    }
}

#[test]
fn every_key_of_a_frame_replaces_that_of_the_file() {
    let shared = json!({ "w": 999, "h": 999, "fl_x": 1, "fl_y": 2, "cx": 3, "cy": 4, "k1": 0.9, "p1": 0.9 });
    let own = json!({ "w": WIDTH, "h": HEIGHT, "fl_x": 60, "fl_y": 70, "cx": 30, "cy": 20, "k1": 0, "p1": 0 });
    assert_sees(&import("transforms", capture(&shared, &own).path()), 0, seen(60.0, 70.0, 29.5, 19.5));
    // A frame's focal length replaces a matrix of the file.
    let shared = json!({ "K": [[1, 0, 2], [0, 3, 4], [0, 0, 1]] });
    assert_sees(&import("transforms", capture(&shared, &own).path()), 0, seen(60.0, 70.0, 29.5, 19.5));
    // Degrees, as instant-ngp reads them, and other names.
    let angle = 0.9_f64;
    let focal = f64::from(WIDTH) / 2.0 / (angle / 2.0).tan();
    let degrees = json!({ "x_fov": angle.to_degrees() });
    let scene = import("transforms", capture(&json!({}), &degrees).path());
    let off = super::camera(&scene, 0).k[0][0] - focal;
    assert!(off.abs() < 1e-9, "{off}");
    let own = json!({ "fx": 60, "fy": 70, "cx": 30, "cy": 20, "width": WIDTH, "height": HEIGHT });
    assert_sees(&import("transforms", capture(&json!({}), &own).path()), 0, seen(60.0, 70.0, 29.5, 19.5));
    let message = refused("transforms", capture(&json!({ "fl_x": 60, "w": 64 }), &json!({})).path());
    assert!(message.contains("w and h are needed together"), "{message}");
}

#[test]
fn poses_have_three_rows_and_a_known_last_one() {
    let shared = json!({ "fl_x": 60, "fl_y": 70, "cx": 30.5, "cy": 20.5 });
    let rows = matrix().as_array().unwrap().clone();
    let flat: Vec<Value> = rows.iter().flat_map(|row| row.as_array().unwrap().clone()).collect();
    let mut five = rows.clone();
    five.push(rows[3].clone());
    for pose in [json!(rows[..3]), json!(rows), json!(five), json!(flat)] {
        let scene = import("transforms", capture(&shared, &json!({ "transform_matrix": pose })).path());
        assert_sees(&scene, 0, seen(60.0, 70.0, 30.0, 20.0));
    }
    // The axes of an object that was scaled: its centre is where it is.
    let larger =
        |row: &Value| (0..4).map(|j| row[j].as_f64().unwrap() * if j < 3 { 2.5 } else { 1.0 }).collect::<Vec<f64>>();
    let scaled: Vec<Vec<f64>> = rows[..3].iter().map(larger).collect();
    let (scene, notes) =
        import_with_notes("transforms", capture(&shared, &json!({ "transform_matrix": scaled })).path());
    assert_sees(&scene, 0, seen(60.0, 70.0, 30.0, 20.0));
    assert!(notes.contains("are made 1 long"), "{notes}");
    let column = |j: usize| -> Vec<Value> { rows.iter().map(|row| row[j].clone()).collect() };
    for (pose, problem) in [
        (json!([column(0), column(1), column(2), column(3)]), "may be transposed"),
        (json!(rows[..2]), "3 or 4 rows"),
        (json!(null), "missing"),
        (json!([[2, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]), "R is not a rotation"),
        (json!([[1, 0, 0, "x"], [0, 1, 0, 0], [0, 0, 1, 0]]), "`x`"),
    ] {
        let message = refused("transforms", capture(&shared, &json!({ "transform_matrix": pose })).path());
        assert!(message.contains(problem) && message.contains("camera `images_a`"), "{message}");
    }
}

#[test]
fn what_is_ignored_is_named_and_what_is_not_understood_refused() {
    let shared = json!({ "fl_x": 60, "aabb_scale": 4, "scale": 0.3, "offset": [1, 2, 3], "applied_transform": [], "n_frames": 1 });
    let (_, notes) =
        import_with_notes("transforms", capture(&shared, &json!({ "sharpness": 9, "rotation": 0.1 })).path());
    assert!(notes.contains("ignored: `aabb_scale`, `scale`, `offset`, `applied_transform`"), "{notes}");
    assert!(notes.contains("ignored: `sharpness`, `rotation`"), "{notes}");
    for key in ["transform_matrix_start", "fovx", "focal_length", "shift_x", "c2w", "K_inv_matrix"] {
        for folder in
            [capture(&json!({ "fl_x": 60, key: 5 }), &json!({})), capture(&json!({ "fl_x": 60 }), &json!({ key: 5 }))]
        {
            let message = refused("transforms", folder.path());
            assert!(message.contains(&format!("`{key}` looks like calibration")), "{message}");
        }
    }
    let message = refused("transforms", capture(&json!({ "fl_x": 60, "n_frames": 20 }), &json!({})).path());
    assert!(message.contains("announces 20 frames, but there are 1"), "{message}");
}

/// Frames of these cameras (places on a line) and times, in this order.
fn frames(list: &[(f64, f64)]) -> TempDir {
    let frame = |(i, &(place, time)): (usize, &(f64, f64))| {
        let pose = json!([[1, 0, 0, place], [0, 1, 0, 0], [0, 0, 1, 3]]);
        json!({ "file_path": format!("images/{i}"), "transform_matrix": pose, "time": time })
    };
    let frames: Vec<Value> = list.iter().enumerate().map(frame).collect();
    let pictures: Vec<String> = (0..list.len()).map(|i| format!("images/{i}.png")).collect();
    let pictures: Vec<&str> = pictures.iter().map(String::as_str).collect();
    source("transforms.json", &json!({ "fl_x": 60, "frames": frames }).to_string(), &pictures, &["masks/1.png"])
}

#[test]
fn frames_of_several_instants_become_a_clip() {
    let list = [(0.0, 0.5), (0.0, 0.0), (1.0, 0.5), (1.0, 0.0), (2.0, 0.5)];
    let (scene, notes) = import_with_notes("transforms", frames(&list).path());
    let names: Vec<&Value> = scene["cameras"].as_array().unwrap().iter().map(|camera| &camera["name"]).collect();
    assert_eq!(names, ["images_0", "images_2", "images_4"]);
    let places: Vec<&Value> = scene["cameras"].as_array().unwrap().iter().map(|camera| &camera["t"][0]).collect();
    assert_eq!(places, [&json!(0.0), &json!(-1.0), &json!(-2.0)]);
    assert_eq!([&scene["frames"][0]["index"], &scene["frames"][1]["index"]], [0, 1]);
    let image = |name: &str| json!(format!("images/images_{name}.png"));
    assert_eq!(scene["frames"][0]["images"], json!([image("0_0000"), image("2_0000"), null]));
    assert_eq!(scene["frames"][1]["images"], json!([image("0_0001"), image("2_0001"), image("4_0001")]));
    assert_eq!(scene["frames"][0]["masks"], json!(["masks/images_0_0000.png", null, null]));
    assert!(notes.contains("5 pictures with different times are 2 frames of 3 cameras"), "{notes}");
}

#[test]
fn frames_that_are_no_clip_are_refused() {
    // A camera that moves through a moving scene.
    let message = refused("transforms", frames(&[(0.0, 0.0), (1.0, 0.5), (2.0, 1.0)]).path());
    assert!(message.contains("3 different times, from 0 to 1, and no instant has 3 views"), "{message}");
    let message = refused("transforms", frames(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.5), (1.0, 0.0)]).path());
    assert!(message.contains("`images_1` and `images_3` have the same camera at the same time"), "{message}");
    // Without times, or with one time, they are cameras of one frame.
    let (scene, notes) = import_with_notes("transforms", frames(&[(0.0, 0.5), (1.0, 0.5), (1.0, 0.5)]).path());
    assert_eq!(scene["cameras"].as_array().unwrap().len(), 3);
    assert_eq!(scene["frames"].as_array().unwrap().len(), 1);
    assert!(notes.contains("`images_1` and `images_2` have the same pose"), "{notes}");
}

#[test]
fn splits_are_not_dropped() {
    let folder = capture(&json!({ "fl_x": 60 }), &json!({}));
    let [whole, train, test] =
        ["transforms.json", "transforms_train.json", "transforms_test.json"].map(|n| folder.path().join(n));
    fs::copy(&whole, &train).unwrap();
    let (_, notes) = import_with_notes("transforms", folder.path());
    assert!(notes.contains("transforms_train.json beside it ignored"), "{notes}");
    fs::rename(&whole, &test).unwrap();
    let message = refused("transforms", folder.path());
    assert!(message.contains("transforms_test.json, transforms_train.json"), "{message}");
    import("transforms", &train);
    fs::remove_file(&test).unwrap();
    import("transforms", folder.path());
    fs::remove_file(&train).unwrap();
    assert!(refused("transforms", folder.path()).contains("contains no transforms.json"));
}
