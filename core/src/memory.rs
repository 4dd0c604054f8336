//! Upper bounds of the memory that a frame needs. A frame over the limit is refused before the memory is allocated.
//!
//! On one thread, and not counting the pictures that the host passes in, a frame needs at most
//!
//! `max(6 P + max(16 MiB, 96 L, 12 T, 9000 B, 6 W), 6 K + 6 W + level W + point S + 640 V + 10 M)` bytes
//!
//! where P is the number of pixels of all views, W the number of those in windows around the hull, K the number of those that
//! are kept although no later stage needs them: P if the frame keeps whole views, otherwise 0. L is the number of
//! pixels of the largest view, T the number of blocks in the bounding box of the hull's grid, B the number of blocks in the
//! hull's grid that its surface may pass, S the number of pixels inside the silhouettes, V the number of vertices in the final
//! mesh, and M the number of blocks in the bounding box of the grid of the Poisson solver. `level` is 3 for detection at full resolution and 3/4 at half resolution, where S counts a quarter
//! as well. `point` is 140, or 200 if the clouds are downsampled or cleaned of conflicts (§5). These and M are 0 for the
//! hull alone. The factors were measured.
//!
//! A form of the finished mesh ([`crate::Frame::form`]) needs at most `500 V + 5 P + 24 X` bytes besides, for a texture of X
//! texels.
//!
//! The mean with neighbouring frames ([`crate::Frame::steady`]) needs at most `300 (V + N)` bytes besides, where N is the number
//! of vertices of the largest neighbour. Its own mesh and those of its neighbours are not counted.
//!
//! P counts pixels at the resolution at which pictures are read ([`crate::reading`]), L those of the whole picture.
//!
//! 96 L is for reading views. Of a figure with a clean contour this takes 30 bytes per pixel, or 35 where the lens distorts.
//! A matte with nearly as much contour as is still refined takes 83 to 88, or 86 to 90 if it comes from a clean plate. On
//! several threads, each thread takes this much while it reads views. A frame that is read with those before and after it
//! ([`crate::Frame::view_between`]) takes 21 L more, on each thread.

use crate::{
    error::Result,
    hull::{
        VisualHull,
        memory::{PER_BLOCK, PER_PIXEL, pixels, within},
    },
    mesh::grid_blocks,
    params::{Method, Params},
    point_cloud::Mesh,
    rig::Rig,
    view::View,
    window::Window,
};

/// Bytes for the search for the hull.
const SEARCH: u64 = 16 << 20;
/// Bytes per pixel of the largest view for reading it: silhouette, distances and contour.
const READING: u64 = 96;
/// Bytes per pixel of the largest view for those of the frames before and after, and for the pixels that a silhouette lacks: two
/// views, three marks per pixel and a list of them, and the silhouette as it was.
const BETWEEN: u64 = 2 * PER_PIXEL + 9;
/// Bytes per vertex of the final mesh: grids and samples of the Poisson solver, the mesh and its colours.
const PER_VERTEX: f64 = 640.0;
/// Bytes per block of the bounding box of the Poisson solver's grid: the tables of its levels and of the blocks to come.
const PER_MESHING_BLOCK: u64 = 10;
/// Bytes per vertex of a mesh for a form of it: reducing it, or cutting it into charts.
const PER_FORM_VERTEX: u64 = 500;
/// Bytes per pixel of all views for what each sees of a mesh that gets a texture.
const PER_SEEN_PIXEL: u64 = 5;
/// Bytes per texel of a texture: the triangle that it shows, its colour, and the pictures that gaps are filled from.
const PER_TEXEL: u64 = 24;
/// Bytes per vertex of a mesh, and of the neighbour that it is averaged with: neighbours, smoothed colours, nodes and sums.
const PER_STEADY_VERTEX: u64 = 300;
/// Shares of a picture that an object and the window around it are expected to cover.
const EXPECTED_WINDOW: f64 = 0.5;
const EXPECTED_INSIDE: f64 = 0.25;
/// Vertices of a mesh per pixel inside a silhouette, with voxels of one pixel: an upright figure's surface is about three
/// times as large as its silhouette.
const EXPECTED_VERTICES: f64 = 3.0;

/// The smallest number of bytes that any frame of a rig needs. Pictures that are read at a lower resolution because they are
/// blurred count in full.
pub fn smallest(rig: &Rig, params: &Params) -> u64 {
    let sizes = rig.cameras().iter().map(|c| u64::from(c.width) * u64::from(c.height));
    PER_PIXEL * read_pixels(rig, params) + before_the_hull(sizes.max().unwrap_or(0))
}

/// Number of pixels of all pictures at the resolution at which they are read.
fn read_pixels(rig: &Rig, params: &Params) -> u64 {
    let octave = params.reading.octave;
    rig.cameras().iter().map(|c| u64::from(c.width >> octave) * u64::from(c.height >> octave)).sum()
}

/// Bytes for reading the views and the search for the hull, from the number of pixels of the largest view.
fn before_the_hull(largest: u64) -> u64 {
    SEARCH.max(READING * largest)
}

/// Bytes that a frame needs up to the hull's mesh, once the hull is known.
fn needed_for_hull(views: &[View], hull: &VisualHull) -> u64 {
    // In full resolution, in which masks are made.
    let largest = views.iter().map(|v| (v.luma.len() as u64) << (2 * v.octave)).max().unwrap_or(0);
    PER_PIXEL * pixels(views) + before_the_hull(largest).max(PER_BLOCK * hull.field().0.blocks.len() as u64)
}

/// The number of bytes that a frame is expected to need, before anything but its rig is known. It assumes that the object
/// covers a quarter of every picture, and the window around it half, and that the frame does not keep whole views.
pub fn expected(rig: &Rig, params: &Params) -> u64 {
    let pixels = read_pixels(rig, params);
    let window = EXPECTED_WINDOW * pixels as f64;
    let inside = EXPECTED_INSIDE * pixels as f64;
    let voxel = f64::from(params.hull.voxel_pixels);
    let vertices = EXPECTED_VERTICES * inside / rig.cameras().len() as f64 / (voxel * voxel);
    let windows = PER_PIXEL * window as u64;
    smallest(rig, params).max(PER_PIXEL * pixels + windows).max(windows + later(window, inside, vertices, params))
}

/// The largest number of bytes that a frame needs, once its silhouettes, its hull and the hull's mesh are known. `keeps` is
/// whether it keeps whole views.
pub fn needed(views: &[View], hull: &VisualHull, hull_mesh: &Mesh, params: &Params, keeps: bool) -> u64 {
    let (mut window, mut inside) = (0, 0);
    for view in views {
        let own = Window::around(hull_mesh, &view.camera).pixels();
        window += own;
        inside += match &view.silhouette {
            _ if !view.is_used() => 0,
            Some(silhouette) => silhouette.distances().iter().filter(|&&d| d > 0).count(),
            None => own,
        };
    }
    let mut later = later(window as f64, inside as f64, hull_mesh.positions.len() as f64, params);
    if params.method == Method::Pcmvs {
        let ((low, high), voxel) = (hull.bounds(), params.meshing.voxel_pixels * hull.footprint());
        later += PER_MESHING_BLOCK.saturating_mul(grid_blocks(high - low, voxel));
    }
    let (whole, windows) = (PER_PIXEL * pixels(views), PER_PIXEL * window as u64);
    needed_for_hull(views, hull).max(whole + windows).max(if keeps { whole } else { 0 } + windows + later)
}

/// The number of bytes that the stages after the hull need besides the views, from the number of pixels of all windows, the
/// number of those inside the silhouettes and the number of vertices of the hull's mesh.
fn later(window: f64, inside: f64, hull_vertices: f64, params: &Params) -> u64 {
    let finer = params.hull.voxel_pixels / params.meshing.voxel_pixels;
    let mut later = PER_VERTEX * hull_vertices * f64::from((finer * finer).max(1.0));
    if params.method == Method::Pcmvs {
        let share = if params.detection.octave > 0 { 0.25 } else { 1.0 };
        let cleaned = params.merging.downsample.is_some() || params.merging.conflicts.is_some();
        later += share * (3.0 * window + if cleaned { 200.0 } else { 140.0 } * inside);
    }
    later as u64
}

/// Refuses a frame if its hull's mesh would need more than `limit` bytes. Called before that mesh is extracted.
///
/// # Errors
/// [`crate::Error::OutOfMemory`].
pub fn check_hull(views: &[View], hull: &VisualHull, limit: Option<u64>) -> Result<()> {
    within(|| needed_for_hull(views, hull), limit)
}

/// Refuses a frame that needs more than `limit` bytes, once its silhouettes, its hull and the hull's mesh are known.
///
/// # Errors
/// [`crate::Error::OutOfMemory`].
pub fn check(
    views: &[View],
    hull: &VisualHull,
    hull_mesh: &Mesh,
    params: &Params,
    keeps: bool,
    limit: Option<u64>,
) -> Result<()> {
    within(|| needed(views, hull, hull_mesh, params, keeps), limit)
}

/// Refuses a form of a mesh if it needs more than `limit` bytes besides the frame, which needs `frame`. `size` is the number of
/// texels along a side of its texture, 0 without one.
///
/// # Errors
/// [`crate::Error::OutOfMemory`].
pub(crate) fn check_form(
    frame: impl FnOnce() -> u64,
    views: &[View],
    mesh: &Mesh,
    size: u32,
    limit: Option<u64>,
) -> Result<()> {
    within(|| frame() + form(views, mesh, size), limit)
}

/// The largest number of bytes that a form of a mesh needs besides the frame.
pub fn form(views: &[View], mesh: &Mesh, size: u32) -> u64 {
    let seen = if size > 0 { PER_SEEN_PIXEL * pixels(views) } else { 0 };
    PER_FORM_VERTEX * mesh.positions.len() as u64 + seen + PER_TEXEL * u64::from(size) * u64::from(size)
}

/// Refuses to average a mesh with its neighbours if that needs more than `limit` bytes besides the frame, which needs `frame`.
///
/// # Errors
/// [`crate::Error::OutOfMemory`].
pub(crate) fn check_steady(
    frame: impl FnOnce() -> u64,
    mesh: &Mesh,
    neighbours: &[&Mesh],
    limit: Option<u64>,
) -> Result<()> {
    let vertices = |mesh: &Mesh| mesh.positions.len() as u64;
    let largest = neighbours.iter().map(|mesh| vertices(mesh)).max().unwrap_or(0);
    within(|| frame() + PER_STEADY_VERTEX * (vertices(mesh) + largest), limit)
}

/// Bytes that a thread needs besides while it reads a view together with those of the frames before and after
/// ([`crate::Frame::view_between`]).
pub fn between(rig: &Rig, params: &Params) -> u64 {
    let octave = params.reading.octave;
    let sizes = rig.cameras().iter().map(|c| u64::from(c.width >> octave) * u64::from(c.height >> octave));
    BETWEEN * sizes.max().unwrap_or(0)
}

/// Refuses all frames of a rig that are read with those before and after, if the views alone need more than `limit` bytes.
///
/// # Errors
/// [`crate::Error::OutOfMemory`].
pub(crate) fn check_rig_between(rig: &Rig, params: &Params, limit: Option<u64>) -> Result<()> {
    within(|| smallest(rig, params) + between(rig, params), limit)
}

/// Refuses all frames of a rig if the views alone need more than `limit` bytes.
///
/// # Errors
/// [`crate::Error::OutOfMemory`].
pub fn check_rig(rig: &Rig, params: &Params, limit: Option<u64>) -> Result<()> {
    within(|| smallest(rig, params), limit)
}
