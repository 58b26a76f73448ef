//! The stars of particles, patch by patch. On a surface with creases each patch is a separate
//! sheet, which ends at its creases; a smooth surface is one sheet.

use super::{StarPoints, Stars, TellsApart};
use crate::math::sort_pairs;
use crate::particles::Particles;
use crate::slices::pause;
use crate::spatial::tree::Tree;
use glam::Vec3;
use std::sync::Arc;

/// The sheets of all patches, in the order of their numbers.
#[derive(Debug)]
pub(crate) struct Sheets {
    pub(crate) all: Vec<Sheet>,
}

/// The points of one patch that can be joined, in tree order, with their stars.
#[derive(Debug)]
pub(crate) struct Sheet {
    /// The patch, if the surface has several.
    pub(crate) patch: Option<u32>,
    /// The points; their origins are rows of the particles.
    pub(crate) tree: Arc<Tree>,
    /// Unit normals.
    pub(crate) normal: Vec<Vec3>,
    /// The points at the apex of a cone, in ascending order.
    tips: Vec<u32>,
    pub(crate) stars: Stars,
    /// Pairs of successive rows along a crease, with the patch on the left.
    pub(crate) border: Vec<[u32; 2]>,
}

impl Sheets {
    /// The sheets of these particles. Rows without a finite position or a normal are left out, and
    /// so are those at the place of an earlier one of the same patch.
    pub(crate) async fn new(particles: &Particles, judge: &dyn TellsApart) -> Self {
        let mut all = Vec::new();
        if particles.patch.is_empty() {
            let rows = (0..particles.len() as u32).collect();
            return Self { all: vec![Sheet::new(particles, None, rows, judge).await] };
        }
        let mut rows: Vec<(u32, u32)> = particles.patch.iter().copied().zip(0..).collect();
        sort_pairs(&mut rows);
        for of_patch in rows.chunk_by(|one, other| one.0 == other.0) {
            pause().await;
            let (patch, rows) = (of_patch[0].0, of_patch.iter().map(|&(_, row)| row).collect());
            all.push(Sheet::new(particles, Some(patch), rows, judge).await);
        }
        let mut sheets = Self { all };
        sheets.find_borders(particles);
        sheets
    }

    /// The sheet of a surface without creases.
    pub(crate) fn only(&self) -> Option<&Sheet> {
        self.all.first().filter(|sheet| sheet.patch.is_none())
    }

    /// Whether these are the sheets of `rows` rows, with none left out.
    pub(crate) fn hold(&self, rows: usize) -> bool {
        self.all.iter().map(|sheet| sheet.tree.len()).sum::<usize>() == rows
    }

    /// Finds the borders of all sheets, from the segments along creases.
    fn find_borders(&mut self, particles: &Particles) {
        // The rows of each particle on a crease, one particle after the other.
        let mut of_first: Vec<(u32, u32)> = particles.twins.iter().copied().zip(0..).collect();
        sort_pairs(&mut of_first);
        let row = |first: u32, patch: u32| {
            let start = of_first.partition_point(|&(other, _)| other < first);
            let mut rows = of_first[start..].iter().take_while(|&&(other, _)| other == first);
            rows.find(|&&(_, row)| particles.patch[row as usize] == patch).map(|&(_, row)| row)
        };
        for (&[a, b], sides) in particles.segments.iter().zip(&particles.sides) {
            for (from, to, patch) in sides.iter().flat_map(|&[left, right]| [(a, b, left), (b, a, right)]) {
                let place = self.all.binary_search_by_key(&Some(patch), |sheet| sheet.patch);
                if let (Ok(place), Some(from), Some(to)) = (place, row(from, patch), row(to, patch)) {
                    self.all[place].border.push([from, to]);
                }
            }
        }
    }
}

impl Sheet {
    /// The points of the sheet.
    pub(crate) fn points(&self) -> StarPoints<'_> {
        StarPoints { tree: &self.tree, normal: &self.normal, tips: &self.tips, patch: self.patch }
    }

    /// The sheet of these rows, which are on one patch.
    async fn new(
        particles: &Particles,
        patch: Option<u32>,
        mut rows: Vec<u32>,
        judge: &dyn TellsApart,
    ) -> Self {
        let Particles { local: position, normal, .. } = particles;
        rows.retain(|&row| {
            position[row as usize].is_finite() && normal[row as usize].try_normalize().is_some()
        });
        let tips = particles.tips();
        loop {
            let points = rows.iter().map(|&row| (position[row as usize], row)).collect();
            let tree = Tree::in_slices(points).await;
            let normal: Vec<Vec3> =
                tree.origin.iter().map(|&row| normal[row as usize].normalize_or_zero()).collect();
            let is_tip = |&(_, row): &(u32, &u32)| tips.binary_search(row).is_ok();
            let tips: Vec<u32> = (0..).zip(&tree.origin).filter(is_tip).map(|(k, _)| k).collect();
            let points = StarPoints { tree: &tree, normal: &normal, tips: &tips, patch };
            let stars = Stars::new(&points, judge).await;
            if stars.twins().is_empty() {
                let tree = Arc::new(tree);
                return Self { patch, tree, normal, tips, stars, border: Vec::new() };
            }
            // They would have the same neighbours as the first one.
            let mut twins: Vec<u32> = stars.twins().iter().map(|&k| tree.origin[k as usize]).collect();
            twins.sort_unstable();
            rows.retain(|row| twins.binary_search(row).is_err());
        }
    }
}
