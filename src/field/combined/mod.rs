//! Fields that combine others: unions, intersections and differences of solids, smooth
//! unions, and offsets.
//!
//! A minimum or a maximum of two fields has creases where the two surfaces meet. They are searched
//! for in small [cells](ties) and followed to full precision, as for a formula; but a field of the
//! program has no bounds to prove that none was missed.
//!
//! Signs and offsets move into the operands of a minimum or a maximum, so that its creases stay
//! known: −max(a, b) = min(−a, −b), −min(a, b) = max(−a, −b), and max(a, b) − d = max(a − d, b −
//! d).

mod evaluator;
mod rule;
mod ties;

use super::given::shared;
use super::{
    Evaluator, Facts, Field, FieldError, Frame, IntoField, IntoFields, Jet, Piecewise, Within, edges,
};
use crate::math::Bounds;
use crate::slices::Work;
use core::fmt::{self, Debug, Formatter};
use core::ops::Deref;
use evaluator::CombinationEvaluator;
use glam::DVec3;
use rule::Rule;
use std::sync::Arc;

/// A field that combines others by [`union`], [`intersection`], [`difference`], [`smooth_union`] or
/// [`offset`]. Copies share it.
#[derive(Clone)]
pub struct Combined(Arc<dyn Field>);

impl Combined {
    pub(super) fn new(field: Arc<dyn Field>) -> Self {
        Self(field)
    }
}

impl Debug for Combined {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("Combined").finish_non_exhaustive()
    }
}

impl Deref for Combined {
    type Target = dyn Field;

    fn deref(&self) -> &Self::Target {
        &*self.0
    }
}

/// The union of solids: min(a, b, …), which is negative where one of them is.
///
/// The solids are an array, a vector or a tuple of anything that can be [sampled](IntoField),
/// including functions of the program and models from points. Where their surfaces meet at an angle
/// the particles lie on the edge, and the mesh is closed along it. Edges are searched for in cells
/// of a 128th of the box: a smaller loop may be missed. There is no proof of completeness. Formulas
/// are better written as one with `min`, `max` and `-`, which has both.
///
/// An operand should have a gradient where it is zero, as a distance has. The union is undefined
/// where one operand is.
///
/// # Panics
///
/// If there are no solids.
///
/// ```
/// use marching_particles::glam::{DVec3, dvec3};
/// use marching_particles::{Formula, Settings, sample, union};
///
/// // Solids of one type are an array, of several types a tuple.
/// let ball = |x: f64| move |p: DVec3| p.distance(dvec3(x, 0.0, 0.0)) - 1.0;
/// let chain = union([-1.0, 0.0, 1.0].map(ball));
/// let rod = Formula::parse("max(hypot(y, z) - 0.3, |x| - 3)")?;
/// let sample = sample(union((chain, rod)), &Settings::with_count(4_000))?;
/// assert!(sample.mesh().topology.is_closed());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn union<K>(solids: impl IntoFields<K>) -> Combined {
    folded(solids, Rule::Least)
}

/// The intersection of solids: max(a, b, …), which is negative where all are. See [`union`].
///
/// # Panics
///
/// If there are no solids.
pub fn intersection<K>(solids: impl IntoFields<K>) -> Combined {
    folded(solids, Rule::Greatest)
}

fn folded<K>(solids: impl IntoFields<K>, rule: Rule) -> Combined {
    let mut fields = solids.into_fields();
    assert!(!fields.is_empty(), "a combination has at least one solid");
    // A balanced tree: a point of one solid then passes few of the others, and labels stay small.
    while fields.len() > 1 {
        let join = |pair: &[Arc<dyn Field>]| -> Arc<dyn Field> {
            match pair {
                [one] => Arc::clone(one),
                both => Arc::new(Combination::new(rule, both.to_vec())),
            }
        };
        fields = fields.chunks(2).map(join).collect();
    }
    Combined(fields.swap_remove(0))
}

/// The difference of two solids: max(a, −b), which is negative where a is and b is not. See
/// [`union`].
///
/// ```
/// use marching_particles::glam::DVec3;
/// use marching_particles::{Formula, Settings, difference, sample};
///
/// let block = Formula::parse("max(abs(x) - 1, abs(y) - 1, abs(z) - 0.5)")?;
/// let drilled = difference(block, |p: DVec3| p.truncate().length() - 0.4);
/// let sample = sample(drilled, &Settings::with_count(3_000))?;
/// assert_eq!(sample.mesh().topology.components[0].euler(), 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn difference<A, B, K, L>(a: A, b: B) -> Combined
where
    A: IntoField<K, Field: 'static>,
    B: IntoField<L, Field: 'static>,
{
    Combined(greatest(shared(a), turned(&shared(b), true, 0.0)))
}

/// The union of two solids, rounded where |a − b| < `width`: `smin(a, b, width)` of formulas. The
/// width is in units of f, a length if a and b are distances; if it is not positive this is
/// [`union`]. An operand with edges is blended as if it were smooth, and the mesh may be open along
/// the edges that remain; `smin` in a formula keeps them.
pub fn smooth_union<A, B, K, L>(a: A, b: B, width: f64) -> Combined
where
    A: IntoField<K, Field: 'static>,
    B: IntoField<L, Field: 'static>,
{
    Combined(blended(shared(a), shared(b), width))
}

/// The field f − `distance`. If f is the distance from a solid, the new solid is larger by
/// `distance`, or smaller if that is negative.
pub fn offset<A, K>(a: A, distance: f64) -> Combined
where
    A: IntoField<K, Field: 'static>,
{
    Combined(turned(&shared(a), false, distance))
}

/// The surface of a field, which ends where another field becomes positive.
pub(super) fn limited(surface: Arc<dyn Field>, limit: Arc<dyn Field>) -> Arc<dyn Piecewise> {
    let whole = Combination::new(Rule::Greatest, vec![surface, limit]);
    Arc::new(Combination { is_limited: true, ..whole })
}

pub(super) fn least(a: Arc<dyn Field>, b: Arc<dyn Field>) -> Arc<dyn Field> {
    Arc::new(Combination::new(Rule::Least, vec![a, b]))
}

pub(super) fn greatest(a: Arc<dyn Field>, b: Arc<dyn Field>) -> Arc<dyn Field> {
    Arc::new(Combination::new(Rule::Greatest, vec![a, b]))
}

/// The smooth minimum of this width.
pub(super) fn blended(a: Arc<dyn Field>, b: Arc<dyn Field>, width: f64) -> Arc<dyn Field> {
    if width > 0.0 { Arc::new(Combination::new(Rule::Blend { width }, vec![a, b])) } else { least(a, b) }
}

/// The field f − shift, or −f − shift.
pub(super) fn turned(field: &Arc<dyn Field>, is_negative: bool, shift: f64) -> Arc<dyn Field> {
    match field.piecewise() {
        _ if !is_negative && shift == 0.0 => Arc::clone(field),
        Some(creased) => creased.turned(is_negative, shift),
        None => {
            let rule = Rule::Turned { is_negative, shift };
            Arc::new(Combination::new(rule, vec![Arc::clone(field)]))
        }
    }
}

/// A function of the values of one field or two.
#[derive(Clone)]
struct Combination {
    rule: Rule,
    parts: Vec<Arc<dyn Field>>,
    /// Pairs of a branch of the first part and one of the second that are known to meet without an
    /// edge somewhere.
    tangent_pairs: Vec<[u32; 2]>,
    /// Whether the zeros of the second part only limit the surface, which ends at them.
    is_limited: bool,
}

impl Combination {
    fn new(rule: Rule, parts: Vec<Arc<dyn Field>>) -> Self {
        Self { rule, parts, tangent_pairs: Vec::new(), is_limited: false }
    }

    fn is_extreme(&self) -> bool {
        matches!(self.rule, Rule::Least | Rule::Greatest)
    }
}

impl Field for Combination {
    fn value(&self, p: DVec3) -> f64 {
        let of = |part: &Arc<dyn Field>| Jet { value: part.value(p), ..Jet::default() };
        self.rule.jet(&mut self.parts.iter().map(of)).value
    }

    fn value_and_gradient(&self, p: DVec3) -> (f64, DVec3) {
        let of = |part: &Arc<dyn Field>| {
            let (value, gradient) = part.value_and_gradient(p);
            Jet { value, gradient, ..Jet::default() }
        };
        let Jet { value, gradient, .. } = self.rule.jet(&mut self.parts.iter().map(of));
        (value, gradient)
    }

    fn jet(&self, p: DVec3) -> Jet {
        self.rule.jet(&mut self.parts.iter().map(|part| part.jet(p)))
    }

    fn evaluator(&self, frame: Frame) -> Box<dyn Evaluator + '_> {
        Box::new(CombinationEvaluator::new(self, frame))
    }

    /// The periods common to all parts, and the unused names of any part. The surface lies in the
    /// boxes that contain the parts' surfaces, and in the box in which all parts are known.
    fn facts(&self) -> Facts {
        let facts: Vec<Facts> = self.parts.iter().map(|part| part.facts()).collect();
        let mut periods = facts.iter().map(|facts| facts.periods);
        let first = periods.next().unwrap_or_default();
        let common = periods.fold(first, |common, own| {
            core::array::from_fn(|axis| common[axis].filter(|_| common[axis] == own[axis]))
        });
        let mut unused: Vec<String> = Vec::new();
        for name in facts.iter().flat_map(|facts| &facts.unused) {
            // The parts of one formula have the same definitions.
            if !unused.contains(name) {
                unused.push(name.clone());
            }
        }
        let domain = facts.iter().filter_map(|facts| facts.domain).reduce(|a, b| a.overlap(&b));
        let has_zeros_of_parts = self.is_extreme() || matches!(self.rule, Rule::Turned { shift: 0.0, .. });
        let own: Option<Vec<Within>> = facts.iter().map(|facts| facts.within).collect();
        let within = own.filter(|_| has_zeros_of_parts).and_then(|own| {
            own.into_iter()
                .reduce(|a, b| Within { bounds: a.bounds.joined(&b.bounds), is_cut: a.is_cut || b.is_cut })
        });
        let within = within.or(domain.map(|bounds| Within { bounds, is_cut: true }));
        let resolution = facts.iter().filter_map(|facts| facts.resolution).reduce(f64::min);
        let edge_cells = facts.iter().filter_map(|facts| facts.edge_cells).min();
        Facts { periods: common, unused, within, domain, resolution, edge_cells, ..Facts::default() }
    }

    fn calls(&self) -> Option<u64> {
        self.parts.iter().filter_map(|part| part.calls()).reduce(|sum, calls| sum + calls)
    }

    fn failure(&self) -> Option<FieldError> {
        self.parts.iter().find_map(|part| part.failure())
    }

    fn piecewise(&self) -> Option<&dyn Piecewise> {
        self.is_extreme().then_some(self)
    }

    fn is_smooth(&self) -> bool {
        !self.is_extreme() && self.parts.iter().all(|part| part.is_smooth())
    }
}

impl Piecewise for Combination {
    fn pieces_in<'a>(
        &'a self,
        bounds: &Bounds,
        width: f64,
        cells: u32,
    ) -> Work<'a, (Vec<Bounds>, Arc<dyn Piecewise>)> {
        let bounds = *bounds;
        Box::pin(async move {
            let (mut found, mut own) = (Vec::new(), self.clone());
            for part in &mut own.parts {
                let known = edges::known_in(&**part, &bounds, width, cells).await;
                let Some((cells, known)) = known else { continue };
                found.extend(cells);
                *part = edges::KnownPieces::of_shared(known.as_ref(), part);
            }
            let origin = bounds.middle();
            let frame = Frame { length: bounds.diagonal(), ..Frame::around(origin) };
            let mut evaluator = CombinationEvaluator::new(&own, frame);
            let near = bounds.relative_to(origin);
            evaluator.drop_hidden(&mut found, origin).await;
            let ties = evaluator.tied_cells(&near, width).await;
            found.extend(ties.iter().map(|cell| cell.relative_to(-origin)));
            let pairs = evaluator.tangent_pairs_in(&ties).await;
            drop(evaluator);
            own.tangent_pairs = pairs;
            let own: Arc<dyn Piecewise> = Arc::new(own);
            (found, own)
        })
    }

    fn with_pieces_of(&self, _: &dyn Piecewise) -> Arc<dyn Piecewise> {
        Arc::new(self.clone())
    }

    fn turned(&self, is_negative: bool, shift: f64) -> Arc<dyn Field> {
        let rule = match self.rule {
            Rule::Least if is_negative => Rule::Greatest,
            Rule::Greatest if is_negative => Rule::Least,
            rule => rule,
        };
        let parts = self.parts.iter().map(|part| turned(part, is_negative, shift)).collect();
        Arc::new(Self { is_limited: self.is_limited, ..Self::new(rule, parts) })
    }
}
