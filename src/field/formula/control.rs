//! Parameters for which the surface passes through given points (Witkin and Heckbert 1994, §3,
//! "control").
//!
//! The rows of J are ∂f/∂q at the points, divided by |∇f| there, so that a residual is a distance.
//! Each parameter is in units of its range, so that none changes more only because its numbers are
//! larger. Each step is the shortest one that solves J δ = −r, that is δ = Jᵀ(J Jᵀ)⁻¹(−r). A
//! parameter that reaches an end of its range is held there, and the others are solved for again.
//!
//! # Differs from Witkin and Heckbert
//!
//! * The parameters are solved for from the places of the points, not integrated from velocities,
//!   so they do not depend on history.
//! * A small multiple of the unit matrix is added to J Jᵀ instead of a singular value
//!   decomposition.

use super::evaluator::FormulaEvaluator;
use super::graph::{Graph, Id, Node};
use super::{Formula, Parameter, scalar};
use crate::field::{Evaluator, Field, Frame};
use crate::math::newton::{self, StepLimits, step_to_surface};
use glam::DVec3;
use serde::Serialize;
use std::collections::BTreeMap;

/// The result of making a surface pass through points.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Grip {
    /// Whether the surface passes through all points. If not, it is as near as the ranges of the
    /// parameters allow.
    pub holds: bool,
    /// For each point, a nearby point of the surface, found down the gradient; the point itself if
    /// none is found.
    pub places: Vec<[f64; 3]>,
    /// The parameters that have changed, with their values.
    pub changed: BTreeMap<String, f64>,
    /// Names of the parameters that hardly move the surface at the points.
    pub idle: Vec<String>,
}

/// Maximum number of steps towards the points: enough to cross a range eight times by the longest
/// steps.
const MOST_STEPS: usize = 64;

/// A step changes a parameter by at most this share of its range, so that a surface that is pulled
/// far moves there gradually. With longer steps fewer pulls meet their points.
const LONGEST_STEP: f64 = 0.125;

/// A step that does not bring the surface nearer to the points is halved at most this often, to a
/// 2,000th of a range. Then the parameters stay where they are.
const MOST_HALVINGS: usize = 8;

/// The surface passes through a point at less than this distance, relative to the point's distance
/// from the origin or to 1: a hundredth of the rounding of particles, which are in single
/// precision.
const NEAR: f64 = 1e-9;

/// Multiple of the unit matrix added to J Jᵀ, relative to its largest diagonal entry: half of the
/// digits of double precision.
const RIDGE: f64 = 1e-8;

/// A parameter is idle if it moves the surface by less than this share of what the strongest one
/// does: less than a pixel while that one crosses the picture.
const IDLE: f64 = 1e-3;

/// f as a function of the parameters, three at a time.
struct ByParameters {
    /// The graph of f with three parameters and the coordinates exchanged.
    parts: Vec<(Graph, Id)>,
    scratch: scalar::Jets<0>,
}

impl ByParameters {
    fn new(graph: &Graph, root: Id, count: usize) -> Self {
        let parts = (0..count.max(1))
            .step_by(3)
            .map(|first| {
                let (part, roots) = graph.rewritten(&[root], |part, node| {
                    part.intern(match node {
                        Node::Coordinate(axis) => Node::Parameter(count as u32 + u32::from(axis)),
                        Node::Parameter(k) if (first..first + 3).contains(&(k as usize)) => {
                            Node::Coordinate((k as usize - first) as u8)
                        }
                        node => node,
                    })
                });
                (part, roots[0])
            })
            .collect();
        Self { parts, scratch: Vec::new() }
    }

    /// Puts ∂f/∂q at a point into `slopes`, with these values of the parameters, and returns f.
    fn slopes(&mut self, values: &[f64], p: DVec3, slopes: &mut [f64]) -> f64 {
        let mut all = values.to_vec();
        all.extend(p.to_array());
        let mut f = f64::NAN;
        for (part, (graph, root)) in self.parts.iter().enumerate() {
            let three = 3 * part..values.len().min(3 * part + 3);
            let mut point = [0.0; 3];
            point[..three.len()].copy_from_slice(&values[three.clone()]);
            scalar::jets(graph, *root, &all, [DVec3::from_array(point)], &mut self.scratch);
            let (value, first) = self.scratch[*root as usize][0].first_order();
            f = value;
            slopes[three.clone()].copy_from_slice(&first.to_array()[..three.len()]);
        }
        f
    }
}

/// The points, and what is known of f there.
struct Control<'a> {
    field: ByParameters,
    points: &'a [DVec3],
    /// |∇f| at each point before any change, or 1 if it is 0 or undefined.
    slope: Vec<f64>,
    /// The range of each parameter, and the ends of it; a value beyond an end may stay.
    range: Vec<f64>,
    ends: Vec<[f64; 2]>,
}

/// The distances of the surface from the points, to first order, and how each parameter changes
/// them: a row for each point.
struct Residuals {
    distance: Vec<f64>,
    rows: Vec<Vec<f64>>,
}

impl Residuals {
    fn sum_of_squares(&self) -> f64 {
        self.distance.iter().map(|r| r * r).sum()
    }
}

impl Control<'_> {
    fn residuals(&mut self, values: &[f64]) -> Residuals {
        let mut rows = vec![vec![0.0; values.len()]; self.points.len()];
        let mut distance = Vec::with_capacity(rows.len());
        for ((&p, row), slope) in self.points.iter().zip(&mut rows).zip(&self.slope) {
            distance.push(self.field.slopes(values, p, row) / slope);
            row.iter_mut().zip(&self.range).for_each(|(entry, range)| *entry *= range / slope);
        }
        Residuals { distance, rows }
    }

    /// The shortest step that brings the surface to the points to first order and no parameter
    /// beyond an end of its range, in units of the ranges.
    fn step(&self, residuals: &Residuals, values: &[f64]) -> Vec<f64> {
        let mut fixed = vec![None; values.len()];
        loop {
            let step = shortest_step(residuals, &fixed);
            let mut is_inside = true;
            for (k, fixed) in fixed.iter_mut().enumerate().filter(|(_, fixed)| fixed.is_none()) {
                let wanted = values[k] + step[k] * self.range[k];
                let possible = wanted.clamp(self.ends[k][0], self.ends[k][1]);
                if possible != wanted {
                    *fixed = Some((possible - values[k]) / self.range[k]);
                    is_inside = false;
                }
            }
            if is_inside {
                return step;
            }
        }
    }
}

/// The shortest δ with J δ = −r and with these entries fixed.
fn shortest_step(Residuals { distance, rows }: &Residuals, fixed: &[Option<f64>]) -> Vec<f64> {
    let free = |row: &[f64], other: &[f64]| -> f64 {
        row.iter().zip(other).zip(fixed).filter(|(_, fixed)| fixed.is_none()).map(|((a, b), _)| a * b).sum()
    };
    let mut matrix: Vec<Vec<f64>> =
        rows.iter().map(|row| rows.iter().map(|other| free(row, other)).collect()).collect();
    let largest = (0..rows.len()).map(|i| matrix[i][i]).fold(f64::MIN_POSITIVE, f64::max);
    (0..rows.len()).for_each(|i| matrix[i][i] += RIDGE * largest);
    let right = rows.iter().zip(distance).map(|(row, r)| {
        let moved: f64 = row.iter().zip(fixed).map(|(slope, fixed)| slope * fixed.unwrap_or(0.0)).sum();
        -r - moved
    });
    let multipliers = solve_positive(matrix, right.collect());
    (0..fixed.len())
        .map(|k| fixed[k].unwrap_or_else(|| rows.iter().zip(&multipliers).map(|(row, m)| row[k] * m).sum()))
        .collect()
}

/// Solves a linear system whose matrix is symmetric and positive definite, by elimination.
fn solve_positive(mut matrix: Vec<Vec<f64>>, mut right: Vec<f64>) -> Vec<f64> {
    let n = right.len();
    for pivot in 0..n {
        for row in pivot + 1..n {
            let factor = matrix[row][pivot] / matrix[pivot][pivot];
            let (above, below) = matrix.split_at_mut(row);
            below[0]
                .iter_mut()
                .zip(&above[pivot])
                .skip(pivot)
                .for_each(|(entry, upper)| *entry -= factor * upper);
            right[row] -= factor * right[pivot];
        }
    }
    for row in (0..n).rev() {
        let known: f64 = (row + 1..n).map(|k| matrix[row][k] * right[k]).sum();
        right[row] = (right[row] - known) / matrix[row][row];
    }
    right
}

/// The number with five significant digits, or whole, as links and number fields show it.
fn rounded(value: f64) -> f64 {
    let mut scale = 1.0;
    while (value * scale).abs() < 1e4 && scale < 1e12 {
        scale *= 10.0;
    }
    // A whole number divided by a power of ten is the double nearest to the decimal.
    (value * scale).round() / scale
}

impl Formula {
    /// Changes the parameters, each in units of its range, as little as possible so that the
    /// surface passes through these points, in the coordinates of the formula. If that is
    /// impossible, the surface comes as near as the ranges allow. Values are rounded to five
    /// significant digits.
    ///
    /// ```
    /// use marching_particles::field::formula::Formula;
    ///
    /// let mut field = Formula::parse("x^2/a^2 + y^2/b^2 + z^2 = 1")?;
    /// let grip = field.pass_through(&[(1.5, 0.0, 0.0).into()]);
    /// assert!(grip.holds);
    /// assert_eq!(grip.idle, ["b"]);
    /// assert_eq!(field.parameters()[0].value, 1.5);
    /// # Ok::<(), marching_particles::field::formula::FormulaError>(())
    /// ```
    #[doc(hidden)]
    pub fn pass_through(&mut self, points: &[DVec3]) -> Grip {
        let start = self.values.clone();
        let slope = points.iter().map(|&p| self.slope_at(p).filter(|slope| *slope > 0.0).unwrap_or(1.0));
        let mut control = Control {
            slope: slope.collect(),
            field: ByParameters::new(&self.compiled.graph, self.compiled.root, start.len()),
            points,
            range: self.parameters.iter().map(|p| if p.max > p.min { p.max - p.min } else { 1.0 }).collect(),
            ends: self.parameters.iter().map(|p| [p.min.min(p.value), p.max.max(p.value)]).collect(),
        };
        let mut values = start.clone();
        let mut residuals = control.residuals(&values);
        let idle = idle(&residuals, &self.parameters);
        let is_near = |residuals: &Residuals| {
            let near = |(r, p): (&f64, &DVec3)| r.abs() <= NEAR * p.length().max(1.0);
            residuals.distance.iter().zip(points).all(near)
        };
        for _ in 0..MOST_STEPS {
            if is_near(&residuals) {
                break;
            }
            let step = control.step(&residuals, &values);
            let longest = step.iter().fold(LONGEST_STEP, |longest, s| longest.max(s.abs()));
            let mut share = LONGEST_STEP / longest;
            let nearer = (0..=MOST_HALVINGS).find_map(|_| {
                let tried: Vec<f64> =
                    (0..values.len()).map(|k| values[k] + share * step[k] * control.range[k]).collect();
                let found = control.residuals(&tried);
                share *= 0.5;
                (found.sum_of_squares() < residuals.sum_of_squares()).then_some((tried, found))
            });
            let Some((tried, found)) = nearer else { break };
            (values, residuals) = (tried, found);
        }
        let holds = is_near(&residuals);
        let mut changed = BTreeMap::new();
        for (k, parameter) in self.parameters.iter_mut().enumerate().filter(|(k, _)| values[*k] != start[*k])
        {
            parameter.value = rounded(values[k]).clamp(control.ends[k][0], control.ends[k][1]);
            self.values[k] = parameter.value;
            changed.insert(parameter.name.to_string(), parameter.value);
        }
        self.compiled.set_parameters(&self.values);
        self.branches.set_parameters(&self.values);
        let places = points.iter().map(|&p| self.place_near(p).to_array()).collect();
        Grip { holds, places, changed, idle }
    }

    /// |∇f| at a point in the coordinates of the formula, if f is defined there.
    fn slope_at(&self, p: DVec3) -> Option<f64> {
        let (value, gradient) = self.value_and_gradient(p);
        (value.is_finite() && gradient.is_finite()).then(|| gradient.length())
    }

    /// A point of the surface near a point, both in the coordinates of the formula; the point
    /// itself if none is found.
    fn place_near(&self, p: DVec3) -> DVec3 {
        let at_rest = NEAR * p.length().max(1.0);
        let limits = StepLimits { at_rest, ..StepLimits::steps(newton::STEPS) };
        let mut evaluator = FormulaEvaluator::new(self, Frame::default());
        let step_at = |place| Some((step_to_surface(evaluator.value_and_gradient(place)), ()));
        newton::land(p, limits, step_at).map_or(p, |(place, ())| place)
    }
}

/// Names of the parameters that hardly move the surface at any of the points.
fn idle(residuals: &Residuals, parameters: &[Parameter]) -> Vec<String> {
    let strength =
        |k: usize| residuals.rows.iter().map(|row| row[k].abs()).fold(0.0, |most: f64, own| most.max(own));
    let strongest = (0..parameters.len()).map(strength).fold(0.0, f64::max);
    let is_idle = |(k, _): &(usize, &Parameter)| strength(*k) <= IDLE * strongest;
    parameters.iter().enumerate().filter(is_idle).map(|(_, parameter)| parameter.name.to_string()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::gallery::SURFACES;

    #[test]
    fn the_slopes_by_the_parameters_are_those_of_differences() {
        let mut compared = 0;
        for surface in SURFACES.iter() {
            let mut field = surface.field();
            let values = field.values.clone();
            let mut by_parameters =
                ByParameters::new(&field.compiled.graph, field.compiled.root, values.len());
            for p in [DVec3::new(0.31, -0.47, 0.23), DVec3::new(-0.72, 0.15, 0.64)] {
                let mut slopes = vec![0.0; values.len()];
                let f = by_parameters.slopes(&values, p, &mut slopes);
                assert_eq!(f.to_bits(), field.value_and_gradient(p).0.to_bits(), "{}", surface.id);
                for (k, parameter) in surface.parameters.iter().enumerate() {
                    let step = 1e-6 * (1.0 + values[k].abs());
                    let [ahead, behind] = [step, -step].map(|by| {
                        field.set_parameter(&parameter.name, values[k] + by).unwrap();
                        field.value_and_gradient(p).0
                    });
                    field.set_parameter(&parameter.name, values[k]).unwrap();
                    let difference = (ahead - behind) / (2.0 * step);
                    let error = (slopes[k] - difference).abs();
                    assert!(
                        error <= 1e-6 * (1.0 + f.abs() + difference.abs()),
                        "{} {}",
                        surface.id,
                        parameter.name
                    );
                    compared += 1;
                }
            }
        }
        assert!(compared > 40, "{compared}");
    }
}
