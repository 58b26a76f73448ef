//! Whether single precision holds the values of a field. If not, the field is evaluated in double
//! precision, compressed to a scale that is found here.

use super::grid::CELLS;
use super::survey::{FEW, SAMPLES, ulps};
use crate::field::{Enclosure, Evaluator};
use crate::math::{Bounds, Interval, Sym3, median};
use crate::particles::Particles;
use glam::{DVec3, Vec3};

/// Nodes along each side of the grid on which both precisions are compared: 729 in all, of which
/// [`MOST_LOST`] allows 15.
const SIDE: usize = 9;
/// Share of the nodes that single precision may lose. A choice.
const MOST_LOST: f64 = 0.02;
/// One in so many nodes is used to measure the distance by which single precision moves the level
/// set: a hundred are enough for a median, and as 7 does not divide [`SIDE`] they are in all rows.
const ONE_IN: usize = 7;
/// Double precision is used if the median of those distances is more than this times the distance
/// by which single precision rounds coordinates. On the gallery's formulas it is at most 0.3 times
/// that.
const MOST_BLUR: f64 = 4.0;
/// Nodes along each side of the grid on which the gradient at the surface is measured: 4,096, a
/// tenth of the survey's.
const FINE_SIDE: usize = 16;
/// Share of the distance between neighbours by which rounding may move a particle: a five-hundredth
/// of the scatter of such distances on a relaxed surface.
const MOST_MOVED: f64 = 1e-4;
/// Lengths of the rays on which rounding is measured, as shares of the distance between neighbours.
/// On the first one, curvature with that distance as radius moves a surface by half of
/// [`MOST_MOVED`]. The longer ones measure more.
const REACHES: [f64; 4] = [0.01, 0.04, 0.16, 0.64];
/// A scatter below this share of the length of a ray is resolved on it.
const RESOLVED: f64 = 0.2;
/// Points of a ray.
const ON_RAY: u32 = 4;
/// Least slope along a ray, as a share of the slope of f: on a ray along the surface f is constant,
/// rounded or not.
const LEAST_SLOPE: f64 = 0.3;
/// Largest error over the scatter of a few points.
const WORST: f64 = 4.0;

/// Rounding of f at a particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Blur {
    /// Index of the particle.
    pub(crate) particle: usize,
    /// Largest distance by which double precision moves the level set there.
    pub(crate) distance: f64,
}

/// Finds the particle, among a selection, at which rounding in double precision moves the level set
/// farthest in relation to the particle's size. None if it moves by less than [`MOST_MOVED`], or if
/// f has no bounds. The bounds of f at a single point are at least as wide as its rounding error
/// there. They are far wider where f jumps at the point, or repeats an operation many times, so the
/// error is [measured](scatter) before it counts.
pub(crate) fn blur(field: &mut dyn Evaluator, particles: &Particles) -> Option<Blur> {
    let field = field.bounded()?;
    let mut most = (MOST_MOVED, None);
    for particle in (0..particles.len()).step_by(particles.len().div_ceil(SAMPLES).max(1)) {
        let place = particles.local[particle].as_dvec3();
        let at = [Bounds::point(place)];
        // The particle lies on the nearest of the factors.
        let of_factors = (0..field.factors()).map(|factor| {
            let mut known = [Enclosure::UNKNOWN];
            field.enclose(factor, &at, &mut known);
            let (value, gradient) = known[0].middle();
            let half_width = 0.5 * (known[0].value.hi - known[0].value.lo);
            let mut second = [Sym3::splat(Interval::EVERYTHING)];
            field.enclose_second(factor, &at, &mut second);
            let bend = second[0].entries().into_iter().map(Interval::magnitude).fold(0.0, f64::max);
            // At the tip of a cone f has no slope: it changes with the square of the distance.
            [value.abs(), half_width]
                .map(|difference| (difference / gradient.length()).min((2.0 * difference / bend).sqrt()))
        });
        let [_, bound] = of_factors.min_by(|a, b| a[0].total_cmp(&b[0]))?;
        let spacing = 2.0 * f64::from(particles.radius[particle]);
        if bound.is_finite() && bound > most.0 * spacing {
            let distance = bound.min(WORST * scatter(field, place, spacing));
            if distance > most.0 * spacing {
                most = (distance / spacing, Some(Blur { particle, distance }));
            }
        }
    }
    most.1
}

/// Measures the distance by which rounding in double precision moves the level set at a point of
/// the surface: the difference of f from its linear part on rays from there. A jump or a kink at
/// the point shows on some of the rays, rounding on all.
fn scatter(field: &mut dyn Evaluator, p: DVec3, spacing: f64) -> f64 {
    let (value, gradient) = field.value_and_gradient(p);
    let slope = gradient.length();
    let rays: Vec<DVec3> = Bounds::cube(1.0)
        .corners()
        .map(DVec3::normalize_or_zero)
        .into_iter()
        .filter(|ray| ray.dot(gradient).abs() > LEAST_SLOPE * slope)
        .collect();
    let mut least = f64::INFINITY;
    for reach in REACHES.map(|share| share * spacing) {
        let difference = |field: &mut dyn Evaluator, way: DVec3| {
            (field.value_and_gradient(p + way).0 - value - gradient.dot(way)).abs() / slope
        };
        let mut largest = |ray: DVec3| {
            let ways = (1..=ON_RAY).map(|k| ray * (reach * f64::from(k) / f64::from(ON_RAY)));
            ways.map(|way| difference(field, way)).fold(0.0, f64::max)
        };
        least = rays.iter().map(|&ray| largest(ray)).fold(f64::INFINITY, f64::min);
        // A value that is constant between roundings differs by the reach itself.
        if least < RESOLVED * reach {
            break;
        }
    }
    least
}

/// The scale at which the field is compressed in double precision; none if single precision
/// suffices. It does if it gives a value, above underflow, at nearly all places where double
/// precision does, and if its rounding moves level sets hardly more than the rounding of
/// coordinates.
pub(crate) fn double_scale(field: &mut dyn Evaluator, bounds: &Bounds) -> Option<f64> {
    let points: Vec<Vec3> = bounds.spread(SIDE).map(|p| p.as_vec3()).collect();
    let (mut value, mut gradient) = (vec![0.0; points.len()], vec![Vec3::ZERO; points.len()]);
    field.gradients(&points, &mut value, &mut gradient);
    let mut lost = 0;
    for (k, &p) in points.iter().enumerate() {
        let overflows = !(value[k].is_finite() && gradient[k].is_finite());
        if overflows || value[k].abs() < f32::MIN_POSITIVE {
            let jet = field.jet(p.as_dvec3());
            let is_there = jet.value.is_finite() && jet.gradient.is_finite();
            lost += usize::from(is_there && (overflows || jet.value != 0.0));
        }
    }
    let is_lost = lost as f64 > MOST_LOST * points.len() as f64;
    (is_lost || is_blurred(field, bounds, &points, &value)).then(|| scale(field, bounds))
}

/// Whether the rounding of `values`, which are in single precision, moves level sets by far more
/// than the rounding of the coordinates does: f is small compared with its terms, as cos(0.001 x) −
/// 0.999999 is. A field without bounds has only one precision.
fn is_blurred(field: &mut dyn Evaluator, bounds: &Bounds, points: &[Vec3], values: &[f32]) -> bool {
    if field.bounded().is_none() {
        return false;
    }
    let values: Vec<f64> = values.iter().step_by(ONE_IN).map(|&value| value.into()).collect();
    let points: Vec<Vec3> = points.iter().step_by(ONE_IN).copied().collect();
    let (mut exact, mut gradient) = (vec![0.0; points.len()], vec![DVec3::ZERO; points.len()]);
    field.exact_gradients(&points, &mut exact, &mut gradient);
    let moves = (0..points.len())
        .map(|k| (values[k] - exact[k]).abs() / gradient[k].length())
        .filter(|distance| distance.is_finite());
    median(moves.collect()).is_some_and(|usual| usual > MOST_BLUR * f64::from(ulps(bounds)))
}

/// Whether f overflows double precision somewhere.
pub(crate) fn overflows_double(field: &mut dyn Evaluator, bounds: &Bounds) -> bool {
    bounds.spread(SIDE).any(|p| field.jet(p).value.is_infinite())
}

/// Whether f has different values in a box, which single precision may not distinguish.
pub(crate) fn varies(field: &mut dyn Evaluator, bounds: &Bounds) -> bool {
    let mut values = bounds.spread(SIDE).map(|p| field.jet(p).value).filter(|value| value.is_finite());
    values.next().is_some_and(|first| values.any(|value| value != first))
}

/// The usual |∇f| at the surface times the width of a cell of the survey; the usual |f| if no
/// surface is found.
fn scale(field: &mut dyn Evaluator, bounds: &Bounds) -> f64 {
    let grid: Vec<DVec3> = bounds.spread(FINE_SIDE).collect();
    let value: Vec<f64> = grid.iter().map(|&p| field.jet(p).value).collect();
    let mut edges = Vec::new();
    for i in 0..grid.len() {
        for (axis, step) in [1, FINE_SIDE, FINE_SIDE * FINE_SIDE].into_iter().enumerate() {
            let is_last = i / FINE_SIDE.pow(axis as u32) % FINE_SIDE == FINE_SIDE - 1;
            if !is_last && value[i] * value[i + step].signum() < 0.0 && value[i + step].is_finite() {
                edges.push([i, i + step]);
            }
        }
    }
    let mut slopes = Vec::new();
    for &[a, b] in edges.iter().step_by(edges.len().div_ceil(FEW).max(1)) {
        let (mut from, mut to) = (grid[a], grid[b]);
        // As often as a number has digits.
        for _ in 0..f64::MANTISSA_DIGITS {
            let middle = 0.5 * (from + to);
            let is_before = (field.jet(middle).value > 0.0) == (value[a] > 0.0);
            if is_before { from = middle } else { to = middle }
        }
        slopes.push(field.jet(from).gradient.length());
    }
    let cell = (bounds.hi() - bounds.lo()).max_element() / CELLS;
    let usual = |mut sizes: Vec<f64>| {
        sizes.retain(|size| size.is_finite() && *size > 0.0);
        median(sizes)
    };
    let of_slopes = usual(slopes).map(|slope| slope * cell);
    of_slopes.or_else(|| usual(value.iter().map(|v| v.abs()).collect())).unwrap_or(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::formula::Formula;
    use crate::field::{Field, Frame};
    use crate::particles::Slots;

    /// The blur that is reported for a formula at some points.
    fn blur_at(text: &str, points: impl Iterator<Item = Vec3>) -> Option<Blur> {
        let mut particles = Particles::default();
        points.for_each(|p| particles.push(p, Vec3::Z, 0.01, Particles::NO_PARENT, 0, Slots::default()));
        let field = Formula::as_written(text, &[]).expect("a formula");
        blur(&mut *field.evaluator(Frame::default()), &particles)
    }

    #[test]
    fn a_jump_at_a_particle_is_no_rounding() {
        let mut state = 7_u32;
        let mut random = move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / 16_777_216.0
        };
        for case in 0..60 {
            let size = 0.05 + random();
            let jump =
                ["round(x)", "floor(x+0.5)", "fract(x+0.5)", "round(x)*round(y)", "mod(x+0.5,1)"][case % 5];
            let text = [
                format!("hypot(x-{size}*{jump},y,z)-0.7"),
                format!("hypot(x,y,z)-1-{size}*{jump}"),
                format!("z-{size}*fract(sin(floor(x+0.5)*12.9898+floor(y)*78.233)*43758.5453)"),
            ];
            // x is where the numbers jump.
            let points: Vec<Vec3> =
                (0..8).map(|k| Vec3::new(k as f32 - 3.5, 0.1 + 0.8 * random(), random())).collect();
            let said = blur_at(&text[case % 3], points.into_iter());
            assert_eq!(said, None, "{}", text[case % 3]);
        }
    }
}
