//! The statements of a formula: definitions, and at last the surface.
//!
//! `r = hypot(x, y); (r - 1)^2 + z^2 = 0.1` defines r, `f(a, b) = a^2 + b^2; f(x, y) = f(y, z)` a
//! function. A definition ends at a `;`, or at the end of its line where the next one begins with
//! an operand. Elsewhere lines may break anywhere except between factors without a sign. A
//! definition may use only earlier ones, so that none refers to itself.
//!
//! As the last statement, `f(x, y, z) = …` and what other languages have for it, `f = …;`, `return
//! …`, `@(x, y, z) …`, is the surface.

use super::MAX_FORMULA_BYTES;
use super::ast::{COORDINATES, Constant, Definition, Equation, Expr, Function};
use super::colours::{self, ColourText, Colours};
use super::elsewhere::{self, NO_VECTORS, is_elsewhere, is_vector};
use super::error::{FormulaError, FormulaErrorKind as ErrorKind};
use super::heads::{Head, head, nameless, word};
use super::lex::tokens;
use super::parse::{Parse, Parser, inequality};
use super::spelling::{is_known, readings};
use super::token::{Spanned, Token, slice};
use core::ops::Range;

/// A parsed formula and the names in it that are neither coordinates, constants, functions nor
/// defined.
pub(super) struct Parsed {
    pub(super) equation: Equation,
    /// Each name once, in order of appearance, with the span of its first occurrence.
    pub(super) names: Vec<(String, Range<usize>)>,
    /// The colours that the formula gives to the surface.
    pub(super) colours: Colours,
}

/// Parses `text`. `declared` are the names of the declared parameters.
///
/// # Errors
///
/// The first error from left to right, with the text it concerns and, where there is a good guess,
/// a correction.
pub(super) fn parse(text: &str, declared: &[&str]) -> Result<Parsed, FormulaError> {
    if text.len() > MAX_FORMULA_BYTES {
        let message = format!("A formula has at most {MAX_FORMULA_BYTES} bytes; this one has {}", text.len());
        let end = (0..=MAX_FORMULA_BYTES).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0);
        return Err(FormulaError::new(ErrorKind::TooLong, end..text.len(), message));
    }
    let tokens = tokens(text, declared)?;
    if tokens.iter().all(|spanned| matches!(spanned.token, Token::Separator | Token::End)) {
        let message = "Type a formula of x, y and z, for example `x^2 + y^2 + z^2 = 1`";
        return Err(FormulaError::new(ErrorKind::Empty, 0..0, message));
    }
    let (tokens, colours) = colours::taken_out(text, separated(text, tokens));
    let mut parser = Parser::new(text, tokens, declared);
    let equation = parser.statements(&colours.given)?;
    Ok(Parsed { equation, names: parser.names, colours })
}

/// The tree of a text that defines a function of the language with these arguments.
pub(super) fn body(text: &str, arguments: impl Iterator<Item = String>) -> Parse {
    let mut parser = Parser::new(text, tokens(text, &[])?, &[]);
    parser.present = Some((String::new(), arguments.collect()));
    parser.value()
}

/// The tokens with a separator at the end of each line that ends a definition: where an operand
/// ends it and one begins the next line.
fn separated(text: &str, tokens: Vec<Spanned>) -> Vec<Spanned> {
    let is_broken = |at: usize| {
        at > 0 && slice(text, &(tokens[at - 1].span.end..tokens[at].span.start)).contains(['\n', '\r'])
    };
    let ends = |token: &Token| {
        matches!(
            token,
            Token::Number(_) | Token::Name(_) | Token::Superscript(_) | Token::Close(_) | Token::Bar(_)
        )
    };
    let begins = |token: &Token| {
        matches!(
            token,
            Token::Number(_)
                | Token::Name(_)
                | Token::Open(_)
                | Token::Fraction
                | Token::Root
                | Token::Bar(_)
                | Token::At
                | Token::Not
        )
    };
    // A leading sign continues the definition, unless its line is an equation.
    let begins_equation = |from: usize| {
        let is_sign = matches!(tokens[from].token, Token::Plus | Token::Minus);
        let line = (from..tokens.len()).take_while(|&at| at == from || !is_broken(at));
        is_sign && line.map(|at| &tokens[at].token).any(|token| *token == Token::Equals)
    };
    let (mut places, mut brackets, mut body) = (Vec::new(), 0_usize, head(&tokens, 0).map(|head| head.body));
    for at in 0..tokens.len() {
        let token = &tokens[at].token;
        if (body.is_some_and(|body| at > body) || colours::begins(&tokens, at))
            && brackets == 0
            && at > 0
            && is_broken(at)
            && ends(&tokens[at - 1].token)
            && (begins(token) || begins_equation(at))
        {
            places.push(at);
            body = head(&tokens, at).map(|head| head.body);
        }
        match token {
            Token::Separator => body = head(&tokens, at + 1).map(|head| head.body),
            Token::Open(_) => brackets += 1,
            Token::Close(_) => brackets = brackets.saturating_sub(1),
            _ => {}
        }
    }
    if places.is_empty() {
        return tokens;
    }
    let mut all = Vec::with_capacity(tokens.len() + places.len());
    for (at, spanned) in tokens.into_iter().enumerate() {
        if places.binary_search(&at).is_ok() {
            let end = spanned.span.start;
            all.push(Spanned { token: Token::Separator, span: end..end });
        }
        all.push(spanned);
    }
    all
}

/// Whether the names are those of the three coordinates.
fn are_coordinates(names: &[String]) -> bool {
    names.len() == 3 && COORDINATES.iter().all(|axis| names.iter().any(|name| name == axis))
}

impl Parser<'_> {
    fn statements(&mut self, colours: &[ColourText]) -> Result<Equation, FormulaError> {
        loop {
            while self.take(&Token::Separator) {}
            self.skip_program();
            let end = self.end_of_statement();
            let is_last =
                self.tokens[end..].iter().all(|later| matches!(later.token, Token::Separator | Token::End));
            if is_last {
                break;
            }
            self.definition(end, colours)?;
        }
        let surface = self.surface()?;
        let definitions =
            core::mem::take(&mut self.definitions).into_iter().map(|(definition, _)| definition).collect();
        Ok(Equation { definitions, ..surface })
    }

    /// Skips the head of a function of the coordinates in a program: `def f(x, y, z):`.
    fn skip_program(&mut self) {
        if let Some(head) = head(&self.tokens, self.next)
            && are_coordinates(&head.arguments)
            && self.tokens[head.body - 1].token == Token::Colon
            && head.has_keyword
        {
            self.next = head.body;
        }
    }

    /// The token that ends the statement that the next token begins; a `;` in brackets ends none.
    fn end_of_statement(&self) -> usize {
        let mut brackets = 0_i32;
        let ends = |at: &usize| match self.tokens[*at].token {
            Token::Separator => brackets <= 0,
            Token::Open(_) => {
                brackets += 1;
                false
            }
            Token::Close(_) => {
                brackets -= 1;
                false
            }
            _ => false,
        };
        (self.next..self.tokens.len()).find(ends).unwrap_or(self.tokens.len() - 1)
    }

    /// Whether a name occurs in this range of tokens.
    fn mentions(&self, name: &str, range: Range<usize>) -> bool {
        range.into_iter().any(|at| word(&self.tokens, at) == Some(name))
    }

    /// Parses a definition, which ends before token `end`. The colours may use it as well.
    fn definition(&mut self, end: usize, colours: &[ColourText]) -> Result<(), FormulaError> {
        let start = self.next;
        let refused = |span: Range<usize>, message: String| {
            Err(FormulaError::new(ErrorKind::BadDefinition, span, message))
        };
        let whole = self.tokens[start].span.start..self.tokens[end - 1].span.end;
        let Some(head) = head(&self.tokens, start) else {
            if word(&self.tokens, start).is_some_and(is_vector) {
                return refused(whole, NO_VECTORS.into());
            }
            return refused(
                whole,
                "Only the last statement is the surface: those before it define names, as in `r = hypot(x, y);`".into(),
            );
        };
        let span = self.tokens[head.name].span.clone();
        let name = word(&self.tokens, head.name).unwrap_or_default().to_owned();
        if is_known(&name) {
            return refused(
                span,
                format!("`{name}` has a meaning of its own and cannot be defined: choose another name"),
            );
        }
        for (k, argument) in head.arguments.iter().enumerate() {
            let is_taken = Constant::find(argument).is_some() || elsewhere::function(argument).is_some();
            if is_taken || head.arguments[..k].contains(argument) {
                let message = format!("`{argument}` cannot be an argument of `{name}`: choose another name");
                return refused(span, message);
            }
        }
        // A value may be changed, as programs do.
        let is_value = head.arguments.is_empty();
        let is_changed = is_value && self.mentions(&name, head.body..end);
        if let Some((before, _)) = self.definitions.iter().rfind(|(before, _)| before.name == name)
            && !(is_changed && before.arguments.is_empty())
        {
            return refused(span, format!("`{name}` is defined twice: choose another name for one of them"));
        }
        if let Some((_, used)) = self.names.iter().find(|(used, _)| *used == name) {
            return refused(
                used.clone(),
                format!("`{name}` is used before it is defined: its definition has to come first"),
            );
        }
        self.next = head.body;
        self.take_return();
        self.deepest = self.depth;
        self.present = Some((name.clone(), head.arguments.clone()));
        let body = self.value()?;
        self.present = None;
        match self.peek().token {
            Token::Separator => {}
            Token::Equals => return Err(self.second_equation()),
            _ => return Err(self.unexpected()),
        }
        check_conditions(&body)?;
        // A line that was meant to continue ends like a definition that nothing uses.
        let is_line = self.peek().span.is_empty();
        let is_coloured = colours.iter().any(|colour| colour.needs(&name));
        if is_line && !is_coloured && !self.mentions(&name, end..self.tokens.len()) {
            let message = format!(
                "Nothing uses `{name}`, which is defined in this line: leave it out, or end the line with `;`"
            );
            return refused(span, message);
        }
        let depth = self.deepest - self.depth;
        self.definitions.push((Definition { name, arguments: head.arguments, body }, depth));
        Ok(())
    }

    /// Consumes a `return`.
    fn take_return(&mut self) -> bool {
        let is_return = word(&self.tokens, self.next) == Some("return");
        self.next += usize::from(is_return);
        is_return
    }

    fn second_equation(&self) -> FormulaError {
        let message = "A formula has one `=` at most. Definitions such as `r = 2` come before it, each in its \
            own line or with a `;`";
        FormulaError::new(ErrorKind::TooManyEquations, self.peek().span.clone(), message)
    }

    /// Parses the last statement.
    fn surface(&mut self) -> Result<Equation, FormulaError> {
        let end = self.end_of_statement();
        let is_program =
            self.take_return() || !self.definitions.is_empty() || self.tokens[end].token == Token::Separator;
        let named = self.skip_head(is_program, end)?;
        let left = self.value()?;
        let right = if self.take(&Token::Equals) { Some(self.value()?) } else { None };
        let region = self.region()?;
        match self.peek().token {
            Token::Separator | Token::End => {}
            Token::Equals if right.is_none() && !region.is_empty() => {
                let message = "Conditions in braces stand at the end: `z = x*y {x < 1}`";
                let span = self.peek().span.clone();
                return Err(FormulaError::new(ErrorKind::UnexpectedSymbol, span, message));
            }
            Token::Equals => return Err(self.second_equation()),
            _ => return Err(self.unexpected()),
        }
        if let (Some(span), true, None) = (&self.comparison, left.kind.is_condition(), &right) {
            return Err(inequality(span.clone()));
        }
        check_conditions(&left)?;
        right.as_ref().map_or(Ok(()), check_conditions)?;
        let equation = Equation { definitions: Vec::new(), left, right, region };
        // Functions run together in one name have another error.
        let is_lone = |(name, _): &(String, Range<usize>)| readings(name, &[], false).is_empty();
        if let Some((name, span)) = named.filter(is_lone).filter(|_| equation.looks_like_definition()) {
            let error = |message: String| FormulaError::new(ErrorKind::Ambiguous, span, message);
            let question = format!("Does `{name}` name the function? Then leave `{name} =` out");
            return Err(if Constant::find(&name).is_some() {
                let message = format!("{question}; for the number, write `({name}) =`");
                error(message).choose([String::new(), format!("({name}) =")])
            } else {
                let message = format!(
                    "{question}; for a level, write it on the right: `… = {name}`. Or add a slider `{name}`"
                );
                error(message).suggest("").unknown(&name)
            });
        }
        Ok(equation)
    }

    /// Skips the head of the surface, `f(x, y, z) =`, `f =` in a program, `@(x, y, z)`. Returns the
    /// name before the `=`, with the span of both, if the name may mean a level or the function.
    fn skip_head(
        &mut self,
        is_program: bool,
        end: usize,
    ) -> Result<Option<(String, Range<usize>)>, FormulaError> {
        if let Some((arguments, body)) = nameless(&self.tokens, self.next) {
            return self.skip_arguments("f", &arguments, self.next, body).map(|()| None);
        }
        let Some(Head { name: at, has_keyword, arguments, body }) = head(&self.tokens, self.next) else {
            return Ok(None);
        };
        let name = word(&self.tokens, at).unwrap_or_default().to_owned();
        let is_own = self.definitions.iter().any(|(definition, _)| definition.name == name);
        if !arguments.is_empty() {
            let is_other = is_own
                || Function::find(&name).is_some()
                || COORDINATES.contains(&name.as_str())
                || is_elsewhere(&name);
            return if is_other {
                Ok(None)
            } else {
                self.skip_arguments(&name, &arguments, self.next, body).map(|()| None)
            };
        }
        let span = self.tokens[at].span.start..self.tokens[body - 1].span.end;
        let is_mentioned = self.mentions(&name, body..end);
        if is_own && is_mentioned && !has_keyword {
            let message = format!(
                "`{name}` is defined above: leave `{name} =` out for its new value, or write `({name}) =` for an equation"
            );
            return Err(FormulaError::new(ErrorKind::Ambiguous, span, message)
                .choose([String::new(), format!("({name}) =")]));
        }
        if has_keyword && is_known(&name) {
            let message =
                format!("`{name}` has a meaning of its own and cannot be defined: choose another name");
            return Err(FormulaError::new(ErrorKind::BadDefinition, span, message));
        }
        let is_equation =
            is_own || COORDINATES.contains(&name.as_str()) || self.declared.contains(&name.as_str());
        if is_equation && !has_keyword {
            return Ok(None);
        }
        if has_keyword || (is_program || name == "f" || name == "F") && !is_mentioned {
            self.next = body;
            return Ok(None);
        }
        Ok(Some((name, span)).filter(|_| !is_mentioned))
    }

    /// Skips the head of a function of the three coordinates, up to token `body`.
    fn skip_arguments(
        &mut self,
        name: &str,
        arguments: &[String],
        start: usize,
        body: usize,
    ) -> Result<(), FormulaError> {
        let whole = self.tokens[start].span.start..self.tokens[body - 1].span.end;
        if are_coordinates(arguments) {
            self.next = body;
            self.take_return();
            return Ok(());
        }
        let error = |message: String| FormulaError::new(ErrorKind::Ambiguous, whole, message);
        let left_out: Vec<&str> =
            COORDINATES.into_iter().filter(|axis| !arguments.iter().any(|name| name == axis)).collect();
        Err(match left_out[..] {
            [height] if arguments.len() == 2 => {
                let message = format!(
                    "A function of two coordinates is no surface by itself: its graph is `{height} = …`"
                );
                error(message).suggest(format!("{height} ="))
            }
            _ => error(format!("Write `{name}(x, y, z) = …`, or an equation of x, y and z")),
        })
    }
}

/// An error for a condition that is used as a number.
fn check_conditions(expr: &Expr) -> Result<(), FormulaError> {
    expr.misplaced_condition(false)
        .map_or(Ok(()), |condition| Err(FormulaError::misplaced_condition(&condition.span)))
}
