//! Splits records among buffers, so that every device accepts their size.

use core::ops::Range;

/// Records per chunk. For particles that is 7 MiB of records and 1 MiB of colours, far below the
/// buffer limit of any device; a million particles need only 4 draw calls per pass.
pub const CHUNK: u32 = 1 << 18;
/// Largest number of records of each kind. It is more than the particles that a run may place: they
/// take 144 MiB on the GPU, faces 396 MiB.
pub const MOST_RECORDS: u32 = 18 * CHUNK;

/// Consecutive records within one chunk.
pub struct ChunkSpan {
    /// Number of the chunk.
    pub chunk: usize,
    /// Index within the chunk of the first of these records.
    pub start: u32,
    /// Range of these records, relative to the first record that is split.
    pub records: Range<usize>,
}

/// Splits records `first..first + count` at chunk borders.
pub fn split_at_chunks(first: u32, count: u32) -> impl Iterator<Item = ChunkSpan> {
    let end = first + count;
    let mut at = first;
    core::iter::from_fn(move || {
        (at < end).then(|| {
            let stop = end.min((at / CHUNK + 1) * CHUNK);
            let records = (at - first) as usize..(stop - first) as usize;
            let span = ChunkSpan { chunk: (at / CHUNK) as usize, start: at % CHUNK, records };
            at = stop;
            span
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
            for ChunkSpan { chunk, start, records } in split_at_chunks(first, count) {
                assert_eq!(records.start, next);
                assert_eq!(chunk as u32 * CHUNK + start, first + records.start as u32);
                assert!(!records.is_empty() && start + records.len() as u32 <= CHUNK);
                next = records.end;
            }
            assert_eq!(next, count as usize, "first {first}");
        }
    }
}
