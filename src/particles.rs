//! The particles of one run, as a structure of arrays: one column per attribute, all of the same length, in the
//! order in which a front placed them, so that its generation levels are contiguous; particles that fill gaps come last.

use glam::Vec3;

/// Particle columns. Index `i` of every column belongs to particle `i`.
#[derive(Clone, Debug, Default)]
pub struct Particles {
    /// Position on the surface.
    pub position: Vec<Vec3>,
    /// Unit outward normal.
    pub normal: Vec<Vec3>,
    /// Repulsion radius.
    pub radius: Vec<f32>,
    /// Index of the particle that placed this one; [`Particles::NO_PARENT`] for a seed.
    pub parent: Vec<u32>,
    /// Generation level: 0 for a seed, the parent's level + 1 otherwise.
    pub level: Vec<u32>,
    /// What became of the slots around the particle: see [`SlotFate`].
    pub slots: Vec<Slots>,
}

/// What became of one of the slots around a particle: six in hexagons (paper §4.4), up to ten where the radii vary (§5), in the order of their angles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum SlotFate {
    /// Not decided: the front has not come to it.
    Open = 0,
    /// Slot 0 of every particle but a seed: the parent sits there.
    Parent = 1,
    /// A new particle was placed.
    Added = 2,
    /// An existing particle of the same sheet sits there.
    Matched = 3,
    /// The root finder met no point of the surface on the circle.
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

/// The fates of up to ten slots, three bits each; slot `k` at bits `3k..3k + 3`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(transparent)]
pub struct Slots(pub u32);

impl Slots {
    /// Set where the surface has a singular point within 2r: one without a gradient. The highest bit but one; the slots take
    /// those below.
    pub const SINGULAR: u32 = 1 << 30;

    /// Whether the surface has a singular point within 2r of the particle.
    #[must_use]
    pub fn is_singular(self) -> bool {
        self.0 & Self::SINGULAR != 0
    }

    /// Fate of slot `k < 10`.
    #[must_use]
    pub fn get(self, k: usize) -> SlotFate {
        SlotFate::ALL[(self.0 >> (3 * k) & 7) as usize]
    }

    /// Sets the fate of slot `k < 10`.
    pub fn set(&mut self, k: usize, fate: SlotFate) {
        self.0 = self.0 & !(7 << (3 * k)) | (fate as u32) << (3 * k);
    }
}

impl Particles {
    /// Parent index of a seed.
    pub const NO_PARENT: u32 = u32::MAX;

    /// Number of particles.
    #[must_use]
    pub fn len(&self) -> usize {
        self.position.len()
    }

    /// Whether there is no particle.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.position.is_empty()
    }

    /// Makes room for exactly `count` particles in all.
    pub fn reserve(&mut self, count: usize) {
        let more = count.saturating_sub(self.len());
        self.position.reserve_exact(more);
        self.normal.reserve_exact(more);
        self.radius.reserve_exact(more);
        self.parent.reserve_exact(more);
        self.level.reserve_exact(more);
        self.slots.reserve_exact(more);
    }

    /// Gives back the room for more particles than there are.
    pub(crate) fn shrink(&mut self) {
        self.position.shrink_to_fit();
        self.normal.shrink_to_fit();
        self.radius.shrink_to_fit();
        self.parent.shrink_to_fit();
        self.level.shrink_to_fit();
        self.slots.shrink_to_fit();
    }

    /// Adds a particle.
    pub fn push(&mut self, position: Vec3, normal: Vec3, radius: f32, parent: u32, level: u32, slots: Slots) {
        self.position.push(position);
        self.normal.push(normal);
        self.radius.push(radius);
        self.parent.push(parent);
        self.level.push(level);
        self.slots.push(slots);
    }

    /// Keeps the first `len` particles.
    pub fn truncate(&mut self, len: usize) {
        self.position.truncate(len);
        self.normal.truncate(len);
        self.radius.truncate(len);
        self.parent.truncate(len);
        self.level.truncate(len);
        self.slots.truncate(len);
    }

    /// Removes every particle and keeps the memory.
    pub fn clear(&mut self) {
        self.position.clear();
        self.normal.clear();
        self.radius.clear();
        self.parent.clear();
        self.level.clear();
        self.slots.clear();
    }

    /// FNV-1a hash of the bits of every column: equal digests mean equal runs, on any machine.
    #[must_use]
    pub fn digest(&self) -> u64 {
        let mut hash = 0xcbf2_9ce4_8422_2325_u64;
        let mut word = |bits: u32| {
            for byte in bits.to_le_bytes() {
                hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
            }
        };
        for i in 0..self.len() {
            for v in [self.position[i], self.normal[i]] {
                for c in v.to_array() {
                    word(c.to_bits());
                }
            }
            word(self.radius[i].to_bits());
            word(self.parent[i]);
            word(self.level[i]);
            word(self.slots[i].0);
        }
        hash
    }
}
