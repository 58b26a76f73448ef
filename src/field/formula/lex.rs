//! Text to tokens. Look-alikes of the ASCII operators and digits are mapped, everything else is an error that
//! names the code point.

use super::error::{FormulaError, FormulaErrorKind as ErrorKind};
use crate::math::decimal;
use core::ops::Range;

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token {
    Number(f64),
    Name(String),
    /// An integer exponent written in superscript digits.
    Superscript(i32),
    Plus,
    Minus,
    Star,
    Slash,
    Caret,
    Open,
    Close,
    Comma,
    Equals,
    End,
}

#[derive(Clone, Debug)]
pub(super) struct Spanned {
    pub(super) token: Token,
    pub(super) span: Range<usize>,
}

/// The character that `c` stands for in a formula.
fn mapped(c: char) -> char {
    match c {
        // Full-width forms of ! … ~ follow the ASCII order.
        '\u{FF01}'..='\u{FF5E}' => char::from_u32(u32::from(c) - 0xFEE0).unwrap_or(c),
        '\u{2212}' | '\u{2010}' | '\u{2011}' | '\u{2013}' | '\u{FE63}' => '-',
        '\u{00D7}' | '\u{00B7}' | '\u{22C5}' | '\u{2217}' | '\u{2219}' | '\u{2022}' => '*',
        '\u{00F7}' | '\u{2215}' | '\u{2044}' => '/',
        '\u{03D5}' => '\u{03C6}',
        // Spaces of every width, and the byte-order mark that some editors leave at the front.
        '\u{00A0}' | '\u{2000}'..='\u{200A}' | '\u{202F}' | '\u{205F}' | '\u{3000}' | '\u{FEFF}' => ' ',
        // Invisible times and invisible comma of mathematical text.
        '\u{2062}' => '*',
        '\u{2063}' => ',',
        _ => c,
    }
}

fn superscript(c: char) -> Option<u8> {
    Some(match c {
        '⁰' => 0,
        '¹' => 1,
        '²' => 2,
        '³' => 3,
        '⁴' => 4,
        '⁵' => 5,
        '⁶' => 6,
        '⁷' => 7,
        '⁸' => 8,
        '⁹' => 9,
        _ => return None,
    })
}

/// The constant that a single Greek letter stands for.
fn greek_constant(c: char) -> Option<&'static str> {
    match c {
        'π' => Some("pi"),
        'τ' => Some("tau"),
        'φ' => Some("phi"),
        _ => None,
    }
}

fn starts_name(c: char) -> bool {
    c.is_ascii_alphabetic() || (matches!(c, 'α'..='ω' | 'Α'..='Ω') && greek_constant(c).is_none())
}

fn continues_name(c: char) -> bool {
    starts_name(c) || c.is_ascii_digit() || c == '_'
}

/// Whether `name` can be the name of a parameter as far as its letters go.
pub(super) fn is_name(name: &str) -> bool {
    let mut letters = name.chars();
    letters.next().is_some_and(starts_name) && letters.all(continues_name)
}

/// The tokens of `text`, the last one being `End`. `declared` are names to be kept whole where a run of
/// coordinates such as `xy` would otherwise be read as a product.
pub(super) fn tokens(text: &str, declared: &[&str]) -> Result<Vec<Spanned>, FormulaError> {
    let characters: Vec<(usize, char)> = text.char_indices().map(|(at, c)| (at, mapped(c))).collect();
    let at = |index: usize| characters.get(index).map_or(text.len(), |&(at, _)| at);
    let get = |index: usize| characters.get(index).map(|&(_, c)| c);
    let mut out: Vec<Spanned> = Vec::new();
    let mut i = 0;
    while let Some(c) = get(i) {
        let start = i;
        i += 1;
        let token = match c {
            _ if c.is_ascii_whitespace() => continue,
            '+' => Token::Plus,
            '-' => Token::Minus,
            '*' if get(i) == Some('*') => {
                let span = at(start)..at(i + 1);
                return Err(FormulaError::new(ErrorKind::UnexpectedSymbol, span, "A power is written `^`")
                    .suggest("^"));
            }
            '*' => Token::Star,
            '/' => Token::Slash,
            '^' => Token::Caret,
            '[' | '{' => return Err(bracket(c, '(', at(start)..at(i))),
            ']' | '}' => return Err(bracket(c, ')', at(start)..at(i))),
            '(' => Token::Open,
            ')' => Token::Close,
            ',' => Token::Comma,
            '=' if get(i) == Some('=') => {
                let span = at(start)..at(i + 1);
                return Err(FormulaError::new(
                    ErrorKind::UnexpectedSymbol,
                    span,
                    "An equation is written with one `=`",
                )
                .suggest("="));
            }
            '=' => Token::Equals,
            '0'..='9' | '.' => {
                let digits = |mut i: usize| {
                    while get(i).is_some_and(|c| c.is_ascii_digit()) {
                        i += 1;
                    }
                    i
                };
                i = digits(start);
                if get(i) == Some('.') {
                    i = digits(i + 1);
                }
                // `2e3` is a number; `2e` and `2e x` are twice Euler's number.
                if matches!(get(i), Some('e' | 'E')) {
                    let sign = usize::from(matches!(get(i + 1), Some('+' | '-')));
                    let end = digits(i + 1 + sign);
                    if end > i + 1 + sign {
                        i = end;
                    }
                }
                let span = at(start)..at(i);
                let written: String = characters[start..i].iter().map(|&(_, c)| c).collect();
                let bad = written == "." || get(i) == Some('.');
                let value = if bad { None } else { decimal::read(&written) };
                let Some(value) = value else {
                    let span = at(start)..at((i + usize::from(get(i) == Some('.'))).max(start + 1));
                    let message = format!("`{}` is not a number", part(text, &span));
                    return Err(FormulaError::new(ErrorKind::BadNumber, span, message));
                };
                if !value.is_finite() {
                    let message = format!("`{written}` is too large to be a number");
                    return Err(FormulaError::new(ErrorKind::NotFinite, span, message));
                }
                if get(i) == Some(',') && get(i + 1).is_some_and(|c| c.is_ascii_digit()) {
                    let whole = at(start)..at(digits(i + 1));
                    let decimals: String = characters[i + 1..digits(i + 1)].iter().map(|&(_, c)| c).collect();
                    let message = format!(
                        "`{written},{decimals}`: decimals take a point; to separate two arguments put a space after the comma"
                    );
                    return Err(FormulaError::new(ErrorKind::DecimalComma, whole, message)
                        .suggest(format!("{written}.{decimals}")));
                }
                Token::Number(value)
            }
            _ if superscript(c).is_some() || c == '⁻' => {
                let mut value: i64 = 0;
                let mut digits = 0;
                i = start + usize::from(c == '⁻');
                while let Some(digit) = get(i).and_then(superscript) {
                    value = (value * 10 + i64::from(digit)).min(i64::from(i32::MAX));
                    digits += 1;
                    i += 1;
                }
                let span = at(start)..at(i.max(start + 1));
                if digits == 0 {
                    let message = "A raised minus needs raised digits after it, as in `x⁻²`";
                    return Err(FormulaError::new(ErrorKind::UnexpectedSymbol, span, message));
                }
                let value = i32::try_from(value).unwrap_or(i32::MAX);
                Token::Superscript(if c == '⁻' { -value } else { value })
            }
            _ if greek_constant(c).is_some() => Token::Name(greek_constant(c).unwrap_or_default().into()),
            _ if starts_name(c) => {
                while get(i).is_some_and(continues_name) {
                    i += 1;
                }
                let name: String = characters[start..i].iter().map(|&(_, c)| c).collect();
                let product = name.len() > 1 && name.bytes().all(|b| matches!(b, b'x' | b'y' | b'z'));
                if product && !declared.contains(&name.as_str()) {
                    for (offset, letter) in name.chars().enumerate() {
                        let span = at(start + offset)..at(start + offset + 1);
                        out.push(Spanned { token: Token::Name(letter.into()), span });
                    }
                    continue;
                }
                Token::Name(name)
            }
            _ => return Err(stranger(text, c, at(start)..at(i))),
        };
        out.push(Spanned { token, span: at(start)..at(i) });
    }
    out.push(Spanned { token: Token::End, span: text.len()..text.len() });
    Ok(out)
}

/// The part of the text at `span`; nothing if that splits a character, so that no formula can end the program.
pub(super) fn part<'a>(text: &'a str, span: &Range<usize>) -> &'a str {
    text.get(span.clone()).unwrap_or_default()
}

fn bracket(found: char, wanted: char, span: Range<usize>) -> FormulaError {
    let message = format!("Use round brackets `{wanted}` in place of `{found}`");
    FormulaError::new(ErrorKind::UnexpectedSymbol, span, message).suggest(wanted)
}

/// The error for a character that the language has no use for.
fn stranger(text: &str, c: char, span: Range<usize>) -> FormulaError {
    let written = part(text, &span);
    let point = u32::from(c);
    let name = match c {
        '\0' => "a null character",
        '\u{200B}'..='\u{200D}' | '\u{2060}' => "an invisible joiner or space",
        '\u{200E}' | '\u{200F}' | '\u{202A}'..='\u{202E}' | '\u{2066}'..='\u{2069}' | '\u{061C}' => {
            "an invisible text-direction mark"
        }
        '\u{FFFD}' => "a replacement character, left by a damaged text",
        _ if c.is_control() => "a control character",
        _ => "",
    };
    let message = if name.is_empty() {
        format!("`{written}` (U+{point:04X}) means nothing in a formula")
    } else {
        format!("U+{point:04X}, {name}, cannot stand in a formula")
    };
    let error = FormulaError::new(ErrorKind::UnexpectedCharacter, span, message);
    match c {
        '√' => error.suggest("sqrt"),
        '∛' => error.suggest("cbrt"),
        '|' => FormulaError { message: "Write an absolute value as `abs(…)`".into(), ..error },
        '<' | '>' | '≤' | '≥' | '≠' => {
            FormulaError { message: "A surface is an equation: write `f = g`".into(), ..error }.suggest("=")
        }
        ';' => error.suggest(","),
        _ if !name.is_empty() => error.suggest(""),
        _ => error,
    }
}
