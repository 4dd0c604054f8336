//! Arranges views by cameras and instants. Most sources hold one instant; files of moving scenes hold many, in which the
//! same cameras occur again and again.

use super::{notes::Notes, view::ImportedView};

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

/// Most names or numbers in a note.
const MOST_LISTED: usize = 5;

impl Clip {
    /// Tells of the frames, the numbers that are missing between them, and the cameras that lack pictures.
    pub fn note(&self, views: &[ImportedView], notes: &mut Notes) {
        if self.frames.len() < 2 {
            return;
        }
        notes.add(format!(
            "{} pictures with different times are {} frames of {} cameras, in the order of time; frames per second are \
             unknown",
            views.len(),
            self.frames.len(),
            self.cameras.len()
        ));
        let times: Vec<f64> =
            self.frames.iter().filter_map(|slots| views[slots.iter().flatten().next().copied()?].time).collect();
        let gaps: Vec<String> = gaps(&times).into_iter().map(|[a, b]| format!("between {a} and {b}")).collect();
        if !gaps.is_empty() {
            notes.add(format!("the numbers of the pictures have gaps, which frames do not: {}", few(&gaps)));
        }
        let lacking = |(place, &first): (usize, &usize)| {
            let count = self.frames.iter().filter(|slots| slots[place].is_none()).count();
            (count > 0).then(|| format!("`{}` {count}", views[first].name))
        };
        let lacking: Vec<String> = self.cameras.iter().enumerate().filter_map(lacking).collect();
        if !lacking.is_empty() {
            notes.add(format!(
                "cameras without a picture in some of the {} frames, and in how many: {}",
                self.frames.len(),
                few(&lacking)
            ));
        }
    }
}

/// Neighbouring times that are whole numbers and more than the usual step apart.
fn gaps(times: &[f64]) -> Vec<[f64; 2]> {
    if times.iter().any(|&time| time != libm::floor(time)) {
        return Vec::new();
    }
    let steps: Vec<[f64; 2]> = times.windows(2).map(|pair| [pair[0], pair[1]]).collect();
    let least = steps.iter().map(|[a, b]| b - a).fold(f64::INFINITY, f64::min);
    steps.into_iter().filter(|[a, b]| b - a > least).collect()
}

/// The first of a list, for a message.
fn few(list: &[String]) -> String {
    let rest = list.len().saturating_sub(MOST_LISTED);
    let first = list[..list.len() - rest].join(", ");
    if rest > 0 { format!("{first}, and {rest} more") } else { first }
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
