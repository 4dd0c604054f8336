//! The JSON of CMU Panoptic.

use super::super::refused;
use super::{BROWN, Pinhole, brown, by_rows, check, folder, images, opencv, pinholes};
use std::fs;

/// The file. A last camera has no picture.
pub fn panoptic(cameras: &[Pinhole], lens: &[f64]) -> String {
    let camera = |(i, pose): (usize, &Pinhole)| {
        serde_json::json!({
            "name": format!("00_0{i}"), "type": "hd", "resolution": pose.size, "panel": 0, "node": i,
            "K": pose.k().chunks(3).collect::<Vec<_>>(), "distCoef": lens,
            "R": by_rows(&pose.r).chunks(3).collect::<Vec<_>>(), "t": pose.t.to_array().map(|v| [v]),
        })
    };
    let mut cameras: Vec<_> = cameras.iter().enumerate().map(camera).collect();
    cameras.push(serde_json::json!({ "name": "01_01", "K": [], "distCoef": [] }));
    let file = serde_json::json!({ "calibDataSource": "160422", "cameras": cameras });
    serde_json::to_string_pretty(&file).unwrap()
}

#[test]
fn panoptic_is_opencv_in_a_list() {
    let text = panoptic(&pinholes(), &BROWN);
    let capture = folder(&images(|i| format!("00_0{i}")), &[("calibration_160422.json", &text)]);
    let notes = check("panoptic", capture.path(), &["calibration_160422.json"], |pose, point| {
        opencv(pose, point, |p| brown(p, BROWN))
    });
    assert!(notes.contains("1 of 5 cameras have no picture and are left out, such as `01_01`"), "{notes}");
    let odd = text.replacen("\"panel\"", "\"skew\": 3, \"panel\"", 1);
    fs::write(capture.path().join("calibration_160422.json"), odd).unwrap();
    assert!(refused("panoptic", capture.path()).contains("`skew` looks like calibration"));
    // What holds for all cameras is not overlooked.
    for (key, problem) in [("\"fisheye\": true", "a fisheye has 4"), ("\"skew\": 2", "`skew` looks like calibration")] {
        let all = text.replacen("\"calibDataSource\"", &format!("{key}, \"calibDataSource\""), 1);
        fs::write(capture.path().join("calibration_160422.json"), all).unwrap();
        let message = refused("panoptic", capture.path());
        assert!(message.contains(problem), "{message}");
    }
}
