//! The surfaces on which claims about smooth closed surfaces are made: a round one, one whose
//! curvature varies, one with a handle and one with five.

use marching_particles::field::gallery;

/// Identifier and Euler number of each.
pub(crate) fn smooth() -> [(&'static str, i64); 4] {
    ["sphere", "ellipsoid", "torus", "tanglecube"].map(|id| {
        let genus = gallery::find(id).and_then(|surface| surface.genus).expect("a closed gallery surface");
        (id, 2 - 2 * i64::from(genus))
    })
}
