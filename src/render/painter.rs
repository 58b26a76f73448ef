//! Encoder of the render pass of a picture.

use super::frame::Frame;
use super::pipelines::{DEPTH_FORMAT, FrameBinding, Pipelines, TargetKind};
use super::store::Store;

/// Samples per pixel of a picture with faces. The silhouette of a mesh has no rim that a shader could antialias. All devices of
/// WebGPU and WebGL2 have targets with four samples, and not all with another number.
const FACE_SAMPLES: u32 = 4;

/// Draws pictures into targets.
pub(super) struct Painter {
    format: wgpu::TextureFormat,
    frame: FrameBinding,
    /// Pipelines for pictures of discs alone.
    discs: Pipelines,
    /// Pipelines for pictures with faces, made for the first one.
    faces: Option<Pipelines>,
    /// Buffers of the canvas, kept between pictures.
    buffers: Option<Buffers>,
}

/// The textures that a picture is drawn with, besides its target.
#[derive(Clone)]
struct Buffers {
    depth: wgpu::Texture,
    /// The multisampled colour texture, if a pixel has several samples.
    samples: Option<wgpu::Texture>,
    /// The texture that the samples are resolved to, if it is copied to the target.
    resolved: Option<wgpu::Texture>,
}

/// Contents of a picture.
pub(super) struct Scene<'a> {
    pub(super) particles: &'a Store,
    /// Number of particles.
    pub(super) count: u32,
    pub(super) faces: Option<Faces<'a>>,
    /// The pieces of creases, and their number.
    pub(super) lines: &'a Store,
    pub(super) line_count: u32,
    /// Index of a particle that is marked by a ring.
    pub(super) outline: Option<u32>,
    /// Whether the edges of the clip box are drawn.
    pub(super) clip_box: bool,
    /// Whether a plane cuts the faces.
    pub(super) is_cut: bool,
    pub(super) frame: Frame,
    /// Whether the background is left out.
    pub(super) transparent: bool,
}

/// Faces of a picture.
pub(super) struct Faces<'a> {
    pub(super) store: &'a Store,
    pub(super) count: u32,
    /// Number of particles that the faces stand for. Only the particles after these are drawn as discs, except above a ghost.
    pub(super) particles: u32,
    pub(super) is_ghost: bool,
}

/// Texture view that a picture is drawn on.
pub(super) struct Canvas<'a> {
    pub(super) view: &'a wgpu::TextureView,
    /// The texture to which samples are copied once they are resolved; without one they are resolved to the view.
    pub(super) copied: Option<&'a wgpu::Texture>,
    pub(super) size: [u32; 2],
    /// Whether the buffers are kept for the next target of the same size.
    pub(super) keep: bool,
}

impl Painter {
    /// Compiles the pipelines for targets of `format`, which must be an sRGB format so that blending is linear.
    pub(super) fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let frame = FrameBinding::new(device);
        let discs = Pipelines::new(device, &frame, TargetKind { format, samples: 1 });
        Self { format, frame, discs, faces: None, buffers: None }
    }

    /// Drops the buffers, since the size of the target has changed.
    pub(super) fn forget_buffers(&mut self) {
        self.buffers = None;
    }

    /// Encodes and submits a picture.
    pub(super) fn paint(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        canvas: &Canvas<'_>,
        scene: &Scene<'_>,
    ) {
        queue.write_buffer(&self.frame.buffer, 0, bytemuck::bytes_of(&scene.frame));
        let samples = if scene.faces.is_some() { FACE_SAMPLES } else { 1 };
        let target = TargetKind { format: self.format, samples };
        let buffers = match &self.buffers {
            Some(buffers) if buffers.fit(canvas, target) => buffers.clone(),
            _ => Buffers::new(device, canvas, target),
        };
        if canvas.keep {
            self.buffers = Some(buffers.clone());
        }
        let pipelines = if scene.faces.is_some() {
            self.faces.get_or_insert_with(|| Pipelines::new(device, &self.frame, target))
        } else {
            &self.discs
        };
        let [sampled, resolved] =
            [&buffers.samples, &buffers.resolved].map(|texture| texture.as_ref().map(view_of));
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("picture"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: sampled.as_ref().unwrap_or(canvas.view),
                depth_slice: None,
                resolve_target: sampled.as_ref().map(|_| resolved.as_ref().unwrap_or(canvas.view)),
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(scene.clear_colour()),
                    store: if sampled.is_some() { wgpu::StoreOp::Discard } else { wgpu::StoreOp::Store },
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &view_of(&buffers.depth),
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_bind_group(0, &self.frame.group, &[]);
        scene.draw(&mut pass, pipelines);
        drop(pass);
        if let (Some(resolved), Some(texture)) = (&buffers.resolved, canvas.copied) {
            let (from, to) = (resolved.as_image_copy(), texture.as_image_copy());
            encoder.copy_texture_to_texture(from, to, resolved.size());
        }
        queue.submit([encoder.finish()]);
    }
}

impl Scene<'_> {
    fn clear_colour(&self) -> wgpu::Color {
        let [r, g, b, _] = self.frame.light.background.map(f64::from);
        if self.transparent { wgpu::Color::TRANSPARENT } else { wgpu::Color { r, g, b, a: 1.0 } }
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, pipelines: &Pipelines) {
        let mut first_disc = 0;
        if let Some(&Faces { store, count, particles, is_ghost }) = self.faces.as_ref() {
            pass.set_pipeline(match (is_ghost, self.is_cut) {
                (true, _) => &pipelines.ghost,
                (false, true) => &pipelines.cut_faces,
                (false, false) => &pipelines.faces,
            });
            draw_instances(pass, store, 3, 0..count);
            first_disc = if is_ghost { 0 } else { particles };
        }
        let [behind, front] = &pipelines.rims;
        for pipeline in [&pipelines.core, behind, front] {
            pass.set_pipeline(pipeline);
            draw_instances(pass, self.particles, 4, first_disc..self.count);
        }
        if self.line_count > 0 {
            pass.set_pipeline(&pipelines.creases);
            draw_instances(pass, self.lines, 4, 0..self.line_count);
        }
        if self.clip_box {
            pass.set_pipeline(&pipelines.clip_box);
            pass.draw(0..4, 0..12);
        }
        if let Some(index) = self.outline.filter(|&index| index < self.count) {
            pass.set_pipeline(&pipelines.ring);
            draw_instances(pass, self.particles, 4, index..index + 1);
        }
    }
}

/// Draws a strip of so many vertices per record. The buffer slices begin at the first record drawn, because WebGL2 has no base
/// instance.
fn draw_instances(
    pass: &mut wgpu::RenderPass<'_>,
    store: &Store,
    vertices: u32,
    range: core::ops::Range<u32>,
) {
    for run in store.runs(range) {
        for (slot, buffer) in run.buffers.into_iter().enumerate() {
            pass.set_vertex_buffer(slot as u32, buffer);
        }
        pass.draw(0..vertices, 0..run.count);
    }
}

impl Buffers {
    fn new(device: &wgpu::Device, canvas: &Canvas<'_>, target: TargetKind) -> Self {
        let [width, height] = canvas.size;
        let texture = |label, format, sample_count, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
                view_formats: &[],
            })
        };
        let TargetKind { format, samples } = target;
        let plain = wgpu::TextureUsages::empty();
        let is_copied = samples > 1 && canvas.copied.is_some();
        Self {
            depth: texture("depth", DEPTH_FORMAT, samples, plain),
            samples: (samples > 1).then(|| texture("samples", format, samples, plain)),
            resolved: is_copied.then(|| texture("resolved", format, 1, wgpu::TextureUsages::COPY_SRC)),
        }
    }

    fn fit(&self, canvas: &Canvas<'_>, target: TargetKind) -> bool {
        let Self { depth, resolved, .. } = self;
        [depth.width(), depth.height()] == canvas.size
            && depth.sample_count() == target.samples
            && (target.samples == 1 || resolved.is_some() == canvas.copied.is_some())
    }
}

fn view_of(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
