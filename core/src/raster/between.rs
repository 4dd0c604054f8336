//! Finds the triangles of a mesh that lie between the centres of pixels and therefore cover none. Most triangles of a fine mesh
//! do. One integer per vertex says between which centres the vertex lies, and comparing three of them is enough for a triangle.

use crate::{
    math::{max, min},
    point_cloud::Mesh,
};
use alloc::vec::Vec;
use glam::Vec3;

/// For each vertex, between which columns and between which rows of pixel centres it lies. Reused for all views, so that its
/// memory is allocated once.
#[derive(Debug, Default)]
pub(super) struct Between {
    /// The column to the right in the lower half, and the row below in the upper half. [`UNCERTAIN`] is set in a half whose
    /// coordinate may be that of a pixel centre.
    places: Vec<u32>,
}

/// Set where a coordinate may be that of a pixel centre, or has too large a number.
const UNCERTAIN: u32 = 0x8000;
/// The halves of a word.
const HALVES: [u32; 2] = [0xffff, 0xffff << 16];

impl Between {
    /// Looks at the pixels of a mesh's vertices in a picture of the given size.
    pub fn set(&mut self, pixels: impl Iterator<Item = Vec3>, width: usize, height: usize) {
        self.places.clear();
        self.places.extend(pixels.map(|p| place(p.x, width) | place(p.y, height) << 16));
    }

    /// Calls `f` for the triangles of the mesh in their order, without those that [`super::cover`] would not find to cover any
    /// pixel's centre because all three corners lie between the same two columns, or between the same two rows.
    #[inline(always)]
    pub fn for_each(&self, mesh: &Mesh, mut f: impl FnMut([u32; 3])) {
        for &triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|i| self.places[i as usize]);
            let differing = (a ^ b) | (a ^ c) | a & (UNCERTAIN | UNCERTAIN << 16);
            if HALVES.iter().all(|half| differing & half != 0) {
                f(triangle);
            }
        }
    }
}

/// The first pixel centre that is not before a coordinate.
#[inline(always)]
pub(super) fn first(v: f32) -> i32 {
    // Negative values are clamped first, so that truncation equals floor.
    let v = max(v, 0.0);
    let floor = v as i32;
    // Where a position is too large for an integer, `floor` is the largest one.
    floor.saturating_add(i32::from(floor as f32 != v))
}

/// The first pixel centre behind a coordinate, in a picture with `n` of them.
#[inline(always)]
pub(super) fn end(v: f32, n: usize) -> i32 {
    (max(v + 1.0, 0.0) as i32).min(n as i32)
}

/// The first pixel centre behind a coordinate, or [`UNCERTAIN`]. As [`first`] and [`end`] never fall while the coordinate
/// rises, coordinates of the same place have no pixel centre between them.
#[inline(always)]
fn place(v: f32, n: usize) -> u32 {
    let (first, end) = (first(v).min(n as i32) as u32, end(v, n) as u32);
    if first == end && end < UNCERTAIN { end } else { UNCERTAIN }
}

/// The pixels that lie between three coordinates, from [`first`] to [`end`] of them.
#[inline(always)]
pub(super) fn spanned(a: f32, b: f32, c: f32, n: usize) -> [i32; 2] {
    [first(min(min(a, b), c)), end(max(max(a, b), c), n)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        raster::cover,
        testing::{pinhole, sphere},
    };
    use alloc::vec;
    use proptest::prelude::*;

    /// The pixels that triangles cover, if `between` has not dropped them.
    fn covered(mesh: &Mesh, between: Option<&Between>, [width, height]: [usize; 2]) -> Vec<(usize, usize, u32, bool)> {
        let mut found = Vec::new();
        let mut draw = |triangle: [u32; 3]| {
            let corners = triangle.map(|i| mesh.positions[i as usize]);
            cover(corners, width, height, |x, y, z, front| found.push((x, y, z.to_bits(), front)));
        };
        match between {
            Some(between) => between.for_each(mesh, draw),
            None => mesh.triangles.iter().for_each(|&triangle| draw(triangle)),
        }
        found
    }

    /// Pixels around the centres of pixels, on them and as close to them as numbers allow, in small and in very wide pictures.
    fn pixel() -> impl Strategy<Value = (i32, usize)> {
        (-3_i32..12, 0_usize..6)
    }

    proptest! {
        #[test]
        fn triangles_that_are_dropped_cover_no_pixel(
            columns in [pixel(), pixel(), pixel()],
            rows in [pixel(), pixel(), pixel()],
            first in prop_oneof![Just(0_i32), Just(32_760_i32), Just(70_000_i32)],
        ) {
            let at = |(whole, part): (i32, usize)| whole as f32 + [0.0, 1e-7, 0.25, 0.5, 0.75, 0.999_999_9][part];
            let corner = |k: usize| Vec3::new(at(columns[k]) + first as f32, at(rows[k]), 1.0 + k as f32);
            let mesh = Mesh { positions: (0..3).map(corner).collect(), triangles: vec![[0, 1, 2]], ..Mesh::default() };
            let size = [first as usize + 9, 9];
            let mut between = Between::default();
            between.set(mesh.positions.iter().copied(), size[0], size[1]);
            prop_assert_eq!(covered(&mesh, Some(&between), size), covered(&mesh, None, size));
        }
    }

    /// Most triangles of a fine mesh are dropped, and none that covers a pixel.
    #[test]
    fn most_triangles_of_a_fine_mesh_are_dropped() {
        let mut mesh = sphere(Vec3::ZERO, 0.5);
        let camera = pinhole(Vec3::X * 3.0, Vec3::ZERO, 12, 16.0);
        mesh.positions.iter_mut().for_each(|p| *p = camera.project(*p));
        let mut between = Between::default();
        between.set(mesh.positions.iter().copied(), 12, 12);
        let mut left = 0;
        between.for_each(&mesh, |_| left += 1);
        assert!(left < mesh.triangles.len() / 4, "{left} of {}", mesh.triangles.len());
        let found = covered(&mesh, Some(&between), [12; 2]);
        assert!(found.len() > 20);
        assert_eq!(found, covered(&mesh, None, [12; 2]));
    }
}
