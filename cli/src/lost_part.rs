//! Parts that a frame has lost and that frames before and after it have. The result of a frame depends on itself, its neighbours
//! and, if one of these lacks a part that the other has, on the frame beyond that one.

use crate::{
    frame::{Job, Own, Pair},
    kept::Kept,
    neighbours::{Found, Planned, Ready, Waiting, frames_beyond},
    warning::WarningReport,
};
use pcmvs_scene::{Failure, SceneFrame};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// What looking for lost parts needs of a run.
pub struct Search<'r, 'a> {
    pub job: &'a Job<'a>,
    pub plan: &'r [Planned<'a>],
    pub waiting: &'r Mutex<Waiting<'r, Own<'a>>>,
    /// Held while files are read.
    pub turn: &'r Mutex<usize>,
}

/// A frame beyond a frame's neighbours. Nothing is found of it if it has failed.
pub struct Beyond<'a> {
    pub frame: &'a SceneFrame,
    pub found: Option<Found>,
}

impl<'a> Beyond<'a> {
    fn made(&self) -> Option<(&'a SceneFrame, &Kept)> {
        self.found.as_ref().map(|(_, kept)| (self.frame, &**kept))
    }
}

impl<'a> Search<'_, 'a> {
    /// Decides whether a frame asks for the frames beyond its neighbours. `None` if it has to wait for them.
    pub fn ask(&self, ready: Ready<Own<'a>>) -> Result<Option<Ready<Own<'a>>>, Failure> {
        if ready.asks.is_some() {
            return Ok(Some(ready));
        }
        let [Some((_, before)), Some((_, after))] = &ready.neighbours[..] else { return Ok(Some(ready)) };
        let asks = ready.own.look_beyond(self.job, [before, after])?;
        if asks == [false; 2] { Ok(Some(ready)) } else { Ok(lock(self.waiting).ask_beyond(ready, asks)) }
    }

    /// The frames that a frame has asked for, of those that the take has. If the plan does not have one, it is made here.
    pub fn beyond(&self, ready: &mut Ready<Own<'a>>) -> Result<[Option<Beyond<'a>>; 2], Failure> {
        let Planned { frame, beyond, .. } = &self.plan[ready.place];
        let all = frames_beyond(&self.job.scene.frames, frame.index);
        let mut side = |side: usize| -> Result<Option<Beyond<'a>>, Failure> {
            let asked = ready.asks.is_some_and(|asks| asks[side]);
            let Some(other) = all[side].filter(|_| asked) else { return Ok(None) };
            let found = if beyond[side].is_some() { ready.beyond[side].take() } else { self.made(other, frame.index)? };
            Ok(Some(Beyond { frame: other, found }))
        };
        Ok([side(0)?, side(1)?])
    }

    /// Makes a frame for the sake of another one.
    fn made(&self, frame: &'a SceneFrame, sake: u32) -> Result<Option<Found>, Failure> {
        let job = self.job;
        job.console.line(&format!(
            "frame {} is made, too, because frame {sake} may lack a part together with the frame between them",
            frame.index
        ));
        let turn = lock(self.turn);
        let files = job.read(frame);
        drop(turn);
        let mut warnings = Vec::new();
        let made = files.and_then(|files| {
            let digest = Job::digest(&files);
            Ok((digest, job.reconstruct(frame, files, &mut warnings)?))
        });
        job.say(&warnings);
        match made {
            Ok((digest, own)) => Ok(Some((digest, Arc::new(own.kept())))),
            Err(Failure::Cancelled) => Err(Failure::Cancelled),
            Err(failure) => {
                job.console.line(&format!("{failure}: frame {sake} is made without it"));
                Ok(None)
            }
        }
    }

    /// Makes a frame again if it lacks a part that frames before and after it have, and its pictures show that part.
    pub fn restored(
        &self,
        place: usize,
        own: Own<'a>,
        neighbours: &[Option<Found>],
        [before_last, after_next]: &[Option<Beyond<'a>>; 2],
        warnings: &mut Vec<WarningReport>,
    ) -> Result<Own<'a>, Failure> {
        let [Some((_, kept_before)), Some((_, kept_after))] = neighbours else { return Ok(own) };
        let beside = |side: usize| self.plan[self.plan[place].neighbours[side]].frame;
        let (before, after) = ((beside(0), &**kept_before), (beside(1), &**kept_after));
        let pair = |(before, kept_before), (after, kept_after)| Pair {
            frames: [before, after],
            kept: [kept_before, kept_after],
        };
        // First the nearest frames. A frame beyond a neighbour has what both have lost, so that it may give back more.
        let mut pairs = vec![pair(before, after)];
        pairs.extend(after_next.as_ref().and_then(Beyond::made).map(|after| pair(before, after)));
        pairs.extend(before_last.as_ref().and_then(Beyond::made).map(|before| pair(before, after)));
        let read = |frames: [&'a SceneFrame; 3]| {
            let _turn = lock(self.turn);
            let [own, before, after] = frames.map(|frame| self.job.read(frame));
            Ok([own?, before?, after?])
        };
        self.job.restored(own, &pairs, read, warnings)
    }
}

/// Locks a value. A panic in another frame has not left it half-changed.
pub fn lock<T>(value: &Mutex<T>) -> MutexGuard<'_, T> {
    value.lock().unwrap_or_else(PoisonError::into_inner)
}
