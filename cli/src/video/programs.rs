//! The programs that read videos.

use std::{
    env,
    ffi::{OsStr, OsString},
    path::Path,
    process::{Command, Stdio},
};

/// Environment variable with the path of ffmpeg. ffprobe is expected in the same folder.
const VARIABLE: &str = "PCMVS_FFMPEG";

/// The programs that read videos.
#[derive(Debug, Clone)]
pub struct Programs {
    pub ffmpeg: OsString,
    pub ffprobe: OsString,
}

impl Programs {
    /// Finds them, and starts each once to see that it runs.
    pub fn find() -> Result<Self, String> {
        let ffmpeg = env::var_os(VARIABLE).unwrap_or_else(|| OsString::from("ffmpeg"));
        let path = Path::new(&ffmpeg);
        let mut name = OsString::from("ffprobe");
        if let Some(extension) = path.extension() {
            name.push(".");
            name.push(extension);
        }
        let ffprobe = path.with_file_name(name).into_os_string();
        for program in [&ffmpeg, &ffprobe] {
            let mut command = quiet(program);
            let started = command.arg("-version").stdout(Stdio::null()).stderr(Stdio::null()).status();
            if !started.is_ok_and(|status| status.success()) {
                return Err(format!(
                    "the pictures are videos, but the program `{}` that reads them cannot be started: install ffmpeg, or set \
                     {VARIABLE} to its path",
                    Path::new(program).display()
                ));
            }
        }
        Ok(Self { ffmpeg, ffprobe })
    }
}

/// A program that reads nothing from the terminal, and that Ctrl-C in the terminal does not reach: this program ends it.
pub fn quiet(program: &OsStr) -> Command {
    let mut command = Command::new(program);
    command.stdin(Stdio::null());
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    command
}

/// A video as an argument. Without the protocol a name could be taken for an option or an address.
pub fn argument(path: &Path) -> OsString {
    let mut argument = OsString::from("file:");
    argument.push(path);
    argument
}
