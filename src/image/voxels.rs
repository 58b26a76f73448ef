//! The voxels of an image, in the type and byte order of their file.

use crate::slices::{self, LIGHT, pause};
use bytemuck::NoUninit;
use core::fmt::{self, Display, Formatter};
use core::ops::Range;
use std::sync::Arc;

/// The type of voxels in a file or an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoxelType {
    /// Unsigned integers of 8 bits.
    U8,
    /// Signed integers of 8 bits.
    I8,
    /// Unsigned integers of 16 bits.
    U16,
    /// Signed integers of 16 bits.
    I16,
    /// Unsigned integers of 32 bits.
    U32,
    /// Signed integers of 32 bits.
    I32,
    /// Unsigned integers of 64 bits.
    U64,
    /// Signed integers of 64 bits.
    I64,
    /// Floating-point numbers in single precision.
    F32,
    /// Floating-point numbers in double precision.
    F64,
}

/// Largest allowed value. Spline coefficients, up to ten times as large, must fit single precision.
const LARGEST: f64 = 1e30;

/// Voxels that are read at once.
const AT_ONCE: usize = 256;

impl VoxelType {
    /// All types.
    pub const ALL: [Self; 10] = [
        Self::U8,
        Self::I8,
        Self::U16,
        Self::I16,
        Self::U32,
        Self::I32,
        Self::U64,
        Self::I64,
        Self::F32,
        Self::F64,
    ];

    /// The type with this NumPy name, such as `int16`.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|known| known.to_string() == name)
    }

    /// Bytes of a voxel.
    #[must_use]
    pub fn bytes(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }

    /// Whether these are whole numbers, as labels are.
    #[must_use]
    pub fn is_whole(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }
}

impl Display for VoxelType {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::U8 => "uint8",
            Self::I8 => "int8",
            Self::U16 => "uint16",
            Self::I16 => "int16",
            Self::U32 => "uint32",
            Self::I32 => "int32",
            Self::U64 => "uint64",
            Self::I64 => "int64",
            Self::F32 => "float32",
            Self::F64 => "float64",
        })
    }
}

/// A number type that a program's voxel array can have.
pub trait Voxel: NoUninit {
    /// Its type.
    const TYPE: VoxelType;
}

macro_rules! voxel {
    ($($number:ty => $name:ident),*) => {
        $(impl Voxel for $number {
            const TYPE: VoxelType = VoxelType::$name;
        })*
    };
}

voxel!(u8 => U8, i8 => I8, u16 => U16, i16 => I16, u32 => U32, i32 => I32, u64 => U64, i64 => I64, f32 => F32, f64 => F64);

/// How the bytes of a file encode voxels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layout {
    pub(super) voxel_type: VoxelType,
    /// Whether the most significant byte of a number comes first.
    pub(super) is_big_endian: bool,
    /// Offset of the first voxel in bytes.
    pub(super) first: usize,
    /// Numbers from one voxel to the next; above 1 if each voxel has several.
    pub(super) step: usize,
    /// A value is `slope` times the number of the file, plus `intercept`.
    pub(super) slope: f64,
    pub(super) intercept: f64,
}

impl Layout {
    /// Consecutive numbers from the first byte on.
    pub(super) fn plain(voxel_type: VoxelType, is_big_endian: bool) -> Self {
        Self { voxel_type, is_big_endian, first: 0, step: 1, slope: 1.0, intercept: 0.0 }
    }
}

/// The memory of voxels.
enum Data {
    /// The bytes of a file.
    Bytes(Vec<u8>),
    /// The result of a filter.
    Filtered(Vec<f32>),
}

impl Data {
    #[inline]
    fn bytes(&self) -> &[u8] {
        match self {
            Self::Bytes(bytes) => bytes,
            Self::Filtered(numbers) => bytemuck::cast_slice(numbers),
        }
    }
}

/// A sequence of voxels, which copies share.
#[derive(Clone)]
pub(super) struct Voxels {
    data: Arc<Data>,
    layout: Layout,
    len: usize,
}

impl Voxels {
    /// The numbers of an array.
    pub(super) fn new<T: Voxel>(numbers: &[T]) -> Self {
        let layout = Layout::plain(T::TYPE, cfg!(target_endian = "big"));
        let data = Arc::new(Data::Bytes(bytemuck::cast_slice(numbers).to_vec()));
        Self { data, layout, len: numbers.len() }
    }

    /// The result of a filter, which is not copied.
    pub(super) fn filtered(numbers: Vec<f32>) -> Self {
        let layout = Layout::plain(VoxelType::F32, cfg!(target_endian = "big"));
        let len = numbers.len();
        Self { data: Arc::new(Data::Filtered(numbers)), layout, len }
    }

    /// The first `len` voxels of a file; none if it has fewer.
    pub(super) fn of_file(data: Vec<u8>, layout: Layout, len: usize) -> Option<Self> {
        let size = layout.voxel_type.bytes();
        let last = len.checked_sub(1)?.checked_mul(layout.step)?.checked_mul(size)?;
        let end = layout.first.checked_add(last)?.checked_add(size)?;
        (end <= data.len()).then(|| Self { data: Arc::new(Data::Bytes(data)), layout, len })
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    pub(super) fn bytes(&self) -> usize {
        self.data.bytes().len()
    }

    /// Whether both are the same bytes in memory, read in the same way.
    pub(super) fn are_shared_with(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.data, &other.data) && self.layout == other.layout
    }

    /// Distance between consecutive values of integer voxels; 0 for floating-point voxels.
    pub(super) fn step(&self) -> f64 {
        if self.layout.voxel_type.is_whole() { self.layout.slope.abs() } else { 0.0 }
    }

    pub(super) fn voxel_type(&self) -> VoxelType {
        self.layout.voxel_type
    }

    /// Writes the values of the voxels from `first` on. Only this function handles the types.
    #[allow(trivial_numeric_casts, reason = "one of the types is already double precision")]
    fn read(&self, first: usize, out: &mut [f64]) {
        let Layout { voxel_type, is_big_endian, step, slope, intercept, .. } = self.layout;
        let size = voxel_type.bytes();
        let from = &self.data.bytes()[self.layout.first + first * step * size..];
        macro_rules! read {
            ($number:ty) => {{
                let value = |number: $number| number as f64 * slope + intercept;
                let all = from.as_chunks::<{ size_of::<$number>() }>().0;
                if step > 1 || is_big_endian {
                    for (out, &bytes) in out.iter_mut().zip(all.iter().step_by(step)) {
                        let number = if is_big_endian {
                            <$number>::from_be_bytes(bytes)
                        } else {
                            <$number>::from_le_bytes(bytes)
                        };
                        *out = value(number);
                    }
                } else {
                    // The common case alone, in a loop for several numbers at once.
                    for (out, &bytes) in out.iter_mut().zip(all) {
                        *out = value(<$number>::from_le_bytes(bytes));
                    }
                }
            }};
        }
        match voxel_type {
            VoxelType::U8 => read!(u8),
            VoxelType::I8 => read!(i8),
            VoxelType::U16 => read!(u16),
            VoxelType::I16 => read!(i16),
            VoxelType::U32 => read!(u32),
            VoxelType::I32 => read!(i32),
            VoxelType::U64 => read!(u64),
            VoxelType::I64 => read!(i64),
            VoxelType::F32 => read!(f32),
            VoxelType::F64 => read!(f64),
        }
    }

    /// The bytes of one voxel.
    pub(super) fn bytes_of(&self, index: usize) -> &[u8] {
        let Layout { first, step, voxel_type, .. } = self.layout;
        &self.data.bytes()[first + index * step * voxel_type.bytes()..][..voxel_type.bytes()]
    }

    /// The layout of voxels that follow one another, otherwise as here.
    pub(super) fn packed(&self) -> Layout {
        Layout { first: 0, step: 1, ..self.layout }
    }

    /// Calls `take` with the values of these voxels, up to [`AT_ONCE`] at a time, and the index of
    /// the first of them.
    fn each(&self, range: Range<usize>, mut take: impl FnMut(usize, &[f64])) {
        let mut values = [0.0; AT_ONCE];
        let end = range.end;
        for begin in range.step_by(AT_ONCE) {
            let values = &mut values[..AT_ONCE.min(end - begin)];
            self.read(begin, values);
            take(begin, values);
        }
    }

    /// Writes the values of the voxels from `first` on, relative to `zero`.
    pub(super) fn write(&self, first: usize, zero: f64, out: &mut [f32]) {
        self.each(first..first + out.len(), |begin, values| {
            for (out, value) in out[begin - first..].iter_mut().zip(values) {
                *out = (value - zero) as f32;
            }
        });
    }

    /// The value of a voxel.
    pub(super) fn at(&self, index: usize) -> f64 {
        let mut found = [0.0];
        self.read(index, &mut found);
        found[0]
    }

    /// Calls `take` with the values of all voxels, some at a time, and the index of the first of
    /// them, in slices of work.
    pub(super) async fn for_each(&self, mut take: impl FnMut(usize, &[f64])) {
        for range in slices::ranges(self.len, LIGHT) {
            self.each(range, &mut take);
            pause().await;
        }
    }

    /// Smallest and largest value. If some values are not finite or too large for single precision,
    /// their number and the index of the first.
    pub(super) async fn range(&self) -> Result<[f64; 2], (usize, usize)> {
        let (mut min, mut max) = (f64::INFINITY, f64::NEG_INFINITY);
        let (mut count, mut first) = (0, 0);
        self.for_each(|begin, values| {
            for (k, &value) in values.iter().enumerate() {
                if value.abs() <= LARGEST {
                    // Unlike `f64::min`, a comparison is one instruction in WebAssembly.
                    min = if value < min { value } else { min };
                    max = if value > max { value } else { max };
                } else {
                    first = if count == 0 { begin + k } else { first };
                    count += 1;
                }
            }
        })
        .await;
        if count == 0 { Ok([min, max]) } else { Err((count, first)) }
    }
}
