//! The radius of adaptive particles as a field over the surface: a law of the curvature, limited to a slope.
//!
//! r(x) = min(law(κ(x)), envelope(x)). The envelope is min over the survey's points y of law(κ(y)) + L |x − y|, the
//! largest function of slope L below the law at those points, so that the radius grows no faster than that away from
//! where the surface bends. It is kept on the nodes of a grid near the surface and read in between by interpolation.

mod laws;

pub use laws::{ChordError, MaxCurvature, SumOfCurvatures};

use crate::differential::{Curvature, curvatures};
use crate::field::Field;
use crate::math::{Bounds, SQRT_3};
use crate::sampler::discovery::survey::Survey;
use crate::sampler::settings::Settings;
use crate::sampler::sizing::laws::SizingLaw;
use glam::Vec3;

/// Grid cells along the longest side of the box: as the survey's, so that a cell of the surface holds some of its points.
const CELLS: f32 = 32.0;
/// Times the envelope is spread forwards and backwards over the nodes. Once would do in the open; around the bends of a
/// thin band of nodes a way may turn back.
const ROUNDS: usize = 2;
/// Attempts at a count: each one takes the square root of what it is off by, and only clamps and grading make a second
/// one necessary.
const MAX_ATTEMPTS: u32 = 6;
/// A predicted count this near is met: the prediction itself is no better.
const COUNT_TOLERANCE: f64 = 2e-3;
/// Area of the hexagonal cell of a particle over r².
const CELL_AREA: f64 = 2.0 * SQRT_3;

/// The radius field of a run.
#[derive(Clone, Debug)]
pub(crate) struct Sizing {
    law: SizingLaw,
    /// Slope L.
    slope: f32,
    /// Points of the surface with what they stand for.
    site: Vec<Site>,
    envelope: Envelope,
    predicted: f64,
    smallest: f32,
    largest: f32,
}

#[derive(Clone, Copy, Debug)]
struct Site {
    position: Vec3,
    curvature: Curvature,
    /// Area.
    weight: f32,
}

impl Sizing {
    /// The radius field that `settings` ask for; one Hessian at every point of the survey.
    pub(crate) fn new(
        field: &mut dyn Field,
        bounds: &Bounds,
        settings: &Settings,
        survey: &Survey,
        evaluations: &mut u64,
    ) -> Self {
        let n = survey.position.len();
        let mut curvature = vec![Curvature::default(); n];
        curvatures(field, &survey.position, &mut curvature);
        *evaluations += n as u64;
        let site = (0..n)
            .map(|i| Site { position: survey.position[i], curvature: curvature[i], weight: survey.weight[i] })
            .collect();
        let mut sizing = Self {
            law: SizingLaw::new(settings, bounds.diagonal()),
            slope: settings.grading as f32,
            site,
            envelope: Envelope::new(bounds, survey.position.iter().copied()),
            predicted: 0.0,
            smallest: 0.0,
            largest: 0.0,
        };
        sizing.grade();
        sizing
    }

    /// Repulsion radius of a particle at a point of the surface with this curvature: the smallest one where there is
    /// none.
    #[inline]
    pub(crate) fn radius(&self, position: Vec3, curvature: &Curvature) -> f32 {
        self.law.radius(curvature).min(self.envelope.at(position))
    }

    #[cfg(test)]
    /// What the radius at `position` is at most, without a Hessian. Not close to it where the surface bends more than at
    /// the nearest points of the survey.
    #[inline]
    pub(crate) fn envelope(&self, position: Vec3) -> f32 {
        self.envelope.at(position)
    }

    /// Slope L: |r(x) − r(y)| ≤ L |x − y|.
    pub(crate) fn slope(&self) -> f32 {
        self.slope
    }

    /// Particles that cover the surface in perfect hexagons: ∫ dA / (2√3 r²).
    pub(crate) fn predicted_count(&self) -> f64 {
        self.predicted
    }

    /// Smallest radius that a particle may have.
    pub(crate) fn least(&self) -> f32 {
        self.law.least()
    }

    /// Smallest radius among the points of the survey.
    pub(crate) fn smallest(&self) -> f32 {
        self.smallest
    }

    /// Largest radius among the points of the survey.
    pub(crate) fn largest(&self) -> f32 {
        self.largest
    }

    /// Multiplies the law and its clamp by `factor` and grades anew: the slope stays.
    pub(crate) fn scale(&mut self, factor: f64) {
        self.law = self.law.scaled(factor);
        self.grade();
    }

    /// Scales the law until the predicted count is `count`.
    pub(crate) fn scale_to(&mut self, count: f64) {
        for _ in 0..MAX_ATTEMPTS {
            let off = self.predicted / count;
            if !(off > 0.0 && (off - 1.0).abs() > COUNT_TOLERANCE) {
                break;
            }
            self.scale(off.sqrt());
        }
    }

    /// Makes the envelope of the present law.
    fn grade(&mut self) {
        self.envelope.fill(self.law.greatest());
        for site in &self.site {
            self.envelope.lower(site.position, self.law.radius(&site.curvature), self.slope);
        }
        self.envelope.spread(self.slope);
        (self.predicted, self.smallest, self.largest) = (0.0, f32::INFINITY, 0.0);
        for site in &self.site {
            let radius = self.law.radius(&site.curvature).min(self.envelope.at(site.position));
            self.predicted += f64::from(site.weight) / (CELL_AREA * f64::from(radius) * f64::from(radius));
            self.smallest = self.smallest.min(radius);
            self.largest = self.largest.max(radius);
        }
        if self.site.is_empty() {
            // The survey has found no surface. What the search for pieces may still find has some radius.
            (self.smallest, self.largest) = (self.law.greatest(), self.law.greatest());
        }
    }
}

/// A function on the nodes of a regular grid, of which only those near the surface count.
#[derive(Clone, Debug)]
struct Envelope {
    /// The first node.
    lo: Vec3,
    inverse_cell: f32,
    cell: f32,
    /// The last place in the box, in cells.
    last: Vec3,
    /// Nodes along each axis. The outermost ones are never active, so that an active node has all its neighbours.
    nodes: [usize; 3],
    value: Vec<f32>,
    /// Nodes near the surface, in order.
    active: Vec<u32>,
}

/// Cells of the grid beyond the box, on each side: an active node lies within two of a point in the box.
const MARGIN: usize = 2;

/// What the last place of the box is off its last node, so that it lies in the last cell.
const LAST_CELL: f32 = 1e-4;

impl Envelope {
    fn new(bounds: &Bounds, points: impl Iterator<Item = Vec3>) -> Self {
        let size = (bounds.hi() - bounds.lo()).as_vec3();
        let cell = size.max_element() / CELLS;
        let nodes = (size / cell).ceil().to_array().map(|c| (c as usize).max(1) + 2 * MARGIN + 1);
        let mut envelope = Self {
            lo: bounds.lo().as_vec3() - cell * MARGIN as f32,
            inverse_cell: 1.0 / cell,
            cell,
            last: Vec3::from_array(nodes.map(|n| (n - 1 - MARGIN) as f32)) - LAST_CELL,
            nodes,
            value: vec![0.0; nodes.iter().product()],
            active: Vec::new(),
        };
        let mut near = vec![false; envelope.value.len()];
        let [_, row, layer] = envelope.strides();
        for p in points {
            // The nodes of the cell around the point and of the cells around that.
            let (first, _) = envelope.locate(p);
            let start = first - 1 - row - layer;
            for corner in 0..64 {
                near[start + (corner & 3) + (corner >> 2 & 3) * row + (corner >> 4) * layer] = true;
            }
        }
        envelope.active.extend((0..near.len() as u32).filter(|&n| near[n as usize]));
        envelope
    }

    fn strides(&self) -> [usize; 3] {
        [1, self.nodes[0], self.nodes[0] * self.nodes[1]]
    }

    /// The first node of the cell that holds `p`, or of the nearest one in the box, and the place in it: 0 to 1 along each
    /// axis.
    fn locate(&self, p: Vec3) -> (usize, Vec3) {
        // NaN becomes the first place.
        let place = ((p - self.lo) * self.inverse_cell).max(Vec3::splat(MARGIN as f32)).min(self.last);
        let cell = place.to_array().map(|c| c as u32);
        let rest = place - Vec3::from_array(cell.map(|c| c as f32));
        let [x, y, z] = cell.map(|c| c as usize);
        let [_, row, layer] = self.strides();
        let first = x + y * row + z * layer;
        (first, rest)
    }

    /// Gives every node one value.
    fn fill(&mut self, value: f32) {
        self.value.fill(value);
    }

    /// Lowers the nodes of the cell around `p` to what a radius there allows them.
    fn lower(&mut self, p: Vec3, radius: f32, slope: f32) {
        let (first, t) = self.locate(p);
        let [_, row, layer] = self.strides();
        for corner in 0..8 {
            let (i, j, k) = (corner & 1, corner >> 1 & 1, corner >> 2);
            let way = (t - Vec3::new(i as f32, j as f32, k as f32)).length() * self.cell;
            let value = &mut self.value[first + i + j * row + k * layer];
            *value = value.min(radius + slope * way);
        }
    }

    /// Lowers every active node to what the others allow it, along ways over active nodes.
    fn spread(&mut self, slope: f32) {
        let steps = [1.0, core::f32::consts::SQRT_2, SQRT_3 as f32].map(|way| slope * way * self.cell);
        for _ in 0..ROUNDS {
            let mut lowered = false;
            for k in 0..self.active.len() {
                let n = self.active[k] as usize;
                lowered |= self.lower_node(n, steps, |distance| n - distance);
            }
            for k in (0..self.active.len()).rev() {
                let n = self.active[k] as usize;
                lowered |= self.lower_node(n, steps, |distance| n + distance);
            }
            if !lowered {
                break;
            }
        }
    }

    /// Lowers node `n` to what thirteen of its neighbours allow it, those before it or those after it in the order of the
    /// nodes; `steps` are the rises to a neighbour across a face, an edge and a corner. Says whether it was lowered.
    fn lower_node(&mut self, n: usize, steps: [f32; 3], at: impl Fn(usize) -> usize) -> bool {
        let [_, row, layer] = self.strides();
        let least = |a: f32, b: f32| if b < a { b } else { a };
        let of = |distance: usize| self.value[at(distance)];
        let face = [row, layer].map(of).into_iter().fold(of(1), least);
        let edge = [row + 1, layer - 1, layer + 1, layer - row, layer + row]
            .map(of)
            .into_iter()
            .fold(of(row - 1), least);
        let corner = [layer - row + 1, layer + row - 1, layer + row + 1]
            .map(of)
            .into_iter()
            .fold(of(layer - row - 1), least);
        let value = least(least(face + steps[0], edge + steps[1]), corner + steps[2]);
        let lower = value < self.value[n];
        if lower {
            self.value[n] = value;
        }
        lower
    }

    /// The function at `p`, by trilinear interpolation.
    #[inline]
    fn at(&self, p: Vec3) -> f32 {
        let (first, t) = self.locate(p);
        let [_, row, layer] = self.strides();
        let along_x = |offset: usize| {
            let ends = &self.value[first + offset..first + offset + 2];
            ends[0] + (ends[1] - ends[0]) * t.x
        };
        let along_y = |offset: usize| {
            let (a, b) = (along_x(offset), along_x(offset + row));
            a + (b - a) * t.y
        };
        let (a, b) = (along_y(0), along_y(layer));
        a + (b - a) * t.z
    }
}

#[cfg(test)]
mod tests;
