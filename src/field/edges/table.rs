//! The result of the search: vertices and sites with their labels, and look-ups by place.

use super::cells::Cells;
use super::joins::Joins;
use super::labels::Labels;
use super::sampled::{Sampled, Taylor};
use super::search::{RawSite, Search};
use super::site::{Side, Site};
use crate::math::newton::step_to_surface;
use crate::math::{Bounds, NONE, sort_pairs};
use glam::DVec3;
use std::collections::BTreeMap;

/// Distance up to which the sites around a place are taken into account, in cells of the grid.
const NEAR: f64 = 2.0;
/// Step of the differences beside an edge, as a share of that of the search. The error of a piece
/// beyond its edge grows with the third power of the step; a smaller one loses digits by rounding.
const BESIDE: f64 = 0.1;
/// Smallest distance from an edge, in steps, at which differences do not reach over it.
const MARGIN: f64 = 5.0;

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
    /// How pieces meet between which edges fade out, if there are any.
    pub(super) joins: Option<Joins>,
}

impl EdgeTable {
    /// The table of what was found; none if there is no edge.
    pub(super) fn new(search: Search<'_>) -> Option<Self> {
        if search.sites.is_empty() {
            return None;
        }
        let mut labels = Labels::new(&search);
        let label = &labels.label;
        let (cell, size) = (search.cell, search.f.size);
        let step = BESIDE * search.f.step;
        let (margin, clear) = (MARGIN * step, MARGIN * search.f.step);
        let Search { vertices, sites: raw, .. } = &search;
        let mut sites = Vec::new();
        for site in raw {
            let mut sides = site.ends.map(|end| Side { label: label[end as usize], end, is_flush: false });
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
            let [u, v] = search.normals_at(site);
            let along = u.cross(v).normalize_or_zero();
            let [towards_first, towards_second] =
                sides.map(|side| (vertices[side.end as usize].p - site.position).normalize_or_zero());
            sites.push(Site {
                position: site.position,
                sides,
                sign,
                along,
                across: (towards_first - towards_second).reject_from(along).normalize_or_zero(),
                angle: u.distance(v),
                fades: false,
            });
        }
        let by_cell = Cells::new(cell, vertices.iter().map(|vertex| vertex.p));
        let joins = Joins::new(&search, &mut labels, &mut sites, &by_cell);
        if sites.is_empty() {
            return None;
        }
        let count = labels.count();
        let label = labels.label;
        let sites_by_cell = Cells::new(NEAR * cell, sites.iter().map(|site| site.position));
        Some(Self {
            vertices: search.vertices,
            label,
            sites,
            count,
            size,
            step,
            margin,
            clear,
            cell,
            by_cell,
            sites_by_cell,
            joins,
        })
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

    /// Pairs of labels whose pieces meet smoothly, ascending.
    pub(super) fn tangent_pairs(&self) -> Vec<[u32; 2]> {
        let mut pairs: Vec<_> =
            self.joins.iter().flat_map(|joins| joins.places.iter().map(|place| place.0)).collect();
        sort_pairs(&mut pairs);
        pairs.dedup();
        pairs
    }

    /// The label of a place where these two pieces are equal, if they are of one group.
    pub(super) fn joined_label(&self, p: DVec3, labels: [u32; 2]) -> Option<u32> {
        let joins = self.joins.as_ref()?;
        let [group, other] = labels.map(|label| joins.group(label));
        if group == other { joins.label(p, group?, &self.by_cell) } else { None }
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
        if let Some(joins) = &self.joins {
            for k in joins.by_cell.within(&around) {
                let (labels, place) = joins.places[k as usize];
                if around.holds(place) {
                    labels.into_iter().for_each(&mut add);
                }
            }
        }
        found.sort_unstable();
        found
    }

    /// Cells of a box from which the edges can be traced, see [`EdgeCells`].
    pub(crate) fn edge_cells(&self, bounds: &Bounds, width: f64) -> Vec<Bounds> {
        let mut found = EdgeCells::new(width, APART);
        let mut joined = EdgeCells::new(width, JOINS_APART);
        for site in self.sites.iter().filter(|site| bounds.holds(site.position)) {
            found.add(site.sides.map(|side| side.label), site.position);
        }
        for &(labels, place) in self.joins.iter().flat_map(|joins| &joins.places) {
            if bounds.holds(place) {
                joined.add(labels, place);
            }
        }
        found.cells.extend(joined.cells);
        found.cells
    }
}

/// Smallest distance between cells of one pair, in widths.
pub(super) const APART: f64 = 6.0;
/// Smallest distance between cells of one pair on smooth joins, in widths: a join may be short.
const JOINS_APART: f64 = 1.5;

/// Small cells around points of edges, from which these can be traced. Each pair of labels has one
/// cell within some widths.
pub(super) struct EdgeCells {
    width: f64,
    apart: f64,
    known: BTreeMap<[u32; 2], Vec<DVec3>>,
    pub(super) cells: Vec<Bounds>,
}

impl EdgeCells {
    /// Cells of this width, those of one pair at least so many widths `apart`.
    pub(super) fn new(width: f64, apart: f64) -> Self {
        Self { width, apart: apart * width, known: BTreeMap::new(), cells: Vec::new() }
    }

    pub(super) fn add(&mut self, labels: [u32; 2], place: DVec3) {
        /// Offset of the middle of a cell from the edge, in widths, so that it is on no face of a
        /// solid: beside a corner three pieces are equal there.
        const ASIDE: DVec3 = DVec3::new(0.131, 0.083, -0.057);
        let known = self.known.entry(labels).or_default();
        if known.iter().all(|p| p.distance(place) > self.apart) {
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
    let label = Labels::new(search).label;
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
