//! cameras_sphere.npz and cameras.npz of NeuS, IDR and DTU: `world_mat_N` is the projection K (R, t), whose first pixel has
//! its centre at (0, 0). The pictures are in `image` or `images`, in the order of their names, or a folder per camera is,
//! with its pictures of several instants.

use super::{
    found::Found,
    notes::Notes,
    source::{failure, find_picture, is_picture, read, without_extension},
    view::ImportedView,
};
use crate::{failure::Failure, files::Files};
use glam::{DMat3, DVec3};
use npyz::NpyFile;
use pcmvs_core::Lens;
use std::{
    io::Cursor,
    path::{Path, PathBuf},
};
use zip::{ZipArchive, result::ZipError};

/// Names of the file.
pub const FILES: [&str; 2] = ["cameras_sphere.npz", "cameras.npz"];
const PROJECTION: &str = "world_mat_";
/// Scales of the subject, inverses, and a copy of the projection.
const HARMLESS: [&str; 5] = ["scale_mat_", "scale_mat_inv_", "world_mat_inv_", "camera_mat_", "camera_mat_inv_"];

/// Reads the file, or a folder with it.
pub fn import(files: &dyn Files, path: &Path, notes: &mut Notes) -> Result<Vec<ImportedView>, Failure> {
    let file = if files.is_folder(path) {
        let found = FILES.map(|name| path.join(name)).into_iter().find(|file| files.is_file(file));
        found.ok_or_else(|| Failure::Input(format!("{}: contains no {}", path.display(), FILES[0])))?
    } else {
        path.to_path_buf()
    };
    let wrong = |problem: String| Failure::Input(format!("{}: {problem}", file.display()));
    let matrices = matrices(read(files, &file)?, &file, notes).map_err(wrong)?;
    let folder = file.parent().unwrap_or(Path::new(""));
    let images = pictures(files, folder)?;
    if images.len() != matrices.len() {
        return Err(wrong(format!(
            "has {} cameras, but there are {} pictures or folders in `image`: remove those that are too many",
            matrices.len(),
            images.len()
        )));
    }
    let mut views = Vec::new();
    for (image, p) in images.iter().zip(matrices) {
        let full = image.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let name = without_extension(&full).to_owned();
        let (k, r, t) = decompose(&p).map_err(|problem| failure(&file, &name, &problem))?;
        let beside = image.parent().unwrap_or(folder).to_path_buf();
        let found = Found { name: name.clone(), picture: full, size: None, k, lens: Lens::NONE, r, t };
        let mut own = found.views(files, &file, &[beside], notes)?;
        for view in &mut own {
            view.mask = mask(files, folder, &view.image);
        }
        views.extend(own);
    }
    Ok(views)
}

/// The projections in the order of their numbers.
fn matrices(bytes: Vec<u8>, file: &Path, notes: &mut Notes) -> Result<Vec<[f64; 16]>, String> {
    let unreadable = |e: std::io::Error| format!("{e}: copy the file again");
    let broken = |e: ZipError| format!("{e}: copy the file again");
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(broken)?;
    let mut names = Vec::new();
    for name in archive.file_names() {
        names.extend(name.map_err(broken)?.strip_suffix(".npy").map(str::to_owned));
    }
    let is_numbered = |name: &str, start: &str| name.strip_prefix(start).is_some_and(|n| n.parse::<u32>().is_ok());
    for name in &names {
        if !is_numbered(name, PROJECTION) && !HARMLESS.iter().any(|start| is_numbered(name, start)) {
            return Err(format!("the array `{name}` is not understood: remove it, or convert the file"));
        }
    }
    if names.iter().any(|name| name.starts_with("scale_mat_")) {
        notes.add(format!("{}: scale_mat is ignored: the scene has the unit of world_mat", file.display()));
    }
    let count = names.iter().filter(|name| is_numbered(name, PROJECTION)).count();
    let matrix = |i: usize| -> Result<[f64; 16], String> {
        let name = format!("{PROJECTION}{i}");
        let missing = || format!("`{name}` is missing: cameras must be numbered from 0 without a gap");
        let entry = match archive.by_name(&format!("{name}.npy")) {
            Err(ZipError::FileNotFound) => return Err(missing()),
            entry => entry.map_err(broken)?,
        };
        let array = NpyFile::new(entry).map_err(unreadable)?;
        if array.shape() != [4, 4] && array.shape() != [3, 4] {
            return Err(format!("`{name}` must be a matrix of 4 x 4 numbers"));
        }
        let by_columns = array.order() == npyz::Order::Fortran;
        let rows = array.shape()[0] as usize;
        let list: Vec<f64> = match array.try_data::<f64>() {
            Ok(data) => data.collect::<Result<_, _>>().map_err(unreadable)?,
            Err(array) => {
                let data =
                    array.try_data::<f32>().map_err(|_| format!("`{name}` must have numbers of type f4 or f8"))?;
                data.map(|v| v.map(f64::from)).collect::<Result<_, _>>().map_err(unreadable)?
            }
        };
        let mut p = [0.0; 16];
        p[15] = 1.0;
        for (i, v) in list.into_iter().enumerate() {
            let at = if by_columns { i % rows * 4 + i / rows } else { i };
            p[at] = v;
        }
        Ok(p)
    };
    (0..count).map(matrix).collect()
}

type Camera = ([[f64; 3]; 3], [[f64; 3]; 3], [f64; 3]);

/// K, R and t of a projection: K is upper triangular with positive focal lengths, so that the rows of K R, from the last to
/// the first, give those of R one after another.
fn decompose(p: &[f64; 16]) -> Result<Camera, String> {
    let row = |i: usize| DVec3::new(p[4 * i], p[4 * i + 1], p[4 * i + 2]);
    let m = DMat3::from_cols(row(0), row(1), row(2)).transpose();
    let scale = row(2).length();
    if !(scale > 0.0) || !scale.is_finite() || m.determinant() == 0.0 {
        return Err(String::from("its projection is singular: export it again"));
    }
    // A projection is the same with the other sign.
    let scale = if m.determinant() < 0.0 { -scale } else { scale };
    let [a, b, c] = [row(0) / scale, row(1) / scale, row(2) / scale];
    let (cx, cy) = (a.dot(c), b.dot(c));
    let up = b - c * cy;
    let fy = up.length();
    let down = up / fy;
    let skew = a.dot(down);
    let across = a - c * cx - down * skew;
    let fx = across.length();
    let right = across / fx;
    let k = [[fx, skew, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]];
    let (tz, ty) = (p[11] / scale, (p[7] - cy * p[11]) / scale / fy);
    let tx = (p[3] / scale - skew * ty - cx * tz) / fx;
    Ok((k, [right.to_array(), down.to_array(), c.to_array()], [tx, ty, tz]))
}

/// All pictures of the folder. If it has none, the folders in it.
fn pictures(files: &dyn Files, folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let Some(images) =
        ["image", "images", "rgb"].map(|name| folder.join(name)).into_iter().find(|f| files.is_folder(f))
    else {
        return Err(Failure::Input(format!("{}: has no folder `image` with the pictures", folder.display())));
    };
    let entries = files.list(&images).map_err(|e| Failure::unreadable(&images, &e))?;
    let (pictures, others): (Vec<PathBuf>, Vec<PathBuf>) =
        entries.into_iter().partition(|path| files.is_file(path) && is_picture(path));
    let folders = || others.into_iter().filter(|path| files.is_folder(path)).collect();
    let found: Vec<PathBuf> = if pictures.is_empty() { folders() } else { pictures };
    let falls =
        |pair: &&[PathBuf]| number(&pair[0]).zip(number(&pair[1])).is_some_and(|(first, second)| second < first);
    match found.windows(2).find(falls) {
        Some(pair) => Err(Failure::Input(format!(
            "{}: {} comes after {} by its number and before it by its name, so that it is not certain which camera it belongs \
             to: write all numbers with equally many digits",
            images.display(),
            name(&pair[0]),
            name(&pair[1])
        ))),
        None => Ok(found),
    }
}

fn name(path: &Path) -> std::borrow::Cow<'_, str> {
    path.file_name().unwrap_or_default().to_string_lossy()
}

/// The number that the name of a picture or folder is.
fn number(path: &Path) -> Option<u64> {
    without_extension(&name(path)).parse().ok()
}

/// The mask of a picture, in `mask` under the picture's name or its number with three digits.
fn mask(files: &dyn Files, folder: &Path, image: &Path) -> Option<PathBuf> {
    let name = image.file_name()?.to_str()?;
    let stem = without_extension(name);
    let short = stem.parse::<u32>().ok().map(|number| format!("{number:03}"));
    let folders = [folder.join("mask")];
    // A folder per camera is repeated below `mask`.
    let camera = image.parent().and_then(Path::file_name).unwrap_or_default();
    let of_clip = [folder.join("mask").join(camera)];
    if let Some(mask) = find_picture(files, &of_clip, stem) {
        return Some(mask);
    }
    find_picture(files, &folders, stem).or_else(|| find_picture(files, &folders, &short?))
}
