//! Statistics that the figures have in common.

/// Mean and standard deviation of numbers that arrive one by one (Welford's update) or together.
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

    /// Adds other numbers (T. F. Chan, G. H. Golub & R. J. LeVeque, "Updating Formulae and a
    /// Pairwise Algorithm for Computing Sample Variances", 1979, equation 2.1).
    pub(super) fn join(&mut self, other: &Self) {
        if other.count > 0.0 {
            let (count, step) = (self.count + other.count, other.mean - self.mean);
            self.squares += other.squares + step * step * (self.count * other.count / count);
            self.mean += step * (other.count / count);
            self.count = count;
        }
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

/// Returns the share of `count` in `all`; NaN if `all` is 0.
pub(super) fn share(count: usize, all: usize) -> f64 {
    count as f64 / all as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_arrive_in_parts_have_the_moments_of_all() {
        let numbers: Vec<f64> = (0..100).map(|k| f64::from(k * k % 37)).collect();
        let of = |numbers: &[f64]| {
            let mut moments = Moments::default();
            numbers.iter().for_each(|&number| moments.add(number));
            moments
        };
        let all = of(&numbers);
        for cut in [0, 1, 40, 100] {
            let mut joined = of(&numbers[..cut]);
            joined.join(&of(&numbers[cut..]));
            assert!((joined.mean() - all.mean()).abs() < 1e-13 * all.mean(), "{cut}");
            assert!((joined.deviation() - all.deviation()).abs() < 1e-13 * all.deviation(), "{cut}");
        }
        assert!(Moments::default().mean().is_nan());
    }
}
