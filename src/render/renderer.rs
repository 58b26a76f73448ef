//! A device, a surface to draw on and the particles in between.

use super::layout::Frame;
use super::painter::{Painter, Scene};
use super::pixels::{padded_row, straight_rgba};
use super::store::{Columns, Store};
use super::style::{Style, Target};
use super::view::View;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use thiserror::Error;

/// Called when the device is gone: the reason ("unknown" or "destroyed") and the driver's words.
pub type OnLost = Arc<dyn Fn(&str, &str) + Send + Sync>;
/// Called with what the device says when it refuses a call.
pub type OnError = Arc<dyn Fn(&str) + Send + Sync>;

/// Whom to tell what the graphics device reports between calls.
#[derive(Clone)]
pub struct Callbacks {
    /// The device is gone. Called once at most.
    pub on_lost: OnLost,
    /// A call was refused by the device; the picture may be incomplete.
    pub on_error: OnError,
}

/// Why there is no renderer.
#[derive(Debug, Error)]
pub enum CreateError {
    /// The canvas gives no context of this kind: unsupported, or taken by another kind.
    #[error("the canvas gives no graphics context: {0}")]
    Surface(#[from] wgpu::CreateSurfaceError),
    /// No graphics adapter.
    #[error("no graphics adapter: {0}")]
    Adapter(#[from] wgpu::RequestAdapterError),
    /// The adapter gives no device.
    #[error("no graphics device: {0}")]
    Device(#[from] wgpu::RequestDeviceError),
    /// The adapter cannot draw on this surface in 8-bit sRGB.
    #[error("the adapter cannot draw on the canvas")]
    Format,
}

/// What became of one call to draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The picture is on its way to the screen.
    Drawn,
    /// Nothing to draw on now: size zero, hidden, or busy. Draw again when something changes.
    Skipped,
    /// The device is gone; only a new renderer helps.
    Lost,
}

/// A picture that the device is copying to where it can be read.
pub struct Picture {
    buffer: wgpu::Buffer,
    size: [u32; 2],
    bgra: bool,
    transparent: bool,
}

/// Draws particles on a surface.
pub struct Renderer {
    device: wgpu::Device,
    queue: wgpu::Queue,
    info: wgpu::AdapterInfo,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    /// Format through which the surface is drawn: sRGB, so that blending happens in linear light.
    view_format: wgpu::TextureFormat,
    /// Size of the canvas; nothing is drawn while a side is zero.
    size: [u32; 2],
    configured: bool,
    lost: Arc<AtomicBool>,
    callbacks: Callbacks,
    painter: Painter,
    store: Store,
    count: u32,
    view: View,
    style: Style,
    /// Second of the caller's clock at which the renderer's clock is zero, so that single precision suffices.
    epoch_s: Option<f64>,
}

/// Times this many seconds from the epoch stand for ±∞: a day and more, at a resolution of 8 ms.
const LONG_AGO_S: f64 = 1e5;

impl Renderer {
    /// Largest number of particles that [`Renderer::write`] takes.
    pub const MAX_PARTICLES: u32 = Store::MAX;

    /// Opens a device that can draw on `surface_target`.
    ///
    /// # Errors
    ///
    /// [`CreateError`] where the surface, the adapter or the device cannot be had.
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

    /// "webgpu", "webgl2", or the native back end's name.
    #[must_use]
    pub fn backend(&self) -> &'static str {
        match self.info.backend {
            wgpu::Backend::BrowserWebGpu => "webgpu",
            wgpu::Backend::Gl if cfg!(target_arch = "wasm32") => "webgl2",
            other => other.to_str(),
        }
    }

    /// What the driver calls the graphics adapter; may be empty, since browsers hide it.
    #[must_use]
    pub fn adapter(&self) -> &str {
        [&self.info.name, &self.info.driver, &self.info.driver_info]
            .into_iter()
            .find(|words| !words.is_empty())
            .map_or("", String::as_str)
    }

    /// Whether the device is gone.
    #[must_use]
    pub fn is_lost(&self) -> bool {
        self.lost.load(Ordering::Relaxed)
    }

    /// Says that the device is gone, where wgpu cannot know: a lost WebGL context. Later calls do nothing.
    pub fn mark_lost(&self, reason: &str, message: &str) {
        if !self.lost.swap(true, Ordering::Relaxed) {
            (self.callbacks.on_lost)(reason, message);
        }
    }

    /// Sets the size of the surface in pixels and returns the size taken: beyond the largest texture it shrinks in
    /// proportion. Where a side is 0 nothing is drawn until the next resize.
    pub fn resize(&mut self, size: [u32; 2]) -> [u32; 2] {
        let size = self.fit(size);
        if size != self.size {
            self.size = size;
            self.configured = false;
        }
        size
    }

    /// The size that [`Renderer::picture`] takes for `size`: at least one pixel, within the largest texture and the largest buffer.
    #[must_use]
    pub fn picture_size(&self, size: [u32; 2]) -> [u32; 2] {
        let mut size = self.fit(size.map(|side| side.max(1)));
        while u64::from(padded_row(size[0])) * u64::from(size[1]) > self.device.limits().max_buffer_size {
            size = size.map(|side| (side * 9 / 10).max(1));
        }
        size
    }

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

    /// Appends or overwrites particles `first..first + radii.len()`; the number drawn grows to their end.
    ///
    /// Positions and normals have three numbers per particle. Colours are 0xAABBGGRR, sRGB. `birth_s` is the second on
    /// the caller's clock (that of [`Renderer::draw`]) at which they begin to appear; −∞ shows them at once.
    ///
    /// # Panics
    ///
    /// If the columns disagree in length or end beyond [`Renderer::MAX_PARTICLES`].
    #[allow(clippy::too_many_arguments, reason = "one column each; a struct would only be taken apart again")]
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

    /// Changes the colours of particles from `first` on; those never written are left out.
    pub fn write_colours(&mut self, first: u32, colours: &[u32]) {
        if !self.is_lost() && (first as usize + colours.len()) <= Self::MAX_PARTICLES as usize {
            self.store.write_colours(&self.queue, first, colours);
        }
    }

    /// Draws particles `0..count` from now on. Buffers keep their size.
    pub fn set_count(&mut self, count: u32) {
        self.count = count.min(Self::MAX_PARTICLES);
    }

    /// Sets the camera, made for the present size of the surface.
    pub fn set_view(&mut self, view: View) {
        self.view = view;
    }

    /// Sets the look.
    pub fn set_style(&mut self, style: Style) {
        self.style = style;
    }

    /// Draws on the surface. `time_s` is now on the caller's clock.
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
                // Once more with a fresh configuration; a second failure waits for the next call.
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

    /// Draws the same picture into a texture of [`Renderer::picture_size`] and has it copied to where it can be read. With another shape than the
    /// surface's, the picture shows more at the sides or at top and bottom. `None` where the device is gone.
    ///
    /// [`Picture::map`] asks for the pixels.
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

    /// Lets callbacks of finished work run, where the back end needs it (WebGL2).
    pub fn poll(&self) {
        // An error here means that the device is gone, which its own callback tells.
        let _ = self.device.poll(wgpu::PollType::Poll);
    }

    /// Gives the device and its memory back. Later calls do nothing.
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

    /// The caller's second on the renderer's own clock, which starts at the first finite second seen. NaN is long ago.
    fn clock(&mut self, time_s: f64) -> f32 {
        if !time_s.is_finite() {
            return (if time_s > 0.0 { LONG_AGO_S } else { -LONG_AGO_S }) as f32;
        }
        let epoch_s = *self.epoch_s.get_or_insert(time_s);
        (time_s - epoch_s).clamp(-LONG_AGO_S, LONG_AGO_S) as f32
    }
}

impl Picture {
    /// Asks for the pixels; `done` is called when [`Picture::pixels`] may be, or with `false` when they will never come.
    pub fn map(&self, done: impl FnOnce(bool) + Send + 'static) {
        self.buffer.map_async(wgpu::MapMode::Read, .., move |result| done(result.is_ok()));
    }

    /// The pixels: rows from top to bottom, four bytes each, red first, sRGB, opacity not multiplied in. `None` before [`Picture::map`] is done.
    #[must_use]
    pub fn pixels(&self) -> Option<Vec<u8>> {
        let [width, height] = self.size;
        let view = self.buffer.get_mapped_range(..).ok()?;
        Some(straight_rgba(&view, width, height, self.bgra, !self.transparent))
    }
}
