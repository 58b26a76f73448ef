//! Render pipelines and the uniform buffer that they share.

use super::frame::Frame;
use super::layout::{
    Attribute, AttributeFormat, COLOUR_ATTRIBUTES, COLOUR_STRIDE, FACE_ATTRIBUTES, FaceRecord, FaceTint,
    LINE_ATTRIBUTES, LineRecord, RECORD_ATTRIBUTES, Record, TINT_ATTRIBUTES,
};
use super::shaders::{DISCS, FACES, LINES};

/// Format of the depth buffers.
pub(super) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// The uniform buffer for a [`Frame`], which all pipelines of a device share.
pub(super) struct FrameBinding {
    pub(super) buffer: wgpu::Buffer,
    pub(super) group: wgpu::BindGroup,
    layout: wgpu::BindGroupLayout,
}

/// Pipelines for a target.
pub(super) struct Pipelines {
    /// Draws fully covered pixels of discs, with depth test and depth writes.
    pub(super) core: wgpu::RenderPipeline,
    /// Blend partly covered pixels of discs seen from behind and of discs seen from the front, with depth test, without
    /// depth writes.
    pub(super) rims: [wgpu::RenderPipeline; 2],
    /// Draws faces, with depth test and depth writes.
    pub(super) faces: wgpu::RenderPipeline,
    /// Draws faces that a plane may cut, with depth test and depth writes. The samples of a pixel antialias the edge at the plane.
    pub(super) cut_faces: wgpu::RenderPipeline,
    /// Draws faces as a ghost beneath discs, with depth test and depth writes.
    pub(super) ghost: wgpu::RenderPipeline,
    /// Blends a ring around a particle over everything.
    pub(super) ring: wgpu::RenderPipeline,
    /// Blends the edges of the clip box, with depth test, without depth writes.
    pub(super) clip_box: wgpu::RenderPipeline,
    /// Blends the creases, with depth test, without depth writes.
    pub(super) creases: wgpu::RenderPipeline,
}

/// Format and sample count of the texture that a pipeline draws into.
#[derive(Clone, Copy)]
pub(super) struct TargetKind {
    /// An sRGB format, so that blending is linear.
    pub(super) format: wgpu::TextureFormat,
    /// Samples per pixel.
    pub(super) samples: u32,
}

/// Blending of colours that are premultiplied by their opacity.
const BLEND: wgpu::BlendState = wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING;

/// The properties in which the pipelines differ.
struct PipelineSpec<'a> {
    label: &'a str,
    shader: &'a wgpu::ShaderModule,
    vertex: &'a str,
    fragment: &'a str,
    buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    depth_write: bool,
    /// Whether the opacity says how many samples of a pixel are covered, instead of being blended.
    alpha_to_coverage: bool,
    depth_compare: wgpu::CompareFunction,
}

impl Pipelines {
    /// Compiles the pipelines for a target.
    pub(super) fn new(device: &wgpu::Device, frame: &FrameBinding, target: TargetKind) -> Self {
        let [discs, faces, lines] = [DISCS, FACES, LINES].map(|shader| {
            device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(shader.name),
                source: wgpu::ShaderSource::Wgsl(shader.lean.into()),
            })
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("frame"),
            bind_group_layouts: &[Some(&frame.layout)],
            immediate_size: 0,
        });

        let record = RECORD_ATTRIBUTES.map(vertex_attribute);
        let colour = COLOUR_ATTRIBUTES.map(vertex_attribute);
        let corners = FACE_ATTRIBUTES.map(vertex_attribute);
        let tint = TINT_ATTRIBUTES.map(vertex_attribute);
        let ends = LINE_ATTRIBUTES.map(vertex_attribute);
        let instance = |stride: usize| wgpu::VertexBufferLayout {
            array_stride: stride as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &[],
        };
        let particles = [
            Some(wgpu::VertexBufferLayout { attributes: &record, ..instance(size_of::<Record>()) }),
            Some(wgpu::VertexBufferLayout { attributes: &colour, ..instance(COLOUR_STRIDE) }),
        ];
        let triangles = [
            Some(wgpu::VertexBufferLayout { attributes: &corners, ..instance(size_of::<FaceRecord>()) }),
            Some(wgpu::VertexBufferLayout { attributes: &tint, ..instance(size_of::<FaceTint>()) }),
        ];
        let pieces = [
            Some(wgpu::VertexBufferLayout { attributes: &ends, ..instance(size_of::<LineRecord>()) }),
            Some(wgpu::VertexBufferLayout { attributes: &colour, ..instance(COLOUR_STRIDE) }),
        ];
        let disc = PipelineSpec {
            label: "disc core",
            shader: &discs,
            vertex: "vs_core",
            fragment: "fs_core",
            buffers: &particles,
            depth_write: true,
            alpha_to_coverage: false,
            depth_compare: wgpu::CompareFunction::LessEqual,
        };
        let face = PipelineSpec {
            label: "face",
            shader: &faces,
            vertex: "vs_face",
            fragment: "fs_face",
            buffers: &triangles,
            ..disc
        };
        let make = |recipe: PipelineSpec<'_>| pipeline(device, &layout, target, &recipe);
        Self {
            rims: ["vs_rim_behind", "vs_rim_front"].map(|vertex| {
                make(PipelineSpec {
                    label: "disc rim",
                    vertex,
                    fragment: "fs_rim",
                    depth_write: false,
                    ..disc
                })
            }),
            cut_faces: make(PipelineSpec {
                label: "cut face",
                fragment: "fs_cut_face",
                // A single sample has no share to be covered.
                alpha_to_coverage: target.samples > 1,
                ..face
            }),
            ghost: make(PipelineSpec {
                label: "ghost",
                vertex: "vs_ghost",
                fragment: "fs_ghost",
                alpha_to_coverage: target.samples > 1,
                ..face
            }),
            faces: make(face),
            ring: make(PipelineSpec {
                label: "ring",
                vertex: "vs_ring",
                fragment: "fs_ring",
                depth_write: false,
                depth_compare: wgpu::CompareFunction::Always,
                ..disc
            }),
            clip_box: make(PipelineSpec {
                label: "clip box",
                shader: &lines,
                vertex: "vs_box",
                fragment: "fs_line",
                buffers: &[],
                depth_write: false,
                ..disc
            }),
            creases: make(PipelineSpec {
                label: "creases",
                shader: &lines,
                vertex: "vs_crease",
                fragment: "fs_line",
                buffers: &pieces,
                depth_write: false,
                ..disc
            }),
            core: make(disc),
        }
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

fn pipeline(
    device: &wgpu::Device,
    layout: &wgpu::PipelineLayout,
    target: TargetKind,
    recipe: &PipelineSpec<'_>,
) -> wgpu::RenderPipeline {
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(recipe.label),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module: recipe.shader,
            entry_point: Some(recipe.vertex),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: recipe.buffers,
        },
        primitive: wgpu::PrimitiveState {
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            ..wgpu::PrimitiveState::default()
        },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(recipe.depth_write),
            depth_compare: Some(recipe.depth_compare),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState {
            count: target.samples,
            alpha_to_coverage_enabled: recipe.alpha_to_coverage,
            ..wgpu::MultisampleState::default()
        },
        fragment: Some(wgpu::FragmentState {
            module: recipe.shader,
            entry_point: Some(recipe.fragment),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format: target.format,
                blend: (!recipe.alpha_to_coverage).then_some(BLEND),
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn vertex_attribute(attribute: Attribute) -> wgpu::VertexAttribute {
    wgpu::VertexAttribute {
        format: match attribute.format {
            AttributeFormat::Float32 => wgpu::VertexFormat::Float32,
            AttributeFormat::Float32x3 => wgpu::VertexFormat::Float32x3,
            AttributeFormat::Float32x4 => wgpu::VertexFormat::Float32x4,
            AttributeFormat::Snorm16x2 => wgpu::VertexFormat::Snorm16x2,
            AttributeFormat::Unorm8x4 => wgpu::VertexFormat::Unorm8x4,
        },
        offset: attribute.offset as u64,
        shader_location: attribute.location,
    }
}
