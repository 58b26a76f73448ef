//! The steps of a pattern. Each takes what it needs from a budget, and goes on when it is called
//! again until it has a result.

use super::cells::{Cell, PlanePoint};
use super::holes::{Bound, State};
use super::taken::Taken;
use super::{CELLS, Drawing, Ground, Random};
use crate::math::HEXAGONAL_CELL;
use crate::particles::Particles;
use crate::sampler::constraint::Creases;
use crate::sampler::constraint::tips::{self, Tip};
use crate::sampler::front::FrontPlan;
use crate::sampler::neighbours::grids::RadiusRange;
use crate::sampler::probe::{BATCH, Probe};
use crate::sampler::settings::{Pattern, Settings, SizeMode};
use crate::sampler::sheet::SheetRule;
use core::mem::replace;

/// Darts into each piece before the pieces are divided. With fewer there are more cells to divide;
/// more mostly hit what is taken.
const ROUNDS: usize = 2;
/// Pieces whose darts measure the surface, at most: its area is off by about 0.3 %.
const MEASURING: usize = 100_000;
/// Distance of rows on creases, over that of touching particles: where a crease bends, the straight
/// line is shorter than the way, by so much if it turns by 40° from one particle to the next.
const ROW: f32 = 1.02;
/// Trials at a radius that leaves some of the wanted count to the largest holes; a limit on time
/// where few particles are wanted.
const MOST_TRIALS: u32 = 8;
/// Factor on the radius after a trial that has placed too many.
const FEWER: f32 = 1.03;
/// Share of the darts of a random pattern that are kept where the surface is parallel to the plane
/// and the radius is that of the front: more are kept where it is steep or the radius smaller.
const KEPT: f32 = 0.5;
const KEPT_OF_SIZES: f32 = 0.25;
/// Darts per wanted point after which a random pattern stays as it is. A tenth of the darts
/// count.
const MOST_DARTS: usize = 1_000;

impl Drawing {
    /// Begins a pattern over a front of this plan. Of blue noise, so many particles are expected
    /// per hexagonal cell as the `packing` says.
    pub(in super::super) fn begun(
        front: Particles,
        plan: &FrontPlan,
        rule: SheetRule,
        settings: &Settings,
        packing: f64,
    ) -> Self {
        let wanted = (settings.size_mode == SizeMode::Count).then_some(settings.count as usize);
        Self {
            pattern: settings.pattern_in_use(),
            limit: settings.max_particles as usize,
            seed: settings.seed,
            packing,
            wanted,
            ..Self::over(front, plan, rule)
        }
    }

    /// Lists the cells of the squares that may hold some of the surface.
    pub(in super::super) fn list_pieces(
        &mut self,
        ground: &Ground,
        probe: &mut Probe,
        _: &mut Particles,
        left: &mut u32,
    ) -> Option<()> {
        let all = self.front.len() as u32 * CELLS;
        while self.next < all as usize {
            let range = self.afford(all as usize, left)?;
            let pieces: Vec<u32> = (range.start as u32..range.end as u32).collect();
            let cells: Vec<Cell> = pieces.iter().map(|&piece| Cell::of_piece(piece)).collect();
            let spots = self.land_middles(ground, probe, &cells);
            for ((piece, cell), spot) in pieces.into_iter().zip(cells).zip(&spots) {
                if self.may_hold(ground, probe, cell, spot.as_ref()) {
                    self.pieces.push(piece);
                }
            }
        }
        self.begin();
        Some(())
    }

    /// Measures ∫ dA/r² with darts, and chooses the factor on the radii for the wanted count.
    pub(in super::super) fn measure_surface(
        &mut self,
        ground: &Ground,
        probe: &mut Probe,
        _: &mut Particles,
        left: &mut u32,
    ) -> Option<()> {
        // Several darts into each of a few pieces, or one into every so many.
        let pieces = self.pieces.len();
        let each = (MEASURING / 4).checked_div(pieces).map_or(0, |each| each.clamp(1, 64));
        let step = pieces.div_ceil(MEASURING).max(1);
        let darts = each * pieces / step;
        while self.next < darts {
            let range = self.afford(darts, left)?;
            let mut points = Vec::with_capacity(range.len());
            for dart in range {
                let piece = self.pieces[dart * step % pieces];
                points.push(self.dart(Cell::of_piece(piece)));
            }
            let spots = self.land(ground, probe, &points);
            for (&PlanePoint { owner, .. }, spot) in points.iter().zip(&spots) {
                let Some(spot) = spot else { continue };
                if self.is_own(ground, probe, owner, spot) {
                    self.tally += f64::from(self.area_over_radius_sq(owner, spot));
                }
            }
        }
        let measure = self.tally / darts.max(1) as f64 * self.pieces.len() as f64;
        let count = measure * self.packing / HEXAGONAL_CELL;
        match (self.wanted, self.pattern) {
            (Some(wanted), pattern) => {
                let wanted = if pattern == Pattern::Blue { Self::first_count(wanted) } else { wanted as f64 };
                self.scale = if count > 0.0 { (count / wanted).sqrt() as f32 } else { 1.0 };
            }
            (None, Pattern::Random) => self.wanted = Some(count.round() as usize),
            (None, _) => {}
        }
        self.begin();
        Some(())
    }

    /// Draws independent points, until there are as many as wanted.
    pub(in super::super) fn draw_points(
        &mut self,
        ground: &Ground,
        probe: &mut Probe,
        particles: &mut Particles,
        left: &mut u32,
    ) -> Option<()> {
        let usual = self.usual_area_over_radius_sq(ground.front_radius / (ground.scale * ground.radius));
        let wanted = self.wanted.unwrap_or(0);
        if particles.is_empty() {
            particles.reserve(wanted.min(self.limit));
        }
        let kept = if ground.sizing.is_some() { KEPT_OF_SIZES } else { KEPT };
        let darts = if self.pieces.is_empty() { 0 } else { wanted.saturating_mul(MOST_DARTS) };
        while self.next < darts && self.count < wanted && !self.is_full {
            let range = self.afford(darts, left)?;
            let points = self.random_points(range.len());
            let spots = self.land(ground, probe, &points);
            for (&PlanePoint { owner, .. }, spot) in points.iter().zip(spots) {
                let chance = self.random.unit();
                let Some(mut spot) = spot else { continue };
                let share = self.area_over_radius_sq(owner, &spot) / usual;
                if chance < kept * share && self.is_own(ground, probe, owner, &spot) {
                    if self.count == wanted || self.count == self.limit {
                        self.is_full = self.count < wanted;
                        break;
                    }
                    Self::polish(ground, probe, &mut spot);
                    particles.push_seed(spot.position, spot.normal, spot.radius, spot.patch);
                    self.count += 1;
                }
            }
        }
        Some(())
    }

    /// Begins a trial at a factor on the radii, with the particles on creases and tips.
    pub(in super::super) fn begin_trial(
        &mut self,
        ground: &Ground,
        probe: &mut Probe,
        particles: &mut Particles,
        (creases, tips): (&Creases, &[Tip]),
    ) {
        particles.truncate(0);
        *particles = Particles { origin: particles.origin, ..Particles::default() };
        particles.reserve(self.wanted.unwrap_or(self.front.len()).min(self.limit));
        let mut radius = |probe: &mut Probe, place| ROW * ground.radius_at(probe, place);
        let filled = creases.fill(probe, 0, f64::floor, &mut radius);
        filled.add_rows(probe, particles);
        tips::add(probe, tips, radius, 2.0, &ground.bounds, particles);
        // Rings around tips are for fronts.
        particles.truncate(particles.twins.len());
        particles.radius.iter_mut().for_each(|radius| *radius /= ROW);
        let scale = self.scale * ground.radius / ground.front_radius;
        let sizes = RadiusRange::among(&self.front.radius);
        let radii = RadiusRange { smallest: scale * sizes.smallest, largest: scale * sizes.largest };
        self.taken = Taken::of(particles, radii);
        self.count = particles.count();
        self.restart();
    }

    /// Throws darts into each piece, in random order, and keeps those that do not collide.
    pub(in super::super) fn throw_darts(
        &mut self,
        ground: &Ground,
        probe: &mut Probe,
        particles: &mut Particles,
        left: &mut u32,
    ) -> Option<()> {
        let count = self.pieces.len();
        for _ in self.round..ROUNDS {
            if *left == 0 {
                return None;
            }
            if self.next == 0 {
                self.random.shuffle(&mut self.pieces);
            }
            while self.next < count && !self.is_full {
                let range = self.afford(count, left)?;
                let cells: Vec<Cell> =
                    self.pieces[range].iter().map(|&piece| Cell::of_piece(piece)).collect();
                self.throw(ground, probe, particles, &cells);
            }
            self.next = 0;
            self.round += 1;
        }
        Some(())
    }

    /// Covers the squares one by one, in random order.
    pub(in super::super) fn cover_squares(
        &mut self,
        ground: &Ground,
        probe: &mut Probe,
        particles: &mut Particles,
        left: &mut u32,
    ) -> Option<()> {
        let ratio = ground.scale * ground.radius / ground.front_radius;
        if *left == 0 {
            return None;
        }
        if self.next == 0 {
            self.pieces.sort_unstable();
            let squares = self.pieces.chunk_by(|a, b| a / CELLS == b / CELLS);
            self.squares =
                squares.scan(0, |at, pieces| Some(replace(at, *at + pieces.len()) as u32)).collect();
            self.random.shuffle(&mut self.squares);
        }
        while self.next < self.squares.len() && !self.is_full {
            if *left == 0 {
                return None;
            }
            *left = left.saturating_sub(CELLS);
            let pieces = &self.pieces[self.squares[self.next] as usize..];
            self.next += 1;
            let owner = pieces[0] / CELLS;
            let own = pieces.iter().take_while(|&&piece| piece / CELLS == owner);
            let cells: Vec<Cell> = own.map(|&piece| Cell::of_piece(piece)).collect();
            self.look_around(owner as usize, &cells, ratio);
            self.cover(ground, probe, particles, cells);
            self.look_anywhere();
        }
        Some(())
    }

    /// Puts the particles that are missing into the largest holes.
    pub(in super::super) fn fill_largest(
        &mut self,
        ground: &Ground,
        probe: &mut Probe,
        particles: &mut Particles,
        left: &mut u32,
    ) -> Option<()> {
        while self.wanted.is_some_and(|wanted| self.count < wanted) && !self.is_full {
            if *left == 0 {
                return None;
            }
            *left -= 1;
            if !self.fill_hole(ground, probe, particles) {
                break;
            }
        }
        Some(())
    }

    /// Whether the limit on particles has cut the pattern short.
    pub(in super::super) fn is_cut_short(&self) -> bool {
        self.is_full && self.wanted.is_none_or(|wanted| self.count < wanted)
    }

    /// The radius at which the pattern has the wanted count, over the radius at which it was begun:
    /// below 1 if particles were put into holes that were too small for them.
    pub(in super::super) fn shrink(&self) -> f32 {
        if self.pattern == Pattern::Blue { self.taken.shrink } else { 1.0 }
    }

    /// The factor on the radii that the particles were given.
    pub(in super::super) fn scale(&self) -> f32 {
        self.scale
    }

    /// Whether the points are random, and do not keep others away.
    pub(in super::super) fn is_random(&self) -> bool {
        self.pattern == Pattern::Random
    }

    /// Whether the trial has the wanted count, or is the last one; if not, the next one has other
    /// radii.
    pub(in super::super) fn is_accepted(&mut self) -> bool {
        let Some(wanted) = self.wanted else { return true };
        let is_met = self.count == wanted && !self.is_full;
        if is_met || self.limit < wanted || self.trials == MOST_TRIALS {
            return true;
        }
        self.scale *= if self.is_full {
            FEWER
        } else {
            (self.count as f64 / Self::first_count(wanted)).sqrt().clamp(0.5, 0.99) as f32
        };
        false
    }

    /// Number of particles that the first part of a trial should place: fewer than wanted, since
    /// the rest goes into the largest holes. Which number fits at a radius is known to some
    /// per cent, and varies by chance.
    fn first_count(wanted: usize) -> f64 {
        const LEFT: f64 = 0.006;
        /// Share of the square root of the number.
        const CHANCE: f64 = 0.3;
        let wanted = wanted as f64;
        ((1.0 - LEFT) * wanted - CHANCE * wanted.sqrt()).max(0.5)
    }

    /// Begins a part that goes through something from its first item.
    fn begin(&mut self) {
        (self.next, self.tally) = (0, 0.0);
        self.random = Random::seeded(self.seed);
    }

    fn restart(&mut self) {
        /// Shares of the radius and of one over the root of the number by which the radii may
        /// shrink.
        const MOST: f32 = 0.06;
        const CHANCE: f32 = 3.0;
        self.begin();
        // The same darts would fall as those that have measured the surface.
        self.random.below(1);
        self.trials += 1;
        (self.round, self.is_full) = (0, false);
        self.reserve.clear();
        self.least = match self.wanted {
            Some(wanted) => (1.0 - MOST - CHANCE / (wanted as f32).sqrt()).max(MOST),
            None => 1.0,
        };
    }

    /// The next batch of so many items; none if the budget is spent.
    pub(super) fn afford(&mut self, count: usize, left: &mut u32) -> Option<core::ops::Range<usize>> {
        if *left == 0 {
            return None;
        }
        let range = self.next..(self.next + BATCH).min(count);
        *left = left.saturating_sub(range.len() as u32);
        self.next = range.end;
        Some(range)
    }

    /// Share of the particles that are drawn.
    pub(in super::super) fn share(&self) -> f64 {
        self.count as f64 / self.wanted.unwrap_or(self.front.len()).max(1) as f64
    }

    /// Points of random pieces.
    fn random_points(&mut self, count: usize) -> Vec<PlanePoint> {
        let mut points = Vec::with_capacity(count);
        for _ in 0..count {
            let piece = self.pieces[self.random.below(self.pieces.len())];
            points.push(self.dart(Cell::of_piece(piece)));
        }
        points
    }

    /// Throws a dart into each of some cells, and adds a particle wherever one does not collide.
    fn throw(&mut self, ground: &Ground, probe: &mut Probe, particles: &mut Particles, cells: &[Cell]) {
        let mut points = Vec::with_capacity(cells.len());
        points.extend(cells.iter().map(|&cell| self.dart(cell)));
        let spots = self.land(ground, probe, &points);
        let free = [1.0; 2];
        for (cell, spot) in cells.iter().zip(spots) {
            let Some(mut spot) = spot else { continue };
            if self.taken.room(ground, particles, &spot, 0.0, free) < 1.0
                || !self.is_own(ground, probe, cell.owner, &spot)
            {
                continue;
            }
            Self::polish(ground, probe, &mut spot);
            if self.taken.room(ground, particles, &spot, 0.0, free) < 1.0 {
                continue;
            }
            if self.count >= self.limit || self.wanted.is_some_and(|wanted| self.count >= wanted) {
                self.is_full = true;
                return;
            }
            self.taken.add(particles, &spot, self.round as u32);
            self.count += 1;
        }
    }

    /// Covers some cells of a square: drops those that are covered, throws a dart into each of the
    /// others and divides them, until none is left.
    fn cover(&mut self, ground: &Ground, probe: &mut Probe, particles: &mut Particles, mut cells: Vec<Cell>) {
        while !cells.is_empty() && !self.is_full {
            cells = self.sift_all(ground, probe, particles, &cells);
            let before = self.count;
            for cells in cells.chunks(BATCH) {
                self.throw(ground, probe, particles, cells);
            }
            if self.count > before {
                cells = self.sift_all(ground, probe, particles, &cells);
            }
            cells = cells.iter().flat_map(|cell| cell.quarters()).collect();
        }
    }

    fn sift_all(
        &mut self,
        ground: &Ground,
        probe: &mut Probe,
        particles: &Particles,
        cells: &[Cell],
    ) -> Vec<Cell> {
        let mut open = Vec::with_capacity(cells.len());
        for cells in cells.chunks(BATCH) {
            open.extend(self.sift(ground, probe, particles, cells.to_vec()));
        }
        open
    }

    /// The cells among these that may not be covered.
    pub(super) fn sift(
        &mut self,
        ground: &Ground,
        probe: &mut Probe,
        particles: &Particles,
        mut cells: Vec<Cell>,
    ) -> Vec<Cell> {
        let mut middles = self.land_middles(ground, probe, &cells).into_iter();
        cells.retain(|&cell| {
            let middle = middles.next().flatten();
            match self.judge(ground, probe, particles, cell, middle.as_ref()) {
                State::Gone => false,
                State::Covered(room) => {
                    self.reserve.push(Bound { room, cell });
                    false
                }
                State::Open => cell.depth < Cell::DEEPEST,
            }
        });
        cells
    }
}
