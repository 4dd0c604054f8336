//! Frames that are averaged with their neighbours in time: which frames are made, and when each can be finished.

use crate::{frame::Job, kept::Kept, report::FrameReport, warning::WarningReport};
use pcmvs_scene::{Failure, SceneFrame};
use std::sync::Arc;

/// A frame and what it has to do in this run.
pub struct Planned<'a> {
    pub frame: &'a SceneFrame,
    /// Whether its mesh is written. Other frames are made for the sake of their neighbours.
    pub is_asked: bool,
    /// Places in the plan of the frames before and after it. Empty if every frame is made by itself.
    pub neighbours: Vec<usize>,
}

/// The frames of `all`, which are sorted by index, that are asked for or that such a frame is averaged with. Frames are
/// neighbours if their indices differ by one.
pub fn plan<'a>(all: &'a [SceneFrame], is_asked: impl Fn(u32) -> bool, alone: bool) -> Vec<Planned<'a>> {
    let asked: Vec<bool> = all.iter().map(|frame| is_asked(frame.index)).collect();
    let is_needed = |&place: &usize| asked[place] || (!alone && next_to(all, place).any(|other| asked[other]));
    let needed: Vec<usize> = (0..all.len()).filter(is_needed).collect();
    let planned = |&place: &usize| {
        let of = |other: usize| needed.binary_search(&other).ok();
        let neighbours = if alone { Vec::new() } else { next_to(all, place).filter_map(of).collect() };
        Planned { frame: &all[place], is_asked: asked[place], neighbours }
    };
    needed.iter().map(planned).collect()
}

/// The places of the frames before and after one.
fn next_to(all: &[SceneFrame], place: usize) -> impl Iterator<Item = usize> {
    let near = place.saturating_sub(1)..(place + 2).min(all.len());
    near.filter(move |&other| all[other].index.abs_diff(all[place].index) == 1)
}

/// Those of `all` frames that are `asked` for, a sorted list of indices, or are the neighbour of such a frame, sorted by index.
pub fn with_neighbours(mut all: Vec<SceneFrame>, asked: &[u32]) -> Vec<SceneFrame> {
    let is_asked = |index: u32| asked.binary_search(&index).is_ok();
    let near = |index: u32| index.saturating_sub(1)..=index.saturating_add(1);
    all.retain(|frame| near(frame.index).any(is_asked));
    all.sort_by_key(|frame| frame.index);
    all
}

/// A frame that can be finished. `O` is the frame as it was reconstructed by itself.
pub struct Ready<O> {
    pub place: usize,
    pub own: O,
    pub digest: String,
    /// The digests of its neighbours and what they have kept for it, of those that have a mesh.
    pub neighbours: Vec<Option<(String, Arc<Kept>)>>,
    pub warnings: Vec<WarningReport>,
}

/// What has become of the frames of a plan.
pub struct Waiting<'a, O> {
    plan: &'a [Planned<'a>],
    states: Vec<State<O>>,
}

enum State<O> {
    /// It has not been reconstructed yet.
    Open,
    /// It has been reconstructed by itself. `own` is there until it is finished.
    Made { own: Option<Box<(O, Vec<WarningReport>)>>, digest: String, kept: Arc<Kept> },
    /// It has failed.
    Failed,
    /// Neither it nor any of its neighbours needs it any more.
    Gone,
}

impl<'a, O> Waiting<'a, O> {
    pub fn new(plan: &'a [Planned<'a>]) -> Self {
        Self { plan, states: plan.iter().map(|_| State::Open).collect() }
    }

    /// Notes that a frame has failed. Returns the frames that can be finished now.
    pub fn failed(&mut self, place: usize) -> Vec<Ready<O>> {
        self.states[place] = State::Failed;
        self.ready_around(place)
    }

    /// Notes that a frame has been reconstructed. `kept` is the copy that its neighbours are averaged with. Returns the frames
    /// that can be finished now: itself, or frames beside it.
    pub fn made(
        &mut self,
        place: usize,
        own: O,
        kept: Kept,
        digest: String,
        warnings: Vec<WarningReport>,
    ) -> Vec<Ready<O>> {
        let own = self.plan[place].is_asked.then(|| Box::new((own, warnings)));
        self.states[place] = State::Made { own, digest, kept: Arc::new(kept) };
        self.ready_around(place)
    }

    fn ready_around(&mut self, place: usize) -> Vec<Ready<O>> {
        let around: Vec<usize> = self.plan[place].neighbours.iter().copied().chain([place]).collect();
        let ready = around.iter().filter_map(|&place| self.ready(place)).collect();
        // A frame that is finished now may be the last that needed the one beside it.
        let plan = self.plan;
        for place in around.into_iter().flat_map(|place| plan[place].neighbours.iter().copied().chain([place])) {
            self.let_go(place);
        }
        ready
    }

    /// Takes out a frame if it and all of its neighbours are settled.
    fn ready(&mut self, place: usize) -> Option<Ready<O>> {
        let plan = self.plan;
        let neighbours = &plan[place].neighbours;
        if neighbours.iter().any(|&other| matches!(self.states[other], State::Open)) {
            return None;
        }
        let State::Made { own, digest, .. } = &mut self.states[place] else { return None };
        let ((own, warnings), digest) = (*own.take()?, digest.clone());
        let result = |&other: &usize| match &self.states[other] {
            State::Made { digest, kept, .. } => Some((digest.clone(), Arc::clone(kept))),
            State::Open | State::Failed | State::Gone => None,
        };
        Some(Ready { place, own, digest, neighbours: neighbours.iter().map(result).collect(), warnings })
    }

    /// Drops the mesh of a frame that nothing needs any more.
    fn let_go(&mut self, place: usize) {
        let is_over = |place: usize| match &self.states[place] {
            State::Open => false,
            State::Made { own, .. } => own.is_none(),
            State::Failed | State::Gone => true,
        };
        if is_over(place) && self.plan[place].neighbours.iter().all(|&other| is_over(other)) {
            self.states[place] = State::Gone;
        }
    }
}

/// For each frame of a plan whose earlier result can be kept, that result. `digests` are those of the frames' pictures, `None`
/// where they cannot be read.
pub fn kept<'j>(job: &'j Job, plan: &[Planned], digests: &[Option<String>]) -> Vec<Option<&'j FrameReport>> {
    let kept = |planned: &Planned, digest: &Option<String>| {
        let neighbours = planned.neighbours.iter().map(|&other| digests[other].clone());
        let fingerprint = job.fingerprint(digest.as_deref()?, neighbours);
        job.kept(planned.frame, &fingerprint).filter(|_| planned.is_asked)
    };
    plan.iter().zip(digests).map(|(planned, digest)| kept(planned, digest)).collect()
}

/// The digests of all frames of a plan.
pub fn digests(job: &Job, plan: &[Planned]) -> Result<Vec<Option<String>>, Failure> {
    let digest = |planned: &Planned| match job.read(planned.frame) {
        Ok(files) => Ok(Some(Job::digest(&files))),
        Err(Failure::Cancelled) => Err(Failure::Cancelled),
        // The frame fails again, with its message, when it is made.
        Err(_) => Ok(None),
    };
    plan.iter().map(digest).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frames(count: u32) -> Vec<SceneFrame> {
        (0..count).map(|index| SceneFrame { index, images: Vec::new(), masks: None }).collect()
    }

    fn held(waiting: &Waiting<u32>) -> usize {
        waiting.states.iter().filter(|state| matches!(state, State::Made { .. })).count()
    }

    #[test]
    fn the_meshes_of_a_take_are_held_as_long_as_frames_beside_them_need_them() {
        let frames = frames(40);
        let plan = plan(&frames, |_| true, false);
        for fails in [None, Some(7)] {
            let (mut waiting, mut finished) = (Waiting::new(&plan), Vec::new());
            for place in 0..plan.len() {
                let ready = if fails == Some(place) {
                    waiting.failed(place)
                } else {
                    waiting.made(place, place as u32, Kept::default(), place.to_string(), Vec::new())
                };
                finished.extend(ready.into_iter().map(|ready| (ready.own, ready.neighbours.iter().flatten().count())));
                // The frame that waits for the next one, and the one beside it.
                assert!(held(&waiting) <= 2, "{place}: {}", held(&waiting));
            }
            assert_eq!(held(&waiting), 0);
            let made = |place: &u32| *place < 40 && fails != Some(*place as usize);
            let beside = |place: u32| [place.wrapping_sub(1), place + 1].iter().filter(|other| made(other)).count();
            let expected: Vec<(u32, usize)> = (0..40).filter(made).map(|place| (place, beside(place))).collect();
            assert_eq!(finished, expected);
        }
    }
}
