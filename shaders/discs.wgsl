// Draws particles as discs in their tangent planes or as spheres, the body beneath them, and a ring
// around one of them. See src/render/mod.rs.

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
    // First axis of the plane in world coordinates, and 1 for a disc seen from behind.
    @location(2) @interpolate(flat) t: vec4<f32>,
    // Second axis, and 1 minus the cosine of the viewing angle: 0 face-on, 1 edge-on.
    @location(3) @interpolate(flat) b: vec4<f32>,
    // Semi-axes of the ellipse on the screen in pixels: along t, along b.
    @location(4) @interpolate(flat) axes_px: vec2<f32>,
    // Fraction by which the disc fades to the background, because all do or because its level is not the newest.
    @location(5) @interpolate(flat) faded: f32,
    // Centre and radius of a sphere; the radius of a disc is 0.
    @location(6) @interpolate(flat) ball: vec4<f32>,
    // Depth by which it is drawn behind its place.
    @location(7) @interpolate(flat) sunk: f32,
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
const DOME = 0.26;
// Light that the rim of a large disc loses, and the share of the radius from which on it does.
const RIM_SHADE = 0.14;
const RIM_FROM = 0.72;
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
    return disc_vertex(vertex, particle, POINT_DEPTH, 0.0, false);
}

// Rims seen from behind are drawn before those seen from the front. On a closed surface this is from back to front.
@vertex
fn vs_rim_behind(@builtin(vertex_index) vertex: u32, particle: Particle) -> Disc {
    return disc_vertex(vertex, particle, 0.0, -1.0, false);
}

@vertex
fn vs_rim_front(@builtin(vertex_index) vertex: u32, particle: Particle) -> Disc {
    return disc_vertex(vertex, particle, 0.0, 1.0, false);
}

@vertex
fn vs_ball_core(@builtin(vertex_index) vertex: u32, particle: Particle) -> Disc {
    return disc_vertex(vertex, particle, POINT_DEPTH, 0.0, true);
}

@vertex
fn vs_ball_rim(@builtin(vertex_index) vertex: u32, particle: Particle) -> Disc {
    return disc_vertex(vertex, particle, 0.0, 0.0, true);
}

// Distance of the eye from the centre of a sphere, in radii. From farther away its rays are as good as parallel.
fn eye_distance(ball: vec4<f32>) -> f32 {
    return select(1e3, clamp(distance(frame.camera.eye, ball.xyz) / ball.w, 1.0001, 1e3), frame.camera.perspective > 0.5);
}

// Progress from 0 to 1 of the appearance of a particle.
fn appeared(birth: f32) -> f32 {
    let fade = frame.appearance.fade;
    let age = select(1.0, clamp((frame.appearance.time - birth) / max(fade, 1e-6), 0.0, 1.0), fade > 0.0);
    return age * age * (3.0 - 2.0 * age);
}

// `side` is 1 to draw only discs seen from the front, -1 for those seen from behind, 0 for both. With `spheres` a particle is drawn as
// the disc that its sphere covers, which faces the eye; one without a level is no particle of a surface and stays a disc.
fn disc_vertex(vertex: u32, particle: Particle, point_depth: f32, side: f32, spheres: bool) -> Disc {
    var out: Disc;
    out.clip = hidden();
    let appear = appeared(particle.birth);
    let opacity = appear * particle.colour.a;
    let centre = frame.camera.clip_from_world * vec4<f32>(particle.position, 1.0);
    if particle.radius == 0.0 || particle.level > frame.appearance.level || opacity <= NOTHING || centre.w <= 0.0
        || beyond_plane(particle.position) > 0.0 {
        return out;
    }

    let v = toward_eye(particle.position);
    let is_ball = spheres && particle.level >= 0.0;
    let is_dot = particle.radius < 0.0 && !is_ball;
    // A particle on a crease has no side.
    let outward = select(oct_decode(particle.normal_oct), v, particle.radius < 0.0);
    let behind = dot(outward, v) < 0.0;
    if side * select(1.0, -1.0, behind) < 0.0 {
        return out;
    }
    let n = select(select(outward, -outward, behind), v, is_ball);
    let t = facing_axis(n, v);
    let b = cross(n, t);
    let clip_t = clip_direction(t);
    let clip_b = clip_direction(b);
    var plain_r = abs(particle.radius) * select(1.0, DOT, is_dot) * frame.look.disc_scale * mix(BIRTH_SIZE, 1.0, appear);
    var widening = 1.0;
    if is_ball {
        // The outline of a sphere, seen from nearby, lies before its centre.
        let far = eye_distance(vec4<f32>(particle.position, plain_r));
        widening = far * inverseSqrt(far * far - 1.0);
        plain_r *= widening;
    }
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
    let push = (point_depth * pointness(axes) - select(0.0, 1.0, is_dot)) * r;
    let deeper = out.clip - push * clip_direction(v);
    let depth = deeper.z / deeper.w;
    out.sunk = depth - out.clip.z / out.clip.w;
    out.clip.z = depth * out.clip.w;
    out.ball = vec4<f32>(particle.position - push * v, select(0.0, r / widening, is_ball));

    out.uv = corner * reach;
    out.colour = vec4<f32>(linear_from_srgb(particle.colour.rgb), opacity);
    out.t = vec4<f32>(t, select(0.0, 1.0, behind));
    out.b = vec4<f32>(b, 1.0 - dot(n, v));
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

// `local` along the axes of the disc, in world coordinates.
fn world_of(disc: Disc, local: vec3<f32>) -> vec3<f32> {
    return local.x * disc.t.xyz + local.y * disc.b.xyz + local.z * cross(disc.t.xyz, disc.b.xyz);
}

// Colour of a disc. `slope` is the change of its depth to the next pixel.
fn shade(disc: Disc, slope: f32) -> vec3<f32> {
    let full = smoothstep(1.5, 6.0, min(disc.axes_px.x, disc.axes_px.y));
    let rho = min(length(disc.uv), 1.0);
    // The normal of the dome tilts outward by DOME at the rim.
    let lean = disc.uv / max(length(disc.uv), 1e-6) * rho * rho * DOME * full;
    let rim = 1.0 - RIM_SHADE * full * smoothstep(RIM_FROM, 1.0, rho);
    let open = openness(disc.clip.xy, disc.clip.z - disc.sunk, slope);
    return lit(disc, normalize(world_of(disc, vec3<f32>(lean, 1.0))), disc.b.w, open) * rim;
}

// Colour with a unit normal in world coordinates. `open` is the share of the light from all around
// that reaches it.
fn lit(disc: Disc, n: vec3<f32>, edge_on: f32, open: f32) -> vec3<f32> {
    let seen = inside(disc.colour.rgb * light_on(n, edge_on, open), disc.t.w * frame.light.dim_backfaces);
    return fade_to(seen, frame.light.background.rgb, disc.faded);
}

// Degree from 0 to 1 to which a disc is wide enough to cover pixels completely.
fn fullness(disc: Disc) -> f32 {
    return smoothstep(WIDE_PX.x, WIDE_PX.y, min(disc.axes_px.x, disc.axes_px.y));
}

// Coverage from which a pixel belongs to the core.
fn core_of(disc: Disc, of_points: f32) -> f32 {
    return mix(mix(CORE.y, CORE.z, fullness(disc)), of_points, as_point(disc));
}

// Degree from 0 to 1 to which a disc is treated as a point. It reaches 1 halfway through the enlargement, so that
// sheets close before gaps become small.
fn as_point(disc: Disc) -> f32 {
    return smoothstep(0.0, 0.5, pointness(disc.axes_px));
}

// Coverage of a pixel that belongs to the core, or, with `rim`, of one that does not; 0 for the others. All pixels of points are drawn
// in both passes.
fn covered_in(disc: Disc, rim: bool) -> f32 {
    let covered = coverage(disc) * disc.colour.a;
    let core = core_of(disc, select(CORE.x, 1.01, rim));
    return select(0.0, covered, (covered < core) == rim);
}

@fragment
fn fs_core(disc: Disc) -> @location(0) vec4<f32> {
    return painted(disc, covered_in(disc, false));
}

@fragment
fn fs_rim(disc: Disc) -> @location(0) vec4<f32> {
    return painted(disc, covered_in(disc, true));
}

fn painted(disc: Disc, covered: f32) -> vec4<f32> {
    let slope = fwidth(disc.clip.z);
    if covered < NOTHING {
        discard;
    }
    return vec4<f32>(shade(disc, slope) * covered, covered);
}

// Normal of a sphere where the ray through the pixel meets it, along the axes of its disc.
fn ball_normal(disc: Disc) -> vec3<f32> {
    let far = eye_distance(disc.ball);
    let far_sq = far * far;
    let rho_sq = min(dot(disc.uv, disc.uv), 1.0);
    // Where the ray meets the plane of the disc, which goes through the centre, in radii of the sphere.
    let met = disc.uv * sqrt(far_sq / (far_sq - 1.0));
    let along = (far_sq - far * sqrt(1.0 - rho_sq)) / (dot(met, met) + far_sq);
    return normalize(vec3<f32>(along * met, far * (1.0 - along)));
}

// Depth of a place.
fn depth_at(place: vec3<f32>) -> f32 {
    let clip = frame.camera.clip_from_world * vec4<f32>(place, 1.0);
    return clip.z / clip.w;
}

struct Pixel {
    @location(0) colour: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn fs_ball_core(disc: Disc) -> Pixel {
    return painted_ball(disc, false);
}

@fragment
fn fs_ball_rim(disc: Disc) -> Pixel {
    return painted_ball(disc, true);
}

fn painted_ball(disc: Disc, rim: bool) -> Pixel {
    let covered = covered_in(disc, rim);
    let slope_of_disc = fwidth(disc.clip.z);
    if covered < NOTHING {
        discard;
    }
    if disc.ball.w == 0.0 {
        return Pixel(vec4<f32>(shade(disc, slope_of_disc) * covered, covered), disc.clip.z);
    }
    let local = ball_normal(disc);
    let n = world_of(disc, local);
    let depth = depth_at(disc.ball.xyz + disc.ball.w * n);
    let slope = abs(depth_at(disc.ball.xyz) - depth) / min(disc.axes_px.x, disc.axes_px.y);
    return Pixel(vec4<f32>(lit(disc, n, 1.0 - local.z, openness(disc.clip.xy, depth, slope)) * covered, covered), depth);
}

struct Nearest {
    @location(0) texel: vec2<u32>,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn fs_ball_nearest(disc: Disc) -> Nearest {
    if coverage(disc) * disc.colour.a < 0.5 {
        discard;
    }
    let n = world_of(disc, select(ball_normal(disc), vec3<f32>(0.0, 0.0, 1.0), disc.ball.w == 0.0));
    let depth = select(depth_at(disc.ball.xyz + disc.ball.w * n), disc.clip.z, disc.ball.w == 0.0);
    return Nearest(texel_of(depth, n), depth);
}

// A disc of the body: a particle's disc, larger and a little behind.
struct Bed {
    @builtin(position) clip: vec4<f32>,
    // Position in the plane of the disc. The rim is at length 1.
    @location(0) uv: vec2<f32>,
    @location(1) place: vec3<f32>,
    // Unit normal on the side of the eye, and 1 minus the cosine of the viewing angle.
    @location(2) @interpolate(flat) n: vec4<f32>,
    // Shares by which it is drawn as an inside and fades to the background, and the depth by which
    // it is behind its place.
    @location(3) @interpolate(flat) seen: vec3<f32>,
    // Linear colour.
    @location(4) @interpolate(flat) colour: vec3<f32>,
}

// Radius of a bed in repulsion radii. In a hexagonal packing no place is farther than 1.15 r from a
// particle; where fronts meet they leave holes 1.5 times as wide, and the first row beside a crease
// is 1.7 r away from it. Larger: more pixels are drawn several times.
const BED_RADIUS = 1.75;
// Depths in radii by which a bed lies behind its place, along the normal and along the line of
// sight. A bed that touches the surface at its centre would cut through the neighbours' discs where
// the surface bends.
const BED_SUNK = 0.22;
const BED_BEHIND = 0.40;
// Radius of a bed seen edge-on, which stays behind the discs at the outline, and the cosine of the
// viewing angle from which on it has its full radius. On an open surface nothing hides it from
// behind, so it goes farther back there.
const OUTLINE_BED = vec2<f32>(0.88, 0.15);
const OPEN_OUTLINE_BED = vec2<f32>(1.20, 0.60);
// Cosines of the viewing angle between which a bed seen from behind becomes an inside. At the
// outline it has the tone of the beds beside it, which are seen from the front.
const INSIDE_FROM = vec2<f32>(0.15, 0.45);
// Share by which the body fades to the background where the surface is still to come.
const TO_COME = 0.72;
// Depth along the line of sight there: above the beds of the particles that are shown, so that the
// front ends at its discs.
const TO_COME_BEHIND = 0.2;
// Radius in pixels below which there is no bed: discs are enlarged there until they touch.
const LEAST_BED_PX = 0.8;

@vertex
fn vs_bed(@builtin(vertex_index) vertex: u32, particle: Particle) -> Bed {
    return bed_vertex(vertex, particle, 1.0, false);
}

@vertex
fn vs_bed_to_come(@builtin(vertex_index) vertex: u32, particle: Particle) -> Bed {
    return bed_vertex(vertex, particle, 1.0, true);
}

// In its place, where the discs find the openness that they look up by their depth.
@vertex
fn vs_bed_nearest(@builtin(vertex_index) vertex: u32, particle: Particle) -> Bed {
    return bed_vertex(vertex, particle, 0.0, false);
}

// `sunk` is the share of its depth below the surface.
fn bed_vertex(vertex: u32, particle: Particle, sunk: f32, to_come: bool) -> Bed {
    var out: Bed;
    out.clip = hidden();
    let place = frame.camera.clip_from_world * vec4<f32>(particle.position, 1.0);
    if particle.radius <= 0.0 || particle.level < 0.0 || frame.appearance.time < particle.birth || place.w <= 0.0 {
        return out;
    }
    let v = toward_eye(particle.position);
    let outward = oct_decode(particle.normal_oct);
    let facing = dot(outward, v);
    let is_open = frame.body.is_open > 0.5;
    if facing < 0.0 && !is_open {
        return out;
    }
    let n = select(outward, -outward, facing < 0.0);
    let t = facing_axis(n, v);
    let b = cross(n, t);
    let outline = select(OUTLINE_BED, OPEN_OUTLINE_BED, is_open);
    let r = particle.radius * mix(outline.x, BED_RADIUS, min(abs(facing) / outline.y, 1.0));
    if length(particle.radius * moved_px(place, clip_direction(t))) < LEAST_BED_PX {
        return out;
    }
    let uv = quad_corner(vertex);
    // Seen from both sides, it cannot be sunk to the other one.
    let down = select(BED_SUNK, 0.0, is_open) * sunk * particle.radius;
    let corner = particle.position - down * n + r * (uv.x * t + uv.y * b);
    let is_shown = !to_come && particle.level <= frame.appearance.level;
    let back = select(TO_COME_BEHIND, BED_BEHIND, is_shown) * sunk * particle.radius * v;
    let clip = frame.camera.clip_from_world * vec4<f32>(corner, 1.0);
    let deeper = frame.camera.clip_from_world * vec4<f32>(corner - back, 1.0);
    out.clip = vec4<f32>(clip.xy, deeper.z / deeper.w * clip.w, clip.w);
    out.uv = uv;
    out.place = corner;
    // It has the colour of the disc until that has appeared, so that a surface that takes the place
    // of another stays coloured; and where the disc is so narrow on the screen that the gaps beside
    // it fall between pixels, of which some would show the body and others not.
    let narrow_px = particle.radius * length(moved_px(place, clip_direction(b)));
    let has_gaps = select(1.0, smoothstep(SWELL_PX.x, SWELL_PX.y, narrow_px), is_shown);
    let share = min(appeared(particle.birth), has_gaps);
    out.colour = fade_to(linear_from_srgb(particle.colour.rgb), frame.body.colour, share);
    out.n = vec4<f32>(n, 1.0 - abs(facing));
    let behind = smoothstep(INSIDE_FROM.x, INSIDE_FROM.y, -facing) * frame.light.dim_backfaces;
    let at = particle.position - down * n - back;
    out.seen = vec3<f32>(behind, select(max(TO_COME, frame.light.dim), faded(particle.level), is_shown), depth_at(at) - place.z / place.w);
    return out;
}

// Whether the body ends before this pixel: at the rim of the bed, at the box or at the cutting
// plane.
fn is_beside(bed: Bed) -> bool {
    let is_in_box = all(bed.place >= frame.body.lo.xyz) && all(bed.place <= frame.body.hi.xyz);
    return dot(bed.uv, bed.uv) > 1.0 || !is_in_box || beyond_plane(bed.place) > 0.0;
}

@fragment
fn fs_bed(bed: Bed) -> @location(0) vec4<f32> {
    let slope = fwidth(bed.clip.z);
    if is_beside(bed) {
        discard;
    }
    let open = openness(bed.clip.xy, bed.clip.z - bed.seen.z, slope);
    let seen = inside(bed.colour * light_on(bed.n.xyz, bed.n.w, open), bed.seen.x);
    return vec4<f32>(fade_to(seen, frame.light.background.rgb, bed.seen.y), 1.0);
}

@fragment
fn fs_bed_nearest(bed: Bed) -> @location(0) vec2<u32> {
    if is_beside(bed) {
        discard;
    }
    return texel_of(bed.clip.z, bed.n.xyz);
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
    let ink = vec3<f32>(mix(1.0, 0.01, frame.light.light_ground));
    let ground = vec3<f32>(1.0) - ink;
    let alpha = max(line, casing);
    if alpha < NOTHING {
        discard;
    }
    return vec4<f32>(mix(ground, ink, line) * alpha, alpha);
}
