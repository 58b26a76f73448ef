//! The tokens of a formula.

use core::ops::Range;

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token {
    Number(f64),
    Name(String),
    /// Integer exponent in superscript digits.
    Superscript(i32),
    Plus,
    Minus,
    Star,
    Slash,
    /// The remainder of a division.
    Percent,
    Caret,
    /// Opening bracket: round, square or curly, of `⌊x⌋` or of `⌈x⌉`.
    Open(char),
    Close(char),
    Bar(Bar),
    /// `\frac`, which two groups follow.
    Fraction,
    /// `\sqrt`, which `[n]` may follow, and a group.
    Root,
    Comma,
    Equals,
    Compare(Comparison),
    And,
    Or,
    Not,
    /// `?` and `:` of a choice.
    Question,
    Colon,
    /// The sign before the arguments of a nameless function, `@(x, y, z)`.
    At,
    /// The sign after the arguments of a nameless function, `(x, y, z) =>`.
    Arrow,
    /// `;`, or the end of a line that ends a definition.
    Separator,
    End,
}

/// A comparison of two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Comparison {
    Less,
    AtMost,
    Greater,
    AtLeast,
}

impl Comparison {
    pub(super) fn sign(self) -> &'static str {
        match self {
            Self::Less => "<",
            Self::AtMost => "<=",
            Self::Greater => ">",
            Self::AtLeast => ">=",
        }
    }
}

/// A bar of an absolute value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Bar {
    /// `|`, which opens or closes by its place.
    Either,
    Opening,
    Closing,
}

/// The bracket that closes `open`.
pub(super) fn closing(open: char) -> char {
    match open {
        '[' => ']',
        '{' => '}',
        '⌊' => '⌋',
        '⌈' => '⌉',
        _ => ')',
    }
}

#[derive(Clone, Debug)]
pub(super) struct Spanned {
    pub(super) token: Token,
    pub(super) span: Range<usize>,
}

/// Text at `span`, or nothing if `span` splits a character. It never panics, whatever the formula.
pub(super) fn slice<'a>(text: &'a str, span: &Range<usize>) -> &'a str {
    text.get(span.clone()).unwrap_or_default()
}
