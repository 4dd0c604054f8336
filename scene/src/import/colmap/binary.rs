//! cameras.bin and images.bin. Numbers are little-endian.

use super::model::{Image, Lens};
use crate::{failure::Failure, files::Files, import::source};
use std::{collections::BTreeMap, path::Path};

/// Names of COLMAP's models and the number of their parameters. The position is the number of the model.
const MODELS: [(&str, usize); 12] = [
    ("SIMPLE_PINHOLE", 3),
    ("PINHOLE", 4),
    ("SIMPLE_RADIAL", 4),
    ("RADIAL", 5),
    ("OPENCV", 8),
    ("OPENCV_FISHEYE", 8),
    ("FULL_OPENCV", 12),
    ("FOV", 5),
    ("SIMPLE_RADIAL_FISHEYE", 4),
    ("RADIAL_FISHEYE", 5),
    ("THIN_PRISM_FISHEYE", 12),
    ("RAD_TAN_THIN_PRISM_FISHEYE", 16),
];
/// Bytes of a 2D point: X and Y as f64, and the number of a 3D point.
const POINT: u64 = 24;

/// Bytes that have not been read yet.
struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let (taken, rest) = self.0.split_first_chunk::<N>().ok_or_else(truncated)?;
        self.0 = rest;
        Ok(*taken)
    }

    fn u32(&mut self) -> Result<u32, String> {
        self.take().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Result<u64, String> {
        self.take().map(u64::from_le_bytes)
    }

    fn f64s<const N: usize>(&mut self) -> Result<[f64; N], String> {
        let mut values = [0.0; N];
        for value in &mut values {
            *value = f64::from_le_bytes(self.take()?);
        }
        Ok(values)
    }

    /// UTF-8 text up to a zero byte.
    fn text(&mut self) -> Result<String, String> {
        let end = self.0.iter().position(|&byte| byte == 0).ok_or_else(truncated)?;
        let text = std::str::from_utf8(&self.0[..end])
            .map_err(|_| String::from("the name of a picture is not UTF-8: rename the picture"))?;
        self.0 = &self.0[end + 1..];
        Ok(text.to_owned())
    }

    fn skip(&mut self, count: u64) -> Result<(), String> {
        let rest = usize::try_from(count).ok().and_then(|count| self.0.get(count..));
        self.0 = rest.ok_or_else(truncated)?;
        Ok(())
    }

    fn at_end<T>(&self, value: T) -> Result<T, String> {
        let more = || String::from("there are more bytes than the file announces: export the model again");
        self.0.is_empty().then_some(value).ok_or_else(more)
    }
}

fn truncated() -> String {
    String::from("the file is truncated: copy it again")
}

fn in_file<T>(file: &Path, result: Result<T, String>) -> Result<T, Failure> {
    result.map_err(|problem| Failure::Input(format!("{}: {problem}", file.display())))
}

/// Reads cameras.bin.
pub fn read_cameras(files: &dyn Files, file: &Path) -> Result<BTreeMap<u32, Lens>, Failure> {
    in_file(file, cameras(&mut Bytes(&source::read(files, file)?)))
}

fn cameras(bytes: &mut Bytes) -> Result<BTreeMap<u32, Lens>, String> {
    let mut lenses = BTreeMap::new();
    for _ in 0..bytes.u64()? {
        let (id, model) = (bytes.u32()?, bytes.u32()?);
        let &(name, count) = MODELS.get(model as usize).ok_or_else(|| {
            format!("camera {id}: the model number {model} is unknown: convert with `colmap model_converter --output_type TXT`")
        })?;
        let side = |v: u64| u32::try_from(v).map_err(|_| format!("camera {id}: {v} pixels are too many"));
        let size = [side(bytes.u64()?)?, side(bytes.u64()?)?];
        let params: Vec<f64> = (0..count).map(|_| Ok(bytes.f64s::<1>()?[0])).collect::<Result<_, String>>()?;
        if lenses.insert(id, Lens { model: name.to_owned(), size, params }).is_some() {
            return Err(format!("camera {id}: occurs twice: export the model again"));
        }
    }
    bytes.at_end(lenses)
}

/// Reads images.bin.
pub fn read_images(files: &dyn Files, file: &Path) -> Result<Vec<Image>, Failure> {
    in_file(file, images(&mut Bytes(&source::read(files, file)?)))
}

fn images(bytes: &mut Bytes) -> Result<Vec<Image>, String> {
    let mut images = Vec::new();
    for _ in 0..bytes.u64()? {
        bytes.u32()?;
        let (quaternion, translation, camera) = (bytes.f64s()?, bytes.f64s()?, bytes.u32()?);
        let name = bytes.text()?;
        let points = bytes.u64()?;
        bytes.skip(points.checked_mul(POINT).ok_or_else(truncated)?)?;
        images.push(Image { name, quaternion, translation, camera });
    }
    bytes.at_end(images)
}
