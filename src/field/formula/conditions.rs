//! Choices by conditions: `if(x < 1 and not y > 0, a, b)`, `x < 1 ? a : b`.
//!
//! A condition compares numbers or joins conditions. It is parsed wherever a number may be, since a
//! bracket may hold either; a condition outside of a choice is refused afterwards.

use super::ast::{Connective, Expr, ExprKind};
use super::error::{FormulaError, FormulaErrorKind as ErrorKind};
use super::parse::{Parse, Parser};
use super::token::{Bar, Spanned, Token};

impl Parser<'_> {
    /// Parses a number or, where one may stand, a condition.
    pub(super) fn value(&mut self) -> Parse {
        let condition = self.logic()?;
        if !self.take(&Token::Question) {
            return Ok(condition);
        }
        let start = condition.span.start;
        let condition = as_condition(condition)?;
        self.has_comparison = false;
        let first = self.deeper(Self::value)?;
        if !self.take(&Token::Colon) {
            let message = "A choice has two values: `c ? a : b` is a where the condition c holds, else b";
            return Err(self.cannot_stand(message));
        }
        let second = self.deeper(Self::value)?;
        let span = start..second.span.end;
        Ok(Expr { kind: ExprKind::Choice(Box::new([condition, first, second])), span })
    }

    fn logic(&mut self) -> Parse {
        let mut conditions = vec![self.both()?];
        while self.take_or() {
            conditions.push(self.both()?);
        }
        connected(Connective::Or, conditions)
    }

    fn both(&mut self) -> Parse {
        let mut conditions = vec![self.compared()?];
        while self.take(&Token::And) {
            conditions.push(self.compared()?);
        }
        connected(Connective::And, conditions)
    }

    fn compared(&mut self) -> Parse {
        let start = self.peek().span.start;
        if self.take(&Token::Not) {
            let inner = as_condition(self.deeper(Self::compared)?)?;
            let span = start..inner.span.end;
            return Ok(Expr { kind: ExprKind::Not(Box::new(inner)), span });
        }
        let mut left = self.sum()?;
        let mut conditions = Vec::new();
        while let Token::Compare(comparison) = self.peek().token {
            self.comparison.get_or_insert(self.tokens[self.next].span.clone());
            self.next += 1;
            self.has_comparison = true;
            let right = self.sum()?;
            let span = left.span.start..right.span.end;
            let sides = Box::new([left, right.clone()]);
            conditions.push(Expr { kind: ExprKind::Compare(comparison, sides), span });
            left = right;
        }
        // −1 < x < 1 compares twice.
        if conditions.is_empty() { Ok(left) } else { connected(Connective::And, conditions) }
    }

    /// Whether the next token opens a region that limits the surface, `{x < 1, y > 0}`.
    pub(super) fn begins_region(&self) -> bool {
        if self.peek().token != Token::Open('{') {
            return false;
        }
        let mut brackets = 0_u32;
        for Spanned { token, .. } in &self.tokens[self.next..] {
            match token {
                Token::Open(_) => brackets += 1,
                Token::Close(_) if brackets == 1 => return false,
                Token::Close(_) => brackets -= 1,
                Token::Compare(_) if brackets == 1 => return true,
                _ => {}
            }
        }
        false
    }

    /// Parses the regions that limit the surface. All of their conditions must hold.
    pub(super) fn region(&mut self) -> Result<Vec<Expr>, FormulaError> {
        let mut conditions = Vec::new();
        while self.begins_region() {
            let before = self.comparison.clone();
            let open = self.peek().span.clone();
            self.next += 1;
            loop {
                conditions.push(as_condition(self.within(false, Self::logic)?)?);
                if !self.take(&Token::Comma) {
                    break;
                }
            }
            if !self.take(&Token::Close('}')) {
                return Err(self.unclosed(&open, '{'));
            }
            self.comparison = before;
        }
        Ok(conditions)
    }

    /// Whether the next two tokens are the bars of `||`.
    pub(super) fn is_double_bar(&self) -> bool {
        let (bar, next) = (self.peek(), self.second());
        [&bar.token, &next.token] == [&Token::Bar(Bar::Either); 2] && bar.span.end == next.span.start
    }

    fn take_or(&mut self) -> bool {
        if !self.is_in_bars && self.is_double_bar() {
            self.next += 2;
            return true;
        }
        self.take(&Token::Or)
    }
}

/// The conditions joined by `connective`, or the only item, which may be a number.
fn connected(connective: Connective, mut conditions: Vec<Expr>) -> Parse {
    if conditions.len() == 1 {
        return Ok(conditions.remove(0));
    }
    let conditions = conditions.into_iter().map(as_condition).collect::<Result<Vec<Expr>, FormulaError>>()?;
    let span = conditions[0].span.start..conditions[conditions.len() - 1].span.end;
    Ok(Expr { kind: ExprKind::Logic(connective, conditions), span })
}

/// The expression, which has to be a condition.
pub(super) fn as_condition(expr: Expr) -> Parse {
    if expr.kind.is_condition() {
        return Ok(expr);
    }
    let message = "A condition compares two numbers, as in `x < 1`";
    Err(FormulaError::new(ErrorKind::UnexpectedSymbol, expr.span, message))
}
