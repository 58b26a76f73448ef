//! Division of records among buffers, so that no buffer is larger than any device takes.

use core::ops::Range;

/// Records per chunk: for particles 7 MiB of records and 1 MiB of colours. That is far below the buffer limit of any device and
/// takes only 4 draw calls per pass for a million of them.
pub const CHUNK: u32 = 1 << 18;
/// Most records of one kind: more than the particles that a run may place.
pub const MOST_RECORDS: u32 = 18 * CHUNK;

/// Splits records `first..first + count` at chunk borders. Each item is a chunk, the first record within it, and
/// the range relative to `first`.
pub fn split_at_chunks(first: u32, count: u32) -> impl Iterator<Item = (usize, u32, Range<usize>)> {
    let end = first + count;
    let mut at = first;
    core::iter::from_fn(move || {
        (at < end).then(|| {
            let stop = end.min((at / CHUNK + 1) * CHUNK);
            let item = ((at / CHUNK) as usize, at % CHUNK, (at - first) as usize..(stop - first) as usize);
            at = stop;
            item
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_cover_the_records_and_stay_within_chunks() {
        for (first, count) in [(0, 0), (0, 1), (5, CHUNK), (CHUNK - 1, 2), (3 * CHUNK, CHUNK), (7, 3 * CHUNK)]
        {
            let mut next = 0;
            for (chunk, local, span) in split_at_chunks(first, count) {
                assert_eq!(span.start, next);
                assert_eq!(chunk as u32 * CHUNK + local, first + span.start as u32);
                assert!(!span.is_empty() && local + span.len() as u32 <= CHUNK);
                next = span.end;
            }
            assert_eq!(next, count as usize, "first {first}");
        }
    }
}
