//! Pictures are measured by their headers, and those that are cut off are refused.

use super::{HEIGHT, WIDTH, camera, import, refused, source};
use image::{ImageFormat, RgbImage};
use std::{fs, io::Cursor};

/// An APP1 segment with an EXIF entry that asks for a quarter turn: tag 0x112, one short of value 6.
const QUARTER_TURN: &[u8] =
    b"\xFF\xE1\x00\x22Exif\0\0MM\0\x2A\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0";

fn jpeg() -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    RgbImage::new(WIDTH, HEIGHT).write_to(&mut file, ImageFormat::Jpeg).unwrap();
    let mut file = file.into_inner();
    file.splice(2..2, QUARTER_TURN.iter().copied());
    file
}

/// A capture of three cameras, of which the second has a JPEG.
fn capture() -> tempfile::TempDir {
    let line = |i: usize, end: &str| format!("{i}.{end} 60 0 30 0 60 20 0 0 1 0 -1 0 1 0 0 0 0 1 0.{i} 0.2 3\n");
    let text = format!("3\n{}{}{}", line(0, "png"), line(1, "jpg"), line(2, "png"));
    let folder = source("x_par.txt", &text, &["0.png", "2.png"], &[]);
    fs::write(folder.path().join("1.jpg"), jpeg()).unwrap();
    folder
}

#[test]
fn an_orientation_in_exif_does_not_exchange_the_sides() {
    let capture = capture();
    // A Middlebury file has no sizes: they are those of the pictures.
    let turned = camera(&import("middlebury", capture.path()), 1);
    assert_eq!([turned.width, turned.height], [WIDTH, HEIGHT]);
    let decoded = pcmvs_scene::Picture::decode(&jpeg()).unwrap();
    assert_eq!([decoded.view().width, decoded.view().height], [WIDTH, HEIGHT]);

    // A program that applies the orientation has calibrated the turned picture.
    let camera = format!("SIMPLE_PINHOLE {HEIGHT} {WIDTH} 60 24 32");
    let message = refused("colmap", super::colmap(&camera).path());
    assert!(message.contains("its sides are exchanged") && message.contains("EXIF"), "{message}");
}

#[test]
fn pictures_that_are_cut_off_are_refused() {
    let capture = capture();
    for name in ["1.jpg", "2.png"] {
        let path = capture.path().join(name);
        let whole = fs::read(&path).unwrap();
        for length in [whole.len() / 2, whole.len() - 20] {
            fs::write(&path, &whole[..length]).unwrap();
            let message = refused("middlebury", capture.path());
            assert!(message.contains(name) && message.contains("truncated"), "{message}");
        }
        fs::write(&path, whole).unwrap();
    }
}
