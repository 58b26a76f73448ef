//! Named surfaces, each with a formula, parameters, a box and known properties.

use super::formula::{FormulaField, Parameter};
use crate::math::Bounds;

/// A parameter of a gallery surface.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceParameter {
    /// Name in the formula.
    pub name: &'static str,
    /// Label for the user.
    pub label: &'static str,
    /// Default value.
    pub value: f64,
    /// Smallest value of the slider.
    pub min: f64,
    /// Largest value of the slider.
    pub max: f64,
    /// Step of the slider.
    pub step: f64,
}

/// A named surface.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Identifier: lower case, words joined by hyphens.
    pub id: &'static str,
    /// Name for the user.
    pub name: &'static str,
    /// Formula of f, or an equation; f < 0 inside.
    pub formula: &'static str,
    /// Parameters of the formula, in the order of their sliders.
    pub parameters: &'static [SurfaceParameter],
    /// Box that is sampled.
    pub bounds: Bounds,
    /// Algebraic degree; `None` for a transcendental surface.
    pub degree: Option<u32>,
    /// Whether the surface is closed, so that it lies in the box for all values of the parameters.
    pub closed: bool,
    /// Genus with the default parameters; `None` unless the surface is closed, connected and free of
    /// self-intersections.
    pub genus: Option<u32>,
    /// Whether the surface with the default parameters has no singular point.
    pub smooth: bool,
    /// Whether thin parts or long blends keep the search for components from a proof, and a coarse relaxation from its last
    /// steps.
    pub intricate: bool,
    /// Two sentences about the surface.
    pub story: &'static str,
}

impl Surface {
    /// The parameters in the form that [`FormulaField::parse`] takes.
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

    /// Parses the formula, with the default values of the parameters.
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

/// Surface with the identifier `id`.
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

/// All surfaces of the gallery. The first one is the default.
pub static SURFACES: &[Surface] = &[
    Surface {
        id: "ellipsoid",
        name: "Ellipsoid",
        formula: "x^2/a^2 + y^2/b^2 + z^2/c^2 = 1",
        parameters: &[
            parameter("a", "Semi-axis along x", 1.0, [0.3, 1.2, 0.01]),
            parameter("b", "Semi-axis along y", 0.7, [0.3, 1.0, 0.01]),
            parameter("c", "Semi-axis along z", 0.5, [0.3, 0.8, 0.01]),
        ],
        bounds: Bounds::symmetric([1.25, 1.05, 0.85]),
        degree: Some(2),
        closed: true,
        genus: Some(0),
        smooth: true,
        intricate: false,
        story: "A sphere stretched by three different factors, the simplest closed surface whose \
                curvature varies from point to point. At each of its four umbilics the two principal \
                curvatures agree.",
    },
    Surface {
        id: "sphere",
        name: "Sphere",
        formula: "x^2 + y^2 + z^2 = r^2",
        parameters: &[parameter("r", "Radius", 1.0, [0.3, 1.2, 0.01])],
        bounds: Bounds::cube(1.25),
        degree: Some(2),
        closed: true,
        genus: Some(0),
        smooth: true,
        intricate: false,
        story: "All points at one distance from a centre: the closed surface that holds the most volume \
                for its area. No lattice of six neighbours covers it, because the defects of valence \
                must add up to twelve.",
    },
    Surface {
        id: "torus",
        name: "Torus",
        formula: "(sqrt(x^2 + y^2) - R)^2 + z^2 = r^2",
        parameters: &[
            parameter("R", "Radius of the ring", 1.0, [0.5, 1.1, 0.01]),
            parameter("r", "Radius of the tube", 0.4, [0.1, 0.5, 0.01]),
        ],
        bounds: Bounds::symmetric([1.65, 1.65, 0.55]),
        degree: Some(4),
        closed: true,
        genus: Some(1),
        smooth: true,
        intricate: false,
        story: "A circle of radius r carried around an axis at distance R; it is dome-shaped on the \
                outside and saddle-shaped on the inside. Its Euler number is zero, so that a covering \
                with six neighbours everywhere is possible.",
    },
    Surface {
        id: "dupin-cyclide",
        name: "Dupin cyclide",
        formula: "(x^2 + y^2 + z^2 + b^2 - d^2)^2 = 4((x - d sqrt(1 - b^2))^2 + b^2 y^2)",
        parameters: &[
            parameter("b", "Roundness of the spine", 0.9, [0.85, 0.97, 0.005]),
            parameter("d", "Mean radius of the tube", 0.65, [0.6, 0.75, 0.005]),
        ],
        bounds: Bounds { min: [-2.35, -1.82, -1.35], max: [1.6, 1.82, 1.35] },
        degree: Some(4),
        closed: true,
        genus: Some(1),
        smooth: true,
        intricate: false,
        story: "A torus seen in a spherical mirror: the tube swells on one side and narrows on the \
                other. All its lines of curvature are circles, which Charles Dupin found around 1802, \
                while still a student.",
    },
    Surface {
        id: "tanglecube",
        name: "Tanglecube",
        formula: "x^4 - 5x^2 + y^4 - 5y^2 + z^4 - 5z^2 + c = 0",
        parameters: &[parameter("c", "Level", 11.8, [7.0, 13.5, 0.05])],
        bounds: Bounds::cube(2.5),
        degree: Some(4),
        closed: true,
        genus: Some(5),
        smooth: true,
        intricate: false,
        story: "Eight balls at the corners of a cube, joined along its twelve edges to a surface of \
                genus five. Raise c past 12.5 and the bridges break.",
    },
    Surface {
        id: "heart",
        name: "Heart",
        formula: "(x^2 + d y^2 + z^2 - 1)^3 = (x^2 + 9y^2/80) z^3",
        parameters: &[parameter("d", "Flatness", 2.25, [1.5, 4.0, 0.05])],
        bounds: Bounds { min: [-1.25, -0.95, -1.1], max: [1.25, 0.95, 1.35] },
        degree: Some(6),
        closed: true,
        genus: Some(0),
        smooth: false,
        intricate: false,
        story: "Gabriel Taubin's sextic of the early 1990s, made to try out the drawing of implicit \
                surfaces. The gradient vanishes at the dimple and at the tip, which makes both of them \
                hard for any method that follows it.",
    },
    Surface {
        id: "superellipsoid",
        name: "Superellipsoid",
        formula: "abs(x)^p + abs(y)^p + abs(z/c)^p = 1",
        parameters: &[
            parameter("p", "Exponent", 4.0, [2.0, 10.0, 0.1]),
            parameter("c", "Height", 0.8, [0.4, 1.1, 0.01]),
        ],
        bounds: Bounds::symmetric([1.1, 1.1, 1.2]),
        degree: None,
        closed: true,
        genus: Some(0),
        smooth: true,
        intricate: false,
        story: "The sphere's formula with another exponent: 2 gives an ellipsoid, and growing exponents \
                turn it into a box with rounded edges. The designer and poet Piet Hein made the form \
                popular in the 1960s.",
    },
    Surface {
        id: "decocube",
        name: "Decocube",
        formula: "((x^2 + y^2 - c^2)^2 + (z^2 - 1)^2)((y^2 + z^2 - c^2)^2 + (x^2 - 1)^2)((z^2 + x^2 - c^2)^2 + (y^2 - 1)^2) = b",
        parameters: &[
            parameter("c", "Radius of the rings", 0.8, [0.65, 0.9, 0.01]),
            parameter("b", "Thickness", 0.02, [0.005, 0.04, 0.001]),
        ],
        bounds: Bounds::cube(1.45),
        degree: Some(12),
        closed: true,
        genus: Some(13),
        smooth: true,
        intricate: true,
        story: "Six rings, one on each face of a cube, thick enough to melt together where they come \
                close. With the first settings it has genus thirteen; thin the rings and it falls apart \
                into six tori.",
    },
    Surface {
        id: "double-torus",
        name: "Double torus",
        formula: "(x^2 (1 - x^2) - y^2)^2 + z^2 = c^2",
        parameters: &[parameter("c", "Thickness", 0.12, [0.05, 0.22, 0.005])],
        bounds: Bounds::symmetric([1.2, 0.72, 0.28]),
        degree: Some(8),
        closed: true,
        genus: Some(2),
        smooth: true,
        intricate: false,
        story: "A plane figure of eight, Gerono's lemniscate, thickened until it is the skin of a body \
                with two holes. Squaring a curve's equation and adding z² does the same for any plane \
                curve.",
    },
    Surface {
        id: "cassini",
        name: "Cassini oval",
        formula: "(x^2 + y^2 + z^2 + a^2)^2 - 4a^2 x^2 = b^4",
        parameters: &[
            parameter("a", "Half distance of the foci", 1.0, [0.6, 1.1, 0.01]),
            parameter("b", "Mean distance", 1.06, [0.7, 1.2, 0.01]),
        ],
        bounds: Bounds::symmetric([1.7, 1.2, 1.2]),
        degree: Some(4),
        closed: true,
        genus: Some(0),
        smooth: true,
        intricate: false,
        story: "The points whose distances from two foci have the constant product b². For b just above \
                a it has a waist; at b = a that shrinks to a point, and below there are two eggs.",
    },
    Surface {
        id: "metaballs",
        name: "Metaballs",
        formula: "t = exp(-4((x - d)^2 + y^2 + z^2)) + exp(-4((x + d/2)^2 + (y - 0.866d)^2 + z^2)) + exp(-4((x + d/2)^2 + (y + 0.866d)^2 + z^2))",
        parameters: &[
            parameter("d", "Distance from the middle", 0.55, [0.0, 0.9, 0.01]),
            parameter("t", "Level", 0.5, [0.2, 0.8, 0.01]),
        ],
        bounds: Bounds { min: [-1.3, -1.6, -0.85], max: [1.7, 1.6, 0.85] },
        degree: None,
        closed: true,
        genus: Some(0),
        smooth: true,
        intricate: false,
        story: "Three bells of density and the surface where they add up to t: pull the centres apart \
                and the drops part. James Blinn introduced such blobs in 1982 to draw molecules.",
    },
    Surface {
        id: "drilled-block",
        name: "Drilled block",
        formula: "smax(smax(smax(smax(abs(x), abs(y), k), abs(z), k) - 0.8, hypot(x, y, z) - 1.05, k), r - smin(smin(hypot(y, z), hypot(z, x), k), hypot(x, y), k), k)",
        parameters: &[
            parameter("r", "Radius of the drill", 0.4, [0.25, 0.55, 0.01]),
            parameter("k", "Blend", 0.12, [0.02, 0.25, 0.01]),
        ],
        bounds: Bounds::cube(0.95),
        degree: None,
        closed: true,
        genus: Some(5),
        smooth: true,
        intricate: true,
        story: "A cube cut to a ball and drilled along three axes: constructive solid geometry with \
                every sharp edge replaced by a smooth blend of width k. The crossing drill holes make \
                its genus five.",
    },
    Surface {
        id: "gyroid",
        name: "Gyroid",
        formula: "sin(x) cos(y) + sin(y) cos(z) + sin(z) cos(x) = t",
        parameters: &[parameter("t", "Level", 0.0, [-1.3, 1.3, 0.01])],
        // A little less than two periods, 4π, so that no slivers appear at the corners.
        bounds: Bounds::cube(6.2),
        degree: None,
        closed: false,
        genus: None,
        smooth: true,
        intricate: false,
        story: "It divides space into two labyrinths, each the mirror image of the other, and holds \
                neither a straight line nor a plane of symmetry. Alan Schoen found the minimal surface \
                that this formula closely follows in 1970; butterfly wings and block copolymers grow \
                it by themselves.",
    },
    Surface {
        id: "schwarz-p",
        name: "Schwarz P",
        formula: "cos(x) + cos(y) + cos(z) = t",
        parameters: &[parameter("t", "Level", 0.0, [-0.95, 0.95, 0.01])],
        bounds: Bounds::cube(6.3),
        degree: None,
        closed: false,
        genus: None,
        smooth: true,
        intricate: false,
        story: "The primitive surface of Hermann Amandus Schwarz: chambers joined by necks along the \
                edges of a cubic lattice. The formula is the first term of the true minimal surface's \
                Fourier series, and already hard to tell from it.",
    },
    Surface {
        id: "schwarz-d",
        name: "Schwarz D",
        formula: "sin(x) sin(y) sin(z) + sin(x) cos(y) cos(z) + cos(x) sin(y) cos(z) + cos(x) cos(y) sin(z) = t",
        parameters: &[parameter("t", "Level", 0.0, [-0.9, 0.9, 0.01])],
        // A little less than one period, 2π, so that no slivers appear at the corners.
        bounds: Bounds::cube(3.1),
        degree: None,
        closed: false,
        genus: None,
        smooth: true,
        intricate: false,
        story: "Two interlocking labyrinths whose tunnels run along the bonds of a diamond crystal. With \
                the P surface and the gyroid it belongs to one family: bending without stretching turns \
                each one into the others.",
    },
    Surface {
        id: "clebsch",
        name: "Clebsch cubic",
        formula: "81(x^3 + y^3 + z^3) - 189(x^2 (y + z) + y^2 (z + x) + z^2 (x + y)) + 54x y z + 126(x y + y z + z x) - 9(x^2 + y^2 + z^2) - 9(x + y + z) + 1 = 0",
        parameters: &[],
        bounds: Bounds::cube(1.2),
        degree: Some(3),
        closed: false,
        genus: None,
        smooth: true,
        intricate: false,
        story: "Every smooth cubic surface carries 27 straight lines, and on this one, found by Alfred \
                Clebsch in 1871, all of them are real. In ten points three of the lines meet.",
    },
    Surface {
        id: "cayley",
        name: "Cayley cubic",
        formula: "4(x^2 + y^2 + z^2) + 16x y z = t",
        parameters: &[parameter("t", "Level", 1.0, [0.6, 1.4, 0.01])],
        bounds: Bounds::cube(1.6),
        degree: Some(3),
        closed: false,
        genus: None,
        smooth: false,
        intricate: false,
        story: "The cubic surface with four cone points, the most that a cubic can have; nine straight \
                lines lie on it. Move t off 1 and the points open or pinch off.",
    },
    Surface {
        id: "kummer",
        name: "Kummer quartic",
        formula: "(x^2 + y^2 + z^2 - mu^2)^2 = (3mu^2 - 1)/(3 - mu^2)*((1 - z)^2 - 2x^2)((1 + z)^2 - 2y^2)",
        parameters: &[parameter("mu", "Radius of the base sphere", 1.3, [1.05, 1.6, 0.01])],
        bounds: Bounds::cube(2.6),
        degree: Some(4),
        closed: false,
        genus: None,
        smooth: false,
        intricate: false,
        story: "A quartic surface with sixteen cone points, the most possible, built from a sphere of \
                radius mu and the four planes of a tetrahedron. Ernst Kummer met the family in 1864 \
                while studying bundles of light rays.",
    },
    Surface {
        id: "barth-sextic",
        name: "Barth sextic",
        formula: "(1 + 2phi)(x^2 + y^2 + z^2 - 1)^2 = 4(phi^2 x^2 - y^2)(phi^2 y^2 - z^2)(phi^2 z^2 - x^2) + t",
        parameters: &[parameter("t", "Level", 0.0, [-0.3, 0.3, 0.01])],
        bounds: Bounds::cube(1.9),
        degree: Some(6),
        closed: false,
        genus: None,
        smooth: false,
        intricate: false,
        story: "65 cone points, arranged with the symmetry of an icosahedron, fifteen of them at \
                infinity: no surface of degree six has more. Wolf Barth found it in 1996, half a \
                century after a supposed proof that 52 was the limit.",
    },
    Surface {
        id: "klein-bottle",
        name: "Klein bottle",
        formula: "(x^2 + y^2 + z^2 + 2y - 1)((x^2 + y^2 + z^2 - 2y - 1)^2 - 8z^2) + 16x z (x^2 + y^2 + z^2 - 2y - 1) = 0",
        parameters: &[],
        bounds: Bounds { min: [-3.6, -3.2, -4.6], max: [3.6, 5.2, 4.6] },
        degree: Some(6),
        closed: true,
        genus: None,
        smooth: false,
        intricate: false,
        story: "A closed surface with one side, which in space has to pass through itself. On the curve \
                of self-crossing the gradient vanishes: no method can place particles there by following \
                it, and this one says so.",
    },
    Surface {
        id: "helicoid",
        name: "Helicoid",
        formula: "x sin(k z) = y cos(k z)",
        parameters: &[parameter("k", "Twist", 1.0, [0.3, 2.5, 0.01])],
        bounds: Bounds::symmetric([2.0, 2.0, 3.2]),
        degree: None,
        closed: false,
        genus: None,
        smooth: true,
        intricate: false,
        story: "The surface of a spiral staircase, swept by a line that turns as it climbs. Among the \
                surfaces made of straight lines only it and the plane are minimal, as Eugène Catalan \
                proved in 1842.",
    },
];
