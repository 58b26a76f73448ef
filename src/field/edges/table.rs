//! The result of the search: vertices and sites with their labels, and look-ups by place.

use super::sampled::Taylor;
use super::search::{ALIKE_NEAR, RawSite, Search};
use crate::math::{Bounds, Forest, NONE};
use glam::DVec3;
use std::collections::BTreeMap;

/// Smallest number of vertices of a piece. Fewer have no label.
const FEWEST: usize = 8;
/// Distance up to which the sites around a place are taken into account, in cells of the grid.
const NEAR: f64 = 2.0;
/// Step of the differences beside an edge, as a share of that of the search. The error of a piece
/// beyond its edge grows with the third power of the step; a smaller one loses digits by rounding.
const BESIDE: f64 = 0.1;
/// Smallest distance from an edge, in steps, at which differences do not reach over it.
const MARGIN: f64 = 5.0;

/// One of the two pieces that meet at a site.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    /// The label of the piece.
    pub(super) label: u32,
    /// The vertex of the piece at which the search ended, the nearest to the site.
    pub(super) end: u32,
}

/// A point of an edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Site {
    pub(super) position: DVec3,
    /// The piece with the smaller label first.
    pub(super) sides: [Side; 2],
    /// 1 if f is the larger one of the two pieces here, as in a maximum; −1 if it is the smaller.
    pub(super) sign: f64,
}

/// The edges of a surface in a box, with the smooth pieces beside them.
#[derive(Debug)]
pub(crate) struct EdgeTable {
    pub(super) vertices: Vec<Taylor>,
    /// The label of each vertex, or [`NONE`].
    pub(super) label: Vec<u32>,
    pub(super) sites: Vec<Site>,
    /// Number of labels.
    count: u32,
    /// The size of the box.
    pub(super) size: f64,
    /// Step of the differences beside an edge.
    pub(super) step: f64,
    /// Smallest distance from an edge at which these do not reach over it.
    pub(super) margin: f64,
    /// Smallest distance from an edge at which no differences do.
    pub(super) clear: f64,
    /// The side of a cell of the grid.
    pub(super) cell: f64,
    by_cell: Cells,
    sites_by_cell: Cells,
}

impl EdgeTable {
    /// The table of what was found; none if there is no edge.
    pub(super) fn new(search: Search<'_>) -> Option<Self> {
        if search.sites.is_empty() {
            return None;
        }
        let label = labels(&search);
        let (cell, size) = (search.cell, search.f.size);
        let step = BESIDE * search.f.step;
        let (margin, clear) = (MARGIN * step, MARGIN * search.f.step);
        let Search { vertices, sites: raw, .. } = search;
        let mut sites = Vec::new();
        for site in raw {
            let mut sides = site.ends.map(|end| Side { label: label[end as usize], end });
            // Beside an edge that fades out both sides are one piece.
            if sides.iter().any(|side| side.label == NONE) || sides[0].label == sides[1].label {
                continue;
            }
            sides.sort_by_key(|side| side.label);
            // At a vertex of its own a piece is zero, so the sign of the other one tells which is
            // larger.
            let [of_first, of_second] = [0, 1].map(|k: usize| {
                let [own, other] = [sides[k], sides[1 - k]].map(|side| &vertices[side.end as usize]);
                other.slope(own.p).0 / other.jet.gradient.length()
            });
            let towards = of_first.abs() >= of_second.abs();
            let sign = if towards { -of_first.signum() } else { -of_second.signum() };
            sites.push(Site { position: site.position, sides, sign });
        }
        if sites.is_empty() {
            return None;
        }
        let count = label.iter().filter(|&&label| label != NONE).max().map_or(0, |last| last + 1);
        let by_cell = Cells::new(cell, vertices.iter().map(|vertex| vertex.p));
        let sites_by_cell = Cells::new(NEAR * cell, sites.iter().map(|site| site.position));
        Some(Self { vertices, label, sites, count, size, step, margin, clear, cell, by_cell, sites_by_cell })
    }

    /// Number of labels.
    #[cfg(test)]
    pub(crate) fn labels(&self) -> u32 {
        self.count
    }

    /// Points of the edges.
    #[cfg(test)]
    pub(crate) fn sites(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.sites.iter().map(|site| site.position)
    }

    /// The sites around a place.
    pub(super) fn sites_near(&self, p: DVec3) -> impl Iterator<Item = &Site> + '_ {
        let reach = NEAR * self.cell;
        let near = self.sites_by_cell.around(p).map(|k| &self.sites[k as usize]);
        near.filter(move |site| site.position.distance_squared(p) <= reach * reach)
    }

    /// The labels around a place, each with the squared distance of its nearest vertex, the nearest
    /// first; of a label that has none there, with that of its nearest site.
    pub(super) fn labels_near(&self, p: DVec3) -> Vec<(u32, f64)> {
        let mut near: BTreeMap<u32, f64> = BTreeMap::new();
        for k in self.by_cell.around(p) {
            let label = self.label[k as usize];
            if label != NONE {
                let distance = self.vertices[k as usize].p.distance_squared(p);
                near.entry(label).and_modify(|known| *known = known.min(distance)).or_insert(distance);
            }
        }
        let mut labels: Vec<(u32, f64)> = near.into_iter().collect();
        for site in self.sites_near(p) {
            for side in site.sides {
                if labels.iter().all(|&(known, _)| known != side.label) {
                    labels.push((side.label, site.position.distance_squared(p)));
                }
            }
        }
        labels.sort_by(|a, b| a.1.total_cmp(&b.1));
        labels
    }

    /// The labels of the pieces that may have points in a box, ascending; all of them for a large
    /// box.
    pub(super) fn labels_in(&self, bounds: &Bounds) -> Vec<u32> {
        /// Largest number of cells that are looked through.
        const MOST_CELLS: f64 = 4096.0;
        /// Room around the box, in cells: vertices are up to a cell apart.
        const ROOM: f64 = 0.6;
        let around = bounds.enlarged(ROOM * self.cell);
        let cells = (around.size() / self.cell).ceil() + 1.0;
        if cells.element_product() > MOST_CELLS {
            return (0..self.count).collect();
        }
        let mut found = Vec::new();
        let mut add = |label: u32| {
            if label != NONE && !found.contains(&label) {
                found.push(label);
            }
        };
        for k in self.by_cell.within(&around) {
            if around.holds(self.vertices[k as usize].p) {
                add(self.label[k as usize]);
            }
        }
        for k in self.sites_by_cell.within(&around) {
            let site = &self.sites[k as usize];
            if around.holds(site.position) {
                site.sides.iter().for_each(|side| add(side.label));
            }
        }
        found.sort_unstable();
        found
    }

    /// Cells of a box from which the edges can be traced, see [`Seams`].
    pub(crate) fn seams(&self, bounds: &Bounds, width: f64) -> Vec<Bounds> {
        let mut seams = Seams::new(width);
        for site in self.sites.iter().filter(|site| bounds.holds(site.position)) {
            seams.add(site.sides.map(|side| side.label), site.position);
        }
        seams.cells
    }
}

/// Small cells around points of edges, from which these can be traced. Each pair of labels has one
/// cell within some widths.
pub(super) struct Seams {
    width: f64,
    known: BTreeMap<[u32; 2], Vec<DVec3>>,
    pub(super) cells: Vec<Bounds>,
}

impl Seams {
    pub(super) fn new(width: f64) -> Self {
        Self { width, known: BTreeMap::new(), cells: Vec::new() }
    }

    pub(super) fn add(&mut self, labels: [u32; 2], place: DVec3) {
        /// Smallest distance between cells of one pair, in widths.
        const APART: f64 = 6.0;
        /// Offset of the middle of a cell from the edge, in widths, so that it is on no face of a
        /// solid: beside a corner three pieces are equal there.
        const ASIDE: DVec3 = DVec3::new(0.131, 0.083, -0.057);
        let known = self.known.entry(labels).or_default();
        if known.iter().all(|p| p.distance(place) > APART * self.width) {
            known.push(place);
            self.cells.push(Bounds::point(place + self.width * ASIDE).enlarged(0.25 * self.width));
        }
    }
}

/// The places for closer looks, at least a cell apart: points of edges with a third piece nearby,
/// or with a piece of too few vertices beside them, and places that were unclear.
pub(super) fn close_places(search: &Search<'_>) -> Vec<DVec3> {
    if search.sites.is_empty() {
        return Vec::new();
    }
    let label = labels(search);
    let cells = Cells::new(search.cell, search.sites.iter().map(|site| site.position));
    let labels_of = |site: &RawSite| site.ends.map(|end| label[end as usize]);
    let is_close = |site: &&RawSite| {
        let own = labels_of(site);
        let mut near = cells.around(site.position).map(|k| &search.sites[k as usize]);
        own.contains(&NONE)
            || near.any(|other| {
                other.position.distance(site.position) <= search.cell
                    && labels_of(other).iter().any(|label| !own.contains(label))
            })
    };
    let mut kept: Vec<DVec3> = Vec::new();
    let places = search.sites.iter().filter(is_close).map(|site| site.position);
    for place in places.chain(search.unclear.iter().copied()) {
        if kept.iter().all(|other| other.distance(place) > search.cell) {
            kept.push(place);
        }
    }
    kept
}

/// The label of each vertex. Vertices that are joined, directly or by others, have the same one;
/// the labels are numbered in the order of their first vertices.
fn labels(search: &Search<'_>) -> Vec<u32> {
    let vertices = &search.vertices;
    let mut forest = Forest::new(vertices.len());
    search.joined.iter().for_each(|&[a, b]| forest.join(a, b));
    // No link leads to the vertices beside edges of a strip thinner than a cell, or from a closer
    // look to the rest: they are joined with neighbours whose jets agree.
    let cells = Cells::new(search.cell, vertices.iter().map(|vertex| vertex.p));
    for a in search.inserted as u32..vertices.len() as u32 {
        for b in cells.around(vertices[a as usize].p) {
            let is_next = search.distance(a, b) <= 1.5 * search.cell;
            let are_apart = b < a && is_next && forest.find(a) != forest.find(b);
            if are_apart && search.residual(a, b) <= ALIKE_NEAR {
                forest.join(a, b);
            }
        }
    }
    let mut size = vec![0_usize; vertices.len()];
    (0..vertices.len() as u32).for_each(|k| size[forest.find(k) as usize] += 1);
    let (mut number, mut next) = (vec![NONE; vertices.len()], 0);
    let mut label = Vec::with_capacity(vertices.len());
    for k in 0..vertices.len() as u32 {
        let root = forest.find(k) as usize;
        if size[root] >= FEWEST && number[root] == NONE {
            number[root] = next;
            next += 1;
        }
        label.push(number[root]);
    }
    label
}

/// Indices of points, sorted by the cell in which each lies.
#[derive(Debug)]
struct Cells {
    lo: DVec3,
    side: f64,
    count: [usize; 3],
    /// The first of the points of each cell.
    start: Vec<u32>,
    points: Vec<u32>,
}

impl Cells {
    fn new(side: f64, points: impl Iterator<Item = DVec3> + Clone) -> Self {
        let around = Bounds::around(points.clone());
        let count = (around.size() / side).floor().to_array().map(|cells| cells as usize + 1);
        let mut cells = Self { lo: around.lo(), side, count, start: Vec::new(), points: Vec::new() };
        let mut own: Vec<(usize, u32)> =
            points.zip(0..).map(|(p, k)| (cells.index(cells.cell(p).map(|x| x as usize)), k)).collect();
        own.sort_unstable();
        let mut next = own.iter().peekable();
        for cell in 0..=count.into_iter().product() {
            cells.start.push(cells.points.len() as u32);
            while let Some(&(_, k)) = next.next_if(|(of, _)| *of == cell) {
                cells.points.push(k);
            }
        }
        cells
    }

    /// The cell of a place, which may lie outside.
    fn cell(&self, p: DVec3) -> [i64; 3] {
        ((p - self.lo) / self.side).floor().to_array().map(|x| x as i64)
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.count[1] + y) * self.count[0] + x
    }

    /// The points in the cells of a range along each axis.
    fn between(&self, lo: [i64; 3], hi: [i64; 3]) -> impl Iterator<Item = u32> + '_ {
        let range = |axis: usize| {
            let last = self.count[axis] as i64 - 1;
            lo[axis].max(0) as usize..(hi[axis].min(last) + 1).max(0) as usize
        };
        let (xs, ys) = (range(0), range(1));
        let rows = range(2).flat_map(move |z| ys.clone().map(move |y| [y, z]));
        let ranges = rows.filter(move |_| xs.start < xs.end).map({
            let (first, end) = (range(0).start, range(0).end);
            move |[y, z]| {
                let [first, last] = [first, end - 1].map(|x| self.index([x, y, z]));
                self.start[first] as usize..self.start[last + 1] as usize
            }
        });
        ranges.flat_map(|range| self.points[range].iter().copied())
    }

    /// The points in the cell of a place and in those around it.
    fn around(&self, p: DVec3) -> impl Iterator<Item = u32> + '_ {
        let cell = self.cell(p);
        self.between(cell.map(|x| x.saturating_sub(1)), cell.map(|x| x.saturating_add(1)))
    }

    /// The points in the cells of a box.
    fn within(&self, bounds: &Bounds) -> impl Iterator<Item = u32> + '_ {
        self.between(self.cell(bounds.lo()), self.cell(bounds.hi()))
    }
}
