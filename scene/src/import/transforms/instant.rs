//! The instants of a file's frames. A scene's cameras look at the same instant.

use crate::import::values::{find, number};
use serde_json::{Map, Value};

/// Keys of the time of a frame, which data sets of moving scenes write.
pub const KEYS: &[&str] = &["time", "time_id", "frame_time"];

/// Refuses frames of different instants: as cameras of one frame they would contradict each other.
pub fn check(frames: &[&Map<String, Value>]) -> Result<(), String> {
    for key in KEYS {
        let times = frames.iter().filter_map(|frame| find(frame, &[key])).map(|(key, value)| number(&key, value));
        let mut times: Vec<f64> = times.collect::<Result<_, _>>()?;
        times.sort_by(f64::total_cmp);
        times.dedup();
        if let [first, .., last] = times[..] {
            return Err(format!(
                "the frames have {} different values of `{key}`, from {first} to {last}, but import reads one instant: \
                 keep the frames of one instant in this file, and import every instant by itself",
                times.len()
            ));
        }
    }
    Ok(())
}
