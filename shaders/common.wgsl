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
    occlusion: f32,
    warmth: f32,
    rim: f32,
    light_ground: f32,
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
    padding: f32,
}

struct Body {
    colour: vec3<f32>,
    is_open: f32,
    lo: vec4<f32>,
    hi: vec4<f32>,
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
    body: Body,
    clip_box: ClipBox,
    plane: vec4<f32>,
}

@group(0) @binding(0) var<uniform> frame: Frame;

// What is nearest to the eye at every other pixel each way: the bits of its depth, and its normal or, once occlusion.wgsl has found
// it, its openness.
@group(1) @binding(0) var nearest: texture_2d<u32>;

// Coverage below which a pixel is discarded: half a step of an 8-bit channel.
const NOTHING = 0.002;
// Share of linear light by which each component of a linear sRGB colour adds to its luminance (Rec. 709).
const LUMINANCE = vec3<f32>(0.2126, 0.7152, 0.0722);
// What an inside keeps of its light and of its distance from grey. With more it is hard to tell
// from the front, with less the patterns on it drown; ambient occlusion darkens it besides.
const INSIDE_LIGHT = 0.6;
const INSIDE_CHROMA = 0.75;
// Light from below and from the sky above, and that of the key light. The sum is 1.34 where a
// surface faces key light and sky, so that the palettes, whose colours are no lighter than 0.9 in
// OKLab, seldom clip.
const GROUND_LIGHT = 0.32;
const SKY_LIGHT = 0.60;
const KEY_LIGHT = 0.74;
// Share of its half circle by which the key light reaches past the terminator, like light from a
// large source.
const WRAP = 0.30;
// Light that the outline loses.
const OUTLINE_SHADE = 0.14;
// Brightnesses between which the light goes from cool to warm.
const COOL_TO_WARM = vec2<f32>(0.35, 1.15);

// See oct_encode in src/render/layout.rs.
fn oct_encode(n: vec3<f32>) -> vec2<f32> {
    let e = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
    return select((1.0 - abs(e.yx)) * select(vec2<f32>(-1.0), vec2<f32>(1.0), e >= vec2<f32>(0.0)), e, n.z >= 0.0);
}

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

// Light on a surface with this unit normal, for each component of its colour. `edge_on` is 1 at the
// outline, and `open` the share of the light from all around that reaches it.
fn light_on(n: vec3<f32>, edge_on: f32, open: f32) -> vec3<f32> {
    let skyward = 0.5 + 0.5 * dot(frame.light.sky, n);
    let key = max((dot(frame.light.key, n) + WRAP) / (1.0 + WRAP), 0.0);
    let edge_sq = edge_on * edge_on;
    let direct = (mix(GROUND_LIGHT, SKY_LIGHT, skyward) + KEY_LIGHT * key * key) * (1.0 - OUTLINE_SHADE * edge_sq * edge_on);
    let light = (direct + frame.light.rim * edge_sq * edge_sq * skyward) * mix(1.0, open, frame.light.occlusion);
    let warmth = frame.light.warmth * (smoothstep(COOL_TO_WARM.x, COOL_TO_WARM.y, light) - 0.5);
    return light * (1.0 + warmth * vec3<f32>(0.6, 0.1, -1.0));
}

// Share by which a surface of this level fades to the background, because all do or because its level is not the newest.
fn faded(level: f32) -> f32 {
    let older = level >= 0.0 && level < frame.appearance.level;
    return max(frame.light.dim, select(0.0, frame.appearance.mute, older));
}

// A texel of `nearest`: a depth and a normal of any length.
fn texel_of(depth: f32, normal: vec3<f32>) -> vec2<u32> {
    return vec2<u32>(bitcast<u32>(depth), pack2x16snorm(oct_encode(normal)));
}

// Difference of depths up to which texels of `nearest` are of one surface, besides that by its slope.
const SAME_DEPTH = 3e-4;

// Mean openness over `width` texels each way around a place in texels, of those that are of the surface with this depth, as far as there
// are any. `slope` is the change of its depth from one texel to the next.
fn mean_openness(at: vec2<f32>, width: f32, depth: f32, slope: f32) -> f32 {
    let first = vec2<i32>(floor(at - 0.5 * width));
    let last = vec2<i32>(textureDimensions(nearest)) - 1;
    let across = i32(width) + 1;
    var sum = 0.0;
    var weights = 0.0;
    for (var k = 0; k < across * across; k++) {
        let texel = first + vec2<i32>(k % across, k / across);
        let found = textureLoad(nearest, clamp(texel, vec2<i32>(0), last), 0).xy;
        let share = clamp(0.5 * width + 0.5 - abs(vec2<f32>(texel) + 0.5 - at), vec2<f32>(0.0), vec2<f32>(1.0));
        let apart = abs(bitcast<f32>(found.x) - depth) / (SAME_DEPTH + 2.0 * width * slope);
        let weight = share.x * share.y * clamp(2.0 - apart, 1e-4, 1.0);
        sum += weight * bitcast<f32>(found.y);
        weights += weight;
    }
    return sum / weights;
}

// Share of the light from all around that reaches a pixel with this depth. `slope` is the change of the depth to the next pixel.
fn openness(pixel: vec2<f32>, depth: f32, slope: f32) -> f32 {
    return mean_openness(0.5 * pixel, 1.0, depth, 2.0 * slope);
}
