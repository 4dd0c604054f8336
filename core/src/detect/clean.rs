//! §4.3: removes what cannot be surface from a view's points, and gives the rest their normals.

use super::{depth::DepthMap, level::Level};
use crate::{
    eigen::principal,
    point_cloud::{Point, PointCloud, Rank},
    report::Counts,
};
use alloc::{vec, vec::Vec};
use glam::Vec3;

/// The constraints of §4.3.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct CleanParams {
    /// Radius of a point's neighbourhood in pixels of footprint.
    pub radius_pixels: f32,
    /// A point goes if it has fewer than this share of the average number of neighbours; 0 switches it off.
    pub density: f32,
    /// A point goes if λ3/λ1 or λ3/λ2 of its neighbourhood's covariance is larger; 1 switches it off.
    pub flatness: f32,
    /// A point goes if |n·c| is smaller, c the direction to the camera; 0 switches it off.
    pub facing: f32,
}

/// Windows of at least this reach in pixels are sampled more sparsely.
const WIDE: usize = 4;

/// A view's points with normals: what is left of a depth map. `rank` tells per pixel how its depth came about.
pub fn clean(
    level: &Level,
    map: &DepthMap,
    rank: &[Rank],
    view: u16,
    params: &CleanParams,
    counts: &mut Counts,
) -> PointCloud {
    let (w, h) = (level.camera.width as usize, level.camera.height as usize);
    let positions: Vec<Vec3> =
        (0..w * h).map(|i| level.camera.unproject((i % w) as f32, (i / w) as f32, map.depth[i])).collect();
    // Points of one view lie on a pixel each, so a ball's points are within a window of pixels.
    let reach = libm::ceilf(params.radius_pixels) as usize;
    // A wide window is read at every second pixel.
    let stride = if reach < WIDE { 1 } else { 2 };
    let window = |v: usize, n: usize| (v - (v.min(reach) / stride) * stride..(v + reach + 1).min(n)).step_by(stride);
    let mut fits: Vec<Option<([f32; 3], Vec3)>> = vec![None; w * h];
    let mut neighbours = vec![0u16; w * h];
    let (mut total, mut points) = (0u64, 0u64);
    for y in 0..h {
        for x in 0..w {
            let i = y * w + x;
            if map.depth[i] <= 0.0 {
                continue;
            }
            let radius = params.radius_pixels * level.camera.footprint(map.depth[i]);
            let mut moments = Moments::default();
            for ny in window(y, h) {
                for nx in window(x, w) {
                    let j = ny * w + nx;
                    let offset = positions[j] - positions[i];
                    if map.depth[j] > 0.0 && offset.length_squared() <= radius * radius {
                        moments.add(offset);
                    }
                }
            }
            neighbours[i] = moments.count as u16;
            fits[i] = moments.fit();
            total += u64::from(neighbours[i]);
            points += 1;
        }
    }
    let fewest = params.density * total as f32 / points.max(1) as f32;
    let mut cloud = PointCloud::new();
    for i in 0..w * h {
        if map.depth[i] <= 0.0 {
            continue;
        }
        if f32::from(neighbours[i]) < fewest {
            counts.cleaned_density += 1;
            continue;
        }
        let Some(([l1, l2, l3], normal)) = fits[i] else {
            counts.cleaned_density += 1;
            continue;
        };
        if l3 > params.flatness * l1 || l3 > params.flatness * l2 {
            counts.cleaned_pca += 1;
            continue;
        }
        let toward = (level.camera.centre - positions[i]).normalize_or_zero();
        let facing = normal.dot(toward);
        if facing.abs() < params.facing {
            counts.cleaned_normal += 1;
            continue;
        }
        let normal = if facing < 0.0 { -normal } else { normal };
        let fidelity = map.fidelity[i];
        cloud.push(Point { position: positions[i], normal, fidelity, weight: fidelity.max(0.0), view, rank: rank[i] });
    }
    cloud
}

/// Sums over a neighbourhood, relative to its centre point.
#[derive(Default)]
struct Moments {
    count: u32,
    sum: Vec3,
    products: [f32; 6],
}

impl Moments {
    #[inline]
    fn add(&mut self, o: Vec3) {
        self.count += 1;
        self.sum += o;
        for (p, v) in self.products.iter_mut().zip([o.x * o.x, o.x * o.y, o.x * o.z, o.y * o.y, o.y * o.z, o.z * o.z]) {
            *p += v;
        }
    }

    /// Eigenvalues of the covariance and the normal; none of fewer than four points.
    fn fit(&self) -> Option<([f32; 3], Vec3)> {
        if self.count < 4 {
            return None;
        }
        let n = self.count as f32;
        let m = self.sum / n;
        let [xx, xy, xz, yy, yz, zz] = self.products.map(|p| p / n);
        Some(principal([
            xx - m.x * m.x,
            xy - m.x * m.y,
            xz - m.x * m.z,
            yy - m.y * m.y,
            yz - m.y * m.z,
            zz - m.z * m.z,
        ]))
    }
}
