//! Frames that are averaged with their neighbours in time: which frames are made, and when each can be finished.
//!
//! A frame is finished when its neighbours are made. It may then ask for the frames beyond them, two frames before and after it
//! ([`pcmvs_core::Frame::look_beyond`]). If the plan has these, the frame waits until they are made. Meshes are held for that.

use crate::{kept::Kept, warning::WarningReport};
use pcmvs_scene::SceneFrame;
use std::{mem::replace, sync::Arc};

/// A frame and what it has to do in this run.
pub struct Planned<'a> {
    pub frame: &'a SceneFrame,
    /// Whether its mesh is written. Other frames are made for the sake of their neighbours.
    pub is_asked: bool,
    /// Places in the plan of the frames before and after it. Empty if every frame is made by itself.
    pub neighbours: Vec<usize>,
    /// Places in the plan of the frames two before and two after it, of those that the plan has.
    pub beyond: [Option<usize>; 2],
}

impl Planned<'_> {
    /// Places in the plan of all frames that may need this one's mesh, and of this one.
    fn around(&self, place: usize) -> Vec<usize> {
        self.neighbours.iter().copied().chain(self.beyond.into_iter().flatten()).chain([place]).collect()
    }
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
        let beyond = if alone { [None; 2] } else { beyond(all, place).map(|other| of(other?)) };
        Planned { frame: &all[place], is_asked: asked[place], neighbours, beyond }
    };
    needed.iter().map(planned).collect()
}

/// The places of the frames before and after one.
fn next_to(all: &[SceneFrame], place: usize) -> impl Iterator<Item = usize> {
    let near = place.saturating_sub(1)..(place + 2).min(all.len());
    near.filter(move |&other| all[other].index.abs_diff(all[place].index) == 1)
}

/// The places in `all` of the frames two before and two after one.
fn beyond(all: &[SceneFrame], place: usize) -> [Option<usize>; 2] {
    let indices = [-2, 2].map(|offset| all[place].index.checked_add_signed(offset));
    indices.map(|index| all.binary_search_by_key(&index?, |frame| frame.index).ok())
}

/// The frames two before and two after one, of `all` frames, which are sorted by index.
pub fn frames_beyond(all: &[SceneFrame], index: u32) -> [Option<&SceneFrame>; 2] {
    let place = all.binary_search_by_key(&index, |frame| frame.index).ok();
    place.map_or([None; 2], |place| beyond(all, place).map(|other| other.map(|other| &all[other])))
}

/// Those of `all` frames that are `asked` for, a sorted list of indices, or at most two frames before or after such a frame,
/// sorted by index.
pub fn with_neighbours(mut all: Vec<SceneFrame>, asked: &[u32]) -> Vec<SceneFrame> {
    let is_asked = |index: u32| asked.binary_search(&index).is_ok();
    let near = |index: u32| index.saturating_sub(2)..=index.saturating_add(2);
    all.retain(|frame| near(frame.index).any(is_asked));
    all.sort_by_key(|frame| frame.index);
    all
}

/// The digest of a frame's pictures, and what the frame has kept for others.
pub type Found = (String, Arc<Kept>);

/// A frame that can be finished. `O` is the frame as it was reconstructed by itself.
pub struct Ready<O> {
    pub place: usize,
    pub own: O,
    pub digest: String,
    /// What was found of its neighbours. `None` if they have no mesh.
    pub neighbours: Vec<Option<Found>>,
    /// Whether it has asked for the frames beyond its neighbours. `None` if that has not been decided.
    pub asks: Option<[bool; 2]>,
    /// What was found of those that it has asked for and the plan has.
    pub beyond: [Option<Found>; 2],
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
    /// It has been reconstructed by itself.
    Made { own: Own<O>, digest: String, kept: Arc<Kept> },
    /// It has failed.
    Failed,
    /// Neither it nor any frame around it needs it any more.
    Gone,
}

/// A frame as it was reconstructed by itself.
enum Own<O> {
    /// It waits for its neighbours and, if `asks` is there, for those of the frames beyond them that it marks.
    Waits { own: Box<(O, Vec<WarningReport>)>, asks: Option<[bool; 2]> },
    /// It has been given out and may come back.
    Out,
    /// It needs no other frame any more.
    Done,
}

impl<'a, O> Waiting<'a, O> {
    pub fn new(plan: &'a [Planned<'a>]) -> Self {
        Self { plan, states: plan.iter().map(|_| State::Open).collect() }
    }

    /// Notes that a frame has failed. Returns the frames that can be finished now.
    pub fn failed(&mut self, place: usize) -> Vec<Ready<O>> {
        self.states[place] = State::Failed;
        self.settled(place)
    }

    /// Notes that a frame has been reconstructed. `kept` is the copy that its neighbours are averaged with. Returns the frames
    /// that can be finished now: itself, or frames around it.
    pub fn made(
        &mut self,
        place: usize,
        own: O,
        kept: Kept,
        digest: String,
        warnings: Vec<WarningReport>,
    ) -> Vec<Ready<O>> {
        let is_asked = self.plan[place].is_asked;
        let own = if is_asked { Own::Waits { own: Box::new((own, warnings)), asks: None } } else { Own::Done };
        self.states[place] = State::Made { own, digest, kept: Arc::new(kept) };
        self.settled(place)
    }

    /// Takes back a frame that asks for frames beyond its neighbours. Returns it if those are settled already.
    pub fn ask_beyond(&mut self, ready: Ready<O>, asks: [bool; 2]) -> Option<Ready<O>> {
        let Ready { place, own: frame, warnings, .. } = ready;
        let State::Made { own, .. } = &mut self.states[place] else { return None };
        *own = Own::Waits { own: Box::new((frame, warnings)), asks: Some(asks) };
        self.ready(place)
    }

    /// Notes that a frame that has been given out needs no other frame any more.
    pub fn done(&mut self, place: usize) {
        if let State::Made { own, .. } = &mut self.states[place] {
            *own = Own::Done;
        }
        self.let_go_around(place);
    }

    fn settled(&mut self, place: usize) -> Vec<Ready<O>> {
        let around = self.plan[place].around(place);
        let ready = around.into_iter().filter_map(|place| self.ready(place)).collect();
        self.let_go_around(place);
        ready
    }

    /// Takes out a frame if it and all of those that it waits for are settled.
    fn ready(&mut self, place: usize) -> Option<Ready<O>> {
        let Planned { neighbours, beyond, .. } = &self.plan[place];
        let State::Made { own: Own::Waits { asks, .. }, .. } = &self.states[place] else { return None };
        let asks = *asks;
        let beyond = [0, 1].map(|side: usize| beyond[side].filter(|_| asks.is_some_and(|asks| asks[side])));
        let mut others = neighbours.iter().chain(beyond.iter().flatten());
        if others.any(|&other| matches!(self.states[other], State::Open)) {
            return None;
        }
        let result = |other: usize| match &self.states[other] {
            State::Made { digest, kept, .. } => Some((digest.clone(), Arc::clone(kept))),
            State::Open | State::Failed | State::Gone => None,
        };
        let neighbours = neighbours.iter().map(|&other| result(other)).collect();
        let beyond = beyond.map(|other| result(other?));
        let State::Made { own, digest, .. } = &mut self.states[place] else { return None };
        let digest = digest.clone();
        let Own::Waits { own, .. } = replace(own, Own::Out) else { return None };
        let (own, warnings) = *own;
        Some(Ready { place, own, digest, neighbours, asks, beyond, warnings })
    }

    /// Drops the meshes that nothing needs any more, of a frame and those around it.
    fn let_go_around(&mut self, place: usize) {
        let plan = self.plan;
        let is_over = |state: &State<O>| match state {
            State::Open => false,
            State::Made { own, .. } => matches!(own, Own::Done),
            State::Failed | State::Gone => true,
        };
        for place in plan[place].around(place) {
            if plan[place].around(place).iter().all(|&other| is_over(&self.states[other])) {
                self.states[place] = State::Gone;
            }
        }
    }
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
                ready.iter().for_each(|ready| waiting.done(ready.place));
                finished.extend(ready.into_iter().map(|ready| (ready.own, ready.neighbours.iter().flatten().count())));
                // The frame that waits for the next one, and the two before it.
                assert!(held(&waiting) <= 3, "{place}: {}", held(&waiting));
            }
            assert_eq!(held(&waiting), 0);
            let made = |place: &u32| *place < 40 && fails != Some(*place as usize);
            let beside = |place: u32| [place.wrapping_sub(1), place + 1].iter().filter(|other| made(other)).count();
            let expected: Vec<(u32, usize)> = (0..40).filter(made).map(|place| (place, beside(place))).collect();
            assert_eq!(finished, expected);
        }
    }

    #[test]
    fn a_frame_that_asks_for_frames_beyond_its_neighbours_gets_them() {
        let frames = frames(7);
        let plan = plan(&frames, |_| true, false);
        // Frames in their order, and late ones first.
        for order in [[0, 1, 2, 3, 4, 5, 6], [6, 5, 4, 3, 2, 1, 0], [1, 3, 0, 2, 5, 4, 6]] {
            for fails in [None, Some(0), Some(4)] {
                let (mut waiting, mut finished) = (Waiting::new(&plan), Vec::new());
                for place in order {
                    let mut ready = if fails == Some(place) {
                        waiting.failed(place)
                    } else {
                        waiting.made(place, place as u32, Kept::default(), place.to_string(), Vec::new())
                    };
                    while let Some(next) = ready.pop() {
                        if next.place == 2 && next.asks.is_none() {
                            ready.extend(waiting.ask_beyond(next, [true; 2]));
                        } else {
                            waiting.done(next.place);
                            finished.push((next.own, next.beyond.map(|found| found.map(|(digest, _)| digest))));
                        }
                    }
                }
                finished.sort();
                let found = |place: usize| Some(place.to_string()).filter(|_| fails != Some(place));
                let beyond = |place: usize| if place == 2 { [found(0), found(4)] } else { [None, None] };
                let made = (0..7).filter(|&place| fails != Some(place));
                let expected: Vec<_> = made.map(|place| (place as u32, beyond(place))).collect();
                assert_eq!(finished, expected, "{order:?} {fails:?}");
                assert_eq!(held(&waiting), 0, "{order:?} {fails:?}");
            }
        }
    }

    #[test]
    fn frames_beyond_the_neighbours_are_read_but_not_planned() {
        let all = with_neighbours(frames(9), &[4]);
        assert_eq!(all.iter().map(|frame| frame.index).collect::<Vec<_>>(), [2, 3, 4, 5, 6]);
        let plan = plan(&all, |index| index == 4, false);
        let planned: Vec<_> = plan.iter().map(|planned| (planned.frame.index, planned.beyond)).collect();
        assert_eq!(planned, [(3, [None, Some(2)]), (4, [None; 2]), (5, [Some(0), None])]);
        let beyond = |index| frames_beyond(&all, index).map(|frame| frame.map(|frame| frame.index));
        assert_eq!((beyond(4), beyond(3), beyond(9)), ([Some(2), Some(6)], [None, Some(5)], [None; 2]));
    }
}
