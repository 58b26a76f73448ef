//! The core bundle: a [`Session`] behind plain objects and copies of the particle columns.
#![cfg(target_arch = "wasm32")]

mod combined;
mod mesh;

use glam::{DVec3, Vec3};
use js_sys::{Float64Array, Function, Uint8Array, Uint32Array};
use marching_particles::field::formula::number;
use marching_particles::field::model::SolvedModel;
use marching_particles::field::rbf::RbfData;
use marching_particles::field::{BatchField, BatchPiecewise, Field};
use marching_particles::image::{AxisOrder, Section, VoxelType};
use marching_particles::internal::session::{
    Asked, Fault, FaultKind, FieldRequest, FileRecord, FileRequest, ImageFacts, ImagePromise, Language,
    Lengths, OpenedMesh, Session, SolidSettings, SpacingText, ValueText, describe,
};
use marching_particles::internal::slices::Estimated;
use marching_particles::particles::Particles;
use marching_particles::run::Value;
use marching_particles::sampler::Sampling;
use marching_particles::{Image, Spacing, TriangleMesh};
use marching_particles_values::{answer, read, to_js};
use std::sync::Arc;
use wasm_bindgen::prelude::wasm_bindgen;
use wasm_bindgen::{JsCast, JsValue};

/// The member of the settings with lengths instead of shares.
const LENGTHS: &str = "lengths";

/// The member of the settings that holds the formula of the spacing, empty for none.
const SPACING: &str = "spacing";

/// Error of a JavaScript function that has thrown; the caller of the core knows the reason.
const THROWN: &str = "the function has thrown";

/// Where the declarations of the bundle find the types of the values.
#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r"import type {
  Answer,
  Code,
  Description,
  Fault,
  FieldAnswer,
  FieldRequest,
  FileRequest,
  ImageFacts,
  ImagePromise,
  MeshAnswer,
  MeshChange,
  Progress,
  FileRecord,
  Measured,
  Measures,
  Report,
  SolvedModel,
  Start,
} from '../../engine/core-types.js';";

/// A sampling session. Requests and answers are plain objects; columns are copies, with three
/// floats per vector.
#[wasm_bindgen]
pub struct Core {
    session: Session,
    /// The last opened file, with its name. The field keeps its own copy, which shares voxels and
    /// faces.
    opened: Option<(String, Opened)>,
    /// The bytes of the file that is read.
    bytes: Vec<u8>,
    /// Along each axis of the image in this file, one voxel in so many is kept; 1 keeps all.
    step: usize,
    /// The file that is opened.
    opening: Option<Opening>,
    /// The kept fields, of which [`Core::combine`] makes others.
    kept: Vec<Arc<dyn Field>>,
}

/// The name of a file, and the work of opening it; of an image it also finds out the facts.
type Opening = (String, Estimated<'static, Result<(Opened, Option<ImageFacts>), Fault>>);

/// The contents of a file or an array.
enum Opened {
    Image(Image),
    Mesh(OpenedMesh),
}

#[wasm_bindgen]
impl Core {
    /// A session on the default surface, with nothing sampled.
    #[wasm_bindgen(constructor)]
    #[expect(clippy::new_without_default, reason = "a constructor for JavaScript")]
    pub fn new() -> Self {
        console_error_panic_hook::set_once();
        Self::of(Session::new())
    }

    /// A session whose first formula is treated as that of no gallery surface, whatever its text.
    pub fn without_surface() -> Self {
        console_error_panic_hook::set_once();
        Self::of(Session::without_surface())
    }

    fn of(session: Session) -> Self {
        Self { session, opened: None, bytes: Vec::new(), step: 1, opening: None, kept: Vec::new() }
    }

    /// The description of all settings, surfaces and figures: `Description`.
    #[wasm_bindgen(unchecked_return_type = "Description")]
    pub fn describe(&self) -> JsValue {
        to_js(&describe())
    }

    /// Changes the field: takes a `FieldRequest`, returns an `Answer` with `FieldAnswer`. After an
    /// error the last valid field stays.
    #[wasm_bindgen(unchecked_return_type = "Answer<FieldAnswer, Fault>")]
    pub fn set_field(
        &mut self,
        #[wasm_bindgen(unchecked_param_type = "Partial<FieldRequest>")] request: JsValue,
    ) -> JsValue {
        let request = read::<FieldRequest>(request, FaultKind::Request);
        answer(request.and_then(|request| self.session.set_field(&request)))
    }

    /// The value of a text without names in the language of formulas; nothing for any other text.
    pub fn number(&self, text: &str) -> Option<f64> {
        number(text).ok()
    }

    /// The error in the formula of a `thickness`, a `spacing` or a `value` on the present surface;
    /// nothing if it is valid.
    pub fn text_fault(
        &self,
        #[wasm_bindgen(unchecked_param_type = "'thickness' | 'spacing' | 'value'")] what: &str,
        text: &str,
    ) -> Option<String> {
        let checked = match what {
            "thickness" => self.session.check_thickness(&text.into()),
            "spacing" => self.session.check_spacing(text),
            _ => self.session.value(text).map(drop),
        };
        checked.err().map(|fault| fault.message)
    }

    /// Refuses runs that need more than about `megabytes`, including their report.
    pub fn limit_memory(&mut self, megabytes: usize) {
        self.session.run.limit_memory(megabytes << 20);
    }

    /// Changes the field to a model from points. `system` is the result of `Points.field`, with the
    /// `SolvedModel` from `Points.info`; of the `FieldRequest` the box, the pulls and a formula
    /// with the model as an operand count. Returns an `Answer` with `FieldAnswer`. After an error
    /// the last valid field stays.
    #[wasm_bindgen(unchecked_return_type = "Answer<FieldAnswer, Fault>")]
    pub fn set_points(
        &mut self,
        system: &[u8],
        #[wasm_bindgen(unchecked_param_type = "SolvedModel")] about: JsValue,
        #[wasm_bindgen(unchecked_param_type = "Partial<FieldRequest>")] request: JsValue,
    ) -> JsValue {
        answer(read::<SolvedModel>(about, FaultKind::Request).and_then(|SolvedModel { info, bounds }| {
            let request = read::<FieldRequest>(request, FaultKind::Request)?;
            let data = RbfData::from_bytes(system).map_err(|error| Fault::new(FaultKind::Points, &error))?;
            self.session.set_points(data, info, bounds, &request)
        }))
    }

    /// The size and type of the image in a file, and the memory that it needs, from the first
    /// megabyte of the file or all its bytes: an `Answer` with `ImagePromise`.
    #[wasm_bindgen(unchecked_return_type = "Answer<ImagePromise, Fault>")]
    pub fn image_promise(&self, name: &str, start: &[u8]) -> JsValue {
        let outline = Image::outline(name, start).map_err(|error| Fault::new(FaultKind::Image, &error));
        answer(outline.map(|outline| ImagePromise::of(outline.as_ref())))
    }

    /// Begins a file of this size, whose bytes [`Core::add_bytes`] appends. One that has been begun
    /// is forgotten.
    pub fn begin_file(&mut self, size: usize) {
        (self.bytes, self.step, self.opening) = (Vec::new(), 1, None);
        // Without the memory, the bytes are refused as they come.
        let _ = self.bytes.try_reserve_exact(size);
    }

    /// Appends bytes to the file that was begun.
    pub fn add_bytes(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    /// Keeps one voxel in `step` along each axis of the image in the file that was begun.
    pub fn keep_one_in(&mut self, step: usize) {
        self.step = step.max(1);
    }

    /// Begins to open the image in the file whose bytes have been added. [`Core::open_step`] does
    /// the work. `beside` returns the bytes of another file by name.
    pub fn open_image(
        &mut self,
        name: String,
        #[wasm_bindgen(unchecked_param_type = "(name: string) => Uint8Array | undefined")] beside: Function,
    ) {
        let beside = move |name: &str| {
            let found = beside.call1(&JsValue::NULL, &JsValue::from_str(name));
            let bytes = found.ok().and_then(|bytes| bytes.dyn_into::<Uint8Array>().ok());
            bytes.map(|bytes| bytes.to_vec()).ok_or_else(|| "choose both files together".to_owned())
        };
        let (bytes, step) = (core::mem::take(&mut self.bytes), self.step);
        let outline = Image::outline(&name, &bytes[..bytes.len().min(1 << 20)]).ok().flatten();
        let image = Image::read_in_slices(name.clone(), bytes, beside);
        let work = async move {
            let fault = |error: &dyn core::fmt::Display| Fault::new(FaultKind::Image, &error);
            let mut image = image.await.map_err(|error| fault(&error))?;
            if step > 1 {
                image = image.coarser_in_slices(step).await.map_err(|error| fault(&error))?;
            }
            let facts = ImageFacts::of(&image).await;
            Ok((Opened::Image(image), Some(facts)))
        };
        let expected = outline.map_or(0, |outline| outline.slices());
        self.opening = Some((name, Estimated::new(Box::pin(work), expected)));
    }

    /// Begins to open the triangle mesh in the file whose bytes have been added, for
    /// [`Core::set_opened`]. [`Core::open_step`] does the work.
    pub fn open_mesh(&mut self, name: String) {
        /// Bytes of a file that take about one slice to read and repair.
        const BYTES: usize = 4_096;
        let bytes = core::mem::take(&mut self.bytes);
        let expected = bytes.len() / BYTES;
        let mesh = OpenedMesh::read_in_slices(name.clone(), bytes);
        let work = async { Ok((Opened::Mesh(mesh.await?), None)) };
        self.opening = Some((name, Estimated::new(Box::pin(work), expected as u64)));
    }

    /// Does up to `budget` slices of the work of opening a file, for [`Core::set_opened`]. Returns
    /// the share that is done; at the end an `Answer`, of an image with `ImageFacts`. After an
    /// error the last valid file stays.
    #[wasm_bindgen(unchecked_return_type = "number | Answer<ImageFacts | object, Fault>")]
    pub fn open_step(&mut self, budget: u32) -> JsValue {
        let nothing = || Fault::new(FaultKind::Request, &"no file has been begun");
        let Some((name, mut work)) = self.opening.take() else {
            return answer(Err::<ImageFacts, _>(nothing()));
        };
        let Some(opened) = work.advance(budget) else {
            let share = work.fraction().min(0.999);
            self.opening = Some((name, work));
            return share.into();
        };
        answer(opened.map(|(opened, facts)| {
            self.opened = Some((name, opened));
            facts
        }))
    }

    /// Opens an image from an array: the bytes of voxels of a type such as `int16`, the index along
    /// the first axis changing fastest, and the affine map from indices to points, row by row.
    /// Returns the reason if that fails, else null.
    #[wasm_bindgen(unchecked_return_type = "Fault | null")]
    pub fn open_voxels(
        &mut self,
        name: String,
        voxel_type: &str,
        size: &[u32],
        rows: &[f64],
        bytes: Vec<u8>,
    ) -> JsValue {
        let image = image_of(voxel_type, size, rows, bytes);
        to_js(&image.map(|image| self.opened = Some((name, Opened::Image(image)))).err())
    }

    /// Opens a triangle mesh from arrays: three coordinates per vertex, and three vertices per
    /// face. Returns the reason if that fails, else null.
    #[wasm_bindgen(unchecked_return_type = "Fault | null")]
    pub fn open_faces(&mut self, name: String, points: &[f64], faces: &[u32]) -> JsValue {
        let points = points.as_chunks().0.iter().copied().map(DVec3::from_array).collect();
        let mesh = TriangleMesh::new(points, faces.as_chunks().0.to_vec())
            .map_err(|error| Fault::new(FaultKind::Mesh, &error))
            .and_then(|mesh| OpenedMesh::new(&mesh));
        to_js(&mesh.map(|mesh| self.opened = Some((name, Opened::Mesh(mesh)))).err())
    }

    /// Forgets the last opened file. The present field keeps its own copy.
    pub fn close_opened(&mut self) {
        self.opened = None;
    }

    /// Does up to `budget` slices of the work of [`Core::set_opened`] with this request, which then
    /// takes what is made. Returns the share that is done, 1 at the end, also after an error. A
    /// call with another choice begins again.
    pub fn make_opened(
        &mut self,
        #[wasm_bindgen(unchecked_param_type = "Partial<FieldRequest>")] request: JsValue,
        budget: u32,
    ) -> f64 {
        match (read::<FieldRequest>(request, FaultKind::Request), &self.opened) {
            (Ok(request), Some((_, Opened::Image(image)))) => {
                self.session.make_image(image, &request, budget)
            }
            (Ok(request), Some((_, Opened::Mesh(mesh)))) => self.session.make_mesh(mesh, &request, budget),
            _ => 1.0,
        }
    }

    /// Changes the field to a surface of the last opened file. A `FieldRequest` gives the file's
    /// parameters (`iso`, `label`, `smooth`, `dark` and `closed` of an image, `edges`, `borders`
    /// and `smooth` of a mesh), the box, and a formula with the surface as an operand. Returns an
    /// `Answer` with `FieldAnswer`. After an error the last valid field stays.
    #[wasm_bindgen(unchecked_return_type = "Answer<FieldAnswer, Fault>")]
    pub fn set_opened(
        &mut self,
        #[wasm_bindgen(unchecked_param_type = "Partial<FieldRequest>")] request: JsValue,
    ) -> JsValue {
        let request = read::<FieldRequest>(request, FaultKind::Request);
        answer(request.and_then(|request| match &self.opened {
            Some((name, Opened::Image(image))) => self.session.set_image(image, name, &request),
            Some((name, Opened::Mesh(mesh))) => self.session.set_mesh(mesh, name, &request),
            None => Err(Fault::new(FaultKind::Request, &"no file has been opened")),
        }))
    }

    /// The voxels of the image in a plane: at `place`, nine numbers for a corner and the steps
    /// along two directions, with so many points along these. NaN outside the image; empty without
    /// one.
    pub fn section(&self, place: &[f64], width: usize, height: usize) -> Vec<f32> {
        let [corner, across, along] = core::array::from_fn(|k| DVec3::from_slice(&place[3 * k..]));
        let section = Section { corner, steps: [across, along], size: [width, height] };
        self.session.section(&section).unwrap_or_default()
    }

    /// Changes the field to a function that takes the coordinates of up to 512 points and an array
    /// for f at each of them. Returns an `Answer` with `FieldAnswer`. With `labels`, the function
    /// also takes the label of a piece, whose values it writes; `labels` writes the labels at
    /// points. Only the box of the `FieldRequest` is used. After a function has thrown, none is
    /// called again, and the run ends.
    #[wasm_bindgen(unchecked_return_type = "Answer<FieldAnswer, Fault>")]
    pub fn set_function(
        &mut self,
        #[wasm_bindgen(
            unchecked_param_type = "(points: Float64Array, out: Float64Array, piece?: number) => void"
        )]
        function: Function,
        #[wasm_bindgen(unchecked_param_type = "Partial<FieldRequest>")] request: JsValue,
        #[wasm_bindgen(unchecked_optional_param_type = "(points: Float64Array, out: Uint32Array) => void")]
        labels: Option<Function>,
    ) -> JsValue {
        #[expect(clippy::arc_with_non_send_sync, reason = "a function of JavaScript is sent nowhere")]
        let field: Arc<dyn Field> = match labels {
            None => Arc::new(function_of(function)),
            Some(labels) => {
                let labels = move |points: &[DVec3], out: &mut [u32]| {
                    let found = Uint32Array::new_with_length(out.len() as u32);
                    labels.call2(&JsValue::NULL, &coordinates(points), &found).map_err(|_| THROWN)?;
                    found.copy_to(out);
                    Ok(())
                };
                let piece = move |piece: u32, points: &[DVec3], f: &mut [f64]| {
                    let out = Float64Array::new_with_length(f.len() as u32);
                    let (points, piece) = (coordinates(points), piece.into());
                    function.call3(&JsValue::NULL, &points, &out, &piece).map_err(|_| THROWN)?;
                    out.copy_to(f);
                    Ok(())
                };
                Arc::new(BatchPiecewise::<_, _, &str>::new(labels, piece))
            }
        };
        answer(
            read::<FieldRequest>(request, FaultKind::Request)
                .and_then(|request| self.session.set_function(field, request.bounds)),
        )
    }

    /// Chooses the distance between neighbours for the next runs: a formula, or a function like
    /// that of [`Core::set_function`]. Returns the error in the formula, else null.
    #[wasm_bindgen(unchecked_return_type = "Fault | null")]
    pub fn space(
        &mut self,
        #[wasm_bindgen(
            unchecked_param_type = "string | ((points: Float64Array, out: Float64Array) => void)"
        )]
        spacing: JsValue,
    ) -> JsValue {
        let spaced = match spacing.dyn_into::<Function>() {
            Ok(function) => {
                self.session.space_by(Spacing::by(function_of(function)));
                Ok(())
            }
            Err(text) => {
                let formula = text.as_string().unwrap_or_default();
                self.session.space(Some(SpacingText { formula, ..SpacingText::default() }))
            }
        };
        to_js(&spaced.err())
    }

    /// Adds a column of values at the particles, from a formula or a function like that of
    /// [`Core::set_function`], doing up to `budget` slices of the work. Returns undefined until it
    /// is complete; then the error in the value, else null.
    #[wasm_bindgen(unchecked_return_type = "Fault | null | undefined")]
    pub fn add_value(
        &mut self,
        name: &str,
        #[wasm_bindgen(
            unchecked_param_type = "string | ((points: Float64Array, out: Float64Array) => void)"
        )]
        value: JsValue,
        budget: u32,
    ) -> JsValue {
        let value = match value.dyn_into::<Function>() {
            Ok(function) => Ok(Value::by(function_of(function))),
            Err(text) => self.session.value(&text.as_string().unwrap_or_default()),
        };
        match value.map(|value| self.session.add_value(name, &value, budget)) {
            Ok(None) => JsValue::UNDEFINED,
            Ok(Some(added)) => to_js(&added.err().map(|error| Fault::new(FaultKind::Value, &error))),
            Err(fault) => to_js(&Some(fault)),
        }
    }

    /// The names of the added columns.
    pub fn value_names(&self) -> Vec<String> {
        self.session.run.measured().values.iter().map(|own| own.name.clone()).collect()
    }

    /// The added column of this name; empty if there is none.
    pub fn added_value(&self, name: &str) -> Vec<f32> {
        let all = &self.session.run.measured().values;
        all.iter().find(|own| own.name == name).map_or_else(Vec::new, |own| own.values.clone())
    }

    /// Finds the box of the next run with these `Settings` and the creases in it, doing up to
    /// `budget` slices of the work: an `Answer` with `FieldAnswer` once complete, nothing before.
    /// While a slider moves, the box `only_grows`.
    #[wasm_bindgen(unchecked_return_type = "Answer<FieldAnswer, Fault> | undefined")]
    pub fn fit(
        &mut self,
        #[wasm_bindgen(unchecked_param_type = "Record<string, number | string>")] settings: JsValue,
        only_grows: bool,
        budget: u32,
    ) -> Option<JsValue> {
        let field = match self.read_settings(settings) {
            Ok(asked) => Ok(self.session.fit(&|bounds| asked.within(bounds), only_grows, budget)?),
            Err(fault) => Err(fault),
        };
        Some(answer(field))
    }

    /// Starts a run with `Settings`, in which missing ones have their defaults. Returns an `Answer`
    /// with `Start`.
    #[wasm_bindgen(unchecked_return_type = "Answer<Start, Fault>")]
    pub fn start(
        &mut self,
        #[wasm_bindgen(unchecked_param_type = "Record<string, number | string>")] settings: JsValue,
    ) -> JsValue {
        answer(self.read_settings(settings).and_then(|asked| {
            let settings = asked.within(&self.session.run.bounds());
            self.session.start(&settings).map_err(|error| Fault::new(FaultKind::Settings, &error))
        }))
    }

    /// Moves the particles of the last run along with its surface to the present field, in the box
    /// from [`Core::fit`]. Returns whether that is possible and the run had these `Settings`.
    /// `is_closed`: no particle is born, and one dies only if it does not reach the surface.
    pub fn follow(
        &mut self,
        #[wasm_bindgen(unchecked_param_type = "Record<string, number | string>")] settings: JsValue,
        is_closed: bool,
    ) -> bool {
        self.read_settings(settings).is_ok_and(|asked| {
            let settings = asked.within(&self.session.run.bounds());
            self.session.follow(&settings, is_closed).is_ok()
        })
    }

    /// Does up to `budget` units of work: `Progress`.
    #[wasm_bindgen(unchecked_return_type = "Progress")]
    pub fn step(&mut self, budget: u32) -> JsValue {
        to_js(&self.session.run.step(budget))
    }

    /// Queues relaxation steps on the present particles.
    pub fn relax(&mut self, steps: u32) {
        let _ = self.session.run.relax(steps);
    }

    /// Ends the run and keeps the particles: `Progress`.
    #[wasm_bindgen(unchecked_return_type = "Progress")]
    pub fn cancel(&mut self) -> JsValue {
        to_js(&self.session.run.cancel())
    }

    /// Rows of the columns: one per particle, and one per side for particles on creases and smooth
    /// joins.
    pub fn count(&self) -> usize {
        self.session.run.rows()
    }

    /// Positions from particle `from` on, rounded to single precision.
    pub fn positions(&self, from: usize) -> Vec<f32> {
        let particles = self.session.run.particles();
        if particles.origin == DVec3::ZERO {
            return self.vectors(&particles.local, from);
        }
        self.exact_positions(from).into_iter().map(|coordinate| coordinate as f32).collect()
    }

    /// Positions from particle `from` on, if single precision is not enough: in a box far from the
    /// origin. Otherwise empty.
    pub fn exact_positions(&self, from: usize) -> Vec<f64> {
        let particles = self.session.run.particles();
        if particles.origin == DVec3::ZERO {
            return Vec::new();
        }
        (from..self.session.run.rows()).flat_map(|i| particles.place(i).to_array()).collect()
    }

    /// For rows of particles on creases, smooth joins and tips, which come first, the first row of
    /// the same particle; empty without any.
    pub fn twins(&self) -> Vec<u32> {
        self.column(&self.session.run.particles().twins, 0)
    }

    /// The pairs of rows that a crease connects, two numbers each; empty without creases.
    pub fn segments(&self) -> Vec<u32> {
        self.pairs_along(true)
    }

    /// The pairs of rows that a smooth join connects, two numbers each; empty without them.
    pub fn seams(&self) -> Vec<u32> {
        self.pairs_along(false)
    }

    /// Unit normals from particle `from` on.
    pub fn normals(&self, from: usize) -> Vec<f32> {
        self.vectors(&self.session.run.particles().normal, from)
    }

    /// Repulsion radii from particle `from` on.
    pub fn radii(&self, from: usize) -> Vec<f32> {
        self.column(&self.session.run.particles().radius, from)
    }

    /// Generation levels from particle `from` on.
    pub fn levels(&self, from: usize) -> Vec<u32> {
        self.column(&self.session.run.particles().level, from)
    }

    /// Parents from particle `from` on; 0xffffffff for a seed.
    pub fn parents(&self, from: usize) -> Vec<u32> {
        self.column(&self.session.run.particles().parent, from)
    }

    /// The fates of the slots, three bits each, from particle `from` on: six, or up to ten of an
    /// adaptive particle. Bit 30 marks a nearby singular point.
    pub fn slots(&self, from: usize) -> Vec<u32> {
        self.column(&self.session.run.particles().slots, from).into_iter().map(|slots| slots.0).collect()
    }

    /// Announces what follows the run, for the estimate of the work: which particles will be
    /// measured, and whether they will be joined.
    pub fn plan(
        &mut self,
        #[wasm_bindgen(unchecked_param_type = "Measured")] measured: JsValue,
        is_joined: bool,
    ) {
        self.session.run.plan(read(measured, FaultKind::Request).unwrap_or_default(), is_joined);
    }

    /// Estimated share of the work that is done, of the run and of what is planned.
    pub fn fraction(&self) -> f64 {
        self.session.run.fraction()
    }

    /// Measures these particles, doing up to `budget` slices of the work: `Report` once complete,
    /// nothing before.
    #[wasm_bindgen(unchecked_return_type = "Report | undefined")]
    pub fn measure(
        &mut self,
        #[wasm_bindgen(unchecked_param_type = "Measured")] measured: JsValue,
        budget: u32,
    ) -> Option<JsValue> {
        let measured = read(measured, FaultKind::Request).unwrap_or_default();
        self.session.measure(measured, budget).map(|report| to_js(&report))
    }

    /// Measures particles placed on the present surface by other means, three floats per vector:
    /// `Measures`. The columns of the last report then belong to them.
    #[wasm_bindgen(unchecked_return_type = "Measures")]
    pub fn measure_placed(
        &mut self,
        positions: &[f32],
        normals: &[f32],
        radii: &[f32],
        is_adaptive: bool,
    ) -> JsValue {
        let vectors = |floats: &[f32]| floats.as_chunks().0.iter().copied().map(Vec3::from_array).collect();
        let placed = Particles {
            local: vectors(positions),
            normal: vectors(normals),
            radius: radii.to_vec(),
            ..Particles::default()
        };
        let sampling = if is_adaptive { Sampling::Adaptive } else { Sampling::Uniform };
        to_js(&self.session.run.measure_placed(&placed, sampling))
    }

    /// Number of natural neighbours per particle, from the last report.
    pub fn valence(&self) -> Vec<u8> {
        self.session.run.measured().valence.clone()
    }

    /// Distance to the nearest particle, from the last report.
    pub fn nearest(&self) -> Vec<f32> {
        self.session.run.measured().nearest.clone()
    }

    /// Patch of each particle, as the number of its branch; empty without creases.
    pub fn patch(&self) -> Vec<u32> {
        self.column(&self.session.run.particles().patch, 0)
    }

    /// The column [`Particles::periodic`].
    pub fn periodic(&self) -> Vec<u32> {
        self.column(&self.session.run.particles().periodic, 0)
    }

    /// For each row, the first row of the same particle: one on a crease has a row on each side.
    /// Empty without creases.
    pub fn particle(&self) -> Vec<u32> {
        let particles = self.session.run.particles();
        let rows = self.session.run.rows().min(particles.patch.len());
        (0..rows).map(|row| particles.first_row(row) as u32).collect()
    }

    /// |f|/|∇f| per particle, from the last report.
    pub fn residual(&self) -> Vec<f32> {
        self.session.run.measured().residual.clone()
    }

    /// Energy of each particle among its natural neighbours, over that of six at the ideal
    /// distance, from the last report.
    pub fn energy(&self) -> Vec<f32> {
        self.session.run.measured().energy.clone()
    }

    /// Component of each particle, 0 the largest, from the last report; 0xffffffff for none.
    pub fn component(&self) -> Vec<u32> {
        self.session.run.measured().component.clone()
    }

    /// Principal curvatures of particles from `from` on, two each, computed by this call.
    pub fn curvature(&mut self, from: usize) -> Vec<f32> {
        self.session.run.curvatures(from).into_flattened()
    }

    /// Joins the particles to a mesh, doing up to `budget` slices of the work: `MeshAnswer` once
    /// complete, nothing before.
    #[wasm_bindgen(unchecked_return_type = "MeshAnswer | undefined")]
    pub fn join(&mut self, budget: u32) -> Option<JsValue> {
        self.session.join(budget).map(|answer| to_js(&answer))
    }

    /// The distance of the joined mesh from the opened one, doing up to `budget` slices of the
    /// work: `MeshChange` once complete, undefined before; null unless the surface is that of a
    /// mesh without a formula.
    #[wasm_bindgen(unchecked_return_type = "MeshChange | null | undefined")]
    pub fn compare(&mut self, budget: u32) -> JsValue {
        self.session.compare(budget).map_or(JsValue::UNDEFINED, |change| to_js(&change))
    }

    /// The triangles of the mesh, three rows each, counter-clockwise around their normals; none
    /// before it is complete.
    pub fn triangles(&self) -> Vec<u32> {
        self.session.run.mesh().map_or_else(Vec::new, |mesh| mesh.corners().as_flattened().to_vec())
    }

    /// The mesh as a file with its record, from a `FileRequest`, doing up to `budget` slices of the
    /// work: its bytes once complete, undefined before; null for an unknown extension or if it is
    /// too large.
    #[wasm_bindgen(unchecked_return_type = "Uint8Array<ArrayBuffer> | null | undefined")]
    pub fn mesh_file(
        &mut self,
        #[wasm_bindgen(unchecked_param_type = "Partial<FileRequest>")] request: JsValue,
        budget: u32,
    ) -> JsValue {
        let Ok(request) = read::<FileRequest>(request, FaultKind::Request) else { return JsValue::NULL };
        match self.session.mesh_file(&request, json_of, budget) {
            Some(Some(bytes)) => js_sys::Uint8Array::from(&bytes[..]).into(),
            Some(None) => JsValue::NULL,
            None => JsValue::UNDEFINED,
        }
    }

    /// The particles as a file with this extension, with what was measured of them and the record;
    /// as `json` the record by itself. None for another extension or without a record.
    #[wasm_bindgen(unchecked_return_type = "Uint8Array<ArrayBuffer> | undefined")]
    pub fn particle_file(&self, extension: &str) -> Option<js_sys::Uint8Array> {
        self.session.particle_file(extension, json_of).map(|bytes| js_sys::Uint8Array::from(&bytes[..]))
    }

    /// The record for the files of the particles: `FileRecord`; null before the first run.
    #[wasm_bindgen(unchecked_return_type = "FileRecord | null")]
    pub fn record(&self) -> JsValue {
        to_js(&self.session.record(None))
    }

    /// A program that makes the particles of the last run, in a language (`rust`, `js`, `python` or
    /// `shell`): an `Answer` with `Code`.
    #[wasm_bindgen(unchecked_return_type = "Answer<Code, string>")]
    pub fn code(&self, language: &str) -> JsValue {
        let values = ValueText::of(&self.session.run.measured().values);
        let language = Language::named(language).ok_or_else(|| format!("there is no language `{language}`"));
        answer(language.and_then(|language| self.session.code(language, &values)))
    }

    /// Digest of the particle columns, 16 hexadecimal digits.
    pub fn digest(&self) -> String {
        format!("{:016x}", self.session.run.particles().digest())
    }

    /// Reads the settings of a run, and applies those of the box and the solid, which belong to the
    /// session. `lengths` among them are [`Lengths`].
    fn read_settings(&mut self, settings: JsValue) -> Result<Asked, Fault> {
        let solid: SolidSettings = read(settings.clone(), FaultKind::Settings)?;
        self.session.choose(solid)?;
        let of_run = js_sys::Object::assign(&js_sys::Object::new(), settings.unchecked_ref());
        let lengths = js_sys::Reflect::get(&of_run, &LENGTHS.into()).unwrap_or_default();
        let lengths =
            if lengths.is_undefined() { Lengths::default() } else { read(lengths, FaultKind::Settings)? };
        if let Some(formula) = js_sys::Reflect::get(&of_run, &SPACING.into()).unwrap_or_default().as_string()
        {
            let spacing = SpacingText { formula, ..SpacingText::default() };
            self.session.space(Some(spacing).filter(|spacing| !spacing.formula.is_empty()))?;
        }
        for name in SolidSettings::NAMES.into_iter().chain([LENGTHS, SPACING]) {
            // Deleting a missing property does nothing; a copy can be changed.
            let _ = js_sys::Reflect::delete_property(&of_run, &name.into());
        }
        Ok(Asked { settings: read(of_run.into(), FaultKind::Settings)?, lengths })
    }

    fn column<T: Copy>(&self, column: &[T], from: usize) -> Vec<T> {
        let count = self.session.run.rows().min(column.len());
        column[from.min(count)..count].to_vec()
    }

    fn pairs_along(&self, is_edge: bool) -> Vec<u32> {
        let particles = self.session.run.particles();
        let segments = particles.segments.iter().zip(particles.edges());
        segments.filter(|&(_, edge)| edge == is_edge).flat_map(|(rows, _)| *rows).collect()
    }

    fn vectors(&self, column: &[Vec3], from: usize) -> Vec<f32> {
        let count = self.session.run.rows().min(column.len());
        bytemuck::cast_slice(&column[from.min(count)..count]).to_vec()
    }
}

/// The JSON of a record.
fn json_of(record: &FileRecord) -> String {
    js_sys::JSON::stringify(&to_js(record)).expect("a record is an object without cycles").into()
}

/// A field from a function that writes f at points.
fn function_of(function: Function) -> impl Field + 'static {
    BatchField::<_, &str>::new(move |points: &[DVec3], f: &mut [f64]| {
        let out = Float64Array::new_with_length(f.len() as u32);
        function.call2(&JsValue::NULL, &coordinates(points), &out).map_err(|_| THROWN)?;
        out.copy_to(f);
        Ok(())
    })
}

/// The coordinates of points, three numbers each.
fn coordinates(points: &[DVec3]) -> Float64Array {
    Float64Array::from(bytemuck::cast_slice::<_, f64>(points))
}

/// The image from an array, see [`Core::open_voxels`].
fn image_of(voxel_type: &str, size: &[u32], rows: &[f64], bytes: Vec<u8>) -> Result<Image, Fault> {
    let wrong = || Fault::new(FaultKind::Request, &"an image has three sizes and twelve numbers of a map");
    let voxel_type = VoxelType::named(voxel_type).ok_or_else(wrong)?;
    let size: [u32; 3] = size.try_into().map_err(|_| wrong())?;
    let [x, y, z] = rows.as_chunks().0 else { return Err(wrong()) };
    Image::from_bytes(size.map(|n| n as usize), AxisOrder::FirstFastest, voxel_type, bytes)
        .and_then(|image| image.with_affine([*x, *y, *z]))
        .map_err(|error| Fault::new(FaultKind::Image, &error))
}
