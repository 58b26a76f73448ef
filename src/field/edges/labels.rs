//! The labels of vertices: which of them are on one piece.

use super::cells::Cells;
use super::search::{ALIKE_NEAR, Search};
use crate::math::{Forest, NONE, key_of, sort_by_key, sort_pairs};
use std::collections::BTreeMap;

/// Smallest number of vertices of a piece. Fewer have no label.
const FEWEST: usize = 8;

/// The labels of vertices, and the pairs of vertices from which they were found.
pub(super) struct Labels {
    /// The label of each vertex, or [`NONE`]. Vertices that are joined, directly or by others, have
    /// the same one; the labels are numbered in the order of their first vertices.
    pub(super) label: Vec<u32>,
    /// Pairs of neighbouring vertices of one piece, with those of `fading`.
    pub(super) links: Vec<[u32; 2]>,
    /// Pairs of neighbours between which there is no edge, with different labels all the same: the
    /// edge that divides their pieces elsewhere fades out.
    pub(super) fading: Vec<[u32; 2]>,
}

impl Labels {
    pub(super) fn new(search: &Search<'_>) -> Self {
        let vertices = &search.vertices;
        let mut sets = Sets::new(search);
        // What is beside edges comes first, so that a set knows what is across them.
        sets.join_all(search, search.beside.clone());
        sets.join_all(search, search.joined.clone());
        // No link leads to the vertices beside edges of a strip thinner than a cell, or from a
        // closer look to the rest: they are joined with neighbours whose jets agree.
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
        let mut links = [search.beside.clone(), search.joined.clone(), near.clone()].concat();
        sets.join_all(search, near);
        let Sets { mut forest, left_out, .. } = sets;
        let sites = Cells::new(search.cell, search.sites.iter().map(|site| site.position));
        let (mut beside, fading): (Vec<_>, Vec<_>) = left_out.into_iter().partition(|&[a, b]| {
            let place = vertices[a as usize].p.midpoint(vertices[b as usize].p);
            let mut near = sites.around(place).map(|k| search.sites[k as usize].position);
            near.any(|site| site.distance(place) <= search.cell)
        });
        sort_pairs(&mut beside);
        links.retain(|link| beside.binary_search(link).is_err());
        Self { label: numbered(&mut forest, vertices.len()), links, fading }
    }

    /// Number of labels.
    pub(super) fn count(&self) -> u32 {
        self.label.iter().filter(|&&label| label != NONE).max().map_or(0, |last| last + 1)
    }
}

/// The label of each vertex by the set to which it belongs.
fn numbered(forest: &mut Forest, vertices: usize) -> Vec<u32> {
    let mut size = vec![0_usize; vertices];
    (0..vertices as u32).for_each(|k| size[forest.find(k) as usize] += 1);
    let (mut number, mut next) = (vec![NONE; vertices], 0);
    let mut label = Vec::with_capacity(vertices);
    for k in 0..vertices as u32 {
        let root = forest.find(k) as usize;
        if size[root] >= FEWEST && number[root] == NONE {
            number[root] = next;
            next += 1;
        }
        label.push(number[root]);
    }
    label
}

/// Disjoint sets of vertices. Two sets with an edge between them must stay apart.
struct Sets {
    forest: Forest,
    /// For each set, by its least vertex, the vertices that are across an edge from one of its own.
    across: BTreeMap<u32, Vec<u32>>,
    /// Pairs that were not joined, since there is an edge between their sets.
    left_out: Vec<[u32; 2]>,
    /// The sharpness of the edges beside each vertex: the largest distance between the unit normals
    /// on both sides of one, or 0 without an edge.
    sharpness: Vec<f64>,
}

impl Sets {
    /// Each vertex by itself.
    fn new(search: &Search<'_>) -> Self {
        let sites = Cells::new(search.cell, search.sites.iter().map(|site| site.position));
        let angles = search.sites.iter().map(|site| {
            let [u, v] = search.normals_at(site);
            u.distance(v)
        });
        let angles: Vec<f64> = angles.collect();
        let sharpness = search.vertices.iter().map(|vertex| {
            let near = sites.around(vertex.p).map(|k| k as usize);
            let near = near.filter(|&k| search.sites[k].position.distance(vertex.p) <= search.cell);
            near.map(|k| angles[k]).fold(0.0, f64::max)
        });
        let mut across: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for site in &search.sites {
            for [from, to] in [site.ends, [site.ends[1], site.ends[0]]] {
                across.entry(from).or_default().push(to);
            }
        }
        let forest = Forest::new(search.vertices.len());
        Self { forest, across, left_out: Vec::new(), sharpness: sharpness.collect() }
    }

    /// Joins pairs of vertices, those beside the sharpest edges first, then the likeliest. Where
    /// the angle of an edge vanishes, pieces on both sides of it look like one: by then their sets
    /// are known to be apart.
    fn join_all(&mut self, search: &Search<'_>, mut pairs: Vec<[u32; 2]>) {
        sort_by_key(&mut pairs, |&[a, b]| key_of(search.residual(a, b)));
        sort_by_key(&mut pairs, |pair| {
            let sharpness = pair.map(|k| self.sharpness[k as usize]);
            key_of(-sharpness[0].max(sharpness[1]))
        });
        for pair in pairs {
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
