//! The refinement of a coarse front: order is made where particles are few, and kept where they are many.
//!
//! A front freezes the seams in where its grains meet, and no relaxation of all its particles mends them. But dividing every face
//! of a mesh into four adds no defect: old particles keep their neighbours, and those on the middles of edges have six. So the
//! front marches with a radius 2ᵏ times as large, is joined to a mesh and brought into order there, where a few hundred particles
//! cost next to nothing; and then every edge is halved, k times, with a few sweeps at each level.
//!
//! * *Sweeps* move every particle by the springs to its neighbours, in the manner of Gauss and Seidel, and edges are flipped to
//!   those of Delaunay.
//! * *Surgery* tries one particle more or one fewer beside a defect. On a curved surface an even lattice has scars, lines of
//!   particles with five and seven neighbours in turn, that grow as the spacing shrinks: M. J. Bowick, D. R. Nelson and A.
//!   Travesset, "Interacting topological defects on frozen topographies", Physical Review B 62, 2000. Surgery makes and removes
//!   them where that lowers the energy. Early rounds also accept a loss, so that a scar can leave a bad place: G. Dueck and T.
//!   Scheuer, "Threshold accepting", Journal of Computational Physics 90, 1990.
//! * *Lloyd's method*, at the last level of one size and near defects only, evens out the cells that the springs leave too small at fives and
//!   too large at sevens: Q. Du, V. Faber and M. Gunzburger, "Centroidal Voronoi Tessellations", SIAM Review 41(4), 1999.
//!
//! Everything is in single precision and in a fixed order: the same bits natively and in WebAssembly, however a run is cut into
//! steps.

mod border;
mod coarse;
mod components;
mod layer;
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
pub use refusal::{Refusal, Spot};

use crate::math::{Bounds, SQRT_3};
use crate::mesh::half_edge::{Stage, Subdivision};
use crate::particles::Particles;
use crate::sampler::probe::Probe;
use crate::sampler::sizing::Sizing;
use core::ops::RangeInclusive;
use layer::{BLOCK, Block, Ground, Layer, Springs};
use recipe::{Pass, Recipe};
use rings::Rings;
use surgery::{Aim, Surgeon};
use tally::Tally;

/// Area of the faces after a subdivision over that before. On a dome it grows, and on a saddle it shrinks, by 2.5 % on a gyroid as
/// coarse as may be. Below, something was lost; above, two sheets have been joined.
const AREA_GAIN: RangeInclusive<f64> = 0.95..=1.15;

/// Share of faces missing or too many from which on the first level tries every particle. Defects alone cannot make up for
/// the front: where it leaves fives only, none would be inserted.
const SLACK: f32 = 0.002;

/// Rounds in which the spacing and the number of edges on the border are found from each other.
const BORDER_ROUNDS: u32 = 4;

/// Units that a trial of surgery counts for: it moves some twenty particles four times.
const TRIAL_UNITS: u32 = 64;
/// Half-edges looked at for a unit.
const HALF_EDGES_PER_UNIT: u32 = 12;
/// Faces measured for a unit.
const FACES_PER_UNIT: u32 = 4;
/// Corners of the finished mesh that are named in one slice of work.
const CORNERS: usize = 6_144;

/// Fewest particles of a component of the coarse front, by which its shape can be told.
const LEAST_PARTICLES: u32 = 180;

/// The number of levels, the radius and the count that a refinement is to reach.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Target {
    /// Levels to come after the coarse one, k.
    pub(crate) halvings: u32,
    /// Repulsion radius r of the particles of the last level; of sizes that differ, the one at which as many of one size would
    /// cover the surface.
    pub(crate) radius: f32,
    /// Largest slope of the radius, where sizes differ.
    pub(crate) grading: Option<f32>,
    /// Particles of the last level.
    pub(crate) count: Count,
}

/// How many particles the last level has.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Count {
    /// So many.
    Total(f64),
    /// So many per hexagonal cell 2√3 r².
    PerCell(f64),
}

/// A refinement of one component under way, or of components that are told apart by no front.
#[derive(Clone, Debug)]
struct Refinement {
    target: Target,
    layer: Layer,
    shape: Shape,
    level: Level,
    tools: Tools,
    /// Of the pass under way.
    tally: Tally,
    /// Area of the faces of the level before, until this one has been compared with it.
    area_before: Option<f64>,
    task: Task,
    /// The finished mesh, by the particles at the corners of its faces.
    corners: Vec<u32>,
}

/// What holds on every level of a refinement.
#[derive(Clone, Copy, Debug)]
struct Shape {
    euler: i64,
    has_border: bool,
    /// Wanted number of particles of the last level, once the surface has been measured.
    wanted: f64,
}

/// What is to be done on the level under way.
#[derive(Clone, Debug)]
struct Level {
    /// Levels still to come after it.
    to_come: u32,
    recipe: Recipe,
    /// Spacing of the hexagonal lattice with the wanted number of particles of this level.
    spacing: f32,
    /// Faces of that lattice.
    faces: f32,
}

/// The memory of the passes.
#[derive(Clone, Debug, Default)]
struct Tools {
    block: Block,
    surgeon: Surgeon,
    /// Particles near defects, in ascending order.
    near: Vec<u32>,
    /// Half-edges between crowded particles.
    crowded: Vec<u32>,
}

/// What is being done.
#[derive(Clone, Debug)]
enum Task {
    /// A pass of the recipe, come to `next` of the particles or half-edges below `end`.
    Pass { pass: usize, next: u32, end: u32 },
    /// The finished level is handed on.
    Show(Rings),
    /// Every face is divided into four.
    Divide(Subdivision),
    /// The particles of the finer level are put onto the surface, come to the number of those in its columns.
    Lift { coarse: Box<Layer>, ends: Vec<[u32; 2]> },
    /// The corners of the finished mesh are named by their particles, come to the corner `next` of those before, of which `kept`
    /// belong to a face. The particles are handed on with the last one.
    Name { rings: Rings, next: usize, kept: usize },
    /// Nothing.
    Done,
}

impl Level {
    fn new(target: &Target, to_come: u32, has_border: bool) -> Self {
        let recipe = Recipe::of(target.halvings, to_come, target.grading.is_some(), has_border);
        Self { to_come, recipe, spacing: 0.0, faces: 0.0 }
    }
}

impl Refinement {
    /// Joins the particles of a coarse front to a surface and begins to refine it. `bounds` is the box that is sampled, beyond
    /// which the front has grown.
    ///
    /// # Errors
    ///
    /// Why the front is not good enough.
    fn new(
        probe: &mut Probe,
        particles: &Particles,
        bounds: &Bounds,
        target: Target,
    ) -> Result<Self, Refusal> {
        let mut block = Block::default();
        let mut ground = Ground { probe, block: &mut block };
        let layer = coarse::join(&mut ground, particles, bounds, target.halvings)?;
        Ok(Self::of_layer(layer, block, target))
    }

    fn of_layer(layer: Layer, block: Block, target: Target) -> Self {
        let shape = Shape { euler: layer.mesh.euler(), has_border: layer.has_border(), wanted: 0.0 };
        let mut refinement = Self {
            target,
            level: Level::new(&target, target.halvings, shape.has_border),
            layer,
            shape,
            tools: Tools { block, ..Tools::default() },
            tally: Tally::default(),
            area_before: None,
            task: Task::Done,
            corners: Vec::new(),
        };
        refinement.task = refinement.begin_pass(0);
        refinement
    }

    /// Area of the surface.
    fn area(&self) -> f64 {
        let mut tally = Tally::default();
        tally.measure(&self.layer, 0..(self.layer.mesh.half_edge_slots() / 3) as u32);
        tally.area()
    }

    /// The level that is finished next, by how many come after it.
    fn pending(&self) -> u32 {
        match self.task {
            Task::Divide(_) | Task::Lift { .. } => self.level.to_come - 1,
            Task::Pass { .. } | Task::Show(_) | Task::Name { .. } | Task::Done => self.level.to_come,
        }
    }

    /// Whether there is nothing left to do.
    fn is_done(&self) -> bool {
        matches!(self.task, Task::Done)
    }

    /// Estimated share of the work that is done, that of the coarse front included.
    fn fraction(&self) -> f64 {
        let at = match self.task {
            Task::Pass { pass, .. } => pass as f64 / self.level.recipe.passes.len() as f64,
            _ => 1.0,
        };
        // From a quarter of the share of this level to all of it.
        coarse_share(self.level.to_come) * (1.0 + 3.0 * at)
    }

    /// Does `budget` units of work, or as many more as end a block. A level that is finished is put into `particles` and stays
    /// there until the next one is. Where sizes differ, `sizing` has them. Returns the units done and whether `particles` has
    /// changed.
    ///
    /// # Errors
    ///
    /// Why the refinement cannot go on.
    fn step(
        &mut self,
        probe: &mut Probe,
        sizing: Option<&Sizing>,
        particles: &mut Particles,
        budget: u32,
    ) -> Result<(u32, bool), Refusal> {
        let (mut done, mut has_changed) = (0, false);
        while done < budget && !self.is_done() {
            let task = core::mem::replace(&mut self.task, Task::Done);
            let was_whole = matches!(task, Task::Show(_) | Task::Name { .. });
            let (next, units) = match task {
                Task::Pass { pass, next, end } => self.pass(probe, sizing, pass, next, end)?,
                Task::Show(rings) => self.show(rings, particles),
                Task::Divide(subdivision) => self.divide(subdivision),
                Task::Lift { coarse, ends } => self.lift(probe, coarse, ends)?,
                Task::Name { rings, next, kept } => (self.name(rings, next, kept, particles), BLOCK as u32),
                Task::Done => (Task::Done, 0),
            };
            has_changed |= was_whole && !matches!(next, Task::Show(_) | Task::Name { .. });
            self.task = next;
            done += units;
        }
        Ok((done, has_changed))
    }

    /// Takes in what the faces of this level have been measured to be: the wanted numbers follow.
    ///
    /// # Errors
    ///
    /// If the area is not that of the level before.
    fn measure(&mut self) -> Result<(), Refusal> {
        let tally = self.tally;
        if let Some(before) = self.area_before.take()
            && !AREA_GAIN.contains(&(tally.flat_area() / before))
        {
            return Err(Refusal::Folded { at: tally.widest().into() });
        }
        if self.shape.wanted == 0.0 {
            let radius = f64::from(self.target.radius);
            self.shape.wanted = match self.target.count {
                Count::Total(count) => count,
                Count::PerCell(packing) => {
                    // Half of the cell of a particle on the border lies beyond it.
                    packing * tally.area() / (2.0 * SQRT_3 * radius * radius)
                        + tally.border() / (4.0 * radius)
                }
            };
        }
        let share = f64::from(1_u32 << (2 * self.level.to_come));
        let euler = self.shape.euler as f64;
        let is_graded = self.layer.is_graded();
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
        if tally.border() > 0.0 {
            // With a border there are as many fewer as there are edges on it, and a division makes two of each of those.
            for _ in 0..BORDER_ROUNDS {
                faces = (closed - tally.border() / (spacing(faces) * share.sqrt())).max(1.0);
            }
        }
        self.level.faces = faces as f32;
        self.level.spacing = spacing(faces) as f32;
        Ok(())
    }

    /// The start of a pass of the recipe, or what follows after the last one.
    fn begin_pass(&mut self, pass: usize) -> Task {
        let mesh = &self.layer.mesh;
        let Some(&kind) = self.level.recipe.passes.get(pass) else {
            // Before the columns of the finished level take their place.
            self.tools = Tools { block: core::mem::take(&mut self.tools.block), ..Tools::default() };
            return Task::Show(Rings::new(&self.layer));
        };
        let end = match kind {
            Pass::Flip => mesh.half_edge_slots(),
            Pass::Thin => {
                self.tools.crowded.clear();
                mesh.half_edge_slots()
            }
            Pass::Measure | Pass::Inspect => {
                self.tally = Tally::default();
                mesh.half_edge_slots() / 3
            }
            Pass::Find => {
                self.tools.near.clear();
                mesh.vertex_slots()
            }
            Pass::Centre => self.tools.near.len(),
            Pass::Size(_) | Pass::Limit { .. } | Pass::Sweep | Pass::Mend { .. } | Pass::Land => {
                mesh.vertex_slots()
            }
        };
        Task::Pass { pass, next: 0, end: end as u32 }
    }

    /// Goes on with a pass for one block.
    fn pass(
        &mut self,
        probe: &mut Probe,
        sizing: Option<&Sizing>,
        pass: usize,
        next: u32,
        end: u32,
    ) -> Result<(Task, u32), Refusal> {
        let springs =
            Springs { spacing: self.level.spacing, theta: self.level.recipe.theta, omega: recipe::OMEGA };
        let layer = &mut self.layer;
        let mut ground = Ground { probe, block: &mut self.tools.block };
        let kind = self.level.recipe.passes[pass];
        let per_unit = match kind {
            Pass::Flip | Pass::Thin => HALF_EDGES_PER_UNIT,
            Pass::Measure | Pass::Inspect => FACES_PER_UNIT,
            _ => 1,
        };
        let last = end.min(next + per_unit * BLOCK as u32);
        let mut units = BLOCK as u32;
        match kind {
            Pass::Size(quarters) => {
                if let Some(sizing) = sizing {
                    layer.find_sizes(&mut ground, sizing, self.target.radius, quarters, next..last);
                }
            }
            Pass::Limit { back } => {
                let rise = self.rise();
                let way = |k: u32| if back { end - 1 - k } else { k };
                self.layer.limit_sizes(rise, (next..last).map(way));
            }
            Pass::Measure => self.tally.measure(layer, next..last),
            Pass::Inspect => self.tally.inspect(layer, next..last),
            Pass::Sweep => layer.relax(&mut ground, springs, next..last),
            Pass::Flip => layer.flip(next..last),
            Pass::Mend { loss } => {
                let slack = if self.level.to_come == self.target.halvings { SLACK } else { f32::INFINITY };
                let aim =
                    Aim { springs, delta: self.level.recipe.delta, faces: self.level.faces, slack, loss };
                for v in next..last {
                    units += TRIAL_UNITS * u32::from(self.tools.surgeon.mend(layer, &mut ground, aim, v));
                }
            }
            Pass::Find => {
                let has_border = self.shape.has_border;
                let is_defect = |&v: &u32| {
                    layer.mesh.has_vertex(v)
                        && layer.excess(v) != 0
                        && (!has_border || layer.mesh.is_border(v) || layer.excess(v) > 1)
                };
                self.tools.near.extend((next..last).filter(is_defect));
            }
            Pass::Centre => {
                let near = self.tools.near[next as usize..last as usize].iter().copied();
                layer.centre(&mut ground, springs, near);
            }
            Pass::Thin => {
                self.tools.crowded.extend((next..last).filter(|&h| layer.is_crowded(h, self.level.spacing)));
            }
            Pass::Land => {
                layer.land(&mut ground, self.level.spacing, next..last);
            }
        }
        if last < end {
            return Ok((Task::Pass { pass, next: last, end }, units));
        }
        self.end_pass(kind)?;
        Ok((self.begin_pass(pass + 1), units))
    }

    /// How much the size may differ per unit of length at this level.
    fn rise(&self) -> f32 {
        let spacing = 2.0 * self.target.radius * (1_u32 << self.level.to_come) as f32;
        sizes::slope(self.target.grading.unwrap_or(0.0), self.level.to_come) / spacing
    }

    /// What is done once after a pass.
    fn end_pass(&mut self, kind: Pass) -> Result<(), Refusal> {
        match kind {
            Pass::Measure => self.measure(),
            Pass::Find => {
                self.tools.surgeon.widen(&self.layer.mesh, &mut self.tools.near);
                Ok(())
            }
            Pass::Thin => {
                self.layer.thin(&mut self.tools.crowded, self.level.spacing);
                Ok(())
            }
            Pass::Inspect => {
                self.area_before = Some(self.tally.flat_area());
                match self.tally.inverted() {
                    Some(at) if self.level.to_come == 0 => Err(Refusal::Folded { at: at.into() }),
                    _ => Ok(()),
                }
            }
            _ => Ok(()),
        }
    }

    fn show(&mut self, mut rings: Rings, particles: &mut Particles) -> (Task, u32) {
        let radius = self.target.radius * (1_u32 << self.level.to_come) as f32;
        let task = if !rings.step(&self.layer, radius) {
            Task::Show(rings)
        } else if self.level.to_come > 0 {
            rings.hand_on(particles);
            Task::Divide(Subdivision::new(&self.layer.mesh))
        } else {
            // Of the layer nothing else is needed any more.
            self.corners = core::mem::take(&mut self.layer).mesh.into_corners();
            Task::Name { rings, next: 0, kept: 0 }
        };
        (task, BLOCK as u32)
    }

    /// Goes on naming the corners of the mesh for a slice.
    fn name(&mut self, rings: Rings, next: usize, mut kept: usize, particles: &mut Particles) -> Task {
        let end = self.corners.len().min(next + CORNERS);
        for k in next..end {
            // Surgery, which removes faces, may have been at work on a last level that is the first one too.
            if let Some(place) = rings.place(self.corners[k]) {
                self.corners[kept] = place;
                kept += 1;
            }
        }
        if end < self.corners.len() {
            return Task::Name { rings, next: end, kept };
        }
        self.corners.truncate(kept);
        rings.hand_on(particles);
        Task::Done
    }

    fn divide(&mut self, mut subdivision: Subdivision) -> (Task, u32) {
        subdivision.step(&self.layer.mesh, BLOCK as u32);
        if subdivision.stage() != Stage::Done {
            return (Task::Divide(subdivision), BLOCK as u32);
        }
        let (mesh, ends) = subdivision.finish();
        let coarse = Box::new(core::mem::replace(&mut self.layer, Layer::with_room(mesh, ends.len())));
        self.layer.walls = coarse.walls.finer(ends.len());
        (Task::Lift { coarse, ends }, BLOCK as u32)
    }

    fn lift(
        &mut self,
        probe: &mut Probe,
        coarse: Box<Layer>,
        ends: Vec<[u32; 2]>,
    ) -> Result<(Task, u32), Refusal> {
        let layer = &mut self.layer;
        let start = layer.position.len();
        let end = ends.len().min(start + BLOCK);
        ends[start..end].iter().for_each(|&ends| layer.push_from(&coarse, ends));
        let mut ground = Ground { probe, block: &mut self.tools.block };
        layer.land(&mut ground, self.level.spacing, start as u32..end as u32);
        let refused = core::mem::take(&mut ground.block.refused);
        if let Some(&v) = refused.iter().find(|&&v| !layer.rescue(&mut ground, self.level.spacing, v)) {
            return Err(Refusal::Folded { at: layer.position[v as usize].into() });
        }
        if end < ends.len() {
            return Ok((Task::Lift { coarse, ends }, BLOCK as u32));
        }
        self.level = Level::new(&self.target, self.level.to_come - 1, self.shape.has_border);
        Ok((self.begin_pass(0), BLOCK as u32))
    }
}

/// Share of the work that is done when a front is placed that has so many levels to come, each of which takes four times as
/// long as the one before.
pub(crate) fn coarse_share(halvings: u32) -> f64 {
    1.0 / f64::from(1_u32 << (2 * (halvings + 1)))
}
