//! Camera names that are safe as file names on every system.

use super::{notes::Notes, source::without_extension};
use std::collections::BTreeSet;

/// Longest name in bytes. File systems allow 255, of which folders, extensions and temporary names need a few.
const LONGEST: usize = 160;
/// Names that Windows keeps for devices, whatever extension follows.
const RESERVED: [&str; 6] = ["con", "prn", "aux", "nul", "conin$", "conout$"];

/// A camera name from the path of its picture, without a picture's extension. Folders become part of the name.
pub fn name_of(path: &str) -> String {
    without_extension(path)
        .split(['/', '\\'])
        .filter(|part| !["", ".", ".."].contains(part))
        .collect::<Vec<_>>()
        .join("_")
}

/// One file name component from any text.
fn component(name: &str) -> String {
    let parts = name.split(['/', '\\']).filter(|part| !["", ".", ".."].contains(part)).collect::<Vec<_>>().join("_");
    let mut safe: String = parts.chars().map(|c| if is_safe(c) { c } else { '_' }).collect();
    let mut end = safe.len().min(LONGEST);
    while !safe.is_char_boundary(end) {
        end -= 1;
    }
    safe.truncate(end);
    // A leading dot hides a file. Windows drops dots and spaces at the end.
    let safe = safe.trim().trim_start_matches('.').trim_end_matches(['.', ' ']).trim();
    let stem = safe.split('.').next().unwrap_or_default().trim().to_lowercase();
    let port = ["com", "lpt"].iter().find_map(|port| stem.strip_prefix(port));
    let is_port =
        port.is_some_and(|n| matches!(n, "1" | "2" | "3" | "4" | "5" | "6" | "7" | "8" | "9" | "¹" | "²" | "³"));
    if safe.is_empty() {
        String::from("camera")
    } else if is_port || RESERVED.contains(&stem.as_str()) {
        format!("_{safe}")
    } else {
        safe.to_owned()
    }
}

/// Whether a character may be in a file name on every system, and shows.
fn is_safe(c: char) -> bool {
    let invisible =
        matches!(c, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}');
    !c.is_control() && !invisible && !matches!(c, '<' | '>' | ':' | '"' | '/' | '\\' | '|' | '?' | '*')
}

/// Safe names for cameras whose own names differ. No two are equal where upper and lower case are the same. A note tells of
/// every name that was changed.
pub fn safe_names(names: &[&str], notes: &mut Notes) -> Vec<String> {
    let clean: Vec<String> = names.iter().map(|name| component(name)).collect();
    // Names that need no change have precedence over numbered ones.
    let mut taken: BTreeSet<String> = BTreeSet::new();
    let kept: Vec<bool> =
        names.iter().zip(&clean).map(|(name, clean)| name == clean && taken.insert(clean.to_lowercase())).collect();
    let mut unique = Vec::new();
    for ((name, clean), kept) in names.iter().zip(clean).zip(kept) {
        if kept {
            unique.push(clean);
            continue;
        }
        let numbered = (2..).map(|number| format!("{clean}_{number}"));
        let candidates = std::iter::once(clean.clone()).chain(numbered);
        let mut free = candidates.filter(|candidate| !taken.contains(&candidate.to_lowercase()));
        let chosen = free.next().unwrap_or(clean);
        taken.insert(chosen.to_lowercase());
        notes.add(format!(
            "camera `{}` is called `{chosen}`, because camera names become file names",
            name.escape_debug()
        ));
        unique.push(chosen);
    }
    unique
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::{Component, Path};

    #[test]
    fn every_name_becomes_one_component() {
        let hostile = [
            "../../../OUTSIDE",
            "/etc/passwd",
            "C:\\x",
            "..",
            ".",
            "",
            "a\0b",
            "a\nb",
            ".hidden",
            "...",
            "con",
            "NUL.tar",
            "com1",
            "LPT¹",
            "a. ",
            " ",
            "a/../b",
            "\\\\server\\share",
            "\u{202e}gnp",
            "x:stream",
            "-",
            "~",
            "a*?b",
            &"ü".repeat(300),
        ];
        let names = safe_names(&hostile, &mut Notes::default());
        for (name, source) in names.iter().zip(&hostile) {
            let path = Path::new(name);
            let components: Vec<_> = path.components().collect();
            assert!(matches!(components[..], [Component::Normal(_)]), "{source} -> {name}");
            assert!(name.chars().all(is_safe) && !name.contains(['/', '\\']), "{source} -> {name}");
            assert!(
                !name.starts_with('.') && !name.ends_with(['.', ' ']) && name.len() <= LONGEST + 3,
                "{source} -> {name}"
            );
        }
        assert_eq!(names[..3], ["OUTSIDE", "etc_passwd", "C__x"]);
        assert_eq!(names[10..13], ["_con", "_NUL.tar", "_com1"]);
    }

    #[test]
    fn equal_names_are_numbered_without_regard_to_case() {
        let mut notes = Notes::default();
        let names = safe_names(&["../a", "A", "a", "a_2", "x/y", "x_y"], &mut notes);
        assert_eq!(names, ["a_3", "A", "a_4", "a_2", "x_y_2", "x_y"]);
        assert_eq!(notes.into_list().len(), 3);
    }

    #[test]
    fn ordinary_names_stay() {
        let ordinary = ["cam00", "cam.00", "left camera", "カメラ1", "com10", "console", "a_c d"];
        let mut notes = Notes::default();
        assert_eq!(safe_names(&ordinary, &mut notes), ordinary);
        assert!(notes.into_list().is_empty());
    }

    #[test]
    fn only_extensions_of_pictures_are_removed() {
        let of = [
            ("./images/a.png", "images_a"),
            ("cam.00", "cam.00"),
            ("cam.00.JPG", "cam.00"),
            ("b\\c.jpeg", "b_c"),
            ("../x/1.tif", "x_1.tif"),
        ];
        for (path, name) in of {
            assert_eq!(name_of(path), name);
        }
    }
}
