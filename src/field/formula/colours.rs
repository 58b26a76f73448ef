//! Colours that a formula gives to its surface: `colour = z` is a number at each particle, `c_rgb =
//! (x, y, 1)` are red, green and blue from 0 to 1.
//!
//! They are statements beside the surface, before or after it, and may use what is defined before
//! them and the quantities of a particle, as a [`Value`](super::Value) may. A name that the surface
//! uses is an ordinary definition.

use super::elsewhere::is_vector;
use super::error::{FormulaError, FormulaErrorKind as ErrorKind};
use super::heads::{head, word};
use super::token::{Spanned, Token, slice};
use core::ops::Range;

/// The columns that are the parts of a colour in sRGB, from 0 to 1.
pub(crate) const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// The column of a colour that is one number.
const COLOUR: &str = "colour";

/// Names of a colour with three parts or one, and of one that has three.
const NAMES: [&str; 3] = [COLOUR, "color", RGB];
const RGB: &str = "c_rgb";

/// A part of a colour, as it is written.
#[derive(Debug)]
pub(super) struct ColourText {
    /// Name of the column.
    pub(super) column: &'static str,
    /// Its expression, after the definitions that it needs, each at its place in the formula; the
    /// rest is blank.
    pub(super) text: String,
    /// The names of these definitions.
    needs: Vec<String>,
    /// Place of the expression in the formula.
    pub(super) span: Range<usize>,
}

impl ColourText {
    /// Whether the expression needs this definition.
    pub(super) fn needs(&self, name: &str) -> bool {
        self.needs.iter().any(|need| need == name)
    }
}

/// A statement: its tokens, without the `;` at its end.
type Statement = Range<usize>;

fn statements(tokens: &[Spanned]) -> Vec<Statement> {
    let (mut all, mut start, mut brackets) = (Vec::new(), 0, 0_i32);
    for (at, Spanned { token, .. }) in tokens.iter().enumerate() {
        match token {
            Token::Open(_) => brackets += 1,
            Token::Close(_) => brackets -= 1,
            Token::Separator if brackets > 0 => {}
            Token::Separator | Token::End => {
                all.push(start..at);
                start = at + 1;
            }
            _ => {}
        }
    }
    all.retain(|statement| !statement.is_empty());
    all
}

/// Whether a statement that begins at this token gives a colour, if nothing else uses its name.
pub(super) fn begins(tokens: &[Spanned], at: usize) -> bool {
    name_of(tokens, at).is_some_and(|name| NAMES.contains(&name))
}

/// The name that the statement at this token gives a value.
fn name_of(tokens: &[Spanned], at: usize) -> Option<&str> {
    head(tokens, at).filter(|head| head.arguments.is_empty()).and_then(|head| word(tokens, head.name))
}

fn words<'a>(tokens: &'a [Spanned], statement: &Statement) -> impl Iterator<Item = &'a str> {
    statement.clone().filter_map(|at| word(tokens, at))
}

/// The colours that a formula gives.
#[derive(Debug, Default)]
pub(super) struct Colours {
    pub(super) given: Vec<ColourText>,
    /// A colour has two parts or more than three, or is a second one.
    error: Option<FormulaError>,
}

impl Colours {
    /// # Errors
    ///
    /// `BadDefinition` for a colour with two parts or more than three, or for a second one.
    pub(super) fn checked(self) -> Result<Vec<ColourText>, FormulaError> {
        self.error.map_or(Ok(self.given), Err)
    }
}

/// Takes the statements that give colours out of the tokens of a formula.
pub(super) fn taken_out(text: &str, mut tokens: Vec<Spanned>) -> (Vec<Spanned>, Colours) {
    let (named, others): (Vec<Statement>, Vec<Statement>) =
        statements(&tokens).into_iter().partition(|statement| begins(&tokens, statement.start));
    let is_colour = |statement: &&Statement| {
        let name = name_of(&tokens, statement.start);
        !others.iter().any(|other| words(&tokens, other).any(|word| Some(word) == name))
    };
    let given: Vec<Statement> = named.iter().filter(is_colour).cloned().collect();
    // A name alone may be that of the function.
    let Some(surface) = others.last().filter(|_| !given.is_empty()) else {
        return (tokens, Colours::default());
    };
    let mut colours = Colours::default();
    for statement in &given {
        let before = others.iter().filter(|other| *other != surface && other.end <= statement.start);
        let definitions: Vec<&Statement> = before.collect();
        let parts = parts(text, &tokens, statement).unwrap_or_else(|error| {
            colours.error.get_or_insert(error);
            Vec::new()
        });
        for (column, part) in parts {
            if colours.given.iter().any(|own| own.column == column) {
                let span = tokens[statement.start].span.clone();
                let message = "A surface has one colour of its own: leave the others out";
                let error = FormulaError::new(ErrorKind::BadDefinition, span, message.to_owned());
                colours.error.get_or_insert(error);
            }
            colours.given.push(colour(text, &tokens, &definitions, (column, part)));
        }
    }
    let mut at = 0;
    tokens.retain(|spanned| {
        let is_kept = spanned.token == Token::End
            || given.iter().all(|statement| !(statement.start..=statement.end).contains(&at));
        at += 1;
        is_kept
    });
    (tokens, colours)
}

/// The columns that a statement gives, with the tokens of each.
fn parts(
    text: &str,
    tokens: &[Spanned],
    statement: &Statement,
) -> Result<Vec<(&'static str, Range<usize>)>, FormulaError> {
    let head = head(tokens, statement.start).map_or(statement.start, |head| head.body);
    let body = head..statement.end;
    let is_open = |at: usize| matches!(tokens[at].token, Token::Open(_));
    let is_maker = word(tokens, head).is_some_and(|name| is_vector(name) || name == "rgb");
    let open = if is_maker { head + 1 } else { head };
    let (mut commas, mut brackets, mut is_one) = (Vec::new(), 0_i32, open < body.end && is_open(open));
    for (at, spanned) in tokens.iter().enumerate().take(body.end).skip(open) {
        match spanned.token {
            Token::Open(_) => brackets += 1,
            Token::Close(_) => brackets -= 1,
            Token::Comma if brackets == 1 => commas.push(at),
            _ => {}
        }
        is_one &= brackets > 0 || at + 1 == body.end;
    }
    let has_three = is_one && commas.len() == 2;
    let is_rgb = word(tokens, statement.start) == Some(RGB);
    if has_three {
        let ends = [open, commas[0], commas[1], body.end - 1];
        return Ok((0..3).map(|k| (CHANNELS[k], ends[k] + 1..ends[k + 1])).collect());
    }
    if body.is_empty() || is_rgb || is_maker || is_one && !commas.is_empty() {
        let name = slice(text, &tokens[statement.start].span);
        let end = tokens[statement.end - 1].span.end;
        let span = tokens[statement.start].span.start..end;
        let message = format!(
            "A colour has three parts, red, green and blue from 0 to 1: `{name} = (0.5 + 0.5 n_z, 0.5, 0.2)`"
        );
        return Err(FormulaError::new(ErrorKind::BadDefinition, span, message));
    }
    Ok(vec![(COLOUR, body)])
}

/// The part of a colour in these tokens, with the definitions that it needs.
fn colour(
    text: &str,
    tokens: &[Spanned],
    definitions: &[&Statement],
    (column, part): (&'static str, Range<usize>),
) -> ColourText {
    let place = |range: &Range<usize>| match range.is_empty() {
        true => tokens[range.start].span.start..tokens[range.start].span.start,
        false => tokens[range.start].span.start..tokens[range.end - 1].span.end,
    };
    let span = place(&part);
    let mut bytes = vec![b' '; span.end];
    bytes[span.clone()].copy_from_slice(&text.as_bytes()[span.clone()]);
    let mut used: Vec<&str> = words(tokens, &part).collect();
    let mut needs = Vec::new();
    for definition in definitions.iter().rev() {
        let Some(name) = head(tokens, definition.start).and_then(|head| word(tokens, head.name)) else {
            continue;
        };
        if used.contains(&name) {
            needs.push(name.to_owned());
            used.extend(words(tokens, definition));
            let own = place(definition);
            bytes[own.clone()].copy_from_slice(&text.as_bytes()[own.clone()]);
            // A `;`, or the end of a line, follows a definition.
            bytes[own.end] = b';';
        }
    }
    let text = String::from_utf8(bytes).expect("whole tokens, spaces and `;`");
    ColourText { column, text, needs, span }
}
