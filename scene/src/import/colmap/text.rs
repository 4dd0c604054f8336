//! cameras.txt and images.txt.

use super::model::{Image, Lens};
use crate::{
    failure::Failure,
    files::Files,
    import::{notes::Notes, source::read_text},
};
use std::{collections::BTreeMap, path::Path};

/// Lines without surrounding space and without comments.
fn lines(text: &str) -> impl Iterator<Item = &str> {
    text.lines().map(str::trim).filter(|line| !line.starts_with('#'))
}

/// Reads cameras.txt: CAMERA_ID MODEL WIDTH HEIGHT PARAMS, one camera a line.
pub fn read_cameras(files: &dyn Files, file: &Path) -> Result<BTreeMap<u32, Lens>, Failure> {
    let text = read_text(files, file)?;
    let mut lenses = BTreeMap::new();
    for line in lines(&text).filter(|line| !line.is_empty()) {
        let id = line.split_whitespace().next().unwrap_or_default();
        let wrong = |problem: String| Failure::Input(format!("{}: camera {id}: {problem}", file.display()));
        let (id, lens) = camera(line).map_err(wrong)?;
        if lenses.insert(id, lens).is_some() {
            return Err(wrong(String::from("occurs twice: export the model again")));
        }
    }
    Ok(lenses)
}

fn camera(line: &str) -> Result<(u32, Lens), String> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let [id, model, width, height, params @ ..] = words.as_slice() else {
        return Err(String::from("CAMERA_ID MODEL WIDTH HEIGHT PARAMS is needed: export the model again"));
    };
    let whole = |word: &str| word.parse::<u32>().map_err(|_| format!("`{word}` is not a whole number"));
    let params: Result<Vec<f64>, _> =
        params.iter().map(|p| p.parse().map_err(|_| format!("`{p}` is not a number"))).collect();
    Ok((whole(id)?, Lens { model: (*model).to_owned(), size: [whole(width)?, whole(height)?], params: params? }))
}

/// Reads images.txt. Every image has a line IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, and COLMAP writes a line with its
/// 2D points after it, which is empty if there are none. Some programs leave that line out.
pub fn read_images(files: &dyn Files, file: &Path, notes: &mut Notes) -> Result<Vec<Image>, Failure> {
    let text = read_text(files, file)?;
    let mut images = Vec::new();
    let mut points_may_follow = false;
    for line in lines(&text) {
        if line.is_empty() {
            continue;
        }
        if points_may_follow && is_points(line) {
            points_may_follow = false;
        } else {
            images.push(image(line).ok_or_else(|| {
                let start: String = line.chars().take(80).collect();
                Failure::Input(format!(
                    "{}: `{start}` is not an image: IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME is needed: export the \
                     model again",
                    file.display()
                ))
            })?);
            points_may_follow = true;
        }
    }
    if let Some(count) = announced(&text).filter(|&count| count != images.len()) {
        notes.add(format!("{}: a comment announces {count} images, but there are {}", file.display(), images.len()));
    }
    Ok(images)
}

/// The number of images in COLMAP's comment `# Number of images: 20, mean observations per image: 0`.
fn announced(text: &str) -> Option<usize> {
    let comment = text.lines().find_map(|line| line.trim().strip_prefix("# Number of images:"))?;
    comment.split(',').next()?.trim().parse().ok()
}

/// Whether a line has 2D points: X Y POINT3D_ID for each, nothing but numbers.
fn is_points(line: &str) -> bool {
    let words: Vec<&str> = line.split_whitespace().collect();
    words.len().is_multiple_of(3) && words.iter().all(|word| word.parse::<f64>().is_ok())
}

fn image(line: &str) -> Option<Image> {
    let mut rest = line;
    let mut word = || {
        let (word, after) = rest.split_once(char::is_whitespace)?;
        rest = after.trim_start();
        Some(word)
    };
    let _: u32 = word()?.parse().ok()?;
    let mut numbers = [0.0; 7];
    for number in &mut numbers {
        *number = word()?.parse().ok()?;
    }
    let camera = word()?.parse().ok()?;
    let [w, x, y, z, tx, ty, tz] = numbers;
    // A name may contain spaces.
    (!rest.is_empty()).then(|| Image {
        name: rest.to_owned(),
        quaternion: [w, x, y, z],
        translation: [tx, ty, tz],
        camera,
    })
}
