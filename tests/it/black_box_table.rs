//! Functions of which nothing but values is known, with edges: solids as code writes them.

use glam::{DMat3, DVec2, DVec3, dvec2, dvec3};

pub(crate) type Function = Box<dyn Fn(DVec3) -> f64 + Send + Sync>;

/// A solid, with the Euler number of its surface, its creases and corners, and its volume where
/// that is known.
pub(crate) struct Solid {
    pub(crate) name: &'static str,
    pub(crate) euler: i64,
    pub(crate) creases: usize,
    pub(crate) corners: usize,
    pub(crate) volume: Option<f64>,
    pub(crate) f: Function,
}

fn solid(
    name: &'static str,
    (euler, creases, corners): (i64, usize, usize),
    volume: impl Into<Option<f64>>,
    f: impl Fn(DVec3) -> f64 + Send + Sync + 'static,
) -> Solid {
    Solid { name, euler, creases, corners, volume: volume.into(), f: Box::new(f) }
}

pub(crate) fn block(p: DVec3, half: DVec3) -> f64 {
    (p.abs() - half).max_element()
}

fn hexagon(p: DVec3, radius: f64, half: f64) -> f64 {
    let normals = [0.0, 1.0, 2.0].map(|k| DVec2::from_angle(k * core::f64::consts::FRAC_PI_3));
    let far = normals.into_iter().map(|n| p.truncate().dot(n).abs()).fold(0.0, f64::max);
    (far - radius).max(p.z.abs() - half)
}

/// A cube under a roof of this angle.
fn roof(p: DVec3, degrees: f64) -> f64 {
    let slope = (90.0 - 0.5 * degrees).to_radians();
    let n = dvec3(libm::sin(slope), 0.0, libm::cos(slope));
    block(p, DVec3::splat(0.8)).max(dvec3(p.x.abs(), p.y, p.z).dot(n) - 0.5)
}

fn nearest_of(x: f64, spacing: f64, most: f64) -> f64 {
    x - spacing * (x / spacing).round().clamp(-most, most)
}

pub(crate) fn solids() -> Vec<Solid> {
    let tau = core::f64::consts::TAU;
    let ball = |centre: f64, radius: f64| move |p: DVec3| p.distance(centre * DVec3::X) - radius;
    let tubes = |p: DVec3| {
        let across = [p.truncate().length(), libm::hypot(p.y, p.z), libm::hypot(p.x, p.z)];
        across.into_iter().fold(f64::INFINITY, f64::min) - 0.5
    };
    vec![
        solid("a cube", (2, 12, 8), 4.096, |p| block(p, DVec3::splat(0.8))),
        solid("a drilled block", (0, 14, 8), 4.0 - 0.16 * 0.5 * tau, |p| {
            block(p, dvec3(1.0, 1.0, 0.5)).max(0.4 - p.truncate().length())
        }),
        solid("a ball in a box, less three tubes", (-8, 24, 8), None, move |p| {
            (p.length() - 1.0).max(block(p, DVec3::splat(0.75))).max(-tubes(p))
        }),
        solid("two balls", (2, 1, 0), None, move |p| ball(0.5, 0.8)(p).min(ball(-0.5, 0.8)(p))),
        solid("a bitten ball", (2, 1, 0), None, move |p| ball(0.0, 0.9)(p).max(-ball(0.8, 0.6)(p))),
        solid("an octahedron", (2, 12, 6), 4.0 / 3.0, |p| (p.abs().element_sum() - 1.0) / 3.0_f64.sqrt()),
        solid("a bolt", (2, 18, 12), 1.8 * 2.0 * 3.0_f64.sqrt() * 0.25, |p| hexagon(p, 0.5, 0.9)),
        solid("a nut", (2, 18, 12), 0.6 * 2.0 * 3.0_f64.sqrt() * 0.81, |p| hexagon(p, 0.9, 0.3)),
        solid("a capped cone", (2, 2, 0), None, |p| {
            (p.truncate().length() - 0.5 * (0.8 - p.z)).max(p.z.abs() - 0.6)
        }),
        solid("an L", (2, 18, 12), 0.8 * (1.8 * 1.8 - 1.0 * 0.7), |p| {
            block(p, dvec3(0.9, 0.9, 0.4)).max((0.1 - p.x).min(-0.2 - p.y))
        }),
        solid("a twisted bar", (2, 12, 8), 1.6, |p| {
            let turned = DVec2::from_angle(0.7 * p.z).rotate(p.truncate());
            block(turned.extend(p.z), dvec3(0.5, 0.5, 0.8)) * 0.8
        }),
        // Within the bar its distance is that to a side, not one of the largest coordinate.
        solid("a twisted bar by its distance", (2, 12, 8), 1.92, |p| {
            let turned = DVec2::from_angle(0.8 * p.z).rotate(p.truncate());
            let q = turned.extend(p.z).abs() - dvec3(0.6, 0.4, 1.0);
            q.max(DVec3::ZERO).length() + q.max_element().min(0.0)
        }),
        solid("two blocks that share a face", (2, 12, 8), 1.92, |p| {
            block(dvec3(p.x.abs() - 0.4, p.y, p.z), dvec3(0.4, 0.5, 0.6))
        }),
        solid("nine boxes by round", (18, 108, 72), 0.864, |p| {
            block(dvec3(nearest_of(p.x, 0.6, 1.0), nearest_of(p.y, 0.6, 1.0), p.z), dvec3(0.2, 0.2, 0.3))
        }),
        solid("a roof of 150°", (2, 15, 10), None, |p| roof(p, 150.0)),
        solid("a roof of 175°", (2, 15, 10), None, |p| roof(p, 175.0)),
        solid("a star", (2, 30, 20), None, move |p| {
            let angle = libm::atan2(p.y, p.x);
            let aside = (angle - (angle / tau * 5.0).round() * tau / 5.0).abs();
            let q = p.truncate().length() * dvec2(libm::cos(aside), libm::sin(aside));
            (q.x * 0.6 + q.y * 0.8 - 0.5).max(p.z.abs() - 0.4)
        }),
        solid("a lens", (2, 1, 0), None, |p| {
            (p - 0.8 * DVec3::Z).length().max((p + 0.8 * DVec3::Z).length()) - 1.0
        }),
        solid("a pipe", (0, 4, 0), 0.39 * 0.5 * tau * 1.4, |p| {
            let r = p.truncate().length();
            (r - 0.8).max(0.5 - r).max(p.z.abs() - 0.7)
        }),
        solid("stairs", (2, 24, 16), 1.4 * (1.8 * 0.6 + (1.2 + 0.6) * 0.5), |p| {
            let step = |x: f64, z: f64, half: f64| block(p - dvec3(x, 0.0, z), dvec3(half, 0.7, 0.3));
            step(0.0, -0.6, 0.9).min(step(0.3, -0.1, 0.6)).min(step(0.6, 0.4, 0.3))
        }),
        solid("a gear", (0, 4, 0), None, |p| {
            let r = p.truncate().length();
            (r - 0.8 - 0.08 * libm::sin(8.0 * libm::atan2(p.y, p.x))).max(0.3 - r).max(p.z.abs() - 0.2)
        }),
        solid("a bowl", (2, 2, 0), None, |p| ((p.length() - 0.9).abs() - 0.08).max(p.z - 0.3)),
        solid("a box of steep and flat functions", (2, 12, 8), 2.744, |p| {
            let q = p.abs() - 0.7;
            q.x.max(30.0 * q.y).max(0.05 * q.z)
        }),
        solid("a cube with its edges cut", (2, 48, 32), None, |p| {
            let q = p.abs();
            let cut = (q.x + q.y).max(q.y + q.z).max(q.z + q.x) / 2.0_f64.sqrt();
            (q.max_element() - 0.8).max(cut - 1.1)
        }),
    ]
}

/// The smooth minimum of two numbers by a polynomial: it is smaller than both where they differ by
/// less than `reach`.
pub(crate) fn smooth_min(a: f64, b: f64, reach: f64) -> f64 {
    let near = (reach - (a - b).abs()).max(0.0) / reach;
    a.min(b) - near * near * near * reach / 6.0
}

/// Solids of which edges fade out.
pub(crate) fn fading_solids() -> Vec<Solid> {
    let ball = |p: DVec3| p.distance(dvec3(0.6, 0.5, 0.7)) - 0.5;
    let at_corner = |p: DVec3| p.distance(DVec3::splat(0.7)) - 0.5;
    let cube = |p: DVec3| {
        let q = p.abs() - 0.7;
        q.max(DVec3::ZERO).length() + q.max_element().min(0.0)
    };
    vec![
        solid("a cube with a ball", (2, 12, 10), None, move |p| smooth_min(cube(p), ball(p), 0.2)),
        solid("a cube with a ball, by exponentials", (2, 12, 10), None, move |p| {
            let sum = libm::exp(-20.0 * cube(p)) + libm::exp(-20.0 * at_corner(p));
            -libm::log(sum) / 20.0
        }),
        solid("a ball with a crease", (2, 1, 2), None, |p| {
            let up = p.z.max(0.0);
            p.length() - 1.0 + 0.3 * p.x.abs() * up * up
        }),
    ]
}

fn named(name: &'static str, f: impl Fn(DVec3) -> f64 + Send + Sync + 'static) -> (&'static str, Function) {
    (name, Box::new(f))
}

fn turned(p: DVec3, axis: DVec3, angle: f64) -> DVec3 {
    DMat3::from_axis_angle(axis.normalize_or_zero(), angle) * p
}

/// The distance of a point of the plane from a segment.
fn from_segment(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let along = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    p.distance(a + along * (b - a))
}

/// A solid of a plane figure between two planes.
fn extruded(figure: f64, z: f64, half: f64) -> f64 {
    figure.max(z.abs() - half)
}

fn tube(p: DVec3) -> f64 {
    p.truncate().length()
}

/// Solids as people write them, of which only the function is given.
pub(crate) fn more_solids() -> Vec<(&'static str, Function)> {
    let tau = core::f64::consts::TAU;
    vec![
        named("steps side by side", |p| {
            let step = |y: f64, height: f64| {
                block(p - dvec3(0.0, y, 0.5 * height - 0.5), dvec3(0.6, 0.25, 0.5 * height))
            };
            step(-0.5, 0.3).min(step(0.0, 0.6)).min(step(0.5, 0.9))
        }),
        named("a gyroid wall cut by a box", |p| {
            let [x, y, z] = (4.0 * p).to_array().map(libm::sincos);
            let gyroid = x.0 * y.1 + y.0 * z.1 + z.0 * x.1;
            (gyroid.abs() / 4.0 - 0.1).max(block(p, DVec3::splat(0.9)))
        }),
        named("a clipped gear", move |p| {
            let teeth = (0.25 * libm::sin(10.0 * libm::atan2(p.y, p.x))).clamp(-0.08, 0.08);
            (tube(p) - 0.8 - teeth).max(0.25 - tube(p)).max(p.z.abs() - 0.2)
        }),
        named("a ball tangent to a face of a block", |p| {
            block(p, dvec3(0.5, 0.5, 0.5)).min((p + 0.2 * DVec3::Z).length() - 0.7)
        }),
        named("a block rounded by a ball tangent to its top", |p| {
            block(p, dvec3(0.5, 0.5, 0.5)).max((p + 0.2 * DVec3::Z).length() - 0.7)
        }),
        named("turned bodies", |p| {
            let q = turned(p, dvec3(1.0, 0.5, -0.3), 0.6);
            let box_less_hole = block(q, dvec3(0.7, 0.5, 0.4)).max(0.25 - libm::hypot(q.y, q.z));
            let cone = turned(p - dvec3(0.2, 0.4, 0.3), dvec3(-0.4, 1.0, 0.2), 1.1);
            let cone = (0.8 * tube(cone) + 0.6 * cone.z - 0.3).max(-0.5 - cone.z);
            box_less_hole.min(cone).max(0.4 - p.distance(dvec3(-0.5, -0.4, 0.5)))
        }),
        named("a block with chamfers", |p| {
            let q = p.abs();
            block(p, dvec3(0.8, 0.6, 0.5))
                .max((q.x + q.z - 1.15) / 2.0_f64.sqrt())
                .max((q.y + q.z - 0.95) * 0.8)
        }),
        named("a bracket with holes", |p| {
            let plates = block(p - dvec3(0.0, 0.0, -0.5), dvec3(0.7, 0.5, 0.12))
                .min(block(p - dvec3(-0.58, 0.0, 0.0), dvec3(0.12, 0.5, 0.62)));
            let rib = block(p, dvec3(0.6, 0.08, 0.5)).max((p.x + p.z) / 2.0_f64.sqrt());
            let hole = |x: f64, y: f64| libm::hypot(p.x - x, p.y - y) - 0.12;
            let side = libm::hypot(p.y, p.z - 0.3) - 0.15;
            plates.min(rib).max(-hole(0.4, 0.25)).max(-hole(0.4, -0.25)).max(-side)
        }),
        named("a plate with dimples", |p| {
            let cell = |x: f64| x - 0.4 * (x / 0.4).round().clamp(-1.0, 1.0);
            let ball = dvec3(cell(p.x), cell(p.y), p.z - 0.25).length() - 0.18;
            block(p, dvec3(0.8, 0.8, 0.2)).max(-ball)
        }),
        named("a capsule through a block", |p| {
            let along = p.x.clamp(-0.8, 0.8);
            ((p - along * DVec3::X).length() - 0.2).min(block(p, dvec3(0.3, 0.4, 0.5)))
        }),
        named("a box blended with a ball", |p| {
            let (a, b, k) = (block(p, dvec3(0.7, 0.5, 0.4)), p.distance(dvec3(0.3, 0.2, 0.5)) - 0.4, 0.2);
            let h = (k - (a - b).abs()).max(0.0) / k;
            a.min(b) - h * h * k * 0.25
        }),
        named("a twisted bracket", |p| {
            let (sine, cosine) = libm::sincos(0.9 * p.z);
            let q = dvec2(cosine * p.x + sine * p.y, cosine * p.y - sine * p.x);
            let figure = ((q + 0.35).abs() - dvec2(0.6, 0.15)).max_element();
            let figure = figure.min(((q - dvec2(-0.8, 0.1)).abs() - dvec2(0.15, 0.6)).max_element());
            0.7 * extruded(figure, p.z, 0.8)
        }),
        named("a shell with a hole", |p| {
            ((p.length() - 0.8).abs() - 0.1).max(0.35 - libm::hypot(p.x, p.y).max(-p.z))
        }),
        named("a letter", |p| {
            let q = p.truncate();
            let stroke = |a: DVec2, b: DVec2| from_segment(q, a, b) - 0.13;
            let figure = stroke(dvec2(-0.6, -0.8), dvec2(0.0, 0.8))
                .min(stroke(dvec2(0.0, 0.8), dvec2(0.6, -0.8)))
                .min(stroke(dvec2(-0.35, -0.15), dvec2(0.35, -0.15)));
            extruded(figure, p.z, 0.25)
        }),
        named("a letter of boxes", |p| {
            let bar = |x: f64, y: f64, a: f64, b: f64| {
                ((p.truncate() - dvec2(x, y)).abs() - dvec2(a, b)).max_element()
            };
            let figure = bar(-0.4, 0.0, 0.12, 0.8)
                .min(bar(0.0, 0.68, 0.5, 0.12))
                .min(bar(-0.05, 0.0, 0.4, 0.12))
                .min(bar(0.0, -0.68, 0.5, 0.12));
            extruded(figure, p.z, 0.25)
        }),
        named("a gear of straight teeth", move |p| {
            let angle = libm::atan2(p.y, p.x);
            let aside = angle - (angle / tau * 12.0).round() * tau / 12.0;
            let q = tube(p) * dvec2(libm::cos(aside), libm::sin(aside).abs());
            let tooth = (q.x - 0.95).max(q.x * 0.25 + q.y - 0.33);
            extruded(tooth.min(tube(p) - 0.75).max(0.3 - tube(p)), p.z, 0.2)
        }),
        named("half a torus", |p| (libm::hypot(tube(p) - 0.7, p.z) - 0.25).max(p.x + 0.3 * p.z)),
        named("three cylinders in common", |p| {
            tube(p).max(libm::hypot(p.y, p.z)).max(libm::hypot(p.x, p.z)) - 0.8
        }),
        named("crossing pipes of one radius", |p| {
            let pipe = |r: f64, z: f64| (r - 0.4).max(z.abs() - 1.0);
            pipe(libm::hypot(p.y, p.z), p.x).min(pipe(libm::hypot(p.x, p.z), p.y))
        }),
        named("a cone", |p| (0.8 * tube(p) + 0.6 * p.z - 0.4).max(-0.6 - p.z)),
        named("a wedge of 20°", |p| {
            let q = turned(p, dvec3(0.3, 1.0, 0.2), 0.4);
            let (sine, cosine) = libm::sincos(10_f64.to_radians());
            (cosine * q.z.abs() + sine * (q.x - 0.9)).max(-0.8 - q.x).max(q.y.abs() - 0.6)
        }),
        named("a dodecahedron", |p| {
            let (golden, q) = (0.5 * (1.0 + 5.0_f64.sqrt()), p.abs());
            let length = libm::hypot(1.0, golden);
            [dvec3(0.0, 1.0, golden), dvec3(1.0, golden, 0.0), dvec3(golden, 0.0, 1.0)]
                .map(|n| q.dot(n) / length)
                .into_iter()
                .fold(0.0, f64::max)
                - 0.8
        }),
        named("a Menger sponge", |p| {
            let cross = |q: DVec3, half: f64| {
                let q = q.abs();
                (q.x.max(q.y)).min(q.y.max(q.z)).min(q.z.max(q.x)) - half
            };
            let cell = |x: f64| x - 0.6 * (x / 0.6).round();
            let small = cross(dvec3(cell(p.x), cell(p.y), cell(p.z)), 0.1);
            block(p, DVec3::splat(0.9)).max(-cross(p, 0.3)).max(-small)
        }),
        named("a box with thin walls", |p| {
            block(p, dvec3(0.8, 0.6, 0.5)).max(-block(p - dvec3(0.0, 0.0, 0.1), dvec3(0.74, 0.54, 0.54)))
        }),
        named("a screw", move |p| {
            let turn = libm::atan2(p.y, p.x) / tau + p.z / 0.35;
            let ridge = (2.0 * (turn - turn.round())).abs();
            (0.6 * (tube(p) - 0.5 - 0.2 * ridge)).max(p.z.abs() - 0.7)
        }),
        named("a waved block", |p| {
            (0.5 * (p.z - 0.2 - 0.15 * libm::sin(5.0 * p.x) * libm::cos(4.0 * p.y)))
                .max(block(p, dvec3(0.9, 0.8, 0.6)))
        }),
        named("a jack", |p| {
            let q = p.abs();
            let bar = |x: f64, y: f64, z: f64| (x - 0.9).max(y - 0.2).max(z - 0.2);
            bar(q.x, q.y, q.z).min(bar(q.y, q.z, q.x)).min(bar(q.z, q.x, q.y))
        }),
        named("a countersunk plate", |p| {
            let q = (p.truncate().abs() - 0.45).extend(p.z);
            block(p, dvec3(0.9, 0.9, 0.2)).max(0.12 - tube(q)).max((p.z - tube(q) + 0.05) / 2.0_f64.sqrt())
        }),
        named("an extruded rounded rectangle", |p| {
            let q = (p.truncate().abs() - dvec2(0.5, 0.3)).max(DVec2::ZERO).length() - 0.25;
            extruded(q, p.z, 0.4)
        }),
        named("a pipe bent in a box", |p| {
            let ring = libm::hypot(tube(p) - 0.6, p.z);
            let quarter = (ring - 0.3).max(0.2 - ring).max(-p.x).max(-p.y);
            quarter.min(block(p - dvec3(0.6, -0.1, 0.0), dvec3(0.4, 0.1, 0.4)))
        }),
    ]
}
