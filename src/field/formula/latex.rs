//! The commands of LaTeX that a formula may have, as it is pasted from a text.

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

/// Functions and constants by their commands.
const NAMES: &[(&str, &str)] = &[
    ("sin", "sin"),
    ("cos", "cos"),
    ("tan", "tan"),
    ("sinh", "sinh"),
    ("cosh", "cosh"),
    ("tanh", "tanh"),
    ("arcsin", "asin"),
    ("arccos", "acos"),
    ("arctan", "atan"),
    ("exp", "exp"),
    ("ln", "ln"),
    ("log", "log"),
    ("lg", "lg"),
    ("min", "min"),
    ("max", "max"),
    ("sgn", "sign"),
    ("pi", "pi"),
    ("tau", "tau"),
    ("phi", "phi"),
    ("varphi", "phi"),
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
        _ => {
            let (_, name) = NAMES.iter().find(|(latex, _)| *latex == word)?;
            Token::Name((*name).into())
        }
    };
    Some(LatexCommand::Token(token))
}
