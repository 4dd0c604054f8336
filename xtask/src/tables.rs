//! Generated parts of a Markdown file. The text between two markers is replaced, and all other text is kept.

use crate::Result;
use std::{fs, path::Path};

/// A Markdown table.
pub struct Table {
    lines: Vec<String>,
}

impl Table {
    /// A table with its header. The first column is aligned left, the figures right.
    pub fn new<S: AsRef<str>>(header: &[S]) -> Self {
        let mut rule = String::from("|---|");
        rule.push_str(&"---:|".repeat(header.len() - 1));
        let mut table = Self { lines: Vec::new() };
        table.row(header);
        table.lines.push(rule);
        table
    }

    /// Adds a row.
    pub fn row<S: AsRef<str>>(&mut self, cells: &[S]) {
        let cells: Vec<&str> = cells.iter().map(AsRef::as_ref).collect();
        self.lines.push(format!("| {} |", cells.join(" | ")));
    }

    /// The Markdown text.
    pub fn text(&self) -> String {
        self.lines.join("\n")
    }
}

/// A figure with this many digits after the point, or a dash if there is none.
pub fn figure(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| String::from("–"), |v| format!("{v:.digits$}"))
}

/// The text between `<!-- begin: name -->` and `<!-- end: name -->`.
pub fn content<'a>(text: &'a str, name: &str) -> Result<&'a str> {
    let [_, content, _] = split(text, name)?;
    Ok(content.trim())
}

/// The text before, between and after the markers of a name. The markers belong to the outer parts.
fn split<'a>(text: &'a str, name: &str) -> Result<[&'a str; 3]> {
    let [begin, end] = ["begin", "end"].map(|word| format!("<!-- {word}: {name} -->"));
    let inner = text.find(&begin).map(|at| at + begin.len());
    let found = inner.and_then(|from| Some((from, from + text[from..].find(&end)?)));
    let (from, to) = found.ok_or_else(|| format!("`{begin}` or `{end}` is missing"))?;
    Ok([&text[..from], &text[from..to], &text[to..]])
}

/// Replaces the text between `<!-- begin: name -->` and `<!-- end: name -->`.
pub fn replace(text: &str, name: &str, content: &str) -> Result<String> {
    let [before, _, after] = split(text, name)?;
    Ok(format!("{before}\n{}\n{after}", content.trim_end()))
}

/// Replaces several parts of a file.
pub fn replace_in(path: &Path, parts: &[(&str, String)]) -> Result<()> {
    let problem = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
    let mut text = fs::read_to_string(path).map_err(|e| problem(&e))?;
    for (name, content) in parts {
        text = replace(&text, name, content).map_err(|e| problem(&e))?;
    }
    fs::write(path, text).map_err(|e| problem(&e))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_between_the_markers_changes() {
        let text = "# A\n<!-- begin: a -->\nold\n<!-- end: a -->\nremark\n<!-- begin: b --><!-- end: b -->\nlast";
        let once = replace(text, "a", "new | table\n").unwrap();
        assert_eq!(once, text.replace("old", "new | table"));
        assert_eq!(replace(&once, "a", "new | table").unwrap(), once);
        assert_eq!(content(&once, "a").unwrap(), "new | table");
        assert!(replace(&once, "b", "x").unwrap().ends_with("<!-- begin: b -->\nx\n<!-- end: b -->\nlast"));
        assert!(replace(text, "c", "").is_err());
    }

    #[test]
    fn tables_are_markdown() {
        let mut table = Table::new(&["scene", "F"]);
        table.row(&["akimbo".to_owned(), figure(Some(1.25), 1)]);
        table.row(&["wd2".to_owned(), figure(None, 1)]);
        assert_eq!(table.text(), "| scene | F |\n|---|---:|\n| akimbo | 1.2 |\n| wd2 | – |");
    }
}
