// Finds how open a surface is to light from all around: at every texel of `nearest`, from what lies around it in the picture.

struct Corner {
    @builtin(position) clip: vec4<f32>,
}

// Reach of an occluder, as a share of half the shorter side of the picture at the depth of what it occludes. With half of it the
// channels of a gyroid stay as light as its outside.
const REACH = 0.8;
// Number of places looked at around a texel. Those of 4 × 4 texels form one spiral, in which each place follows the last by the golden
// angle, which spreads them evenly.
const PLACES = 16;
const TURN = 2.39996;
// Sine of the elevation up to which nothing is occluded, which hides that faces are flat.
const LEAST_RISE = 0.15;
// Light that is taken away if all places are occluded from straight above.
const STRENGTH = 4.0;

// One triangle that covers the picture.
@vertex
fn vs_cover(@builtin(vertex_index) vertex: u32) -> Corner {
    return Corner(vec4<f32>(f32(vertex & 1u) * 4.0 - 1.0, f32(vertex >> 1u) * 4.0 - 1.0, 0.0, 1.0));
}

// The camera's matrix, taken apart: clip coordinates are `along` times the distance d along the viewing direction, plus `offset`, plus
// the first two by `right` and `up`, which are perpendicular to it.
struct Lens {
    along: vec4<f32>,
    offset: vec4<f32>,
    right: vec3<f32>,
    up: vec3<f32>,
}

fn lens() -> Lens {
    let m = frame.camera.clip_from_world;
    let rows = transpose(m);
    let forward = frame.camera.forward;
    let along = m * vec4<f32>(forward, 0.0);
    return Lens(along, m[3], rows[0].xyz - along.x * forward, rows[1].xyz - along.y * forward);
}

// A place, and its clip coordinate w.
fn place_of(lens: Lens, texel: vec2<i32>, depth: f32) -> vec4<f32> {
    let size = vec2<f32>(textureDimensions(nearest));
    let at = (vec2<f32>(texel) + 0.5) / size * vec2<f32>(2.0, -2.0) + vec2<f32>(-1.0, 1.0);
    let d = (depth * lens.offset.w - lens.offset.z) / (lens.along.z - depth * lens.along.w);
    let w = lens.along.w * d + lens.offset.w;
    let across = at * w - lens.along.xy * d - lens.offset.xy;
    let place = d * frame.camera.forward + across.x / dot(lens.right, lens.right) * lens.right
        + across.y / dot(lens.up, lens.up) * lens.up;
    return vec4<f32>(place, w);
}

@fragment
fn fs_occlusion(corner: Corner) -> @location(0) vec2<u32> {
    let texel = vec2<i32>(corner.clip.xy);
    let found = textureLoad(nearest, texel, 0).xy;
    let depth = bitcast<f32>(found.x);
    if depth >= 1.0 {
        return vec2<u32>(found.x, bitcast<u32>(1.0));
    }
    let lens = lens();
    let here = place_of(lens, texel, depth);
    let seen = oct_decode(unpack2x16snorm(found.y));
    let n = select(-seen, seen, dot(seen, toward_eye(here.xyz)) > 0.0);
    let reach = REACH * here.w / max(length(lens.right), length(lens.up));
    let last = vec2<i32>(textureDimensions(nearest)) - 1;
    let reach_px = 0.5 * vec2<f32>(textureDimensions(nearest)) * reach * vec2<f32>(length(lens.right), length(lens.up)) / here.w;
    // In this order neighbours differ most.
    let order = ((texel.x & 3) * 4 + (texel.y & 3)) * 7 % 16;
    var taken = 0.0;
    for (var k = 0; k < PLACES; k++) {
        let number = f32(16 * k + order);
        let share = (number + 0.5) / f32(16 * PLACES);
        let angle = TURN * number;
        let other = clamp(vec2<i32>(corner.clip.xy + share * reach_px * vec2<f32>(cos(angle), sin(angle))), vec2<i32>(0), last);
        let way = place_of(lens, other, bitcast<f32>(textureLoad(nearest, other, 0).x)).xyz - here.xyz;
        let distance_sq = max(dot(way, way), 1e-30);
        let rise = dot(way, n) * inverseSqrt(distance_sq);
        taken += max(rise - LEAST_RISE, 0.0) * max(1.0 - distance_sq / (reach * reach), 0.0);
    }
    return vec2<u32>(found.x, bitcast<u32>(max(1.0 - STRENGTH * taken / f32(PLACES), 0.0)));
}

// Smoothes the openness: the mean over 4 × 4 texels, in which the pattern of the places repeats.
@fragment
fn fs_mean(corner: Corner) -> @location(0) vec2<u32> {
    let texel = vec2<i32>(corner.clip.xy);
    let found = textureLoad(nearest, texel, 0).xy;
    let depth = bitcast<f32>(found.x);
    if depth >= 1.0 {
        return found;
    }
    var step = vec2<f32>(1.0);
    for (var side = -1; side <= 1; side += 2) {
        let right = bitcast<f32>(textureLoad(nearest, texel + vec2<i32>(side, 0), 0).x);
        let up = bitcast<f32>(textureLoad(nearest, texel + vec2<i32>(0, side), 0).x);
        // On the side of another surface the step is large.
        step = min(step, abs(vec2<f32>(right, up) - depth));
    }
    return vec2<u32>(found.x, bitcast<u32>(mean_openness(corner.clip.xy, 4.0, depth, step.x + step.y)));
}
