//! Origin of the points of the built-in models, with tests that the shipped files hold them.
//!
//! Two models are made here from formulas. The bunny's points are vertices of the closed mesh in
//! the npm package `bunny` 1.0.1, which is not part of this project. These commands make all files
//! again:
//!
//! ```sh
//! npm pack bunny@1.0.1 && tar xzf bunny-1.0.1.tgz
//! UPDATE_MODELS=1 BUNNY=package/index.js cargo test --test it models:: -- --include-ignored
//! ```

use crate::golden::checkout;
use glam::{DVec2, DVec3, Vec3};
use marching_particles::field::Field;
use marching_particles::field::Frame;
use marching_particles::field::formula::Formula;
use marching_particles::field::model::MODELS;
use marching_particles::pointcloud::Cloud;
use marching_particles::pointcloud::models;
use std::collections::{BTreeMap, BTreeSet};

/// Number of points per model.
const COUNT: usize = 200;

/// Encodes a data file, as `models::cloud` decodes it up to rounding.
fn encode(cloud: &Cloud) -> Vec<u8> {
    let lo = cloud.position.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let hi = cloud.position.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let side = f64::from((hi - lo).max_element() as f32);
    let mut bytes: Vec<u8> =
        [lo.x, lo.y, lo.z, side].iter().flat_map(|&x| (x as f32).to_le_bytes()).collect();
    let lo = lo.as_vec3().as_dvec3();
    for (&p, &n) in cloud.position.iter().zip(&cloud.normal) {
        let (p, n) = ((p - lo) / side, 0.5 * octahedral_encode(n) + 0.5);
        let numbers = [p.x, p.y, p.z, n.x, n.y].map(|x| (x * f64::from(u16::MAX)).round() as u16);
        bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
    }
    bytes
}

/// Octahedral encoding of a direction, on the square from −1 to 1.
fn octahedral_encode(n: DVec3) -> DVec2 {
    let flat = n.truncate() / (n.x.abs() + n.y.abs() + n.z.abs());
    if n.z >= 0.0 {
        return flat;
    }
    (1.0 - DVec2::new(flat.y, flat.x).abs()) * DVec2::new(1.0_f64.copysign(flat.x), 1.0_f64.copysign(flat.y))
}

fn check(id: &str, made: &Cloud) {
    let bytes = encode(&centred(made));
    let path = checkout().join(format!("src/pointcloud/data/{id}.bin"));
    if std::env::var_os("UPDATE_MODELS").is_some_and(|value| value == "1") {
        std::fs::write(&path, &bytes).expect("the data file can be written");
    }
    let shipped = std::fs::read(&path).expect("the data file can be read");
    assert!(shipped == bytes, "{} does not hold the points that are made here", path.display());
}

/// Cloud moved and scaled so that its box is centred at the origin and has the longest side 2.
fn centred(cloud: &Cloud) -> Cloud {
    let lo = cloud.position.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let hi = cloud.position.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let (middle, scale) = ((lo + hi) * 0.5, 2.0 / (hi - lo).max_element());
    Cloud { position: cloud.position.iter().map(|&p| (p - middle) * scale).collect(), ..cloud.clone() }
}

/// `COUNT` points of the cloud by farthest-point sampling.
fn spread(cloud: &Cloud) -> Cloud {
    let mut distance = vec![f64::INFINITY; cloud.len()];
    let (mut chosen, mut next) = (Cloud::default(), 0);
    for _ in 0..COUNT {
        chosen.position.push(cloud.position[next]);
        chosen.normal.push(cloud.normal[next]);
        for (d, p) in distance.iter_mut().zip(&cloud.position) {
            *d = d.min(p.distance_squared(cloud.position[next]));
        }
        next = (0..cloud.len()).fold(0, |a, b| if distance[b] > distance[a] { b } else { a });
    }
    chosen
}

#[test]
fn every_model_has_two_hundred_points_of_its_own() {
    for model in MODELS {
        let cloud = models::cloud(model.id).expect("a model has points");
        assert_eq!((cloud.len(), cloud.normal.len()), (COUNT, COUNT), "{}", model.id);
        assert_eq!(model.points as usize, COUNT);
        let places: BTreeSet<_> = cloud.position.iter().map(|p| p.to_array().map(f64::to_bits)).collect();
        assert_eq!(places.len(), COUNT, "{}: a point is there twice", model.id);
        assert!(cloud.normal.iter().all(|n| (n.length() - 1.0).abs() < 1e-12), "{}", model.id);
        // Encoding a decoded cloud gives the same bytes.
        let again = encode(&cloud);
        let path = checkout().join(format!("src/pointcloud/data/{}.bin", model.id));
        assert!(std::fs::read(path).expect("the data file can be read") == again, "{}", model.id);
    }
    assert_eq!(models::cloud("ellipsoid"), None);
}

/// Function of an ellipsoid with the given centre and semi-axes, rotated about y (top forward) and
/// then about z (front to the left) by angles in degrees. It approximates the distance; the rounder
/// the ellipsoid, the better.
fn ellipsoid(centre: [f64; 3], axes: [f64; 3], (pitch, yaw): (f64, f64)) -> String {
    let (sp, cp) = libm::sincos(pitch.to_radians());
    let (sy, cy) = libm::sincos(yaw.to_radians());
    let turned = [[cp * cy, cp * sy, -sp], [-sy, cy, 0.0], [sp * cy, sp * sy, cp]];
    let [x, y, z] = centre;
    let along = |k: usize| {
        let [a, b, c] = turned[k];
        format!("(({a:.5}(x - ({x})) + ({b:.5})(y - ({y})) + ({c:.5})(z - ({z})))/{})^2", axes[k])
    };
    let least = axes[0].min(axes[1]).min(axes[2]);
    format!("(sqrt({} + {} + {}) - 1)*{least}", along(0), along(1), along(2))
}

/// Smooth union of parts, each with the width of its blend with the parts before it.
fn union(parts: &[(f64, String)]) -> String {
    let first = parts[0].1.clone();
    parts[1..].iter().fold(first, |all, (width, part)| format!("smin({all}, {part}, {width})"))
}

/// Points of the formula's surface on lattice lines parallel to the axes, in the box from (−1.3,
/// −1.3, −0.3) to (1.3, 1.3, 2.7).
fn points_of(formula: &str) -> Cloud {
    const STEP: f64 = 0.04;
    const CELLS: [usize; 3] = [65, 65, 75];
    let corner = DVec3::new(-1.3, -1.3, -0.3);
    let node = |i: usize, j: usize, k: usize| corner + DVec3::new(i as f64, j as f64, k as f64) * STEP;
    let field = Formula::as_written(formula, &[]).expect("a formula");
    let mut cloud = Cloud::default();
    let mut value = vec![0.0; CELLS[0].max(CELLS[2])];
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for a in 0..CELLS[u] {
            for b in 0..CELLS[v] {
                let at = |c: usize| {
                    let mut index = [0; 3];
                    (index[axis], index[u], index[v]) = (c, a, b);
                    node(index[0], index[1], index[2])
                };
                let line: Vec<Vec3> = (0..CELLS[axis]).map(|c| at(c).as_vec3()).collect();
                field.evaluator(Frame::default()).values(&line, &mut value);
                for c in 1..line.len() {
                    if (value[c - 1] < 0.0) != (value[c] < 0.0) {
                        let t = f64::from(value[c - 1]) / f64::from(value[c - 1] - value[c]);
                        let mut p = at(c - 1).lerp(at(c), t);
                        for _ in 0..8 {
                            let jet = field.jet(p);
                            p -= jet.gradient * (jet.value / jet.gradient.length_squared());
                        }
                        cloud.position.push(p);
                        cloud.normal.push(field.jet(p).gradient.normalize_or_zero());
                    }
                }
            }
        }
    }
    assert!(cloud.len() > 5000, "{} points are too few to choose from", cloud.len());
    cloud
}

/// Rotation by no angle.
const UPRIGHT: (f64, f64) = (0.0, 0.0);

#[test]
fn the_rabbit_is_made_of_twelve_ellipsoids() {
    let pair = |width, [x, y, z]: [f64; 3], axes, (pitch, yaw): (f64, f64)| {
        [1.0, -1.0].map(|side| (width, ellipsoid([x, side * y, z], axes, (pitch, side * yaw))))
    };
    let body = (0.0, ellipsoid([-0.05, 0.0, 0.62], [0.48, 0.46, 0.60], (14.0, 0.0)));
    let head = (0.22, ellipsoid([0.22, 0.0, 1.36], [0.38, 0.34, 0.34], UPRIGHT));
    let muzzle = (0.2, ellipsoid([0.54, 0.0, 1.25], [0.17, 0.19, 0.15], UPRIGHT));
    let ears = pair(0.14, [0.08, 0.22, 1.98], [0.11, 0.16, 0.50], (-10.0, -20.0));
    let thighs = pair(0.16, [0.0, 0.42, 0.34], [0.44, 0.20, 0.36], UPRIGHT);
    let feet = pair(0.10, [0.36, 0.46, 0.10], [0.36, 0.14, 0.13], UPRIGHT);
    let forelegs = pair(0.16, [0.38, 0.15, 0.44], [0.17, 0.15, 0.46], (-10.0, 0.0));
    let tail = (0.1, ellipsoid([-0.62, 0.0, 0.34], [0.21; 3], UPRIGHT));
    let mut parts = vec![body, head, muzzle];
    parts.extend(ears.into_iter().chain(thighs).chain(feet).chain(forelegs));
    parts.push(tail);
    assert_eq!(parts.len(), 12);
    check("rabbit", &spread(&points_of(&union(&parts))));
}

#[test]
fn the_figure_with_sack_and_hat_is_made_of_fifteen_ellipsoids() {
    let part = |width, centre, axes, turn| (width, ellipsoid(centre, axes, turn));
    let parts = [
        part(0.0, [0.0, 0.0, 0.74], [0.46, 0.50, 0.54], UPRIGHT),
        // Head, beard and nose.
        part(0.12, [0.05, 0.0, 1.44], [0.33; 3], UPRIGHT),
        part(0.12, [0.25, 0.0, 1.20], [0.20, 0.26, 0.26], UPRIGHT),
        part(0.06, [0.42, 0.0, 1.46], [0.11; 3], UPRIGHT),
        // The hat: brim, cone, bobble.
        part(0.06, [0.0, 0.0, 1.68], [0.40, 0.40, 0.12], UPRIGHT),
        part(0.10, [-0.06, 0.0, 1.90], [0.27, 0.27, 0.36], (-16.0, 0.0)),
        part(0.08, [-0.24, 0.0, 2.30], [0.16; 3], UPRIGHT),
        // Legs and boots.
        part(0.12, [0.04, 0.25, 0.20], [0.20, 0.19, 0.24], UPRIGHT),
        part(0.12, [0.04, -0.25, 0.20], [0.20, 0.19, 0.24], UPRIGHT),
        part(0.10, [0.18, 0.25, 0.09], [0.28, 0.18, 0.14], UPRIGHT),
        part(0.10, [0.18, -0.25, 0.09], [0.28, 0.18, 0.14], UPRIGHT),
        // Arms; the right one reaches for the sack.
        part(0.16, [0.16, 0.52, 0.86], [0.15, 0.16, 0.36], (-40.0, 25.0)),
        part(0.16, [0.06, -0.55, 1.04], [0.15, 0.16, 0.34], (-20.0, 35.0)),
        // The sack and its neck.
        part(0.08, [-0.52, -0.36, 0.94], [0.44, 0.42, 0.48], UPRIGHT),
        part(0.12, [-0.34, -0.50, 1.38], [0.15, 0.15, 0.16], UPRIGHT),
    ];
    assert_eq!(parts.len(), 15);
    check("sack-and-hat", &spread(&points_of(&union(&parts))));
}

/// A triangle mesh.
struct Mesh {
    vertices: Cloud,
    faces: Vec<[usize; 3]>,
}

/// Mesh of the bunny from the only file of the package, rotated so that z is up and the bunny faces
/// along x.
fn bunny(text: &str) -> Mesh {
    let rows = |name: &str| -> Vec<[f64; 3]> {
        let list = text.split_once(&format!("exports.{name}=[[")).expect("the list is there").1;
        let list = list.split_once("]]").expect("the list ends").0;
        list.split("],[")
            .map(|row| {
                let numbers: Vec<f64> =
                    row.split(',').map(|number| number.trim().parse().expect("a number")).collect();
                numbers.try_into().expect("three numbers")
            })
            .collect()
    };
    let position: Vec<DVec3> = rows("positions").into_iter().map(|[x, y, z]| DVec3::new(-x, z, y)).collect();
    let faces: Vec<[usize; 3]> = rows("cells").into_iter().map(|row| row.map(|x| x as usize)).collect();
    assert_eq!((position.len(), faces.len()), (1839, 3674));
    let mut normal = vec![DVec3::ZERO; position.len()];
    for face in &faces {
        let [a, b, c] = face.map(|i| position[i]);
        for &i in face {
            // The length is twice the area of the triangle.
            normal[i] += (b - a).cross(c - a);
        }
    }
    let normal = normal.into_iter().map(DVec3::normalize_or_zero).collect();
    Mesh { vertices: Cloud { position, normal, ..Cloud::default() }, faces }
}

/// Vertices of the ears without their outer sides. The ears are the two largest components of the
/// mesh above `HEIGHT`. A vertex belongs if its normal does not point away from the nearest vertex
/// of the other ear. (If only the vertices that face the other ear were removed, the gap below the
/// handle would be so narrow that coarse particles bridge it.)
fn between_the_ears(mesh: &Mesh) -> Vec<bool> {
    const HEIGHT: f64 = 8.0;
    /// Cosine of the angle between the normal and the direction to the other ear.
    const AWAY: f64 = -0.6;
    let (position, normal) = (&mesh.vertices.position, &mesh.vertices.normal);
    let mut component: Vec<usize> = (0..position.len()).collect();
    // Labels spread until each component has a single one.
    loop {
        let mut changed = false;
        for face in &mesh.faces {
            for (i, j) in [(0, 1), (1, 2), (2, 0)].map(|(i, j)| (face[i], face[j])) {
                if position[i].z > HEIGHT && position[j].z > HEIGHT && component[i] != component[j] {
                    let least = component[i].min(component[j]);
                    (component[i], component[j], changed) = (least, least, true);
                }
            }
        }
        if !changed {
            break;
        }
    }
    let mut components: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for i in (0..position.len()).filter(|&i| position[i].z > HEIGHT) {
        components.entry(component[i]).or_default().push(i);
    }
    let mut components: Vec<Vec<usize>> = components.into_values().collect();
    components.sort_by_key(|component| std::cmp::Reverse(component.len()));
    let mut between = vec![false; position.len()];
    for (ear, other) in [(&components[0], &components[1]), (&components[1], &components[0])] {
        for &i in ear {
            let nearest = other
                .iter()
                .map(|&j| position[j] - position[i])
                .min_by(|a, b| a.length_squared().total_cmp(&b.length_squared()))
                .expect("an ear has vertices");
            between[i] = normal[i].dot(nearest) > AWAY * nearest.length();
        }
    }
    between
}

#[test]
#[ignore = "needs the npm package `bunny`: see above"]
fn the_bunnies_are_vertices_of_the_packages_mesh() {
    let path = std::env::var_os("BUNNY").expect("BUNNY names the package's index.js");
    let mesh = bunny(&std::fs::read_to_string(path).expect("the package's file can be read"));
    check("bunny", &spread(&mesh.vertices));
    let between = between_the_ears(&mesh);
    let kept =
        |list: &[DVec3]| list.iter().zip(&between).filter(|(_, out)| !**out).map(|(x, _)| *x).collect();
    let rest = Cloud {
        position: kept(&mesh.vertices.position),
        normal: kept(&mesh.vertices.normal),
        ..Cloud::default()
    };
    assert!(
        rest.len() < mesh.vertices.len() - 20,
        "{} points were removed",
        mesh.vertices.len() - rest.len()
    );
    check("bunny-joined", &spread(&rest));
}
