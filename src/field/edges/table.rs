//! The result of the search: vertices and sites with their labels, and look-ups by place.

use super::cells::Cells;
use super::sampled::{Sampled, Taylor};
use super::search::{ALIKE_NEAR, RawSite, Search};
use crate::math::newton::step_to_surface;
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
    /// Whether f is zero on the sheet of the piece beyond the site, too, without changing its sign,
    /// as in the face along which two bodies touch. Its value does not tell there that the piece
    /// has ended.
    pub(super) is_flush: bool,
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
        let Search { vertices, sites: raw, .. } = &search;
        let mut sites = Vec::new();
        for site in raw {
            let mut sides = site.ends.map(|end| Side { label: label[end as usize], end, is_flush: false });
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
            for k in [0, 1] {
                let [own, other] = [sides[k], sides[1 - k]].map(|side| &vertices[side.end as usize]);
                sides[k].is_flush = goes_on_flush(search.f, own, other, site.position);
            }
            sites.push(Site { position: site.position, sides, sign });
        }
        if sites.is_empty() {
            return None;
        }
        let count = label.iter().filter(|&&label| label != NONE).max().map_or(0, |last| last + 1);
        let by_cell = Cells::new(cell, vertices.iter().map(|vertex| vertex.p));
        let sites_by_cell = Cells::new(NEAR * cell, sites.iter().map(|site| site.position));
        let vertices = search.vertices;
        Some(Self { vertices, label, sites, count, size, step, margin, clear, cell, by_cell, sites_by_cell })
    }

    /// Number of labels.
    #[cfg(test)]
    pub(crate) fn labels(&self) -> u32 {
        self.count
    }

    /// Cells along the longest side of the box of the grid on which the edges were searched.
    pub(super) fn cells(&self) -> u32 {
        (self.size / self.cell).round() as u32
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

    /// The labels around a place, each with its nearest vertex, the nearest first; a label without
    /// a vertex there has that of its nearest site.
    pub(super) fn labels_near(&self, p: DVec3) -> Vec<(u32, u32)> {
        // For each label the squared distance and the vertex.
        let mut near: BTreeMap<u32, (f64, u32)> = BTreeMap::new();
        for k in self.by_cell.around(p) {
            let label = self.label[k as usize];
            if label != NONE {
                let distance = self.vertices[k as usize].p.distance_squared(p);
                let nearest = near.entry(label).or_insert((distance, k));
                if distance < nearest.0 {
                    *nearest = (distance, k);
                }
            }
        }
        let mut at_sites: BTreeMap<u32, (f64, u32)> = BTreeMap::new();
        for site in self.sites_near(p) {
            let distance = site.position.distance_squared(p);
            for side in site.sides.iter().filter(|side| !near.contains_key(&side.label)) {
                let nearest = at_sites.entry(side.label).or_insert((distance, side.end));
                if distance < nearest.0 {
                    *nearest = (distance, side.end);
                }
            }
        }
        let mut labels: Vec<_> = near.into_iter().chain(at_sites).collect();
        labels.sort_by(|(_, a), (_, b)| a.0.total_cmp(&b.0));
        labels.into_iter().map(|(label, (_, vertex))| (label, vertex)).collect()
    }

    /// Whether a place is so near to a vertex that an edge between them has
    /// [sites](Self::sites_near) around the place.
    pub(super) fn is_beside(&self, vertex: u32, p: DVec3) -> bool {
        /// Largest distance in cells: sites are up to a cell apart, so that one is within half a
        /// cell of where the edge passes.
        const BESIDE: f64 = NEAR - 0.5;
        self.vertices[vertex as usize].p.distance(p) <= BESIDE * self.cell
    }

    /// Whether the polynomial of a vertex allows this value of its piece at a place around it. A
    /// piece is not known exactly between its vertices, but far more exactly than the distance.
    pub(super) fn fits(&self, vertex: u32, p: DVec3, value: f64) -> bool {
        (self.vertices[vertex as usize].slope(p).0 - value).abs() <= self.error(vertex, p)
    }

    /// Largest error of the polynomial of a vertex at a place around it.
    pub(super) fn error(&self, vertex: u32, p: DVec3) -> f64 {
        /// The error over the slope, as a share of the distance from the vertex: the surface of
        /// another function is nearly always farther away.
        const ERROR: f64 = 0.1;
        /// Least distance in cells: beside an edge a piece is extrapolated.
        const LEAST: f64 = 0.1;
        let vertex = &self.vertices[vertex as usize];
        let d = p - vertex.p;
        let bent = 0.5 * d.dot(vertex.jet.hessian.apply(d)).abs();
        ERROR * d.length().max(LEAST * self.cell) * vertex.jet.gradient.length() + bent
    }

    /// A number that is the label of no piece: of places on none of those that were found.
    pub(super) fn no_label(&self) -> u32 {
        self.count
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

    /// Cells of a box from which the edges can be traced, see [`EdgeCells`].
    pub(crate) fn edge_cells(&self, bounds: &Bounds, width: f64) -> Vec<Bounds> {
        let mut found = EdgeCells::new(width);
        for site in self.sites.iter().filter(|site| bounds.holds(site.position)) {
            found.add(site.sides.map(|side| side.label), site.position);
        }
        found.cells
    }
}

/// Small cells around points of edges, from which these can be traced. Each pair of labels has one
/// cell within some widths.
pub(super) struct EdgeCells {
    width: f64,
    known: BTreeMap<[u32; 2], Vec<DVec3>>,
    pub(super) cells: Vec<Bounds>,
}

impl EdgeCells {
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

/// Whether f is zero on the sheet of a piece beyond a site, too, without changing its sign. `other`
/// is the piece that gives f there otherwise.
fn goes_on_flush(f: &Sampled<'_>, own: &Taylor, other: &Taylor, site: DVec3) -> bool {
    /// Distance from the site, as a share of the size of the box: at an angle of two degrees f is
    /// still far above the error of the polynomials.
    const BEYOND: f64 = 3e-4;
    /// Share of the value of the other piece below which f counts as zero. Larger: a third piece
    /// beside a corner is taken for that.
    const ZERO: f64 = 1e-3;
    let [u, v] = [own, other].map(|piece| piece.slope(site).1);
    let Some(way) = u.cross(u.cross(v)).try_normalize() else { return false };
    let way = if way.dot(own.p - site) > 0.0 { -way } else { way };
    let mut p = site + way * (BEYOND * f.size);
    for _ in 0..2 {
        p -= step_to_surface(own.slope(p));
    }
    let aside = u.normalize_or_zero() * (0.1 * BEYOND * f.size);
    f.value(p).abs() <= ZERO * other.slope(p).0.abs() && f.value(p + aside) * f.value(p - aside) > 0.0
}

/// The label of each vertex. Vertices that are joined, directly or by others, have the same one;
/// the labels are numbered in the order of their first vertices.
fn labels(search: &Search<'_>) -> Vec<u32> {
    let vertices = &search.vertices;
    let mut forest = joined(search);
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

/// The sets of vertices that are joined. Where the angle of an edge vanishes at a point, pieces on
/// both sides of it look like one there: pairs that would join what meets at an edge elsewhere are
/// left out, if they are beside an edge. Elsewhere the edge fades out, and both sides are one
/// piece.
fn joined(search: &Search<'_>) -> Forest {
    let vertices = &search.vertices;
    let mut sets =
        Sets { forest: Forest::new(vertices.len()), across: BTreeMap::new(), left_out: Vec::new() };
    for site in &search.sites {
        for [from, to] in [site.ends, [site.ends[1], site.ends[0]]] {
            sets.across.entry(from).or_default().push(to);
        }
    }
    // What is beside edges comes first, so that a set knows what is across them.
    sets.join_all(search, search.beside.clone());
    sets.join_all(search, search.joined.clone());
    // No link leads to the vertices beside edges of a strip thinner than a cell, or from a closer
    // look to the rest: they are joined with neighbours whose jets agree.
    let cells = Cells::new(search.cell, vertices.iter().map(|vertex| vertex.p));
    let mut near = Vec::new();
    for a in search.inserted as u32..vertices.len() as u32 {
        for b in cells.around(vertices[a as usize].p) {
            let is_next = b < a && search.distance(a, b) <= 1.5 * search.cell;
            let are_apart = is_next && sets.forest.find(a) != sets.forest.find(b);
            if are_apart && search.residual(a, b) <= ALIKE_NEAR {
                near.push([a, b]);
            }
        }
    }
    sets.join_all(search, near);
    let sites = Cells::new(search.cell, search.sites.iter().map(|site| site.position));
    for [a, b] in sets.left_out {
        let place = vertices[a as usize].p.midpoint(vertices[b as usize].p);
        let mut near = sites.around(place).map(|k| search.sites[k as usize].position);
        if near.all(|site| site.distance(place) > search.cell) {
            sets.forest.join(a, b);
        }
    }
    sets.forest
}

/// Disjoint sets of vertices. Two sets with an edge between them must stay apart.
struct Sets {
    forest: Forest,
    /// For each set, by its least vertex, the vertices that are across an edge from one of its own.
    across: BTreeMap<u32, Vec<u32>>,
    /// Pairs that were not joined.
    left_out: Vec<[u32; 2]>,
}

impl Sets {
    /// Joins pairs of vertices, the likeliest first.
    fn join_all(&mut self, search: &Search<'_>, pairs: Vec<[u32; 2]>) {
        let mut ranked: Vec<_> =
            pairs.into_iter().map(|pair| (search.residual(pair[0], pair[1]), pair)).collect();
        ranked.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        for (_, pair) in ranked {
            let [a, b] = pair.map(|k| self.forest.find(k));
            if a == b {
                continue;
            }
            let [of_a, of_b] = [a, b].map(|k| self.across.get(&k).map_or(0, Vec::len));
            let [few, other] = if of_a <= of_b { [a, b] } else { [b, a] };
            let Self { forest, across, .. } = self;
            if across.get(&few).is_some_and(|own| own.iter().any(|&k| forest.find(k) == other)) {
                self.left_out.push(pair);
                continue;
            }
            forest.join(a, b);
            if let Some(moved) = across.remove(&a.max(b)) {
                across.entry(a.min(b)).or_default().extend(moved);
            }
        }
    }
}
