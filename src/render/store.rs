//! Particles on the GPU, in chunks of instance buffers that grow and keep their content.

use super::layout::{COLOUR_STRIDE, Record};
use core::ops::Range;

/// Particles per chunk: 7 MiB of records and 1 MiB of colours. That is far below the buffer limit of any device and
/// takes only 4 draw calls per pass for a million particles.
const CHUNK: u32 = 1 << 18;
/// Initial capacity of the first chunk.
const FIRST: u32 = 1 << 12;

/// Instance buffers of all particles.
#[derive(Default)]
pub(super) struct Store {
    chunks: Vec<Chunk>,
    scratch: Vec<Record>,
}

struct Chunk {
    records: wgpu::Buffer,
    colours: wgpu::Buffer,
    capacity: u32,
}

/// Consecutive particles in one chunk, as slices of its vertex buffers.
pub(super) struct Run<'a> {
    pub(super) records: wgpu::BufferSlice<'a>,
    pub(super) colours: wgpu::BufferSlice<'a>,
    pub(super) count: u32,
}

/// Columns of particles to write, with one entry per particle, or three for vectors.
#[derive(Clone, Copy)]
pub(super) struct Columns<'a> {
    pub(super) positions: &'a [f32],
    pub(super) normals: &'a [f32],
    pub(super) radii: &'a [f32],
    pub(super) levels: &'a [u32],
    pub(super) colours: &'a [u32],
    pub(super) birth: f32,
}

impl Store {
    /// Maximum number of particles, which take 128 MiB on the GPU.
    pub(super) const MAX: u32 = 1 << 22;

    /// Packs and uploads particles from `first` on. Buffers grow as needed.
    ///
    /// # Panics
    ///
    /// If the columns differ in length or end beyond [`Store::MAX`].
    pub(super) fn write(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        first: u32,
        columns: Columns<'_>,
    ) {
        let count = columns.radii.len();
        assert!(
            columns.positions.len() == 3 * count
                && columns.normals.len() == 3 * count
                && columns.levels.len() == count,
            "columns of {count} radii, {} positions, {} normals, {} levels",
            columns.positions.len() / 3,
            columns.normals.len() / 3,
            columns.levels.len()
        );
        self.reserve(device, queue, first + count as u32);
        let positions = columns.positions.as_chunks::<3>().0;
        let normals = columns.normals.as_chunks::<3>().0;
        for (chunk, local, span) in split_at_chunks(first, count as u32) {
            self.scratch.clear();
            self.scratch.extend(span.clone().map(|i| {
                Record::new(positions[i], normals[i], columns.radii[i], columns.birth, columns.levels[i])
            }));
            let offset = u64::from(local) * size_of::<Record>() as u64;
            queue.write_buffer(&self.chunks[chunk].records, offset, bytemuck::cast_slice(&self.scratch));
        }
        self.write_colours(queue, first, columns.colours);
    }

    /// Uploads the colours of particles from `first` on. Those beyond the capacity of the buffers are dropped.
    pub(super) fn write_colours(&mut self, queue: &wgpu::Queue, first: u32, colours: &[u32]) {
        for (chunk, local, span) in split_at_chunks(first, colours.len() as u32) {
            let Some(chunk) = self.chunks.get(chunk) else { break };
            let room = chunk.capacity.saturating_sub(local) as usize;
            let colours = &colours[span];
            let colours = &colours[..colours.len().min(room)];
            let offset = u64::from(local) * COLOUR_STRIDE as u64;
            queue.write_buffer(&chunk.colours, offset, bytemuck::cast_slice(colours));
        }
    }

    /// Slices of the vertex buffers for the particles `range`, in order.
    pub(super) fn runs(&self, range: Range<u32>) -> impl Iterator<Item = Run<'_>> {
        split_at_chunks(range.start, range.end.saturating_sub(range.start)).filter_map(
            |(chunk, local, span)| {
                let chunk = self.chunks.get(chunk)?;
                let count = (span.len() as u32).min(chunk.capacity.saturating_sub(local));
                let bytes = |stride: usize| {
                    let stride = stride as u64;
                    u64::from(local) * stride..u64::from(local + count) * stride
                };
                (count > 0).then(|| Run {
                    records: chunk.records.slice(bytes(size_of::<Record>())),
                    colours: chunk.colours.slice(bytes(COLOUR_STRIDE)),
                    count,
                })
            },
        )
    }

    /// Grows the buffers to a capacity of at least `count` particles.
    fn reserve(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, count: u32) {
        assert!(count <= Self::MAX, "{count} particles asked for, at most {} are drawn", Self::MAX);
        for index in 0..count.div_ceil(CHUNK) {
            let wanted = (count - index * CHUNK).min(CHUNK);
            let present = self.chunks.get(index as usize).map_or(0, |chunk| chunk.capacity);
            if wanted <= present {
                continue;
            }
            let floor = if index == 0 { FIRST } else { CHUNK };
            let grown = Chunk::new(device, wanted.next_power_of_two().max(floor));
            if let Some(old) = self.chunks.get_mut(index as usize) {
                let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
                encoder.copy_buffer_to_buffer(&old.records, 0, &grown.records, 0, old.records.size());
                encoder.copy_buffer_to_buffer(&old.colours, 0, &grown.colours, 0, old.colours.size());
                queue.submit([encoder.finish()]);
                *old = grown;
            } else {
                self.chunks.push(grown);
            }
        }
    }
}

impl Chunk {
    fn new(device: &wgpu::Device, capacity: u32) -> Self {
        let buffer = |label, stride: usize| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: u64::from(capacity) * stride as u64,
                usage: wgpu::BufferUsages::VERTEX
                    | wgpu::BufferUsages::COPY_DST
                    | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            })
        };
        Self {
            records: buffer("records", size_of::<Record>()),
            colours: buffer("colours", COLOUR_STRIDE),
            capacity,
        }
    }
}

/// Splits particles `first..first + count` at chunk borders. Each item is a chunk, the first particle within it, and
/// the range relative to `first`.
fn split_at_chunks(first: u32, count: u32) -> impl Iterator<Item = (usize, u32, Range<usize>)> {
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
    fn ranges_cover_the_particles_and_stay_within_chunks() {
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
