//! Answers to commands of the page: `{"ok": true, …}` with the fields of the value, or
//! `{"ok": false, "error": …}`.

use serde::{Serialize, Serializer};

/// An answer to a command that can be refused.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum Answer<T, E> {
    /// The command was carried out.
    Accepted {
        /// Tells the two answers apart.
        ok: Literal<true>,
        /// Result of the command: a structure, whose fields stand beside `ok`.
        #[serde(flatten)]
        value: T,
    },
    /// The command was refused.
    Refused {
        /// Tells the two answers apart.
        ok: Literal<false>,
        /// The error.
        error: E,
    },
}

/// A type with one value, which is a boolean in JSON.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Literal<const VALUE: bool>;

impl<const VALUE: bool> Serialize for Literal<VALUE> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_bool(VALUE)
    }
}

impl<T, E> From<Result<T, E>> for Answer<T, E> {
    fn from(result: Result<T, E>) -> Self {
        match result {
            Ok(value) => Self::Accepted { ok: Literal, value },
            Err(error) => Self::Refused { ok: Literal, error },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Answer;

    #[derive(serde::Serialize)]
    struct Size {
        radius: f64,
        count: Option<u32>,
    }

    #[test]
    fn an_answer_says_ok_beside_its_fields_or_the_error() {
        let json = |result: Result<Size, &str>| serde_json::to_string(&Answer::from(result)).unwrap();
        assert_eq!(json(Ok(Size { radius: 0.1, count: None })), r#"{"ok":true,"radius":0.1,"count":null}"#);
        assert_eq!(json(Err("too large")), r#"{"ok":false,"error":"too large"}"#);
    }
}
