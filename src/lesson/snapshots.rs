//! The beginnings of chapters, from which their events are made again.

use super::course::Course;

/// The snapshots hold no more particles than this together, or twice as many for a moment: about 50
/// MB.
const MOST: usize = 250_000;

/// The run at the beginning of every chapter whose number is a multiple of the stride. The way back
/// begins at one of them.
pub(super) struct Snapshots {
    kept: Vec<Course>,
    stride: usize,
    /// Number of particles that are held.
    held: usize,
    most: usize,
}

impl Snapshots {
    pub(super) fn new() -> Self {
        Self { kept: Vec::new(), stride: 1, held: 0, most: MOST }
    }

    /// Takes a snapshot before a chapter, unless it is not at the stride. The stride grows until
    /// few enough particles are held.
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

    /// The run at the beginning of a chapter, made from the last snapshot before it.
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
    /// Keeps so few that a short run drops some.
    pub(super) fn with_most(most: usize) -> Self {
        Self { most, ..Self::new() }
    }

    /// Number of chapters whose beginning is kept.
    pub(super) fn kept(&self) -> usize {
        self.kept.len()
    }
}
