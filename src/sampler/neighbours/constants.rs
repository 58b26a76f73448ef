//! How far neighbours are looked for. The fronts write the first lists and the relaxation makes them anew, so both have
//! to agree on these figures.

/// Range of the Gaussian repulsion, in radii.
pub(crate) const GAUSSIAN_RANGE: f32 = 3.0;

/// Verlet skin of the lists of particles of one size, in radii: the lists reach this much beyond the range, so that they
/// serve while particles move. It was chosen by counting instructions: a wider one lengthens every list, a narrower one
/// has more of them made anew.
pub(crate) const GAUSSIAN_SKIN: f32 = 0.4;

/// Distance at which two discs of the overlap repulsion stop pushing, over the sum of their radii.
const OVERLAP_REACH: f32 = 1.15;

/// Range of the overlap repulsion, in mean radii of the pair.
pub(crate) const OVERLAP_RANGE: f32 = 2.0 * OVERLAP_REACH;

/// Verlet skin of the lists of particles of many sizes, in mean radii of the pair.
pub(crate) const OVERLAP_SKIN: f32 = 0.8;

/// The longest change of a particle's unit normal until its list is made anew.
pub(crate) const MAX_TURN: f32 = 0.1;

/// Pairs whose normals have a cosine above this repel in full until their lists are made anew.
pub(crate) const FULL_COSINE: f32 = 0.5 + 2.0 * MAX_TURN;

/// Pairs whose normals have a cosine below this do not repel until their lists are made anew, and are not listed.
pub(crate) const LISTED_COSINE: f32 = -0.5 - 2.0 * MAX_TURN;

/// Side of a grid's cells over the radius of the usual query. It was chosen by counting instructions, which hardly change
/// from 1.2 to 2.5, and by memory: larger cells fill their blocks better.
pub(crate) const CELL_PER_REACH: f32 = 2.0;
