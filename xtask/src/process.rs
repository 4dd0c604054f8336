//! Runs other programs. Their output is shown only if they fail.

use crate::Result;
use std::{
    env,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

/// The workspace's folder.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new("."))
}

/// Cargo's target folder.
pub fn target() -> PathBuf {
    env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from)
}

/// A program that runs in the workspace's folder. Arguments are separated by spaces.
pub fn program(name: impl AsRef<std::ffi::OsStr>, arguments: &str) -> Command {
    let mut command = Command::new(name);
    command.current_dir(root()).args(arguments.split_whitespace()).stdin(Stdio::null());
    command
}

/// The Cargo that runs this task.
pub fn cargo(arguments: &str) -> Command {
    let mut command = program(env::var_os("CARGO").unwrap_or("cargo".into()), arguments);
    cargo_environment(&mut command);
    command
}

/// Removes the variables that the outer `cargo run` sets for this package, which would make a nested Cargo rebuild
/// everything.
pub fn cargo_environment(command: &mut Command) -> &mut Command {
    for (name, _) in env::vars_os() {
        if name.to_string_lossy().starts_with("CARGO_PKG_") || name == "CARGO_MANIFEST_DIR" {
            command.env_remove(name);
        }
    }
    command
}

/// Runs a program and returns its output. If it fails, the error contains the command and all of its output.
pub fn run(command: &mut Command) -> Result<String> {
    let line = describe(command);
    let output = command.output().map_err(|e| format!("{line}\ncannot be run: {e}"))?;
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    if output.status.success() {
        return Ok(text(&output.stdout));
    }
    Err(format!("{line}\nfailed ({}):\n{}{}", output.status, text(&output.stdout), text(&output.stderr)))
}

/// Runs a program that shows its progress itself.
pub fn show(command: &mut Command) -> Result<()> {
    let line = describe(command);
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("{line}\nfailed ({status})")),
        Err(e) => Err(format!("{line}\ncannot be run: {e}")),
    }
}

fn describe(command: &Command) -> String {
    let mut words: Vec<String> = Vec::new();
    for (name, value) in command.get_envs() {
        if let Some(value) = value {
            words.push(format!("{}={:?}", name.display(), value.display().to_string()));
        }
    }
    words.extend([command.get_program()].into_iter().chain(command.get_args()).map(|w| w.display().to_string()));
    words.join(" ")
}
