//! ZJU-MoCap's annots.npy, as numpy writes it.

use super::super::{import, import_with_notes, refused};
use super::{BROWN, COUNT, Pinhole, brown, by_rows, check, folder, opencv, pinholes};
use std::fs;

/// A pickle of protocol 3. Arrays are what numpy makes of them: a function's call with a state.
#[derive(Default)]
struct Pickle(Vec<u8>);

impl Pickle {
    fn add(&mut self, bytes: &[u8]) -> &mut Self {
        self.0.extend(bytes);
        self
    }

    fn text(&mut self, text: &str) -> &mut Self {
        self.add(b"X").add(&(text.len() as u32).to_le_bytes()).add(text.as_bytes())
    }

    fn bytes(&mut self, bytes: &[u8]) -> &mut Self {
        self.add(b"B").add(&(bytes.len() as u32).to_le_bytes()).add(bytes)
    }

    fn list(&mut self, count: usize, item: impl Fn(&mut Self, usize)) -> &mut Self {
        self.add(b"](");
        (0..count).for_each(|i| item(self, i));
        self.add(b"e")
    }

    /// An array of a kind such as f8: its shape, whether it is by columns, and its data.
    fn array(&mut self, kind: &str, shape: &[u8], by_columns: bool, data: impl Fn(&mut Self)) -> &mut Self {
        self.add(b"cnumpy.core.multiarray\n_reconstruct\ncnumpy\nndarray\nK\x00\x85C\x01b\x87R(K\x01(");
        for &side in shape {
            self.add(&[b'K', side]);
        }
        self.add(b"tcnumpy\ndtype\n").text(kind).add(b"\x89\x88\x87R(K\x03").text("<");
        self.add(b"NNNJ\xff\xff\xff\xffJ\xff\xff\xff\xffK\x00tb").add(if by_columns { b"\x88" } else { b"\x89" });
        data(self);
        self.add(b"tb")
    }

    fn doubles(&mut self, shape: &[u8], by_columns: bool, numbers: &[f64]) -> &mut Self {
        let bytes: Vec<u8> = numbers.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.array("f8", shape, by_columns, |pickle| {
            pickle.bytes(&bytes);
        })
    }
}

pub fn picture(camera: usize, frame: usize) -> String {
    format!("Camera_B{}/{frame:06}.png", camera + 1)
}

/// The file of a number of frames.
pub fn annots(cameras: &[Pinhole], lens: [f64; 5], frames: usize, extra: &str) -> Vec<u8> {
    let count = cameras.len();
    let mut pickle = Pickle::default();
    pickle.add(b"\x80\x03").array("O8", &[], false, |top| {
        top.list(1, |top, _| {
            top.add(b"}(").text("cams").add(b"}(");
            top.text("K").list(count, |list, i| {
                // As arrays by rows and by columns, and as nested lists.
                let k = cameras[i].k();
                let by_columns = [k[0], k[3], k[6], k[1], k[4], k[7], k[2], k[5], k[8]];
                match i {
                    0 => drop(list.doubles(&[3, 3], true, &by_columns)),
                    1 => drop(list.list(3, |rows, row| {
                        rows.list(3, |row_list, column| {
                            let value = k[3 * row + column];
                            row_list.add(b"G").add(&value.to_be_bytes());
                        });
                    })),
                    _ => drop(list.doubles(&[3, 3], false, &k)),
                }
            });
            top.text("D").list(count, |list, _| {
                list.doubles(&[5, 1], false, &lens);
            });
            top.text("R").list(count, |list, i| {
                list.doubles(&[3, 3], false, &by_rows(&cameras[i].r));
            });
            // All in one array.
            let t: Vec<f64> = cameras.iter().flat_map(|pose| (pose.t * 1000.0).to_array()).collect();
            top.text("T").doubles(&[count as u8, 3, 1], false, &t);
            if !extra.is_empty() {
                top.text(extra).add(b"K\x01");
            }
            top.add(b"u").text("ims").list(frames, |list, frame| {
                list.add(b"}(").text("ims");
                if frame == 1 {
                    // An array of texts of equal length.
                    let names: String = (0..count).map(|i| picture(i, frame)).collect();
                    let length = picture(0, 0).len();
                    let data: Vec<u8> = names.chars().flat_map(|c| u32::from(c).to_le_bytes()).collect();
                    list.array(&format!("U{length}"), &[count as u8], false, |array| {
                        array.bytes(&data);
                    });
                } else {
                    list.list(count, |names, i| {
                        let name = picture(i, frame);
                        names.text(&if i == 0 { name.replace('/', "\\") } else { name });
                    });
                }
                list.text("kpts2d").doubles(&[1, 2], false, &[1.0, 2.0]).add(b"u");
            });
            top.add(b"u");
        });
    });
    pickle.add(b".");
    let header = format!("{:<117}\n", "{'descr': '|O', 'fortran_order': False, 'shape': (), }");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.bytes());
    bytes.extend(pickle.0);
    bytes
}

#[test]
fn zju_is_opencv_in_millimetres() {
    let pictures: Vec<String> = (0..COUNT).map(|i| picture(i, 0)).collect();
    let capture = folder(&pictures, &[]);
    fs::write(capture.path().join("annots.npy"), annots(&pinholes(), BROWN, 1, "")).unwrap();
    fs::create_dir(capture.path().join("mask_cihp")).unwrap();
    let notes = check("zju", capture.path(), &["annots.npy"], |pose, point| opencv(pose, point, |p| brown(p, BROWN)));
    assert!(notes.contains("T is in millimetres") && notes.contains("ignored: `kpts2d`"), "{notes}");
    assert!(notes.contains("mask_cihp: is not taken"), "{notes}");
    assert_eq!(import("zju", capture.path())["cameras"][3]["name"], "Camera_B4");
}

#[test]
fn zju_frames_are_a_clip() {
    let pictures: Vec<String> = (0..COUNT).flat_map(|i| (0..3).map(move |frame| picture(i, frame))).collect();
    let capture = folder(&pictures, &[]);
    fs::write(capture.path().join("annots.npy"), annots(&pinholes(), BROWN, 3, "")).unwrap();
    fs::remove_file(capture.path().join(picture(2, 1))).unwrap();
    let (scene, notes) = import_with_notes("auto", capture.path());
    assert_eq!(scene["frames"].as_array().unwrap().len(), 3);
    assert!(scene["frames"][1]["images"][2].is_null() && scene["frames"][1]["images"][1].is_string());
    assert!(notes.contains("1 of 12 pictures are not there and left out, such as `Camera_B3/000001.png`"), "{notes}");
    assert!(notes.contains("in how many: `Camera_B3` 1"), "{notes}");
}

#[test]
fn a_zju_file_that_is_wrong_is_refused() {
    let pictures: Vec<String> = (0..COUNT).map(|i| picture(i, 0)).collect();
    let capture = folder(&pictures, &[]);
    let file = capture.path().join("annots.npy");
    let whole = annots(&pinholes(), BROWN, 1, "");
    let numbers = [&b"\x93NUMPY\x01\x00\x76\x00"[..], format!("{:<118}", "{'descr': '<f8'}").as_bytes()].concat();
    for (bytes, problem) in [
        (whole[..whole.len() - 40].to_vec(), "annots.npy: "),
        (annots(&pinholes(), BROWN, 1, "pose"), "`pose` looks like calibration"),
        (numbers, "is an array of numbers"),
        (b"PK".to_vec(), "is no .npy file"),
    ] {
        fs::write(&file, bytes).unwrap();
        let message = refused("zju", capture.path());
        assert!(message.contains(problem), "{message}");
    }
    fs::write(&file, whole).unwrap();
    fs::remove_file(capture.path().join(picture(3, 0))).unwrap();
    let message = refused("zju", capture.path());
    assert!(message.contains("Camera_B4") && message.contains("none of its pictures is there"), "{message}");
}
