//! Surfaces that go on beyond the box, other than those that repeat.

use super::{OPEN, Surface, parameter};
use crate::math::Bounds;

pub(super) const SURFACES: &[Surface] = &[
    Surface {
        id: "plane",
        name: "Plane",
        formula: "z = a x + b y",
        parameters: &[
            parameter("a", "Slope along x", -0.4, [-0.6, 0.6, 0.01]),
            parameter("b", "Slope along y", -0.3, [-0.6, 0.6, 0.01]),
        ],
        bounds: Bounds::symmetric([1.0, 1.0, 0.8]),
        degree: Some(1),
        words: "flat sheet floor line square",
        story: "Here the front is perfect: level k has exactly 6k particles, and nothing is left for the \
                relaxation to do. Of all arrangements of equal discs in the plane this lattice is the \
                densest.",
        source: "L. Fejes Tóth, Lagerungen in der Ebene, auf der Kugel und im Raum, 1953",
        ..OPEN
    },
    Surface {
        id: "cylinder",
        name: "Cylinder",
        formula: "x^2 + y^2 = r^2",
        parameters: &[parameter("r", "Radius", 0.8, [0.3, 1.1, 0.01])],
        bounds: Bounds::symmetric([1.2, 1.2, 1.5]),
        degree: Some(2),
        words: "pipe tube rod can circle column",
        story: "A plane rolled up without stretching, so the hexagons fit everywhere but on the line where \
                the front meets itself. Its area, 2πr times the height, tests what the report says.",
        source: "C. F. Gauss, Disquisitiones generales circa superficies curvas, 1828",
        ..OPEN
    },
    Surface {
        id: "hyperboloid",
        name: "Hyperboloid",
        formula: "x^2 + y^2 - z^2 = t",
        parameters: &[parameter("t", "Level", 0.15, [-0.6, 0.8, 0.01])],
        bounds: Bounds::symmetric([1.5, 1.5, 1.2]),
        degree: Some(2),
        words: "cooling tower hourglass chair cone hyperbola",
        story: "Two straight lines through each of its points make the shape of cooling towers. Lower t to \
                zero and the waist closes to a cone; below it there are two bowls.",
        source: "C. Wren, Generatio corporis cylindroidis hyperbolici, Philosophical Transactions 4, 1669",
        ..OPEN
    },
    Surface {
        id: "catenoid",
        name: "Catenoid",
        formula: "hypot(x, y) = c cosh(z/c)",
        parameters: &[parameter("c", "Radius of the waist", 0.6, [0.45, 0.8, 0.01])],
        bounds: Bounds::symmetric([1.7, 1.7, 1.0]),
        words: "soap film minimal vase",
        story: "The soap film between two rings, and the first minimal surface after the plane. Leonhard \
                Euler found it in 1744; cut open, it can be bent into a helicoid without stretching.",
        source: "L. Euler, Methodus inveniendi lineas curvas, 1744",
        ..OPEN
    },
    Surface {
        id: "helicoid",
        name: "Helicoid",
        formula: "x sin(k z) = y cos(k z)",
        parameters: &[parameter("k", "Twist", 1.0, [0.3, 2.5, 0.01])],
        bounds: Bounds::symmetric([2.0, 2.0, 3.2]),
        words: "screw thread spiral staircase auger drill ramp helix",
        story: "The surface of a spiral staircase, swept by a line that turns as it climbs. Among the \
                surfaces made of straight lines only it and the plane are minimal, as Eugène Catalan \
                proved in 1842.",
        source: "E. Catalan, Journal de mathématiques pures et appliquées 7, 1842",
        ..OPEN
    },
    Surface {
        id: "monkey-saddle",
        name: "Monkey saddle",
        formula: "z = a (x^3 - 3x y^2)",
        parameters: &[parameter("a", "Height", 0.6, [0.1, 1.0, 0.01])],
        bounds: Bounds::cube(1.2),
        degree: Some(3),
        words: "saddle chip crisp",
        story: "A saddle with three valleys, two for the legs and one for the tail. In the middle both \
                principal curvatures are zero, so no direction is special there.",
        source: "D. Hilbert and S. Cohn-Vossen, Anschauliche Geometrie, 1932",
        ..OPEN
    },
    Surface {
        id: "fermat-cubic",
        name: "Fermat cubic",
        formula: "x^3 + y^3 + z^3 = 1",
        bounds: Bounds::cube(1.6),
        degree: Some(3),
        words: "cubic algebraic",
        story: "Three of its 27 straight lines are real. Its rational points are the solutions of a³ + b³ + c³ = d³ \
                in whole numbers, such as 3³ + 4³ + 5³ = 6³, all of which Leonhard Euler described.",
        source: "G. H. Hardy and E. M. Wright, An Introduction to the Theory of Numbers, 1938",
        ..OPEN
    },
    Surface {
        id: "clebsch",
        name: "Clebsch cubic",
        formula: "81(x^3 + y^3 + z^3) - 189(x^2 (y + z) + y^2 (z + x) + z^2 (x + y)) + 54x y z + 126(x y + y z + z x) - 9(x^2 + y^2 + z^2) - 9(x + y + z) + 1 = 0",
        bounds: Bounds::cube(1.2),
        degree: Some(3),
        words: "cubic lines algebraic",
        story: "Every smooth cubic surface carries 27 straight lines, and on this one, found by Alfred \
                Clebsch in 1871, all of them are real. In ten points three of the lines meet.",
        source: "A. Clebsch, Mathematische Annalen 4, 1871",
        ..OPEN
    },
];
