//! Encoder of the render pass of a picture.

use super::layout::Frame;
use super::pipelines::{DEPTH_FORMAT, Pipelines};
use super::store::Store;

/// Draws pictures into targets.
pub(super) struct Painter {
    pipelines: Pipelines,
    /// Depth buffer of the canvas, kept between pictures.
    depth: Option<wgpu::Texture>,
}

/// Contents of a picture.
pub(super) struct Scene<'a> {
    pub(super) store: &'a Store,
    /// Particles `0..count` are drawn.
    pub(super) count: u32,
    /// Index of a particle that is marked by a ring.
    pub(super) outline: Option<u32>,
    /// Whether the edges of the clip box are drawn.
    pub(super) clip_box: bool,
    pub(super) frame: Frame,
    /// Whether the background is left out.
    pub(super) transparent: bool,
}

impl Painter {
    pub(super) fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        Self { pipelines: Pipelines::new(device, format), depth: None }
    }

    /// Drops the depth buffer, since the size of the target has changed.
    pub(super) fn forget_depth(&mut self) {
        self.depth = None;
    }

    /// Encodes and submits a picture. If `keep` is set, the depth buffer is kept for the next target of the same size.
    pub(super) fn paint(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        target: &wgpu::TextureView,
        size: [u32; 2],
        keep: bool,
        scene: &Scene<'_>,
    ) {
        queue.write_buffer(&self.pipelines.frame, 0, bytemuck::bytes_of(&scene.frame));
        let depth = match &self.depth {
            Some(depth) if [depth.width(), depth.height()] == size => depth.clone(),
            _ => depth_texture(device, size),
        };
        if keep {
            self.depth = Some(depth.clone());
        }
        let depth_view = depth.create_view(&wgpu::TextureViewDescriptor::default());
        let [r, g, b, _] = scene.frame.background.map(f64::from);
        let clear =
            if scene.transparent { wgpu::Color::TRANSPARENT } else { wgpu::Color { r, g, b, a: 1.0 } };
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("picture"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store: wgpu::StoreOp::Store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &depth_view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_bind_group(0, &self.pipelines.bind_group, &[]);
        let [behind, front] = &self.pipelines.rims;
        for pipeline in [&self.pipelines.core, behind, front] {
            pass.set_pipeline(pipeline);
            draw_particles(&mut pass, scene.store, 0..scene.count);
        }
        if scene.clip_box {
            pass.set_pipeline(&self.pipelines.clip_box);
            pass.draw(0..4, 0..12);
        }
        if let Some(index) = scene.outline.filter(|&index| index < scene.count) {
            pass.set_pipeline(&self.pipelines.ring);
            draw_particles(&mut pass, scene.store, index..index + 1);
        }
        drop(pass);
        queue.submit([encoder.finish()]);
    }
}

/// Draws a quad per particle. The buffer slices begin at the first particle drawn, because WebGL2 has no base instance.
fn draw_particles(pass: &mut wgpu::RenderPass<'_>, store: &Store, range: core::ops::Range<u32>) {
    for run in store.runs(range) {
        pass.set_vertex_buffer(0, run.records);
        pass.set_vertex_buffer(1, run.colours);
        pass.draw(0..4, 0..run.count);
    }
}

fn depth_texture(device: &wgpu::Device, size: [u32; 2]) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some("depth"),
        size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: DEPTH_FORMAT,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    })
}
