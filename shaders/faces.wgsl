// Draws the triangles of a mesh, with their edges and marks on vertices. See src/render/mod.rs.

// A triangle, counter-clockwise seen from outside, as FACE_ATTRIBUTES and TINT_ATTRIBUTES in src/render/layout.rs describe it.
struct Face {
    // Position of each corner, and its repulsion radius.
    @location(0) a: vec4<f32>,
    @location(1) b: vec4<f32>,
    @location(2) c: vec4<f32>,
    @location(3) normal_a: vec2<f32>,
    @location(4) normal_b: vec2<f32>,
    @location(5) normal_c: vec2<f32>,
    @location(6) level: f32,
    @location(7) colour_a: vec4<f32>,
    @location(8) colour_b: vec4<f32>,
    @location(9) colour_c: vec4<f32>,
    // Colour of the mark on each corner; without a mark its opacity is 0.
    @location(10) mark_a: vec4<f32>,
    @location(11) mark_b: vec4<f32>,
    @location(12) mark_c: vec4<f32>,
}

struct Point {
    @builtin(position) clip: vec4<f32>,
    // Barycentric coordinates.
    @location(0) weights: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) colour: vec3<f32>,
    @location(3) to_eye: vec3<f32>,
    // Squared lengths of the sides opposite to the corners.
    @location(4) @interpolate(flat) sides_sq: vec3<f32>,
    // Repulsion radii of the corners.
    @location(5) @interpolate(flat) radii: vec3<f32>,
    // Linear colours of the marks, with their opacities.
    @location(6) @interpolate(flat) mark_a: vec4<f32>,
    @location(7) @interpolate(flat) mark_b: vec4<f32>,
    @location(8) @interpolate(flat) mark_c: vec4<f32>,
    @location(9) @interpolate(flat) faded: f32,
    // See beyond_plane.
    @location(10) beyond: f32,
}

// Share of the way to the ink that the colour of a face goes on its edges.
const EDGE_INK = 0.62;
// Heights of a triangle in page pixels up to which no edge is drawn, and from which edges are drawn in full. In between, the
// edges of a fine mesh would fill its faces.
const EDGE_FADE_PX = vec2<f32>(2.5, 9.0);
// Radius of a mark: in repulsion radii, at least in page pixels, and at most in repulsion radii, so that marks on neighbours
// do not meet.
const MARK_RADIUS = 0.36;
const MARK_LEAST_PX = 2.0;
const MARK_MOST = 0.9;
// Width in page pixels of the casing around a mark, which has the colour of the background, and radii of marks in page pixels
// up to which there is none and from which there is all of it. Where marks are small, their casings would be all that is seen.
const MARK_CASING_PX = 1.0;
const MARK_CASED_PX = vec2<f32>(2.5, 4.5);

// A corner of a face: position and repulsion radius, normal, colour.
struct Corner {
    place: vec4<f32>,
    normal_oct: vec2<f32>,
    colour: vec4<f32>,
}

fn corner_of(face: Face, vertex: u32) -> Corner {
    if vertex == 1u {
        return Corner(face.b, face.normal_b, face.colour_b);
    }
    if vertex == 2u {
        return Corner(face.c, face.normal_c, face.colour_c);
    }
    return Corner(face.a, face.normal_a, face.colour_a);
}

// Whether a face is not drawn at all, because a corner has no radius or because it is beyond the cutting plane.
fn is_hidden(face: Face) -> bool {
    let beyond = min(beyond_plane(face.a.xyz), min(beyond_plane(face.b.xyz), beyond_plane(face.c.xyz)));
    return min(face.a.w, min(face.b.w, face.c.w)) <= 0.0 || beyond > 0.0;
}

@vertex
fn vs_face(@builtin(vertex_index) vertex: u32, face: Face) -> Point {
    var out: Point;
    out.clip = hidden();
    if is_hidden(face) || face.level > frame.appearance.level {
        return out;
    }
    let bc = face.c.xyz - face.b.xyz;
    let ca = face.a.xyz - face.c.xyz;
    let ab = face.b.xyz - face.a.xyz;
    out.sides_sq = vec3<f32>(dot(bc, bc), dot(ca, ca), dot(ab, ab));
    out.radii = vec3<f32>(face.a.w, face.b.w, face.c.w);

    let corner = corner_of(face, vertex);
    let position = corner.place.xyz;
    out.weights = vec3<f32>(f32(vertex == 0u), f32(vertex == 1u), f32(vertex == 2u));
    out.clip = frame.camera.clip_from_world * vec4<f32>(position, 1.0);
    out.beyond = beyond_plane(position);
    out.to_eye = toward_eye(position);
    out.normal = oct_decode(corner.normal_oct);
    out.colour = linear_from_srgb(corner.colour.rgb);
    if frame.look.flat_faces > 0.5 {
        // A flat face has one normal, and the mean colour of its corners.
        let across = cross(ab, -ca);
        out.normal = across / max(length(across), 1e-30);
        out.colour = (linear_from_srgb(face.colour_a.rgb) + linear_from_srgb(face.colour_b.rgb)
            + linear_from_srgb(face.colour_c.rgb)) / 3.0;
    }
    out.mark_a = vec4<f32>(linear_from_srgb(face.mark_a.rgb), face.mark_a.a);
    out.mark_b = vec4<f32>(linear_from_srgb(face.mark_b.rgb), face.mark_b.a);
    out.mark_c = vec4<f32>(linear_from_srgb(face.mark_c.rgb), face.mark_c.a);
    out.faded = faded(face.level);
    return out;
}

// Squared distances from the corners of a triangle, by barycentric coordinates.
fn corner_distances_sq(w: vec3<f32>, sides_sq: vec3<f32>) -> vec3<f32> {
    let next = w.yzx;
    let last = w.zxy;
    let side_next = sides_sq.yzx;
    let side_last = sides_sq.zxy;
    return next * next * side_last + last * last * side_next + next * last * (side_next + side_last - sides_sq);
}

// `under`, with the mark of a corner on it, if it has one. The corner's repulsion radius and its distance are in world units, of
// which a pixel has `per_px`. The face is turned to the eye by the cosine `facing`.
fn marked(under: vec3<f32>, mark: vec4<f32>, radius: f32, distance: f32, per_px: f32, facing: f32, light: vec3<f32>) -> vec3<f32> {
    if mark.a < 0.5 {
        return under;
    }
    let ratio = frame.camera.pixel_ratio;
    // Across a face seen from the side a pixel is long, along it is not: `facing` keeps the least size that of a circle.
    let rim = max(MARK_RADIUS * radius, min(MARK_LEAST_PX * ratio * per_px * facing, MARK_MOST * radius));
    let inside_px = (rim - distance) / per_px;
    let cased = smoothstep(MARK_CASED_PX.x, MARK_CASED_PX.y, rim / (per_px * ratio));
    let casing = clamp(inside_px + MARK_CASING_PX * ratio + 0.5, 0.0, 1.0) * cased;
    let dot_shade = mark.rgb * mix(vec3<f32>(1.0), light, 0.6);
    return mix(mix(under, frame.light.background.rgb, casing), dot_shade, clamp(inside_px + 0.5, 0.0, 1.0));
}

fn shade_face(point: Point, front: bool) -> vec3<f32> {
    // Derivatives are taken in uniform control flow.
    let along_x = dpdx(point.weights);
    let along_y = dpdy(point.weights);
    let slope = max(sqrt(along_x * along_x + along_y * along_y), vec3<f32>(1e-9));
    let distances = sqrt(max(corner_distances_sq(point.weights, point.sides_sq), vec3<f32>(0.0)));
    let rise_x = dpdx(distances);
    let rise_y = dpdy(distances);
    let per_px = max(sqrt(rise_x * rise_x + rise_y * rise_y), vec3<f32>(1e-9));

    let n = normalize(select(-point.normal, point.normal, front));
    let v = normalize(point.to_eye);
    let facing = clamp(dot(n, v), 0.0, 1.0);
    let open = openness(point.clip.xy, point.clip.z, fwidth(point.clip.z));
    let light = light_on(n, 1.0 - facing, open);
    var colour = point.colour * light;

    // Distances from the sides in pixels, and the heights over them.
    let ratio = frame.camera.pixel_ratio;
    let drawn = smoothstep(vec3<f32>(EDGE_FADE_PX.x * ratio), vec3<f32>(EDGE_FADE_PX.y * ratio), 1.0 / slope);
    let lines = clamp(vec3<f32>(0.5 * frame.look.edge_px * ratio + 0.5) - point.weights / slope, vec3<f32>(0.0), vec3<f32>(1.0)) * drawn;
    let line = max(lines.x, max(lines.y, lines.z)) * min(frame.look.edge_px, 1.0);
    colour = fade_to(colour, colour * 0.08, EDGE_INK * line);

    colour = marked(colour, point.mark_a, point.radii.x, distances.x, per_px.x, facing, light);
    colour = marked(colour, point.mark_b, point.radii.y, distances.y, per_px.y, facing, light);
    colour = marked(colour, point.mark_c, point.radii.z, distances.z, per_px.z, facing, light);

    let ground = frame.light.background.rgb;
    let seen = inside(colour, select(frame.light.dim_backfaces, 0.0, front));
    return fade_to(seen, ground, point.faded);
}

@fragment
fn fs_face(point: Point, @builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
    return vec4<f32>(shade_face(point, front), 1.0);
}

// Share of a pixel that is on the side of the cutting plane that is shown. It takes derivatives, so call it in uniform control flow.
fn shown_share(beyond: f32) -> f32 {
    let per_px = max(length(vec2<f32>(dpdx(beyond), dpdy(beyond))), 1e-20);
    return clamp(0.5 - beyond / per_px, 0.0, 1.0);
}

// A face that the cutting plane may cross. The opacity is the share of the pixel on the side that is shown.
@fragment
fn fs_cut_face(point: Point, @builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
    let colour = shade_face(point, front);
    let shown = shown_share(point.beyond);
    if shown < NOTHING {
        discard;
    }
    return vec4<f32>(colour, shown);
}

// What is nearest of the faces, for occlusion.wgsl.
@fragment
fn fs_nearest(point: Point) -> @location(0) vec2<u32> {
    if point.beyond > 0.0 {
        discard;
    }
    return texel_of(point.clip.z, point.normal);
}
