//! Render pipelines, and the uniform buffer that they share.

use super::frame::Frame;
use super::layout::{AttributeFormat, FACE, PARTICLE, PIECE, stride};
use super::shaders::{DISCS, FACES, LINES, OCCLUSION, Shader};

/// Format of the depth buffers.
pub(super) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Format of what is nearest to the eye: the bits of a depth, and those of a normal or of the
/// openness. All devices draw on it.
pub(super) const NEAREST_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Uint;

/// The uniform buffer for a [`Frame`], which all pipelines of a device share.
pub(super) struct FrameBinding {
    pub(super) buffer: wgpu::Buffer,
    pub(super) group: wgpu::BindGroup,
    layout: wgpu::BindGroupLayout,
}

/// Blending of colours that are premultiplied by their opacity.
const BLEND: wgpu::BlendState = wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING;

/// Kind of a pipeline: the shapes that it draws, and into which pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// The body beneath discs, with depth writes.
    Bed,
    /// The body of particles that a later level will place, with depth writes.
    BedToCome,
    /// The body into the nearest-surface texture: depth and normal of what is nearest at each
    /// pixel.
    BedNearest,
    /// Fully covered pixels of discs, with depth writes.
    DiscCore,
    /// Partly covered pixels of discs seen from behind.
    RimBehind,
    /// Partly covered pixels of discs seen from the front.
    RimFront,
    /// Fully covered pixels of spheres, with depth writes.
    BallCore,
    /// Partly covered pixels of spheres.
    BallRim,
    /// Spheres into the nearest-surface texture: depth and normal of the sphere that is nearest at
    /// each pixel.
    BallNearest,
    /// Faces, with depth writes.
    Face,
    /// Faces that a plane may cut, with depth writes. The samples of a pixel antialias the edge at
    /// the plane.
    CutFace,
    /// Faces into the nearest-surface texture: depth and normal of the face that is nearest at each
    /// pixel.
    FaceNearest,
    /// Ambient occlusion: the openness of the nearest surface at each pixel.
    Occlusion,
    /// The ambient occlusion, smoothed by the mean over neighbouring pixels.
    Mean,
    /// A ring around a particle, over everything.
    Ring,
    /// The edges of the clip box.
    ClipBox,
    /// The creases.
    Crease,
}

/// How a pipeline draws on its target.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Way {
    /// Blends and writes depths.
    Solid,
    /// Writes depths. The opacity says how many samples of a pixel are covered, instead of being
    /// blended.
    Covering,
    /// Blends with depth test, without depth writes.
    Blended,
    /// Blends over everything.
    Above,
    /// Writes depths and what is nearest.
    Nearest,
    /// Computes every texel of what is nearest.
    Screen,
}

/// The properties in which the pipelines differ.
struct Spec {
    shader: Shader,
    vertex: &'static str,
    fragment: &'static str,
    /// Formats of the attributes of each vertex buffer.
    buffers: &'static [&'static [AttributeFormat]],
    way: Way,
}

impl Kind {
    fn spec(self) -> Spec {
        use Way::{Above, Blended, Covering, Nearest, Screen, Solid};
        let (shader, vertex, fragment, buffers, way) = match self {
            Self::Bed => (DISCS, "vs_bed", "fs_bed", &PARTICLE[..], Solid),
            Self::BedToCome => (DISCS, "vs_bed_to_come", "fs_bed", &PARTICLE[..], Solid),
            Self::BedNearest => (DISCS, "vs_bed_nearest", "fs_bed_nearest", &PARTICLE[..], Nearest),
            Self::DiscCore => (DISCS, "vs_core", "fs_core", &PARTICLE[..], Solid),
            Self::RimBehind => (DISCS, "vs_rim_behind", "fs_rim", &PARTICLE[..], Blended),
            Self::RimFront => (DISCS, "vs_rim_front", "fs_rim", &PARTICLE[..], Blended),
            Self::BallCore => (DISCS, "vs_ball_core", "fs_ball_core", &PARTICLE[..], Solid),
            Self::BallRim => (DISCS, "vs_ball_rim", "fs_ball_rim", &PARTICLE[..], Blended),
            Self::BallNearest => (DISCS, "vs_ball_core", "fs_ball_nearest", &PARTICLE[..], Nearest),
            Self::Ring => (DISCS, "vs_ring", "fs_ring", &PARTICLE[..], Above),
            Self::Face => (FACES, "vs_face", "fs_face", &FACE[..], Solid),
            Self::CutFace => (FACES, "vs_face", "fs_cut_face", &FACE[..], Covering),
            Self::FaceNearest => (FACES, "vs_face", "fs_nearest", &FACE[..], Nearest),
            Self::ClipBox => (LINES, "vs_box", "fs_line", &[][..], Blended),
            Self::Crease => (LINES, "vs_crease", "fs_line", &PIECE[..], Blended),
            Self::Occlusion => (OCCLUSION, "vs_cover", "fs_occlusion", &[][..], Screen),
            Self::Mean => (OCCLUSION, "vs_cover", "fs_mean", &[][..], Screen),
        };
        Spec { shader, vertex, fragment, buffers, way }
    }

    /// Whether its shader reads what is nearest.
    fn reads_nearest(self) -> bool {
        matches!(
            self,
            Self::Bed
                | Self::BedToCome
                | Self::DiscCore
                | Self::RimBehind
                | Self::RimFront
                | Self::BallCore
                | Self::BallRim
                | Self::Face
                | Self::CutFace
                | Self::Occlusion
                | Self::Mean
        )
    }
}

/// Pipelines of a device, each compiled when it is first used.
pub(super) struct Pipelines {
    /// Format of the pictures: an sRGB format, so that blending is linear.
    format: wgpu::TextureFormat,
    /// Without and with the group with what is nearest.
    layouts: [wgpu::PipelineLayout; 2],
    /// Layout of that group.
    nearest: wgpu::BindGroupLayout,
    /// By their names.
    modules: Vec<(&'static str, wgpu::ShaderModule)>,
    /// By what they draw, and the samples per pixel of the target.
    made: Vec<((Kind, u32), wgpu::RenderPipeline)>,
}

/// Returns the entry of `key`, which `make` makes unless it is there.
fn entry<K: PartialEq, V: Clone>(made: &mut Vec<(K, V)>, key: K, make: impl FnOnce() -> V) -> V {
    if let Some((_, value)) = made.iter().find(|(other, _)| *other == key) {
        return value.clone();
    }
    let value = make();
    made.push((key, value.clone()));
    value
}

impl Pipelines {
    /// Pipelines for pictures of `format`.
    pub(super) fn new(device: &wgpu::Device, frame: &FrameBinding, format: wgpu::TextureFormat) -> Self {
        let label = Some("nearest");
        let nearest = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label,
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::FRAGMENT,
                ty: wgpu::BindingType::Texture {
                    sample_type: wgpu::TextureSampleType::Uint,
                    view_dimension: wgpu::TextureViewDimension::D2,
                    multisampled: false,
                },
                count: None,
            }],
        });
        let groups = [Some(&frame.layout), Some(&nearest)];
        let layouts = [1, 2].map(|count| {
            device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label,
                bind_group_layouts: &groups[..count],
                immediate_size: 0,
            })
        });
        Self { format, layouts, nearest, modules: Vec::new(), made: Vec::new() }
    }

    /// The group with what is nearest, for the pipelines that read it.
    pub(super) fn group(&self, device: &wgpu::Device, nearest: &wgpu::TextureView) -> wgpu::BindGroup {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("nearest"),
            layout: &self.nearest,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(nearest),
            }],
        })
    }

    /// The pipeline that draws `kind` on a target with so many samples per pixel.
    pub(super) fn get(&mut self, device: &wgpu::Device, kind: Kind, samples: u32) -> wgpu::RenderPipeline {
        let Self { format, layouts, modules, made, .. } = self;
        entry(made, (kind, samples), || {
            let Spec { shader, vertex, fragment, buffers, way } = kind.spec();
            let module = entry(modules, shader.name, || {
                device.create_shader_module(wgpu::ShaderModuleDescriptor {
                    label: Some(shader.name),
                    source: wgpu::ShaderSource::Wgsl(shader.lean.into()),
                })
            });
            let mut locations = 0..;
            let attributes: Vec<Vec<_>> = buffers
                .iter()
                .map(|formats| {
                    (0..formats.len()).zip(&mut locations).map(|(k, at)| attribute(formats, k, at)).collect()
                })
                .collect();
            let vertex_layouts: Vec<_> = buffers
                .iter()
                .zip(&attributes)
                .map(|(formats, attributes)| {
                    Some(wgpu::VertexBufferLayout {
                        array_stride: stride(formats),
                        step_mode: wgpu::VertexStepMode::Instance,
                        attributes,
                    })
                })
                .collect();
            let is_nearest = matches!(way, Way::Nearest | Way::Screen);
            let alpha_to_coverage = way == Way::Covering;
            let compare = if way == Way::Above {
                wgpu::CompareFunction::Always
            } else {
                wgpu::CompareFunction::LessEqual
            };
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(fragment),
                layout: Some(&layouts[usize::from(kind.reads_nearest())]),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some(vertex),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers: &vertex_layouts,
                },
                primitive: wgpu::PrimitiveState {
                    topology: wgpu::PrimitiveTopology::TriangleStrip,
                    ..wgpu::PrimitiveState::default()
                },
                depth_stencil: (way != Way::Screen).then(|| wgpu::DepthStencilState {
                    format: DEPTH_FORMAT,
                    depth_write_enabled: Some(matches!(way, Way::Solid | Way::Covering | Way::Nearest)),
                    depth_compare: Some(compare),
                    stencil: wgpu::StencilState::default(),
                    bias: wgpu::DepthBiasState::default(),
                }),
                multisample: wgpu::MultisampleState {
                    count: samples,
                    alpha_to_coverage_enabled: alpha_to_coverage,
                    ..wgpu::MultisampleState::default()
                },
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(fragment),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    targets: &[Some(wgpu::ColorTargetState {
                        format: if is_nearest { NEAREST_FORMAT } else { *format },
                        blend: (!is_nearest && !alpha_to_coverage).then_some(BLEND),
                        write_mask: wgpu::ColorWrites::ALL,
                    })],
                }),
                multiview_mask: None,
                cache: None,
            })
        })
    }
}

impl FrameBinding {
    pub(super) fn new(device: &wgpu::Device) -> Self {
        let label = Some("frame");
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label,
            size: size_of::<Frame>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label,
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: wgpu::BufferSize::new(size_of::<Frame>() as u64),
                },
                count: None,
            }],
        });
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label,
            layout: &layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: buffer.as_entire_binding() }],
        });
        Self { buffer, group, layout }
    }
}

/// Attribute `k` of a buffer, at a location of the shader.
fn attribute(formats: &[AttributeFormat], k: usize, shader_location: u32) -> wgpu::VertexAttribute {
    let format = match formats[k] {
        AttributeFormat::Float32 => wgpu::VertexFormat::Float32,
        AttributeFormat::Float32x3 => wgpu::VertexFormat::Float32x3,
        AttributeFormat::Float32x4 => wgpu::VertexFormat::Float32x4,
        AttributeFormat::Snorm16x2 => wgpu::VertexFormat::Snorm16x2,
        AttributeFormat::Unorm8x4 => wgpu::VertexFormat::Unorm8x4,
    };
    wgpu::VertexAttribute { format, offset: stride(&formats[..k]), shader_location }
}
