//! The report of a run: the counts of the sampler, and the measurements of the particles before and
//! after the relaxation.

use super::measuring::{
    Measured, Measuring, MeasuringInput, MeasuringResult, expected_slices, measure, measured_columns,
};
use super::{Run, RunState, Warning, check, shared};
use crate::extent::Reach;
use crate::field::{Field, edges};
use crate::math::Forest;
use crate::mesh::facing::Inside;
use crate::particles::{Particles, SlotFate, Slots};
use crate::quality::{Figures, Histogram, Places};
use crate::sampler::{Blur, FateCounts, Sampled, Sampling, Search, StopReason};
use crate::slices::{self, Estimated};
use core::fmt::{self, Display, Formatter};
use glam::Vec3;
use serde::{Serialize, Serializer};
use std::sync::Arc;

/// Report on a run: its particles, how they were placed, the proof of completeness, quality and
/// warnings.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Report {
    /// Number of particles.
    pub count: usize,
    /// Repulsion radii.
    #[serde(flatten)]
    pub sizes: Radii,
    /// Statistics of the placement.
    #[serde(flatten)]
    pub growth: Growth,
    /// Components of the surface, and how sure it is that all were found.
    #[serde(flatten)]
    pub proof: Proof,
    /// Figures of quality.
    #[serde(flatten)]
    pub measures: Measures,
    /// Volume enclosed by the mesh to which [`Run::join`] has joined the particles; none if it is
    /// open, or the particles were not joined.
    #[serde(rename = "volume")]
    pub joined_volume: Option<f64>,
    /// Sign of f inside of the closed parts of the surface, by that mesh if the particles were
    /// joined, else by the triangles of natural neighbours; none if no part is closed, or nothing
    /// was measured.
    pub inside: Option<Inside>,
    /// Smallest angle of the triangles of that mesh in degrees, including its border; none if the
    /// particles were not joined.
    pub smallest_angle: Option<f64>,
    /// Pairs of particles on opposite faces of a cell, see [`Particles::pairs`]; none if no
    /// opposite faces agree.
    pub pairs: Option<usize>,
    /// Particles with a child that fell outside of the box; for particles that have followed a
    /// moving surface, with room for a child there.
    pub border: usize,
    /// Why particles lie at the border of the box.
    pub cut: Option<Cut>,
    /// Why the run ended.
    pub stop_reason: Option<StopReason>,
    /// Warnings about the field, the settings and the result.
    #[cfg_attr(test, ts(as = "Vec<super::warning::Told>"))]
    pub warnings: Vec<Warning>,
    /// Digest of the particles, 16 hexadecimal digits.
    pub digest: String,
}

/// Why particles lie at the border of the box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Cut {
    /// The surface continues beyond the fitted box: it is unbounded, or the search for the box
    /// missed a part of it.
    Endless,
    /// The box was given, and the surface reaches beyond it.
    Fixed,
    /// The box was fitted to the surface before it moved, and the surface has outgrown it.
    Outgrown,
}

/// Repulsion radii of a run, in the units of the field's coordinates.
#[derive(Clone, Copy, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Radii {
    /// Repulsion radius of the run; with adaptive sampling, the radius at which as many particles
    /// of equal size would cover the surface.
    pub radius: f64,
    /// Repulsion radius of the smallest particle; 0 without particles.
    pub radius_min: f64,
    /// Repulsion radius of the largest particle.
    pub radius_max: f64,
}

/// Statistics of the placement of the particles: levels, fronts, fates, evaluations and energy.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Growth {
    /// Number of generation levels.
    pub levels: u32,
    /// Particles per generation level.
    pub level_counts: Vec<u32>,
    /// Fronts started: each from a seed of its own, or from connected creases.
    pub components_seeded: u32,
    /// Particles placed in gaps between fronts.
    pub gaps_filled: u64,
    /// Number of proposed children by fate.
    pub fates: FateCounts,
    /// Field evaluations of the whole run, counted as
    /// [`Progress::evaluations`](crate::Progress::evaluations).
    pub evaluations: u64,
    /// Points at which functions of the program were evaluated, for values and gradients, from the
    /// search for a box to this report; none if the field does not [count](crate::Field::calls)
    /// them.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, ts(skip))]
    pub calls: Option<u64>,
    /// Field evaluations of the front per particle.
    pub evaluations_per_particle: f64,
    /// Number of refinements of a coarse front; none if it was not refined, or the front was kept.
    pub refined_levels: Option<u32>,
    /// Energy per particle before the first relaxation step and after each; none if nothing was
    /// relaxed.
    pub energy: Option<Vec<f64>>,
}

/// Components of the surface, and how sure it is that all were found.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Proof {
    /// Number of components at this radius, in the graph of natural neighbours of the particles. 0,
    /// and null in JSON, without particles or if they were not measured.
    #[serde(serialize_with = "null_for_zero")]
    #[cfg_attr(test, ts(type = "number | null"))]
    pub components: usize,
    /// Whether it is proven that every component of the surface has a witness, and that every
    /// witness is on the component of a particle or named in `sampled`.
    pub search: Search,
    /// The witnessed components that hold particles, and those that do not.
    pub sampled: Sampled,
    /// Cells of the box and witnesses that the proof left undecided; none if no proof was
    /// attempted.
    pub undecided_cells: Option<u64>,
    /// Places where f has no gradient on the surface, a curve of them counted as one; none if they
    /// were not searched for.
    pub singular_points: Option<u64>,
    /// Curves of particles along which the surface has an edge, from corner to corner or closed;
    /// none if it has no edges.
    pub creases: Option<usize>,
    /// Particles at which creases meet or end; none if the surface has no edges.
    pub corners: Option<usize>,
    /// How the edges were found, if they were searched for in the values of f; none if the field
    /// itself says which pieces meet at its edges, and if no edge was found.
    #[cfg_attr(test, ts(as = "Option<String>"))]
    pub edges_found: Option<EdgeSearch>,
    /// Number of smooth joins, the curves of particles along which patches of the surface meet
    /// without an edge; `None` on a surface without any.
    pub seams: Option<usize>,
}

/// A search for edges in the values of f. It proves nothing: an edge of a part of the surface that
/// is smaller than a cell of its grid may have been missed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum EdgeSearch {
    /// The edges were searched.
    Grid {
        /// Cells of the grid along the longest side of the box.
        cells: u32,
    },
    /// The values of f are too noisy to show any, as in single precision.
    Noisy,
}

impl Display for EdgeSearch {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Grid { cells } => write!(f, "in the values of f to 1/{cells} of the box"),
            Self::Noisy => f.write_str("nowhere: the values of f are too noisy"),
        }
    }
}

impl Serialize for EdgeSearch {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// Figures of quality of a run.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Measures {
    /// Quality of the present particles; none without particles, or if they were not measured.
    pub quality: Option<Figures>,
    /// Quality of the particles after the front, before the relaxation; none if nothing was
    /// relaxed, or the front was not measured.
    pub quality_before: Option<Figures>,
    /// Nearest-neighbour distances over the ideal ones; in an adaptive run, over the diameters of
    /// the particles.
    pub nearest_histogram: Histogram,
    /// The crowded pairs and wide holes of the present particles.
    pub places: Places,
}

fn null_for_zero<S: Serializer>(count: &usize, serializer: S) -> Result<S::Ok, S::Error> {
    Some(*count).filter(|&count| count > 0).serialize(serializer)
}

/// Counts of the curves of particles along which the surface has an edge, or of those along which
/// it has none.
pub(super) struct CurveCounts {
    curves: usize,
    /// Particles at which curves meet or end.
    ends: usize,
    /// Curves along which sheets cross, and a particle on the first of them.
    pub(super) crossings: usize,
    pub(super) crossing: Option<u32>,
}

/// Counts the curves of the segments of a kind.
fn curves_of(Particles { twins, segments, sides, .. }: &Particles, is_of_kind: &[bool]) -> CurveCounts {
    let of_kind: Vec<u32> =
        (0..).zip(is_of_kind).filter(|&(_, &is_of_kind)| is_of_kind).map(|(k, _)| k).collect();
    // The segments at each particle.
    let mut at = vec![Vec::new(); twins.len()];
    for &k in &of_kind {
        segments[k as usize].iter().for_each(|&first| at[first as usize].push(k));
    }
    let mut curves = Forest::new(segments.len());
    for way in at.iter().filter(|segments| segments.len() == 2) {
        curves.join(way[0], way[1]);
    }
    let firsts: Vec<u32> = of_kind.into_iter().filter(|&k| curves.find(k) == k).collect();
    let mut crossings = firsts.iter().filter(|&&k| sides[k as usize].len() > 1).copied().peekable();
    CurveCounts {
        curves: firsts.len(),
        ends: at.iter().filter(|segments| !matches!(segments.len(), 0 | 2)).count(),
        crossing: crossings.peek().map(|&k| segments[k as usize][0]),
        crossings: crossings.count(),
    }
}

/// Counts the creases, and the smooth joins; none if their number is 0.
pub(super) fn creases_and_seams(particles: &Particles) -> [Option<CurveCounts>; 2] {
    let edges = particles.edges();
    let seams: Vec<bool> = edges.iter().map(|is_edge| !is_edge).collect();
    [edges, seams].map(|kind| Some(curves_of(particles, &kind)).filter(|counts| counts.curves > 0))
}

/// A report in the making, as [`Run::measure`] begins it. Dropping it aborts the measurement.
pub struct Reporting<'a> {
    work: Estimated<'a, Report>,
    /// Share of the call that was done before the measurement.
    before: f64,
    /// Share of the call that is the measurement.
    share: f64,
}

impl Reporting<'_> {
    /// Does up to `budget` slices, some 10 to 50 microseconds each; returns the report once it is
    /// complete.
    ///
    /// # Panics
    ///
    /// If it has returned the report already.
    pub fn step(&mut self, budget: u32) -> Option<Report> {
        self.work.advance(budget)
    }

    /// Estimated share of the work that is done: of the run and of what is [planned](Run::plan).
    #[must_use]
    pub fn fraction(&self) -> f64 {
        self.before + self.share * self.work.fraction()
    }
}

impl<'f, F: Field + 'f> Run<'f, F> {
    /// Measures the particles and reports. Call it when the run has ended. Measurements made since
    /// the particles last changed are not repeated.
    pub fn report(&mut self) -> Report {
        self.report_with(Measured::Particles)
    }

    /// [`Run::report`], with other particles measured, or none.
    pub fn report_with(&mut self, measured: Measured) -> Report {
        self.state.report_with(&self.field, measured)
    }

    /// [`Run::report_with`] in slices, with [`Reporting::step`].
    pub fn measure(&mut self, measured: Measured) -> Reporting<'_> {
        self.state.measure(&self.field, measured)
    }

    /// [`Run::report_with`] in slices, up to `budget` of them, with the run free between them;
    /// returns the report once it is complete. Any other change in between aborts the measurement,
    /// and the next call starts again.
    pub(crate) fn measure_freely(&mut self, measured: Measured, budget: u32) -> Option<Report> {
        self.state.measure_freely(&shared(&self.field), measured, budget)
    }

    /// Measures particles that something else has placed on the surface, one row each, and keeps
    /// the result as the last measurement. [`Sampling`] says whether sizes vary; positions are
    /// relative to the origin of the run's own particles.
    pub fn measure_placed(&mut self, placed: &Particles, sampling: Sampling) -> Measures {
        self.state.measure_placed(&self.field, placed, sampling)
    }
}

impl<'f> RunState<'f> {
    /// The particles of the front that have to be measured, if wanted.
    fn wanted_front(&self, measured: Measured) -> Option<Arc<Particles>> {
        self.measuring.open_front().filter(|_| measured == Measured::FrontToo)
    }

    /// Whether wanted measurements have not been made since the particles changed.
    fn is_due(&self, measured: Measured) -> bool {
        measured != Measured::Nothing
            && (self.measuring.facing.is_none() || self.wanted_front(measured).is_some())
    }

    /// The input of a measurement of the particles, and of the front's if wanted.
    fn measuring_input(&self, measured: Measured) -> MeasuringInput {
        MeasuringInput {
            front: self.wanted_front(measured),
            now: measured_columns(self.particles()),
            bounds: self.local_bounds(),
            sampling: self.sampler.settings().sampling,
        }
    }

    /// [`Run::report_with`].
    pub(super) fn report_with(&mut self, field: &dyn Field, measured: Measured) -> Report {
        slices::in_pool(|| self.measure(field, measured).work.complete())
    }

    /// [`Run::measure`].
    fn measure<'a>(&'a mut self, field: &'a dyn Field, measured: Measured) -> Reporting<'a> {
        let is_due = self.is_due(measured);
        let (mut expected, mut share) = (0, 0.0);
        if is_due {
            self.measuring.stop();
            expected = expected_slices(self.wanted_front(measured).as_ref(), self.particles());
            share = self.shares().measuring;
        }
        let before = self.fraction();
        let work = Box::pin(async move {
            if measured == Measured::Nothing {
                self.measuring = Measuring::default();
            } else if is_due {
                let input = self.measuring_input(measured);
                let result = input.in_slices(&self.field.function(field), self.sampler.frame()).await;
                self.keep(field, result);
                while !self.close(field, 1) {
                    slices::pause().await;
                }
            }
            self.reported(field)
        });
        Reporting { work: Estimated::new(work, expected), before, share }
    }

    /// [`Run::measure_freely`].
    fn measure_freely(
        &mut self,
        field: &Arc<dyn Field + 'f>,
        measured: Measured,
        budget: u32,
    ) -> Option<Report> {
        if self.is_due(measured) {
            let begun = self.measuring.work.take();
            let work = begun.unwrap_or_else(|| {
                let field = self.field.shared(field);
                self.measuring_input(measured).work(field, self.sampler.frame())
            });
            let result = self.measuring.work.insert(work).advance(budget)?;
            self.measuring.work = None;
            self.keep(field, result);
        }
        if measured != Measured::Nothing && !self.close(field, budget) {
            return None;
        }
        Some(self.reported(field))
    }

    /// [`Run::measure_placed`].
    fn measure_placed(&mut self, field: &dyn Field, placed: &Particles, sampling: Sampling) -> Measures {
        self.measuring.stop();
        let bounds = self.local_bounds();
        let measured = slices::complete(measure(
            placed,
            &mut *self.evaluator(field),
            &bounds,
            sampling,
            &mut None,
            None,
        ));
        self.measuring.measured = measured;
        Measures { quality_before: None, ..self.measures() }
    }

    /// The figures of the last measurement, with places in the coordinates of the field.
    fn measures(&self) -> Measures {
        let (measured, origin) = (&self.measuring.measured, self.particles().origin);
        let mut places = measured.places.clone();
        for hole in &mut places.holes {
            hole.position = (origin + Vec3::from_array(hole.position).as_dvec3()).as_vec3().to_array();
        }
        Measures {
            quality: (!measured.valence.is_empty()).then_some(measured.figures),
            quality_before: self.measuring.front_figures,
            nearest_histogram: measured.histogram.clone(),
            places,
        }
    }

    fn keep(&mut self, field: &dyn Field, MeasuringResult { front, now, facing, sheets }: MeasuringResult) {
        if front.is_some() {
            (self.measuring.front, self.measuring.front_figures) = (None, front);
        }
        (self.measuring.measured, self.measuring.facing, self.measuring.sheets) =
            (now, Some(facing), Some(sheets));
        self.take_topology(field);
    }

    /// Joins the particles if their triangles leave the surface open: only the mesh, and the field,
    /// show which of the gaps are surface. With up to `budget` slices of the work; returns whether
    /// it is complete.
    fn close(&mut self, field: &dyn Field, budget: u32) -> bool {
        let is_due = self.measuring.measured.opening.is_some() && self.meshing.joined().is_none();
        !is_due || self.join(field, budget).is_some()
    }

    /// The report, with the present measurements.
    pub(super) fn reported(&mut self, field: &dyn Field) -> Report {
        self.add_own_values(field);
        let is_overflowing = self.sampler.is_open_by_overflow(&self.field.function(field));
        let blur = self.sampler.blur(&self.field.function(field));
        let particles = self.sampler.particles();
        let count = particles.count();
        let measured = &self.measuring.measured;
        let proof = self.proof(field, measured.figures.connectivity.components);
        let border = self.at_border();
        let mut warnings = self.warnings_of_run(field, &proof.sampled, self.measuring.facing.unwrap_or(0));
        warnings.extend(blur.map(|Blur { particle, distance }| Warning::Digits {
            position: particles.place(particle).to_array(),
            distance,
            spacing: 2.0 * f64::from(particles.radius[particle]),
        }));
        let ends_at_jumps = Warning::tell_of_jumps(&warnings);
        let of_mesh = |mesh| Warning::of_mesh(measured, mesh, ends_at_jumps);
        warnings.extend(self.meshing.joined().into_iter().flat_map(of_mesh));
        let inside = self.meshing.joined().map_or(measured.inside, |mesh| mesh.inside);
        warnings.extend(inside.filter(|&inside| inside != Inside::Negative).map(Warning::LargerInside));
        let is_beyond = self.reach == Some(Reach::Endless) && border == 0 && count > 0;
        warnings.extend(is_beyond.then_some(Warning::Beyond { bounds: self.bounds }));
        warnings.extend(is_overflowing.then_some(Warning::Overflow));
        Report {
            count,
            sizes: self.sizes(),
            growth: self.growth(field),
            warnings,
            proof,
            measures: self.measures(),
            joined_volume: self.meshing.joined().and_then(|mesh| mesh.volume(particles)),
            inside,
            smallest_angle: self.meshing.joined().and_then(|mesh| mesh.smallest_angle(particles)),
            pairs: particles.pairs(),
            border,
            cut: if border > 0 { self.cut(field) } else { None },
            stop_reason: self.last.as_ref().and_then(|progress| progress.stop_reason),
            digest: format!("{:016x}", particles.digest()),
        }
    }

    /// Number of particles at the border of the box, with a child that fell outside. A child beyond
    /// a crease is outside of its patch, which the distance from the box distinguishes: a child is
    /// two radii away. Particles that have moved had their children elsewhere; they count if a step
    /// of two radii in the tangent plane leads outside.
    pub(super) fn at_border(&self) -> usize {
        let (particles, bounds) = (self.particles(), self.local_bounds());
        let is_inside = |i: usize, reach: Vec3| {
            let (p, reach) = (particles.local[i], 2.0 * particles.radius[i] * reach);
            bounds.contains(p - reach) && bounds.contains(p + reach)
        };
        let is_at = |&i: &usize| {
            if self.has_moved() {
                return !is_inside(i, particles.normal[i].map(|n| (1.0 - n * n).max(0.0).sqrt()));
            }
            let slots = particles.slots[i];
            (0..Slots::COUNT).any(|slot| slots.get(slot) == SlotFate::Outside)
                && (particles.patch.is_empty() || !is_inside(i, Vec3::ONE))
        };
        let mut firsts: Vec<usize> =
            (0..particles.len()).filter(is_at).map(|i| particles.first_row(i)).collect();
        firsts.sort_unstable();
        firsts.dedup();
        firsts.len()
    }

    /// The reason why particles lie at the border of the box, if some do.
    fn cut(&self, field: &dyn Field) -> Option<Cut> {
        match self.reach {
            Some(Reach::Bounded) if self.has_moved() => Some(Cut::Outgrown),
            // Particles that are large compared with the surface may have a child outside of a box
            // that contains it.
            Some(Reach::Bounded) => self.passes_faces(field).then_some(Cut::Endless),
            Some(Reach::Endless | Reach::Nowhere | Reach::Unknown) => Some(Cut::Endless),
            None => Some(Cut::Fixed),
        }
    }

    /// Whether the surface passes through the faces of the box next to a particle.
    fn passes_faces(&self, field: &dyn Field) -> bool {
        let (particles, bounds, field) = (self.particles(), self.local_bounds(), &mut *self.evaluator(field));
        (0..particles.len()).any(|i| {
            let (p, reach) = (particles.local[i].as_dvec3(), 2.0 * f64::from(particles.radius[i]));
            (0..3).any(|axis| {
                let is_passed = |at: f64| {
                    (p[axis] - at).abs() <= reach && check::passes_plane(field, &bounds, p, reach, axis, at)
                };
                [bounds.min[axis], bounds.max[axis]].into_iter().any(is_passed)
            })
        })
    }

    /// Whether the particles have followed the surface while it moved.
    pub(super) fn has_moved(&self) -> bool {
        !self.particles().identity.is_empty()
    }

    fn sizes(&self) -> Radii {
        let sizes = self.particles().radius.iter().map(|&radius| f64::from(radius));
        let radius_max = sizes.clone().fold(0.0, f64::max);
        Radii { radius: self.sampler.radius(), radius_min: sizes.fold(radius_max, f64::min), radius_max }
    }

    fn growth(&self, field: &dyn Field) -> Growth {
        let particles = self.particles();
        let mut level_counts = Vec::new();
        for (i, &level) in particles.level.iter().enumerate() {
            if particles.first_row(i) != i {
                continue;
            }
            if level_counts.len() <= level as usize {
                level_counts.resize(level as usize + 1, 0);
            }
            level_counts[level as usize] += 1;
        }
        let counts = self.sampler.counts();
        let evaluations =
            counts.seeding_evaluations + counts.generation_evaluations + counts.relaxation_evaluations;
        Growth {
            levels: level_counts.len() as u32,
            level_counts,
            components_seeded: counts.seeds,
            gaps_filled: counts.gaps_filled,
            fates: counts.fates,
            evaluations,
            calls: self.field.calls(field),
            evaluations_per_particle: counts.front_evaluations as f64 / particles.count().max(1) as f64,
            refined_levels: counts.refined_levels,
            energy: Some(self.sampler.energy()).filter(|energy| !energy.is_empty()).map(<[f64]>::to_vec),
        }
    }

    /// The search for edges, also where it has found none; none if the field tells its pieces.
    pub(super) fn edge_search(&self, field: &dyn Field) -> Option<EdgeSearch> {
        self.edges_found(field).or_else(|| {
            let is_noisy = edges::is_noisy(field, &self.bounds)?;
            let cells = edges::cells_of(self.sampler.settings().survey_cells);
            Some(if is_noisy { EdgeSearch::Noisy } else { EdgeSearch::Grid { cells } })
        })
    }

    /// See [`Proof::edges_found`].
    fn edges_found(&self, field: &dyn Field) -> Option<EdgeSearch> {
        self.field.function(field).facts().edge_cells.map(|cells| EdgeSearch::Grid { cells })
    }

    fn proof(&self, field: &dyn Field, components: usize) -> Proof {
        let mut sampled = self.sampler.sampled();
        for witness in &mut sampled.without {
            witness.position = self.place(witness.position);
        }
        let [creases, seams] = creases_and_seams(self.particles());
        Proof {
            components,
            search: self.sampler.search(),
            sampled,
            undecided_cells: self.sampler.undecided_cells(),
            singular_points: self.sampler.singular_points(),
            creases: creases.as_ref().map(|creases| creases.curves),
            corners: creases.map(|creases| creases.ends),
            edges_found: self.edges_found(field),
            seams: seams.map(|seams| seams.curves),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::formula::Formula;
    use crate::math::Bounds;
    use crate::sampler::Settings;

    #[test]
    fn a_surface_that_passes_through_the_faces_of_its_fitted_box_is_said_to() {
        // In the second case particles are so large that children fall outside of the box.
        for (half, radius_share, is_cut) in [(0.9, 0.02, true), (1.05, 0.2, false), (1.3, 0.02, false)] {
            let field = Formula::parse("x^2 + y^2 + z^2 = 1").expect("a formula");
            let mut run = Run::idle(field, Bounds::cube(half));
            run.set_bounds(Bounds::cube(half), Some(Reach::Bounded));
            run.begin(&Settings { radius_share, ..Settings::DEFAULT }, None).expect("a good box");
            while run.step(u32::MAX).stop_reason.is_none() {}
            let report = run.report();
            assert!(report.count > 0 && (report.border > 0 || !is_cut), "{half}");
            assert_eq!(report.cut.is_some(), is_cut, "{half}: {:?}", report.cut);
        }
    }
}
