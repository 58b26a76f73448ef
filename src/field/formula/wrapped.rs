//! Formulas within the calls that draw them in other programs, such as `implicit_plot3d(f, (x, -2,
//! 2), …)`, `ContourPlot3D[f == 0, {x, -2, 2}, …]` and `With[{R = 1}, …]`. Such a text is refused,
//! and the formula is suggested, with the definitions that it needs.
//!
//! A call draws if other arguments are ranges of variables, or if an argument is a function without
//! a name, whatever the call's name is; otherwise if its name is known.

use super::ast::{COORDINATES, Equation, ExprKind};
use super::elsewhere::{self, is_program};
use super::error::{FormulaError, FormulaErrorKind as ErrorKind};
use super::lex::is_name;
use super::spelling::is_known;
use super::{MAX_FORMULA_BYTES, syntax};
use core::ops::Range;

/// Calls around the call that draws.
const HOLDERS: &[&str] = &[
    "animate",
    "display",
    "display3d",
    "draw",
    "draw3d",
    "evaluate",
    "manipulate",
    "plot",
    "quiet",
    "show",
    "simplify",
    "wxdraw3d",
];

/// Calls that define constants for their contents: `With[{R = 1}, …]`.
const SCOPES: &[&str] = &["With", "Module", "Block"];

/// Options that name the level of the surface.
const LEVELS: &[&str] = &["contours", "contour", "level", "levels", "isovalue", "threshold"];

/// Options with which the formula alone is not the surface: they limit it, or name coordinates.
const OTHERS: &[&str] = &["regionfunction", "region", "coords", "transformation"];

/// Parts of the names of calls whose variables are not x, y and z.
const CURVED: &[&str] = &["spherical", "revolution", "polar", "cylindrical"];

/// Maximum nesting of calls.
const DEEPEST: usize = 8;

/// The error for a text that draws a formula; none for another text.
pub(super) fn error(text: &str, declared: &[&str]) -> Option<FormulaError> {
    let plain = plain(text);
    if let Some(head) = function_with_body(&plain) {
        let message = format!(
            "`{}` is a function with a body in braces, which is not read: write its value by x, y and z, as \
             `length(vec3(x, y, z)) - 1` for `length(p) - 1.0`",
            text[head.clone()].trim()
        );
        return Some(FormulaError::new(ErrorKind::UnexpectedSymbol, head, message));
    }
    let all = statements(&plain);
    let path = || FormulaError::new(ErrorKind::UnexpectedSymbol, 0..text.trim_end().len(), NO_PATHS);
    let found = all.iter().enumerate().find_map(|(at, statement)| {
        let statement = without_assignment(&plain, statement.clone());
        Some((at, unwrapped(Source { text, plain: &plain }, statement, DEEPEST)?))
    });
    let Some((at, found)) = found else { return is_path(&plain, &all).then(path) };
    let message = match found.kind {
        Kind::Path => return Some(path()),
        Kind::Surface => format!("Type the formula alone, without `{}`", found.name),
    };
    let error = FormulaError::new(ErrorKind::UnknownFunction, 0..text.trim_end().len(), message);
    let earlier: Vec<&str> = all[..at].iter().map(|range| text[range.clone()].trim()).collect();
    let ways: Vec<String> =
        found.formulas.iter().filter_map(|formula| mended(&earlier, &found, formula, declared)).collect();
    Some(match &ways[..] {
        [only] => error.suggest(only.clone()),
        several => error.choose(several.iter().cloned()),
    })
}

/// The head of the first function with a body in braces, such as `float f(vec3 p)`, `fn f(p: vec3f)
/// -> f32` and `function f(x, y, z)`.
fn function_with_body(plain: &str) -> Option<Range<usize>> {
    let mut found = None;
    walk(plain, 0..plain.len(), |at, c, depth| {
        if c != '{' || depth > 0 || found.is_some() {
            return;
        }
        let before = plain[..at].trim_end();
        let before = match before.rsplit_once("->") {
            Some((before, kind)) if is_name(kind.trim()) => before.trim_end(),
            _ => before,
        };
        let Some(open) = before.ends_with(')').then(|| before.rfind('(')).flatten() else { return };
        let line = plain[..open].rfind(['\n', ';', '}']).map_or(0, |end| end + 1);
        let words: Vec<&str> = plain[line..open].split_whitespace().collect();
        if words.len() > 1 && words.iter().all(|word| is_name(word)) {
            found = Some(trimmed(plain, line..at));
        }
    });
    found
}

/// The error message for a surface that is given by its points.
const NO_PATHS: &str = "Equations are drawn, not surfaces or curves given by parameters. Eliminate these, as in \
     `x^2 + y^2 = 1` for (cos(u), sin(u), v), or compute points elsewhere and open them as a file";

/// The error for a coordinate along a path, such as `x(t) = t`, which reads as a product.
pub(super) fn one_path(text: &str) -> Option<FormulaError> {
    let plain = plain(text);
    let is_one = statements(&plain).into_iter().any(|range| is_coordinate(&plain[range]));
    is_one.then(|| FormulaError::new(ErrorKind::UnexpectedSymbol, 0..text.trim_end().len(), NO_PATHS))
}

/// Whether a statement gives a coordinate by parameters: `x(t) = t`.
fn is_coordinate(statement: &str) -> bool {
    let Some((head, value)) = assignment(statement).map(|at| statement.split_at(at)) else { return false };
    let call = head.trim().strip_suffix(')').and_then(|call| call.split_once('('));
    let Some((name, arguments)) = call else { return false };
    let is_argument = |argument: &str| is_name(argument) && mentions(value, argument);
    COORDINATES.contains(&name.trim())
        && arguments.split(',').map(str::trim).all(is_argument)
        && !COORDINATES.iter().any(|axis| mentions(arguments, axis) || mentions(value, axis))
}

/// Whether a text gives the points of a surface: `x = cos(u), y = sin(u), z = v`, or at last
/// `(cos(u), sin(u), v)`.
fn is_path(plain: &str, all: &[Range<usize>]) -> bool {
    let Some(last) = all.last() else { return false };
    let axis_of = |part: Range<usize>| {
        let statement = &plain[part];
        let head = &statement[..assignment(statement)?];
        let name = head.find('(').map_or(head, |open| &head[..open]).trim();
        COORDINATES.into_iter().find(|axis| name == *axis)
    };
    let named = all.iter().flat_map(|range| parts(plain, range.clone(), &[","])).filter_map(axis_of);
    let mut named: Vec<&str> = named.collect();
    named.dedup();
    let value = match assignment(&plain[last.clone()]) {
        Some(at) => last.start + at + 1..last.end,
        None => last.clone(),
    };
    let has_axis = || COORDINATES.iter().any(|axis| mentions(&plain[value.clone()], axis));
    // Three numbers without brackets, such as `cos u, sin u, v`, and `x = cos t y = sin t z = t`.
    let bare = parts(plain, value.clone(), &[","]);
    let varies = |part: &Range<usize>| plain[part.clone()].contains(char::is_alphabetic);
    named.len() > 1
        || all.iter().any(|range| is_coordinate(&plain[range.clone()]))
        || matches!(listed(plain, &value).len(), 2 | 3)
        || bare.len() == 3 && bare.iter().all(varies) && !has_axis()
        || COORDINATES.iter().all(|axis| is_assigned(plain, axis))
}

/// Whether a text contains `name =`, but not as in `a = name = b`.
fn is_assigned(text: &str, name: &str) -> bool {
    text.match_indices(name).any(|(at, _)| {
        let (before, after) = (&text[..at], text[at + name.len()..].trim_start());
        !before.ends_with(is_of_name) && !before.trim_end().ends_with('=') && after.starts_with('=')
    })
}

/// A text, and the same bytes with comments and quoted words blanked out.
#[derive(Clone, Copy)]
struct Source<'a> {
    text: &'a str,
    plain: &'a str,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Surface,
    /// Points that follow parameters.
    Path,
}

/// What a call draws.
struct Drawn {
    /// The name of the call.
    name: String,
    kind: Kind,
    /// The formula, or several that are drawn together; none where it is not known.
    formulas: Vec<String>,
    /// Names and their values.
    definitions: Vec<(String, String)>,
}

/// The formula with those definitions that it needs, if that can be read.
fn mended(earlier: &[&str], drawn: &Drawn, formula: &str, declared: &[&str]) -> Option<String> {
    let earlier: Vec<String> = earlier.iter().map(|statement| without_return(statement)).collect();
    let own: Vec<String> =
        drawn.definitions.iter().map(|(name, value)| format!("{name} = {value}")).collect();
    let all: Vec<&str> = earlier.iter().chain(&own).map(String::as_str).collect();
    // A side that is only a name may name a function.
    let ways = ["(x, y, z)", "(x, y)", ""].map(|arguments| {
        let called = |side: &str| match is_name(side) && !COORDINATES.contains(&side) {
            true => format!("{side}{arguments}"),
            false => side.to_owned(),
        };
        formula.split(" = ").map(called).collect::<Vec<_>>().join(" = ")
    });
    ways.into_iter().find_map(|way| {
        let mut whole = way;
        for statement in all.iter().rev() {
            if let Some(name) = defined(statement)
                && mentions(&whole, name)
            {
                whole = format!("{statement}; {whole}");
            }
        }
        let is_short = whole.len() <= MAX_FORMULA_BYTES;
        // An ellipsis is for the user to fill in.
        let is_read = match syntax(&whole.replace('…', "1"), declared) {
            Ok((parsed, _)) => varies(&parsed.equation),
            // Another mistake gets its own correction.
            Err(error) => error.suggestion.is_some() || !error.choices.is_empty(),
        };
        (is_short && is_read).then_some(whole)
    })
}

/// `def f(x): return a` of Python as `f(x) = a`; another statement as it is.
fn without_return(statement: &str) -> String {
    let function = statement.strip_prefix("def ").and_then(|rest| rest.split_once(':'));
    match function.and_then(|(head, body)| Some((head, body.trim().strip_prefix("return ")?))) {
        Some((head, body)) => format!("{} = {}", head.trim(), body.trim()),
        None => statement.to_owned(),
    }
}

/// Whether an equation holds a coordinate.
fn varies(equation: &Equation) -> bool {
    let parts = equation.definitions.iter().map(|definition| &definition.body);
    parts
        .chain([&equation.left])
        .chain(&equation.right)
        .any(|part| part.any(&|kind| matches!(kind, ExprKind::Coordinate(_))))
}

/// The name that a statement defines.
fn defined(statement: &str) -> Option<&str> {
    let head = match statement.trim().strip_prefix("def ") {
        Some(rest) => rest,
        None => statement[..assignment(statement)?].trim_end_matches(':'),
    };
    let name = head.find(['(', '[']).map_or(head, |open| &head[..open]).trim();
    Some(name).filter(|name| is_name(name) && !is_known(name))
}

fn is_of_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Whether `name` occurs in `text` as a whole word.
fn mentions(text: &str, name: &str) -> bool {
    text.match_indices(name)
        .any(|(at, _)| !text[..at].ends_with(is_of_name) && !text[at + name.len()..].starts_with(is_of_name))
}

/// The text with each byte of comments and quotations replaced by a blank.
fn plain(text: &str) -> String {
    let mut plain = text.as_bytes().to_vec();
    let mut at = 0;
    let mut blank = |range: Range<usize>| {
        plain[range].iter_mut().filter(|byte| **byte != b'\n').for_each(|byte| *byte = b' ');
    };
    while let Some(c) = text[at..].chars().next() {
        let rest = &text[at..];
        let line = || rest.find('\n').unwrap_or(rest.len());
        let before = text[..at].trim_end_matches([' ', '\t']);
        let begins = before.is_empty() || before.ends_with(['\n', ';']);
        let length = if rest.starts_with("//") && !before.ends_with([')', ']'])
            || c == '#'
            || c == '%' && begins && !rest[1..].starts_with(|c: char| c.is_ascii_alphabetic())
        {
            line()
        } else if rest.starts_with("(*") || rest.starts_with("/*") {
            let end = if c == '(' { "*)" } else { "*/" };
            rest[2..].find(end).map_or(rest.len(), |end| end + 4)
        } else if matches!(c, '"' | '\'') && (begins || before.ends_with(['(', '[', '{', ',', '=', ':', '>']))
        {
            rest[1..line().max(1)].find(c).map_or(0, |end| end + 2)
        } else {
            0
        };
        if length > 0 {
            blank(at..at + length);
            at += length;
        } else {
            at += c.len_utf8();
        }
    }
    // Whole characters were replaced by as many blanks as they have bytes.
    String::from_utf8(plain).unwrap_or_default()
}

/// Calls `visit` with each character, its place and the number of brackets around it; a bracket
/// does not count itself.
fn walk(plain: &str, range: Range<usize>, mut visit: impl FnMut(usize, char, usize)) {
    let mut depth = 0_usize;
    for (at, c) in plain[range.clone()].char_indices() {
        if matches!(c, ')' | ']' | '}') {
            depth = depth.saturating_sub(1);
        }
        visit(range.start + at, c, depth);
        if matches!(c, '(' | '[' | '{') {
            depth += 1;
        }
    }
}

/// The parts of a range between these separators outside brackets.
fn parts(plain: &str, range: Range<usize>, separators: &[&str]) -> Vec<Range<usize>> {
    let (mut found, mut start) = (Vec::new(), range.start);
    walk(plain, range.clone(), |at, _, depth| {
        if depth == 0
            && at >= start
            && let Some(separator) =
                separators.iter().find(|separator| plain[at..range.end].starts_with(**separator))
        {
            found.push(start..at);
            start = at + separator.len();
        }
    });
    found.push(start..range.end);
    found
}

/// The statements of a text: they end at a `;`, or with a line that is complete.
fn statements(plain: &str) -> Vec<Range<usize>> {
    let (mut found, mut start) = (Vec::new(), 0);
    walk(plain, 0..plain.len(), |at, c, depth| {
        let goes_on = || {
            let signs = ['+', '-', '*', '/', '^', '=', ','];
            plain[..at].trim_end().ends_with(|c| c == ':' || signs.contains(&c))
                || plain[at..].trim_start().starts_with(|c| c == ')' || signs.contains(&c))
        };
        // Maple ends a statement with a colon.
        let is_colon = c == ':'
            && plain[at + 1..].starts_with([' ', '\n'])
            && !["def ", "lambda ", "?"].iter().any(|word| plain[start..at].contains(word));
        if depth == 0 && (c == ';' || is_colon || c == '\n' && !goes_on()) {
            found.push(start..at);
            start = at + 1;
        }
    });
    found.push(start..plain.len());
    found.retain(|range| !plain[range.clone()].trim().is_empty());
    found
}

/// The place of the first `=` outside brackets that is no comparison and no arrow.
fn assignment(plain: &str) -> Option<usize> {
    let mut found = None;
    walk(plain, 0..plain.len(), |at, c, depth| {
        let is_sign = c == '='
            && depth == 0
            && !plain[at + 1..].starts_with(['=', '>'])
            && !plain[..at].ends_with(['=', '<', '>', '!', '~', '/']);
        found = found.or(is_sign.then_some(at));
    });
    found
}

/// The right side of an assignment to names, `plot = …`, or the statement.
fn without_assignment(plain: &str, range: Range<usize>) -> Range<usize> {
    let statement = &plain[range.clone()];
    match assignment(statement) {
        Some(at) if statement[..at].trim_end_matches(':').split(',').all(|name| is_name(name.trim())) => {
            range.start + at + 1..range.end
        }
        _ => range,
    }
}

/// The range without blanks at its ends.
fn trimmed(plain: &str, range: Range<usize>) -> Range<usize> {
    let inside = &plain[range.clone()];
    let start = range.start + (inside.len() - inside.trim_start().len());
    start..(range.start + inside.trim_end().len()).max(start)
}

/// A call: its name, its arguments, and the text after it.
struct Call {
    name: String,
    bracket: char,
    arguments: Vec<Range<usize>>,
    inside: Range<usize>,
    rest: Range<usize>,
}

/// The arguments in a range; the commas of a `lambda` separate none.
fn arguments(plain: &str, inside: Range<usize>) -> Vec<Range<usize>> {
    let mut all: Vec<Range<usize>> = Vec::new();
    for part in parts(plain, inside, &[","]) {
        match all.last_mut() {
            Some(last) if is_begun(&plain[last.clone()]) => last.end = part.end,
            _ => all.push(part),
        }
    }
    all
}

/// Whether a `lambda` has no value yet.
fn is_begun(written: &str) -> bool {
    let from = written.rfind("lambda ");
    from.is_some_and(|at| !written[at..].contains(':'))
}

/// The place of the bracket that closes the one at `open`.
fn closing(plain: &str, open: usize, end: usize) -> Option<usize> {
    let mut close = None;
    walk(plain, open..end, |at, c, depth| {
        close = close.or((depth == 0 && matches!(c, ')' | ']' | '}')).then_some(at));
    });
    close
}

/// The call that a range begins with: `Show[…]`, `plots[implicitplot3d](…)`, `np.show(…)`.
fn call(plain: &str, range: Range<usize>) -> Option<Call> {
    let range = trimmed(plain, range);
    let open = range.start + plain[range.clone()].find(['(', '[', '{'])?;
    let bracket = plain[open..].chars().next()?;
    let path = plain[range.start..open].trim();
    let name = path.rsplit(['.', ':', '-']).next()?.trim();
    if !is_name(name) || path.contains(|c: char| !is_of_name(c) && !matches!(c, '.' | ':' | '-')) {
        return None;
    }
    let close = closing(plain, open, range.end)?;
    let after = &plain[close + 1..range.end];
    if bracket == '[' && after.starts_with('(') && is_name(plain[open + 1..close].trim()) {
        let end = closing(plain, close + 1, range.end)?;
        let inside = close + 2..end;
        let arguments = arguments(plain, inside.clone());
        let name = plain[open + 1..close].trim().to_owned();
        return Some(Call { name, bracket: '(', arguments, inside, rest: end + 1..range.end });
    }
    let inside = open + 1..close;
    let arguments = arguments(plain, inside.clone());
    Some(Call { name: name.to_owned(), bracket, arguments, inside, rest: close + 1..range.end })
}

/// What the text in a range draws, if anything.
fn unwrapped(source: Source<'_>, range: Range<usize>, depth: usize) -> Option<Drawn> {
    let plain = source.plain;
    let depth = depth.checked_sub(1)?;
    if let Some(with_rules) = replaced(source, &range, |whole| unwrapped(source, whole, depth)) {
        return Some(with_rules);
    }
    let Some(Call { name, bracket, arguments, inside, rest }) = call(plain, range.clone()) else {
        return typed_command(source, range);
    };
    if !(plain[rest.clone()].trim().is_empty() || plain[rest].trim().starts_with(['.', ':', '$'])) {
        return typed_command(source, range);
    }
    if SCOPES.contains(&name.as_str()) && bracket == '[' {
        let (names, body) = (arguments.first()?, arguments.get(1)?.start..inside.end);
        let mut own = bindings(&plain[names.clone()]);
        let inner = unwrapped(source, body.clone(), depth);
        let drawn = inner.unwrap_or_else(|| surface(&name, vec![source.text[body].trim().to_owned()]));
        own.extend(drawn.definitions);
        return Some(Drawn { definitions: own, ..drawn });
    }
    let lower = name.to_ascii_lowercase();
    let held = || arguments.iter().find_map(|argument| unwrapped(source, argument.clone(), depth));
    match HOLDERS.contains(&lower.as_str()).then(held).flatten() {
        None if lower == "isosurface" && bracket == '{' => povray(source, &inside),
        None => drawing(source, &name, &arguments),
        held => held,
    }
}

/// What `f /. {a -> 1}` draws, where `inner` gives what f draws: replaced names become definitions.
fn replaced(
    source: Source<'_>,
    range: &Range<usize>,
    inner: impl FnOnce(Range<usize>) -> Option<Drawn>,
) -> Option<Drawn> {
    let Source { text, plain } = source;
    let [whole, rules] = &parts(plain, range.clone(), &["/."])[..] else { return None };
    // `x/.5` is a quotient.
    if plain[rules.clone()].starts_with(|c: char| c.is_ascii_digit()) {
        return None;
    }
    let formula = || surface("/.", vec![text[whole.clone()].trim().to_owned()]);
    let mut drawn = inner(whole.clone()).unwrap_or_else(formula);
    drawn.definitions.extend(bindings(&plain[rules.clone()]));
    Some(drawn)
}

fn surface(name: &str, formulas: Vec<String>) -> Drawn {
    Drawn { name: name.to_owned(), kind: Kind::Surface, formulas, definitions: Vec::new() }
}

/// `splot x*y`, and `plot z = x*y` as people type it.
fn typed_command(source: Source<'_>, range: Range<usize>) -> Option<Drawn> {
    let range = trimmed(source.plain, range);
    let written = source.text[range].trim_end_matches(['$', ':']);
    let (name, formula) = written.split_once(char::is_whitespace)?;
    let formula = formula.trim();
    let is_command = is_program(name) && formula.starts_with(|c: char| is_of_name(c) || "(-|[".contains(c));
    is_command.then(|| {
        let is_height = assignment(formula).is_none() && !formula.contains("==") && !mentions(formula, "z");
        surface(name, vec![if is_height { format!("z = {formula}") } else { formula.to_owned() }])
    })
}

/// `isosurface { function { f } threshold 1 … }` of POV-Ray.
fn povray(source: Source<'_>, inside: &Range<usize>) -> Option<Drawn> {
    let Source { text, plain } = source;
    let open = inside.start + plain[inside.clone()].find("function")?;
    let open = open + plain[open..inside.end].find('{')?;
    let close = closing(plain, open, inside.end)?;
    let formula = text[open + 1..close].trim();
    let threshold =
        plain[inside.clone()].split("threshold").nth(1).and_then(|rest| rest.split_whitespace().next());
    let level = threshold.filter(|level| level.parse::<f64>().is_ok_and(|level| level != 0.0));
    Some(surface(
        "isosurface",
        vec![level.map_or(formula.to_owned(), |level| format!("{formula} = {level}"))],
    ))
}

/// Names and their values in `{a = 1, b = 2}`, `{a -> 1}` or `a -> 1`.
fn bindings(list: &str) -> Vec<(String, String)> {
    let list = list.trim();
    let inside = match closing(list, 0, list.len()) {
        Some(close) if list.starts_with('{') => 1..close,
        _ => 0..list.len(),
    };
    let found = parts(list, inside, &[","]).into_iter().filter_map(|range| {
        let written = &list[range];
        let (name, value) = written.split_once("->").or_else(|| written.split_once('='))?;
        let name = name.trim().trim_end_matches(':').trim();
        is_name(name).then(|| (name.to_owned(), value.trim().to_owned()))
    });
    found.collect()
}

/// A function without a name: its arguments and the place of its value.
fn nameless(plain: &str, range: &Range<usize>) -> Option<(Vec<String>, Range<usize>)> {
    let range = trimmed(plain, range.clone());
    let written = &plain[range.clone()];
    let (names, body) = if let Some(rest) = written.strip_prefix("lambda ") {
        rest.split_once(':')?
    } else {
        let rest = written.strip_prefix('@').unwrap_or(written).trim_start();
        let (names, body) = rest.strip_prefix('(')?.split_once(')')?;
        let arrow = body.trim_start();
        match arrow.strip_prefix("->").or_else(|| arrow.strip_prefix("=>")) {
            Some(body) => (names, body),
            None if written.starts_with('@') => (names, body),
            None => return None,
        }
    };
    let names: Vec<String> = names.split(',').map(|name| name.trim().to_owned()).collect();
    names.iter().all(|name| is_name(name)).then(|| (names, range.end - body.len()..range.end))
}

/// The variable that an argument gives a range to: `{x, -2, 2}`, `(x, -2, 2)`, `x = -2..2`.
fn variable(plain: &str, range: &Range<usize>) -> Option<String> {
    let range = trimmed(plain, range.clone());
    let written = &plain[range.clone()];
    if let Some((name, limits)) = written.split_once('=')
        && limits.contains("..")
    {
        return Some(name.trim().to_owned()).filter(|name| is_name(name));
    }
    let is_bracketed =
        written.starts_with(['{', '(', '[']) && closing(plain, range.start, range.end)? + 1 == range.end;
    if !is_bracketed {
        return None;
    }
    let inside = parts(plain, range.start + 1..range.end - 1, &[","]);
    let name = plain[inside.first()?.clone()].trim();
    (matches!(inside.len(), 3 | 4) && is_name(name)).then(|| name.to_owned())
}

/// What a call of this name with these arguments draws; none if it draws nothing.
fn drawing(source: Source<'_>, name: &str, arguments: &[Range<usize>]) -> Option<Drawn> {
    let Source { text, plain } = source;
    let lower = name.to_ascii_lowercase();
    let words: Vec<&str> = arguments.iter().map(|range| plain[range.clone()].trim()).collect();
    let functions = arguments.iter().find_map(|argument| nameless(plain, argument));
    let mut variables: Vec<String> =
        arguments.iter().skip(1).filter_map(|range| variable(plain, range)).collect();
    if variables.is_empty() {
        // `implicit(f, x, -2, 2, y, -2, 2)`
        let is_number = |word: &str| super::number(word).is_ok();
        let triples = words
            .windows(3)
            .skip(1)
            .filter(|three| is_name(three[0]) && three[1..].iter().all(|word| is_number(word)));
        variables = triples.map(|three| three[0].to_owned()).collect();
    }
    let is_function = elsewhere::called(name, '(').is_some();
    let has_shape = !is_function && (variables.len() >= 2 || functions.is_some());
    if !has_shape && !is_program(name) {
        return None;
    }
    let option = |names: &[&str]| {
        arguments.iter().find_map(|range| {
            let written = plain[range.clone()].trim();
            let (key, value) = written.split_once("->").or_else(|| written.split_once('='))?;
            names.contains(&key.trim().to_ascii_lowercase().as_str()).then(|| value.trim().to_owned())
        })
    };
    let mut levels: Vec<String> = option(LEVELS).map_or(Vec::new(), |value| listed_in(&value));
    let (names, body) = match functions {
        Some((names, body)) => (names, body),
        // The grid comes before the values on it, and the level after them.
        None if words.len() > 3
            && words.iter().zip(COORDINATES).all(|(word, axis)| word.eq_ignore_ascii_case(axis)) =>
        {
            levels.extend(words.get(4).map(|level| (*level).to_owned()));
            (words[..3].iter().map(|word| (*word).to_owned()).collect(), arguments[3].clone())
        }
        None => (variables, arguments.first()?.clone()),
    };
    levels.retain(|level| super::number(level).is_ok());
    let listed = listed(plain, &body);
    let is_path = lower.contains("parametric")
        || listed.len() == 3
            && !names.is_empty()
            && !names.iter().any(|name| COORDINATES.contains(&name.as_str()));
    if is_path {
        return Some(Drawn { kind: Kind::Path, ..surface(name, Vec::new()) });
    }
    let mut drawn = surface(name, Vec::new());
    if option(OTHERS).is_some() || CURVED.iter().any(|word| lower.contains(word)) {
        return Some(drawn);
    }
    // Variables by other names are the coordinates that are left.
    let mut free = COORDINATES.into_iter().filter(|axis| !names.iter().any(|name| name == axis));
    for name in names.iter().filter(|name| !COORDINATES.contains(&name.as_str())) {
        drawn.definitions.push((name.clone(), free.next()?.to_owned()));
    }
    let height = free.next().filter(|_| names.len() == 2);
    let is_level = ["implicit", "contour", "region"].iter().any(|word| lower.contains(word));
    for formula in listed {
        let replaced = replaced(source, &formula, |_| None);
        let written = parts(plain, formula, &["/."]).swap_remove(0);
        drawn.definitions.extend(replaced.into_iter().flat_map(|replaced| replaced.definitions));
        let formula = text[trimmed(plain, written.clone())].trim().to_owned();
        let is_equation = plain[written.clone()].contains('=');
        if let Some(solid) = solid(plain, &written, DEEPEST) {
            drawn.formulas.push(solid);
        } else if let Some(sides) = equal(source, &written) {
            drawn.formulas.push(sides);
        } else if is_equation {
            drawn.formulas.push(formula.replace("==", "="));
        } else if let Some(height) = height.filter(|_| !is_level) {
            drawn.formulas.push(format!("{height} = {formula}"));
        } else if !levels.is_empty() {
            drawn.formulas.extend(levels.iter().map(|level| format!("{formula} = {level}")));
        } else if lower.contains("contour") {
            // It is unknown which levels are drawn.
            drawn.formulas.push(format!("{formula} = …"));
        } else {
            drawn.formulas.push(formula);
        }
    }
    Some(drawn)
}

/// The items of a list in brackets, or the whole range.
fn listed(plain: &str, range: &Range<usize>) -> Vec<Range<usize>> {
    let range = trimmed(plain, range.clone());
    let is_list = plain[range.clone()].starts_with(['{', '[', '('])
        && closing(plain, range.start, range.end).is_some_and(|close| close + 1 == range.end);
    if !is_list {
        return vec![range];
    }
    let items = parts(plain, range.start + 1..range.end - 1, &[","]);
    if items.len() == 1 && plain[range.clone()].starts_with('(') { vec![range] } else { items }
}

fn listed_in(written: &str) -> Vec<String> {
    listed(written, &(0..written.len())).into_iter().map(|item| written[item].trim().to_owned()).collect()
}

/// `Eq(a, b)` and `Equal[a, b]` as an equation.
fn equal(source: Source<'_>, range: &Range<usize>) -> Option<String> {
    let call = call(source.plain, range.clone())?;
    let is_equal = matches!(call.name.as_str(), "Eq" | "Equal") && source.plain[call.rest].trim().is_empty();
    let [left, right] = &call.arguments[..] else { return None };
    is_equal.then(|| format!("{} = {}", source.text[left.clone()].trim(), source.text[right.clone()].trim()))
}

/// The solid where a condition holds, as the formula of its surface, which is negative inside.
fn solid(plain: &str, range: &Range<usize>, depth: usize) -> Option<String> {
    let depth = depth.checked_sub(1)?;
    let range = trimmed(plain, range.clone());
    for (signs, function) in [(&["||", "∨", " or "][..], "min"), (&["&&", "∧", "&", " and "][..], "max")]
    {
        let parts = parts(plain, range.clone(), signs);
        if parts.len() > 1 {
            let inner: Option<Vec<String>> =
                parts.iter().map(|part| solid(plain, part, depth).map(|solid| difference(&solid))).collect();
            return Some(format!("{function}({})", inner?.join(", ")));
        }
    }
    if plain[range.clone()].starts_with('(')
        && closing(plain, range.start, range.end).is_some_and(|close| close + 1 == range.end)
    {
        return solid(plain, &(range.start + 1..range.end - 1), depth);
    }
    let signs = ["<=", ">=", "<", ">", "≤", "≥"];
    let sides = parts(plain, range, &signs);
    let pairs: Vec<(&str, &str)> = sides
        .windows(2)
        .map(|pair| {
            let [a, b] = [0, 1].map(|k: usize| plain[pair[k].clone()].trim());
            let is_less = plain[pair[0].end..].starts_with(['<', '≤']);
            if is_less { (a, b) } else { (b, a) }
        })
        .collect();
    let is_whole =
        pairs.iter().all(|(a, b)| !a.is_empty() && !b.is_empty() && !format!("{a}{b}").contains('='));
    match &pairs[..] {
        _ if !is_whole => None,
        [] => None,
        [(a, b)] => Some(format!("{a} = {b}")),
        several => {
            let all: Vec<String> = several.iter().map(|(a, b)| difference(&format!("{a} = {b}"))).collect();
            Some(format!("max({})", all.join(", ")))
        }
    }
}

/// The difference of the sides of an equation.
fn difference(equation: &str) -> String {
    match equation.split_once(" = ") {
        Some((left, right)) if right.chars().all(is_of_name) => format!("{left} - {right}"),
        Some((left, right)) => format!("{left} - ({right})"),
        None => equation.to_owned(),
    }
}
