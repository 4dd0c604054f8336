//! Kalibr's camchain.yaml.

use super::super::{camera, import, refused};
use super::{BROWN, FISHEYE, Pinhole, brown, by_rows, fisheye, folder, images, opencv, pinholes, points};
use glam::{DVec2, DVec3};
use std::fmt::Write as _;

pub fn kalibr(cameras: &[Pinhole], model: &str, lens: &[f64]) -> String {
    let mut text = String::new();
    for (i, pose) in cameras.iter().enumerate() {
        let _ = write!(text, "cam{i}:\n  cam_overlaps: [1]\n  camera_model: pinhole\n");
        if i > 0 {
            let before = &cameras[i - 1];
            let r = pose.r * before.r.transpose();
            let t = pose.t - r * before.t;
            let rows = by_rows(&r);
            let row = |i: usize| format!("  - {:?}\n", [rows[3 * i], rows[3 * i + 1], rows[3 * i + 2], t[i]]);
            let _ = write!(text, "  T_cn_cnm1:\n{}{}{}  - [0.0, 0.0, 0.0, 1.0]\n", row(0), row(1), row(2));
        }
        let _ = write!(
            text,
            "  distortion_coeffs: {lens:?}\n  distortion_model: {model}\n  intrinsics: {:?}\n  resolution: {:?}\n\
             \x20 rostopic: /cam{i}/image_raw\n",
            [pose.focal.x, pose.focal.y, pose.principal.x, pose.principal.y],
            pose.size
        );
    }
    text
}

#[test]
fn kalibr_is_a_chain_whose_first_camera_is_the_origin() {
    let pictures = images(|i| format!("cam{i}"));
    let of = |text: &str| folder(&pictures, &[("camchain.yaml", text)]);
    // The scene is that of the first camera.
    let all = pinholes();
    let to_world = |point: DVec3| all[0].r.transpose() * (point - all[0].t);
    let seen = |text: &str, bend: &dyn Fn(DVec2) -> DVec2| {
        let capture = of(text);
        let scene = import("kalibr", capture.path());
        assert_eq!(import("auto", capture.path()), scene);
        for (i, pose) in all.iter().enumerate() {
            for world in points(pose) {
                let point = all[0].r * world + all[0].t;
                assert!((to_world(point) - world).length() < 1e-12);
                let (pixel, _) = camera(&scene, i).project(point).unwrap();
                assert!((pixel - opencv(pose, world, bend)).length() < 1e-6);
            }
        }
    };
    let radtan = kalibr(&all, "radtan", &BROWN[..4]);
    let [k1, k2, p1, p2, _] = BROWN;
    seen(&radtan, &|p| brown(p, [k1, k2, p1, p2, 0.0]));
    seen(&kalibr(&all, "equidistant", &FISHEYE), &|p| fisheye(p, FISHEYE));
    seen(&kalibr(&all, "none", &[]), &|p| p);
    for (text, problem) in [
        (radtan.replace("camera_model: pinhole", "camera_model: omni"), "camera_model omni is not supported"),
        (radtan.replace("cam2:", "cam7:"), "`cam2` is missing"),
        (radtan.replacen("  - [0.0, 0.0, 0.0, 1.0]", "  - [0.0, 0.0, 0.0, 2.0]", 1), "T_cn_cnm1"),
    ] {
        let message = refused("kalibr", of(&text).path());
        assert!(message.contains(problem), "{message}");
    }
}
