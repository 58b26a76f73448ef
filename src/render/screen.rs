//! The surface that pictures are shown on.

use super::gpu::CreateError;

/// A surface with its configuration.
pub(super) struct Screen {
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    /// sRGB format through which the surface is drawn, so that blending is linear.
    pub(super) view_format: wgpu::TextureFormat,
    /// Size in pixels. Nothing is drawn while a side is zero.
    pub(super) size: [u32; 2],
    configured: bool,
}

impl Screen {
    /// A surface that `adapter` draws on.
    ///
    /// # Errors
    ///
    /// If there is no sRGB format for it.
    pub(super) fn new(surface: wgpu::Surface<'static>, adapter: &wgpu::Adapter) -> Result<Self, CreateError> {
        let mut config = surface.get_default_config(adapter, 1, 1).ok_or(CreateError::Format)?;
        let capabilities = surface.get_capabilities(adapter);
        let downlevel = adapter.get_downlevel_capabilities();
        let view_format = if downlevel.flags.contains(wgpu::DownlevelFlags::SURFACE_VIEW_FORMATS) {
            let view_format = config.format.add_srgb_suffix();
            config.view_formats = vec![view_format];
            // Every canvas of WebGPU can be copied to, although wgpu lists only that it can be drawn to.
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
        Ok(Self { surface, config, view_format, size: [0, 0], configured: false })
    }

    /// Sets the size; takes effect with the next picture.
    pub(super) fn resize(&mut self, size: [u32; 2]) {
        if size != self.size {
            self.size = size;
            self.configured = false;
        }
    }

    /// The texture of the next picture, and whether the surface has been configured anew for it; `None` if it cannot be had now.
    pub(super) fn next(&mut self, device: &wgpu::Device) -> (Option<wgpu::SurfaceTexture>, bool) {
        let was_configured = self.configured;
        if !was_configured {
            self.configure(device);
        }
        match self.surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(texture) => (Some(texture), !was_configured),
            wgpu::CurrentSurfaceTexture::Suboptimal(texture) => {
                self.configured = false;
                (Some(texture), !was_configured)
            }
            wgpu::CurrentSurfaceTexture::Outdated | wgpu::CurrentSurfaceTexture::Lost => {
                // Try once more with a fresh configuration. After a second failure the next call tries again.
                self.configure(device);
                match self.surface.get_current_texture() {
                    wgpu::CurrentSurfaceTexture::Success(texture)
                    | wgpu::CurrentSurfaceTexture::Suboptimal(texture) => (Some(texture), true),
                    _ => (None, true),
                }
            }
            _ => (None, !was_configured),
        }
    }

    /// The view through which a texture of this surface is drawn.
    pub(super) fn view(&self, texture: &wgpu::SurfaceTexture) -> wgpu::TextureView {
        texture.texture.create_view(&wgpu::TextureViewDescriptor {
            format: Some(self.view_format),
            ..wgpu::TextureViewDescriptor::default()
        })
    }

    /// The texture, if samples are not to be resolved to its view but copied to it: where the view has another format, a driver may
    /// resolve to the format of the texture, and the picture be too dark (seen in Chromium 156 with SwiftShader's WebGPU).
    pub(super) fn copied<'a>(&self, texture: &'a wgpu::SurfaceTexture) -> Option<&'a wgpu::Texture> {
        let can_copy = self.config.usage.contains(wgpu::TextureUsages::COPY_DST);
        (can_copy && self.view_format != self.config.format).then_some(&texture.texture)
    }

    fn configure(&mut self, device: &wgpu::Device) {
        [self.config.width, self.config.height] = self.size;
        self.surface.configure(device, &self.config);
        self.configured = true;
    }
}
