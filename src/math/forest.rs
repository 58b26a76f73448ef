//! Disjoint sets of numbers.

/// A union–find forest over the numbers 0 to n − 1. The least number of a set represents it.
#[derive(Debug)]
pub(crate) struct Forest {
    /// A number of the same set that is smaller, or the number itself if it is the least.
    up: Vec<u32>,
}

impl Forest {
    /// The forest in which every number is in a set of its own.
    pub(crate) fn new(count: usize) -> Self {
        Self::with_links((0..count as u32).collect())
    }

    /// The forest in which every number is in the set of the number that it links to, which must
    /// not be larger.
    pub(crate) fn with_links(up: Vec<u32>) -> Self {
        debug_assert!((0..).zip(&up).all(|(i, &up)| up <= i), "a link leads to a smaller number");
        Self { up }
    }

    /// The least number of the set of `i`. Path halving shortens later searches.
    pub(crate) fn find(&mut self, mut i: u32) -> u32 {
        while self.up[i as usize] != i {
            let up = self.up[self.up[i as usize] as usize];
            self.up[i as usize] = up;
            i = up;
        }
        i
    }

    /// Joins the sets of `i` and `j`.
    pub(crate) fn join(&mut self, i: u32, j: u32) {
        let (i, j) = (self.find(i), self.find(j));
        self.up[i.max(j) as usize] = i.min(j);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_number_stands_for_a_set() {
        let mut forest = Forest::with_links(vec![0, 0, 2, 2, 4, 5]);
        forest.join(5, 3);
        assert_eq!([0, 1, 2, 3, 4, 5].map(|i| forest.find(i)), [0, 0, 2, 2, 4, 2]);
        forest.join(1, 5);
        assert_eq!([0, 1, 2, 3, 4, 5].map(|i| forest.find(i)), [0, 0, 0, 0, 4, 0]);
    }
}
