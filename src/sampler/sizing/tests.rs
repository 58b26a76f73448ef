use super::*;
use crate::field::gallery::{self, SURFACES, Surface};
use crate::field::{Field, Frame};
use crate::sampler::discovery::survey::survey;
use crate::sampler::probe::{Probe, ProbeMemory};
use crate::sampler::settings::LawKind;

const LAWS: [LawKind; 3] = [LawKind::ChordError, LawKind::MaxCurvature, LawKind::SumOfCurvatures];

fn sizing_of(surface: &Surface, settings: &Settings) -> Sizing {
    let field = surface.field();
    let mut evaluator = field.evaluator(Frame::default());
    let mut memory = ProbeMemory::default();
    let probe = &mut Probe::new(&mut *evaluator, &mut memory);
    let found = survey(probe, &surface.bounds, None);
    Sizing::new(probe, &surface.bounds, settings, None, &found, &Creases::default())
}

fn smooth() -> impl Iterator<Item = &'static Surface> {
    SURFACES.iter().filter(|surface| surface.smooth)
}

#[test]
fn a_sphere_has_one_radius_and_the_count_of_its_area() {
    let sphere = gallery::find("sphere").expect("in the gallery");
    for radius_law in LAWS {
        let settings = Settings { radius_law, ..Settings::default() };
        let sizing = sizing_of(sphere, &settings);
        assert!(sizing.largest() / sizing.smallest() - 1.0 < 1e-3, "{radius_law:?}");
        let radius = f64::from(sizing.smallest());
        let exact = 4.0 * core::f64::consts::PI / (HEXAGONAL_CELL * radius * radius);
        assert!((sizing.predicted_count() / exact - 1.0).abs() < 0.02, "{radius_law:?}");
    }
}

#[test]
fn the_envelope_lies_above_the_law_by_no_more_than_a_cell() {
    for surface in smooth() {
        let sizing = sizing_of(surface, &Settings::default());
        for sample in &sizing.samples {
            // In the middle of a cell the nodes are half a diagonal away.
            let slack = sizing.slope * sizing.envelope.cell * 0.87;
            let law = sizing.law.radius(f32::INFINITY, &sample.curvature);
            let bound = sizing.envelope(sample.position);
            assert!(bound <= law + 1.001 * slack, "{}: envelope {bound}, law {law}", surface.id);
            assert!(bound >= sizing.law.least() && bound <= sizing.law.greatest());
            assert!(sizing.radius(sample.position, &sample.curvature) <= law);
        }
    }
}

#[test]
fn a_count_is_met_by_one_factor() {
    for surface in smooth() {
        for radius_law in LAWS {
            let mut sizing = sizing_of(surface, &Settings { radius_law, ..Settings::default() });
            for count in [800.0, 20_000.0, 300_000.0] {
                sizing.scale_to(count);
                let off = sizing.predicted_count() / count;
                assert!((off - 1.0).abs() < 0.01, "{} {radius_law:?}: {off} of {count}", surface.id);
            }
        }
    }
}

#[test]
fn places_outside_the_box_and_places_that_are_none_have_a_radius() {
    let sizing = sizing_of(&SURFACES[0], &Settings::default());
    let nowhere = Curvature { k1: f32::NAN, k2: f32::NAN, direction: Vec3::NAN };
    for p in [Vec3::splat(1e9), Vec3::splat(-1e9), Vec3::NAN, Vec3::INFINITY] {
        assert_eq!(sizing.radius(p, &nowhere), sizing.law.least(), "{p}");
    }
}
