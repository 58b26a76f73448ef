// Draws lines as quads of constant width on the screen: the twelve edges of the clip box, and the creases of a surface.

// Width of an edge of the clip box and of a crease in page pixels.
const WIDTH = 1.25;
const CREASE_WIDTH = 1.5;
// Distance in radii by which a crease is drawn nearer to the eye, so that the faces and discs beside it do not cover it.
const CREASE_LIFT = 0.3;
// Smallest distance from the eye's plane at which an edge is drawn, as a share of the distance of its farther end.
const NEAR = 1e-3;

struct Edge {
    @builtin(position) clip: vec4<f32>,
    // Signed distance from the centre line in pixels, times w; see fs_line.
    @location(0) across_px: f32,
    @location(1) @interpolate(flat) half_px: f32,
    // Linear colour, not premultiplied by its opacity.
    @location(2) @interpolate(flat) colour: vec4<f32>,
}

// A piece of a crease, as LINE_ATTRIBUTES and COLOUR_ATTRIBUTES in src/render/layout.rs describe it: its ends, each with the radius of
// the particle there.
struct Piece {
    @location(0) start: vec4<f32>,
    @location(1) to: vec4<f32>,
    @location(2) colour: vec4<f32>,
}

// Position of end `end` (0 or 1) of edge `edge` (0 to 11); there are four edges along each axis.
fn edge_end(edge: u32, end: f32) -> vec3<f32> {
    let axis = edge >> 2u;
    let a = f32(edge & 1u);
    let b = f32((edge >> 1u) & 1u);
    var s = vec3<f32>(end, a, b);
    if axis == 1u {
        s = vec3<f32>(a, end, b);
    } else if axis == 2u {
        s = vec3<f32>(a, b, end);
    }
    return mix(frame.clip_box.lo.xyz, frame.clip_box.hi.xyz, s);
}

@vertex
fn vs_box(@builtin(vertex_index) vertex: u32, @builtin(instance_index) edge: u32) -> Edge {
    return line(vertex, edge_end(edge, 0.0), edge_end(edge, 1.0), WIDTH, frame.clip_box.colour);
}

@vertex
fn vs_crease(@builtin(vertex_index) vertex: u32, piece: Piece) -> Edge {
    var out: Edge;
    out.clip = hidden();
    if beyond_plane(0.5 * (piece.start.xyz + piece.to.xyz)) > 0.0 {
        return out;
    }
    let start = piece.start.xyz + CREASE_LIFT * piece.start.w * toward_eye(piece.start.xyz);
    let to = piece.to.xyz + CREASE_LIFT * piece.to.w * toward_eye(piece.to.xyz);
    let colour = fade_to(linear_from_srgb(piece.colour.rgb), frame.light.background.rgb, frame.light.dim);
    return line(vertex, start, to, CREASE_WIDTH, vec4<f32>(colour, piece.colour.a));
}

fn line(vertex: u32, from_place: vec3<f32>, to_place: vec3<f32>, width: f32, colour: vec4<f32>) -> Edge {
    var out: Edge;
    out.clip = hidden();
    out.colour = colour;
    var start = frame.camera.clip_from_world * vec4<f32>(from_place, 1.0);
    var to = frame.camera.clip_from_world * vec4<f32>(to_place, 1.0);
    // Clip the part of the edge that is behind the eye.
    let near = NEAR * max(start.w, to.w);
    if near <= 0.0 {
        return out;
    }
    if start.w < near {
        start = mix(start, to, (near - start.w) / (to.w - start.w));
    } else if to.w < near {
        to = mix(to, start, (near - to.w) / (start.w - to.w));
    }
    let along_px = 0.5 * frame.camera.viewport * (to.xy / to.w - start.xy / start.w);
    let length_px = length(along_px);
    if length_px < 1e-3 {
        return out;
    }
    let along = along_px / length_px;
    let side = f32(vertex & 1u) * 2.0 - 1.0;
    let half_px = 0.5 * width * frame.camera.pixel_ratio;
    let reach_px = half_px + 1.0;
    let at = select(start, to, vertex > 1u);
    let outwards = select(-along, along, vertex > 1u);
    // Extend the edge by half its width past the corner, so that three edges meet without a notch.
    let shift_px = side * reach_px * vec2<f32>(-along.y, along.x) + half_px * outwards;
    out.clip = at + vec4<f32>(shift_px * 2.0 / frame.camera.viewport * at.w, 0.0, 0.0);
    out.across_px = side * reach_px * at.w;
    out.half_px = half_px;
    return out;
}

@fragment
fn fs_line(edge: Edge) -> @location(0) vec4<f32> {
    // Perspective interpolation of a value times w gives w times the value interpolated linearly on the screen. In the
    // fragment stage, clip.w is 1/w.
    let distance = abs(edge.across_px * edge.clip.w);
    let alpha = clamp(edge.half_px + 0.5 - distance, 0.0, 1.0) * edge.colour.a;
    if alpha < NOTHING {
        discard;
    }
    return vec4<f32>(edge.colour.rgb * alpha, alpha);
}
