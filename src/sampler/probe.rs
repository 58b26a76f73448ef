//! The field as the sampler evaluates it: in batches, with their memory, and counted.

pub(crate) use crate::field::BATCH;

use crate::field::Evaluator;
use crate::field::descent::Descent;
use crate::math::newton::step_to_surface;
use crate::math::{Bounds, Sym3};
use glam::{DVec3, Vec3};

/// State that outlasts a [`Probe`]: the buffers of a batch, and the count of all evaluations.
#[derive(Clone, Debug, Default)]
pub(crate) struct ProbeMemory {
    pub(super) points: Vec<Vec3>,
    pub(super) value: Vec<f32>,
    pub(super) gradient: Vec<Vec3>,
    /// Number of field evaluations so far, one for each point and call.
    pub(crate) evaluations: u64,
}

/// A field with the memory to evaluate it at a batch of points, and the count of these evaluations.
pub(crate) struct Probe<'a> {
    /// The field. Evaluations made of it directly are not counted.
    pub(crate) field: &'a mut dyn Evaluator,
    pub(super) memory: &'a mut ProbeMemory,
}

impl<'a> Probe<'a> {
    pub(crate) fn new(field: &'a mut dyn Evaluator, memory: &'a mut ProbeMemory) -> Self {
        memory.value.resize(BATCH, 0.0);
        memory.gradient.resize(BATCH, Vec3::ZERO);
        Self { field, memory }
    }

    /// Number of field evaluations so far, one for each point and call.
    pub(crate) fn evaluations(&self) -> u64 {
        self.memory.evaluations
    }

    /// Evaluates the smooth function of a patch instead of f; f itself if there is no patch.
    pub(crate) fn on(&mut self, patch: Option<u32>) -> Probe<'_> {
        Probe { field: self.field.on(patch), memory: &mut *self.memory }
    }

    /// Whether a point of the sheet of a patch, with its normal there, lies on the patch whose
    /// function this is. Without creases there are no patches, and every point does. `size` is
    /// about the size of a particle there.
    pub(crate) fn is_on_patch(&mut self, point: Vec3, normal: Vec3, size: f32, patch: Option<u32>) -> bool {
        /// Distance from other patches, in sizes of a particle, at which the test is reliable.
        const APART: f64 = 0.1;
        patch.is_none_or(|patch| {
            self.gives_beside(point.as_dvec3(), normal.as_dvec3(), APART * f64::from(size), patch)
        })
    }

    /// Whether the patch whose function this is gives f next to a place near its sheet, on the side
    /// to which the unit vector `outward` points. Reliable if the patch meets others no nearer than
    /// `apart`.
    ///
    /// The test is made a little beside the sheet: where the bodies of a solid share a plane, each
    /// of two pieces gives f only on its inner side.
    pub(crate) fn gives_beside(&mut self, place: DVec3, outward: DVec3, apart: f64, patch: u32) -> bool {
        /// Distance from the sheet in units of `apart`: far above rounding in double precision, and
        /// so small that a piece counts even beside one 10⁶ times as steep.
        const BESIDE: f64 = 1e-7;
        /// Largest distance of the place from the sheet, in the same units.
        const FARTHEST: f64 = 10.0;
        let mut on_sheet = place;
        if outward != DVec3::ZERO {
            let step = step_to_surface(self.field.value_and_gradient(place));
            // Written so that NaN fails.
            on_sheet -= if step.length() <= FARTHEST * apart { step } else { DVec3::ZERO };
        }
        self.field.label(on_sheet + outward * (BESIDE * apart)) == patch
    }

    /// Whether a patch may have points in a box. Ignores the zeros of √(u² + v²) that lie on the
    /// edge of other patches.
    pub(crate) fn may_have_zeros(&mut self, patch: Option<u32>, bounds: &Bounds) -> bool {
        let known = self.field.labels_in(bounds);
        patch.zip(known).is_none_or(|(patch, known)| known.contains(&patch))
    }

    /// True if f vanishes here only along a curve or at an isolated point: f keeps one sign around
    /// it, and most planes through it contain no other zero of f nearby. A plane cuts a surface,
    /// and contains a curve that is tangent to it, such as the edge of a solid. `size` is the
    /// largest distance at which f is evaluated; the surface must not bend within it.
    ///
    /// The evaluations, which are in double precision, are not counted.
    pub(crate) fn is_bare_zero(&mut self, point: DVec3, size: f64) -> bool {
        /// Distances as shares of the size: a surface that bends within one need not bend within
        /// the other, and an error in the point matters least at the larger one.
        const SIZES: [f64; 2] = [1.0, 0.25];
        /// Normals of the planes. Any three are independent, so that at most two planes contain one
        /// direction.
        const NORMALS: [DVec3; 5] = [
            DVec3::new(0.8, 0.5, 0.3),
            DVec3::new(-0.3, 0.8, 0.5),
            DVec3::new(0.5, -0.3, 0.8),
            DVec3::new(0.6, 0.6, -0.6),
            DVec3::new(-0.7, 0.2, 0.7),
        ];
        const MOST_CUT: usize = 2;
        /// Below this share of its largest value at that distance |f| counts as zero: Newton's
        /// method ends nearer than that to a zero.
        const ZERO: f64 = 0.01;
        let (at_point, slope) = self.field.value_and_gradient(point);
        // Next to a much steeper branch of f, f may be small compared with its surroundings without
        // being zero.
        if at_point.abs() > ZERO * slope.length() * size && slope.length() > 0.0 {
            return false;
        }
        let distances = SIZES.map(|share| share * size);
        let most = distances.map(|d| self.most_around(point, d));
        // False for NaN.
        if !(at_point.abs() <= ZERO * most[0] && most.iter().all(|&most| most > 0.0)) {
            return false;
        }
        let mut is_cut = |normal: &&DVec3| distances.iter().any(|&d| self.is_zero_around(point, **normal, d));
        NORMALS.iter().filter(|normal| is_cut(normal)).take(MOST_CUT + 1).count() <= MOST_CUT
            && !self.changes_sign_near(point, size)
    }

    /// The value of f around a place, at an eighth of the shortest side of the box from it, to one
    /// digit: where f has it, there is a surface that shows in the box. 0 if f has no value there.
    pub(crate) fn level_around(&mut self, place: DVec3, bounds: &Bounds) -> f64 {
        const SHARE: f64 = 0.125;
        let distance = SHARE * (bounds.hi() - bounds.lo()).min_element();
        let ways = DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
        let values = ways.map(|way| self.field.value_and_gradient(place + distance * way).0);
        let mut values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
        values.sort_unstable_by(|a, b| a.abs().total_cmp(&b.abs()));
        // Along a curve of zeros there are two values of 0.
        let level = values.get(values.len() / 2).copied().unwrap_or(0.0);
        format!("{level:.0e}").parse().unwrap_or(level)
    }

    /// Whether f changes its sign near the zero to which Newton's method leads from a point: a
    /// surface that is small compared with `size` looks like a point or a curve.
    fn changes_sign_near(&mut self, mut point: DVec3, size: f64) -> bool {
        /// Number of Newton steps, and of distances tried. At a double zero a Newton step halves
        /// the distance, and each distance tried is half of the one before, so that both get from
        /// `size` down to 2⁻⁴⁰ of it.
        const STEPS: usize = 40;
        for _ in 0..STEPS {
            let (value, gradient) = self.field.value_and_gradient(point);
            let step = gradient * (value / gradient.length_squared());
            if !step.is_finite() {
                break;
            }
            point -= step.clamp_length_max(size);
        }
        let (value, gradient) = self.field.value_and_gradient(point);
        let way = gradient.normalize_or(DVec3::X);
        let distances = core::iter::successors(Some(size), |distance| Some(0.5 * distance)).take(STEPS);
        let sides = distances.flat_map(|distance| [distance, -distance].map(|along| point + way * along));
        let mut sign = value;
        for place in sides {
            let (value, _) = self.field.value_and_gradient(place);
            if value * sign < 0.0 {
                return true;
            }
            sign = if value == 0.0 { sign } else { value.signum() };
        }
        false
    }

    /// The largest |f| all around a point at a distance; 0 if f takes both signs there, NaN if it
    /// is undefined.
    fn most_around(&mut self, point: DVec3, distance: f64) -> f64 {
        /// Number of steps towards a smaller |f|. Each is twice a Newton step, so that it ends at a
        /// double zero (a curve) and passes a simple one (the side of a narrow cone), where f
        /// changes its sign.
        const STEPS: u32 = 8;
        let (mut least, mut most) = ((f64::INFINITY, DVec3::ZERO), 0.0_f64);
        let mut sign = 0.0;
        for k in (0..27).filter(|&k| k != 13) {
            let way = DVec3::new(f64::from(k % 3), f64::from(k / 3 % 3), f64::from(k / 9)) - DVec3::ONE;
            let way = way.normalize_or_zero();
            let (value, _) = self.field.value_and_gradient(point + way * distance);
            if value.is_nan() {
                return value;
            }
            if value * sign < 0.0 {
                return 0.0;
            }
            sign = if value == 0.0 { sign } else { value.signum() };
            least = if value.abs() < least.0 { (value.abs(), way) } else { least };
            most = most.max(value.abs());
        }
        let mut way = least.1;
        for _ in 0..STEPS {
            let (value, gradient) = self.field.value_and_gradient(point + way * distance);
            if value * sign < 0.0 {
                return 0.0;
            }
            let along = gradient - way * gradient.dot(way);
            let step = along * (2.0 * value / (along.length_squared() * distance));
            if step.is_finite() {
                way = (way - step.clamp_length_max(0.5)).normalize_or_zero();
            }
        }
        most
    }

    /// Whether f vanishes somewhere on the circle around a point across `normal`, or changes its
    /// sign or is undefined there.
    fn is_zero_around(&mut self, point: DVec3, normal: DVec3, radius: f64) -> bool {
        /// Below this share of its largest value on the circle |f| counts as zero. It is far above
        /// rounding and above what the steps leave of |f| near a sheet; near the curve of |u| + v²
        /// the share is about the radius.
        const ZERO: f64 = 1e-9;
        /// The circle is divided into this many arcs; `TANGENT` is tan(π/8), of half an arc.
        const ARCS: usize = 8;
        const TANGENT: f64 = 0.4142;
        let u = normal.any_orthogonal_vector().normalize_or_zero();
        let v = normal.cross(u).normalize_or_zero();
        let ways: [DVec3; ARCS] = [u, u + v, v, v - u, -u, -u - v, -v, u - v].map(DVec3::normalize_or_zero);
        let (mut most, mut sign) = (0.0_f64, 0.0);
        !ways.iter().all(|&way| {
            let aside = normal.cross(way).normalize_or_zero();
            let mut size_at = |offset: f64| {
                let place = point + (way + aside * offset).normalize_or_zero() * radius;
                let (value, _) = self.field.value_and_gradient(place);
                // Once it is NaN it stays.
                sign = if sign * value >= 0.0 { value } else { f64::NAN };
                value.abs()
            };
            most = most.max(size_at(TANGENT));
            let least = least_within(TANGENT, size_at);
            sign.abs() > 0.0 && least > ZERO * most
        })
    }

    /// Counts evaluations that were made of the field directly.
    pub(crate) fn count(&mut self, evaluations: u64) {
        self.memory.evaluations += evaluations;
    }

    /// Returns value and gradient at a point.
    pub(crate) fn gradient(&mut self, point: Vec3) -> (f32, Vec3) {
        let (value, gradient) = self.gradients(&[point]);
        (value[0], gradient[0])
    }

    /// Returns values and gradients at no more than [`BATCH`] points, which are evaluated in one
    /// call.
    pub(crate) fn gradients(&mut self, points: &[Vec3]) -> (&[f32], &[Vec3]) {
        let n = points.len();
        let ProbeMemory { value, gradient, evaluations, .. } = &mut *self.memory;
        *evaluations += n as u64;
        self.field.gradients(points, &mut value[..n], &mut gradient[..n]);
        (&value[..n], &gradient[..n])
    }

    /// Moves points onto the surface along the gradient. Returns the unit normal at each that is on
    /// it within the limits.
    pub(crate) fn land_all(
        &mut self,
        points: &mut [Vec3],
        min_gradient: f32,
        mut limits: Descent,
        max_steps: u32,
    ) -> Vec<Option<Vec3>> {
        let mut landed = Vec::with_capacity(points.len());
        let (mut normal, mut ok) = ([Vec3::ZERO; BATCH], [false; BATCH]);
        for chunk in points.chunks_mut(BATCH) {
            self.land_along_gradient(chunk, &mut normal, &mut ok, min_gradient, &mut limits, max_steps);
            landed.extend((0..chunk.len()).map(|k| ok[k].then_some(normal[k])));
        }
        landed
    }

    /// Writes values, gradients and Hessians at `points`, as [`Evaluator::hessians`] does.
    pub(crate) fn hessians(
        &mut self,
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
        hessian: &mut [Sym3<f32>],
    ) {
        self.count(points.len() as u64);
        self.field.hessians(points, value, gradient, hessian);
    }
}

/// The least of some values of a function between −`most` and `most`, near its minimum if it has
/// one: golden-section search (J. Kiefer, "Sequential minimax search for a maximum", 1953).
fn least_within(most: f64, mut value: impl FnMut(f64) -> f64) -> f64 {
    /// The share of an interval that is left after a step.
    const GOLDEN: f64 = 0.618_033_988_749_895;
    /// After so many steps 3·10⁻¹¹ of the interval is left.
    const STEPS: u32 = 50;
    let (mut lo, mut hi) = (-most, most);
    let (mut a, mut b) = (hi - GOLDEN * (hi - lo), lo + GOLDEN * (hi - lo));
    let (mut at_a, mut at_b) = (value(a), value(b));
    for _ in 0..STEPS {
        if at_a <= at_b {
            (hi, b, at_b) = (b, a, at_a);
            a = hi - GOLDEN * (hi - lo);
            at_a = value(a);
        } else {
            (lo, a, at_a) = (a, b, at_b);
            b = lo + GOLDEN * (hi - lo);
            at_b = value(b);
        }
    }
    at_a.min(at_b)
}
