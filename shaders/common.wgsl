// What every shader begins with: the uniform block, and how colours are decoded, lit and faded. The shaders follow it as one
// text (see src/render/shaders.rs).

// Copies of the structs in src/render/frame.rs, which documents the fields. A test compares them.
struct Camera {
    clip_from_world: mat4x4<f32>,
    eye: vec3<f32>,
    perspective: f32,
    forward: vec3<f32>,
    pixel_ratio: f32,
    viewport: vec2<f32>,
    padding: vec2<f32>,
}

struct Light {
    key: vec3<f32>,
    dim: f32,
    sky: vec3<f32>,
    dim_backfaces: f32,
    background: vec4<f32>,
}

struct Appearance {
    time: f32,
    fade: f32,
    level: f32,
    mute: f32,
}

struct Look {
    disc_scale: f32,
    flat_faces: f32,
    edge_px: f32,
    light_ground: f32,
}

struct ClipBox {
    lo: vec4<f32>,
    hi: vec4<f32>,
    colour: vec4<f32>,
}

struct Frame {
    camera: Camera,
    light: Light,
    appearance: Appearance,
    look: Look,
    clip_box: ClipBox,
    plane: vec4<f32>,
}

@group(0) @binding(0) var<uniform> frame: Frame;

// Coverage below which a pixel is discarded: half a step of an 8-bit channel.
const NOTHING = 0.002;
// Share of linear light by which each component of a linear sRGB colour adds to its luminance (Rec. 709).
const LUMINANCE = vec3<f32>(0.2126, 0.7152, 0.0722);
// What an inside keeps of its light and of its distance from grey. Chosen by comparing pictures of the gyroid, Klein bottle,
// Neovius's and Clebsch's surfaces, decocube and bunny as discs and as mesh on both grounds: at a light of 0.3 the patterns on the
// inside drown, at 0.5 it is hard to tell from the front.
const INSIDE_LIGHT = 0.40;
const INSIDE_CHROMA = 0.5;

fn oct_decode(e: vec2<f32>) -> vec3<f32> {
    let z = 1.0 - abs(e.x) - abs(e.y);
    let fold = max(-z, 0.0);
    return normalize(vec3<f32>(e.x + select(fold, -fold, e.x >= 0.0), e.y + select(fold, -fold, e.y >= 0.0), z));
}

fn linear_from_srgb(c: vec3<f32>) -> vec3<f32> {
    return select(pow((c + 0.055) / 1.055, vec3<f32>(2.4)), c / 12.92, c <= vec3<f32>(0.04045));
}

// Position outside of the view volume, which culls the quad.
fn hidden() -> vec4<f32> {
    return vec4<f32>(0.0, 0.0, 2.0, 1.0);
}

// Distance from the cutting plane times the length of its normal: positive on the side that is hidden.
fn beyond_plane(position: vec3<f32>) -> f32 {
    return dot(frame.plane.xyz, position) - frame.plane.w;
}

// Mixes linear colours in steps that look even: the square root is close to the transfer function of sRGB.
fn fade_to(colour: vec3<f32>, other: vec3<f32>, share: f32) -> vec3<f32> {
    let root = mix(sqrt(colour), sqrt(other), share);
    return root * root;
}

// Colour of a side seen from behind: darker and greyer than the front, which reads as the unlit inside on a light and on a
// dark ground alike. Fading to a light ground instead would make the inside the brightest part of the picture.
fn inside(colour: vec3<f32>, share: f32) -> vec3<f32> {
    let grey = vec3<f32>(dot(colour, LUMINANCE));
    return mix(colour, mix(grey, colour, INSIDE_CHROMA) * INSIDE_LIGHT, share);
}

// Direction from a place to the eye.
fn toward_eye(position: vec3<f32>) -> vec3<f32> {
    return select(-frame.camera.forward, normalize(frame.camera.eye - position), frame.camera.perspective > 0.5);
}

// Brightness of a surface by the cosines of its normal with the directions to the key light and to the sky, darker at the
// silhouette, where `edge_on` is 1.
fn brightness(toward_key: f32, toward_sky: f32, edge_on: f32) -> f32 {
    let hemisphere = mix(0.46, 0.66, 0.5 + 0.5 * toward_sky);
    // Wrapped diffuse light reaches a little past the terminator, like light from a large source.
    let key = max((toward_key + 0.25) / 1.25, 0.0);
    return (hemisphere + 0.52 * key * key) * (1.0 - 0.30 * edge_on * edge_on * edge_on);
}

// Share by which a surface of this level fades to the background, because all do or because its level is not the newest.
fn faded(level: f32) -> f32 {
    let older = level >= 0.0 && level < frame.appearance.level;
    return max(frame.light.dim, select(0.0, frame.appearance.mute, older));
}
