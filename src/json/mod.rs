//! JSON, for what crosses between the core and the page: any serde type is written; what is read becomes a tree of values
//! first, of which a few types are made.
//!
//! It is made to be small, for it is part of what the page downloads: numbers go through
//! [`decimal`](crate::math::decimal), one writer and one tree serve all types, and errors name what is wrong but not
//! the line.

mod read;
mod write;

pub use read::{Fields, Read, Value, from_str};
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
