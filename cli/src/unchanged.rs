//! Results of an earlier run for which nothing has changed.

use crate::{frame::Job, neighbours::Planned, report::FrameReport};
use pcmvs_scene::{Failure, SceneFrame};
use std::collections::BTreeMap;

/// The digests of frames' pictures by index, `None` where they cannot be read.
type Digests = BTreeMap<u32, Option<String>>;

/// For each frame of a plan whose earlier result can be kept, that result.
pub fn kept<'j>(job: &'j Job, plan: &[Planned]) -> Result<Vec<Option<&'j FrameReport>>, Failure> {
    let mut digests = Digests::new();
    for planned in plan {
        digests.insert(planned.frame.index, digest(job, planned.frame)?);
    }
    let mut kept = Vec::new();
    for planned in plan {
        let earlier = job.earlier.frames.iter().find(|e| planned.is_asked && e.index == planned.frame.index);
        let Some(earlier) = earlier else {
            kept.push(None);
            continue;
        };
        // These are read for the few frames that have asked for them.
        for index in &earlier.beyond {
            let frame = job.scene.frames.iter().find(|frame| frame.index == *index && !digests.contains_key(index));
            if let Some(frame) = frame {
                digests.insert(*index, digest(job, frame)?);
            }
        }
        kept.push(is_unchanged(job, planned, plan, earlier, &digests).then_some(earlier));
    }
    Ok(kept)
}

fn is_unchanged(job: &Job, planned: &Planned, plan: &[Planned], earlier: &FrameReport, digests: &Digests) -> bool {
    let of = |index: u32| digests.get(&index).cloned().flatten();
    let Some(own) = of(planned.frame.index) else { return false };
    let neighbours = planned.neighbours.iter().map(|&other| plan[other].frame.index);
    let others = neighbours.chain(earlier.beyond.iter().copied());
    earlier.fingerprint == job.fingerprint(&own, others.map(of)) && job.is_still_there(earlier)
}

fn digest(job: &Job, frame: &SceneFrame) -> Result<Option<String>, Failure> {
    match job.read(frame) {
        Ok(files) => Ok(Some(Job::digest(&files))),
        Err(Failure::Cancelled) => Err(Failure::Cancelled),
        // The frame fails again, with its message, when it is made.
        Err(_) => Ok(None),
    }
}
