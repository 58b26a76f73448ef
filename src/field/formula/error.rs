//! Errors of a formula: their class, a message for the user, the text concerned and a suggested
//! correction.

use core::ops::Range;

/// The class of a [`FormulaError`]; its name in JSON is the snake-case form.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum FormulaErrorKind {
    /// The text holds nothing but white space.
    Empty,
    /// The text is longer than [`MAX_FORMULA_BYTES`](super::MAX_FORMULA_BYTES). It is refused
    /// before parsing.
    TooLong,
    /// The formula is nested too deep.
    TooDeep,
    /// The formula has more than [`MAX_OPERATIONS`](super::MAX_OPERATIONS) operations.
    TooComplex,
    /// The formula ends where an operand or a bracket is expected.
    UnexpectedEnd,
    /// A symbol is not allowed in its place.
    UnexpectedSymbol,
    /// A character is not part of the language. The message gives its code point.
    UnexpectedCharacter,
    /// A number is malformed.
    BadNumber,
    /// A comma stands where a decimal point is meant, as in `0,5`.
    DecimalComma,
    /// The text has two possible readings.
    Ambiguous,
    /// A function name is not followed by brackets.
    MissingBrackets,
    /// A function has too few or too many arguments.
    WrongArity,
    /// There is more than one `=`.
    TooManyEquations,
    /// A name is neither a coordinate, a constant, a function nor a parameter.
    UnknownName,
    /// An unknown name is used like a function.
    UnknownFunction,
    /// A definition has a name that is taken, refers to itself or to a later one, or is missing.
    BadDefinition,
    /// A constant expression has no finite value, such as `1/0` or `1e999`.
    NotFinite,
    /// A declared parameter has an unusable name, range or value.
    BadParameter,
    /// A formula for a model from points does not use the model as an operand.
    ModelUse,
}

/// Error of [`Formula::parse`](super::Formula::parse) and of the other operations on formulas.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
#[non_exhaustive]
pub struct FormulaError {
    /// The class of the error.
    pub kind: FormulaErrorKind,
    /// The error as a sentence for the user, in plain text.
    pub message: String,
    /// Byte range of the formula that the error concerns. It is empty where something is missing.
    pub span: Range<usize>,
    /// Text that would correct the span, if there is a good guess.
    pub suggestion: Option<String>,
    /// Texts for the span, each with another meaning, where the formula has several readings.
    pub choices: Box<[String]>,
    /// The formula with every mistake of this kind corrected, if there are several.
    pub mended: Option<Box<Mended>>,
    /// The unknown name, which could be declared as a parameter ("add a slider").
    pub name: Option<String>,
}

/// A formula with every mistake of one kind corrected.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Mended {
    /// The whole formula.
    pub text: String,
    /// Number of places that were corrected.
    pub places: usize,
}

impl FormulaError {
    /// Error for a condition used as a number.
    pub(super) fn misplaced_condition(span: &Range<usize>) -> Self {
        let message = "A comparison stands in the condition of a choice alone: `if(x < 1, a, b)`";
        Self::new(FormulaErrorKind::UnexpectedSymbol, span.clone(), message)
    }

    pub(crate) fn new(kind: FormulaErrorKind, span: Range<usize>, message: impl Into<String>) -> Self {
        Self {
            kind,
            message: message.into(),
            span,
            suggestion: None,
            choices: Box::default(),
            mended: None,
            name: None,
        }
    }

    pub(crate) fn suggest(mut self, suggestion: impl Into<String>) -> Self {
        self.suggestion = Some(suggestion.into());
        self
    }

    pub(crate) fn choose(mut self, choices: impl IntoIterator<Item = String>) -> Self {
        self.choices = choices.into_iter().collect();
        self
    }

    pub(crate) fn unknown(mut self, name: &str) -> Self {
        self.name = Some(name.into());
        self
    }

    /// Span in UTF-16 code units, which a browser's text field counts in. `text` is the formula
    /// that was parsed.
    #[must_use]
    pub fn utf16_span(&self, text: &str) -> Range<usize> {
        utf16_offset(text, self.span.start)..utf16_offset(text, self.span.end)
    }
}

/// Offset in UTF-16 code units of byte `byte` of `text`.
///
/// An offset past the end gives the length; one inside a character gives the start of that
/// character.
#[must_use]
pub fn utf16_offset(text: &str, byte: usize) -> usize {
    text.char_indices().take_while(|&(at, c)| at + c.len_utf8() <= byte).map(|(_, c)| c.len_utf16()).sum()
}
