//! The named surfaces, as data.

use super::formula::{FormulaField, Parameter};
use crate::math::Bounds;

/// A parameter of a gallery surface.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceParameter {
    /// The name in the formula.
    pub name: &'static str,
    /// What it is.
    pub label: &'static str,
    /// Default value.
    pub value: f64,
    /// Least value of the slider.
    pub min: f64,
    /// Greatest value of the slider.
    pub max: f64,
    /// Step of the slider.
    pub step: f64,
}

/// A named surface.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Identifier: lower case, words joined by hyphens.
    pub id: &'static str,
    /// Name for a person.
    pub name: &'static str,
    /// Formula; negative inside.
    pub formula: &'static str,
    /// Parameters of the formula, in the order of their sliders.
    pub parameters: &'static [SurfaceParameter],
    /// The box that is sampled.
    pub bounds: Bounds,
    /// Degree of the polynomial, if it is one.
    pub degree: Option<u32>,
    /// Genus with the default parameters, if the surface is closed, connected and smooth.
    pub genus: Option<u32>,
    /// Two sentences about the surface.
    pub story: &'static str,
}

impl Surface {
    /// The parameters as a formula takes them.
    #[must_use]
    pub fn declared(&self) -> Vec<Parameter> {
        self.parameters
            .iter()
            .map(|p| Parameter {
                name: p.name.into(),
                label: p.label.into(),
                value: p.value,
                min: p.min,
                max: p.max,
                step: p.step,
            })
            .collect()
    }

    /// The field with the default parameters.
    ///
    /// # Panics
    ///
    /// Never: a test parses every formula of the gallery.
    #[must_use]
    pub fn field(&self) -> FormulaField {
        FormulaField::parse(self.formula, &self.declared())
            .unwrap_or_else(|error| panic!("gallery surface `{}`: {error}", self.id))
    }
}

/// The surface with this identifier.
#[must_use]
pub fn find(id: &str) -> Option<&'static Surface> {
    SURFACES.iter().find(|surface| surface.id == id)
}

const fn parameter(
    name: &'static str,
    label: &'static str,
    value: f64,
    [min, max, step]: [f64; 3],
) -> SurfaceParameter {
    SurfaceParameter { name, label, value, min, max, step }
}

/// Every surface of the gallery; the first one is the default.
pub static SURFACES: &[Surface] = &[
    Surface {
        id: "ellipsoid",
        name: "Ellipsoid",
        formula: "x^2/a^2 + y^2/b^2 + z^2/c^2 = 1",
        parameters: &[
            parameter("a", "Semi-axis in x", 1.0, [0.2, 1.2, 0.01]),
            parameter("b", "Semi-axis in y", 0.7, [0.2, 1.2, 0.01]),
            parameter("c", "Semi-axis in z", 0.5, [0.2, 1.2, 0.01]),
        ],
        bounds: Bounds::cube(1.25),
        degree: Some(2),
        genus: Some(0),
        story: "",
    },
    Surface {
        id: "sphere",
        name: "Sphere",
        formula: "(x^2 + y^2 + z^2 - r^2)/(2r)",
        parameters: &[parameter("r", "Radius", 1.0, [0.2, 1.2, 0.01])],
        bounds: Bounds::cube(1.25),
        degree: Some(2),
        genus: Some(0),
        story: "",
    },
    Surface {
        id: "torus",
        name: "Torus",
        formula: "(sqrt(x^2 + y^2) - R)^2 + z^2 = r^2",
        parameters: &[
            parameter("R", "Radius of the ring", 1.0, [0.5, 1.2, 0.01]),
            parameter("r", "Radius of the tube", 0.4, [0.1, 0.6, 0.01]),
        ],
        bounds: Bounds::symmetric([1.5, 1.5, 0.5]),
        degree: Some(4),
        genus: Some(1),
        story: "",
    },
    Surface {
        id: "tanglecube",
        name: "Tanglecube",
        formula: "x^4 - 5x^2 + y^4 - 5y^2 + z^4 - 5z^2 + c",
        parameters: &[parameter("c", "Level", 11.8, [10.0, 13.0, 0.05])],
        bounds: Bounds::cube(2.6),
        degree: Some(4),
        genus: Some(5),
        story: "",
    },
];
