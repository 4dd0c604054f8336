//! The compilers of Windows programs, and Wine, which runs them.

use crate::{
    Result,
    abi::problem,
    process::{program, root, run, target},
};
use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

pub const TRIPLE: &str = "x86_64-pc-windows-gnu";
pub const CC: &str = "x86_64-w64-mingw32-gcc";
/// The compiler whose library has threads.
pub const CXX: &str = "x86_64-w64-mingw32-g++-posix";

/// Folder of what is built and written.
pub fn work() -> PathBuf {
    target().join("windows")
}

/// Folder of Wine's drive C: and of its settings.
pub fn prefix() -> PathBuf {
    work().join("wine")
}

/// Folder of what Cargo has built for Windows.
pub fn built() -> PathBuf {
    target().join(TRIPLE).join("release")
}

/// An empty folder for the files of a check. Its path has spaces and letters that are not ASCII.
pub fn empty(name: &str) -> Result<PathBuf> {
    let folder = work().join("Aufnahme für Test").join(name);
    if folder.exists() {
        fs::remove_dir_all(&folder).map_err(problem(&folder))?;
    }
    fs::create_dir_all(&folder).map_err(problem(&folder))?;
    Ok(folder)
}

/// The command that runs a program by Wine. What Wine 8 lacks is built beside the program.
pub fn wine(exe: &Path) -> Result<Command> {
    let missing = exe.with_file_name("bcryptprimitives.dll");
    let mut cc = program(CC, "-shared -o");
    run(cc.arg(missing).arg(root().join("tests/windows/bcryptprimitives.c")).arg("-ladvapi32"))?;
    // The command line's meshoptimizer is in C++, whose libraries come with the compiler.
    let mut folders = vec![windows_path(&built())];
    for library in ["libstdc++-6.dll", "libgcc_s_seh-1.dll", "libwinpthread-1.dll"] {
        let path = run(program(CXX, "").arg(format!("-print-file-name={library}")))?;
        folders.extend(Path::new(path.trim()).parent().map(windows_path));
    }
    let mut wine = program("wine", "");
    // Wine makes the last folder of this path only.
    fs::create_dir_all(prefix()).map_err(|e| format!("{}: {e}", prefix().display()))?;
    wine.arg(exe).env("WINEPATH", folders.join(";")).env("WINEDEBUG", "-all").env("WINEPREFIX", prefix());
    // Without it names that are not ASCII get lost.
    wine.env("LC_ALL", "C.UTF-8");
    Ok(wine)
}

/// A path of this machine as Windows programs see it.
pub fn windows_path(path: &Path) -> String {
    format!("Z:{}", path.display()).replace('/', "\\")
}

/// Fails unless two files have the same bytes.
pub fn compare(here: &Path, there: &Path) -> Result<()> {
    let read = |path: &Path| fs::read(path).map_err(problem(path));
    if read(here)? == read(there)? {
        return Ok(());
    }
    Err(format!("{} and {} differ", here.display(), there.display()))
}
