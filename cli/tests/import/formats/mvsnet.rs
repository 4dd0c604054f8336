//! MVSNet's files *_cam.txt.

use super::super::refused;
use super::{Pinhole, by_rows, check, folder, images, opencv, pinholes};
use std::fs;

/// The file of a camera.
pub fn mvsnet(pose: &Pinhole) -> String {
    let (r, t) = (by_rows(&pose.r), pose.t);
    let row = |i: usize| format!("{} {} {} {}\n", r[3 * i], r[3 * i + 1], r[3 * i + 2], t[i]);
    let k = pose.k().chunks(3).map(|r| format!("{} {} {}\n", r[0], r[1], r[2])).collect::<String>();
    format!("extrinsic\n{}{}{}0.0 0.0 0.0 1.0\n\nintrinsic\n{k}\n1.5 0.01 192 4.0\n", row(0), row(1), row(2))
}

#[test]
fn mvsnet_is_a_matrix_and_k_per_file() {
    let name = |i: usize| format!("{i:08}");
    let files: Vec<(String, String)> =
        pinholes().iter().enumerate().map(|(i, pose)| (format!("cams/{}_cam.txt", name(i)), mvsnet(pose))).collect();
    let texts: Vec<(&str, &str)> = files.iter().map(|(file, text)| (file.as_str(), text.as_str())).collect();
    let capture = folder(&images(name), &texts);
    let names: Vec<&str> = texts.iter().map(|(file, _)| *file).collect();
    let notes = check("mvsnet", capture.path(), &names, |pose, point| opencv(pose, point, |p| p));
    assert!(notes.contains("ranges of depths are ignored"), "{notes}");
    fs::write(capture.path().join(names[1]), texts[1].1.replace("0.0 1.0\n", "0.0 2.0\n")).unwrap();
    assert!(refused("mvsnet", capture.path()).contains("may be transposed"));
    fs::write(capture.path().join(names[1]), texts[1].1.replace("intrinsic", "")).unwrap();
    assert!(refused("mvsnet", capture.path()).contains("`intrinsic` is missing"));
}
