//! JSON of the core's parameters and counts, from their `Debug` text.
//!
//! The core has no serialiser. Its `Debug` output is derived, so this cannot miss a field that is added there, as a
//! mirrored struct would.

use serde_json::{Map, Value};
use std::fmt::Debug;

/// The JSON of structs, arrays, tuples, numbers, options and names of enum variants; `None` is null. A variant with
/// fields becomes an object or an array without its name, and a number that is not finite a string.
pub fn to_value(value: &impl Debug) -> Value {
    let text = format!("{value:?}");
    Text { rest: &text }.value()
}

struct Text<'a> {
    rest: &'a str,
}

impl<'a> Text<'a> {
    fn eat(&mut self, token: &str) -> bool {
        self.rest = self.rest.trim_start();
        let found = self.rest.strip_prefix(token);
        self.rest = found.unwrap_or(self.rest);
        found.is_some()
    }

    /// Everything up to a delimiter: a number or a name.
    fn word(&mut self) -> &'a str {
        self.rest = self.rest.trim_start();
        let end = self.rest.find([' ', ',', ':', '{', '}', '[', ']', '(', ')']).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        word
    }

    fn value(&mut self) -> Value {
        if self.eat("[") {
            return self.list("]").into();
        }
        let word = self.word();
        if self.eat("{") {
            let mut map = Map::new();
            while !self.eat("}") && !self.rest.is_empty() {
                let key = self.word();
                self.eat(":");
                map.insert(key.into(), self.value());
                self.eat(",");
            }
            return map.into();
        }
        if self.eat("(") {
            let mut items = self.list(")");
            return if items.len() == 1 { items.remove(0) } else { items.into() };
        }
        match word {
            "None" => Value::Null,
            _ => serde_json::from_str(word).unwrap_or_else(|_| word.into()),
        }
    }

    fn list(&mut self, end: &str) -> Vec<Value> {
        let mut items = Vec::new();
        while !self.eat(end) && !self.rest.is_empty() {
            items.push(self.value());
            self.eat(",");
        }
        items
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pcmvs_core::{Counts, Params, Preset};
    use serde_json::json;

    #[test]
    fn every_kind_of_field_has_its_json() {
        #[derive(Debug)]
        #[expect(dead_code, reason = "read through Debug")]
        struct Inner {
            small: f32,
            pair: (u32, bool),
        }
        #[derive(Debug)]
        #[expect(dead_code, reason = "read through Debug")]
        struct Outer {
            inner: Inner,
            list: Vec<f64>,
            none: Option<u8>,
            some: Option<Preset>,
            infinite: f32,
        }
        let value = Outer {
            inner: Inner { small: 1e-7, pair: (3, true) },
            list: vec![1.0, -2.5],
            none: None,
            some: Some(Preset::Paper),
            infinite: f32::INFINITY,
        };
        let expected = json!({
            "inner": { "small": 1e-7, "pair": [3, true] },
            "list": [1.0, -2.5],
            "none": null,
            "some": "Paper",
            "infinite": "inf",
        });
        assert_eq!(to_value(&value), expected);
    }

    #[test]
    fn parameters_and_counts_are_objects() {
        let params = Params::preset(Preset::Paper);
        let value = to_value(&params);
        assert_eq!(value["meshing"]["screening"], json!(params.meshing.screening));
        assert_eq!(to_value(&Counts::default())["vertices"], json!(0));
    }
}
