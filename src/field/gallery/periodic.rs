//! Surfaces that repeat for ever; the box cuts a part out.

use super::{OPEN, Surface, parameter};
use crate::math::Bounds;

pub(super) const SURFACES: &[Surface] = &[
    Surface {
        id: "gyroid",
        name: "Gyroid",
        formula: "sin(x) cos(y) + sin(y) cos(z) + sin(z) cos(x) = t",
        parameters: &[parameter("t", "Level", 0.0, [-1.3, 1.3, 0.01])],
        // A little less than two periods, 4π, so that no slivers appear at the corners.
        bounds: Bounds::cube(6.2),
        words: "infill foam bone sponge scaffold tpms minimal printing",
        story: "It divides space into two labyrinths, each the mirror image of the other, and holds \
                neither a straight line nor a plane of symmetry. Alan Schoen found the minimal surface \
                that this formula closely follows in 1970; butterfly wings and block copolymers grow \
                it by themselves.",
        source: "A. H. Schoen, Infinite periodic minimal surfaces without self-intersections, NASA TN D-5541, 1970",
        ..OPEN
    },
    Surface {
        id: "schwarz-p",
        name: "Schwarz P",
        formula: "cos(x) + cos(y) + cos(z) = t",
        parameters: &[parameter("t", "Level", 0.0, [-0.95, 0.95, 0.01])],
        bounds: Bounds::cube(6.3),
        words: "infill foam scaffold tpms minimal pipes plumbing",
        story: "The primitive surface of Hermann Amandus Schwarz: chambers joined by necks along the \
                edges of a cubic lattice. The formula is the first term of the true minimal surface's \
                Fourier series, and already hard to tell from it.",
        source: "H. A. Schwarz, Gesammelte mathematische Abhandlungen 1, 1890",
        ..OPEN
    },
    Surface {
        id: "schwarz-d",
        name: "Schwarz D",
        formula: "sin(x) sin(y) sin(z) + sin(x) cos(y) cos(z) + cos(x) sin(y) cos(z) + cos(x) cos(y) sin(z) = t",
        parameters: &[parameter("t", "Level", 0.0, [-0.9, 0.9, 0.01])],
        // A little less than one period, 2π, so that no slivers appear at the corners.
        bounds: Bounds::cube(3.1),
        words: "infill diamond scaffold tpms minimal",
        story: "Two interlocking labyrinths whose tunnels run along the bonds of a diamond crystal. With \
                the P surface and the gyroid it belongs to one family: bending without stretching turns \
                each one into the others.",
        source: "H. A. Schwarz, Gesammelte mathematische Abhandlungen 1, 1890",
        ..OPEN
    },
    Surface {
        id: "neovius",
        name: "Neovius surface",
        formula: "3(cos(x) + cos(y) + cos(z)) + 4cos(x) cos(y) cos(z) = t",
        parameters: &[parameter("t", "Level", 0.0, [-0.9, 0.9, 0.01])],
        bounds: Bounds::cube(3.1),
        words: "infill scaffold tpms minimal",
        story: "The same symmetry as Schwarz P, but the chambers are joined along the twelve edges of a \
                cube. Edvard Neovius, a student of Schwarz, described the minimal surface that this formula \
                follows in 1883.",
        source: "E. R. Neovius, Bestimmung zweier speciellen periodischen Minimalflächen, 1883",
        ..OPEN
    },
    Surface {
        id: "i-wp",
        name: "Schoen I-WP",
        formula: "2(cos(x) cos(y) + cos(y) cos(z) + cos(z) cos(x)) - cos(2x) - cos(2y) - cos(2z) = t",
        parameters: &[parameter("t", "Level", 0.0, [-1.0, 1.0, 0.01])],
        bounds: Bounds::cube(3.1),
        words: "infill scaffold tpms minimal",
        story: "Unlike the gyroid it parts space into two labyrinths that are not alike: one follows the \
                bonds of a body-centred lattice, the other wraps around it. Alan Schoen named it after these \
                two graphs, I and wrapped package.",
        source: "A. H. Schoen, Infinite periodic minimal surfaces without self-intersections, NASA TN D-5541, 1970",
        ..OPEN
    },
    Surface {
        id: "scherk-doubly-periodic",
        name: "Scherk surface",
        formula: "cos(x) exp(z) = cos(y)",
        bounds: Bounds::symmetric([6.0, 6.0, 3.0]),
        words: "minimal chessboard checkerboard",
        story: "Saddles over the black fields of a chessboard, joined at its corners by vertical lines. \
                Heinrich Scherk gave this formula, exact and not an approximation, in 1835.",
        source: "H. F. Scherk, Journal für die reine und angewandte Mathematik 13, 1835",
        ..OPEN
    },
    Surface {
        id: "saddle-tower",
        name: "Saddle tower",
        formula: "sinh(x) sinh(y) = sin(z)",
        bounds: Bounds::symmetric([2.0, 2.0, 6.0]),
        words: "minimal scherk tower",
        story: "Two planes that cross are made one minimal surface by holes along the line of crossing, one \
                above the other. It is Scherk's other surface of 1835, and its formula too is exact.",
        source: "H. F. Scherk, Journal für die reine und angewandte Mathematik 13, 1835",
        ..OPEN
    },
];
