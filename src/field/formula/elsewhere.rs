//! Names of functions in other languages and books, each with the way to write it here.

use super::error::{FormulaError, FormulaErrorKind as ErrorKind};
use super::token::{Spanned, Token, slice};

/// The places of a call's arguments in [`call_elsewhere`]: the first, second and third, with their names in messages. No formula has
/// these characters.
const PLACES: [(char, &str); 3] = [('①', "a"), ('②', "b"), ('③', "c")];
/// The place of all arguments.
const ALL: char = '…';

/// Function that is called `name` in other languages and books.
pub(super) fn name_elsewhere(name: &str) -> Option<&'static str> {
    Some(match name {
        "log" => "ln",
        "lg" => "log10",
        "arcsin" => "asin",
        "arccos" => "acos",
        "arctan" => "atan",
        "sgn" => "sign",
        _ => return None,
    })
}

/// How a call of `name` is written here. Only calls count: as a name of its own, such as `length`, it may be a parameter.
fn call_elsewhere(name: &str) -> Option<&'static str> {
    Some(match name {
        "length" | "norm" | "len" => "hypot(…)",
        "vec2" | "vec3" | "vec4" => "…",
        "pow" => "①^②",
        "abs2" => "①^2",
        "clamp" => "min(max(①, ②), ③)",
        "mix" | "lerp" => "①*(1 - ③) + ②*③",
        "mod" | "fmod" => "① - ②*floor(①/②)",
        "fract" => "① - floor(①)",
        "ceil" => "-floor(-①)",
        "round" => "floor(① + 1/2)",
        "step" => "(1 + sign(② - ①))/2",
        _ => return None,
    })
}

fn is_of_vectors(name: &str) -> bool {
    matches!(name, "dot" | "cross" | "normalize")
}

/// Whether a call of `name` means something elsewhere, so that `name` is hardly that of a definition.
pub(super) fn is_elsewhere(name: &str) -> bool {
    name_elsewhere(name).is_some() || call_elsewhere(name).is_some() || is_of_vectors(name)
}

/// The error for a call that is written otherwise here: that of the name which is token `at`, before a bracket. None for the call of
/// another function.
pub(super) fn call_error(text: &str, tokens: &[Spanned], at: usize) -> Option<FormulaError> {
    let Spanned { token: Token::Name(name), span } = &tokens[at] else { return None };
    if is_of_vectors(name) {
        let message =
            format!("There is no `{name}` and no vector: write coordinates, as in `x*x + y*y + z*z`");
        return Some(FormulaError::new(ErrorKind::UnknownFunction, span.clone(), message));
    }
    let written = call_elsewhere(name)?;
    let example =
        PLACES.iter().fold(written.to_owned(), |done, &(place, letter)| done.replace(place, letter));
    let message = match written {
        "…" => format!("There is no `{name}` and no vector: write the coordinates one by one"),
        _ => format!("There is no function `{name}`: write `{}`", example.replace(ALL, "a, b, …")),
    };
    let (arguments, close) = arguments(text, tokens, at + 1)?;
    let wanted = PLACES.iter().filter(|(place, _)| written.contains(*place)).count();
    let whole = span.start..tokens[close].span.end;
    if arguments.is_empty() || wanted > 0 && arguments.len() != wanted {
        return Some(FormulaError::new(ErrorKind::UnknownFunction, span.clone(), message));
    }
    let filled = PLACES
        .iter()
        .zip(&arguments)
        .fold(written.to_owned(), |done, (&(place, _), argument)| done.replace(place, &as_operand(argument)));
    let filled = filled.replace(ALL, &arguments.join(", "));
    let before = at.checked_sub(1).map(|before| &tokens[before].token);
    let is_term = matches!(before, None | Some(Token::Plus | Token::Open(_) | Token::Comma | Token::Equals))
        && matches!(
            tokens[close + 1].token,
            Token::End | Token::Plus | Token::Minus | Token::Close(_) | Token::Comma | Token::Equals
        );
    let mended = if is_term || wanted == 0 { filled } else { format!("({filled})") };
    Some(FormulaError::new(ErrorKind::UnknownFunction, whole, message).suggest(mended))
}

/// The arguments in the bracket that token `open` opens, as they are written, and the token that closes it. None without a bracket;
/// no arguments where it is not closed.
fn arguments<'a>(text: &'a str, tokens: &[Spanned], open: usize) -> Option<(Vec<&'a str>, usize)> {
    let mut depth = 0_usize;
    let mut list = Vec::new();
    let mut start = tokens[open].span.end;
    for (k, Spanned { token, span }) in tokens.iter().enumerate().skip(open) {
        match token {
            Token::Open(_) => depth += 1,
            Token::Close(_) => depth = depth.saturating_sub(1),
            _ => {}
        }
        let is_last = depth == 0;
        if is_last || *token == Token::Comma && depth == 1 {
            list.push(slice(text, &(start..span.start)).trim());
            start = span.end;
        }
        if is_last {
            let is_closed = k > open;
            return is_closed
                .then(|| (if list.iter().all(|item| !item.is_empty()) { list } else { Vec::new() }, k));
        }
    }
    Some((Vec::new(), open))
}

/// `argument` in brackets, unless it is one word or number.
fn as_operand(argument: &str) -> String {
    let is_one = argument.chars().all(|c| c.is_alphanumeric() || c == '_' || c == '.');
    if is_one { argument.to_owned() } else { format!("({argument})") }
}

/// The error for a component of a vector, as in `p.x`: the point stands at `point..point + 1` after a name. None for anything else.
pub(super) fn component_error(text: &str, last: Option<&Spanned>, point: usize) -> Option<FormulaError> {
    let Spanned { token: Token::Name(name), span } = last? else { return None };
    let component: String = text.get(point + 1..)?.chars().take_while(|c| c.is_alphanumeric()).collect();
    let is_component = component.len() == 1 && matches!(component.as_str(), "x" | "y" | "z");
    if span.end != point || !is_component {
        return None;
    }
    let message = format!("There are no vectors: write `{component}` in place of `{name}.{component}`");
    let span = span.start..point + 1 + component.len();
    Some(FormulaError::new(ErrorKind::UnexpectedSymbol, span, message).suggest(component))
}
