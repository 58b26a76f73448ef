//! Values at the particles: curvatures of surfaces whose curvatures are known, areas that add up,
//! and what files hold.

use marching_particles::field::BatchField;
use marching_particles::glam::DVec3;
use marching_particles::run::{Value, ValueError};
use marching_particles::{Field, Format, Formula, MeshFormat, Sample, Settings, sample};

const TORUS: &str = "(hypot(x, y) - 1)^2 + z^2 = 0.16";

fn torus() -> (Formula, Sample) {
    let field = Formula::parse(TORUS).expect("a formula");
    let sample = sample(&field, &Settings::with_count(2_000)).expect("a sample");
    (field, sample)
}

fn with(values: &[(&str, &str)]) -> Sample {
    let (field, mut sample) = torus();
    for (name, text) in values {
        let value = Value::parse(text).unwrap_or_else(|error| panic!("{text}: {error}"));
        sample.add_value(&field, name, &value).unwrap_or_else(|error| panic!("{name}: {error}"));
    }
    sample
}

/// The place of each particle, and its value.
fn at_places(sample: &Sample, name: &str) -> Vec<(DVec3, f64)> {
    let column = sample.values().iter().find(|column| column.name == name).expect("a column");
    let places = (0..sample.particles().len()).map(|row| sample.particles().place(row));
    places.zip(column.values.iter().map(|&value| value.into())).collect()
}

#[test]
fn curvatures_of_a_torus_are_those_of_the_textbook() {
    let sample = with(&[("H", "(k_1 + k_2)/2"), ("K", "k_1 k_2"), ("around", "d_x n_y - d_y n_x")]);
    for (p, mean) in at_places(&sample, "H") {
        let axis = libm::hypot(p.x, p.y);
        // κ is 1/r around the tube and cos θ/(R + r cos θ) around the axis.
        let other = (axis - 1.0) / 0.4 / axis;
        assert!((mean - 0.5 * (2.5 + other)).abs() < 2e-3, "H = {mean} at {p}");
    }
    for (p, product) in at_places(&sample, "K") {
        let axis = libm::hypot(p.x, p.y);
        assert!((product - 2.5 * (axis - 1.0) / 0.4 / axis).abs() < 5e-3, "K = {product} at {p}");
    }
    // The larger curvature is that around the tube, in planes through the axis: d, n and z are in
    // one.
    for (p, off) in at_places(&sample, "around") {
        assert!(off.abs() < 1e-3, "{off} at {p}");
    }
}

#[test]
fn areas_add_up_and_columns_of_the_particles_have_names() {
    let sample = with(&[("share", "area"), ("r", "2 radius"), ("up", "n_z"), ("generation", "level")]);
    let area: f64 = at_places(&sample, "share").iter().map(|(_, share)| share).sum();
    let exact = 4.0 * core::f64::consts::PI.powi(2) * 0.4;
    assert!((area / exact - 1.0).abs() < 0.01, "{area} of {exact}");
    let particles = sample.particles();
    for (row, (_, r)) in at_places(&sample, "r").into_iter().enumerate() {
        assert_eq!(r, f64::from(2.0 * particles.radius[row]));
    }
    for (row, (_, up)) in at_places(&sample, "up").into_iter().enumerate() {
        assert_eq!(up as f32, particles.normal[row].z);
    }
    for (row, (_, level)) in at_places(&sample, "generation").into_iter().enumerate() {
        assert_eq!(level as u32, particles.level[row]);
    }
}

#[test]
fn distances_to_edges_are_those_of_the_solid() {
    let cube = Formula::parse("max(abs(x), abs(y), abs(z)) = 1").expect("a formula");
    let mut solid = sample(&cube, &Settings::with_count(3_000)).expect("a cube");
    solid.add_value(&cube, "d", &Value::parse("edge").expect("a formula")).expect("values");
    for (p, distance) in at_places(&solid, "d") {
        // On a face the edges are where the second of the coordinates reaches 1.
        let mut own = p.abs().to_array();
        own.sort_by(f64::total_cmp);
        assert!((distance - (1.0 - own[1])).abs() < 1e-5, "{distance} at {p}");
    }
    let (field, mut torus) = torus();
    torus.add_value(&field, "d", &Value::parse("edge").expect("a formula")).expect("values");
    assert!(at_places(&torus, "d").iter().all(|(_, distance)| distance.is_nan()));
}

#[test]
fn a_formula_and_a_function_of_place_agree() {
    let (field, mut sample) = torus();
    let value = Value::parse("if(z > 0, x^2, -1)").expect("a formula");
    sample.add_value(&field, "a", &value).expect("values");
    let function = Value::by(|p: DVec3| if p.z > 0.0 { p.x * p.x } else { -1.0 });
    sample.add_value(&field, "b", &function).expect("values");
    assert_eq!(sample.values()[0].values, sample.values()[1].values);
}

#[test]
fn files_have_the_columns() {
    let sample = with(&[("height", "z"), ("H", "(k_1 + k_2)/2")]);
    let (count, values) = (sample.particles().len(), sample.values());
    let written = |format: Format| {
        let mut file = Vec::new();
        sample.write(format, &mut file).expect("memory");
        file
    };
    let float = |bytes: &[u8]| f32::from_le_bytes(bytes.try_into().expect("four bytes"));
    let csv = String::from_utf8(written(Format::Csv)).expect("text");
    let mut lines = csv.lines();
    assert!(lines.next().expect("names").ends_with(",singular,height,H"));
    for (row, line) in lines.enumerate() {
        let cells: Vec<f32> =
            line.split(',').rev().take(2).map(|cell| cell.parse().expect("a number")).collect();
        assert_eq!(cells, [values[1].values[row], values[0].values[row]]);
    }
    let npy = written(Format::Npy);
    assert!(String::from_utf8_lossy(&npy[..128]).contains(&format!("'shape': ({count}, 8)")));
    let last = npy.len() - 8;
    assert_eq!(
        [float(&npy[last..last + 4]), float(&npy[last + 4..])],
        [0, 1].map(|k| values[k].values[count - 1])
    );
    let ply = written(Format::Ply);
    let head = String::from_utf8_lossy(&ply[..2_000]).into_owned();
    assert!(head.contains("property float height\nproperty float H\nend_header"), "{head}");
    assert_eq!(float(&ply[ply.len() - 4..]), values[1].values[count - 1]);
    let mesh = |format: MeshFormat| {
        let mut file = Vec::new();
        sample.write_mesh(format, &mut file).expect("memory");
        file
    };
    let glb = mesh(MeshFormat::Glb);
    let json = String::from_utf8_lossy(&glb[20..3_000]).into_owned();
    assert!(json.contains("\"_HEIGHT\":4") && json.contains("\"_H\":5"), "{json}");
    let head = String::from_utf8_lossy(&mesh(MeshFormat::Ply)[..1_000]).into_owned();
    assert!(head.contains("property float nz\nproperty float height\nproperty float H\n"), "{head}");
}

#[test]
fn what_is_no_value_is_refused() {
    let (field, mut sample) = torus();
    let value = Value::parse("z").expect("a formula");
    sample.add_value(&field, "height", &value).expect("values");
    for name in ["", "1st", "a b", "é", "x", "Radius", "height", "HEIGHT"] {
        let error = sample.add_value(&field, name, &value).expect_err(name);
        assert_eq!(error, ValueError::Name { name: name.to_owned() });
    }
    for (text, says) in [
        ("k_3", "A particle has no `k_3`: a value is made of x, y, z and the quantities of a particle (n_x"),
        ("", "A value is a number such as `1`"),
        ("H = k_1", "A value has no `=`"),
    ] {
        let error = Value::parse(text).expect_err(text);
        assert!(error.to_string().starts_with(says), "{text}: {error}");
    }
    let failing = Value::by(BatchField::new(|_: &[DVec3], _: &mut [f64]| Err::<(), _>("no value")));
    let error = sample.add_value(&field, "bad", &failing).expect_err("it fails");
    assert_eq!(error.to_string(), "the function of the values has failed: no value");
    assert_eq!(sample.values().len(), 1);
}

/// A sample of a formula, with the names of the columns that it gives.
fn coloured(text: &str) -> (Sample, Vec<String>) {
    let torus = Formula::parse(text).unwrap_or_else(|error| panic!("{text}: {error}"));
    let sample = sample(&torus, &Settings::with_count(800)).expect("a sample");
    let names = sample.values().iter().map(|own| own.name.clone()).collect();
    (sample, names)
}

#[test]
fn a_formula_gives_its_surface_a_colour() {
    let (plain, none) = coloured(TORUS);
    assert!(none.is_empty());
    for text in [
        format!("colour = 2 x + 1; {TORUS}"),
        format!("{TORUS}; color = 2 x + 1"),
        format!("{TORUS}\ncolour = 2 x + 1\n"),
        format!("twice = 2 x\ncolour = twice + 1\n{TORUS}"),
        format!("twice(t) = 2 t; half = x / 2; colour = twice(2 half) + 1; {TORUS}"),
        "r = hypot(x, y); (r - 1)^2 + z^2 = 0.16; colour = 2 x (r / r) + 1".to_owned(),
    ] {
        let (coloured, names) = coloured(&text);
        assert_eq!(names, ["colour"], "{text}");
        assert_eq!(coloured.particles().digest(), plain.particles().digest(), "{text}: the same surface");
        for (p, value) in at_places(&coloured, "colour") {
            assert!((value - (2.0 * p.x + 1.0)).abs() < 1e-5, "{text}: {value} at {p}");
        }
        let unused = Formula::parse(&text).expect("it was").facts().unused;
        assert!(unused.is_empty(), "{text}: {unused:?}");
    }
}

#[test]
fn a_formula_gives_its_surface_red_green_and_blue() {
    for triple in
        ["(0.5 + x/4, 0.25, abs(n_z))", "vec3(0.5 + x/4, 0.25, abs(n_z))", "[0.5+x/4,0.25,abs(n_z)]"]
    {
        for name in ["c_rgb", "colour"] {
            let (coloured, names) = coloured(&format!("{name} = {triple}; {TORUS}"));
            assert_eq!(names, ["red", "green", "blue"], "{name} = {triple}");
            for (row, (p, red)) in at_places(&coloured, "red").into_iter().enumerate() {
                let of = |name| at_places(&coloured, name)[row].1;
                assert!((red - (0.5 + p.x / 4.0)).abs() < 1e-6);
                if row % 100 == 0 {
                    let facing = f64::from(coloured.particles().normal[row].z.abs());
                    assert!((of("green") - 0.25).abs() < 1e-7 && (of("blue") - facing).abs() < 1e-6);
                }
            }
        }
    }
}

#[test]
fn a_colour_follows_the_parameters_and_yields_to_the_program() {
    let torus = Formula::parse("colour = R + z; (hypot(x, y) - R)^2 + z^2 = 0.16").expect("a formula");
    let torus = torus.with("R", 1.5).expect("a parameter");
    let mut sample = sample(&torus, &Settings::with_count(800)).expect("a sample");
    let is_set = |(p, value): (DVec3, f64)| (value - (1.5 + p.z)).abs() < 1e-5;
    assert!(at_places(&sample, "colour").into_iter().all(is_set));
    sample.add_value(&torus, "colour", &Value::parse("7").expect("a formula")).expect("values");
    assert_eq!(sample.values().len(), 1);
    assert!(at_places(&sample, "colour").into_iter().all(|(_, value)| value == 7.0));
}

#[test]
fn what_is_no_colour_is_refused_and_a_name_in_use_is_a_definition() {
    for (text, at, says) in [
        ("colour = k_3; x^2 + y^2 = 1", "k_3", "A particle has no `k_3`: a colour is made of"),
        ("colour = area; x^2 + y^2 = 1", "area", "A particle has no `area`"),
        ("c_rgb = z; x^2 + y^2 = 1", "c_rgb = z", "A colour has three parts"),
        ("x^2 + y^2 = 1; colour = (x, y)", "colour = (x, y)", "A colour has three parts"),
        ("colour = x; color = y; x^2 + y^2 = 1", "color", "A surface has one colour"),
        ("colour = x +; x^2 + y^2 = 1", "", ""),
        ("colour = ; x^2 + y^2 = 1", "", ""),
    ] {
        let error = Formula::parse(text).expect_err(text);
        assert!(error.message.starts_with(says), "{text}: {error}");
        assert!(at.is_empty() || &text[error.span.clone()] == at, "{text}: {:?}", error.span);
    }
    let (_, names) = coloured("colour = 2 x; colour^2 + y^2 + z^2 = 1");
    assert!(names.is_empty(), "the surface uses it: {names:?}");
    assert!(Value::parse("colour = x; colour").is_ok());
    let error = Value::parse("x; colour = y").expect_err("a value has no colour");
    assert!(error.message.starts_with("A value has no colour"), "{error}");
}
