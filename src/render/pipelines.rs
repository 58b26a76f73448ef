//! Render pipelines and the uniform buffer that they share.

use super::layout::{Attribute, COLOUR_ATTRIBUTES, COLOUR_STRIDE, Format, Frame, RECORD_ATTRIBUTES, Record};
use super::shaders::{BOX, DISCS};

/// Format of the depth buffers.
pub(super) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Pipelines for a colour format.
pub(super) struct Pipelines {
    /// Draws fully covered pixels of discs, with depth test and depth writes.
    pub(super) core: wgpu::RenderPipeline,
    /// Blend partly covered pixels of discs seen from behind and of discs seen from the front, with depth test, without
    /// depth writes.
    pub(super) rims: [wgpu::RenderPipeline; 2],
    /// Blends a ring around a particle over everything.
    pub(super) ring: wgpu::RenderPipeline,
    /// Blends the edges of the clip box, with depth test, without depth writes.
    pub(super) clip_box: wgpu::RenderPipeline,
    /// Uniform buffer for a [`Frame`].
    pub(super) frame: wgpu::Buffer,
    /// Bind group of [`Pipelines::frame`].
    pub(super) bind_group: wgpu::BindGroup,
}

/// Blending of colours that are premultiplied by their opacity.
const BLEND: wgpu::BlendState = wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING;

/// What distinguishes one pipeline from another.
struct Recipe<'a> {
    label: &'a str,
    shader: &'a wgpu::ShaderModule,
    vertex: &'a str,
    fragment: &'a str,
    buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    depth_write: bool,
    depth_compare: wgpu::CompareFunction,
}

impl Pipelines {
    /// Compiles the pipelines for targets of `format`, which must be an sRGB format so that blending is linear.
    pub(super) fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let [discs, edges] = [DISCS, BOX].map(|shader| {
            device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(shader.name),
                source: wgpu::ShaderSource::Wgsl(shader.lean.into()),
            })
        });
        let (frame, bind_layout, bind_group) = frame_binding(device);
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("frame"),
            bind_group_layouts: &[Some(&bind_layout)],
            immediate_size: 0,
        });

        let record = RECORD_ATTRIBUTES.map(vertex_attribute);
        let colour = COLOUR_ATTRIBUTES.map(vertex_attribute);
        let instance = |stride: usize| wgpu::VertexBufferLayout {
            array_stride: stride as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &[],
        };
        let particles = [
            Some(wgpu::VertexBufferLayout { attributes: &record, ..instance(size_of::<Record>()) }),
            Some(wgpu::VertexBufferLayout { attributes: &colour, ..instance(COLOUR_STRIDE) }),
        ];
        let disc = Recipe {
            label: "disc core",
            shader: &discs,
            vertex: "vs_core",
            fragment: "fs_core",
            buffers: &particles,
            depth_write: true,
            depth_compare: wgpu::CompareFunction::LessEqual,
        };
        let make = |recipe: Recipe<'_>| pipeline(device, &layout, format, &recipe);
        Self {
            rims: ["vs_rim_behind", "vs_rim_front"].map(|vertex| {
                make(Recipe { label: "disc rim", vertex, fragment: "fs_rim", depth_write: false, ..disc })
            }),
            ring: make(Recipe {
                label: "ring",
                vertex: "vs_ring",
                fragment: "fs_ring",
                depth_write: false,
                depth_compare: wgpu::CompareFunction::Always,
                ..disc
            }),
            clip_box: make(Recipe {
                label: "clip box",
                shader: &edges,
                vertex: "vs_box",
                fragment: "fs_box",
                buffers: &[],
                depth_write: false,
                ..disc
            }),
            core: make(disc),
            frame,
            bind_group,
        }
    }
}

/// Uniform buffer for a [`Frame`], with its bind group and the layout of that.
fn frame_binding(device: &wgpu::Device) -> (wgpu::Buffer, wgpu::BindGroupLayout, wgpu::BindGroup) {
    let label = Some("frame");
    let frame = device.create_buffer(&wgpu::BufferDescriptor {
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
    let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label,
        layout: &layout,
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: frame.as_entire_binding() }],
    });
    (frame, layout, bind_group)
}

fn pipeline(
    device: &wgpu::Device,
    layout: &wgpu::PipelineLayout,
    format: wgpu::TextureFormat,
    recipe: &Recipe<'_>,
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
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: recipe.shader,
            entry_point: Some(recipe.fragment),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format,
                blend: Some(BLEND),
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
            Format::Float32 => wgpu::VertexFormat::Float32,
            Format::Float32x3 => wgpu::VertexFormat::Float32x3,
            Format::Snorm16x2 => wgpu::VertexFormat::Snorm16x2,
            Format::Unorm8x4 => wgpu::VertexFormat::Unorm8x4,
        },
        offset: attribute.offset as u64,
        shader_location: attribute.location,
    }
}
