//! `pcmvs reconstruct` from files to files.

use crate::common::{Capture, HEIGHT, WIDTH, names, pcmvs, stderr};
use glam::DVec3;
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::fs;

fn json(capture: &Capture, name: &str) -> Value {
    serde_json::from_slice(&fs::read(capture.path("out").join(name)).unwrap()).unwrap()
}

#[track_caller]
fn assert_runs(capture: &Capture, arguments: &[&str]) -> String {
    let output = capture.run(arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    stderr(&output)
}

fn indices(list: &Value) -> Vec<u64> {
    list.as_array().unwrap().iter().map(|frame| frame["index"].as_u64().unwrap()).collect()
}

#[test]
fn manifest_and_report_describe_the_files() {
    let mut capture = Capture::new(6, 2);
    capture.scene["fps"] = 25.into();
    assert_runs(&capture, &[]);
    assert_eq!(capture.results(), ["frame_0000.glb", "frame_0001.glb", "report.json", "sequence.json"]);
    let (manifest, report) = (json(&capture, "sequence.json"), json(&capture, "report.json"));
    assert_eq!((&manifest["frame_count"], &manifest["fps"]), (&2.into(), &25.0.into()));
    assert_eq!(manifest["frames"][1]["time"], 0.04);
    assert_eq!(manifest["up"], serde_json::json!([0.0, 0.0, 1.0]));
    for i in 0..2 {
        let (listed, made) = (&manifest["frames"][i], &report["frames"][i]);
        let bytes = fs::read(capture.path("out").join(listed["url"].as_str().unwrap())).unwrap();
        let hash: String = Sha256::digest(&bytes).iter().map(|b| format!("{b:02x}")).collect();
        assert_eq!((listed["bytes"].as_u64(), listed["sha256"].as_str()), (Some(bytes.len() as u64), Some(&*hash)));
        let gltf = gltf::Gltf::from_slice(&bytes).unwrap();
        let primitive = gltf.meshes().next().unwrap().primitives().next().unwrap();
        let vertices = primitive.get(&gltf::Semantic::Positions).unwrap().count();
        assert_eq!(made["counts"]["vertices"], vertices);
        assert_eq!(made["counts"]["faces"], primitive.indices().unwrap().count() / 3);
        // The ball's radius in the pictures is 14 pixels of 60 at 4.3 from its centre: about one.
        let box_ = primitive.bounding_box();
        for axis in 0..3 {
            assert!((-1.6..-0.8).contains(&box_.min[axis]) && (0.8..1.6).contains(&box_.max[axis]), "{box_:?}");
            let bound = |end: usize| manifest["bounds"][end][axis].as_f64().unwrap() as f32;
            assert!(bound(0) <= box_.min[axis] && bound(1) >= box_.max[axis]);
        }
        for stage in ["views", "hull", "colour", "write"] {
            assert!(made["seconds"][stage].as_f64().is_some_and(|s| s >= 0.0), "{stage}: {made}");
        }
        assert!(made["hashes"]["colour"].as_str().is_some_and(|h| h.len() == 16));
    }
    assert_eq!(report["params"]["method"], "Hull");
    if cfg!(target_os = "linux") {
        assert!(report["peak_memory"].as_u64().unwrap() > 1 << 20);
    }
}

/// The meshes of two frames of a new capture.
fn meshes(change: impl Fn(&mut Capture), arguments: &[&str]) -> [Vec<u8>; 2] {
    let mut capture = Capture::enlarged(14, 2, 3);
    change(&mut capture);
    assert_runs(&capture, &[&["--preset", "default"], arguments].concat());
    [0, 1].map(|i| fs::read(capture.path(&format!("out/frame_000{i}.glb"))).unwrap())
}

/// The positions of a GLB's vertices in the scene's frame.
fn vertices(glb: &[u8]) -> Vec<DVec3> {
    let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(glb).unwrap();
    let (translation, ..) = document.nodes().next().unwrap().transform().decomposed();
    let primitive = document.meshes().next().unwrap().primitives().next().unwrap();
    let positions = primitive.reader(|_| blob.as_deref()).read_positions().unwrap();
    let exact = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
    positions.map(|position| exact(translation) + exact(position)).collect()
}

/// Surveyors' coordinates move a mesh, and change nothing else.
#[test]
fn a_scene_far_from_the_origin_gives_the_same_mesh_there() {
    let offset = DVec3::new(448_291.537, 5_411_932.18, 113.06);
    let moved = |capture: &mut Capture| {
        for camera in capture.scene["cameras"].as_array_mut().unwrap() {
            let number = |value: &Value| value.as_f64().unwrap();
            let along = |row: usize| (0..3).map(|i| number(&camera["R"][row][i]) * offset[i]).sum::<f64>();
            let t: Vec<f64> = (0..3).map(|row| number(&camera["t"][row]) - along(row)).collect();
            camera["t"] = t.into();
        }
    };
    let mesh = |change: &dyn Fn(&mut Capture)| {
        let mut capture = Capture::enlarged(8, 1, 3);
        change(&mut capture);
        assert_runs(&capture, &["--preset", "hull"]);
        vertices(&fs::read(capture.path("out/frame_0000.glb")).unwrap())
    };
    let (near, far) = (mesh(&|_| ()), mesh(&moved));
    // Rounding differs in the last bits, so that a few vertices do.
    let is_there = |a: &&DVec3| far.iter().any(|b| (**a + offset - *b).length() < 1e-4);
    let there = near.iter().step_by(10).filter(is_there).count();
    assert!(there > near.len() / 10 * 99 / 100, "{there} of {}", near.len() / 10);
    let extent =
        |vertices: &[DVec3]| vertices.iter().fold([DVec3::MAX, DVec3::MIN], |[a, b], p| [a.min(*p), b.max(*p)]);
    let (near, far) = (extent(&near), extent(&far));
    for end in 0..2 {
        assert!((near[end] + offset - far[end]).length() < 1e-4, "{near:?} {far:?}");
    }
}

#[test]
fn threads_frame_order_and_stages_do_not_change_a_byte() {
    let expected = meshes(|_| (), &["--threads", "1"]);
    assert!(expected[0] != expected[1], "the frames are equal, so the test cannot detect their order");
    assert!(meshes(|_| (), &["--threads", "3"]) == expected, "threads");
    assert!(meshes(|_| (), &["--frames", "1,0", "--stages"]) == expected, "frames that are listed backwards, stages");
    let backwards = |capture: &mut Capture| capture.scene["frames"].as_array_mut().unwrap().reverse();
    assert!(meshes(backwards, &["--threads", "1"]) == expected, "frames that come backwards in scene.json");
}

#[test]
fn a_second_run_makes_only_what_is_missing_or_has_changed() {
    let capture = Capture::new(5, 3);
    let kept = |message: &str| message.matches("has not changed: its mesh is kept").count();
    assert_eq!(kept(&assert_runs(&capture, &["--frames", "0,1"])), 0);
    let first = fs::read(capture.path("out/frame_0000.glb")).unwrap();
    assert_eq!(kept(&assert_runs(&capture, &[])), 2);
    assert_eq!(indices(&json(&capture, "sequence.json")["frames"]), [0, 1, 2]);

    // Removed, damaged, or made from another picture.
    fs::remove_file(capture.path("out/frame_0000.glb")).unwrap();
    fs::write(capture.path("out/frame_0001.glb"), b"glTF").unwrap();
    capture.mask("masks/cam00_2.png", 31.5, 12.0);
    assert_eq!(kept(&assert_runs(&capture, &[])), 0);
    assert_eq!(fs::read(capture.path("out/frame_0000.glb")).unwrap(), first);
    assert_eq!(kept(&assert_runs(&capture, &[])), 3);

    // Other cameras give another clip, which does not contain the old frames.
    assert_eq!(kept(&assert_runs(&capture, &["--cameras", "0..3", "--frames", "1"])), 0);
    assert_eq!(indices(&json(&capture, "sequence.json")["frames"]), [1]);
}

#[test]
fn a_frame_that_fails_does_not_stop_the_others() {
    let capture = Capture::new(5, 3);
    fs::write(capture.path("images/cam03_1.png"), b"this is text").unwrap();
    let output = capture.run(&[]);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("frame 1: camera `cam03`") && message.contains("1 of 3 frames failed"), "{message}");
    assert_eq!(capture.results(), ["frame_0000.glb", "frame_0002.glb", "report.json", "sequence.json"]);
    assert_eq!(indices(&json(&capture, "sequence.json")["frames"]), [0, 2]);
    assert_eq!(indices(&json(&capture, "report.json")["failures"]), [1]);
}

#[test]
fn stages_and_ply() {
    let capture = Capture::new(5, 1);
    assert_runs(&capture, &["--stages", "--format", "ply"]);
    assert_eq!(capture.results(), ["frame_0000.ply", "report.json", "sequence.json", "stages"]);
    let stages = names(&capture.path("out/stages/frame_0000"));
    for name in ["hull.ply", "frontier.ply", "implicit.ply", "merge.ply", "mesh.ply", "colour.ply"] {
        assert!(stages.contains(&name.to_owned()), "{stages:?}");
        let bytes = fs::read(capture.path("out/stages/frame_0000").join(name)).unwrap();
        assert!(bytes.starts_with(b"ply\nformat binary_little_endian 1.0\n"));
    }
    let colour = fs::read(capture.path("out/stages/frame_0000/colour.ply")).unwrap();
    assert_eq!(colour, fs::read(capture.path("out/frame_0000.ply")).unwrap());
}

#[test]
fn silhouettes_from_the_backdrop() {
    let mut capture = Capture::new(6, 1);
    let refused = capture.run(&["--masks", "chroma"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("chroma_rgb"), "{}", stderr(&refused));

    capture.scene["background"] = serde_json::json!({ "chroma_rgb": [40, 165, 75] });
    capture.scene["frames"][0]["masks"] = Value::Null;
    for i in 0..6 {
        let path = capture.path(&format!("images/cam{i:02}_0.png"));
        let picture = image::RgbImage::from_fn(WIDTH, HEIGHT, |x, y| {
            let inside = (x as f32 - 31.5).hypot(y as f32 - 23.5) < 14.0;
            image::Rgb(if inside { [180, 90, 60] } else { [40, 165, 75] })
        });
        picture.save(path).unwrap();
    }
    assert_runs(&capture, &["--masks", "chroma"]);
    let bounds = &json(&capture, "sequence.json")["bounds"];
    for axis in 0..3 {
        assert!(bounds[0][axis].as_f64().unwrap() < -0.8 && bounds[1][axis].as_f64().unwrap() > 0.8, "{bounds}");
    }
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_ends_with_3_and_can_be_continued() {
    use std::{
        io::{BufRead, BufReader, Read},
        process::{Command, Stdio},
    };
    let capture = Capture::new(5, 40);
    fs::write(capture.path("scene.json"), capture.scene.to_string()).unwrap();
    let (scene, out) = (capture.path(""), capture.path("out"));
    let mut command = pcmvs();
    command.arg("reconstruct").arg(scene).arg("-o").arg(out).args(["--preset", "hull", "--threads", "1"]);
    let mut child = command.stderr(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    // A frame is written when the one after it has been made.
    while !line.contains("frame 2 ") {
        line.clear();
        assert!(lines.read_line(&mut line).unwrap() > 0, "it ended before its third frame");
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    lines.read_to_string(&mut line).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(3), "{line}");
    let results = capture.results();
    assert!(results.contains(&"frame_0000.glb".to_owned()) && !results.contains(&"frame_0039.glb".to_owned()));
    assert!(!results.iter().any(|name| name.ends_with(".tmp")), "{results:?}");
    assert!(assert_runs(&capture, &[]).contains("frame 0 has not changed: its mesh is kept"));
    assert_eq!(json(&capture, "sequence.json")["frame_count"], 40);
}
