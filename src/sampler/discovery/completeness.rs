//! Claims of a run about the connected components of the surface, and how sure each of them is.
//!
//! Three claims are made, each weaker than the next one sounds:
//!
//! * *Witnessed*: there is a point on every component. Interval arithmetic proves it, or it is only
//!   searched ([`Search`]).
//! * *Sampled*: every witnessed component larger than a stated size holds particles ([`Sampled`]).
//!   The others are named, with their places and sizes ([`Unsampled`]).
//! * *At this radius*: the components and the Euler number in the report are those of the
//!   particles' neighbour graph. A neck or a needle thinner than a particle may join or divide
//!   them.

use serde::Serialize;

/// How the first points of the connected components were found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Search {
    /// Interval arithmetic proves that every component has a witness, and that each witness is on
    /// the component of a particle or listed among the [`Unsampled`].
    Proven,
    /// Only the nodes of a grid were examined, which can miss a component smaller than its cells;
    /// or the proof left cells or witnesses open.
    #[default]
    Searched,
}

/// The witnessed components that hold particles, and those that do not.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Sampled {
    /// Every witnessed component that reaches farther than this from its witness holds particles; 0
    /// if all do. None if this is not proven.
    pub above: Option<f64>,
    /// Number of witnessed components without a particle; none without a search for witnesses. A
    /// component counts twice if two of its witnesses could not be proven to be connected.
    pub missing: Option<usize>,
    /// A witness of each component without a particle: at most 256.
    pub without: Vec<Unsampled>,
}

/// A witness on whose component no particle was found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Unsampled {
    /// The witness, a point of the surface.
    pub position: [f64; 3],
    /// Largest distance from the witness at which a point of the component was found.
    pub reach: f64,
    /// Whether the exploration stopped there, so that the component may be larger.
    pub goes_on: bool,
}

/// Why a search is not proven. There is a doubt exactly if the [`Search`] is only searched.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Doubt {
    /// The field has no bounds to prove anything by.
    NoBounds,
    /// The surface has creases that were found by searching, as where sheets cross: the proof holds
    /// for components without.
    Creases,
    /// The run ended before the search or the audit did.
    Unfinished,
    /// Two sheets are so near each other that single precision may hold them at one place.
    Unresolved {
        /// A point of one of the sheets.
        position: [f64; 3],
        /// Distance from that point to the other sheet.
        gap: f64,
        /// Least distance at which sheets are distinguished here.
        least: f64,
    },
    /// The proof could not decide in some cells of the box.
    Cells {
        /// Number of cells.
        count: u64,
        /// Middle of the first undecided cell.
        position: [f64; 3],
        /// Length of the longest side of that cell.
        size: f64,
    },
    /// For some witnesses it could not be proven whether a particle lies on their component.
    Witnesses {
        /// Number of witnesses.
        count: u64,
        /// Position of the first witness in doubt.
        position: [f64; 3],
    },
}

impl Doubt {
    /// Returns the doubt with its place, if it has one, mapped by `to`.
    pub(crate) fn moved(mut self, to: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        match &mut self {
            Self::NoBounds | Self::Creases | Self::Unfinished => {}
            Self::Unresolved { position, .. }
            | Self::Cells { position, .. }
            | Self::Witnesses { position, .. } => {
                *position = to(*position);
            }
        }
        self
    }
}
