//! Reading: the text becomes a tree, and the tree the type.

use super::Error;
use crate::math::decimal;
use std::collections::BTreeMap;

/// Lists and objects may be nested this deep.
const MOST_DEPTH: usize = 32;

/// Reads a type from JSON.
///
/// # Errors
///
/// If the text is not JSON, or not of the type.
pub fn from_str<T: Read>(text: &str) -> Result<T, Error> {
    T::read(tree(text)?)
}

/// A JSON value.
pub enum Value {
    /// null
    Null,
    /// true or false
    Boolean(bool),
    /// A whole number from 0 to 2⁶⁴ − 1.
    Whole(u64),
    /// Any other number.
    Number(f64),
    /// A text.
    Text(String),
    /// A list.
    List(Vec<Value>),
    /// An object; no two keys are equal.
    Object(Vec<(String, Value)>),
}

impl Value {
    /// The error that this value stands where another one is `expected`.
    #[cold]
    pub fn refused(&self, expected: &str) -> Error {
        let found = match self {
            Self::Null => "null",
            Self::Boolean(_) => "a boolean",
            Self::Whole(_) => "this whole number",
            Self::Number(_) => "this number",
            Self::Text(_) => "this text",
            Self::List(_) => "a list",
            Self::Object(_) => "an object",
        };
        Error(format!("{found} cannot stand where {expected} is expected"))
    }

    fn list(self) -> Result<Vec<Self>, Error> {
        match self {
            Self::List(values) => Ok(values),
            other => Err(other.refused("a list")),
        }
    }

    /// The fields of an object.
    ///
    /// # Errors
    ///
    /// If it is none.
    pub fn fields(self) -> Result<Fields, Error> {
        match self {
            Self::Object(fields) => Ok(Fields(fields)),
            other => Err(other.refused("an object")),
        }
    }
}

/// A type that can be read.
pub trait Read: Sized {
    /// The value of the type that a JSON value stands for.
    ///
    /// # Errors
    ///
    /// If it stands for none.
    fn read(value: Value) -> Result<Self, Error>;

    /// What a field of this type is where an object has none of its name.
    #[must_use]
    fn missing() -> Option<Self> {
        None
    }
}

/// The fields of an object, to be taken one by one; what is left is ignored.
pub struct Fields(Vec<(String, Value)>);

impl Fields {
    #[inline(never)]
    fn take(&mut self, name: &str) -> Option<Value> {
        let place = self.0.iter().position(|field| field.0 == name)?;
        Some(self.0.swap_remove(place).1)
    }

    /// The field of this name, or `default`.
    ///
    /// # Errors
    ///
    /// If it is not of the type, or there is neither.
    pub fn field<T: Read>(&mut self, name: &str, default: Option<T>) -> Result<T, Error> {
        match self.take(name) {
            Some(value) => T::read(value),
            None => {
                default.or_else(T::missing).ok_or_else(|| Error(format!("the field `{name}` is missing")))
            }
        }
    }
}

impl Read for f64 {
    fn read(value: Value) -> Result<Self, Error> {
        match value {
            Value::Whole(whole) => Ok(whole as Self),
            Value::Number(number) => Ok(number),
            other => Err(other.refused("a number")),
        }
    }
}

impl Read for u64 {
    fn read(value: Value) -> Result<Self, Error> {
        if let Value::Whole(whole) = value { Ok(whole) } else { Err(value.refused("a whole number")) }
    }
}

impl Read for u32 {
    fn read(value: Value) -> Result<Self, Error> {
        match value {
            Value::Whole(whole) if whole <= Self::MAX.into() => Ok(whole as Self),
            other => Err(other.refused("a whole number below 2^32")),
        }
    }
}

impl Read for String {
    fn read(value: Value) -> Result<Self, Error> {
        if let Value::Text(text) = value { Ok(text) } else { Err(value.refused("a text")) }
    }
}

impl<T: Read> Read for Option<T> {
    fn read(value: Value) -> Result<Self, Error> {
        if let Value::Null = value { Ok(None) } else { T::read(value).map(Some) }
    }

    fn missing() -> Option<Self> {
        Some(None)
    }
}

impl<T: Read> Read for Vec<T> {
    fn read(value: Value) -> Result<Self, Error> {
        value.list()?.into_iter().map(T::read).collect()
    }
}

impl<T: Read, const N: usize> Read for [T; N] {
    fn read(value: Value) -> Result<Self, Error> {
        Vec::read(value)?.try_into().map_err(|_| Error(format!("a list of {N} is expected")))
    }
}

impl Read for BTreeMap<String, f64> {
    fn read(value: Value) -> Result<Self, Error> {
        // Collected, they would be sorted first, by code that nothing else needs.
        let mut map = Self::new();
        for (key, value) in value.fields()?.0 {
            map.insert(key, f64::read(value)?);
        }
        Ok(map)
    }
}

fn tree(text: &str) -> Result<Value, Error> {
    let mut parser = Parser { text, at: 0 };
    let value = parser.value(0)?;
    parser.skip_space();
    if parser.at < text.len() {
        return Err(parser.unexpected());
    }
    Ok(value)
}

struct Parser<'a> {
    text: &'a str,
    at: usize,
}

impl Parser<'_> {
    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    fn skip_space(&mut self) {
        while matches!(self.peek(), Some(b' ' | b'\t' | b'\n' | b'\r')) {
            self.at += 1;
        }
    }

    /// Whether `wanted` comes next; then it is read.
    fn take(&mut self, wanted: &str) -> bool {
        let found = self.text.as_bytes()[self.at..].starts_with(wanted.as_bytes());
        self.at += if found { wanted.len() } else { 0 };
        found
    }

    #[cold]
    fn unexpected(&self) -> Error {
        if self.at < self.text.len() {
            Error(format!("the text is not JSON from byte {} on", self.at))
        } else {
            Error("the text ends too early to be JSON".into())
        }
    }

    fn value(&mut self, depth: usize) -> Result<Value, Error> {
        if depth > MOST_DEPTH {
            return Err(Error("the text is nested too deep".into()));
        }
        self.skip_space();
        match self.peek() {
            Some(b'n') if self.take("null") => Ok(Value::Null),
            Some(b't') if self.take("true") => Ok(Value::Boolean(true)),
            Some(b'f') if self.take("false") => Ok(Value::Boolean(false)),
            Some(b'"') => self.string().map(Value::Text),
            Some(b'-' | b'0'..=b'9') => self.number(),
            Some(b'[') => {
                let mut values = Vec::new();
                self.items("]", |parser| {
                    values.push(parser.value(depth + 1)?);
                    Ok(())
                })?;
                Ok(Value::List(values))
            }
            Some(b'{') => {
                let mut fields = Vec::new();
                self.items("}", |parser| {
                    let key = parser.string()?;
                    parser.skip_space();
                    if !parser.take(":") {
                        return Err(parser.unexpected());
                    }
                    if fields.iter().any(|(other, _)| *other == key) {
                        return Err(Error(format!("`{key}` is there twice")));
                    }
                    fields.push((key, parser.value(depth + 1)?));
                    Ok(())
                })?;
                Ok(Value::Object(fields))
            }
            _ => Err(self.unexpected()),
        }
    }

    /// What stands between the bracket that comes next and `close`, item by item.
    fn items(
        &mut self,
        close: &str,
        mut item: impl FnMut(&mut Self) -> Result<(), Error>,
    ) -> Result<(), Error> {
        self.at += 1;
        self.skip_space();
        if self.take(close) {
            return Ok(());
        }
        loop {
            self.skip_space();
            item(self)?;
            self.skip_space();
            if self.take(close) {
                return Ok(());
            }
            if !self.take(",") {
                return Err(self.unexpected());
            }
        }
    }

    fn number(&mut self) -> Result<Value, Error> {
        let start = self.at;
        while matches!(self.peek(), Some(b'-' | b'+' | b'.' | b'e' | b'E' | b'0'..=b'9')) {
            self.at += 1;
        }
        let text = self.text.get(start..self.at).unwrap_or_default();
        // What JSON forbids and the reader of numbers would take.
        let bytes = text.trim_start_matches('-').as_bytes();
        let padded = matches!(bytes, [b'0', b'0'..=b'9', ..]);
        let bare =
            (0..bytes.len()).any(|k| bytes[k] == b'.' && !bytes.get(k + 1).is_some_and(u8::is_ascii_digit));
        let number = if padded || bare || bytes.first() == Some(&b'.') { None } else { decimal::read(text) };
        match (text.parse::<u64>(), number) {
            (Ok(whole), Some(_)) => Ok(Value::Whole(whole)),
            (_, Some(number)) if number.is_finite() => Ok(Value::Number(number)),
            (_, Some(_)) => Err(Error(format!("{text} is too large to be a number"))),
            _ => {
                self.at = start;
                Err(self.unexpected())
            }
        }
    }

    fn string(&mut self) -> Result<String, Error> {
        if !self.take("\"") {
            return Err(self.unexpected());
        }
        let mut out = String::new();
        loop {
            let rest = self.text.get(self.at..).unwrap_or_default();
            let Some(c) = rest.chars().next() else { return Err(self.unexpected()) };
            match c {
                '"' => {
                    self.at += 1;
                    return Ok(out);
                }
                '\\' => {
                    let c = self.escape()?;
                    out.push(c);
                }
                '\0'..='\u{1f}' => return Err(self.unexpected()),
                _ => {
                    self.at += c.len_utf8();
                    out.push(c);
                }
            }
        }
    }

    /// The character that an escape stands for.
    fn escape(&mut self) -> Result<char, Error> {
        let start = self.at;
        self.at += 1;
        let letter = self.peek();
        self.at += 1;
        let c = match letter {
            Some(c @ (b'"' | b'\\' | b'/')) => Some(char::from(c)),
            Some(b'n') => Some('\n'),
            Some(b't') => Some('\t'),
            Some(b'r') => Some('\r'),
            Some(b'b') => Some('\u{8}'),
            Some(b'f') => Some('\u{c}'),
            Some(b'u') => match self.unit() {
                Some(high @ 0xd800..0xdc00) if self.take("\\u") => match self.unit() {
                    Some(low @ 0xdc00..0xe000) => {
                        char::from_u32(0x1_0000 + ((high - 0xd800) << 10) + (low - 0xdc00))
                    }
                    _ => None,
                },
                unit => unit.and_then(char::from_u32),
            },
            _ => None,
        };
        c.ok_or_else(|| {
            self.at = start;
            self.unexpected()
        })
    }

    /// Four hexadecimal digits.
    fn unit(&mut self) -> Option<u32> {
        let digits = self.text.get(self.at..self.at + 4)?;
        self.at += 4;
        digits.chars().try_fold(0, |unit, c| Some(unit << 4 | c.to_digit(16)?))
    }
}
