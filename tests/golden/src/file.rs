//! `golden.txt`: one [`Record`] per case.

use crate::Record;

const HEAD: &str = "\
# What every stage gives, on every machine. Made by `cargo xtask golden --renew`; not for editing.
# stage NAME HASH, then what it consists of: floats or words, their name, how many there are, and some of them as
# INDEX:BITS in hexadecimal.
";

/// The text of the file.
pub fn write<'a>(records: impl IntoIterator<Item = (&'a str, &'a Record)>) -> String {
    let sections = records.into_iter().map(|(case, record)| format!("\ncase {case}\n{record}"));
    HEAD.to_owned() + &sections.collect::<String>()
}

/// The record of a case.
///
/// # Errors
/// There is no such case, or its record cannot be read.
pub fn find(text: &str, case: &str) -> Result<Record, String> {
    let fail =
        |problem: &str| format!("tests/golden/golden.txt: {problem}: write it anew with `cargo xtask golden --renew`");
    let (_, section) = text.split_once(&format!("\ncase {case}\n")).ok_or_else(|| fail(&format!("no case {case}")))?;
    section.split("\n\n").next().unwrap_or(section).parse().map_err(|problem: String| fail(&problem))
}

#[test]
fn sections_are_found() {
    let stage = |hash| crate::Stage { name: "hull".to_owned(), hash, arrays: Vec::new() };
    let [small, large] = [1, 2].map(|hash| Record { stages: vec![stage(hash)] });
    let text = write([("small", &small), ("large", &large)]);
    assert_eq!(find(&text, "small"), Ok(small));
    assert_eq!(find(&text, "large"), Ok(large));
    assert!(find(&text, "other").is_err());
}
