// Draws particles as discs in their tangent planes, and a ring around one of them. See src/render/mod.rs.

// A particle, as RECORD_ATTRIBUTES and COLOUR_ATTRIBUTES in src/render/layout.rs describe it.
struct Particle {
    @location(0) position: vec3<f32>,
    @location(1) radius: f32,
    @location(2) normal_oct: vec2<f32>,
    @location(3) birth: f32,
    @location(4) level: f32,
    @location(5) colour: vec4<f32>,
}

struct Disc {
    @builtin(position) clip: vec4<f32>,
    // Position in the plane of the disc. The rim is at length 1.
    @location(0) uv: vec2<f32>,
    // Linear colour, and the opacity: that of the colour times the progress of the appearance.
    @location(1) @interpolate(flat) colour: vec4<f32>,
    // Direction to the key light along (t, b, n), and 1 for a disc seen from behind.
    @location(2) @interpolate(flat) key: vec4<f32>,
    // Direction to the sky along (t, b, n), and 1 minus the cosine of the viewing angle: 0 face-on, 1 edge-on.
    @location(3) @interpolate(flat) sky: vec4<f32>,
    // Semi-axes of the ellipse on the screen in pixels: along t, along b.
    @location(4) @interpolate(flat) axes_px: vec2<f32>,
    // Fraction by which the disc fades to the background, because all do or because its level is not the newest.
    @location(5) @interpolate(flat) faded: f32,
}

// Padding of the quad beyond the rim, in pixels. Half a pixel holds the antialiased edge; the other half is a reserve,
// because a pixel is shaded only if its centre is in the quad.
const PAD_PX = 1.0;
// Largest extent of a quad in the plane of the disc, in radii. A larger quad is widened on the screen at constant
// depth: in the plane, the padding of a disc seen edge-on would cut through its neighbours.
const MAX_REACH = 2.0;
// Size of a disc at the start of its appearance, as a share of its final size.
const BIRTH_SIZE = 0.6;
// Tilt of the shading normal at the rim. It gives a large disc the look of a low dome.
const DOME = 0.34;
// Radii in pixels between which discs become points. Below the second a disc is enlarged, and at the first the gaps are
// closed: gaps of about a pixel would cause moiré. CLOSED is the enlargement at which three neighbours meet.
const SWELL_PX = vec2<f32>(0.8, 2.4);
const CLOSED = 1.26;
// Depth in radii that the core pass adds to points. Neighbours in the sheet then pass the depth test of the rim passes,
// which blend them, and the far side of the surface does not. Every pixel thus averages the points of the nearest
// sheet.
const POINT_DEPTH = 2.0;
// Radius of the dot of a particle on a crease, as a share of that of a disc: it is a bead on the line, which covers no neighbour. It is
// drawn nearer to the eye by its radius, so that the discs beside it do not cut it.
const DOT = 0.5;
// Smaller semi-axis in pixels up to which a disc covers no pixel completely, and from which it does.
const WIDE_PX = vec2<f32>(0.7, 1.7);
// Coverage from which a pixel belongs to the core: of a point, of a narrow disc, of a wide disc.
const CORE = vec3<f32>(0.15, 0.5, 0.96);

// Unit vector perpendicular to n and to the line of sight v: the axis of the disc that is not foreshortened.
fn facing_axis(n: vec3<f32>, v: vec3<f32>) -> vec3<f32> {
    var t = cross(n, v);
    if dot(t, t) < 1e-6 {
        // The disc is seen face-on, so any axis in its plane will do. Start from a world axis that is not along n.
        t = cross(n, select(vec3<f32>(1.0, 0.0, 0.0), vec3<f32>(0.0, 1.0, 0.0), abs(n.x) > 0.7));
    }
    return normalize(t);
}

// World direction d in clip coordinates.
fn clip_direction(d: vec3<f32>) -> vec4<f32> {
    let m = frame.camera.clip_from_world;
    return d.x * m[0] + d.y * m[1] + d.z * m[2];
}

// Derivative of the projection of `centre` on the screen, in pixels, along `direction` (both in clip coordinates).
fn moved_px(centre: vec4<f32>, direction: vec4<f32>) -> vec2<f32> {
    return 0.5 * frame.camera.viewport * (direction.xy - centre.xy * (direction.w / centre.w)) / centre.w;
}

// 1 for a point, 0 for a disc, by the larger semi-axis.
fn pointness(axes: vec2<f32>) -> f32 {
    return 1.0 - smoothstep(SWELL_PX.x, SWELL_PX.y, axes.x);
}

fn quad_corner(vertex: u32) -> vec2<f32> {
    return vec2<f32>(f32(vertex & 1u), f32(vertex >> 1u)) * 2.0 - 1.0;
}

@vertex
fn vs_core(@builtin(vertex_index) vertex: u32, particle: Particle) -> Disc {
    return disc_vertex(vertex, particle, POINT_DEPTH, 0.0);
}

// Rims seen from behind are drawn before those seen from the front. On a closed surface this is from back to front.
@vertex
fn vs_rim_behind(@builtin(vertex_index) vertex: u32, particle: Particle) -> Disc {
    return disc_vertex(vertex, particle, 0.0, -1.0);
}

@vertex
fn vs_rim_front(@builtin(vertex_index) vertex: u32, particle: Particle) -> Disc {
    return disc_vertex(vertex, particle, 0.0, 1.0);
}

// `side` is 1 to draw only discs seen from the front, -1 for those seen from behind, 0 for both.
fn disc_vertex(vertex: u32, particle: Particle, point_depth: f32, side: f32) -> Disc {
    var out: Disc;
    out.clip = hidden();
    let age = select(1.0, clamp((frame.appearance.time - particle.birth) / max(frame.appearance.fade, 1e-6), 0.0, 1.0), frame.appearance.fade > 0.0);
    let appear = age * age * (3.0 - 2.0 * age);
    let opacity = appear * particle.colour.a;
    let centre = frame.camera.clip_from_world * vec4<f32>(particle.position, 1.0);
    if particle.radius == 0.0 || particle.level > frame.appearance.level || opacity <= NOTHING || centre.w <= 0.0
        || beyond_plane(particle.position) > 0.0 {
        return out;
    }

    let v = toward_eye(particle.position);
    let is_dot = particle.radius < 0.0;
    let outward = select(oct_decode(particle.normal_oct), v, is_dot);
    let behind = dot(outward, v) < 0.0;
    if side * select(1.0, -1.0, behind) < 0.0 {
        return out;
    }
    let n = select(outward, -outward, behind);
    let t = facing_axis(n, v);
    let b = cross(n, t);
    let clip_t = clip_direction(t);
    let clip_b = clip_direction(b);
    let plain_r = abs(particle.radius) * select(1.0, DOT, is_dot) * frame.look.disc_scale * mix(BIRTH_SIZE, 1.0, appear);
    let plain_px = plain_r * moved_px(centre, clip_t);
    let swell = mix(CLOSED, 1.0, smoothstep(SWELL_PX.x, SWELL_PX.y, length(plain_px)));
    let r = swell * plain_r;
    let a_px = swell * plain_px;
    let b_px = r * moved_px(centre, clip_b);
    let axes = max(vec2<f32>(length(a_px), length(b_px)), vec2<f32>(1e-4));
    let a_dir = a_px / axes.x;
    // An axis that points at the eye has no direction on the screen.
    let b_dir = select(vec2<f32>(-a_dir.y, a_dir.x), b_px / axes.y, axes.y > 1e-3);

    let corner = quad_corner(vertex);
    let reach = 1.0 + PAD_PX / axes;
    let in_plane = corner * min(reach, vec2<f32>(MAX_REACH));
    let on_screen = corner * (reach - min(reach, vec2<f32>(MAX_REACH))) * axes;
    out.clip = centre + r * (in_plane.x * clip_t + in_plane.y * clip_b);
    out.clip += vec4<f32>((on_screen.x * a_dir + on_screen.y * b_dir) * 2.0 / frame.camera.viewport * out.clip.w, 0.0, 0.0);
    let deeper = out.clip - (point_depth * pointness(axes) - select(0.0, 1.0, is_dot)) * r * clip_direction(v);
    out.clip.z = deeper.z / deeper.w * out.clip.w;

    out.uv = corner * reach;
    out.colour = vec4<f32>(linear_from_srgb(particle.colour.rgb), opacity);
    out.key = vec4<f32>(dot(frame.light.key, t), dot(frame.light.key, b), dot(frame.light.key, n), select(0.0, 1.0, behind));
    let edge_on = 1.0 - dot(n, v);
    out.sky = vec4<f32>(dot(frame.light.sky, t), dot(frame.light.sky, b), dot(frame.light.sky, n), edge_on);
    out.axes_px = axes;
    out.faded = faded(particle.level);
    return out;
}

// Coverage of the pixel, from the distance to the rim in pixels. It takes derivatives, so call it in uniform control
// flow.
fn coverage(disc: Disc) -> f32 {
    let along_x = dpdx(disc.uv);
    let along_y = dpdy(disc.uv);
    let rho = max(length(disc.uv), 1e-6);
    let slope = length(vec2<f32>(dot(disc.uv, along_x), dot(disc.uv, along_y))) / rho;
    let inside_px = (1.0 - rho) / max(slope, 1e-6);
    // The distance is inaccurate for thin ellipses. The coverage is at most that of a band as wide as the ellipse.
    let widest = 0.5 + min(disc.axes_px.x, disc.axes_px.y);
    return clamp(min(0.5 + inside_px, widest), 0.0, 1.0);
}

fn shade(disc: Disc) -> vec3<f32> {
    let full = smoothstep(1.5, 6.0, min(disc.axes_px.x, disc.axes_px.y));
    let rho = min(length(disc.uv), 1.0);
    // The normal of the dome tilts outward by DOME at the rim.
    let lean = disc.uv / max(length(disc.uv), 1e-6) * rho * rho * DOME * full;
    let scale = inverseSqrt(1.0 + dot(lean, lean));
    let toward_key = (dot(lean, disc.key.xy) + disc.key.z) * scale;
    let toward_sky = (dot(lean, disc.sky.xy) + disc.sky.z) * scale;
    var light = brightness(toward_key, toward_sky, disc.sky.w);
    // The rim is darker, so that discs stand out from each other.
    light *= 1.0 - 0.24 * full * smoothstep(0.72, 1.0, rho);
    let front = disc.colour.rgb * light;
    let seen = inside(front, disc.key.w * frame.light.dim_backfaces);
    return fade_to(seen, frame.light.background.rgb, disc.faded);
}

// Degree from 0 to 1 to which a disc is wide enough to cover pixels completely.
fn fullness(disc: Disc) -> f32 {
    return smoothstep(WIDE_PX.x, WIDE_PX.y, min(disc.axes_px.x, disc.axes_px.y));
}

// Degree from 0 to 1 to which a disc is treated as a point. It reaches 1 halfway through the enlargement, so that
// sheets close before gaps become small.
fn as_point(disc: Disc) -> f32 {
    return smoothstep(0.0, 0.5, pointness(disc.axes_px));
}

@fragment
fn fs_core(disc: Disc) -> @location(0) vec4<f32> {
    let covered = coverage(disc) * disc.colour.a;
    if covered < mix(mix(CORE.y, CORE.z, fullness(disc)), CORE.x, as_point(disc)) {
        discard;
    }
    return vec4<f32>(shade(disc) * covered, covered);
}

@fragment
fn fs_rim(disc: Disc) -> @location(0) vec4<f32> {
    let covered = coverage(disc) * disc.colour.a;
    // All pixels of points are drawn again.
    let core = mix(mix(CORE.y, CORE.z, fullness(disc)), 1.01, as_point(disc));
    if covered >= core || covered < NOTHING {
        discard;
    }
    return vec4<f32>(shade(disc) * covered, covered);
}

struct Ring {
    @builtin(position) clip: vec4<f32>,
    // Offset from the centre in pixels along the axes of the ellipse.
    @location(0) offset_px: vec2<f32>,
    @location(1) @interpolate(flat) axes_px: vec2<f32>,
}

// Gap between ring and disc, and width of the ring, in page pixels.
const RING_GAP = 1.5;
const RING_WIDTH = 2.0;
// Smallest semi-axis of the ring, in page pixels, and smallest ratio of its semi-axes.
const RING_MIN = 4.0;
const RING_SQUASH = 0.35;

@vertex
fn vs_ring(@builtin(vertex_index) vertex: u32, particle: Particle) -> Ring {
    var out: Ring;
    out.clip = hidden();
    let centre = frame.camera.clip_from_world * vec4<f32>(particle.position, 1.0);
    if particle.radius == 0.0 || centre.w <= 0.0 {
        return out;
    }
    let v = toward_eye(particle.position);
    let is_dot = particle.radius < 0.0;
    let n = select(oct_decode(particle.normal_oct), v, is_dot);
    let t = facing_axis(n, v);
    let r = abs(particle.radius) * select(1.0, DOT, is_dot) * frame.look.disc_scale;
    let a_px = r * moved_px(centre, clip_direction(t));
    let a = max(length(a_px), 1e-4);
    let squash = max(abs(dot(n, v)), RING_SQUASH);
    let grow = (RING_GAP + 0.5 * RING_WIDTH) * frame.camera.pixel_ratio;
    out.axes_px = max(vec2<f32>(a, a * squash), vec2<f32>(RING_MIN * frame.camera.pixel_ratio)) + grow;
    out.offset_px = quad_corner(vertex) * (out.axes_px + 2.0 * RING_WIDTH * frame.camera.pixel_ratio);
    let a_dir = a_px / a;
    let screen = out.offset_px.x * a_dir + out.offset_px.y * vec2<f32>(-a_dir.y, a_dir.x);
    out.clip = centre + vec4<f32>(screen * 2.0 / frame.camera.viewport * centre.w, 0.0, 0.0);
    return out;
}

@fragment
fn fs_ring(ring: Ring) -> @location(0) vec4<f32> {
    // First-order distance to the ellipse.
    let p = ring.offset_px / ring.axes_px;
    let rho = max(length(p), 1e-4);
    let distance = abs((rho - 1.0) * rho / max(length(p / ring.axes_px), 1e-6));
    let half = 0.5 * RING_WIDTH * frame.camera.pixel_ratio;
    // A line that contrasts with the background has a thin casing like the background, so it is visible on any colour.
    let line = clamp(half + 0.5 - distance, 0.0, 1.0);
    let casing = 0.8 * clamp(half + 0.75 * frame.camera.pixel_ratio + 0.5 - distance, 0.0, 1.0);
    let ink = vec3<f32>(mix(1.0, 0.01, frame.look.light_ground));
    let ground = vec3<f32>(1.0) - ink;
    let alpha = max(line, casing);
    if alpha < NOTHING {
        discard;
    }
    return vec4<f32>(mix(ground, ink, line) * alpha, alpha);
}
