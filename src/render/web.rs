//! The renderer's interface for JavaScript.
//!
//! Every method borrows the renderer only during the call, even the asynchronous one, so that the
//! next frame can be drawn while a picture is being read.

use crate::chunks::MOST_RECORDS;
use crate::style::{BodyStyle, ClipBoxStyle, CuttingPlane, Drawing, Style};
use crate::view::View;
use crate::{Callbacks, Columns, DrawOutcome, Renderer as Inner, Screen};
use js_sys::{Array, Float32Array, Function, JSON, Promise, Reflect, Uint8Array, Uint32Array};
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::{Arc, OnceLock};
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::{JsFuture, future_to_promise, spawn_local};
use web_sys::HtmlCanvasElement;

/// Particles copied at a time: 2.4 MB of columns, so that a million particles need no second copy
/// in this memory.
const SLICE: u32 = 1 << 16;
/// Milliseconds between two checks whether a picture has arrived, for WebGL2, which calls nobody.
/// The HTML Standard's minimum for timers that are set from timers (§8.6, "Timers").
const POLL_MS: i32 = 4;

#[wasm_bindgen]
extern "C" {
    #[wasm_bindgen(js_name = setTimeout)]
    fn set_timeout(handler: &Function, timeout_ms: i32);
}

/// Draws particles on a canvas. Call `free()` when done. After the device is lost, create a new
/// renderer on a new canvas.
#[wasm_bindgen]
pub struct Renderer {
    inner: Rc<RefCell<Inner>>,
    screen: RefCell<Screen>,
    scratch: RefCell<Scratch>,
    canvas: HtmlCanvasElement,
    on_context_lost: Closure<dyn FnMut(web_sys::Event)>,
}

#[derive(Default)]
struct Scratch {
    positions: Vec<f32>,
    normals: Vec<f32>,
    radii: Vec<f32>,
    levels: Vec<u32>,
    colours: Vec<u32>,
    marks: Vec<u32>,
}

impl Scratch {
    fn columns(&self) -> Columns<'_> {
        let Self { positions, normals, radii, levels, colours, .. } = self;
        Columns { positions, normals, radii, levels, colours }
    }
}

#[wasm_bindgen]
impl Renderer {
    /// Opens a graphics device on `canvas`, which must not have a context of another kind.
    ///
    /// `on_lost(reason, message)` is called once, when the device is lost; reason is "unknown" or
    /// "destroyed". `on_error(message)` is called when the device rejects a call; drawing
    /// continues. Both are called after the causing method has returned, and may use the renderer.
    ///
    /// # Errors
    ///
    /// Throws an `Error` if the canvas, the adapter or the device is not available.
    pub async fn create(
        canvas: HtmlCanvasElement,
        #[wasm_bindgen(unchecked_param_type = "(reason: string, message: string) => void")] on_lost: Function,
        #[wasm_bindgen(unchecked_param_type = "(message: string) => void")] on_error: Function,
    ) -> Result<Renderer, JsError> {
        console_error_panic_hook::set_once();
        let callbacks = Callbacks {
            on_lost: Arc::new(move |reason, message| {
                call_later(&on_lost, Array::of2(&reason.into(), &message.into()));
            }),
            on_error: Arc::new(move |message| call_later(&on_error, Array::of1(&message.into()))),
        };
        let target = wgpu::SurfaceTarget::Canvas(canvas.clone());
        let (screen, inner) = Screen::open(target, callbacks).await?;
        let (screen, inner) = (RefCell::new(screen), Rc::new(RefCell::new(inner)));
        // wgpu does not see a lost WebGL context. The default action would forbid restoring it.
        let weak = Rc::downgrade(&inner);
        let on_context_lost = Closure::new(move |event: web_sys::Event| {
            event.prevent_default();
            if let Some(inner) = weak.upgrade()
                && let Ok(inner) = inner.try_borrow()
            {
                inner.mark_lost("unknown", "the WebGL context was lost");
            }
        });
        canvas
            .add_event_listener_with_callback("webglcontextlost", on_context_lost.as_ref().unchecked_ref())
            .map_err(|_| JsError::new("the canvas takes no event listener"))?;
        Ok(Self { inner, screen, scratch: RefCell::default(), canvas, on_context_lost })
    }

    /// "webgpu" or "webgl2".
    pub fn backend(&self) -> String {
        self.inner.borrow().backend().to_owned()
    }

    /// Name of the graphics adapter according to the driver; may be empty, since browsers hide it.
    pub fn adapter(&self) -> String {
        self.inner.borrow().adapter().to_owned()
    }

    /// Largest number of particles that `write` takes.
    pub fn max_particles(&self) -> u32 {
        MOST_RECORDS
    }

    /// Sets the canvas's size in pixels. Beyond the device's limit it shrinks in proportion (read
    /// `canvas.width` after the next `draw`). If a side is 0 nothing is drawn.
    pub fn resize(&self, width_px: u32, height_px: u32) {
        self.inner.borrow_mut().resize([width_px, height_px]);
    }

    /// Appends or overwrites particles `first..first + radii.length`. The number of particles drawn
    /// grows to include them.
    ///
    /// `positions` and `normals` have three numbers per particle. A negative radius means a dot
    /// that faces the eye; the level 4294967295 means no level, and such a particle is always
    /// drawn; `colours` are 0xAABBGGRR, sRGB. The particles begin to appear at `birth_s` on the
    /// clock of `draw`; -Infinity shows them at once.
    ///
    /// # Errors
    ///
    /// Throws if the columns differ in length or there are more particles than `max_particles()`.
    #[allow(clippy::too_many_arguments, reason = "JavaScript hands over one typed array for each column")]
    pub fn write(
        &self,
        first: u32,
        positions: &Float32Array,
        normals: &Float32Array,
        radii: &Float32Array,
        levels: &Uint32Array,
        colours: &Uint32Array,
        birth_s: f64,
    ) -> Result<(), JsError> {
        let count = radii.length();
        check_columns(count, positions, normals, levels, colours)?;
        check_end(first, count, "particles")?;
        let mut inner = self.inner.borrow_mut();
        let mut scratch = self.scratch.borrow_mut();
        for from in (0..count).step_by(SLICE as usize) {
            let to = count.min(from + SLICE);
            copy(&positions.subarray(3 * from, 3 * to), &mut scratch.positions);
            copy(&normals.subarray(3 * from, 3 * to), &mut scratch.normals);
            copy(&radii.subarray(from, to), &mut scratch.radii);
            copy_words(&levels.subarray(from, to), &mut scratch.levels);
            copy_words(&colours.subarray(from, to), &mut scratch.colours);
            inner.write(first + from, scratch.columns(), birth_s);
        }
        Ok(())
    }

    /// Changes the colours of particles from `first` on.
    ///
    /// # Errors
    ///
    /// Throws if there are more particles than `max_particles()`.
    pub fn write_colours(&self, first: u32, colours: &Uint32Array) -> Result<(), JsError> {
        let count = colours.length();
        check_end(first, count, "particles")?;
        let mut inner = self.inner.borrow_mut();
        let mut scratch = self.scratch.borrow_mut();
        for from in (0..count).step_by(SLICE as usize) {
            let to = count.min(from + SLICE);
            copy_words(&colours.subarray(from, to), &mut scratch.colours);
            inner.write_colours(first + from, &scratch.colours);
        }
        Ok(())
    }

    /// Sets how many particles are drawn, and how many form the body beneath them. The body is
    /// fainter where its particles are not drawn.
    pub fn set_count(&self, count: u32, body: u32) {
        self.inner.borrow_mut().set_count(count, body);
    }

    /// Largest number of faces that `write_faces` takes.
    pub fn max_faces(&self) -> u32 {
        MOST_RECORDS
    }

    /// Writes faces from `first` on. Each face has three corners, counter-clockwise seen from
    /// outside, with the data of a particle in `write`. `marks` are the colours of marks on the
    /// corners, 0 for none. Pass some ten thousand faces at a time.
    ///
    /// # Errors
    ///
    /// Throws if the columns differ in length or there are more faces than `max_faces()`.
    #[allow(clippy::too_many_arguments, reason = "JavaScript hands over one typed array for each column")]
    pub fn write_faces(
        &self,
        first: u32,
        positions: &Float32Array,
        normals: &Float32Array,
        radii: &Float32Array,
        levels: &Uint32Array,
        colours: &Uint32Array,
        marks: &Uint32Array,
    ) -> Result<(), JsError> {
        let count = radii.length();
        check_columns(count, positions, normals, levels, colours)?;
        check_corners(first, count, marks)?;
        let mut scratch = self.scratch.borrow_mut();
        copy(positions, &mut scratch.positions);
        copy(normals, &mut scratch.normals);
        copy(radii, &mut scratch.radii);
        copy_words(levels, &mut scratch.levels);
        copy_words(colours, &mut scratch.colours);
        copy_words(marks, &mut scratch.marks);
        self.inner.borrow_mut().write_faces(first, scratch.columns(), &scratch.marks);
        Ok(())
    }

    /// Changes the colours of faces from `first` on and of their marks, three each.
    ///
    /// # Errors
    ///
    /// As for `write_faces`.
    pub fn tint_faces(&self, first: u32, colours: &Uint32Array, marks: &Uint32Array) -> Result<(), JsError> {
        check_corners(first, colours.length(), marks)?;
        let mut scratch = self.scratch.borrow_mut();
        copy_words(colours, &mut scratch.colours);
        copy_words(marks, &mut scratch.marks);
        self.inner.borrow_mut().tint_faces(first, &scratch.colours, &scratch.marks);
        Ok(())
    }

    /// Sets how many faces are drawn, if the style asks for faces, and how many particles they
    /// replace. Without faces discs are drawn.
    pub fn set_faces(&self, count: u32, particles: u32) {
        self.inner.borrow_mut().set_faces(count, particles);
    }

    /// Replaces the crease segments. `ends` has eight numbers for each, the position of both ends
    /// with the radius of the particle there; `colours` are 0xAABBGGRR, sRGB.
    ///
    /// # Errors
    ///
    /// Throws if the columns differ in length or there are more segments than `max_particles()`.
    pub fn write_lines(&self, ends: &Float32Array, colours: &Uint32Array) -> Result<(), JsError> {
        let count = colours.length();
        check_end(0, count, "lines")?;
        if ends.length() != 8 * count {
            return Err(JsError::new(&format!("{} numbers of ends for {count} lines", ends.length())));
        }
        let mut scratch = self.scratch.borrow_mut();
        copy(ends, &mut scratch.positions);
        copy_words(colours, &mut scratch.colours);
        self.inner.borrow_mut().write_lines(&scratch.positions, &scratch.colours);
        Ok(())
    }

    /// Sets the camera: clip from world (16, column-major, depth 0 to 1), eye (3) and viewing
    /// direction (3) in world coordinates. Further numbers are ignored. The matrix tells whether
    /// the camera is orthographic.
    ///
    /// # Errors
    ///
    /// Throws for fewer than 22 numbers or a number that is not finite; the last camera stays.
    pub fn set_view(&self, view: &[f32]) -> Result<(), JsError> {
        self.inner.borrow_mut().set_view(View::from_slice(view)?);
        Ok(())
    }

    /// Sets the look from a JSON object. Missing keys take their defaults, unknown ones are
    /// ignored.
    ///
    /// `background` [r, g, b, a] · `faces` {flat, edge_px} or null for discs · `body` {colour,
    /// is_open, bounds: {min, max}} beneath them or null · `spheres` instead of discs ·
    /// `disc_scale` · `key_light_view` [x, y, z] · `dim` · `dim_backfaces` · `occlusion` · `warmth`
    /// · `fade_s` · `level` newest generation level drawn, null for all · `outline` index of the
    /// particle with a ring, negative for none · `box` {min, max, colour} or null · `plane`
    /// {normal, offset}, which hides the side of its normal, or null · `pixel_ratio`. Meaning,
    /// units and defaults: `render::style::Style`.
    ///
    /// # Errors
    ///
    /// Throws for malformed JSON and for values of another type; the last style stays.
    pub fn set_style(&self, json: &str) -> Result<(), JsError> {
        let style = read_style(json)?;
        self.inner.borrow_mut().set_style(style);
        Ok(())
    }

    /// Draws one picture on the canvas. Returns "drawn", "skipped" (nothing to draw on now) or
    /// "lost" (create a new renderer).
    pub fn draw(&self, time_s: f64) -> String {
        match self.screen.borrow_mut().draw(&mut self.inner.borrow_mut(), time_s) {
            DrawOutcome::Drawn => "drawn",
            DrawOutcome::Skipped => "skipped",
            DrawOutcome::Lost => "lost",
        }
        .to_owned()
    }

    /// The `[width, height]` that `read_pixels` draws for a wanted size: the same size, unless the
    /// device cannot.
    pub fn picture_size(&self, width_px: u32, height_px: u32) -> Uint32Array {
        Uint32Array::from(self.inner.borrow().picture_size([width_px, height_px]).as_slice())
    }

    /// Draws the picture into a texture of `picture_size(width_px, height_px)`, with every particle
    /// fully shown. Resolves to its pixels: rows from top to bottom, red, green, blue, opacity (not
    /// premultiplied), sRGB. Rejects if the device is lost.
    #[wasm_bindgen(unchecked_return_type = "Promise<Uint8Array<ArrayBuffer>>")]
    #[expect(clippy::missing_panics_doc, reason = "it panics in no call that JavaScript could make")]
    pub fn read_pixels(&self, width_px: u32, height_px: u32, transparent: bool) -> Promise {
        let inner = Rc::clone(&self.inner);
        future_to_promise(async move {
            let lost = || JsError::new("the graphics device is lost");
            let picture = inner
                .borrow_mut()
                .picture([width_px, height_px], transparent, f64::INFINITY)
                .ok_or_else(lost)?;
            let is_mapped = Arc::new(OnceLock::new());
            picture.map({
                let is_mapped = Arc::clone(&is_mapped);
                move |ok| is_mapped.set(ok).expect("a picture is mapped once")
            });
            while is_mapped.get().is_none() {
                if inner.borrow().is_lost() {
                    return Err(lost().into());
                }
                inner.borrow().poll();
                let tick = Promise::new(&mut |resolve, _| set_timeout(&resolve, POLL_MS));
                JsFuture::from(tick).await?;
            }
            if is_mapped.get() == Some(&false) {
                return Err(lost().into());
            }
            let pixels = picture.pixels().ok_or_else(lost)?;
            Ok(Uint8Array::from(pixels.as_slice()).into())
        })
    }

    /// Releases the device and its memory; later calls do nothing. `on_lost` gets "destroyed".
    pub fn destroy(&self) {
        self.inner.borrow().destroy();
        if cfg!(feature = "webgl") {
            lose_context(&self.canvas);
        }
    }
}

impl Drop for Renderer {
    fn drop(&mut self) {
        // Fails only if the listener does not exist.
        let _ = self.canvas.remove_event_listener_with_callback(
            "webglcontextlost",
            self.on_context_lost.as_ref().unchecked_ref(),
        );
    }
}

/// Calls `callback` after the running JavaScript has returned: wgpu reports from within calls,
/// while the renderer is borrowed. Exceptions of the callback are ignored, since no caller could
/// receive them.
fn call_later(callback: &Function, arguments: Array) {
    let callback = callback.clone();
    spawn_local(async move {
        let _ = callback.apply(&JsValue::NULL, &arguments);
    });
}

/// Releases a canvas's WebGL context now. Browsers allow about sixteen, and would otherwise wait
/// for the garbage collector.
fn lose_context(canvas: &HtmlCanvasElement) {
    let lose = || -> Result<(), JsValue> {
        let context = canvas.get_context("webgl2")?.ok_or(JsValue::NULL)?;
        let method =
            |object: &JsValue, name: &str| Reflect::get(object, &name.into())?.dyn_into::<Function>();
        let extension = method(&context, "getExtension")?.call1(&context, &"WEBGL_lose_context".into())?;
        method(&extension, "loseContext")?.call0(&extension)?;
        Ok(())
    };
    // Without the extension, the garbage collector releases it.
    let _ = lose();
}

fn check_columns(
    count: u32,
    positions: &Float32Array,
    normals: &Float32Array,
    levels: &Uint32Array,
    colours: &Uint32Array,
) -> Result<(), JsError> {
    let lengths = [positions.length(), normals.length(), levels.length(), colours.length()];
    if lengths == [3 * count, 3 * count, count, count] {
        return Ok(());
    }
    let [positions, normals, levels, colours] = lengths;
    Err(JsError::new(&format!(
        "columns disagree: {positions} numbers of positions, {normals} of normals, {count} radii, {levels} levels, {colours} colours"
    )))
}

fn check_corners(first: u32, corners: u32, marks: &Uint32Array) -> Result<(), JsError> {
    if !corners.is_multiple_of(3) || marks.length() != corners {
        return Err(JsError::new(&format!("{corners} corners and {} marks are no faces", marks.length())));
    }
    check_end(first, corners / 3, "faces")
}

/// Refuses more records than a renderer can draw.
fn check_end(first: u32, count: u32, what: &str) -> Result<(), JsError> {
    let (end, most) = (u64::from(first) + u64::from(count), MOST_RECORDS);
    if end > u64::from(most) {
        return Err(JsError::new(&format!("{end} {what}, at most {most} are drawn")));
    }
    Ok(())
}

fn copy(from: &Float32Array, to: &mut Vec<f32>) {
    to.resize(from.length() as usize, 0.0);
    from.copy_to(to);
}

fn copy_words(from: &Uint32Array, to: &mut Vec<u32>) {
    to.resize(from.length() as usize, 0);
    from.copy_to(to);
}

/// Parses a style with the browser's JSON parser; another parser would be a tenth of the bundle.
fn read_style(json: &str) -> Result<Style, JsError> {
    let value = JSON::parse(json).map_err(|_| JsError::new("the style is not JSON"))?;
    let mut style = Style::default();
    read(&value, "background", &mut style.background)?;
    read(&value, "disc_scale", core::array::from_mut(&mut style.disc_scale))?;
    read(&value, "key_light_view", &mut style.key_light_view)?;
    read(&value, "dim", core::array::from_mut(&mut style.dim))?;
    read(&value, "dim_backfaces", core::array::from_mut(&mut style.dim_backfaces))?;
    read(&value, "occlusion", core::array::from_mut(&mut style.occlusion))?;
    read(&value, "warmth", core::array::from_mut(&mut style.warmth))?;
    read(&value, "fade_s", core::array::from_mut(&mut style.fade_s))?;
    read(&value, "pixel_ratio", core::array::from_mut(&mut style.pixel_ratio))?;
    let faces = get(&value, "faces")?;
    if faces.is_object() {
        let mut edge_px = 0.0;
        read(&faces, "edge_px", core::array::from_mut(&mut edge_px))?;
        let flat = get(&faces, "flat")?.is_truthy();
        style.drawing = Drawing::Faces { flat, edge_px };
    }
    let body = get(&value, "body")?;
    if body.is_object() {
        let mut read_body = BodyStyle { is_open: get(&body, "is_open")?.is_truthy(), ..BodyStyle::default() };
        read(&body, "colour", &mut read_body.colour)?;
        let bounds = get(&body, "bounds")?;
        if bounds.is_object() {
            read(&bounds, "min", &mut read_body.bounds[0])?;
            read(&bounds, "max", &mut read_body.bounds[1])?;
        }
        style.body = Some(read_body);
    }
    style.spheres = get(&value, "spheres")?.is_truthy();
    style.level = get(&value, "level")?.as_f64().map(|level| level as u32);
    if let Some(index) = get(&value, "outline")?.as_f64() {
        style.outline = (index >= 0.0).then_some(index as u32);
    }
    let clip_box = get(&value, "box")?;
    if clip_box.is_object() {
        let mut read_box = ClipBoxStyle::default();
        read(&clip_box, "min", &mut read_box.min)?;
        read(&clip_box, "max", &mut read_box.max)?;
        read(&clip_box, "colour", &mut read_box.colour)?;
        style.clip_box = Some(read_box);
    }
    let plane = get(&value, "plane")?;
    if plane.is_object() {
        let mut read_plane = CuttingPlane::default();
        read(&plane, "normal", &mut read_plane.normal)?;
        read(&plane, "offset", core::array::from_mut(&mut read_plane.offset))?;
        style.plane = Some(read_plane);
    }
    Ok(style)
}

/// Overwrites `numbers` by the value of `key`, if present: a number for one, an array of the same
/// length for several.
fn read(object: &JsValue, key: &str, numbers: &mut [f32]) -> Result<(), JsError> {
    let value = get(object, key)?;
    if value.is_undefined() {
        return Ok(());
    }
    let array = if Array::is_array(&value) { Array::from(&value) } else { Array::of1(&value) };
    let wrong = || JsError::new(&format!("the style's `{key}` is not of the right type"));
    if array.length() as usize != numbers.len() {
        return Err(wrong());
    }
    for (number, value) in numbers.iter_mut().zip(array.iter()) {
        *number = value.as_f64().ok_or_else(wrong)? as f32;
    }
    Ok(())
}

fn get(object: &JsValue, key: &str) -> Result<JsValue, JsError> {
    Reflect::get(object, &key.into()).map_err(|_| JsError::new("the style is not an object"))
}
