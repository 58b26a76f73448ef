//! Smooth joins of pieces between which an edge fades out, as the edges of a cube do in the fillet
//! that joins it to a ball.
//!
//! Around the end of such an edge the surface is smooth, and the values of f do not tell where one
//! piece ends and the other begins. The search divides them by distance: it puts a *centre* on
//! either side of each known point of an edge, and gives each vertex to the piece of the nearest
//! centre from which the pieces lead to it. Beyond the end of an edge its last two centres divide
//! the surface along the plane halfway between them.

use super::cells::Cells;
use super::labels::Labels;
use super::search::Search;
use super::site::Site;
use crate::math::{Forest, NONE, key_of, sort_by_key};
use glam::DVec3;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Distance of a centre from its edge, in cells of the grid.
const ASIDE: f64 = 0.25;
/// Least distance between the unit normals on both sides of an edge that fades out: an angle of six
/// degrees. Where the angle is smaller the edge is left out, since its pieces are hardly known.
const LEAST: f64 = 0.1;
/// Number of times that the way between two vertices is halved.
const HALVINGS: u32 = 20;

/// A centre, with the piece to which the vertices around it belong.
#[derive(Clone, Copy, Debug)]
struct Centre {
    place: DVec3,
    label: u32,
}

/// How the pieces between which edges fade out divide the surface.
#[derive(Debug)]
pub(super) struct Joins {
    /// The group of each label, or [`NONE`]. Pieces of one group meet without an edge somewhere.
    group: Vec<u32>,
    centres: Vec<Centre>,
    /// For each vertex of a group the nearest centre, for others [`NONE`].
    nearest: Vec<u32>,
    /// Points of smooth joins, each with the labels that meet there, ascending.
    pub(super) places: Vec<([u32; 2], DVec3)>,
    /// These points by the cell in which each lies.
    pub(super) by_cell: Cells,
}

impl Joins {
    /// Divides pieces between which edges fade out, and labels their vertices anew; none if there
    /// are no such pieces. Removes the sites at which an edge has nearly faded out. `vertices` are
    /// those of the search by their cells.
    pub(super) fn new(
        search: &Search<'_>,
        labels: &mut Labels,
        sites: &mut Vec<Site>,
        vertices: &Cells,
    ) -> Option<Self> {
        let by_cell = Cells::new(search.cell, core::iter::empty());
        let (centres, nearest, places) = Default::default();
        let mut joins = Self { group: groups(labels)?, centres, nearest, places, by_cell };
        for site in &mut *sites {
            let [first, second] = site.sides.map(|side| joins.group(side.label));
            site.fades = first.is_some() && first == second;
        }
        continue_edges(sites, search.cell);
        sites.retain(|site| !site.fades || site.angle >= LEAST);
        joins.join_undivided(labels, sites);
        joins.find_nearest(search, labels, sites);
        for (label, &nearest) in labels.label.iter_mut().zip(&joins.nearest) {
            if nearest != NONE {
                *label = joins.centres[nearest as usize].label;
            }
        }
        joins.find_places(search, labels, vertices);
        Some(joins)
    }

    /// The group of a label, if it has one.
    pub(super) fn group(&self, label: u32) -> Option<u32> {
        self.group.get(label as usize).copied().filter(|&group| group != NONE)
    }

    /// The label of a place on the pieces of a group: that of the nearest one of the centres to
    /// which the vertices around it belong.
    pub(super) fn label(&self, p: DVec3, group: u32, vertices: &Cells) -> Option<u32> {
        let around = vertices.around(p).map(|k| self.nearest[k as usize]).filter(|&k| k != NONE);
        let own = around.filter(|&k| self.group(self.centres[k as usize].label) == Some(group));
        let nearest = own.min_by_key(|&k| (key_of(self.centres[k as usize].place.distance_squared(p)), k));
        nearest.map(|k| self.centres[k as usize].label)
    }

    /// Makes each group one piece that has no point of an edge any more.
    fn join_undivided(&mut self, labels: &mut Labels, sites: &[Site]) {
        let mut is_divided = vec![false; self.group.len()];
        for side in sites.iter().flat_map(|site| site.sides) {
            if let Some(group) = self.group(side.label) {
                is_divided[group as usize] = true;
            }
        }
        for label in &mut labels.label {
            if let Some(group) = self.group(*label).filter(|&group| !is_divided[group as usize]) {
                *label = group;
            }
        }
        for group in &mut self.group {
            if *group != NONE && !is_divided[*group as usize] {
                *group = NONE;
            }
        }
    }

    /// Sets the centres, and finds for each vertex the nearest one within its group.
    fn find_nearest(&mut self, search: &Search<'_>, labels: &Labels, sites: &[Site]) {
        let vertices = &search.vertices;
        let group_of = |k: u32| self.group(labels.label[k as usize]);
        let mut next_to = vec![Vec::new(); vertices.len()];
        for &[a, b] in &labels.links {
            if group_of(a).is_some() && group_of(a) == group_of(b) {
                next_to[a as usize].push(b);
                next_to[b as usize].push(a);
            }
        }
        let mut centres = Vec::new();
        let mut open = BinaryHeap::new();
        // The squared distance, the centre and the vertex in one number.
        let entry = |centre: u32, place: DVec3, k: u32| {
            let distance_sq = key_of(place.distance_squared(vertices[k as usize].p));
            Reverse(u128::from(distance_sq) << 64 | u128::from(centre) << 32 | u128::from(k))
        };
        for site in sites {
            for (side, way) in site.sides.into_iter().zip([site.across, -site.across]) {
                if self.group(side.label).is_some() {
                    let place = site.position + way * (ASIDE * search.cell);
                    open.push(entry(centres.len() as u32, place, side.end));
                    centres.push(Centre { place, label: side.label });
                }
            }
        }
        let mut nearest = vec![NONE; vertices.len()];
        while let Some(Reverse(entered)) = open.pop() {
            let [centre, k] = [(entered >> 32) as u32, entered as u32];
            if nearest[k as usize] == NONE {
                nearest[k as usize] = centre;
                let place = centres[centre as usize].place;
                open.extend(next_to[k as usize].iter().map(|&next| entry(centre, place, next)));
            }
        }
        (self.centres, self.nearest) = (centres, nearest);
    }

    /// Finds points at which the label changes between two neighbouring vertices of a group.
    fn find_places(&mut self, search: &Search<'_>, labels: &Labels, vertices: &Cells) {
        let mut places = Vec::new();
        for link in &labels.links {
            let [first, second] = link.map(|k| labels.label[k as usize]);
            let Some(group) = self.group(first) else { continue };
            if first == second || self.group(second) != Some(group) {
                continue;
            }
            let [mut from, mut to] = link.map(|k| search.vertices[k as usize].p);
            let label_at = |p: DVec3| self.label(p, group, vertices);
            let [Some(before), Some(after)] = [from, to].map(label_at) else { continue };
            if before == after {
                continue;
            }
            for _ in 0..HALVINGS {
                let middle = from.midpoint(to);
                if label_at(middle) == Some(before) {
                    from = middle;
                } else {
                    to = middle;
                }
            }
            places.push(([before.min(after), before.max(after)], to));
        }
        self.by_cell = Cells::new(search.cell, places.iter().map(|place| place.1));
        self.places = places;
    }
}

/// The group of each label, or [`NONE`]; nothing if there is no group.
fn groups(labels: &Labels) -> Option<Vec<u32>> {
    let count = labels.count();
    let mut forest = Forest::new(count as usize);
    for pair in &labels.fading {
        let [a, b] = pair.map(|k| labels.label[k as usize]);
        if a != NONE && b != NONE {
            forest.join(a, b);
        }
    }
    let mut sizes = vec![0_u32; count as usize];
    (0..count).for_each(|label| sizes[forest.find(label) as usize] += 1);
    let group = |label: u32| Some(forest.find(label)).filter(|&root| sizes[root as usize] > 1);
    let groups: Vec<u32> = (0..count).map(group).map(|group| group.unwrap_or(NONE)).collect();
    groups.iter().any(|&group| group != NONE).then_some(groups)
}

/// Gives each point of an edge that fades out the pieces of the nearest one along the edge that is
/// sharper: the less sharp an edge, the more chance decides to which piece the vertices beside it
/// are joined.
fn continue_edges(sites: &mut [Site], cell: f64) {
    /// Distance in cells up to which points of an edge follow each other.
    const NEXT: f64 = 1.5;
    /// Cosine of the largest angle between the directions of an edge at two points of it, and
    /// between these and the way from one to the other.
    const STRAIGHT: f64 = 0.8;
    let by_cell = Cells::new(NEXT * cell, sites.iter().map(|site| site.position));
    let mut order: Vec<u32> = (0..sites.len() as u32).filter(|&k| sites[k as usize].fades).collect();
    sort_by_key(&mut order, |&k| key_of(-sites[k as usize].angle));
    let mut is_done = vec![false; sites.len()];
    for k in order {
        let site = sites[k as usize];
        let sharper = by_cell.around(site.position).filter(|&other| is_done[other as usize]);
        let follows = |other: &Site| {
            let way = other.position - site.position;
            way.length() <= NEXT * cell
                && way.dot(site.along).abs() >= STRAIGHT * way.length()
                && other.along.dot(site.along).abs() >= STRAIGHT
                && other.across.dot(site.across).abs() >= STRAIGHT
        };
        let nearest = sharper
            .map(|other| sites[other as usize])
            .filter(follows)
            .min_by_key(|other| key_of(other.position.distance_squared(site.position)));
        if let Some(other) = nearest {
            let own = &mut sites[k as usize];
            let is_turned = other.across.dot(own.across) < 0.0;
            if is_turned {
                own.sides.reverse();
                own.across = -own.across;
            }
            for (side, of) in own.sides.iter_mut().zip(other.sides) {
                side.label = of.label;
            }
        }
        is_done[k as usize] = true;
    }
}
