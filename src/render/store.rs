//! Records on the GPU, in chunks of instance buffers that grow and keep their content.

use super::chunks::{CHUNK, ChunkSpan, MOST_RECORDS, split_at_chunks};
use super::layout::{InstanceFormats, stride};
use core::ops::Range;

/// Initial capacity of the first chunk, 128 KiB for particles. Six doublings lead to a whole
/// [`CHUNK`]; each copies the content once.
const FIRST: u32 = 1 << 12;

/// A buffer of a chunk: the geometry of its records, or their colours, which change more often.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    Records,
    Colours,
}

/// Instance buffers of records of one kind.
pub(super) struct Store {
    /// Bytes of a record and of its colours.
    strides: [u64; 2],
    chunks: Vec<Chunk>,
    /// Number of records that are drawn.
    pub(super) count: u32,
}

struct Chunk {
    buffers: [wgpu::Buffer; 2],
    capacity: u32,
}

/// Consecutive records in one chunk, as slices of its vertex buffers.
pub(super) struct RecordRun<'a> {
    pub(super) buffers: [wgpu::BufferSlice<'a>; 2],
    pub(super) count: u32,
}

impl Store {
    /// A store of records and colours with these formats.
    pub(super) fn new(formats: InstanceFormats) -> Self {
        Self { strides: formats.map(stride), chunks: Vec::new(), count: 0 }
    }

    /// Uploads a part of the records from `first` on. Records beyond the capacity of the buffers
    /// are dropped.
    pub(super) fn write(&self, queue: &wgpu::Queue, part: Part, first: u32, bytes: &[u8]) {
        let stride = self.strides[part as usize];
        let count = (bytes.len() as u64 / stride) as u32;
        for ChunkSpan { chunk, start, records } in split_at_chunks(first, count) {
            let Some(chunk) = self.chunks.get(chunk) else { break };
            let room = chunk.capacity.saturating_sub(start) as usize;
            let end = records.end.min(records.start + room);
            let bytes = &bytes[records.start * stride as usize..end * stride as usize];
            queue.write_buffer(&chunk.buffers[part as usize], u64::from(start) * stride, bytes);
        }
    }

    /// Slices of the vertex buffers for the records `range`, in order.
    pub(super) fn runs(&self, range: Range<u32>) -> impl Iterator<Item = RecordRun<'_>> {
        split_at_chunks(range.start, range.end.saturating_sub(range.start)).filter_map(
            |ChunkSpan { chunk, start, records }| {
                let chunk = self.chunks.get(chunk)?;
                let count = (records.len() as u32).min(chunk.capacity.saturating_sub(start));
                let slice = |part: Part| {
                    let stride = self.strides[part as usize];
                    let bytes = u64::from(start) * stride..u64::from(start + count) * stride;
                    chunk.buffers[part as usize].slice(bytes)
                };
                (count > 0)
                    .then(|| RecordRun { buffers: [slice(Part::Records), slice(Part::Colours)], count })
            },
        )
    }

    /// Grows the buffers to a capacity of at least `count` records.
    ///
    /// # Panics
    ///
    /// If `count` is more than [`MOST_RECORDS`].
    pub(super) fn reserve(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, count: u32) {
        assert!(count <= MOST_RECORDS, "{count} records asked for, at most {MOST_RECORDS} are drawn");
        for index in 0..count.div_ceil(CHUNK) {
            let wanted = (count - index * CHUNK).min(CHUNK);
            let present = self.chunks.get(index as usize).map_or(0, |chunk| chunk.capacity);
            if wanted <= present {
                continue;
            }
            let floor = if index == 0 { FIRST } else { CHUNK };
            let grown = self.chunk(device, wanted.next_power_of_two().max(floor));
            if let Some(old) = self.chunks.get_mut(index as usize) {
                let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
                for (old, grown) in old.buffers.iter().zip(&grown.buffers) {
                    encoder.copy_buffer_to_buffer(old, 0, grown, 0, old.size());
                }
                queue.submit([encoder.finish()]);
                *old = grown;
            } else {
                self.chunks.push(grown);
            }
        }
    }

    /// Releases the buffers.
    pub(super) fn release(&mut self) {
        self.chunks.clear();
    }

    fn chunk(&self, device: &wgpu::Device, capacity: u32) -> Chunk {
        let buffers = self.strides.map(|stride| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("instances"),
                size: u64::from(capacity) * stride,
                usage: wgpu::BufferUsages::VERTEX
                    | wgpu::BufferUsages::COPY_DST
                    | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            })
        });
        Chunk { buffers, capacity }
    }
}
