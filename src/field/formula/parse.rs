//! Recursive-descent parser: tokens to a syntax tree.
//!
//! ```text
//! equation := [ name "(" "x" "," "y" "," "z" ")" "=" ] sum [ "=" sum ]
//! sum      := term { ("+" | "-") term }
//! term     := ("-" | "+") term | product
//! product  := power { "*" signed | "/" signed | power }      juxtaposition: no number but the first
//! signed   := ("-" | "+") signed | power
//! power    := atom [ superscript | "^" signed ]               "^" binds to the right
//! atom     := number | name | "(" sum ")" | "|" sum "|" | "\frac" group group | "\sqrt" [ "[" sum "]" ] group
//!           | function [ exponent ] ( "(" sum { "," sum } ")" | operand )
//! ```
//!
//! An opening bracket of any kind, `(`, `[` or `{`, is closed by its own. [`call`](super::call) says what a function without
//! brackets is applied to.

use super::ast::{COORDINATES, Constant, Equation, Expr, ExprKind, FUNCTIONS, Factor, Function, Sign};
use super::elsewhere::{call_error, is_elsewhere, name_elsewhere};
use super::error::{FormulaError, FormulaErrorKind as ErrorKind};
use super::lex::tokens;
use super::operations::Unary;
use super::token::{Bar, Spanned, Token, closing, slice};
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
    let mut parser =
        Parser { text, tokens, next: 0, depth: 0, is_in_bars: false, declared, names: Vec::new() };
    parser.head()?;
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

pub(super) struct Parser<'a> {
    pub(super) text: &'a str,
    pub(super) tokens: Vec<Spanned>,
    /// Index of the next token.
    pub(super) next: usize,
    depth: usize,
    /// Whether the innermost bracket around the next token is a bar, which a bar after an operand closes.
    is_in_bars: bool,
    declared: &'a [&'a str],
    names: Vec<(String, Range<usize>)>,
}

pub(super) type Parse = Result<Expr, FormulaError>;

/// The arguments of a function.
pub(super) struct CallArguments {
    pub(super) arguments: Vec<Expr>,
    /// Number of the commas between them that may be decimal ones, and the token of the first.
    pub(super) doubtful: usize,
    pub(super) first_doubtful: usize,
}

impl Parser<'_> {
    /// Skips the head of a definition `f(x, y, z) = …`, whose body is the formula.
    fn head(&mut self) -> Result<(), FormulaError> {
        let [Spanned { token: Token::Name(name), span }, Spanned { token: Token::Open('('), .. }, rest @ ..] =
            &self.tokens[..]
        else {
            return Ok(());
        };
        let mut left_out: Vec<&str> = COORDINATES.to_vec();
        let mut end = None;
        for (k, pair) in rest.chunks_exact(2).enumerate() {
            let [Spanned { token: Token::Name(axis), .. }, after] = pair else { return Ok(()) };
            let Some(place) = left_out.iter().position(|left| left == axis) else { return Ok(()) };
            left_out.remove(place);
            match after.token {
                Token::Comma => {}
                Token::Close(')') => {
                    end = Some(2 + 2 * (k + 1));
                    break;
                }
                _ => return Ok(()),
            }
        }
        let Some(end) = end.filter(|&end| self.tokens[end].token == Token::Equals) else { return Ok(()) };
        if Function::find(name).is_some() || COORDINATES.contains(&name.as_str()) || is_elsewhere(name) {
            return Ok(());
        }
        let whole = span.start..self.tokens[end].span.end;
        match left_out[..] {
            [] => {
                self.next = end + 1;
                Ok(())
            }
            [height] => {
                let message = format!(
                    "A function of two coordinates is no surface by itself: its graph is `{height} = …`"
                );
                Err(FormulaError::new(ErrorKind::Ambiguous, whole, message).suggest(format!("{height} =")))
            }
            _ => {
                let message = format!("Write `{name}(x, y, z) = …`, or an equation of x, y and z");
                Err(FormulaError::new(ErrorKind::Ambiguous, whole, message))
            }
        }
    }

    pub(super) fn peek(&self) -> &Spanned {
        // The last token, `End`, is never consumed.
        &self.tokens[self.next.min(self.tokens.len() - 1)]
    }

    /// The token after the next one.
    pub(super) fn second(&self) -> &Spanned {
        &self.tokens[(self.next + 1).min(self.tokens.len() - 1)]
    }

    /// Consumes the next token if it is `token`.
    pub(super) fn take(&mut self, token: &Token) -> bool {
        let found = self.peek().token == *token && *token != Token::End;
        self.next += usize::from(found);
        found
    }

    /// Applies `parse` one nesting level deeper; an error at the next token beyond [`MAX_DEPTH`].
    pub(super) fn deeper(&mut self, parse: impl FnOnce(&mut Self) -> Parse) -> Parse {
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
    pub(super) fn unexpected(&self) -> FormulaError {
        if let Some(error) = self.decimal_comma(self.next) {
            return error;
        }
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
            Some(Token::Number(_) | Token::Name(_) | Token::Close(_) | Token::Superscript(_))
        );
        let message = match token {
            Token::Close(_) if after_operand => format!("This `{written}` closes nothing"),
            Token::Close(_) => format!("Something is missing before this `{written}`"),
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

    /// The numbers on both sides of the comma that is token `at`, if it may be a decimal one: they have no point, and there is no space.
    fn numbers_beside(&self, at: usize) -> Option<[&Range<usize>; 2]> {
        let [
            Spanned { token: Token::Number(_), span: whole },
            Spanned { token: Token::Comma, span: comma },
            Spanned { token: Token::Number(_), span: rest },
        ] = self.tokens.get(at.checked_sub(1)?..at + 2)?
        else {
            return None;
        };
        let is_tight = whole.end == comma.start && comma.end == rest.start;
        let is_whole = slice(self.text, whole).chars().all(char::is_numeric);
        (is_tight && is_whole && !slice(self.text, rest).contains('.')).then_some([whole, rest])
    }

    /// Error for the comma that is token `at`, if it may be a decimal one.
    pub(super) fn decimal_comma(&self, at: usize) -> Option<FormulaError> {
        let span = self.numbers_beside(at).map(|[whole, rest]| whole.start..rest.end)?;
        let written = slice(self.text, &span);
        let message = format!(
            "`{written}`: decimals take a point; to separate two arguments put a space after the comma"
        );
        let suggestion = written.replace(',', ".");
        Some(FormulaError::new(ErrorKind::DecimalComma, span, message).suggest(suggestion))
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
        Ok(flatten(terms, ExprKind::Sum))
    }

    fn term(&mut self) -> Parse {
        self.signed(Self::term, Self::product)
    }

    pub(super) fn signed_power(&mut self) -> Parse {
        self.signed(Self::signed_power, Self::power)
    }

    /// Parses a sign followed by `again`, or `plain` if there is no sign.
    fn signed(&mut self, again: fn(&mut Self) -> Parse, plain: fn(&mut Self) -> Parse) -> Parse {
        let start = self.peek().span.start;
        if self.take(&Token::Minus) {
            let inner = self.deeper(again)?;
            let span = start..inner.span.end;
            Ok(Expr { kind: ExprKind::Negated(Box::new(inner)), span })
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
            } else if self.begins_factor() {
                self.check_bars(&factors)?;
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
        Ok(flatten(factors, ExprKind::Product))
    }

    /// Whether the next token begins a factor that stands beside the one before it.
    pub(super) fn begins_factor(&self) -> bool {
        match self.peek().token {
            Token::Name(_) | Token::Open(_) | Token::Fraction | Token::Root | Token::Bar(Bar::Opening) => {
                true
            }
            Token::Bar(Bar::Either) => !self.is_in_bars,
            _ => false,
        }
    }

    /// In `|x|y|z|` the second bar may close or open: an error at the third one, where the factors lead to it.
    fn check_bars(&self, factors: &[(Factor, Expr)]) -> Result<(), FormulaError> {
        let Spanned { token, span } = self.peek();
        let is_barred = |(_, factor): &(Factor, Expr)| slice(self.text, &factor.span).ends_with('|');
        if *token != Token::Bar(Bar::Either)
            || factors.last().is_none_or(is_barred)
            || !factors.iter().any(is_barred)
        {
            return Ok(());
        }
        let message = "These bars have two readings: write `*` before the one that opens";
        Err(FormulaError::new(ErrorKind::Ambiguous, span.clone(), message)
            .suggest(format!("*{}", slice(self.text, span))))
    }

    pub(super) fn power(&mut self) -> Parse {
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
        Ok(Expr { kind: ExprKind::Power(Box::new(base), Box::new(exponent)), span })
    }

    fn atom(&mut self) -> Parse {
        let Spanned { token, span } = self.peek().clone();
        match token {
            Token::Number(value) => {
                self.next += 1;
                Ok(Expr { kind: ExprKind::Number(value), span })
            }
            Token::Name(name) => {
                self.next += 1;
                self.name(name, span)
            }
            Token::Open(_) => {
                let (inner, span) = self.bracketed(|parser| parser.within(false, Self::sum))?;
                Ok(Expr { span, ..inner })
            }
            Token::Bar(Bar::Either | Bar::Opening) => {
                self.next += 1;
                let inner = self.within(true, Self::sum)?;
                let end = self.peek().span.end;
                if !(self.take(&Token::Bar(Bar::Either)) || self.take(&Token::Bar(Bar::Closing))) {
                    return Err(self.unclosed(&span, '|'));
                }
                Ok(Expr {
                    kind: ExprKind::Call(Function::Unary(Unary::Abs), vec![inner]),
                    span: span.start..end,
                })
            }
            Token::Fraction => {
                self.next += 1;
                let (above, below) = (self.group()?, self.group()?);
                let span = span.start..below.span.end;
                Ok(Expr {
                    kind: ExprKind::Product(vec![(Factor::Times, above), (Factor::Over, below)]),
                    span,
                })
            }
            Token::Root => {
                self.next += 1;
                let degree = match self.peek().token {
                    Token::Open('[') => Some(self.atom()?),
                    _ => None,
                };
                let inner = self.group()?;
                let span = span.start..inner.span.end;
                Ok(Expr { kind: root(degree, inner), span })
            }
            _ => Err(self.unexpected()),
        }
    }

    /// Parses what a command of LaTeX is applied to: something in braces, or one character.
    fn group(&mut self) -> Parse {
        let Spanned { token, span } = self.peek().clone();
        match token {
            Token::Open('{') => self.atom(),
            Token::Number(_) | Token::Name(_) if span.len() == 1 => self.atom(),
            _ => {
                let message = "Braces hold what a command is applied to, as in `\\frac{1}{2}`";
                Err(FormulaError::new(ErrorKind::UnexpectedSymbol, span, message))
            }
        }
    }

    /// Applies `parse` one nesting level deeper, within bars or within brackets.
    fn within(&mut self, bars: bool, parse: impl FnOnce(&mut Self) -> Parse) -> Parse {
        let outside = core::mem::replace(&mut self.is_in_bars, bars);
        let result = self.deeper(parse);
        self.is_in_bars = outside;
        result
    }

    /// Parses a bracket, which is the next token, with what `inside` parses; returns the span of it all too.
    fn bracketed<T>(
        &mut self,
        inside: impl FnOnce(&mut Self) -> Result<T, FormulaError>,
    ) -> Result<(T, Range<usize>), FormulaError> {
        let Spanned { token, span } = self.peek().clone();
        let Token::Open(open) = token else { return Err(self.unexpected()) };
        self.next += 1;
        let content = inside(self)?;
        let end = self.close(open, &span)?;
        Ok((content, span.start..end))
    }

    /// Parses the arguments of a function with the brackets around them; returns their span, too.
    pub(super) fn arguments(&mut self) -> Result<(CallArguments, Range<usize>), FormulaError> {
        self.bracketed(|parser| {
            let (mut arguments, mut doubtful, mut first_doubtful) = (Vec::new(), 0, 0);
            if !matches!(parser.peek().token, Token::Close(_)) {
                arguments.push(parser.within(false, Self::sum)?);
                while parser.take(&Token::Comma) {
                    let comma = parser.next - 1;
                    if parser.numbers_beside(comma).is_some() {
                        first_doubtful = if doubtful == 0 { comma } else { first_doubtful };
                        doubtful += 1;
                    }
                    arguments.push(parser.within(false, Self::sum)?);
                }
            }
            Ok(CallArguments { arguments, doubtful, first_doubtful })
        })
    }

    /// Consumes the bracket that closes the one at `span` and returns its end.
    fn close(&mut self, open: char, span: &Range<usize>) -> Result<usize, FormulaError> {
        let Spanned { token, span: found } = self.peek().clone();
        if self.take(&Token::Close(closing(open))) {
            return Ok(found.end);
        }
        if let Token::Close(_) = token {
            let message = format!("`{}` cannot close a `{open}`", slice(self.text, &found));
            return Err(FormulaError::new(ErrorKind::UnexpectedSymbol, found, message).suggest(closing(open)));
        }
        Err(self.unclosed(span, closing(open)))
    }

    /// Error where the bracket at `open` should be closed by `closing`.
    fn unclosed(&self, open: &Range<usize>, closing: char) -> FormulaError {
        let place = slice(self.text, &(0..open.start)).chars().count() + 1;
        let message = format!("The bracket opened at character {place} is not closed");
        match self.peek().token {
            Token::End => {
                let end = self.text.len();
                FormulaError::new(ErrorKind::UnexpectedEnd, end..end, message).suggest(closing)
            }
            Token::Equals => {
                let before = self.next.checked_sub(1).map_or(0, |last| self.tokens[last].span.end);
                // Editors close a bracket as soon as it is opened: that one stands too far to the right.
                let late = self.tokens[self.next..].iter().find(|later| later.token == Token::Close(closing));
                let (span, inside) = match late {
                    Some(late) => (before..late.span.end, slice(self.text, &(before..late.span.start))),
                    None => (before..before, ""),
                };
                let message = format!("{message} before `=`");
                FormulaError::new(ErrorKind::UnexpectedSymbol, span, message)
                    .suggest(format!("{closing}{inside}"))
            }
            _ => self.unexpected(),
        }
    }

    /// Parses what begins with `name`, which has just been consumed.
    fn name(&mut self, name: String, span: Range<usize>) -> Parse {
        if let Some(axis) = COORDINATES.iter().position(|&coordinate| coordinate == name) {
            let axis = u8::try_from(axis).unwrap_or(0);
            return Ok(Expr { kind: ExprKind::Coordinate(axis), span });
        }
        if let Some(constant) = Constant::find(&name) {
            return Ok(Expr { kind: ExprKind::Constant(constant), span });
        }
        if let Some(function) = Function::find(&name) {
            return self.call(function, span);
        }
        if self.peek().token == Token::Open('(') && !self.declared.contains(&name.as_str()) {
            if let Some(error) = call_error(self.text, &self.tokens, self.next - 1) {
                return Err(error);
            }
            let guess = self.similar(&name);
            let has_arguments = self.has_comma();
            let message = match guess {
                Some(guess) => format!("There is no function `{name}`: did you mean `{guess}`?"),
                None if has_arguments => {
                    format!("There is no function `{name}`: write its formula in its place")
                }
                None => format!("There is no function `{name}`; to multiply, write `{name}*(`"),
            };
            let error = FormulaError::new(ErrorKind::UnknownFunction, span, message);
            return Err(match guess {
                Some(guess) => error.suggest(guess),
                None if has_arguments => error,
                None => error.suggest(format!("{name}*")),
            });
        }
        if !self.names.iter().any(|(known, _)| *known == name) {
            self.names.push((name.clone(), span.clone()));
        }
        Ok(Expr { kind: ExprKind::Parameter(name), span })
    }

    /// Function that was probably meant by `name`.
    fn similar(&self, name: &str) -> Option<&'static str> {
        name_elsewhere(name).or_else(|| similar(name, FUNCTIONS.iter().map(|function| function.name)))
    }
}

/// Tree of an integer; a negative one is a negated number.
pub(super) fn integer(value: i32, span: Range<usize>) -> Expr {
    let magnitude = Expr { kind: ExprKind::Number(f64::from(value).abs()), span: span.clone() };
    if value < 0 { Expr { kind: ExprKind::Negated(Box::new(magnitude)), span } } else { magnitude }
}

/// The root of the given degree, or the square root.
fn root(degree: Option<Expr>, inner: Expr) -> ExprKind {
    match degree {
        None => ExprKind::Call(Function::Unary(Unary::Sqrt), vec![inner]),
        Some(Expr { kind: ExprKind::Number(2.0), .. }) => {
            ExprKind::Call(Function::Unary(Unary::Sqrt), vec![inner])
        }
        Some(Expr { kind: ExprKind::Number(3.0), .. }) => {
            ExprKind::Call(Function::Unary(Unary::Cbrt), vec![inner])
        }
        Some(degree) => {
            let span = degree.span.clone();
            let one = Expr { kind: ExprKind::Number(1.0), span: span.clone() };
            let inverse =
                Expr { kind: ExprKind::Product(vec![(Factor::Times, one), (Factor::Over, degree)]), span };
            ExprKind::Power(Box::new(inner), Box::new(inverse))
        }
    }
}

/// The only item, or a `list` node of several.
fn flatten<T>(mut items: Vec<(T, Expr)>, list: fn(Vec<(T, Expr)>) -> ExprKind) -> Expr {
    if items.len() == 1
        && let Some((_, only)) = items.pop()
    {
        return only;
    }
    let start = items.first().map_or(0, |(_, item)| item.span.start);
    let end = items.last().map_or(0, |(_, item)| item.span.end);
    Expr { kind: list(items), span: start..end }
}

/// Word of `known` that `name` is probably a misspelling of: one that differs in case only, or by one edit (two for a
/// long name). Ties go to the word with the same first letter, then to the one with the fewest letters that `name` has not:
/// `siin` is rather `sin` than `sign`.
pub(super) fn similar<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
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
