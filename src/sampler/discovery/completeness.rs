//! How sure a run is of having found every connected component of the surface.

use serde::Serialize;

/// How the first points of the connected components were found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Search {
    /// Interval arithmetic proves that there is a first point on every component.
    Proven,
    /// By looking at the nodes of a grid, which can miss a component smaller than its cells; or the proof left cells open.
    #[default]
    Searched,
}
