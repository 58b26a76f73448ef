//! Functions of position that are not surfaces, such as a thickness or a spacing: expressions in
//! the coordinates and in given names.

use super::ast::Equation;
use super::compiled::Compiled;
use super::error::{FormulaError, FormulaErrorKind as ErrorKind};
use super::{Formula, Parameter, WrittenFormula, repair, syntax};

/// What an expression is, in the words of its errors.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Noun {
    /// Its name: `thickness`.
    pub(crate) name: &'static str,
    /// Beginning of the message about an unknown name, up to the name.
    pub(crate) unknown: &'static str,
    /// What it may use besides x, y and z.
    pub(crate) others: &'static str,
    /// Two examples, and an alternative to a condition in braces.
    pub(crate) examples: [&'static str; 3],
}

impl Formula {
    /// The function of an expression in x, y, z and `parameters`, evaluated as it is written;
    /// `text` becomes its text.
    ///
    /// # Errors
    ///
    /// Any of [`FormulaErrorKind`](super::FormulaErrorKind), with its span in bytes of `text`:
    /// `UnknownName` for a name that is not among `parameters`.
    pub(crate) fn expression(
        text: &str,
        parameters: &[Parameter],
        noun: &Noun,
    ) -> Result<Self, FormulaError> {
        let equation = expression(text, parameters, noun)?;
        let is_named = |parameter: &&Parameter| text.contains(&*parameter.name);
        let parameters: Vec<Parameter> = parameters.iter().filter(is_named).cloned().collect();
        let compiled = Compiled::new(&equation, &parameters)?;
        Ok(Self::of(WrittenFormula::new(text, equation, Vec::new()), parameters, compiled))
    }
}

/// The syntax tree of an expression in which every name is a parameter.
pub(super) fn expression(
    text: &str,
    parameters: &[Parameter],
    noun: &Noun,
) -> Result<Equation, FormulaError> {
    let Noun { name: what, unknown: no, others, examples: [number, formula, choice] } = *noun;
    let known: Vec<&str> = parameters.iter().map(|parameter| &*parameter.name).collect();
    let no_parameter = |name: &str| {
        let own = if known.is_empty() { "there is none".to_owned() } else { known.join(", ") };
        format!("{no} `{name}`: a {what} is made of x, y, z and {others} ({own})")
    };
    let read = syntax(text, &known).map_err(|error| repair::throughout(text, &known, error));
    let (parsed, unknown) = read.map_err(|error| match (&error.kind, &error.name) {
        (ErrorKind::Empty, _) => {
            let message =
                format!("A {what} is a number such as `{number}`, or a formula such as `{formula}`");
            FormulaError { message, ..error }
        }
        // A correction is suggested, but the name cannot become a slider.
        (_, Some(name)) => FormulaError { message: no_parameter(name), name: None, ..error },
        _ => error,
    })?;
    if let Some(colour) = parsed.colours.given.first() {
        let message = format!("A {what} has no colour: that belongs to the formula of the surface");
        return Err(FormulaError::new(ErrorKind::BadDefinition, colour.span.clone(), message));
    }
    if let Some(right) = &parsed.equation.right {
        let span = parsed.equation.left.span.end..right.span.end;
        let message = format!("A {what} has no `=`");
        return Err(FormulaError::new(ErrorKind::UnexpectedSymbol, span, message).suggest(""));
    }
    if let Some(condition) = parsed.equation.region.first() {
        let message = format!("A {what} has no condition in braces: `{choice}` chooses one");
        return Err(FormulaError::new(ErrorKind::UnexpectedSymbol, condition.span.clone(), message));
    }
    match parsed.names.into_iter().find(|(name, _)| unknown.contains(name)) {
        Some((name, span)) => Err(FormulaError::new(ErrorKind::UnknownName, span, no_parameter(&name))),
        None => Ok(parsed.equation),
    }
}
