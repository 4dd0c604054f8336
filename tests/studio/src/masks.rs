//! What keyers and hands do to masks: jagged edges, holes, specks, missing limbs. Masks are stored by rows, 255 on the
//! subject.

use crate::{contour::Contour, noise::Random};
use core::ops::Range;

/// Discs of a wrong value in a mask.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Spots {
    /// Number of discs per mask.
    pub count: u32,
    /// Diameter in pixels.
    pub diameter: f64,
}

/// Makes a whole square cell white if the subject touches one of its pixels, so that masks are 0 to `size` pixels too
/// wide.
pub fn coarse(mask: &[u8], width: u32, height: u32, size: u32) -> Vec<u8> {
    let cell = size + 1;
    let columns = width.div_ceil(cell);
    let at = |x: u32, y: u32| (y / cell * columns + x / cell) as usize;
    let mut cells = vec![0; (columns * height.div_ceil(cell)) as usize];
    let pixels = || (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    for ((x, y), &v) in pixels().zip(mask) {
        cells[at(x, y)] = v.max(cells[at(x, y)]);
    }
    pixels().map(|(x, y)| cells[at(x, y)]).collect()
}

/// Clears discs around random pixels of the subject.
pub fn punch_holes(mask: &mut [u8], width: u32, holes: Spots, random: &mut Random) {
    let subject: Vec<usize> = (0..mask.len()).filter(|&i| mask[i] > 127).collect();
    paint(mask, width, holes, 0, &subject, random);
}

/// Whitens discs around random pixels of the background that are farther than the diameter from the subject, so that the
/// discs do not touch it.
pub fn add_specks(mask: &mut [u8], width: u32, specks: Spots, random: &mut Random) {
    let coverage: Vec<f64> = mask.iter().map(|v| f64::from(*v) / 255.0).collect();
    let distances = Contour::new(&coverage, width, mask.len() as u32 / width).distances(specks.diameter + 1.0);
    let free: Vec<usize> = (0..mask.len()).filter(|&i| distances[i] < -specks.diameter).collect();
    paint(mask, width, specks, 255, &free, random);
}

/// Gives discs a value. Their centres are chosen from those given; without any, nothing changes.
fn paint(mask: &mut [u8], width: u32, spots: Spots, value: u8, centres: &[usize], random: &mut Random) {
    let width = width as usize;
    let radius = 0.5 * spots.diameter;
    for _ in 0..spots.count {
        let Some(&centre) = centres.get((random.uniform() * centres.len() as f64) as usize) else { return };
        for (i, v) in mask.iter_mut().enumerate() {
            let (dx, dy) = ((i % width).abs_diff(centre % width) as f64, (i / width).abs_diff(centre / width) as f64);
            if dx * dx + dy * dy <= radius * radius {
                *v = value;
            }
        }
    }
}

/// Clears some columns of the subject's bounding box, given as shares (0..=1) of its width from the left: the mask lacks a
/// limb, or more. A mask without a subject stays.
pub fn clear_columns(mask: &mut [u8], width: u32, columns: Range<f64>) {
    let width = width as usize;
    let on_subject = || mask.iter().enumerate().filter(|(_, v)| **v > 127).map(|(i, _)| i % width);
    let (Some(low), Some(high)) = (on_subject().min(), on_subject().max()) else { return };
    let at = |share: f64| low + (share * (high - low + 1) as f64) as usize;
    let cleared = at(columns.start)..at(columns.end);
    mask.iter_mut().enumerate().filter(|(i, _)| cleared.contains(&(i % width))).for_each(|(_, v)| *v = 0);
}
