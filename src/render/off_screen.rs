//! A texture to draw on natively, instead of a canvas.

use super::gpu::{Callbacks, CreateError, Gpu};
use super::painter::Canvas;
use super::renderer::Renderer;

/// Format of the texture, which every Vulkan device can draw on.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// A texture on which pictures are drawn, each replacing the last.
pub struct OffScreen {
    view: wgpu::TextureView,
    size: [u32; 2],
    timer: Option<Timer>,
}

impl OffScreen {
    /// Opens the machine's graphics card, or else a software driver. Returns a texture of this size
    /// and a renderer for it. The size must come from [`Renderer::picture_size`].
    ///
    /// # Errors
    ///
    /// [`CreateError`] if there is no Vulkan driver, or it provides no device.
    pub async fn open(size: [u32; 2], callbacks: Callbacks) -> Result<(Self, Renderer), CreateError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let (gpu, _) =
            Gpu::open(&instance, None, |adapter| adapter.features() & Timer::FEATURES, callbacks).await?;
        let mut renderer = Renderer::new(gpu, FORMAT);
        let size = renderer.resize(renderer.picture_size(size));
        let Gpu { device, .. } = &renderer.gpu;
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("off screen"),
            size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let timer = device.features().contains(Timer::FEATURES).then(|| Timer::new(device));
        Ok((Self { view, size, timer }, renderer))
    }

    /// Draws a picture and waits for it. `time_s` is the current time on the caller's clock.
    /// Returns the seconds that the device took, if it has a clock.
    pub fn draw(&mut self, renderer: &mut Renderer, time_s: f64) -> Option<f64> {
        if let Some(timer) = &self.timer {
            timer.mark(&renderer.gpu, 0);
        }
        let canvas = Canvas { view: &self.view, copied: None, size: self.size, keep: true };
        renderer.draw_on(&canvas, time_s);
        if let Some(timer) = &self.timer {
            timer.mark(&renderer.gpu, 1);
        }
        wait(&renderer.gpu);
        self.timer.as_ref().and_then(|timer| timer.read(&renderer.gpu))
    }

    /// Pixels of a picture, as from [`Picture::pixels`](super::Picture::pixels). `None` if the
    /// device is lost.
    pub fn read(&self, renderer: &mut Renderer, is_transparent: bool, time_s: f64) -> Option<Vec<u8>> {
        let picture = renderer.picture(self.size, is_transparent, time_s)?;
        // After a failure there are no pixels.
        picture.map(drop);
        wait(&renderer.gpu);
        picture.pixels()
    }
}

/// Waits until the device has done all submitted work.
fn wait(gpu: &Gpu) {
    // An error means that the device is lost, which its callback reports.
    let _ = gpu.device.poll(wgpu::PollType::wait_indefinitely());
}

/// The device's clock, read before and after a picture.
struct Timer {
    times: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    readable: wgpu::Buffer,
}

impl Timer {
    /// Device features that are needed to measure the time of a picture.
    const FEATURES: wgpu::Features =
        wgpu::Features::TIMESTAMP_QUERY.union(wgpu::Features::TIMESTAMP_QUERY_INSIDE_ENCODERS);
    /// Bytes of the two times.
    const SIZE: u64 = 2 * wgpu::QUERY_SIZE as u64;

    fn new(device: &wgpu::Device) -> Self {
        let label = Some("times");
        let buffer = |usage| {
            let mapped_at_creation = false;
            device.create_buffer(&wgpu::BufferDescriptor {
                label,
                size: Self::SIZE,
                usage,
                mapped_at_creation,
            })
        };
        let ty = wgpu::QueryType::Timestamp;
        Self {
            times: device.create_query_set(&wgpu::QuerySetDescriptor { label, ty, count: 2 }),
            resolved: buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC),
            readable: buffer(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST),
        }
    }

    /// Records when all previously submitted work is done, as the first or the second time.
    fn mark(&self, gpu: &Gpu, index: u32) {
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.write_timestamp(&self.times, index);
        if index == 1 {
            encoder.resolve_query_set(&self.times, 0..2, &self.resolved, 0);
            encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.readable, 0, Self::SIZE);
        }
        gpu.queue.submit([encoder.finish()]);
    }

    /// Seconds between the two times. `None` if the device is lost.
    fn read(&self, gpu: &Gpu) -> Option<f64> {
        // After a failure there is no range.
        self.readable.map_async(wgpu::MapMode::Read, .., drop);
        wait(gpu);
        let ticks = {
            let range = self.readable.get_mapped_range(..).ok()?;
            let &[first, last] = bytemuck::try_cast_slice::<u8, u64>(&range).ok()?.as_array::<2>()?;
            last.saturating_sub(first)
        };
        self.readable.unmap();
        Some(ticks as f64 * f64::from(gpu.queue.get_timestamp_period()) * 1e-9)
    }
}
