//! cameras_sphere.npz of NeuS, IDR and DTU.

use super::super::{HEIGHT, WIDTH, import, refused};
use super::{COUNT, Pinhole, check, folder, opencv, pinholes};
use glam::DMat3;
use image::GrayImage;
use std::{fs, path::PathBuf};

/// An .npz file: stored entries, one array of 4 x 4 numbers of eight bytes each.
pub fn npz(arrays: &[(String, [f64; 16])]) -> Vec<u8> {
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

/// The arrays of the cameras.
pub fn neus(cameras: &[Pinhole]) -> Vec<(String, [f64; 16])> {
    let mut arrays = Vec::new();
    for (i, pose) in cameras.iter().enumerate() {
        let k = DMat3::from_cols_array(&pose.k()).transpose();
        let (m, p) = (k * pose.r, k * pose.t);
        // Projections may have any scale, and the other sign.
        let scale = [1.0, 0.01, -2.0, 7.0][i % 4];
        let numbers: Vec<f64> =
            (0..3).flat_map(|r| [m.row(r).x, m.row(r).y, m.row(r).z, p[r]]).map(|v| v * scale).collect();
        let mut world = [0.0; 16];
        world[..12].copy_from_slice(&numbers);
        world[15] = 1.0;
        arrays.push((format!("world_mat_{i}"), world));
        arrays.push((format!("scale_mat_{i}"), [2.0; 16]));
    }
    arrays
}

#[test]
fn neus_is_a_projection_matrix_in_npz() {
    let mut arrays = neus(&pinholes());
    let pictures: Vec<String> = (0..COUNT).map(|i| format!("image/{i:06}.png")).collect();
    let capture = folder(&pictures, &[]);
    let file: PathBuf = capture.path().join("cameras_sphere.npz");
    fs::write(&file, npz(&arrays)).unwrap();
    fs::create_dir(capture.path().join("mask")).unwrap();
    GrayImage::new(WIDTH, HEIGHT).save(capture.path().join("mask/002.png")).unwrap();
    let notes = check("neus", capture.path(), &["cameras_sphere.npz"], |pose, point| opencv(pose, point, |p| p));
    assert!(notes.contains("scale_mat is ignored"), "{notes}");
    // Names whose order is not that of their numbers.
    for i in 0..COUNT {
        fs::rename(capture.path().join(&pictures[i]), capture.path().join(format!("image/{}.png", 8 + i))).unwrap();
    }
    let message = refused("neus", capture.path());
    assert!(
        message.contains("11.png comes after 8.png by its number") && message.contains("equally many digits"),
        "{message}"
    );
    for i in 0..COUNT {
        fs::rename(capture.path().join(format!("image/{}.png", 8 + i)), capture.path().join(&pictures[i])).unwrap();
    }
    // What macOS writes beside files.
    fs::write(capture.path().join("image/._000000.png"), "x").unwrap();
    let scene = import("neus", capture.path());
    assert_eq!(scene["frames"][0]["masks"], serde_json::json!([null, null, "masks/000002.png", null]));

    // A folder per camera is a clip.
    let pictures: Vec<String> =
        (0..COUNT).flat_map(|i| (0..2).map(move |frame| format!("image/c{i}/{frame:03}.png"))).collect();
    let clip = folder(&pictures, &[]);
    fs::copy(&file, clip.path().join("cameras_sphere.npz")).unwrap();
    fs::create_dir_all(clip.path().join("mask/c1")).unwrap();
    GrayImage::new(WIDTH, HEIGHT).save(clip.path().join("mask/c1/001.png")).unwrap();
    let scene = import("auto", clip.path());
    assert_eq!(scene["frames"].as_array().unwrap().len(), 2);
    assert_eq!(scene["frames"][1]["masks"], serde_json::json!([null, "masks/c1_0001.png", null, null]));

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
