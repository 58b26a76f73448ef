//! The bodies of a mesh: the pieces that a printer would print.

use super::triangulation::Triangulation;
use crate::math::sort_few;
use crate::particles::Particles;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// A body is a loose chip if its area is below this share of the largest one's: a piece that a box
/// cuts off at a corner, for example. Larger: small pieces that are wanted count as chips.
const CHIP_SHARE: f64 = 0.05;

/// A body of a mesh: a closed component with the walls of its hollows, or an open component.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Body {
    /// Area, in squared units of the coordinates.
    pub area: f64,
    /// Lower corner of the box around it, in the coordinates of the field.
    pub min: [f64; 3],
    /// Upper corner of the box around it.
    pub max: [f64; 3],
    /// Volume that it encloses, without its hollows; none if it has an open edge.
    pub volume: Option<f64>,
    /// Whether it is a loose chip: its area is less than a twentieth of the largest body's.
    pub is_chip: bool,
}

/// Which bodies of a mesh a file holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Bodies {
    /// All of them.
    #[default]
    All,
    /// All that are not loose chips.
    WithoutChips,
    /// The one with the largest area.
    Largest,
}

/// The bodies of a mesh, and their components.
pub(crate) struct Split {
    /// The largest first.
    pub(crate) bodies: Vec<Body>,
    /// For each component, its place in `bodies`.
    pub(crate) place_of: Vec<usize>,
}

impl Split {
    pub(crate) fn new(mesh: &Triangulation, particles: &Particles) -> Self {
        /// A body that is still empty.
        const NOTHING: Body = Body {
            area: 0.0,
            min: [f64::INFINITY; 3],
            max: [f64::NEG_INFINITY; 3],
            volume: Some(0.0),
            is_chip: false,
        };
        let components = &mesh.topology.components;
        let body_of = |component: usize| mesh.body_of.get(component).map_or(component, |&body| body as usize);
        let mut all = vec![NOTHING; components.len()];
        for triangle in &mesh.triangles {
            let body = &mut all[body_of(mesh.component_of(triangle))];
            let [a, b, c] = triangle.map(|v| particles.local[v as usize].as_dvec3());
            body.area += 0.5 * (b - a).cross(c - a).length();
            body.volume = body.volume.map(|volume| volume + a.dot(b.cross(c)) / 6.0);
            body.min = DVec3::from(body.min).min(a).min(b).min(c).to_array();
            body.max = DVec3::from(body.max).max(a).max(b).max(c).to_array();
        }
        for (k, component) in components.iter().enumerate() {
            if component.border_edges > 0 {
                all[body_of(k)].volume = None;
            }
        }
        let mut order: Vec<(f64, usize)> =
            (0..all.len()).filter(|&k| body_of(k) == k).map(|k| (all[k].area, k)).collect();
        sort_few(&mut order, |(a, _), (b, _)| a > b);
        let largest = order.first().map_or(0.0, |(area, _)| *area);
        let mut place_of = vec![0; all.len()];
        for (place, &(_, k)) in order.iter().enumerate() {
            place_of[k] = place;
        }
        let placed = |local: [f64; 3]| (DVec3::from(local) + particles.origin).to_array();
        let bodies = order.iter().map(|&(area, k)| Body {
            min: placed(all[k].min),
            max: placed(all[k].max),
            is_chip: area < CHIP_SHARE * largest,
            ..all[k].clone()
        });
        Self { bodies: bodies.collect(), place_of: (0..all.len()).map(|k| place_of[body_of(k)]).collect() }
    }
}

impl Triangulation {
    /// The bodies of the mesh over these particles, the largest first.
    #[must_use]
    pub fn bodies(&self, particles: &Particles) -> Vec<Body> {
        Split::new(self, particles).bodies
    }

    /// The triangles of some bodies, for a file; their topology is not counted.
    pub(crate) fn only(&self, which: Bodies, particles: &Particles) -> Cow<'_, Self> {
        if which == Bodies::All {
            return Cow::Borrowed(self);
        }
        let Split { bodies, place_of } = Split::new(self, particles);
        let is_kept = |triangle: &[u32; 3]| which.keep(&bodies, place_of[self.component_of(triangle)]);
        let of = |corners: &[[u32; 3]]| {
            let kept = corners.iter().zip(&self.triangles).filter(|(_, triangle)| is_kept(triangle));
            kept.map(|(corners, _)| *corners).collect()
        };
        Cow::Owned(Self {
            triangles: of(&self.triangles),
            corners: if self.has_corners() { of(self.corners()) } else { Vec::new() },
            turned: self.turned.clone(),
            ..Self::default()
        })
    }

    /// The component of a triangle.
    fn component_of(&self, triangle: &[u32; 3]) -> usize {
        self.topology.component_of[triangle[0] as usize] as usize
    }
}

impl Split {
    /// The triangles of the loose chips, in ascending order.
    pub(crate) fn chips(&self, mesh: &Triangulation) -> Vec<u32> {
        (0..)
            .zip(&mesh.triangles)
            .filter(|(_, triangle)| self.bodies[self.place_of[mesh.component_of(triangle)]].is_chip)
            .map(|(k, _)| k)
            .collect()
    }
}

impl Bodies {
    /// Whether the body at a place among `bodies` is kept.
    fn keep(self, bodies: &[Body], place: usize) -> bool {
        match self {
            Self::All => true,
            Self::WithoutChips => !bodies[place].is_chip,
            Self::Largest => place == 0,
        }
    }

    /// The size of the box around these bodies of a mesh, whose bodies are `all`, the largest
    /// first; zeros without any.
    #[must_use]
    pub fn size(self, all: &[Body]) -> DVec3 {
        let kept = (0..all.len()).filter(|&place| self.keep(all, place)).map(|place| &all[place]);
        let (low, high) = kept.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), body| {
            (low.min(body.min.into()), high.max(body.max.into()))
        });
        (high - low).max(DVec3::ZERO)
    }
}
