//! Agisoft Metashape's XML of cameras.

use super::super::{HEIGHT, WIDTH, import, import_with_notes, refused};
use super::{FISHEYE, Pinhole, by_rows, check, fisheye, folder, images, pinholes};
use glam::{DMat3, DVec2, DVec3};
use std::{fmt::Write as _, fs};

/// Metashape's XML: camera to chunk, and a chunk that is turned, moved and three times as large. Cameras whose lenses are equal
/// share a sensor. A last camera has no pose.
pub fn metashape(all: &[Pinhole], kind: &str, lens: impl Fn(&Pinhole) -> String) -> String {
    let turn = DMat3::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 0.9);
    let (shift, scale) = (DVec3::new(0.4, -0.3, 0.2), 3.0);
    let (mut cameras, mut sensors, mut lenses) = (String::new(), String::new(), Vec::new());
    for (i, pose) in all.iter().enumerate() {
        let lens = lens(pose);
        let sensor = lenses.iter().position(|known| *known == lens).unwrap_or(lenses.len());
        if sensor == lenses.len() {
            let [width, height] = pose.size;
            let _ = writeln!(
                sensors,
                "<sensor id=\"{sensor}\" label=\"unknown\" type=\"{kind}\">\n\
                 <resolution width=\"{width}\" height=\"{height}\"/>\n\
                 <calibration type=\"{kind}\" class=\"initial\"><f>1</f></calibration>\n\
                 <calibration type=\"{kind}\" class=\"adjusted\"><resolution width=\"{width}\" height=\"{height}\"/>\n{lens}\n\
                 </calibration>\n</sensor>"
            );
            lenses.push(lens);
        }
        // World to chunk, applied to the camera's axes and centre.
        let axes = turn.transpose() * pose.r.transpose();
        let centre = turn.transpose() * (-(pose.r.transpose() * pose.t) - shift) / scale;
        let row = |i: usize| format!("{} {} {} {}", axes.row(i).x, axes.row(i).y, axes.row(i).z, centre[i]);
        let _ = writeln!(
            cameras,
            "<camera id=\"{i}\" sensor_id=\"{sensor}\" component_id=\"0\" label=\"IMG_{i}\">\n\
             <transform>{} {} {} 0 0 0 1</transform>\n\
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
         <sensors next_id=\"1\">\n{sensors}</sensors>\n\
         <components><component id=\"0\" label=\"Component 1\">{world}</component></components>\n\
         <cameras next_id=\"9\">\n<group id=\"0\">\n{cameras}</group>\n\
         <camera id=\"99\" sensor_id=\"0\" label=\"IMG_99\"></camera>\n</cameras>\n</chunk>\n</document>\n"
    )
}

/// x, y of a point by the formulas in the appendix of Metashape's manual.
fn metashape_pixel(pose: &Pinhole, point: DVec3, bend: impl Fn(DVec2) -> DVec2) -> DVec2 {
    let c = pose.r * point + pose.t;
    let p = bend(DVec2::new(c.x / c.z, c.y / c.z));
    let (f, cx, cy, b1, b2) = (60.0, -1.5, 0.75, 0.5, 0.25);
    // The manual's pixels have their first centre at (0.5, 0.5).
    DVec2::new(0.5 * f64::from(WIDTH) + cx + p.x * f + p.x * b1 + p.y * b2, 0.5 * f64::from(HEIGHT) + cy + p.y * f)
        - 0.5
}

/// The four cameras, whose lenses are this.
fn four(kind: &str, lens: &str) -> String {
    metashape(&pinholes(), kind, |_| lens.to_owned())
}

#[test]
fn metashape_counts_from_the_middle_and_has_tangential_coefficients_exchanged() {
    let projection = "<f>60</f><cx>-1.5</cx><cy>0.75</cy><b1>0.5</b1><b2>0.25</b2>";
    let lens = format!("{projection}<k1>-0.1</k1><k2>0.05</k2><k3>-0.01</k3><k4>0</k4><p1>0.003</p1><p2>-0.002</p2>");
    let pictures = images(|i| format!("IMG_{i}"));
    let of = |text: &str| folder(&pictures, &[("cameras.xml", text)]);
    let text = four("frame", &lens);
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
    assert!(notes.contains("not aligned and are left out: IMG_99") && notes.contains("its scale of 3"), "{notes}");
    let fish = format!("{projection}<k1>-0.03</k1><k2>0.02</k2><k3>-0.01</k3><k4>0.003</k4>");
    for kind in ["fisheye", "equidistant_fisheye"] {
        check("metashape", of(&four(kind, &fish)).path(), &["cameras.xml"], |pose, point| {
            metashape_pixel(pose, point, |p| fisheye(p, FISHEYE))
        });
    }
    for (text, problem) in [
        (four("frame", &fish), "k4 = 0.003"),
        (four("equisolid_fisheye", &fish), "type `equisolid_fisheye`"),
        (four("fisheye", &lens), "p1 or p2 of a fisheye"),
        (four("frame", &format!("{lens}<p3>0.1</p3>")), "`p3` = 0.1"),
        (text.replace("<orientation>1", "<orientation>6"), "turned"),
        (text.replace("</chunk>", "</chunk><chunk></chunk>"), "2 chunks"),
        (text.replace("</sensors>", ""), "correct that line"),
        (text.replace("label=\"IMG_1\"", ""), "id `1` has no label"),
        (text.replace("id=\"99\"", "id=\"99\" master_id=\"0\""), "multi-camera system"),
        (text.replace("<orientation>1</orientation>", "<rolling_shutter>1</rolling_shutter>"), "rolling shutter"),
    ] {
        let message = refused("metashape", of(&text).path());
        assert!(message.contains(problem) && message.contains("cameras.xml"), "{message}");
    }
}

const PROJECTION: &str = "<f>60</f><cx>-1.5</cx><cy>0.75</cy>";

/// A chunk of two frames that hold this of every camera.
fn of_frames(camera: impl Fn(usize, usize) -> String) -> String {
    let frame = |frame: usize| {
        let cameras: String = (0..pinholes().len()).map(|i| camera(frame, i)).collect();
        format!("<frame id=\"{frame}\">\n<cameras>\n{cameras}</cameras>\n<markers/></frame>\n")
    };
    let frames = format!("<frames next_id=\"2\">\n{}{}</frames>\n</chunk>", frame(0), frame(1));
    four("frame", PROJECTION).replace("</chunk>", &frames)
}

#[test]
fn frames_of_a_chunk_become_a_clip() {
    let photo = |frame: usize, i: usize| format!("take{}IMG_{i}.png", ["0/", "1\\"][frame]);
    let text =
        of_frames(|frame, i| format!("<camera camera_id=\"{i}\"><photo path=\"{}\"/></camera>\n", photo(frame, i)));
    let pictures: Vec<String> = (0..8).map(|i| photo(i / 4, i % 4).replace('\\', "/")).collect();
    let capture = folder(&pictures, &[("cameras.xml", &text)]);
    let scene = import("auto", capture.path());
    assert_eq!(scene["cameras"].as_array().unwrap().len(), 4);
    let frames = scene["frames"].as_array().unwrap();
    assert_eq!(frames.len(), 2);
    for frame in frames {
        assert!(frame["images"].as_array().unwrap().iter().all(|image| image.is_string()));
    }
    fs::remove_file(capture.path().join("take1/IMG_2.png")).unwrap();
    let message = refused("metashape", capture.path());
    assert!(message.contains("`IMG_2`") && message.contains("is missing"), "{message}");
}

#[test]
fn frames_without_pictures_and_cameras_without_poses_are_named() {
    let text = of_frames(|_, _| String::new());
    let capture = folder(&images(|i| format!("IMG_{i}")), &[("cameras.xml", &text)]);
    let (scene, notes) = import_with_notes("metashape", capture.path());
    assert_eq!(scene["frames"].as_array().unwrap().len(), 1);
    assert!(notes.contains("has 2 frames, but the export does not name their pictures"), "{notes}");
    // As the note says.
    let numbered = |i: usize| format!("images/IMG_{}/{:06}.png", i % 4, i / 4);
    let capture = folder(&(0..8).map(numbered).collect::<Vec<_>>(), &[("cameras.xml", &text)]);
    assert_eq!(import("metashape", capture.path())["frames"].as_array().unwrap().len(), 2);

    let nowhere = text.replace("<transform>", "<other>").replace("</transform>", "</other>");
    let capture = folder(&images(|i| format!("IMG_{i}")), &[("cameras.xml", &nowhere)]);
    let message = refused("metashape", capture.path());
    assert!(message.contains("no camera that can be used") && message.contains("left out: IMG_0, IMG_1"), "{message}");
}

#[test]
fn projects_are_refused_with_what_to_export() {
    let document = "<document version=\"1.2.0\" path=\"{projectname}.files/project.zip\"/>";
    for (name, text, remedy) in [
        ("a.psx", document, "is a project of Metashape: export its cameras as XML"),
        ("A.PSX", "not even XML", "is a project of Metashape: export its cameras as XML"),
        ("a.psz", "PK\x03\x04", "is a project of Metashape: export its cameras as XML"),
        ("a.rcproj", "<project/>", "is a project of RealityCapture: export the registration"),
        ("database.db", "SQLite format 3", "has no poses: name the folder of the model"),
        ("poses_bounds.npy", "", "import the COLMAP model"),
    ] {
        let capture = folder(&[], &[(name, text)]);
        for path in [capture.path().to_path_buf(), capture.path().join(name)] {
            let message = refused("auto", &path);
            assert!(message.contains(name) && message.contains(remedy), "{message}");
        }
        if name.to_lowercase().contains(".ps") {
            assert!(refused("metashape", capture.path()).contains(remedy));
            assert!(refused("metashape", &capture.path().join(name)).contains(remedy));
        }
    }
    // Beside an export, a project does not matter.
    let capture =
        folder(&images(|i| format!("IMG_{i}")), &[("a.psx", document), ("c.xml", &four("frame", PROJECTION))]);
    import("auto", capture.path());
}

#[test]
fn a_folder_of_pictures_that_is_passed_over_is_named() {
    let mut pictures = images(|i| format!("IMG_{i}"));
    pictures.push(String::from("images/IMG_2/000000.png"));
    let capture = folder(&pictures, &[("cameras.xml", &four("frame", PROJECTION))]);
    let (scene, notes) = import_with_notes("metashape", capture.path());
    assert_eq!(scene["frames"].as_array().unwrap().len(), 1);
    assert!(notes.contains("IMG_2.png is taken, and") && notes.contains("images/IMG_2 is not"), "{notes}");
    fs::write(capture.path().join("images/IMG_3.mp4"), "a video").unwrap();
    assert!(import_with_notes("metashape", capture.path()).1.contains("IMG_3.mp4 is not"));
}

#[test]
fn groups_are_the_folders_of_pictures_whose_labels_repeat() {
    // Two groups with pictures of the same names, and a sensor for each.
    let text = four("frame", PROJECTION).replace("<group id=\"0\">", "<group id=\"0\" label=\"left\">");
    let text = text.replace("label=\"IMG_2\"", "label=\"IMG_0\"").replace("label=\"IMG_3\"", "label=\"IMG_1\"");
    let at = text.find("<camera id=\"2\"").unwrap();
    let (first, second) = text.split_at(at);
    let second = second.replace("sensor_id=\"0\"", "sensor_id=\"1\"");
    let start = first.find("<sensor id").unwrap();
    let sensor = &first[start..first.find("</sensors>").unwrap()];
    let other = sensor.replace("id=\"0\"", "id=\"1\"").replace("<f>60</f>", "<f>70</f>");
    let first = first.replace("</sensors>", &format!("{other}</sensors>"));
    let text = format!("{first}</group>\n<group id=\"1\" label=\"right\">\n{second}");
    let pictures = ["left/IMG_0.png", "left/IMG_1.png", "images/right/IMG_0.png", "images/right/IMG_1.png"];
    let capture = folder(&pictures.map(String::from), &[("cameras.xml", &text)]);
    let scene = import("auto", capture.path());
    let cameras = scene["cameras"].as_array().unwrap().iter();
    let found: Vec<_> =
        cameras.map(|camera| (camera["name"].as_str().unwrap(), camera["K"][0][0].as_f64().unwrap())).collect();
    assert_eq!(found, [("left_IMG_0", 60.0), ("left_IMG_1", 60.0), ("right_IMG_0", 70.0), ("right_IMG_1", 70.0)]);
    // A label does not lead out of the folder.
    let text = text.replace("label=\"left\"", "label=\"../left\"");
    let capture = folder(&pictures.map(String::from), &[("scene/cameras.xml", &text)]);
    assert!(refused("metashape", &capture.path().join("scene/cameras.xml")).contains("`IMG_0` is missing"));
}
