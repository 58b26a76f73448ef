//! The beginnings of chapters, from which their events are made again.

use super::course::Moment;
use crate::paper::Particle;
use crate::particles::Slots;

/// The snapshots hold no more particles than this together, or twice as many for a moment: about 40 MB.
const MOST: usize = 400_000;

/// State of the run at the beginning of a chapter. The way back restores it and replays the events that follow.
enum Snapshot {
    /// The first so many particles, as they were placed: until the first one is moved, nothing more is needed.
    Placed(Moment, usize),
    /// All particles.
    Whole(Moment, Vec<Particle>),
    /// Nothing: the chapter is reached from an earlier one.
    Dropped,
}

/// The snapshots of a run. Of the chapters in which particles move one in `stride` is kept, the first of them always.
pub(super) struct Snapshots {
    all: Vec<Snapshot>,
    /// The first chapter in which particles move.
    first_moving: Option<usize>,
    stride: usize,
    held: usize,
    most: usize,
}

impl Snapshots {
    pub(super) fn new() -> Self {
        Self { all: Vec::new(), first_moving: None, stride: 1, held: 0, most: MOST }
    }

    /// Adds the beginning of the next chapter, in which particles are only placed.
    pub(super) fn add_placed(&mut self, moment: Moment, count: usize) {
        self.all.push(Snapshot::Placed(moment, count));
    }

    /// Adds the beginning of the next chapter, in which particles are moved.
    pub(super) fn add_moving(&mut self, moment: Moment, particles: &[Particle]) {
        let first = *self.first_moving.get_or_insert(self.all.len());
        if !(self.all.len() - first).is_multiple_of(self.stride) {
            self.all.push(Snapshot::Dropped);
            return;
        }
        self.all.push(Snapshot::Whole(moment, particles.to_vec()));
        self.held += particles.len();
        while self.held > self.most && self.all.len() - first > self.stride {
            self.stride *= 2;
            self.thin(first);
        }
    }

    /// Drops what is not at the stride.
    fn thin(&mut self, first: usize) {
        for (k, snapshot) in self.all.iter_mut().enumerate().skip(first) {
            if let Snapshot::Whole(_, particles) = snapshot
                && !(k - first).is_multiple_of(self.stride)
            {
                self.held -= particles.len();
                *snapshot = Snapshot::Dropped;
            }
        }
    }

    /// The last chapter up to this one whose beginning is kept, and that beginning. `now` are the particles at the end of the run
    /// so far.
    pub(super) fn before(&self, chapter: usize, now: &[Particle]) -> (usize, Moment, Vec<Particle>) {
        let mut from = chapter;
        loop {
            match &self.all[from] {
                Snapshot::Whole(moment, particles) => return (from, moment.clone(), particles.clone()),
                Snapshot::Placed(moment, count) => {
                    let first = self.first_moving.map(|first| &self.all[first]);
                    let placed =
                        if let Some(Snapshot::Whole(_, particles)) = first { particles } else { now };
                    let mut particles = placed[..*count].to_vec();
                    for &waiting in &moment.waiting {
                        let particle = &mut particles[waiting as usize];
                        (particle.is_done, particle.slots) = (false, Slots::default());
                    }
                    return (from, moment.clone(), particles);
                }
                // The first chapter of all is never dropped.
                Snapshot::Dropped => from -= 1,
            }
        }
    }
}

#[cfg(test)]
impl Snapshots {
    /// Keeps so few that a short run drops some.
    pub(super) fn with_most(most: usize) -> Self {
        Self { most, ..Self::new() }
    }

    /// Number of chapters whose beginning is kept.
    pub(super) fn kept(&self) -> usize {
        self.all.iter().filter(|snapshot| !matches!(snapshot, Snapshot::Dropped)).count()
    }
}
