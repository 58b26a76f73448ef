//! Words that were probably meant: misspelt ones, and several that are written as one.

use super::ast::{COORDINATES, Constant, FUNCTIONS, Function};
use super::elsewhere;
use super::error::{FormulaError, FormulaErrorKind as ErrorKind};
use super::operations::Unary;
use core::ops::Range;

/// Whether a word is a coordinate, a constant or a function.
pub(super) fn is_known(word: &str) -> bool {
    COORDINATES.contains(&word) || Constant::find(word).is_some() || elsewhere::function(word).is_some()
}

/// The error for an unknown name of a formula that is probably no parameter; none for one that is.
/// `meant` are the names that are declared or defined, `all` those in the formula.
pub(super) fn unlikely_parameter(
    text: &str,
    name: &str,
    span: &Range<usize>,
    meant: &[&str],
    all: &[&str],
) -> Option<FormulaError> {
    let error =
        |message: String| FormulaError::new(ErrorKind::UnknownName, span.clone(), message).unknown(name);
    if let Some(error) = elsewhere::logarithm(name, span.clone()) {
        return Some(error.unknown(name));
    }
    if is_imaginary(text, name, span) {
        let message =
            format!("Complex numbers are not read. If `{name}` is a parameter, add a slider `{name}`");
        return Some(error(message));
    }
    let mut readings = readings(name, all, false);
    if !readings.is_empty() {
        // An exponent may belong to the last operand: `sinx^2`.
        let exponent = exponent(&text[span.end.min(text.len())..]);
        let span = span.start..span.end + exponent.len();
        if let [only] = &readings[..]
            && !exponent.is_empty()
        {
            let inner = only.trim_end_matches(')');
            let within = format!("{inner}{exponent}{}", &only[inner.len()..]);
            readings = vec![format!("{only}{exponent}"), within];
            readings.dedup();
        }
        let ways: Vec<String> = readings.iter().take(2).map(|way| format!("`{way}`")).collect();
        let message =
            format!("`{name}` reads as one name: write {}. Or add a slider `{name}`", ways.join(" or "));
        let error = FormulaError { span, ..error(message) };
        return Some(match &readings[..] {
            [only] => error.suggest(only.clone()),
            several => error.choose(several.iter().cloned()),
        });
    }
    if let Some(meant) = match name {
        "sh" => Some("sinh"),
        "ch" => Some("cosh"),
        "th" => Some("tanh"),
        _ => None,
    } {
        let message = format!("Is `{name}` the function `{meant}`? Or add a slider `{name}`");
        return Some(error(message).suggest(meant));
    }
    if name.chars().count() == 1 && !COORDINATES.iter().any(|axis| axis.eq_ignore_ascii_case(name)) {
        return None;
    }
    // A name that differs by a digit or an index, such as `phi0` or `r_1`, differs on purpose.
    let indexed = name.ends_with(|c: char| c.is_ascii_digit()) || name.contains('_');
    let words = COORDINATES
        .into_iter()
        .chain(Constant::ALL.map(Constant::name))
        .chain(FUNCTIONS.iter().filter(|info| is_operation(info.function)).map(|info| info.name))
        .chain(meant.iter().copied());
    let meant = similar(name, words).filter(|meant| {
        let long = name.chars().count() >= 3 && meant.chars().count() >= 3;
        // `signal` continues after `sign` on purpose.
        meant.eq_ignore_ascii_case(name) || (long && !indexed && !name.starts_with(meant))
    })?;
    let message = format!("Unknown name `{name}`: did you mean `{meant}`? Or add a slider `{name}`");
    Some(error(message).suggest(meant))
}

/// Whether a name means the imaginary unit: `i`, in Mathematica `I`, in Python `2j`.
fn is_imaginary(text: &str, name: &str, span: &Range<usize>) -> bool {
    match name {
        "i" | "I" => true,
        "j" | "J" => text[..span.start.min(text.len())].ends_with(|c: char| c.is_ascii_digit() || c == '.'),
        _ => false,
    }
}

/// Says that a name is a parameter, in a formula without coordinates.
pub(super) fn no_coordinate(name: &str) -> String {
    format!("`{name}` is a parameter here, not a coordinate: a surface is a formula of x, y and z.")
}

/// The exponent with which a text begins, such as `^2`, `**2` or `²`; empty if it begins with none.
fn exponent(text: &str) -> &str {
    let sign = ["^", "**"].into_iter().find(|sign| text.starts_with(sign)).map_or(0, str::len);
    let is_digit = |c: char| if sign > 0 { c.is_ascii_digit() } else { !c.is_ascii() && c.is_numeric() };
    let digits = text[sign..].len() - text[sign..].trim_start_matches(is_digit).len();
    if digits > 0 { &text[..sign + digits] } else { "" }
}

/// Whether a lone word may be a misspelling of this function's name: others, such as `cot` and
/// `mix`, are too short and too rare.
fn is_operation(function: Function) -> bool {
    matches!(function, Function::Unary(operation) if operation != Unary::Erf)
}

/// A piece of a name.
#[derive(Clone, Debug, PartialEq)]
enum Piece<'a> {
    Function(&'a str),
    /// A coordinate, a constant, a number or another name.
    Factor(String),
}

/// The ways to read an unknown name as functions of coordinates and other factors, each once:
/// `xsinx` as `x*sin(x)`. If the name `is_called`, a bracket follows, and its last piece is a
/// function.
///
/// Its pieces are functions of one argument, coordinates, numbers, constants, and other names in
/// the formula; if these do not suffice, one letter that is a name nowhere else. So `radius_max`,
/// `signal` and `minx` are names like any other.
pub(super) fn readings(name: &str, names: &[&str], is_called: bool) -> Vec<String> {
    /// Longer names are not split: there are too many ways.
    const LONGEST: usize = 40;
    if name.contains('_') || name.len() > LONGEST {
        return Vec::new();
    }
    let mut found: Vec<String> = Vec::new();
    for strangers in 0..2 {
        let mut splits = Vec::new();
        split(name, names, strangers, &mut Vec::new(), &mut splits);
        for pieces in splits {
            let text = written(&pieces, is_called, strangers > 0);
            found.extend(text.filter(|text| !found.contains(text)));
        }
        if !found.is_empty() {
            break;
        }
    }
    found
}

/// Appends the ways to split a name after these pieces, with at most so many letters that are names
/// nowhere else.
fn split<'a>(
    name: &'a str,
    names: &[&str],
    strangers: usize,
    pieces: &mut Vec<Piece<'a>>,
    splits: &mut Vec<Vec<Piece<'a>>>,
) {
    /// Further ways are dropped.
    const MOST: usize = 4;
    if name.is_empty() {
        splits.push(pieces.clone());
    }
    // The name itself is no way to split it.
    let whole = if pieces.is_empty() { name.len() } else { usize::MAX };
    let mut go_on = |piece: Piece<'a>, length: usize, strangers: usize| {
        if splits.len() < MOST && name.is_char_boundary(length) {
            pieces.push(piece);
            split(&name[length..], names, strangers, pieces, splits);
            pieces.pop();
        }
    };
    // The longest function is the likeliest.
    let mut lengths: Vec<usize> = (2..=name.len().min(8)).filter(|&n| name.is_char_boundary(n)).collect();
    lengths.reverse();
    for length in lengths {
        let word = &name[..length];
        if word == "log" || elsewhere::function(word).is_some_and(|function| function.arity() == (1, 1)) {
            go_on(Piece::Function(word), length, strangers);
        } else if length < whole && names.contains(&word) || Constant::find(word).is_some() {
            go_on(Piece::Factor(word.into()), length, strangers);
        }
    }
    let Some(first) = name.chars().next() else { return };
    let letter = &name[..first.len_utf8()];
    let digits = name.len() - name.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    if digits > 0 {
        go_on(Piece::Factor(name[..digits].into()), digits, strangers);
    } else if COORDINATES.contains(&letter) {
        // `x2` means a square; `x0` and `x1` are names.
        let rest = &name[1..];
        let raised = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        let exponent = &rest[..raised];
        if exponent.is_empty() {
            go_on(Piece::Factor(letter.into()), 1, strangers);
        } else if exponent.parse::<u8>().is_ok_and(|exponent| exponent > 1) {
            go_on(Piece::Factor(format!("{letter}^{exponent}")), 1 + raised, strangers);
        }
    } else if names.contains(&letter) {
        go_on(Piece::Factor(letter.into()), letter.len(), strangers);
    } else if strangers > 0 {
        go_on(Piece::Factor(letter.into()), letter.len(), strangers - 1);
    }
}

/// The product that pieces stand for; none if they are the name alone, have neither functions nor
/// powers, or a function has no argument.
fn written(pieces: &[Piece<'_>], is_called: bool, has_stranger: bool) -> Option<String> {
    // `logo` is a word.
    if let [Piece::Function("log"), _] = pieces
        && has_stranger
    {
        return None;
    }
    if is_called && !matches!(pieces.last(), Some(Piece::Function(_))) {
        return None;
    }
    let has_function = pieces.iter().any(|piece| matches!(piece, Piece::Function(_)));
    let is_power = |piece: &Piece<'_>| matches!(piece, Piece::Factor(text) if text.contains('^'));
    if pieces.len() < 2 && !pieces.iter().any(is_power)
        || !has_function && (is_called || !pieces.iter().any(is_power))
    {
        return None;
    }
    let (mut factors, mut rest) = (Vec::new(), pieces);
    while let Some((piece, after)) = rest.split_first() {
        let Piece::Function(function) = piece else {
            let Piece::Factor(text) = piece else { return None };
            factors.push(text.clone());
            rest = after;
            continue;
        };
        if is_called && after.is_empty() {
            factors.push((*function).to_owned());
            break;
        }
        // Functions of functions, as in `sincosx`.
        let nested = after.iter().take_while(|piece| matches!(piece, Piece::Function(_))).count();
        let count = after[nested..].iter().take_while(|piece| matches!(piece, Piece::Factor(_))).count();
        let operand: Vec<&str> = after[nested..nested + count]
            .iter()
            .map(|piece| if let Piece::Factor(text) = piece { text.as_str() } else { "" })
            .collect();
        if operand.is_empty() {
            return None;
        }
        let mut text = format!("{function}(");
        for inner in &after[..nested] {
            let Piece::Function(inner) = inner else { return None };
            text.push_str(inner);
            text.push('(');
        }
        text.push_str(&operand.join("*"));
        text.push_str(&")".repeat(nested + 1));
        factors.push(text);
        rest = &after[nested + count..];
    }
    Some(factors.join("*"))
}

/// Word of `known` that `name` is probably a misspelling of: one that differs in case only, or by
/// one edit (two for a long name). Ties go to the word with the same first letter, then to the one
/// with the fewest letters that `name` has not: `siin` is rather `sin` than `sign`.
pub fn similar<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let length = name.chars().count();
    let allowed = if length > 5 { 2 } else { 1 };
    known
        .filter_map(|word| {
            let distance = if word.eq_ignore_ascii_case(name) { 0 } else { edit_distance(name, word) };
            let close = distance == 0 || (length >= 2 && word.len() >= 2 && distance <= allowed);
            // Misspellings rarely concern the first letter.
            let other_start = word.chars().next() != name.chars().next();
            let foreign = word.chars().filter(|&letter| !name.contains(letter)).count();
            (close && word != name).then_some((distance, other_start, foreign, word))
        })
        .min_by_key(|&(distance, other_start, foreign, _)| (distance, other_start, foreign))
        .map(|(.., word)| word)
}

/// Edit distance (optimal string alignment): insertions, deletions, substitutions and swaps of
/// adjacent characters. Lengths that differ by more than two give `usize::MAX`.
fn edit_distance(a: &str, b: &str) -> usize {
    let a: Vec<char> = a.chars().collect();
    let b: Vec<char> = b.chars().collect();
    if a.len().abs_diff(b.len()) > 2 {
        return usize::MAX;
    }
    let mut before: Vec<usize> = Vec::new();
    let mut previous: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i; b.len() + 1];
        for j in 1..=b.len() {
            let substituted = previous[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            row[j] = substituted.min(previous[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                row[j] = row[j].min(before[j - 2] + 1);
            }
        }
        before = core::mem::replace(&mut previous, row);
    }
    previous[b.len()]
}
