//! OpenCV's FileStorage, as YAML or JSON, read into JSON values.

use super::source::read_text;
use crate::{failure::Failure, files::Files};
use serde_json::{Map, Value};
use std::path::Path;
use yaml_rust2::{Yaml, YamlLoader};

/// Reads a file. Its extension decides the format.
pub fn read(files: &dyn Files, path: &Path) -> Result<Value, Failure> {
    let text = read_text(files, path)?;
    let value = if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("json")) {
        serde_json::from_str(&text).map_err(|e| e.to_string())
    } else {
        from_yaml(&text)
    };
    value.map_err(|problem| Failure::Input(format!("{}: {problem}: correct that line", path.display())))
}

fn from_yaml(text: &str) -> Result<Value, String> {
    // OpenCV writes `%YAML:1.0`, which is not a valid YAML directive.
    let body: String =
        text.lines().map(|line| if line.starts_with('%') { "" } else { line }).flat_map(|l| [l, "\n"]).collect();
    let documents = YamlLoader::load_from_str(&body).map_err(|e| e.to_string())?;
    Ok(documents.into_iter().next().map_or(Value::Null, to_json))
}

fn to_json(yaml: Yaml) -> Value {
    match yaml {
        Yaml::Integer(i) => i.into(),
        Yaml::Boolean(b) => b.into(),
        // Numbers that JSON cannot represent (.nan) stay text. They are reported where a number is needed.
        Yaml::Real(text) => text.parse::<f64>().ok().filter(|v| v.is_finite()).map_or(text.into(), Value::from),
        Yaml::String(text) => text.into(),
        Yaml::Array(items) => items.into_iter().map(to_json).collect(),
        Yaml::Hash(entries) => {
            let entry = |(key, value): (Yaml, Yaml)| Some((key.into_string()?, to_json(value)));
            entries.into_iter().filter_map(entry).collect::<Map<_, _>>().into()
        }
        Yaml::Alias(_) | Yaml::Null | Yaml::BadValue => Value::Null,
    }
}

/// All numbers of a matrix by rows, from FileStorage's `data`, nested lists or a flat list.
pub fn numbers(value: &Value) -> Result<Vec<f64>, String> {
    match value {
        Value::Object(matrix) => match matrix.get("data") {
            Some(data) => numbers(data),
            None => Err(String::from("a matrix without `data`")),
        },
        Value::Array(items) => {
            let parts: Result<Vec<_>, _> = items.iter().map(numbers).collect();
            Ok(parts?.concat())
        }
        Value::Number(number) => Ok(number.as_f64().into_iter().collect()),
        // A YAML 1.2 reader takes some numbers of YAML 1.0 (`0.`) for text.
        Value::String(text) => match text.parse::<f64>() {
            Ok(v) if v.is_finite() => Ok(vec![v]),
            _ => Err(format!("`{text}` is not a finite number")),
        },
        other => Err(format!("`{other}` is not a number")),
    }
}
