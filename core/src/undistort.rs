//! Resamples real pictures to the camera without lens distortion, so that all later stages can use the pinhole model.

use crate::camera::Camera;
use alloc::{format, string::String, vec, vec::Vec};
use glam::DVec2;

/// Largest spacing of the map's nodes in pixels, as a power of two. With it the map takes an eighth of a byte per pixel.
const LARGEST_CELL: u32 = 3;
/// What linear interpolation between the nodes may be wrong by, in pixels. Where it is more, the nodes are closer to each
/// other. Lenses of Brown and Conrady keep the largest spacing, so that their results stay the same from version to version:
/// in ordinary pictures they are wrong by a few hundredths of a pixel at most.
const PRECISION: f64 = 1.0 / 256.0;
/// Most nodes of a map: 64 MiB. Only a strange lens in a large picture needs more.
const MOST_NODES: usize = 1 << 23;
/// Fixed-point units per pixel of source positions.
const UNITS: i32 = 256;
/// Marks ideal pixels for which the distortion model is not valid.
const FOLDED: [i32; 2] = [i32::MIN; 2];

/// Maps each ideal pixel to its position in a camera's real picture. Depends on the camera alone.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Undistortion {
    width: usize,
    height: usize,
    /// Spacing of the nodes, as a power of two.
    cell: u32,
    /// Nodes in a row.
    columns: usize,
    /// Source positions of every node in 1/256 pixel.
    nodes: Vec<[i32; 2]>,
}

impl Undistortion {
    /// The map of a camera; `None` if its lens does not distort. The error says why it cannot be made.
    pub(crate) fn new(camera: &Camera) -> Result<Option<Self>, String> {
        if !camera.lens.is_distorted() {
            return Ok(None);
        }
        let (width, height) = (camera.width as usize, camera.height as usize);
        let fold = camera.lens.fold_over(farthest(camera));
        let is_enough = |cell: &u32| camera.lens.is_brown() || is_fine_enough(camera, *cell, fold);
        let cell = (1..=LARGEST_CELL).rev().find(is_enough).unwrap_or(0);
        let side = 1 << cell;
        let (columns, rows) = (width.div_ceil(side) + 1, height.div_ceil(side) + 1);
        if columns * rows > MOST_NODES {
            return Err(format!(
                "the lens bends pictures of {width} x {height} pixels so strongly that their map would need {} MiB: check the \
                 distortion, or scale pictures and K",
                (columns * rows) >> 17
            ));
        }
        let node = |i: usize| {
            let ideal = DVec2::new((i % columns * side) as f64, (i / columns * side) as f64);
            let fixed = |v: f64| libm::round(v * f64::from(UNITS)) as i32;
            source(camera, ideal, fold).map_or(FOLDED, |source| [fixed(source.x), fixed(source.y)])
        };
        Ok(Some(Self { width, height, cell, columns, nodes: (0..columns * rows).map(node).collect() }))
    }

    /// Computes the source positions of a row of ideal pixels, which are [`FOLDED`] where there is none. Positions
    /// outside the real picture are moved to its edge, so that resampling extends the picture without a step. `known`
    /// is false for both.
    fn row(&self, y: usize, sources: &mut [[i32; 2]], known: &mut [bool]) {
        let side = 1 << self.cell;
        let limit = [(self.width as i32 - 1) * UNITS, (self.height as i32 - 1) * UNITS];
        let (above, fy) = (y / side * self.columns, (y % side) as i32);
        for (c, (cell, known)) in sources.chunks_mut(side).zip(known.chunks_mut(side)).enumerate() {
            let i = above + c;
            let corners = [i, i + 1, i + self.columns, i + self.columns + 1].map(|i| self.nodes[i]);
            if corners.contains(&FOLDED) {
                cell.fill(FOLDED);
                known.fill(false);
                continue;
            }
            let between = |a: [i32; 2], b: [i32; 2]| [0, 1].map(|k| (a[k] << self.cell) + (b[k] - a[k]) * fy);
            let (left, right) = (between(corners[0], corners[2]), between(corners[1], corners[3]));
            // Sums over the area of a cell are rounded to the nearest unit.
            let half = (1 << (2 * self.cell)) >> 1;
            for x in 0..cell.len() {
                let at =
                    |k: usize| ((left[k] << self.cell) + (right[k] - left[k]) * x as i32 + half) >> (2 * self.cell);
                let position = [at(0), at(1)];
                cell[x] = [0, 1].map(|k| position[k].clamp(0, limit[k]));
                known[x] = cell[x] == position;
            }
        }
    }

    /// Resamples packed RGB with the Catmull-Rom kernel, which preserves fine texture. `out` is overwritten.
    pub(crate) fn rgb(&self, picture: &[u8], out: &mut Vec<u8>) {
        let kernel: Vec<[i32; 4]> = (0..UNITS).map(catmull_rom).collect();
        let (w, h) = (self.width, self.height);
        let (mut sources, mut known) = (vec![FOLDED; w], vec![false; w]);
        out.clear();
        out.resize(w * h * 3, 0);
        for (y, line) in out.chunks_exact_mut(w * 3).enumerate() {
            self.row(y, &mut sources, &mut known);
            for (pixel, &source) in line.chunks_exact_mut(3).zip(&sources) {
                if source == FOLDED {
                    continue;
                }
                let (x, y) = ((source[0] / UNITS) as usize, (source[1] / UNITS) as usize);
                let across = &kernel[(source[0] % UNITS) as usize];
                let down = &kernel[(source[1] % UNITS) as usize];
                // The kernel covers 4 x 4 pixels. At the picture's edge the outermost pixels are repeated.
                let mut columns = [0i32; 12];
                let inner = x >= 1 && x + 2 < w;
                for k in 0..4 {
                    let row = (y + k).saturating_sub(1).min(h - 1) * w;
                    if inner {
                        let window = &picture[(row + x - 1) * 3..][..12];
                        for (sum, &v) in columns.iter_mut().zip(window) {
                            *sum += i32::from(v) * down[k];
                        }
                    } else {
                        for i in 0..12 {
                            let column = (x + i / 3).saturating_sub(1).min(w - 1);
                            columns[i] += i32::from(picture[(row + column) * 3 + i % 3]) * down[k];
                        }
                    }
                }
                for c in 0..3 {
                    let sum: i32 = (0..4).map(|k| columns[3 * k + c] * across[k]).sum();
                    pixel[c] = ((sum + (1 << 19)) >> 20).clamp(0, 255) as u8;
                }
            }
        }
    }

    /// Resamples a mask's coverage bilinearly. `known` is true for pixels with a source. `out` and `known` are
    /// overwritten.
    pub(crate) fn coverage(&self, mask: &[u8], out: &mut Vec<u8>, known: &mut Vec<bool>) {
        let (w, h) = (self.width, self.height);
        let mut sources = vec![FOLDED; w];
        out.clear();
        out.reserve(w * h);
        known.clear();
        known.resize(w * h, false);
        for (y, known) in known.chunks_exact_mut(w).enumerate() {
            self.row(y, &mut sources, known);
            for &source in &sources {
                if source == FOLDED {
                    out.push(0);
                    continue;
                }
                let [x, y] = source.map(|v| (v / UNITS) as usize);
                let [fx, fy] = source.map(|v| (v % UNITS) as u32);
                let (x1, y1) = ((x + 1).min(w - 1), (y + 1).min(h - 1));
                let lerp = |y: usize| u32::from(mask[y * w + x]) * (256 - fx) + u32::from(mask[y * w + x1]) * fx;
                out.push(((lerp(y) * (256 - fy) + lerp(y1) * fy + (1 << 15)) >> 16) as u8);
            }
        }
    }
}

/// The largest squared radius of an ideal picture, in normalised coordinates.
fn farthest(camera: &Camera) -> f64 {
    let (w, h) = (f64::from(camera.width), f64::from(camera.height));
    let corners = [(0.0, 0.0), (w, 0.0), (0.0, h), (w, h)];
    corners.into_iter().map(|(x, y)| camera.normalise(DVec2::new(x, y)).length_squared()).fold(0.0, f64::max)
}

/// The position in the real picture of an ideal pixel, unless it lies beyond the fold, whose squared radius is given.
fn source(camera: &Camera, ideal: DVec2, fold: f64) -> Option<DVec2> {
    let source = camera.distort_pixel(ideal);
    // Beyond the fold the model leads back into the picture. Positions far outside have no source in any case.
    let far = (source - ideal).abs().max_element() > f64::from(camera.width) + f64::from(camera.height);
    (!far && camera.normalise(ideal).length_squared() < fold).then_some(source)
}

/// Whether linear interpolation in cells of this size, a power of two, is precise enough inside the real picture.
fn is_fine_enough(camera: &Camera, cell: u32, fold: f64) -> bool {
    let side = 1 << cell;
    let size = DVec2::new(f64::from(camera.width), f64::from(camera.height));
    let is_fine = |x: usize, y: usize| {
        let at = |dx: usize, dy: usize| source(camera, DVec2::new((x + dx) as f64, (y + dy) as f64), fold);
        let corners = [at(0, 0), at(side, 0), at(0, side), at(side, side)];
        // The interpolation of a smooth function is worst in the middle of a cell.
        let (Some(middle), [Some(a), Some(b), Some(c), Some(d)]) = (at(side / 2, side / 2), corners) else {
            return true;
        };
        let outside = middle.cmplt(DVec2::ZERO).any() || middle.cmpgt(size).any();
        outside || (middle - (a + b + c + d) / 4.0).abs().max_element() <= PRECISION
    };
    let (width, height) = (camera.width as usize, camera.height as usize);
    (0..height).step_by(side).all(|y| (0..width).step_by(side).all(|x| is_fine(x, y)))
}

/// The four weights of the Catmull-Rom spline (Catmull & Rom, A Class of Local Interpolating Splines, 1974) at a
/// fraction in 1/256, in units of 1/1024. They sum to one exactly. Fixed point is exact for whole pictures; the sampler
/// of colours (`colour/candidate.rs`) has its own kernel because it blends with bilinear weights at continuous
/// positions.
fn catmull_rom(fraction: i32) -> [i32; 4] {
    let t = fraction;
    // Cubics in t / 256, over 2 · 256³. Halves are rounded up, and the weight of pixel 1 absorbs the rounding errors.
    let scale = |v: i64| ((v + (1 << 14)) >> 15) as i32;
    let (t1, t2, t3) = (i64::from(t) << 16, i64::from(t * t) << 8, i64::from(t) * i64::from(t * t));
    let mut w = [scale(2 * t2 - t3 - t1), 0, scale(t1 + 4 * t2 - 3 * t3), scale(t3 - t2)];
    w[1] = 1024 - w[0] - w[2] - w[3];
    w
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lens::Lens;

    fn camera(distortion: [f64; 5]) -> Camera {
        Camera {
            width: 320,
            height: 240,
            k: [[300.0, 0.0, 163.0], [0.0, 301.0, 117.5], [0.0, 0.0, 1.0]],
            lens: Lens::brown(distortion),
            r: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            t: [0.0; 3],
        }
    }

    /// Ideal pixel of a real one by fixed-point iteration, independent of the map.
    fn ideal(camera: &Camera, real: DVec2) -> DVec2 {
        (0..60).fold(real, |guess, _| guess + (real - camera.distort_pixel(guess)) * 0.7)
    }

    /// Resampled coverage of a mask that is white everywhere, and which pixels are known.
    fn coverage(map: &Undistortion) -> (Vec<u8>, Vec<bool>) {
        let (mut out, mut known) = (Vec::new(), Vec::new());
        map.coverage(&vec![255; map.width * map.height], &mut out, &mut known);
        (out, known)
    }

    fn pattern(p: DVec2) -> [u8; 3] {
        let wave = |x: f64| libm::round(127.5 + 100.0 * libm::sin(x)) as u8;
        [wave(p.x * 0.3), wave(p.y * 0.25), wave((p.x + p.y) * 0.2)]
    }

    #[test]
    fn picture_of_ideal_coordinates_comes_back() {
        for distortion in [[-0.25, 0.08, 0.002, -0.001, 0.0], [0.15, 0.05, 0.0, 0.001, 0.0]] {
            let camera = camera(distortion);
            let (w, h) = (camera.width as usize, camera.height as usize);
            let real: Vec<u8> =
                (0..w * h).flat_map(|i| pattern(ideal(&camera, DVec2::new((i % w) as f64, (i / w) as f64)))).collect();
            let map = Undistortion::new(&camera).expect("the map is small").unwrap();
            let mut rgb = Vec::new();
            map.rgb(&real, &mut rgb);
            let (_, known) = coverage(&map);
            let mut squares = 0.0;
            let (mut worst, mut count) = (0, 0);
            for i in (0..w * h).filter(|&i| known[i]) {
                let truth = pattern(DVec2::new((i % w) as f64, (i / w) as f64));
                for c in 0..3 {
                    let error = i32::from(rgb[3 * i + c]) - i32::from(truth[c]);
                    worst = worst.max(error.abs());
                    squares += f64::from(error * error);
                    count += 1;
                }
            }
            assert!(count > w * h * 2, "most of the picture is known");
            // A hundredth of a pixel is 0.3 levels here.
            assert!(worst <= 6 && squares / f64::from(count as u32) < 1.0, "{worst} {}", squares / count as f64);
        }
    }

    #[test]
    fn positions_of_other_lenses_than_browns_are_exact_to_a_hundredth_of_a_pixel() {
        let lenses = [
            Lens::OpenCv([0.52, -2.6, 4e-4, -2e-4, 1.45, 0.39, -2.4, 1.38, 0.0, 0.0, 0.0, 0.0]),
            Lens::OpenCv([-0.1, 0.03, 0.002, 0.001, -0.004, 0.05, -0.02, 0.003, 0.004, -0.002, -0.003, 0.001]),
            Lens::Fisheye([-0.03, 0.02, -0.03, 0.017]),
        ];
        // Up to 61 degrees from the axis, where a cell of eight pixels is too coarse, and up to 22 degrees.
        for (focal, lens) in [110.0, 500.0].into_iter().flat_map(|focal| lenses.map(|lens| (focal, lens))) {
            let mut camera = camera([0.0; 5]);
            camera.lens = lens;
            (camera.k[0][0], camera.k[1][1]) = (focal, focal + 1.0);
            let map = Undistortion::new(&camera).expect("the map is small").unwrap();
            let (mut sources, mut known) = (vec![FOLDED; map.width], vec![false; map.width]);
            let mut count = 0;
            for y in 0..map.height {
                map.row(y, &mut sources, &mut known);
                for x in (0..map.width).filter(|&x| known[x]) {
                    let exact = camera.distort_pixel(DVec2::new(x as f64, y as f64));
                    let found = DVec2::new(f64::from(sources[x][0]), f64::from(sources[x][1])) / f64::from(UNITS);
                    assert!((found - exact).abs().max_element() < 0.01, "{lens:?} at {x} {y}: {found} for {exact}");
                    count += 1;
                }
            }
            assert!(count > map.width * map.height / 2, "{count} of {lens:?}, focal length {focal}");
        }
    }

    #[test]
    fn fold_over_is_unknown_and_never_wraps() {
        // r (1 - 0.6 r²) turns back at r = 0.745: the picture's corners lie beyond it at this wide angle.
        let mut camera = camera([-0.6, 0.0, 0.0, 0.0, 0.0]);
        camera.k[0][0] = 200.0;
        camera.k[1][1] = 200.0;
        let map = Undistortion::new(&camera).expect("the map is small").unwrap();
        let (w, h) = (camera.width as usize, camera.height as usize);
        let (_, known) = coverage(&map);
        let mut unknown = 0;
        for i in 0..w * h {
            let ideal = DVec2::new((i % w) as f64, (i / w) as f64);
            let folds = 3.0 * 0.6 * camera.normalise(ideal).length_squared() >= 1.0;
            assert!(!(folds && known[i]), "{ideal}");
            unknown += usize::from(!known[i]);
        }
        assert!(unknown > 0 && unknown < w * h / 2, "{unknown}");
    }

    #[test]
    fn pixels_without_source_are_unknown() {
        // With k1 > 0 the ideal picture reaches beyond the real one.
        let camera = camera([0.3, 0.0, 0.0, 0.0, 0.0]);
        let (w, h) = (camera.width as usize, camera.height as usize);
        let (coverage, known) = coverage(&Undistortion::new(&camera).expect("the map is small").unwrap());
        for i in 0..w * h {
            let source = camera.distort_pixel(DVec2::new((i % w) as f64, (i / w) as f64));
            let margin = source.x.min(w as f64 - 1.0 - source.x).min(source.y).min(h as f64 - 1.0 - source.y);
            if margin.abs() > 0.05 {
                assert_eq!(known[i], margin > 0.0);
            }
            assert_eq!(coverage[i], 255, "the edge is extended");
        }
    }

    #[test]
    fn camera_without_distortion_has_no_map() {
        assert_eq!(Undistortion::new(&camera([0.0; 5])), Ok(None));
    }
}
