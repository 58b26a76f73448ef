//! Recursive-descent parser: tokens to a syntax tree.
//!
//! ```text
//! formula   := { definition ";" } surface [ ";" ]               see `statements`
//! surface   := value [ "=" value ] { region }
//! region    := "{" logic { "," logic } "}"                      conditions
//! value     := logic [ "?" value ":" value ]
//! logic     := both { "or" both }                               conditions, or a sum
//! both      := compared { "and" compared }
//! compared  := "not" compared | sum { ( "<" | "<=" | ">" | ">=" ) sum }
//! sum       := term { ("+" | "-") term }
//! term      := ("-" | "+") term | product
//! product   := power { ("*" | "/" | "%") signed | power }       no number but the first stands
//! signed    := ("-" | "+") signed | power                       beside another factor
//! power     := atom [ superscript | "^" signed ]                "^" binds to the right
//! atom      := number | name | "(" value ")" | "|" sum "|" | "\frac" group group
//!            | "\sqrt" [ "[" value "]" ] group
//!            | function [ exponent ] ( "(" value { "," value } ")" | operand )
//! ```
//!
//! An opening bracket of any kind, `(`, `[` or `{`, is closed by its own. [`call`](super::call)
//! says what a function without brackets is applied to.

use super::MAX_DEPTH;
use super::ast::{Constant, Definition, Expr, ExprKind, Factor, Function, Sign};
use super::elsewhere::{self, NO_VECTORS, called, is_vector};
use super::error::{FormulaError, FormulaErrorKind as ErrorKind};
use super::operations::Unary;
use super::token::{Bar, Spanned, Token, closing, slice};
use core::ops::Range;

pub(super) struct Parser<'a> {
    pub(super) text: &'a str,
    pub(super) tokens: Vec<Spanned>,
    /// Index of the next token.
    pub(super) next: usize,
    pub(super) depth: usize,
    /// The greatest depth so far in the present definition.
    pub(super) deepest: usize,
    /// Whether the innermost bracket around the next token is a bar, which a bar after an operand
    /// closes.
    pub(super) is_in_bars: bool,
    /// Whether a comparison precedes the next token in its bracket, so that `||` is a logical
    /// operator.
    pub(super) has_comparison: bool,
    /// Number of brackets around the next token.
    brackets: usize,
    /// The first sign of a comparison.
    pub(super) comparison: Option<Range<usize>>,
    /// Whether calls are written as in Mathematica, so that `E` is Euler's number.
    pub(super) is_mathematica: bool,
    pub(super) declared: &'a [&'a str],
    /// The definitions read so far, each with the depth of its nesting.
    pub(super) definitions: Vec<(Definition, usize)>,
    /// The name that is being defined, with its arguments.
    pub(super) present: Option<(String, Vec<String>)>,
    /// Names that are neither coordinates, constants, functions nor defined, each once, with the
    /// span of its first occurrence.
    pub(super) names: Vec<(String, Range<usize>)>,
}

pub(super) type Parse = Result<Expr, FormulaError>;

/// The arguments of a function.
pub(super) struct CallArguments {
    pub(super) arguments: Vec<Expr>,
    /// The commas between them that may be decimal ones: the token of each, and the argument after
    /// it.
    doubtful: Vec<(usize, usize)>,
    /// Whether a comma that cannot be decimal has no space after it.
    is_tight: bool,
}

impl<'a> Parser<'a> {
    pub(super) fn new(text: &'a str, tokens: Vec<Spanned>, declared: &'a [&'a str]) -> Self {
        let is_mathematica = tokens.windows(2).any(|pair| match pair {
            [Spanned { token: Token::Name(name), .. }, Spanned { token: Token::Open('['), .. }] => {
                name.starts_with(|c: char| c.is_ascii_uppercase()) && called(name, '[').is_some()
            }
            _ => false,
        });
        Self {
            text,
            tokens,
            next: 0,
            depth: 0,
            deepest: 0,
            is_in_bars: false,
            has_comparison: false,
            brackets: 0,
            comparison: None,
            is_mathematica,
            declared,
            definitions: Vec::new(),
            present: None,
            names: Vec::new(),
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
        self.deepest = self.deepest.max(self.depth);
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
        if let Token::Compare(_) = token {
            return inequality(span.clone());
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

    /// Error for the next token, with this message.
    pub(super) fn cannot_stand(&self, message: &str) -> FormulaError {
        FormulaError::new(ErrorKind::UnexpectedSymbol, self.peek().span.clone(), message)
    }

    /// The numbers on both sides of the comma that is token `at`, if it may be a decimal one: they
    /// have no point, and there is no space.
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

    /// Error for a comma between the arguments of a function that may be a decimal one. `takes`
    /// says which numbers of arguments are possible: two only for `min(1,5)`, two or three for
    /// `min(x, 1,5)`. If the other commas have no space after them either, commas separate, unless
    /// one has a bare number on both sides: `max(x-1,3-y,z)`, but not `max(x,1,5)`.
    pub(super) fn doubt(&self, call: &CallArguments, takes: &dyn Fn(usize) -> bool) -> Option<FormulaError> {
        let (count, doubtful) = (call.arguments.len(), &call.doubtful);
        let &(first, _) = doubtful.first()?;
        let may_be_fewer = (count - doubtful.len()..count).any(takes);
        let is_number = |at: usize| matches!(call.arguments[at].kind, ExprKind::Number(_));
        let separates =
            call.is_tight && !doubtful.iter().any(|&(_, after)| is_number(after) && is_number(after - 1));
        let is_decimal = !takes(count) || may_be_fewer && !separates;
        if is_decimal { self.decimal_comma(first) } else { None }
    }

    pub(super) fn sum(&mut self) -> Parse {
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
        if first.kind.is_condition() {
            let is_operand =
                matches!(self.peek().token, Token::Star | Token::Slash | Token::Percent | Token::Caret);
            return if is_operand { Err(FormulaError::misplaced_condition(&first.span)) } else { Ok(first) };
        }
        let mut factors = vec![(Factor::Times, first)];
        let mut is_remainder = false;
        loop {
            if self.take(&Token::Star) {
                factors.push((Factor::Times, self.signed_power()?));
            } else if self.take(&Token::Slash) {
                factors.push((Factor::Over, self.signed_power()?));
            } else if self.take(&Token::Percent) {
                self.check_remark()?;
                let divisor = self.signed_power()?;
                let dividend = flatten(core::mem::take(&mut factors), ExprKind::Product);
                factors.push((Factor::Times, named_call("mod", vec![dividend, divisor])));
                is_remainder = true;
                continue;
            } else if self.begins_factor() {
                self.check_bars(&factors)?;
                self.check_line()?;
                let divisor = self.tokens[self.next - 1].span.end;
                let factor = self.power()?;
                let after_division = is_remainder || matches!(factors.last(), Some((Factor::Over, _)));
                if after_division && !is_fraction_of(&factors, &factor) {
                    return Err(self.what_divides(&factors, divisor, &factor));
                }
                factors.push((Factor::Times, factor));
            } else {
                break;
            }
            is_remainder = false;
        }
        Ok(flatten(factors, ExprKind::Product))
    }

    /// Error for a factor right after a divisor, which ends at byte `end`.
    fn what_divides(&self, factors: &[(Factor, Expr)], end: usize, factor: &Expr) -> FormulaError {
        let (mut start, sign) = match factors.last() {
            Some((Factor::Over, divisor)) => (divisor.span.start, '/'),
            _ => (end, '%'),
        };
        if let [.., (_, Expr { kind: ExprKind::Call(_, parts), .. })] = factors
            && let ('%', [_, divisor]) = (sign, &parts[..])
        {
            start = divisor.span.start;
        }
        let (below, beside) = (slice(self.text, &(start..end)), slice(self.text, &factor.span));
        let ways = [format!("({below} {beside})"), format!("{below}*{beside}")];
        let message = format!("What is divided by? Write `{sign}{}` or `{sign}{}`", ways[0], ways[1]);
        FormulaError::new(ErrorKind::Ambiguous, start..factor.span.end, message).choose(ways)
    }

    /// An error after `%`, which has just been consumed, if words follow: in MATLAB and LaTeX it
    /// begins a comment.
    fn check_remark(&self) -> Result<(), FormulaError> {
        let Token::Name(name) = &self.peek().token else { return Ok(()) };
        let is_word = name.chars().count() > 1
            && !self.declared.contains(&name.as_str())
            && !self.definitions.iter().any(|(definition, _)| definition.name == *name)
            && elsewhere::function(name).is_none()
            && Constant::find(name).is_none();
        if !is_word {
            return Ok(());
        }
        let span = self.tokens[self.next - 1].span.clone();
        let message = "`%` is the remainder of a division here: a comment begins with `//`";
        Err(FormulaError::new(ErrorKind::Ambiguous, span, message).suggest("//"))
    }

    /// An error if a factor begins a line outside brackets: it may be meant as a new statement. In
    /// LaTeX line breaks mean nothing.
    fn check_line(&self) -> Result<(), FormulaError> {
        let Spanned { span, .. } = self.peek();
        let before = self.next.checked_sub(1).map_or(0, |last| self.tokens[last].span.end);
        if self.brackets > 0
            || !slice(self.text, &(before..span.start)).contains('\n')
            || self.text.contains('\\')
        {
            return Ok(());
        }
        let message = "A new line begins here without a sign: write `*` to multiply. What comes before the surface has to be a \
            definition, such as `r = hypot(x, y)`";
        let written = slice(self.text, span);
        Err(FormulaError::new(ErrorKind::Ambiguous, span.clone(), message).suggest(format!("*{written}")))
    }

    /// Whether the next token begins a factor without a sign before it.
    pub(super) fn begins_factor(&self) -> bool {
        match self.peek().token {
            Token::Open('{') if self.begins_region() => false,
            Token::Name(_) | Token::Open(_) | Token::Fraction | Token::Root | Token::Bar(Bar::Opening) => {
                true
            }
            Token::Bar(Bar::Either) => !(self.is_in_bars || self.has_comparison && self.is_double_bar()),
            _ => false,
        }
    }

    /// In `|x|y|z|` the second bar may close or open: an error at the third one, where the factors
    /// lead to it.
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
            Token::Open(bracket) => {
                let (inner, span) = self.bracketed(|parser| parser.within(false, Self::value))?;
                Ok(match bracket {
                    '⌊' => Expr { span, ..named_call("floor", vec![inner]) },
                    '⌈' => Expr { span, ..named_call("ceil", vec![inner]) },
                    _ => Expr { span, ..inner },
                })
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

    /// Parses the argument of a LaTeX command: braces, or one character.
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
    pub(super) fn within(&mut self, bars: bool, parse: impl FnOnce(&mut Self) -> Parse) -> Parse {
        let outside = (self.is_in_bars, self.has_comparison);
        (self.is_in_bars, self.has_comparison) = (bars, false);
        self.brackets += 1;
        let result = self.deeper(parse);
        self.brackets -= 1;
        (self.is_in_bars, self.has_comparison) = outside;
        result
    }

    /// Parses a bracket that begins with the next token, and what is `inside`; also returns the
    /// whole span.
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
    /// The components of vectors are arguments of a length: `length(vec3(x, y, z))`, `norm([x, y,
    /// z])`.
    pub(super) fn arguments(
        &mut self,
        function: Option<Function>,
    ) -> Result<(CallArguments, Range<usize>), FormulaError> {
        self.bracketed(|parser| {
            let mut call = CallArguments { arguments: Vec::new(), doubtful: Vec::new(), is_tight: false };
            if matches!(parser.peek().token, Token::Close(_)) {
                return Ok(call);
            }
            loop {
                if function == Some(Function::Hypot) && parser.begins_vector() {
                    call.arguments.extend(parser.components()?);
                } else {
                    call.arguments.push(parser.within(false, Self::value)?);
                }
                if !parser.take(&Token::Comma) {
                    return match parser.peek().token {
                        Token::Separator => {
                            let message = "A comma separates arguments; `;` ends a definition";
                            Err(parser.cannot_stand(message).suggest(","))
                        }
                        Token::Equals if function == Some(Function::If) => {
                            Err(parser.cannot_stand("A condition compares by `<`, `<=`, `>` or `>=`"))
                        }
                        _ => Ok(call),
                    };
                }
                let comma = parser.next - 1;
                if parser.numbers_beside(comma).is_some() {
                    call.doubtful.push((comma, call.arguments.len()));
                } else {
                    call.is_tight |= parser.tokens[comma].span.end == parser.peek().span.start;
                }
            }
        })
    }

    /// Whether a vector begins with the next token: `vec3(…)`, or a list in brackets.
    fn begins_vector(&self) -> bool {
        match &self.peek().token {
            Token::Name(name) => is_vector(name) && matches!(self.second().token, Token::Open(_)),
            Token::Open(_) => self.has_comma(),
            _ => false,
        }
    }

    /// Parses a vector: its components.
    fn components(&mut self) -> Result<Vec<Expr>, FormulaError> {
        let start = self.peek().span.start;
        self.next += usize::from(matches!(self.peek().token, Token::Name(_)));
        let (call, inside) = self.arguments(None)?;
        if !matches!(self.peek().token, Token::Comma | Token::Close(_)) {
            return Err(FormulaError::new(ErrorKind::UnexpectedSymbol, start..inside.end, NO_VECTORS));
        }
        Ok(call.arguments)
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

    /// The token that closes the bracket around the next token, if there is no comma before it.
    fn late_closing(&self) -> Option<&Spanned> {
        let mut depth = 0_usize;
        for later in &self.tokens[self.next..] {
            match later.token {
                Token::Close(_) if depth == 0 => return Some(later),
                Token::Comma if depth == 0 => return None,
                Token::Open(_) => depth += 1,
                Token::Close(_) => depth -= 1,
                _ => {}
            }
        }
        None
    }

    /// Error where the bracket at `open` should be closed by `closing`.
    pub(super) fn unclosed(&self, open: &Range<usize>, closing: char) -> FormulaError {
        let place = slice(self.text, &(0..open.start)).chars().count() + 1;
        let message = format!("The bracket opened at character {place} is not closed");
        match self.peek().token {
            Token::End => {
                let end = self.text.len();
                FormulaError::new(ErrorKind::UnexpectedEnd, end..end, message).suggest(closing)
            }
            Token::Separator => {
                let at = self.peek().span.start;
                FormulaError::new(ErrorKind::UnexpectedSymbol, at..at, format!("{message} before `;`"))
                    .suggest(closing)
            }
            Token::Equals => {
                let before = self.next.checked_sub(1).map_or(0, |last| self.tokens[last].span.end);
                // Editors close a bracket as soon as it is opened: it may be too far to the right.
                let late = self.late_closing();
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
}

/// Error for the sign of an inequality.
pub(super) fn inequality(span: Range<usize>) -> FormulaError {
    let message = "An inequality describes a solid, and its surface is where both sides are equal: write `=`";
    FormulaError::new(ErrorKind::UnexpectedCharacter, span, message).suggest("=")
}

pub(super) fn wrong_arity(signature: &str, wanted: usize, given: usize, span: Range<usize>) -> FormulaError {
    let wanted = if wanted == 1 { "one argument".to_owned() } else { format!("{wanted} arguments") };
    let message = format!("`{signature}` takes {wanted}, and here it has {given}");
    FormulaError::new(ErrorKind::WrongArity, span, message)
}

/// Whether a factor follows a fraction of two numbers: `9/4y^2` is (9/4)y². A factor that is a
/// number itself may belong to the divisor, as in `1/2pi`.
fn is_fraction_of(factors: &[(Factor, Expr)], factor: &Expr) -> bool {
    let is_fraction = matches!(
        factors,
        [
            ..,
            (Factor::Times, Expr { kind: ExprKind::Number(_), .. }),
            (Factor::Over, Expr { kind: ExprKind::Number(_), .. })
        ]
    );
    let is_named = |kind: &ExprKind| {
        matches!(
            kind,
            ExprKind::Coordinate(_) | ExprKind::Parameter(_) | ExprKind::Argument(_) | ExprKind::Defined(..)
        )
    };
    is_fraction && factor.any(&is_named)
}

/// A call of the function `name`, which the language has.
fn named_call(name: &str, arguments: Vec<Expr>) -> Expr {
    let function = Function::find(name).expect("a function of the language");
    let ends = [arguments.first(), arguments.last()].map(|end| end.map_or(0..0, |end| end.span.clone()));
    Expr { kind: ExprKind::Call(function, arguments), span: ends[0].start..ends[1].end }
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
