//! A formula as MathML.

use super::ast::Equation;

/// The equation as a `math` element.
pub(super) fn equation(equation: &Equation) -> String {
    let text = super::display::plain_equation(equation);
    let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    format!("<math display=\"block\"><mtext>{text}</mtext></math>")
}
