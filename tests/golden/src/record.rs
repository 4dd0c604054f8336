//! Outputs of the stages, as text that people can read and other machines can compare.

use std::{
    fmt::{Display, Formatter, Result as Written},
    str::FromStr,
};

/// The output of all stages of one reconstruction.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Record {
    /// The stages in the order in which they ran.
    pub stages: Vec<Stage>,
}

/// The output of one stage.
#[derive(Debug, Clone, PartialEq)]
pub struct Stage {
    /// Its name.
    pub name: String,
    /// Hash of the whole output.
    pub hash: u64,
    /// The arrays of the output.
    pub arrays: Vec<Array>,
}

/// An array of numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// Name of the array.
    pub name: String,
    /// Whether the bits are those of `f32`.
    pub float: bool,
    /// Number of values.
    pub length: usize,
    /// Index and bits of some or all values, in ascending order.
    pub values: Vec<(usize, u32)>,
}

/// How many values of an array a record contains.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Detail {
    /// The first values and some from the whole array.
    Sample,
    /// All values.
    All,
}

/// Number of values in a sample from the start of the array, and from all of it.
const SAMPLE: (usize, usize) = (6, 10);
/// Values per line.
const LINE: usize = 8;

impl Array {
    /// An array of floats. +0 and -0 count as equal, as in the core's hashes.
    pub fn floats(name: &str, detail: Detail, values: impl IntoIterator<Item = f32>) -> Self {
        Self { float: true, ..Self::words(name, detail, values.into_iter().map(|v| (v + 0.0).to_bits())) }
    }

    /// An array of integers.
    pub fn words(name: &str, detail: Detail, values: impl IntoIterator<Item = u32>) -> Self {
        let all: Vec<u32> = values.into_iter().collect();
        let stride = if detail == Detail::All { 1 } else { all.len().div_ceil(SAMPLE.1).max(1) };
        let chosen = |&(i, _): &(usize, u32)| i < SAMPLE.0 || i % stride == stride - 1;
        let length = all.len();
        Self {
            name: name.to_owned(),
            float: false,
            length,
            values: all.into_iter().enumerate().filter(chosen).collect(),
        }
    }
}

impl Display for Record {
    fn fmt(&self, f: &mut Formatter<'_>) -> Written {
        for stage in &self.stages {
            writeln!(f, "stage {} {:016x}", stage.name, stage.hash)?;
            for array in &stage.arrays {
                writeln!(f, "  {} {} {}", if array.float { "floats" } else { "words" }, array.name, array.length)?;
                for line in array.values.chunks(LINE) {
                    write!(f, "   ")?;
                    line.iter().try_for_each(|(i, bits)| write!(f, " {i}:{bits:08x}"))?;
                    writeln!(f)?;
                }
            }
        }
        Ok(())
    }
}

impl FromStr for Record {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut record = Self::default();
        for line in text.lines() {
            record.add(line).ok_or_else(|| format!("`{line}` is not a line of a record"))?;
        }
        Ok(record)
    }
}

impl Record {
    fn add(&mut self, line: &str) -> Option<()> {
        let mut words = line.split_whitespace().peekable();
        match *words.peek()? {
            "stage" => {
                let [name, hash] = [words.nth(1)?, words.next()?];
                let hash = u64::from_str_radix(hash, 16).ok()?;
                self.stages.push(Stage { name: name.to_owned(), hash, arrays: Vec::new() });
            }
            kind @ ("floats" | "words") => {
                let name = words.nth(1)?.to_owned();
                let length = words.next()?.parse().ok()?;
                let array = Array { name, float: kind == "floats", length, values: Vec::new() };
                self.stages.last_mut()?.arrays.push(array);
            }
            _ => {
                let array = self.stages.last_mut()?.arrays.last_mut()?;
                for word in words {
                    let (index, bits) = word.split_once(':')?;
                    array.values.push((index.parse().ok()?, u32::from_str_radix(bits, 16).ok()?));
                }
            }
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_reads_back() {
        let numbers = (0..100).map(|i| i as f32 / 7.0);
        let arrays = vec![
            Array::floats("positions", Detail::Sample, numbers.clone()),
            Array::floats("normals", Detail::All, numbers),
            Array::words("triangles", Detail::Sample, 0..3),
            Array::words("colours", Detail::Sample, []),
        ];
        let record = Record { stages: vec![Stage { name: "mesh".to_owned(), hash: u64::MAX - 1, arrays }] };
        assert_eq!(record.to_string().parse(), Ok(record));
        assert!("stage mesh".parse::<Record>().is_err());
        assert!("  0:00000000".parse::<Record>().is_err());
    }

    #[test]
    fn samples_are_small() {
        for length in [0, 1, 5, 16, 17, 999, 1000] {
            let array = Array::words("values", Detail::Sample, 0..length);
            assert!(array.values.len() <= SAMPLE.0 + SAMPLE.1);
            assert_eq!(array.values.is_empty(), length == 0);
            assert!(array.values.iter().all(|&(i, v)| i == v as usize));
        }
    }
}
