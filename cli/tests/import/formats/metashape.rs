//! Agisoft Metashape's XML of cameras.

use super::super::{HEIGHT, WIDTH, refused};
use super::{FISHEYE, Pose, by_rows, check, fisheye, folder, images, poses};
use glam::{DMat3, DVec2, DVec3};
use std::fmt::Write as _;

/// Metashape's XML: camera to chunk, and a chunk that is turned, moved and three times as large.
fn metashape(kind: &str, lens: &str) -> String {
    let turn = DMat3::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 0.9);
    let (shift, scale) = (DVec3::new(0.4, -0.3, 0.2), 3.0);
    let mut cameras = String::new();
    for (i, pose) in poses().iter().enumerate() {
        // World to chunk, applied to the camera's axes and centre.
        let axes = turn.transpose() * pose.r.transpose();
        let centre = turn.transpose() * (-(pose.r.transpose() * pose.t) - shift) / scale;
        let row = |i: usize| format!("{} {} {} {}", axes.row(i).x, axes.row(i).y, axes.row(i).z, centre[i]);
        let _ = writeln!(
            cameras,
            "<camera id=\"{i}\" sensor_id=\"0\" component_id=\"0\" label=\"IMG_{i}\">\n<transform>{} {} {} 0 0 0 1</transform>\n\
             <orientation>1</orientation></camera>",
            row(0),
            row(1),
            row(2)
        );
    }
    let join = |n: &[f64]| n.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    let world = format!(
        "<transform><rotation locked=\"false\">{}</rotation><translation>{}</translation><scale>{scale}</scale></transform>",
        join(&by_rows(&turn)),
        join(&shift.to_array())
    );
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<document version=\"1.5.0\">\n<chunk label=\"Chunk 1\" enabled=\"true\">\n\
         <sensors next_id=\"1\">\n<sensor id=\"0\" label=\"unknown\" type=\"{kind}\">\n\
         <resolution width=\"{WIDTH}\" height=\"{HEIGHT}\"/>\n\
         <calibration type=\"{kind}\" class=\"initial\"><f>1</f></calibration>\n\
         <calibration type=\"{kind}\" class=\"adjusted\"><resolution width=\"{WIDTH}\" height=\"{HEIGHT}\"/>\n{lens}\n</calibration>\n\
         </sensor>\n</sensors>\n<components><component id=\"0\" label=\"Component 1\">{world}</component></components>\n\
         <cameras next_id=\"9\">\n<group id=\"0\">\n{cameras}</group>\n\
         <camera id=\"8\" sensor_id=\"0\" label=\"IMG_8\"></camera>\n</cameras>\n</chunk>\n</document>\n"
    )
}

/// x, y of a point by the formulas in the appendix of Metashape's manual.
fn metashape_pixel(pose: &Pose, point: DVec3, bend: impl Fn(DVec2) -> DVec2) -> DVec2 {
    let c = pose.r * point + pose.t;
    let p = bend(DVec2::new(c.x / c.z, c.y / c.z));
    let (f, cx, cy, b1, b2) = (60.0, -1.5, 0.75, 0.5, 0.25);
    // The manual's pixels have their first centre at (0.5, 0.5).
    DVec2::new(0.5 * f64::from(WIDTH) + cx + p.x * f + p.x * b1 + p.y * b2, 0.5 * f64::from(HEIGHT) + cy + p.y * f)
        - 0.5
}

#[test]
fn metashape_counts_from_the_middle_and_has_tangential_coefficients_exchanged() {
    let projection = "<f>60</f><cx>-1.5</cx><cy>0.75</cy><b1>0.5</b1><b2>0.25</b2>";
    let lens = format!("{projection}<k1>-0.1</k1><k2>0.05</k2><k3>-0.01</k3><k4>0</k4><p1>0.003</p1><p2>-0.002</p2>");
    let pictures = images(|i| format!("IMG_{i}"));
    let of = |text: &str| folder(&pictures, &[("cameras.xml", text)]);
    let text = metashape("frame", &lens);
    let notes = check("metashape", of(&text).path(), &["cameras.xml"], |pose, point| {
        metashape_pixel(pose, point, |p| {
            let (x, y, r2) = (p.x, p.y, p.length_squared());
            let radial = 1.0 - 0.1 * r2 + 0.05 * r2.powi(2) - 0.01 * r2.powi(3);
            let (p1, p2) = (0.003, -0.002);
            DVec2::new(
                x * radial + p1 * (r2 + 2.0 * x * x) + 2.0 * p2 * x * y,
                y * radial + p2 * (r2 + 2.0 * y * y) + 2.0 * p1 * x * y,
            )
        })
    });
    assert!(notes.contains("not aligned and are left out: IMG_8") && notes.contains("its scale of 3"), "{notes}");
    let fish = format!("{projection}<k1>-0.03</k1><k2>0.02</k2><k3>-0.01</k3><k4>0.003</k4>");
    for kind in ["fisheye", "equidistant_fisheye"] {
        check("metashape", of(&metashape(kind, &fish)).path(), &["cameras.xml"], |pose, point| {
            metashape_pixel(pose, point, |p| fisheye(p, FISHEYE))
        });
    }
    for (text, problem) in [
        (metashape("frame", &fish), "k4 = 0.003"),
        (metashape("equisolid_fisheye", &fish), "type `equisolid_fisheye`"),
        (metashape("fisheye", &lens), "p1 or p2 of a fisheye"),
        (metashape("frame", &format!("{lens}<p3>0.1</p3>")), "`p3` = 0.1"),
        (text.replace("<orientation>1", "<orientation>6"), "turned"),
        (text.replace("</chunk>", "</chunk><chunk></chunk>"), "2 chunks"),
        (text.replace("</sensors>", ""), "correct that line"),
    ] {
        let message = refused("metashape", of(&text).path());
        assert!(message.contains(problem) && message.contains("cameras.xml"), "{message}");
    }
}
