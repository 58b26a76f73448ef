//! Stacks of TIFF pictures (Adobe, "TIFF Revision 6.0", 1992, and its BigTIFF form): the pages of a
//! file become the slices of an image.

use super::header::{first_of, quoted, wrong};
use super::zip::Unpacked;
use super::{ImageFormat, ImageReadError, MAX_IMAGE_BYTES};
use crate::image::voxels::{Layout, VoxelType, Voxels};
use crate::image::{AxisOrder, Image, Placement};
use crate::slices;
use glam::{DMat3, DVec3};

const FORMAT: ImageFormat = ImageFormat::Tiff;
/// Upper limit on the number of pages, since their chain may be circular.
const MOST_PAGES: usize = 1 << 16;
/// Upper limit on the number of values of an entry: a page may have a strip for each row.
const MOST_VALUES: usize = 1 << 20;

/// Tags of the entries that are used.
mod tag {
    pub(super) const WIDTH: u16 = 256;
    pub(super) const HEIGHT: u16 = 257;
    pub(super) const BITS: u16 = 258;
    pub(super) const COMPRESSION: u16 = 259;
    pub(super) const DESCRIPTION: u16 = 270;
    pub(super) const STRIP_OFFSETS: u16 = 273;
    pub(super) const SAMPLES: u16 = 277;
    pub(super) const ROWS_IN_A_STRIP: u16 = 278;
    pub(super) const STRIP_BYTES: u16 = 279;
    pub(super) const X_RESOLUTION: u16 = 282;
    pub(super) const Y_RESOLUTION: u16 = 283;
    pub(super) const PLANES: u16 = 284;
    pub(super) const PREDICTOR: u16 = 317;
    pub(super) const TILE_WIDTH: u16 = 322;
    pub(super) const FORMAT: u16 = 339;
}

/// How the strips of a page are compressed.
#[derive(Clone, Copy, PartialEq)]
enum Packing {
    Plain,
    Lzw,
    Deflate,
    PackBits,
}

/// The bytes of a file, with its byte order and offset size from the first bytes.
#[derive(Clone, Copy)]
struct File<'a> {
    bytes: &'a [u8],
    is_big_endian: bool,
    /// Whether offsets take eight bytes.
    is_long: bool,
}

impl<'a> File<'a> {
    fn new(bytes: &'a [u8]) -> Result<(Self, u64), ImageReadError> {
        let mut file = Self { bytes, is_big_endian: bytes.starts_with(b"MM"), is_long: false };
        file.is_long = file.number(2, 2) == Some(43);
        let first = if file.is_long { file.number(8, 8) } else { file.number(4, 4) };
        Ok((file, first.ok_or_else(cut_off)?))
    }

    /// The whole number of `size` bytes at an offset.
    fn number(self, at: u64, size: usize) -> Option<u64> {
        let at = usize::try_from(at).ok()?;
        let bytes = self.bytes.get(at..at.checked_add(size)?)?;
        let add = |sum: u64, byte: &u8| sum << 8 | u64::from(*byte);
        Some(if self.is_big_endian { bytes.iter().fold(0, add) } else { bytes.iter().rev().fold(0, add) })
    }
}

/// The error of a file that ends too early.
#[cold]
fn cut_off() -> ImageReadError {
    wrong(FORMAT, "length", "an entry lies behind the end of the file, which is cut off; export it again")
}

/// An entry of a page.
struct Entry {
    tag: u16,
    /// Bytes per value.
    size: usize,
    count: usize,
    /// Offset of the values.
    at: u64,
}

/// A page: its entries.
struct Page<'a> {
    file: File<'a>,
    entries: Vec<Entry>,
}

impl<'a> Page<'a> {
    /// Reads the page at an offset. Also returns the offset of the next page, 0 after the last.
    fn read(file: File<'a>, at: u64) -> Result<(Self, u64), ImageReadError> {
        let (count_size, entry_size, place) = if file.is_long { (8, 20, 8) } else { (2, 12, 4) };
        let count = file.number(at, count_size).ok_or_else(cut_off)?;
        let mut entries = Vec::new();
        let entry_at =
            |k: u64| at.saturating_add(count_size as u64).saturating_add(k.saturating_mul(entry_size));
        for k in 0..count {
            let at = entry_at(k);
            let number = |offset: u64, size: usize| file.number(at + offset, size).ok_or_else(cut_off);
            let size = match number(2, 2)? {
                1 | 2 | 6 | 7 => 1,
                3 | 8 => 2,
                4 | 9 | 11 => 4,
                _ => 8,
            };
            let values = number(4, place)?;
            let count = usize::try_from(values).ok().filter(|count| *count <= MOST_VALUES);
            let count =
                count.ok_or_else(|| wrong(FORMAT, "page", format!("it has an entry of {values} values")))?;
            let own = at + 4 + place as u64;
            let is_here = count * size <= place;
            let at = if is_here { own } else { number(own - at, place)? };
            entries.push(Entry { tag: number(0, 2)? as u16, size, count, at });
        }
        let next = file.number(entry_at(count), place).ok_or_else(cut_off)?;
        Ok((Self { file, entries }, next))
    }

    fn entry(&self, tag: u16) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.tag == tag)
    }

    /// The values of an entry; empty without the entry.
    fn values(&self, tag: u16) -> Result<Vec<u64>, ImageReadError> {
        let Some(entry) = self.entry(tag) else { return Ok(Vec::new()) };
        let value = |k: usize| {
            let at = entry.at.checked_add((k * entry.size) as u64)?;
            self.file.number(at, entry.size)
        };
        (0..entry.count).map(|k| value(k).ok_or_else(cut_off)).collect()
    }

    /// The first value of an entry, or `usual` without the entry.
    fn value(&self, tag: u16, usual: u64) -> Result<u64, ImageReadError> {
        Ok(self.values(tag)?.first().copied().unwrap_or(usual))
    }

    /// A fraction that is stored as two whole numbers of four bytes.
    fn fraction(&self, tag: u16) -> Option<f64> {
        let at = self.entry(tag)?.at;
        let (over, under) = (self.file.number(at, 4)?, self.file.number(at.checked_add(4)?, 4)?);
        Some(over as f64 / under as f64)
    }

    fn text(&self, tag: u16) -> String {
        let text = self.values(tag).unwrap_or_default();
        text.iter().map(|&byte| char::from(byte as u8)).collect()
    }
}

/// What all pages of an image have in common.
#[derive(Clone, Copy, PartialEq)]
struct Form {
    width: usize,
    height: usize,
    voxel_type: VoxelType,
    /// Values of a pixel that are stored together.
    step: usize,
    /// Values of a pixel.
    samples: usize,
    packing: Packing,
    /// Whether each value is stored as its difference from the previous one in the row.
    is_difference: bool,
}

impl Form {
    fn of(page: &Page) -> Result<Self, ImageReadError> {
        let size = |tag: u16, name: &str| {
            let n = page.value(tag, 0)?;
            usize::try_from(n)
                .ok()
                .filter(|n| (1..=1 << 24).contains(n))
                .ok_or_else(|| wrong(FORMAT, name, format!("it is {n}")))
        };
        let bits = page.values(tag::BITS)?;
        let first = bits.first().copied().unwrap_or(1);
        let form = page.value(tag::FORMAT, 1)?;
        let voxel_type = match (first, form) {
            (8, 1 | 4) => VoxelType::U8,
            (8, 2) => VoxelType::I8,
            (16, 1 | 4) => VoxelType::U16,
            (16, 2) => VoxelType::I16,
            (32, 1 | 4) => VoxelType::U32,
            (32, 2) => VoxelType::I32,
            (32, 3) => VoxelType::F32,
            (64, 3) => VoxelType::F64,
            _ => {
                let message = format!(
                    "pixels of {first} bits in the form {form} are not read; save 8, 16 or 32 bits for each"
                );
                return Err(wrong(FORMAT, "BitsPerSample", message));
            }
        };
        if bits.iter().any(|other| *other != first) {
            return Err(wrong(FORMAT, "BitsPerSample", "the values of a pixel differ in their bits"));
        }
        if page.entry(tag::TILE_WIDTH).is_some() {
            return Err(wrong(
                FORMAT,
                "TileWidth",
                "tiles are not read; save the stack in strips, as ImageJ does",
            ));
        }
        let samples = page.value(tag::SAMPLES, 1)?.clamp(1, 1 << 16) as usize;
        let packing = match page.value(tag::COMPRESSION, 1)? {
            1 => Packing::Plain,
            5 => Packing::Lzw,
            8 | 32946 => Packing::Deflate,
            32773 => Packing::PackBits,
            other => {
                let message = format!(
                    "the compression {other} is not read; save the stack without one, or with LZW or deflate"
                );
                return Err(wrong(FORMAT, "Compression", message));
            }
        };
        let is_difference = match page.value(tag::PREDICTOR, 1)? {
            1 => false,
            2 if voxel_type.is_whole() => true,
            other => {
                let message = format!("the predictor {other} is not read; save the stack without one");
                return Err(wrong(FORMAT, "Predictor", message));
            }
        };
        Ok(Self {
            width: size(tag::WIDTH, "ImageWidth")?,
            height: size(tag::HEIGHT, "ImageLength")?,
            voxel_type,
            step: if page.value(tag::PLANES, 1)? == 2 { 1 } else { samples },
            samples,
            packing,
            is_difference,
        })
    }

    /// Bytes of a row.
    fn row(&self) -> usize {
        self.width * self.step * self.voxel_type.bytes()
    }

    /// Bytes of a page that are kept.
    fn bytes(&self) -> u64 {
        self.row() as u64 * self.height as u64
    }
}

/// Appends the pixels of a page.
fn append(page: &Page, form: &Form, out: &mut Vec<u8>) -> Result<(), ImageReadError> {
    let (offsets, lengths) = (page.values(tag::STRIP_OFFSETS)?, page.values(tag::STRIP_BYTES)?);
    let rows = page.value(tag::ROWS_IN_A_STRIP, form.height as u64)?.clamp(1, form.height as u64) as usize;
    let end = out.len() + form.bytes() as usize;
    for (k, first) in (0..form.height).step_by(rows).enumerate() {
        let wanted = rows.min(form.height - first) * form.row();
        let begin = offsets.get(k).and_then(|&at| usize::try_from(at).ok()).ok_or_else(cut_off)?;
        let length = lengths.get(k).map_or(wanted, |&length| usize::try_from(length).unwrap_or(usize::MAX));
        let strip = page.file.bytes.get(begin..).ok_or_else(cut_off)?;
        let strip = &strip[..length.min(strip.len())];
        let start = out.len();
        match form.packing {
            Packing::Plain => out.extend_from_slice(&strip[..wanted.min(strip.len())]),
            Packing::Deflate => {
                let unpacked = slices::complete(Unpacked::packed(strip.to_vec()).all(wanted as u64))?;
                out.extend_from_slice(&unpacked[..wanted.min(unpacked.len())]);
            }
            Packing::Lzw => lzw(strip, start + wanted, out),
            Packing::PackBits => pack_bits(strip, start + wanted, out),
        }
        if out.len() < start + wanted {
            let (needed, found) = (wanted as u64, (out.len() - start) as u64);
            return Err(ImageReadError::CutOff { format: FORMAT, needed, found });
        }
        if form.is_difference {
            out[start..].chunks_mut(form.row()).for_each(|row| add_up(row, form, page.file.is_big_endian));
        }
    }
    out.truncate(end);
    Ok(())
}

/// Adds to each value of a row the previous value of the same channel.
fn add_up(row: &mut [u8], form: &Form, is_big_endian: bool) {
    let size = form.voxel_type.bytes();
    for at in (form.step * size..row.len()).step_by(size) {
        let mut carry = 0;
        for k in 0..size {
            let byte = at + if is_big_endian { size - 1 - k } else { k };
            let sum = u16::from(row[byte]) + u16::from(row[byte - form.step * size]) + carry;
            (row[byte], carry) = (sum as u8, sum >> 8);
        }
    }
}

/// Unpacks PackBits up to `end` bytes (TIFF 6.0, section 9).
fn pack_bits(strip: &[u8], end: usize, out: &mut Vec<u8>) {
    let mut at = 0;
    while out.len() < end && at < strip.len() {
        let count = strip[at] as i8;
        at += 1;
        let room = end - out.len();
        if count >= 0 {
            let length = (count as usize + 1).min(strip.len() - at).min(room);
            out.extend_from_slice(&strip[at..at + length]);
            at += count as usize + 1;
        } else if count != i8::MIN {
            let Some(&byte) = strip.get(at) else { return };
            out.resize(out.len() + (1 - isize::from(count)) as usize, byte);
            out.truncate(end);
            at += 1;
        }
    }
}

/// Unpacks LZW up to `end` bytes (TIFF 6.0, section 13). Stops at an undefined code.
fn lzw(strip: &[u8], end: usize, out: &mut Vec<u8>) {
    const CLEAR: usize = 256;
    const END: usize = 257;
    /// Size of the LZW code table: codes have at most twelve bits.
    const MOST: usize = 4096;
    // The strings of the codes from 258 on, as ranges of the output.
    let mut texts: Vec<(usize, usize)> = Vec::new();
    let mut before: Option<(usize, usize)> = None;
    let (mut bits, mut held, mut at) = (0_u32, 0_u32, 0);
    while out.len() < end {
        // Codes grow by one bit just before the first one that needs it.
        let longest = (END + 1 + texts.len() + usize::from(before.is_some())).min(MOST - 1);
        let width = (usize::BITS - longest.leading_zeros()).max(9);
        while held < width {
            let Some(&byte) = strip.get(at) else { return };
            bits = bits << 8 | u32::from(byte);
            (held, at) = (held + 8, at + 1);
        }
        held -= width;
        let code = (bits >> held & ((1 << width) - 1)) as usize;
        bits &= (1 << held) - 1;
        if code == END {
            return;
        }
        if code == CLEAR {
            (texts, before) = (Vec::new(), None);
            continue;
        }
        let start = out.len();
        if code < CLEAR {
            out.push(code as u8);
        } else if let Some(&(from, length)) = texts.get(code - END - 1) {
            out.extend_from_within(from..from + length);
        } else if let (Some((from, length)), true) = (before, code == END + 1 + texts.len()) {
            // The code that is just being defined: the previous string plus its own first byte.
            out.extend_from_within(from..from + length);
            out.push(out[from]);
        } else {
            return;
        }
        if let Some((from, length)) = before
            && END + 1 + texts.len() < MOST
        {
            // The output continues with the first byte of this code's string.
            texts.push((from, length + 1));
        }
        before = Some((start, out.len() - start));
    }
    out.truncate(end);
}

/// What ImageJ writes about a stack, in lines of the description.
struct Stack {
    channels: usize,
    frames: usize,
    /// Distance between slices.
    spacing: Option<f64>,
    is_told: bool,
}

impl Stack {
    fn of(description: &str) -> Self {
        let entry = |name: &str| {
            let mut lines = description.lines().filter_map(|line| line.split_once('='));
            lines.find(|(own, _)| *own == name).map(|(_, value)| value.trim())
        };
        let count = |name: &str| entry(name).and_then(|value| value.parse().ok()).unwrap_or(1).max(1);
        let spacing = entry("spacing").and_then(|value| value.parse().ok());
        Self {
            channels: count("channels"),
            frames: count("frames"),
            spacing: spacing.filter(|spacing: &f64| *spacing > 0.0 && spacing.is_finite()),
            is_told: description.starts_with("ImageJ="),
        }
    }
}

/// Reads a stack of pages, each as a slice of work.
pub(super) async fn read(file: Unpacked) -> Result<Image, ImageReadError> {
    let bytes = file.all(MAX_IMAGE_BYTES).await?;
    let (file, mut next) = File::new(&bytes)?;
    let mut pages = Vec::new();
    while next != 0 && pages.len() < MOST_PAGES {
        let (page, behind) = Page::read(file, next)?;
        pages.push(page);
        next = behind;
    }
    let Some(first) = pages.first() else {
        return Err(wrong(FORMAT, "page", "there is none; export the file again"));
    };
    let form = Form::of(first)?;
    let stack = Stack::of(&first.text(tag::DESCRIPTION));
    let mut notes = Vec::new();
    let (channels, frames) = if stack.is_told { (stack.channels, stack.frames) } else { (1, 1) };
    if channels > 1 {
        notes.push(first_of(channels, "channels"));
    }
    if frames > 1 {
        notes.push(first_of(frames, "frames"));
    }
    if form.samples > 1 {
        notes.push(first_of(form.samples, "values for each pixel"));
    }
    let slices = (pages.len() / (channels * frames).max(1)).max(1);
    let needed = form.bytes().saturating_mul(slices as u64);
    if needed > MAX_IMAGE_BYTES {
        return Err(ImageReadError::TooLarge { bytes: needed });
    }
    let mut data = Vec::new();
    for (k, page) in pages.iter().step_by(channels).take(slices).enumerate() {
        let own = Form::of(page)?;
        if (own.width, own.height, own.voxel_type, own.step)
            != (form.width, form.height, form.voxel_type, form.step)
        {
            let text = format!("page {}", k * channels + 1);
            let message = format!(
                "it has {} × {} pixels of {}, and the first one {} × {} of {}; save slices of one size",
                own.width, own.height, own.voxel_type, form.width, form.height, form.voxel_type
            );
            return Err(wrong(FORMAT, quoted(&text), message));
        }
        append(page, &own, &mut data)?;
        slices::pause().await;
    }
    let layout = Layout { step: form.step, ..Layout::plain(form.voxel_type, file.is_big_endian) };
    let size = [form.width, form.height, slices];
    let length = |tag: u16| {
        let pixels =
            first.fraction(tag).filter(|pixels| stack.is_told && *pixels > 0.0 && pixels.is_finite());
        pixels.map_or(1.0, |pixels| 1.0 / pixels)
    };
    let axes = DVec3::new(length(tag::X_RESOLUTION), length(tag::Y_RESOLUTION), stack.spacing.unwrap_or(1.0));
    let count = size.iter().product();
    let found = data.len() as u64;
    let voxels = Voxels::of_file(data, layout, count);
    let voxels = voxels.ok_or(ImageReadError::CutOff { format: FORMAT, needed, found })?;
    let image = Image::of(size, AxisOrder::FirstFastest, voxels).await?;
    let placement = Placement::new(DMat3::from_diagonal(axes), DVec3::ZERO)?;
    Ok(Image { placement, notes: notes.into(), ..image })
}
