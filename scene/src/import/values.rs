//! Values of calibration files, from JSON or YAML.

use serde_json::{Map, Value};

/// The objects in which a key is searched: a camera's own, then those that apply to all cameras of the file.
#[derive(Debug, Clone)]
pub struct Levels<'a>(pub Vec<&'a Map<String, Value>>);

impl<'a> Levels<'a> {
    /// The value of the first of these keys in the first object that has one. Null counts as missing.
    pub fn find(&self, keys: &[&str]) -> Option<(String, &'a Value)> {
        self.0.iter().find_map(|object| find(object, keys))
    }

    /// The number of the first of these keys that exists.
    pub fn number(&self, keys: &[&str]) -> Result<Option<f64>, String> {
        self.find(keys).map(|(key, value)| number(&key, value)).transpose()
    }
}

/// Key and value of the first of these keys that exists. Null counts as missing.
pub fn find<'a>(object: &'a Map<String, Value>, keys: &[&str]) -> Option<(String, &'a Value)> {
    keys.iter().find_map(|&key| object.get(key).filter(|value| !value.is_null()).map(|value| (key.to_owned(), value)))
}

/// One number.
pub fn number(key: &str, value: &Value) -> Result<f64, String> {
    match numbers(value).map_err(|problem| format!("{key}: {problem}"))?[..] {
        [number] => Ok(number),
        _ => Err(format!("{key}: one number is needed, not `{value}`")),
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
        // Scalars of YAML are text.
        Value::String(text) => match text.trim().parse::<f64>() {
            Ok(v) if v.is_finite() => Ok(vec![v]),
            _ => Err(format!("`{text}` is not a finite number")),
        },
        other => Err(format!("`{other}` is not a number")),
    }
}

/// Exactly N numbers.
pub fn to_array<const N: usize>(numbers: &[f64], what: &str) -> Result<[f64; N], String> {
    numbers.try_into().map_err(|_| format!("{what} has {} numbers, {N} are needed", numbers.len()))
}

/// Text. A number is taken as it is written.
pub fn text(value: &Value) -> Option<String> {
    match value {
        Value::String(text) => Some(text.clone()),
        Value::Number(number) => Some(number.to_string()),
        _ => None,
    }
}

/// Width and height in pixels.
pub fn size(width: f64, height: f64) -> Result<[u32; 2], String> {
    let whole = |v: f64| v >= 1.0 && v <= f64::from(u32::MAX) && v == libm::floor(v);
    if whole(width) && whole(height) {
        Ok([width as u32, height as u32])
    } else {
        Err(format!("the size {width} x {height} is not a number of pixels: correct it"))
    }
}

/// Whether a value says no, nothing or zero.
pub fn is_neutral(value: &Value) -> bool {
    match value {
        Value::Null => true,
        Value::Bool(flag) => !flag,
        Value::Number(number) => number.as_f64() == Some(0.0),
        Value::String(text) => {
            let text = text.trim().to_lowercase();
            ["", "false", "no", "off", "none", "null", "~"].contains(&text.as_str()) || text.parse() == Ok(0.0)
        }
        Value::Array(items) => items.iter().all(is_neutral),
        Value::Object(matrix) => matrix.get("data").map_or(matrix.is_empty(), is_neutral),
    }
}
