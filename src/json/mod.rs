//! JSON, for what crosses between the core and the page: any serde type is written, and read through a tree of values.
//!
//! It is made to be small, for it is part of what the page downloads: numbers go through
//! [`decimal`](crate::math::decimal), one writer and one tree serve all types, and errors name what is wrong but not
//! the line.

mod read;
mod write;

pub use read::from_str;
pub use write::to_string;

use core::fmt;

/// Why a text could not be read, or a value not be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error(String);

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl core::error::Error for Error {}

impl serde::ser::Error for Error {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Self(message.to_string())
    }
}

impl serde::de::Error for Error {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Self(message.to_string())
    }

    fn invalid_type(unexpected: serde::de::Unexpected<'_>, expected: &dyn serde::de::Expected) -> Self {
        wrong(unexpected, expected)
    }

    fn invalid_value(unexpected: serde::de::Unexpected<'_>, expected: &dyn serde::de::Expected) -> Self {
        wrong(unexpected, expected)
    }
}

#[cold]
fn wrong(unexpected: serde::de::Unexpected<'_>, expected: &dyn serde::de::Expected) -> Error {
    use serde::de::Unexpected;
    let found = match unexpected {
        Unexpected::Bool(_) => "a boolean",
        Unexpected::Unsigned(_) | Unexpected::Signed(_) => "this whole number",
        Unexpected::Float(_) => "this number",
        Unexpected::Str(_) => "this text",
        Unexpected::Unit => "null",
        Unexpected::Seq => "a list",
        Unexpected::Map => "an object",
        _ => "this",
    };
    Error(format!("{found} cannot stand where {expected} is expected"))
}
