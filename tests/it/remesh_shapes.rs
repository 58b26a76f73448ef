//! Triangle meshes to sample anew, and what is expected of the new ones.

use core::f64::consts::PI;
use glam::{DVec3, dvec3};
use marching_particles::remesh::{MeshField, MeshOptions};
use marching_particles::{Sample, Settings, TriangleMesh, sample};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

pub(crate) type Shape = (Vec<DVec3>, Vec<[u32; 3]>);

pub(crate) fn solid_of((vertices, faces): &Shape) -> marching_particles::remesh::MeshSolid {
    let mesh = TriangleMesh::new(vertices.clone(), faces.clone()).expect("a mesh");
    mesh.solid().expect("a solid")
}

pub(crate) fn field_of(shape: &Shape) -> MeshField {
    solid_of(shape).field(&MeshOptions::default()).expect("a field")
}

pub(crate) fn remeshed(shape: &Shape, count: u32, what: &str) -> (MeshField, Sample) {
    let field = field_of(shape);
    let made = sample(field.clone(), &Settings::with_count(count).refined());
    let made = made.unwrap_or_else(|error| panic!("{what}: {error}"));
    (field, made)
}

/// A prism over a polygon whose triangles are given, from z = 0 to `height`.
pub(crate) fn prism(outline: &[[f64; 2]], triangles: &[[u32; 3]], height: f64) -> Shape {
    let n = outline.len() as u32;
    let vertices = [0.0, height].into_iter().flat_map(|z| outline.iter().map(move |&[x, y]| dvec3(x, y, z)));
    let mut faces: Vec<[u32; 3]> =
        (0..n).flat_map(|i| [[i, (i + 1) % n, n + (i + 1) % n], [i, n + (i + 1) % n, n + i]]).collect();
    faces.extend(triangles.iter().flat_map(|&[a, b, c]| [[a, c, b], [n + a, n + b, n + c]]));
    (vertices.collect(), faces)
}

pub(crate) fn fan(n: u32) -> Vec<[u32; 3]> {
    (1..n - 1).map(|i| [0, i, i + 1]).collect()
}

pub(crate) fn cuboid([x, y, z]: [f64; 3]) -> Shape {
    prism(&[[0.0, 0.0], [x, 0.0], [x, y], [0.0, y]], &fan(4), z)
}

pub(crate) fn regular(n: u32) -> Shape {
    let outline: Vec<[f64; 2]> = (0..n)
        .map(|k| 2.0 * PI * f64::from(k) / f64::from(n))
        .map(|t| [libm::cos(t), libm::sin(t)])
        .collect();
    prism(&outline, &fan(n), 2.0)
}

pub(crate) fn bracket() -> Shape {
    let outline = [[0.0, 0.0], [2.0, 0.0], [2.0, 0.5], [0.5, 0.5], [0.5, 2.0], [0.0, 2.0]];
    prism(&outline, &[[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]], 1.0)
}

/// A block from (−1, −1, 0) to (1, 1, 1) with a hole of radius 0.4 of `n` sides, a multiple of 8.
pub(crate) fn drilled(n: u32) -> Shape {
    let ring = |radius: &dyn Fn(f64, f64) -> f64, z: f64| {
        let angles = (0..n).map(|k| 2.0 * PI * f64::from(k) / f64::from(n));
        let place = |t: f64| {
            radius(libm::cos(t), libm::sin(t)) * dvec3(libm::cos(t), libm::sin(t), 0.0) + z * DVec3::Z
        };
        angles.map(place).collect::<Vec<_>>()
    };
    let (inner, outer) = (|_: f64, _: f64| 0.4, |c: f64, s: f64| 1.0 / c.abs().max(s.abs()));
    let rings = [ring(&inner, 0.0), ring(&outer, 0.0), ring(&inner, 1.0), ring(&outer, 1.0)];
    let mut faces = Vec::new();
    for i in 0..n {
        let [a, b, c, d] = [0, 1, 2, 3].map(|ring| ring * n + i);
        let [e, f, g, h] = [0, 1, 2, 3].map(|ring| ring * n + (i + 1) % n);
        faces.extend([
            [c, d, h],
            [c, h, g],
            [a, f, b],
            [a, e, f],
            [b, f, h],
            [b, h, d],
            [a, g, e],
            [a, c, g],
        ]);
    }
    (rings.concat(), faces)
}

pub(crate) fn joined(mut a: Shape, (vertices, faces): &Shape) -> Shape {
    let first = a.0.len() as u32;
    a.0.extend(vertices);
    a.1.extend(faces.iter().map(|face| face.map(|corner| corner + first)));
    a
}

pub(crate) fn moved((vertices, faces): &Shape, map: impl Fn(DVec3) -> DVec3) -> Shape {
    (vertices.iter().map(|&p| map(p)).collect(), faces.clone())
}

pub(crate) fn turned((vertices, faces): &Shape) -> Shape {
    (vertices.clone(), faces.iter().map(|&[a, b, c]| [a, c, b]).collect())
}

/// A torus of radii 1 and 0.4, with noise along its normals.
pub(crate) fn torus(nu: u32, nv: u32, noise: f64) -> Shape {
    let mut random = Pcg32::seed_from_u64(5);
    let mut vertices = Vec::new();
    for i in 0..nu {
        for j in 0..nv {
            let [u, v] = [(i, nu), (j, nv)].map(|(k, n)| 2.0 * PI * f64::from(k) / f64::from(n));
            let sum: f64 = (0..12).map(|_| f64::from(random.next_u32()) / f64::from(u32::MAX)).sum();
            let r = 0.4 + noise * (sum - 6.0);
            let out = dvec3(libm::cos(u), libm::sin(u), 0.0);
            vertices.push(out * (1.0 + r * libm::cos(v)) + r * libm::sin(v) * DVec3::Z);
        }
    }
    let at = |i: u32, j: u32| i % nu * nv + j % nv;
    let quads = (0..nu).flat_map(|i| (0..nv).map(move |j| (i, j)));
    let faces = quads.flat_map(|(i, j)| {
        [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
    });
    (vertices, faces.collect())
}

pub(crate) fn off_torus(p: DVec3) -> f64 {
    (libm::hypot(p.truncate().length() - 1.0, p.z) - 0.4).abs()
}

/// The distance from a triangle, by its plane and its three sides.
pub(crate) fn distance(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let sides = [(a, b), (b, c), (c, a)];
    if sides.iter().all(|&(from, to)| (to - from).cross(p - from).dot(normal) >= 0.0) {
        return (p - a).dot(normal).abs();
    }
    let to_side = |&(from, to): &(DVec3, DVec3)| {
        let t = ((p - from).dot(to - from) / (to - from).length_squared()).clamp(0.0, 1.0);
        p.distance(from.lerp(to, t))
    };
    sides.iter().map(to_side).fold(f64::INFINITY, f64::min)
}

pub(crate) fn off_shape(p: DVec3, (vertices, faces): &Shape) -> f64 {
    let of_face = |face: &[u32; 3]| distance(p, face.map(|corner| vertices[corner as usize]));
    faces.iter().map(of_face).fold(f64::INFINITY, f64::min)
}

/// Checks that the mesh of a sample is closed with this Euler number, number of creases and volume.
pub(crate) fn check(made: &Sample, (euler, creases, volume): (i64, usize, f64), within: f64, what: &str) {
    let topology = &made.mesh().topology;
    assert!(topology.is_closed(), "{what}: {:?}", made.report().warnings);
    assert_eq!(topology.euler(), euler, "{what}");
    if creases > 0 {
        assert_eq!(made.report().proof.creases, Some(creases), "{what}");
    }
    let found = made.volume().unwrap_or_default();
    assert!((found / volume - 1.0).abs() < within, "{what}: {found} of {volume}");
}
