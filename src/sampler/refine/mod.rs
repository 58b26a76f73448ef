//! The refinement of a coarse front: order is made where particles are few, and kept where they are
//! many.
//!
//! A front freezes the seams where its grains meet, and no relaxation of all its particles mends
//! them. But dividing every face of a mesh into four adds no defect: old particles keep their
//! neighbours, and those in the middles of edges have six. So the front marches with a radius 2ᵏ
//! times as large, is joined to a mesh and ordered there, where a few hundred particles cost next
//! to nothing; then every edge is halved, k times, with a few sweeps at each level.
//!
//! * *Sweeps* move every particle by the springs to its neighbours (Gauss–Seidel), and flip edges
//!   that are not Delaunay.
//! * *Surgery* tries one particle more or one fewer at a defect. On a curved surface an even
//!   lattice has scars, lines of alternating particles with five and seven neighbours, that grow as
//!   the spacing shrinks: M. J. Bowick, D. R. Nelson and A. Travesset, "Interacting topological
//!   defects on frozen topographies", Physical Review B 62, 2000. Surgery makes and removes them
//!   where that lowers the energy. Early rounds also accept a loss, so that a scar can leave a bad
//!   place: G. Dueck and T. Scheuer, "Threshold accepting", Journal of Computational Physics 90,
//!   1990.
//! * *Lloyd's method*, at the last level of one size and near defects only, evens out the cells
//!   that the springs leave too small at fives and too large at sevens: Q. Du, V. Faber and M.
//!   Gunzburger, "Centroidal Voronoi Tessellations", SIAM Review 41(4), 1999.
//!
//! Everything is in single precision and in a fixed order: the same bits natively and in
//! WebAssembly, however a run is cut into steps.

mod border;
mod coarse;
mod components;
mod moving;
mod net;
mod recipe;
mod refusal;
mod rings;
mod sizes;
mod surgery;
mod tally;
mod walls;

pub(crate) use border::grown;
pub(crate) use coarse::{FRONT_RADIUS, MATCH_TOLERANCE, halvings, largest_curvatures};
pub(crate) use components::{CoarseFronts, Components, Next, SurfaceFacts};
pub(crate) use moving::MovingMesh;
pub use refusal::{Refusal, Spot};
pub(crate) use rings::Rings;

use crate::math::{NONE, SQRT_3};
use crate::mesh::half_edge::Subdivision;
use crate::particles::Particles;
use crate::sampler::probe::Probe;
use crate::sampler::sizing::Sizing;
use coarse::FrontPart;
use core::ops::Range;
use net::{BLOCK, Ground, MovedBlock, Net, Springs};
use recipe::{LevelFacts, Pass, Recipe, TUNING};
use surgery::{Aim, Surgeon};
use tally::Tally;

/// Rounds that alternately compute the spacing and the number of edges on the border. Each
/// multiplies the error by half the share of border edges among the faces: with one in ten, four
/// rounds leave 10⁻⁵ of it.
const BORDER_ROUNDS: u32 = 4;

/// Units that a trial of surgery counts for. One takes 83,000 to 89,000 instructions, and a unit of
/// the front 2,400 to 5,100.
const TRIAL_UNITS: u32 = 32;
/// Half-edges examined per unit. An edge takes 120 instructions, a particle of a sweep 1,500, and a
/// face that is measured 1,600.
const HALF_EDGES_PER_UNIT: u32 = 12;

/// Fewest particles of a coarse front. Fewer: more particles have six neighbours, and angles are
/// smaller. More: fewer have six, and a run takes longer.
const LEAST_PARTICLES: u32 = 180;

/// The number of levels, the radius and the count that a refinement should reach.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Target {
    /// Number of levels after the coarse one, k.
    pub(crate) halvings: u32,
    /// Repulsion radius r of the particles of the last level; with varying sizes, the radius at
    /// which as many of equal size would cover the surface.
    pub(crate) radius: f32,
    /// Largest slope of the radius, if sizes vary.
    pub(crate) grading: Option<f32>,
    /// Wanted number of particles of the last level.
    pub(crate) count: Count,
}

/// Wanted number of particles of the last level.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Count {
    /// A number of particles.
    Total(f64),
    /// A number of particles per hexagonal cell 2√3 r².
    PerCell(f64),
}

/// The refinement under way of one component or patch, or of components that no front separates.
#[derive(Clone, Debug, Default)]
pub(crate) struct Refinement {
    target: Target,
    /// The patch that is refined, if the surface has creases.
    patch: Option<u32>,
    net: Net,
    shape: Shape,
    level: Goals,
    memory: Memory,
    /// Sums over the faces that the pass under way has reached.
    tally: Tally,
    /// Number of passes of the recipe that have begun.
    begun: usize,
    /// Whether no particle had a defect when the level under way began.
    is_in_order: bool,
    /// The finished mesh: the particles at the corners of its faces.
    corners: Vec<u32>,
}

/// Properties shared by all levels of a refinement.
#[derive(Clone, Copy, Debug, Default)]
struct Shape {
    euler: i64,
    has_border: bool,
    /// Whether creases are part of the border.
    is_creased: bool,
    /// Wanted number of particles of the last level, once the surface is measured.
    wanted: f64,
}

/// The particles that surgery examines in one frame: part number `at` of `of`, in the order of
/// their creation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turn {
    pub(crate) at: u32,
    pub(crate) of: u32,
}

/// Goals of the level under way, and the recipe that leads to them.
#[derive(Clone, Debug, Default)]
struct Goals {
    /// Whether it is the level of the front, where the lattice is ordered. At full resolution the
    /// goals of a last level follow.
    is_first: bool,
    /// The turn of surgery, for a frame of a mesh that follows a moving surface instead of a level.
    turn: Option<Turn>,
    /// Levels still to come after this one.
    to_come: u32,
    recipe: Recipe,
    /// Spacing of the hexagonal lattice with the wanted number of particles of this level.
    spacing: f32,
    /// Wanted number of faces of this level.
    faces: f32,
}

/// Memory that the passes of all levels reuse.
#[derive(Clone, Debug, Default)]
struct Memory {
    block: MovedBlock,
    surgeon: Surgeon,
    /// Particles near defects, in ascending order.
    near: Vec<u32>,
}

/// A net whose faces have been divided; the finer net takes its particles from it.
#[derive(Debug)]
pub(crate) struct Coarse {
    net: Net,
    /// The edge that each particle of the finer net halves; `[v, NONE]` for particle v of this one.
    ends: Vec<[u32; 2]>,
    /// Particles with a defect so far.
    defects: u32,
}

impl Default for Count {
    fn default() -> Self {
        Self::Total(0.0)
    }
}

impl Goals {
    fn new(facts: &LevelFacts) -> Self {
        let &LevelFacts { is_first, to_come, .. } = facts;
        Self { is_first, turn: None, to_come, recipe: Recipe::of(facts), spacing: 0.0, faces: 0.0 }
    }
}

impl Refinement {
    /// Joins a component of a coarse front to a surface and begins to refine it.
    ///
    /// # Errors
    ///
    /// The defect that refuses the front.
    fn of_component(
        probe: &mut Probe,
        surface: &SurfaceFacts,
        particles: &Particles,
        target: Target,
    ) -> Result<Self, Refusal> {
        let triangles = &coarse::triangles(particles, &surface.bounds)?;
        Self::new(probe, surface, &FrontPart { particles, triangles, patch: None }, target)
    }

    /// Begins to refine a part of a coarse front.
    ///
    /// # Errors
    ///
    /// The defect that refuses the front.
    fn new(
        probe: &mut Probe,
        surface: &SurfaceFacts,
        part: &FrontPart,
        target: Target,
    ) -> Result<Self, Refusal> {
        let mut block = MovedBlock::default();
        let probe = &mut probe.on(part.patch);
        let net = coarse::join(&mut Ground { probe, block: &mut block }, part, surface)?;
        Ok(Self::of_layer(net, block, target, part.patch))
    }

    fn of_layer(net: Net, block: MovedBlock, target: Target, patch: Option<u32>) -> Self {
        let (has_border, is_creased) = (net.has_border(), net.is_creased());
        let shape = Shape { euler: net.mesh.euler(), has_border, is_creased, wanted: 0.0 };
        Self {
            target,
            patch,
            level: Goals::new(&LevelFacts {
                is_first: true,
                to_come: target.halvings,
                is_graded: target.grading.is_some(),
                has_border: shape.has_border,
                // The first recipe does not use it.
                defects: 0.0,
            }),
            net,
            shape,
            memory: Memory { block, ..Memory::default() },
            tally: Tally::default(),
            begun: 0,
            is_in_order: false,
            corners: Vec::new(),
        }
    }

    /// The share of the particles due to it: its area, or ∫ dA / r² if the radius r varies, in
    /// units common to all components.
    fn weight(&mut self, probe: &mut Probe, sizing: Option<&Sizing>) -> f64 {
        let Some(sizing) = sizing else { return self.area() };
        let probe = &mut probe.on(self.patch);
        let mut ground = Ground { probe, block: &mut self.memory.block };
        let all = 0..self.net.position.len() as u32;
        self.net.find_sizes(&mut ground, sizing, self.target.radius, true, all);
        let cells = self.measured().cells();
        // The first level has one size.
        self.net.size.clear();
        cells
    }

    /// Area of the surface.
    fn area(&self) -> f64 {
        self.measured().area()
    }

    /// The sums over all faces.
    fn measured(&self) -> Tally {
        let mut tally = Tally::default();
        tally.measure(&self.net, 0..(self.net.mesh.half_edge_slots() / 3) as u32);
        tally
    }

    /// Levels after the present one.
    pub(crate) fn to_come(&self) -> u32 {
        self.level.to_come
    }

    /// Share of the passes of this level that have ended.
    pub(crate) fn share(&self) -> f64 {
        let at = self.begun.saturating_sub(1) as f64 / self.level.recipe.passes.len() as f64;
        // At full resolution the goals of a last level follow those of the first one.
        match (self.target.halvings, self.level.is_first) {
            (0, true) => 0.5 * at,
            (0, false) => 0.5 + 0.5 * at,
            _ => at,
        }
    }

    /// Computes the wanted number of faces of this level, and the spacing, from the measured faces.
    fn measure(&mut self) {
        let tally = self.tally;
        if self.shape.wanted == 0.0 {
            let radius = f64::from(self.target.radius);
            self.shape.wanted = match self.target.count {
                Count::Total(count) => count,
                Count::PerCell(packing) => {
                    // Half of the cell of a particle on the border lies beyond it.
                    packing * tally.area() / (2.0 * SQRT_3 * radius * radius) + tally.border / (4.0 * radius)
                }
            };
        }
        let share = f64::from(1_u32 << (2 * self.level.to_come));
        // Half of the faces at a crease belong to the other patch, so a patch has two for each of
        // its particles.
        let euler = if self.shape.is_creased { 0.0 } else { self.shape.euler as f64 };
        let is_graded = self.net.is_graded();
        // A closed surface has 2 (N − χ) faces, and a division makes four of each.
        let closed = 2.0 * (self.shape.wanted - euler) / share;
        // Each particle has the area of two faces.
        let spacing = |faces: f64| {
            let lattice = faces + 2.0 * euler;
            let spacing_sq = if is_graded {
                tally.cells() / lattice
            } else {
                2.0 * tally.area() / (SQRT_3 * (0.5 * lattice))
            };
            spacing_sq.sqrt()
        };
        let mut faces = closed;
        if tally.border > 0.0 {
            // A border edge takes one face away, and a division makes two of each border edge.
            for _ in 0..BORDER_ROUNDS {
                faces = (closed - tally.border / (spacing(faces) * share.sqrt())).max(1.0);
            }
        }
        self.level.faces = faces as f32;
        self.level.spacing = spacing(faces) as f32;
    }

    /// Begins the next pass of the recipe, over the particles, half-edges or faces of a range; none
    /// after the last pass.
    pub(crate) fn begin_pass(&mut self) -> Option<Range<u32>> {
        if self.begun == self.level.recipe.passes.len() && self.level.is_first && self.level.to_come == 0 {
            // At full resolution the lattice relaxes on the level where it was ordered.
            let net = &self.net;
            let all = (0..net.mesh.vertex_slots() as u32).filter(|&v| net.mesh.has_vertex(v));
            let (count, defects) =
                all.fold((0, 0), |(n, defects), v| (n + 1, defects + u32::from(net.excess(v) != 0)));
            self.begin_level(0, defects as f32 / count as f32);
        }
        let kind = *self.level.recipe.passes.get(self.begun)?;
        self.begun += 1;
        let mesh = &self.net.mesh;
        let end = match kind {
            Pass::Flip => mesh.half_edge_slots(),
            Pass::Measure | Pass::Inspect => {
                self.tally = Tally::default();
                mesh.half_edge_slots() / 3
            }
            Pass::Find => {
                self.memory.near.clear();
                mesh.vertex_slots()
            }
            Pass::Centre => self.memory.near.len(),
            Pass::Size { .. }
            | Pass::Limit { .. }
            | Pass::Sweep
            | Pass::Mend { .. }
            | Pass::Land
            | Pass::Follow => mesh.vertex_slots(),
            Pass::Thin | Pass::Clip => 0,
        };
        let end = end as u32;
        Some(match (kind, self.level.turn) {
            (Pass::Mend { .. }, Some(Turn { at, of })) => at * end / of..(at + 1) * end / of,
            _ => 0..end,
        })
    }

    /// Continues a pass: does the blocks of its range that the budget allows, and takes them from
    /// the range. Returns whether the pass has ended.
    ///
    /// # Errors
    ///
    /// The defect that stops the refinement.
    pub(crate) fn go_on(
        &mut self,
        probe: &mut Probe,
        surface: &SurfaceFacts,
        rest: &mut Range<u32>,
        left: &mut u32,
    ) -> Result<bool, Refusal> {
        let probe = &mut probe.on(self.patch);
        while *left > 0 {
            let units = self.do_block(probe, surface, rest)?;
            *left = left.saturating_sub(units);
            if rest.start == rest.end {
                self.end_pass()?;
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// The pass under way.
    fn kind(&self) -> Pass {
        self.level.recipe.passes[self.begun - 1]
    }

    /// Does a block of the pass under way, and takes it from the range. Returns the units of work.
    fn do_block(
        &mut self,
        probe: &mut Probe,
        surface: &SurfaceFacts,
        rest: &mut Range<u32>,
    ) -> Result<u32, Refusal> {
        let springs =
            Springs { spacing: self.level.spacing, theta: self.level.recipe.theta, omega: TUNING.omega };
        let kind = self.kind();
        let net = &mut self.net;
        let mut ground = Ground { probe, block: &mut self.memory.block };
        let per_unit = if matches!(kind, Pass::Flip) { HALF_EDGES_PER_UNIT } else { 1 };
        let Range { start: next, end } = *rest;
        let last = end.min(next + per_unit * BLOCK as u32);
        rest.start = last;
        let mut units = BLOCK as u32;
        match kind {
            Pass::Size { is_whole } => {
                self.memory.surgeon.forget();
                if let Some(sizing) = surface.sizing {
                    net.find_sizes(&mut ground, sizing, self.target.radius, is_whole, next..last);
                }
            }
            Pass::Limit { back } => {
                let rise = self.rise();
                let way = |k: u32| if back { end - 1 - k } else { k };
                self.net.limit_sizes(rise, (next..last).map(way));
            }
            Pass::Measure => self.tally.measure(net, next..last),
            Pass::Inspect => {
                self.tally.inspect(net, next..last);
                if self.target.halvings == 0 && !net.is_graded() && self.level.turn.is_none() {
                    self.tally.inspect_shapes(net, self.level.spacing, next..last);
                }
            }
            Pass::Sweep => net.relax(&mut ground, springs, next..last),
            Pass::Flip => net.flip(next..last),
            Pass::Mend { loss } => {
                let Recipe { delta, stretch, .. } = self.level.recipe;
                let aim = Aim { springs, delta, faces: self.level.faces, loss, stretch };
                for v in next..last {
                    units += TRIAL_UNITS * u32::from(self.memory.surgeon.mend(net, &mut ground, aim, v));
                }
            }
            Pass::Find => {
                // Where the box cuts the surface, the springs handle lone fives better: Lloyd's
                // method there costs 0.5° of the mean angle.
                let is_cut = self.shape.has_border && !self.shape.is_creased;
                let is_defect = |&v: &u32| {
                    net.mesh.has_vertex(v)
                        && net.excess(v) != 0
                        && (!is_cut || net.mesh.is_border(v) || net.excess(v) > 1)
                };
                self.memory.near.extend((next..last).filter(is_defect));
            }
            Pass::Centre => {
                let near = self.memory.near[next as usize..last as usize].iter().copied();
                net.centre(&mut ground, springs, near);
            }
            Pass::Thin => {
                net.thin(self.level.spacing);
            }
            Pass::Land => net.land_all(&mut ground, self.level.spacing, next..last, false)?,
            Pass::Follow => net.land_all(&mut ground, self.level.spacing, next..last, true)?,
            Pass::Clip => border::clip(net, &mut ground, self.level.spacing)?,
        }
        Ok(units)
    }

    /// Begins a level after the coarse one. `defects` is the share of its particles with a defect.
    fn begin_level(&mut self, to_come: u32, defects: f32) {
        let (is_graded, has_border) = (self.target.grading.is_some(), self.shape.has_border);
        self.level = Goals::new(&LevelFacts { is_first: false, to_come, is_graded, has_border, defects });
        self.begun = 0;
    }

    /// Largest slope of the sizes at this level, per unit of length.
    fn rise(&self) -> f32 {
        let spacing = 2.0 * self.target.radius * (1_u32 << self.level.to_come) as f32;
        sizes::slope(self.target.grading.unwrap_or(0.0), self.level.to_come) / spacing
    }

    /// Ends a pass: does the work that concerns all its particles, half-edges or faces together.
    fn end_pass(&mut self) -> Result<(), Refusal> {
        match self.kind() {
            Pass::Measure => self.measure(),
            Pass::Find => self.memory.surgeon.widen(&self.net.mesh, &mut self.memory.near),
            Pass::Mend { .. } if !self.memory.surgeon.take_kept() => {
                // Nothing new has to relax.
                let is_calm = |pass: &&Pass| matches!(pass, Pass::Sweep | Pass::Flip);
                self.begun += self.level.recipe.passes[self.begun..].iter().take_while(is_calm).count();
            }
            Pass::Inspect => {
                if let Some(at) = self.tally.inverted {
                    return Err(Refusal::Folded { at: at.into() });
                }
                if let Some(at) = self.tally.stretched {
                    return Err(Refusal::Bent { at: at.into() });
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Begins to sort the particles of a finished level.
    pub(crate) fn begin_order(&mut self) -> Rings {
        let block = core::mem::take(&mut self.memory.block);
        // Memory is freed before the columns of the finished level take its place.
        self.memory =
            if self.level.to_come == 0 { Memory::default() } else { Memory { block, ..Memory::default() } };
        Rings::new(&self.net, self.target.radius * (1_u32 << self.level.to_come) as f32)
    }

    /// Continues to sort the particles, until all are in order.
    pub(crate) fn put_in_order(&self, rings: &mut Rings, left: &mut u32) -> Option<Rings> {
        rings.go_on(&self.net, left).then(|| core::mem::take(rings))
    }

    /// The particles of the finished level, in their order.
    pub(crate) fn end_level(&mut self, rings: Rings) -> Particles {
        if self.level.to_come == 0 {
            // Nothing else of the net is needed any more. On a last level that is also the first,
            // surgery may have removed faces.
            let corners = core::mem::take(&mut self.net).mesh.into_corners();
            self.corners = corners.into_iter().filter_map(|v| rings.place(v)).collect();
        }
        rings.into_particles()
    }

    /// Begins to divide every face into four.
    pub(crate) fn begin_division(&self) -> Subdivision {
        Subdivision::new(&self.net.mesh)
    }

    /// Continues a division. Once every face is divided, returns the net before it.
    pub(crate) fn divide(&mut self, division: &mut Subdivision, left: &mut u32) -> Option<Coarse> {
        while *left > 0 {
            let is_done = division.step(&self.net.mesh, BLOCK as u32);
            *left = left.saturating_sub(BLOCK as u32);
            if is_done {
                let (mesh, ends) = core::mem::take(division).finish();
                let net = core::mem::replace(&mut self.net, Net::with_room(mesh, ends.len()));
                self.net.walls = net.walls.finer(ends.len());
                return Some(Coarse { net, ends, defects: 0 });
            }
        }
        None
    }

    /// Puts the particles of a divided net, and those between them, onto the surface and into the
    /// columns of the finer net. Returns whether all are there; the level of the finer net begins
    /// then.
    ///
    /// # Errors
    ///
    /// The particle that does not reach the surface.
    pub(crate) fn land(
        &mut self,
        probe: &mut Probe,
        surface: &SurfaceFacts,
        coarse: &mut Coarse,
        left: &mut u32,
    ) -> Result<bool, Refusal> {
        let probe = &mut probe.on(self.patch);
        let Coarse { net: coarse, ends, defects } = coarse;
        while *left > 0 {
            let net = &mut self.net;
            let start = net.position.len();
            let end = ends.len().min(start + BLOCK);
            for &ends in &ends[start..end] {
                net.push_from(coarse, ends, surface.ladder);
                // A particle in the middle of an edge has none.
                *defects += u32::from(matches!(ends, [old, NONE] if coarse.excess(old) != 0));
            }
            let mut ground = Ground { probe: &mut *probe, block: &mut self.memory.block };
            net.land_all(&mut ground, self.level.spacing, start as u32..end as u32, false)?;
            *left = left.saturating_sub(BLOCK as u32);
            if end == ends.len() {
                self.is_in_order = *defects == 0;
                self.begin_level(self.level.to_come - 1, *defects as f32 / ends.len() as f32);
                return Ok(true);
            }
        }
        Ok(false)
    }
}

/// Share of the work that is done when a front is placed with this many levels to come, each of
/// which takes four times as long as the one before.
pub(crate) fn coarse_share(halvings: u32) -> f64 {
    1.0 / f64::from(1_u32 << (2 * (halvings + 1)))
}
