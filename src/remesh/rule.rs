//! How the patches around a corner give f: nested minima and maxima of their functions.

use glam::DVec3;

/// Most patches around a corner with both convex and concave edges for which all rules are tried.
const MOST: usize = 5;
/// Number of directions in which a rule is compared with the mesh.
const DIRECTIONS: u32 = 200;
/// Least share of directions that must agree. Faces of curved patches leave their tangent planes.
const AGREED: f64 = 0.9;

/// Which of the patches' functions gives f.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Rule {
    Patch(u32),
    Least(Vec<Self>),
    Greatest(Vec<Self>),
}

impl Rule {
    /// The maximum of these at a convex edge, the minimum at a concave one.
    pub(super) fn of(is_convex: bool, parts: Vec<Self>) -> Self {
        if is_convex { Self::Greatest(parts) } else { Self::Least(parts) }
    }

    /// The patch that gives f, and its value.
    pub(super) fn taken(&self, value: &mut dyn FnMut(u32) -> f64) -> (u32, f64) {
        let (parts, sign) = match self {
            Self::Patch(patch) => return (*patch, value(*patch)),
            Self::Least(parts) => (parts, -1.0),
            Self::Greatest(parts) => (parts, 1.0),
        };
        let mut best = (u32::MAX, f64::NAN);
        for part in parts {
            let own = part.taken(value);
            // The first comparison is always true.
            if best.0 == u32::MAX || sign * own.1 > sign * best.1 {
                best = own;
            }
        }
        best
    }

    /// The rule for the patches around a corner. Each comes with its normal there and whether the
    /// edge to the next patch is convex. If the edges are of both kinds, neighbours are joined in
    /// every order, and the first of the rules that agree best with the mesh is taken: `is_inside`
    /// tells whether a direction from the corner leads into the solid.
    pub(super) fn around(patches: &[(u32, DVec3, bool)], is_inside: impl Fn(DVec3) -> bool) -> Option<Self> {
        let nodes: Vec<(Self, bool)> =
            patches.iter().map(|&(patch, _, is_convex)| (Self::Patch(patch), is_convex)).collect();
        let is_convex = nodes.first()?.1;
        if nodes.iter().all(|node| node.1 == is_convex) {
            return Some(Self::of(is_convex, nodes.into_iter().map(|node| node.0).collect()));
        }
        if nodes.len() > MOST {
            return None;
        }
        let known: Vec<(DVec3, bool)> = directions().map(|way| (way, is_inside(way))).collect();
        let mut best: Option<(usize, Self)> = None;
        all_orders(nodes, &mut |rule| {
            let agreed = known.iter().filter(|(way, is_inside)| {
                let mut value = |patch: u32| {
                    let own = patches.iter().filter(|own| own.0 == patch);
                    own.map(|own| own.1).sum::<DVec3>().normalize_or_zero().dot(*way)
                };
                (rule.taken(&mut value).1 < 0.0) == *is_inside
            });
            let agreed = agreed.count();
            if best.as_ref().is_none_or(|(most, _)| agreed > *most) {
                best = Some((agreed, rule));
            }
        });
        best.filter(|(agreed, _)| *agreed as f64 >= AGREED * f64::from(DIRECTIONS)).map(|(_, rule)| rule)
    }
}

/// Calls `each` with the rule of every order in which neighbours in a ring of nodes can be joined.
fn all_orders(nodes: Vec<(Rule, bool)>, each: &mut dyn FnMut(Rule)) {
    if nodes.len() == 1 {
        nodes.into_iter().for_each(|(rule, _)| each(rule));
        return;
    }
    for k in 0..nodes.len() {
        let next = (k + 1) % nodes.len();
        let mut joined = nodes.clone();
        let own = Rule::of(nodes[k].1, vec![nodes[k].0.clone(), nodes[next].0.clone()]);
        joined[k] = (own, nodes[next].1);
        joined.remove(next);
        all_orders(joined, each);
    }
}

/// Evenly spread directions: a Fibonacci lattice.
fn directions() -> impl Iterator<Item = DVec3> {
    (0..DIRECTIONS).map(|k| {
        let z = 1.0 - (2.0 * f64::from(k) + 1.0) / f64::from(DIRECTIONS);
        let (sin, cos) = libm::sincos(2.399_963_229_728_653 * f64::from(k));
        let radius = libm::sqrt(1.0 - z * z);
        DVec3::new(radius * cos, radius * sin, z)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inner_corner_of_a_bracket_joins_its_concave_pair_first() {
        // The solid z < 0 and (x < 0 or y < 0).
        let is_inside = |p: DVec3| p.z < 0.0 && (p.x < 0.0 || p.y < 0.0);
        let around = [(0, DVec3::Z, true), (1, DVec3::Y, false), (2, DVec3::X, true)];
        let rule = Rule::around(&around, is_inside).expect("a rule");
        for way in directions() {
            let mut value = |patch: u32| way[2 - patch as usize];
            assert_eq!(rule.taken(&mut value).1 < 0.0, is_inside(way), "{way} {rule:?}");
        }
    }
}
