//! Calls of functions, with brackets or without: `sin(x)`, `ln 2x`, `sin^2 x cos y`.
//!
//! A call without brackets is accepted if it has one reading; if it has two, it is refused and
//! brackets are suggested. The function applies to the power that follows and, after numbers and
//! constants, to the factors directly after them: `sin 2πx^2` is sin(2πx²). Next must come a sign,
//! a closing bracket or another function: `sin x y`, `sin x/2` and `sqrt 2x` may mean either.

use super::ast::{Expr, ExprKind, Factor, Function, Sign};
use super::conditions::as_condition;
use super::elsewhere::{self, Called, NO_VECTORS};
use super::error::{FormulaError, FormulaErrorKind as ErrorKind};
use super::operations::{Binary, Unary};
use super::parse::{CallArguments, Parse, Parser, integer, wrong_arity};
use super::token::{Spanned, Token, slice};
use core::ops::Range;

impl Parser<'_> {
    /// Whether the next bracket contains a comma outside of inner brackets.
    pub(super) fn has_comma(&self) -> bool {
        let mut depth = 0_usize;
        for Spanned { token, .. } in &self.tokens[self.next..] {
            match token {
                Token::Open(_) => depth += 1,
                Token::Close(_) => depth = depth.saturating_sub(1),
                Token::Comma if depth == 1 => return true,
                _ => {}
            }
            if depth == 0 {
                break;
            }
        }
        false
    }

    /// Parses the exponent and the arguments of `function`, whose name has just been consumed at
    /// `span`.
    pub(super) fn call(&mut self, function: Function, span: Range<usize>) -> Parse {
        let exponent = self.exponent_of_value(function, &span)?;
        let (mut arguments, whole) = if let Token::Open(_) = self.peek().token {
            let (call, inside) = self.arguments(Some(function))?;
            if let Some(error) = self.doubt(&call, &|count| takes(function, count)) {
                return Err(error);
            }
            (call.arguments, span.start..inside.end)
        } else {
            let operand = self.operand(function, &span)?;
            let end = operand.span.end;
            (vec![operand], span.start..end)
        };
        let count = arguments.len();
        if !takes(function, count) {
            let name = slice(self.text, &span);
            let signature = function.info().signature.replacen(function.name(), name, 1);
            let error = match function.arity() {
                (least, most) if least == most => wrong_arity(&signature, least, count, whole),
                (least, _) => {
                    let message =
                        format!("`{signature}` takes at least {least} arguments, and here it has {count}");
                    FormulaError::new(ErrorKind::WrongArity, whole, message)
                }
            };
            return Err(match &arguments[..] {
                [point] if function == Function::Hypot => {
                    let message = format!("{}. {NO_VECTORS}", error.message);
                    let error = FormulaError { message, ..error };
                    if is_point(point) { error.suggest(format!("{name}(x, y, z)")) } else { error }
                }
                _ => error,
            });
        }
        let kind = match function {
            Function::If => {
                let [condition, first, second] = [0, 1, 2].map(|_| arguments.remove(0));
                ExprKind::Choice(Box::new([as_condition(condition)?, first, second]))
            }
            Function::Unary(Unary::Atan) if count == 2 => {
                ExprKind::Call(Function::Binary(Binary::Atan2), arguments)
            }
            _ => ExprKind::Call(function, arguments),
        };
        let call = Expr { kind, span: whole.clone() };
        Ok(match exponent {
            Some(exponent) => Expr { kind: ExprKind::Power(Box::new(call), Box::new(exponent)), span: whole },
            None => call,
        })
    }

    /// Parses a call by a name of another language, which has just been consumed at `span`.
    pub(super) fn call_of(&mut self, called: Called, span: Range<usize>) -> Parse {
        if let Called::Function(function) = called {
            return self.call(function, span);
        }
        let (CallArguments { mut arguments, .. }, inside) =
            self.arguments(Some(Function::Hypot).filter(|_| called == Called::Dot))?;
        let (count, whole) = (arguments.len(), span.start..inside.end);
        let name = slice(self.text, &span);
        let (signature, wanted) = match called {
            Called::Power => (format!("{name}(a, b)"), 2),
            Called::Square => (format!("{name}(a)"), 1),
            Called::AngleOf if count == 1 => (format!("{name}[a]"), 1),
            Called::AngleOf => (format!("{name}[a, b]"), 2),
            _ if count < 4 || count % 2 == 1 => {
                let message = format!("`{name}(a, b, c, d, e, f)` is a d + b e + c f. {NO_VECTORS}");
                let error = FormulaError::new(ErrorKind::WrongArity, whole, message);
                let is_square = count == 2 && arguments.iter().all(is_point);
                return Err(if is_square { error.suggest("(x^2 + y^2 + z^2)") } else { error });
            }
            _ => (String::new(), count),
        };
        if count != wanted {
            return Err(wrong_arity(&signature, wanted, count, whole));
        }
        let last = arguments.pop();
        let kind = match (called, last) {
            (Called::Power, Some(exponent)) => {
                ExprKind::Power(Box::new(arguments.remove(0)), Box::new(exponent))
            }
            (Called::Square, Some(base)) => {
                ExprKind::Power(Box::new(base), Box::new(integer(2, span.clone())))
            }
            (Called::AngleOf, Some(first)) if arguments.is_empty() => {
                ExprKind::Call(Function::Unary(Unary::Atan), vec![first])
            }
            (Called::AngleOf, Some(second)) => {
                ExprKind::Call(Function::Binary(Binary::Atan2), vec![second, arguments.remove(0)])
            }
            (_, last) => {
                arguments.extend(last);
                let others = arguments.split_off(count / 2);
                let products = arguments.into_iter().zip(others).map(|(a, b)| {
                    let span = a.span.start..b.span.end;
                    let factors = vec![(Factor::Times, a), (Factor::Times, b)];
                    (Sign::Plus, Expr { kind: ExprKind::Product(factors), span })
                });
                ExprKind::Sum(products.collect())
            }
        };
        Ok(Expr { kind, span: whole })
    }

    /// Parses the exponent after the name of a function: in `sin^2(x)` and `sin²(x)` it applies to
    /// the value.
    fn exponent_of_value(
        &mut self,
        function: Function,
        span: &Range<usize>,
    ) -> Result<Option<Expr>, FormulaError> {
        let name = function.name();
        let exponent = match self.peek().token {
            Token::Superscript(value) => {
                let raised = self.peek().span.clone();
                self.next += 1;
                integer(value, raised)
            }
            Token::Caret => {
                self.next += 1;
                let is_braced = self.take(&Token::Open('{'));
                let is_negative = self.take(&Token::Minus);
                let Spanned { token, span: raised } = self.peek().clone();
                let Token::Number(value) = token else {
                    let message = format!("Write the power of a value as `{name}(…)^n`");
                    return Err(FormulaError::new(ErrorKind::Ambiguous, span.start..raised.end, message));
                };
                self.next += 1;
                if is_braced && !self.take(&Token::Close('}')) {
                    return Err(self.unexpected());
                }
                Expr { kind: ExprKind::Number(if is_negative { -value } else { value }), span: raised }
            }
            _ => return Ok(None),
        };
        let is_negative = match exponent.kind {
            // −0 is written with a sign, too.
            ExprKind::Number(value) => value.is_sign_negative(),
            _ => true,
        };
        if is_negative {
            let message = format!(
                "A negative power of `{name}` has two readings: write `1/{name}(…)`, or name the inverse"
            );
            return Err(FormulaError::new(ErrorKind::Ambiguous, span.start..exponent.span.end, message));
        }
        Ok(Some(exponent))
    }

    /// Parses the operand of `function`, named at `span`, if it has no brackets.
    fn operand(&mut self, function: Function, span: &Range<usize>) -> Parse {
        let name = function.name();
        let message = match function {
            Function::If => {
                "A choice is written `if(c, a, b)`: a where the condition c holds, else b".to_owned()
            }
            _ => format!("`{name}` needs brackets around what it is applied to"),
        };
        let error = FormulaError::new(ErrorKind::MissingBrackets, span.clone(), message);
        if self.peek().token == Token::Minus
            && let Ok(operand) = self.deeper(Self::signed_power)
        {
            return Err(bracketed(self.text, error, name, &operand.span));
        }
        let begins = self.begins_factor() || matches!(self.peek().token, Token::Number(_));
        if !begins || !function.takes(1) {
            return Err(error.suggest(format!("{name}(…)")));
        }
        let operand = self.deeper(Self::beside)?;
        let is_root = matches!(function, Function::Unary(Unary::Sqrt | Unary::Cbrt));
        if self.is_ambiguous_after() || is_root && matches!(operand.kind, ExprKind::Product(_)) {
            return Err(bracketed(self.text, error, name, &operand.span));
        }
        Ok(operand)
    }

    /// Parses a power and the factors directly after it, if there is one reading: any factor after
    /// numbers and constants, only coordinates after coordinates of the same word.
    fn beside(&mut self) -> Parse {
        let first = self.power()?;
        let mut is_coefficient = is_coefficient(&first.kind);
        let mut is_coordinate = matches!(first.kind, ExprKind::Coordinate(_));
        let span = first.span.clone();
        let mut factors = vec![(Factor::Times, first)];
        let mut end = span.end;
        loop {
            let next = self.peek();
            let Token::Name(name) = &next.token else { break };
            // White space after a command of LaTeX only ends its name.
            let is_after_command = slice(self.text, &factors[factors.len() - 1].1.span).starts_with('\\');
            let between = slice(self.text, &(end..next.span.start));
            let is_beside = between.is_empty() || is_after_command && between.trim().is_empty();
            if !is_beside || !(is_coefficient || is_coordinate) || elsewhere::function(name).is_some() {
                break;
            }
            let factor = self.power()?;
            is_coordinate &= matches!(factor.kind, ExprKind::Coordinate(_) | ExprKind::Power(..));
            is_coordinate |= is_coefficient && matches!(factor.kind, ExprKind::Coordinate(_));
            is_coefficient &= self::is_coefficient(&factor.kind);
            end = factor.span.end;
            factors.push((Factor::Times, factor));
        }
        match factors.len() {
            1 => Ok(factors.remove(0).1),
            _ => Ok(Expr { kind: ExprKind::Product(factors), span: span.start..end }),
        }
    }

    /// Whether the next token might belong to the operand before it.
    fn is_ambiguous_after(&self) -> bool {
        let is_function = |token: &Token| match token {
            Token::Name(name) => elsewhere::function(name).is_some(),
            token => *token == Token::Root,
        };
        match &self.peek().token {
            Token::Star | Token::Slash => !is_function(&self.second().token),
            Token::Number(_) => true,
            token => self.begins_factor() && !is_function(token),
        }
    }
}

/// The error with brackets suggested around the operand at `span`.
fn bracketed(text: &str, error: FormulaError, name: &str, span: &Range<usize>) -> FormulaError {
    let inner = slice(text, span);
    FormulaError { span: error.span.start..span.end, ..error }.suggest(format!("{name}({inner})"))
}

fn is_coefficient(kind: &ExprKind) -> bool {
    matches!(kind, ExprKind::Number(_) | ExprKind::Constant(_))
}

/// Whether an argument is a common name of the point itself.
fn is_point(argument: &Expr) -> bool {
    matches!(&argument.kind, ExprKind::Parameter(name) if matches!(name.as_str(), "p" | "P" | "pos" | "point"))
}

/// Whether a function takes `count` arguments; in GLSL, `atan` takes two.
fn takes(function: Function, count: usize) -> bool {
    function.takes(count) || function == Function::Unary(Unary::Atan) && count == 2
}
