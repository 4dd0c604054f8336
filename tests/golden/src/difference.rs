//! The first difference between two records.

use crate::{
    float::hexadecimal,
    record::{Array, Record, Stage},
};
use std::fmt::Write;

/// Number of differing values that are shown per array.
const SHOWN: usize = 4;

/// Describes the first stage in which `got` differs from `expected`, with the first differing numbers; `None` if they
/// agree. If one of two arrays is a sample, only their common values are compared, and the hashes cover the rest.
pub fn difference(expected: &Record, got: &Record) -> Option<String> {
    let names = |record: &Record| record.stages.iter().map(|s| s.name.clone()).collect::<Vec<_>>();
    if names(expected) != names(got) {
        return Some(format!("stages are {:?}, expected {:?}\n", names(got), names(expected)));
    }
    let mut stages = expected.stages.iter().zip(&got.stages);
    let (expected, got) = stages.find(|(e, g)| e.hash != g.hash || !compare(e, g).is_empty())?;
    let mut text = format!(
        "`{}` is the first stage that differs: hash {:016x}, expected {:016x}\n",
        got.name, got.hash, expected.hash
    );
    let details = compare(expected, got);
    text += if details.is_empty() { "  none of the numbers in the sample differs\n" } else { &details };
    let others = stages.filter(|(e, g)| e.hash != g.hash).map(|(e, _)| e.name.as_str()).collect::<Vec<_>>();
    if !others.is_empty() {
        text += &format!("  after it differ: {}\n", others.join(", "));
    }
    Some(text)
}

/// One line per difference.
fn compare(expected: &Stage, got: &Stage) -> String {
    let mut text = String::new();
    let names = |stage: &Stage| stage.arrays.iter().map(|a| a.name.clone()).collect::<Vec<_>>();
    if names(expected) != names(got) {
        return format!("  it has {:?}, expected {:?}\n", names(got), names(expected));
    }
    for (expected, got) in expected.arrays.iter().zip(&got.arrays) {
        if expected.length != got.length {
            let _ = writeln!(text, "  {}: {} numbers, expected {}", got.name, got.length, expected.length);
        }
        let (common, differing) = numbers(expected, got);
        for &(i, e, g) in differing.iter().take(SHOWN) {
            let _ = writeln!(text, "  {}[{i}]: {}, expected {}", got.name, shown(got, g), shown(got, e));
        }
        if !differing.is_empty() {
            let _ = writeln!(text, "  {}: {} of {common} compared numbers differ", got.name, differing.len());
        }
    }
    text
}

/// The number of common values, and index and bits of those that differ.
fn numbers(expected: &Array, got: &Array) -> (usize, Vec<(usize, u32, u32)>) {
    let (mut common, mut differing) = (0, Vec::new());
    let mut rest = got.values.iter().peekable();
    for &(i, e) in &expected.values {
        while rest.next_if(|&&(j, _)| j < i).is_some() {}
        if let Some(&&(_, g)) = rest.peek().filter(|(j, _)| *j == i) {
            common += 1;
            if e != g {
                differing.push((i, e, g));
            }
        }
    }
    (common, differing)
}

fn shown(array: &Array, bits: u32) -> String {
    let float = f32::from_bits(bits);
    if array.float { format!("{} ({float:e})", hexadecimal(float)) } else { format!("{bits:#x}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Detail;

    fn record(detail: Detail, hash: u64, change: usize) -> Record {
        let mut values = vec![0.25_f32; 100];
        if let Some(value) = values.get_mut(change) {
            *value = 0.1;
        }
        let arrays = vec![Array::floats("positions", detail, values)];
        let stage = |name: &str| Stage { name: name.to_owned(), hash, arrays: arrays.clone() };
        Record {
            stages: vec![Stage { name: "input".to_owned(), hash: 7, arrays: vec![] }, stage("hull"), stage("mesh")],
        }
    }

    #[test]
    fn the_first_stage_and_its_numbers_are_named() {
        let expected = record(Detail::Sample, 1, usize::MAX);
        assert_eq!(difference(&expected, &record(Detail::All, 1, usize::MAX)), None);
        let text = difference(&expected, &record(Detail::All, 2, 3)).unwrap_or_default();
        assert!(text.starts_with("`hull` is the first stage that differs: hash 0000000000000002, "), "{text}");
        assert!(text.contains("positions[3]: 0x1.99999ap-4 (1e-1), expected 0x1p-2 (2.5e-1)\n"), "{text}");
        assert!(text.contains("positions: 1 of 16 compared numbers differ\n"), "{text}");
        assert!(text.ends_with("after it differ: mesh\n"), "{text}");
    }

    #[test]
    fn what_a_sample_misses_the_hash_shows() {
        let expected = record(Detail::Sample, 1, usize::MAX);
        let text = difference(&expected, &record(Detail::All, 2, 50)).unwrap_or_default();
        assert!(text.contains("none of the numbers in the sample differs"), "{text}");
        let all = record(Detail::All, 1, usize::MAX);
        let text = difference(&all, &record(Detail::All, 1, 50)).unwrap_or_default();
        assert!(text.contains("positions[50]"), "{text}");
    }
}
