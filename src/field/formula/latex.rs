//! The commands of LaTeX that a formula may have, as it is pasted from a text.

use super::elsewhere::name_elsewhere;
use super::token::{Bar, Token};

/// The meaning of a LaTeX command.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum LatexCommand {
    /// No meaning: a space, or the size of what follows.
    Nothing,
    /// No meaning of its own. A `|` after it opens or closes, as the bar says.
    Side(Bar),
    /// The beginning of a name in braces.
    Word,
    /// The sign of an inequality.
    Comparison(char),
    /// A token of the formula language.
    Token(Token),
}

/// Greek letters by their names, which are the commands of LaTeX.
const GREEK: &[(&str, &str)] = &[
    ("alpha", "α"),
    ("beta", "β"),
    ("gamma", "γ"),
    ("delta", "δ"),
    ("epsilon", "ε"),
    ("varepsilon", "ε"),
    ("zeta", "ζ"),
    ("eta", "η"),
    ("theta", "θ"),
    ("vartheta", "θ"),
    ("iota", "ι"),
    ("kappa", "κ"),
    ("lambda", "λ"),
    ("mu", "μ"),
    ("nu", "ν"),
    ("xi", "ξ"),
    ("rho", "ρ"),
    ("sigma", "σ"),
    ("upsilon", "υ"),
    ("chi", "χ"),
    ("psi", "ψ"),
    ("omega", "ω"),
    ("Gamma", "Γ"),
    ("Delta", "Δ"),
    ("Theta", "Θ"),
    ("Lambda", "Λ"),
    ("Xi", "Ξ"),
    ("Pi", "Π"),
    ("Sigma", "Σ"),
    ("Upsilon", "Υ"),
    ("Phi", "Φ"),
    ("Psi", "Ψ"),
    ("Omega", "Ω"),
];

/// The Greek letter with this name, but for π, τ and φ, which are constants.
pub(super) fn greek(name: &str) -> Option<&'static str> {
    GREEK.iter().find(|(known, _)| *known == name).map(|&(_, letter)| letter)
}

/// The meaning of the LaTeX command `word`, given without its backslash; none if the command is unknown.
pub(super) fn command(word: &str) -> Option<LatexCommand> {
    let token = match word {
        "," | ";" | ":" | "!" | " " | "quad" | "qquad" | "displaystyle" | "textstyle" | "big" | "Big"
        | "bigg" | "Bigg" | "(" | ")" | "[" | "]" | "limits" => return Some(LatexCommand::Nothing),
        "left" | "bigl" | "Bigl" | "biggl" | "Biggl" => return Some(LatexCommand::Side(Bar::Opening)),
        "right" | "bigr" | "Bigr" | "biggr" | "Biggr" => return Some(LatexCommand::Side(Bar::Closing)),
        "operatorname" | "mathrm" | "text" | "mathit" => return Some(LatexCommand::Word),
        "lt" | "le" | "leq" | "leqslant" => return Some(LatexCommand::Comparison('<')),
        "gt" | "ge" | "geq" | "geqslant" => return Some(LatexCommand::Comparison('>')),
        "ne" | "neq" => return Some(LatexCommand::Comparison('≠')),
        "frac" | "dfrac" | "tfrac" => Token::Fraction,
        "sqrt" => Token::Root,
        "cdot" | "times" | "ast" => Token::Star,
        "div" => Token::Slash,
        "vert" | "mid" => Token::Bar(Bar::Either),
        "lvert" => Token::Bar(Bar::Opening),
        "rvert" => Token::Bar(Bar::Closing),
        "{" => Token::Open('{'),
        "}" => Token::Close('}'),
        "sin" | "cos" | "tan" | "sinh" | "cosh" | "tanh" | "exp" | "ln" | "log" | "lg" | "min" | "max"
        | "pi" | "tau" | "phi" => Token::Name(word.into()),
        "varphi" => Token::Name("phi".into()),
        "arcsin" | "arccos" | "arctan" | "sgn" => Token::Name(name_elsewhere(word)?.into()),
        _ => Token::Name(greek(word)?.into()),
    };
    Some(LatexCommand::Token(token))
}
