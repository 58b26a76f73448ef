//! The points of edges.

use glam::DVec3;

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
    /// Unit vector along the edge.
    pub(super) along: DVec3,
    /// Unit vector across the edge, from the second piece to the first.
    pub(super) across: DVec3,
    /// Distance between the unit normals on both sides.
    pub(super) angle: f64,
    /// Whether the edge of these pieces fades out somewhere.
    pub(super) fades: bool,
}
