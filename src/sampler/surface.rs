//! The surface of a field in a box, as it is found out before particles are placed: the frame in
//! which f is evaluated, points of the surface on a grid, its creases, singular points and tips.
//!
//! The sampler makes a [`Surface`] once, at the start of a run; the stages of its methods read it.

use super::discovery::grid::DENSE_CELLS;
use super::discovery::octree::Octree;
use super::discovery::search::ComponentSearch;
use super::discovery::singular::{self, Bend, NearSurvey, Singular};
use super::discovery::survey::{Absence, Survey, bare_among, bare_size, spacing, survey};
use super::discovery::{completeness::Search, precision};
use super::probe::{Probe, ProbeMemory};
use crate::field::edges::{self, KnownPieces};
use crate::field::{Field, Frame};
use crate::math::Bounds;
use crate::sampler::constraint::Creases;
use crate::sampler::constraint::tips::Tip;
use crate::slices::Work;
use glam::{DVec3, Vec3};

/// The surface of a field in a box. It is found out once; methods only read it.
#[derive(Clone, Default)]
pub(super) struct Surface {
    /// The box, relative to the origin of the frame.
    pub(super) bounds: Bounds,
    /// The frame in which the field is evaluated.
    pub(super) frame: Frame,
    pub(super) survey: Survey,
    pub(super) creases: Creases,
    /// The singular points near those of the survey.
    pub(super) singular: Vec<Singular>,
    pub(super) tips: Vec<Tip>,
    /// The search for components by bounds, with its witnesses, once a run has completed it.
    pub(super) searched: Option<Octree>,
}

/// The creases of a surface in a box, and the function whose patches they separate.
#[derive(Clone, Default)]
pub(crate) struct FoundCreases {
    pub(crate) creases: Creases,
    /// What is known of the pieces of the field; those that meet smoothly on the surface are one.
    pub(crate) known: Option<KnownPieces>,
}

/// Finds, in slices, the creases of the surface of a field in a box given relative to `origin`. In
/// the values of f they are searched on a grid with so many `cells` along the longest side of the
/// box, by default 64.
pub(crate) fn find_creases<'a>(
    field: &'a dyn Field,
    origin: DVec3,
    bounds: &Bounds,
    cells: Option<u32>,
) -> Work<'a, FoundCreases> {
    let bounds = *bounds;
    Box::pin(async move {
        let (outward, width) = (Frame::around(origin).outward(&bounds), Creases::width(&bounds));
        let found = edges::known_in(field, &outward, width, edges::cells_of(cells)).await;
        let Some((cells, known)) = found else { return FoundCreases::default() };
        let function = KnownPieces::of(known.as_ref(), field);
        let creases = if cells.is_empty() {
            Creases::default()
        } else {
            let cells: Vec<Bounds> = cells.iter().map(|cell| cell.relative_to(origin)).collect();
            let unit_cell = function.facts().unit_cell.map(|cell| cell.relative_to(origin));
            let mut evaluator = function.evaluator(frame_for(&function, origin, &bounds));
            let mut memory = ProbeMemory::default();
            let probe = &mut Probe::new(&mut *evaluator, &mut memory);
            Creases::find(probe, &bounds, &cells, unit_cell).await
        };
        FoundCreases { creases, known }
    })
}

/// The frame that scales values and gradients of a field in a box into the range of the numbers
/// they are computed with.
fn frame_for(field: &dyn Field, origin: DVec3, bounds: &Bounds) -> Frame {
    /// Points along each axis: 125 of them, off the faces of the box and its planes of symmetry,
    /// fill one batch.
    const SIDE: usize = 5;
    let frame = Frame { length: bounds.diagonal(), ..Frame::around(origin) };
    let double = precision::double_scale(&mut *field.evaluator(frame), bounds);
    let spread: Vec<Vec3> = bounds.spread(SIDE).map(|p| p.as_vec3()).collect();
    Frame { double, ..frame }.scaled_to(field, spread.into_iter())
}

impl Surface {
    /// Surveys the surface of a field in a box given relative to `origin`, whose creases are known,
    /// in about 40,000 evaluations; 80,000, on a grid of so many `cells` if given, for a field
    /// without bounds.
    pub(super) fn find(
        function: &dyn Field,
        origin: DVec3,
        bounds: &Bounds,
        cells: Option<u32>,
        creases: Creases,
        memory: &mut ProbeMemory,
    ) -> Self {
        memory.evaluations += creases.evaluations;
        let frame = frame_for(function, origin, bounds);
        let field = &mut *function.evaluator(frame);
        let is_dense = field.bounded().is_none();
        let cells = is_dense.then(|| cells.unwrap_or(DENSE_CELLS));
        let mut survey = survey(&mut Probe::new(field, memory), bounds, cells);
        survey.absence = match survey.absence {
            Absence::Undefined if precision::overflows_double(field, bounds) => Absence::TooLarge,
            Absence::Constant if precision::varies(field, bounds) => Absence::NotSeen,
            absence => absence,
        };
        let touches = survey.touches;
        let (singular, tips) = (Vec::new(), Vec::new());
        let mut surface = Self { bounds: *bounds, frame, survey, creases, singular, tips, searched: None };
        // Where f touches zero only, all of the surface is singular.
        if !is_dense && !touches {
            surface.find_singular_points(&mut Probe::new(field, &mut ProbeMemory::default()));
            let probe = &mut Probe::new(field, memory);
            let bare = surface.find_bare_place(probe, &surface.singular);
            surface.survey.bare = bare.or(surface.survey.bare);
        }
        surface
    }

    /// The surface after it has moved to that of another field, in a box, as a survey shows it;
    /// none if what remains is not seen on the grid.
    pub(super) fn moved_to(
        &self,
        function: &dyn Field,
        bounds: &Bounds,
        memory: &mut ProbeMemory,
    ) -> Option<Self> {
        let frame = frame_for(function, self.frame.origin, bounds);
        let survey = survey(&mut Probe::new(&mut *function.evaluator(frame), memory), bounds, None);
        (survey.area != 0.0).then(|| Self { bounds: *bounds, frame, survey, searched: None, ..self.clone() })
    }

    /// Whether the survey has found the surface by itself. What is added to another one depends on
    /// the run.
    pub(super) fn is_surveyed(&self) -> bool {
        self.survey.area > 0.0 && !self.survey.is_adopted
    }

    /// Begins the search for components. If the survey has found no point, the search is completed
    /// at once: the area is then estimated by spheres with the curvature at the points that it
    /// finds.
    pub(super) fn begin_search(
        &mut self,
        function: &dyn Field,
        is_adaptive: bool,
        memory: &mut ProbeMemory,
    ) -> ComponentSearch {
        let field = &mut *function.evaluator(self.frame);
        let mut components = ComponentSearch::default();
        match &self.searched {
            Some(octree) => components.begin_with(octree.clone()),
            None => components.begin(field, &self.bounds, &self.singular),
        }
        components.leave_out_bare(self.bare_place().map(|_| bare_size(spacing(&self.bounds))));
        if self.survey.area == 0.0 {
            let (tolerance, least_gap) = (self.survey.tolerance(), self.survey.least_gap(is_adaptive));
            let probe = &mut Probe::new(field, memory);
            while components.search(probe, &self.bounds, tolerance, least_gap, u32::MAX) == 0 {}
            let found = components.points().iter().map(|seed| (seed.position, seed.normal));
            // Where branches meet, f may be zero on a curve or at a point that has no highest point
            // of either.
            let search = if self.creases.is_open { Search::Searched } else { components.witnessed() };
            self.survey.adopt(probe.field, found, &self.bounds, search);
            if self.survey.position.is_empty() {
                let bare = self.find_bare_place(probe, components.singular());
                self.survey.bare = bare.or(self.survey.bare);
                let is_bare = self.bare_place().is_some();
                self.survey.absence = if is_bare { Absence::Bare } else { self.survey.absence };
            }
        }
        if let (Absence::Bare, Some(place)) = (self.survey.absence, self.bare_place()) {
            self.survey.level = Probe::new(field, memory).level_around(place, &self.bounds);
        }
        components
    }

    /// A place where f vanishes only on a curve or at an isolated point, if one was found. At a
    /// corner there is a surface, though the solid may be too thin for f to show it.
    pub(super) fn bare_place(&self) -> Option<DVec3> {
        let reach = bare_size(spacing(&self.bounds));
        let is_alone = |place: &DVec3| !self.creases.has_corner(*place, reach);
        [self.survey.bare, self.creases.bare].into_iter().flatten().find(is_alone)
    }

    /// Looks among singular points for a zero of f on a curve or at an isolated point, if none is
    /// known.
    pub(super) fn find_bare_place(&self, probe: &mut Probe, singular: &[Singular]) -> Option<DVec3> {
        if self.bare_place().is_some() {
            return None;
        }
        let spacing = spacing(&self.bounds);
        let extrema = singular.iter().filter(|point| !point.has_two_signs);
        let places = extrema.map(|point| point.position);
        bare_among(
            probe,
            places.filter(|&place| !self.creases.has_corner(place, bare_size(spacing))),
            spacing,
        )
    }

    /// Finds the singular points near the points of the survey, for each patch by itself.
    fn find_singular_points(&mut self, probe: &mut Probe) {
        let spacing = spacing(&self.bounds);
        // Points without a patch come first.
        let mut patches: Vec<Vec<Vec3>> = Vec::new();
        for &p in &self.survey.position {
            let patch = self.creases.are_there().then(|| probe.field.label(p.as_dvec3()));
            let place = patch.map_or(0, |patch| patch as usize + 1);
            patches.resize_with(patches.len().max(place + 1), Vec::new);
            patches[place].push(p);
        }
        for (place, points) in (0_u32..).zip(patches).filter(|(_, points)| !points.is_empty()) {
            let patch = place.checked_sub(1);
            let probe = &mut probe.on(patch);
            let mut near = singular::near_survey(probe.field, &points, spacing, &self.bounds);
            self.find_tips(probe, patch, &near, spacing);
            // At a tip another branch may be zero, too.
            near.points.retain(|point| {
                let is_tip = |tip: &Tip| Some(tip.patch) == patch && tip.position == point.position;
                self.tips.iter().any(is_tip)
                    || probe.is_on_patch(point.position.as_vec3(), Vec3::ZERO, 0.0, patch)
                        && probe.may_have_zeros(patch, &Bounds::point(point.position).enlarged(spacing))
            });
            self.singular.extend_from_slice(&near.points);
        }
    }

    /// Finds the tips among the singular points of a patch, and those near bends where f has no
    /// second derivative.
    fn find_tips(&mut self, probe: &mut Probe, patch: Option<u32>, near: &NearSurvey, spacing: f64) {
        /// Maximum number of bends with a possible jump of the gradient that are examined. Most
        /// surfaces have none; around a tip where f has a gradient they are the sharpest. More take
        /// longer on a much bent surface.
        const MOST: usize = 16;
        for place in singular::places(&near.points, spacing) {
            if place.kind == singular::SingularKind::Point {
                self.tips.extend(Tip::at(probe, patch, place.position, spacing));
            }
        }
        let reach = Tip::REACH * spacing;
        let may_be_tip =
            |bend: &&Bend| singular::may_be_rough(probe.field, &Bounds::point(bend.position).enlarged(reach));
        let bends: Vec<&Bend> = near.bends.iter().filter(may_be_tip).take(MOST).collect();
        for bend in bends {
            let Some(tip) = Tip::near(probe, patch, bend.position, spacing) else { continue };
            let known: Vec<u32> = (self.tips.iter())
                .filter(|known| known.position.distance(tip.position) <= spacing)
                .map(|known| known.patch)
                .collect();
            if !self.bounds.holds(tip.position) || known.contains(&tip.patch) {
                continue;
            }
            // Several patches may have their tips at one point.
            if known.is_empty() {
                self.singular.push(Singular::tip(tip.position, spacing));
            }
            self.tips.push(tip);
        }
    }
}
