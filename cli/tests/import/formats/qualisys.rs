//! Calibrations of Qualisys Track Manager.

use super::super::{HEIGHT, WIDTH, camera, import, import_with_notes, refused};
use super::{BROWN, COUNT, FOCAL, PRINCIPAL, Pinhole, brown, check, folder, images, pinholes, points, sized_folder};
use glam::DVec2;
use pcmvs_scene::{Disk, Source};
use std::{fmt::Write as _, fs};

const FILE: &str = "a.qca.txt";

/// The serial number of a camera, which is its name.
pub fn serial(i: usize) -> String {
    (26580 + i).to_string()
}

/// The file of cameras whose videos show the whole sensor, with k1 k2 p1 p2 k3. Numbers have all their digits.
pub fn qualisys(cameras: &[Pinhole], [k1, k2, p1, p2, k3]: [f64; 5]) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<calibration created=\"2026-01-01\" qtm-version=\"2024.3\" type=\"regular\" \
         source=\"a.qca\" wandLength=\"601.1\">\n<results std-dev=\"0.4\" min-max-diff=\"2.6\"/>\n<cameras>\n",
    );
    for (i, camera) in cameras.iter().enumerate() {
        let [width, height] = camera.size;
        let area =
            |name: &str| format!("<{name} left=\"0\" top=\"0\" right=\"{}\" bottom=\"{}\"/>\n", width - 1, height - 1);
        let areas = ["fov_marker", "fov_marker_max", "fov_video", "fov_video_max"].map(area).concat();
        let centre = camera.centre() * 1000.0;
        // Right, up and backward in the world.
        let axes = [camera.r.row(0), -camera.r.row(1), -camera.r.row(2)];
        let rows = [1, 2, 3].map(|row| {
            let axis = axes[row - 1];
            format!("r{row}1=\"{}\" r{row}2=\"{}\" r{row}3=\"{}\"", axis.x, axis.y, axis.z)
        });
        let (focal, principal) = (camera.focal * 64.0, (camera.principal + 0.5) * 64.0);
        let _ = writeln!(
            text,
            "<camera active=\"1\" calibrated=\"true\" message=\"\" point-count=\"2241\" avg-residual=\"0.5\" serial=\"{}\" \
             model=\"Miqus Video\" viewrotation=\"0\" video_resolution=\"1080p\">\n{areas}\
             <transform x=\"{}\" y=\"{}\" z=\"{}\" {}/>\n\
             <intrinsic focallength=\"9.27\" sensorMinU=\"0.000000\" sensorMaxU=\"{}\" sensorMinV=\"0.000000\" sensorMaxV=\"{}\" \
             focalLengthU=\"{}\" focalLengthV=\"{}\" centerPointU=\"{}\" centerPointV=\"{}\" skew=\"0.000000\" \
             radialDistortion1=\"{k1}\" radialDistortion2=\"{k2}\" radialDistortion3=\"{k3}\" \
             tangentalDistortion1=\"{p1}\" tangentalDistortion2=\"{p2}\"/>\n</camera>",
            serial(i),
            centre.x,
            centre.y,
            centre.z,
            rows.join(" "),
            64 * width - 1,
            64 * height - 1,
            focal.x,
            focal.y,
            principal.x,
            principal.y
        );
    }
    text + "</cameras>\n</calibration>\n"
}

/// Where the camera sees a point: the sub-pixel from the edge of the sensor.
fn sub_pixel(pinhole: &Pinhole, point: glam::DVec3) -> DVec2 {
    let (right, up, back) = (pinhole.r.row(0), -pinhole.r.row(1), -pinhole.r.row(2));
    let seen = point - pinhole.centre();
    let (x, y, ahead) = (right.dot(seen), up.dot(seen), -back.dot(seen));
    let (focal, centre) = (FOCAL * 64.0, PRINCIPAL * 64.0 + 32.0);
    focal * brown(DVec2::new(x, -y) / ahead, BROWN) + centre
}

/// From the sensor's edge to the centre of the first pixel.
fn pixel(pinhole: &Pinhole, point: glam::DVec3) -> DVec2 {
    sub_pixel(pinhole, point) / 64.0 - 0.5
}

fn four() -> String {
    qualisys(&pinholes(), BROWN)
}

/// A text with the first camera once more, changed.
fn with_another(text: &str, serial: &str, changes: &[(&str, &str)]) -> String {
    let (start, end) = (text.find("<camera ").unwrap(), text.find("</camera>").unwrap());
    let mut camera = format!("{}</camera>\n", &text[start..end]).replace("26580", serial);
    for (from, to) in changes {
        assert!(camera.contains(from), "{from}");
        camera = camera.replace(from, to);
    }
    text.replace("</cameras>", &format!("{camera}</cameras>"))
}

#[test]
fn qualisys_has_sub_pixels_millimetres_and_opengl_axes_by_rows() {
    let text = with_another(&four(), "11", &[("Miqus Video", "Arqus A12")]);
    let text = with_another(&text, "12", &[("active=\"1\"", "active=\"0\"")]);
    let text = with_another(&text, "13", &[("calibrated=\"true\"", "calibrated=\"false\"")]);
    let mut pictures = images(serial);
    pictures.extend(["12", "13"].map(|name| format!("images/{name}.png")));
    let capture = folder(&pictures, &[(FILE, &text)]);
    let notes = check("qualisys", capture.path(), &[FILE], pixel);
    for expected in [
        "have neither pictures nor a video and are left out: `11` (Arqus A12)\n",
        "are not active and are left out: `12` (Miqus Video)\n",
        "are not calibrated and are left out: `13` (Miqus Video)\n",
        "positions are in millimetres, and the scene in metres",
        "principal points are taken to count from the left and the upper edge of the first pixel",
    ] {
        assert!(notes.contains(expected), "{notes}");
    }
    assert_eq!(import("auto", capture.path())["cameras"][3]["name"], "26583");

    // Other usual names, and a calibration inside of QTM's settings.
    let (head, rest) = text.split_once("?>\n").unwrap();
    let inside = format!("{head}?>\n<QTM_Parameters_Ver_1.25>\n<General/>\n{rest}</QTM_Parameters_Ver_1.25>");
    for (name, text) in [("a.xml", &text), ("take_calibration.txt", &inside), ("Calib.QCA.txt", &text)] {
        fs::remove_file(capture.path().join(FILE)).ok();
        fs::write(capture.path().join(name), text).unwrap();
        check("qualisys", capture.path(), &[name], pixel);
        fs::remove_file(capture.path().join(name)).unwrap();
    }
    // A file of any name is recognised if it is named.
    let other = capture.path().join("take 7.txt");
    fs::write(&other, &text).unwrap();
    assert_eq!(import("auto", &other)["cameras"].as_array().unwrap().len(), COUNT);
}

#[test]
fn poses_by_columns_are_named() {
    let text = [["r12", "r21"], ["r13", "r31"], ["r23", "r32"]].iter().fold(four(), |text, [a, b]| {
        text.replace(&format!("{a}="), "other=")
            .replace(&format!("{b}="), &format!("{a}="))
            .replace("other=", &format!("{b}="))
    });
    let capture = folder(&images(serial), &[(FILE, &text)]);
    let notes = import_with_notes("qualisys", capture.path()).1;
    assert!(notes.contains("these cameras will be refused when a frame is made"), "{notes}");
}

#[test]
fn a_video_is_a_part_of_the_sensor_and_pictures_may_be_smaller() {
    // 100 x 80 pixels, of which the video shows 64 x 48 from (20, 10) on.
    let whole = four().replace("right=\"63\" bottom=\"47\"", "right=\"99\" bottom=\"79\"");
    let whole = whole.replace("sensorMaxU=\"4095\"", "sensorMaxU=\"6399\"");
    let whole = whole.replace("sensorMaxV=\"3071\"", "sensorMaxV=\"5119\"");
    let part = whole.replace(
        "<fov_video left=\"0\" top=\"0\" right=\"99\" bottom=\"79\"/>",
        "<fov_video left=\"20\" top=\"10\" right=\"83\" bottom=\"57\"/>",
    );
    let capture = folder(&images(serial), &[(FILE, &part)]);
    let notes = check("qualisys", capture.path(), &[FILE], |pinhole, point| {
        sub_pixel(pinhole, point) / 64.0 - DVec2::new(20.0, 10.0) - 0.5
    });
    assert!(notes.contains("pictures of 64 x 48 pixels are taken to begin at the pixel (20, 10)"), "{notes}");

    // Every pixel of a picture is 4 x 4 pixels of the same part, or 2 x 2 pixels of the whole sensor.
    for (size, text, scale, first) in
        [([16, 12], &part, 4.0, DVec2::new(20.0, 10.0)), ([50, 40], &whole, 2.0, DVec2::ZERO)]
    {
        let capture = sized_folder(size, &images(serial), &[(FILE, text)]);
        let (scene, notes) = import_with_notes("qualisys", capture.path());
        for (i, pinhole) in pinholes().iter().enumerate() {
            for point in points(pinhole) {
                let seen = camera(&scene, i).project(point).unwrap().0;
                let expected = (sub_pixel(pinhole, point) / 64.0 - first) / scale - 0.5;
                assert!((seen - expected).length() < 1e-6, "{seen} instead of {expected}");
            }
        }
        let [width, height] = size;
        let expected = format!("pictures of {width} x {height} pixels are taken to show all of `fov_video`");
        assert!(notes.contains(&expected), "{notes}");
    }

    for (text, problem) in [
        (part.replace("left=\"20\"", "left=\"90\""), "`fov_video` is not a part of the 100 x 80 pixels"),
        (part.replace("bottom=\"57\"", "bottom=\"80\""), "`fov_video` is not a part of the 100 x 80 pixels"),
        (part.replace("bottom=\"57\"", "bottom=\"53\""), "its `fov_video` is 64 x 44, which has other proportions"),
        (whole.replace("sensorMaxV=\"5119\"", "sensorMaxV=\"5200\""), "not the last sub-pixels of 100 x 80 pixels"),
    ] {
        let message = refused("qualisys", folder(&images(serial), &[(FILE, &text)]).path());
        assert!(message.contains(problem) && message.contains("camera `26580`"), "{message}");
    }
}

#[test]
fn pictures_that_were_turned_are_refused_or_named() {
    let capture = sized_folder([HEIGHT, WIDTH], &images(serial), &[(FILE, &four())]);
    let message = refused("qualisys", capture.path());
    for expected in ["camera `26580`", "48 x 64", "64 x 48", "turned by a quarter", "turn them back"] {
        assert!(message.contains(expected), "{message}");
    }
    let upside_down = four().replacen("viewrotation=\"0\"", "viewrotation=\"180\"", 1);
    let capture = folder(&images(serial), &[(FILE, &upside_down)]);
    let notes = check("qualisys", capture.path(), &[FILE], pixel);
    assert!(notes.contains("camera `26580`: QTM shows its view turned by 180°"), "{notes}");
    assert!(!notes.contains("camera `26581`"), "{notes}");
}

#[test]
fn a_video_is_found_by_the_serial_number_in_its_name() {
    let capture = folder(&[], &[(FILE, &four())]);
    fs::create_dir_all(capture.path().join("videos/26583")).unwrap();
    for name in ["take_Miqus_1_26580.avi", "take_Miqus_2_26581.avi", "26582.mp4", "videos/26583/26583.avi"] {
        fs::write(capture.path().join(name), "not opened here").unwrap();
    }
    let imported = pcmvs_scene::import(&Disk, Source::Qualisys, &capture.path().join(FILE)).unwrap();
    assert!(imported.scene.videos);
    let names: Vec<_> =
        imported.scene.frames[0].images.iter().flatten().map(|path| path.file_name().unwrap()).collect();
    assert_eq!(names, ["take_Miqus_1_26580.avi", "take_Miqus_2_26581.avi", "26582.mp4", "26583.avi"]);
    assert!(imported.scene.cameras.iter().all(|camera| [camera.width, camera.height] == [WIDTH, HEIGHT]));
}

#[test]
fn calibrations_of_theia_are_refused() {
    // Sizes, focal lengths and principal points in pixels, without `fov_video`.
    let mut text = four();
    for (from, to) in [("sensorMaxU=\"4095\"", "sensorMaxU=\"64\""), ("sensorMaxV=\"3071\"", "sensorMaxV=\"48\"")] {
        text = text.replace(from, to);
    }
    let without: String =
        text.lines().filter(|line| !line.starts_with("<fov")).map(|line| format!("{line}\n")).collect();
    for text in [&text, &without] {
        for from in ["auto", "qualisys"] {
            let message = refused(from, folder(&images(serial), &[(FILE, text)]).path());
            assert!(message.contains("that Theia3D writes: these are not read"), "{message}");
            assert!(message.contains("name the calibration that QTM exported"), "{message}");
        }
    }
    // Pictures of half the size do not make them sub-pixels.
    let message = refused("qualisys", sized_folder([32, 24], &images(serial), &[(FILE, &without)]).path());
    assert!(message.contains("has no `fov_video`, as in calibrations that Theia3D writes"), "{message}");
}

#[test]
fn what_is_not_understood_of_qualisys_is_refused() {
    let text = four();
    for (from, to, problem) in [
        ("skew=\"0.000000\"", "skew=\"0.5\"", "skew is 0.5"),
        ("sensorMinU=\"0.000000\"", "sensorMinU=\"64\"", "sensorMinU is 64"),
        ("skew=", "radialDistortion4=\"0.1\" skew=", "`radialDistortion4` of `intrinsic` is not understood"),
        (" tangentalDistortion2=", " tangentialDistortion2=", "`tangentialDistortion2` of `intrinsic`"),
        (" radialDistortion3=\"0.004\"", "", "`radialDistortion3` is missing"),
        ("r33=", "r34=", "`r34` of `transform` is not understood"),
        ("model=", "lens_model=\"fisheye\" model=", "names a fisheye"),
        ("<transform", "<rotation q=\"1\"/>\n<transform", "`rotation` looks like calibration"),
        ("<transform", "<fov_video left=\"1\"/>\n<transform", "`fov_video` twice"),
        ("<transform ", "<pose ", "`pose` looks like calibration"),
        ("viewrotation=\"0\"", "viewrotation=\"45\"", "viewrotation is 45"),
        ("serial=\"26580\"", "serial=\"\"", "camera 1 of 4 has no `serial`"),
        ("serial=\"26580\"", "serial=\"26581\"", "camera `26581`"),
        ("focalLengthU=\"3904\"", "focalLengthU=\"3904,5\"", "`3904,5` is not a finite number"),
        ("focalLengthU=\"3904\"", "focalLengthU=\"-3904\"", "camera `26580`"),
        ("type=\"regular\"", "type=\"regular\" calibrated=\"false\"", "says that nothing is calibrated"),
        ("type=\"regular\"", "type=\"regular\" axis=\"OpenCV\"", "`axis` looks like calibration"),
        ("<cameras>", "<cameras coordinate_system=\"y up\">", "`coordinate_system` looks like calibration"),
        ("<cameras>", "<cameras>\n<calibration/>", "has 2 elements `calibration`"),
        ("</camera>", "</cameras>", "correct that line"),
    ] {
        assert!(text.contains(from), "{from}");
        let capture = folder(&images(serial), &[(FILE, &text.replacen(from, to, 1))]);
        let message = refused("qualisys", capture.path());
        assert!(message.contains(problem) && message.contains(FILE), "{message}");
    }
    let message = refused("auto", folder(&[], &[(FILE, &text)]).path());
    assert!(
        message.contains("none of its cameras has pictures or a video") && message.contains("`26580`"),
        "{message}"
    );
}
