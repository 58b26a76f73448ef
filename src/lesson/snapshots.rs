//! The beginnings of chapters, from which their events are made again.

use super::course::Moment;
use crate::paper::Particle;
use crate::particles::Slots;

/// The snapshots hold no more particles than this together, or twice as many for a moment: about 40 MB.
const MOST: usize = 400_000;

/// State of the run at the beginning of a chapter. The way back restores it and replays the events that follow.
enum Snapshot {
    /// The state with the number of particles: until the first particle is moved, all are where they were placed.
    Placed(Moment, usize),
    /// The state with all particles.
    Whole(Moment, Vec<Particle>),
    /// No state is kept: the chapter is reached from an earlier one.
    Dropped,
}

/// The beginning of a chapter, restored from a snapshot.
pub(super) struct ChapterStart {
    /// Number of the chapter.
    pub(super) chapter: usize,
    pub(super) moment: Moment,
    pub(super) particles: Vec<Particle>,
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

    /// The beginning of the last chapter up to this one whose beginning is kept. `now` are the particles at the end of the run so far.
    pub(super) fn before(&self, mut chapter: usize, now: &[Particle]) -> ChapterStart {
        loop {
            match &self.all[chapter] {
                Snapshot::Whole(moment, particles) => {
                    return ChapterStart { chapter, moment: moment.clone(), particles: particles.clone() };
                }
                Snapshot::Placed(moment, count) => {
                    let first = self.first_moving.map(|first| &self.all[first]);
                    let placed =
                        if let Some(Snapshot::Whole(_, particles)) = first { particles } else { now };
                    let mut particles = placed[..*count].to_vec();
                    for &waiting in &moment.waiting {
                        let particle = &mut particles[waiting as usize];
                        (particle.is_done, particle.slots) = (false, Slots::default());
                    }
                    return ChapterStart { chapter, moment: moment.clone(), particles };
                }
                // The first chapter of all is never dropped.
                Snapshot::Dropped => chapter -= 1,
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
