//! LaTeX commands that a pasted formula may contain.

use super::token::{Bar, Comparison, Token};

/// The meaning of a LaTeX command.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum LatexCommand {
    /// No meaning: a space, or the size of what follows.
    Nothing,
    /// No meaning of its own. A `|` after it opens or closes, as the bar says.
    Side(Bar),
    /// The beginning of a name in braces.
    Word,
    /// The sign that two sides are not equal.
    Unequal,
    /// No meaning; skipped with the group in braces that follows.
    Label,
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

/// The Greek letter with this name, except π, τ and φ, which are constants.
pub(super) fn greek(name: &str) -> Option<&'static str> {
    GREEK.iter().find(|(known, _)| *known == name).map(|&(_, letter)| letter)
}

/// The meaning of the LaTeX command `word`, given without its backslash; none if the command is
/// unknown.
pub(super) fn command(word: &str) -> Option<LatexCommand> {
    let token = match word {
        "," | ";" | ":" | "!" | " " | "quad" | "qquad" | "displaystyle" | "textstyle" | "big" | "Big"
        | "bigg" | "Bigg" | "(" | ")" | "[" | "]" | "limits" | "\\" | "\n" | "\r" | "nonumber" => {
            return Some(LatexCommand::Nothing);
        }
        "left" | "bigl" | "Bigl" | "biggl" | "Biggl" => return Some(LatexCommand::Side(Bar::Opening)),
        "right" | "bigr" | "Bigr" | "biggr" | "Biggr" => return Some(LatexCommand::Side(Bar::Closing)),
        "operatorname" | "mathrm" | "text" | "mathit" => return Some(LatexCommand::Word),
        "ne" | "neq" => return Some(LatexCommand::Unequal),
        "begin" | "end" | "label" | "tag" => return Some(LatexCommand::Label),
        "lt" => Token::Compare(Comparison::Less),
        "gt" => Token::Compare(Comparison::Greater),
        "le" | "leq" | "leqslant" => Token::Compare(Comparison::AtMost),
        "ge" | "geq" | "geqslant" => Token::Compare(Comparison::AtLeast),
        "land" | "wedge" => Token::And,
        "lor" | "vee" => Token::Or,
        "lnot" | "neg" => Token::Not,
        "bmod" | "%" => Token::Percent,
        "lfloor" => Token::Open('⌊'),
        "rfloor" => Token::Close('⌋'),
        "lceil" => Token::Open('⌈'),
        "rceil" => Token::Close('⌉'),
        "frac" | "dfrac" | "tfrac" => Token::Fraction,
        "sqrt" => Token::Root,
        "cdot" | "times" | "ast" => Token::Star,
        "div" => Token::Slash,
        "vert" | "mid" => Token::Bar(Bar::Either),
        "lvert" => Token::Bar(Bar::Opening),
        "rvert" => Token::Bar(Bar::Closing),
        "{" => Token::Open('{'),
        "}" => Token::Close('}'),
        "sin" | "cos" | "tan" | "sec" | "csc" | "cot" | "sinh" | "cosh" | "tanh" | "coth" | "exp" | "ln"
        | "log" | "lg" | "min" | "max" | "pi" | "tau" | "phi" => Token::Name(word.into()),
        "varphi" => Token::Name("phi".into()),
        "arcsin" => Token::Name("asin".into()),
        "arccos" => Token::Name("acos".into()),
        "arctan" => Token::Name("atan".into()),
        "sgn" => Token::Name("sign".into()),
        _ => Token::Name(greek(word)?.into()),
    };
    Some(LatexCommand::Token(token))
}
