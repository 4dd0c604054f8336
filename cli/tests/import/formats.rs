//! The same four cameras in the format of every program, written here by the formulas of that program. The imported cameras
//! see points at the corners of the pictures where that program sees them.

use super::{HEIGHT, WIDTH, import, import_with_notes, refused};
use glam::{DMat3, DVec2, DVec3};
use image::{GrayImage, RgbImage};
use std::{
    fmt::Write as _,
    fs,
    path::{Path, PathBuf},
};
use tempfile::TempDir;

const COUNT: usize = 4;
/// Focal lengths, and a principal point off the middle.
const FOCAL: DVec2 = DVec2::new(61.0, 63.5);
const PRINCIPAL: DVec2 = DVec2::new(30.25, 24.75);
/// k1 k2 p1 p2 k3 in OpenCV's order.
const BROWN: [f64; 5] = [-0.11, 0.03, 0.002, -0.003, 0.004];
const FISHEYE: [f64; 4] = [-0.03, 0.02, -0.01, 0.003];

/// Pose of a camera, world to camera as in OpenCV.
struct Pose {
    r: DMat3,
    t: DVec3,
}

fn poses() -> Vec<Pose> {
    let pose = |i: usize| {
        let angle = i as f64 * 1.4 + 0.2;
        let centre = DVec3::new(3.0 * angle.cos(), 3.0 * angle.sin(), 0.8 + 0.3 * i as f64);
        let forward = (DVec3::new(0.1, -0.2, 0.1 * i as f64) - centre).normalize();
        let right = forward.cross(DVec3::new(0.1, 0.2, 1.0)).normalize();
        let r = DMat3::from_cols(right, forward.cross(right), forward).transpose();
        Pose { r, t: -(r * centre) }
    };
    (0..COUNT).map(pose).collect()
}

/// Points that the cameras see near the corners and in the middle of their pictures.
fn points(pose: &Pose) -> Vec<DVec3> {
    let rays = [(0.0, 0.0), (-0.45, -0.35), (0.5, -0.34), (-0.44, 0.36), (0.47, 0.33)];
    rays.map(|(x, y)| pose.r.transpose() * (DVec3::new(x, y, 1.0) * 2.7 - pose.t)).into()
}

fn brown(p: DVec2, [k1, k2, p1, p2, k3]: [f64; 5]) -> DVec2 {
    let (x, y, r2) = (p.x, p.y, p.length_squared());
    let radial = 1.0 + k1 * r2 + k2 * r2.powi(2) + k3 * r2.powi(3);
    p * radial + DVec2::new(2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x), p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y)
}

fn fisheye(p: DVec2, [k1, k2, k3, k4]: [f64; 4]) -> DVec2 {
    let angle = p.length().atan();
    let bent = angle + k1 * angle.powi(3) + k2 * angle.powi(5) + k3 * angle.powi(7) + k4 * angle.powi(9);
    if angle == 0.0 { p } else { p * (bent / p.length()) }
}

/// OpenCV's pixel with a distortion.
fn opencv(pose: &Pose, point: DVec3, bend: impl Fn(DVec2) -> DVec2) -> DVec2 {
    let c = pose.r * point + pose.t;
    FOCAL * bend(DVec2::new(c.x / c.z, c.y / c.z)) + PRINCIPAL
}

/// A folder with pictures of these names, four masks and one or more text files.
fn folder(pictures: &[String], texts: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for name in pictures {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        RgbImage::new(WIDTH, HEIGHT).save(path).unwrap();
    }
    for (name, text) in texts {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    folder
}

fn images(name: impl Fn(usize) -> String) -> Vec<String> {
    (0..COUNT).map(|i| format!("images/{}.png", name(i))).collect()
}

/// Imports by name, by recognition of the folder and of the file, with a byte-order mark and with other line ends. All give
/// the same cameras, which see what `pixel` says.
fn check(format: &str, folder: &Path, files: &[&str], pixel: impl Fn(&Pose, DVec3) -> DVec2) -> String {
    let (scene, notes) = import_with_notes(format, folder);
    assert_eq!(scene["cameras"].as_array().unwrap().len(), COUNT, "{format}");
    for (i, pose) in poses().iter().enumerate() {
        let camera = super::camera(&scene, i);
        for point in points(pose) {
            let seen = camera.project(point).expect("it is in front").0;
            let off = (seen - pixel(pose, point)).length();
            assert!(off < 1e-6, "{format}: camera {i} is {off} px off at {seen}");
        }
    }
    assert_eq!(import("auto", folder), scene, "{format}");
    let first = folder.join(files[0]);
    assert_eq!(import("auto", &first), scene, "{format}");
    assert_eq!(import(format, &first), scene, "{format}");
    for change in [|text: &str| format!("\u{feff}{text}"), |text: &str| text.replace('\n', "\r\n")] {
        for file in files {
            let path = folder.join(file);
            let Ok(text) = fs::read_to_string(&path) else { continue };
            fs::write(&path, change(text.trim_start_matches('\u{feff}'))).unwrap();
        }
        assert_eq!(import(format, folder), scene, "{format}");
    }
    notes
}

fn list(numbers: impl IntoIterator<Item = f64>) -> String {
    numbers.into_iter().map(|v| format!("{v:?}")).collect::<Vec<_>>().join(", ")
}

/// Numbers of a matrix by rows.
fn by_rows(m: &DMat3) -> [f64; 9] {
    m.transpose().to_cols_array()
}

fn k() -> [f64; 9] {
    [FOCAL.x, 0.0, PRINCIPAL.x, 0.0, FOCAL.y, PRINCIPAL.y, 0.0, 0.0, 1.0]
}

/// Rodrigues' vector of a rotation.
fn rodrigues(r: &DMat3) -> DVec3 {
    let (axis, angle) = glam::DQuat::from_mat3(r).to_axis_angle();
    axis * angle
}

fn easymocap() -> [String; 2] {
    let names = (0..COUNT).map(|i| format!("  - \"0{i}\"\n")).collect::<String>();
    let matrix = |key: String, rows: usize, data: &[f64]| {
        let columns = data.len() / rows;
        let data = list(data.iter().copied());
        format!("{key}: !!opencv-matrix\n  rows: {rows}\n  cols: {columns}\n  dt: d\n  data: [{data}]\n")
    };
    let mut files = [(); 2].map(|()| format!("%YAML:1.0\n---\nnames:\n{names}"));
    for (i, pose) in poses().iter().enumerate() {
        files[0] += &matrix(format!("K_0{i}"), 3, &k());
        files[0] += &matrix(format!("dist_0{i}"), 1, &BROWN);
        let _ = write!(files[0], "H_0{i}: {HEIGHT}\nW_0{i}: {WIDTH}\n");
        files[1] += &matrix(format!("R_0{i}"), 3, &rodrigues(&pose.r).to_array());
        files[1] += &matrix(format!("Rot_0{i}"), 3, &by_rows(&pose.r));
        files[1] += &matrix(format!("T_0{i}"), 3, &pose.t.to_array());
        let _ = write!(files[1], "n_0{i}: 0.1\nf_0{i}: 9.0\n");
    }
    files
}

#[test]
fn easymocap_is_opencv_in_two_files() {
    let [intri, extri] = easymocap();
    let texts = [("intri.yml", intri.as_str()), ("extri.yml", extri.as_str())];
    let of = |pictures: &[String], texts: &[(&str, &str)]| folder(pictures, texts);
    let capture = of(&images(|i| format!("0{i}")), &texts);
    let notes = check("easymocap", capture.path(), &["intri.yml", "extri.yml"], |pose, point| {
        opencv(pose, point, |p| brown(p, BROWN))
    });
    assert!(notes.contains("ignored of every camera: `n`, `f`"), "{notes}");

    // A folder per camera is a clip.
    let clip: Vec<String> =
        (0..COUNT).flat_map(|i| [3, 4].map(|frame| format!("images/0{i}/00000{frame}.png"))).collect();
    let capture = of(&clip, &texts);
    fs::create_dir_all(capture.path().join("masks/01")).unwrap();
    GrayImage::new(WIDTH, HEIGHT).save(capture.path().join("masks/01/000004.png")).unwrap();
    let scene = import("auto", capture.path());
    assert_eq!(scene["cameras"][1]["name"], "01");
    assert_eq!(scene["frames"].as_array().unwrap().len(), 2);
    assert_eq!(scene["frames"][1]["masks"], serde_json::json!([null, "masks/01_0001.png", null, null]));

    for (file, from, to, problem) in [
        ("intri.yml", "K_02", "X_02", "`K_02` is missing"),
        ("extri.yml", "T_01", "U_01", "`T_01` is missing"),
        ("extri.yml", "- \"03\"", "- \"04\"", "`R_04` is missing"),
        ("intri.yml", "dist_02", "distortion_02", "`distortion` looks like calibration"),
        ("intri.yml", "names:", "focal: 3\nnames:", "`focal` looks like calibration"),
        (
            "extri.yml",
            "R_00: !!opencv-matrix\n  rows: 3\n  cols: 1\n  dt: d\n  data: [",
            "R_00: !!opencv-matrix\n  rows: 3\n  cols: 1\n  dt: d\n  data: [1",
            "different rotations",
        ),
    ] {
        let changed =
            texts.map(|(name, text)| (name, if name == file { text.replace(from, to) } else { text.to_owned() }));
        let changed: Vec<(&str, &str)> = changed.iter().map(|(name, text)| (*name, text.as_str())).collect();
        let message = refused("easymocap", of(&images(|i| format!("0{i}")), &changed).path());
        assert!(message.contains(problem), "{message}");
    }
}

#[test]
fn bundler_has_y_up_z_backward_and_the_principal_point_in_the_middle() {
    let (f, k1, k2) = (60.5, -0.1, 0.05);
    let to_bundler = DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0));
    let mut text = format!("# Bundle file v0.3\n{} 1\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n", COUNT + 1);
    for pose in poses() {
        let (r, t) = (to_bundler * pose.r, to_bundler * pose.t);
        let _ = writeln!(text, "{f} {k1} {k2}");
        for row in by_rows(&r).chunks(3) {
            let _ = writeln!(text, "{} {} {}", row[0], row[1], row[2]);
        }
        let _ = writeln!(text, "{} {} {}", t.x, t.y, t.z);
    }
    text += "0.5 0.5 0.5\n255 255 255\n1 0 3 1.5 2.5\n";
    let names: String =
        (0..COUNT).fold(String::from("lost.png\n"), |all, i| all + &format!("images/c {i}.png 0 {f}\n"));
    let capture = folder(&images(|i| format!("c {i}")), &[("bundle/bundle.out", &text), ("list.txt", &names)]);
    let notes = check("bundler", capture.path(), &["bundle/bundle.out", "list.txt"], |pose, point| {
        let c = to_bundler * (pose.r * point + pose.t);
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

fn anipose(table: impl Fn(usize) -> String, lens: &str) -> String {
    let mut text = String::from("[metadata]\nadjusted = false\nerror = 0.3\n\n");
    for (i, pose) in poses().iter().enumerate() {
        let rows = k().chunks(3).map(|row| format!("[ {},]", list(row.iter().copied()))).collect::<Vec<_>>().join(", ");
        let _ = write!(
            text,
            "[{}]\nname = \"c{i}\"\nsize = [ {WIDTH}, {HEIGHT},]\nmatrix = [ {rows},]\n{lens}\nrotation = [ {},]\n\
             translation = [ {},]\nworld_position = [ 1.0, 2.0, 3.0,]\n\n",
            table(i),
            list(rodrigues(&pose.r).to_array()),
            list(pose.t.to_array())
        );
    }
    text
}

#[test]
fn anipose_is_opencv_in_toml() {
    let pictures = images(|i| format!("c{i}"));
    let of = |text: &str| folder(&pictures, &[("calibration.toml", text)]);
    let lens = format!("distortions = [ {},]", list(BROWN));
    for text in [anipose(|i| format!("cam_{i}"), &lens), anipose(|i| format!("cameras.{i}"), &lens)] {
        check("anipose", of(&text).path(), &["calibration.toml"], |pose, point| {
            opencv(pose, point, |p| brown(p, BROWN))
        });
    }
    let lens = format!("fisheye = true\ndistortions = [ {},]", list(FISHEYE));
    let text = anipose(|i| format!("cam_{i}"), &lens);
    check("anipose", of(&text).path(), &["calibration.toml"], |pose, point| {
        opencv(pose, point, |p| fisheye(p, FISHEYE))
    });
    for (change, problem) in [
        ("rotation_count = 1", "pictures are turned"),
        ("skew_y = 0.1", "`skew_y` looks like calibration"),
        ("name = \"again\"", "correct that line"),
    ] {
        let message =
            refused("anipose", of(&text.replacen("fisheye = true", &format!("fisheye = true\n{change}"), 1)).path());
        assert!(message.contains(problem) && message.contains("calibration.toml"), "{message}");
    }
    let ignored = text.replacen("fisheye = true", "fisheye = true\nignore = true", 1);
    let (scene, notes) = import_with_notes("anipose", of(&ignored).path());
    assert_eq!(scene["cameras"].as_array().unwrap().len(), COUNT - 1);
    assert!(notes.contains("`c0`") && notes.contains("left out"), "{notes}");
}

#[test]
fn panoptic_is_opencv_in_a_list() {
    let camera = |(i, pose): (usize, &Pose)| {
        serde_json::json!({
            "name": format!("00_0{i}"), "type": "hd", "resolution": [WIDTH, HEIGHT], "panel": 0, "node": i,
            "K": [&k()[..3], &k()[3..6], &k()[6..]], "distCoef": BROWN,
            "R": by_rows(&pose.r).chunks(3).collect::<Vec<_>>(), "t": pose.t.to_array().map(|v| [v]),
        })
    };
    let mut cameras: Vec<_> = poses().iter().enumerate().map(camera).collect();
    cameras.push(serde_json::json!({ "name": "01_01", "K": [], "distCoef": [] }));
    let file = serde_json::json!({ "calibDataSource": "160422", "cameras": cameras });
    let text = serde_json::to_string_pretty(&file).unwrap();
    let capture = folder(&images(|i| format!("00_0{i}")), &[("calibration_160422.json", &text)]);
    let notes = check("panoptic", capture.path(), &["calibration_160422.json"], |pose, point| {
        opencv(pose, point, |p| brown(p, BROWN))
    });
    assert!(notes.contains("1 of 5 cameras have no picture and are left out, such as `01_01`"), "{notes}");
    let odd = text.replacen("\"panel\"", "\"skew\": 3, \"panel\"", 1);
    fs::write(capture.path().join("calibration_160422.json"), odd).unwrap();
    assert!(refused("panoptic", capture.path()).contains("`skew` looks like calibration"));
}

#[test]
fn mvsnet_is_a_matrix_and_k_per_file() {
    let text = |pose: &Pose| {
        let (r, t) = (by_rows(&pose.r), pose.t);
        let row = |i: usize| format!("{} {} {} {}\n", r[3 * i], r[3 * i + 1], r[3 * i + 2], t[i]);
        let k = k().chunks(3).map(|r| format!("{} {} {}\n", r[0], r[1], r[2])).collect::<String>();
        format!("extrinsic\n{}{}{}0.0 0.0 0.0 1.0\n\nintrinsic\n{k}\n1.5 0.01 192 4.0\n", row(0), row(1), row(2))
    };
    let name = |i: usize| format!("{i:08}");
    let files: Vec<(String, String)> =
        poses().iter().enumerate().map(|(i, pose)| (format!("cams/{}_cam.txt", name(i)), text(pose))).collect();
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

fn kalibr(model: &str, lens: &[f64]) -> String {
    let mut text = String::new();
    let all = poses();
    for (i, pose) in all.iter().enumerate() {
        let _ = write!(text, "cam{i}:\n  cam_overlaps: [1]\n  camera_model: pinhole\n");
        if i > 0 {
            let before = &all[i - 1];
            let r = pose.r * before.r.transpose();
            let t = pose.t - r * before.t;
            let rows = by_rows(&r);
            let row = |i: usize| format!("  - {:?}\n", [rows[3 * i], rows[3 * i + 1], rows[3 * i + 2], t[i]]);
            let _ = write!(text, "  T_cn_cnm1:\n{}{}{}  - [0.0, 0.0, 0.0, 1.0]\n", row(0), row(1), row(2));
        }
        let _ = write!(
            text,
            "  distortion_coeffs: {lens:?}\n  distortion_model: {model}\n  intrinsics: {:?}\n  resolution: [{WIDTH}, {HEIGHT}]\n\
             \x20 rostopic: /cam{i}/image_raw\n",
            [FOCAL.x, FOCAL.y, PRINCIPAL.x, PRINCIPAL.y]
        );
    }
    text
}

#[test]
fn kalibr_is_a_chain_whose_first_camera_is_the_origin() {
    let pictures = images(|i| format!("cam{i}"));
    let of = |text: &str| folder(&pictures, &[("camchain.yaml", text)]);
    // The scene is that of the first camera.
    let all = poses();
    let to_world = |point: DVec3| all[0].r.transpose() * (point - all[0].t);
    let seen = |text: &str, bend: &dyn Fn(DVec2) -> DVec2| {
        let capture = of(text);
        let scene = import("kalibr", capture.path());
        assert_eq!(import("auto", capture.path()), scene);
        for (i, pose) in all.iter().enumerate() {
            for world in points(pose) {
                let point = all[0].r * world + all[0].t;
                assert!((to_world(point) - world).length() < 1e-12);
                let (pixel, _) = super::camera(&scene, i).project(point).unwrap();
                assert!((pixel - opencv(pose, world, bend)).length() < 1e-6);
            }
        }
    };
    let radtan = kalibr("radtan", &BROWN[..4]);
    let [k1, k2, p1, p2, _] = BROWN;
    seen(&radtan, &|p| brown(p, [k1, k2, p1, p2, 0.0]));
    seen(&kalibr("equidistant", &FISHEYE), &|p| fisheye(p, FISHEYE));
    seen(&kalibr("none", &[]), &|p| p);
    for (text, problem) in [
        (radtan.replace("camera_model: pinhole", "camera_model: omni"), "camera_model omni is not supported"),
        (radtan.replace("cam2:", "cam7:"), "`cam2` is missing"),
        (radtan.replacen("  - [0.0, 0.0, 0.0, 1.0]", "  - [0.0, 0.0, 0.0, 2.0]", 1), "T_cn_cnm1"),
    ] {
        let message = refused("kalibr", of(&text).path());
        assert!(message.contains(problem), "{message}");
    }
}

#[test]
fn realitycapture_has_shares_of_the_larger_side_and_the_centre() {
    let (f, u, v, [k1, k2, k3]) = (34.5, 0.0125, -0.02, [-0.12, 0.1, -0.01]);
    let join = |n: &[f64]| n.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    let text = |pose: &Pose| {
        let centre = -(pose.r.transpose() * pose.t);
        format!(
            "<x:xmpmeta xmlns:x=\"adobe:ns:meta/\">\n <rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\">\n\
             <rdf:Description xcr:Version=\"3\" xcr:PosePrior=\"exact\" xcr:Coordinates=\"absolute\"\n\
             xcr:DistortionModel=\"brown3\" xcr:FocalLength35mm=\"{f}\" xcr:Skew=\"0\" xcr:AspectRatio=\"1\"\n\
             xcr:PrincipalPointU=\"{u}\" xcr:PrincipalPointV=\"{v}\" xcr:Comment=\"x\"\n\
             xmlns:xcr=\"http://www.capturingreality.com/ns/xcr/1.1#\">\n<xcr:Rotation>{}</xcr:Rotation>\n\
             <xcr:Position>{}</xcr:Position>\n<xcr:DistortionCoeficients>{k1} {k2} {k3} 0 0 0</xcr:DistortionCoeficients>\n\
             </rdf:Description>\n</rdf:RDF>\n</x:xmpmeta>\n",
            join(&by_rows(&pose.r)),
            join(&centre.to_array())
        )
    };
    let files: Vec<(String, String)> =
        poses().iter().enumerate().map(|(i, pose)| (format!("images/c{i}.xmp"), text(pose))).collect();
    let texts: Vec<(&str, &str)> = files.iter().map(|(file, text)| (file.as_str(), text.as_str())).collect();
    let names: Vec<&str> = texts.iter().map(|(file, _)| *file).collect();
    let capture = folder(&images(|i| format!("c{i}")), &texts);
    let notes = check("realitycapture", capture.path(), &names, |pose, point| {
        let c = pose.r * point + pose.t;
        let p = brown(DVec2::new(c.x / c.z, c.y / c.z), [k1, k2, 0.0, 0.0, k3]);
        let share = p * f / 36.0 + DVec2::new(u, v);
        // From the middle of the picture to pixels whose first centre is at (0, 0).
        share * f64::from(WIDTH) + DVec2::new(f64::from(WIDTH), f64::from(HEIGHT)) / 2.0 - 0.5
    });
    assert!(notes.contains("ignored of every .xmp: `Comment`"), "{notes}");
    for (from, to, problem) in [
        ("Skew=\"0\"", "Skew=\"0.1\"", "Skew"),
        ("0 0 0</xcr:Dist", "0 0.01 0</xcr:Dist", "choose Brown3"),
        ("\"brown3\"", "\"division\"", "choose Brown3"),
        ("xcr:Position", "xcr:Place", "`Position` is missing"),
        ("xcr:Comment=\"x\"", "xcr:FisheyeShift=\"2\"", "`FisheyeShift`"),
    ] {
        fs::write(capture.path().join(names[2]), texts[2].1.replace(from, to)).unwrap();
        let message = refused("realitycapture", capture.path());
        assert!(message.contains(problem) && message.contains("c2.xmp"), "{message}");
    }
}

/// An .npz file: stored entries, one array of 4 x 4 numbers of eight bytes each.
fn npz(arrays: &[(String, [f64; 16])]) -> Vec<u8> {
    let (mut bytes, mut directory) = (Vec::new(), Vec::new());
    for (name, numbers) in arrays {
        let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (4, 4), }";
        let mut array = b"\x93NUMPY\x01\x00".to_vec();
        let padded = format!("{header:<117}\n");
        array.extend((padded.len() as u16).to_le_bytes());
        array.extend(padded.bytes());
        numbers.iter().for_each(|v| array.extend(v.to_le_bytes()));
        let name = format!("{name}.npy");
        let at = bytes.len() as u32;
        let mut crc = flate2::Crc::new();
        crc.update(&array);
        let mut fields = Vec::new();
        [20u16, 0, 0, 0, 0].iter().for_each(|v| fields.extend(v.to_le_bytes()));
        [crc.sum(), array.len() as u32, array.len() as u32].iter().for_each(|v| fields.extend(v.to_le_bytes()));
        [name.len() as u16, 0].iter().for_each(|v| fields.extend(v.to_le_bytes()));
        bytes.extend(b"PK\x03\x04");
        bytes.extend(&fields);
        bytes.extend(name.bytes());
        bytes.extend(array);
        directory.extend(b"PK\x01\x02\x14\x00");
        directory.extend(&fields);
        directory.extend([0; 10]);
        directory.extend(at.to_le_bytes());
        directory.extend(name.bytes());
    }
    let start = bytes.len() as u32;
    let count = (arrays.len() as u16).to_le_bytes();
    bytes.extend(&directory);
    bytes.extend(b"PK\x05\x06\x00\x00\x00\x00");
    [count, count].iter().for_each(|v| bytes.extend(v));
    [directory.len() as u32, start].iter().for_each(|v| bytes.extend(v.to_le_bytes()));
    bytes.extend([0, 0]);
    bytes
}

#[test]
fn neus_is_a_projection_matrix_in_npz() {
    let mut arrays = Vec::new();
    for (i, pose) in poses().iter().enumerate() {
        let k = DMat3::from_cols_array(&k()).transpose();
        let (m, p) = (k * pose.r, k * pose.t);
        // Projections may have any scale, and the other sign.
        let scale = [1.0, 0.01, -2.0, 7.0][i];
        let numbers: Vec<f64> =
            (0..3).flat_map(|r| [m.row(r).x, m.row(r).y, m.row(r).z, p[r]]).map(|v| v * scale).collect();
        let mut world = [0.0; 16];
        world[..12].copy_from_slice(&numbers);
        world[15] = 1.0;
        arrays.push((format!("world_mat_{i}"), world));
        arrays.push((format!("scale_mat_{i}"), [2.0; 16]));
    }
    let pictures: Vec<String> = (0..COUNT).map(|i| format!("image/{i:06}.png")).collect();
    let capture = folder(&pictures, &[]);
    let file: PathBuf = capture.path().join("cameras_sphere.npz");
    fs::write(&file, npz(&arrays)).unwrap();
    fs::create_dir(capture.path().join("mask")).unwrap();
    GrayImage::new(WIDTH, HEIGHT).save(capture.path().join("mask/002.png")).unwrap();
    let notes = check("neus", capture.path(), &["cameras_sphere.npz"], |pose, point| opencv(pose, point, |p| p));
    assert!(notes.contains("scale_mat is ignored"), "{notes}");
    let scene = import("neus", capture.path());
    assert_eq!(scene["frames"][0]["masks"], serde_json::json!([null, null, "masks/000002.png", null]));
    let whole = fs::read(&file).unwrap();
    fs::write(&file, &whole[..whole.len() - 30]).unwrap();
    assert!(refused("neus", capture.path()).contains("cameras_sphere.npz"));
    arrays.push((String::from("pose_3"), [0.0; 16]));
    fs::write(&file, npz(&arrays)).unwrap();
    assert!(refused("neus", capture.path()).contains("`pose_3` is not understood"));
    arrays.retain(|(name, _)| name != "world_mat_1" && name != "pose_3");
    fs::write(&file, npz(&arrays)).unwrap();
    let message = refused("neus", capture.path());
    assert!(message.contains("`world_mat_1` is missing"), "{message}");
}
