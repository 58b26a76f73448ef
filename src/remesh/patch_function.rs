//! The smooth function of a patch of faces: its zero set is a smooth surface through all vertices
//! of the patch that extends beyond its border.
//!
//! Each face has a quadratic function that vanishes at its three corners and bends as the normals
//! there turn. The function of the patch is the weighted mean of those of the faces nearby. The
//! weights are exp(−(d/τ)²), where d is the distance from a face; d² has a continuous gradient, so
//! the mean has one, too. Faces farther than the nearest one by a few τ do not count, however far
//! the point is from all of them.
//!
//! A *skirt* of further triangles continues each patch along its tangents, so that the function is
//! never evaluated far from a face.

use super::TriangleMesh;
use super::edges::{Edges, ends_of};
use super::tree::Tree;
use crate::math::{Sym3, median};
use glam::{DMat2, DVec2, DVec3};

/// The width τ of the weights divided by the median height of curved faces. Smaller values leave
/// facets visible, larger ones need more faces for each evaluation.
const WIDTH: f64 = 0.25;
/// Cosine of the largest angle between a face and the normal at its corner. Where faces turn
/// further, as around the tip of a cone, no normal exists.
const TIP: f64 = 0.88;
/// Largest (d² − d₀²)/τ² of a face that counts, where d₀ is the distance of the nearest one: a
/// weight below 1e-10 is far smaller than the rounding of single precision.
const REACH: f64 = 23.0;
/// Length of the skirt divided by the diagonal of the mesh: two particle diameters of a coarse
/// sampling.
pub(super) const SKIRT: f64 = 0.125;
/// Cosine of the largest angle between two border sides at a vertex whose skirts share a side.
const ROUND: f64 = 0.7;

/// The function of a patch.
pub(super) enum PatchFunction {
    /// A plane: its unit normal and a point.
    Plane { normal: DVec3, point: DVec3 },
    /// A mean of quadratic functions.
    Curved { quadrics: Vec<Quadric>, tree: Tree, width_sq: f64, bulge: f64 },
}

/// The function b + a·x + xᵀHx/2 with x = p − c.
pub(super) struct Quadric {
    middle: DVec3,
    value: f64,
    slope: DVec3,
    bend: Sym3<f64>,
}

/// Value, gradient and the mean Hessian of the quadratic functions, for the surface's curvature.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slope {
    pub(super) value: f64,
    pub(super) gradient: DVec3,
    pub(super) hessian: Sym3<f64>,
}

/// A triangle and the normals at its corners.
type Element = ([DVec3; 3], [DVec3; 3]);

impl PatchFunction {
    /// The function of these faces of a mesh with this diagonal. `is_inner` tells whether the patch
    /// continues beyond an edge, and `is_flat` which faces are not facets of a curve; `flat` is the
    /// largest distance of a vertex from a plane.
    pub(super) fn new(
        mesh: &TriangleMesh,
        edges: &Edges,
        faces: &[u32],
        is_inner: impl Fn(usize) -> bool,
        is_flat: &[bool],
        diagonal: f64,
        flat: f64,
    ) -> Self {
        let corners: Vec<[DVec3; 3]> =
            faces.iter().map(|&face| mesh.corners(&mesh.faces()[face as usize])).collect();
        let area: DVec3 = corners.iter().map(|[a, b, c]| (b - a).cross(c - a)).sum();
        if let Some(plane) = plane_of(&corners, area, flat) {
            return plane;
        }
        let normals = Normals::new(mesh, faces, &corners, is_flat);
        let mut elements: Vec<Element> = Vec::new();
        let mut heights = Vec::new();
        for (&face, &corners) in faces.iter().zip(&corners) {
            let [a, b, c] = corners;
            let across = (b - a).cross(c - a);
            let normal = across.normalize_or_zero();
            let own = mesh.faces()[face as usize].map(|vertex| {
                let at = normals.at(vertex);
                if is_flat[face as usize] || at.dot(normal) < TIP { normal } else { at }
            });
            if !is_flat[face as usize] {
                heights.push(across.length() / a.distance(b).max(b.distance(c)).max(c.distance(a)));
            }
            elements.push((corners, own));
        }
        let least = 1e-4 * diagonal;
        let width = WIDTH * median(heights).unwrap_or(least).max(least);
        elements.extend(skirt(mesh, edges, faces, is_inner, &normals, SKIRT * diagonal));
        let quadrics: Vec<Quadric> = elements.iter().map(|element| Quadric::new(element, width)).collect();
        let bulge = quadrics[..faces.len()].iter().map(|own| own.value.abs()).fold(0.0, f64::max);
        let corners: Vec<[DVec3; 3]> = elements.iter().map(|(corners, _)| *corners).collect();
        Self::Curved { quadrics, tree: Tree::new(&corners), width_sq: width * width, bulge }
    }

    /// Largest height of the surface above the middle of a face.
    pub(super) fn bulge(&self) -> f64 {
        match self {
            Self::Plane { .. } => 0.0,
            Self::Curved { bulge, .. } => *bulge,
        }
    }

    /// f, ∇f and the mean Hessian at a point.
    pub(super) fn at(&self, p: DVec3) -> Slope {
        match self {
            Self::Plane { normal, point } => {
                Slope { value: normal.dot(p - point), gradient: *normal, hessian: Sym3::default() }
            }
            Self::Curved { quadrics, tree, width_sq, .. } => {
                let nearest = tree.nearest(p).distance_sq;
                let mut sum = 0.0;
                let (mut value, mut gradient, mut turn) = (0.0, DVec3::ZERO, DVec3::ZERO);
                let mut hessian = Sym3::<f64>::default();
                tree.within(p, nearest + REACH * width_sq, |found| {
                    let weight = libm::exp((nearest - found.distance_sq) / width_sq);
                    let own = &quadrics[found.triangle as usize];
                    let Slope { value: f, gradient: g, hessian: h } = own.at(p);
                    // The gradient of the weight, divided by the weight.
                    let s = (found.point - p) * (2.0 / width_sq);
                    sum += weight;
                    value += weight * f;
                    gradient += weight * (g + f * s);
                    turn += weight * s;
                    hessian = sum_of(&hessian, &h, weight);
                });
                let value = value / sum;
                let gradient = (gradient - value * turn) / sum;
                Slope { value, gradient, hessian: hessian.map(|entry| entry / sum) }
            }
        }
    }
}

fn sum_of(a: &Sym3<f64>, b: &Sym3<f64>, weight: f64) -> Sym3<f64> {
    Sym3 {
        xx: a.xx + weight * b.xx,
        xy: a.xy + weight * b.xy,
        xz: a.xz + weight * b.xz,
        yy: a.yy + weight * b.yy,
        yz: a.yz + weight * b.yz,
        zz: a.zz + weight * b.zz,
    }
}

/// The plane of the faces, if they lie in one.
fn plane_of(corners: &[[DVec3; 3]], area: DVec3, flat: f64) -> Option<PatchFunction> {
    let normal = area.try_normalize()?;
    let all = corners.as_flattened();
    let point = corners[0][0];
    // Through the mean height of all corners.
    let mean = all.iter().map(|p| normal.dot(*p - point)).sum::<f64>() / all.len() as f64;
    let is_near = |p: &DVec3| (normal.dot(*p - point) - mean).abs() <= flat;
    let is_along = |[a, b, c]: &[DVec3; 3]| (*b - *a).cross(*c - *a).dot(normal) > 0.0;
    let is_plane = all.iter().all(is_near) && corners.iter().all(is_along);
    is_plane.then_some(PatchFunction::Plane { normal, point: point + mean * normal })
}

/// The normals of a patch at its vertices: means of the face normals there, with weights that are
/// exact for spheres and also for cylinders (N. Max, "Weights for Computing Vertex Normals from
/// Facet Normals", 1999). Where a plane turns into a curve, the normal is that of the plane.
struct Normals {
    vertices: Vec<u32>,
    normals: Vec<DVec3>,
}

impl Normals {
    fn new(mesh: &TriangleMesh, faces: &[u32], corners: &[[DVec3; 3]], is_flat: &[bool]) -> Self {
        let of_face = |face: &u32| mesh.faces()[*face as usize];
        let mut vertices: Vec<u32> = faces.iter().flat_map(of_face).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let count = vertices.len();
        let mut known = Self { normals: Vec::new(), vertices };
        // Sums over the flat faces, and over all faces.
        let mut sums = vec![[DVec3::ZERO; 2]; count];
        for (face, corners) in faces.iter().zip(corners) {
            for (k, vertex) in of_face(face).into_iter().enumerate() {
                let [u, v] = [1, 2].map(|step| corners[(k + step) % 3] - corners[k]);
                let normal = u.cross(v) / (u.length_squared() * v.length_squared());
                let own = &mut sums[known.place(vertex)];
                own[0] += if is_flat[*face as usize] { normal } else { DVec3::ZERO };
                own[1] += normal;
            }
        }
        let normal = |[flat, all]: [DVec3; 2]| flat.normalize_or(all.normalize_or_zero());
        known.normals = sums.into_iter().map(normal).collect();
        known
    }

    fn place(&self, vertex: u32) -> usize {
        self.vertices.partition_point(|&own| own < vertex)
    }

    fn at(&self, vertex: u32) -> DVec3 {
        self.normals[self.place(vertex)]
    }
}

/// The side of a face that lies on the border of a patch.
struct Rim {
    ends: [u32; 2],
    /// At both ends, the unit vector along the surface away from the patch.
    away: [DVec3; 2],
}

/// The triangles of the skirt of a patch, no longer than `length`. Between two nearby parts of the
/// border a skirt ends halfway.
fn skirt(
    mesh: &TriangleMesh,
    edges: &Edges,
    faces: &[u32],
    is_inner: impl Fn(usize) -> bool,
    normals: &Normals,
    length: f64,
) -> Vec<Element> {
    let place = |vertex: u32| mesh.vertices()[vertex as usize];
    let mut rims = Vec::new();
    for &face in faces {
        let of_face = &mesh.faces()[face as usize];
        for side in (0..3).filter(|&side| !is_inner(edges.of_face(face)[side as usize] as usize)) {
            let ends = ends_of(of_face, side);
            let [a, b] = ends.map(place);
            // The face lies to the left of its sides.
            let away = ends.map(|end| (b - a).cross(normals.at(end)).normalize_or_zero());
            rims.push(Rim { ends, away });
        }
    }
    // For each vertex the border sides that begin or end there.
    let mut at_vertex: Vec<(u32, bool, usize)> = Vec::new();
    for (k, rim) in rims.iter().enumerate() {
        at_vertex.extend([(rim.ends[0], true, k), (rim.ends[1], false, k)]);
    }
    at_vertex.sort_unstable();
    let corners: Vec<[DVec3; 3]> =
        at_vertex.chunk_by(|a, b| a.0 == b.0).map(|own| [place(own[0].0); 3]).collect();
    let tree = Tree::new(&corners);
    let mut elements = Vec::new();
    let mut outer: Vec<[Option<DVec3>; 2]> = vec![[None; 2]; rims.len()];
    for (number, own) in at_vertex.chunk_by(|a, b| a.0 == b.0).enumerate() {
        let (p, normal) = (place(own[0].0), normals.at(own[0].0));
        let half = own.partition_point(|&(_, begins, _)| !begins);
        for (&(_, _, before), &(_, _, after)) in own[..half].iter().zip(&own[half..]) {
            let (u, v) = (rims[before].away[1], rims[after].away[0]);
            let mean = (u + v).normalize_or(u);
            let is_reflex = u.cross(v).dot(normal) < 0.0;
            let is_other = |vertex: u32| vertex != number as u32;
            let end = |way: DVec3| p + way * free_length(p, way, length, &tree, is_other);
            if is_reflex || u.dot(v) > ROUND {
                (outer[before][1], outer[after][0]) = (Some(end(mean)), Some(end(mean)));
                continue;
            }
            // At a corner of the patch a part of the tangent plane fills the space between skirts.
            let fan = [end(u), end(mean), end(v)];
            (outer[before][1], outer[after][0]) = (Some(fan[0]), Some(fan[2]));
            elements.extend(fan.array_windows().map(|&[a, b]| ([p, a, b], [normal; 3])));
        }
        // Parts of the patch may touch at a vertex only; a side left over there has no neighbour.
        for &(_, begins, k) in own {
            let side = usize::from(!begins);
            outer[k][side].get_or_insert(p + 0.5 * length * rims[k].away[side]);
        }
    }
    for (rim, ends) in rims.iter().zip(outer) {
        let [Some(c), Some(d)] = ends else { continue };
        let ([a, b], [m, n]) = (rim.ends.map(place), rim.ends.map(|end| normals.at(end)));
        elements.push(([b, a, c], [n, m, m]));
        elements.push(([b, c, d], [n, m, n]));
    }
    // A sliver gives no direction in which to bend.
    let has_area = |([a, b, c], _): &Element| {
        let longest = a.distance(*b).max(b.distance(*c)).max(c.distance(*a));
        (*b - *a).cross(*c - *a).length() > 1e-6 * longest * longest
    };
    elements.retain(has_area);
    elements
}

/// The room at `p` along `way`: the radius, at most `length`, of the largest ball that touches `p`
/// and holds none of the triangles for which `is_other` holds (J. Ma et al., "3D Medial Axis Point
/// Approximation Using Nearest Neighbors and the Normal Field", 2012). A vertex is such a triangle,
/// too.
pub(super) fn free_length(
    p: DVec3,
    way: DVec3,
    length: f64,
    others: &Tree,
    is_other: impl Fn(u32) -> bool,
) -> f64 {
    /// Rounds after which the ball is small enough.
    const ROUNDS: u32 = 12;
    let mut radius = length;
    for _ in 0..ROUNDS {
        let most = radius * radius * (1.0 - 1e-9);
        let Some(found) = others.nearest_of(p + radius * way, most, &is_other) else { break };
        let to = found.point - p;
        let along = to.dot(way);
        if along <= 0.0 {
            break;
        }
        radius = radius.min(to.length_squared() / (2.0 * along));
    }
    radius
}

impl Quadric {
    /// The function of a triangle. Its Hessian fits the normals by least squares, damped in
    /// directions in which the triangle is much narrower than the weights are wide.
    fn new((corners, normals): &Element, width: f64) -> Self {
        const DAMPING: f64 = 0.02;
        let middle = corners.iter().sum::<DVec3>() / 3.0;
        let [a, b, c] = *corners;
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let u = (b - a).normalize_or_zero();
        let v = normal.cross(u);
        let flat = |x: DVec3| DVec2::new(x.dot(u), x.dot(v));
        let x = corners.map(|corner| flat(corner - middle));
        let mean = normals.iter().map(|n| flat(*n)).sum::<DVec2>() / 3.0;
        let outer = |a: DVec2, b: DVec2| DMat2::from_cols(a * b.x, a * b.y);
        let (mut spread, mut turn) = (DMat2::ZERO, DMat2::ZERO);
        for (x, n) in x.iter().zip(normals) {
            spread += outer(*x, *x);
            turn += outer(flat(*n) - mean, *x);
        }
        let damped = |share: f64| spread + DMat2::from_diagonal(DVec2::splat(share * width * width));
        let bend = turn * damped(DAMPING).inverse();
        let bend = 0.5 * (bend + bend.transpose());
        // The values at the corners must vanish: the constant cancels their mean.
        let half = x.map(|x| 0.5 * x.dot(bend * x));
        let value = -half.iter().sum::<f64>() / 3.0;
        let lacking = x.iter().zip(half).map(|(x, half)| *x * -(half + value)).sum::<DVec2>();
        let slope = damped(1e-6).inverse() * lacking;
        let entry = |i: usize, j: usize| {
            let (p, q) = ([u[i], v[i]], [u[j], v[j]]);
            let bend = bend.to_cols_array_2d();
            (0..4).map(|k| bend[k / 2][k % 2] * p[k / 2] * q[k % 2]).sum()
        };
        Self { middle, value, slope: normal + slope.x * u + slope.y * v, bend: Sym3::by(entry) }
    }

    fn at(&self, p: DVec3) -> Slope {
        let x = p - self.middle;
        let bent = self.bend.apply(x);
        Slope {
            value: self.value + x.dot(self.slope + 0.5 * bent),
            gradient: self.slope + bent,
            hessian: self.bend,
        }
    }
}
