//! The particles of a run as a structure of arrays: a column for each attribute. Rows are in the
//! order in which the front placed the particles, so generation levels are contiguous; particles
//! that fill gaps come last.

use crate::math::{Bounds, FNV_START, Meet, NONE, fnv, sort_by_key};
use glam::{DVec3, Vec3};
use serde::Serialize;

/// A point of the surface and the unit normal there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OrientedPoint {
    pub(crate) position: Vec3,
    pub(crate) normal: Vec3,
}

impl OrientedPoint {
    /// The position and normal of row `i`.
    pub(crate) fn of(particles: &Particles, i: usize) -> Self {
        Self { position: particles.local[i], normal: particles.normal[i] }
    }
}

/// Particle columns. A particle has one row; one where patches meet, or at the tip of a cone, has
/// several, with one position and a normal each: see [`Particles::twins`]. On a surface of a single
/// patch row `i` is particle `i`.
///
/// The columns up to `slots` have a value for each row. The others say themselves what theirs
/// belong to.
#[derive(Clone, Debug, Default)]
pub struct Particles {
    /// The point from which positions are counted, in the coordinates of the formula. See
    /// [`Bounds::local_origin`].
    pub origin: DVec3,
    /// Position on the surface, counted from `origin`: [`Particles::place`] has it in the
    /// coordinates of the formula, [`Sample::positions`](crate::Sample::positions) those of all.
    pub local: Vec<Vec3>,
    /// Unit normal along the gradient of f: outward where f is smaller inside, as by the convention
    /// of this crate.
    pub normal: Vec<Vec3>,
    /// Repulsion radius.
    pub radius: Vec<f32>,
    /// Row of the particle that placed this one; [`Particles::NO_PARENT`] for a seed.
    pub parent: Vec<u32>,
    /// Generation level: 0 for a seed, the parent's level + 1 otherwise.
    pub level: Vec<u32>,
    /// Fates of the slots around the particle: see [`SlotFate`].
    pub slots: Vec<Slots>,
    /// The patch of each row, as the label of its piece: see [`Pieces::label`]. Empty if the
    /// surface has a single patch and no particles at tips.
    ///
    /// [`Pieces::label`]: crate::field::Pieces::label
    pub patch: Vec<u32>,
    /// For each of the first rows, the first row of the same particle. A particle on a crease has a
    /// row for each patch that meets there: all with its position, each with the normal of its
    /// patch. One at the tip of a cone has a row for each of the sheets that end there, with the
    /// mean normal of the sheet. These rows come before all others and do not move.
    pub twins: Vec<u32>,
    /// Pairs of particles that follow each other along a curve where patches meet, each by its
    /// first row: along a crease, or a smooth join, as [`Particles::edges`] says.
    pub segments: Vec<[u32; 2]>,
    /// For each of the segments, pairs of a patch on its left and one on its right, seen from
    /// outside: one pair, or two where the factors of a product cross.
    pub sides: Vec<Vec<[u32; 2]>>,
    /// Pairs of opposite faces of a [`UnitCell`](crate::field::UnitCell) with the same particles.
    pub opposite: Vec<OppositeFaces>,
    /// For each row, the first row of the particle that its own is a copy of: on an upper face of a
    /// cell, the one across from it on the lowest faces; elsewhere its own particle. Empty unless
    /// opposite faces are the same.
    pub periodic: Vec<u32>,
    /// A number for each particle that follows a moving surface, the same in every frame. Particles
    /// born later have larger numbers, so the column ascends. Empty unless the surface has moved.
    pub identity: Vec<u32>,
}

/// A column of the particles, of any type.
trait Rows {
    /// Keeps the first `len` values.
    fn truncate(&mut self, len: usize);
    /// Keeps the values of the rows that have a new place, in their order.
    fn keep(&mut self, place: &[u32]);
    /// Frees the memory that the values do not use.
    fn shrink(&mut self);
}

impl<T> Rows for Vec<T> {
    fn truncate(&mut self, len: usize) {
        self.truncate(len);
    }

    fn keep(&mut self, place: &[u32]) {
        let mut place = place.iter();
        self.retain(|_| place.next().is_some_and(|&place| place != Particles::NO_PARENT));
    }

    fn shrink(&mut self) {
        self.shrink_to_fit();
    }
}

/// Two opposite faces of a cell with the same particles: their coordinates are the same bit for bit
/// but that across the faces.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OppositeFaces {
    /// The axis across the faces: 0, 1 or 2.
    pub axis: u8,
    /// The patches that the lower and the upper face are.
    pub patches: [u32; 2],
    /// Pairs of rows: that of a particle on the lower face, of its patch, and that of the same
    /// particle on the upper face.
    pub rows: Vec<[u32; 2]>,
}

/// Fate of a slot around a particle. Slots are in the order of their angles: six in a hexagon
/// (paper §4.4), up to ten where radii vary (§5).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
#[repr(u8)]
pub enum SlotFate {
    /// The front has not reached the slot.
    Open = 0,
    /// The parent is there: slot 0 of every particle but a seed.
    Parent = 1,
    /// A new particle was placed.
    Added = 2,
    /// An existing particle of the same sheet is there.
    Matched = 3,
    /// The root finder has found no point of the surface on the circle.
    NotConverged = 4,
    /// The point lies outside the clip box.
    Outside = 5,
    /// The field is undefined there, or its gradient vanishes.
    Undefined = 6,
    /// The limit on the number of particles was reached.
    Capped = 7,
}

impl SlotFate {
    /// Every fate, by its number.
    pub const ALL: [Self; 8] = [
        Self::Open,
        Self::Parent,
        Self::Added,
        Self::Matched,
        Self::NotConverged,
        Self::Outside,
        Self::Undefined,
        Self::Capped,
    ];
}

/// Fates of up to ten slots, in three bits each: slot `k` has the bits `3k..3k + 3`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(transparent)]
pub struct Slots(pub u32);

impl Slots {
    /// Slots of a particle, at most: as many as there is room for below
    /// [`SINGULAR`](Self::SINGULAR).
    pub const COUNT: usize = Self::SINGULAR.trailing_zeros() as usize / Self::BITS;
    /// Bits of a fate.
    pub const BITS: usize = 3;
    /// Bit that is set if the surface has a singular point, where its gradient vanishes, within 2r.
    /// It is bit 30; the slots take the bits below it.
    pub const SINGULAR: u32 = 1 << 30;
    /// The bits of slot 0.
    const FATE: u32 = (1 << Self::BITS) - 1;

    /// Returns whether the surface has a singular point within 2r of the particle.
    #[must_use]
    pub fn is_singular(self) -> bool {
        self.0 & Self::SINGULAR != 0
    }

    /// Returns the fate of slot `k` < [`Slots::COUNT`].
    #[must_use]
    pub fn get(self, k: usize) -> SlotFate {
        SlotFate::ALL[(self.0 >> (Self::BITS * k) & Self::FATE) as usize]
    }

    /// Sets the fate of slot `k` < [`Slots::COUNT`].
    pub fn set(&mut self, k: usize, fate: SlotFate) {
        let at = Self::BITS * k;
        self.0 = self.0 & !(Self::FATE << at) | (fate as u32) << at;
    }
}

impl Particles {
    /// Parent index of a seed.
    pub const NO_PARENT: u32 = NONE;

    /// Returns the number of rows: of particles, on a surface that is smooth everywhere.
    /// [`Report::count`] is the number of particles on any.
    ///
    /// [`Report::count`]: crate::Report::count
    #[must_use]
    pub fn len(&self) -> usize {
        self.local.len()
    }

    /// Returns the position of row `i` in the coordinates of the formula.
    #[must_use]
    pub fn place(&self, i: usize) -> DVec3 {
        self.origin + self.local[i].as_dvec3()
    }

    /// Returns whether there are no particles.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.local.is_empty()
    }

    /// Reserves memory for exactly `count` particles in all.
    pub fn reserve(&mut self, count: usize) {
        let more = count.saturating_sub(self.len());
        self.local.reserve_exact(more);
        self.normal.reserve_exact(more);
        self.radius.reserve_exact(more);
        self.parent.reserve_exact(more);
        self.level.reserve_exact(more);
        self.slots.reserve_exact(more);
        if !self.patch.is_empty() {
            self.patch.reserve_exact(more);
        }
    }

    /// Frees the memory that the particles do not use.
    pub(crate) fn shrink(&mut self) {
        self.columns().into_iter().for_each(|column| column.shrink());
    }

    /// The columns with a value for each row, and those that only some runs have.
    fn columns(&mut self) -> [&mut dyn Rows; 10] {
        let Self {
            local: position,
            normal,
            radius,
            parent,
            level,
            slots,
            patch,
            twins,
            periodic,
            identity,
            ..
        } = self;
        [position, normal, radius, parent, level, slots, patch, twins, periodic, identity]
    }

    /// The first row of the particle of row `i`. It differs from `i` only where a particle on a
    /// crease has several rows.
    #[must_use]
    pub fn first_row(&self, i: usize) -> usize {
        self.twins.get(i).map_or(i, |&first| first as usize)
    }

    /// For each row the number of its particle: [`Particles::identity`], or as many as there are
    /// particles before it, if the surface has not moved yet.
    #[must_use]
    pub fn identities(&self) -> Vec<u32> {
        if !self.identity.is_empty() {
            return self.identity.clone();
        }
        let mut numbers: Vec<u32> = Vec::with_capacity(self.len());
        let mut next = 0;
        for row in 0..self.len() {
            let first = self.first_row(row);
            let number = if first == row { next } else { numbers[first] };
            next = next.max(number + 1);
            numbers.push(number);
        }
        numbers
    }

    /// For each of the first rows, the first row of the same vertex. A particle is one vertex, but
    /// at a [tip](Self::tips) each of its rows is a vertex of its own.
    pub(crate) fn joints(&self) -> Vec<u32> {
        let mut joints = self.twins.clone();
        self.tips().into_iter().for_each(|tip| joints[tip as usize] = tip);
        joints
    }

    /// For each of the segments, whether the surface has an edge there: it ends there, or the
    /// normals of the patches on its left and on its right differ by more than a degree at one end.
    /// An end where a third patch meets counts only if the normals differ at both ends: where a
    /// fillet begins at a point, its normal there is any between those of its neighbours.
    #[must_use]
    pub fn edges(&self) -> Vec<bool> {
        let mut rows: Vec<u32> = (0..self.twins.len() as u32).collect();
        let key = |first: u32, patch: u32| u64::from(first) << 32 | u64::from(patch);
        let own_key = |&row: &u32| key(self.twins[row as usize], self.patch[row as usize]);
        sort_by_key(&mut rows, own_key);
        let mut patches = vec![0; rows.len()];
        self.twins.iter().for_each(|&first| patches[first as usize] += 1);
        let is_sharp = |first: u32, sides: [u32; 2]| {
            let place = |patch: u32| rows.binary_search_by_key(&key(first, patch), own_key).ok();
            let [Some(left), Some(right)] = sides.map(place) else { return true };
            self.are_sharp(rows[left], rows[right])
        };
        let is_edge = |(ends, sides): (&[u32; 2], &Vec<[u32; 2]>)| {
            let has_third = ends.map(|first| patches[first as usize] > 2 * sides.len());
            let counts = |end: usize| !has_third[end] || has_third[1 - end];
            [0, 1]
                .into_iter()
                .filter(|&end| counts(end))
                .any(|end| sides.iter().any(|&sides| is_sharp(ends[end], sides)))
        };
        self.segments.iter().zip(&self.sides).map(is_edge).collect()
    }

    /// For each of the first rows, the first row of the same vertex that has its normal, up to the
    /// angle below which there is no edge.
    pub(crate) fn smooth_rows(&self) -> Vec<u32> {
        let joints = self.joints();
        let mut of_vertex: Vec<Vec<u32>> = vec![Vec::new(); joints.len()];
        let smooth = |(row, &first): (u32, &u32)| {
            let known = &mut of_vertex[first as usize];
            known.iter().copied().find(|&other| !self.are_sharp(other, row)).unwrap_or_else(|| {
                known.push(row);
                row
            })
        };
        (0..).zip(&joints).map(smooth).collect()
    }

    /// Whether two rows of a particle have the normals of an edge.
    fn are_sharp(&self, a: u32, b: u32) -> bool {
        Meet::of_normals([a, b].map(|row| self.normal[row as usize].as_dvec3())) == Meet::Sharp
    }

    /// The first rows of the particles on the rim of the surface: on one side of a segment there is
    /// no patch. Ascending.
    pub(crate) fn on_rim(&self) -> std::collections::BTreeSet<u32> {
        // Those that end at creases.
        let patches: std::collections::BTreeSet<u32> =
            self.patch[..self.twins.len()].iter().copied().collect();
        let is_end =
            |sides: &Vec<[u32; 2]>| sides.as_flattened().iter().any(|patch| !patches.contains(patch));
        let of_rim = self.segments.iter().zip(&self.sides).filter(|(_, sides)| is_end(sides));
        of_rim.flat_map(|(segment, _)| *segment).collect()
    }

    /// The rows of tips, in ascending order: particles with rows of their own through which no
    /// crease runs.
    pub(crate) fn tips(&self) -> Vec<u32> {
        let Self { twins, segments, .. } = self;
        let mut is_tip = vec![true; twins.len()];
        segments.as_flattened().iter().for_each(|&first| is_tip[first as usize] = false);
        (0..twins.len() as u32).filter(|&i| is_tip[twins[i as usize] as usize]).collect()
    }

    /// Gives all rows of a particle on a crease the smallest of their radii. Returns whether any
    /// radius changed.
    pub(crate) fn share_radii(&mut self) -> bool {
        let Self { radius, twins, .. } = self;
        let mut has_lowered = false;
        for (row, &first) in twins.iter().enumerate() {
            has_lowered |= (radius[row] - radius[first as usize]).abs() > 0.0;
            radius[first as usize] = radius[first as usize].min(radius[row]);
        }
        for (row, &first) in twins.iter().enumerate() {
            radius[row] = radius[first as usize];
        }
        has_lowered
    }

    /// Takes pairs of opposite faces, of which the upper ones are images of the lower ones.
    pub(crate) fn repeat(&mut self, opposite: Vec<OppositeFaces>) {
        let mut periodic: Vec<u32> = (0..self.len()).map(|i| self.first_row(i) as u32).collect();
        // From an edge of the box one comes to the lowest one across both faces.
        for &[lower, upper] in opposite.iter().flat_map(|faces| &faces.rows) {
            let [lower, upper] = [lower, upper].map(|row| self.first_row(row as usize));
            periodic[upper] = periodic[lower];
        }
        self.periodic = (0..self.len()).map(|i| periodic[self.first_row(i)]).collect();
        self.opposite = opposite;
    }

    /// Number of pairs of particles on opposite faces of a cell; none unless such faces are the
    /// same.
    #[must_use]
    pub fn pairs(&self) -> Option<usize> {
        let pairs = self.opposite.iter().map(|faces| faces.rows.len()).sum();
        (!self.opposite.is_empty()).then_some(pairs)
    }

    /// The patch of row `i`; none if the surface has no creases.
    #[must_use]
    pub fn patch_of(&self, i: usize) -> Option<u32> {
        self.patch.get(i).copied()
    }

    /// Whether row `i` lies on a patch. Without creases all do.
    #[must_use]
    pub(crate) fn is_on(&self, i: usize, patch: Option<u32>) -> bool {
        self.patch_of(i) == patch
    }

    /// Puts row `i` on a patch, if the surface has several.
    pub(crate) fn set_patch(&mut self, i: usize, patch: Option<u32>) {
        if let Some(patch) = patch {
            self.patch[i] = patch;
        }
    }

    /// Returns the number of particles, each counted once, however many rows it has.
    #[must_use]
    pub fn count(&self) -> usize {
        self.count_of_first(self.len())
    }

    /// Returns the number of particles in the first `rows` rows.
    pub(crate) fn count_of_first(&self, rows: usize) -> usize {
        let further = (0..).zip(&self.twins).take(rows).filter(|&(i, &first)| first != i).count();
        rows - further
    }

    /// Adds a particle, on the patch of its parent.
    pub fn push(&mut self, position: Vec3, normal: Vec3, radius: f32, parent: u32, level: u32, slots: Slots) {
        self.local.push(position);
        self.normal.push(normal);
        self.radius.push(radius);
        self.parent.push(parent);
        self.level.push(level);
        self.slots.push(slots);
        if !self.patch.is_empty() {
            self.patch.push(self.patch_of(parent as usize).unwrap_or_default());
        }
    }

    /// Adds a seed, at level 0, on a patch if the surface has several.
    pub(crate) fn push_seed(&mut self, position: Vec3, normal: Vec3, radius: f32, patch: Option<u32>) {
        self.push(position, normal, radius, Self::NO_PARENT, 0, Slots::default());
        self.patch.truncate(self.len() - 1);
        self.patch.extend(patch);
    }

    /// Keeps the first `len` particles.
    pub fn truncate(&mut self, len: usize) {
        self.columns().into_iter().for_each(|column| column.truncate(len));
        self.keep_segments(len);
    }

    /// Keeps the segments between the first `len` rows.
    fn keep_segments(&mut self, len: usize) {
        let is_kept = |pair: &[u32; 2]| pair.iter().all(|&row| (row as usize) < len);
        let mut kept = self.segments.iter().map(is_kept);
        self.sides.retain(|_| kept.next().unwrap_or(false));
        self.segments.retain(is_kept);
        self.opposite.iter_mut().for_each(|faces| faces.rows.retain(is_kept));
    }

    /// Returns, for each particle, the index of the seed from which its front grew.
    pub(crate) fn fronts(&self) -> Vec<u32> {
        let mut fronts: Vec<u32> = Vec::with_capacity(self.len());
        for (i, &parent) in (0..).zip(&self.parent) {
            // Parents come before their children.
            fronts.push(fronts.get(parent as usize).copied().unwrap_or(i));
        }
        fronts
    }

    /// Removes the particles outside a box. One whose parent is removed is a seed then, and levels
    /// are counted from it. Returns the new row of each, as [`Self::keep`] does.
    pub(crate) fn keep_within(&mut self, bounds: &Bounds) -> Vec<u32> {
        let is_inside: Vec<bool> = self.local.iter().map(|&p| bounds.contains(p)).collect();
        let place = self.keep(|i| is_inside[i]);
        for i in 0..self.len() {
            // Parents come before their children, so the new level is known.
            self.level[i] = self.level.get(self.parent[i] as usize).map_or(0, |level| level + 1);
        }
        place
    }

    /// Keeps some of the particles, in their order. One whose parent is removed has none then.
    /// Returns the new row of each particle, [`Self::NO_PARENT`] for one that is removed.
    pub(crate) fn keep(&mut self, is_kept: impl Fn(usize) -> bool) -> Vec<u32> {
        let mut place = vec![Self::NO_PARENT; self.len()];
        let kept = (0..self.len()).filter(|&i| is_kept(i));
        (0..).zip(kept).for_each(|(new, i)| place[i] = new);
        let parents = self.parent.iter_mut();
        parents.for_each(|parent| *parent = place.get(*parent as usize).copied().unwrap_or(Self::NO_PARENT));
        self.name_twins(&place);
        self.columns().into_iter().for_each(|column| column.keep(&place));
        self.keep_segments(self.len());
        place
    }

    /// Updates the first row of every particle on a crease after rows have moved: the first of its
    /// rows that is kept.
    fn name_twins(&mut self, place: &[u32]) {
        let mut first = vec![Self::NO_PARENT; self.twins.len()];
        for (twin, &place) in self.twins.iter_mut().zip(place) {
            let first = &mut first[*twin as usize];
            *first = place.min(*first);
            *twin = *first;
        }
        // The end of a segment whose particle is removed becomes NO_PARENT: `keep_segments` drops
        // it.
        self.segments.iter_mut().flatten().for_each(|row| *row = first[*row as usize]);
    }

    /// Removes all particles and keeps the memory.
    pub fn clear(&mut self) {
        self.truncate(0);
        self.opposite.clear();
    }

    /// Returns the FNV-1a hash of the bits of the origin, unless that is zero, and of all columns.
    /// Equal digests mean equal runs, on any machine.
    #[must_use]
    pub fn digest(&self) -> u64 {
        let mut hash = FNV_START;
        if self.origin != DVec3::ZERO {
            for c in self.origin.to_array() {
                hash = fnv(hash, &c.to_le_bytes());
            }
        }
        let mut word = |bits: u32| hash = fnv(hash, &bits.to_le_bytes());
        for i in 0..self.len() {
            for v in [self.local[i], self.normal[i]] {
                for c in v.to_array() {
                    word(c.to_bits());
                }
            }
            word(self.radius[i].to_bits());
            word(self.parent[i]);
            word(self.level[i]);
            word(self.slots[i].0);
        }
        self.patch.iter().chain(&self.twins).for_each(|&number| word(number));
        hash
    }
}
