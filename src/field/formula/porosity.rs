//! The thickness of the shell that leaves a wanted share of a box empty.

use super::{Formula, Thickness};
use crate::field::{BATCH, Field, Frame};
use crate::math::Bounds;
use glam::{DVec3, Vec3};

/// Points of the box at which a shell is tried. The share of them that it holds is off by about
/// N^(−2/3) where its faces are curved, 0.04 %; more take longer.
const POINTS: u32 = 1 << 17;

/// Halvings of a range of thicknesses from one to its double, down to the six digits that are kept.
const HALVINGS: u32 = 20;

/// The first thickness that is tried, as a share of the diagonal of the box.
const FIRST: f64 = 1.0 / 128.0;

/// Doublings or halvings of the first thickness before the share counts as unreachable: a factor of
/// 10¹² either way.
const MOST_STEPS: u32 = 40;

/// Why no shell leaves a share of a box empty.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PorosityError {
    /// The wanted share is not between 0 and 1.
    #[error("a porosity is a share between 0 and 1, such as 0.7 or 70 %, not {porosity}")]
    OutOfRange {
        /// The wanted share.
        porosity: f64,
    },
    /// Shells of any thickness leave more of the box empty, or less.
    #[error(
        "no thickness leaves {:.1} % of the box empty: the nearest is {:.1} %; is the surface in the box, \
         and the thickness positive all over it?", 100.0 * wanted, 100.0 * nearest
    )]
    Unreachable {
        /// The wanted share.
        wanted: f64,
        /// The nearest share that a shell leaves empty.
        nearest: f64,
    },
}

impl Formula {
    /// The shell around the surface that leaves this share of a box empty, closed by the box:
    /// [`Formula::thickness`] says how thick it is. If the thickness is a formula, it is scaled.
    ///
    /// The volume is counted at 131,072 points of the box, to about 0.05 %. That of a
    /// [mesh](crate::Sample::volume) depends on the size of its triangles, too.
    ///
    /// ```
    /// use marching_particles::field::formula::Thickness;
    /// use marching_particles::{Bounds, Formula};
    ///
    /// let bounds = Bounds::cube(1.0);
    /// let plate = Formula::parse("z = 0")?.with_porosity(0.7, &bounds)?;
    /// let Some(Thickness::Number(thickness)) = plate.thickness() else { panic!("a number") };
    /// assert!((thickness - 0.6).abs() < 1e-3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the share is not between 0 and 1, or no shell leaves it empty.
    ///
    /// # Panics
    ///
    /// Never: the thickness of this formula is only scaled.
    pub fn with_porosity(self, porosity: f64, bounds: &Bounds) -> Result<Self, PorosityError> {
        if !(porosity > 0.0 && porosity < 1.0) {
            return Err(PorosityError::OutOfRange { porosity });
        }
        let (unit, first) = match self.thickness() {
            Some(formula @ Thickness::Formula(_)) => (formula.clone(), 1.0),
            _ => (Thickness::Number(1.0), FIRST * bounds.diagonal()),
        };
        let surface = self.clone().without_solid();
        let shell = |factor: f64| {
            let thickness = unit.scaled(factor, &self.parameters);
            let thickened = thickness.and_then(|thickness| surface.clone().thickened_by(thickness));
            thickened.expect("the shell has this thickness but for a factor")
        };
        let places = Places::of(bounds);
        let empty = |factor: f64| 1.0 - places.share_in(&shell(factor));
        let by_steps = |from: f64, step: f64, is_there: &dyn Fn(f64) -> bool| {
            let mut factor = from;
            for _ in 0..MOST_STEPS {
                if is_there(empty(factor)) {
                    return Ok(factor);
                }
                factor *= step;
            }
            Err(PorosityError::Unreachable { wanted: porosity, nearest: empty(factor) })
        };
        let thick = by_steps(first, 2.0, &|left| left <= porosity)?;
        let mut low = by_steps(0.5 * thick, 0.5, &|left| left > porosity)?;
        let mut high = 2.0 * low;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if empty(middle) > porosity {
                low = middle;
            } else {
                high = middle;
            }
        }
        Ok(shell(six_digits(high)).closed_by(bounds))
    }
}

/// Sample points by which the volume of a solid in a box is counted.
struct Places {
    frame: Frame,
    points: Vec<Vec3>,
}

impl Places {
    /// [`POINTS`] places of a box, from an additive sequence in three dimensions, by the powers of
    /// the root of g⁴ = g + 1 (M. Roberts, "The unreasonable effectiveness of quasirandom
    /// sequences", 2018). On a grid the faces of a body that are parallel to it would count as a
    /// whole layer.
    fn of(bounds: &Bounds) -> Self {
        const STEP: DVec3 =
            DVec3::new(0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_2);
        let frame = Frame::around(bounds.local_origin());
        let (lo, size) = (bounds.lo() - frame.origin, bounds.size());
        let place = |k: u32| lo + size * (DVec3::splat(0.5) + f64::from(k) * STEP).fract();
        Self { frame, points: (0..POINTS).map(|k| place(k).as_vec3()).collect() }
    }

    /// The share of the places at which a field is not positive.
    fn share_in(&self, field: &Formula) -> f64 {
        let mut evaluator = field.evaluator(self.frame);
        let mut values = [0.0; BATCH];
        let mut inside = 0_usize;
        for points in self.points.chunks(BATCH) {
            evaluator.values(points, &mut values);
            inside += values[..points.len()].iter().filter(|&&value| value <= 0.0).count();
        }
        inside as f64 / f64::from(POINTS)
    }
}

/// The number with six significant digits, as a person would write a thickness.
fn six_digits(number: f64) -> f64 {
    format!("{number:.5e}").parse().unwrap_or(number)
}
