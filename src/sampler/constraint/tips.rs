//! Tips: isolated points of the surface at which sheets end as cones, with one particle each.
//!
//! The *link* of a point is the intersection of the surface and a small sphere around it: around a
//! smooth point one circle, around a tip a closed curve for each *nappe*, the sheets that meet
//! there (J. Milnor, "Singular Points of Complex Hypersurfaces", §2, 1968). The particle of a tip
//! has a row for each nappe. On the link of each nappe, at the distance of neighbours, a ring of
//! particles is placed, from which the front grows.

use super::{AT_REST, ONE_CORNER};
use crate::math::newton::STEPS;
use crate::math::{Bounds, sort_pairs};
use crate::particles::{Particles, SlotFate, Slots};
use crate::sampler::probe::Probe;
use glam::{DMat3, DVec3, Vec3};

/// Divisions of each edge of an octahedron whose faces, projected onto the sphere, sample the link:
/// the narrowest nappe is three of them wide.
const DIVISIONS: i32 = 8;
/// Radius of the sphere that determines how many nappes a tip has, in spacings of the survey.
/// Rounded coefficients open a cone to a neck of a ten-thousandth of a spacing.
const SMALL: f64 = 1.0 / 32.0;
/// Rounds in which the place of a tip is found, each on a sphere a quarter as large as the one
/// before: the error falls with the square.
const ROUNDS: u32 = 10;
/// Determinant of the mean of nnᵀ over the normals n of a link below which the surface is smooth: a
/// cone flatter than 3°.
const SMOOTH: f64 = 1e-5;
/// Least cosine of the angle between a nappe's normals and their mean. It distinguishes the rows of
/// the tip on two nappes.
const LEAST_COSINE: f64 = 0.1;
/// Cosine of the angle within which nappes on a larger and a smaller sphere are the same: 45°.
const ONE_NAPPE: f64 = 0.7;
/// Least number of particles around a tip: three on a narrow cone would face away from each other.
/// With more, fewer particles have six neighbours.
pub(in super::super) const LEAST_RING: u32 = 4;
/// Largest distance of a ring from its tip, in spacings. A nappe narrower than 16° has no closer
/// one.
const FARTHEST: f64 = 1.4;

/// A point of the surface, by the unit vector to it from the centre of a sphere, with its unit
/// normal.
#[derive(Clone, Copy, Debug)]
struct LinkPoint {
    direction: DVec3,
    normal: DVec3,
}

/// A closed curve of the intersection of a sphere and the surface.
type Loop = Vec<LinkPoint>;

/// A tip.
#[derive(Clone, Debug)]
pub(in super::super) struct Tip {
    pub(in super::super) position: DVec3,
    /// The patch around it.
    pub(in super::super) patch: u32,
    /// Unit vectors towards the middle of each nappe, from the tip.
    nappes: Vec<DVec3>,
    /// Largest curvature of the nappes, times the distance from the tip.
    bend: f64,
}

impl Tip {
    /// The tip at a singular point of the selected patch; none if the patch is smooth or absent
    /// there, or its sheets are not cones that face different ways.
    pub(in super::super) fn at(
        probe: &mut Probe,
        patch: Option<u32>,
        position: DVec3,
        spacing: f64,
    ) -> Option<Self> {
        let radius = SMALL * spacing;
        let patch = patch.unwrap_or_else(|| probe.field.label(position));
        let link = link_on_patch(probe, patch, position, radius)?;
        let faces_out = |curve: &Loop| {
            let normal = mean(curve, |point| point.normal);
            curve.iter().all(|point| point.normal.dot(normal) > LEAST_COSINE)
        };
        let normals: Vec<DVec3> = link.iter().map(|curve| mean(curve, |point| point.normal)).collect();
        let faces_away =
            |(k, normal): (usize, &DVec3)| normals[..k].iter().all(|other| other.dot(*normal) < 0.0);
        let is_cone = normals.iter().enumerate().all(faces_away)
            && !link.is_empty()
            && link.iter().all(faces_out)
            && spread(&link).determinant() > SMOOTH;
        let nappes = link.iter().map(|curve| mean(curve, |point| point.direction)).collect();
        is_cone.then(|| Self { position, patch, nappes, bend: link.iter().map(bend).fold(0.0, f64::max) })
    }

    /// Whether a curvature at a point is no larger than a cone with this tip would have there.
    pub(in super::super) fn explains(&self, point: Vec3, curvature: f64) -> bool {
        /// The sheets may also bend by themselves.
        const MORE: f64 = 1.5;
        curvature * self.position.distance(point.as_dvec3()) <= MORE * self.bend
    }

    /// Largest distance of a tip from the place near which it is searched for, in spacings: the
    /// steps are at most 2, 2/4, 2/16, …
    pub(in super::super) const REACH: f64 = 8.0 / 3.0;

    /// The tip of the selected patch near `start`: the point in which the tangent planes around it
    /// meet.
    pub(in super::super) fn near(
        probe: &mut Probe,
        patch: Option<u32>,
        start: DVec3,
        spacing: f64,
    ) -> Option<Self> {
        let (mut position, mut radius) = (start, 2.0 * spacing);
        for _ in 0..ROUNDS {
            let link = link(probe, position, radius)?;
            let matrix = spread(&link);
            let count = link.iter().map(Vec::len).sum::<usize>() as f64;
            let right: DVec3 =
                link.iter().flatten().map(|point| point.normal * point.normal.dot(point.direction)).sum();
            let step = matrix.inverse() * (right * (radius / count));
            // Written so that NaN fails.
            if !(matrix.determinant() > SMOOTH && step.length() <= radius) {
                return None;
            }
            position += step;
            radius *= 0.25;
        }
        Self::at(probe, patch, position, spacing)
    }

    /// The nappes at a distance from the tip, in their order; none if the sphere of that radius has
    /// a different number.
    fn nappes(&self, probe: &mut Probe, distance: f64) -> Option<Vec<Loop>> {
        let mut open = link_on_patch(probe, self.patch, self.position, distance)?;
        if open.len() != self.nappes.len() {
            return None;
        }
        let own = |nappe: &DVec3| {
            let is_own = |curve: &Loop| mean(curve, |point| point.direction).dot(*nappe) > ONE_NAPPE;
            open.iter().position(is_own).map(|k| open.swap_remove(k))
        };
        self.nappes.iter().map(own).collect()
    }

    /// A ring around each nappe, on the patch of the tip. The distances along and around the nappe
    /// average one spacing.
    fn rings(&self, probe: &mut Probe, spacing: f64) -> Option<Vec<Ring>> {
        let nappes = self.nappes(probe, spacing)?;
        let ring = |curve: &Loop| {
            let parts = length(curve).round().max(LEAST_RING.into());
            let distance = spacing * 2.0 / (1.0 + length(curve) / parts);
            let point = |k| landed(probe, self.position, distance, along(curve, f64::from(k) / parts));
            let points = (0..parts as u32).map(point).collect::<Option<Loop>>()?;
            let place = |point: &LinkPoint| (self.position + point.direction * distance).as_vec3();
            let has_room = distance <= FARTHEST * spacing
                && points.iter().all(|point| {
                    probe.is_on_patch(place(point), point.normal.as_vec3(), distance as f32, Some(self.patch))
                });
            has_room.then_some(Ring { tip: 0, distance, points })
        };
        nappes.iter().map(ring).collect()
    }
}

/// A ring of particles on a nappe.
struct Ring {
    /// The row of the tip.
    tip: u32,
    /// Distance from the tip.
    distance: f64,
    points: Vec<LinkPoint>,
}

/// Adds a particle for each tip to columns that hold only particles on creases, and then a ring of
/// particles around each nappe. A tip without room for its rings gets none; one at which patches
/// meet has a particle already.
pub(in super::super) fn add(
    probe: &mut Probe,
    tips: &[Tip],
    mut radius: impl FnMut(&mut Probe, Vec3) -> f32,
    match_share: f32,
    bounds: &Bounds,
    particles: &mut Particles,
) {
    let mut rings: Vec<Ring> = Vec::new();
    for tip in tips {
        let probe = &mut probe.on(Some(tip.patch));
        let place = tip.position.as_vec3();
        let radius = radius(probe, place);
        let Some(around) = tip.rings(probe, 2.0 * f64::from(radius)) else { continue };
        let is_there = |&row: &usize| particles.local[row].distance(place) <= ONE_CORNER as f32 * radius;
        let rows: Vec<usize> = (0..particles.len()).filter(is_there).collect();
        let first = rows.first().map_or(particles.len() as u32, |&row| particles.twins[row]);
        let position = rows.first().map_or(place, |&row| particles.local[row]);
        let mut known =
            rows.into_iter().filter(|&row| particles.is_on(row, Some(tip.patch))).collect::<Vec<_>>();
        for mut ring in around {
            let normal = mean(&ring.points, |point| point.normal).as_vec3();
            let row = known.pop().unwrap_or(particles.len());
            if row == particles.len() {
                particles.push_seed(position, normal, radius, Some(tip.patch));
                particles.twins.push(first);
            }
            ring.tip = row as u32;
            particles.normal[row] = normal;
            // Its neighbours are known.
            let slots = &mut particles.slots[row];
            (0..Slots::COUNT).for_each(|k| slots.set(k, SlotFate::Matched));
            rings.push(ring);
        }
    }
    for Ring { tip, distance, points } in rings {
        let (others, apex) = (particles.len(), particles.local[tip as usize].as_dvec3());
        let radius = particles.radius[tip as usize];
        for (k, LinkPoint { direction, normal }) in points.into_iter().enumerate() {
            let (position, normal) = ((apex + direction * distance).as_vec3(), normal.as_vec3());
            let is_free = (0..others).all(|i| {
                particles.local[i].distance(position) > match_share * radius
                    || particles.normal[i].dot(normal) <= 0.0
            });
            if is_free && bounds.contains(position) {
                let mut slots = Slots::default();
                slots.set(0, SlotFate::Parent);
                if k < Slots::COUNT {
                    particles.slots[tip as usize].set(k, SlotFate::Added);
                }
                particles.push(position, normal, radius, tip, 1, slots);
            }
        }
    }
}

/// The sides of a closed curve: the pairs of successive points, and the last with the first.
fn sides(curve: &Loop) -> impl Iterator<Item = [&LinkPoint; 2]> {
    (0..curve.len()).map(|k| [&curve[k], &curve[(k + 1) % curve.len()]])
}

/// The unit vector along the mean of a vector over a curve.
fn mean(curve: &Loop, of: impl Fn(&LinkPoint) -> DVec3) -> DVec3 {
    let weighted = sides(curve).map(|[a, b]| (of(a) + of(b)) * a.direction.distance(b.direction));
    weighted.sum::<DVec3>().normalize_or_zero()
}

/// Largest curvature of a nappe across its rays, times the distance from the tip: how fast the
/// normal turns along the link.
fn bend(curve: &Loop) -> f64 {
    let turns = sides(curve).map(|[a, b]| a.normal.distance(b.normal) / a.direction.distance(b.direction));
    turns.fold(0.0, f64::max)
}

/// The mean of nnᵀ over the normals n of a link.
fn spread(link: &[Loop]) -> DMat3 {
    let (mut sum, mut count) = (DMat3::ZERO, 0.0);
    for n in link.iter().flatten().map(|point| point.normal) {
        sum += DMat3::from_cols(n * n.x, n * n.y, n * n.z);
        count += 1.0;
    }
    sum * (1.0 / count)
}

/// Length of a curve, in radii of its sphere.
fn length(curve: &Loop) -> f64 {
    sides(curve).map(|[a, b]| a.direction.distance(b.direction)).sum()
}

/// The direction at a share of the way along a curve.
fn along(curve: &Loop, share: f64) -> DVec3 {
    let mut left = share * length(curve);
    for [a, b] in sides(curve).map(|side| side.map(|point| point.direction)) {
        let side = a.distance(b);
        if left < side {
            return a.lerp(b, left / side);
        }
        left -= side;
    }
    curve[0].direction
}

/// The point of the surface on a sphere near a direction, by Newton's method along the sphere.
fn landed(probe: &mut Probe, centre: DVec3, radius: f64, direction: DVec3) -> Option<LinkPoint> {
    let mut d = direction.try_normalize()?;
    for _ in 0..STEPS {
        probe.count(1);
        let (value, gradient) = probe.field.value_and_gradient(centre + d * radius);
        let within = gradient - d * gradient.dot(d);
        let step = within * (value / (radius * within.length_squared()));
        d = (d - step).try_normalize()?;
        if step.length() <= AT_REST {
            return gradient.try_normalize().map(|normal| LinkPoint { direction: d, normal });
        }
    }
    None
}

/// The closed curves of the intersection of a sphere and the surface, on a grid of triangles; none
/// if f is undefined somewhere, or a point of the surface is not found.
fn link(probe: &mut Probe, centre: DVec3, radius: f64) -> Option<Vec<Loop>> {
    let mut values = vec![f64::INFINITY; (SIDE * SIDE * SIDE) as usize];
    // The segments of the link in the triangles, each as the two triangle sides that it connects,
    // in both directions.
    let mut ways: Vec<[u32; 2]> = Vec::new();
    for triangle in triangles() {
        for v in triangle {
            let value = &mut values[v as usize];
            if *value == f64::INFINITY {
                probe.count(1);
                *value = probe.field.value_and_gradient(centre + direction(v) * radius).0;
            }
            if value.is_nan() {
                return None;
            }
        }
        let is_inside = triangle.map(|v| values[v as usize] <= 0.0);
        let mut crossed = [[0, 1], [1, 2], [2, 0]]
            .into_iter()
            .filter(|&[a, b]: &[usize; 2]| is_inside[a] != is_inside[b])
            .map(|[a, b]| triangle[a].min(triangle[b]) << SHIFT | triangle[a].max(triangle[b]));
        if let (Some(one), Some(other)) = (crossed.next(), crossed.next()) {
            ways.extend([[one, other], [other, one]]);
        }
    }
    sort_pairs(&mut ways);
    let mut is_open = vec![true; ways.len()];
    let mut curves = Vec::new();
    // Two segments start at each side.
    for first in (0..ways.len()).step_by(2) {
        let (mut curve, mut next) = (Vec::new(), Some(first));
        while let Some(place) = next.filter(|&place| is_open[place]) {
            is_open[place] = false;
            let [a, b] = [ways[place][0] >> SHIFT, ways[place][0] & ((1 << SHIFT) - 1)];
            let (at_a, at_b) = (values[a as usize], values[b as usize]);
            let guess = direction(a).lerp(direction(b), at_a / (at_a - at_b));
            curve.push(landed(probe, centre, radius, guess)?);
            let ends = [place, place + 1].map(|way| ways.partition_point(|other| other[0] < ways[way][1]));
            next = ends.into_iter().find(|&end| is_open[end]);
        }
        if !curve.is_empty() {
            curves.push(curve);
        }
    }
    Some(curves)
}

/// The curves of the link of the selected branch on which it gives f; none if it gives f on only a
/// part of one.
fn link_on_patch(probe: &mut Probe, patch: u32, centre: DVec3, radius: f64) -> Option<Vec<Loop>> {
    let mut link = link(probe, centre, radius)?;
    let mut is_cut = false;
    link.retain(|curve| {
        let own = curve.iter().filter(|p| probe.field.label(centre + p.direction * radius) == patch).count();
        is_cut |= 0 < own && own < curve.len();
        own > 0
    });
    (!is_cut).then_some(link)
}

/// Number of values of a coordinate of a corner of the octahedron.
const SIDE: u32 = 2 * DIVISIONS as u32 + 1;
/// Bits that hold the number of a corner: 2¹³ is above 17³.
const SHIFT: u32 = 13;

/// The direction of a corner.
fn direction(corner: u32) -> DVec3 {
    let [x, y, z] = [corner / (SIDE * SIDE), corner / SIDE % SIDE, corner % SIDE].map(f64::from);
    (DVec3::new(x, y, z) - f64::from(DIVISIONS)).normalize_or_zero()
}

/// The triangles of an octahedron whose edges are divided, by the numbers of their corners.
fn triangles() -> impl Iterator<Item = [u32; 3]> {
    let signs = (0..8).map(|octant| [0, 1, 2].map(|axis| 1 - 2 * (octant >> axis & 1)));
    signs.flat_map(|[x, y, z]| {
        let corner = move |a: i32, b: i32| {
            let place = [x * a, y * b, z * (DIVISIONS - a - b)].map(|c| (c + DIVISIONS) as u32);
            (place[0] * SIDE + place[1]) * SIDE + place[2]
        };
        (0..DIVISIONS * DIVISIONS).flat_map(move |k| {
            let (a, b) = (k / DIVISIONS, k % DIVISIONS);
            let up = [corner(a, b), corner(a + 1, b), corner(a, b + 1)];
            let down = [corner(a + 1, b), corner(a + 1, b + 1), corner(a, b + 1)];
            [(1, up), (2, down)]
                .into_iter()
                .filter(move |(room, _)| a + b + room <= DIVISIONS)
                .map(|(_, t)| t)
        })
    })
}
