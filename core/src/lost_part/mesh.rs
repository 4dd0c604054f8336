//! Whether the mesh of a frame lacks a part that the meshes of its neighbours have.

use crate::{executor::Executor, neighbour_grid::NeighbourGrid, point_cloud::Mesh};
use alloc::vec::Vec;
use glam::Vec3;

/// Surface this far from the frame's own may be that of a lost part, as a share of the diagonal of the neighbour's bounds. For
/// a person it is about 8 cm.
const FAR: f32 = 0.04;
/// A part has at least this share of the vertices that are looked at.
const SHARE: f32 = 0.004;
/// About so many vertices of a neighbour are looked at, and compared with about so many of the frame and of the other neighbour.
/// Of meshes that have fewer, all are.
const LOOKED_AT: usize = 8192;
const COMPARED: usize = 16384;
/// If the other views have overruled so many silhouettes in this frame alone, neighbouring frames may know more.
const OVERRULED: usize = 2;
/// Vertices that one job of an executor looks at.
const VERTICES_PER_JOB: usize = 1024;

/// What a frame and those beside it tell about themselves to find out whether they have lost a part.
#[derive(Clone, Copy, Debug)]
pub struct Beside<'a> {
    /// Its mesh ([`crate::Frame::own_mesh`]).
    pub mesh: &'a Mesh,
    /// The cameras whose silhouettes its other views have overruled ([`crate::Frame::overruled`]).
    pub overruled: &'a [u32],
}

/// Whether a frame may have lost a part: [`crate::Frame::may_have_lost_part`] without the frame.
pub fn may_have_lost_part(own: Beside, neighbours: [Beside; 2], executor: &dyn Executor) -> bool {
    let only_here = |camera: &&u32| neighbours.iter().all(|beside| !beside.overruled.contains(camera));
    let overruled = own.overruled.iter().filter(only_here).count();
    overruled >= OVERRULED || has_lost_part(own.mesh, neighbours.map(|beside| beside.mesh), executor)
}

/// Whether the frame before `before`, and the one after `after`, may tell more: [`crate::Frame::look_beyond`] without the frame.
pub fn look_beyond(own: Beside, [before, after]: [Beside; 2], executor: &dyn Executor) -> [bool; 2] {
    let share = |with: Beside, other: Beside| {
        let in_both = |camera: &&u32| with.overruled.contains(camera) && !other.overruled.contains(camera);
        own.overruled.iter().filter(in_both).count() >= OVERRULED
            || lacks(&[own.mesh, with.mesh], other.mesh, None, executor)
    };
    [share(before, after), share(after, before)]
}

/// Whether a mesh has no surface near a part that both neighbouring frames' meshes have. All are relative to the same origin.
/// Parts that move fast from frame to frame are not lost: those of the two neighbours are then not near each other, either.
pub fn has_lost_part(own: &Mesh, [before, after]: [&Mesh; 2], executor: &dyn Executor) -> bool {
    lacks(&[own], before, Some(after), executor) && lacks(&[own], after, Some(before), executor)
}

/// Whether meshes have no surface near a part of a neighbour. If there is another neighbour, it has.
fn lacks(without: &[&Mesh], neighbour: &Mesh, other: Option<&Mesh>, executor: &dyn Executor) -> bool {
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for &p in &neighbour.positions {
        (low, high) = (low.min(p), high.max(p));
    }
    let far = FAR * (high - low).length();
    if without.iter().any(|mesh| mesh.positions.is_empty()) || !far.is_finite() || far <= 0.0 {
        return false;
    }
    let without: Vec<Near> = without.iter().map(|mesh| Near::new(mesh, far)).collect();
    let other = other.map(|mesh| Near::new(mesh, far));
    let is_lost = |&p: &Vec3| !without.iter().any(|mesh| mesh.has(p)) && other.as_ref().is_none_or(|mesh| mesh.has(p));
    let stride = (neighbour.positions.len() / LOOKED_AT).max(1);
    let samples = neighbour.positions.len().div_ceil(stride);
    let jobs = samples.div_ceil(VERTICES_PER_JOB);
    let counts = executor.map(jobs, |job| {
        let end = ((job + 1) * VERTICES_PER_JOB).min(samples);
        let points = (job * VERTICES_PER_JOB..end).map(|i| neighbour.positions[i * stride]);
        points.filter(is_lost).count()
    });
    counts.iter().sum::<usize>() as f32 > SHARE * samples as f32
}

/// Finds out whether a mesh has surface near a point.
struct Near<'a> {
    mesh: &'a Mesh,
    stride: usize,
    far: f32,
    grid: NeighbourGrid,
}

impl<'a> Near<'a> {
    fn new(mesh: &'a Mesh, far: f32) -> Self {
        let all = mesh.positions.len();
        let stride = (all / COMPARED).max(1);
        let points = (0..all.div_ceil(stride)).map(|i| mesh.positions[i * stride]);
        Self { mesh, stride, far, grid: NeighbourGrid::new(points, far) }
    }

    fn has(&self, p: Vec3) -> bool {
        let mut is_near = false;
        let is_in_reach = |i: usize| self.mesh.positions[i * self.stride].distance_squared(p) < self.far * self.far;
        self.grid.near(p, self.far, |i| is_near = is_near || is_in_reach(i));
        is_near
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::executor::Serial;

    /// A person's height of points on a pole, and an arm of the given length at its shoulder, which is turned by `turn`.
    fn with_arm(length: f32, turn: f32) -> Mesh {
        let pole = (0..4000).map(|i| Vec3::new(0.0, 0.0, 1.8 * i as f32 / 4000.0));
        let arm = (0..800).map(|i| 1.4 * Vec3::Z + (Vec3::X + turn * Vec3::Z).normalize() * length * i as f32 / 800.0);
        Mesh { positions: pole.chain(arm).collect(), ..Mesh::default() }
    }

    #[test]
    fn a_part_is_lost_if_both_neighbours_have_it_and_nothing_is_near() {
        let [before, own, after] = [0.0, 0.1, 0.2].map(|turn| with_arm(0.6, turn));
        assert!(!has_lost_part(&own, [&before, &after], &Serial), "an arm moves by 6 cm");
        let [second, third] = [0.4, 0.8].map(|turn| with_arm(0.6, turn));
        assert!(!has_lost_part(&second, [&before, &third], &Serial), "an arm moves by 22 cm");
        let none = with_arm(0.0, 0.0);
        assert!(has_lost_part(&none, [&before, &after], &Serial));
        assert!(!has_lost_part(&none, [&before, &none], &Serial), "only one of them has it");
        assert!(!has_lost_part(&before, [&none, &none], &Serial), "a part that only this frame has");
        assert!(!has_lost_part(&Mesh::default(), [&before, &after], &Serial));
        assert!(!has_lost_part(&own, [&Mesh::default(), &Mesh::default()], &Serial));
    }

    #[test]
    fn frames_beyond_the_neighbours_are_asked_if_one_of_these_lacks_the_part_too() {
        let beyond = |own, [before, after]: [&Mesh; 2]| {
            let [own, before, after] = [own, before, after].map(|mesh| Beside { mesh, overruled: &[] });
            look_beyond(own, [before, after], &Serial)
        };
        let (arm, none, empty) = (&with_arm(0.6, 0.0), &with_arm(0.0, 0.0), Mesh::default());
        assert_eq!(beyond(none, [arm, none]), [false, true], "the next frame lacks it, too");
        assert_eq!(beyond(none, [none, arm]), [true, false], "the last frame lacked it, too");
        assert_eq!(beyond(none, [arm, arm]), [false, false], "the neighbours know enough");
        assert_eq!(beyond(arm, [arm, none]), [false, false], "only the next frame lacks it");
        assert_eq!(beyond(none, [none, none]), [false, false], "the neighbours know of no arm");
        assert_eq!(beyond(none, [arm, &empty]), [false, false], "an empty frame lacks no part");
        let overruled = |own: &[u32], before: &[u32], after: &[u32]| {
            let beside = [before, after].map(|overruled| Beside { mesh: arm, overruled });
            look_beyond(Beside { mesh: arm, overruled: own }, beside, &Serial)
        };
        assert_eq!(overruled(&[3, 5], &[], &[3, 5, 7]), [false, true]);
        assert_eq!(overruled(&[3, 5], &[3, 5], &[3]), [false, false], "one camera is not enough");
        assert_eq!(overruled(&[3, 5], &[3, 5], &[3, 5]), [false, false], "bad in all frames");
    }
}
