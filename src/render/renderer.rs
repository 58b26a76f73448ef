//! Renderer: a graphics device with a surface to draw on and the particles to draw.

use super::layout::Frame;
use super::painter::{Painter, Scene};
use super::pixels::{padded_row, straight_rgba};
use super::store::{Columns, Store};
use super::style::{Style, Target};
use super::view::View;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use thiserror::Error;

/// Called when the device is lost, with the reason ("unknown" or "destroyed") and the driver's message.
pub type OnLost = Arc<dyn Fn(&str, &str) + Send + Sync>;
/// Called with the device's message when it rejects a call.
pub type OnError = Arc<dyn Fn(&str) + Send + Sync>;

/// Callbacks for asynchronous reports of the graphics device.
#[derive(Clone)]
pub struct Callbacks {
    /// Called when the device is lost, at most once.
    pub on_lost: OnLost,
    /// Called when the device rejects a call. The picture may then be incomplete.
    pub on_error: OnError,
}

/// Why no renderer could be created.
#[derive(Debug, Error)]
pub enum CreateError {
    /// The canvas gives no graphics context: none is supported, or the canvas already has one of another kind.
    #[error("the canvas gives no graphics context: {0}")]
    Surface(#[from] wgpu::CreateSurfaceError),
    /// There is no graphics adapter.
    #[error("no graphics adapter: {0}")]
    Adapter(#[from] wgpu::RequestAdapterError),
    /// The adapter provides no device.
    #[error("no graphics device: {0}")]
    Device(#[from] wgpu::RequestDeviceError),
    /// The adapter cannot draw on this surface in 8-bit sRGB.
    #[error("the adapter cannot draw on the canvas")]
    Format,
}

/// Outcome of [`Renderer::draw`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The picture was submitted and will be shown.
    Drawn,
    /// The surface cannot be drawn on now, because it is empty, hidden or busy. Draw again when something changes.
    Skipped,
    /// The device is lost. A new renderer is needed.
    Lost,
}

/// A picture whose pixels are being copied to memory that can be read.
pub struct Picture {
    buffer: wgpu::Buffer,
    size: [u32; 2],
    bgra: bool,
    transparent: bool,
}

/// Draws particles as discs on a surface. After the device is lost, its methods do nothing.
pub struct Renderer {
    device: wgpu::Device,
    queue: wgpu::Queue,
    info: wgpu::AdapterInfo,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    /// sRGB format through which the surface is drawn, so that blending is linear.
    view_format: wgpu::TextureFormat,
    /// Size of the canvas in pixels. Nothing is drawn while a side is zero.
    size: [u32; 2],
    configured: bool,
    lost: Arc<AtomicBool>,
    callbacks: Callbacks,
    painter: Painter,
    store: Store,
    /// Number of particles that are drawn.
    count: u32,
    view: View,
    style: Style,
    /// Time on the caller's clock at which the renderer's clock is zero, in seconds. Single precision suffices for
    /// times relative to it.
    epoch_s: Option<f64>,
}

/// Time from the epoch that stands for ±∞, in seconds. It is more than a day and has a resolution of 8 ms.
const INFINITE_TIME_S: f64 = 1e5;

impl Renderer {
    /// Largest number of particles that [`Renderer::write`] takes.
    pub const MAX_PARTICLES: u32 = Store::MAX;

    /// Opens a device that can draw on `surface_target`.
    ///
    /// # Errors
    ///
    /// [`CreateError`] if a surface, an adapter or a device is not available.
    pub async fn new(
        surface_target: impl Into<wgpu::SurfaceTarget<'static>>,
        callbacks: Callbacks,
    ) -> Result<Self, CreateError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let surface = instance.create_surface(surface_target)?;
        let adapter = instance
            .request_adapter(&wgpu::RequestAdapterOptions {
                power_preference: wgpu::PowerPreference::HighPerformance,
                compatible_surface: Some(&surface),
                ..wgpu::RequestAdapterOptions::default()
            })
            .await?;
        let info = adapter.get_info();
        let (device, queue) = adapter
            .request_device(&wgpu::DeviceDescriptor {
                label: Some("particles"),
                required_limits: wgpu::Limits::downlevel_webgl2_defaults().using_resolution(adapter.limits()),
                ..wgpu::DeviceDescriptor::default()
            })
            .await?;

        let lost = Arc::new(AtomicBool::new(false));
        device.set_device_lost_callback({
            let (lost, on_lost) = (Arc::clone(&lost), Arc::clone(&callbacks.on_lost));
            move |reason, message| {
                let reason = match reason {
                    wgpu::DeviceLostReason::Destroyed => "destroyed",
                    wgpu::DeviceLostReason::Unknown => "unknown",
                };
                if !lost.swap(true, Ordering::Relaxed) {
                    on_lost(reason, &message);
                }
            }
        });
        device.on_uncaptured_error({
            let on_error = Arc::clone(&callbacks.on_error);
            Arc::new(move |error: wgpu::Error| on_error(&error.to_string()))
        });

        let mut config = surface.get_default_config(&adapter, 1, 1).ok_or(CreateError::Format)?;
        let formats = surface.get_capabilities(&adapter).formats;
        let downlevel = adapter.get_downlevel_capabilities();
        let view_format = if downlevel.flags.contains(wgpu::DownlevelFlags::SURFACE_VIEW_FORMATS) {
            let view_format = config.format.add_srgb_suffix();
            config.view_formats = vec![view_format];
            view_format
        } else {
            config.format =
                formats.into_iter().find(wgpu::TextureFormat::is_srgb).ok_or(CreateError::Format)?;
            config.format
        };
        if !view_format.is_srgb() {
            return Err(CreateError::Format);
        }
        let painter = Painter::new(&device, view_format);
        Ok(Self {
            device,
            queue,
            info,
            surface,
            config,
            view_format,
            size: [0, 0],
            configured: false,
            lost,
            callbacks,
            painter,
            store: Store::default(),
            count: 0,
            view: View::default(),
            style: Style::default(),
            epoch_s: None,
        })
    }

    /// Name of the back end: "webgpu", "webgl2", or that of a native one.
    #[must_use]
    pub fn backend(&self) -> &'static str {
        match self.info.backend {
            wgpu::Backend::BrowserWebGpu => "webgpu",
            wgpu::Backend::Gl if cfg!(target_arch = "wasm32") => "webgl2",
            other => other.to_str(),
        }
    }

    /// Name of the graphics adapter. It may be empty, because browsers hide it.
    #[must_use]
    pub fn adapter(&self) -> &str {
        [&self.info.name, &self.info.driver, &self.info.driver_info]
            .into_iter()
            .find(|words| !words.is_empty())
            .map_or("", String::as_str)
    }

    /// Whether the device is lost.
    #[must_use]
    pub fn is_lost(&self) -> bool {
        self.lost.load(Ordering::Relaxed)
    }

    /// Records the loss of the device, for a lost WebGL context, which wgpu does not report.
    pub fn mark_lost(&self, reason: &str, message: &str) {
        if !self.lost.swap(true, Ordering::Relaxed) {
            (self.callbacks.on_lost)(reason, message);
        }
    }

    /// Sets the size of the surface in pixels and returns the size in effect.
    ///
    /// A size beyond the largest texture is scaled down in proportion. If a side is 0, nothing is drawn until the next
    /// resize.
    pub fn resize(&mut self, size: [u32; 2]) -> [u32; 2] {
        let size = self.fit(size);
        if size != self.size {
            self.size = size;
            self.configured = false;
        }
        size
    }

    /// Size of the picture that [`Renderer::picture`] makes for `size`: at least one pixel, and within the limits of
    /// textures and buffers.
    #[must_use]
    pub fn picture_size(&self, size: [u32; 2]) -> [u32; 2] {
        let mut size = self.fit(size.map(|side| side.max(1)));
        while u64::from(padded_row(size[0])) * u64::from(size[1]) > self.device.limits().max_buffer_size {
            size = size.map(|side| (side * 9 / 10).max(1));
        }
        size
    }

    /// `size`, scaled down in proportion to the largest texture if it is larger.
    fn fit(&self, size: [u32; 2]) -> [u32; 2] {
        let largest = self.device.limits().max_texture_dimension_2d;
        let longest = size[0].max(size[1]);
        if longest <= largest {
            return size;
        }
        size.map(|side| {
            let scaled = u64::from(side) * u64::from(largest) / u64::from(longest);
            (scaled as u32).max(side.min(1))
        })
    }

    /// Writes particles `first..first + radii.len()`. The number of particles drawn increases to include them.
    ///
    /// Positions and normals have three numbers per particle, colours are sRGB as 0xAABBGGRR. `birth_s` is the time at
    /// which the particles begin to appear, in seconds on the clock of [`Renderer::draw`]; −∞ shows them at once.
    ///
    /// # Panics
    ///
    /// If the columns differ in length or end beyond [`Renderer::MAX_PARTICLES`].
    #[allow(clippy::too_many_arguments, reason = "one argument per column")]
    pub fn write(
        &mut self,
        first: u32,
        positions: &[f32],
        normals: &[f32],
        radii: &[f32],
        levels: &[u32],
        colours: &[u32],
        birth_s: f64,
    ) {
        if self.is_lost() || radii.is_empty() {
            return;
        }
        let end = first as usize + radii.len();
        assert!(end <= Self::MAX_PARTICLES as usize, "particle {end} of at most {}", Self::MAX_PARTICLES);
        let birth = self.clock(birth_s);
        let columns = Columns { positions, normals, radii, levels, colours, birth };
        self.store.write(&self.device, &self.queue, first, columns);
        self.count = self.count.max(end as u32);
    }

    /// Writes the colours of particles from `first` on. Particles beyond the capacity of the buffers are skipped.
    pub fn write_colours(&mut self, first: u32, colours: &[u32]) {
        if !self.is_lost() && (first as usize + colours.len()) <= Self::MAX_PARTICLES as usize {
            self.store.write_colours(&self.queue, first, colours);
        }
    }

    /// Sets the number of particles that are drawn. The buffers keep their size.
    pub fn set_count(&mut self, count: u32) {
        self.count = count.min(Self::MAX_PARTICLES);
    }

    /// Sets the camera, which must be made for the current size of the surface.
    pub fn set_view(&mut self, view: View) {
        self.view = view;
    }

    /// Sets the style.
    pub fn set_style(&mut self, style: Style) {
        self.style = style;
    }

    /// Draws on the surface. `time_s` is the current time on the caller's clock, in seconds.
    pub fn draw(&mut self, time_s: f64) -> Outcome {
        if self.is_lost() {
            return Outcome::Lost;
        }
        if self.size.contains(&0) {
            return Outcome::Skipped;
        }
        if !self.configured {
            self.configure();
        }
        let texture = match self.surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(texture) => texture,
            wgpu::CurrentSurfaceTexture::Suboptimal(texture) => {
                self.configured = false;
                texture
            }
            wgpu::CurrentSurfaceTexture::Outdated | wgpu::CurrentSurfaceTexture::Lost => {
                // Try once more with a fresh configuration. After a second failure the next call tries again.
                self.configure();
                match self.surface.get_current_texture() {
                    wgpu::CurrentSurfaceTexture::Success(texture)
                    | wgpu::CurrentSurfaceTexture::Suboptimal(texture) => texture,
                    _ => return self.skipped(),
                }
            }
            _ => return self.skipped(),
        };
        let view = texture.texture.create_view(&wgpu::TextureViewDescriptor {
            format: Some(self.view_format),
            ..wgpu::TextureViewDescriptor::default()
        });
        let frame = self.frame(self.size, time_s);
        let size = self.size;
        self.paint(&view, size, frame, true, false);
        self.queue.present(texture);
        if self.is_lost() { Outcome::Lost } else { Outcome::Drawn }
    }

    /// Draws into a texture of [`Renderer::picture_size`] and begins to copy it to memory that [`Picture::map`] makes
    /// readable.
    ///
    /// A picture with another aspect ratio than the surface shows more at the sides, or at top and bottom. Returns
    /// `None` if the device is lost.
    pub fn picture(&mut self, size: [u32; 2], transparent: bool, time_s: f64) -> Option<Picture> {
        if self.is_lost() {
            return None;
        }
        let size = self.picture_size(size);
        let extent = wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 };
        let texture = self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("picture"),
            size: extent,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: self.view_format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let frame = self.frame(size, time_s);
        self.paint(&view, size, frame, false, transparent);
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("picture"),
            size: u64::from(padded_row(size[0])) * u64::from(size[1]),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
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
        self.queue.submit([encoder.finish()]);
        let bgra =
            matches!(self.view_format, wgpu::TextureFormat::Bgra8UnormSrgb | wgpu::TextureFormat::Bgra8Unorm);
        Some(Picture { buffer, size, bgra, transparent })
    }

    /// Runs the callbacks of finished work, for back ends that need it (WebGL2).
    pub fn poll(&self) {
        // An error means that the device is lost, which its callback reports.
        let _ = self.device.poll(wgpu::PollType::Poll);
    }

    /// Releases the device and its memory.
    pub fn destroy(&self) {
        self.mark_lost("destroyed", "the renderer was destroyed");
        self.device.destroy();
    }

    fn configure(&mut self) {
        [self.config.width, self.config.height] = self.size;
        self.surface.configure(&self.device, &self.config);
        self.painter.forget_depth();
        self.configured = true;
    }

    fn skipped(&self) -> Outcome {
        if self.is_lost() { Outcome::Lost } else { Outcome::Skipped }
    }

    fn frame(&mut self, size: [u32; 2], time_s: f64) -> Frame {
        let time = self.clock(time_s);
        self.style.frame(&self.view, Target { canvas: self.size, size, time })
    }

    fn paint(
        &mut self,
        view: &wgpu::TextureView,
        size: [u32; 2],
        frame: Frame,
        keep: bool,
        transparent: bool,
    ) {
        let scene = Scene {
            store: &self.store,
            count: self.count,
            outline: self.style.outline,
            clip_box: self.style.clip_box.is_some(),
            frame,
            transparent,
        };
        self.painter.paint(&self.device, &self.queue, view, size, keep, &scene);
    }

    /// Time on the renderer's clock, which is zero at the first finite time that is converted. NaN counts as −∞.
    fn clock(&mut self, time_s: f64) -> f32 {
        if !time_s.is_finite() {
            return (if time_s > 0.0 { INFINITE_TIME_S } else { -INFINITE_TIME_S }) as f32;
        }
        let epoch_s = *self.epoch_s.get_or_insert(time_s);
        (time_s - epoch_s).clamp(-INFINITE_TIME_S, INFINITE_TIME_S) as f32
    }
}

impl Picture {
    /// Requests the pixels. `done` is called with `true` when [`Picture::pixels`] can be called, or with `false` if it
    /// failed.
    pub fn map(&self, done: impl FnOnce(bool) + Send + 'static) {
        self.buffer.map_async(wgpu::MapMode::Read, .., move |result| done(result.is_ok()));
    }

    /// Pixels in rows from top to bottom, four bytes each: sRGB red, green, blue and straight opacity. `None` before
    /// [`Picture::map`] has succeeded.
    #[must_use]
    pub fn pixels(&self) -> Option<Vec<u8>> {
        let [width, height] = self.size;
        let view = self.buffer.get_mapped_range(..).ok()?;
        Some(straight_rgba(&view, width, height, self.bgra, !self.transparent))
    }
}
