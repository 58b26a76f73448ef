//! Calls of functions, with brackets or without: `sin(x)`, `ln 2x`, `sin^2 x cos y`.
//!
//! A call without brackets is read where it has one reading, and refused with brackets suggested where it has two. The function is
//! applied to the power that follows and, after numbers and constants, to what stands directly beside them: `sin 2πx^2` is
//! sin(2πx²). Then a sign, a bracket that closes or another function has to come: `sin x y`, `sin x/2` and `sqrt 2x` may mean
//! either.

use super::ast::{Expr, ExprKind, Factor, Function};
use super::error::{FormulaError, FormulaErrorKind as ErrorKind};
use super::operations::Unary;
use super::parse::{CallArguments, Parse, Parser, integer};
use super::token::{Spanned, Token, slice};
use core::ops::Range;

impl Parser<'_> {
    /// Whether the bracket that is the next token holds a comma of its own.
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

    /// Parses the exponent and the arguments of `function`, whose name has just been consumed at `span`.
    pub(super) fn call(&mut self, function: Function, span: Range<usize>) -> Parse {
        let exponent = self.exponent_of_value(function, &span)?;
        let (arguments, whole) = if let Token::Open(_) = self.peek().token {
            let (CallArguments { arguments, doubtful, first_doubtful }, inside) = self.arguments()?;
            // The number of arguments tells whether a comma may be decimal: `min(1,5)` can have two only, `min(x, 1,5)` two or three.
            let count = arguments.len();
            let may_be_fewer = (count - doubtful..count).any(|fewer| function.takes(fewer));
            if doubtful > 0
                && (may_be_fewer || !function.takes(count))
                && let Some(error) = self.decimal_comma(first_doubtful)
            {
                return Err(error);
            }
            (arguments, span.start..inside.end)
        } else {
            let operand = self.operand(function, &span)?;
            let end = operand.span.end;
            (vec![operand], span.start..end)
        };
        if !function.takes(arguments.len()) {
            let wanted = match function.arity() {
                (1, 1) => "one argument".to_owned(),
                (least, most) if least == most => format!("{least} arguments"),
                (least, _) => format!("at least {least} arguments"),
            };
            let message = format!(
                "`{}` takes {wanted}, and here it has {}",
                function.info().signature,
                arguments.len()
            );
            return Err(FormulaError::new(ErrorKind::WrongArity, whole, message));
        }
        let call = Expr { kind: ExprKind::Call(function, arguments), span: whole.clone() };
        Ok(match exponent {
            Some(exponent) => Expr { kind: ExprKind::Power(Box::new(call), Box::new(exponent)), span: whole },
            None => call,
        })
    }

    /// Parses the exponent after the name of a function: in `sin^2(x)` and `sin²(x)` it applies to the value.
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

    /// Parses what `function`, whose name stands at `span`, is applied to without brackets.
    fn operand(&mut self, function: Function, span: &Range<usize>) -> Parse {
        let name = function.name();
        let message = format!("`{name}` needs brackets around what it is applied to");
        let error = FormulaError::new(ErrorKind::MissingBrackets, span.clone(), message);
        if self.peek().token == Token::Minus
            && let Ok(operand) = self.deeper(Self::signed_power)
        {
            return Err(bracketed(self.text, error, name, &operand.span));
        }
        let begins = self.begins_factor() || matches!(self.peek().token, Token::Number(_));
        let (least, _) = function.arity();
        if !begins || least > 1 {
            return Err(error.suggest(format!("{name}(…)")));
        }
        let operand = self.deeper(Self::beside)?;
        let is_root = matches!(function, Function::Unary(Unary::Sqrt | Unary::Cbrt));
        if self.is_ambiguous_after() || is_root && matches!(operand.kind, ExprKind::Product(_)) {
            return Err(bracketed(self.text, error, name, &operand.span));
        }
        Ok(operand)
    }

    /// Parses a power, and what stands directly beside it if there is one reading: after numbers and constants anything, after
    /// coordinates written as one word the others of them.
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
            if !is_beside || !(is_coefficient || is_coordinate) || Function::find(name).is_some() {
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

    /// Whether what follows an operand might belong to it.
    fn is_ambiguous_after(&self) -> bool {
        let is_function = |token: &Token| match token {
            Token::Name(name) => Function::find(name).is_some(),
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
