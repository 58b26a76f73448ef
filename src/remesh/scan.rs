//! The field of a scan or a smooth shape: a spline through the slightly blurred signed distance on
//! a grid.
//!
//! A point is inside if its winding number w is above one half. Near a hole in the mesh w changes
//! slowly, and so does the factor 1 − 2w of the distance: its zeros close the hole smoothly.

use super::edges::Edges;
use super::{MeshError, MeshSolid, TriangleMesh};
use crate::field::{Evaluator, Facts, Field, Frame, Jet};
use crate::image::{Image, ImageError, ImageField, blur};
use crate::math::{Bounds, Sym3, median};
use crate::slices;
use glam::{DVec3, Vec3};

/// Width of a cell divided by the length of the mesh's edges. Larger cells lose details; smaller
/// ones reproduce the facets.
const CELL: f64 = 0.8;
/// Fewest cells along the longest side of the mesh.
const FEWEST: f64 = 96.0;
/// Most cells of the grid. These take some seconds, and 100 MB.
const MOST: f64 = 4e6;
/// Margin around the mesh, in cells, for the Gaussian and for a surface that bulges.
const ROOM: f64 = 6.0;
/// Widths of the Gaussian in cells. The smallest smooths the edges between faces of a smooth mesh,
/// the second rounds sharp edges enough for particles; larger ones remove small parts.
const WIDTHS: [f64; 3] = [0.7, 1.5, 3.0];
/// A mesh with a larger share of sharp edges is not smooth.
const SHARP_SHARE: f64 = 1e-3;
/// Slope that the remaining noise gives the surface, as the tangent of an angle.
const LEFT: f64 = 0.1;
/// Voxels along each side of a block, whose voxels are searched together.
const SIDE: usize = 4;
/// Blocks in a slice of work.
const AT_ONCE: usize = 4;

/// The field of a mesh as an image.
#[derive(Clone, Debug)]
pub(super) struct ScanField {
    image: ImageField,
    /// The box of the image.
    domain: Bounds,
}

/// The chosen grid and the width of the Gaussian in cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Chosen {
    pub(super) size: [usize; 3],
    pub(super) cell: f64,
    pub(super) width: f64,
}

/// The grid of voxels.
struct Grid {
    origin: DVec3,
    cell: f64,
    size: [usize; 3],
    /// Blocks along each axis.
    blocks: [usize; 3],
}

impl Grid {
    fn new(mesh: &TriangleMesh) -> Self {
        let bounds = mesh.bounds();
        let size = bounds.size();
        // An equilateral triangle has √3/4 of its edge's square as area.
        let edge = libm::sqrt(4.0 * mesh.area() / (crate::math::SQRT_3 * mesh.faces().len() as f64));
        let longest = size.max_element();
        let least = libm::cbrt(size.max(DVec3::splat(longest / FEWEST)).element_product() / MOST);
        let cell = (CELL * edge).min(longest / FEWEST).max(least);
        let cells = (size / cell + 2.0 * ROOM).ceil();
        let blocks = cells.to_array().map(|cells| (cells as usize + 1).div_ceil(SIDE));
        let size = blocks.map(|blocks| SIDE * blocks);
        let middle = 0.5 * DVec3::from_array(size.map(|n| (n - 1) as f64));
        Self { origin: bounds.middle() - cell * middle, cell, size, blocks }
    }

    fn place(&self, at: [usize; 3]) -> DVec3 {
        self.origin + self.cell * DVec3::from_array(at.map(|k| k as f64))
    }

    fn block(&self, number: usize) -> [usize; 3] {
        let [x, y, _] = self.blocks;
        [number % x, number / x % y, number / x / y]
    }

    fn block_count(&self) -> usize {
        self.blocks.iter().product()
    }

    /// The middle of a block.
    fn middle(&self, block: [usize; 3]) -> DVec3 {
        self.place(block.map(|b| SIDE * b)) + 0.5 * (SIDE - 1) as f64 * self.cell
    }
}

/// Number of slices that the distances take.
pub(super) fn slices(solid: &MeshSolid) -> u64 {
    2 * Grid::new(&solid.mesh).block_count().div_ceil(AT_ONCE) as u64
}

impl ScanField {
    /// The field, with a Gaussian of `width` cells; without it the noise of the vertices and the
    /// number of `sharp` edges decide. Made in slices of work.
    pub(super) async fn new(
        solid: &MeshSolid,
        sharp: usize,
        width: Option<f64>,
    ) -> Result<(Self, Chosen), MeshError> {
        let grid = Grid::new(&solid.mesh);
        let width = width.unwrap_or_else(|| {
            let noise = noise(&solid.mesh, &solid.edges);
            // A Gaussian lowers the noise of independent vertices by the square root of the area
            // that it averages, and the slope of that noise by its width once more. The filter's
            // second Gaussian lets more noise through, so the width is 1.5 times that.
            let wanted = libm::sqrt(noise / grid.cell / (LEFT * libm::sqrt(4.0 * core::f64::consts::PI)));
            let is_smooth = (sharp as f64) < SHARP_SHARE * solid.edges.len() as f64;
            (1.5 * wanted).clamp(if is_smooth { WIDTHS[0] } else { WIDTHS[1] }, WIDTHS[2])
        });
        let mut values = distances(solid, &grid).await;
        if width > 0.0 {
            smooth(&grid, &mut values, width).await;
        }
        let narrow = |_: ImageError| MeshError::Narrow { cell: grid.cell };
        let image = Image::filtered(grid.size, values).await.map_err(narrow)?;
        let image = image.with_spacing([grid.cell; 3]).map_err(narrow)?;
        let image = image.with_origin(solid.origin + grid.origin).map_err(narrow)?;
        let domain = Bounds::new(grid.origin, grid.place(grid.size.map(|n| n - 1)));
        let domain = domain.relative_to(-solid.origin);
        let field = Self { image: ImageField::made(&image, 0.0, false).await.map_err(narrow)?, domain };
        Ok((field, Chosen { size: grid.size, cell: grid.cell, width }))
    }

    /// f and ∇f outside the image: those at its border, plus the distance to it.
    #[cold]
    fn beyond(&self, p: DVec3) -> (f64, DVec3) {
        let q = p.clamp(self.domain.lo(), self.domain.hi());
        let inner = q.lerp(self.domain.middle(), 1e-9);
        let distance = p.distance(q);
        let value = self.image.value(inner) + distance;
        if distance > 0.0 {
            (value, (p - q) / distance)
        } else {
            (value, self.image.value_and_gradient(inner).1)
        }
    }
}

impl Field for ScanField {
    fn value_and_gradient(&self, p: DVec3) -> (f64, DVec3) {
        let known = self.image.value_and_gradient(p);
        if known.0.is_nan() { self.beyond(p) } else { known }
    }

    fn value(&self, p: DVec3) -> f64 {
        let known = self.image.value(p);
        if known.is_nan() { self.beyond(p).0 } else { known }
    }

    fn jet(&self, p: DVec3) -> Jet {
        let known = self.image.jet(p);
        if !known.value.is_nan() {
            return known;
        }
        let (value, gradient) = self.beyond(p);
        Jet { value, gradient, hessian: Sym3::default() }
    }

    fn evaluator(&self, frame: Frame) -> Box<dyn Evaluator + '_> {
        Box::new(ScanEvaluator { field: self, image: self.image.evaluator(frame), frame })
    }

    fn facts(&self) -> Facts {
        let facts = self.image.facts();
        Facts { within: facts.within, resolution: facts.resolution, ..Facts::default() }
    }

    fn is_smooth(&self) -> bool {
        true
    }
}

/// The evaluator of the image, with values outside it, too, and without the image's bounds, which
/// do not hold for the mesh.
struct ScanEvaluator<'a> {
    field: &'a ScanField,
    image: Box<dyn Evaluator + 'a>,
    frame: Frame,
}

impl ScanEvaluator<'_> {
    fn place(&self, p: Vec3) -> DVec3 {
        self.frame.place(p.as_dvec3())
    }
}

impl Evaluator for ScanEvaluator<'_> {
    fn frame(&self) -> Frame {
        self.frame
    }

    fn another(&self) -> Box<dyn Evaluator + '_> {
        self.field.evaluator(self.frame)
    }

    fn values(&mut self, points: &[Vec3], value: &mut [f32]) {
        self.image.values(points, value);
        for (p, value) in points.iter().zip(value) {
            if value.is_nan() {
                *value = self.frame.value(self.field.value(self.place(*p)));
            }
        }
    }

    fn gradients(&mut self, points: &[Vec3], value: &mut [f32], gradient: &mut [Vec3]) {
        self.image.gradients(points, value, gradient);
        for ((p, value), gradient) in points.iter().zip(value).zip(gradient) {
            if value.is_nan() {
                (*value, *gradient) = self.frame.gradient(self.field.value_and_gradient(self.place(*p)));
            }
        }
    }

    fn hessians(
        &mut self,
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
        hessian: &mut [Sym3<f32>],
    ) {
        self.image.hessians(points, value, gradient, hessian);
        for (((p, value), gradient), hessian) in points.iter().zip(value).zip(gradient).zip(hessian) {
            if value.is_nan() {
                (*value, *gradient, *hessian) = self.frame.hessian(&self.field.jet(self.place(*p)));
            }
        }
    }

    fn value_and_gradient(&mut self, p: DVec3) -> (f64, DVec3) {
        self.frame.exact(self.field.value_and_gradient(self.frame.place(p)))
    }

    fn jet(&mut self, p: DVec3) -> Jet {
        self.frame.jet(self.field.jet(self.frame.place(p)))
    }
}

/// The voxels: distances from the mesh, positive inside.
async fn distances(solid: &MeshSolid, grid: &Grid) -> Vec<f32> {
    let (tree, cell) = (&*solid.tree, grid.cell);
    let corners = solid.mesh.all_corners();
    let count = grid.block_count();
    let numbers = |range: core::ops::Range<usize>| range.map(|number| grid.block(number)).collect::<Vec<_>>();
    // For each block: the nearest triangle, its distance, and the winding number at the middle.
    let of_block = |block: [usize; 3]| {
        let middle = grid.middle(block);
        let found = tree.nearest(middle);
        (found.triangle, found.distance_sq.sqrt(), tree.winding(middle))
    };
    let known = slices::map(
        count,
        AT_ONCE,
        || (),
        |(), range| numbers(range).into_iter().map(of_block).collect::<Vec<_>>(),
    );
    let known: Vec<(u32, f64, f64)> = known.await.into_iter().flatten().collect();
    let number_of = |[i, j, k]: [usize; 3]| i + grid.blocks[0] * (j + grid.blocks[1] * k);
    let is_closed = solid.is_closed();
    let half = 0.5 * cell * crate::math::SQRT_3 * (SIDE - 1) as f64;
    let fill = |block: [usize; 3]| {
        let (_, away, winding) = known[number_of(block)];
        let near = neighbours(block, grid.blocks).map(|other| known[number_of(other)]);
        let near: Vec<(u32, f64, f64)> = near.collect();
        let is_near = away <= half + cell;
        // Far from the mesh the winding number changes slowly. In the opening of a hole it passes
        // through one half.
        let is_like = |own: &(u32, f64, f64)| (0.5 - own.2).abs() > 0.3 && (own.2 > 0.5) == (winding > 0.5);
        let is_sure = !is_near && (is_closed || near.iter().all(is_like));
        let mut out = [0.0_f32; SIDE * SIDE * SIDE];
        // The winding number at the last voxel and its distance from the mesh; the first "last
        // voxel" is the middle.
        let (mut last, mut step) = ((winding, away), half);
        for at in 0..out.len() {
            let steps = snake(at);
            let p = grid.place([0, 1, 2].map(|a| SIDE * block[a] + steps[a]));
            let most = (last.1 + step) * (1.0 + 1e-9);
            let distance_sq = if is_near {
                tree.nearest_of(p, most * most, |_| true).map(|found| found.distance_sq)
            } else {
                let to = |own: &(u32, f64, f64)| super::tree::nearest_on(p, corners[own.0 as usize]);
                near.iter().map(|own| to(own).distance_squared(p)).reduce(f64::min)
            };
            let distance = libm::sqrt(distance_sq.unwrap_or(most * most));
            // No face of a closed mesh lies between this voxel and the last one, so both are on the
            // same side.
            let is_same = is_sure || is_closed && last.1 > step;
            let winding = if is_same { last.0 } else { tree.winding(p) };
            (last, step) = ((winding, distance), cell);
            let factor = match is_closed {
                true if winding > 0.5 => -1.0,
                true => 1.0,
                false => (1.0 - 2.0 * winding).clamp(-1.0, 1.0),
            };
            out[steps[0] + SIDE * (steps[1] + SIDE * steps[2])] = -(distance * factor) as f32;
        }
        out
    };
    let filled = slices::map(
        count,
        AT_ONCE,
        || (),
        |(), range| numbers(range).into_iter().map(fill).collect::<Vec<_>>(),
    );
    let filled: Vec<[f32; SIDE * SIDE * SIDE]> = filled.await.into_iter().flatten().collect();
    let mut values = vec![0.0; grid.size.iter().product()];
    for (number, own) in filled.iter().enumerate() {
        let block = grid.block(number);
        for (row, own) in own.as_chunks::<SIDE>().0.iter().enumerate() {
            let (j, k) = (SIDE * block[1] + row % SIDE, SIDE * block[2] + row / SIDE);
            let first = SIDE * block[0] + grid.size[0] * (j + grid.size[1] * k);
            values[first..first + SIDE].copy_from_slice(own);
        }
    }
    values
}

/// Blurs values by twice a Gaussian minus that Gaussian applied twice. A single Gaussian moves a
/// surface in proportion to its curvature; this one only where the curvature changes.
async fn smooth(grid: &Grid, values: &mut [f32], width: f64) {
    blur(grid.size, values, [width; 3]).await;
    let mut twice = values.to_vec();
    blur(grid.size, &mut twice, [width; 3]).await;
    values.iter_mut().zip(twice).for_each(|(once, twice)| *once = 2.0 * *once - twice);
}

/// The voxels of a block in such an order that consecutive ones are neighbours.
fn snake(at: usize) -> [usize; 3] {
    let turned = |k: usize, is_turned: bool| if is_turned { SIDE - 1 - k } else { k };
    let [i, j, k] = [at % SIDE, at / SIDE % SIDE, at / SIDE / SIDE];
    [turned(i, at / SIDE % 2 == 1), turned(j, k % 2 == 1), k]
}

/// A block and its up to six neighbours.
fn neighbours(block: [usize; 3], count: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    let ways = [[0, 0, 0], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
    ways.into_iter().filter_map(move |way: [isize; 3]| {
        let at = [0, 1, 2].map(|a| block[a].checked_add_signed(way[a]).filter(|&k| k < count[a]));
        Some([at[0]?, at[1]?, at[2]?])
    })
}

/// The standard deviation of independent noise of the vertices along the normals. A vertex's height
/// above the mean of its neighbours is compared with theirs; on a smooth surface these heights are
/// nearly equal.
fn noise(mesh: &TriangleMesh, edges: &Edges) -> f64 {
    /// Fewest vertices of a scan. A mesh with fewer is a part, whose corners are not noise.
    const FEWEST: usize = 1_000;
    /// The median of the absolute value of a standard normal variable.
    const MEDIAN: f64 = 0.674_489_750_196_081_7;
    /// Standard deviation of this measure divided by that of the noise, for six neighbours: a
    /// vertex has the weight 1.17, its six neighbours about −0.39, and the twelve beyond them 0.05.
    const GAIN: f64 = 1.5;
    let count = mesh.vertices().len();
    if count < FEWEST {
        return 0.0;
    }
    let mut normal = vec![DVec3::ZERO; count];
    for (face, vector) in mesh.faces().iter().zip(mesh.area_vectors()) {
        face.iter().for_each(|&corner| normal[corner as usize] += vector);
    }
    let mean_of = |values: &[DVec3]| {
        let mut sum = vec![(DVec3::ZERO, 0.0); count];
        for edge in 0..edges.len() {
            let [a, b] = edges.ends(edge).map(|end| end as usize);
            for (to, from) in [(a, b), (b, a)] {
                sum[to].0 += values[from];
                sum[to].1 += 1.0;
            }
        }
        sum.into_iter().map(|(sum, count)| sum / f64::max(count, 1.0)).collect::<Vec<_>>()
    };
    let around = mean_of(mesh.vertices());
    let height: Vec<DVec3> = (around.iter().zip(mesh.vertices()).zip(&normal))
        .map(|((mean, own), normal)| DVec3::X * (*own - *mean).dot(normal.normalize_or_zero()))
        .collect();
    let smooth = mean_of(&height);
    let apart = height.iter().zip(smooth).map(|(own, mean)| (own.x - mean.x).abs()).collect();
    median(apart).unwrap_or(0.0) / (MEDIAN * GAIN)
}
