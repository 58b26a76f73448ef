//! Edges of a black box: a field of which only values are known.
//!
//! Code with `min` and `max` in it is smooth nearly everywhere, and its gradient jumps where
//! another operand is taken. The search evaluates f and nothing else:
//!
//! 1. *Vertices* ([`grid`]). Where f changes its sign along an edge of a grid there is a point of
//!    the surface. Thirteen values around it give a second-order jet.
//! 2. *Links* ([`search`]). Two neighbouring vertices are on one smooth piece of the surface if the
//!    jet of each predicts the normal of the other. Where they disagree, the search narrows the way
//!    between them to a ten-thousandth of the box. It finds that the surface only bends there, or a
//!    *site*: a point of an edge, with a jet on either side.
//! 3. *Closer looks*. Around corners, and where the search was inconclusive, it is repeated on a
//!    grid three times as fine.
//! 4. *Labels* ([`labels`]). All vertices that are joined, directly or by others, have one label.
//!    Where an edge fades out, the pieces on both sides of it are divided by distance ([`joins`]).
//! 5. *Pieces* ([`evaluator`]). Within its region a piece is f. Beyond an edge it is the Taylor
//!    polynomial around a place a little within.
//!
//! The search may miss what is smaller than a cell of the grid, so nothing is proven.

mod cells;
mod evaluator;
mod field;
mod grid;
mod joins;
mod labels;
mod sampled;
mod search;
mod site;
mod table;

pub(crate) use field::{KnownField, KnownPieces};
pub(crate) use table::EdgeTable;

use super::{Field, Frame};
use crate::math::Bounds;
use crate::slices;
use glam::DVec3;
use grid::Grid;
use sampled::Sampled;
use search::Search;
use std::sync::Arc;
use table::EdgeCells;

/// Cells along the longest side of the box of the grid on which edges are searched, unless the
/// caller says how many. Fewer miss more of what is small; the calls of f grow with the square.
const CELLS: u32 = 64;
/// Largest number of these cells: the arrays of the grid then take 350 MB.
const MOST_CELLS: u32 = 256;
/// Ratio of the cells of the grid that tells whether there is an edge at all to those.
const FIRST: f64 = 2.0;

/// Maximum number of places that are searched again on a finer grid, at some 2,000 calls of f each.
/// It is the number of corners of 120 boxes. Of a surface with more places none is searched again.
const MOST_CLOSE: usize = 1_000;

/// The cells along the longest side of the box of the grid on which edges are searched, if the
/// caller wants a survey with so many `cells`.
pub(crate) fn cells_of(cells: Option<u32>) -> u32 {
    cells.unwrap_or(CELLS).min(MOST_CELLS)
}

/// Whether the values of a field are too noisy for a search for edges; none if there is no such
/// search, because the field is smooth or tells its pieces.
pub(crate) fn is_noisy(field: &dyn Field, bounds: &Bounds) -> Option<bool> {
    let is_searched = field.piecewise().is_none()
        && !field.is_smooth()
        && field.evaluator(Frame::for_box(bounds)).pieces().is_none();
    is_searched.then(|| Sampled::new(field, bounds).is_none())
}

/// Finds the pieces of a field in a box, in the coordinates of the field. Returns cells from which
/// the edges can be traced, and what the evaluators are to know, if that is more than the field
/// itself tells; none if the surface is smooth. In the values of f edges are searched on a grid
/// with `cells` along the longest side of the box.
pub(crate) async fn known_in(
    field: &dyn Field,
    bounds: &Bounds,
    width: f64,
    cells: u32,
) -> Option<(Vec<Bounds>, Option<KnownPieces>)> {
    if let Some(own) = field.piecewise() {
        let (cells, own) = own.pieces_in(bounds, width, cells).await;
        return Some((cells, Some(KnownPieces::Own(own))));
    }
    if let Some(pieces) = field.evaluator(Frame::for_box(bounds)).pieces() {
        return Some((pieces.edge_cells(bounds, width), None));
    }
    if field.is_smooth() {
        return None;
    }
    let table = find(field, bounds, cells).await?;
    Some((table.edge_cells(bounds, width), Some(KnownPieces::Edges(Arc::new(table)))))
}

/// Finds the edges of the surface of a field in a box, in the coordinates of the field. Returns no
/// table for a surface without edges.
async fn find(field: &dyn Field, bounds: &Bounds, cells: u32) -> Option<EdgeTable> {
    let sampled = Sampled::new(field, bounds)?;
    let cell = sampled.size / f64::from(cells);
    let [mut first, mut search] = [FIRST * cell, cell].map(|cell| Search::new(&sampled, cell));
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

/// Cells of a box in which the label changes on the surface of a field, from which its edges can be
/// traced. Each pair of labels has one cell within some widths. `labels` writes the labels at
/// points.
pub(crate) fn edge_cells_between(
    field: &dyn Field,
    labels: &dyn Fn(&[DVec3], &mut [u32]),
    bounds: &Bounds,
    width: f64,
) -> Vec<Bounds> {
    /// Number of times that the way from one label to the other is halved.
    const HALVINGS: u32 = 6;
    let sampled = Sampled::in_box(field, bounds);
    let grid = slices::complete(Grid::sample(&sampled, bounds, sampled.size / f64::from(CELLS)));
    let (points, of_edge) = slices::complete(grid.points(&sampled));
    let mut of_point = vec![0; points.len()];
    labels(&points, &mut of_point);
    let links = grid.links(&sampled).into_iter().map(|link| link.map(|edge| of_edge[edge] as usize));
    let links: Vec<[usize; 2]> = links.filter(|&[a, b]| of_point[a] != of_point[b]).collect();
    let mut ways: Vec<[DVec3; 2]> = links.iter().map(|link| link.map(|point| points[point])).collect();
    let mut at_middle = vec![0; ways.len()];
    for _ in 0..HALVINGS {
        let middles: Vec<DVec3> = ways.iter().map(|[from, to]| from.midpoint(*to)).collect();
        labels(&middles, &mut at_middle);
        for (k, way) in ways.iter_mut().enumerate() {
            way[usize::from(at_middle[k] != of_point[links[k][0]])] = middles[k];
        }
    }
    let mut found = EdgeCells::new(width, table::APART);
    for ([a, b], [from, to]) in links.into_iter().zip(ways) {
        let place = from.midpoint(to);
        if bounds.holds(place) {
            found.add([of_point[a].min(of_point[b]), of_point[a].max(of_point[b])], place);
        }
    }
    found.cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::FnField;
    use crate::slices::complete;

    fn table(f: impl Fn(DVec3) -> f64 + Send + Sync, half: f64) -> Option<EdgeTable> {
        complete(find(&FnField::new(f), &Bounds::cube(half), CELLS))
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
