//! Closed surfaces in one piece.

use super::{CLOSED, Surface, parameter};
use crate::math::Bounds;

pub(super) const SURFACES: &[Surface] = &[
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
        genus: Some(0),
        words: "egg potato pill rugby ball ellipse oval round",
        story: "A sphere stretched by three different factors, the simplest closed surface whose \
                curvature varies from point to point. At each of its four umbilics the two principal \
                curvatures agree.",
        source: "D. Hilbert and S. Cohn-Vossen, Anschauliche Geometrie, 1932",
        ..CLOSED
    },
    Surface {
        id: "sphere",
        name: "Sphere",
        formula: "x^2 + y^2 + z^2 = r^2",
        parameters: &[parameter("r", "Radius", 1.0, [0.3, 1.2, 0.01])],
        bounds: Bounds::cube(1.25),
        degree: Some(2),
        genus: Some(0),
        words: "ball globe bubble planet circle round",
        story: "All points at one distance from a centre: the closed surface that holds the most volume \
                for its area. No lattice of six neighbours covers it, because the defects of valence \
                must add up to twelve.",
        source: "Archimedes, On the Sphere and Cylinder, about 225 BC",
        ..CLOSED
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
        genus: Some(1),
        words: "donut doughnut ring tyre tire bagel circle",
        story: "A circle of radius r carried around an axis at distance R; it is dome-shaped on the \
                outside and saddle-shaped on the inside. Its Euler number is zero, so that a covering \
                with six neighbours everywhere is possible.",
        source: "D. Hilbert and S. Cohn-Vossen, Anschauliche Geometrie, 1932",
        ..CLOSED
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
        genus: Some(1),
        words: "donut doughnut ring lopsided",
        story: "A torus seen in a spherical mirror: the tube swells on one side and narrows on the \
                other. All its lines of curvature are circles, which Charles Dupin found around 1802, \
                while still a student.",
        source: "C. Dupin, Applications de géométrie et de mécanique, 1822",
        ..CLOSED
    },
    Surface {
        id: "tanglecube",
        name: "Tanglecube",
        formula: "x^4 - 5x^2 + y^4 - 5y^2 + z^4 - 5z^2 + c = 0",
        parameters: &[parameter("c", "Level", 11.8, [7.0, 13.5, 0.05])],
        bounds: Bounds::cube(2.5),
        degree: Some(4),
        genus: Some(5),
        words: "dice block holes",
        story: "Eight balls at the corners of a cube, joined along its twelve edges to a surface of \
                genus five. Raise c past 12.5 and the bridges break.",
        source: "É. Goursat, Annales scientifiques de l'École normale supérieure 4, 1887",
        ..CLOSED
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
        genus: Some(0),
        words: "box cube cushion soap rounded square",
        story: "The sphere's formula with another exponent: 2 gives an ellipsoid, and growing exponents \
                turn it into a box with rounded edges. The designer and poet Piet Hein made the form \
                popular in the 1960s.",
        source: "A. H. Barr, Superquadrics and angle-preserving transformations, IEEE Computer Graphics and Applications 1(1), 1981",
        ..CLOSED
    },
    Surface {
        id: "double-torus",
        name: "Double torus",
        formula: "(x^2 (1 - x^2) - y^2)^2 + z^2 = c^2",
        parameters: &[parameter("c", "Thickness", 0.12, [0.05, 0.22, 0.005])],
        bounds: Bounds::symmetric([1.2, 0.72, 0.28]),
        degree: Some(8),
        genus: Some(2),
        words: "pretzel eight handles donut doughnut",
        story: "A plane figure of eight, Gerono's lemniscate, thickened until it is the skin of a body \
                with two holes. Squaring a curve's equation and adding z² does the same for any plane \
                curve.",
        source: "E. W. Weisstein, Double Torus, MathWorld",
        ..CLOSED
    },
    Surface {
        id: "tetrahedral-quartic",
        name: "Tetrahedral quartic",
        formula: "(x^2 + y^2 + z^2 - 5)^2 + 8x y z = t",
        parameters: &[parameter("t", "Level", 2.0, [-2.0, 6.0, 0.05])],
        bounds: Bounds::cube(3.0),
        degree: Some(4),
        genus: Some(3),
        words: "tetrahedron pyramid triangle",
        story: "Four balls joined along the six edges of a tetrahedron, which leaves three handles. At t = 0 \
                they only touch, in six cone points, and below there are four seeds for four components.",
        source: "É. Goursat, Annales scientifiques de l'École normale supérieure 4, 1887",
        ..CLOSED
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
        genus: Some(13),
        words: "cube cage lattice frame",
        story: "Six rings, one on each face of a cube, thick enough to melt together where they come \
                close. With the first settings it has genus thirteen; thin the rings and it falls apart \
                into six tori.",
        source: "P. Bourke, Geometry, surfaces, curves, polyhedra: Decocube, paulbourke.net",
        ..CLOSED
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
        genus: Some(5),
        words: "nut part machine bracket cad drill hole csg washer",
        story: "A cube cut to a ball and drilled along three axes: constructive solid geometry with \
                every sharp edge replaced by a smooth blend of width k. The crossing drill holes make \
                its genus five.",
        source: "A. Ricci, A constructive geometry for computer graphics, The Computer Journal 16(2), 1973",
        ..CLOSED
    },
    Surface {
        id: "chmutov",
        name: "Chmutov sextic",
        formula: "32x^6 - 48x^4 + 18x^2 - 1 + 32y^6 - 48y^4 + 18y^2 - 1 + 32z^6 - 48z^4 + 18z^2 - 1 = t",
        parameters: &[parameter("t", "Level", 0.0, [-0.8, 0.8, 0.01])],
        bounds: Bounds::cube(1.05),
        degree: Some(6),
        words: "chebyshev many holes",
        story: "The sum of three Chebyshev polynomials of degree six, whose even waves make a lattice of \
                bodies joined by thin necks. Sergei Chmutov used such sums in 1992 to build surfaces with \
                very many cone points, which open here as t leaves an odd number.",
        source: "S. V. Chmutov, Examples of projective surfaces with many singularities, Journal of Algebraic Geometry 1, 1992",
        ..CLOSED
    },
    Surface {
        id: "rippled-sphere",
        name: "Rippled sphere",
        formula: "hypot(x, y, z) = 1 + a sin(n x) sin(n y) sin(n z)",
        parameters: &[
            parameter("a", "Height of the ripples", 0.1, [0.0, 0.15, 0.005]),
            parameter("n", "Ripples", 5.0, [2.0, 8.0, 0.1]),
        ],
        bounds: Bounds::cube(1.2),
        genus: Some(0),
        words: "bumpy golf ball wave waves noise planet asteroid",
        story: "A sphere whose distance from the centre swings between 1 − a and 1 + a. Its curvature grows \
                with the square of n, so it shows well what adaptive sizes are for.",
        source: "Made for this gallery",
        ..CLOSED
    },
];
