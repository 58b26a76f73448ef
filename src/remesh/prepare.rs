//! Repairs of a mesh before it becomes a field.

use super::colours::Colours;
use super::edges::{Edges, ends_of};
use super::mesh::volume;
use super::tree::Tree;
use super::{MeshError, TriangleMesh};
use crate::field::formula::CHANNELS;
use crate::field::{IntoField, Value};
use crate::math::{Bounds, Forest, IndexTable, counted, hash};
use crate::slices::{self, pause};
use core::cell::OnceCell;
use glam::DVec3;
use std::sync::Arc;

/// Distance, as a share of the diagonal, below which vertices are merged and a face has no width: a
/// few units in the last place of single precision.
const SAME: f64 = 2e-7;
/// Most rounds that divide faces at vertices on their sides; a round divides one side of each.
const ROUNDS: usize = 6;

/// What was repaired in a mesh, in the order of the repairs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct MeshRepairs {
    /// Vertices that were merged with another one at the same point.
    pub merged: usize,
    /// Faces that were dropped because they have no area.
    pub degenerate: usize,
    /// Faces that were dropped because another face has the same corners.
    pub doubled: usize,
    /// Faces that were divided at a vertex on one of their sides.
    pub divided: usize,
    /// Faces whose orientation was reversed.
    pub turned: usize,
}

impl MeshRepairs {
    /// The repairs as a list in words; empty if there were none.
    #[must_use]
    pub fn words(&self) -> Vec<String> {
        let Self { merged, degenerate, doubled, divided, turned } = *self;
        let all = [
            (merged, "vertex merged", "vertices merged"),
            (degenerate, "face without area dropped", "faces without area dropped"),
            (doubled, "doubled face dropped", "doubled faces dropped"),
            (divided, "face divided at a vertex on its side", "faces divided at vertices on their sides"),
            (turned, "face turned", "faces turned"),
        ];
        let some = all.into_iter().filter(|(count, ..)| *count > 0);
        some.map(|(count, one, many)| counted(count, one, many)).collect()
    }
}

/// A repaired mesh, with the search structures that tell inside from outside.
#[derive(Clone)]
pub struct MeshSolid {
    pub(super) mesh: Arc<TriangleMesh>,
    /// The vertices are relative to this point.
    pub(super) origin: DVec3,
    pub(super) edges: Arc<Edges>,
    pub(super) tree: Arc<Tree>,
    /// The mesh before its repair, if it has colours.
    colours: Option<Arc<Colours>>,
    /// Segments along which the edges of the mesh are sharp, whatever their angle.
    marks: Arc<[[DVec3; 2]]>,
    repairs: MeshRepairs,
    borders: usize,
    pub(super) fans: usize,
    pieces: usize,
    is_sheet: bool,
}

impl core::fmt::Debug for MeshSolid {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("MeshSolid").field("repairs", &self.repairs).finish_non_exhaustive()
    }
}

impl TriangleMesh {
    /// The solid that the mesh encloses, or the open surface that it is. Vertices at the same point
    /// are merged, faces without area and duplicates are dropped, and faces are divided at vertices
    /// on their sides and oriented alike. A piece of negative volume is reversed with the pieces
    /// inside it; so a piece oriented against the one around it remains a cavity. The faces of an
    /// open piece are turned to agree with most of them.
    ///
    /// # Errors
    ///
    /// [`MeshError::NoArea`] if no face is left, [`MeshError::NoVolume`] if a closed mesh encloses
    /// nothing, and [`MeshError::Far`] if it lies more than 1,000 of its diagonals from the origin.
    pub fn solid(&self) -> Result<MeshSolid, MeshError> {
        slices::complete(self.mended())
    }

    /// [`TriangleMesh::solid`] in slices.
    pub(crate) async fn mended(&self) -> Result<MeshSolid, MeshError> {
        /// Largest distance of a box from the origin that is sampled, in diagonals.
        const FAR: f64 = 1000.0;
        let mut repairs = MeshRepairs::default();
        let bounds = self.bounds();
        if bounds.lo().abs().max(bounds.hi().abs()).max_element() > FAR * bounds.diagonal() {
            return Err(if bounds.diagonal() > 0.0 { MeshError::Far } else { MeshError::NoArea });
        }
        let origin = bounds.local_origin();
        let near =
            Self::of_parts(self.vertices().iter().map(|p| p - origin).collect(), self.faces().to_vec());
        let width = SAME * near.bounds().diagonal();
        let (vertices, merged) = merged(&near, width);
        repairs.merged = merged.0;
        pause().await;
        let mut faces = kept(&vertices, merged.1, width, &mut repairs);
        if faces.is_empty() {
            return Err(MeshError::NoArea);
        }
        for _ in 0..ROUNDS {
            pause().await;
            let edges = Edges::new(&faces);
            let divided = divide(&vertices, &mut faces, &edges, width);
            if divided == 0 {
                break;
            }
            repairs.divided += divided;
            faces = kept(&vertices, faces, width, &mut repairs);
        }
        pause().await;
        let edges = Edges::new(&faces);
        let pieces = orient(&vertices, &mut faces, &edges, &mut repairs.turned);
        let (borders, fans) = (edges.count(|sides| sides == 1), edges.count(|sides| sides > 2));
        pause().await;
        // Reversing a face renumbers its sides.
        let edges = Edges::new(&faces);
        let mesh = TriangleMesh::of_parts(vertices, faces);
        let has_colours = !self.colours().is_empty();
        let colours = has_colours.then(|| Arc::new(Colours::new(near, self.colours().to_vec())));
        pause().await;
        let tree = Tree::new(&mesh.all_corners());
        let is_sheet = is_sheet(&mesh, borders)?;
        Ok(MeshSolid {
            mesh: Arc::new(mesh),
            origin,
            edges: Arc::new(edges),
            tree: Arc::new(tree),
            colours,
            marks: Arc::default(),
            repairs,
            borders,
            fans,
            pieces,
            is_sheet,
        })
    }
}

impl MeshSolid {
    /// The repaired mesh, whose vertices are relative to [`MeshSolid::origin`].
    #[must_use]
    pub fn mesh(&self) -> &TriangleMesh {
        &self.mesh
    }

    /// The point to which the vertices of [`MeshSolid::mesh`] are relative: zero, unless the mesh
    /// is far from zero for its size.
    #[must_use]
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// The numbers of repaired faces and vertices.
    #[must_use]
    pub fn repairs(&self) -> MeshRepairs {
        self.repairs
    }

    /// Number of edges with one face, which border holes.
    #[must_use]
    pub fn border_edges(&self) -> usize {
        self.borders
    }

    /// Number of edges with more than two faces.
    #[must_use]
    pub fn fan_edges(&self) -> usize {
        self.fans
    }

    /// Number of pieces, each connected through edges with two faces.
    #[must_use]
    pub fn pieces(&self) -> usize {
        self.pieces
    }

    /// Whether each edge has two faces.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.borders == 0 && self.fans == 0
    }

    /// Whether the mesh is an open surface, such as a leaf, a terrain or half a sphere, and no
    /// solid with holes.
    #[must_use]
    pub fn is_sheet(&self) -> bool {
        self.is_sheet
    }

    pub(super) fn marks(&self) -> Vec<[DVec3; 2]> {
        self.marks.iter().map(|segment| segment.map(|end| end + self.origin)).collect()
    }

    /// Whether a point is on the inner side of the nearest face (J. A. Bærentzen & H. Aanæs,
    /// "Signed Distance Computation Using the Angle Weighted Pseudonormal", 2005).
    pub(super) fn is_below(&self, p: DVec3) -> bool {
        let nearest = self.tree.nearest(p);
        let mut normal = DVec3::ZERO;
        self.tree.within(p, nearest.distance_sq * (1.0 + 1e-9), |found| {
            let corners = self.mesh.corners(&self.mesh.faces()[found.triangle as usize]);
            let [a, b, c] = corners;
            let at = corners.iter().position(|&corner| corner == found.point);
            let angle = at.map_or(1.0, |k| {
                let [u, v] = [1, 2].map(|step| corners[(k + step) % 3] - corners[k]);
                libm::atan2(u.cross(v).length(), u.dot(v))
            });
            normal += angle * (b - a).cross(c - a).normalize_or_zero();
        });
        normal.dot(p - nearest.point) < 0.0
    }

    /// Also keeps every edge of the mesh sharp whose two ends lie on one of these segments,
    /// whatever its angle. With [`MeshEdges::Rounded`] these are the only sharp edges. An edge that
    /// does not separate two patches, such as a single one within a smooth surface, is rounded, and
    /// counted in [`MeshKind::Parts`].
    ///
    /// [`MeshKind::Parts`]: crate::remesh::MeshKind::Parts
    /// [`MeshEdges::Rounded`]: crate::remesh::MeshEdges::Rounded
    #[must_use]
    pub fn with_edges_along(self, segments: &[[DVec3; 2]]) -> Self {
        let marks = segments.iter().map(|segment| segment.map(|end| end - self.origin)).collect();
        Self { marks, ..self }
    }

    /// Whether edges are marked as sharp.
    pub(super) fn has_marks(&self) -> bool {
        !self.marks.is_empty()
    }

    /// Whether each edge is marked as sharp; empty if none is.
    pub(super) fn marked_edges(&self) -> Vec<bool> {
        if self.marks.is_empty() {
            return Vec::new();
        }
        // A program may give places in single precision.
        let width = 10.0 * SAME * self.mesh.bounds().diagonal();
        let tree = Tree::new(&self.marks.iter().map(|&[a, b]| [a, b, b]).collect::<Vec<_>>());
        let near = |vertex: u32| {
            let mut found = Vec::new();
            tree.within(self.mesh.vertices()[vertex as usize], width * width, |own| found.push(own.triangle));
            found
        };
        let is_marked = |edge: usize| {
            let [a, b] = self.edges.ends(edge).map(near);
            a.iter().any(|own| b.contains(own))
        };
        (0..self.edges.len()).map(is_marked).collect()
    }

    /// Whether the mesh has colours.
    #[must_use]
    pub fn has_colours(&self) -> bool {
        self.colours.is_some()
    }

    /// The colour of the mesh, before its repair, at its point nearest to `p`: red, green and blue
    /// in sRGB, from 0 to 1; none if it [has no colours](TriangleMesh::colours).
    #[must_use]
    pub fn colour_at(&self, p: DVec3) -> Option<[f32; 3]> {
        Some(self.colours.as_ref()?.at(p - self.origin))
    }

    /// The [colour](Self::colour_at) as a value at the particles for each of its parts; none if the
    /// mesh has no colours.
    pub(super) fn colour_values(&self) -> Vec<(&'static str, Value)> {
        let Some(colours) = &self.colours else { return Vec::new() };
        let value = |(channel, &name): (usize, &&'static str)| {
            let (colours, origin) = (Arc::clone(colours), self.origin);
            let part = move |p: DVec3| f64::from(colours.at(p - origin)[channel]);
            (name, Value::of_field(Arc::new(part.into_field())))
        };
        CHANNELS.iter().enumerate().map(value).collect()
    }

    /// Whether both are copies of the same mesh, with the same marks.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.mesh, &other.mesh) && self.marks == other.marks
    }
}

/// Largest area of the openings of a solid, as a share of the mesh's area. Half a sphere, whose
/// opening has half its area, must not count as a solid. The area vectors of a closed mesh add up
/// to zero; otherwise their sum is the area vector of the openings.
const OPEN: f64 = 0.4;

/// Whether a mesh with this number of border edges is an open surface, however it is bent.
fn is_sheet(mesh: &TriangleMesh, borders: usize) -> Result<bool, MeshError> {
    /// Least volume, as a share of the volume of a ball with the same area.
    const THIN: f64 = 1e-6;
    let area = mesh.area();
    let open: DVec3 = mesh.area_vectors().sum();
    let ball = area * libm::sqrt(area) / libm::sqrt(36.0 * core::f64::consts::PI);
    let is_thin = mesh.volume().abs() < THIN * ball;
    if is_thin && borders == 0 {
        return Err(MeshError::NoVolume);
    }
    Ok(borders > 0 && (is_thin || open.length() > OPEN * area))
}

/// Merges vertices closer than `width`. Returns the vertices in use, how many were merged, and the
/// faces.
fn merged(mesh: &TriangleMesh, width: f64) -> (Vec<DVec3>, (usize, Vec<[u32; 3]>)) {
    let (mut table, mut kept) = (IndexTable::default(), Vec::<DVec3>::new());
    let cell = 4.0 * width.max(f64::MIN_POSITIVE);
    let hash_at = |p: DVec3| hash((p / cell).floor().to_array().map(|x| x as i64 as u64));
    let mut number = vec![None; mesh.vertices().len()];
    let mut used = 0;
    let faces = mesh.faces().iter().map(|face| {
        face.map(|corner| {
            *number[corner as usize].get_or_insert_with(|| {
                used += 1;
                let p = mesh.vertices()[corner as usize];
                let is_same = |k: usize| kept[k].distance_squared(p) <= width * width;
                let ways = Bounds::symmetric([width; 3]).corners();
                let found = ways.iter().find_map(|&way| table.find(hash_at(p + way), is_same));
                found.unwrap_or_else(|| {
                    let fresh = kept.len();
                    // `None` only if memory could not be allocated.
                    let index = table.find_or_add(hash_at(p), fresh, |_| false).unwrap_or(0);
                    kept.push(p);
                    index
                })
            })
        })
    });
    let faces = faces.collect();
    let merged = used - kept.len();
    (kept, (merged, faces))
}

/// The faces that have an area, without duplicates. Of two with the same corners and opposite
/// orientations both are kept if they are the [wall](walls) between two bodies.
fn kept(vertices: &[DVec3], faces: Vec<[u32; 3]>, width: f64, repairs: &mut MeshRepairs) -> Vec<[u32; 3]> {
    let (mut table, mut sorted, mut kept) = (IndexTable::default(), Vec::<[u32; 3]>::new(), Vec::new());
    // The second face of each pair, if there is one.
    let mut backs: Vec<Option<[u32; 3]>> = Vec::new();
    for face in faces {
        let [a, b, c] = face.map(|corner| vertices[corner as usize]);
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        // Written so that NaN counts as no width.
        let has_width = (b - a).cross(c - a).length() > width * longest;
        if face[0] == face[1] || face[1] == face[2] || face[2] == face[0] || !has_width {
            repairs.degenerate += 1;
            continue;
        }
        let mut key = face;
        key.sort_unstable();
        let fresh = sorted.len();
        let index = table.find_or_add(hash(key.map(u64::from)), fresh, |k| sorted[k] == key);
        match index.map(|index| index as usize).filter(|&index| index != fresh) {
            None => {
                sorted.push(key);
                kept.push(face);
                backs.push(None);
            }
            Some(index) if backs[index].is_none() && !runs_alike(&kept[index], &face) => {
                backs[index] = Some(face);
            }
            Some(_) => repairs.doubled += 1,
        }
    }
    let is_wall = walls(&kept, &backs);
    for (back, is_wall) in backs.into_iter().zip(is_wall) {
        match back {
            Some(back) if is_wall => kept.push(back),
            Some(_) => repairs.doubled += 1,
            None => {}
        }
    }
    kept
}

/// Whether two faces with the same corners have the same orientation.
fn runs_alike(face: &[u32; 3], other: &[u32; 3]) -> bool {
    (0..3).any(|side| ends_of(other, side) == ends_of(face, 0))
}

/// Which of the faces that have a back are the wall between two bodies: along its border two other
/// faces meet it at every edge. The two sides of a leaf end at a border of their own, and a second
/// side of some faces of a body ends at one face.
fn walls(faces: &[[u32; 3]], backs: &[Option<[u32; 3]>]) -> Vec<bool> {
    if backs.iter().all(Option::is_none) {
        return vec![false; faces.len()];
    }
    let edges = Edges::new(faces);
    let mut forest = Forest::new(faces.len());
    let (mut meets_others, mut is_wrong) = (vec![false; faces.len()], vec![false; faces.len()]);
    let doubled =
        |edge: usize| edges.sides(edge).iter().map(|side| side.face).filter(|&f| backs[f as usize].is_some());
    for edge in 0..edges.len() {
        let lone = edges.sides(edge).len() - doubled(edge).count();
        for face in doubled(edge) {
            meets_others[face as usize] |= lone > 0;
            is_wrong[face as usize] |= lone % 2 == 1;
        }
        let own: Vec<u32> = doubled(edge).collect();
        own.array_windows().for_each(|&[a, b]| forest.join(a, b));
    }
    let mut roots = vec![[false; 2]; faces.len()];
    for face in 0..faces.len() {
        let root = &mut roots[forest.find(face as u32) as usize];
        *root = [root[0] | meets_others[face], root[1] | is_wrong[face]];
    }
    (0..faces.len() as u32).map(|face| roots[forest.find(face) as usize] == [true, false]).collect()
}

/// Divides a face with a border side at the border vertices that lie on that side. Returns the
/// number of divided faces.
fn divide(vertices: &[DVec3], faces: &mut Vec<[u32; 3]>, edges: &Edges, width: f64) -> usize {
    let borders: Vec<usize> = (0..edges.len()).filter(|&edge| edges.sides(edge).len() == 1).collect();
    let place = |vertex: u32| vertices[vertex as usize];
    let segments: Vec<[DVec3; 3]> = borders
        .iter()
        .map(|&edge| {
            let [a, b] = edges.ends(edge).map(place);
            [a, b, b]
        })
        .collect();
    let tree = Tree::new(&segments);
    let mut corners: Vec<u32> = borders.iter().flat_map(|&edge| edges.ends(edge)).collect();
    corners.sort_unstable();
    corners.dedup();
    let mut on_edge: Vec<(usize, u32)> = Vec::new();
    for vertex in corners {
        tree.within(place(vertex), width * width, |found| {
            let edge = borders[found.triangle as usize];
            let [a, b] = edges.ends(edge);
            let is_inside = [a, b].iter().all(|&end| place(end).distance(place(vertex)) > 2.0 * width);
            if is_inside && vertex != a && vertex != b {
                on_edge.push((edge, vertex));
            }
        });
    }
    on_edge.sort_unstable();
    let mut is_done = vec![false; faces.len()];
    let mut divided = 0;
    for own in on_edge.chunk_by(|a, b| a.0 == b.0) {
        let side = edges.sides(own[0].0)[0];
        let face = side.face as usize;
        if core::mem::replace(&mut is_done[face], true) {
            continue;
        }
        let [a, b] = ends_of(&faces[face], side.side);
        let third = faces[face][(side.side as usize + 2) % 3];
        let mut row: Vec<u32> = own.iter().map(|&(_, vertex)| vertex).collect();
        row.retain(|&vertex| vertex != third);
        row.sort_by(|&u, &v| place(a).distance(place(u)).total_cmp(&place(a).distance(place(v))));
        row.push(b);
        if row.len() == 1 {
            continue;
        }
        divided += 1;
        faces[face] = [a, row[0], third];
        faces.extend(row.windows(2).map(|pair| [pair[0], pair[1], third]));
    }
    divided
}

/// Faces that are connected through edges with two faces.
struct Piece {
    faces: Vec<u32>,
    /// The faces, turned so that neighbours agree.
    corners: Vec<[u32; 3]>,
    bounds: Bounds,
    volume: f64,
    is_open: bool,
    /// The tree of its faces, made on first use.
    tree: OnceCell<Tree>,
}

/// Orients faces consistently, and pieces so that they enclose a positive volume. Returns the
/// number of pieces.
fn orient(vertices: &[DVec3], faces: &mut [[u32; 3]], edges: &Edges, turned: &mut usize) -> usize {
    let mut pieces: Vec<Piece> = Vec::new();
    let mut is_turned = vec![false; faces.len()];
    let mut is_known = vec![false; faces.len()];
    for start in 0..faces.len() {
        if core::mem::replace(&mut is_known[start], true) {
            continue;
        }
        let mut own = vec![start as u32];
        let mut next = 0;
        while let Some(&face) = own.get(next) {
            next += 1;
            for edge in edges.of_face(face) {
                let [a, b] = edges.sides(edge as usize) else { continue };
                let (here, there) = if a.face == face { (a, b) } else { (b, a) };
                if core::mem::replace(&mut is_known[there.face as usize], true) {
                    continue;
                }
                let runs_alike = ends_of(&faces[face as usize], here.side)
                    == ends_of(&faces[there.face as usize], there.side);
                is_turned[there.face as usize] = is_turned[face as usize] ^ runs_alike;
                own.push(there.face);
            }
        }
        let corners: Vec<[u32; 3]> =
            own.iter().map(|&face| turned_if(is_turned[face as usize], faces[face as usize])).collect();
        let bounds = Bounds::around(corners.as_flattened().iter().map(|&corner| vertices[corner as usize]));
        let volume = volume(vertices, corners.iter());
        let vectors = corners.iter().map(|corners| {
            let [a, b, c] = corners.map(|corner| vertices[corner as usize]);
            (b - a).cross(c - a)
        });
        let (open, area) = vectors.fold((DVec3::ZERO, 0.0), |sum, own| (sum.0 + own, sum.1 + own.length()));
        pieces.push(Piece {
            faces: own,
            corners,
            bounds,
            volume,
            is_open: open.length() > OPEN * area,
            tree: OnceCell::new(),
        });
    }
    for k in 0..pieces.len() {
        // A piece inside others is reversed with the largest of them.
        let around = (0..pieces.len()).filter(|&other| is_within(vertices, &pieces[k], &pieces[other]));
        let outermost =
            around.fold(k, |a, b| if pieces[b].volume.abs() > pieces[a].volume.abs() { b } else { a });
        let turned_ones = pieces[k].faces.iter().filter(|&&face| is_turned[face as usize]).count();
        let is_wrong = match pieces[k].is_open {
            true => 2 * turned_ones > pieces[k].faces.len(),
            false => pieces[outermost].volume < 0.0,
        };
        if is_wrong {
            for &face in &pieces[k].faces {
                is_turned[face as usize] ^= true;
            }
        }
        *turned += pieces[k].faces.iter().filter(|&&face| is_turned[face as usize]).count();
    }
    for (face, is_turned) in faces.iter_mut().zip(is_turned) {
        *face = turned_if(is_turned, *face);
    }
    pieces.len()
}

fn turned_if(is_turned: bool, [a, b, c]: [u32; 3]) -> [u32; 3] {
    if is_turned { [a, c, b] } else { [a, b, c] }
}

/// Whether a piece lies within a larger one.
fn is_within(vertices: &[DVec3], piece: &Piece, other: &Piece) -> bool {
    if piece.volume.abs() >= other.volume.abs() || !other.bounds.holds_inside(&piece.bounds) {
        return false;
    }
    let place = |&corner: &u32| vertices[corner as usize];
    let corners = || other.corners.iter().map(|face| face.map(|c| place(&c))).collect::<Vec<_>>();
    let tree = other.tree.get_or_init(|| Tree::new(&corners()));
    tree.winding(place(&piece.corners[0][0])).abs() > 0.5
}
