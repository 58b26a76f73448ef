//! Sorting by integer keys.
//!
//! The standard library's sort is compiled for each type and comparison, about 10 kB of WebAssembly
//! each time. So items are sorted as `u64` keys or, with each item's index below its key, as
//! `u128`. Lists of indices are sorted directly.

/// Packs a non-negative number and an index into a key, ordered by the number and then by the
/// index.
#[inline]
pub(crate) fn key(number: f32, index: u32) -> u64 {
    // Non-negative floats are ordered like their bits.
    u64::from(number.to_bits()) << 32 | u64::from(index)
}

/// The number and the index of a [`key`].
#[inline]
pub(crate) fn unkey(key: u64) -> (f32, u32) {
    (f32::from_bits((key >> 32) as u32), key as u32)
}

/// [`key`] of any number, in the total order of floating-point numbers.
#[inline]
pub(crate) fn signed_key(number: f32, index: u32) -> u64 {
    let bits = number.to_bits();
    // All bits of a negative number change, and the sign of a positive one.
    let ordered = bits ^ if number.is_sign_negative() { u32::MAX } else { 1 << 31 };
    u64::from(ordered) << 32 | u64::from(index)
}

/// A key in the total order of floating-point numbers.
pub(crate) fn key_of(number: f64) -> u64 {
    let bits = number.to_bits();
    // All bits of a negative number change, and the sign of a positive one.
    bits ^ if number.is_sign_negative() { u64::MAX } else { 1 << 63 }
}

/// Sorts by a key, stably.
pub(crate) fn sort_by_key<T: Copy>(items: &mut [T], key: impl Fn(&T) -> u64) {
    let mut order: Vec<u128> =
        (0..).zip(&*items).map(|(place, item)| u128::from(key(item)) << 32 | place).collect();
    order.sort_unstable();
    let old = items.to_vec();
    for (item, place) in items.iter_mut().zip(order) {
        *item = old[place as u32 as usize];
    }
}

/// Sorts pairs by their first number, then by their second.
pub(crate) fn sort_pairs<P: Copy + Into<[u32; 2]>>(pairs: &mut [P]) {
    sort_by_key(pairs, |&pair| {
        let [first, second] = pair.into();
        u64::from(first) << 32 | u64::from(second)
    });
}

/// Sorts numbers in their total order.
pub(crate) fn sort_numbers<T: Copy + Into<f64>>(numbers: &mut [T]) {
    sort_by_key(numbers, |&number| key_of(number.into()));
}

/// The median, the upper of two; none if there is no number.
pub(crate) fn median<T: Copy + Into<f64>>(mut numbers: Vec<T>) -> Option<T> {
    sort_numbers(&mut numbers);
    numbers.get(numbers.len() / 2).copied()
}

/// Sorts a few items by insertion, stably.
pub fn sort_few<T>(items: &mut [T], before: impl Fn(&T, &T) -> bool) {
    for end in 1..items.len() {
        for at in (1..=end).rev() {
            if !before(&items[at], &items[at - 1]) {
                break;
            }
            items.swap(at, at - 1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sorting_is_the_standard_librarys() {
        let numbers = [3.0, -0.0, f32::NAN, 0.0, f32::NEG_INFINITY, -f32::NAN, 3.0, 1e-40, -2.5, f32::MAX];
        let bits = |numbers: [f32; 10]| numbers.map(f32::to_bits);
        let (mut ours, mut theirs) = (numbers, numbers);
        sort_numbers(&mut ours);
        theirs.sort_by(f32::total_cmp);
        assert_eq!(bits(ours), bits(theirs));
        let mut keys = numbers.map(|x| key(x.abs(), 7));
        keys.sort_unstable();
        theirs = numbers.map(f32::abs);
        theirs.sort_by(f32::total_cmp);
        assert_eq!(keys.map(unkey).map(|(x, i)| (x.to_bits(), i)), bits(theirs).map(|bits| (bits, 7)));
    }

    #[test]
    fn pairs_are_sorted_as_the_standard_library_sorts_them() {
        let pairs = [(2, 0), (0, u32::MAX), (2, 0), (0, 3), (u32::MAX, 1), (1, 7), (0, 0)];
        let (mut ours, mut theirs) = (pairs, pairs);
        sort_pairs(&mut ours);
        theirs.sort_unstable();
        assert_eq!(ours, theirs);
    }

    #[test]
    fn items_with_equal_keys_stay_in_their_order() {
        let items = [(2, 'a'), (1, 'b'), (2, 'c'), (0, 'd'), (1, 'e'), (2, 'f')];
        let (mut by_key, mut by_insertion, mut theirs) = (items, items, items);
        theirs.sort_by_key(|item| item.0);
        sort_by_key(&mut by_key, |item| item.0);
        sort_few(&mut by_insertion, |a, b| a.0 < b.0);
        assert_eq!((by_key, by_insertion), (theirs, theirs));
        sort_few(&mut by_insertion[..0], |a, b| a < b);
    }
}
