//! Opposite faces of a cell: the features on the lower face are repeated on the upper one.
//!
//! The creases and corners on an upper face are replaced by those of the lower face before any
//! particle is placed, so that the particles on both differ only by the shift. The particles inside
//! a face are repeated after the run has placed them.

use super::{Corner, Crease, Creases, ONE_END};
use crate::field::UnitCell;
use crate::math::{NONE, sort_by_key};
use crate::particles::{OppositeFaces, Particles};
use crate::sampler::probe::Probe;
use glam::{DVec3, Vec3};

/// Largest difference of a branch between a point and its image, as a share of its gradient: far
/// above rounding, far below the difference of another branch.
const SAME: f64 = 1e-4;

/// Two opposite faces of a cell that the solid reaches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in super::super) struct FacePair {
    axis: usize,
    /// The patches on the lower and on the upper face.
    patches: [u32; 2],
    /// The coordinate of either face.
    at: [f64; 2],
}

/// A crease or a corner that is the image of another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Image {
    /// Number of the other one, which precedes this one.
    pub(super) of: usize,
    /// Number of the pair of faces.
    pub(super) pair: usize,
}

impl FacePair {
    /// The patches of the image of a feature on these patches of the lower face.
    fn image_of(&self, patches: &[u32]) -> Vec<u32> {
        let [lower, upper] = self.patches;
        let mut image: Vec<u32> = patches.iter().map(|&p| if p == lower { upper } else { p }).collect();
        image.sort_unstable();
        image
    }

    /// The image of a point on the lower face.
    fn shifted(&self, mut p: DVec3) -> DVec3 {
        p[self.axis] = self.at[1];
        p
    }

    /// The image of a particle on the lower face.
    pub(super) fn repeated(&self, mut p: Vec3) -> Vec3 {
        p[self.axis] = self.at[1] as f32;
        p
    }
}

impl Creases {
    /// Replaces the features on the upper faces of a cell by the images of those on the lower ones,
    /// along every axis along which the cell repeats. Creases are searched for with this step. If
    /// the creases of two faces differ, they stay as they are.
    pub(super) fn repeat(&mut self, probe: &mut Probe, cell: &UnitCell, step: f64) {
        for axis in (0..3).filter(|&axis| cell.repeats[axis]) {
            if let Some(pair) = self.face_pair(probe, cell, axis, step)
                && let Some(repeated) = self.with_images(probe, pair, step)
            {
                *self = repeated;
            }
        }
    }

    /// The patches on the two faces of the cell across an axis, if both are there.
    fn face_pair(&self, probe: &mut Probe, cell: &UnitCell, axis: usize, step: f64) -> Option<FacePair> {
        let at = [cell.bounds.min[axis], cell.bounds.max[axis]];
        let mut of = |at: f64, outward: f64| {
            let slack = SAME * step;
            let is_in_plane = |p: &DVec3| (p[axis] - at).abs() <= slack;
            let mut patches = self.curves.iter().flat_map(|curve| curve.patches.iter().copied());
            patches.find(|patch| {
                let mut own = self.curves.iter().filter(|curve| curve.patches.contains(patch));
                own.clone().all(|curve| curve.points.iter().all(is_in_plane))
                    && own.next().is_some_and(|curve| {
                        let (_, gradient) = probe.on(Some(*patch)).field.value_and_gradient(curve.points[0]);
                        gradient.normalize_or_zero()[axis] * outward > 1.0 - SAME
                    })
            })
        };
        Some(FacePair { axis, patches: [of(at[0], -1.0)?, of(at[1], 1.0)?], at })
    }

    /// The creases with those on the upper of two faces replaced by images; none if the two faces
    /// differ.
    fn with_images(&self, probe: &mut Probe, pair: FacePair, step: f64) -> Option<Self> {
        let [lower, upper] = pair.patches;
        let mut faces = self.faces.clone();
        faces.push(pair);
        let Self { unit_cell, passed, bare, evaluations, .. } = *self;
        let mut next = Self { unit_cell, faces, passed, bare, evaluations, ..Self::default() };
        let number = next.faces.len() - 1;

        // An image lies on the upper face exactly if its original does, so that both go or stay.
        let mut place = vec![None; self.corners.len()];
        for (k, corner) in self.corners.iter().enumerate().filter(|(_, c)| !c.patches.contains(&upper)) {
            place[k] = Some(next.corners.len());
            let image = moved(corner.image, &place)?;
            next.corners.push(Corner { image, ..corner.clone() });
        }
        let kept = next.corners.len();
        let mut image = vec![None; self.corners.len()];
        for (k, corner) in self.corners.iter().enumerate().filter(|(_, c)| c.patches.contains(&lower)) {
            let position = pair.shifted(corner.position);
            if !is_same(probe, corner.patches.iter().filter(|&&p| p != lower), corner.position, position) {
                return None;
            }
            image[k] = Some(next.corners.len());
            let source = Some(Image { of: place[k]?, pair: number });
            next.corners.push(Corner { position, patches: pair.image_of(&corner.patches), image: source });
        }
        for (k, corner) in self.corners.iter().enumerate().filter(|(_, c)| c.patches.contains(&upper)) {
            let is_near = |image: &Corner| image.position.distance(corner.position) <= ONE_END * step;
            place[k] = Some(kept + next.corners[kept..].iter().position(is_near)?);
        }

        let mut curve_place = vec![None; self.curves.len()];
        for (k, curve) in self.curves.iter().enumerate().filter(|(_, c)| !c.patches.contains(&upper)) {
            curve_place[k] = Some(next.curves.len());
            let mut own = Crease { image: moved(curve.image, &curve_place)?, ..curve.clone() };
            own.corners.iter_mut().flatten().try_for_each(|corner| {
                *corner = place[*corner]?;
                Some(())
            })?;
            next.curves.push(own);
        }
        for (k, curve) in self.curves.iter().enumerate().filter(|(_, c)| c.patches.contains(&lower)) {
            let points: Vec<DVec3> = curve.points.iter().map(|&p| pair.shifted(p)).collect();
            let middle = points.len() / 2;
            let others = curve.patches.iter().filter(|&&p| p != lower);
            if !is_same(probe, others, curve.points[middle], points[middle]) {
                return None;
            }
            let mut corners = [None; 2];
            for (own, corner) in corners.iter_mut().zip(curve.corners) {
                *own = match corner {
                    Some(corner) => Some(image[corner]?),
                    None => None,
                };
            }
            let moved = |p: u32| if p == lower { upper } else { p };
            next.curves.push(Crease {
                branches: curve.branches.map(moved),
                patches: pair.image_of(&curve.patches),
                // On the opposite face the solid lies on the other side.
                sides: curve.sides.iter().map(|&[left, right]| [moved(right), moved(left)]).collect(),
                points,
                corners,
                is_closed: curve.is_closed,
                is_smooth: curve.is_smooth,
                image: Some(Image { of: curve_place[k]?, pair: number }),
            });
        }
        let mut replaced = self.curves.iter().filter(|curve| curve.patches.contains(&upper));
        let is_there = |curve: &Crease| {
            let position = curve.points[curve.points.len() / 2];
            next.has_point(position, curve.branches, step)
        };
        replaced.all(is_there).then_some(next)
    }

    /// The position of a particle on these patches, with the coordinates of the faces among them.
    pub(super) fn pinned(&self, patches: &[u32], mut p: Vec3) -> Vec3 {
        for pair in &self.faces {
            for (patch, at) in pair.patches.iter().zip(pair.at) {
                if patches.contains(patch) {
                    p[pair.axis] = at as f32;
                }
            }
        }
        p
    }

    /// Replaces the particles inside the upper faces by images of those inside the lower ones, and
    /// records which rows of both belong together. `corners` are those of the triangles over the
    /// rows, if there are any. Faces whose creases have different particles stay as they are.
    /// Returns whether any particle was replaced.
    pub(in super::super) fn repeat_faces(&self, particles: &mut Particles, corners: &mut Vec<u32>) -> bool {
        particles.opposite.clear();
        let mut repeats = Vec::new();
        for pair in &self.faces {
            if let Some(rows) = crease_pairs(particles, pair) {
                repeats.push(pair);
                let (axis, patches) = (pair.axis as u8, pair.patches);
                particles.opposite.push(OppositeFaces { axis, patches, rows });
            }
        }
        if repeats.is_empty() {
            return false;
        }
        let face_at = |row: usize, side: usize| {
            repeats.iter().position(|pair| pair.patches[side] == particles.patch[row])
        };
        let on_creases = particles.twins.len();
        let mut place: Vec<u32> = (0..particles.len() as u32).collect();
        let mut image = vec![NONE; particles.len()];
        for &[lower, upper] in particles.opposite.iter().flat_map(|faces| &faces.rows) {
            image[lower as usize] = upper;
        }
        let mut next = particles.clone();
        next.truncate(on_creases);
        for i in on_creases..particles.len() {
            if face_at(i, 1).is_some() {
                place[i] = NONE;
                continue;
            }
            place[i] = next.len() as u32;
            let pair = face_at(i, 0);
            let (mut position, normal) = (particles.local[i], particles.normal[i]);
            if let Some(k) = pair {
                position[repeats[k].axis] = repeats[k].at[0] as f32;
            }
            let parent = |of: &[u32]| of.get(particles.parent[i] as usize).copied().unwrap_or(NONE);
            let (radius, level, slots) = (particles.radius[i], particles.level[i], particles.slots[i]);
            next.push(position, normal, radius, parent(&place), level, slots);
            next.set_patch(next.len() - 1, particles.patch_of(i));
            let Some(k) = pair else { continue };
            image[i] = next.len() as u32;
            next.opposite[k].rows.push([place[i], image[i]]);
            let mut across = normal;
            across[repeats[k].axis] *= -1.0;
            next.push(repeats[k].repeated(position), across, radius, parent(&image), level, slots);
            next.set_patch(next.len() - 1, Some(repeats[k].patches[1]));
        }
        let mut repeated = Vec::with_capacity(corners.len());
        for triangle in corners.as_chunks::<3>().0 {
            if face_at(triangle[0] as usize, 1).is_some() {
                continue;
            }
            repeated.extend(triangle.map(|v| place[v as usize]));
            if face_at(triangle[0] as usize, 0).is_some() {
                let [a, b, c] = triangle.map(|v| image[v as usize]);
                repeated.extend([a, c, b]);
            }
        }
        *corners = repeated;
        let opposite = core::mem::take(&mut next.opposite);
        next.repeat(opposite);
        *particles = next;
        true
    }
}

/// An image with the new number of its original.
fn moved(image: Option<Image>, place: &[Option<usize>]) -> Option<Option<Image>> {
    match image {
        Some(Image { of, pair }) => Some(Some(Image { of: place[of]?, pair })),
        None => Some(None),
    }
}

/// Whether each of the branches has the same value and gradient at a point and at its image.
fn is_same<'a>(probe: &mut Probe, branches: impl Iterator<Item = &'a u32>, p: DVec3, image: DVec3) -> bool {
    branches.copied().all(|branch| {
        let probe = probe.on(Some(branch));
        let [(f, u), (g, v)] = [p, image].map(|p| probe.field.value_and_gradient(p));
        let most = SAME * u.length();
        // Written so that NaN fails.
        (f - g).abs() <= most && (u - v).length() <= most
    })
}

/// The pairs of corresponding rows of particles on the creases of two opposite faces; none if the
/// faces differ.
fn crease_pairs(particles: &Particles, pair: &FacePair) -> Option<Vec<[u32; 2]>> {
    // The two coordinates in the face, by their bits.
    let place = |&row: &u32| {
        let p = particles.local[row as usize].to_array().map(|x| u64::from(x.to_bits()));
        p[(pair.axis + 1) % 3] << 32 | p[(pair.axis + 2) % 3]
    };
    let [lower, upper] = pair.patches.map(|patch| {
        let on_creases = 0..particles.twins.len() as u32;
        let mut rows: Vec<u32> = on_creases.filter(|&i| particles.is_on(i as usize, Some(patch))).collect();
        sort_by_key(&mut rows, place);
        rows
    });
    let is_same = lower.iter().map(place).eq(upper.iter().map(place));
    is_same.then(|| lower.into_iter().zip(upper).map(|(lower, upper)| [lower, upper]).collect())
}
