//! The two CSV files of camera parameters that RealityCapture and RealityScan export, with one row per picture and the names
//! of the columns in the first:
//! - "Internal/External camera parameters": `x`, `y`, `alt` are the camera's centre, x to the east, y to the north. With
//!   `heading` (or `yaw`), `pitch` and `roll` of zero it looks straight down and the picture's top is to the north. It turns
//!   as an aircraft would: around its own vertical axis by the heading, clockwise from above, then around the picture's x
//!   axis by the pitch, and around the picture's y axis by the roll, in degrees. `f` (or `f_35mm`) is the focal length in
//!   36ths of the picture's larger side; `px` and `py` (or `px_norm`, `py_norm`) are shares of it, from the picture's middle.
//! - "OpenCV-compliant Internal/External camera parameters": `tx`, `ty`, `tz` and `R00` to `R22` by rows, world to camera,
//!   and `f_pix`, `px_pix`, `py_pix` in pixels from the picture's corner.
//!
//! Neither tells the model of the distortion. A program that shows tables may have saved them with semicolons, and then mostly with
//! decimal commas.

use super::{
    super::{
        found::{Found, first_size},
        keys::{listed, unread},
        names::name_of,
        notes::Notes,
        source::{failure, read_text},
        view::{ImportedView, rows},
    },
    shares::{brown, entries_with, principal},
};
use crate::{failure::Failure, files::Files};
use csv::{ReaderBuilder, StringRecord, Trim};
use glam::{DMat3, DVec3};
use pcmvs_core::Lens;
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};

const NAME: &str = "name";
const ANGLES: [[&str; 2]; 3] = [["heading", "yaw"], ["pitch", "pitch"], ["roll", "roll"]];
const CENTRE: [&str; 3] = ["x", "y", "alt"];
const FOCAL: [&str; 2] = ["f", "f_35mm"];
const PRINCIPAL: [[&str; 2]; 2] = [["px", "px_norm"], ["py", "py_norm"]];
const TRANSLATION: [&str; 3] = ["tx", "ty", "tz"];
const ROTATION: [&str; 9] = ["r00", "r01", "r02", "r10", "r11", "r12", "r20", "r21", "r22"];
const PIXELS: [&str; 3] = ["f_pix", "px_pix", "py_pix"];
const DISTORTION: [&str; 6] = ["k1", "k2", "k3", "k4", "t1", "t2"];

/// Whether a text is such a file.
pub fn is_csv(text: &str) -> bool {
    header(text).is_ok()
}

/// The files of a folder.
pub fn files_of(files: &dyn Files, folder: &Path) -> Vec<PathBuf> {
    let known = |path: &PathBuf| files.is_file(path) && read_text(files, path).is_ok_and(|text| is_csv(&text));
    entries_with(files, folder, "csv").into_iter().filter(known).collect()
}

/// What comes before the rows.
struct Header<'a> {
    /// The columns' names in lower case.
    names: Vec<String>,
    /// Between columns.
    separator: char,
    /// The number of cameras that a line before the names may announce.
    announced: Option<&'a str>,
}

/// What comes before the rows, and the rows.
fn header(text: &str) -> Result<(Header<'_>, &str), String> {
    let mut rest = text.trim_start();
    let mut announced = None;
    if let Some(count) = rest.strip_prefix("#cameras ") {
        let (count, after) = count.split_once('\n').unwrap_or((count, ""));
        announced = Some(count.trim().trim_end_matches([',', ';']));
        rest = after.trim_start();
    }
    let (names, rows) = rest.split_once('\n').unwrap_or((rest, ""));
    let separator = if names.contains(';') { ';' } else { ',' };
    let names: Vec<String> = names
        .trim_start_matches('#')
        .split(separator)
        .map(|name| name.trim().trim_matches('"').trim_start_matches('#').to_lowercase())
        .collect();
    let has = |name: &str| names.iter().any(|known| known == name);
    let by_angles = CENTRE.iter().all(|name| has(name)) && ANGLES.iter().all(|pair| pair.iter().any(|name| has(name)));
    let by_matrix = TRANSLATION.iter().chain(&ROTATION).all(|name| has(name));
    if has(NAME) && (by_angles || by_matrix) {
        Ok((Header { names, separator, announced }, rows))
    } else {
        Err(String::from(
            "the first line does not name the columns of camera parameters: export the registration as Internal/External \
             camera parameters, with the header",
        ))
    }
}

/// Whether the numbers of rows that are separated by semicolons have decimal commas. A point would then separate thousands, or be
/// a decimal point, too: nobody knows.
fn has_decimal_commas(names: &[String], records: &[StringRecord]) -> Result<bool, String> {
    let numbers = || {
        let columns = |record| names.iter().zip(record).filter(|(name, _)| *name != NAME).map(|(_, text)| text);
        records.iter().flat_map(columns)
    };
    let commas = numbers().any(|text: &str| text.contains(','));
    match numbers().find(|text| commas && text.contains('.')) {
        None => Ok(commas),
        Some(text) => Err(format!(
            "has numbers with decimal commas, and `{text}` with a point: export it again, and do not save it in another program"
        )),
    }
}

/// Reads a file.
pub fn read(files: &dyn Files, file: &Path, notes: &mut Notes) -> Result<Vec<ImportedView>, Failure> {
    let wrong = |problem: String| Failure::Input(format!("{}: {problem}", file.display()));
    let text = read_text(files, file)?;
    let (Header { names, separator, announced }, rest) = header(&text).map_err(wrong)?;
    if let Some(twice) = names.iter().enumerate().find(|(i, name)| names[..*i].contains(name)) {
        return Err(wrong(format!("the column `{}` occurs twice: remove the one that is wrong", twice.1)));
    }
    let ignored = unknown(&names).map_err(wrong)?;
    if !ignored.is_empty() {
        notes.add(format!("{}: ignored columns: {}", file.display(), listed(ignored.iter().map(String::as_str))));
    }
    let folder = file.parent().unwrap_or(Path::new(""));
    let folders = [folder.to_path_buf(), folder.join("images")];
    let mut views = Vec::new();
    let mut count = 0;
    let mut reader = ReaderBuilder::new();
    reader.has_headers(false).flexible(true).trim(Trim::All).delimiter(separator as u8);
    let records: Result<Vec<_>, _> = reader.from_reader(rest.as_bytes()).into_records().collect();
    let records = records.map_err(|e| wrong(format!("{e}: correct that line")))?;
    let decimal_commas = separator == ';' && has_decimal_commas(&names, &records).map_err(wrong)?;
    for record in &records {
        if record.iter().all(str::is_empty) {
            continue;
        }
        count += 1;
        let row = Row { names: &names, record, decimal_commas };
        let picture = row.text(NAME).ok_or_else(|| wrong(format!("row {count} has no name: add it")))?;
        let name = name_of(picture);
        let of_camera = |problem: String| failure(file, &name, &problem);
        if record.len() != names.len() {
            let problem = format!("its row has {} values, but there are {} columns", record.len(), names.len());
            return Err(of_camera(problem));
        }
        let size = first_size(files, file, &folders, [&name, picture])?;
        let found = camera(&row, [&name, picture], size).map_err(of_camera)?;
        if found.lens != Lens::NONE {
            notes.add(format!(
                "{}: the distortion is taken as Brown's: if it is that of the model Division, align with Brown3 and export \
                 again",
                file.display()
            ));
        }
        views.extend(found.views(files, file, &folders, notes)?);
    }
    if let Some(announced) = announced
        && announced.parse() != Ok(count)
    {
        return Err(wrong(format!("announces {announced} cameras, but has {count}: export it again")));
    }
    Ok(views)
}

fn unknown(names: &[String]) -> Result<Vec<String>, String> {
    let known: Vec<&str> = [NAME]
        .into_iter()
        .chain(ANGLES.into_iter().flatten())
        .chain(CENTRE)
        .chain(FOCAL)
        .chain(PRINCIPAL.into_iter().flatten())
        .chain(TRANSLATION)
        .chain(ROTATION)
        .chain(PIXELS)
        .chain(DISTORTION)
        .collect();
    let columns: Map<String, Value> = names.iter().map(|name| (name.clone(), Value::Bool(true))).collect();
    Ok(unread(&columns, &[&known], &[])?.into_iter().filter(|name| !name.is_empty()).map(str::to_owned).collect())
}

struct Row<'a> {
    names: &'a [String],
    record: &'a StringRecord,
    decimal_commas: bool,
}

impl<'a> Row<'a> {
    fn text(&self, name: &str) -> Option<&'a str> {
        let column = self.names.iter().position(|known| known == name)?;
        self.record.get(column).filter(|text| !text.is_empty())
    }

    /// The number in the first of these columns that exists.
    fn number(&self, names: &[&str]) -> Result<Option<f64>, String> {
        let Some((name, text)) = names.iter().find_map(|name| Some((name, self.text(name)?))) else { return Ok(None) };
        let number = if self.decimal_commas { text.replace(',', ".").parse() } else { text.parse::<f64>() };
        match number {
            Ok(number) if number.is_finite() => Ok(Some(number)),
            _ => Err(format!("{name}: `{text}` is not a finite number")),
        }
    }

    fn needed(&self, names: &[&str]) -> Result<f64, String> {
        self.number(names)?.ok_or_else(|| format!("`{}` is missing: export it again", names[0]))
    }

    fn all<const N: usize>(&self, names: &[&str; N]) -> Result<[f64; N], String> {
        let mut all = [0.0; N];
        for (value, name) in all.iter_mut().zip(names) {
            *value = self.needed(&[name])?;
        }
        Ok(all)
    }
}

fn camera(row: &Row, [name, picture]: [&str; 2], [width, height]: [u32; 2]) -> Result<Found, String> {
    let mut distortion = [0.0; 6];
    for (value, name) in distortion.iter_mut().zip(DISTORTION) {
        *value = row.number(&[name])?.unwrap_or(0.0);
    }
    let lens = brown(distortion)
        .ok_or_else(|| format!("k4 = {} is not supported: align with Brown3 and export again", distortion[3]))?;
    let (r, t) = if row.text(ROTATION[0]).is_some() {
        (rows(row.all(&ROTATION)?), row.all(&TRANSLATION)?)
    } else {
        let [heading, pitch, roll] = [row.needed(&ANGLES[0])?, row.needed(&ANGLES[1])?, row.needed(&ANGLES[2])?];
        pose([heading, pitch, roll].map(f64::to_radians), DVec3::from_array(row.all(&CENTRE)?))
    };
    let k = if row.text(PIXELS[0]).is_some() {
        let [f, x, y] = row.all(&PIXELS)?;
        [[f, 0.0, x - 0.5], [0.0, f, y - 0.5], [0.0, 0.0, 1.0]]
    } else {
        let larger = f64::from(width.max(height));
        let f = row.needed(&FOCAL)? / 36.0 * larger;
        let [px, py] = [row.number(&PRINCIPAL[0])?.unwrap_or(0.0), row.number(&PRINCIPAL[1])?.unwrap_or(0.0)];
        [[f, 0.0, principal(px, larger, width)], [0.0, f, principal(py, larger, height)], [0.0, 0.0, 1.0]]
    };
    Ok(Found { name: name.to_owned(), picture: picture.to_owned(), size: Some([width, height]), k, lens, r, t })
}

/// Rotation and translation, world to camera, from heading, pitch and roll in radians and the camera's centre.
fn pose([heading, pitch, roll]: [f64; 3], centre: DVec3) -> ([[f64; 3]; 3], [f64; 3]) {
    let [(sh, ch), (sp, cp), (sr, cr)] = [heading, pitch, roll].map(libm::sincos);
    // The columns are the pictures of the axes.
    let heading = DMat3::from_cols_array(&[ch, -sh, 0.0, sh, ch, 0.0, 0.0, 0.0, 1.0]);
    let pitch = DMat3::from_cols_array(&[1.0, 0.0, 0.0, 0.0, cp, sp, 0.0, -sp, cp]);
    let roll = DMat3::from_cols_array(&[cr, 0.0, -sr, 0.0, 1.0, 0.0, sr, 0.0, cr]);
    // Camera to world with y up and z backward.
    let axes = heading * pitch * roll;
    let r = DMat3::from_cols(axes.x_axis, -axes.y_axis, -axes.z_axis).transpose();
    (r.transpose().to_cols_array_2d(), (-(r * centre)).to_array())
}
