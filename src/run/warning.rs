//! Warnings about a run: a typed list. The first sentence of each says in one line what happened
//! and what to do; the others are details, which the page folds away.

mod kind;
mod missing;

use super::jumps::breaks_in;
use super::report::creases_and_seams;
use super::{EdgeSearch, Report, RunState, Severity, check};
use crate::field::model::{GivenMesh, GivenTopology, ModelInfo};
use crate::field::{Field, edges};
use crate::math::{Bounds, counted, place_text, significant};
use crate::mesh::facing::Inside;
use crate::mesh::triangulation::Triangulation;
use crate::particles::Particles;
use crate::quality::Measurements;
use crate::quality::figures::Connectivity;
use crate::sampler::{
    COUNT_TOLERANCE, Doubt, FateCounts, Forecast, Refusal, Sampled, SingularKind, SizeMode, Smoothing,
    StopReason, Unsampled,
};
use core::fmt;
use glam::DVec3;
#[cfg(test)]
pub(super) use kind::Told;
use missing::{about_length, unproven, without_particle};

/// Sheets are reported as close if at least this share of the particles faces another sheet. The
/// particles around a tip face each other too, up to 15 of them at any radius. Smaller: more tips
/// are mistaken for close sheets; larger: more close sheets are missed.
const CLOSE_SHARE: f64 = 0.005;
/// Sheets are reported as close if at least this many particles face another sheet: in samples of a
/// few hundred, tips exceed the share. Smaller: more tips are mistaken for close sheets; larger:
/// more close sheets are missed.
const CLOSE_COUNT: usize = 8;
/// Maximum number of places of components without a particle that a message names, as a note of
/// some four lines holds. A choice; the report has all of them.
const NAMED: usize = 4;

/// Particles count as finer than an image if their spacing is below this multiple of the voxels'
/// spacing. Larger: a warning appears although the image still determines their places.
const FINEST: f64 = 0.5;

/// Largest difference between the areas of a mesh and of the surface fitted to it that gives no
/// warning, as a share of the mesh's area. For smooth meshes it is 0.1 %; rounded edges take 2 % of
/// a cylinder, 4 % of a washer and 5 % of a cube.
const AREA_TOLERANCE: f64 = 0.01;
/// The triangles of N particles on a sphere lack 3/N of its area. Most surfaces bend at most as
/// much as four such spheres.
const LACKING: f64 = 12.0;

/// A warning about a run. The first sentence of its `Display` says what happened and what to do, in
/// at most 110 letters and without the terms of the method; the others are details.
///
/// Positions are in the coordinates of the field. `length` is the radius of the run; `Display`
/// rounds positions to a thousandth of it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// More particles would fit than the limit allows.
    Limit {
        /// Expected number of particles.
        predicted: u64,
        /// The limit, [`Settings::max_particles`](crate::sampler::Settings::max_particles).
        limit: u32,
    },
    /// f touches zero without changing its sign.
    Touches,
    /// f also vanishes on a curve or at a point, where it has no surface.
    Bare {
        /// A place where it does.
        position: [f64; 3],
        /// Radius of the run.
        length: f64,
    },
    /// Parts of the surface are outside of the fitted box, which cuts none of it.
    Beyond {
        /// The fitted box.
        bounds: Bounds,
    },
    /// An equivalent equation of the surface is sampled.
    SampledAs {
        /// The equation that is sampled.
        equation: String,
    },
    /// The spacing changes faster than the [grading](crate::Settings::grading) lets sizes follow.
    Smoothed {
        /// Share of the area on which particles are nearer to each other than wanted, by more than
        /// 5 %.
        share: f64,
        /// Largest ratio of the spacing and the distance between neighbours.
        ratio: f64,
        /// The place of the largest ratio.
        position: [f64; 3],
        /// Radius of the run.
        length: f64,
    },
    /// Cutters of a solid lie flush with faces of it.
    FlushFaces {
        /// The faces, as equations.
        faces: Vec<String>,
    },
    /// The particles are finer than the values that the field is interpolated from.
    Finer {
        /// Distance between neighbouring particles.
        spacing: f64,
        /// Distance between the values that are interpolated.
        resolution: f64,
    },
    /// Names that the formula defines, and that nothing uses.
    Unused {
        /// The names.
        names: Vec<String>,
    },
    /// The gradient given by the field does not match its values.
    Gradient {
        /// Position at which the two differ.
        position: [f64; 3],
        /// The position is rounded to a thousandth of this length.
        length: f64,
    },
    /// A wanted number of particles was missed by more than the promised 3 %.
    Count {
        /// Number of particles.
        count: usize,
        /// Wanted number of particles.
        wanted: u32,
    },
    /// A refinement was requested, but the front was kept.
    NotRefined(Refusal),
    /// Opposite faces of a cell do not agree.
    Unpaired {
        /// The axis across the faces: 0, 1 or 2.
        axis: usize,
        /// Whether the surface repeats after the width of the box.
        repeats: bool,
    },
    /// Children could not be placed.
    Children {
        /// Number of children that found no surface at the right distance.
        not_converged: u64,
        /// Number of children that met a place where f or the normal is undefined.
        undefined: u64,
        /// Whether the particles were measured and close the surface anyway.
        is_closed: bool,
    },
    /// Particles face another sheet within their diameter.
    CloseSheets {
        /// Number of particles that face another sheet.
        count: usize,
    },
    /// The surface crosses itself along curves, or touches itself at points, where f has no
    /// gradient.
    Meets {
        /// Number of sets of curves along which it crosses itself.
        crossings: usize,
        /// Number of points at which it touches itself.
        touches: usize,
        /// A place where the surface crosses or touches itself.
        position: [f64; 3],
        /// Radius of the run.
        length: f64,
    },
    /// The surface ends in a cusp along curves, where f has no gradient.
    Rims {
        /// Number of curves.
        curves: usize,
        /// A place where it does.
        position: [f64; 3],
        /// Radius of the run.
        length: f64,
    },
    /// Sheets of the surface cross along creases.
    Crosses {
        /// Number of curves.
        curves: usize,
        /// Position of a particle on the first one.
        position: [f64; 3],
        /// Radius of the run.
        length: f64,
    },
    /// The particles have followed the surface while it moved.
    Moved,
    /// The run was ended because too many seeds stayed alone next to other particles.
    EndedEarly {
        /// Number of seeds undone.
        seeds: u32,
    },
    /// Features within the reach of other particles are too small for a particle of their own.
    SmallFeatures {
        /// Number of features too small for a particle of their own.
        count: u32,
    },
    /// Components of the surface hold no particle.
    WithoutParticle {
        /// The components without a particle, at least one.
        components: Vec<Unsampled>,
        /// Radius of the run.
        length: f64,
        /// Whether sheets are too near to be distinguished, so that a smaller radius does not help.
        is_unresolved: bool,
    },
    /// The triangles between the particles do not close the surface, or close it without some of
    /// them.
    Open {
        /// Number of edges of one triangle alone.
        edges: usize,
        /// Number of particles in no triangle.
        points: usize,
        /// Position of an open edge or of a particle in no triangle.
        position: [f64; 3],
        /// Radius of the run.
        length: f64,
        /// The search for edges in the values of f, if there was one.
        search: Option<EdgeSearch>,
        /// Whether f has no value beside that position.
        is_undefined: bool,
    },
    /// The surface ends where f jumps from one sign to the other.
    Jumps {
        /// A place where it does.
        position: [f64; 3],
        /// Radius of the run.
        length: f64,
    },
    /// The mesh and the triangles between the particles have different topologies.
    MeshDiffers {
        /// Components of the mesh and of the sample.
        components: [usize; 2],
        /// Euler numbers of the mesh and of the sample.
        euler: [i64; 2],
    },
    /// The mesh has border loops where no manifold was possible.
    MeshHoles {
        /// Number of border loops.
        count: usize,
    },
    /// Parts of the mesh touch in vertices that they share.
    MeshTouches {
        /// Number of such vertices.
        count: usize,
    },
    /// Particles are in no triangle of the mesh.
    MeshLeavesOut {
        /// Number of particles.
        count: usize,
    },
    /// f is larger inside of closed parts of the surface than outside.
    LargerInside(Inside),
    /// The surface that was fitted to a mesh has another topology or area than the mesh.
    FileDiffers {
        /// The mesh of the file.
        mesh: GivenMesh,
        /// Components of the sample.
        components: usize,
        /// Euler number of the sample.
        euler: i64,
        /// Area of the sample.
        area: f64,
        /// Position of the point of the file that is farthest from the surface.
        position: [f64; 3],
        /// Radius of the run.
        length: f64,
    },
    /// The search has not proven that every component of the surface has been found.
    Unproven {
        /// The reason. Its position is in the coordinates of the field.
        doubt: Doubt,
        /// Radius of the run.
        length: f64,
    },
    /// Rounding in double precision may move the surface by more than 10⁻⁴ of the distance between
    /// neighbours.
    Digits {
        /// The particle, of a selection, with the largest effect.
        position: [f64; 3],
        /// Bound of the distance by which the surface moves near the particle.
        distance: f64,
        /// Wanted distance between neighbours near the particle.
        spacing: f64,
    },
    /// The search was left undecided near places where f overflows double precision.
    Overflow,
}

impl Warning {
    /// The warnings about a mesh. Its topology is compared with the particles' topology, if they
    /// were measured and their triangles leave no gaps. Where a box cuts the surface, the two end
    /// differently near its faces, and only the components are compared; where f jumps they do so
    /// everywhere, and nothing is compared.
    pub(super) fn of_mesh(measured: &Measurements, mesh: &Triangulation, ends_at_jumps: bool) -> Vec<Self> {
        let mut warnings = Vec::new();
        let Connectivity { components, euler, .. } = measured.figures.connectivity;
        let is_cut = measured.figures.boundary_excluded > 0;
        let components = [mesh.topology.components.len(), components];
        let euler = [mesh.topology.euler(), euler];
        let differs = components[0] != components[1] || !is_cut && euler[0] != euler[1];
        // Triangles of natural neighbours with gaps have no topology to compare.
        let is_comparable = !ends_at_jumps && !measured.valence.is_empty() && measured.opening.is_none();
        if differs && is_comparable {
            warnings.push(Self::MeshDiffers { components, euler });
        }
        if !mesh.unfilled.is_empty() {
            warnings.push(Self::MeshHoles { count: mesh.unfilled.len() });
        }
        let touches = mesh.topology.pinched_vertices.len();
        if touches > 0 {
            warnings.push(Self::MeshTouches { count: touches });
        }
        if !mesh.left_out.is_empty() {
            warnings.push(Self::MeshLeavesOut { count: mesh.left_out.len() });
        }
        warnings
    }

    /// Whether one of these warnings reports that the surface ends where f jumps.
    pub(super) fn tell_of_jumps(warnings: &[Self]) -> bool {
        warnings.iter().any(|warning| matches!(warning, Self::Jumps { .. }))
    }

    /// The warning about a surface that was fitted to the mesh of a file, if it has another
    /// topology than the mesh or if their areas differ by more than 5 %.
    #[must_use]
    pub fn of_file(model: &ModelInfo, report: &Report) -> Option<Self> {
        let (mesh, figures) = (model.mesh?, report.measures.quality?);
        let Connectivity { components, euler, .. } = figures.connectivity;
        let is_other =
            mesh.topology.is_some_and(|given| (given.components, given.euler) != (components, euler));
        let tolerance = AREA_TOLERANCE + LACKING / report.count.max(1) as f64;
        let differs = is_other || (figures.area / mesh.area - 1.0).abs() > tolerance;
        let (position, length) = (model.farthest, report.sizes.radius);
        let area = figures.area;
        differs.then_some(Self::FileDiffers { mesh, components, euler, area, position, length })
    }
}

impl RunState<'_> {
    /// Returns the warnings known at the start, with this forecast and at most `limit` particles.
    pub(super) fn known_at_start(&mut self, field: &dyn Field, start: Forecast, limit: u32) -> Vec<Warning> {
        let mut warnings = Vec::new();
        let Forecast { predicted_count: predicted, radius, .. } = start;
        if predicted > u64::from(limit) {
            warnings.push(Warning::Limit { predicted, limit });
        }
        if self.sampler.touches() {
            warnings.push(Warning::Touches);
        }
        warnings.extend(self.sampler.smoothing().map(|Smoothing { share, ratio, position }| {
            let position = self.place(position.as_dvec3().to_array());
            Warning::Smoothed { share, ratio, position, length: self.sampler.radius() }
        }));
        // Derivatives of a field with bounds are derived, not given.
        let bounds = self.local_bounds();
        let evaluator = &mut *self.evaluator(field);
        if evaluator.bounded().is_none()
            && let Some(at) = check::wrong_gradient(evaluator, &bounds)
            // Differences of values that are noisy show nothing.
            && edges::is_noisy(field, &self.bounds) != Some(true)
        {
            let position = self.place(at.to_array());
            warnings.push(Warning::Gradient { position, length: self.bounds.diagonal() });
        }
        let facts = field.facts();
        warnings.extend(facts.sampled_as.map(|equation| Warning::SampledAs { equation }));
        let spacing = 2.0 * radius;
        if let Some(resolution) = facts.resolution.filter(|resolution| spacing < FINEST * resolution) {
            warnings.push(Warning::Finer { spacing, resolution });
        }
        if !facts.unused.is_empty() {
            warnings.push(Warning::Unused { names: facts.unused });
        }
        if !facts.flush_faces.is_empty() {
            warnings.push(Warning::FlushFaces { faces: facts.flush_faces });
        }
        warnings
    }

    /// The warning about the faces of a cell across an axis, if particles lie on them and do not
    /// match.
    fn unpaired(&self, field: &dyn Field, axis: usize) -> Option<Warning> {
        let cell = field.facts().unit_cell?.relative_to(self.particles().origin);
        let Particles { local: position, opposite, .. } = self.particles();
        let faces = [cell.bounds.min[axis], cell.bounds.max[axis]].map(|at| at as f32);
        let is_paired = opposite.iter().any(|faces| usize::from(faces.axis) == axis);
        let is_reached = || position.iter().any(|p| faces.contains(&p[axis]));
        (!is_paired && is_reached()).then_some(Warning::Unpaired { axis, repeats: cell.repeats[axis] })
    }

    /// The warnings about the run. The places in `sampled` are in the coordinates of the field;
    /// `facing` is the number of particles that face another sheet.
    pub(super) fn warnings_of_run(
        &self,
        field: &dyn Field,
        sampled: &Sampled,
        facing: usize,
    ) -> Vec<Warning> {
        let total = self.particles().count();
        let (length, settings, counts) =
            (self.sampler.radius(), self.sampler.settings(), self.sampler.counts());
        let mut warnings = self.start.warnings.clone();
        let stop_reason = self.last.as_ref().and_then(|progress| progress.stop_reason);
        let is_met = (total as f64 / f64::from(settings.count) - 1.0).abs() <= COUNT_TOLERANCE;
        if settings.size_mode == SizeMode::Count
            && matches!(stop_reason, Some(StopReason::Complete | StopReason::OneParticle))
            && !is_met
        {
            warnings.push(Warning::Count { count: total, wanted: settings.count });
        }
        let bare = self.sampler.bare_place().map(|place| self.place(place.to_array()));
        warnings.extend(bare.map(|position| Warning::Bare { position, length }));
        let doubts = self.sampler.doubts();
        let is_unresolved = doubts.iter().any(|doubt| matches!(doubt, Doubt::Unresolved { .. }));
        let origin = self.particles().origin;
        warnings.extend(counts.refusal.map(|refusal| Warning::NotRefined(refusal.counted_from_zero(origin))));
        let unpaired = [0, 1, 2].map(|axis| self.unpaired(field, axis));
        warnings.extend(unpaired.into_iter().flatten().filter(|_| stop_reason == Some(StopReason::Complete)));
        // Children of a coarse front do not matter once its mesh has been checked and refined.
        let FateCounts { not_converged, undefined, .. } =
            if counts.refined_levels.is_some() { FateCounts::default() } else { counts.fates };
        let ends = self.ends(field);
        // New particles find no surface beyond its ends.
        let is_told = ends.at_jump.is_some() && ends.others.is_none();
        if (not_converged > 0 || undefined > 0) && !is_told {
            // Figures of other particles do not apply to these.
            let is_closed = self.measuring.facing.is_some() && self.measuring.measured.opening.is_none();
            warnings.push(Warning::Children { not_converged, undefined, is_closed });
        }
        if self.has_moved() {
            warnings.push(Warning::Moved);
        }
        let [meets, rims] = self.singular_warnings(field);
        let meets = [rims, meets, self.crossing()];
        // A smaller radius does not separate sheets that meet.
        let is_close = !is_unresolved && meets.iter().all(Option::is_none) && facing >= CLOSE_COUNT;
        warnings.extend(meets.into_iter().flatten());
        if is_close && facing as f64 >= CLOSE_SHARE * total as f64 {
            warnings.push(Warning::CloseSheets { count: facing });
        }
        if counts.ended_early {
            warnings.push(Warning::EndedEarly { seeds: counts.left_out });
        }
        // If the run was audited, components without particles are named.
        if sampled.missing.is_none() && counts.left_out > 0 {
            warnings.push(Warning::SmallFeatures { count: counts.left_out });
        }
        if !sampled.without.is_empty() {
            let components = sampled.without.clone();
            warnings.push(Warning::WithoutParticle { components, length, is_unresolved });
        }
        if let Some(place) = ends.at_jump {
            warnings.push(Warning::Jumps { position: self.place(place.to_array()), length });
        }
        if let (Some(opening), Some(place), false) =
            (&self.measuring.measured.opening, ends.others, is_unresolved)
        {
            let position = self.place(place.to_array());
            let (edges, points) = (opening.edges, opening.points);
            let search = self.edge_search(field);
            let is_undefined = ends.is_undefined;
            warnings.push(Warning::Open { edges, points, position, length, search, is_undefined });
        }
        // Sheets too near to be distinguished leave witnesses open, which is reported already. No
        // model from points has bounds, which the row of the report says; of its creases nothing is
        // said. How components of a moved surface were searched for is reported already, too.
        let has_bounds = !doubts.contains(&Doubt::NoBounds);
        let is_told = |doubt: &Doubt| match doubt {
            Doubt::NoBounds => false,
            Doubt::Creases => has_bounds,
            Doubt::Witnesses { .. } => !is_unresolved,
            Doubt::Unfinished => !self.has_moved(),
            // A cell at a jump stays open at any radius and in any box.
            Doubt::Cells { position, size, .. } => {
                let place = DVec3::from_array(*position);
                ends.at_jump.is_none() || !breaks_in(&mut *self.evaluator(field), place, *size)
            }
            Doubt::Unresolved { .. } => true,
        };
        let moved = doubts.into_iter().filter(is_told).map(|doubt| doubt.moved(|place| self.place(place)));
        warnings.extend(moved.map(|doubt| Warning::Unproven { doubt, length }));
        warnings
    }

    /// The warning that sheets cross in creases, if they do.
    fn crossing(&self) -> Option<Warning> {
        let [creases, _] = creases_and_seams(self.particles());
        let creases = creases?;
        let position = self.particles().place(creases.crossing? as usize).to_array();
        Some(Warning::Crosses { curves: creases.crossings, position, length: self.sampler.radius() })
    }

    /// The warnings about places where the gradient vanishes: where the surface crosses or touches
    /// itself, and where it ends in a cusp.
    fn singular_warnings(&self, field: &dyn Field) -> [Option<Warning>; 2] {
        let length = self.sampler.radius();
        let field = &mut *self.evaluator(field);
        let places = self.sampler.singular_places();
        let kinds: Vec<SingularKind> = places.iter().map(|place| place.kind_by_signs(field)).collect();
        let found = |wanted: &[SingularKind]| {
            let first = kinds.iter().position(|kind| wanted.contains(kind))?;
            Some(self.place(places[first].position.to_array()))
        };
        let count = |wanted: SingularKind| kinds.iter().filter(|&&kind| kind == wanted).count();
        let [crossings, touches, rims] =
            [SingularKind::Crossing, SingularKind::Touch, SingularKind::Rim].map(count);
        let meets = found(&[SingularKind::Crossing, SingularKind::Touch]);
        let meets = meets.map(|position| Warning::Meets { crossings, touches, position, length });
        let ends = found(&[SingularKind::Rim]);
        [meets, ends.map(|position| Warning::Rims { curves: rims, position, length })]
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Limit { predicted, limit } => write!(
                f,
                "About {predicted} particles fit here; the run stops at the limit of {limit}."
            ),
            Self::Touches => f.write_str(
                "The surface is covered twice, because f touches zero without changing its sign. Both sides are sampled. \
                 If f is a square, enter what is squared instead.",
            ),
            Self::Bare { position, length } => write!(
                f,
                "f is also zero along a curve or at a point, where it has no surface to sample. It keeps one sign around that \
                 place, near {}.",
                place_text(*position, *length)
            ),
            Self::Beyond { bounds } => {
                let [min, max] = [bounds.min, bounds.max].map(|corner| place_text(corner, bounds.diagonal()));
                write!(
                    f,
                    "Parts of the surface lie outside the fitted box and are not sampled: set a larger box. It reaches from {min} \
                     to {max}."
                )
            }
            Self::SampledAs { equation } => write!(
                f,
                "The same surface is sampled in a simpler form. The powers, roots or absolute values of whole factors in f \
                 have no gradient on the surface; without them it is {equation}"
            ),
            Self::Smoothed { share, ratio, position, length } => write!(
                f,
                "Particles lie closer than the spacing asks on {:.1} % of the surface: a larger grading follows it. Near {} the \
                 spacing is {ratio:.2} times the distance of neighbours.",
                100.0 * share,
                place_text(*position, *length)
            ),
            Self::FlushFaces { faces } => write!(
                f,
                "A cutter lies flush with a face of the solid, and no skin is left between them. {} {}.",
                if faces.len() == 1 { "It is" } else { "They are" },
                faces.join(", ")
            ),
            Self::Finer { spacing, resolution } => write!(
                f,
                "The particles are finer than the image, and show how its voxels are interpolated. They are {} apart, the \
                 voxels {}.",
                significant(*spacing),
                significant(*resolution)
            ),
            Self::Unused { names } => {
                let (verb, names) = (if names.len() == 1 { "is" } else { "are" }, names.join(", "));
                write!(f, "{names} {verb} defined and not used: leave that out, or check the name.")
            }
            Self::Gradient { position, length } => write!(
                f,
                "The gradient does not fit the values of f: correct it, or leave it out. Near {} the two differ, so that particles \
                 may lie off the surface and face the wrong way. A gradient that is left out is found by differences.",
                place_text(*position, *length)
            ),
            Self::Count { count, wanted } => write!(
                f,
                "The run has {count} particles instead of {wanted}. Where particles are large compared with the surface, or lie in \
                 rows along edges, a small change of the radius changes their number by much."
            ),
            Self::NotRefined(refusal) => refusal.fmt(f),
            Self::Unpaired { axis, repeats } => {
                let axis = ["x", "y", "z"][*axis];
                f.write_str(if *repeats {
                    "The cell does not repeat: move the box. "
                } else {
                    "The cell does not repeat: set a box of whole periods. "
                })?;
                let reason = if *repeats {
                    "their edges differ, as where the surface runs through a corner or along an edge of the box."
                } else {
                    "the box is not known to be a whole number of periods wide there."
                };
                write!(f, "The faces across {axis} are closed, but not the same: {reason}")
            }
            Self::Children { not_converged, undefined, is_closed } => {
                let [not_converged, undefined] = [*not_converged, *undefined].map(|count| count as usize);
                let places = counted(not_converged + undefined, "place", "places");
                if *is_closed {
                    write!(
                        f,
                        "At {places} the surface is sharp or thin; the particles around them close it."
                    )?;
                } else {
                    write!(
                        f,
                        "At {places} the surface is too sharp or thin for this radius: choose a smaller one."
                    )?;
                }
                let found = those_that_are([
                    (not_converged, format!("no surface at the right distance ({not_converged})")),
                    (undefined, format!("no value or no normal ({undefined})")),
                ]);
                write!(f, " New particles found {found} there. At a singular point no radius helps.")
            }
            Self::CloseSheets { count } => write!(
                f,
                "Sheets of the surface lie closer than the particles are wide: choose a smaller radius. {count} particles face \
                 another sheet within 2r. The sheets are kept apart, but not by position alone."
            ),
            Self::Meets { crossings, touches, position, length } => {
                let meets = those_that_are([
                    (*crossings, format!("crosses itself along {}", counted(*crossings, "curve", "curves"))),
                    (*touches, format!("touches itself at {}", counted(*touches, "point", "points"))),
                ]);
                write!(
                    f,
                    "The surface {meets}. f has no gradient there, first near {}, and the sheets are sampled up to it: parts that meet only \
                     there count as components of their own, also in the Euler number.",
                    place_text(*position, *length)
                )
            }
            Self::Rims { curves, position, length } => write!(
                f,
                "The surface has {}. f has no gradient there, first near {}: normals turn over, and the particles lie beside it.",
                counted(*curves, "sharp rim", "sharp rims"),
                place_text(*position, *length)
            ),
            Self::Crosses { curves, position, length } => write!(
                f,
                "Sheets of the surface cross along {}. They share the particles there, first near {}: components and Euler number \
                 are those of all sheets together, and the mesh is no manifold.",
                counted(*curves, "curve", "curves"),
                place_text(*position, *length)
            ),
            Self::Moved => f.write_str(
                "The particles have moved with the surface: a new run places them in better order. They are even, but fewer have \
                 six neighbours than after a run, and a component that appeared meanwhile can be missing.",
            ),
            Self::EndedEarly { seeds } => write!(
                f,
                "The run ended early, because the particles are too large here: choose a smaller radius. {seeds} parts of the \
                 surface had room for one particle alone, beside those of other parts."
            ),
            Self::SmallFeatures { count } => write!(
                f,
                "Some features are too small for a particle of their own: choose a smaller radius. There are {count} within 2r of \
                 other particles; they may be components of their own."
            ),
            Self::WithoutParticle { components, length, is_unresolved } => {
                without_particle(f, components, *length, *is_unresolved)
            }
            Self::Open { edges: 0, points, position, length, .. } => write!(
                f,
                "{} in no triangle: the others close the surface all the same. The first is near {}.",
                counted(*points, "particle is", "particles are"),
                place_text(*position, *length)
            ),
            Self::Open { edges, points, position, length, search, is_undefined } => {
                let found = those_that_are([
                    (*edges, counted(*edges, "open edge", "open edges")),
                    (*points, format!("{} in no triangle", counted(*points, "particle", "particles"))),
                ]);
                write!(
                    f,
                    "The particles leave gaps in the surface: choose a smaller radius. Their triangles have {found}, first near {}, so \
                     that components and Euler number may be wrong. Where the surface has an edge, a tip or an end, no radius helps.",
                    place_text(*position, *length)
                )?;
                match search {
                    _ if *is_undefined => f.write_str(
                        " f has no value beside that place, and the surface ends where f does: give f values beyond, or a box that \
                         leaves the end out.",
                    ),
                    None => Ok(()),
                    Some(EdgeSearch::Noisy) => f.write_str(
                        " The values of f are too noisy to show its edges: compute them in double precision, or state the edges by \
                         the pieces of f or a union of bodies.",
                    ),
                    Some(search @ EdgeSearch::Grid { .. }) => write!(
                        f,
                        " Edges were searched {search}: a smaller box shows finer ones, and an edge can be stated, by the pieces of f \
                         or a union of bodies."
                    ),
                }
            }
            Self::Jumps { position, length } => write!(
                f,
                "f jumps where the surface ends, first near {}: there is no zero between its parts. To close it, put a steep \
                 slope in place of the jump, as of smoothstep.",
                place_text(*position, *length)
            ),
            Self::MeshDiffers { components, euler } => {
                let told = |k: usize| {
                    let components = counted(components[k], "component", "components");
                    format!("{components} and Euler number {}", euler[k])
                };
                write!(
                    f,
                    "The topology of the mesh is in doubt: choose a smaller radius. The mesh has {}, the particles {}; at least one \
                     of them differs from the surface.",
                    told(0),
                    told(1)
                )
            }
            Self::MeshHoles { count } => write!(
                f,
                "The mesh has {}, where sheets meet or particles are too sparse.",
                counted(*count, "hole that could not be filled", "holes that could not be filled")
            ),
            Self::MeshTouches { count } => write!(
                f,
                "Parts of the mesh touch in {}, where it is no manifold.",
                counted(*count, "point", "points")
            ),
            Self::MeshLeavesOut { count } => {
                write!(f, "{} in no triangle of the mesh.", counted(*count, "particle is", "particles are"))
            }
            Self::LargerInside(inside) => {
                let place = if *inside == Inside::Both { " some closed parts of" } else { "" };
                write!(
                    f,
                    "f is larger inside{place} the surface than outside. Meshes in files face outward all the same; the normals of \
                     particles follow the gradient of f and point inward."
                )
            }
            Self::FileDiffers { mesh, components, euler, area, position, length } => {
                let told = |components: usize, euler: i64, area: f64| {
                    let components = counted(components, "component", "components");
                    format!("{components}, Euler number {euler} and area {area:.3}")
                };
                let given = match mesh.topology {
                    Some(GivenTopology { components, euler, .. }) => told(components, euler, mesh.area),
                    None => format!("area {:.3} and edges of more than two faces", mesh.area),
                };
                write!(
                    f,
                    "The surface differs from the mesh of the file: use more centres. The mesh has {given}, the surface {}: holes are \
                     closed, parts joined or edges rounded. The farthest point of the file is near {}.",
                    told(*components, *euler, *area),
                    place_text(*position, *length)
                )?;
                let is_open = mesh.topology.is_some_and(|topology| topology.borders > 0);
                f.write_str(if is_open { " The mesh is open: the surface may continue beyond its borders." } else { "" })
            }
            Self::Unproven { doubt, length } => unproven(f, doubt, *length),
            Self::Digits { position, distance, spacing } => write!(
                f,
                "Rounding errors in f move the surface: enter f in a form whose terms do not cancel. Near {} the surface may be off by \
                 up to {}, {} times the distance between neighbours.",
                place_text(*position, *spacing),
                about_length(*distance),
                about_length(distance / spacing)
            ),
            Self::Overflow => f.write_str(
                "f overflows in a part of the box, where the surface may be missed: make the box smaller. Or enter f in a form with \
                 smaller numbers, for example the logarithm of each factor.",
            ),
        }
    }
}

/// The words for those things whose count is not 0.
fn those_that_are(things: [(usize, String); 2]) -> String {
    let words = things.into_iter().filter(|(count, _)| *count > 0).map(|(_, words)| words);
    words.collect::<Vec<_>>().join(" and ")
}

#[cfg(test)]
mod tests;
