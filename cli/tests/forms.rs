//! The forms of a mesh that the command writes: textured, compressed, upright.

use crate::common::{Capture, parts, stderr, view};
use glam::{DQuat, DVec3, Vec3};
use serde_json::Value;
use std::{collections::BTreeMap, fs};

fn made(capture: &Capture, arguments: &[&str]) -> Vec<u8> {
    let output = capture.run(arguments);
    assert!(output.status.success(), "{}", stderr(&output));
    fs::read(capture.path("out/frame_0000.glb")).unwrap()
}

fn shorts(bytes: &[u8], stride: usize) -> Vec<Vec<u16>> {
    bytes.chunks(stride).map(|v| v.chunks(2).map(|s| u16::from_le_bytes([s[0], s[1]])).collect()).collect()
}

/// A number of the filter EXPONENTIAL: 24 bits times two to the power of the highest 8.
fn exponential(bytes: &[u8]) -> f32 {
    let number = i32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
    ((number << 8) >> 8) as f32 * ((number >> 24) as f32).exp2()
}

/// Positions and sRGB colours of the triangles' corners in a plain file.
fn plain_corners(bytes: &[u8]) -> Vec<(Vec3, Option<[f32; 3]>)> {
    let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(bytes).unwrap();
    let primitive = document.meshes().next().unwrap().primitives().next().unwrap();
    let reader = primitive.reader(|_| blob.as_deref());
    let positions: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
    let colours: Option<Vec<[f32; 3]>> = reader.read_colors(0).map(|c| c.into_rgb_f32().collect());
    let corners = reader.read_indices().unwrap().into_u32().map(|i| i as usize);
    corners.map(|i| (positions[i].into(), colours.as_ref().map(|c| c[i].map(srgb)))).collect()
}

fn srgb(linear: f32) -> f32 {
    255.0 * if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Triangles as rounded corners, each with its smallest corner first, sorted.
fn set(corners: &[Vec3], step: f32) -> Vec<[[i64; 3]; 3]> {
    let rounded = |p: Vec3| (p / step).round().to_array().map(|v| v as i64);
    let mut triangles: Vec<[[i64; 3]; 3]> = corners
        .chunks(3)
        .map(|t| {
            let t = [rounded(t[0]), rounded(t[1]), rounded(t[2])];
            let first = (0..3).min_by_key(|&k| t[k]).unwrap();
            [t[first], t[(first + 1) % 3], t[(first + 2) % 3]]
        })
        .collect();
    triangles.sort_unstable();
    triangles
}

#[test]
fn a_textured_file_has_one_picture_and_the_same_triangles() {
    let capture = Capture::new(8, 1);
    let plain = plain_corners(&made(&capture, &[]));
    let bytes = made(&capture, &["--texture=128"]);
    let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(&bytes).unwrap();
    let primitive = document.meshes().next().unwrap().primitives().next().unwrap();
    let reader = primitive.reader(|_| blob.as_deref());
    let uvs: Vec<[f32; 2]> = reader.read_tex_coords(0).unwrap().into_f32().collect();
    assert!(uvs.iter().flatten().all(|v| (0.0..=1.0).contains(v)));
    assert!(reader.read_colors(0).is_none() && primitive.material().unlit());
    let texture = primitive.material().pbr_metallic_roughness().base_color_texture().unwrap().texture();
    let gltf::image::Source::View { view, mime_type } = texture.source().source() else { panic!("it is in the file") };
    let jpeg = &blob.as_deref().unwrap()[view.offset()..][..view.length()];
    let picture = image::load_from_memory(jpeg).unwrap();
    assert_eq!((mime_type, picture.width(), picture.height()), ("image/jpeg", 128, 128));
    // Only the order of the triangles and the copies of vertices differ.
    let textured: Vec<Vec3> = plain_corners(&bytes).iter().map(|c| c.0).collect();
    let plain: Vec<Vec3> = plain.iter().map(|c| c.0).collect();
    assert_eq!(set(&textured, 1e-6), set(&plain, 1e-6));
}

#[test]
fn a_compressed_file_is_within_its_steps_of_the_plain_one() {
    let capture = Capture::new(8, 1);
    let plain = plain_corners(&made(&capture, &[]));
    let bytes = made(&capture, &["--compress"]);
    assert_eq!(bytes, made(&capture, &["--compress", "--threads", "1"]));
    let (json, binary) = parts(&bytes);
    let required = serde_json::json!(["KHR_mesh_quantization", "EXT_meshopt_compression"]);
    assert_eq!(json["extensionsRequired"], required);
    let primitive = &json["meshes"][0]["primitives"][0];
    assert!(primitive["attributes"]["NORMAL"].is_null());
    let accessor = |index: &Value| &json["accessors"][index.as_u64().unwrap() as usize];
    let bytes_of = |name: &str| view(&json, binary, &accessor(&primitive["attributes"][name])["bufferView"]);
    let (node, positions) = (&json["nodes"][0], shorts(&bytes_of("POSITION"), 8));
    let stored = accessor(&primitive["attributes"]["COLOR_0"]);
    let packed = &json["bufferViews"][stored["bufferView"].as_u64().unwrap() as usize]["extensions"];
    assert_eq!(packed["EXT_meshopt_compression"]["filter"], "EXPONENTIAL");
    assert_eq!((&stored["componentType"], &stored["normalized"]), (&serde_json::json!(5126), &Value::Null));
    let colours: Vec<[f32; 3]> =
        bytes_of("COLOR_0").chunks(12).map(|v| [0, 4, 8].map(|k| exponential(&v[k..]))).collect();
    let number = |v: &Value| v.as_f64().unwrap();
    let (scale, offset) = (number(&node["scale"][0]), &node["translation"]);
    let indices = view(&json, binary, &accessor(&primitive["indices"])["bufferView"]);
    let corners: Vec<(Vec3, [f32; 3])> = indices
        .chunks(2)
        .map(|i| usize::from(u16::from_le_bytes([i[0], i[1]])))
        .map(|i| {
            let place = |axis: usize| number(&offset[axis]) + scale * f64::from(positions[i][axis]);
            let colour = [0, 1, 2].map(|k| srgb(colours[i][k]));
            (DVec3::new(place(0), place(1), place(2)).as_vec3(), colour)
        })
        .collect();
    assert_eq!(corners.len(), plain.len());
    // Each corner has one in the plain file within half a step along each axis, with its colour within a code.
    let size = plain.iter().fold(0.0f32, |size, (p, _)| size.max(p.abs().max_element())) * 2.0;
    let near = |a: Vec3, b: Vec3| (a - b).abs().max_element() <= size / 32_000.0;
    let mut by_place: BTreeMap<i64, Vec<(Vec3, [f32; 3])>> = BTreeMap::new();
    for &(p, colour) in &plain {
        by_place.entry((p.x * 100.0).floor() as i64).or_default().push((p, colour.unwrap()));
    }
    for (p, colour) in corners {
        let key = (p.x * 100.0).floor() as i64;
        let found = (key - 1..=key + 1)
            .filter_map(|k| by_place.get(&k))
            .flatten()
            .any(|(q, other)| near(p, *q) && colour.iter().zip(other).all(|(a, b)| (a - b).abs() <= 1.0));
        assert!(found, "{p} {colour:?}");
    }
}

#[test]
fn a_compressed_file_is_a_quarter_of_the_plain_one() {
    let capture = Capture::enlarged(8, 1, 4);
    let plain = made(&capture, &[]).len();
    let small = made(&capture, &["--compress"]).len();
    assert!(small * 39 < plain * 10, "{small} of {plain} bytes");
}

#[test]
fn upright_files_turn_the_scenes_upward_direction_to_plus_y() {
    let mut capture = Capture::new(8, 1);
    let scene_frame = made(&capture, &[]);
    let (json, _) = parts(&scene_frame);
    assert!(json["nodes"][0]["rotation"].is_null());
    let bytes = made(&capture, &["--upright", "--faces", "500"]);
    let (json, _) = parts(&bytes);
    assert_eq!(json["scenes"][0]["extras"]["up"], serde_json::json!([0, 1, 0]));
    let rotation: [f64; 4] = serde_json::from_value(json["nodes"][0]["rotation"].clone()).unwrap();
    let up = DQuat::from_array(rotation) * DVec3::Z;
    assert!((up - DVec3::Y).abs().max_element() < 1e-12, "{up}");

    // The manifest has both frames, and bounds in that of the files.
    let manifest: Value = serde_json::from_slice(&fs::read(capture.path("out/sequence.json")).unwrap()).unwrap();
    let numbers = |v: &Value| -> Vec<f64> { serde_json::from_value(v.clone()).unwrap() };
    assert_eq!(numbers(&manifest["up"]), [0.0, 1.0, 0.0]);
    assert_eq!(numbers(&manifest["rotation"]), rotation);
    let corner = |end: usize| -> [f64; 3] { serde_json::from_value(manifest["bounds"][end].clone()).unwrap() };
    for (p, _) in plain_corners(&bytes) {
        let turned = DQuat::from_array(rotation) * p.as_dvec3();
        assert!((0..3).all(|k| turned[k] > corner(0)[k] - 1e-6 && turned[k] < corner(1)[k] + 1e-6), "{turned}");
    }

    capture.scene["up"] = Value::Null;
    let output = capture.run(&["--upright"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("`up` is missing"), "{}", stderr(&output));
}

#[test]
fn forms_are_for_glb_files_and_sizes_that_exist() {
    let capture = Capture::new(8, 1);
    for argument in ["--faces=100", "--texture", "--compress", "--upright"] {
        let output = capture.run(&["--format", "ply", argument]);
        assert_eq!(output.status.code(), Some(2), "{argument}");
        assert!(stderr(&output).contains("leave out --format ply"), "{}", stderr(&output));
    }
    let output = capture.run(&["--texture=20"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("choose 64 to 16384"), "{}", stderr(&output));
    assert!(!capture.results().iter().any(|name| name.ends_with(".glb")));
}

#[test]
fn fewer_faces_are_made_or_the_rest_is_warned_of() {
    let capture = Capture::enlarged(8, 1, 4);
    let faces = |bytes: &[u8]| plain_corners(bytes).len() / 3;
    assert!(faces(&made(&capture, &[])) > 10_000);
    let some = made(&capture, &["--faces", "2000"]);
    assert!((1900..=2000).contains(&faces(&some)), "{}", faces(&some));
    let output = capture.run(&["--faces", "4", "--texture=256"]);
    assert!(output.status.success() && stderr(&output).contains("instead of 4"), "{}", stderr(&output));
    let output = capture.run(&["--faces", "4", "--strict"]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
}
