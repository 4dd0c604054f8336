//! Closes gaps of a mesh in front of which silhouettes show the object.
//!
//! Poisson reconstruction (§6.1) loses sheets that are thinner than its voxels, such as the hem of a skirt: the points of
//! both sides cancel each other. Where stereo matches wrongly, it may lose a whole part that protrudes. The ray of a pixel that
//! lies well inside a silhouette must meet the object, so that such places are known. A gap that the mesh surrounds is filled
//! at the depth of the mesh around it, so thick that voxels hold it. One that it does not surround is a lost part, for which
//! the hull is taken.

use crate::{
    camera::Pinhole,
    detect::PyramidLevel,
    error::Result,
    executor::Executor,
    math::max,
    point_cloud::{Mesh, Point, PointCloud, Rank},
    progress::{self, Progress},
    raster::Raster,
    silhouette::{Connected, Parts, Silhouette},
    stage::Stage,
    view::View,
};
use alloc::{vec, vec::Vec};

/// Which gaps are filled.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct GapParams {
    /// Gaps with fewer pixels are left, in pixels of the resolution that is searched.
    pub smallest_pixels: u32,
    /// A gap must have a pixel that is at least this far inside the silhouette, in the same pixels. Others are a seam along the
    /// contour, which the mesh may miss because the contour is not exact.
    pub inside_pixels: u32,
}

/// Weight of the points that fill gaps (eq. 3): they must outweigh the points of both sides, which cancel each other.
const WEIGHT: f32 = 20.0;
/// Standard deviation of these points in pixels of footprint.
const SIGMA: f32 = 1.0;
/// The mesh surrounds a gap if the square of the length of their common rim is at least this many times the gap's pixels. A
/// square has 4 with the mesh on two of its sides, and 9 on three.
const SURROUNDED: u64 = 5;

/// The pixels in which each view has points, row after row: there its silhouette shows the object, and the ray meets the hull.
/// Empty for views without a silhouette, which do not tell where the object is.
pub(super) fn pixels_with_points(
    views: &[View],
    clouds: &[PointCloud],
    cameras: &[Pinhole],
    executor: &dyn Executor,
) -> Vec<Vec<bool>> {
    executor.map(views.len(), |view| {
        if views[view].shown().is_none() {
            return Vec::new();
        }
        let camera = &cameras[view];
        let mut pixels = vec![false; camera.width as usize * camera.height as usize];
        clouds[view]
            .iter()
            .filter_map(|point| camera.pixel(point.position))
            .for_each(|(pixel, _)| pixels[pixel] = true);
        pixels
    })
}

/// Points that fill the gaps of a mesh. `pixels` are those of each view in which there must be a surface
/// ([`pixels_with_points`]). For gaps that the mesh surrounds, the points lie `thickness` scene units before the missing surface,
/// as seen from their view, so that views on both sides make a sheet of twice this thickness. For others, they are the vertices
/// of the hull that the view sees there, and those behind.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub(super) fn filling(
    mut pixels: Vec<Vec<bool>>,
    levels: &[PyramidLevel],
    mesh: &Mesh,
    hull: &Mesh,
    params: &GapParams,
    thickness: f32,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<PointCloud> {
    let count = levels.len() as u32;
    let parts = pixels.iter_mut().zip(levels);
    let found = executor.map_parts_with(&mut Vec::new(), parts, |raster: &mut Raster, view, (pixels, level)| {
        progress::step(progress, Stage::Detect, view as u32, count)?;
        if !pixels.contains(&true) {
            return Ok(PointCloud::new());
        }
        raster.render(mesh, &level.camera);
        let surrounded = keep_gaps(pixels, level, raster, params);
        let filled = fill(&surrounded, raster);
        let point = |pixel: usize| {
            let (x, y) = (pixel % raster.width, pixel / raster.width);
            let depth = 1.0 / raster.inverse[pixel] - thickness;
            let position = level.camera.unproject(x as f32, y as f32, depth);
            let normal = (level.camera.centre - position).normalize_or_zero();
            let (view, rank) = (view as u16, Rank::Substituted);
            Point { position, normal, fidelity: 0.0, sigma: SIGMA, weight: WEIGHT, view, rank }
        };
        Ok(filled.into_iter().map(point).collect())
    });
    let mut all = PointCloud::new();
    for cloud in found {
        all.append(&mut cloud?);
    }
    add_hull(&pixels, levels, hull, &mut all);
    Ok(all)
}

/// Keeps the pixels of those gaps that the hull is to fill. Returns the pixels of gaps that the mesh surrounds.
fn keep_gaps(pixels: &mut [bool], level: &PyramidLevel, raster: &Raster, params: &GapParams) -> Vec<bool> {
    let (w, h) = (raster.width, raster.height);
    pixels.iter_mut().zip(&raster.inverse).for_each(|(pixel, &inverse)| *pixel &= inverse == 0.0);
    let parts = Parts::of_side(w, h, pixels, true, Connected::Sides);
    let deep = params.inside_pixels as f32 * Silhouette::UNITS;
    let mut is_deep = vec![false; parts.list.len()];
    // The sides of each gap's pixels beyond which there is the mesh.
    let mut rim = vec![0u64; parts.list.len()];
    for (i, &inside) in level.inside.iter().enumerate() {
        if let Some(part) = parts.of(i) {
            is_deep[part] |= f32::from(inside) >= deep;
            rim[part] += around(i, w, h).filter(|&j| raster.inverse[j] > 0.0).count() as u64;
        }
    }
    let is_gap = |part: usize| is_deep[part] && parts.list[part].pixels >= params.smallest_pixels;
    let is_surrounded = |part: usize| rim[part] * rim[part] >= SURROUNDED * u64::from(parts.list[part].pixels);
    let gap = |i: usize| parts.of(i).filter(|&part| is_gap(part));
    let surrounded = (0..pixels.len()).map(|i| gap(i).is_some_and(is_surrounded)).collect();
    pixels.iter_mut().enumerate().for_each(|(i, pixel)| *pixel = gap(i).is_some_and(|part| !is_surrounded(part)));
    surrounded
}

/// The pixels beside a pixel of a picture of `w` x `h`.
fn around(i: usize, w: usize, h: usize) -> impl Iterator<Item = usize> {
    let (x, y) = (i % w, i / w);
    let near = [(x > 0, i.wrapping_sub(1)), (x + 1 < w, i + 1), (y > 0, i.wrapping_sub(w)), (y + 1 < h, i + w)];
    near.into_iter().filter(|&(within, _)| within).map(|(_, j)| j)
}

/// Adds the vertices of the hull on the rays of each view's pixels, with the first view that has one there.
fn add_hull(pixels: &[Vec<bool>], levels: &[PyramidLevel], hull: &Mesh, points: &mut PointCloud) {
    let is_open = |view: &usize| pixels[*view].contains(&true);
    let open: Vec<usize> = (0..pixels.len()).filter(is_open).collect();
    if open.is_empty() {
        return;
    }
    for (&position, &normal) in hull.positions.iter().zip(&hull.normals) {
        let shows = |view: &usize| levels[*view].camera.pixel(position).is_some_and(|(pixel, _)| pixels[*view][pixel]);
        if let Some(&view) = open.iter().find(|view| shows(view)) {
            let (view, rank) = (view as u16, Rank::Substituted);
            points.push(Point { position, normal, fidelity: 0.0, sigma: SIGMA, weight: WEIGHT, view, rank });
        }
    }
}

/// Continues the depths around gaps into them, from the rim inwards. Where several surfaces meet a gap, the nearest is
/// continued. Returns the pixels that now have a depth; a gap without a rim is left.
fn fill(pixels: &[bool], raster: &mut Raster) -> Vec<usize> {
    let (w, h) = (raster.width, raster.height);
    let mut filled = Vec::new();
    let mut next: Vec<usize> = (0..pixels.len()).filter(|&i| pixels[i]).collect();
    loop {
        let nearest = |i: usize| around(i, w, h).map(|j| raster.inverse[j]).fold(0.0, max);
        let ring: Vec<(usize, f32)> =
            next.iter().map(|&i| (i, nearest(i))).filter(|&(_, inverse)| inverse > 0.0).collect();
        if ring.is_empty() {
            return filled;
        }
        let first = filled.len();
        for (i, inverse) in ring {
            // A pixel may be next to several of the ring before.
            if raster.inverse[i] == 0.0 {
                raster.inverse[i] = inverse;
                filled.push(i);
            }
        }
        let open = |&j: &usize| pixels[j] && raster.inverse[j] == 0.0;
        next = filled[first..].iter().flat_map(|&i| around(i, w, h)).filter(open).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{executor::Serial, progress::Silent, testing::pinhole};
    use glam::Vec3;

    const SIZE: u32 = 40;

    /// A wall of triangles in the plane z = 0, from -1 to 1, with a square hole of half width `hole` in its middle.
    fn wall(hole: f32) -> Mesh {
        let steps = [-1.0, -hole, hole, 1.0];
        let positions = steps.iter().flat_map(|&y| steps.iter().map(move |&x| Vec3::new(x, y, 0.0))).collect();
        let mut mesh = Mesh { positions, ..Mesh::default() };
        for (x, y) in (0..3).flat_map(|y| (0..3).map(move |x| (x, y))).filter(|&cell| cell != (1, 1)) {
            let first = 4 * y + x;
            mesh.triangles.push([first, first + 1, first + 5]);
            mesh.triangles.push([first, first + 5, first + 4]);
        }
        mesh
    }

    /// Vertices of a hull: two sheets, at z = -0.2 and z = 0.2.
    fn hull() -> Mesh {
        let at = |i: i32| i as f32 / 10.0;
        let sheet = |z: f32| (-10..=10).flat_map(move |y| (-10..=10).map(move |x| Vec3::new(at(x), at(y), z)));
        let positions: Vec<Vec3> = [-0.2, 0.2].into_iter().flat_map(sheet).collect();
        let normals = positions.iter().map(|p| Vec3::Z * p.z.signum()).collect();
        Mesh { positions, normals, ..Mesh::default() }
    }

    /// The points that fill the hole of a wall, as a camera before it sees them whose silhouette is `inside` pixels wide
    /// around each pixel.
    fn filled(hole: f32, inside: i16, thickness: f32) -> PointCloud {
        filled_in(&wall(hole), inside, thickness)
    }

    /// The same for any mesh.
    fn filled_in(mesh: &Mesh, inside: i16, thickness: f32) -> PointCloud {
        let camera = pinhole(Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, SIZE, 80.0);
        let pixels = (SIZE * SIZE) as usize;
        let inside = vec![inside * Silhouette::UNITS as i16; pixels];
        let level = PyramidLevel { camera, luma: vec![0; pixels].into(), inside: inside.into() };
        let params = GapParams { smallest_pixels: 20, inside_pixels: 4 };
        // The hull covers the middle half of the picture.
        let middle = SIZE / 4..3 * SIZE / 4;
        let shown = (0..SIZE * SIZE).map(|i| middle.contains(&(i % SIZE)) && middle.contains(&(i / SIZE))).collect();
        filling(vec![shown], &[level], mesh, &hull(), &params, thickness, &Serial, &Silent).expect("nothing cancels")
    }

    #[test]
    fn a_hole_is_filled_at_the_depth_around_it() {
        let cloud = filled(0.25, 9, 0.1);
        // The hole is 0.5 wide, and a pixel 4 / 80.
        assert!((81..=121).contains(&cloud.len()), "{} pixels", cloud.len());
        for point in &cloud {
            assert!((point.position.z - 0.1).abs() < 1e-4, "{}: as thick as asked, before the wall", point.position);
            assert!(point.position.truncate().abs().max_element() < 0.3, "{}: inside the hole", point.position);
            assert!(point.normal.z > 0.9, "{}: toward the camera", point.normal);
        }
    }

    #[test]
    fn a_part_that_protrudes_is_taken_from_the_hull() {
        // Of the wall, only what lies left of x = -0.25 is left.
        let mut half = wall(0.25);
        half.triangles.retain(|t| t.iter().all(|&vertex| half.positions[vertex as usize].x < 0.0));
        let cloud = filled_in(&half, 9, 0.1);
        let [before, behind] = [0.2, -0.2].map(|z| cloud.iter().filter(|p| p.position.z == z).count());
        assert!(before > 40 && behind > 40 && before + behind == cloud.len(), "{before} before, {behind} behind");
        for point in &cloud {
            assert!(point.position.x > -0.3, "{}: where the wall is missing", point.position);
            assert!(point.normal.z * point.position.z > 0.0, "{}: outwards", point.normal);
        }
    }

    #[test]
    fn small_gaps_and_seams_along_the_contour_are_left() {
        assert!(filled(0.09, 9, 0.1).is_empty(), "fewer pixels than a gap has");
        assert!(filled(0.25, 3, 0.1).is_empty(), "no pixel is well inside the silhouette");
    }
}
