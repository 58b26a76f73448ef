//! Encodes the render passes of a picture.

use super::frame::Frame;
use super::pipelines::{DEPTH_FORMAT, FrameBinding, Kind, NEAREST_FORMAT, Pipelines};
use super::store::Store;
use super::style::{Drawing, Style};

/// Samples per pixel of a picture with faces, since a shader cannot antialias the silhouette of a
/// mesh as it does the rim of a disc. Every WebGPU and WebGL2 device supports four samples; other
/// numbers are optional.
const FACE_SAMPLES: u32 = 4;

/// Draws pictures into targets.
pub(super) struct Painter {
    pub(super) format: wgpu::TextureFormat,
    frame: FrameBinding,
    pipelines: Pipelines,
    /// Buffers for the canvas, kept between pictures.
    buffers: Option<Buffers>,
}

/// The textures that drawing needs, besides the target.
#[derive(Clone)]
struct Buffers {
    depth: wgpu::Texture,
    /// The multisampled colour texture, if a pixel has several samples.
    samples: Option<wgpu::Texture>,
    /// The texture to which samples are resolved before it is copied to the target.
    resolved: Option<wgpu::Texture>,
    occlusion: Occlusion,
}

/// Textures of the ambient-occlusion passes, at half the picture's resolution along each axis.
/// Without occlusion they have a single, unused texel.
#[derive(Clone)]
struct Occlusion {
    is_drawn: bool,
    depth: wgpu::TextureView,
    /// Depths of the nearest surface, first with normals, then with openness. A pass reads one,
    /// through its group, while it draws on the other.
    nearest: [(wgpu::TextureView, wgpu::BindGroup); 2],
}

/// The particles, faces and crease segments to draw.
pub(super) struct Content {
    pub(super) particles: Store,
    /// Number of particles whose beds make up the body.
    pub(super) body: u32,
    pub(super) faces: Store,
    /// Number of particles that faces replace. Only later particles are drawn themselves.
    pub(super) face_particles: u32,
    pub(super) lines: Store,
}

/// A picture.
pub(super) struct Scene<'a> {
    pub(super) content: &'a Content,
    pub(super) style: &'a Style,
    pub(super) frame: Frame,
    /// Whether the background stays transparent.
    pub(super) transparent: bool,
}

/// Texture view that a picture is drawn on.
pub(super) struct Canvas<'a> {
    pub(super) view: &'a wgpu::TextureView,
    /// The texture to which resolved samples are copied; without it samples are resolved to the
    /// view.
    pub(super) copied: Option<&'a wgpu::Texture>,
    pub(super) size: [u32; 2],
    /// Whether the buffers are kept for the next target of the same size.
    pub(super) keep: bool,
}

impl Painter {
    /// For targets of `format`, which must be an sRGB format so that blending is linear.
    pub(super) fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let frame = FrameBinding::new(device);
        let pipelines = Pipelines::new(device, &frame, format);
        Self { format, frame, pipelines, buffers: None }
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
        if canvas.keep {
            // Frees the old buffers' memory before new ones are allocated.
            self.buffers.take_if(|buffers| !buffers.fit(canvas, scene));
        }
        let buffers = match &self.buffers {
            Some(buffers) if buffers.fit(canvas, scene) => buffers.clone(),
            _ => self.buffers(device, canvas, scene),
        };
        if canvas.keep {
            self.buffers = Some(buffers.clone());
        }
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let Occlusion { is_drawn, depth, nearest } = &buffers.occlusion;
        if *is_drawn {
            let clear = wgpu::Color { r: f64::from(1.0_f32.to_bits()), ..wgpu::Color::TRANSPARENT };
            let target = |k: usize| PassTarget { view: &nearest[k].0, resolve: None, clear, depth: None };
            let mut pass = self.pass(&mut encoder, PassTarget { depth: Some(depth), ..target(0) });
            scene.draw_nearest(&mut pass, &mut |kind| self.pipelines.get(device, kind, 1));
            drop(pass);
            for (kind, from) in [(Kind::Occlusion, 0), (Kind::Mean, 1)] {
                let mut pass = self.pass(&mut encoder, target(1 - from));
                pass.set_bind_group(1, &nearest[from].1, &[]);
                pass.set_pipeline(&self.pipelines.get(device, kind, 1));
                pass.draw(0..3, 0..1);
            }
        }
        let [sampled, resolved] =
            [&buffers.samples, &buffers.resolved].map(|texture| texture.as_ref().map(view_of));
        let mut pass = self.pass(
            &mut encoder,
            PassTarget {
                view: sampled.as_ref().unwrap_or(canvas.view),
                resolve: sampled.as_ref().map(|_| resolved.as_ref().unwrap_or(canvas.view)),
                clear: scene.clear_colour(),
                depth: Some(&view_of(&buffers.depth)),
            },
        );
        pass.set_bind_group(1, &nearest[0].1, &[]);
        scene.draw(&mut pass, &mut |kind| self.pipelines.get(device, kind, scene.samples()));
        drop(pass);
        if let (Some(resolved), Some(texture)) = (&buffers.resolved, canvas.copied) {
            let (from, to) = (resolved.as_image_copy(), texture.as_image_copy());
            encoder.copy_texture_to_texture(from, to, resolved.size());
        }
        queue.submit([encoder.finish()]);
    }

    /// Begins a pass whose depths are discarded.
    fn pass<'a>(
        &self,
        encoder: &'a mut wgpu::CommandEncoder,
        target: PassTarget<'_>,
    ) -> wgpu::RenderPass<'a> {
        let PassTarget { view, resolve, clear, depth } = target;
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: resolve,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(clear),
                    store: if resolve.is_some() { wgpu::StoreOp::Discard } else { wgpu::StoreOp::Store },
                },
            })],
            depth_stencil_attachment: depth.map(|view| wgpu::RenderPassDepthStencilAttachment {
                view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_bind_group(0, &self.frame.group, &[]);
        pass
    }

    /// Creates the buffers for a picture.
    fn buffers(&self, device: &wgpu::Device, canvas: &Canvas<'_>, scene: &Scene<'_>) -> Buffers {
        let texture = |[width, height]: [u32; 2], format, sample_count, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: None,
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
                view_formats: &[],
            })
        };
        let (size, samples) = (canvas.size, scene.samples());
        let plain = wgpu::TextureUsages::empty();
        let is_copied = samples > 1 && canvas.copied.is_some();
        Buffers {
            depth: texture(size, DEPTH_FORMAT, samples, plain),
            samples: (samples > 1).then(|| texture(size, self.format, samples, plain)),
            resolved: is_copied.then(|| texture(size, self.format, 1, wgpu::TextureUsages::COPY_SRC)),
            occlusion: {
                let is_drawn = scene.is_occluded();
                let size = if is_drawn { size.map(|side| side.div_ceil(2)) } else { [1, 1] };
                let nearest = [(), ()].map(|()| {
                    let view =
                        view_of(&texture(size, NEAREST_FORMAT, 1, wgpu::TextureUsages::TEXTURE_BINDING));
                    let group = self.pipelines.group(device, &view);
                    (view, group)
                });
                Occlusion { is_drawn, depth: view_of(&texture(size, DEPTH_FORMAT, 1, plain)), nearest }
            },
        }
    }
}

/// The attachments of a render pass.
struct PassTarget<'a> {
    view: &'a wgpu::TextureView,
    /// Texture to which the samples of a multisampled `view` are resolved.
    resolve: Option<&'a wgpu::TextureView>,
    clear: wgpu::Color,
    depth: Option<&'a wgpu::TextureView>,
}

/// Returns the pipeline of a kind for a target.
type Get<'a> = dyn FnMut(Kind) -> wgpu::RenderPipeline + 'a;

impl Scene<'_> {
    fn clear_colour(&self) -> wgpu::Color {
        let [r, g, b, _] = self.frame.light.background.map(f64::from);
        if self.transparent { wgpu::Color::TRANSPARENT } else { wgpu::Color { r, g, b, a: 1.0 } }
    }

    /// Whether the picture has faces.
    fn has_faces(&self) -> bool {
        self.style.drawing != Drawing::Discs && self.content.faces.count > 0
    }

    /// Samples per pixel.
    fn samples(&self) -> u32 {
        if self.has_faces() { FACE_SAMPLES } else { 1 }
    }

    /// Whether ambient occlusion is drawn. Discs without a body get none: those behind the gaps
    /// would darken the discs in front.
    fn is_occluded(&self) -> bool {
        let Style { occlusion, spheres, body, .. } = self.style;
        *occlusion > 0.0 && (*spheres || body.is_some() || self.has_faces())
    }

    /// The first particle that is drawn itself; faces replace the ones before it.
    fn first(&self) -> u32 {
        if self.has_faces() { self.content.face_particles } else { 0 }
    }

    /// Draws those of these particles that no face replaces.
    fn draw_particles(&self, pass: &mut wgpu::RenderPass<'_>, range: core::ops::Range<u32>) {
        let first = range.start.max(self.first());
        draw_instances(pass, &self.content.particles, 4, first..range.end.max(first));
    }

    fn draw_faces(&self, pass: &mut wgpu::RenderPass<'_>) {
        let faces = &self.content.faces;
        draw_instances(pass, faces, 3, 0..faces.count);
    }

    fn draw_nearest(&self, pass: &mut wgpu::RenderPass<'_>, get: &mut Get<'_>) {
        let Content { particles, body, .. } = self.content;
        if self.has_faces() {
            pass.set_pipeline(&get(Kind::FaceNearest));
            self.draw_faces(pass);
        }
        if self.style.body.is_some() {
            pass.set_pipeline(&get(Kind::BedNearest));
            self.draw_particles(pass, 0..*body);
        }
        if self.style.spheres {
            pass.set_pipeline(&get(Kind::BallNearest));
            self.draw_particles(pass, 0..particles.count);
        }
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, get: &mut Get<'_>) {
        let Self { content: Content { particles, body, lines, .. }, style, .. } = self;
        if self.has_faces() {
            pass.set_pipeline(&get(if style.plane.is_some() { Kind::CutFace } else { Kind::Face }));
            self.draw_faces(pass);
        }
        if style.body.is_some() {
            let shown = particles.count.min(*body);
            for (kind, range) in [(Kind::Bed, 0..shown), (Kind::BedToCome, shown..*body)] {
                if !range.is_empty() {
                    pass.set_pipeline(&get(kind));
                    self.draw_particles(pass, range);
                }
            }
        }
        let kinds: &[Kind] = if style.spheres {
            &[Kind::BallCore, Kind::BallRim]
        } else {
            &[Kind::DiscCore, Kind::RimBehind, Kind::RimFront]
        };
        for &kind in kinds {
            pass.set_pipeline(&get(kind));
            self.draw_particles(pass, 0..particles.count);
        }
        if lines.count > 0 {
            pass.set_pipeline(&get(Kind::Crease));
            draw_instances(pass, lines, 4, 0..lines.count);
        }
        if style.clip_box.is_some() {
            pass.set_pipeline(&get(Kind::ClipBox));
            pass.draw(0..4, 0..12);
        }
        if let Some(index) = style.outline.filter(|&index| index < particles.count) {
            pass.set_pipeline(&get(Kind::Ring));
            draw_instances(pass, particles, 4, index..index + 1);
        }
    }
}

/// Draws a strip of this many vertices per record. The buffer slices begin at the first record
/// drawn, because WebGL2 has no base instance.
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
    fn fit(&self, canvas: &Canvas<'_>, scene: &Scene<'_>) -> bool {
        let Self { depth, resolved, occlusion, .. } = self;
        [depth.width(), depth.height()] == canvas.size
            && depth.sample_count() == scene.samples()
            && (scene.samples() == 1 || resolved.is_some() == canvas.copied.is_some())
            && occlusion.is_drawn == scene.is_occluded()
    }
}

fn view_of(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
