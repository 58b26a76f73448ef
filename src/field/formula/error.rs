//! What can be wrong with a formula, said so that a person can mend it.

use core::ops::Range;

/// The class of a [`FormulaError`]; its name in JSON is the snake-case form.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum FormulaErrorKind {
    /// Nothing but white space.
    Empty,
    /// More than [`MAX_FORMULA_BYTES`](super::MAX_FORMULA_BYTES) of text; refused before parsing.
    TooLong,
    /// Nested deeper than [`MAX_DEPTH`](super::MAX_DEPTH).
    TooDeep,
    /// More than [`MAX_OPERATIONS`](super::MAX_OPERATIONS) operations.
    TooComplex,
    /// The formula stops where an operand or a bracket is due.
    UnexpectedEnd,
    /// A symbol that cannot stand where it stands.
    UnexpectedSymbol,
    /// A character that the language does not know, named by its code point.
    UnexpectedCharacter,
    /// A malformed number.
    BadNumber,
    /// `0,5`: a comma where a decimal point is meant.
    DecimalComma,
    /// A text with two possible readings.
    Ambiguous,
    /// A function name without its brackets.
    MissingBrackets,
    /// A function with too few or too many arguments.
    WrongArity,
    /// More than one `=`.
    TooManyEquations,
    /// A name that is neither a coordinate, a constant, a function nor a parameter.
    UnknownName,
    /// An unknown name used like a function.
    UnknownFunction,
    /// A constant expression without a finite value, such as `1/0` or `1e999`.
    NotFinite,
    /// A declared parameter with an unusable name, range or value.
    BadParameter,
}

/// Why a text is not a formula.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct FormulaError {
    /// The class of the error.
    pub kind: FormulaErrorKind,
    /// One sentence for a person; plain text.
    pub message: String,
    /// Bytes of the formula that the error is about; empty at the place where something is missing.
    pub span: Range<usize>,
    /// Text that would mend the span, if there is a good guess.
    pub suggestion: Option<String>,
    /// Unknown names that could be declared as parameters ("add a slider"), in order of appearance.
    pub names: Vec<String>,
}

impl FormulaError {
    pub(crate) fn new(kind: FormulaErrorKind, span: Range<usize>, message: impl Into<String>) -> Self {
        Self { kind, message: message.into(), span, suggestion: None, names: Vec::new() }
    }

    pub(crate) fn suggest(mut self, suggestion: impl Into<String>) -> Self {
        self.suggestion = Some(suggestion.into());
        self
    }

    pub(crate) fn names(mut self, names: Vec<String>) -> Self {
        self.names = names;
        self
    }

    /// The span in UTF-16 code units of `text`, the formula that was parsed: what a browser's text field counts
    /// in.
    #[must_use]
    pub fn utf16_span(&self, text: &str) -> Range<usize> {
        utf16_offset(text, self.span.start)..utf16_offset(text, self.span.end)
    }
}

/// The offset in UTF-16 code units of byte `byte` of `text`; an offset past the end gives the length, one inside
/// a character the start of that character.
#[must_use]
pub fn utf16_offset(text: &str, byte: usize) -> usize {
    text.char_indices().take_while(|&(at, c)| at + c.len_utf8() <= byte).map(|(_, c)| c.len_utf16()).sum()
}
