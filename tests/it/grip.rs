//! A surface whose parameters change so that it passes through points.

use marching_particles::Field;
use marching_particles::field::formula::{Formula, Parameter};
use marching_particles::field::gallery;
use marching_particles::glam::DVec3;

fn declared(name: &str, value: f64, min: f64, max: f64) -> Parameter {
    Parameter { value, min, max, ..Parameter::automatic(name) }
}

fn distance(field: &mut Formula, p: DVec3) -> f64 {
    let (value, gradient) = field.value_and_gradient(p);
    value.abs() / gradient.length()
}

#[test]
fn a_surface_of_the_gallery_passes_through_a_point_beside_it() {
    let mut pulled = 0;
    for surface in gallery::SURFACES.iter().filter(|surface| !surface.parameters.is_empty()) {
        let mut field = surface.field();
        // A point of the surface on a ray from the middle of the box, and one a little farther out.
        let size = surface.bounds.size().length();
        let way = DVec3::new(0.48, 0.6, 0.64);
        let at = |t: f64| surface.bounds.middle() + way * (t * size);
        let Some(hit) = (0..500)
            .map(|k| f64::from(k) / 1000.0)
            .find(|&t| field.value_and_gradient(at(t)).0 * field.value_and_gradient(at(t + 0.001)).0 < 0.0)
        else {
            continue;
        };
        let pin = at(hit + 0.01);
        let before = distance(&mut field, pin);
        let grip = field.pass_through(&[pin]);
        for parameter in field.parameters() {
            assert!((parameter.min..=parameter.max).contains(&parameter.value), "{}", surface.id);
        }
        let after = distance(&mut field, pin);
        if !grip.holds {
            assert!(after <= before, "{}: {before} {after}", surface.id);
            continue;
        }
        assert!(after < 1e-4 * size, "{}: {after}", surface.id);
        pulled += 1;
    }
    assert!(pulled >= 15, "{pulled}");
}

#[test]
fn of_two_parameters_the_one_that_has_to_change_less_changes_more() {
    // At x = y both move the surface alike, but the range of b is four times as wide.
    let parameters = [declared("a", 1.0, 0.5, 1.5), declared("b", 1.0, 0.0, 4.0)];
    let mut field = Formula::as_written("x^2/a + y^2/b - 1", &parameters).unwrap();
    let at = (0.5_f64).sqrt() * 1.05;
    assert!(field.pass_through(&[(at, at, 0.0).into()]).holds);
    let [a, b] = [0, 1].map(|k| field.parameters()[k].value - 1.0);
    assert!(b > 8.0 * a && a > 0.0, "{a} {b}");
}

#[test]
fn several_points_are_held_at_once() {
    let text = "x^2/a^2 + y^2/b^2 + z^2/c^2 - 1";
    let mut field =
        Formula::as_written(text, &["a", "b", "c"].map(|name| declared(name, 1.0, 0.2, 3.0))).unwrap();
    // One point is pulled, two stay where they are.
    let pins = [(1.5, 0.0, 0.0).into(), (0.0, 1.0, 0.0).into(), DVec3::Z];
    let grip = field.pass_through(&pins);
    assert!(grip.holds && grip.idle.is_empty());
    assert_eq!(grip.changed.into_iter().collect::<Vec<_>>(), [("a".to_owned(), 1.5)]);
    let values: Vec<f64> = field.parameters().iter().map(|parameter| parameter.value).collect();
    assert_eq!(values, [1.5, 1.0, 1.0]);
    // More points than parameters, which contradict each other, are met as nearly as can be.
    let grip = field.pass_through(&[(1.0, 0.0, 0.0).into(), (2.0, 0.0, 0.0).into(), DVec3::Y, DVec3::Z]);
    assert!(!grip.holds);
    let a = field.parameters()[0].value;
    assert!((1.2..=1.8).contains(&a), "{a}");
}

#[test]
fn a_surface_that_cannot_come_to_a_point_comes_as_near_as_it_can() {
    let mut field = Formula::as_written("x^2 + y^2 + z^2 - r^2", &[declared("r", 1.0, 0.5, 2.0)]).unwrap();
    let grip = field.pass_through(&[(3.0, 0.0, 0.0).into()]);
    assert!(!grip.holds);
    assert_eq!(field.parameters()[0].value, 2.0);
    let [x, y, z] = grip.places[0];
    assert!((x - 2.0).abs() < 1e-9 && y == 0.0 && z == 0.0);
    // The way back is the same.
    assert!(field.pass_through(&[(1.0, 0.0, 0.0).into()]).holds);
    assert_eq!(field.parameters()[0].value, 1.0);
}

#[test]
fn what_no_parameter_moves_is_left_alone() {
    let mut sphere = Formula::parse("x^2 + y^2 + z^2 = 1").unwrap();
    let grip = sphere.pass_through(&[(2.0, 0.0, 0.0).into()]);
    assert!(!grip.holds && grip.idle.is_empty());
    assert!(sphere.pass_through(&[DVec3::X]).holds);

    // The ring of the torus does not depend on t, and a point where f is undefined changes nothing.
    let mut field = Formula::as_written("sqrt(x) + y*t - 1", &[declared("t", 1.0, 0.0, 3.0)]).unwrap();
    for pin in [DVec3::new(2.0, 0.0, 0.0), DVec3::new(-1.0, 1.0, 0.0)] {
        let grip = field.pass_through(&[pin]);
        assert!(!grip.holds, "{pin}");
        assert_eq!(field.parameters()[0].value, 1.0);
    }
    assert_eq!(field.pass_through(&[DVec3::new(2.0, 0.0, 0.0)]).idle, ["t"]);
}
