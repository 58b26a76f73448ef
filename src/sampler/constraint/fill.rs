//! Particles on corners and along creases.

use super::cell::{FacePair, Image};
use super::ladder::CreaseLadder;
use super::meeting::{ASIDE, FADED, Meeting};
use super::{Crease, Creases, ONE_CORNER};
use crate::math::{Bounds, sort_pairs};
use crate::particles::Particles;
use crate::sampler::probe::Probe;
use core::ops::Range;
use glam::{DVec3, Vec3};

/// A particle on a crease or a corner.
#[derive(Clone, Debug)]
pub(in super::super) struct CreaseParticle {
    pub(in super::super) position: Vec3,
    /// Half the distance to the next particles along the crease.
    pub(in super::super) radius: f32,
    /// Unit vector along the crease, or along one of those that meet at the corner.
    pub(in super::super) tangent: Vec3,
    /// The patches that meet there.
    pub(in super::super) patches: Vec<u32>,
}

impl CreaseParticle {
    /// The normal of the selected patch. If it is undefined, as at the tip of a cone, the normal at
    /// a point near the particle, along the crease if possible.
    pub(super) fn normal(&self, probe: &mut Probe) -> Option<Vec3> {
        probe.gradient(self.position).1.try_normalize().or_else(|| {
            // Double precision distinguishes places this close, however small the particle is.
            [self.tangent, -self.tangent, Vec3::X, Vec3::Y, Vec3::Z].into_iter().find_map(|way| {
                let aside = ASIDE * f64::from(self.radius) * way.as_dvec3();
                probe.count(1);
                let (_, gradient) = probe.field.value_and_gradient(self.position.as_dvec3() + aside);
                gradient.try_normalize().map(|normal| normal.as_vec3())
            })
        })
    }
}

/// The particles on creases, and the pairs of successive ones.
#[derive(Clone, Debug, Default)]
pub(in super::super) struct CreaseParticles {
    pub(in super::super) list: Vec<CreaseParticle>,
    pub(in super::super) segments: Vec<[u32; 2]>,
    /// For each segment, the patches on its left and on its right.
    sides: Vec<Vec<[u32; 2]>>,
    /// Points that divide every segment into 2ᵏ equal parts, segment by segment from its first end
    /// to its second.
    between: Vec<Vec3>,
}

/// A point of a curve that is being filled.
#[derive(Clone, Copy, Debug)]
struct CurvePoint {
    position: DVec3,
    /// Wanted radius of a particle.
    radius: f64,
    /// Number of particles that fit between the start and this point.
    room: f64,
}

impl Creases {
    /// Fills corners and curves with particles. `radius` gives the wanted radius at a point of a
    /// patch, and each curve gets the number of particles that comes closest to it. Points are also
    /// stored for `halvings` halvings of the way between two particles.
    ///
    /// `rounded` makes a whole number of the room on a curve.
    pub(in super::super) fn fill(
        &self,
        probe: &mut Probe,
        halvings: u32,
        rounded: fn(f64) -> f64,
        mut radius: impl FnMut(&mut Probe, Vec3) -> f32,
    ) -> CreaseParticles {
        let mut least = |probe: &mut Probe, place: DVec3, patches: &[u32]| {
            let mut of = |probe: &mut Probe, patch: u32| radius(&mut probe.on(Some(patch)), place.as_vec3());
            patches.iter().fold(f32::INFINITY, |least, &patch| least.min(of(probe, patch)))
        };
        let mut filled = CreaseParticles::default();
        for corner in &self.corners {
            let (position, radius) = match corner.image {
                Some(Image { of, pair }) => {
                    (self.faces[pair].repeated(filled.list[of].position), filled.list[of].radius)
                }
                None => {
                    let radius = least(probe, corner.position, &corner.patches);
                    (self.pinned(&corner.patches, corner.position.as_vec3()), radius)
                }
            };
            let patches = corner.patches.clone();
            filled.list.push(CreaseParticle { position, radius, tangent: Vec3::ZERO, patches });
        }
        // For each curve, its particles in order, and the points between them.
        let mut ways: Vec<(Vec<u32>, Range<usize>)> = Vec::with_capacity(self.curves.len());
        for curve in &self.curves {
            let start = filled.between.len();
            if let Some(Image { of, pair }) = curve.image {
                let (numbers, between) = &ways[of];
                let numbers =
                    self.repeat_curve(curve, &self.faces[pair], numbers, between.clone(), &mut filled);
                ways.push((numbers, start..filled.between.len()));
                continue;
            }
            let mut points: Vec<CurvePoint> = Vec::with_capacity(curve.points.len() + 1);
            for &position in curve.points.iter().chain(curve.is_closed.then(|| &curve.points[0])) {
                let radius = f64::from(least(probe, position, &curve.patches));
                let room = points.last().map_or(0.0, |last| {
                    last.room + position.distance(last.position) / (last.radius + radius)
                });
                points.push(CurvePoint { position, radius, room });
            }
            let numbers = self.fill_curve(probe, curve, &points, (halvings, rounded), &mut filled);
            ways.push((numbers, start..filled.between.len()));
        }
        filled
    }

    /// Repeats a curve with these particles on the opposite face of a cell. Returns the numbers of
    /// the images.
    fn repeat_curve(
        &self,
        curve: &Crease,
        pair: &FacePair,
        numbers: &[u32],
        between: Range<usize>,
        filled: &mut CreaseParticles,
    ) -> Vec<u32> {
        let last = numbers.len() - 1;
        let mut images: Vec<u32> = Vec::with_capacity(numbers.len());
        for (k, &number) in numbers.iter().enumerate() {
            let tangent = filled.list[number as usize].tangent;
            let corner = match k {
                0 => curve.corners[0],
                k if k == last => curve.corners[1],
                _ => None,
            };
            if let Some(corner) = corner {
                filled.list[corner].tangent = tangent;
                images.push(corner as u32);
            } else if curve.is_closed && k == last {
                images.push(images[0]);
            } else {
                images.push(filled.list.len() as u32);
                let CreaseParticle { position, radius, .. } = filled.list[number as usize];
                let (position, patches) = (pair.repeated(position), curve.patches.clone());
                filled.list.push(CreaseParticle { position, radius, tangent, patches });
            }
        }
        filled.between.extend_from_within(between.clone());
        let start = filled.between.len() - between.len();
        filled.between[start..].iter_mut().for_each(|p| *p = pair.repeated(*p));
        filled.add_segments(&images, &curve.sides);
        images
    }

    /// Fills a curve of these points; if it is closed, the last point repeats the first one.
    /// Returns the numbers of its particles.
    fn fill_curve(
        &self,
        probe: &mut Probe,
        curve: &Crease,
        points: &[CurvePoint],
        (halvings, rounded): (u32, fn(f64) -> f64),
        filled: &mut CreaseParticles,
    ) -> Vec<u32> {
        let others = filled.list.len();
        let room = points[points.len() - 1].room;
        // With two particles a closed curve would run back along itself.
        let least = if curve.is_closed { 3.0 } else { 1.0 };
        let parts = rounded(room).max(least) as usize;
        let mut numbers: Vec<u32> = Vec::with_capacity(parts + 1);
        let mut after = 1;
        let fine = parts << halvings;
        for k in 0..=fine {
            let target = room * k as f64 / fine as f64;
            while after + 1 < points.len() && points[after].room < target {
                after += 1;
            }
            let (a, b) = (points[after - 1], points[after]);
            let tangent = (b.position - a.position).normalize_or_zero().as_vec3();
            let is_end = k == 0 || k == fine;
            let corner = if is_end { curve.corners[usize::from(k == fine)] } else { None };
            if let Some(corner) = corner {
                filled.list[corner].tangent = tangent;
                numbers.push(corner as u32);
                continue;
            }
            if curve.is_closed && k == fine {
                numbers.push(numbers[0]);
                continue;
            }
            let share = ((target - a.room) / (b.room - a.room)).clamp(0.0, 1.0);
            let (place, radius) =
                (a.position.lerp(b.position, share), a.radius + (b.radius - a.radius) * share);
            // A point of the chord is moved to the curve. The ends of an open curve are exact
            // already, and lie on the box.
            let reach = a.position.distance(b.position);
            let found = if is_end {
                None
            } else if curve.is_smooth {
                Meeting::beside_chord(probe, curve.branches, place, b.position - a.position)
            } else {
                Meeting::of_branches(probe, curve.branches, place, reach, FADED).map(|found| found.position)
            };
            let position = found.unwrap_or(place).as_vec3();
            let position = self.pinned(&curve.patches, position);
            // Several creases may end at one point of the box.
            let is_there = |known: &CreaseParticle| {
                known.position.distance(position) <= ONE_CORNER as f32 * known.radius
            };
            if is_end && let Some(known) = filled.list[..others].iter().position(is_there) {
                let own = &mut filled.list[known].patches;
                own.extend_from_slice(&curve.patches);
                own.sort_unstable();
                own.dedup();
                numbers.push(known as u32);
                continue;
            }
            if !k.is_multiple_of(1 << halvings) {
                filled.between.push(position);
                continue;
            }
            numbers.push(filled.list.len() as u32);
            filled.list.push(CreaseParticle {
                position,
                radius: radius as f32,
                tangent,
                patches: curve.patches.clone(),
            });
        }
        filled.add_segments(&numbers, &curve.sides);
        numbers
    }
}

impl CreaseParticles {
    /// Adds the segments between successive particles, with the patches on their left and on their
    /// right.
    fn add_segments(&mut self, numbers: &[u32], sides: &[[u32; 2]]) {
        self.segments.extend(numbers.windows(2).map(|pair| [pair[0], pair[1]]));
        self.sides.resize(self.segments.len(), sides.to_vec());
    }

    /// Adds a row for each patch of each particle, patch by patch, to empty columns. Returns a unit
    /// vector along the crease for each row.
    pub(in super::super) fn add_rows(&self, probe: &mut Probe, particles: &mut Particles) -> Vec<Vec3> {
        // The patches of each particle, with its number.
        let of_particle = |(particle, k): (&CreaseParticle, u32)| {
            let patches = particle.patches.clone();
            patches.into_iter().map(move |patch| (patch, k))
        };
        let mut rows: Vec<(u32, u32)> = self.list.iter().zip(0..).flat_map(of_particle).collect();
        sort_pairs(&mut rows);
        rows.dedup();
        let mut first: Vec<Option<u32>> = vec![None; self.list.len()];
        let mut along = Vec::with_capacity(rows.len());
        for of_patch in rows.chunk_by(|a, b| a.0 == b.0) {
            let patch = Some(of_patch[0].0);
            let probe = &mut probe.on(patch);
            for &(_, k) in of_patch {
                let particle = &self.list[k as usize];
                let row = particles.len() as u32;
                let normal = particle.normal(probe).unwrap_or_default();
                particles.push_seed(particle.position, normal, particle.radius, patch);
                particles.twins.push(*first[k as usize].get_or_insert(row));
                along.push(particle.tangent);
            }
        }
        particles.segments.extend(
            self.segments.iter().map(|pair| {
                pair.map(|particle| first[particle as usize].expect("a particle lies on a patch"))
            }),
        );
        particles.sides.extend_from_slice(&self.sides);
        along
    }

    /// The particles on creases at every level of a refinement that starts from `rows`; only those
    /// in `bounds` if creases continue beyond the box.
    pub(in super::super) fn into_ladder(self, rows: &Particles, bounds: Option<&Bounds>) -> CreaseLadder {
        CreaseLadder::new(rows, self.between, bounds)
    }
}
