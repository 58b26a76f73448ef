//! Heads of definitions: the name that a statement gives a value or a function, as formulas and
//! programs write it.

use super::token::{Spanned, Token};

/// Words before the name that a program gives a value or a function.
const KEYWORDS: [&str; 9] = ["float", "double", "int", "let", "const", "var", "auto", "def", "function"];

/// The beginning of a definition.
pub(super) struct Head {
    /// Token of the name, which a keyword may precede.
    pub(super) name: usize,
    pub(super) has_keyword: bool,
    /// Names of the arguments of a function.
    pub(super) arguments: Vec<String>,
    /// First token of the definition's body.
    pub(super) body: usize,
}

pub(super) fn word(tokens: &[Spanned], at: usize) -> Option<&str> {
    match &tokens.get(at)?.token {
        Token::Name(name) => Some(name),
        _ => None,
    }
}

pub(super) fn is_at(tokens: &[Spanned], at: usize, token: &Token) -> bool {
    tokens.get(at).is_some_and(|spanned| spanned.token == *token)
}

/// The names between token `at` and the token `end`, with commas between them and perhaps types
/// before them, and the token after `end`. Mathematica writes `f[x_]`.
fn names(tokens: &[Spanned], mut at: usize, end: &Token) -> Option<(Vec<String>, usize)> {
    let mut names = Vec::new();
    loop {
        if word(tokens, at).is_some_and(|word| KEYWORDS.contains(&word)) && word(tokens, at + 1).is_some() {
            at += 1;
        }
        let name = word(tokens, at)?;
        names.push(if *end == Token::Close(']') { name.strip_suffix('_')? } else { name }.to_owned());
        at += 1;
        if is_at(tokens, at, end) {
            return Some((names, at + 1));
        }
        if !is_at(tokens, at, &Token::Comma) {
            return None;
        }
        at += 1;
    }
}

/// The arguments of a nameless function, `@(x, y, z) …`, `lambda x, y, z: …` or `(x, y, z) => …`,
/// and the token after them.
pub(super) fn nameless(tokens: &[Spanned], at: usize) -> Option<(Vec<String>, usize)> {
    match &tokens.get(at)?.token {
        Token::At if is_at(tokens, at + 1, &Token::Open('(')) => names(tokens, at + 2, &Token::Close(')')),
        Token::Name(name) if name == "lambda" => names(tokens, at + 1, &Token::Colon),
        Token::Open('(') => names(tokens, at + 1, &Token::Close(')'))
            .filter(|&(_, next)| is_at(tokens, next, &Token::Arrow))
            .map(|(names, next)| (names, next + 1)),
        _ => None,
    }
}

/// The head of a definition that begins with token `at`: `r =`, `float r =`, `f(a, b) =`, `f =
/// lambda a, b:`, `def f(a, b):`.
pub(super) fn head(tokens: &[Spanned], at: usize) -> Option<Head> {
    let mut name = at;
    while word(tokens, name).is_some_and(|word| KEYWORDS.contains(&word)) && word(tokens, name + 1).is_some()
    {
        name += 1;
    }
    word(tokens, name)?;
    let has_keyword = name > at;
    let (mut arguments, mut next) = (Vec::new(), name + 1);
    for (open, close) in [('(', ')'), ('[', ']')] {
        if is_at(tokens, name + 1, &Token::Open(open)) {
            (arguments, next) = names(tokens, next + 1, &Token::Close(close))?;
        }
    }
    let is_python = has_keyword && !arguments.is_empty() && is_at(tokens, next, &Token::Colon);
    if !is_python && !is_at(tokens, next, &Token::Equals) {
        return None;
    }
    let mut body = next + 1;
    if arguments.is_empty()
        && let Some((names, next)) = nameless(tokens, body)
    {
        (arguments, body) = (names, next);
    }
    Some(Head { name, has_keyword, arguments, body })
}
