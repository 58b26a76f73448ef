//! The renderer: a graphics device, and the particles and faces to draw with it.

use super::chunks::MOST_RECORDS;
use super::frame::Frame;
use super::gpu::Gpu;
use super::layout::{FACE, FaceRecord, FaceTint, PARTICLE, PIECE, Record};
use super::painter::{Canvas, Content, Painter, Scene};
use super::pixels::{padded_row, straight_rgba};
use super::store::{Part, Store};
use super::style::{PictureTarget, Style};
use super::view::View;

/// Columns of particles or of the corners of faces. Each has one entry, or three for vectors.
#[derive(Clone, Copy, Debug)]
pub struct Columns<'a> {
    /// World positions.
    pub positions: &'a [f32],
    /// Normals, of any length.
    pub normals: &'a [f32],
    /// Repulsion radii.
    pub radii: &'a [f32],
    /// Generation levels; `u32::MAX` for none.
    pub levels: &'a [u32],
    /// Colours, sRGB as 0xAABBGGRR.
    pub colours: &'a [u32],
}

impl Columns<'_> {
    /// The records of the particles, which begin to appear at `birth`.
    ///
    /// # Panics
    ///
    /// If another column is shorter than the radii.
    fn records(&self, birth: f32) -> impl Iterator<Item = Record> {
        let Self { positions, normals, radii, levels, .. } = *self;
        let (positions, normals) = (positions.as_chunks::<3>().0, normals.as_chunks::<3>().0);
        (0..radii.len()).map(move |i| Record::new(positions[i], normals[i], radii[i], birth, levels[i]))
    }
}

/// The caller's clock in single precision, relative to the first finite time that was read.
#[derive(Default)]
struct Clock {
    epoch_s: Option<f64>,
}

/// Time from the epoch that replaces ±∞, in seconds. It is more than a day; single precision
/// resolves 8 ms there.
const INFINITE_TIME_S: f64 = 1e5;

impl Clock {
    /// Time on this clock. NaN counts as −∞.
    fn read(&mut self, time_s: f64) -> f32 {
        if !time_s.is_finite() {
            return (if time_s > 0.0 { INFINITE_TIME_S } else { -INFINITE_TIME_S }) as f32;
        }
        let epoch_s = *self.epoch_s.get_or_insert(time_s);
        (time_s - epoch_s).clamp(-INFINITE_TIME_S, INFINITE_TIME_S) as f32
    }
}

/// Draws particles on a surface, as discs or as the faces between them. Once the device is lost,
/// its methods do nothing.
pub struct Renderer {
    pub(super) gpu: Gpu,
    painter: Painter,
    content: Content,
    /// Buffers in which records are packed before they are uploaded.
    scratch: Vec<Record>,
    face_scratch: Vec<FaceRecord>,
    /// Size of the target in pixels, for which the camera is set.
    pub(super) size: [u32; 2],
    view: View,
    style: Style,
    clock: Clock,
}

impl Renderer {
    /// A renderer for textures of `format`, which must be an sRGB format so that blending is
    /// linear.
    pub(super) fn new(gpu: Gpu, format: wgpu::TextureFormat) -> Self {
        let painter = Painter::new(&gpu.device, format);
        let content = Content {
            particles: Store::new(PARTICLE),
            body: 0,
            faces: Store::new(FACE),
            face_particles: 0,
            lines: Store::new(PIECE),
        };
        Self {
            gpu,
            painter,
            content,
            scratch: Vec::new(),
            face_scratch: Vec::new(),
            size: [0, 0],
            view: View::default(),
            style: Style::default(),
            clock: Clock::default(),
        }
    }

    /// Name of the back end: "webgpu", "webgl2" or a native one.
    #[must_use]
    pub fn backend(&self) -> &'static str {
        self.gpu.backend()
    }

    /// Name of the graphics adapter. It may be empty, because browsers hide it.
    #[must_use]
    pub fn adapter(&self) -> &str {
        self.gpu.adapter()
    }

    /// Whether the device is lost.
    #[must_use]
    pub fn is_lost(&self) -> bool {
        self.gpu.is_lost()
    }

    /// Records the loss of the device when a WebGL context is lost, which wgpu does not report.
    pub fn mark_lost(&self, reason: &str, message: &str) {
        self.gpu.mark_lost(reason, message);
    }

    /// Sets the size of the target in pixels. Returns the size in effect.
    ///
    /// A size beyond the largest texture is reduced in proportion. If a side is 0, nothing is drawn
    /// until the next resize.
    pub fn resize(&mut self, size: [u32; 2]) -> [u32; 2] {
        self.size = self.fit(size);
        self.size
    }

    /// Size of the picture that [`Renderer::picture`] makes for `size`: at least one pixel, and
    /// within the limits of textures and buffers.
    #[must_use]
    pub fn picture_size(&self, size: [u32; 2]) -> [u32; 2] {
        let mut size = self.fit(size.map(|side| side.max(1)));
        while u64::from(padded_row(size[0])) * u64::from(size[1]) > self.gpu.device.limits().max_buffer_size {
            size = size.map(|side| (side * 9 / 10).max(1));
        }
        size
    }

    /// `size`, reduced in proportion if it exceeds the largest texture.
    fn fit(&self, size: [u32; 2]) -> [u32; 2] {
        let largest = self.gpu.device.limits().max_texture_dimension_2d;
        let longest = size[0].max(size[1]);
        if longest <= largest {
            return size;
        }
        size.map(|side| {
            let scaled = u64::from(side) * u64::from(largest) / u64::from(longest);
            (scaled as u32).max(side.min(1))
        })
    }

    /// Writes particles `first..first + columns.radii.len()`, and increases the number of particles
    /// drawn to include them.
    ///
    /// `birth_s` is the time at which the particles begin to appear, in seconds on the pictures'
    /// clock; −∞ shows them at once.
    ///
    /// # Panics
    ///
    /// If a column is shorter than the radii, or the particles exceed [`MOST_RECORDS`].
    pub fn write(&mut self, first: u32, columns: Columns<'_>, birth_s: f64) {
        if self.is_lost() || columns.radii.is_empty() {
            return;
        }
        let end = first + columns.radii.len() as u32;
        let birth = self.clock.read(birth_s);
        let Self { gpu, content: Content { particles, .. }, scratch, .. } = self;
        scratch.clear();
        scratch.extend(columns.records(birth));
        particles.reserve(&gpu.device, &gpu.queue, end);
        particles.write(&gpu.queue, Part::Records, first, bytemuck::cast_slice(scratch));
        particles.count = particles.count.max(end);
        self.write_colours(first, columns.colours);
    }

    /// Writes the colours of particles from `first` on. Particles beyond the capacity of the
    /// buffers are skipped.
    pub fn write_colours(&mut self, first: u32, colours: &[u32]) {
        if !self.is_lost() && (first as usize + colours.len()) <= MOST_RECORDS as usize {
            let bytes = bytemuck::cast_slice(colours);
            self.content.particles.write(&self.gpu.queue, Part::Colours, first, bytes);
        }
    }

    /// Sets the number of particles that are drawn, and the number that make up the body; of the
    /// rest of the body only beds are drawn, faintly. The buffers keep their size.
    pub fn set_count(&mut self, count: u32, body: u32) {
        self.content.particles.count = count.min(MOST_RECORDS);
        self.content.body = body.min(MOST_RECORDS);
    }

    /// Writes faces from `first` on. Each takes three entries of the columns, counter-clockwise
    /// seen from outside. `marks` has the colour of the mark on each corner, 0 for none.
    ///
    /// # Panics
    ///
    /// If a column is shorter than the radii, or the faces exceed [`MOST_RECORDS`].
    pub fn write_faces(&mut self, first: u32, corners: Columns<'_>, marks: &[u32]) {
        let count = (corners.radii.len() / 3) as u32;
        if self.is_lost() || count == 0 {
            return;
        }
        let Self { gpu, content: Content { faces, .. }, scratch, face_scratch, .. } = self;
        scratch.clear();
        scratch.extend(corners.records(0.0));
        face_scratch.clear();
        face_scratch.extend(scratch.as_chunks::<3>().0.iter().map(|&corners| FaceRecord::new(corners)));
        faces.reserve(&gpu.device, &gpu.queue, first + count);
        faces.write(&gpu.queue, Part::Records, first, bytemuck::cast_slice(face_scratch));
        self.tint_faces(first, corners.colours, marks);
    }

    /// Writes the colours of faces from `first` on and of their marks, three each. Faces beyond the
    /// capacity of the buffers are skipped.
    pub fn tint_faces(&mut self, first: u32, colours: &[u32], marks: &[u32]) {
        if self.is_lost() || (first as usize + colours.len() / 3) > MOST_RECORDS as usize {
            return;
        }
        let (colours, marks) = (colours.as_chunks::<3>().0, marks.as_chunks::<3>().0);
        let tints: Vec<FaceTint> =
            colours.iter().zip(marks).map(|(&colours, &marks)| FaceTint { colours, marks }).collect();
        self.content.faces.write(&self.gpu.queue, Part::Colours, first, bytemuck::cast_slice(&tints));
    }

    /// Sets the number of faces, and the number of particles that faces replace. Without faces
    /// their buffers are released.
    pub fn set_faces(&mut self, count: u32, particles: u32) {
        let Content { faces, face_particles, .. } = &mut self.content;
        (faces.count, *face_particles) = (count.min(MOST_RECORDS), particles);
        if count == 0 {
            faces.release();
            self.face_scratch = Vec::new();
        }
    }

    /// Replaces the crease segments. Each has eight numbers, the position of both ends with the
    /// radius of the particle there, and a colour, sRGB as 0xAABBGGRR.
    ///
    /// # Panics
    ///
    /// If the columns differ in length or there are more than [`MOST_RECORDS`].
    pub fn write_lines(&mut self, ends: &[f32], colours: &[u32]) {
        assert_eq!(ends.len(), 8 * colours.len(), "numbers of ends, for as many colours times 8");
        if self.is_lost() {
            return;
        }
        let (gpu, lines) = (&self.gpu, &mut self.content.lines);
        lines.count = colours.len() as u32;
        lines.reserve(&gpu.device, &gpu.queue, lines.count);
        lines.write(&gpu.queue, Part::Records, 0, bytemuck::cast_slice(ends));
        lines.write(&gpu.queue, Part::Colours, 0, bytemuck::cast_slice(colours));
    }

    /// Sets the camera, which must be made for the current size of the target.
    pub fn set_view(&mut self, view: View) {
        self.view = view;
    }

    /// Sets the style.
    pub fn set_style(&mut self, style: Style) {
        self.style = style;
    }

    /// Draws on `canvas`. `time_s` is the current time on the caller's clock, in seconds.
    pub(super) fn draw_on(&mut self, canvas: &Canvas<'_>, time_s: f64) {
        let frame = self.frame(canvas.size, time_s);
        self.paint(canvas, frame, false);
    }

    /// Draws into a texture of [`Renderer::picture_size`] and begins to copy it to memory, which
    /// [`Picture::map`] makes readable.
    ///
    /// If the picture's aspect ratio differs from the canvas's, it shows more at the sides, or at
    /// top and bottom. Returns `None` if the device is lost.
    pub fn picture(&mut self, size: [u32; 2], transparent: bool, time_s: f64) -> Option<Picture> {
        if self.is_lost() {
            return None;
        }
        let size = self.picture_size(size);
        let extent = wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 };
        let texture = self.gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("picture"),
            size: extent,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: self.painter.format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let frame = self.frame(size, time_s);
        self.paint(&Canvas { view: &view, copied: None, size, keep: false }, frame, transparent);
        let buffer = self.gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("picture"),
            size: u64::from(padded_row(size[0])) * u64::from(size[1]),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(padded_row(size[0])),
                    rows_per_image: Some(size[1]),
                },
            },
            extent,
        );
        self.gpu.queue.submit([encoder.finish()]);
        let bgra = matches!(
            self.painter.format,
            wgpu::TextureFormat::Bgra8UnormSrgb | wgpu::TextureFormat::Bgra8Unorm
        );
        Some(Picture { buffer, size, bgra, transparent })
    }

    /// Runs the callbacks of finished work, for back ends that need it (WebGL2).
    pub fn poll(&self) {
        // An error means that the device is lost, which its callback reports.
        let _ = self.gpu.device.poll(wgpu::PollType::Poll);
    }

    /// Releases the device and its memory.
    pub fn destroy(&self) {
        self.mark_lost("destroyed", "the renderer was destroyed");
        self.gpu.device.destroy();
    }

    fn frame(&mut self, size: [u32; 2], time_s: f64) -> Frame {
        let time = self.clock.read(time_s);
        self.style.frame(&self.view, PictureTarget { canvas: self.size, size, time })
    }

    fn paint(&mut self, canvas: &Canvas<'_>, frame: Frame, transparent: bool) {
        let Self { gpu, painter, content, style, .. } = self;
        let scene = Scene { content, style, frame, transparent };
        painter.paint(&gpu.device, &gpu.queue, canvas, &scene);
    }
}

/// A picture whose pixels are being copied to readable memory.
pub struct Picture {
    buffer: wgpu::Buffer,
    size: [u32; 2],
    bgra: bool,
    transparent: bool,
}

impl Picture {
    /// Requests the pixels. `done` is called with `true` once [`Picture::pixels`] can be called, or
    /// with `false` after a failure.
    pub fn map(&self, done: impl FnOnce(bool) + Send + 'static) {
        self.buffer.map_async(wgpu::MapMode::Read, .., move |result| done(result.is_ok()));
    }

    /// Pixels in rows from top to bottom, four bytes each: sRGB red, green, blue and straight
    /// opacity. `None` before [`Picture::map`] has succeeded.
    #[must_use]
    pub fn pixels(&self) -> Option<Vec<u8>> {
        let [width, height] = self.size;
        let view = self.buffer.get_mapped_range(..).ok()?;
        Some(straight_rgba(&view, width, height, self.bgra, !self.transparent))
    }
}
