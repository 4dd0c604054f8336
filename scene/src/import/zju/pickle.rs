//! Python's pickles, as far as numpy needs them for its arrays of objects. Nothing is ever called: the functions and classes
//! that a file names stay names. Values refer to each other by number, so that neither the depth nor the repetition of what a
//! file holds takes stack or memory, and [`MOST_STEPS`] bounds both.

use std::{collections::BTreeMap, ops::Range};

/// Most steps of a file. A take of ZJU-MoCap needs some hundred thousand.
const MOST_STEPS: usize = 2_000_000;

/// The place of a value in a [`Pickle`].
pub type Id = usize;

#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    Nothing,
    Bool(bool),
    Int(i64),
    Float(f64),
    Text(String),
    /// A place in the file.
    Bytes(Range<usize>),
    /// A list or a tuple.
    List(Vec<Id>),
    Map(Vec<(Id, Id)>),
    /// A function or class: module and name.
    Name(String, String),
    /// What a function would give for its arguments, and the state that it would get then.
    Call {
        function: Id,
        arguments: Id,
        state: Option<Id>,
    },
}

/// The values of a file.
#[derive(Debug)]
pub struct Pickle<'a> {
    bytes: &'a [u8],
    values: Vec<Value>,
    /// The value of the whole file.
    pub root: Id,
}

impl<'a> Pickle<'a> {
    /// Reads a file, or says what is wrong with it.
    pub fn read(bytes: &'a [u8]) -> Result<Self, String> {
        let mut machine =
            Machine { bytes, at: 0, values: Vec::new(), stack: Vec::new(), marks: Vec::new(), memo: BTreeMap::new() };
        for _ in 0..MOST_STEPS {
            if let Some(root) = machine.step()? {
                return Ok(Self { bytes, values: machine.values, root });
            }
        }
        Err(format!("has more than {MOST_STEPS} values: save fewer frames"))
    }

    pub fn get(&self, id: Id) -> &Value {
        &self.values[id]
    }

    /// Text. Python 2 wrote it as bytes.
    pub fn text(&self, id: Id) -> Option<&str> {
        match self.get(id) {
            Value::Text(text) => Some(text),
            Value::Bytes(range) => std::str::from_utf8(&self.bytes[range.clone()]).ok(),
            _ => None,
        }
    }

    /// Bytes. Protocol 2 wrote them as text of characters below 256, for a function to turn back.
    pub fn bytes(&self, id: Id) -> Option<Vec<u8>> {
        match self.get(id) {
            Value::Bytes(range) => Some(self.bytes[range.clone()].to_vec()),
            Value::Call { function, arguments, .. } if self.is_name(*function, "encode") => {
                let text = self.text(*self.list(*arguments)?.first()?)?;
                text.chars().map(|c| u8::try_from(u32::from(c)).ok()).collect()
            }
            _ => None,
        }
    }

    /// The values of a list or tuple.
    pub fn list(&self, id: Id) -> Option<&[Id]> {
        match self.get(id) {
            Value::List(items) => Some(items),
            _ => None,
        }
    }

    /// Whether a value is a function or class of this name, whatever its module: numpy moved its own.
    pub fn is_name(&self, id: Id, wanted: &str) -> bool {
        matches!(self.get(id), Value::Name(_, name) if name == wanted)
    }
}

/// The machine that a pickle is a program for.
struct Machine<'a> {
    bytes: &'a [u8],
    at: usize,
    values: Vec<Value>,
    stack: Vec<Id>,
    /// Heights of the stack.
    marks: Vec<usize>,
    memo: BTreeMap<usize, Id>,
}

impl Machine<'_> {
    fn take(&mut self, count: usize) -> Result<Range<usize>, String> {
        let end = self.at.checked_add(count).filter(|&end| end <= self.bytes.len());
        let end = end.ok_or("ends in the middle of a value: copy the file again")?;
        Ok(std::mem::replace(&mut self.at, end)..end)
    }

    /// An integer without a sign, of up to eight bytes, the lowest first.
    fn unsigned(&mut self, count: usize) -> Result<usize, String> {
        let range = self.take(count)?;
        let value = self.bytes[range].iter().rev().fold(0u64, |value, &byte| value << 8 | u64::from(byte));
        usize::try_from(value).map_err(|_| String::from("has a length out of reason: copy the file again"))
    }

    fn text(&mut self, count: usize) -> Result<String, String> {
        let range = self.take(count)?;
        let text = std::str::from_utf8(&self.bytes[range]);
        text.map(str::to_owned).map_err(|_| String::from("has text that is not UTF-8: save it again"))
    }

    fn line(&mut self) -> Result<String, String> {
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(|&byte| byte == b'\n').ok_or("ends in the middle of a name")?;
        let line = self.text(length)?;
        self.at += 1;
        Ok(line.trim_end_matches('\r').to_owned())
    }

    fn push(&mut self, value: Value) {
        self.stack.push(self.values.len());
        self.values.push(value);
    }

    fn pop(&mut self) -> Result<Id, String> {
        let lowest = self.marks.last().copied().unwrap_or(0);
        let top = if self.stack.len() > lowest { self.stack.pop() } else { None };
        top.ok_or_else(|| String::from("takes a value where there is none: save it again"))
    }

    fn top(&self) -> Result<Id, String> {
        self.stack.last().copied().ok_or_else(|| String::from("uses a value where there is none: save it again"))
    }

    /// What was pushed since the last mark.
    fn since_mark(&mut self) -> Result<Vec<Id>, String> {
        let mark = self.marks.pop().ok_or("lacks a mark: save it again")?;
        Ok(self.stack.split_off(mark))
    }

    fn tuple(&mut self, count: usize) -> Result<(), String> {
        let mut items: Vec<Id> = (0..count).map(|_| self.pop()).collect::<Result<_, _>>()?;
        items.reverse();
        self.push(Value::List(items));
        Ok(())
    }

    fn extend(&mut self, items: Vec<Id>) -> Result<(), String> {
        let list = self.top()?;
        match &mut self.values[list] {
            Value::List(list) => list.extend(items),
            _ => return Err(String::from("appends to a value that is no list: save it again")),
        }
        Ok(())
    }

    fn insert(&mut self, items: &[Id]) -> Result<(), String> {
        let map = self.top()?;
        match &mut self.values[map] {
            Value::Map(map) => map.extend(items.chunks_exact(2).map(|pair| (pair[0], pair[1]))),
            _ => return Err(String::from("adds a key to a value that is no dict: save it again")),
        }
        Ok(())
    }

    fn remember(&mut self, place: usize) -> Result<(), String> {
        let top = self.top()?;
        self.memo.insert(place, top);
        Ok(())
    }

    fn recall(&mut self, place: usize) -> Result<(), String> {
        let id = self.memo.get(&place).copied().ok_or("refers to a value that it does not have: save it again")?;
        self.stack.push(id);
        Ok(())
    }

    /// Obeys one code. Returns the value of the file at its end.
    fn step(&mut self) -> Result<Option<Id>, String> {
        let code = self.unsigned(1)? as u8;
        match code {
            b'.' => return self.pop().map(Some),
            // The protocol's number, and the length of what follows.
            0x80 => _ = self.take(1)?,
            0x95 => _ = self.take(8)?,
            b'(' => self.marks.push(self.stack.len()),
            b'0' => _ = self.pop()?,
            b'1' => _ = self.since_mark()?,
            b'N' => self.push(Value::Nothing),
            0x88 => self.push(Value::Bool(true)),
            0x89 => self.push(Value::Bool(false)),
            b'K' => self.int(1)?,
            b'M' => self.int(2)?,
            b'J' => {
                let value = self.unsigned(4)? as u32;
                self.push(Value::Int(i64::from(value.cast_signed())));
            }
            0x8a => self.long()?,
            b'G' => {
                let range = self.take(8)?;
                let value = self.bytes[range].iter().fold(0u64, |value, &byte| value << 8 | u64::from(byte));
                self.push(Value::Float(f64::from_bits(value)));
            }
            b'X' => self.text_of(4)?,
            0x8c => self.text_of(1)?,
            0x8d => self.text_of(8)?,
            b'B' | b'T' => self.bytes_of(4)?,
            b'C' | b'U' => self.bytes_of(1)?,
            0x8e => self.bytes_of(8)?,
            b']' | b')' => self.push(Value::List(Vec::new())),
            b'}' => self.push(Value::Map(Vec::new())),
            b'a' => {
                let item = self.pop()?;
                self.extend(vec![item])?;
            }
            b'e' => {
                let items = self.since_mark()?;
                self.extend(items)?;
            }
            b's' => {
                let (value, key) = (self.pop()?, self.pop()?);
                self.insert(&[key, value])?;
            }
            b'u' => {
                let items = self.since_mark()?;
                self.insert(&items)?;
            }
            b't' => {
                let items = self.since_mark()?;
                self.push(Value::List(items));
            }
            b'l' => {
                let items = self.since_mark()?;
                self.push(Value::List(items));
            }
            0x85 => self.tuple(1)?,
            0x86 => self.tuple(2)?,
            0x87 => self.tuple(3)?,
            b'q' => {
                let place = self.unsigned(1)?;
                self.remember(place)?;
            }
            b'r' => {
                let place = self.unsigned(4)?;
                self.remember(place)?;
            }
            0x94 => self.remember(self.memo.len())?,
            b'h' => {
                let place = self.unsigned(1)?;
                self.recall(place)?;
            }
            b'j' => {
                let place = self.unsigned(4)?;
                self.recall(place)?;
            }
            b'c' => {
                let (module, name) = (self.line()?, self.line()?);
                self.push(Value::Name(module, name));
            }
            0x93 => {
                let (name, module) = (self.pop()?, self.pop()?);
                match (&self.values[module], &self.values[name]) {
                    (Value::Text(module), Value::Text(name)) => self.push(Value::Name(module.clone(), name.clone())),
                    _ => return Err(String::from("names a function by something that is no text: save it again")),
                }
            }
            b'R' => {
                let (arguments, function) = (self.pop()?, self.pop()?);
                self.push(Value::Call { function, arguments, state: None });
            }
            b'b' => {
                let new = self.pop()?;
                let object = self.top()?;
                match &mut self.values[object] {
                    Value::Call { state, .. } => *state = Some(new),
                    _ => return Err(String::from("has an object of an unknown kind: save it as dict, list and array")),
                }
            }
            other => {
                return Err(format!(
                    "has the pickle code {other:#04x}, which is not supported: save it again with numpy.save"
                ));
            }
        }
        Ok(None)
    }

    fn int(&mut self, count: usize) -> Result<(), String> {
        let value = self.unsigned(count)?;
        self.push(Value::Int(value as i64));
        Ok(())
    }

    /// An integer with a sign, the lowest byte first.
    fn long(&mut self) -> Result<(), String> {
        let count = self.unsigned(1)?;
        let range = self.take(count)?;
        let bytes = &self.bytes[range];
        if count > 8 {
            return Err(String::from("has an integer of more than 64 bits: save it again"));
        }
        let filling = if bytes.last().is_some_and(|&byte| byte >= 0x80) { -1 } else { 0 };
        let value = bytes.iter().rev().fold(filling, |value: i64, &byte| value << 8 | i64::from(byte));
        self.push(Value::Int(value));
        Ok(())
    }

    fn text_of(&mut self, size: usize) -> Result<(), String> {
        let count = self.unsigned(size)?;
        let text = self.text(count)?;
        self.push(Value::Text(text));
        Ok(())
    }

    fn bytes_of(&mut self, size: usize) -> Result<(), String> {
        let count = self.unsigned(size)?;
        let range = self.take(count)?;
        self.push(Value::Bytes(range));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_build_values_and_call_nothing() {
        // {"a": [1, -2, 1.5], "b": os.system("x")}, with the list remembered and recalled.
        let bytes = b"\x80\x02}(X\x01\0\0\0a](K\x01J\xfe\xff\xff\xffG\x3f\xf8\0\0\0\0\0\0eq\x05U\x01bcos\nsystem\nU\x01x\x85RX\x01\0\0\0ch\x05u.";
        let pickle = Pickle::read(bytes).unwrap();
        let Value::Map(entries) = pickle.get(pickle.root) else { panic!("a dict") };
        assert_eq!(entries.iter().map(|(key, _)| pickle.text(*key).unwrap()).collect::<String>(), "abc");
        let list: Vec<&Value> = pickle.list(entries[0].1).unwrap().iter().map(|&id| pickle.get(id)).collect();
        assert_eq!(list, [&Value::Int(1), &Value::Int(-2), &Value::Float(1.5)]);
        let Value::Call { function, .. } = pickle.get(entries[1].1) else { panic!("a call") };
        assert!(pickle.is_name(*function, "system"));
        assert_eq!(entries[0].1, entries[2].1);
    }

    #[test]
    fn what_is_broken_is_an_error_and_depth_costs_nothing() {
        for bytes in [
            &b"."[..],
            b"K",
            b"e.",
            b"K\x01a.",
            b"h\x07.",
            b"B\xff\xff\xff\xff.",
            b"\x8e\xff\xff\xff\xff\xff\xff\xff\xff.",
            b"}s.",
            b"i\n",
        ] {
            assert!(Pickle::read(bytes).is_err(), "{bytes:?}");
        }
        let deep: Vec<u8> = [vec![b']'; 300_000], vec![b'a'; 299_999], vec![b'.']].concat();
        assert!(Pickle::read(&deep).is_ok());
        assert!(Pickle::read(&vec![b']'; MOST_STEPS + 1]).unwrap_err().contains("more than"));
    }
}
