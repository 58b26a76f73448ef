//! How a method is carried out in slices. A method is an async function that reads from top to
//! bottom as the method does. It owns nothing: it puts the next slice of its work on its desk, as a
//! function of the sampler, and waits. Given a budget, the sampler takes the slice from the desk,
//! runs it with the current field, and lets the method continue.

use super::Sampler;
use super::phase::StopReason;
use super::probe::Probe;
use crate::slices::pause;
use core::pin::Pin;
use core::task::{Context, Poll, Waker};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The caller has stopped the run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stopped;

/// A slice of work, which takes what it needs from the budget.
pub(super) type Slice = Box<dyn FnOnce(&mut Sampler, &mut Probe, &mut u32) + Send>;

/// What a method waits for.
enum Wish {
    /// A slice of work, once there is budget left.
    Work(Slice),
    /// Something too short to count against a budget.
    Now(Slice),
    /// The next call of the caller, who may look at the particles in between.
    Turn,
}

#[derive(Default)]
struct State {
    wish: Option<Wish>,
    is_stopped: bool,
}

/// Where a method says what it waits for.
#[derive(Clone, Default)]
pub(super) struct Desk(Arc<Mutex<State>>);

impl Desk {
    /// Nobody holds the lock while something that could panic is done.
    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for a wish to be granted: its result, or nothing if the run was stopped meanwhile.
    async fn wait_for<R: Send + 'static>(
        &self,
        wish: fn(Slice) -> Wish,
        slice: impl FnOnce(&mut Sampler, &mut Probe, &mut u32) -> R + Send + 'static,
    ) -> Result<R, Stopped> {
        let result = Arc::new(Mutex::new(None));
        let there = Arc::clone(&result);
        let slice: Slice = Box::new(move |sampler, probe, left| {
            let result = slice(sampler, probe, left);
            *there.lock().unwrap_or_else(PoisonError::into_inner) = Some(result);
        });
        self.state().wish = Some(wish(slice));
        pause().await;
        let mut result = result.lock().unwrap_or_else(PoisonError::into_inner);
        result.take().ok_or(Stopped)
    }

    fn check(&self) -> Result<(), Stopped> {
        if self.state().is_stopped { Err(Stopped) } else { Ok(()) }
    }

    /// Does slices of work until one has a result.
    pub(super) async fn until<R: Send + 'static>(
        &self,
        mut slice: impl FnMut(&mut Sampler, &mut Probe, &mut u32) -> Option<R> + Send + 'static,
    ) -> Result<R, Stopped> {
        self.until_on(&mut (), move |sampler, (), probe, left| slice(sampler, probe, left)).await
    }

    /// [`Desk::until`], with slices that also work on a value of the method. The value is lost if
    /// the run is stopped.
    pub(super) async fn until_on<T: Default + Send + 'static, R: Send + 'static>(
        &self,
        value: &mut T,
        mut slice: impl FnMut(&mut Sampler, &mut T, &mut Probe, &mut u32) -> Option<R> + Send + 'static,
    ) -> Result<R, Stopped> {
        loop {
            self.check()?;
            let mut own = core::mem::take(value);
            let work = move |sampler: &mut Sampler, probe: &mut Probe, left: &mut u32| {
                let result = slice(sampler, &mut own, probe, left);
                (own, slice, result)
            };
            let result;
            (*value, slice, result) = self.wait_for(Wish::Work, work).await?;
            if let Some(result) = result {
                return Ok(result);
            }
        }
    }

    /// Does something too short to count against a budget.
    pub(super) async fn now<R: Send + 'static>(
        &self,
        what: impl FnOnce(&mut Sampler) -> R + Send + 'static,
    ) -> Result<R, Stopped> {
        self.with_field(|sampler, _| what(sampler)).await
    }

    /// [`Desk::now`], with the field.
    pub(super) async fn with_field<R: Send + 'static>(
        &self,
        what: impl FnOnce(&mut Sampler, &mut Probe) -> R + Send + 'static,
    ) -> Result<R, Stopped> {
        self.check()?;
        self.wait_for(Wish::Now, |sampler, probe, _| what(sampler, probe)).await
    }

    /// The result of a part of a method. If the run was stopped in it, `tidy` cleans up what is
    /// half done.
    pub(super) async fn leaving<R>(
        &self,
        part: impl Future<Output = Result<R, Stopped>>,
        tidy: fn(&mut Sampler, &mut Probe),
    ) -> Result<R, Stopped> {
        let result = part.await;
        if result.is_err() {
            self.finally(tidy).await;
        }
        result
    }

    /// Does something at the end, even if the run was stopped.
    pub(super) async fn finally(&self, what: impl FnOnce(&mut Sampler, &mut Probe) + Send + 'static) {
        // It is lost only with the method.
        let _ = self.wait_for(Wish::Now, |sampler, probe, _| what(sampler, probe)).await;
    }

    /// Ends the caller's step: the next slice waits for another one.
    pub(super) async fn turn(&self) -> Result<(), Stopped> {
        self.state().wish = Some(Wish::Turn);
        pause().await;
        self.check()
    }
}

/// A method under way.
pub(super) struct MethodUnderWay {
    desk: Desk,
    work: Pin<Box<dyn Future<Output = StopReason> + Send>>,
}

/// What a method asks of the sampler.
pub(super) enum Request {
    /// This slice of work.
    Slice(Slice),
    /// A budget, or the next step of the caller.
    Step,
    /// Nothing more: it has ended.
    End(StopReason),
}

impl MethodUnderWay {
    /// A method that begins.
    pub(super) fn begin<F: Future<Output = StopReason> + Send + 'static>(method: fn(Desk) -> F) -> Self {
        let desk = Desk::default();
        Self { work: Box::pin(method(desk.clone())), desk }
    }

    /// Stops the method. It then requests only what it does [finally](Desk::finally).
    pub(super) fn stop(&mut self) {
        *self.desk.state() = State { wish: None, is_stopped: true };
    }

    /// What the method requests, with this much of a budget left.
    pub(super) fn request(&mut self, left: u32) -> Request {
        loop {
            let wish = self.desk.state().wish.take();
            match wish {
                Some(Wish::Turn) => return Request::Step,
                Some(work @ Wish::Work(_)) if left == 0 => {
                    self.desk.state().wish = Some(work);
                    return Request::Step;
                }
                Some(Wish::Work(slice) | Wish::Now(slice)) => return Request::Slice(slice),
                None => match self.work.as_mut().poll(&mut Context::from_waker(Waker::noop())) {
                    Poll::Ready(reason) => return Request::End(reason),
                    Poll::Pending => {}
                },
            }
        }
    }
}
