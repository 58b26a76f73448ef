//! The mesh of a refined run that follows a surface while it moves, frame by frame.
//!
//! Newton's method moves the particles onto the new surface, the springs and flips of a level keep
//! the lattice even, and surgery lets particles be born and die where that disturbs the order
//! least: M. Botsch and L. Kobbelt, "A Remeshing Approach to Multiresolution Modeling", Symposium
//! on Geometry Processing 2004, with trials instead of splits and collapses by length. Varying
//! sizes are taken from the radius field at the new places, in every frame.
//!
//! If a particle does not reach the surface, or a face looks against it, the surface has torn or
//! joined. The mesh is then given up, and the particles continue without it:
//! [`Flow`](crate::sampler::flow::Flow).

use super::net::{Ground, MovedBlock, Net};
use super::recipe::Recipe;
use super::walls::Walls;
use super::{Goals, Refinement, Refusal, Target, Turn, border, coarse};
use crate::math::{Bounds, NONE};
use crate::mesh::half_edge::HalfEdges;
use crate::particles::{Particles, Slots};
use crate::sampler::probe::Probe;

/// A frame of a mesh that follows a surface.
#[derive(Clone, Debug)]
pub(crate) struct MovingMesh {
    pub(crate) refinement: Refinement,
    /// Area of the surface at the beginning of the frame.
    area: f64,
}

impl MovingMesh {
    /// Begins a frame with the particles of the frame before, and the mesh between them by its
    /// `corners`. Particles are born and die among those whose `turn` it is. None if the mesh ends
    /// somewhere off the box.
    pub(crate) fn new(
        particles: &Particles,
        corners: &[u32],
        bounds: &Bounds,
        target: Target,
        spacing: f32,
        turn: Turn,
    ) -> Option<Self> {
        let mut net = Net::over(particles, corners.as_chunks().0, bounds, target, spacing)?;
        if !net.hold_border() {
            return None;
        }
        let recipe = Recipe::of_frame(net.is_graded(), net.has_border());
        let mut refinement = Refinement::of_layer(net, MovedBlock::default(), target, None);
        refinement.level =
            Goals { is_first: false, turn: Some(turn), to_come: 0, recipe, spacing, faces: 0.0 };
        let area = refinement.area();
        Some(Self { refinement, area })
    }

    /// Joins particles that have followed the surface without a mesh into one.
    ///
    /// # Errors
    ///
    /// The place where the mesh is in doubt.
    pub(crate) fn join(
        probe: &mut Probe,
        particles: &Particles,
        bounds: &Bounds,
        target: Target,
    ) -> Result<Self, Refusal> {
        let spacing = 2.0 * target.radius;
        let triangles = coarse::triangles(particles, bounds)?;
        let net = Net::over(particles, &triangles, bounds, target, spacing);
        let mut net = net.ok_or_else(|| coarse::doubtful(particles, 0))?;
        let mut block = MovedBlock::default();
        border::clip(&mut net, &mut Ground { probe, block: &mut block }, spacing)?;
        let refinement = Refinement::of_layer(net, block, target, None);
        let area = refinement.area();
        Ok(Self { refinement, area })
    }

    /// Factor by which lengths on the surface grew in this frame.
    pub(crate) fn growth(&self) -> f64 {
        (self.refinement.area() / self.area).sqrt()
    }

    /// Writes the particles of the finished frame to the columns of the frame before, new ones
    /// last, and the mesh to `corners`. A frame that was cancelled earlier leaves both as they
    /// were.
    pub(crate) fn hand_on(self, radius: f32, particles: &mut Particles, corners: &mut Vec<u32>) {
        let net = self.refinement.net;
        let (old, born): (Vec<u32>, Vec<u32>) = (0..net.position.len() as u32)
            .filter(|&v| net.mesh.has_vertex(v))
            .partition(|&v| !net.is_born[v as usize]);
        let mut place = vec![NONE; net.position.len()];
        for (row, &v) in (0..).zip(&old) {
            place[v as usize] = row;
        }
        particles.keep(|i| place[i] != NONE);
        for (row, &v) in old.iter().enumerate() {
            particles.local[row] = net.position[v as usize];
            particles.normal[row] = net.normal[v as usize];
            if net.is_graded() {
                particles.radius[row] = radius * net.size_of(v);
            }
        }
        for &v in &born {
            let near = net.mesh.neighbours(v).map(|other| place[other as usize]).find(|&row| row != NONE);
            let (parent, level) =
                near.map_or((Particles::NO_PARENT, 0), |row| (row, particles.level[row as usize] + 1));
            place[v as usize] = particles.len() as u32;
            let (position, normal) = (net.position[v as usize], net.normal[v as usize]);
            particles.push(position, normal, radius * net.size_of(v), parent, level, Slots::default());
        }
        corners.clear();
        corners.extend(net.mesh.triangles().flatten().map(|v| place[v as usize]));
    }
}

impl Net {
    /// The net of particles with these triangles between them, with sizes in units of the target's
    /// radius. None if it is no manifold.
    fn over(
        particles: &Particles,
        triangles: &[[u32; 3]],
        bounds: &Bounds,
        target: Target,
        spacing: f32,
    ) -> Option<Self> {
        let size = match target.grading {
            Some(_) => particles.radius.iter().map(|radius| radius / target.radius).collect(),
            None => Vec::new(),
        };
        let largest = size.iter().copied().reduce(f32::max).unwrap_or(1.0);
        Some(Self {
            mesh: HalfEdges::from_triangles(particles.len(), triangles)?,
            position: particles.local.clone(),
            normal: particles.normal.clone(),
            slots: vec![Slots::default(); particles.len()],
            size,
            walls: Walls::new(bounds, &particles.local, spacing * largest),
            is_born: vec![false; particles.len()],
            ..Self::default()
        })
    }

    /// Binds the particles of the border to the planes of the box on which they lie. Returns
    /// whether each of them lies on one.
    fn hold_border(&mut self) -> bool {
        for v in 0..self.position.len() as u32 {
            if !self.mesh.has_vertex(v) || !self.mesh.is_border(v) {
                continue;
            }
            let planes = self.walls.planes_at(self.position[v as usize]);
            if planes.is_inner() {
                return false;
            }
            self.walls.set(v, planes);
        }
        true
    }
}
