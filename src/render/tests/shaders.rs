//! Tests of the shaders without a GPU: each is valid WGSL, translates to GLSL ES 3.00 as in wgpu's
//! WebGL2 back end, and has the layout of the data that the Rust side writes.

use marching_particles::Settings;
use marching_particles_render::chunks::{CHUNK, MOST_RECORDS};
use marching_particles_render::frame::{Appearance, Body, Camera, ClipBox, Frame, Light, Look};
use marching_particles_render::layout::{
    AttributeFormat, FACE, FaceRecord, FaceTint, PARTICLE, PIECE, Record,
};
use marching_particles_render::shaders::{COMMON, SHADERS, Shader};
use naga::back::glsl;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Module, ScalarKind, ShaderStage, TypeInner, VectorSize};
use std::mem::offset_of;
use std::path::Path;

/// Parses and validates a shader, without the capabilities of optional features.
fn validated(name: &str, source: &str) -> (Module, ModuleInfo) {
    let module = naga::front::wgsl::parse_str(source)
        .unwrap_or_else(|error| panic!("{}", error.emit_to_string_with_path(source, name)));
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .unwrap_or_else(|error| panic!("{}", error.emit_to_string_with_path(source, name)));
    (module, info)
}

fn shaders() -> Vec<(&'static str, Module, ModuleInfo)> {
    SHADERS
        .into_iter()
        .map(|shader| {
            let (module, info) = validated(shader.name, shader.source);
            (shader.name, module, info)
        })
        .collect()
}

/// GLSL ES 3.00 of an entry point, translated with the flags of wgpu's WebGL2 back end, and its
/// number of uniform blocks.
fn glsl(name: &str, module: &Module, info: &ModuleInfo, entry: &naga::EntryPoint) -> (String, usize) {
    let options = glsl::Options {
        version: glsl::Version::Embedded { version: 300, is_webgl: true },
        writer_flags: glsl::WriterFlags::ADJUST_COORDINATE_SPACE | glsl::WriterFlags::FORCE_POINT_SIZE,
        ..glsl::Options::default()
    };
    let pipeline =
        glsl::PipelineOptions { shader_stage: entry.stage, entry_point: entry.name.clone(), multiview: None };
    let policies = naga::proc::BoundsCheckPolicies::default();
    let mut text = String::new();
    let reflection = glsl::Writer::new(&mut text, module, info, &options, &pipeline, policies)
        .and_then(|mut writer| writer.write())
        .unwrap_or_else(|error| panic!("{name}, {}: {error}", entry.name));
    let blocks = reflection.uniforms.len();
    (text, blocks)
}

#[test]
fn every_particle_that_a_run_may_place_has_room_on_a_device_that_promises_least() {
    /// Bytes of a buffer that every device takes.
    const LEAST_BUFFER: usize = 256 << 20;
    let most = *Settings::range("max_particles").expect("it is a number").end();
    assert!(most < f64::from(MOST_RECORDS), "{most} particles, room for {MOST_RECORDS}");
    let largest = size_of::<FaceRecord>().max(size_of::<FaceTint>()).max(size_of::<Record>());
    assert!(CHUNK as usize * largest <= LEAST_BUFFER / 8, "a chunk takes {} bytes", CHUNK as usize * largest);
}

#[test]
fn every_shader_file_is_known_and_used() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shaders");
    let mut files: Vec<String> = std::fs::read_dir(&folder)
        .expect("the folder shaders/")
        .map(|entry| entry.expect("an entry of shaders/").file_name().into_string().expect("a UTF-8 name"))
        .collect();
    files.sort();
    let mut known: Vec<String> =
        SHADERS.iter().map(|shader| shader.name).chain([COMMON]).map(str::to_owned).collect();
    known.sort();
    assert_eq!(files, known);
    assert!(!files.is_empty());
    for (name, module, _) in shaders() {
        for stage in [ShaderStage::Vertex, ShaderStage::Fragment] {
            assert!(
                module.entry_points.iter().any(|entry| entry.stage == stage),
                "{name}: no {stage:?} stage"
            );
        }
    }
}

#[test]
fn every_entry_point_translates_to_glsl_es_300() {
    let mut translated = 0;
    for (name, module, info) in shaders() {
        for entry in &module.entry_points {
            let (text, blocks) = glsl(name, &module, &info, entry);
            assert!(text.starts_with("#version 300 es"), "{name}, {}", entry.name);
            assert!(!text.contains("buffer "), "{name}, {}: WebGL2 has no storage buffers", entry.name);
            assert!(blocks <= 1, "{name}, {}: {blocks} uniform blocks", entry.name);
            translated += 1;
        }
    }
    assert!(translated >= 2 * SHADERS.len(), "{translated} entry points");
}

/// The stripped text has the meaning of the file.
#[test]
fn lean_shaders_translate_like_their_files() {
    for shader in SHADERS {
        assert!(!shader.lean.contains("//") && shader.lean.len() < shader.source.len(), "{}", shader.name);
        let (module, info) = validated(shader.name, shader.source);
        let (lean, lean_info) = validated(shader.name, shader.lean);
        assert_eq!(module.entry_points.len(), lean.entry_points.len(), "{}", shader.name);
        for (entry, lean_entry) in module.entry_points.iter().zip(&lean.entry_points) {
            assert_eq!(
                glsl(shader.name, &module, &info, entry),
                glsl(shader.name, &lean, &lean_info, lean_entry),
                "{}, {}",
                shader.name,
                entry.name
            );
        }
    }
}

/// Name and byte offset of each field of a struct, in order.
macro_rules! fields {
    ($type:ty: $($field:ident),+) => { &[$((stringify!($field), offset_of!($type, $field))),+] };
}

/// Every struct of the uniform block with its fields.
const STRUCTS: [(&str, &[(&str, usize)]); 7] = [
    ("Frame", fields!(Frame: camera, light, appearance, look, body, clip_box, plane)),
    ("Camera", fields!(Camera: clip_from_world, eye, perspective, forward, pixel_ratio, viewport, padding)),
    ("Light", fields!(Light: key, dim, sky, dim_backfaces, background, occlusion, warmth, rim, light_ground)),
    ("Appearance", fields!(Appearance: time, fade, level, mute)),
    ("Look", fields!(Look: disc_scale, flat_faces, edge_px, padding)),
    ("Body", fields!(Body: colour, is_open, lo, hi)),
    ("ClipBox", fields!(ClipBox: lo, hi, colour)),
];

#[test]
fn uniform_blocks_have_the_layout_of_the_rust_structs() {
    for (name, module, _) in shaders() {
        let frame = module
            .global_variables
            .iter()
            .find(|(_, variable)| variable.space == naga::AddressSpace::Uniform)
            .map(|(_, variable)| &module.types[variable.ty])
            .unwrap_or_else(|| panic!("{name}: no uniform block"));
        assert_eq!(frame.name.as_deref(), Some("Frame"), "{name}");
        assert_eq!(span(&frame.inner), size_of::<Frame>(), "{name}");
        for (struct_name, fields) in STRUCTS {
            let found = module
                .types
                .iter()
                .find(|(_, found)| found.name.as_deref() == Some(struct_name))
                .map(|(_, found)| &found.inner)
                .unwrap_or_else(|| panic!("{name}: no struct {struct_name}"));
            let TypeInner::Struct { members, .. } = found else {
                panic!("{name}: {struct_name} is no struct")
            };
            let members: Vec<(&str, usize)> = members
                .iter()
                .map(|member| (member.name.as_deref().unwrap_or(""), member.offset as usize))
                .collect();
            assert_eq!(members, fields, "{name}, {struct_name}");
        }
    }
}

fn span(inner: &TypeInner) -> usize {
    let TypeInner::Struct { span, .. } = inner else { panic!("no struct: {inner:?}") };
    *span as usize
}

/// The shaders declare the attributes that the pipelines provide.
#[test]
fn vertex_inputs_match_the_attribute_tables() {
    let mut checked = 0;
    for (name, module, _) in shaders() {
        for entry in module.entry_points.iter().filter(|entry| entry.stage == ShaderStage::Vertex) {
            let mut of = None;
            let inputs: Vec<(u32, usize)> = entry
                .function
                .arguments
                .iter()
                .filter_map(|argument| match &module.types[argument.ty].inner {
                    TypeInner::Struct { members, .. } => {
                        of = module.types[argument.ty].name.as_deref();
                        Some(members)
                    }
                    _ => None,
                })
                .flatten()
                .map(|member| {
                    let Some(naga::Binding::Location { location, .. }) = member.binding else {
                        panic!("{name}, {}: a member without a location", entry.name)
                    };
                    (location, components(&module.types[member.ty].inner))
                })
                .collect();
            if inputs.is_empty() {
                continue;
            }
            let [records, colours] = match of {
                Some("Face") => FACE,
                Some("Piece") => PIECE,
                _ => PARTICLE,
            };
            let table: Vec<(u32, usize)> =
                (0..).zip(records.iter().chain(colours).map(|&format| lanes_of(format))).collect();
            assert_eq!(inputs, table, "{name}, {}", entry.name);
            checked += 1;
        }
    }
    assert!(checked >= 4, "{checked} vertex stages read particles, faces or creases");
}

/// Number of `f32` components that the shader sees of an attribute.
fn lanes_of(format: AttributeFormat) -> usize {
    match format {
        AttributeFormat::Float32 => 1,
        AttributeFormat::Snorm16x2 => 2,
        AttributeFormat::Float32x3 => 3,
        AttributeFormat::Float32x4 | AttributeFormat::Unorm8x4 => 4,
    }
}

/// Number of `f32` components.
fn components(inner: &TypeInner) -> usize {
    match inner {
        TypeInner::Scalar(scalar) if scalar.kind == ScalarKind::Float => 1,
        TypeInner::Vector { size, scalar } if scalar.kind == ScalarKind::Float => match size {
            VectorSize::Bi => 2,
            VectorSize::Tri => 3,
            VectorSize::Quad => 4,
        },
        other => panic!("not a vector of floats: {other:?}"),
    }
}

/// naga accepts words that WGSL reserves as names, but browsers refuse them.
#[test]
fn no_name_is_a_reserved_word() {
    for Shader { name, source, .. } in SHADERS {
        let code: String =
            source.lines().map(|line| line.split("//").next().unwrap_or("")).collect::<Vec<_>>().join("\n");
        let words: Vec<&str> = code
            .split(|c: char| !(c.is_alphanumeric() || c == '_'))
            .filter(|word| !word.is_empty())
            .collect();
        assert!(words.contains(&"fn"), "{name}: no code found");
        for word in words {
            assert!(!RESERVED.contains(&word), "{name}: `{word}` is reserved");
        }
    }
}

/// WGSL, §16.2 "Reserved words".
const RESERVED: &[&str] = &[
    "NULL",
    "Self",
    "abstract",
    "active",
    "alignas",
    "alignof",
    "as",
    "asm",
    "asm_fragment",
    "async",
    "attribute",
    "auto",
    "await",
    "become",
    "binding_array",
    "cast",
    "catch",
    "class",
    "co_await",
    "co_return",
    "co_yield",
    "coherent",
    "column_major",
    "common",
    "compile",
    "compile_fragment",
    "concept",
    "const_cast",
    "consteval",
    "constexpr",
    "constinit",
    "crate",
    "debugger",
    "decltype",
    "delete",
    "demote",
    "demote_to_helper",
    "do",
    "dynamic_cast",
    "enum",
    "explicit",
    "export",
    "extends",
    "extern",
    "external",
    "fallthrough",
    "filter",
    "final",
    "finally",
    "friend",
    "from",
    "fxgroup",
    "get",
    "goto",
    "groupshared",
    "highp",
    "impl",
    "implements",
    "import",
    "inline",
    "instanceof",
    "interface",
    "layout",
    "lowp",
    "macro",
    "macro_rules",
    "match",
    "mediump",
    "meta",
    "mod",
    "module",
    "move",
    "mut",
    "mutable",
    "namespace",
    "new",
    "nil",
    "noexcept",
    "noinline",
    "nointerpolation",
    "non_coherent",
    "noncoherent",
    "noperspective",
    "null",
    "nullptr",
    "of",
    "operator",
    "package",
    "packoffset",
    "partial",
    "pass",
    "patch",
    "pixelfragment",
    "precise",
    "precision",
    "premerge",
    "priv",
    "protected",
    "pub",
    "public",
    "readonly",
    "ref",
    "regardless",
    "register",
    "reinterpret_cast",
    "require",
    "resource",
    "restrict",
    "self",
    "set",
    "shared",
    "sizeof",
    "smooth",
    "snorm",
    "static",
    "static_assert",
    "static_cast",
    "std",
    "subroutine",
    "super",
    "target",
    "template",
    "this",
    "thread_local",
    "throw",
    "trait",
    "try",
    "type",
    "typedef",
    "typeid",
    "typename",
    "typeof",
    "union",
    "unless",
    "unorm",
    "unsafe",
    "unsized",
    "use",
    "using",
    "varying",
    "virtual",
    "volatile",
    "wgsl",
    "where",
    "with",
    "writeonly",
    "yield",
];

/// The vertex and fragment stages of a file agree on the data that passes between them.
#[test]
fn stages_pass_on_the_same_struct() {
    for (name, module, _) in shaders() {
        let passed = |stage| {
            let mut types: Vec<_> = module
                .entry_points
                .iter()
                .filter(|entry| entry.stage == stage)
                .map(|entry| match stage {
                    ShaderStage::Vertex => entry.function.result.as_ref().expect("a vertex output").ty,
                    _ => entry.function.arguments[0].ty,
                })
                .map(|ty| module.types[ty].name.clone().unwrap_or_default())
                .collect();
            types.sort();
            types.dedup();
            types
        };
        assert_eq!(passed(ShaderStage::Vertex), passed(ShaderStage::Fragment), "{name}");
    }
}
