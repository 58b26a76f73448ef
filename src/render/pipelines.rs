//! Render pipelines, and the uniform buffer that they share.

use super::frame::Frame;
use super::layout::{AttributeFormat, FACE, PARTICLE, PIECE, stride};
use super::shaders::{DISCS, FACES, LINES, OCCLUSION, Shader};

/// Format of the depth buffers.
pub(super) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Format of the nearest-surface texture: the bits of a depth, and of a normal or an openness.
/// Every device can draw on it.
pub(super) const NEAREST_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Uint;

/// The uniform buffer for a [`Frame`], which all pipelines of a device share.
pub(super) struct FrameBinding {
    pub(super) buffer: wgpu::Buffer,
    pub(super) group: wgpu::BindGroup,
    layout: wgpu::BindGroupLayout,
}

/// Blending of premultiplied colours.
const BLEND: wgpu::BlendState = wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING;

/// Kind of a pipeline: the shapes it draws, and the pass in which.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// The body beneath discs, with depth writes.
    Bed,
    /// The body of particles that later levels will place, with depth writes.
    BedToCome,
    /// The body into the nearest-surface texture, as depth and normal at each pixel.
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
    /// Spheres into the nearest-surface texture, as depth and normal at each pixel.
    BallNearest,
    /// Faces, with depth writes.
    Face,
    /// Faces that a plane may cut, with depth writes. Their edge at the plane is antialiased by the
    /// samples of a pixel.
    CutFace,
    /// Faces into the nearest-surface texture, as depth and normal at each pixel.
    FaceNearest,
    /// Ambient occlusion: the openness of the nearest surface at each pixel.
    Occlusion,
    /// Smooths the ambient occlusion by the mean over neighbouring pixels.
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
    /// Writes depths. The opacity determines how many samples of a pixel are covered and is not
    /// blended.
    Covering,
    /// Blends with depth test, without depth writes.
    Blended,
    /// Blends over everything.
    Above,
    /// Writes depths and the nearest-surface texture.
    Nearest,
    /// Computes every texel of the nearest-surface texture.
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

    /// Whether the shader reads the nearest-surface texture.
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
    /// Without and with the group of the nearest-surface texture.
    layouts: [wgpu::PipelineLayout; 2],
    /// Layout of that group.
    nearest: wgpu::BindGroupLayout,
    /// Shader modules by name.
    modules: Vec<(&'static str, wgpu::ShaderModule)>,
    /// Pipelines by what they draw and the samples per pixel of the target.
    made: Vec<((Kind, u32), wgpu::RenderPipeline)>,
}

/// Returns the entry of `key`, which `make` creates if it is missing.
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

    /// The group of the nearest-surface texture, for the pipelines that read it.
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

    /// The pipeline that draws `kind` on a target with this number of samples per pixel.
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

/// Attribute `k` of a buffer at a shader location.
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
