//! Reach of the neighbour lists. The fronts write the first lists and the relaxation renews them,
//! so both have to use the same figures.

/// Range of the Gaussian repulsion, in radii: between the first ring of a lattice, at 2, and the
/// second, at 3.46. The energy of a pair is a twelfth there of what it is at 2.
pub(crate) const GAUSSIAN_RANGE: f32 = 3.0;

/// Verlet skin of the lists of particles of one size, in radii: the lists reach this much beyond
/// the range, so that they serve while particles move, and just not to the second ring. Instruction
/// counts have chosen it: a wider skin makes every list longer, a narrower one has more lists
/// renewed.
pub(crate) const GAUSSIAN_SKIN: f32 = 0.4;

/// Distance at which two discs of the overlap repulsion stop pushing, over the sum of their radii.
/// A longer reach counts more neighbours in each force, and a shorter one leaves gaps that no disc
/// feels.
const OVERLAP_REACH: f32 = 1.15;

/// Range of the overlap repulsion, in mean radii of the pair.
pub(crate) const OVERLAP_RANGE: f32 = 2.0 * OVERLAP_REACH;

/// Verlet skin of the lists of particles of many sizes, in mean radii of the pair: with the range
/// 3.1, less than the second ring of a lattice at 3.46. It is wider than that of one size, because
/// radii change too.
pub(crate) const OVERLAP_SKIN: f32 = 0.8;

/// Length of the change of a particle's unit normal at which its list becomes stale, about 6°. A
/// larger one leaves more pairs whose weight is computed in every step, a smaller one has more
/// lists renewed.
pub(crate) const STALE_TURN: f32 = 0.1;

/// Pairs whose normals have a cosine above this have the weight 1 until one of their lists is
/// stale: the weight falls from 60° on, and both normals may turn.
pub(crate) const FULL_COSINE: f32 = 0.5 + 2.0 * STALE_TURN;

/// Pairs whose normals have a cosine below this have the weight 0 until one of their lists is
/// stale, and are not listed: the weight ends at 120°, and both normals may turn.
pub(crate) const LISTED_COSINE: f32 = -0.5 - 2.0 * STALE_TURN;

/// Side of a grid's cells over the radius of the usual query. Instruction counts hardly change from
/// 1.2 to 2.5; larger cells fill their blocks better and so take less memory.
pub(crate) const CELL_PER_REACH: f32 = 2.0;

/// Particles that are looked at together: the lanes of a SIMD register.
pub(crate) const CHUNK: usize = 4;
