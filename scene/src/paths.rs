//! Paths as scene.json has them: with `/` between folders, on every system.

use std::path::{MAIN_SEPARATOR, Path, PathBuf};

/// A path of a scene.json, relative to its folder. Programs on Windows write `\`, which therefore separates folders on every
/// system.
pub fn resolve(folder: &Path, written: &Path) -> PathBuf {
    match written.to_str() {
        Some(text) if text.contains('\\') => folder.join(text.replace('\\', "/")),
        _ => folder.join(written),
    }
}

/// A path of this system as scene.json has it.
pub fn written(path: &Path) -> String {
    let text = path.to_string_lossy();
    if MAIN_SEPARATOR == '/' { text.into_owned() } else { without_backslashes(&text) }
}

/// A path of Windows with `/` between folders. The prefix of paths without a limit of their length, `\\?\`, is removed,
/// because such paths do not know `/`.
fn without_backslashes(path: &str) -> String {
    let share = path.strip_prefix(r"\\?\UNC\").map(|share| format!("//{share}"));
    share.unwrap_or_else(|| path.strip_prefix(r"\\?\").unwrap_or(path).to_owned()).replace('\\', "/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_slashes_separate_folders() {
        for text in ["images/a.png", r"images\a.png"] {
            assert_eq!(resolve(Path::new("scene"), Path::new(text)), Path::new("scene").join("images").join("a.png"));
        }
    }

    #[test]
    fn paths_of_windows_are_written_with_slashes() {
        let paths = [
            (r"images\a b.png", "images/a b.png"),
            (r"..\scene\ä.png", "../scene/ä.png"),
            (r"D:\take\a.png", "D:/take/a.png"),
            (r"\\?\D:\take\a.png", "D:/take/a.png"),
            (r"\\server\share\a.png", "//server/share/a.png"),
            (r"\\?\UNC\server\share\a.png", "//server/share/a.png"),
            ("images/a.png", "images/a.png"),
        ];
        for (path, expected) in paths {
            assert_eq!(without_backslashes(path), expected);
        }
    }
}
