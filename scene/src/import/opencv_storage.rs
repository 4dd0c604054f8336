//! OpenCV's FileStorage, as YAML, JSON or XML, read into JSON values.

use super::{json, source::read_text};
use crate::{failure::Failure, files::Files};
use serde_json::{Map, Value};
use std::{collections::BTreeMap, path::Path};
use yaml_rust2::{
    parser::{Event, MarkedEventReceiver, Parser},
    scanner::{Marker, TScalarStyle},
};

/// Most values of a file. It bounds the memory that aliases of aliases can take.
const MOST_VALUES: usize = 1_000_000;

/// Reads a file. Its extension decides the format.
pub fn read(files: &dyn Files, path: &Path) -> Result<Value, Failure> {
    let text = read_text(files, path)?;
    let has = |extension: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension));
    let value = if has("json") {
        json::parse(&text)
    } else if has("xml") {
        from_xml(&text)
    } else {
        from_yaml(&text)
    };
    value.map_err(|problem| Failure::Input(format!("{}: {problem}", path.display())))
}

/// Whether a file is XML of FileStorage. Other programs write XML, too.
pub fn is_xml(files: &dyn Files, path: &Path) -> bool {
    read_text(files, path).is_ok_and(|text| text.contains("<opencv_storage"))
}

#[cfg(feature = "formats")]
use super::opencv_xml::from_xml;

#[cfg(not(feature = "formats"))]
fn from_xml(_: &str) -> Result<Value, String> {
    Err(String::from("XML is not read here: save the calibration as YAML or JSON, or use the command line"))
}

/// YAML as JSON. All scalars are text, as they are written, so that a name such as `007` keeps its zeros.
fn from_yaml(text: &str) -> Result<Value, String> {
    // OpenCV writes `%YAML:1.0`, which is not a valid YAML directive.
    let body: String =
        text.lines().map(|line| if line.starts_with('%') { "" } else { line }).flat_map(|l| [l, "\n"]).collect();
    // The parser refuses tabs where editors and scripts put them.
    let body = body.replace('\t', "    ");
    let mut builder = Builder::default();
    Parser::new_from_str(&body).load(&mut builder, true).map_err(|e| format!("{e}: correct that line"))?;
    match (builder.problem, builder.documents.len()) {
        (Some(problem), _) => Err(format!("{problem}: correct that line")),
        (None, 0..=1) => Ok(builder.documents.pop().unwrap_or_default()),
        (None, count) => Err(format!("the file has {count} documents, and only one can be read: split it at `---`")),
    }
}

/// A list or map that is being read, with the number of its anchor, which is 0 if it has none.
enum Open {
    List(Vec<Value>, usize),
    Map(Map<String, Value>, Option<String>, usize),
}

/// Builds values from the parser's events.
#[derive(Default)]
struct Builder {
    open: Vec<Open>,
    anchors: BTreeMap<usize, Value>,
    documents: Vec<Value>,
    values: usize,
    problem: Option<String>,
}

impl Builder {
    fn fail(&mut self, mark: Marker, problem: &str) {
        self.problem.get_or_insert_with(|| format!("line {}: {problem}", mark.line()));
    }

    fn add(&mut self, value: Value, anchor: usize, mark: Marker) {
        if anchor != 0 {
            self.anchors.insert(anchor, value.clone());
        }
        match self.open.last_mut() {
            None => self.documents.push(value),
            Some(Open::List(items, _)) => items.push(value),
            Some(Open::Map(entries, key, _)) => match (key.take(), value) {
                (Some(key), value) => {
                    if entries.insert(key.clone(), value).is_some() {
                        self.fail(mark, &format!("the key `{key}` occurs twice"));
                    }
                }
                (None, Value::String(name)) => *key = Some(name),
                (None, Value::Null) => *key = Some(String::from("null")),
                (None, _) => self.fail(mark, "a list or map as a key is not supported"),
            },
        }
    }
}

impl MarkedEventReceiver for Builder {
    fn on_event(&mut self, event: Event, mark: Marker) {
        if self.problem.is_some() {
            return;
        }
        self.values += 1;
        match event {
            Event::Scalar(text, style, anchor, _) => {
                let null = style == TScalarStyle::Plain && ["", "~", "null", "Null", "NULL"].contains(&text.as_str());
                self.add(if null { Value::Null } else { text.into() }, anchor, mark);
            }
            Event::Alias(anchor) => match self.anchors.get(&anchor).cloned() {
                Some(value) => {
                    self.values += count(&value);
                    self.add(value, 0, mark);
                }
                None => self.fail(mark, "an alias has no anchor before it"),
            },
            Event::SequenceStart(anchor, _) => self.open.push(Open::List(Vec::new(), anchor)),
            Event::MappingStart(anchor, _) => self.open.push(Open::Map(Map::new(), None, anchor)),
            Event::SequenceEnd | Event::MappingEnd => match self.open.pop() {
                Some(Open::List(items, anchor)) => self.add(items.into(), anchor, mark),
                Some(Open::Map(entries, _, anchor)) => self.add(merged(entries).into(), anchor, mark),
                None => {}
            },
            Event::Nothing | Event::StreamStart | Event::StreamEnd | Event::DocumentStart | Event::DocumentEnd => {}
        }
        if self.values > MOST_VALUES {
            self.fail(mark, "the file has more than a million values");
        }
    }
}

/// The entries of a map, with those of the map under `<<` that it does not have itself.
fn merged(mut entries: Map<String, Value>) -> Map<String, Value> {
    if let Some(Value::Object(base)) = entries.get("<<").cloned() {
        entries.remove("<<");
        for (key, value) in base {
            entries.entry(key).or_insert(value);
        }
    }
    entries
}

fn count(value: &Value) -> usize {
    match value {
        Value::Array(items) => 1 + items.iter().map(count).sum::<usize>(),
        Value::Object(entries) => 1 + entries.values().map(count).sum::<usize>(),
        _ => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn scalars_stay_as_they_are_written() {
        let text = "%YAML:1.0\r\n---\r\nname:\t007\r\n0: [ 1., .5, -2e-1 ]\r\nempty:\r\nflag: true\r\n";
        let expected = json!({ "name": "007", "0": ["1.", ".5", "-2e-1"], "empty": null, "flag": "true" });
        assert_eq!(from_yaml(text).unwrap(), expected);
    }

    #[test]
    fn aliases_stand_for_what_was_anchored() {
        let text = "a: &lens { D: [1, 2] }\nb: { <<: *lens, K: 3 }\nc: *lens\n";
        assert_eq!(
            from_yaml(text).unwrap(),
            json!({ "a": { "D": ["1", "2"] }, "b": { "K": "3", "D": ["1", "2"] }, "c": { "D": ["1", "2"] } })
        );
    }

    #[test]
    fn what_would_be_lost_is_an_error() {
        assert!(from_yaml("a: 1\na: 2\n").unwrap_err().contains("`a` occurs twice"));
        assert!(from_yaml("a: 1\n---\na: 2\n").unwrap_err().contains("2 documents"));
        let bomb: String = (1..30).map(|i| format!("a{i}: &a{i} [*a{0}, *a{0}]\n", i - 1)).collect();
        assert!(from_yaml(&format!("a0: &a0 [1, 2]\n{bomb}")).unwrap_err().contains("million"));
    }
}
