//! The colours of a texture's texels.

use super::{cells::Cells, pack::Packed, unfold::Unfolded};
use crate::{
    colour::{Candidate, PointColours},
    error::Result,
    executor::Executor,
    point_cloud::Mesh,
    progress::{self, Progress},
    stage::Stage,
};
use alloc::{vec, vec::Vec};
use core::sync::atomic::{AtomicU32, Ordering};
use glam::{Vec2, Vec3};

/// Rows of texels per job.
const ROWS: usize = 16;

/// Colours, in reading order, of the texels that charts cover. Those of others are `None`.
///
/// Each gets the colour of the surface at its centre. Where no view sees the surface it gets the interpolated colour of
/// the mesh's vertices, which colouring has filled in from their surroundings.
pub(super) fn bake(
    mesh: &Mesh,
    charts: &[Unfolded],
    packed: &Packed,
    size: u32,
    colours: &PointColours,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<Vec<Option<[u8; 3]>>> {
    let size = size as usize;
    let owners = owners(charts, packed, size);
    let jobs = size.div_ceil(ROWS);
    let done = AtomicU32::new(0);
    let bands = executor.map(jobs, |job| {
        let mut scratch = Vec::new();
        let texels = job * ROWS * size..((job + 1) * ROWS).min(size) * size;
        let band: Vec<_> = texels
            .map(|i| {
                let (chart, triangle) = owners[i].of()?;
                let chart_texels = corners(&charts[chart], packed, chart, triangle);
                let weights = weights(chart_texels, Vec2::new((i % size) as f32, (i / size) as f32));
                Some(colour(mesh, charts[chart].triangles[triangle], weights, colours, &mut scratch))
            })
            .collect();
        progress::step(progress, Stage::Form, done.fetch_add(1, Ordering::Relaxed) + 1, jobs as u32)?;
        Ok(band)
    });
    let mut all = Vec::with_capacity(size * size);
    for band in bands {
        all.append(&mut band?);
    }
    Ok(all)
}

/// The triangle that covers a texel.
#[derive(Clone, Copy)]
struct Owner {
    /// Chart, or [`Owner::NOBODY`].
    chart: u32,
    /// Place of the triangle in the chart.
    triangle: u32,
}

impl Owner {
    const NOBODY: Self = Self { chart: u32::MAX, triangle: 0 };

    fn of(self) -> Option<(usize, usize)> {
        (self.chart != u32::MAX).then_some((self.chart as usize, self.triangle as usize))
    }
}

/// The owner of each texel.
fn owners(charts: &[Unfolded], packed: &Packed, size: usize) -> Vec<Owner> {
    let mut owners = vec![Owner::NOBODY; size * size];
    for (c, chart) in charts.iter().enumerate() {
        for triangle in 0..chart.triangles.len() {
            let Some(cells) = Cells::new(corners(chart, packed, c, triangle)) else { continue };
            cells.for_each(|cell| {
                owners[cell.y as usize * size + cell.x as usize] = Owner { chart: c as u32, triangle: triangle as u32 };
            });
        }
    }
    owners
}

/// Corners of a chart's triangle in texels. The centre of the first texel is at (0, 0).
pub(super) fn corners(chart: &Unfolded, packed: &Packed, index: usize, triangle: usize) -> [Vec2; 3] {
    chart.corners[triangle].map(|p| p * packed.scale + packed.places[index])
}

/// Barycentric weights of a point in a triangle.
fn weights([a, b, c]: [Vec2; 3], p: Vec2) -> [f32; 3] {
    let area = (b - a).perp_dot(c - a);
    let (wb, wc) = ((p - a).perp_dot(c - a) / area, (b - a).perp_dot(p - a) / area);
    [1.0 - wb - wc, wb, wc]
}

fn colour(
    mesh: &Mesh,
    triangle: u32,
    weights: [f32; 3],
    colours: &PointColours,
    scratch: &mut Vec<Candidate>,
) -> [u8; 3] {
    let corners = mesh.triangles[triangle as usize].map(|v| v as usize);
    let mix = |of: &dyn Fn(usize) -> Vec3| {
        of(corners[0]) * weights[0] + of(corners[1]) * weights[1] + of(corners[2]) * weights[2]
    };
    let seen = colours.at(mix(&|v| mesh.positions[v]), mix(&|v| mesh.normals[v]), scratch);
    let colour = seen.unwrap_or_else(|| mix(&|v| Vec3::from_array(mesh.colours[v].map(f32::from))));
    colour.to_array().map(|v| libm::roundf(v.clamp(0.0, 255.0)) as u8)
}
