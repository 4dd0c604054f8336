//! Whether the calibration fits the pictures of a frame, from a few of the points that stereo has found. It costs a frame
//! little and corrects nothing; [`super::calibrate`] does.
//!
//! Stereo compares pictures along epipolar lines only. If the cameras are off, it still finds depths, and they are wrong.
//! Here a point's surroundings are searched in all directions: how far they lie from the epipolar line does not depend on
//! the depth, but on the cameras.

use super::{
    corners::{AROUND, strength},
    instant::INSIDE,
    matching::OWN_SIGMA,
    model::Model,
    patch::{self, MARGIN},
    residuals::{epipolar_bias, residuals},
    smooth::Smooth,
    track::{Observation, Source, Track},
};
use crate::{
    camera::Pinhole,
    executor::Executor,
    point_cloud::{Point, PointCloud, Rank},
    rig::Rig,
    silhouette::Silhouette,
    view::View,
};
use alloc::{vec, vec::Vec};
use glam::{DVec2, DVec3, Mat2, Vec2, Vec3};

/// Points that are searched, per view.
const POINTS: usize = 28;
/// The strongest corner of so many points is searched.
const CANDIDATES: usize = 12;
/// Neighbours in which each of them is searched.
const NEIGHBOURS: usize = 2;
/// How far from where it is expected a point is searched, in pixels.
const REACH: usize = 5;
/// Half the edge of what is smoothed of the other picture, in pixels. Windows may appear enlarged there.
const SEARCHED: usize = 30;
/// Cosine between a surface's normal and the ray below which a window would be warped too much.
const LEAST_FACING: f32 = 0.35;

/// How well the calibration fits a frame.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct SpotCheck {
    /// Median distance in pixels of each camera's matches from their epipolar lines, by place in the rig's order. `None`
    /// where there are too few. Pixels are those of the picture before it was read at a lower resolution.
    pub(crate) epipolar: Vec<Option<f32>>,
    /// The mean over all pairs of cameras of the size of their median signed distance, in pixels: what the calibration,
    /// not chance, is off by. `None` if fewer than half as many pairs as cameras have enough matches.
    pub(crate) bias: Option<f32>,
}

/// Matches points that stereo has found in each view, given in the rig's order like the views.
pub(crate) fn spot_check(rig: &Rig, views: &[View], points: &[PointCloud], executor: &dyn Executor) -> SpotCheck {
    let ordered = rig.order().iter().map(|&i| &rig.cameras()[i as usize]);
    let models: Vec<Model> = ordered.map(|camera| Model::new(camera, rig.origin())).collect();
    let found = executor.map(views.len(), |i| matches(rig, views, &models, i, &points[i]));
    let tracks: Vec<Track> = found.into_iter().flatten().collect();
    // Every pair counts for both of its cameras. Fewer say nothing about the calibration as a whole.
    let least = views.iter().filter(|view| view.is_used()).count().max(1);
    let epipolar = residuals(&[], &models, &tracks).iter().map(|r| r.epipolar_px.map(|d| d as f32)).collect();
    SpotCheck { epipolar, bias: epipolar_bias(&models, &tracks, least).map(|d| d as f32) }
}

/// The matches of one view's points in its neighbours.
fn matches(rig: &Rig, views: &[View], models: &[Model], i: usize, points: &[Point]) -> Vec<Track> {
    let view = &views[i];
    let others = || {
        let near = rig.neighbours(i).iter().map(|&j| j as usize);
        near.filter(|&j| views[j].is_used() && !views[j].luma.is_empty()).take(NEIGHBOURS)
    };
    let mut tracks = Vec::new();
    for point in chosen(view, points) {
        let [x, y] = point.pixel;
        let half = MARGIN + REACH;
        let Some(own) = smoothed(view, [x, y], half) else { continue };
        let mut observations = vec![seen(view, &models[i], i, Vec2::new(x as f32, y as f32))];
        for j in others() {
            let Some((expected, affine)) = point.seen_by(&view.camera, &views[j].camera) else { continue };
            let Some(middle) = nearest(expected) else { continue };
            let Some(there) = smoothed(&views[j], middle, SEARCHED) else { continue };
            let corner = Vec2::from(middle.map(|v| v as f32)) - SEARCHED as f32;
            if let Some(found) = patch::find([&own, &there], [half as u16; 2], expected - corner, affine, REACH) {
                observations.push(seen(&views[j], &models[j], j, found.pixel + corner));
            }
        }
        if observations.len() > 1 {
            tracks.push(Track { observations, point: DVec3::ZERO, source: Source::Texture, held_out: false });
        }
    }
    tracks
}

/// Where a camera's real picture shows what a pixel of its view shows.
fn seen(view: &View, model: &Model, place: usize, pixel: Vec2) -> Observation {
    let scale = f64::from(1u32 << view.octave);
    let pixel = pixel.as_dvec2() + DVec2::from(view.corner.map(f64::from));
    let ideal = (pixel + 0.5) * scale - DVec2::splat(0.5);
    Observation { camera: place as u16, pixel: model.real_of_ideal(ideal), sigma: OWN_SIGMA }
}

/// The pixel nearest to a position; `None` above or to the left of the picture.
fn nearest(at: Vec2) -> Option<[usize; 2]> {
    let [x, y] = [libm::roundf(at.x), libm::roundf(at.y)];
    (x >= 0.0 && y >= 0.0).then_some([x as usize, y as usize])
}

/// The surroundings of a pixel, smoothed.
fn smoothed(view: &View, pixel: [usize; 2], half: usize) -> Option<Smooth> {
    Smooth::around(&view.luma, [view.camera.width as usize, view.camera.height as usize], pixel, half)
}

/// A pixel and the tangent plane of what it shows.
struct Tangent {
    pixel: [usize; 2],
    position: Vec3,
    normal: Vec3,
}

impl Tangent {
    /// Where another camera sees the pixel's surface, and its map of offsets in pixels.
    fn seen_by(&self, own: &Pinhole, other: &Pinhole) -> Option<(Vec2, Mat2)> {
        let [x, y] = self.pixel.map(|v| v as f32);
        let distance = self.normal.dot(self.position - own.centre);
        let at = |u: f32, v: f32| {
            let ray = own.ray(u, v);
            other.project(own.centre + ray * (distance / self.normal.dot(ray)))
        };
        let from = (own.centre - self.position).normalize();
        let there = (other.centre - self.position).normalize();
        if !(self.normal.dot(from) > LEAST_FACING && self.normal.dot(there) > LEAST_FACING) {
            return None;
        }
        let middle = at(x, y);
        let right = 0.5 * (at(x + 1.0, y) - at(x - 1.0, y)).truncate();
        let down = 0.5 * (at(x, y + 1.0) - at(x, y - 1.0)).truncate();
        (middle.z > 0.0).then(|| (middle.truncate(), Mat2::from_cols(right, down)))
    }
}

/// The view's points that are searched: those of stereo, well inside of the silhouette, the strongest corner of each of
/// [`POINTS`] parts of the cloud, which runs along the rows of the picture.
fn chosen(view: &View, points: &[Point]) -> Vec<Tangent> {
    if view.luma.is_empty() || points.is_empty() {
        return Vec::new();
    }
    let width = view.camera.width as usize;
    let deep = (INSIDE * Silhouette::UNITS) as i16;
    let shown = view.shown().map(|silhouette| silhouette.distances());
    let part = points.len().div_ceil(POINTS);
    let strongest = |part: &[Point]| {
        let step = part.len().div_ceil(CANDIDATES);
        let mut best: Option<(f32, Tangent)> = None;
        for point in part.iter().step_by(step).filter(|point| point.rank == Rank::Detected) {
            let at = view.camera.project(point.position).truncate();
            let Some(pixel) = nearest(at) else { continue };
            let Some(around) = smoothed(view, pixel, AROUND) else { continue };
            let inside = |d: &[i16]| d[pixel[1] * width + pixel[0]] > deep;
            if !shown.is_none_or(inside) {
                continue;
            }
            if let Some(corner) = strength(&around, AROUND, AROUND)
                && best.as_ref().is_none_or(|(strongest, _)| corner > *strongest)
            {
                best = Some((corner, Tangent { pixel, position: point.position, normal: point.normal }));
            }
        }
        best.map(|(_, tangent)| tangent)
    };
    points.chunks(part).filter_map(strongest).collect()
}
