//! Particles on surfaces with creases, made by hand: rows along every crease, and a lattice on
//! every patch.

use glam::{DVec2, DVec3, Vec3};
use marching_particles::Bounds;
use marching_particles::field::Sym3;
use marching_particles::field::{Evaluator, Field, Frame, Jet, Pieces};
use marching_particles::particles::{Particles, Slots};

/// A crease: points in order along it, and the patches on its left and on its right.
pub(crate) struct Crease {
    pub(crate) points: Vec<DVec3>,
    pub(crate) patches: [u32; 2],
}

/// A surface of patches.
pub(crate) struct Creased {
    pub(crate) creases: Vec<Crease>,
    /// Points of each patch that lie on no crease.
    pub(crate) inner: Vec<(u32, DVec3)>,
    /// f and ∇f of a patch.
    pub(crate) branch: Branch,
    /// The patch that is nearest to a point.
    pub(crate) nearest: Nearest,
    pub(crate) area: f64,
    pub(crate) spacing: f64,
}

type Branch = Box<dyn Fn(u32, DVec3) -> (f64, DVec3) + Send + Sync>;
type Nearest = Box<dyn Fn(DVec3) -> u32 + Send + Sync>;

/// The field of a surface of patches: at each point that of the nearest patch.
pub(crate) struct CreasedField {
    branch: Branch,
    nearest: Nearest,
}

impl Field for CreasedField {
    fn value_and_gradient(&self, p: DVec3) -> (f64, DVec3) {
        (self.branch)((self.nearest)(p), p)
    }

    fn evaluator(&self, frame: Frame) -> Box<dyn Evaluator + '_> {
        Box::new(CreasedEvaluator { field: self, patch: None, frame, branch: None })
    }
}

/// The field, or the function of a patch.
struct CreasedEvaluator<'a> {
    field: &'a CreasedField,
    patch: Option<u32>,
    frame: Frame,
    branch: Option<Box<CreasedEvaluator<'a>>>,
}

/// The function of a patch, as a field.
struct PatchField<'a>(&'a CreasedField, u32);

impl Field for PatchField<'_> {
    fn value_and_gradient(&self, p: DVec3) -> (f64, DVec3) {
        (self.0.branch)(self.1, p)
    }
}

impl CreasedEvaluator<'_> {
    /// The function at a point.
    fn at(&self, p: DVec3) -> PatchField<'_> {
        PatchField(self.field, self.patch.unwrap_or_else(|| (self.field.nearest)(self.frame.place(p))))
    }
}

impl Evaluator for CreasedEvaluator<'_> {
    fn frame(&self) -> Frame {
        self.frame
    }

    fn another(&self) -> Box<dyn Evaluator + '_> {
        Box::new(CreasedEvaluator { field: self.field, patch: self.patch, frame: self.frame, branch: None })
    }

    fn values(&mut self, points: &[Vec3], value: &mut [f32]) {
        for (k, p) in points.iter().enumerate() {
            self.at(p.as_dvec3()).evaluator(self.frame).values(&[*p], &mut value[k..]);
        }
    }

    fn gradients(&mut self, points: &[Vec3], value: &mut [f32], gradient: &mut [Vec3]) {
        for (k, p) in points.iter().enumerate() {
            let field = self.at(p.as_dvec3());
            field.evaluator(self.frame).gradients(&[*p], &mut value[k..], &mut gradient[k..]);
        }
    }

    fn hessians(
        &mut self,
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
        hessian: &mut [Sym3<f32>],
    ) {
        for (k, p) in points.iter().enumerate() {
            let field = self.at(p.as_dvec3());
            let mut evaluator = field.evaluator(self.frame);
            evaluator.hessians(&[*p], &mut value[k..], &mut gradient[k..], &mut hessian[k..]);
        }
    }

    fn value_and_gradient(&mut self, p: DVec3) -> (f64, DVec3) {
        self.at(p).evaluator(self.frame).value_and_gradient(p)
    }

    fn jet(&mut self, p: DVec3) -> Jet {
        self.at(p).evaluator(self.frame).jet(p)
    }

    fn pieces(&mut self) -> Option<&mut dyn Pieces> {
        Some(self)
    }
}

/// The creases are those of the particles: nobody looks for them.
impl Pieces for CreasedEvaluator<'_> {
    fn edge_cells(&mut self, _: &Bounds, _: f64) -> Vec<Bounds> {
        unreachable!("the creases are given")
    }

    fn labels_in(&mut self, _: &Bounds) -> Option<Vec<u32>> {
        unreachable!("the creases are given")
    }

    fn label(&mut self, p: DVec3) -> u32 {
        (self.field.nearest)(self.frame.place(p))
    }

    fn piece(&mut self, label: u32) -> &mut dyn Evaluator {
        let (field, frame, patch) = (self.field, self.frame, Some(label));
        &mut **self.branch.insert(Box::new(Self { field, patch, frame, branch: None }))
    }
}

impl Creased {
    pub(crate) fn field(self) -> CreasedField {
        CreasedField { branch: self.branch, nearest: self.nearest }
    }

    pub(crate) fn particles(&self) -> Particles {
        // Each particle on a crease, with its patches.
        let mut places: Vec<(Vec3, Vec<u32>)> = Vec::new();
        let (mut pairs, mut sides) = (Vec::new(), Vec::new());
        for Crease { points, patches } in &self.creases {
            let mut last = None;
            for point in points {
                let place = point.as_vec3();
                let k =
                    places.iter().position(|(other, _)| other.distance(place) < 1e-5).unwrap_or_else(|| {
                        places.push((place, Vec::new()));
                        places.len() - 1
                    });
                let new = patches.iter().filter(|&patch| !places[k].1.contains(patch)).copied();
                let new: Vec<u32> = new.collect();
                places[k].1.extend(new);
                pairs.extend(last.replace(k).map(|from| [from, k]));
                sides.resize(pairs.len(), vec![*patches]);
            }
        }
        let mut particles = Particles::default();
        let push = |particles: &mut Particles, place: Vec3, patch: u32| {
            let normal = (self.branch)(patch, place.as_dvec3()).1.normalize_or_zero().as_vec3();
            let radius = 0.5 * self.spacing as f32;
            particles.push(place, normal, radius, Particles::NO_PARENT, 0, Slots::default());
            particles.patch.truncate(particles.len() - 1);
            particles.patch.push(patch);
        };
        let mut first_of = Vec::new();
        for (place, patches) in &places {
            let first = particles.len() as u32;
            first_of.push(first);
            for &patch in patches {
                push(&mut particles, *place, patch);
                particles.twins.push(first);
            }
        }
        particles.sides = sides;
        particles.segments = pairs.into_iter().map(|pair| pair.map(|k| first_of[k])).collect();
        for &(patch, point) in &self.inner {
            push(&mut particles, point.as_vec3(), patch);
        }
        particles
    }
}

/// Points along a way, evenly spaced by about `spacing`, both ends included.
fn along(from: DVec3, to: DVec3, spacing: f64) -> Vec<DVec3> {
    let count = (from.distance(to) / spacing).round().max(1.0) as u32;
    (0..=count).map(|k| from.lerp(to, f64::from(k) / f64::from(count))).collect()
}

/// Points round a circle, the first one repeated at the end.
fn around(centre: DVec3, x: DVec3, y: DVec3, spacing: f64) -> Vec<DVec3> {
    let count = (core::f64::consts::TAU * x.length() / spacing).round() as u32;
    let point = |k: u32| {
        let angle = core::f64::consts::TAU * f64::from(k % count) / f64::from(count);
        centre + x * libm::cos(angle) + y * libm::sin(angle)
    };
    (0..=count).map(point).collect()
}

/// A hexagonal lattice on a square around zero of half-width `half`, turned a little, so that it
/// fits no edge.
fn lattice(half: f64, spacing: f64) -> Vec<DVec2> {
    let count = (1.5 * half / spacing) as i32 + 2;
    let turn = DVec2::from_angle(0.2);
    let mut points = Vec::new();
    for row in -2 * count..=2 * count {
        for column in -2 * count..=2 * count {
            let shift = if row % 2 == 0 { 0.1 } else { 0.6 };
            let point = DVec2::new(f64::from(column) + shift, f64::from(row) * 0.75_f64.sqrt()) * spacing;
            points.push(turn.rotate(point));
        }
    }
    points
}

/// A flat face: the number of its plane, and loops of corners, counter-clockwise seen from outside
/// around the face.
pub(crate) type Face = (u32, Vec<Vec<DVec3>>);

fn plane_normal(face: &Face) -> DVec3 {
    let corners = &face.1[0];
    let area = |k: usize| (corners[k] - corners[0]).cross(corners[(k + 1) % corners.len()] - corners[0]);
    (0..corners.len()).map(area).sum::<DVec3>().normalize_or_zero()
}

fn distance_to(face: &Face, p: DVec3) -> f64 {
    let normal = plane_normal(face);
    let (mut nearest, mut turns) = (f64::INFINITY, 0.0);
    for corners in &face.1 {
        for (k, &a) in corners.iter().enumerate() {
            let b = corners[(k + 1) % corners.len()];
            let share = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            nearest = nearest.min(p.distance(a.lerp(b, share)));
            let flat = |q: DVec3| (q - p) - normal * (q - p).dot(normal);
            turns += libm::atan2(flat(a).cross(flat(b)).dot(normal), flat(a).dot(flat(b)));
        }
    }
    if turns > 3.0 { nearest.min((p - face.1[0][0]).dot(normal).abs()) } else { nearest }
}

/// The surface of a solid with flat faces, sampled with a `spacing`.
pub(crate) fn polyhedron(faces: Vec<Face>, spacing: f64) -> Creased {
    let mut creases: Vec<(DVec3, DVec3, Crease)> = Vec::new();
    let (mut inner, mut area) = (Vec::new(), 0.0);
    for face in &faces {
        let (patch, loops) = face;
        let normal = plane_normal(face);
        let (x, y) = normal.any_orthonormal_pair();
        let origin = loops[0][0];
        let flat = |p: DVec3| DVec2::new((p - origin).dot(x), (p - origin).dot(y));
        let mut sides = Vec::new();
        for corners in loops {
            for (k, &a) in corners.iter().enumerate() {
                let b = corners[(k + 1) % corners.len()];
                sides.push((flat(a), flat(b)));
                area += 0.5 * flat(a).perp_dot(flat(b)) * x.cross(y).dot(normal);
                let other = creases.iter_mut().find(|(from, to, _)| (*from, *to) == (b, a));
                match other {
                    Some((_, _, crease)) => crease.patches[1] = *patch,
                    None => {
                        creases.push((a, b, Crease { points: along(a, b, spacing), patches: [*patch; 2] }));
                    }
                }
            }
        }
        let distance = |p: DVec2, (a, b): (DVec2, DVec2)| {
            let share = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            p.distance(a.lerp(b, share))
        };
        let is_inside = |p: DVec2| {
            let crosses = |&&(a, b): &&(DVec2, DVec2)| {
                (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
            };
            sides.iter().filter(crosses).count() % 2 == 1
                && sides.iter().all(|&side| distance(p, side) > 0.6 * spacing)
        };
        let half = sides.iter().map(|side| side.0.length()).fold(0.0, f64::max);
        let points = lattice(half, spacing).into_iter().filter(|&p| is_inside(p));
        inner.extend(points.map(|p| (*patch, origin + x * p.x + y * p.y)));
    }
    let planes: Vec<(u32, DVec3, DVec3)> =
        faces.iter().map(|face| (face.0, plane_normal(face), face.1[0][0])).collect();
    let branch = move |patch: u32, p: DVec3| {
        let (_, normal, at) = planes.iter().find(|plane| plane.0 == patch).expect("a plane");
        (normal.dot(p - at), *normal)
    };
    let nearest = move |p: DVec3| {
        let distance = |face: &Face| distance_to(face, p);
        faces.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).expect("a face").0
    };
    let creases = creases.into_iter().map(|(_, _, crease)| crease).collect();
    Creased { creases, inner, branch: Box::new(branch), nearest: Box::new(nearest), area, spacing }
}

/// A prism over an outline, counter-clockwise in the plane, with holes, clockwise. Sides are of one
/// patch if they are of one plane.
pub(crate) fn prism(loops: &[&[[f64; 2]]], height: f64, spacing: f64) -> Creased {
    let at = |[x, y]: [f64; 2], z: f64| DVec3::new(x, y, z);
    let top = loops.iter().map(|outline| outline.iter().map(|&p| at(p, height)).collect()).collect();
    let bottom = loops.iter().map(|outline| outline.iter().rev().map(|&p| at(p, 0.0)).collect()).collect();
    let mut faces: Vec<Face> = vec![(7, top), (3, bottom)];
    let mut planes: Vec<(DVec3, f64)> = Vec::new();
    for outline in loops {
        for (k, &a) in outline.iter().enumerate() {
            let b = outline[(k + 1) % outline.len()];
            let mut face: Face = (0, vec![vec![at(a, 0.0), at(b, 0.0), at(b, height), at(a, height)]]);
            let normal = plane_normal(&face);
            let level = normal.dot(at(a, 0.0));
            let is_one =
                |other: &(DVec3, f64)| other.0.distance(normal) < 1e-9 && (other.1 - level).abs() < 1e-9;
            let number = planes.iter().position(is_one).unwrap_or_else(|| {
                planes.push((normal, level));
                planes.len() - 1
            });
            face.0 = 10 + number as u32;
            faces.push(face);
        }
    }
    polyhedron(faces, spacing)
}

/// A box with a corner at zero.
pub(crate) fn cuboid(size: [f64; 3], spacing: f64) -> Creased {
    let [x, y, z] = size;
    prism(&[&[[0.0, 0.0], [x, 0.0], [x, y], [0.0, y]]], z, spacing)
}

/// The union of two unit spheres around (0, 0, ±0.5).
pub(crate) fn two_spheres(spacing: f64) -> Creased {
    let centre = |patch: u32| DVec3::Z * if patch == 0 { -0.5 } else { 0.5 };
    let rim = 0.75_f64.sqrt();
    let points = around(DVec3::ZERO, DVec3::X * rim, DVec3::Y * rim, spacing);
    // Points of a spiral, each of which stands for the same area.
    let count = (4.0 * core::f64::consts::PI / (0.75_f64.sqrt() * spacing * spacing)) as u32;
    let on_sphere = |k: u32| {
        let z = 1.0 - (2.0 * f64::from(k) + 1.0) / f64::from(count);
        let angle = f64::from(k) * core::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * libm::cos(angle), r * libm::sin(angle), z)
    };
    let is_inner = |&(patch, p): &(u32, DVec3)| {
        let height = if patch == 0 { -p.z } else { p.z };
        let from_rim = DVec2::new(p.truncate().length() - rim, p.z).length();
        height > 0.0 && from_rim > 0.6 * spacing
    };
    let inner = (0..2).flat_map(|patch| (0..count).map(move |k| (patch, centre(patch) + on_sphere(k))));
    Creased {
        creases: vec![Crease { points, patches: [1, 0] }],
        inner: inner.filter(is_inner).collect(),
        branch: Box::new(move |patch, p| {
            let offset = p - centre(patch);
            (offset.length() - 1.0, offset.normalize_or_zero())
        }),
        nearest: Box::new(|p| u32::from(p.z > 0.0)),
        area: 6.0 * core::f64::consts::PI,
        spacing,
    }
}

/// A cube of side 2 around zero with a round hole of a radius along z.
pub(crate) fn drilled_cube(radius: f64, spacing: f64) -> Creased {
    const HOLE: u32 = 1;
    let mut solid = prism(&[&[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]], 2.0, spacing);
    let distance = |p: DVec3| p.truncate().length();
    solid.inner.retain(|&(patch, p)| patch >= 10 || distance(p) > radius + 0.6 * spacing);
    let (x, y) = (DVec3::X * radius, DVec3::Y * radius);
    for (patches, z) in [([3, HOLE], 0.0), ([HOLE, 7], 2.0)] {
        solid.creases.push(Crease { points: around(DVec3::Z * z, x, y, spacing), patches });
    }
    let count = (core::f64::consts::TAU * radius / spacing).round();
    let rows = (2.0 / (0.75_f64.sqrt() * spacing)).round();
    for row in 1..rows as u32 {
        for column in 0..count as u32 {
            let shift = f64::from(row % 2) * 0.5;
            let angle = core::f64::consts::TAU * (f64::from(column) + shift) / count;
            let p = x * libm::cos(angle) + y * libm::sin(angle) + DVec3::Z * (2.0 * f64::from(row) / rows);
            solid.inner.push((HOLE, p));
        }
    }
    let (flat, nearest) = (solid.branch, solid.nearest);
    solid.branch = Box::new(move |patch, p| {
        let of_hole = (radius - distance(p), -p.with_z(0.0).normalize_or_zero());
        if patch == HOLE { of_hole } else { flat(patch, p) }
    });
    solid.nearest = Box::new(move |p| {
        let from_top = (p.z - 1.0).abs() - 1.0;
        if radius - distance(p) > from_top.max(-radius) { HOLE } else { nearest(p) }
    });
    solid.area += core::f64::consts::PI * radius * (4.0 - 2.0 * radius);
    solid
}
