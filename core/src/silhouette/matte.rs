//! From hard labels to soft coverage: what chroma key and clean plate share.

use super::colour::vector;
use alloc::{vec, vec::Vec};
use glam::Vec3;

/// Pixels this near to the labels' border may be mixed of object and background.
const BAND: u8 = 3;
/// Half size of the window in which a mixed pixel finds pure colours.
const WINDOW: usize = 5;

/// Gives connected parts of fewer than `smallest` pixels the other label: specks of object (8-connected) or holes of
/// background (4-connected, so that diagonal gaps do not join them).
pub(super) fn remove_small(width: usize, height: usize, object: &mut [bool], label: bool, smallest: usize) {
    let mut visited = vec![false; width * height];
    let mut part: Vec<u32> = Vec::new();
    for start in 0..width * height {
        if visited[start] || object[start] != label {
            continue;
        }
        part.clear();
        part.push(start as u32);
        visited[start] = true;
        let mut next = 0;
        while next < part.len() {
            let (x, y) = (part[next] as usize % width, part[next] as usize / width);
            next += 1;
            for ny in y.saturating_sub(1)..(y + 2).min(height) {
                for nx in x.saturating_sub(1)..(x + 2).min(width) {
                    let j = ny * width + nx;
                    if !visited[j] && object[j] == label && (label || nx == x || ny == y) {
                        visited[j] = true;
                        part.push(j as u32);
                    }
                }
            }
        }
        if part.len() < smallest {
            part.iter().for_each(|&i| object[i as usize] = !label);
        }
    }
}

/// Coverage from labels. Near their border a pixel is a mixture α F + (1 - α) B of the colours that object and
/// background have next to it; that α finds the contour to a fraction of a pixel whatever the labels' bias, in
/// shadows as well, because B is local.
pub(super) fn soften(width: usize, height: usize, rgb: &[u8], object: &[bool]) -> Vec<u8> {
    let depth = depths(width, height, object);
    let coverage = |i: usize| {
        let label = if object[i] { 255 } else { 0 };
        if depth[i] > BAND {
            return label;
        }
        let (x, y) = (i % width, i / width);
        // Sums of colours and weights of background and object; deep pixels are pure, those at the border are not.
        let mut sums = [(Vec3::ZERO, 0.0f32); 2];
        for ny in y.saturating_sub(WINDOW)..(y + WINDOW + 1).min(height) {
            for nx in x.saturating_sub(WINDOW)..(x + WINDOW + 1).min(width) {
                let j = ny * width + nx;
                let purity = [0.0, 1.0, 32.0, 1024.0, 1024.0][depth[j] as usize];
                let (sum, weight) = &mut sums[usize::from(object[j])];
                *sum += vector(&rgb[3 * j..]) * purity;
                *weight += purity;
            }
        }
        let [(b, wb), (f, wf)] = sums;
        if wb == 0.0 || wf == 0.0 {
            return label;
        }
        let (b, f) = (b / wb, f / wf);
        let contrast = (f - b).length_squared();
        // Colours within noise of each other say nothing.
        if contrast < 100.0 {
            return label;
        }
        let alpha = (vector(&rgb[3 * i..]) - b).dot(f - b) / contrast;
        libm::roundf(alpha.clamp(0.0, 1.0) * 255.0) as u8
    };
    (0..width * height).map(coverage).collect()
}

/// Chessboard distance of every pixel to the nearest of the other label, at most [`BAND`] + 1.
fn depths(width: usize, height: usize, object: &[bool]) -> Vec<u8> {
    let mut depth = vec![BAND + 1; width * height];
    let mut offer = |i: usize, x: usize, rows: [usize; 2]| {
        for ny in rows {
            for nx in x.saturating_sub(1)..(x + 2).min(width) {
                let j = ny * width + nx;
                let through = if object[j] == object[i] { depth[j] + 1 } else { 1 };
                depth[i] = depth[i].min(through);
            }
        }
    };
    for y in 0..height {
        for x in 0..width {
            offer(y * width + x, x, [y.saturating_sub(1), y]);
        }
    }
    for y in (0..height).rev() {
        for x in (0..width).rev() {
            offer(y * width + x, x, [y, (y + 1).min(height - 1)]);
        }
    }
    depth
}
