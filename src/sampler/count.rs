//! The search for the radius of a front that gives a wanted number of particles.

/// A search among fronts. `T` is what a front is made from, which the search can return to.
#[derive(Clone, Debug)]
pub(super) struct Search<T> {
    /// The radius of the front over that of the first one.
    pub(super) scale: f64,
    /// The largest scale known to give too many particles, and the smallest known to give too few.
    bracket: [f64; 2],
    /// Fronts tried, and their largest number.
    tried: u32,
    most: u32,
    nearest: Option<Nearest<T>>,
}

/// The front that came nearest to the wanted number.
#[derive(Clone, Debug)]
struct Nearest<T> {
    /// Its number of particles over the wanted one, or the inverse, which is the larger.
    miss: f64,
    number: u32,
    scale: f64,
    made_from: T,
}

/// What follows after a front.
pub(super) enum Next<T> {
    /// None: it is the nearest.
    None,
    /// A front with radii changed by this factor.
    Scaled(f64),
    /// The nearest front again.
    Back(T),
}

impl<T> Search<T> {
    /// A search that tries at most so many fronts.
    pub(super) fn new(most: u32) -> Self {
        Self { scale: 1.0, bracket: [0.0, f64::INFINITY], tried: 0, most, nearest: None }
    }

    /// Whether no more fronts are tried.
    pub(super) fn is_over(&self) -> bool {
        self.tried >= self.most
    }

    /// Whether no front has been tried yet.
    pub(super) fn is_new(&self) -> bool {
        self.tried == 0
    }

    /// Takes in a front with `miss` times the wanted number of particles, which is infinite if the
    /// limit on particles cut it short. The radius changes by the factor `most_change` at most.
    pub(super) fn next(&mut self, miss: f64, most_change: f64, made_from: T) -> Next<T> {
        if self.is_over() {
            return Next::None;
        }
        self.tried += 1;
        let (number, scale, either) = (self.tried, self.scale, miss.max(1.0 / miss));
        if either.is_finite() && self.nearest.as_ref().is_none_or(|nearest| either < nearest.miss) {
            self.nearest = Some(Nearest { miss: either, number, scale, made_from });
        }
        if !self.is_over() {
            return Next::Scaled(self.advance(miss, most_change));
        }
        let is_last = self.nearest.as_ref().is_some_and(|nearest| nearest.number == number);
        self.recall().filter(|_| !is_last).map_or(Next::None, Next::Back)
    }

    /// Returns to the nearest front, which is then final, if there is one.
    pub(super) fn recall(&mut self) -> Option<T> {
        let nearest = self.nearest.take()?;
        (self.tried, self.scale) = (self.most, nearest.scale);
        Some(nearest.made_from)
    }

    /// Changes the scale, assuming that the number of particles goes with the inverse square of the
    /// radius. If this leads beyond a scale known to give too many particles or one known to give
    /// too few, the next scale is halfway between them. Returns the factor on the radius.
    fn advance(&mut self, miss: f64, most_change: f64) -> f64 {
        let [many, few] = &mut self.bracket;
        if miss > 1.0 {
            *many = self.scale;
            // The number need not fall as the radius grows.
            *few = if *few > self.scale { *few } else { f64::INFINITY };
        } else {
            *few = self.scale;
            *many = if *many < self.scale { *many } else { 0.0 };
        }
        let [many, few] = self.bracket;
        let mut factor = miss.sqrt().clamp(1.0 / most_change, most_change);
        let next = self.scale * factor;
        if many > 0.0 && few.is_finite() && !(next > many && next < few) {
            factor = (many * few).sqrt() / self.scale;
        }
        self.scale *= factor;
        factor
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The numbers of particles of the fronts of a search, where `count` gives that for a radius.
    fn counts_of(count: impl Fn(f64) -> f64, wanted: f64) -> Vec<f64> {
        let (mut radius, mut search, mut counts) = (1.0, Search::new(8), Vec::new());
        loop {
            counts.push(count(radius));
            match search.next(count(radius) / wanted, f64::INFINITY, radius) {
                Next::None => return counts,
                Next::Scaled(factor) => radius *= factor,
                Next::Back(nearest) => radius = nearest,
            }
            assert!((search.scale - radius).abs() < 1e-12, "{} at {radius}", search.scale);
        }
    }

    #[test]
    fn a_number_that_goes_with_the_area_is_met_by_the_second_front() {
        let counts = counts_of(|radius| 500.0 / (radius * radius), 1_000.0);
        assert!(counts[1..].iter().all(|count| (count / 1_000.0 - 1.0).abs() < 1e-9), "{counts:?}");
    }

    #[test]
    fn where_the_number_leaps_the_nearest_front_is_made_again() {
        // There is no number between 400 and 1,500.
        let leap = |radius: f64| if radius < 1.3 { 1_500.0 } else { 400.0 };
        let counts = counts_of(leap, 1_000.0);
        assert_eq!(counts.len(), 9, "{counts:?}");
        assert_eq!(counts[8], 1_500.0, "{counts:?}");
        assert!(counts.contains(&400.0), "{counts:?}");
    }

    #[test]
    fn a_front_that_was_cut_short_is_never_the_nearest() {
        let mut search = Search::new(2);
        assert!(
            matches!(search.next(f64::INFINITY, 2.0, "cut short"), Next::Scaled(factor) if factor == 2.0)
        );
        assert!(matches!(search.next(0.1, 2.0, "whole"), Next::None));
        assert!(search.is_over() && search.recall().is_none());
    }
}
