//! Recursive-descent parser: tokens to a syntax tree.
//!
//! ```text
//! equation := sum [ "=" sum ]
//! sum      := term { ("+" | "-") term }
//! term     := ("-" | "+") term | product
//! product  := power { "*" signed | "/" signed | power }      juxtaposition: names and brackets only
//! signed   := ("-" | "+") signed | power
//! power    := atom [ superscript | "^" signed ]               "^" binds to the right
//! atom     := number | name | function "(" sum { "," sum } ")" | "(" sum ")"
//! ```

use super::ast::{COORDINATES, Constant, Equation, Expr, Factor, Function, Kind, Sign};
use super::error::{FormulaError, FormulaErrorKind as ErrorKind};
use super::lex::{Spanned, Token, slice, tokens};
use super::{MAX_DEPTH, MAX_FORMULA_BYTES};
use core::ops::Range;

/// A parsed formula and the names in it that are neither coordinates, constants nor functions.
pub(super) struct Parsed {
    pub(super) equation: Equation,
    /// Each name once, in order of appearance, with the span of its first occurrence.
    pub(super) names: Vec<(String, Range<usize>)>,
}

/// Parses `text`. `declared` are the names of the declared parameters.
///
/// # Errors
///
/// The first error from left to right, with the text it concerns and, where there is a good guess, a correction.
pub(super) fn parse(text: &str, declared: &[&str]) -> Result<Parsed, FormulaError> {
    if text.len() > MAX_FORMULA_BYTES {
        let message = format!("A formula has at most {MAX_FORMULA_BYTES} bytes; this one has {}", text.len());
        let end = (0..=MAX_FORMULA_BYTES).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0);
        return Err(FormulaError::new(ErrorKind::TooLong, end..text.len(), message));
    }
    let tokens = tokens(text, declared)?;
    if tokens.len() == 1 {
        let message = "Type a formula of x, y and z, for example `x^2 + y^2 + z^2 = 1`";
        return Err(FormulaError::new(ErrorKind::Empty, 0..0, message));
    }
    let mut parser = Parser { text, tokens, next: 0, depth: 0, declared, names: Vec::new() };
    let left = parser.sum()?;
    let right = if parser.take(&Token::Equals) { Some(parser.sum()?) } else { None };
    let rest = parser.peek().clone();
    match rest.token {
        Token::End => Ok(Parsed { equation: Equation { left, right }, names: parser.names }),
        Token::Equals => {
            let message = "A formula has one `=` at most";
            Err(FormulaError::new(ErrorKind::TooManyEquations, rest.span, message))
        }
        _ => Err(parser.unexpected()),
    }
}

struct Parser<'a> {
    text: &'a str,
    tokens: Vec<Spanned>,
    next: usize,
    depth: usize,
    declared: &'a [&'a str],
    names: Vec<(String, Range<usize>)>,
}

type Parse = Result<Expr, FormulaError>;

impl Parser<'_> {
    fn peek(&self) -> &Spanned {
        // The last token, `End`, is never consumed.
        &self.tokens[self.next.min(self.tokens.len() - 1)]
    }

    /// Consumes the next token if it is `token`.
    fn take(&mut self, token: &Token) -> bool {
        let found = self.peek().token == *token && *token != Token::End;
        self.next += usize::from(found);
        found
    }

    /// Applies `parse` one nesting level deeper; an error at the next token beyond [`MAX_DEPTH`].
    fn deeper(&mut self, parse: impl FnOnce(&mut Self) -> Parse) -> Parse {
        if self.depth == MAX_DEPTH {
            let message = format!("Nested more than {MAX_DEPTH} levels deep");
            return Err(FormulaError::new(ErrorKind::TooDeep, self.peek().span.clone(), message));
        }
        self.depth += 1;
        let result = parse(self);
        self.depth -= 1;
        result
    }

    /// Error for the next token, which is not allowed here.
    fn unexpected(&self) -> FormulaError {
        let Spanned { token, span } = self.peek();
        if *token == Token::End {
            return FormulaError::new(
                ErrorKind::UnexpectedEnd,
                span.clone(),
                "Something is missing at the end",
            );
        }
        let written = slice(self.text, span);
        let previous = self.next.checked_sub(1).map(|index| &self.tokens[index].token);
        let after_operand = matches!(
            previous,
            Some(Token::Number(_) | Token::Name(_) | Token::Close | Token::Superscript(_))
        );
        let message = match token {
            Token::Close if after_operand => "This `)` closes nothing".to_owned(),
            Token::Close => "Something is missing before this `)`".to_owned(),
            Token::Number(_) if after_operand => {
                format!(
                    "An operator is missing before `{written}`; a number goes in front of what it multiplies"
                )
            }
            Token::Comma => "A comma separates the arguments of a function and cannot stand here".to_owned(),
            _ => format!("`{written}` cannot stand here"),
        };
        FormulaError::new(ErrorKind::UnexpectedSymbol, span.clone(), message)
    }

    fn sum(&mut self) -> Parse {
        let first = self.term()?;
        let mut terms = vec![(Sign::Plus, first)];
        loop {
            let sign = if self.take(&Token::Plus) {
                Sign::Plus
            } else if self.take(&Token::Minus) {
                Sign::Minus
            } else {
                break;
            };
            terms.push((sign, self.term()?));
        }
        Ok(flatten(terms, Kind::Sum))
    }

    fn term(&mut self) -> Parse {
        self.signed(Self::term, Self::product)
    }

    fn signed_power(&mut self) -> Parse {
        self.signed(Self::signed_power, Self::power)
    }

    /// Parses a sign followed by `again`, or `plain` if there is no sign.
    fn signed(&mut self, again: fn(&mut Self) -> Parse, plain: fn(&mut Self) -> Parse) -> Parse {
        let start = self.peek().span.start;
        if self.take(&Token::Minus) {
            let inner = self.deeper(again)?;
            let span = start..inner.span.end;
            Ok(Expr { kind: Kind::Negated(Box::new(inner)), span })
        } else if self.take(&Token::Plus) {
            self.deeper(again)
        } else {
            plain(self)
        }
    }

    fn product(&mut self) -> Parse {
        let first = self.power()?;
        let mut factors = vec![(Factor::Times, first)];
        loop {
            if self.take(&Token::Star) {
                factors.push((Factor::Times, self.signed_power()?));
            } else if self.take(&Token::Slash) {
                factors.push((Factor::Over, self.signed_power()?));
            } else if matches!(self.peek().token, Token::Name(_) | Token::Open) {
                let after_division = matches!(factors.last(), Some((Factor::Over, _)));
                let divisor = factors.last().map_or(0..0, |(_, factor)| factor.span.clone());
                let factor = self.power()?;
                if after_division {
                    let span = divisor.start..factor.span.end;
                    let (below, beside) = (slice(self.text, &divisor), slice(self.text, &factor.span));
                    let message =
                        format!("What is divided by? Write `/({below} {beside})` or `/{below}*{beside}`");
                    return Err(FormulaError::new(ErrorKind::Ambiguous, span, message)
                        .suggest(format!("({below} {beside})")));
                }
                factors.push((Factor::Times, factor));
            } else {
                break;
            }
        }
        Ok(flatten(factors, Kind::Product))
    }

    fn power(&mut self) -> Parse {
        let base = self.atom()?;
        let exponent = match self.peek().token {
            Token::Superscript(value) => {
                let span = self.peek().span.clone();
                self.next += 1;
                if matches!(self.peek().token, Token::Caret | Token::Superscript(_)) {
                    let span = base.span.start..self.peek().span.end;
                    let message = "Two exponents in a row: put brackets around the inner power";
                    return Err(FormulaError::new(ErrorKind::Ambiguous, span, message));
                }
                integer(value, span)
            }
            Token::Caret => {
                self.next += 1;
                self.deeper(Self::signed_power)?
            }
            _ => return Ok(base),
        };
        let span = base.span.start..exponent.span.end;
        Ok(Expr { kind: Kind::Power(Box::new(base), Box::new(exponent)), span })
    }

    fn atom(&mut self) -> Parse {
        let Spanned { token, span } = self.peek().clone();
        match token {
            Token::Number(value) => {
                self.next += 1;
                Ok(Expr { kind: Kind::Number(value), span })
            }
            Token::Name(name) => {
                self.next += 1;
                self.name(name, span)
            }
            Token::Open => {
                self.next += 1;
                let inner = self.deeper(Self::sum)?;
                let end = self.close(&span)?;
                Ok(Expr { span: span.start..end, ..inner })
            }
            _ => Err(self.unexpected()),
        }
    }

    /// Consumes the `)` that closes the `(` at `open` and returns its end.
    fn close(&mut self, open: &Range<usize>) -> Result<usize, FormulaError> {
        let end = self.peek().span.end;
        if self.take(&Token::Close) {
            return Ok(end);
        }
        if self.peek().token == Token::End {
            let message = format!("The bracket opened at character {} is not closed", {
                slice(self.text, &(0..open.start)).chars().count() + 1
            });
            return Err(FormulaError::new(ErrorKind::UnexpectedEnd, end..end, message).suggest(")"));
        }
        Err(self.unexpected())
    }

    /// Parses what begins with `name`, which has just been consumed.
    fn name(&mut self, name: String, span: Range<usize>) -> Parse {
        if let Some(axis) = COORDINATES.iter().position(|&coordinate| coordinate == name) {
            let axis = u8::try_from(axis).unwrap_or(0);
            return Ok(Expr { kind: Kind::Coordinate(axis), span });
        }
        if let Some(constant) = Constant::find(&name) {
            return Ok(Expr { kind: Kind::Constant(constant), span });
        }
        if let Some(function) = Function::find(&name) {
            return self.call(function, span);
        }
        if self.peek().token == Token::Open && !self.declared.contains(&name.as_str()) {
            let guess = self.similar(&name);
            if name == "pow" {
                let message = "A power is written `a^b`";
                return Err(FormulaError::new(ErrorKind::UnknownFunction, span, message));
            }
            let message = match guess {
                Some(guess) => format!("There is no function `{name}`: did you mean `{guess}`?"),
                None => format!("There is no function `{name}`; to multiply, write `{name}*(`"),
            };
            let error = FormulaError::new(ErrorKind::UnknownFunction, span, message);
            return Err(error.suggest(guess.map_or_else(|| format!("{name}*"), str::to_owned)));
        }
        if !self.names.iter().any(|(known, _)| *known == name) {
            self.names.push((name.clone(), span.clone()));
        }
        Ok(Expr { kind: Kind::Parameter(name), span })
    }

    /// Parses the exponent and the arguments of `function`, whose name has just been consumed at `span`.
    fn call(&mut self, function: Function, span: Range<usize>) -> Parse {
        let name = function.name();
        // In `sin^2(x)` and `sin²(x)` the power applies to the value.
        let mut exponent = None;
        if let Token::Superscript(value) = self.peek().token {
            exponent = Some(integer(value, self.peek().span.clone()));
            self.next += 1;
        } else if self.peek().token == Token::Caret {
            self.next += 1;
            let negative = self.take(&Token::Minus);
            let Spanned { token, span: raised } = self.peek().clone();
            let Token::Number(value) = token else {
                let message = format!("Write the power of a value as `{name}(…)^n`");
                return Err(FormulaError::new(ErrorKind::Ambiguous, span.start..raised.end, message));
            };
            self.next += 1;
            let value = if negative { -value } else { value };
            exponent = Some(Expr { kind: Kind::Number(value), span: raised });
        }
        let negative = |kind: &Kind| match kind {
            Kind::Number(value) => *value < 0.0,
            _ => true,
        };
        if let Some(Expr { kind, span: raised }) = &exponent
            && negative(kind)
        {
            let message = format!(
                "A negative power of `{name}` has two readings: write `1/{name}(…)`, or name the inverse"
            );
            return Err(FormulaError::new(ErrorKind::Ambiguous, span.start..raised.end, message));
        }
        if self.peek().token != Token::Open {
            return Err(self.missing_brackets(name, span));
        }
        let open = self.peek().span.clone();
        self.next += 1;
        let mut arguments = Vec::new();
        if self.peek().token != Token::Close {
            arguments.push(self.deeper(Self::sum)?);
            while self.take(&Token::Comma) {
                arguments.push(self.deeper(Self::sum)?);
            }
        }
        let whole = span.start..self.close(&open)?;
        let (least, most) = function.arity();
        if !(least..=most).contains(&arguments.len()) {
            let wanted = match (least, most) {
                (1, 1) => "one argument".to_owned(),
                (least, most) if least == most => format!("{least} arguments"),
                (least, most) => format!("{least} to {most} arguments"),
            };
            let message =
                format!("`{}` takes {wanted}, and here it has {}", function.signature(), arguments.len());
            return Err(FormulaError::new(ErrorKind::WrongArity, whole, message));
        }
        let call = Expr { kind: Kind::Call(function, arguments), span: whole.clone() };
        Ok(match exponent {
            Some(exponent) => Expr { kind: Kind::Power(Box::new(call), Box::new(exponent)), span: whole },
            None => call,
        })
    }

    /// Error for the function `name` without brackets, with the brackets suggested around its operand.
    fn missing_brackets(&mut self, name: &str, span: Range<usize>) -> FormulaError {
        let message = format!("`{name}` needs brackets around what it is applied to");
        let error = FormulaError::new(ErrorKind::MissingBrackets, span.clone(), message);
        let starts_operand = matches!(self.peek().token, Token::Name(_) | Token::Number(_));
        // The brackets should hold the operand that follows and any name written directly after it, as in `sin 2x`.
        match if starts_operand { self.deeper(Self::power) } else { Err(error.clone()) } {
            Ok(operand) => {
                let mut inside = operand.span;
                while matches!(self.peek().token, Token::Name(_)) && self.peek().span.start == inside.end {
                    match self.deeper(Self::power) {
                        Ok(factor) => inside.end = factor.span.end,
                        Err(_) => break,
                    }
                }
                let inner = slice(self.text, &inside);
                FormulaError { span: span.start..inside.end, ..error }.suggest(format!("{name}({inner})"))
            }
            Err(_) => error.suggest(format!("{name}(…)")),
        }
    }

    /// Function that was probably meant by `name`.
    fn similar(&self, name: &str) -> Option<&'static str> {
        name_elsewhere(name).or_else(|| similar(name, Function::ALL.iter().map(|function| function.name())))
    }
}

/// Tree of an integer; a negative one is a negated number.
fn integer(value: i32, span: Range<usize>) -> Expr {
    let magnitude = Expr { kind: Kind::Number(f64::from(value).abs()), span: span.clone() };
    if value < 0 { Expr { kind: Kind::Negated(Box::new(magnitude)), span } } else { magnitude }
}

/// The only item, or a `list` node of several.
fn flatten<T>(mut items: Vec<(T, Expr)>, list: fn(Vec<(T, Expr)>) -> Kind) -> Expr {
    if items.len() == 1
        && let Some((_, only)) = items.pop()
    {
        return only;
    }
    let start = items.first().map_or(0, |(_, item)| item.span.start);
    let end = items.last().map_or(0, |(_, item)| item.span.end);
    Expr { kind: list(items), span: start..end }
}

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

/// Word of `known` that `name` is probably a misspelling of: one that differs in case only, or by one edit (two for a
/// long name). Ties go to the word with the same first letter.
pub(super) fn similar<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let length = name.chars().count();
    let allowed = if length > 5 { 2 } else { 1 };
    known
        .filter_map(|word| {
            let distance = if word.eq_ignore_ascii_case(name) { 0 } else { edit_distance(name, word) };
            let close = distance == 0 || (length >= 2 && word.len() >= 2 && distance <= allowed);
            // Misspellings rarely concern the first letter.
            let other_start = word.chars().next() != name.chars().next();
            (close && word != name).then_some((distance, other_start, word))
        })
        .min_by_key(|&(distance, other_start, _)| (distance, other_start))
        .map(|(_, _, word)| word)
}

/// Edit distance (optimal string alignment): insertions, deletions, substitutions and swaps of adjacent characters.
/// Lengths that differ by more than two give `usize::MAX`.
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
