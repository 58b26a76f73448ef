//! Surfaces of several components, or that part as a slider moves.

use super::{CLOSED, Surface, parameter};
use crate::math::Bounds;

pub(super) const SURFACES: &[Surface] = &[
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
        genus: Some(0),
        words: "peanut bone dumbbell",
        story: "The points whose distances from two foci have the constant product b². For b just above \
                a it has a waist; at b = a that shrinks to a point, and below there are two eggs.",
        source: "E. W. Weisstein, Cassini Surface, MathWorld",
        ..CLOSED
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
        genus: Some(0),
        words: "blobs drops water balls",
        story: "Three bells of density and the surface where they add up to t: pull the centres apart \
                and the drops part. James Blinn introduced such blobs in 1982 to draw molecules.",
        source: "J. F. Blinn, A generalization of algebraic surface drawing, ACM Transactions on Graphics 1(3), 1982",
        ..CLOSED
    },
    Surface {
        id: "linked-rings",
        name: "Linked rings",
        formula: "min(hypot(hypot(x + R/2, y) - R, z), hypot(hypot(x - R/2, z) - R, y)) = r",
        parameters: &[
            parameter("R", "Radius of the rings", 0.75, [0.6, 0.85, 0.01]),
            parameter("r", "Radius of the tubes", 0.26, [0.08, 0.28, 0.01]),
        ],
        bounds: Bounds::symmetric([1.65, 1.2, 1.2]),
        words: "knot chain links hopf jewellery",
        story: "Two tori, each through the hole of the other: a Hopf link. The smaller of two distances \
                joins two bodies without a blend, and no front can pass from one ring to the other.",
        source: "H. Hopf, Über die Abbildungen der dreidimensionalen Sphäre auf die Kugelfläche, Mathematische Annalen 104, 1931",
        ..CLOSED
    },
    Surface {
        id: "ball-lattice",
        name: "Ball lattice",
        formula: "t = cos(x) + cos(y) + cos(z)",
        parameters: &[parameter("t", "Level", 1.25, [1.15, 2.8, 0.01])],
        bounds: Bounds::cube(8.9),
        words: "crystal atoms grid packing",
        story: "The formula of Schwarz P at a level above one, where the chambers have come apart: 27 equal \
                bodies, and 27 seeds. Each of them is closed, so their Euler numbers add up to 54.",
        source: "H. G. von Schnering and R. Nesper, Nodal surfaces of Fourier series, Zeitschrift für Physik B 83, 1991",
        ..CLOSED
    },
    Surface {
        id: "nested-spheres",
        name: "Nested spheres",
        formula: "(x^2 + y^2 + z^2 - 1) (x^2 + y^2 + z^2 - b^2) (x^2 + y^2 + z^2 - b^4) = 0",
        parameters: &[parameter("b", "Ratio of the radii", 0.8, [0.6, 0.95, 0.005])],
        bounds: Bounds::cube(1.1),
        degree: Some(6),
        words: "onion shells hollow",
        story: "Three spheres about one centre, by a product of their formulas. Raise b and they become thin \
                sheets: particles of one sheet must not answer for those of the next, although they are \
                close.",
        source: "Made for this gallery",
        ..CLOSED
    },
];
