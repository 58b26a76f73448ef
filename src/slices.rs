//! Long computations in slices of bounded length.
//!
//! A computation is an `async` function that awaits [`pause`] wherever it may be interrupted, so
//! the compiler makes its state machine. It never waits for anything, so it needs no waker. The
//! owner does as many slices as there is time for, and cancels the computation by dropping it. The
//! result does not depend on how slices were grouped.
//!
//! A method of the sampler is such a function, too. It pauses where a budget is used up, and hands
//! over what it has made so far: see its pace.

#[cfg(all(feature = "parallel", not(target_arch = "wasm32")))]
use rayon::prelude::*;

use core::future::poll_fn;
use core::ops::Range;
use core::pin::{Pin, pin};
use core::task::{Context, Poll, Waker};

/// A computation under way, which may borrow what it works on.
#[cfg(not(target_arch = "wasm32"))]
pub type Work<'a, T> = Pin<Box<dyn Future<Output = T> + Send + 'a>>;
/// A computation under way, which may borrow what it works on, a function of JavaScript among it.
#[cfg(target_arch = "wasm32")]
pub type Work<'a, T> = Pin<Box<dyn Future<Output = T> + 'a>>;

/// [`Send`] natively. In WebAssembly, where a function of JavaScript is never sent to another
/// thread, everything is.
#[cfg(not(target_arch = "wasm32"))]
pub trait MaybeSend: Send {}
#[cfg(not(target_arch = "wasm32"))]
impl<T: Send + ?Sized> MaybeSend for T {}
/// [`Send`] natively. In WebAssembly, where a function of JavaScript is never sent to another
/// thread, everything is.
#[cfg(target_arch = "wasm32")]
pub trait MaybeSend {}
#[cfg(target_arch = "wasm32")]
impl<T: ?Sized> MaybeSend for T {}

/// [`Sync`] natively, everything in WebAssembly: see [`MaybeSend`].
#[cfg(not(target_arch = "wasm32"))]
pub trait MaybeSync: Sync {}
#[cfg(not(target_arch = "wasm32"))]
impl<T: Sync + ?Sized> MaybeSync for T {}
/// [`Sync`] natively, everything in WebAssembly: see [`MaybeSend`].
#[cfg(target_arch = "wasm32")]
pub trait MaybeSync {}
#[cfg(target_arch = "wasm32")]
impl<T: ?Sized> MaybeSync for T {}

/// Items in a slice of work, of 10 to 50 µs, of which each takes up to a microsecond or two: they
/// search a tree, or evaluate a field.
pub const HEAVY: usize = 32;
/// Items that take some 100 ns each: they ask their neighbours, or a field evaluates them in lanes.
pub const MEDIUM: usize = 8 * HEAVY;
/// Items that take some 10 ns each: they are read and counted.
pub const LIGHT: usize = 8 * MEDIUM;

/// Ends a slice of work. A slice should take 10 to 50 µs natively; no result depends on its size.
pub fn pause() -> impl Future<Output = ()> + Send {
    let mut is_over = false;
    poll_fn(move |_| if core::mem::replace(&mut is_over, true) { Poll::Ready(()) } else { Poll::Pending })
}

/// Ends a slice of work after every [`LIGHT`] items.
#[derive(Default)]
pub(crate) struct Meter {
    items: usize,
}

impl Meter {
    /// Counts items that were done.
    pub(crate) async fn add(&mut self, items: usize) {
        self.items += items;
        while self.items >= LIGHT {
            self.items -= LIGHT;
            pause().await;
        }
    }
}

/// Divides 0..`count` into ranges of `size`, one for each slice.
pub fn ranges(count: usize, size: usize) -> impl Iterator<Item = Range<usize>> + Send {
    (0..count).step_by(size).map(move |first| first..(first + size).min(count))
}

/// Divides 0..`count` into ranges of `size` items, does `work` on each as a slice of work, and
/// returns the results in order.
///
/// With the feature `parallel` all threads of the current rayon pool share the ranges, and do many
/// between two pauses. `new_scratch` makes the scratch memory of each thread. `work` must give the
/// same result whatever that memory held before.
pub(crate) async fn map<S: MaybeSend, T: MaybeSend>(
    count: usize,
    size: usize,
    new_scratch: impl Fn() -> S + MaybeSend,
    work: impl Fn(&mut S, Range<usize>) -> T + MaybeSend + MaybeSync,
) -> Vec<T> {
    let all: Vec<Range<usize>> = ranges(count, size).collect();
    let mut scratch: Vec<S> = (0..threads().min(all.len()).max(1)).map(|_| new_scratch()).collect();
    let mut results = Vec::with_capacity(all.len());
    // Each thread gets so many that waking it takes little time in comparison.
    let at_once = if scratch.len() > 1 { 64 * scratch.len() } else { 1 };
    for group in all.chunks(at_once) {
        share_out(&mut scratch, group, &work, &mut results);
        for _ in group {
            pause().await;
        }
    }
    results
}

/// Does `work` on each part of `size` items, the last of which may be smaller, with the part's
/// number. The threads share the parts as in [`map`].
#[cfg(feature = "points")]
pub(crate) async fn change<T: MaybeSend>(
    items: &mut [T],
    size: usize,
    work: impl Fn(usize, &mut [T]) + MaybeSend + MaybeSync,
) {
    let at_once = if threads() > 1 { 4 * threads() } else { 1 };
    for (first, items) in (0..).step_by(at_once).zip(items.chunks_mut(at_once * size)) {
        let count = items.len().div_ceil(size);
        if at_once > 1 {
            #[cfg(all(feature = "parallel", not(target_arch = "wasm32")))]
            items.par_chunks_mut(size).enumerate().for_each(|(k, part)| work(first + k, part));
        } else {
            work(first, items);
        }
        for _ in 0..count {
            pause().await;
        }
    }
}

/// Does `work`, which threads share, in one of them: natively with the feature `parallel` in a
/// thread of the rayon pool. Another thread would have to wait, and to be woken, for each share.
///
/// No lock must be held meanwhile: a thread that waits for a share of another one may do any job of
/// the pool.
pub(crate) fn in_pool<R: MaybeSend>(work: impl FnOnce() -> R + MaybeSend) -> R {
    #[cfg(all(feature = "parallel", not(target_arch = "wasm32")))]
    return rayon::scope(|_| work());
    #[cfg(not(all(feature = "parallel", not(target_arch = "wasm32"))))]
    work()
}

/// Number of threads that share the work.
fn threads() -> usize {
    #[cfg(all(feature = "parallel", not(target_arch = "wasm32")))]
    return rayon::current_num_threads();
    #[cfg(not(all(feature = "parallel", not(target_arch = "wasm32"))))]
    1
}

/// Appends the results of `work` on these ranges, in order. Each thread does consecutive ones.
fn share_out<S: MaybeSend, T: MaybeSend>(
    scratch: &mut [S],
    ranges: &[Range<usize>],
    work: &(impl Fn(&mut S, Range<usize>) -> T + MaybeSync),
    results: &mut Vec<T>,
) {
    #[cfg(all(feature = "parallel", not(target_arch = "wasm32")))]
    if scratch.len() > 1 {
        let shares = ranges.par_chunks(ranges.len().div_ceil(scratch.len()));
        let shares = scratch.par_iter_mut().zip(shares);
        results.par_extend(
            shares.flat_map_iter(|(scratch, ranges)| ranges.iter().map(|range| work(scratch, range.clone()))),
        );
        return;
    }
    results.extend(ranges.iter().map(|range| work(&mut scratch[0], range.clone())));
}

/// Does up to `budget` slices and returns the result, if the last one is done. The computation must
/// not be advanced after that.
pub fn advance<T>(mut work: Pin<&mut (impl Future<Output = T> + ?Sized)>, budget: u32) -> Option<T> {
    let mut context = Context::from_waker(Waker::noop());
    (0..budget).find_map(|_| match work.as_mut().poll(&mut context) {
        Poll::Ready(result) => Some(result),
        Poll::Pending => None,
    })
}

/// A computation under way that tells how far it is, by the number of slices that it is expected to
/// take.
pub struct Estimated<'a, T> {
    work: Work<'a, T>,
    done: u64,
    expected: u64,
}

impl<'a, T> Estimated<'a, T> {
    /// Work whose length is `expected` to be so many steps.
    pub fn new(work: Work<'a, T>, expected: u64) -> Self {
        Self { work, done: 0, expected }
    }

    /// Does up to `budget` slices and returns the result, if the last one is done, as [`advance`]
    /// does.
    pub fn advance(&mut self, budget: u32) -> Option<T> {
        self.done += u64::from(budget);
        advance(self.work.as_mut(), budget)
    }

    /// Does all slices and returns the result.
    pub fn complete(self) -> T {
        complete(self.work)
    }

    /// Estimated share of the work that is done, at most 1.
    pub fn fraction(&self) -> f64 {
        if self.done < self.expected { self.done as f64 / self.expected as f64 } else { 1.0 }
    }
}

/// Does all slices and returns the result.
pub fn complete<T>(work: impl Future<Output = T>) -> T {
    let mut work = pin!(work);
    loop {
        if let Some(result) = advance(work.as_mut(), u32::MAX) {
            return result;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_is_a_number_of_slices() {
        let mut work: Work<'_, u32> = Box::pin(async {
            for _ in 0..5 {
                pause().await;
            }
            7
        });
        assert_eq!(advance(work.as_mut(), 0), None);
        assert_eq!(advance(work.as_mut(), 2), None);
        assert_eq!(advance(work.as_mut(), 3), None);
        assert_eq!(advance(work.as_mut(), 1), Some(7));
        assert_eq!(complete(async { pause().await }), ());
    }

    #[test]
    fn results_are_in_the_order_of_the_ranges_whatever_their_number() {
        for (count, size) in [(0, 3), (1, 3), (7, 3), (10_000, 7)] {
            let new_scratch = || Vec::new();
            let sums = complete(map(count, size, new_scratch, |seen: &mut Vec<usize>, range| {
                seen.clear();
                seen.extend(range);
                seen.iter().sum::<usize>()
            }));
            assert_eq!(sums, ranges(count, size).map(Iterator::sum).collect::<Vec<usize>>());
        }
    }

    #[test]
    #[cfg(feature = "points")]
    fn every_part_is_changed_once() {
        for count in [0, 1, 7, 10_000] {
            let mut items = vec![1; count];
            complete(change(&mut items, 7, |k, part| part.iter_mut().for_each(|item| *item += k)));
            assert!(items.iter().enumerate().all(|(i, &item)| item == 1 + i / 7), "{count}");
        }
    }

    #[test]
    #[cfg(feature = "parallel")]
    fn any_number_of_threads_does_the_same() {
        for threads in [1, 2, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| {
                results_are_in_the_order_of_the_ranges_whatever_their_number();
                #[cfg(feature = "points")]
                every_part_is_changed_once();
            });
        }
    }

    #[test]
    fn an_estimate_counts_slices_and_ends_at_one() {
        let work = async {
            for _ in 0..5 {
                pause().await;
            }
        };
        let mut work = Estimated::new(Box::pin(work), 4);
        let fractions: Vec<f64> = (0..5)
            .map(|_| {
                assert_eq!(work.advance(1), None);
                work.fraction()
            })
            .collect();
        assert_eq!(fractions, [0.25, 0.5, 0.75, 1.0, 1.0]);
        assert_eq!(work.advance(1), Some(()));
    }
}
