//! How the values of options are read, where one number or word does not do.

use crate::arguments::{BoxChoice, Length, Sweep};
use crate::options::{list, number, whole};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use marching_particles::Bounds;
use marching_particles::export::{Unit, VERTICES, Vertices};
use marching_particles::field::formula::Thickness;
use marching_particles::internal::math::{BoxError, shortest_text};
use marching_particles::internal::session::{BeyondPoints, SolidSettings, ValueText};
use marching_particles::pointcloud::CENTRES;
use marching_particles::{Format, MeshFormat};

/// Parses a name of a table to its value.
pub(crate) fn one_of<T: Copy + Send + Sync>(
    table: &'static [(&'static str, T)],
) -> impl TypedValueParser<Value = (&'static str, T)> {
    PossibleValuesParser::new(table.iter().map(|(name, _)| *name)).try_map(|given| {
        table.iter().find(|(name, _)| *name == given).copied().ok_or("there is no such name")
    })
}

/// Extensions of all formats of files.
pub(crate) fn file_formats() -> PossibleValuesParser {
    let particles = Format::ALL.iter().map(|(name, _)| *name);
    let meshes =
        MeshFormat::ALL.iter().map(|(name, _)| *name).filter(|name| Format::of_extension(name).is_none());
    PossibleValuesParser::new(particles.chain(meshes))
}

/// Parses how vertices are written; the help explains each choice.
pub(crate) fn vertices() -> impl TypedValueParser<Value = Vertices> {
    let words = VERTICES.iter().map(|choice| PossibleValue::new(choice.value.name()).help(choice.help));
    PossibleValuesParser::new(words).try_map(|given| {
        let found = VERTICES.iter().find(|choice| choice.value.name() == given);
        found.map(|choice| choice.value).ok_or("there is no such way")
    })
}

/// Where the surface of points ends.
pub(crate) fn beyond_points(text: &str) -> Result<BeyondPoints, String> {
    match text {
        "cut" => Ok(BeyondPoints::Cut),
        "kept" => Ok(BeyondPoints::Kept),
        _ => Err("it is `cut` or `kept`".to_owned()),
    }
}

/// A thickness that a shell can have: a length or a formula.
pub(crate) fn thickness(text: &str) -> Result<Thickness, String> {
    let solid = SolidSettings { thickness: text.into(), ..SolidSettings::default() };
    solid.validate().map_err(|error| error.to_string())?;
    Ok(solid.thickness)
}

/// A positive length with its unit, in millimetres by default.
pub(crate) fn length(text: &str) -> Result<Length, String> {
    // `mm` also ends with the symbol of the metre, so it comes first in the table.
    let found = Unit::ALL.iter().find_map(|&(symbol, unit)| Some((text.strip_suffix(symbol)?, unit)));
    let (digits, unit) = found.unwrap_or((text, Unit::Millimetre));
    match number(digits.trim()) {
        Ok(value) if (1e-12..=1e12).contains(&value) => Ok(Length { value, unit }),
        _ => Err("a length is a positive number with mm, cm, m or in, such as 40mm".to_owned()),
    }
}

/// A share between 0 and 1, exclusive.
pub(crate) fn porosity(text: &str) -> Result<f64, String> {
    let share = match text.strip_suffix('%') {
        Some(percent) => number(percent)? / 100.0,
        None => number(text)?,
    };
    if share > 0.0 && share < 1.0 {
        return Ok(share);
    }
    Err("a porosity is a share between 0 and 1, such as 70% or 0.7".to_owned())
}

/// A positive factor that keeps every box within single precision.
pub(crate) fn scale(text: &str) -> Result<f64, String> {
    match number(text)? {
        scale if (1e-12..=1e12).contains(&scale) => Ok(scale),
        scale => Err(format!("{} is not between 1e-12 and 1e12", shortest_text(scale))),
    }
}

pub(crate) fn frames(text: &str) -> Result<u32, String> {
    Ok(whole(text, &(1..=100_000))? as u32)
}

pub(crate) fn centres(text: &str) -> Result<u32, String> {
    Ok(whole(text, &(u64::from(*CENTRES.start())..=u64::from(*CENTRES.end())))? as u32)
}

pub(crate) fn parameter(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text.split_once('=').ok_or("a parameter is given as NAME=VALUE, like a=2")?;
    if value.contains("..") {
        return Err(format!("a parameter has one value; the command `sweep` takes --sweep {text}"));
    }
    Ok((name.trim().to_owned(), number(value)?))
}

pub(crate) fn value(text: &str) -> Result<ValueText, String> {
    let how = "a value is given as NAME=FORMULA, like H=(k_1+k_2)/2";
    let (name, formula) = text.split_once('=').ok_or(how)?;
    Ok(ValueText { name: name.trim().to_owned(), formula: formula.trim().to_owned() })
}

pub(crate) fn sweep(text: &str) -> Result<Sweep, String> {
    let how = "a sweep is given as NAME=FROM..TO, like a=0.2..1.5";
    let (name, range) = text.split_once('=').ok_or(how)?;
    let (from, to) = range.split_once("..").ok_or(how)?;
    Ok(Sweep { name: name.trim().to_owned(), from: number(from)?, to: number(to)? })
}

pub(crate) fn choice_of_box(text: &str) -> Result<BoxChoice, String> {
    match text.trim() {
        "fit" => Ok(BoxChoice::Fit),
        "fixed" => Ok(BoxChoice::Fixed),
        numbers => bounds(numbers).map(BoxChoice::Given),
    }
}

pub(crate) fn bounds(text: &str) -> Result<Bounds, String> {
    let numbers = list(text).into_iter().map(number).collect::<Result<Vec<f64>, String>>();
    let numbers = numbers
        .map_err(|error| format!("a box takes one, three or six numbers, separated by commas: {error}"))?;
    let bounds = match numbers[..] {
        [half] => Bounds::cube(half),
        [x, y, z] => Bounds::symmetric([x, y, z]),
        [x0, y0, z0, x1, y1, z1] => Bounds { min: [x0, y0, z0], max: [x1, y1, z1] },
        _ => return Err(format!("a box takes one, three or six numbers, not {}", numbers.len())),
    };
    let how = "give half-widths, or the smallest corner and then the largest, as x0,y0,z0,x1,y1,z1";
    bounds.check().map_err(|error| match error {
        BoxError::Far => error.to_string(),
        _ => format!("{error}: {how}"),
    })?;
    Ok(bounds)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sweep_takes_a_name_and_two_numbers() {
        let range = |from, to| Ok(Sweep { name: "a".to_owned(), from, to });
        assert_eq!(sweep("a=0.2..1.5"), range(0.2, 1.5));
        assert_eq!(sweep("a = -1 .. -2e-1"), range(-1.0, -0.2));
        assert_eq!(sweep("a=0..2pi"), range(0.0, std::f64::consts::TAU));
        for bad in ["a", "a=1", "a=1..", "1..2", "a=..2", "a=1..b", "a=nan..1"] {
            assert!(sweep(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn porosity_is_a_share_between_0_and_1() {
        assert_eq!(porosity("70%"), Ok(0.7));
        assert_eq!(porosity("2/3"), Ok(2.0 / 3.0));
        for bad in ["70", "0", "1", "-1%", "100%", "nan", "x", "", "%"] {
            assert!(porosity(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn thickness_is_a_length_or_a_formula() {
        assert_eq!(thickness("pi/10"), Ok(Thickness::Number(std::f64::consts::PI / 10.0)));
        assert_eq!(thickness("-z"), Ok(Thickness::Formula("-z".to_owned())));
        assert!(thickness("-0.1").is_err());
    }

    #[test]
    fn box_is_fitted_fixed_or_given() {
        assert_eq!(choice_of_box("fit"), Ok(BoxChoice::Fit));
        assert_eq!(choice_of_box("fixed"), Ok(BoxChoice::Fixed));
        assert_eq!(choice_of_box("2"), Ok(BoxChoice::Given(Bounds::cube(2.0))));
        assert!(choice_of_box("tight").is_err());
    }

    #[test]
    fn box_takes_one_three_or_six_numbers() {
        assert_eq!(bounds("1.5"), Ok(Bounds::cube(1.5)));
        assert_eq!(bounds("pi"), Ok(Bounds::cube(std::f64::consts::PI)));
        assert_eq!(
            bounds("-pi,-1,-sqrt(4),max(1, 3),1,2e0"),
            Ok(Bounds { min: [-std::f64::consts::PI, -1.0, -2.0], max: [3.0, 1.0, 2.0] })
        );
        assert_eq!(bounds("1, 2,3"), Ok(Bounds::symmetric([1.0, 2.0, 3.0])));
        assert_eq!(bounds("-1,0,0,1,2,3"), Ok(Bounds { min: [-1.0, 0.0, 0.0], max: [1.0, 2.0, 3.0] }));
        for bad in [
            "",
            "1,2",
            "0",
            "-1",
            "1,0,1",
            "0,0,0,1,1,0",
            "a",
            "nan",
            "1e39",
            "1e-30",
            "1e9,0,0,1000000001,1,1",
        ] {
            assert!(bounds(bad).is_err(), "{bad}");
        }
    }
}
