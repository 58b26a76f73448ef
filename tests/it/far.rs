//! Tests of boxes far from the origin, where single precision would round the places of particles.

use crate::runs::{finished, run};
use glam::{DVec3, Vec3};
use marching_particles::Bounds;
use marching_particles::Report;
use marching_particles::export::{self, Format, MeshFormat};
use marching_particles::field::Frame;
use marching_particles::field::formula::Formula;
use marching_particles::field::{Enclosure, Field};
use marching_particles::field::{Interval, Sym3};
use marching_particles::internal::session::{FieldRequest, Session};
use marching_particles::quality;
use marching_particles::sampler::{Method, Sampling, Search, Settings};

const FAR: DVec3 = DVec3::new(100.0, -200.0, 300.0);

/// A formula in X, Y and Z, written about `centre`.
fn about(centre: DVec3, formula: &str) -> String {
    formula
        .replace('X', &format!("(x - {:?})", centre.x))
        .replace('Y', &format!("(y - {:?})", centre.y))
        .replace('Z', &format!("(z - {:?})", centre.z))
}

/// A finished run of the formula in a cube around `centre`.
fn sampled(centre: DVec3, formula: &str, half: f64, settings: &Settings) -> (Session, Report) {
    let (min, max) = ((centre - half).to_array(), (centre + half).to_array());
    finished(&about(centre, formula), Bounds { min, max }, settings)
}

#[test]
#[ignore = "slow: for cargo xtask test --all"]
fn far_from_the_origin_the_figures_are_those_at_the_origin() {
    let uniform = settings!(radius_share: 0.008; ..Settings::default());
    let adaptive = settings!(sampling: Sampling::Adaptive; ..uniform);
    let refined = settings!(method: Method::Refined; ..uniform);
    for (formula, half) in [
        ("X^2 + 2Y^2 + 4Z^2 = 1", 1.25),
        ("(sqrt(X^2 + Y^2) - 0.7)^2 + Z^2 = 0.09", 1.2),
        ("sin(3X)cos(3Y) + sin(3Y)cos(3Z) + sin(3Z)cos(3X)", 1.0),
        ("(X^2 + Y^2 + Z^2 - 1) (X^2 + Y^2 + Z^2 - 0.9)", 1.25),
    ] {
        for settings in [uniform, adaptive, refined] {
            let (_, near) = sampled(DVec3::ZERO, formula, half, &settings);
            let (session, far) = sampled(FAR, formula, half, &settings);
            let name = format!("{formula}, {:?}, {:?}", settings.sampling, settings.method);
            let figures =
                |report: &Report| report.measures.quality.unwrap_or_else(|| panic!("{name}: no particles"));
            let (here, there) = (figures(&near), figures(&far));
            assert!(
                there.accuracy.error_max < 1.2 * here.accuracy.error_max,
                "{name}: residual {} at the origin, {}",
                here.accuracy.error_max,
                there.accuracy.error_max
            );
            // 0.4 %. Where a surface is refined, surgery ends one level before the last, and a
            // particle there stands for four: by the rounding of the field, the torus has two more
            // or fewer of its 583.
            assert!(
                near.count.abs_diff(far.count) * 250 <= near.count,
                "{name}: {} {}",
                near.count,
                far.count
            );
            assert_eq!(
                (here.connectivity.components, here.connectivity.euler),
                (there.connectivity.components, there.connectivity.euler),
                "{name}"
            );
            assert_eq!((near.proof.search, far.proof.search), (Search::Proven, Search::Proven), "{name}");
            assert!(
                (here.order.six_neighbours - there.order.six_neighbours).abs() < 0.01,
                "{name}: six {} {}",
                here.order.six_neighbours,
                there.order.six_neighbours
            );
            let bounds = session.run.bounds();
            let is_inside = |p: DVec3| p.cmpge(bounds.lo()).all() && p.cmple(bounds.hi()).all();
            let particles = session.run.particles();
            assert!((0..particles.len()).all(|i| is_inside(particles.place(i))), "{name}");
        }
    }
}

#[test]
fn a_field_with_an_origin_is_the_same_field_there() {
    let text = "sin(x) y^2 + exp(z/300) sqrt(x) - x y z";
    let field = Formula::as_written(text, &[]).expect("a formula");
    let mut moved = field.evaluator(Frame::around(FAR));
    let points: Vec<Vec3> =
        (0..50).map(|k| Vec3::new(0.37, -0.21, 0.11) * (k as f32 - 25.0) * 0.03).collect();
    let (mut value, mut gradient) = (vec![0.0; 50], vec![Vec3::ZERO; 50]);
    let mut hessian = vec![Sym3::default(); 50];
    moved.hessians(&points, &mut value, &mut gradient, &mut hessian);
    let (mut alone, mut again, mut slope) = (vec![0.0; 50], vec![0.0; 50], vec![Vec3::ZERO; 50]);
    moved.values(&points, &mut alone);
    moved.gradients(&points, &mut again, &mut slope);
    for (k, p) in points.iter().enumerate() {
        let jet = field.jet(FAR + p.as_dvec3());
        assert_eq!(moved.jet(p.as_dvec3()), jet);
        let near = |a: f32, b: f64| (f64::from(a) - b).abs() <= 1e-6 * b.abs().max(1.0);
        assert!([value[k], alone[k], again[k]].into_iter().all(|v| near(v, jet.value)), "{k}");
        for axis in 0..3 {
            assert!(near(gradient[k][axis], jet.gradient[axis]) && near(slope[k][axis], jet.gradient[axis]));
        }
        assert!(near(hessian[k].xy, jet.hessian.xy) && near(hessian[k].zz, jet.hessian.zz), "{k}");
    }
    let boxes: Vec<Bounds> = points.iter().map(|p| Bounds::new(p.as_dvec3(), p.as_dvec3() + 0.01)).collect();
    let mut bounds = vec![Enclosure::UNKNOWN; 50];
    let mut second = vec![Sym3::splat(Interval::EVERYTHING); 50];
    let bounded = moved.bounded().expect("a formula has bounds");
    bounded.enclose(0, &boxes, &mut bounds);
    bounded.enclose_second(0, &boxes, &mut second);
    for (k, around) in boxes.iter().enumerate() {
        for corner in [around.lo(), around.hi(), around.middle()] {
            let jet = field.jet(FAR + corner);
            assert!(bounds[k].value.holds(jet.value) && second[k].xy.holds(jet.hessian.xy), "{k}");
        }
    }
}

#[test]
fn a_place_in_a_far_box_is_told_in_the_coordinates_of_the_formula() {
    let settings = settings!(radius_share: 0.01, method: Method::Refined; ..Settings::default());
    let (_, touch) =
        sampled(FAR, "(X^2 + Y^2 + (Z - 0.9)^2 - 0.81) (X^2 + Y^2 + (Z + 0.9)^2 - 0.81)", 1.0, &settings);
    let named = "near (100, -200, 300) the gradient vanishes";
    assert!(touch.warnings.iter().any(|warning| warning.to_string().contains(named)), "{:?}", touch.warnings);
    assert!(!touch.measures.places.holes.is_empty(), "the largest hole is told");
    for hole in &touch.measures.places.holes {
        let away = Vec3::from_array(hole.position).as_dvec3() - FAR;
        assert!(away.abs().max_element() <= 1.001, "{hole:?}");
    }
    // A ball smaller than a particle, beside a large one.
    let two = "(X^2 + Y^2 + Z^2 - 0.25) ((X - 0.51)^2 + Y^2 + Z^2 - 0.000001)";
    let (_, report) = sampled(FAR, two, 1.0, &settings!(radius_share: 0.02; ..Settings::default()));
    assert!(!report.proof.sampled.without.is_empty(), "{:?}", report.proof.sampled);
    for witness in &report.proof.sampled.without {
        let away = DVec3::from_array(witness.position) - FAR - DVec3::new(0.51, 0.0, 0.0);
        assert!(away.length() < 0.0011, "{witness:?}");
    }
    assert!(report.warnings.iter().any(|w| w.to_string().contains("near (100.51")), "{:?}", report.warnings);
}

#[test]
fn files_hold_far_places_in_double_precision() {
    let settings = settings!(radius_share: 0.02; ..Settings::default());
    let (mut session, _) = sampled(FAR, "X^2 + Y^2 + Z^2 = 1", 1.25, &settings);
    while session.run.join(u32::MAX).is_none() {}
    let (particles, measured) = (session.run.particles(), session.run.measured());
    let file = |format: Format| {
        let mut bytes = Vec::new();
        export::write(&format.into(), particles, measured, &mut bytes).expect("memory does not run out");
        bytes
    };
    let on_sphere = |p: DVec3, what: &str| {
        let off = ((p - FAR).length() - 1.0).abs();
        assert!(off < 1e-5, "{what}: {p} is {off} off the sphere");
    };
    let numbers = |line: &str, skip: usize, split: char| -> DVec3 {
        let mut values = line.split(split).skip(skip).map(|v| v.parse::<f64>().expect("a number"));
        DVec3::from_array([(); 3].map(|()| values.next().expect("three numbers")))
    };
    let csv = String::from_utf8(file(Format::Csv)).expect("text");
    csv.lines().skip(1).for_each(|line| on_sphere(numbers(line, 0, ','), "CSV"));
    let xyz = String::from_utf8(file(Format::Xyz)).expect("text");
    xyz.lines().for_each(|line| on_sphere(numbers(line, 0, ' '), "XYZ"));
    let npy = file(Format::Npy);
    assert!(npy.windows(5).any(|bytes| bytes == b"'<f8'"));
    let rows = &npy[npy.len() - 48 * particles.len()..];
    let double = |bytes: &[u8]| f64::from_le_bytes(bytes.try_into().expect("eight bytes"));
    rows.chunks_exact(48).for_each(|row| {
        on_sphere(DVec3::from_array([0, 8, 16].map(|at| double(&row[at..at + 8]))), "NPY");
    });
    let ply = file(Format::Ply);
    let text = String::from_utf8_lossy(&ply);
    assert!(text.contains("property double x\nproperty double y\nproperty double z\nproperty float nx"));
    let end = ply.windows(11).position(|bytes| bytes == b"end_header\n").expect("a header") + 11;
    on_sphere(DVec3::from_array([0, 8, 16].map(|at| double(&ply[end + at..end + at + 8]))), "PLY");

    let mesh = |format: MeshFormat| {
        let mut bytes = Vec::new();
        let unmeasured = quality::Measurements::default();
        let joined = session.run.mesh().expect("a mesh");
        export::write_mesh(&format.into(), particles, &unmeasured, joined, &mut bytes)
            .expect("memory does not run out");
        bytes
    };
    let obj = String::from_utf8(mesh(MeshFormat::Obj)).expect("text");
    obj.lines()
        .filter(|line| line.starts_with("v "))
        .for_each(|line| on_sphere(numbers(line, 1, ' '), "OBJ"));
    // glTF's y axis points up: (x, y, z) is (x, z, −y) there.
    let glb = mesh(MeshFormat::Glb);
    let origin = particles.origin;
    let translation = format!(r#""translation":[{},{},{}]"#, origin.x, origin.z, -origin.y);
    assert!(String::from_utf8_lossy(&glb).contains(&translation), "{translation}");
}

#[test]
fn only_a_box_far_for_its_size_has_an_origin_of_its_own() {
    let around = |centre: DVec3, half: f64| Bounds {
        min: (centre - half).to_array(),
        max: (centre + half).to_array(),
    };
    for (centre, half) in [(DVec3::ZERO, 1.0), (DVec3::splat(3.0), 1.0), (FAR, 60.0)] {
        assert_eq!(around(centre, half).local_origin(), DVec3::ZERO, "{centre}, {half}");
    }
    for (centre, half) in [(FAR, 1.0), (FAR, 20.0), (DVec3::X * 1e-3, 1e-6), (DVec3::NEG_Z * 1e9, 1e7)] {
        let bounds = around(centre, half);
        let origin = bounds.local_origin();
        assert!((origin - centre).abs().max_element() <= 0.5 * half, "{centre}, {half}: {origin}");
        let local = bounds.relative_to(origin);
        assert!(local.is_valid() && local.local_origin() == DVec3::ZERO, "{local:?}");
        assert!(
            (origin.as_vec3().as_dvec3() - origin).abs().max_element() <= 1e-6 * half,
            "{origin} is round"
        );
    }
}

#[test]
fn a_session_leaves_a_far_box_as_it_came() {
    let settings = settings!(radius_share: 0.02; ..Settings::default());
    let mut fresh = Session::new();
    run(&mut fresh, &settings);
    let (mut session, _) = sampled(FAR, "X^2 + Y^2 + Z^2 = 1", 1.25, &settings);
    let far = session.run.particles().digest();
    // A fitted box is far, too.
    let request =
        FieldRequest { formula: Some(about(FAR, "X^2 + Y^2 + Z^2 = 2")), ..FieldRequest::default() };
    let mut fitted = Session::new();
    fitted.set_field(&request).expect("a formula");
    let report = run(&mut fitted, &settings);
    assert!(
        fitted.run.particles().origin != DVec3::ZERO
            && report.measures.quality.expect("figures").accuracy.error_max < 1e-4
    );
    // Back at the origin, and far away again.
    let surface = FieldRequest { surface: Some("ellipsoid".into()), ..FieldRequest::default() };
    session.set_field(&surface).expect("a surface of the gallery");
    run(&mut session, &settings);
    assert_eq!(session.run.particles().digest(), fresh.run.particles().digest());
    let (again, _) = sampled(FAR, "X^2 + Y^2 + Z^2 = 1", 1.25, &settings);
    assert_eq!(again.run.particles().digest(), far);
}
