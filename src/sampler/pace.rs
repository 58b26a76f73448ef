//! How a method is carried out in slices. A method is an async function that reads from top to
//! bottom as the method does, and owns what it works on. Where the caller's budget is used up, it
//! waits; meanwhile the caller has the [`Cover`] and may look at it.

use super::cover::Cover;
use super::phase::StopReason;
use super::probe::{Probe, ProbeMemory};
use super::settings::Settings;
use super::surface::Surface;
use crate::field::Field;
use crate::slices::{Work, pause};
use core::mem::swap;
use core::task::{Context, Poll, Waker};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Largest number of units of the search, of the audit or of the relaxation in one step, whatever
/// the budget: a caller that derives its budget from the pace of the front must not wait. A unit
/// takes 0.04 to 0.5 µs natively, a slice 0.3 to 4 ms. The limit changes no particle.
pub(super) const SLICE: u32 = 8_192;

/// The caller has stopped the run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stopped;

/// What a method and its caller share.
#[derive(Default)]
struct Shared {
    /// Units of work that the caller's step may still do.
    left: u32,
    is_stopped: bool,
    /// The cover, on its way from one to the other.
    cover: Cover,
}

/// The caller's budget, and the place where the cover is handed over.
#[derive(Clone, Default)]
struct Pace(Arc<Mutex<Shared>>);

impl Pace {
    /// Nobody holds the lock while something that could panic is done.
    fn shared(&self) -> MutexGuard<'_, Shared> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn hand_over(&self, cover: &mut Cover) {
        swap(cover, &mut self.shared().cover);
    }

    fn check(&self) -> Result<(), Stopped> {
        if self.shared().is_stopped { Err(Stopped) } else { Ok(()) }
    }
}

/// What a method is given: the surface, the settings, the field to evaluate, and the budget.
pub(super) struct Task<'a> {
    pub(super) surface: &'a Surface,
    pub(super) settings: Settings,
    pub(super) probe: Probe<'a>,
    pace: Pace,
}

impl Task<'_> {
    /// Says whether the run is stopped, which the next wait would say, too.
    pub(super) fn check(&self) -> Result<(), Stopped> {
        self.pace.check()
    }

    /// Ends the caller's step, whatever is left of its budget, and waits for the next one.
    pub(super) async fn turn(&mut self, cover: &mut Cover) -> Result<(), Stopped> {
        cover.evaluations = self.probe.evaluations();
        self.pace.hand_over(cover);
        pause().await;
        self.pace.hand_over(cover);
        self.check()
    }

    /// Calls `slice` until it returns a result. Each call is given the rest of the budget and
    /// subtracts the units of work that it has done. Where nothing is left, this waits for the
    /// caller's next step.
    pub(super) async fn until<R>(
        &mut self,
        cover: &mut Cover,
        mut slice: impl FnMut(&mut Cover, &mut Self, &mut u32) -> Option<R>,
    ) -> Result<R, Stopped> {
        loop {
            self.check()?;
            let mut left = self.pace.shared().left;
            if left == 0 {
                self.turn(cover).await?;
                continue;
            }
            let result = slice(cover, self, &mut left);
            self.pace.shared().left = left;
            if let Some(result) = result {
                return Ok(result);
            }
        }
    }
}

/// A method under way.
pub(super) struct MethodUnderWay<'f> {
    pace: Pace,
    work: Work<'f, StopReason>,
}

impl<'f> MethodUnderWay<'f> {
    /// Begins a method on the surface of a field, which works on the cover that it is given and
    /// says why it has ended. It does nothing before its first step.
    pub(super) fn begin(
        method: impl for<'t> FnOnce(&'t mut Task<'_>, &'t mut Cover) -> Work<'t, StopReason> + Send + 'static,
        field: Arc<dyn Field + 'f>,
        surface: Arc<Surface>,
        settings: Settings,
    ) -> Self {
        let pace = Pace::default();
        let own = pace.clone();
        let work = Box::pin(async move {
            let mut cover = Cover::default();
            own.hand_over(&mut cover);
            let mut evaluator = field.evaluator(surface.frame);
            evaluator.continue_beyond();
            let mut memory = ProbeMemory { evaluations: cover.evaluations, ..ProbeMemory::default() };
            let probe = Probe::new(&mut *evaluator, &mut memory);
            let mut task = Task { surface: &surface, settings, probe, pace: own };
            let reason = method(&mut task, &mut cover).await;
            cover.evaluations = task.probe.evaluations();
            task.pace.hand_over(&mut cover);
            reason
        });
        Self { pace, work }
    }

    /// Stops the method: its next step ends it, even if the budget is 0.
    pub(super) fn stop(&mut self) {
        self.pace.shared().is_stopped = true;
    }

    /// Does up to `budget` units of work on the cover. Returns why the method has ended, if it has.
    pub(super) fn step(&mut self, cover: &mut Cover, budget: u32) -> Option<StopReason> {
        self.pace.shared().left = budget;
        self.pace.hand_over(cover);
        let poll = self.work.as_mut().poll(&mut Context::from_waker(Waker::noop()));
        self.pace.hand_over(cover);
        match poll {
            Poll::Ready(reason) => Some(reason),
            Poll::Pending => None,
        }
    }
}
