//! §4.3: cleaning. Removes outliers from the points of a view and computes the normals of the remaining points.

use super::{depth::DepthMap, level::PyramidLevel};
use crate::{
    eigen::{LANES, Lanes, principal},
    math::max,
    point_cloud::{Point, PointCloud, Rank},
    report::Counts,
    simd::{Simd, Work},
};
use alloc::vec::Vec;
use glam::Vec3;

/// Parameters of the constraints of §4.3.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct CleanParams {
    /// Radius of a point's neighbourhood in pixels of footprint.
    pub radius_pixels: f32,
    /// Density constraint: a point is removed if its number of neighbours is less than this fraction of the average.
    /// The paper uses 1/2.
    pub density: Option<f32>,
    /// PCA constraint: a point is removed if λ3/λ1 or λ3/λ2 exceeds this, where λ1 ≥ λ2 ≥ λ3 are the eigenvalues of its
    /// neighbourhood's covariance. The paper uses 1/2.
    pub flatness: Option<f32>,
    /// Normal constraint: a point is removed if |n·c| is less than this, where c is the unit vector to the camera.
    pub facing: Option<f32>,
}

/// Standard deviation of a substituted point in pixels of footprint: that of a guide surface where stereo has failed,
/// which is smooth and mostly on the hull.
const SUBSTITUTED_SIGMA: f32 = 0.6;

/// Windows that reach at least this far, in pixels, are sampled at every second pixel.
const WIDE: usize = 4;

/// Converts a depth map to cleaned points with normals. `rank` is the kind of each pixel's point. `footprint` is the unit
/// of their standard deviations in scene units.
pub fn clean(
    level: &PyramidLevel,
    map: &DepthMap,
    rank: &[Rank],
    view: u16,
    params: &CleanParams,
    footprint: f32,
    scratch: &mut CleanScratch,
    counts: &mut Counts,
) -> PointCloud {
    let (w, h) = (level.camera.width as usize, level.camera.height as usize);
    let CleanScratch { planes, fits } = scratch;
    let points = Points::new(level, map, params, planes);
    let simd = Simd::detect();
    fits.clear();
    for y in 0..h {
        let mut x = 0;
        while let Some(first) = (x..w).find(|&x| map.depth[y * w + x] > 0.0) {
            let lanes = simd.run(FitAt { points: &points, x: first, y });
            x = first + LANES;
            for l in (0..LANES.min(w - first)).filter(|&l| map.depth[y * w + first + l] > 0.0) {
                fits.push(Fit {
                    pixel: (y * w + first + l) as u32,
                    neighbours: lanes.count[l],
                    values: lanes.values.map(|v| v[l]),
                    normal: Vec3::from_array(lanes.normal.map(|v| v[l])),
                });
            }
        }
    }
    let total: f64 = fits.iter().fold(0.0, |sum, fit| sum + f64::from(fit.neighbours));
    let fewest = params.density.unwrap_or(0.0) * (total / fits.len().max(1) as f64) as f32;
    let mut cloud = PointCloud::with_capacity(fits.len());
    for fit in fits.iter() {
        let i = fit.pixel as usize;
        if fit.neighbours < fewest.max(MIN_NEIGHBOURS) {
            counts.cleaned_density += 1;
            continue;
        }
        let [l1, l2, l3] = fit.values;
        if params.flatness.is_some_and(|flatness| l3 > flatness * l1 || l3 > flatness * l2) {
            counts.cleaned_pca += 1;
            continue;
        }
        let position = level.camera.unproject((i % w) as f32, (i / w) as f32, map.depth[i]);
        let toward = level.camera.centre - position;
        let (distance, facing) = (toward.length(), fit.normal.dot(toward.normalize_or_zero()));
        if params.facing.is_some_and(|limit| facing.abs() < limit) {
            counts.cleaned_normal += 1;
            continue;
        }
        let normal = if facing < 0.0 { -fit.normal } else { fit.normal };
        let sigma = match rank[i] {
            // A ray of depth 1 is distance / depth long.
            Rank::Detected => map.sigma[i] * (distance / map.depth[i]) * facing.abs() / footprint,
            _ => SUBSTITUTED_SIGMA,
        };
        cloud.push(Point { position, normal, fidelity: map.fidelity[i], sigma, weight: 0.0, view, rank: rank[i] });
    }
    cloud
}

/// Smallest number of points in a neighbourhood, the point itself included, that determines a normal.
const MIN_NEIGHBOURS: f32 = 4.0;

/// Buffers that are reused for all views.
#[derive(Default)]
pub struct CleanScratch {
    planes: [Vec<f32>; 4],
    fits: Vec<Fit>,
}

/// PCA of a point's neighbourhood.
struct Fit {
    pixel: u32,
    neighbours: f32,
    /// Eigenvalues of its covariance, largest first.
    values: [f32; 3],
    normal: Vec3,
}

/// [`Fit`]s of neighbouring pixels, side by side.
pub(super) struct Fits {
    pub(super) count: Lanes,
    pub(super) values: [Lanes; 3],
    pub(super) normal: [Lanes; 3],
}

/// The points of a depth map, with one plane per coordinate and a margin on all sides. Each point of a view belongs to
/// a pixel, so that all points in a ball lie in a window of pixels.
pub(super) struct Points<'a> {
    /// x, y, z, and 1 where there is a point or 0 where there is none.
    planes: &'a [Vec<f32>; 4],
    /// Row length of the planes.
    stride: usize,
    /// How far a window reaches, in pixels, and the spacing of the pixels that are read.
    reach: usize,
    step: usize,
    /// Radius of a neighbourhood per unit of depth.
    radius: f32,
    /// The camera's optical axis and its offset: the depth of a point p is axis · p + offset.
    axis: Vec3,
    offset: f32,
}

/// [`Points::fit`] at a pixel.
pub(super) struct FitAt<'a> {
    pub(super) points: &'a Points<'a>,
    pub(super) x: usize,
    pub(super) y: usize,
}

impl Work for FitAt<'_> {
    type Output = Fits;

    #[inline(always)]
    fn run(self) -> Fits {
        self.points.fit(self.x, self.y)
    }
}

impl<'a> Points<'a> {
    pub(super) fn new(
        level: &PyramidLevel,
        map: &DepthMap,
        params: &CleanParams,
        planes: &'a mut [Vec<f32>; 4],
    ) -> Self {
        let (w, h) = (level.camera.width as usize, level.camera.height as usize);
        let reach = libm::ceilf(params.radius_pixels) as usize;
        let step = if reach < WIDE { 1 } else { 2 };
        // Lanes can extend beyond the end of a row.
        let stride = w + 2 * reach + LANES;
        for plane in planes.iter_mut() {
            plane.clear();
            plane.resize(stride * (h + 2 * reach), 0.0);
        }
        for (i, &depth) in map.depth.iter().enumerate().filter(|&(_, &depth)| depth > 0.0) {
            let p = level.camera.unproject((i % w) as f32, (i / w) as f32, depth);
            let place = (i / w + reach) * stride + i % w + reach;
            for (plane, value) in planes.iter_mut().zip([p.x, p.y, p.z, 1.0]) {
                plane[place] = value;
            }
        }
        let radius = params.radius_pixels * level.camera.footprint(1.0);
        let (rows, offset) = level.camera.projection();
        Self { planes, stride, reach, step, radius, axis: rows[2], offset: offset.z }
    }

    /// PCA of the neighbourhoods of pixels (x, y) to (x + LANES - 1, y).
    #[inline(always)]
    fn fit(&self, x: usize, y: usize) -> Fits {
        let lanes = |plane: usize, row: usize, column: usize| -> &Lanes {
            self.planes[plane][row * self.stride + column..].first_chunk().expect("planes have a margin")
        };
        let centre = [0, 1, 2].map(|k| *lanes(k, y + self.reach, x + self.reach));
        let mut within: Lanes = [0.0; LANES];
        for l in 0..LANES {
            let depth = self.axis.x * centre[0][l] + self.axis.y * centre[1][l] + self.axis.z * centre[2][l];
            let radius = self.radius * (depth + self.offset);
            within[l] = radius * radius;
        }
        // If every second pixel is read and the reach is odd, start one pixel later, so that the centre is read.
        let first = self.reach % self.step;
        let (mut count, mut sum, mut products) = ([0.0; LANES], [[0.0; LANES]; 3], [[0.0; LANES]; 6]);
        for dy in (first..=2 * self.reach).step_by(self.step) {
            for dx in (first..=2 * self.reach).step_by(self.step) {
                let at = [0, 1, 2, 3].map(|k| lanes(k, y + dy, x + dx));
                for l in 0..LANES {
                    let o = [0, 1, 2].map(|k| at[k][l] - centre[k][l]);
                    let (near, there) = (o[0] * o[0] + o[1] * o[1] + o[2] * o[2] <= within[l], at[3][l]);
                    let weight = if near { there } else { 0.0 };
                    let weighted = o.map(|v| v * weight);
                    count[l] += weight;
                    for k in 0..3 {
                        sum[k][l] += weighted[k];
                    }
                    for (product, (i, j)) in products.iter_mut().zip(TRIANGLE) {
                        product[l] += weighted[i] * o[j];
                    }
                }
            }
        }
        for l in 0..LANES {
            let inverse = 1.0 / max(count[l], 1.0);
            for k in 0..3 {
                sum[k][l] *= inverse;
            }
            for (product, (i, j)) in products.iter_mut().zip(TRIANGLE) {
                product[l] = product[l] * inverse - sum[i][l] * sum[j][l];
            }
        }
        let (values, normal) = principal(products);
        Fits { count, values, normal }
    }
}

/// Rows and columns of a symmetric matrix's upper triangle.
const TRIANGLE: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
