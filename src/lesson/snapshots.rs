//! Copies of the run at the beginnings of chapters, from which later events are computed again.

use super::course::Course;

/// Most particles in all snapshots together; for a moment there may be twice as many, about 50 MB.
const MOST: usize = 250_000;

/// The run at the beginning of every chapter whose number is a multiple of the stride. To go back,
/// the run continues from one of them.
pub(super) struct Snapshots {
    kept: Vec<Course>,
    stride: usize,
    /// Number of particles in all snapshots.
    held: usize,
    most: usize,
}

impl Snapshots {
    pub(super) fn new() -> Self {
        Self { kept: Vec::new(), stride: 1, held: 0, most: MOST }
    }

    /// Takes a snapshot before a chapter whose number is a multiple of the stride. The stride grows
    /// until the snapshots hold few enough particles.
    pub(super) fn add(&mut self, chapter: usize, course: &Course) {
        if !chapter.is_multiple_of(self.stride) {
            return;
        }
        self.held += course.run.particles.len();
        self.kept.push(course.clone());
        while self.held > self.most && self.kept.len() > 1 {
            self.stride *= 2;
            let mut is_kept = false;
            self.kept.retain(|_| {
                is_kept = !is_kept;
                is_kept
            });
            self.held = self.kept.iter().map(|course| course.run.particles.len()).sum();
        }
    }

    /// The run at the beginning of a chapter, continued from the last snapshot before it.
    pub(super) fn at(&self, chapter: usize) -> Course {
        let mut course = self.kept[chapter / self.stride].clone();
        for _ in 0..chapter % self.stride {
            course.do_chapter();
            course.run.seen.events.clear();
        }
        course
    }
}

#[cfg(test)]
impl Snapshots {
    /// A limit so low that even a short run drops snapshots.
    pub(super) fn with_most(most: usize) -> Self {
        Self { most, ..Self::new() }
    }

    /// Number of snapshots.
    pub(super) fn kept(&self) -> usize {
        self.kept.len()
    }
}
