//! A number at each particle, by a formula or a function: what colours particles and becomes a
//! column of files.

use super::colours::ColourText;
use super::{Formula, FormulaError, Noun, Parameter};
use crate::field::Field;

use core::fmt::{self, Debug, Formatter};
use std::sync::Arc;

/// A number at each particle, by a formula or a function of position.
///
/// ```
/// use marching_particles::run::Value;
/// use marching_particles::{Format, Formula, Settings, sample};
///
/// let torus = Formula::parse("(hypot(x, y) - 1)^2 + z^2 = 0.16")?;
/// let mut sample = sample(&torus, &Settings::with_count(2_000))?;
/// sample.add_value(&torus, "mean_curvature", &Value::parse("(k_1 + k_2)/2")?)?;
/// sample.add_value(&torus, "height", &Value::by(|p: marching_particles::glam::DVec3| p.z))?;
/// let mut file = Vec::new();
/// sample.write(Format::Csv, &mut file)?;
/// assert!(file.windows(21).any(|text| text == b"mean_curvature,height"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Value(pub(crate) Source);

#[derive(Clone)]
pub(crate) enum Source {
    Formula(Box<Formula>),
    Function(Arc<dyn Field>),
}

impl Debug for Value {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match &self.0 {
            Source::Formula(formula) => f.debug_tuple("Value").field(&formula.text()).finish(),
            Source::Function(_) => f.write_str("Value(a function)"),
        }
    }
}

/// How errors name a value.
const NOUN: Noun = Noun {
    name: "value",
    unknown: "A particle has no",
    others: "the quantities of a particle",
    examples: ["1", "0.5 (k_1 + k_2)", "if(z > 0, 1, 0)"],
};

/// The quantities of a particle, by their names in formulas.
pub(crate) const QUANTITIES: [&str; 12] =
    ["n_x", "n_y", "n_z", "k_1", "k_2", "d_x", "d_y", "d_z", "radius", "level", "area", "edge"];

/// The quantity that needs the mesh.
pub(crate) const AREA: &str = "area";

impl Value {
    /// The value of a formula of the position x, y, z and of
    ///
    /// | name | quantity |
    /// |---|---|
    /// | `n_x`, `n_y`, `n_z` | the unit normal, along the gradient of f |
    /// | `k_1`, `k_2` | principal curvatures, the larger one first; positive where the surface bends away from its normal, in inverse units of length |
    /// | `d_x`, `d_y`, `d_z` | unit principal direction of `k_1`, of either sign |
    /// | `radius` | repulsion radius |
    /// | `level` | generation level |
    /// | `edge` | distance to the nearest sharp edge or rim; NaN if there is none |
    /// | `area` | share of the surface: a third of the triangles of the mesh around it, which adds up to the area of the mesh |
    ///
    /// The mean curvature is `0.5 (k_1 + k_2)`, the Gaussian one `k_1 k_2`. An edge has no
    /// curvature: formulas that use it give NaN there.
    ///
    /// # Errors
    ///
    /// Any of [`FormulaErrorKind`](super::FormulaErrorKind), with its span in bytes
    /// of `text`: `UnknownName` for another name.
    pub fn parse(text: &str) -> Result<Self, FormulaError> {
        Self::of_formula(text, &[])
    }

    /// [`Value::parse`], with the values of more names.
    ///
    /// # Errors
    ///
    /// Those of [`Value::parse`].
    #[doc(hidden)]
    pub fn of_formula(text: &str, parameters: &[Parameter]) -> Result<Self, FormulaError> {
        let known: Vec<Parameter> = known(parameters).collect();
        let formula = Formula::expression(text, &known, &NOUN)?;
        Ok(Self(Source::Formula(Box::new(formula))))
    }

    /// The value of a function of position.
    pub(crate) fn of_field(function: Arc<dyn Field>) -> Self {
        Self(Source::Function(function))
    }

    /// Whether the value needs the mesh, for the area.
    #[doc(hidden)]
    #[must_use]
    pub fn needs_mesh(&self) -> bool {
        self.takes(&[AREA])
    }

    /// Whether the formula uses one of these quantities.
    pub(crate) fn takes(&self, names: &[&str]) -> bool {
        match &self.0 {
            Source::Formula(formula) => formula.parameters().iter().any(|own| names.contains(&&*own.name)),
            Source::Function(_) => false,
        }
    }
}

/// How errors name a colour.
const COLOUR: Noun = Noun { name: "colour", examples: ["0.5", "k_1 k_2", "if(z > 0, 1, 0)"], ..NOUN };

/// The function of a colour that a formula gives, which may use the `parameters` of the surface.
///
/// # Errors
///
/// Those of [`Value::parse`], and `UnknownName` for `area`: there may be no mesh.
pub(super) fn of_colour(
    colour: &ColourText,
    parameters: &[Parameter],
) -> Result<(&'static str, Formula), FormulaError> {
    let is_known = |parameter: &Parameter| parameter.name != AREA;
    let known: Vec<Parameter> = known(parameters).filter(is_known).collect();
    Ok((colour.column, Formula::expression(&colour.text, &known, &COLOUR)?))
}

/// The values of the colours that a formula gives, for these values of its parameters.
pub(super) fn of_columns(
    columns: &[(&'static str, Formula)],
    parameters: &[Parameter],
) -> Vec<(&'static str, Value)> {
    let value = |(name, formula): &(&'static str, Formula)| {
        let mut formula = formula.clone();
        for Parameter { name, value, .. } in parameters {
            // The colour may not have the parameter.
            let _ = formula.set_parameter(name, *value);
        }
        (*name, Value(Source::Formula(Box::new(formula))))
    };
    columns.iter().map(value).collect()
}

/// The `parameters` with other names than the quantities, and these.
fn known(parameters: &[Parameter]) -> impl Iterator<Item = Parameter> {
    let is_free = |parameter: &&Parameter| !QUANTITIES.contains(&&*parameter.name);
    let own = QUANTITIES.iter().map(|name| Parameter::automatic(name));
    parameters.iter().filter(is_free).cloned().chain(own)
}
