//! The lesson's bundle: a [`lesson::Lesson`] behind plain objects and copies of its particles.
#![cfg(target_arch = "wasm32")]

use glam::DVec3;
use marching_particles::Bounds;
use marching_particles::field::formula::Formula;
use marching_particles::field::rbf::{Pull, RbfData, RbfField};
use marching_particles::field::{Field, Jet};
use marching_particles::internal::lesson::{self, LessonError, LessonField, LessonSettings};
use marching_particles::internal::paper::Particle;
use marching_particles::internal::session::{Excess, Fault, FaultKind};
use marching_particles_values::{answer, read, to_js};
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

/// Where the declarations of the bundle find the types of the values.
#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r"import type {
  Answer,
  Bounds,
  Fault,
  LessonChapter,
  LessonEvent,
  LessonField,
  LessonIterate,
  LessonLife,
  LessonProgress,
  LessonSettings,
  Pull,
} from '../../engine/core-types.js';";

/// The paper's algorithms, event by event. Requests and answers are plain objects; columns are
/// copies.
#[wasm_bindgen]
#[derive(Default)]
pub struct Lesson {
    run: Option<lesson::Lesson>,
}

/// A field that only evaluates jets. Evaluation in lanes and bounds over boxes are not compiled
/// into the bundle.
struct Pointwise<F>(F);

impl<F: Field> Field for Pointwise<F> {
    fn value_and_gradient(&self, p: DVec3) -> (f64, DVec3) {
        self.0.value_and_gradient(p)
    }

    fn jet(&self, p: DVec3) -> Jet {
        self.0.jet(p)
    }
}

fn formula(field: &LessonField) -> Result<Box<dyn Field>, Fault> {
    let parsed = Formula::as_written(&field.formula, &field.parameters)
        .map_err(|error| Fault::in_formula(error, &field.formula))?;
    Ok(Box::new(Pointwise(parsed.for_sampling())))
}

fn points(system: &[u8], pulls: &[Pull]) -> Result<Box<dyn Field>, Fault> {
    let refused = |error| Fault::new(FaultKind::Points, &error);
    let mut field = RbfData::from_bytes(system).and_then(RbfField::new).map_err(refused)?;
    field.pull(pulls).map_err(refused)?;
    Ok(Box::new(Pointwise(field)))
}

#[wasm_bindgen]
impl Lesson {
    /// A lesson without a run.
    #[wasm_bindgen(constructor)]
    pub fn new() -> Self {
        console_error_panic_hook::set_once();
        Self::default()
    }

    /// Begins a run on a formula, and drops the previous one: takes `LessonField` and
    /// `LessonSettings`, possibly partial; returns an `Answer` with `LessonProgress`.
    #[wasm_bindgen(unchecked_return_type = "Answer<LessonProgress, Fault>")]
    pub fn start(
        &mut self,
        #[wasm_bindgen(unchecked_param_type = "LessonField")] field: JsValue,
        #[wasm_bindgen(unchecked_param_type = "Partial<LessonSettings>")] settings: JsValue,
    ) -> JsValue {
        let field = read::<LessonField>(field, FaultKind::Request);
        self.begin(field.and_then(|field| Ok((formula(&field)?, field.bounds))), settings)
    }

    /// Begins a run on a model from points: `system` is the result of `Points.field`, `pulls` are
    /// those on its surface, and `bounds` is its `Bounds`. Returns an `Answer` with
    /// `LessonProgress`.
    #[wasm_bindgen(unchecked_return_type = "Answer<LessonProgress, Fault>")]
    pub fn start_points(
        &mut self,
        system: &[u8],
        #[wasm_bindgen(unchecked_param_type = "readonly Pull[]")] pulls: JsValue,
        #[wasm_bindgen(unchecked_param_type = "Bounds")] bounds: JsValue,
        #[wasm_bindgen(unchecked_param_type = "Partial<LessonSettings>")] settings: JsValue,
    ) -> JsValue {
        let pulled = read::<Vec<Pull>>(pulls, FaultKind::Request).and_then(|pulls| points(system, &pulls));
        let bounds = read::<Bounds>(bounds, FaultKind::Request);
        self.begin(pulled.and_then(|field| Ok((field, bounds?))), settings)
    }

    /// Does up to `budget` units of work: `LessonProgress`; null before a run.
    #[wasm_bindgen(unchecked_return_type = "LessonProgress | null")]
    pub fn step(&mut self, budget: u32) -> JsValue {
        to_js(&self.run.as_mut().map(|run| run.step(budget)))
    }

    /// The chapters from number `first` on: an array of `LessonChapter`.
    #[wasm_bindgen(unchecked_return_type = "LessonChapter[]")]
    pub fn chapters(&self, first: usize) -> JsValue {
        let chapters = self.run.as_ref().map(lesson::Lesson::chapters).unwrap_or_default();
        to_js(&chapters.get(first..).unwrap_or_default())
    }

    /// Up to `count` events from number `first` on: an array of `LessonEvent`.
    #[wasm_bindgen(unchecked_return_type = "LessonEvent[]")]
    pub fn events(&mut self, first: u32, count: u32) -> JsValue {
        to_js(&self.run.as_mut().map(|run| run.events(first, count)).unwrap_or_default())
    }

    /// Goes to the moment before event number `event`; returns the number of events before that
    /// moment.
    pub fn seek(&mut self, event: u32) -> u32 {
        self.run.as_mut().map_or(0, |run| run.seek(event))
    }

    /// The events at which a particle was added, treated and done: `LessonLife`; null if there is
    /// no such particle.
    #[wasm_bindgen(unchecked_return_type = "LessonLife | null")]
    pub fn life(&self, particle: u32) -> JsValue {
        to_js(&self.run.as_ref().and_then(|run| run.life(particle)))
    }

    /// Positions at the sought moment, three floats each.
    pub fn positions(&self) -> Vec<f32> {
        self.column(|particle| particle.p().as_vec3().to_array()).into_flattened()
    }

    /// Unit normals, three floats each.
    pub fn normals(&self) -> Vec<f32> {
        self.column(|particle| particle.n().as_vec3().to_array()).into_flattened()
    }

    /// Repulsion radii.
    pub fn radii(&self) -> Vec<f32> {
        self.column(|particle| particle.radius as f32)
    }

    /// Generation levels.
    pub fn levels(&self) -> Vec<u32> {
        self.column(|particle| particle.level)
    }

    /// Parents; 0xffffffff for a seed.
    pub fn parents(&self) -> Vec<u32> {
        self.column(|particle| particle.parent.unwrap_or(u32::MAX))
    }

    /// Numbers of the fronts.
    pub fn fronts(&self) -> Vec<u32> {
        self.column(|particle| particle.front)
    }

    /// Three-bit fates of the slots, as in the sampler.
    pub fn slots(&self) -> Vec<u32> {
        self.column(|particle| particle.slots.0)
    }

    /// 1 for a particle that is done, 0 for one that waits.
    pub fn done(&self) -> Vec<u8> {
        self.column(|particle| u8::from(particle.is_done))
    }

    /// The curve f = 0 in the plane of `centre` and two perpendicular unit vectors, within `half`
    /// of the centre: segments as four floats each, x along `right` and y along `up`.
    pub fn section(&mut self, centre: &[f64], right: &[f64], up: &[f64], half: f64, cells: u32) -> Vec<f32> {
        let (Some(run), Some(centre), Some(right), Some(up)) =
            (&mut self.run, vector(centre), vector(right), vector(up))
        else {
            return Vec::new();
        };
        let segments = run.section(centre, right, up, half, cells);
        segments.as_flattened().iter().map(|&x| x as f32).collect()
    }

    /// The steps of Newton's method in space from a point: an array of `LessonIterate`.
    #[wasm_bindgen(unchecked_return_type = "LessonIterate[]")]
    pub fn newton(&mut self, start: &[f64], reach: f64) -> JsValue {
        let run = self.run.as_mut().zip(vector(start));
        to_js(&run.map(|(run, start)| run.newton(start, reach)).unwrap_or_default())
    }

    /// Digest of the particles at the sought moment, 16 hexadecimal digits.
    pub fn digest(&self) -> String {
        format!(
            "{:016x}",
            lesson::digest(self.run.as_ref().map(lesson::Lesson::particles).unwrap_or_default())
        )
    }

    fn begin(&mut self, field: Result<(Box<dyn Field>, Bounds), Fault>, settings: JsValue) -> JsValue {
        self.run = None;
        let settings = read::<LessonSettings>(settings, FaultKind::Settings);
        answer(field.and_then(|(field, bounds)| {
            let run = lesson::Lesson::new(field, &bounds, &settings?).map_err(|error| refusal(&error))?;
            Ok(self.run.insert(run).progress())
        }))
    }

    fn column<T>(&self, of: impl Fn(&Particle) -> T) -> Vec<T> {
        self.run.as_ref().map(lesson::Lesson::particles).unwrap_or_default().iter().map(of).collect()
    }
}

/// Why a run cannot begin.
fn refusal(error: &LessonError) -> Fault {
    match *error {
        LessonError::TooMany { expected, limit, factor } => Fault {
            excess: Some(Box::new(Excess { expected, limit, factor })),
            ..Fault::new(FaultKind::TooMany, error)
        },
        _ => Fault::new(FaultKind::Settings, error),
    }
}

fn vector(numbers: &[f64]) -> Option<[f64; 3]> {
    numbers.try_into().ok()
}
