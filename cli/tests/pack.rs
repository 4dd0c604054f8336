//! `pcmvs pack`: the frames of a clip in one GLB file.

use crate::common::{Capture, names, parts, pcmvs, stderr, view};
use gltf::animation::{Interpolation, util::ReadOutputs};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::{collections::BTreeMap, fs, process::Output, sync::atomic::AtomicBool};

/// Arguments of `pcmvs reconstruct` for each kind of file.
const FORMS: [&[&str]; 4] = [
    &[],
    &["--compress"],
    &["--texture=128", "--faces=500"],
    &["--texture=128", "--faces=500", "--compress", "--upright"],
];

/// A capture whose frames are finished.
fn finished(frames: u32, arguments: &[&str]) -> Capture {
    let mut capture = Capture::new(8, frames);
    // Beside the scene's origin, at which no frame may appear.
    for camera in capture.scene["cameras"].as_array_mut().unwrap() {
        let number = |v: &Value| v.as_f64().unwrap();
        let moved = |i: usize| number(&camera["t"][i]) - 30.0 * number(&camera["R"][i][0]);
        camera["t"] = json!([moved(0), moved(1), moved(2)]);
    }
    capture.scene["fps"] = json!(12);
    let output = capture.run(arguments);
    assert!(output.status.success(), "{}", stderr(&output));
    capture
}

fn pack(capture: &Capture, arguments: &[&str]) -> Output {
    let mut command = pcmvs();
    command.arg("pack").arg(capture.path("out")).arg("-o").arg(capture.path("clip.glb")).args(arguments);
    command.output().unwrap()
}

fn packed(capture: &Capture, arguments: &[&str]) -> Vec<u8> {
    let output = pack(capture, arguments);
    assert!(output.status.success(), "{}", stderr(&output));
    fs::read(capture.path("clip.glb")).unwrap()
}

/// Changes sequence.json.
fn with_manifest(capture: &Capture, change: impl FnOnce(&mut Value)) {
    let path = capture.path("out/sequence.json");
    let mut manifest = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    change(&mut manifest);
    fs::write(path, manifest.to_string()).unwrap();
}

/// Puts another file in the place of a frame's, and lists it in the manifest.
fn replace(capture: &Capture, frame: usize, bytes: &[u8]) {
    fs::write(capture.path(&format!("out/frame_{frame:04}.glb")), bytes).unwrap();
    let sha256: String = Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    with_manifest(capture, |manifest| {
        manifest["frames"][frame]["sha256"] = json!(sha256);
        manifest["frames"][frame]["bytes"] = json!(bytes.len());
    });
}

/// Everything that a file says about the mesh of a node: how it is placed, its accessors with their bytes, and its material with
/// the picture.
fn content(json: &Value, binary: &[u8], node: &Value) -> BTreeMap<String, Value> {
    let at = |kind: &str, index: &Value| json[kind][index.as_u64().unwrap() as usize].clone();
    let bytes = |index: &Value| json!(view(json, binary, index));
    let [primitive] = at("meshes", &node["mesh"])["primitives"].as_array().unwrap().clone().try_into().unwrap();
    let mut found: BTreeMap<String, Value> =
        ["translation", "rotation", "scale"].map(|key| (key.to_owned(), node[key].clone())).into();
    let attributes = primitive["attributes"].as_object().unwrap();
    for (name, index) in attributes.iter().chain([(&"indices".to_owned(), &primitive["indices"])]) {
        let mut accessor = at("accessors", index);
        accessor["bufferView"] = bytes(&accessor["bufferView"]);
        found.insert(name.clone(), accessor);
    }
    let mut material = at("materials", &primitive["material"]);
    let texture = &mut material["pbrMetallicRoughness"]["baseColorTexture"]["index"];
    if !texture.is_null() {
        let mut parts = at("textures", texture);
        let mut image = at("images", &parts["source"]);
        image["bufferView"] = bytes(&image["bufferView"]);
        parts["sampler"] = at("samplers", &parts["sampler"]);
        parts["source"] = image;
        *texture = parts;
    }
    found.insert("material".to_owned(), material);
    found
}

#[test]
fn each_frame_of_a_clip_is_that_of_its_file() {
    for form in FORMS {
        let capture = finished(3, form);
        let clip = packed(&capture, &[]);
        assert_eq!(clip, packed(&capture, &[]), "the same frames give the same bytes");
        let (json, binary) = parts(&clip);
        let node = |index: &Value| &json["nodes"][index.as_u64().unwrap() as usize];
        let root = node(&json["scenes"][0]["nodes"][0]);
        assert_eq!((&root["name"], root["children"].as_array().unwrap().len()), (&json!("clip"), 3));
        for (i, frame) in root["children"].as_array().unwrap().iter().enumerate() {
            let name = format!("frame_{i:04}");
            let (frame, bytes) = (node(frame), fs::read(capture.path(&format!("out/{name}.glb"))).unwrap());
            let (own_json, own_binary) = parts(&bytes);
            for key in ["asset", "extensionsUsed", "extensionsRequired"] {
                assert_eq!(json[key], own_json[key]);
            }
            assert_eq!(json["scenes"][0]["extras"], own_json["scenes"][0]["extras"]);
            assert_eq!(frame["name"], name);
            // The first frame is shown without the animation, too.
            assert_eq!(frame["scale"], if i == 0 { Value::Null } else { json!([0, 0, 0]) });
            let below = node(&frame["children"][0]);
            let sum = |axis: usize| {
                frame["translation"][axis].as_f64().unwrap() + below["translation"][axis].as_f64().unwrap()
            };
            assert_eq!([sum(0), sum(1), sum(2)], [0.0; 3]);
            let expected = content(&own_json, own_binary, &own_json["nodes"][0]);
            assert!(expected == content(&json, binary, node(&below["children"][0])), "{form:?} {name}");
        }
    }
}

#[test]
fn hidden_frames_shrink_to_a_point_inside_their_box() {
    for upright in [false, true] {
        let capture = finished(2, if upright { &["--upright"] } else { &[] });
        let manifest: Value = serde_json::from_slice(&fs::read(capture.path("out/sequence.json")).unwrap()).unwrap();
        let bounds: [[f64; 3]; 2] = serde_json::from_value(manifest["bounds"].clone()).unwrap();
        let (json, _) = parts(&packed(&capture, &[]));
        for frame in [0, 3] {
            let middle: [f64; 3] = serde_json::from_value(json["nodes"][frame]["translation"].clone()).unwrap();
            for axis in 0..3 {
                let near = (bounds[0][axis] + bounds[1][axis]) / 2.0 - middle[axis];
                assert!(near.abs() < 0.05, "{middle:?} in {bounds:?}");
            }
        }
    }
}

/// The steps of each frame's scale: times, and whether it is shown from then on.
fn steps(clip: &[u8]) -> Vec<Vec<(f32, bool)>> {
    let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(clip).unwrap();
    let [animation] = document.animations().collect::<Vec<_>>().try_into().unwrap();
    let root = document.default_scene().unwrap().nodes().next().unwrap();
    let of = |node: gltf::Node| {
        let channel = animation.channels().find(|channel| channel.target().node().index() == node.index()).unwrap();
        assert_eq!(channel.sampler().interpolation(), Interpolation::Step);
        let reader = channel.reader(|_| blob.as_deref());
        let Some(ReadOutputs::Scales(scales)) = reader.read_outputs() else { panic!("it is a scale") };
        let shown = scales.map(|scale| {
            assert!(scale == [0.0; 3] || scale == [1.0; 3]);
            scale == [1.0; 3]
        });
        reader.read_inputs().unwrap().zip(shown).collect()
    };
    root.children().map(of).collect()
}

#[test]
fn at_any_time_exactly_the_frame_of_that_time_is_shown() {
    let capture = finished(5, &[]);
    for (arguments, fps, frames) in [
        (&[][..], 12.0, 5),
        (&["--fps", "29.97"], 29.97, 5),
        (&["--frames", "2,4"], 12.0, 2),
        (&["--frames", "3", "--fps=0.5"], 0.5, 1),
    ] {
        let steps = steps(&packed(&capture, arguments));
        let shown = |steps: &[(f32, bool)], time: f32| {
            let last = steps.iter().rev().find(|(start, _)| *start <= time);
            last.unwrap_or(&steps[0]).1
        };
        let end = steps.iter().map(|steps| steps.last().unwrap().0).fold(0.0, f32::max);
        assert_eq!(end, (f64::from(frames) / fps) as f32);
        for i in 0..100 * frames {
            let time = ((f64::from(i) + 0.5) / (100.0 * fps)) as f32;
            let seen: Vec<i32> = (0..frames).filter(|&frame| shown(&steps[frame as usize], time)).collect();
            assert_eq!(seen, [i / 100], "{time} s, {arguments:?}");
        }
        assert!(shown(steps.last().unwrap(), end), "a clip that does not loop stops with its last frame");
    }
}

#[test]
fn what_frames_have_in_common_is_stored_once() {
    let capture = finished(2, &["--texture=128"]);
    let different = packed(&capture, &[]);
    let (json, _) = parts(&different);
    let count = |json: &Value, kind: &str| json[kind].as_array().unwrap().len();
    let counts = |json: &Value| ["meshes", "images", "textures", "materials", "samplers"].map(|kind| count(json, kind));
    assert_eq!(counts(&json), [2, 2, 2, 2, 1]);
    let first = fs::read(capture.path("out/frame_0000.glb")).unwrap();
    replace(&capture, 1, &first);
    let same = packed(&capture, &[]);
    assert_eq!(counts(&parts(&same).0), [1; 5]);
    assert!(same.len() < first.len() + 4000 && different.len() > 2 * first.len() - 40_000);
}

#[test]
fn visibility_is_animated_besides_if_asked_for() {
    let capture = finished(3, &[]);
    let clip = packed(&capture, &["--visibility"]);
    let (json, binary) = parts(&clip);
    let used = json["extensionsUsed"].as_array().unwrap();
    assert_eq!(used[used.len() - 2..], ["KHR_node_visibility", "KHR_animation_pointer"]);
    assert!(json["extensionsRequired"].is_null());
    let channels = json["animations"][0]["channels"].as_array().unwrap();
    assert_eq!(channels.len(), 6);
    for (i, pair) in channels.chunks(2).enumerate() {
        // That of the mesh, two below the node that is scaled.
        let node = pair[0]["target"]["node"].as_u64().unwrap() + 2;
        assert!(json["nodes"][node as usize]["mesh"].is_u64());
        let visible = &json["nodes"][node as usize]["extensions"]["KHR_node_visibility"]["visible"];
        assert_eq!(visible, &json!(i == 0));
        let pointer = &pair[1]["target"]["extensions"]["KHR_animation_pointer"]["pointer"];
        assert_eq!(pointer, &json!(format!("/nodes/{node}/extensions/KHR_node_visibility/visible")));
        // The flags are those of the scale, at the same times.
        let sampler =
            |channel: &Value| &json["animations"][0]["samplers"][channel["sampler"].as_u64().unwrap() as usize];
        let (scale, flag) = (sampler(&pair[0]), sampler(&pair[1]));
        assert_eq!((&scale["input"], &flag["interpolation"]), (&flag["input"], &json!("STEP")));
        let values = |index: &Value, size: usize| -> Vec<u8> {
            let accessor = &json["accessors"][index.as_u64().unwrap() as usize];
            let offset = accessor["byteOffset"].as_u64().unwrap_or(0) as usize;
            let bytes = &view(&json, binary, &accessor["bufferView"])[offset..];
            bytes
                .chunks(size)
                .take(accessor["count"].as_u64().unwrap() as usize)
                .map(|v| v[v.len() - 1].min(1))
                .collect()
        };
        assert_eq!(values(&scale["output"], 12), values(&flag["output"], 1));
    }
}

/// Packing fails with this status and words, and leaves no file.
fn fails(capture: &Capture, arguments: &[&str], words: &[&str]) {
    let output = pack(capture, arguments);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    let message = stderr(&output);
    assert!(words.iter().all(|word| message.contains(word)), "{message}");
    assert_eq!(names(&capture.path("")).iter().filter(|name| name.contains("clip.glb")).count(), 0);
}

#[test]
fn frames_that_are_missing_or_changed_are_named() {
    let capture = finished(4, &[]);
    fails(&capture, &["--frames", "1,4,7"], &["sequence.json", "no frames 4,7", "--frames"]);
    let path = capture.path("out/frame_0002.glb");
    let bytes = fs::read(&path).unwrap();
    fs::remove_file(&path).unwrap();
    fails(&capture, &[], &["frame_0002.glb", "frame 2 cannot be read", "run `pcmvs reconstruct` again"]);
    let mut changed = bytes.clone();
    *changed.last_mut().unwrap() ^= 1;
    fs::write(&path, &changed).unwrap();
    fails(&capture, &[], &["frame_0002.glb", "not the file that sequence.json lists"]);
    fs::write(&path, &bytes).unwrap();
    with_manifest(&capture, |manifest| drop(manifest["frames"].as_array_mut().unwrap().remove(2)));
    fails(&capture, &[], &["frames 2 are missing", "--frames"]);
    packed(&capture, &["--frames", "0,1,3"]);
}

#[test]
fn frames_of_other_forms_versions_or_programs_are_refused() {
    let capture = finished(2, &[]);
    let other = fs::read(finished(2, &["--compress"]).path("out/frame_0001.glb")).unwrap();
    let own = fs::read(capture.path("out/frame_0001.glb")).unwrap();
    replace(&capture, 1, &other);
    fails(&capture, &[], &["frame_0001.glb", "another version or form", "frame_0000.glb", "KHR_mesh_quantization"]);
    // As long as before, so that the chunks stay as they are.
    let edited = |from: &str, to: &str| {
        assert_eq!(from.len(), to.len());
        let at = own.windows(from.len()).position(|window| window == from.as_bytes()).unwrap();
        [&own[..at], to.as_bytes(), &own[at + from.len()..]].concat()
    };
    let version = concat!("pcmvs ", env!("CARGO_PKG_VERSION"));
    replace(&capture, 1, &edited(version, &version.replace("pcmvs", "other")));
    fails(&capture, &[], &["another version or form", "other "]);
    replace(&capture, 1, &edited(r#""indices""#, r#""targets""#));
    fails(&capture, &[], &["frame_0001.glb", "unknown field `targets`"]);
    replace(&capture, 1, &own[..own.len() - 4]);
    fails(&capture, &[], &["frame_0001.glb", "chunks"]);
    replace(&capture, 1, &own);
    packed(&capture, &[]);
}

#[test]
fn only_glb_clips_of_this_version_are_packed() {
    let capture = finished(1, &["--format", "ply"]);
    fails(&capture, &[], &["sequence.json", "frame 0 is frame_0000.ply"]);
    with_manifest(&capture, |manifest| manifest["version"] = json!(99));
    fails(&capture, &[], &["sequence.json", "version 99"]);
    fs::remove_file(capture.path("out/sequence.json")).unwrap();
    fails(&capture, &[], &["sequence.json", "cannot be read"]);
    for fps in ["0", "-1", "nan", "inf", "1e12", "x"] {
        fails(&capture, &[&format!("--fps={fps}")], &["frames per second"]);
    }
}

#[test]
fn nothing_but_an_earlier_clip_is_replaced() {
    let capture = finished(1, &[]);
    let to = |name: &str| {
        let mut command = pcmvs();
        command.arg("pack").arg(capture.path("out")).arg("-o").arg(capture.path(name));
        command.output().unwrap()
    };
    fs::write(capture.path("notes.glb"), "my notes").unwrap();
    let frame = fs::read(capture.path("out/frame_0000.glb")).unwrap();
    for (name, words) in [
        ("notes.glb", "no GLB file"),
        ("out", "is a folder"),
        ("clip.gltf", "let it end with .glb"),
        ("out/frame_0000.glb", "is a frame of the clip"),
    ] {
        let output = to(name);
        assert_eq!(output.status.code(), Some(2), "{name}");
        assert!(stderr(&output).contains(words), "{}", stderr(&output));
    }
    assert_eq!(fs::read(capture.path("notes.glb")).unwrap(), b"my notes");
    assert_eq!(fs::read(capture.path("out/frame_0000.glb")).unwrap(), frame);
    for _ in 0..2 {
        assert!(to("new/clip.GLB").status.success());
        assert_eq!(names(&capture.path("new")), ["clip.GLB"]);
    }
    // A folder with the name of the temporary file makes writing fail.
    fs::create_dir(capture.path("new/.other.glb.tmp")).unwrap();
    assert_eq!(to("new/other.glb").status.code(), Some(1));
    assert_eq!(names(&capture.path("new")), [".other.glb.tmp", "clip.GLB"]);
}

#[test]
fn a_cancelled_run_leaves_no_file() {
    let capture = finished(2, &[]);
    let arguments =
        ["pcmvs".into(), "pack".into(), capture.path("out").into(), "-o".into(), capture.path("clip.glb").into()];
    assert_eq!(pcmvs_cli::run(arguments, &AtomicBool::new(true)), 3);
    assert!(!names(&capture.path("")).iter().any(|name| name.contains("clip.glb")));
}
