//! Names from other languages and books: functions with other names there, modules and vectors.

use super::ast::{Constant, Function};
use super::error::{FormulaError, FormulaErrorKind as ErrorKind};
use super::token::{Spanned, Token, slice};

/// Placeholders for the first and the second argument in [`call_elsewhere`], with their names in
/// messages. No formula has these characters.
const PLACES: [(char, &str); 2] = [('①', "a"), ('②', "b")];

/// The function that `name` means, with or without brackets after it.
pub(super) fn function(name: &str) -> Option<Function> {
    let name = match name {
        "sgn" | "signum" => "sign",
        "tg" => "tan",
        "ctg" | "cotg" | "cotan" => "cot",
        "cosec" => "csc",
        "arcsin" => "asin",
        "arccos" => "acos",
        "arctan" | "arctg" => "atan",
        "arcsinh" | "arsinh" => "asinh",
        "arccosh" | "arcosh" => "acosh",
        "arctanh" | "artanh" => "atanh",
        _ => name,
    };
    Function::find(name)
}

/// The function or the expression that a called name means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Called {
    Function(Function),
    /// a^b
    Power,
    /// a^2
    Square,
    /// The dot product of two vectors, of which the arguments list the components one after the
    /// other.
    Dot,
    /// The angle of the point (a, b).
    AngleOf,
}

/// Returns the meaning of a call of `name` with this opening bracket, as other programs write it.
/// Without a bracket most of these names may be parameters.
pub(super) fn called(name: &str, bracket: char) -> Option<Called> {
    // Mathematica writes `Sin[x]`.
    if bracket == '[' {
        match name {
            "Log" => return called("ln", bracket),
            "ArcTan" => return Some(Called::AngleOf),
            _ => {}
        }
    }
    let lower = name.to_ascii_lowercase();
    Some(Called::Function(match lower.as_str() {
        "pow" | "power" => return Some(Called::Power),
        "square" => return Some(Called::Square),
        "dot" => return Some(Called::Dot),
        "fabs" | "absolute" => return called("abs", bracket),
        "fmin" | "minimum" => return called("min", bracket),
        "fmax" | "maximum" => return called("max", bracket),
        "ceiling" => return called("ceil", bracket),
        "frac" => return called("fract", bracket),
        "cuberoot" => return called("cbrt", bracket),
        "length" | "norm" | "len" => return called("hypot", bracket),
        "lerp" => return called("mix", bracket),
        "clip" => return called("clamp", bracket),
        "where" | "ifelse" => return called("if", bracket),
        "arctan2" => return called("atan2", bracket),
        "sh" => return called("sinh", bracket),
        "ch" => return called("cosh", bracket),
        "th" => return called("tanh", bracket),
        lower => match function(lower) {
            Some(function) => function,
            // The functions of C in single precision, such as `sqrtf`.
            None => return called(lower.strip_suffix('f').filter(|rest| rest.len() > 2)?, bracket),
        },
    }))
}

/// How to write a call of `name`, which is no function here; several ways if it has several
/// meanings.
fn call_elsewhere(name: &str) -> Option<&'static [&'static str]> {
    Some(match name {
        "exp2" => &["2^①"],
        "exp10" => &["10^①"],
        "expm1" => &["exp(①) - 1"],
        "log1p" => &["ln(1 + ①)"],
        "cube" => &["①^3"],
        "abs2" => &["①^2"],
        "sqr" => &["①^2", "sqrt(①)"],
        "inversesqrt" | "rsqrt" => &["1/sqrt(①)"],
        "trunc" | "fix" => &["sign(①)*floor(abs(①))"],
        "fmod" | "rem" => &["① - ②*sign(①/②)*floor(abs(①/②))"],
        "rint" => &["round(①)"],
        "saturate" => &["clamp(①, 0, 1)"],
        "heaviside" => &["step(0, ①)"],
        "erfc" => &["1 - erf(①)"],
        "asec" | "arcsec" => &["acos(1/①)"],
        "acsc" | "arccsc" => &["asin(1/①)"],
        "acoth" | "arcoth" | "arccoth" => &["atanh(1/①)"],
        "acot" | "arccot" => &["atan(1/①)", "pi/2 - atan(①)"],
        "sind" => &["sin(①*pi/180)"],
        "cosd" => &["cos(①*pi/180)"],
        "tand" => &["tan(①*pi/180)"],
        "sinpi" => &["sin(pi*①)"],
        "cospi" => &["cos(pi*①)"],
        "sinc" => &["sin(①)/①", "sin(pi*①)/(pi*①)"],
        "radians" | "deg2rad" => &["①*pi/180"],
        "degrees" | "rad2deg" => &["①*180/pi"],
        _ => return None,
    })
}

/// Functions of other languages without a counterpart here; no name is suggested for them.
const UNKNOWN: &[&str] = &[
    "gamma", "tgamma", "lgamma", "beta", "zeta", "besselj", "bessely", "airy", "nthroot", "surd", "sum",
    "prod", "mean", "diff", "noise", "snoise", "perlin", "rand", "random", "hash", "real", "imag", "conj",
    "arg", "sigmoid", "softplus", "relu", "any", "all",
];

/// Functions that make grids and pictures, in lower case.
const PROGRAM: &[&str] = &[
    "meshgrid",
    "ndgrid",
    "linspace",
    "mgrid",
    "contour3d",
    "contourplot",
    "contourplot3d",
    "densityplot3d",
    "ezplot3",
    "ezsurf",
    "fimplicit",
    "fimplicit3",
    "fsurf",
    "implicit_plot",
    "implicit_plot3d",
    "implicitplot",
    "implicitplot3d",
    "implicitregion",
    "isosurface",
    "marching_cubes",
    "parametric_plot3d",
    "parametricplot3d",
    "plot",
    "plot3d",
    "plot_implicit",
    "print",
    "regionplot",
    "regionplot3d",
    "revolutionplot3d",
    "slicecontourplot3d",
    "sphericalplot3d",
    "splot",
];

/// Whether `name` is a function that makes grids or pictures.
pub(super) fn is_program(name: &str) -> bool {
    PROGRAM.contains(&name.to_ascii_lowercase().as_str())
}

/// The error for a formula inside a call that makes grids or pictures.
pub(super) fn formula_alone(name: &str, span: core::ops::Range<usize>) -> FormulaError {
    FormulaError::new(ErrorKind::UnknownFunction, span, format!("Type the formula alone, without `{name}`"))
}

fn is_of_vectors(name: &str) -> bool {
    is_vector(name)
        || matches!(
            name,
            "dot" | "cross" | "normalize" | "reflect" | "refract" | "transpose" | "mat2" | "mat3" | "mat4"
        )
}

/// Whether a call of `name` makes a vector.
pub(super) fn is_vector(name: &str) -> bool {
    matches!(name, "vec2" | "vec3" | "vec4" | "float2" | "float3" | "float4" | "Vector" | "Vector3" | "array")
}

/// The error message for a formula that contains a vector.
pub(super) const NO_VECTORS: &str =
    "There are no vectors: write coordinates, such as `hypot(x, z)` for the length of (x, z)";

/// Whether `name` is a function in another language, and so hardly the name of a defined f.
pub(super) fn is_elsewhere(name: &str) -> bool {
    let lower = name.to_ascii_lowercase();
    called(name, '(').is_some()
        || call_elsewhere(name).is_some()
        || is_of_vectors(name)
        || matches!(name, "log" | "lg")
        || is_program(name)
        || UNKNOWN.contains(&lower.as_str())
}

/// The error for a name that means several logarithms, at this place; none for another name.
pub(super) fn logarithm(name: &str, span: core::ops::Range<usize>) -> Option<FormulaError> {
    let (choices, meanings) = match name {
        "log" | "Log" | "LOG" => (
            &["ln", "log10", "log2"][..],
            "`ln` is the natural one, `log10` and `log2` are those to base 10 and 2",
        ),
        "lg" => (&["log10", "log2"][..], "`log10` and `log2` are those to base 10 and 2"),
        _ => return None,
    };
    let message = format!("`{name}` means several logarithms: {meanings}");
    let error = FormulaError::new(ErrorKind::UnknownFunction, span, message);
    Some(error.choose(choices.iter().map(|&choice| choice.to_owned())))
}

/// The error for a call that is written differently here, of the name at token `at` before a
/// bracket; none for other calls.
pub(super) fn call_error(text: &str, tokens: &[Spanned], at: usize) -> Option<FormulaError> {
    let Spanned { token: Token::Name(name), span } = &tokens[at] else { return None };
    let error = |message: String| FormulaError::new(ErrorKind::UnknownFunction, span.clone(), message);
    let lower = name.to_ascii_lowercase();
    if let Some(error) = logarithm(name, span.clone()) {
        return Some(error);
    }
    if is_of_vectors(name) {
        return Some(error(NO_VECTORS.into()));
    }
    if is_program(name) {
        return Some(formula_alone(name, span.clone()));
    }
    if UNKNOWN.contains(&lower.as_str()) {
        return Some(error(format!(
            "There is no function `{name}` here: define it first, as in `{name}(a) = …;`"
        )));
    }
    let written = call_elsewhere(&lower)?;
    let example = |way: &str| {
        let filled = PLACES.iter().fold(way.to_owned(), |done, &(place, letter)| done.replace(place, letter));
        format!("`{filled}`")
    };
    let ways: Vec<String> = written.iter().map(|way| example(way)).collect();
    let message = format!("There is no function `{name}`: write {}", ways.join(" or "));
    let (arguments, close) = arguments(text, tokens, at + 1)?;
    let wanted = PLACES.iter().filter(|(place, _)| written[0].contains(*place)).count();
    if arguments.len() != wanted {
        return Some(error(message));
    }
    let before = at.checked_sub(1).map(|before| &tokens[before].token);
    let is_term = matches!(before, None | Some(Token::Plus | Token::Open(_) | Token::Comma | Token::Equals))
        && matches!(
            tokens[close + 1].token,
            Token::End | Token::Plus | Token::Minus | Token::Close(_) | Token::Comma | Token::Equals
        );
    let filled = |way: &str| {
        let filled = PLACES
            .iter()
            .zip(&arguments)
            .fold(way.to_owned(), |done, (&(place, _), argument)| done.replace(place, &as_operand(argument)));
        if is_term { filled } else { format!("({filled})") }
    };
    let whole = FormulaError::new(ErrorKind::UnknownFunction, span.start..tokens[close].span.end, message);
    Some(match written {
        [only] => whole.suggest(filled(only)),
        several => whole.choose(several.iter().map(|way| filled(way))),
    })
}

/// The arguments, as written, in the bracket that token `open` opens, and the token that closes it.
/// None without a bracket; no arguments if it is not closed.
fn arguments<'a>(text: &'a str, tokens: &[Spanned], open: usize) -> Option<(Vec<&'a str>, usize)> {
    let mut depth = 0_usize;
    let mut list = Vec::new();
    let mut start = tokens[open].span.end;
    for (k, Spanned { token, span }) in tokens.iter().enumerate().skip(open) {
        match token {
            Token::Open(_) => depth += 1,
            Token::Close(_) => depth = depth.saturating_sub(1),
            _ => {}
        }
        let is_last = depth == 0;
        if is_last || *token == Token::Comma && depth == 1 {
            list.push(slice(text, &(start..span.start)).trim());
            start = span.end;
        }
        if is_last {
            let is_closed = k > open;
            return is_closed
                .then(|| (if list.iter().all(|item| !item.is_empty()) { list } else { Vec::new() }, k));
        }
    }
    Some((Vec::new(), open))
}

/// `argument` in brackets, unless it is one word or number.
fn as_operand(argument: &str) -> String {
    let is_one = argument.chars().all(|c| c.is_alphanumeric() || c == '_' || c == '.');
    if is_one { argument.to_owned() } else { format!("({argument})") }
}

/// The error for components of a vector, as in `p.x` and `length(p.xz)`, where byte `point` is the
/// point after a name; none for anything else.
pub(super) fn component_error(text: &str, tokens: &[Spanned], point: usize) -> Option<FormulaError> {
    let [before @ .., Spanned { token: Token::Name(name), span }] = tokens else { return None };
    let components: String = text.get(point + 1..)?.chars().take_while(|c| c.is_alphanumeric()).collect();
    let is_component = |c: char| matches!(c, 'x' | 'y' | 'z');
    if span.end != point || !matches!(components.len(), 1..=3) || !components.chars().all(is_component) {
        return None;
    }
    let span = span.start..point + 1 + components.len();
    let apart: Vec<String> = components.chars().map(String::from).collect();
    // Several components are the arguments of a length.
    let is_length = match before {
        [.., Spanned { token: Token::Name(function), .. }, Spanned { token: Token::Open('('), .. }] => {
            is_vector(function) || called(function, '(') == Some(Called::Function(Function::Hypot))
        }
        _ => false,
    };
    let written = apart.join(", ");
    let message = format!("There are no vectors: write `{written}` in place of `{name}.{components}`");
    let error = FormulaError::new(ErrorKind::UnexpectedSymbol, span, message);
    Some(if is_length || apart.len() == 1 { error.suggest(written) } else { error })
}

/// Whether `name` is a module, whose functions are written `np.sin` or `std::sin`.
pub(super) fn is_module(name: &str) -> bool {
    matches!(
        name,
        "np" | "numpy"
            | "jnp"
            | "math"
            | "Math"
            | "cmath"
            | "sp"
            | "sympy"
            | "scipy"
            | "special"
            | "linalg"
            | "torch"
            | "tf"
            | "std"
            | "glm"
    )
}

/// The name here of the function or the constant that a module calls `name`.
pub(super) fn member(name: &str) -> Option<String> {
    let lower = name.to_ascii_lowercase();
    match lower.as_str() {
        "log" => Some("ln".into()),
        lower if Constant::find(lower).is_some() || is_elsewhere(lower) => Some(lower.into()),
        _ => None,
    }
}
