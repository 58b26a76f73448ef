//! Reading: the text becomes a tree, and the tree the type.

use super::Error;
use crate::math::decimal;
use serde::de::value::{MapDeserializer, SeqDeserializer, StringDeserializer};
use serde::de::{DeserializeOwned, Deserializer, IntoDeserializer, Visitor};
use serde::forward_to_deserialize_any;

/// Lists and objects may be nested this deep.
const MOST_DEPTH: usize = 32;

/// Reads a type from JSON.
///
/// # Errors
///
/// If the text is not JSON, or not of the type.
pub fn from_str<T: DeserializeOwned>(text: &str) -> Result<T, Error> {
    T::deserialize(tree(text)?)
}

enum Value {
    Null,
    Boolean(bool),
    Whole(u64),
    Number(f64),
    Text(String),
    List(Vec<Value>),
    Object(Vec<(String, Value)>),
}

impl<'de> IntoDeserializer<'de, Error> for Value {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

impl<'de> Deserializer<'de> for Value {
    type Error = Error;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self {
            Self::Null => visitor.visit_unit(),
            Self::Boolean(value) => visitor.visit_bool(value),
            Self::Whole(value) => visitor.visit_u64(value),
            Self::Number(value) => visitor.visit_f64(value),
            Self::Text(value) => visitor.visit_string(value),
            Self::List(values) => {
                let mut rest = SeqDeserializer::new(values.into_iter());
                let value = visitor.visit_seq(&mut rest)?;
                rest.end()?;
                Ok(value)
            }
            Self::Object(fields) => visitor.visit_map(MapDeserializer::new(fields.into_iter())),
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        if matches!(self, Self::Null) { visitor.visit_none() } else { visitor.visit_some(self) }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, Error> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        let Self::Text(variant) = self else { return Err(Error(format!("{name} must be a text"))) };
        StringDeserializer::new(variant).deserialize_enum(name, variants, visitor)
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_unit()
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 u8 u16 u32 u64 f32 f64 char str string bytes byte_buf unit unit_struct seq tuple
        tuple_struct map struct identifier
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
