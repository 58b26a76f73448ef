//! The mesh over the particles of a run: joined on request, in slices, and dropped when they
//! change.

use super::{Run, RunState};
use crate::export::{File, FileContent, MeshFile};
use crate::field::Field;
use crate::field::crossing::is_passed;
use crate::math::{Bounds, Forest, sort_few};
use crate::mesh::bodies::{Body, Split};
use crate::mesh::facing::Inside;
use crate::mesh::stars::Sheets;
use crate::mesh::triangulation::{self, Middle, Triangulation};
use crate::particles::{OrientedPoint, Particles};
use crate::quality::sheets::ByField;
use crate::slices::{self, Estimated, MEDIUM};
use crate::spatial::tree::Tree;
use crate::topology::Component;
use glam::DVec3;
use serde::Serialize;
use std::io;

/// Counts and sizes of a mesh: triangles, components, borders and volume.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct MeshAnswer {
    /// Number of triangles.
    pub triangles: usize,
    /// Connected components, in the order of their first particles.
    pub components: Vec<MeshComponent>,
    /// Number of border loops where no manifold was possible, not counting ends of the surface.
    pub unfilled: usize,
    /// Number of particles in no triangle.
    pub left_out: usize,
    /// [Volume](Triangulation::volume) that the mesh encloses; none if it is open.
    pub volume: Option<f64>,
    /// Sign of f inside of the closed parts; none if there is no closed part. All face outward in
    /// files.
    pub inside: Option<Inside>,
    /// [Smallest angle](Triangulation::smallest_angle) of any triangle, in degrees; none without
    /// triangles.
    pub smallest_angle: Option<f64>,
    /// Border loops: rows of particles in order. Those where no manifold was possible come first,
    /// then the longest.
    pub loops: Vec<Vec<u32>>,
    /// The bodies, the largest first.
    pub bodies: Vec<Body>,
    /// The triangles of the bodies that are loose chips, in ascending order.
    pub chips: Vec<u32>,
}

/// A connected part of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct MeshComponent {
    /// Number of triangles.
    pub triangles: u32,
    /// Euler number, vertices − edges + triangles: 2 − 2g for a closed surface of genus g.
    pub euler: i64,
    /// Number of edges with one triangle.
    pub open_edges: u32,
    /// Index of its body among the bodies of the mesh.
    pub body: usize,
}

/// The mesh of a run, if there is one, and a file of it under way.
#[derive(Default)]
pub(super) struct Meshing {
    state: MeshState,
    file: Option<Begun>,
}

#[derive(Default)]
enum MeshState {
    /// No mesh has been requested since the particles changed.
    #[default]
    None,
    /// The particles are being joined.
    Joining(Estimated<'static, Triangulation>),
    /// The mesh is complete.
    Joined(Box<Triangulation>),
}

impl Meshing {
    /// The mesh, if it is complete.
    pub(super) fn joined(&self) -> Option<&Triangulation> {
        match &self.state {
            MeshState::Joined(mesh) => Some(&**mesh),
            _ => None,
        }
    }

    /// Estimated share of the joining that is done.
    pub(super) fn fraction(&self) -> f64 {
        match &self.state {
            MeshState::None => 0.0,
            MeshState::Joining(work) => work.fraction(),
            MeshState::Joined(_) => 1.0,
        }
    }

    /// The mesh, if it is complete.
    pub(super) fn into_joined(self) -> Option<Triangulation> {
        match self.state {
            MeshState::Joined(mesh) => Some(*mesh),
            _ => None,
        }
    }
}

/// Joins particles to triangles, or takes those that are `known`. `bounds` is the clip box,
/// relative to the origin of the particles. `sheets` belongs to the particles, if known: without it
/// near sheets are distinguished by directions alone.
pub(super) async fn joined(
    particles: &Particles,
    known: &[[u32; 3]],
    bounds: &Bounds,
    sheets: Option<&Sheets>,
) -> Triangulation {
    match sheets {
        _ if !known.is_empty() => Triangulation::known(known.to_vec(), particles).await,
        Some(sheets) => triangulation::join(particles, sheets, Some(bounds)).await,
        None => triangulation::in_slices(particles, Some(bounds)).await,
    }
}

/// A mesh file that is being written.
struct Begun {
    wish: MeshFile,
    content: FileContent,
    /// Number of rows that are written.
    next: usize,
    bytes: Vec<u8>,
}

impl MeshAnswer {
    /// Counts and sizes of the triangles over the particles.
    #[must_use]
    pub fn new(mesh: &Triangulation, particles: &Particles) -> Self {
        let split = Split::new(mesh, particles);
        let component = |(component, &body): (&Component, &usize)| MeshComponent {
            triangles: component.triangles,
            euler: component.euler(),
            open_edges: component.border_edges,
            body,
        };
        let mut loops: Vec<((bool, usize), &Vec<u32>)> = (mesh.topology.borders.iter())
            .map(|border| ((mesh.unfilled.contains(border), border.len()), border))
            .collect();
        sort_few(&mut loops, |(a, _), (b, _)| a > b);
        Self {
            triangles: mesh.triangles.len(),
            components: mesh.topology.components.iter().zip(&split.place_of).map(component).collect(),
            unfilled: mesh.unfilled.len(),
            left_out: mesh.left_out.len(),
            volume: mesh.volume(particles),
            inside: mesh.inside,
            smallest_angle: mesh.smallest_angle(particles),
            loops: loops.into_iter().map(|(_, border)| border.clone()).collect(),
            chips: split.chips(mesh),
            bodies: split.bodies,
        }
    }
}

impl<'f, F: Field + 'f> Run<'f, F> {
    /// Joins the particles to a mesh, with up to `budget` slices of the work, some 10 to 50
    /// microseconds each; returns its counts and sizes once it is complete. The mesh of a refined
    /// run is taken as it is. Call it when the run has ended. The mesh stays until the particles
    /// change.
    pub fn join(&mut self, budget: u32) -> Option<MeshAnswer> {
        self.state.join(&self.field, budget)
    }

    /// The mesh; none before [`Run::join`] is complete.
    #[must_use]
    pub fn mesh(&self) -> Option<&Triangulation> {
        self.state.mesh()
    }

    /// The triangles of the [mesh](Run::mesh): triples of particles, counter-clockwise seen from
    /// outside. Empty before [`Run::join`] is complete.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        self.mesh().map_or(&[], |mesh| &mesh.triangles)
    }

    /// The mesh as a file, with the measurements of the particles: up to `budget` slices of the
    /// work, of [`MEDIUM`] rows each; returns the file once it is complete. Another wish, or a
    /// change of the particles, starts again. Before [`Run::join`] is complete the file has no
    /// triangles.
    ///
    /// # Errors
    ///
    /// An error if the 32-bit counters of the format are too small.
    pub fn mesh_file(&mut self, wish: &MeshFile, budget: u32) -> io::Result<Option<Vec<u8>>> {
        self.state.mesh_file(wish, budget)
    }
}

impl RunState<'_> {
    /// [`Run::join`].
    pub(super) fn join(&mut self, field: &dyn Field, budget: u32) -> Option<MeshAnswer> {
        if let MeshState::None = self.meshing.state {
            let (mut particles, bounds) = (self.particles().clone(), self.local_bounds());
            particles.truncate(self.rows());
            let known = self.sampler.triangles().to_vec();
            let sheets = self.measuring.sheets.clone();
            let expected = if known.is_empty() {
                triangulation::expected_slices(particles.len(), sheets.is_some())
            } else {
                0
            };
            let work = async move { joined(&particles, &known, &bounds, sheets.as_deref()).await };
            self.meshing.state = MeshState::Joining(Estimated::new(Box::pin(work), expected));
        }
        if let MeshState::Joining(work) = &mut self.meshing.state {
            let mesh = work.advance(budget)?;
            self.meshing.state = MeshState::Joined(Box::new(self.judged(field, mesh)));
            self.take_topology(field);
        }
        self.meshing.joined().map(|mesh| MeshAnswer::new(mesh, self.particles()))
    }

    /// The mesh, without triangles in holes where the field has no surface, and facing outward if
    /// the field is larger inside.
    fn judged(&self, field: &dyn Field, mesh: Triangulation) -> Triangulation {
        let evaluator = &mut *self.evaluator(field);
        let has_surface = |Middle { place, up, reach }: Middle| is_passed(evaluator, place, up, reach);
        let mesh = slices::complete(mesh.judged(self.particles(), has_surface));
        if self.is_negative_outside(field) { mesh.facing_outward() } else { mesh }
    }

    /// Whether the box does not cut the surface, and f is negative at all of its corners.
    fn is_negative_outside(&self, field: &dyn Field) -> bool {
        let Bounds { min, max } = self.local_bounds();
        let corners = (0..8).map(|k| [0, 1, 2].map(|axis| if k >> axis & 1 == 0 { min } else { max }[axis]));
        let field = &mut *self.evaluator(field);
        self.at_border() == 0 && corners.map(DVec3::from).all(|p| field.value_and_gradient(p).0 < 0.0)
    }

    /// Takes the topology of the sample from its mesh if the triangles of natural neighbours leave
    /// gaps and the mesh does not: they do where the surface bends too much for its particles. A
    /// mesh that joins what the field does not connect bridges more than gaps.
    pub(super) fn take_topology(&mut self, field: &dyn Field) {
        let (Some(_), Some(mesh)) = (&self.measuring.measured.opening, self.meshing.joined()) else { return };
        let components = mesh.topology.components.len();
        if !self.is_whole(mesh) || self.connected(mesh, field) != components {
            return;
        }
        let euler = mesh.topology.euler();
        let measured = &mut self.measuring.measured;
        let connectivity = &mut measured.figures.connectivity;
        (connectivity.components, connectivity.euler, measured.opening) = (components, euler, None);
    }

    /// Number of components of the triangles of natural neighbours, joined where the field leads
    /// along an edge of the mesh, and from a particle that the mesh leaves out to one near it.
    fn connected(&self, mesh: &Triangulation, field: &dyn Field) -> usize {
        /// Distance, in radii, within which a particle that the mesh leaves out is led to others: a
        /// spacing.
        const NEAR: f32 = 2.0;
        let component = &self.measuring.measured.component;
        let count = self.measuring.measured.figures.connectivity.components;
        let particles = self.particles();
        let mut sets = Forest::new(count);
        let evaluator = self.evaluator(field);
        let mut field = ByField::new(&*evaluator);
        let mut join = |[i, j]: [u32; 2]| {
            let of = [i, j].map(|particle| component[particle as usize]);
            let [i, j] = [i as usize, j as usize];
            let patch = particles.patch_of(i);
            if of.iter().any(|&own| own as usize >= count)
                || sets.find(of[0]) == sets.find(of[1])
                || patch != particles.patch_of(j)
            {
                return;
            }
            let [one, other] = [i, j].map(|particle| OrientedPoint::of(particles, particle));
            if field.leads(patch, one, other) {
                sets.join(of[0], of[1]);
            }
        };
        mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).for_each(&mut join);
        if !mesh.left_out.is_empty() {
            let (tree, mut near) = (Tree::new(&particles.local), Vec::new());
            for &i in &mesh.left_out {
                let (p, reach) = (particles.local[i as usize], NEAR * particles.radius[i as usize]);
                near.clear();
                tree.within_box(p - reach, p + reach, &mut near);
                near.iter().for_each(|&j| join([tree.origin[j as usize], i]));
            }
        }
        (0..count as u32).filter(|&component| sets.find(component) == component).count()
    }

    /// Whether a mesh is a manifold that is open only at the faces of the box.
    fn is_whole(&self, mesh: &Triangulation) -> bool {
        /// Distance from a face, in radii, within which an edge is at the box: one and a half
        /// spacings.
        const AT_BOX: f64 = 3.0;
        let (bounds, particles) = (self.local_bounds(), self.particles());
        let is_at_box = |&v: &u32| {
            let p = particles.local[v as usize].as_dvec3();
            let from_face = (p - bounds.lo()).min(bounds.hi() - p).min_element();
            from_face <= AT_BOX * f64::from(particles.radius[v as usize])
        };
        mesh.topology.is_manifold() && mesh.topology.lone_edges.iter().all(|edge| edge.iter().all(is_at_box))
    }

    fn mesh(&self) -> Option<&Triangulation> {
        self.meshing.joined()
    }

    /// [`Run::mesh_file`].
    fn mesh_file(&mut self, wish: &MeshFile, budget: u32) -> io::Result<Option<Vec<u8>>> {
        if budget == 0 {
            return Ok(None);
        }
        let begun = self.meshing.file.take().filter(|begun| begun.wish == *wish);
        let (particles, measured) = (self.particles(), &self.measuring.measured);
        let mut begun = begun.unwrap_or_else(|| {
            let none = Triangulation::default();
            let content = FileContent::new(wish, particles, measured, self.mesh().unwrap_or(&none));
            Begun { wish: wish.clone(), content, next: 0, bytes: Vec::new() }
        });
        let file = File::new(wish, particles, measured, &begun.content);
        let all = file.rows();
        let end = all.min(begun.next.saturating_add(MEDIUM.saturating_mul(budget as usize)));
        file.write_rows(begun.next..end, &mut begun.bytes)?;
        if end == all {
            return Ok(Some(begun.bytes));
        }
        begun.next = end;
        self.meshing.file = Some(begun);
        Ok(None)
    }
}
