//! Unfolds charts into the plane by a parallel projection, and splits those that would cover themselves, such as an arm
//! in front of the body.

use super::{
    cells::Cells,
    charts::{Chart, connected},
};
use crate::{
    math::{max, min},
    point_cloud::Mesh,
};
use alloc::{vec, vec::Vec};
use glam::{Vec2, Vec3};

/// Parts of a chart whose depths differ by more than this many texels are kept apart by at least a texel, so that
/// their colours do not mix.
const DEPTH_TEXELS: f32 = 10.0;
/// A chart's picture is rotated by the best of this many angles of a quarter turn.
const ANGLES: u32 = 16;

/// A chart with positions in the plane.
#[derive(Debug)]
pub(super) struct Unfolded {
    pub triangles: Vec<u32>,
    /// Positions of the corners of each triangle, in the unit of the scene. The smallest coordinates are zero.
    pub corners: Vec<[Vec2; 3]>,
    /// Largest coordinates.
    pub size: Vec2,
}

/// Unfolds charts. `texel` is about the size of a texel in the unit of the scene.
pub(super) fn unfold(mesh: &Mesh, charts: Vec<Chart>, neighbours: &[[u32; 3]], texel: f32) -> Vec<Unfolded> {
    let mut waiting = charts;
    waiting.reverse();
    let mut unfolded = Vec::with_capacity(waiting.len());
    let mut flags = vec![false; neighbours.len()];
    while let Some(chart) = waiting.pop() {
        let plane = Plane::new(chart.axis);
        let (kept, rest) = split(mesh, &chart, &plane, texel);
        for triangles in connected(&rest, neighbours, &mut flags, |_, _| true).into_iter().rev() {
            waiting.push(Chart { triangles, axis: chart.axis });
        }
        for triangles in connected(&kept, neighbours, &mut flags, |_, _| true) {
            unfolded.push(Unfolded::new(mesh, triangles, &plane));
        }
    }
    unfolded
}

/// A plane that a chart is projected to.
struct Plane {
    axis: Vec3,
    right: Vec3,
    up: Vec3,
}

impl Plane {
    fn new(axis: Vec3) -> Self {
        // Any direction that is not close to the axis gives a frame.
        let aside = if axis.z.abs() < 0.8 { Vec3::Z } else { Vec3::X };
        let right = aside.cross(axis);
        let right = right / libm::sqrtf(right.length_squared());
        Self { axis, right, up: axis.cross(right) }
    }

    fn project(&self, p: Vec3) -> Vec2 {
        Vec2::new(p.dot(self.right), p.dot(self.up))
    }
}

fn corners_of(mesh: &Mesh, triangle: u32) -> [Vec3; 3] {
    mesh.triangles[triangle as usize].map(|v| mesh.positions[v as usize])
}

/// Takes a chart's triangles one by one and leaves out those whose texels are taken. Returns both.
fn split(mesh: &Mesh, chart: &Chart, plane: &Plane, texel: f32) -> (Vec<u32>, Vec<u32>) {
    const MARGIN: f32 = 2.0;
    let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
    for p in chart.triangles.iter().flat_map(|&t| corners_of(mesh, t)).map(|p| plane.project(p)) {
        (low, high) = (low.min(p), high.max(p));
    }
    let size = (high - low) / texel;
    let (width, height) = (size.x as usize + 6, size.y as usize + 6);
    // The depth at each texel that is taken, in texels.
    let mut taken = vec![f32::NAN; width * height];
    let (mut kept, mut rest) = (Vec::with_capacity(chart.triangles.len()), Vec::new());
    for &t in &chart.triangles {
        let corners = corners_of(mesh, t);
        let flat = corners.map(|p| (plane.project(p) - low) / texel + Vec2::splat(MARGIN));
        let depths = corners.map(|p| p.dot(plane.axis) / texel);
        let Some(cells) = Cells::new(flat) else {
            kept.push(t);
            continue;
        };
        let mut is_free = true;
        cells.for_each(|cell| {
            let at = cell.y as usize * width + cell.x as usize;
            let depth = cell.weights[0] * depths[0] + cell.weights[1] * depths[1] + cell.weights[2] * depths[2];
            let far = |i: usize| (taken[i] - depth).abs() > DEPTH_TEXELS;
            let around = [at - width, at - 1, at + 1, at + width];
            is_free &= taken[at].is_nan() && !around.into_iter().any(far);
        });
        if !is_free {
            rest.push(t);
            continue;
        }
        cells.for_each(|cell| {
            let depth = cell.weights[0] * depths[0] + cell.weights[1] * depths[1] + cell.weights[2] * depths[2];
            taken[cell.y as usize * width + cell.x as usize] = depth;
        });
        kept.push(t);
    }
    (kept, rest)
}

impl Unfolded {
    fn new(mesh: &Mesh, triangles: Vec<u32>, plane: &Plane) -> Self {
        let mut corners: Vec<[Vec2; 3]> =
            triangles.iter().map(|&t| corners_of(mesh, t).map(|p| plane.project(p))).collect();
        let turn = best_turn(&corners);
        let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        for p in corners.iter_mut().flatten() {
            *p = turned(*p, turn);
            low = Vec2::new(min(low.x, p.x), min(low.y, p.y));
            high = Vec2::new(max(high.x, p.x), max(high.y, p.y));
        }
        corners.iter_mut().flatten().for_each(|p| *p -= low);
        Self { triangles, corners, size: high - low }
    }
}

/// Cosine and sine of the rotation that gives the bounding rectangle the smallest area.
fn best_turn(corners: &[[Vec2; 3]]) -> Vec2 {
    let turns = (0..ANGLES).map(|i| {
        let angle = f64::from(i) * (core::f64::consts::FRAC_PI_2 / f64::from(ANGLES));
        Vec2::new(libm::cos(angle) as f32, libm::sin(angle) as f32)
    });
    let area = |turn: Vec2| {
        let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        for p in corners.iter().flatten() {
            let p = turned(*p, turn);
            (low, high) = (low.min(p), high.max(p));
        }
        (high - low).x * (high - low).y
    };
    let mut best = (Vec2::X, area(Vec2::X));
    for turn in turns.skip(1) {
        let found = area(turn);
        if found < best.1 {
            best = (turn, found);
        }
    }
    best.0
}

fn turned(p: Vec2, turn: Vec2) -> Vec2 {
    Vec2::new(p.x * turn.x - p.y * turn.y, p.x * turn.y + p.y * turn.x)
}
