//! Arranges views by cameras and instants. Most sources hold one instant; files of moving scenes hold many, in which the
//! same cameras occur again and again.

use super::view::ImportedView;

/// Fewest views of a frame that can be reconstructed.
const FEWEST: usize = 3;

/// Views by their place in a list.
#[derive(Debug, PartialEq, Eq)]
pub struct Clip {
    /// The first view of every camera.
    pub cameras: Vec<usize>,
    /// The views of every instant in the order of time, one per camera, none where it has no picture then.
    pub frames: Vec<Vec<Option<usize>>>,
}

/// Finds cameras and instants.
pub fn arrange(views: &[ImportedView]) -> Result<Clip, String> {
    let mut times: Vec<f64> = views.iter().filter_map(|view| view.time).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let [first, .., last] = times[..] else {
        return Ok(Clip { cameras: (0..views.len()).collect(), frames: vec![(0..views.len()).map(Some).collect()] });
    };
    let mut cameras: Vec<usize> = Vec::new();
    let mut frames: Vec<Vec<Option<usize>>> = vec![Vec::new(); times.len()];
    for (i, view) in views.iter().enumerate() {
        let frame = view.time.and_then(|time| times.iter().position(|&t| t == time));
        let frame = frame.ok_or_else(|| {
            format!("frame `{}` has no time, but others have: add it, or remove that of the others", view.name)
        })?;
        let camera = cameras.iter().position(|&first| views[first].camera == view.camera).unwrap_or(cameras.len());
        if camera == cameras.len() {
            cameras.push(i);
        }
        let slots = &mut frames[frame];
        slots.resize(slots.len().max(camera + 1), None);
        if let Some(other) = slots[camera].replace(i) {
            return Err(format!(
                "frames `{}` and `{}` have the same camera at the same time: correct one of them",
                views[other].name, view.name
            ));
        }
    }
    if frames.iter().all(|slots| slots.iter().flatten().count() < FEWEST) {
        return Err(format!(
            "the frames have {} different times, from {first} to {last}, and no instant has {FEWEST} views: a moving scene \
             needs cameras that record at the same time",
            times.len()
        ));
    }
    for slots in &mut frames {
        slots.resize(cameras.len(), None);
    }
    Ok(Clip { cameras, frames })
}
