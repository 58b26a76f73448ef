//! A canvas of the page, on which pictures are shown.

use super::gpu::{Callbacks, CreateError, Gpu};
use super::painter::Canvas;
use super::renderer::Renderer;

/// Result of [`Screen::draw`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrawOutcome {
    /// The picture was submitted and will be shown.
    Drawn,
    /// The surface cannot be drawn on now, because it is empty, hidden or busy. Draw again after
    /// the next change.
    Skipped,
    /// The device is lost. A new renderer is needed.
    Lost,
}

/// A surface with its configuration.
pub struct Screen {
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    /// sRGB format through which the surface is drawn, so that blending is linear.
    view_format: wgpu::TextureFormat,
    configured: bool,
}

impl Screen {
    /// Opens a device that can draw on `surface_target`. Returns the screen and its renderer.
    ///
    /// # Errors
    ///
    /// [`CreateError`] if a surface, an adapter, a device or an sRGB format is not available.
    pub async fn open(
        surface_target: impl Into<wgpu::SurfaceTarget<'static>>,
        callbacks: Callbacks,
    ) -> Result<(Self, Renderer), CreateError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let surface = instance.create_surface(surface_target)?;
        let (gpu, adapter) =
            Gpu::open(&instance, Some(&surface), |_| wgpu::Features::empty(), callbacks).await?;
        let screen = Self::new(surface, &adapter)?;
        let renderer = Renderer::new(gpu, screen.view_format);
        Ok((screen, renderer))
    }

    /// A surface for `adapter`.
    fn new(surface: wgpu::Surface<'static>, adapter: &wgpu::Adapter) -> Result<Self, CreateError> {
        let mut config = surface.get_default_config(adapter, 1, 1).ok_or(CreateError::Format)?;
        let capabilities = surface.get_capabilities(adapter);
        let downlevel = adapter.get_downlevel_capabilities();
        let view_format = if downlevel.flags.contains(wgpu::DownlevelFlags::SURFACE_VIEW_FORMATS) {
            let view_format = config.format.add_srgb_suffix();
            config.view_formats = vec![view_format];
            // Every WebGPU canvas can be a copy target, although wgpu lists it only as a render
            // target.
            if adapter.get_info().backend == wgpu::Backend::BrowserWebGpu {
                config.usage |= wgpu::TextureUsages::COPY_DST;
            }
            view_format
        } else {
            config.format = capabilities
                .formats
                .into_iter()
                .find(wgpu::TextureFormat::is_srgb)
                .ok_or(CreateError::Format)?;
            config.format
        };
        if !view_format.is_srgb() {
            return Err(CreateError::Format);
        }
        Ok(Self { surface, config, view_format, configured: false })
    }

    /// Draws a picture and shows it. `time_s` is the current time on the caller's clock, in
    /// seconds.
    pub fn draw(&mut self, renderer: &mut Renderer, time_s: f64) -> DrawOutcome {
        let outcome = |renderer: &Renderer, or| if renderer.is_lost() { DrawOutcome::Lost } else { or };
        let size = renderer.size;
        if renderer.is_lost() || size.contains(&0) {
            return outcome(renderer, DrawOutcome::Skipped);
        }
        let Some(texture) = self.next(&renderer.gpu.device, size) else {
            return outcome(renderer, DrawOutcome::Skipped);
        };
        let canvas = Canvas { view: &self.view(&texture), copied: self.copied(&texture), size, keep: true };
        renderer.draw_on(&canvas, time_s);
        renderer.gpu.queue.present(texture);
        outcome(renderer, DrawOutcome::Drawn)
    }

    /// The texture of the next picture; `None` if it is not available now.
    fn next(&mut self, device: &wgpu::Device, size: [u32; 2]) -> Option<wgpu::SurfaceTexture> {
        if !self.configured || size != [self.config.width, self.config.height] {
            self.configure(device, size);
        }
        match self.surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(texture) => Some(texture),
            wgpu::CurrentSurfaceTexture::Suboptimal(texture) => {
                self.configured = false;
                Some(texture)
            }
            wgpu::CurrentSurfaceTexture::Outdated | wgpu::CurrentSurfaceTexture::Lost => {
                // Try once more with a fresh configuration. After a second failure the next call
                // tries again.
                self.configure(device, size);
                match self.surface.get_current_texture() {
                    wgpu::CurrentSurfaceTexture::Success(texture)
                    | wgpu::CurrentSurfaceTexture::Suboptimal(texture) => Some(texture),
                    _ => None,
                }
            }
            _ => None,
        }
    }

    /// The view through which a texture of this surface is drawn.
    fn view(&self, texture: &wgpu::SurfaceTexture) -> wgpu::TextureView {
        texture.texture.create_view(&wgpu::TextureViewDescriptor {
            format: Some(self.view_format),
            ..wgpu::TextureViewDescriptor::default()
        })
    }

    /// The texture, if samples must be copied to it instead of resolved to its view. If the view
    /// has another format, a driver may resolve in the texture's format and make the picture too
    /// dark (seen in Chromium 156 with SwiftShader's WebGPU).
    fn copied<'a>(&self, texture: &'a wgpu::SurfaceTexture) -> Option<&'a wgpu::Texture> {
        let can_copy = self.config.usage.contains(wgpu::TextureUsages::COPY_DST);
        (can_copy && self.view_format != self.config.format).then_some(&texture.texture)
    }

    fn configure(&mut self, device: &wgpu::Device, size: [u32; 2]) {
        [self.config.width, self.config.height] = size;
        self.surface.configure(device, &self.config);
        self.configured = true;
    }
}
