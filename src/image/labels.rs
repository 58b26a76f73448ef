//! Labels: whole numbers that assign each voxel to an organ, grain or phase.

use super::smooth::{WIDTHS_IN_A_VOXEL, blur, deviations, in_plane};
use super::{Image, ImageError};
use crate::slices::{self, LIGHT, Meter};
use std::collections::BTreeMap;

/// Number of different values up to which whole numbers count as labels. With more they are grey
/// values.
const MOST_LABELS: usize = 4096;
/// Share of a label's voxels that the Gaussian may move outside the surface without a note.
const LOST: f64 = 0.05;

/// A label of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Label {
    /// The value of its voxels.
    pub value: f64,
    /// Number of its voxels.
    pub voxels: u64,
}

impl Image {
    /// The labels of an image in order, including the background 0; empty if its voxels are not
    /// whole numbers or there are more than 4096 different ones.
    #[must_use]
    pub fn labels(&self) -> Vec<Label> {
        slices::complete(self.up_to(MOST_LABELS))
    }

    /// [`Image::labels`] in slices of work; empty if there are more than `most`.
    pub(crate) async fn up_to(&self, most: usize) -> Vec<Label> {
        let mut counts: BTreeMap<i64, u64> = BTreeMap::new();
        let mut are_labels = true;
        // Neighbours often have the same label: a run of them is looked up once.
        let (mut label, mut run) = (0, 0);
        self.voxels
            .for_each(|_, values| {
                for &value in values {
                    let own = value as i64;
                    are_labels &= own as f64 == value && value.abs() < 1e15;
                    if !are_labels {
                        return;
                    }
                    if own != label && run > 0 {
                        *counts.entry(label).or_default() += run;
                        are_labels = counts.len() <= most;
                        run = 0;
                    }
                    (label, run) = (own, run + 1);
                }
            })
            .await;
        *counts.entry(label).or_default() += run;
        if !are_labels || counts.len() > most {
            return Vec::new();
        }
        counts.into_iter().map(|(value, voxels)| Label { value: value as f64, voxels }).collect()
    }

    /// The image of the signed distance from the boundary of a label, positive inside, blurred by a
    /// Gaussian of `width` voxels, as that of [`Image::smoothed`]; the [width against
    /// steps](Image::width_against_steps) is a good start. Its surface is [at](Image::at) 0. The
    /// distance is measured to the nearest voxel on the other side, minus half a voxel (P.
    /// Felzenszwalb & D. Huttenlocher, "Distance Transforms of Sampled Functions", Theory of
    /// Computing 8, 2012).
    ///
    /// The boundary of a label is known to half a voxel, and for smooth bodies the surface stays
    /// within that. The Gaussian smooths the steps between voxels: they turn normals by about 4°
    /// with the width against steps, 2° with one and a half times as much, and 26° without it. It
    /// rounds corners by about its width and removes parts thinner than two widths, which a
    /// [note](Image::notes) reports.
    ///
    /// # Errors
    ///
    /// [`ImageError::NoLabel`] if no voxel or every voxel has the label, [`ImageError::Thin`] if
    /// the Gaussian removes it, [`ImageError::Width`] if the width is not in 0 to 100.
    pub fn label(&self, value: f64, width: f64) -> Result<Self, ImageError> {
        slices::complete(self.distance_from(value, width))
    }

    /// The width of the Gaussian that smooths the steps of a label's boundary, in voxels as for
    /// [`Image::smoothed`]: the root mean square of the distances between voxels along the three
    /// axes, to a tenth. It is 1 for cubes, and 1.9 for voxels of 1 × 1 × 3. Smaller: the steps
    /// show in the normals. Larger: corners are rounded more.
    ///
    /// A boundary with the normal n has steps of height |n_x| d_x, |n_y| d_y and |n_z| d_z. Over
    /// all directions their mean square is that of the distances d.
    #[must_use]
    pub fn width_against_steps(&self) -> f64 {
        let spacing = self.placement.spacing();
        let ratios = spacing.map(|own| own / in_plane(spacing));
        let mean_sq = ratios.iter().map(|ratio| ratio * ratio).sum::<f64>() / 3.0;
        libm::round(libm::sqrt(mean_sq) * WIDTHS_IN_A_VOXEL) / WIDTHS_IN_A_VOXEL
    }

    /// [`Image::label`] in slices of work.
    pub(super) async fn distance_from(&self, value: f64, width: f64) -> Result<Self, ImageError> {
        if !(0.0..=100.0).contains(&width) {
            return Err(ImageError::Width { width });
        }
        let mut count = 0;
        let mut distances = Vec::with_capacity(self.voxels.len());
        self.voxels
            .for_each(|_, values| {
                count += values.iter().filter(|own| **own == value).count();
                distances.extend(values.iter().map(|&own| if own == value { f32::INFINITY } else { 0.0 }));
            })
            .await;
        if count == 0 || count == distances.len() {
            let known = self.up_to(MOST_LABELS).await.iter().map(|label| label.value).collect();
            return Err(ImageError::NoLabel { value, count, known });
        }
        let spacing = self.placement.spacing();
        let mut outside: Vec<f32> = Vec::with_capacity(distances.len());
        let mut meter = Meter::default();
        for own in distances.chunks(LIGHT) {
            outside.extend(own.iter().map(|&own| if own == 0.0 { f32::INFINITY } else { 0.0 }));
            meter.add(own.len()).await;
        }
        squared_distances(self.size, spacing, &mut distances).await;
        squared_distances(self.size, spacing, &mut outside).await;
        let half = 0.5 * spacing.into_iter().fold(f64::INFINITY, f64::min) as f32;
        for (distances, outside) in distances.chunks_mut(LIGHT).zip(outside.chunks(LIGHT)) {
            for (distance, outside) in distances.iter_mut().zip(outside) {
                *distance = if *distance > 0.0 { distance.sqrt() - half } else { half - outside.sqrt() };
            }
            meter.add(distances.len()).await;
        }
        drop(outside);
        blur(self.size, &mut distances, deviations(self, width)).await;
        let mut lost = 0;
        self.voxels
            .for_each(|begin, values| {
                let both = distances[begin..].iter().zip(values);
                lost += both.filter(|(distance, own)| **own == value && **distance <= 0.0).count();
            })
            .await;
        if lost == count {
            return Err(ImageError::Thin { value, width });
        }
        let mut notes = self.notes.to_vec();
        if lost as f64 > LOST * count as f64 {
            notes.push(format!(
                "{:.0} % of the label's voxels are outside of its surface: what is thinner than twice the Gaussian of \
                 {width:.1} voxels is lost; a smaller width keeps more of it.",
                100.0 * lost as f64 / count as f64
            ));
        }
        let image = Self::filtered(self.size, distances).await?;
        Ok(Self { placement: self.placement, order: self.order, notes: notes.into(), ..image })
    }
}

/// Replaces 0 in the voxels of a set, and infinity elsewhere, by the squared distances to the
/// nearest voxel of the set, in slices of work. The set is not empty.
async fn squared_distances(size: [usize; 3], spacing: [f64; 3], squares: &mut [f32]) {
    let strides = [1, size[0], size[0] * size[1]];
    let mut meter = Meter::default();
    for axis in 0..3 {
        let (n, stride) = (size[axis], strides[axis]);
        let mut envelope = Envelope::new(n, spacing[axis]);
        let mut line = vec![0.0; n];
        for start in (0..squares.len()).step_by(n * stride).flat_map(|first| first..first + stride) {
            for (k, value) in line.iter_mut().enumerate() {
                *value = f64::from(squares[start + stride * k]);
            }
            envelope.lower(&line, |k, value| squares[start + stride * k] = value as f32);
            meter.add(n).await;
        }
    }
}

/// The lower envelope of the parabolas at the points of a line.
struct Envelope {
    spacing: f64,
    /// The points whose parabolas form the envelope, and where each part begins.
    places: Vec<(usize, f64)>,
}

impl Envelope {
    fn new(n: usize, spacing: f64) -> Self {
        Self { spacing, places: Vec::with_capacity(n) }
    }

    /// Calls `store` with the minimum of `line[k]` + (x − x_k)² at each point x.
    fn lower(&mut self, line: &[f64], mut store: impl FnMut(usize, f64)) {
        self.places.clear();
        let x = |k: usize| self.spacing * k as f64;
        for (k, &height) in line.iter().enumerate().filter(|(_, height)| height.is_finite()) {
            let from = loop {
                let Some(&(last, from)) = self.places.last() else { break f64::NEG_INFINITY };
                // Where the two parabolas intersect.
                let rise = height - line[last];
                let meet = 0.5 * (x(k) + x(last)) + 0.5 * rise / (x(k) - x(last));
                if meet > from {
                    break meet;
                }
                self.places.pop();
            };
            self.places.push((k, from));
        }
        if self.places.is_empty() {
            return;
        }
        let mut at = 0;
        for k in 0..line.len() {
            while self.places.get(at + 1).is_some_and(|(_, from)| *from < x(k)) {
                at += 1;
            }
            let (nearest, _) = self.places[at];
            let away = x(k) - x(nearest);
            store(k, line[nearest] + away * away);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_core::{Rng, SeedableRng};
    use rand_pcg::Pcg32;

    #[test]
    fn distances_are_those_of_all_pairs() {
        let mut random = Pcg32::seed_from_u64(3);
        for (size, spacing) in [([5, 4, 6], [1.0, 1.0, 1.0]), ([7, 3, 4], [0.5, 2.0, 1.25])] {
            let count: usize = size.iter().product();
            let is_in: Vec<bool> = (0..count).map(|at| at == 0 || random.next_u32() % 9 == 0).collect();
            let mut found: Vec<f32> =
                is_in.iter().map(|is_in| if *is_in { 0.0 } else { f32::INFINITY }).collect();
            slices::complete(squared_distances(size, spacing, &mut found));
            let place = |at: usize| {
                let steps = [at % size[0], at / size[0] % size[1], at / size[0] / size[1]];
                [0, 1, 2].map(|a| steps[a] as f64 * spacing[a])
            };
            for (at, found) in found.iter().enumerate() {
                let apart = |other: usize| -> f64 {
                    place(at).iter().zip(place(other)).map(|(a, b)| (a - b) * (a - b)).sum()
                };
                let nearest =
                    (0..count).filter(|&other| is_in[other]).map(apart).fold(f64::INFINITY, f64::min);
                assert!(
                    (f64::from(*found) - nearest).abs() < 1e-5 * (1.0 + nearest),
                    "{size:?} {at}: {found} {nearest}"
                );
            }
        }
    }
}
