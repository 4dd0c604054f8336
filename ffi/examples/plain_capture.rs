//! Renders a small capture as plain files for the examples in C. Usage:
//! plain_capture FOLDER [VIEWS WIDTH HEIGHT | turned | FRAMES | lacking]
//!
//! `turned` writes a capture of which camera 4 was turned after it was calibrated. FRAMES writes a capture of that many frames:
//! frame 0 to the folder FOLDER0, frame 1 to FOLDER1, and so on. `lacking` does the same with three frames, of which the masks of
//! the second one lack a part.

use std::{env, io, path::Path};
use studio::Capture;

#[path = "../tests/common/plain.rs"]
mod plain;

fn main() -> io::Result<()> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let folder = arguments.first().ok_or_else(|| io::Error::other("name a folder"))?;
    let numbers: Option<Vec<u32>> = arguments.iter().skip(1).map(|a| a.parse().ok()).collect();
    let capture = match numbers.as_deref() {
        Some([]) => plain::capture(10, 160, 120),
        Some(&[views, width, height]) => plain::capture(views, width, height),
        Some(&[frames]) => return write_frames(&plain::take(frames), folder),
        None if arguments[1..] == ["lacking"] => return write_frames(&plain::lacking(), folder),
        None if arguments[1..] == ["turned"] => plain::one_turned(),
        _ => {
            return Err(io::Error::other(
                "usage: plain_capture FOLDER [VIEWS WIDTH HEIGHT | turned | FRAMES | lacking]",
            ));
        }
    };
    plain::write(&capture, 0, Path::new(folder))
}

/// Writes every frame to a folder of its own, whose name ends with the frame's number.
fn write_frames(capture: &Capture, folder: &str) -> io::Result<()> {
    (0..capture.frames.len()).try_for_each(|frame| plain::write(capture, frame, Path::new(&format!("{folder}{frame}"))))
}
