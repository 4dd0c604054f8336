//! Bundler's bundle.out.

use super::super::{HEIGHT, WIDTH, refused};
use super::{Pinhole, by_rows, check, folder, images, pinholes};
use glam::{DMat3, DVec2, DVec3};
use std::{fmt::Write as _, fs};

/// From OpenCV's axes to those of Bundler.
const TO_BUNDLER: DMat3 = DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0));

/// bundle.out and list.txt. The first camera has no pose. Principal points are not written.
pub fn bundler(cameras: &[Pinhole], [k1, k2]: [f64; 2]) -> [String; 2] {
    let mut text = format!("# Bundle file v0.3\n{} 1\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n", cameras.len() + 1);
    let mut names = String::from("lost.png\n");
    for (i, pose) in cameras.iter().enumerate() {
        let (r, t, f) = (TO_BUNDLER * pose.r, TO_BUNDLER * pose.t, pose.focal.x);
        let _ = writeln!(text, "{f} {k1} {k2}");
        let _ = writeln!(names, "images/c {i}.png 0 {f}");
        for row in by_rows(&r).chunks(3) {
            let _ = writeln!(text, "{} {} {}", row[0], row[1], row[2]);
        }
        let _ = writeln!(text, "{} {} {}", t.x, t.y, t.z);
    }
    text += "0.5 0.5 0.5\n255 255 255\n1 0 3 1.5 2.5\n";
    [text, names]
}

#[test]
fn bundler_has_y_up_z_backward_and_the_principal_point_in_the_middle() {
    let (f, k1, k2) = (60.5, -0.1, 0.05);
    let cameras: Vec<Pinhole> =
        pinholes().into_iter().map(|pinhole| Pinhole { focal: DVec2::splat(f), ..pinhole }).collect();
    let [text, names] = bundler(&cameras, [k1, k2]);
    let capture = folder(&images(|i| format!("c {i}")), &[("bundle/bundle.out", &text), ("list.txt", &names)]);
    let notes = check("bundler", capture.path(), &["bundle/bundle.out", "list.txt"], |pose, point| {
        let c = TO_BUNDLER * (pose.r * point + pose.t);
        let p = -DVec2::new(c.x, c.y) / c.z;
        let bent = p * f * (1.0 + k1 * p.length_squared() + k2 * p.length_squared().powi(2));
        // From the middle of the picture, y up, to pixels whose first centre is at (0, 0).
        DVec2::new(f64::from(WIDTH) / 2.0 + bent.x, f64::from(HEIGHT) / 2.0 - bent.y) - 0.5
    });
    assert!(notes.contains("`lost`") && notes.contains("has no pose and is left out"), "{notes}");
    fs::write(capture.path().join("list.txt"), names.replace("lost.png\n", "")).unwrap();
    assert!(refused("bundler", capture.path()).contains("has 5 cameras, but"));
    fs::write(capture.path().join("bundle/bundle.out"), &text[..400]).unwrap();
    assert!(refused("bundler", capture.path()).contains("truncated"));
}
