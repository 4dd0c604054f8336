//! What a video contains: its size, and the times of its pictures.

use super::programs::{Programs, argument, quiet};
use serde::Deserialize;
use std::path::Path;

/// A picture may be off its regular time by this share of the time between two pictures. A picture that was left out moves
/// others by half of that time or more.
const IRREGULAR: f64 = 0.25;

/// Containers in which ffmpeg finds a picture exactly, because they have an index. In others, such as MPEG-TS, it may start at a
/// later picture without a word.
const EXACT: [&str; 2] = ["mp4", "matroska"];

/// The pictures of a video, in the order in which they are shown.
#[derive(Debug)]
pub struct Index {
    /// Width and height.
    pub size: [u32; 2],
    /// Times in units of `unit`, ascending.
    times: Vec<i64>,
    /// In seconds.
    unit: f64,
    /// Whether reading can start at any picture.
    pub can_seek: bool,
}

/// The output of ffprobe.
#[derive(Deserialize)]
struct Found {
    format: Format,
    #[serde(default)]
    streams: Vec<Stream>,
    #[serde(default)]
    packets: Vec<Packet>,
}

#[derive(Deserialize)]
struct Format {
    format_name: String,
}

#[derive(Deserialize)]
struct Stream {
    width: u32,
    height: u32,
    time_base: String,
}

#[derive(Deserialize)]
struct Packet {
    pts: Option<i64>,
    #[serde(default)]
    flags: String,
}

impl Index {
    /// Reads the times of all pictures without decoding them. Their number per second must be constant, because frames are
    /// found by counting.
    pub fn read(programs: &Programs, file: &Path) -> Result<Self, String> {
        if !file.is_file() {
            return Err(String::from("the video does not exist: check its path in scene.json, or write null"));
        }
        let mut command = quiet(&programs.ffprobe);
        command.args(["-v", "error", "-protocol_whitelist", "file", "-select_streams", "v:0", "-of", "json"]);
        command
            .args(["-show_entries", "format=format_name:stream=width,height,time_base:packet=pts,flags"])
            .arg(argument(file));
        let output = command.output().map_err(|e| format!("ffprobe cannot be started ({e})"))?;
        let broken = |why: &str| format!("is no video that ffmpeg reads ({why}): copy or record it again");
        if !output.status.success() {
            return Err(broken(String::from_utf8_lossy(&output.stderr).trim()));
        }
        let found: Found = serde_json::from_slice(&output.stdout).map_err(|e| broken(&e.to_string()))?;
        let Found { format, streams, packets } = found;
        let stream = streams.first().ok_or_else(|| broken("there are no pictures in it"))?;
        let unit = ratio(&stream.time_base).ok_or_else(|| broken("the unit of its times is unknown"))?;
        // Pictures that the container says to discard are not shown.
        let shown = packets.iter().filter(|packet| !packet.flags.contains('D'));
        let times: Option<Vec<i64>> = shown.map(|packet| packet.pts).collect();
        let mut times = times.ok_or("has no times of its pictures: put it into another container, such as MKV")?;
        times.sort_unstable();
        if times.is_empty() {
            return Err(broken("there are no pictures in it"));
        }
        let can_seek = EXACT.iter().any(|name| format.format_name.split(',').any(|other| other == *name));
        let index = Self { size: [stream.width, stream.height], times, unit, can_seek };
        match index.irregular() {
            Some(number) => Err(format!(
                "the time between its pictures is not constant, as at picture {number}, but frames are found by counting \
                 pictures: record or convert it with a constant frame rate"
            )),
            None => Ok(index),
        }
    }

    /// Number of pictures.
    pub fn count(&self) -> usize {
        self.times.len()
    }

    /// Seconds from one picture to the next, on average. A single picture lasts 1 s.
    pub fn period(&self) -> f64 {
        if self.count() < 2 { 1.0 } else { self.ticks() * self.unit }
    }

    fn ticks(&self) -> f64 {
        (self.times[self.count() - 1] - self.times[0]) as f64 / (self.count() - 1).max(1) as f64
    }

    /// The picture that is farthest from its regular time, if that is too far.
    fn irregular(&self) -> Option<usize> {
        let ticks = self.ticks();
        let off = |i: usize| ((self.times[i] - self.times[0]) as f64 - ticks * i as f64).abs();
        let worst = (0..self.count()).max_by(|&a, &b| off(a).total_cmp(&off(b)))?;
        // Containers round times to their unit.
        (off(worst) > IRREGULAR * ticks + 1.0).then_some(worst)
    }

    /// A time in seconds between a picture and the one before it. `None` if the video has to be read from its beginning.
    pub fn before(&self, number: u32) -> Option<f64> {
        let i = if self.can_seek { number as usize } else { 0 };
        let between = (self.times[i.checked_sub(1)?] + self.times[i]) as f64 * 0.5 * self.unit;
        (between > 0.0).then_some(between)
    }
}

/// A fraction such as `1/1000`.
fn ratio(text: &str) -> Option<f64> {
    let (above, below) = text.split_once('/')?;
    let [above, below]: [f64; 2] = [above.parse().ok()?, below.parse().ok()?];
    (above > 0.0 && below > 0.0).then(|| above / below)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn index(times: impl IntoIterator<Item = i64>) -> Index {
        Index { size: [1, 1], times: times.into_iter().collect(), unit: 0.001, can_seek: true }
    }

    #[test]
    fn rounded_times_are_regular_and_a_picture_that_is_left_out_is_not() {
        let rounded = |i: i64| (i * 1000 + 15) / 30;
        assert_eq!(index((0..100).map(rounded)).irregular(), None);
        for missing in [1, 2, 50, 97, 98] {
            assert!(index((0..100).filter(|&i| i != missing).map(rounded)).irregular().is_some(), "{missing}");
        }
        assert_eq!(index([5]).irregular(), None);
    }

    #[test]
    fn a_time_before_a_picture_is_after_the_one_before_it() {
        let index = index([0, 33, 67]);
        assert_eq!([0, 1, 2].map(|i| index.before(i)), [None, Some(0.0165), Some(0.05)]);
    }
}
