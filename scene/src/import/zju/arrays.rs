//! numpy's arrays inside a pickle, and lists in their place.

use super::pickle::{Id, Pickle, Value};

/// Most numbers of one key, such as K, of all cameras. It bounds what lists of lists of the same list can make.
const MOST_NUMBERS: usize = 100_000;
/// Longest text in bytes.
const LONGEST: usize = 4096;
/// Deepest lists of lists.
const DEEPEST: usize = 4;

/// An array as numpy keeps it.
struct Array<'a> {
    shape: Vec<usize>,
    by_columns: bool,
    /// Such as f8, or O for objects.
    kind: &'a str,
    big_endian: bool,
    data: Id,
}

fn array<'a>(pickle: &'a Pickle<'_>, id: Id) -> Option<Array<'a>> {
    let Value::Call { function, state: Some(state), .. } = pickle.get(id) else { return None };
    let &[.., shape, kind, order, data] = pickle.list(*state)? else { return None };
    if !pickle.is_name(*function, "_reconstruct") {
        return None;
    }
    let int = |&id: &Id| match pickle.get(id) {
        Value::Int(value) => usize::try_from(*value).ok(),
        _ => None,
    };
    let (kind, big_endian) = kind_of(pickle, kind)?;
    Some(Array {
        shape: pickle.list(shape)?.iter().map(int).collect::<Option<_>>()?,
        by_columns: *pickle.get(order) == Value::Bool(true),
        kind,
        big_endian,
        data,
    })
}

/// The type of an array's values, and whether their highest byte comes first.
fn kind_of<'a>(pickle: &'a Pickle<'_>, id: Id) -> Option<(&'a str, bool)> {
    let Value::Call { arguments, state, .. } = pickle.get(id) else { return None };
    let kind = pickle.text(*pickle.list(*arguments)?.first()?)?;
    let order = state.and_then(|state| pickle.text(*pickle.list(state)?.get(1)?));
    Some((kind, order == Some(">")))
}

/// The items of a list, a tuple or an array of objects.
pub fn items<'a>(pickle: &'a Pickle<'_>, id: Id) -> Option<&'a [Id]> {
    match array(pickle, id) {
        Some(array) if array.kind.starts_with('O') => pickle.list(array.data),
        Some(_) => None,
        None => pickle.list(id),
    }
}

/// The entries of a dict, also where it is the only object of an array.
pub fn entries<'a>(pickle: &'a Pickle<'_>, id: Id) -> Option<&'a [(Id, Id)]> {
    match pickle.get(id) {
        Value::Map(entries) => Some(entries),
        _ => match pickle.get(*items(pickle, id)?.first()?) {
            Value::Map(entries) => Some(entries),
            _ => None,
        },
    }
}

fn too_many() -> String {
    format!("has more than {MOST_NUMBERS} numbers")
}

/// All numbers of an array or of nested lists, by rows.
pub fn numbers(pickle: &Pickle<'_>, id: Id) -> Result<Vec<f64>, String> {
    let mut list = Vec::new();
    add_numbers(pickle, id, DEEPEST, &mut list)?;
    Ok(list)
}

fn add_numbers(pickle: &Pickle<'_>, id: Id, deeper: usize, list: &mut Vec<f64>) -> Result<(), String> {
    if list.len() > MOST_NUMBERS {
        return Err(too_many());
    }
    if let Some(array) = array(pickle, id)
        && !array.kind.starts_with('O')
    {
        list.extend(array.numbers(pickle)?);
        return Ok(());
    }
    match pickle.get(id) {
        Value::Int(value) => list.push(*value as f64),
        Value::Float(value) => list.push(*value),
        _ => {
            let inner = items(pickle, id).filter(|_| deeper > 0);
            for &item in inner.ok_or("is neither an array nor a list of numbers")? {
                let before = list.len();
                add_numbers(pickle, item, deeper - 1, list)?;
                if list.len() == before {
                    return Err(String::from("has an empty list"));
                }
            }
        }
    }
    Ok(())
}

/// One list of numbers per item of a list, or per first index of an array.
pub fn lists(pickle: &Pickle<'_>, id: Id) -> Result<Vec<Vec<f64>>, String> {
    if let Some(items) = items(pickle, id) {
        let mut total = 0;
        let one = |&item: &Id| {
            let list = numbers(pickle, item)?;
            total += list.len().max(1);
            if total > MOST_NUMBERS { Err(too_many()) } else { Ok(list) }
        };
        return items.iter().map(one).collect();
    }
    let all = numbers(pickle, id)?;
    let count = array(pickle, id).and_then(|array| array.shape.first().copied()).unwrap_or(0);
    if count == 0 || all.len() % count != 0 {
        return Err(String::from("is no list"));
    }
    Ok(all.chunks_exact(all.len() / count).map(<[f64]>::to_vec).collect())
}

/// The texts of a list or of an array of text, if there are `count`.
pub fn texts(pickle: &Pickle<'_>, id: Id, count: usize) -> Option<Vec<String>> {
    let text = |&id: &Id| pickle.text(id).filter(|text| text.len() <= LONGEST).map(str::to_owned);
    let texts = match items(pickle, id) {
        Some(items) => items.iter().take(count + 1).map(text).collect(),
        None => array(pickle, id)?.texts(pickle),
    };
    texts.filter(|texts: &Vec<String>| texts.len() == count)
}

impl Array<'_> {
    fn numbers(&self, pickle: &Pickle<'_>) -> Result<Vec<f64>, String> {
        let (kind, size) = self.kind.split_at(self.kind.len().min(1));
        let size: usize = size.parse().ok().filter(|size| [1, 2, 4, 8].contains(size)).unwrap_or(0);
        let count = self.shape.iter().try_fold(1usize, |count, &side| count.checked_mul(side));
        let bytes = pickle.bytes(self.data).unwrap_or_default();
        if size == 0 || count.and_then(|count| count.checked_mul(size)) != Some(bytes.len()) {
            return Err(format!("is an array of `{}` whose data has another size", self.kind));
        }
        if bytes.len() / size > MOST_NUMBERS {
            return Err(too_many());
        }
        let bits = |chunk: &[u8]| {
            let add = |value: u64, &byte: &u8| value << 8 | u64::from(byte);
            if self.big_endian { chunk.iter().fold(0, add) } else { chunk.iter().rev().fold(0, add) }
        };
        let signed = |bits: u64| {
            let unused = 64 - 8 * size as u32;
            (bits << unused).cast_signed() >> unused
        };
        let number = |chunk: &[u8]| match (kind, size) {
            ("f", 8) => Ok(f64::from_bits(bits(chunk))),
            ("f", 4) => Ok(f64::from(f32::from_bits(bits(chunk) as u32))),
            ("i", _) => Ok(signed(bits(chunk)) as f64),
            ("u", _) => Ok(bits(chunk) as f64),
            _ => Err(format!("is an array of `{}`: save it as numbers of type f4 or f8", self.kind)),
        };
        let list: Vec<f64> = bytes.chunks_exact(size).map(number).collect::<Result<_, _>>()?;
        match self.shape[..] {
            [rows, columns] if self.by_columns => {
                Ok((0..rows * columns).map(|i| list[i % columns * rows + i / columns]).collect())
            }
            [_, _, _, ..] if self.by_columns => Err(String::from("is an array in Fortran's order: save it in C's")),
            _ => Ok(list),
        }
    }

    /// Texts of equal length, filled with zeros: four bytes per character.
    fn texts(&self, pickle: &Pickle<'_>) -> Option<Vec<String>> {
        let length: usize = self.kind.strip_prefix('U')?.parse().ok()?;
        let bytes = pickle.bytes(self.data)?;
        let character = |four: &[u8]| {
            let four = four.try_into().ok()?;
            char::from_u32(if self.big_endian { u32::from_be_bytes(four) } else { u32::from_le_bytes(four) })
        };
        let text = |chunk: &[u8]| {
            let all: Option<String> = chunk.chunks_exact(4).map(character).collect();
            all.map(|text| text.trim_end_matches('\0').to_owned())
        };
        bytes.chunks_exact(length.checked_mul(4).filter(|&size| size > 0)?).map(text).collect()
    }
}
