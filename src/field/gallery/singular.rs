//! Surfaces with points at which f has no gradient.

use super::{CLOSED, OPEN, Surface, parameter};
use crate::math::Bounds;

pub(super) const SURFACES: &[Surface] = &[
    Surface {
        id: "heart",
        name: "Heart",
        formula: "(x^2 + d y^2 + z^2 - 1)^3 = (x^2 + 9y^2/80) z^3",
        parameters: &[parameter("d", "Flatness", 2.25, [1.5, 4.0, 0.05])],
        bounds: Bounds { min: [-1.25, -0.95, -1.1], max: [1.25, 0.95, 1.35] },
        degree: Some(6),
        genus: Some(0),
        smooth: false,
        words: "love valentine",
        story: "Gabriel Taubin's sextic of the early 1990s, made to try out the drawing of implicit \
                surfaces. The gradient vanishes at the dimple and at the tip, which makes both of them \
                hard for any method that follows it.",
        source: "G. Taubin, Rasterizing algebraic curves and surfaces, IEEE Computer Graphics and Applications 14(2), 1994",
        ..CLOSED
    },
    Surface {
        id: "cayley",
        name: "Cayley cubic",
        formula: "4(x^2 + y^2 + z^2) + 16x y z = t",
        parameters: &[parameter("t", "Level", 1.0, [0.6, 1.4, 0.01])],
        bounds: Bounds::cube(1.6),
        degree: Some(3),
        smooth: false,
        words: "cubic nodes tetrahedron",
        story: "The cubic surface with four cone points, the most that a cubic can have; nine straight \
                lines lie on it. Move t off 1 and the points open or pinch off.",
        source: "A. Cayley, A memoir on cubic surfaces, Philosophical Transactions of the Royal Society 159, 1869",
        ..OPEN
    },
    Surface {
        id: "octdong",
        name: "Octdong",
        formula: "x^2 + y^2 = a z^2 (1 - z^2)",
        parameters: &[parameter("a", "Width", 1.0, [0.5, 2.0, 0.01])],
        bounds: Bounds::symmetric([0.8, 0.8, 1.1]),
        degree: Some(4),
        smooth: false,
        words: "hourglass drops",
        story: "An eight turned about its axis: two drops that touch in one cone point. One particle \
                stands there for both, and a front grows over each drop from it.",
        source: "H. Hauser, Gallery of algebraic surfaces, University of Vienna",
        ..CLOSED
    },
    Surface {
        id: "piriform",
        name: "Piriform",
        formula: "y^2 + z^2 = b^2 x^3 (1 - x)",
        parameters: &[parameter("b", "Width", 1.2, [0.6, 1.6, 0.01])],
        bounds: Bounds { min: [-0.1, -0.6, -0.6], max: [1.1, 0.6, 0.6] },
        degree: Some(4),
        smooth: false,
        words: "pear drop teardrop onion",
        story: "A pear, or a drop that is about to fall, with a cusp instead of a cone at its tip. There the \
                surface becomes thinner than any particle, and the proof that every component was found \
                stays open.",
        source: "E. W. Weisstein, Piriform Surface, MathWorld",
        ..CLOSED
    },
    Surface {
        id: "kummer",
        name: "Kummer quartic",
        formula: "(x^2 + y^2 + z^2 - mu^2)^2 = (3mu^2 - 1)/(3 - mu^2)*((1 - z)^2 - 2x^2)((1 + z)^2 - 2y^2)",
        parameters: &[parameter("mu", "Radius of the base sphere", 1.3, [1.05, 1.6, 0.01])],
        bounds: Bounds::cube(2.6),
        degree: Some(4),
        smooth: false,
        words: "nodes algebraic",
        story: "A quartic surface with sixteen cone points, the most possible, built from a sphere of \
                radius mu and the four planes of a tetrahedron. Ernst Kummer met the family in 1864 \
                while studying bundles of light rays.",
        source: "E. Kummer, Monatsberichte der Berliner Akademie der Wissenschaften, 1864",
        ..OPEN
    },
    Surface {
        id: "barth-sextic",
        name: "Barth sextic",
        formula: "(1 + 2phi)(x^2 + y^2 + z^2 - 1)^2 = 4(phi^2 x^2 - y^2)(phi^2 y^2 - z^2)(phi^2 z^2 - x^2) + t",
        parameters: &[parameter("t", "Level", 0.0, [-0.3, 0.3, 0.01])],
        bounds: Bounds::cube(1.9),
        degree: Some(6),
        smooth: false,
        words: "star nodes",
        story: "65 cone points, arranged with the symmetry of an icosahedron, fifteen of them at \
                infinity: no surface of degree six has more. Wolf Barth found it in 1996, half a \
                century after a supposed proof that 52 was the limit.",
        source: "W. Barth, Two projective surfaces with many nodes, admitting the symmetries of the icosahedron, Journal of Algebraic Geometry 5, 1996",
        ..OPEN
    },
    Surface {
        id: "roman",
        name: "Roman surface",
        formula: "x^2 y^2 + y^2 z^2 + z^2 x^2 = r x y z",
        parameters: &[parameter("r", "Size", 1.0, [0.6, 1.05, 0.01])],
        bounds: Bounds::cube(0.55),
        degree: Some(4),
        smooth: false,
        words: "steiner projective plane",
        story: "Jakob Steiner's model, found in Rome in 1844, of the projective plane: it crosses itself \
                along three lines, which meet in a triple point. The gradient vanishes on the lines, so \
                particles stop beside them and warnings say so.",
        source: "E. W. Weisstein, Roman Surface, MathWorld",
        ..OPEN
    },
    Surface {
        id: "klein-bottle",
        name: "Klein bottle",
        formula: "(x^2 + y^2 + z^2 + 2y - 1)((x^2 + y^2 + z^2 - 2y - 1)^2 - 8z^2) + 16x z (x^2 + y^2 + z^2 - 2y - 1) = 0",
        bounds: Bounds { min: [-3.6, -3.2, -4.6], max: [3.6, 5.2, 4.6] },
        degree: Some(6),
        smooth: false,
        words: "bottle one-sided mobius möbius",
        story: "A closed surface with one side, which in space has to pass through itself. On the curve \
                of self-crossing the gradient vanishes: no method can place particles there by following \
                it, and this one says so.",
        source: "I. Stewart, Game, Set and Math, 1991",
        ..CLOSED
    },
];
