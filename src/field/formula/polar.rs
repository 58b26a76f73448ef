//! Equations in polar, cylindrical or spherical coordinates, such as `r = 1 + cos(theta)`. Their
//! names would become parameters; the same equation in x, y and z is suggested.

use super::Formula;
use super::ast::ExprKind;
use super::error::{FormulaError, FormulaErrorKind as ErrorKind};
use super::lex::tokens;
use super::operand::MODEL;
use super::statements::{self, Parsed};
use super::token::{Token, slice};
use crate::field::Field;
use glam::DVec3;

const FROM_AXIS: &str = "hypot(x, y)";
const FROM_ORIGIN: &str = "hypot(x, y, z)";
const AROUND_AXIS: &str = "atan2(y, x)";
const ANGLE_FROM_AXIS: &str = "atan2(hypot(x, y), z)";

/// Names of the radius.
const RADII: [&str; 5] = ["r", "rho", "ρ", "R", "radius"];
/// Names of the angles; `φ` and `phi` also name a constant.
const THETA: [&str; 2] = ["theta", "θ"];
const PHI: &str = "phi";

/// The error for an equation in other coordinates than x, y and z; none for other equations. Such
/// an equation contains neither x nor y, and an angle or only the radius.
pub(super) fn error(text: &str, parsed: &Parsed, declared: &[&str]) -> Option<FormulaError> {
    let equation = &parsed.equation;
    let bodies = || equation.definitions.iter().map(|definition| &definition.body);
    let parts = || bodies().chain([&equation.left]).chain(&equation.right);
    let has = |axis: u8| parts().any(|part| part.any(&|kind| *kind == ExprKind::Coordinate(axis)));
    if has(0) || has(1) || !equation.region.is_empty() {
        return None;
    }
    let tokens = tokens(text, declared).ok()?;
    let is_free = |name: &str| parsed.names.iter().any(|(free, _)| free == name) && !declared.contains(&name);
    if is_free(MODEL) {
        return None;
    }
    let radius = RADII.into_iter().find(|name| is_free(name));
    let theta = THETA.into_iter().find(|name| is_free(name));
    // In `r = 1 + cos(t)` the one parameter is the angle.
    let theta = theta.or_else(|| (radius.is_some() && !has(2) && is_free("t")).then_some("t"));
    let has_phi = radius.is_some()
        && !declared.contains(&PHI)
        && tokens.iter().any(|spanned| spanned.token == Token::Name(PHI.into()));
    let phi = has_phi.then_some(PHI);
    let (one_angle, both) = (theta.is_some() != phi.is_some(), theta.is_some() && phi.is_some());
    let is_distance = matches!(radius, Some("rho" | "ρ"));
    let (kind, places) = match (radius, has(2)) {
        (None, _) | (_, true) if one_angle => ("Cylindrical", [FROM_AXIS, AROUND_AXIS, AROUND_AXIS]),
        (None, _) | (_, true) => return None,
        // As in most books, θ is the angle from the axis next to r, and around it next to ρ.
        (Some(_), false) if is_distance => ("Spherical", [FROM_ORIGIN, AROUND_AXIS, ANGLE_FROM_AXIS]),
        (Some(_), false) if both => ("Spherical", [FROM_ORIGIN, ANGLE_FROM_AXIS, AROUND_AXIS]),
        (Some(_), false) if one_angle => ("Polar", [FROM_AXIS, AROUND_AXIS, AROUND_AXIS]),
        (Some(radius), false) => {
            let message = format!(
                "`{radius}` is no coordinate: the distance from the origin is `{FROM_ORIGIN}`, that from the z axis `{FROM_AXIS}`"
            );
            let ways = [FROM_ORIGIN, FROM_AXIS].map(|place| written(text, declared, &[(radius, place)]));
            let span = 0..text.trim_end().len();
            let error = FormulaError::new(ErrorKind::UnknownName, span, message);
            return Some(error.choose(ways.into_iter().flatten()));
        }
    };
    let names: Vec<(&str, &str)> = [radius, theta, phi]
        .into_iter()
        .zip(places)
        .filter_map(|(name, place)| Some((name?, place)))
        .collect();
    let meanings = names.iter().map(|&(name, place)| match place {
        ANGLE_FROM_AXIS => format!("{name}, the angle from the z axis, is `{place}`"),
        AROUND_AXIS => format!("{name}, the angle around the z axis, is `{place}`"),
        _ => format!("{name} is `{place}`"),
    });
    let message =
        format!("{kind} coordinates are written by x, y and z: {}", meanings.collect::<Vec<_>>().join("; "));
    let error = FormulaError::new(ErrorKind::UnknownName, 0..text.trim_end().len(), message);
    // Without a coordinate in the formula, a slider would leave no surface.
    let error = match radius.or(theta).filter(|_| has(2)) {
        Some(name) => error.unknown(name),
        None => error,
    };
    Some(match written(text, declared, &names) {
        Some(text) => error.suggest(text),
        None => error,
    })
}

/// Places at which two texts are compared. A formula that is the same at each is the same.
const POINTS: [DVec3; 3] =
    [DVec3::new(0.3, 0.7, 0.45), DVec3::new(-0.6, 0.25, 1.3), DVec3::new(1.4, -0.9, -0.35)];

/// The text with the names replaced, if that keeps its meaning, or with the names defined before
/// it: `sin 3theta` is not `sin 3 atan2(y, x)`.
fn written(text: &str, declared: &[&str], names: &[(&str, &str)]) -> Option<String> {
    let text = text.trim_end();
    let tokens = tokens(text, declared).ok()?;
    let replaced = |by: &dyn Fn(&str, &str) -> String| {
        let (mut out, mut at) = (String::new(), 0);
        for spanned in &tokens {
            let Token::Name(word) = &spanned.token else { continue };
            if let Some((name, place)) = names.iter().find(|(name, _)| name == word) {
                out.push_str(slice(text, &(at..spanned.span.start)));
                // White space parts a number and a name.
                let is_beside = out.ends_with(|c: char| c.is_ascii_digit()) && *place == by(name, place);
                out.push_str(if is_beside { " " } else { "" });
                out.push_str(&by(name, place));
                at = spanned.span.end;
            }
        }
        out + slice(text, &(at..text.len()))
    };
    // The name of a constant cannot be defined.
    let own = |name: &str| if name == PHI { "phi_1".to_owned() } else { name.to_owned() };
    let definitions: String =
        names.iter().map(|(name, place)| format!("{} = {place}; ", own(name))).collect();
    let equation = replaced(&|name, _| own(name));
    // `r = …` would define it again, `(r) = …` is an equation.
    let starts = names.iter().map(|(name, _)| own(name)).find(|name| {
        let rest = equation.strip_prefix(name.as_str());
        rest.is_some_and(|rest| rest.trim_start().starts_with('='))
    });
    let equation = starts.map_or(equation.clone(), |name| equation.replacen(&name, &format!("({name})"), 1));
    let defined = definitions + &equation;
    let meant = values(&defined, declared)?;
    let is_meant = |way: &String| values(way, declared).is_some_and(|found| is_same(&found, &meant));
    let ways = [replaced(&|_, place| place.to_owned()), replaced(&|_, place| format!("({place})"))];
    Some(ways.into_iter().find(is_meant).unwrap_or(defined))
}

/// The values of a formula at [`POINTS`].
fn values(text: &str, declared: &[&str]) -> Option<Vec<f64>> {
    let Parsed { equation, names, .. } = statements::parse(text, declared).ok()?;
    let names = names.into_iter().map(|(name, _)| name).collect();
    let field = Formula::of_equation(text, equation, names).ok()?;
    Some(POINTS.iter().map(|&p| field.jet(p).value).collect())
}

fn is_same(a: &[f64], b: &[f64]) -> bool {
    // Rounding differs where operations do.
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-9 * (1.0 + b.abs()) || a.is_nan() && b.is_nan())
}
