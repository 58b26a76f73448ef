//! Solids with sharp edges, of known shape and volume.

use core::f64::consts::PI;

/// A solid, with what is known of it.
#[derive(Clone, Copy)]
pub(crate) struct Solid {
    pub(crate) name: &'static str,
    pub(crate) formula: &'static str,
    pub(crate) euler: i64,
    pub(crate) volume: f64,
    /// Number of creases and corners.
    pub(crate) creases: [usize; 2],
}

const fn solid(
    name: &'static str,
    formula: &'static str,
    euler: i64,
    volume: f64,
    creases: [usize; 2],
) -> Solid {
    Solid { name, formula, euler, volume, creases }
}

/// Volume of the union of two unit balls whose centres are 1 apart: two balls less their lens of
/// 5π/12.
const TWO_BALLS: f64 = 8.0 * PI / 3.0 - 5.0 * PI / 12.0;

pub(crate) const SOLIDS: [Solid; 21] = [
    solid("cube", "max(abs(x), abs(y), abs(z)) - 1", 2, 8.0, [12, 8]),
    solid(
        "turned cube",
        "max(abs(0.36x + 0.48y - 0.8z), abs(-0.8x + 0.6y), abs(0.48x + 0.64y + 0.6z)) - 1",
        2,
        8.0,
        [12, 8],
    ),
    solid("octahedron", "abs(x) + abs(y) + abs(z) - 1", 2, 4.0 / 3.0, [12, 6]),
    solid("cylinder", "max(x^2 + y^2 - 1, abs(z) - 1)", 2, 2.0 * PI, [2, 0]),
    solid(
        "lens",
        "max((z - 0.5)^2 + x^2 + y^2 - 1, (z + 0.5)^2 + x^2 + y^2 - 1)",
        2,
        5.0 * PI / 12.0,
        [1, 0],
    ),
    solid("two balls", "min((x - 0.5)^2 + y^2 + z^2 - 1, (x + 0.5)^2 + y^2 + z^2 - 1)", 2, TWO_BALLS, [1, 0]),
    solid("bitten ball", "max(x^2 + y^2 + z^2 - 1, 1 - (x - 1)^2 - y^2 - z^2)", 2, 11.0 * PI / 12.0, [1, 0]),
    solid(
        "drilled block",
        "max(abs(x) - 1, abs(y) - 1, abs(z) - 0.4, 0.16 - x^2 - y^2)",
        0,
        0.8 * (4.0 - 0.16 * PI),
        [14, 8],
    ),
    solid(
        "plate with four holes",
        "max(abs(x) - 1, abs(y) - 1, abs(z) - 0.2, 0.04 - (abs(x) - 0.5)^2 - (abs(y) - 0.5)^2)",
        -6,
        0.4 * (4.0 - 0.16 * PI),
        [20, 8],
    ),
    // The edges of each pair cross where the surface is smooth.
    solid("three cylinders", "max(x^2 + y^2, y^2 + z^2, z^2 + x^2) - 1", 2, 4.686_291_501, [24, 14]),
    solid(
        "L",
        "max(min(max(abs(x - 0.5) - 0.5, abs(y - 1) - 1), max(abs(x - 1) - 1, abs(y - 0.5) - 0.5)), abs(z) - 0.5)",
        2,
        3.0,
        [18, 12],
    ),
    solid(
        "wedge of 10°",
        "max(z, 0.176327x - z, abs(y) - 1, -x - 1.5)",
        2,
        2.0 * 0.5 * 1.5 * 1.5 * 0.176_327,
        [9, 6],
    ),
    solid("half ball", "max(x^2 + y^2 + z^2 - 1, z)", 2, 2.0 * PI / 3.0, [1, 0]),
    solid(
        "prism",
        "max(abs(z) - 1, y - 0.5, 0.866025x - 0.5y - 0.5, -0.866025x - 0.5y - 0.5)",
        2,
        2.598_076 * 1.0,
        [9, 6],
    ),
    solid(
        "hexagonal nut",
        "max(abs(y), abs(0.8660254x + 0.5y), abs(0.8660254x - 0.5y), 1.5 - hypot(x, y), 0.6 + abs(z)) - 1",
        0,
        0.8 * (3.464_101_6 - 0.25 * PI),
        [20, 12],
    ),
    solid(
        "cross of three bars",
        "min(max(abs(x) - 1.2, abs(y) - 0.4, abs(z) - 0.4), max(abs(x) - 0.4, abs(y) - 1.2, abs(z) - 0.4), \
         max(abs(x) - 0.4, abs(y) - 0.4, abs(z) - 1.2))",
        2,
        3.584,
        [60, 32],
    ),
    solid(
        "drilled ball",
        "max(x^2 + y^2 + z^2 - 1, 0.09 - x^2 - y^2)",
        0,
        4.0 * PI / 3.0 * 0.868_084_7,
        [2, 0],
    ),
    solid("two cylinders", "max(x^2 + y^2, x^2 + z^2) - 1", 2, 16.0 / 3.0, [4, 2]),
    // The corner of the cuts is just outside the ball, and three creases are too short to be found
    // by themselves.
    solid(
        "ball with three cuts",
        "max(x^2 + y^2 + z^2 - 1, x - 0.5785, y - 0.5785, z - 0.5785)",
        2,
        2.809_211_7,
        [9, 6],
    ),
    // Of the next two, parts meet without an edge: wall and ball of the first on a circle of its
    // flat end, which the ball covers.
    solid(
        "rod with a round end",
        "min(max(hypot(x, y) - 0.5, abs(z) - 1), hypot(x, y, z - 1) - 0.5)",
        2,
        0.5 * PI + PI / 12.0,
        [1, 0],
    ),
    solid(
        "half a rounded box",
        "max(z, hypot(max(abs(x) - 1, 0), max(abs(y) - 0.7, 0), max(abs(z) - 0.5, 0)) \
         + min(max(abs(x) - 1, abs(y) - 0.7, abs(z) - 0.5), 0) - 0.2)",
        2,
        2.64 + 0.088 * PI + 0.016 / 3.0 * PI,
        [1, 0],
    ),
];
