//! Textures: a surface cut into charts, unfolded into a square, and a colour for every texel (§7 gives the colours of
//! vertices only).
//!
//! A texel gets its colour from the photographs by the same rules as a vertex, so that a texture has no seams between
//! views, and none between charts beyond a texel.

mod adjacency;
mod bake;
mod cells;
mod charts;
mod pack;
mod spread;
mod unfold;

use crate::{
    colour::PointColours,
    error::{Error, Result},
    executor::Executor,
    point_cloud::Mesh,
    progress::{self, Onward, Progress},
    stage::Stage,
    view::View,
};
use alloc::{format, vec, vec::Vec};
use glam::{Vec2, Vec3};
use pack::Packed;
use unfold::Unfolded;

/// Parameters of a texture.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TextureParams {
    /// Texels along a side. `None` chooses the smallest power of two that keeps the detail of the photographs.
    pub size: Option<u32>,
}

/// Smallest and largest number of texels along a side.
pub const SIZES: [u32; 2] = [64, 16384];
/// Without a given size, texels are at most this long, in pixels of footprint.
const TEXEL_FOOTPRINTS: f32 = 0.75;
/// Largest size that is chosen without being asked for.
const MOST_CHOSEN: u32 = 8192;

/// The texture of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    /// Texture coordinates, one per vertex of the mesh: (0, 0) is the upper left corner of the picture, (1, 1) the lower
    /// right one, as in glTF.
    pub uvs: Vec<[f32; 2]>,
    /// Width and height in texels.
    pub size: u32,
    /// sRGB texels in reading order, three bytes each.
    pub texels: Vec<u8>,
}

/// Makes a texture for a closed, coloured mesh from the views that see it. Returns it with the mesh that it fits: the same
/// surface without colours of vertices. A vertex at a border of charts is there once per chart, at the same position and
/// with the same normal.
///
/// `gains` has one factor per view, `size` comes from [`size()`], and `blended_views` is that of
/// [`crate::colour::ColourParams`].
///
/// # Errors
/// [`Error::Form`] if the texture is too small for the mesh, and [`Error::Cancelled`].
pub(crate) fn texture(
    mesh: &Mesh,
    views: &[View],
    gains: &[Vec3],
    size: u32,
    blended_views: u32,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<(Mesh, Texture)> {
    let normals: Vec<Vec3> = normals(mesh).collect();
    let neighbours = adjacency::adjacency(mesh);
    // The steps are those of baking, which takes longest. Before it the progress only asks whether to go on.
    let progress = &Onward::new(progress);
    let go_on = || progress::step(progress, Stage::Form, 0, 1);
    go_on()?;
    let charts = charts::charts(&normals, &neighbours);
    go_on()?;
    let charts = unfold::unfold(mesh, charts, &neighbours, 1.0 / pack::expected_scale(area_of(&normals), size));
    let Some(packed) = pack::pack(&charts, size, go_on)? else {
        let problem = format!(
            "a texture of {size} x {size} texels is too small for this mesh: choose a larger one, or fewer triangles"
        );
        return Err(Error::Form { problem });
    };
    let colours = PointColours::new(mesh, views, gains, blended_views, executor);
    go_on()?;
    let texels = bake::bake(mesh, &charts, &packed, size, &colours, executor, progress)?;
    let (mesh, uvs) = cut(mesh, &charts, &packed, size);
    Ok((mesh, Texture { uvs, size, texels: spread::spread(&texels, size) }))
}

/// Texels along a side of the texture for a mesh: the size that was asked for, or a chosen one. `footprint` is the size of a
/// pixel at the object, in the unit of the scene.
///
/// # Errors
/// [`Error::Form`] if the size is out of range.
pub(crate) fn size(mesh: &Mesh, footprint: f32, params: &TextureParams) -> Result<u32> {
    let [smallest, largest] = SIZES;
    let size = params.size.unwrap_or_else(|| chosen_size(normals(mesh).map(length).sum(), footprint));
    if size < smallest || size > largest {
        let problem = format!("a texture of {size} x {size} texels is not possible: choose {smallest} to {largest}");
        return Err(Error::Form { problem });
    }
    Ok(size)
}

/// The normals of the triangles, with the length of their areas.
fn normals(mesh: &Mesh) -> impl Iterator<Item = Vec3> + '_ {
    mesh.triangles.iter().map(|t| area(t.map(|v| mesh.positions[v as usize])))
}

fn length(v: Vec3) -> f32 {
    libm::sqrtf(v.length_squared())
}

fn area_of(normals: &[Vec3]) -> f32 {
    normals.iter().copied().map(length).sum()
}

/// The normal of a triangle, with the length of its area.
fn area([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(c - a) * 0.5
}

/// The smallest power of two that gives texels of [`TEXEL_FOOTPRINTS`] for a surface of some area.
fn chosen_size(area: f32, footprint: f32) -> u32 {
    let mut size = SIZES[0];
    while size < MOST_CHOSEN && pack::expected_scale(area, size) * footprint * TEXEL_FOOTPRINTS < 1.0 {
        size *= 2;
    }
    size
}

/// Cuts the mesh along the borders of the charts, and gives its vertices their texture coordinates.
fn cut(mesh: &Mesh, charts: &[Unfolded], packed: &Packed, size: u32) -> (Mesh, Vec<[f32; 2]>) {
    const ABSENT: u32 = u32::MAX;
    let mut copies = vec![ABSENT; mesh.positions.len()];
    let (mut out, mut uvs) = (Mesh::default(), Vec::new());
    for (c, chart) in charts.iter().enumerate() {
        for (i, &t) in chart.triangles.iter().enumerate() {
            let texels = bake::corners(chart, packed, c, i);
            let corners = mesh.triangles[t as usize];
            out.triangles.push([0, 1, 2].map(|k| {
                let v = corners[k] as usize;
                if copies[v] == ABSENT {
                    copies[v] = out.positions.len() as u32;
                    out.positions.push(mesh.positions[v]);
                    out.normals.push(mesh.normals[v]);
                    uvs.push(((texels[k] + Vec2::splat(0.5)) / size as f32).to_array());
                }
                copies[v]
            }));
        }
        // The next chart has its own copies.
        for &t in &chart.triangles {
            mesh.triangles[t as usize].iter().for_each(|&v| copies[v as usize] = ABSENT);
        }
    }
    (out, uvs)
}

#[cfg(test)]
mod tests;
