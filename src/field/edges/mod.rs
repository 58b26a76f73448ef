//! Edges of a function that nobody can look into, found in its values.
//!
//! The code of a distance with `min` and `max` in it is smooth nearly everywhere, and its gradient
//! jumps where another operand is taken. Nothing but values of f is asked for:
//!
//! 1. *Vertices* ([`grid`]). f is sampled on a grid; where it changes its sign along an edge of the
//!    grid there is a point of the surface, at which ten differences give a second-order jet.
//! 2. *Links* ([`search`]). Two vertices beside each other are on one smooth piece of the surface
//!    if the jet of each foretells the normal of the other. Where it does not the surface between
//!    them is followed down to a ten-thousandth of the box: either it only bends there, or there is
//!    a *site*, a point of an edge with a jet on either side.
//! 3. *Labels* ([`table`]). Vertices that are linked, over any number of others, have one label.
//! 4. *Pieces* ([`evaluator`]). Within its region a piece is f. Beyond an edge it is the Taylor
//!    polynomial from a place a little within.
//!
//! Where a third piece begins near an edge, or it stays unclear how the surface goes on, a finer
//! grid is looked at around the place.
//!
//! What is smaller than a cell of the grid may be missed, so nothing is proven. An edge that fades
//! out has one label on both sides; such a site is counted and left out.

mod evaluator;
mod field;
mod grid;
mod sampled;
mod search;
mod table;

pub(crate) use field::{KnownField, KnownPieces};
use table::EdgeTable;

use super::{Field, Frame};
use crate::math::Bounds;
use crate::slices;
use glam::DVec3;
use grid::Grid;
use sampled::Sampled;
use search::Search;
use std::sync::Arc;
use table::Seams;

/// Cells along the longest side of the box with which it is found out whether there is an edge at
/// all, and those with which edges are found. Fewer miss more of what is small; the calls of f grow
/// with the square.
const SIDES: [u32; 2] = [32, 64];

/// Maximum number of places that are looked at more closely: as many corners as a hundred and
/// twenty boxes have. Each takes some 2,000 calls of f.
const MOST_CLOSE: usize = 1_000;

/// Finds out about the pieces of a field in a box, in the coordinates of the field: cells with
/// which a search for edges can begin, and what is known of the pieces then, where they are not the
/// field's own. None where the surface is smooth.
pub(crate) async fn known_in(
    field: &dyn Field,
    bounds: &Bounds,
    width: f64,
) -> Option<(Vec<Bounds>, Option<KnownPieces>)> {
    if let Some(own) = field.piecewise() {
        let (cells, own) = own.pieces_in(bounds, width).await;
        return Some((cells, Some(KnownPieces::Own(own))));
    }
    if let Some(pieces) = field.evaluator(Frame::for_box(bounds)).pieces() {
        return Some((pieces.seams_in(bounds, width), None));
    }
    if field.is_smooth() {
        return None;
    }
    let table = find(field, bounds).await?;
    Some((table.seams(bounds, width), Some(KnownPieces::Edges(Arc::new(table)))))
}

/// Finds the edges of the surface of a field in a box, in the coordinates of the field; none if
/// there are none.
async fn find(field: &dyn Field, bounds: &Bounds) -> Option<EdgeTable> {
    let sampled = Sampled::new(field, bounds)?;
    let [few, many] = SIDES.map(|side| Search::new(&sampled, sampled.size / f64::from(side)));
    let (mut first, mut search) = (few, many);
    first.run(bounds, true).await;
    if first.sites.is_empty() {
        return None;
    }
    search.run(bounds, false).await;
    let places = table::close_places(&search);
    if places.len() <= MOST_CLOSE {
        search.look_closely(&places).await;
    }
    EdgeTable::new(search)
}

/// Cells of a box in which the surface of a field passes from one label to another: one for each
/// two labels within some widths of each other.
pub(crate) fn seams_between(
    field: &dyn Field,
    label: &dyn Fn(DVec3) -> u32,
    bounds: &Bounds,
    width: f64,
) -> Vec<Bounds> {
    /// Number of times that the way from one label to the other is halved.
    const HALVINGS: u32 = 6;
    let sampled = Sampled::in_box(field, bounds);
    let grid = slices::complete(Grid::sample(&sampled, bounds, sampled.size / f64::from(SIDES[1])));
    let (points, of_edge) = slices::complete(grid.points(&sampled));
    let labels: Vec<u32> = points.iter().map(|&p| label(p)).collect();
    let mut seams = Seams::new(width);
    for link in grid.links(&sampled) {
        let [a, b] = link.map(|edge| of_edge[edge] as usize);
        if labels[a] == labels[b] {
            continue;
        }
        let (mut from, mut to) = (points[a], points[b]);
        for _ in 0..HALVINGS {
            let middle = from.midpoint(to);
            if label(middle) == labels[a] {
                from = middle;
            } else {
                to = middle;
            }
        }
        let place = from.midpoint(to);
        if bounds.holds(place) {
            seams.add([labels[a].min(labels[b]), labels[a].max(labels[b])], place);
        }
    }
    seams.cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::FnField;
    use crate::slices::complete;

    fn table(f: impl Fn(DVec3) -> f64 + Send + Sync, half: f64) -> Option<EdgeTable> {
        complete(find(&FnField::new(f), &Bounds::cube(half)))
    }

    #[test]
    fn a_cube_has_six_labels_and_its_sites_lie_on_its_edges() {
        let table = table(|p| p.abs().max_element() - 0.8, 1.0).expect("a cube has edges");
        assert_eq!(table.labels(), 6);
        for site in table.sites() {
            let mut p = site.abs().to_array();
            p.sort_by(f64::total_cmp);
            assert!((p[1] - 0.8).abs() < 1e-9 && (p[2] - 0.8).abs() < 1e-9, "{site}");
        }
    }
}
