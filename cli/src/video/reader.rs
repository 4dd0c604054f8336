//! A process that decodes a video from one of its pictures on.

use super::{
    index::Index,
    programs::{Programs, argument, quiet},
};
use std::{
    io::Read,
    path::Path,
    process::{Child, ChildStdout, Stdio},
    thread::{self, JoinHandle},
};

/// Conversion to RGB that is rounded exactly and in the same way on all machines.
const CONVERSION: &str = "bicubic+accurate_rnd+full_chroma_int+full_chroma_inp+bitexact";
/// Most bytes of a message that are kept.
const MESSAGE: usize = 1 << 10;

/// Ends the process when it is dropped.
#[derive(Debug)]
pub struct Reader {
    /// Number of the picture that is read next.
    pub next: u32,
    bytes: usize,
    process: Child,
    output: ChildStdout,
    errors: Option<JoinHandle<String>>,
}

impl Reader {
    /// Starts to decode at a picture, or at the beginning where that is not possible.
    pub fn start(programs: &Programs, file: &Path, index: &Index, number: u32) -> Result<Self, String> {
        let mut command = quiet(&programs.ffmpeg);
        // One thread per video: there are many of them, and each thread holds pictures. Damage ends the process, which would
        // otherwise make pictures up.
        command.args(["-v", "error", "-nostdin", "-xerror", "-filter_threads", "1"]);
        command.args(["-protocol_whitelist", "file", "-threads", "1", "-noautorotate", "-err_detect", "explode"]);
        let seek = index.before(number);
        if let Some(seconds) = seek {
            // Pictures before this time are decoded and dropped, so that the first one is exact.
            command.args(["-seek_timestamp", "1", "-ss", &format!("{seconds:.6}")]);
        }
        command.arg("-i").arg(argument(file)).args(["-map", "0:v:0", "-fps_mode", "passthrough"]);
        command.args(["-sws_flags", CONVERSION, "-pix_fmt", "rgb24"]);
        // Every picture is passed on at once, so that those before damage are there.
        command.args(["-flush_packets", "1", "-f", "rawvideo", "pipe:1"]);
        let cannot_start = |e: std::io::Error| format!("ffmpeg cannot be started: {e}");
        let mut process = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().map_err(cannot_start)?;
        let (output, errors) = (process.stdout.take(), process.stderr.take());
        let output = output.ok_or("ffmpeg has no output")?;
        // All messages have to be read, or the process would wait.
        let errors = errors.map(|mut errors| {
            thread::spawn(move || {
                let (mut kept, mut buffer) = (Vec::new(), [0; 1 << 12]);
                while let Ok(count @ 1..) = errors.read(&mut buffer) {
                    kept.extend(&buffer[..count.min(MESSAGE - kept.len())]);
                }
                String::from_utf8_lossy(&kept).trim().replace('\n', "; ")
            })
        });
        let [width, height] = index.size.map(|size| size as usize);
        Ok(Self { next: if seek.is_some() { number } else { 0 }, bytes: 3 * width * height, process, output, errors })
    }

    /// Reads the next picture, as packed RGB.
    pub fn read(&mut self, pixels: &mut Vec<u8>) -> Result<(), String> {
        pixels.resize(self.bytes, 0);
        if let Err(error) = self.output.read_exact(pixels) {
            self.end();
            let message = self.errors.take().and_then(|errors| errors.join().ok()).unwrap_or_default();
            return Err(if message.is_empty() { error.to_string() } else { message });
        }
        self.next += 1;
        Ok(())
    }

    fn end(&mut self) {
        // The process may have ended by itself.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Drop for Reader {
    fn drop(&mut self) {
        self.end();
    }
}
