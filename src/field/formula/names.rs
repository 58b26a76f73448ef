//! Looks a name up: it is an argument, a coordinate, a definition, a constant, a function or a
//! parameter.

use super::MAX_DEPTH;
use super::ast::{COORDINATES, Constant, Expr, ExprKind, FUNCTIONS, Reference};
use super::elsewhere::{self, NO_VECTORS, call_error, called, formula_alone, is_program};
use super::error::{FormulaError, FormulaErrorKind as ErrorKind};
use super::parse::{Parse, Parser, wrong_arity};
use super::spelling::{readings, similar};
use super::token::Token;
use core::ops::Range;

impl Parser<'_> {
    /// Parses what begins with `name`, which has just been consumed.
    pub(super) fn name(&mut self, name: String, span: Range<usize>) -> Parse {
        let arguments = self.present.as_ref().map_or(&[][..], |(_, arguments)| arguments);
        if let Some(index) = arguments.iter().position(|argument| *argument == name) {
            return Ok(Expr { kind: ExprKind::Argument(Reference { index, name }), span });
        }
        if let Some(axis) = COORDINATES.iter().position(|&coordinate| coordinate == name) {
            let axis = u8::try_from(axis).unwrap_or(0);
            return Ok(Expr { kind: ExprKind::Coordinate(axis), span });
        }
        if let Some(index) = self.definitions.iter().rposition(|(definition, _)| definition.name == name) {
            return self.defined(Reference { index, name }, span);
        }
        let is_declared = self.declared.contains(&name.as_str());
        if !is_declared && let Some(constant) = self.constant(&name) {
            return Ok(Expr { kind: ExprKind::Constant(constant), span });
        }
        if let Some(function) = elsewhere::function(&name) {
            return self.call(function, span);
        }
        if self.present.as_ref().is_some_and(|(present, _)| *present == name) {
            let message = format!(
                "`{name}` is defined by itself: a definition may hold names that are defined before it"
            );
            return Err(FormulaError::new(ErrorKind::BadDefinition, span, message));
        }
        if let Token::Open(bracket) = self.peek().token
            && !is_declared
        {
            if let Some(called) = called(&name, bracket) {
                return self.call_of(called, span);
            }
            if bracket == '(' {
                return Err(self.unknown_function(&name, &span));
            }
            if bracket == '['
                && self.peek().span.start == span.end
                && matches!(self.second().token, Token::Number(_))
            {
                return Err(FormulaError::new(ErrorKind::UnexpectedSymbol, span, NO_VECTORS));
            }
        }
        let is_applied = self.begins_factor() || matches!(self.peek().token, Token::Number(_));
        if !is_declared && is_program(&name) && is_applied {
            return Err(formula_alone(&name, span));
        }
        if name == "E" && !is_declared && self.peek().token == Token::Caret {
            let message = "Euler's number is written `e`. Or add a slider `E`";
            return Err(FormulaError::new(ErrorKind::UnknownName, span, message).suggest("e").unknown(&name));
        }
        if name == "return" {
            let message = "`return` stands before the last expression alone: choose another name";
            return Err(FormulaError::new(ErrorKind::UnexpectedSymbol, span, message));
        }
        if !self.names.iter().any(|(known, _)| *known == name) {
            self.names.push((name.clone(), span.clone()));
        }
        Ok(Expr { kind: ExprKind::Parameter(name), span })
    }

    /// The constant that is called `name` here or elsewhere.
    fn constant(&self, name: &str) -> Option<Constant> {
        match name {
            "Pi" | "PI" | "M_PI" => Some(Constant::Pi),
            "E" if self.is_mathematica => Some(Constant::E),
            _ => Constant::find(name),
        }
    }

    /// Parses what begins with the name of a definition, which has just been consumed.
    fn defined(&mut self, reference: Reference, span: Range<usize>) -> Parse {
        let (definition, depth) = &self.definitions[reference.index];
        let (wanted, depth) = (definition.arguments.clone(), *depth);
        if wanted.is_empty() {
            return Ok(Expr { kind: ExprKind::Defined(reference, Vec::new()), span });
        }
        let signature = format!("{}({})", reference.name, wanted.join(", "));
        let Token::Open(_) = self.peek().token else {
            let message = format!("`{}` is a function: write `{signature}`", reference.name);
            return Err(FormulaError::new(ErrorKind::MissingBrackets, span, message));
        };
        let (call, inside) = self.arguments(None)?;
        let takes = |count: usize| count == wanted.len();
        if let Some(error) = self.doubt(&call, &takes) {
            return Err(error);
        }
        let span = span.start..inside.end;
        if !takes(call.arguments.len()) {
            return Err(wrong_arity(&signature, wanted.len(), call.arguments.len(), span));
        }
        if self.depth + depth > MAX_DEPTH {
            let message = format!("Nested more than {MAX_DEPTH} levels deep");
            return Err(FormulaError::new(ErrorKind::TooDeep, span, message));
        }
        self.deepest = self.deepest.max(self.depth + depth);
        Ok(Expr { kind: ExprKind::Defined(reference, call.arguments), span })
    }

    /// The error for a call of an unknown function, whose name has just been consumed.
    fn unknown_function(&self, name: &str, span: &Range<usize>) -> FormulaError {
        if let Some(error) = call_error(self.text, &self.tokens, self.next - 1) {
            return error;
        }
        let error = |message: String| FormulaError::new(ErrorKind::UnknownFunction, span.clone(), message);
        let readings = readings(name, &self.known_names(), true);
        if let [only] = &readings[..] {
            return error(format!("`{name}` reads as one name: write `{only}(`")).suggest(only.clone());
        }
        if let [one, other, ..] = &readings[..] {
            return error(format!("`{name}` reads as one name: write `{one}(` or `{other}(`"))
                .choose(readings);
        }
        if let Some(guess) = similar(name, FUNCTIONS.iter().map(|function| function.name)) {
            return error(format!("There is no function `{name}`: did you mean `{guess}`?")).suggest(guess);
        }
        let may_multiply = !self.has_comma();
        let is_word = name.chars().filter(|c| c.is_alphabetic()).count() > 1;
        let arguments = if may_multiply { "a" } else { "a, b" };
        let define = format!(
            "There is no function `{name}`: define it before the surface, `{name}({arguments}) = …;`"
        );
        match (may_multiply, is_word) {
            (false, _) => error(define),
            (true, true) => error(format!("{define}, or write `{name}*(` to multiply")),
            (true, false) => {
                error(format!("{define}, or write `{name}*(` to multiply")).suggest(format!("{name}*"))
            }
        }
    }

    /// The names that parameters and definitions have so far.
    pub(super) fn known_names(&self) -> Vec<&str> {
        let defined = self.definitions.iter().map(|(definition, _)| definition.name.as_str());
        let found = self.names.iter().map(|(name, _)| name.as_str());
        self.declared.iter().copied().chain(defined).chain(found).collect()
    }
}
