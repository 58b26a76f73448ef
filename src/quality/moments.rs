//! Statistics that the figures have in common.

/// Mean and standard deviation of numbers that arrive one by one (Welford's update).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moments {
    count: f64,
    mean: f64,
    squares: f64,
}

impl Moments {
    pub(super) fn add(&mut self, value: f64) {
        self.count += 1.0;
        let step = value - self.mean;
        self.mean += step / self.count;
        self.squares += step * (value - self.mean);
    }

    /// Returns the mean; NaN of no numbers.
    pub(super) fn mean(&self) -> f64 {
        if self.count > 0.0 { self.mean } else { f64::NAN }
    }

    /// Returns the standard deviation of the population; NaN of no numbers.
    pub(super) fn deviation(&self) -> f64 {
        (self.squares / self.count).sqrt()
    }

    /// Returns the coefficient of variation: the standard deviation over the mean.
    pub(super) fn variation(&self) -> f64 {
        self.deviation() / self.mean()
    }
}

/// Returns the share of `count` in `all`; NaN if there are none at all.
pub(super) fn share(count: usize, all: usize) -> f64 {
    count as f64 / all as f64
}
