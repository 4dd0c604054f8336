//! Stereo pairs of OpenCV: `x2 = R x1 + T`, in the world of the first camera.

use super::super::{HEIGHT, WIDTH, camera, import, import_with_notes, refused};
use super::{BROWN, Pinhole, brown, by_rows, folder, list, opencv, pinholes, points};
use glam::{DMat3, DVec3};
use serde_json::{Value, json};
use tempfile::TempDir;

/// The step between two cameras.
fn step(from: &Pinhole, to: &Pinhole) -> (DMat3, DVec3) {
    let r = to.r * from.r.transpose();
    (r, to.t - r * from.t)
}

/// Keys, rows and numbers of matrices, in the order in which a program writes them.
pub type Matrices = Vec<(String, usize, Vec<f64>)>;

fn lens(keys: [&str; 2]) -> Matrices {
    lens_of(&pinholes()[0], &BROWN, keys)
}

pub fn lens_of(pinhole: &Pinhole, distortion: &[f64], [k, d]: [&str; 2]) -> Matrices {
    vec![(k.into(), 3, pinhole.k().into()), (d.into(), 1, distortion.into())]
}

pub fn pose([r, t]: [&str; 2], from: &Pinhole, to: &Pinhole) -> Matrices {
    let (rotation, translation) = step(from, to);
    vec![(r.into(), 3, by_rows(&rotation).into()), (t.into(), 3, translation.to_array().into())]
}

/// The essential matrix: its columns are those of R, crossed with T.
fn essential(from: &Pinhole, to: &Pinhole) -> (String, usize, Vec<f64>) {
    let (r, t) = step(from, to);
    let e = DMat3::from_cols(t.cross(r.x_axis), t.cross(r.y_axis), t.cross(r.z_axis));
    (String::from("E"), 3, by_rows(&e).into())
}

/// What stereoCalibrate and stereoRectify write besides. Numbers of the rectification do not matter, because nothing may be read
/// from them.
fn derived(from: &Pinhole, to: &Pinhole) -> Matrices {
    let nine = by_rows(&DMat3::IDENTITY).to_vec();
    let of = |key: &str, rows: usize, count: usize| (key.to_owned(), rows, vec![0.5; count]);
    let mut all = vec![of("P1", 3, 12), of("P2", 3, 12), of("Q", 4, 16), essential(from, to), of("F", 3, 9)];
    all.extend(["R1", "R2"].map(|key| (key.to_owned(), 3, nine.clone())));
    all
}

pub fn yaml(matrices: &Matrices) -> String {
    let matrix = |(key, rows, data): &(String, usize, Vec<f64>)| {
        let columns = data.len() / rows;
        let data = list(data.iter().copied());
        format!("{key}: !!opencv-matrix\n   rows: {rows}\n   cols: {columns}\n   dt: d\n   data: [ {data} ]\n")
    };
    format!("%YAML:1.0\n---\n{}", matrices.iter().map(matrix).collect::<String>())
}

pub fn xml(matrices: &Matrices) -> String {
    let matrix = |(key, rows, data): &(String, usize, Vec<f64>)| {
        let columns = data.len() / rows;
        let data = list(data.iter().copied()).replace(',', "");
        format!(
            "<{key} type_id=\"opencv-matrix\">\n  <rows>{rows}</rows>\n  <cols>{columns}</cols>\n  <dt>d</dt>\n  <data>\n    \
             {data}</data></{key}>\n"
        )
    };
    let all: String = matrices.iter().map(matrix).collect();
    format!("<?xml version=\"1.0\"?>\n<opencv_storage>\n{all}</opencv_storage>\n")
}

/// Nested lists, as Python's `tolist` gives.
pub fn nested(matrices: &Matrices) -> String {
    let matrix = |(key, rows, data): &(String, usize, Vec<f64>)| {
        (key.clone(), json!(data.chunks(data.len() / rows).collect::<Vec<_>>()))
    };
    Value::Object(matrices.iter().map(matrix).collect()).to_string()
}

fn pictures(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| format!("images/{name}.png")).collect()
}

/// The imported cameras see points where OpenCV's formula has them. The world is that of the first of `cameras`.
#[track_caller]
fn assert_is_seen(scene: &Value, cameras: &[&Pinhole]) {
    assert_eq!(scene["cameras"].as_array().unwrap().len(), cameras.len());
    for (i, pose) in cameras.iter().enumerate() {
        for point in points(pose) {
            let (pixel, _) = camera(scene, i).project(cameras[0].r * point + cameras[0].t).unwrap();
            let off = (pixel - opencv(pose, point, |p| brown(p, BROWN))).length();
            assert!(off < 1e-6, "camera {i} is {off} px off");
        }
    }
}

#[test]
fn the_second_camera_of_a_pair_is_r_and_t_from_the_first() {
    let [first, second, ..] = &pinholes()[..] else { panic!("four poses") };
    for ([k1, d1], [k2, d2], pose_keys, names) in [
        (["M1", "D1"], ["M2", "D2"], ["R", "T"], ["left", "right"]),
        (["K1", "d1"], ["K2", "d2"], ["R", "t"], ["cam1", "cam2"]),
        (["K0", "D0"], ["K1", "D1"], ["R", "T"], ["cam0", "cam1"]),
        (["CM1", "dist1"], ["CM2", "dist2"], ["R", "T"], ["1", "2"]),
        (["cameraMatrix1", "distCoeffs1"], ["cameraMatrix2", "distCoeffs2"], ["R", "T"], ["cam00", "cam01"]),
        (
            ["left_camera_matrix", "left_distortion"],
            ["right_camera_matrix", "right_distortion"],
            ["R", "T"],
            ["left", "right"],
        ),
        (["mtxL", "distL"], ["mtxR", "distR"], ["Rotation_Matrix", "Translation_Vector"], ["Left", "Right"]),
        (
            ["camera_matrix_1", "distortion_coefficients_1"],
            ["camera_matrix_2", "distortion_coefficients_2"],
            ["R", "T"],
            ["camera_01", "camera_02"],
        ),
    ] {
        // The second lens first: names decide, not the order.
        let all = [lens([k2, d2]), lens([k1, d1]), pose(pose_keys, first, second), derived(first, second)].concat();
        for (file, text) in [("stereo.yml", yaml(&all)), ("stereo.xml", xml(&all)), ("stereo.json", nested(&all))] {
            let capture = folder(&pictures(&names), &[(file, &text)]);
            for path in [capture.path(), &capture.path().join(file)] {
                let (scene, notes) = import_with_notes("opencv", path);
                assert_is_seen(&scene, &[first, second]);
                assert_eq!(import("auto", path), scene, "{file}");
                assert_eq!([&scene["cameras"][0]["name"], &scene["cameras"][1]["name"]], names);
                for expected in [
                    format!("the world is that of its first camera, `{}`", names[0]),
                    String::from("it follows from the lenses, R and T: "),
                    String::from("two cameras are too few for a mesh"),
                ] {
                    assert!(notes.contains(&expected), "{notes}");
                }
            }
        }
    }
}

#[test]
fn a_pair_may_be_in_two_or_three_files_or_in_maps() {
    let [first, second, ..] = &pinholes()[..] else { panic!("four poses") };
    let pose = pose(["R", "T"], first, second);
    let extrinsics = yaml(&[pose.clone(), derived(first, second)].concat());
    let both = yaml(&[lens(["M1", "D1"]), lens(["M2", "D2"])].concat());
    let [one, other] = [["M1", "D1"], ["M2", "D2"]].map(|keys| yaml(&lens(keys)));
    let alone = yaml(&lens(["camera_matrix", "distortion_coefficients"]));
    let map = |name: &str| json!({ "K": first.k(), "dist_coeffs": BROWN, "image_size": [WIDTH, HEIGHT], "name": name });
    let [(_, _, r), (_, _, t)] = &pose[..] else { panic!("R and T") };
    let maps = json!({ "right": map("b"), "left": map("a"), "R": r, "T": t }).to_string();
    let cases: [&[(&str, &str)]; 4] = [
        &[("intrinsics.yml", &both), ("extrinsics.yml", &extrinsics)],
        &[("m1.yml", &one), ("m2.yml", &other), ("pose.yml", &extrinsics)],
        &[("left.yml", &alone), ("right.yml", &alone), ("stereo.yml", &extrinsics)],
        &[("maps.json", &maps)],
    ];
    for texts in cases {
        let names = if texts.len() == 1 { ["a", "b"] } else { ["left", "right"] };
        let capture = folder(&pictures(&names), texts);
        let scene = import("opencv", capture.path());
        assert_is_seen(&scene, &[first, second]);
        assert_eq!(import("auto", capture.path()), scene);
        // Any of the files leads to the others, if there is one more.
        if texts.len() < 3 {
            for (file, _) in texts {
                assert_eq!(import("opencv", &capture.path().join(file)), scene, "{file}");
            }
        }
    }
}

/// Pairs of neighbours of four cameras.
fn chain(name: impl Fn(usize, usize) -> String) -> Vec<(String, String)> {
    let all = pinholes();
    let pair = |[from, to]: [usize; 2]| {
        let matrices = [
            lens(["M1", "D1"]),
            lens(["M2", "D2"]),
            pose(["R", "T"], &all[from], &all[to]),
            derived(&all[from], &all[to]),
        ]
        .concat();
        (name(from + 1, to + 1), yaml(&matrices))
    };
    // One leads backwards.
    [[0, 1], [2, 1], [2, 3]].map(pair).into()
}

fn chain_folder(texts: &[(String, String)]) -> TempDir {
    let texts: Vec<(&str, &str)> = texts.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
    folder(&pictures(&["cam1", "cam2", "cam3", "cam4"]), &texts)
}

#[test]
fn pairs_make_a_chain_if_their_names_say_so() {
    let all = pinholes();
    let files = chain(|a, b| format!("stereo_{a}_{b}.yml"));
    let (scene, notes) = import_with_notes("opencv", chain_folder(&files).path());
    assert_is_seen(&scene, &all.iter().collect::<Vec<_>>());
    assert!(notes.contains("3 stereo pairs that make a chain: the world is that of camera `cam1`"), "{notes}");
    let fails = |files: &[(String, String)], problem: &str| {
        let message = refused("opencv", chain_folder(files).path());
        assert!(message.contains(problem), "{message}");
    };
    fails(&chain(|a, b| format!("stereo{a}{b}.yml")), "its name does not tell which cameras it has");
    fails(&[&files[..1], &files[2..]].concat(), "no pair leads from camera 1 to camera 3");
    let again = (String::from("2-1.yml"), files[0].1.clone());
    fails(&[&files[..], &[again]].concat(), "lead to the same camera in two ways");
    let other = files[1].1.replacen("61.0", "62.0", 1);
    fails(&[files[0].clone(), (files[1].0.clone(), other), files[2].clone()], "camera 3 has another lens");
}

#[test]
fn a_pair_that_is_not_certain_is_refused_with_the_remedy() {
    let [first, second, ..] = &pinholes()[..] else { panic!("four poses") };
    let [pose, backwards] = [[first, second], [second, first]].map(|[from, to]| pose(["R", "T"], from, to));
    let lenses = [lens(["M1", "D1"]), lens(["M2", "D2"])].concat();
    let whole = [lenses.clone(), pose.clone()].concat();
    let sides = pictures(&["left", "right"]);
    let fails = |pictures: &[String], texts: &[(&str, String)], problem: &str| {
        let texts: Vec<(&str, &str)> = texts.iter().map(|(name, text)| (*name, text.as_str())).collect();
        let capture = folder(pictures, &texts);
        let message = refused("opencv", capture.path());
        assert!(message.contains(problem) && message.contains(".yml: "), "{message}");
    };
    let more = |matrices: Matrices| yaml(&[whole.clone(), matrices].concat());
    fails(&sides, &[("a.yml", yaml(&lenses))], "its R and T are missing");
    fails(&sides, &[("a.yml", more(lens(["M3", "D3"])))], "not those of its first and its second camera");
    fails(
        &sides,
        &[("a.yml", more(vec![("KK".into(), 3, first.k().into())]))],
        "`KK` is a matrix that is not understood",
    );
    fails(
        &sides,
        &[("a.yml", more(vec![("T1".into(), 3, vec![0.0; 3])]))],
        "`T1` looks like the pose of a single camera",
    );
    fails(&sides, &[("a.yml", more(vec![("focal".into(), 1, vec![3.0])]))], "`focal` looks like calibration");
    let with_essential = |e: Matrices| [("a.yml", more(e))];
    let of_other_way = with_essential(vec![essential(second, first)]);
    fails(&sides, &of_other_way, "R and T lead from the second camera to the first");
    let of_other = with_essential(vec![essential(first, &pinholes()[2])]);
    fails(&sides, &of_other, "the essential matrix does not follow from R and T");
    fails(&[], &[("a.yml", yaml(&whole))], "the pictures of its cameras are missing");
    let ambiguous = pictures(&["left", "right", "cam1", "cam2"]);
    fails(&ambiguous, &[("a.yml", yaml(&whole))], "may all be the pictures of its cameras");
    let extrinsics = yaml(&pose);
    let twice = [("a.yml", yaml(&lenses)), ("b.yml", extrinsics), ("c.yml", yaml(&backwards))];
    fails(&sides, &twice, "R and T of a stereo pair, and so has");
    let alone = [("a.yml", yaml(&whole)), ("b.yml", yaml(&[lens(["K", "D"]), pose.clone()].concat()))];
    fails(&sides, &alone, "has a camera with a pose of its own");
}
