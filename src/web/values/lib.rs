//! Values that cross between Rust and JavaScript, as plain objects.
//!
//! With JSON text the core would grow by 61 kB (gzip) instead of 29: half of that would be code and
//! tables for decimal digits.
#![cfg(target_arch = "wasm32")]

use js_sys::{Object, Reflect};
use marching_particles::internal::session::{Fault, FaultKind};
use serde::Serialize;
use serde_wasm_bindgen::Serializer;
use wasm_bindgen::JsValue;

/// Converts a plain object to a value.
///
/// # Errors
///
/// A fault of this kind, if the object describes no such value.
pub fn read<T: serde::de::DeserializeOwned>(value: JsValue, kind: FaultKind) -> Result<T, Fault> {
    serde_wasm_bindgen::from_value(value).map_err(|error| Fault::new(kind, &error))
}

/// Converts a value as JSON would: structures and maps become objects, absent values null. Numbers
/// that are not finite are kept.
///
/// # Panics
///
/// If a map has keys that are not strings, which no value here has.
pub fn to_js(value: &impl Serialize) -> JsValue {
    value.serialize(&Serializer::json_compatible()).expect("every value of the core has a form in JavaScript")
}

/// The answer to a command that can be refused: `{ok: true, …}` with the fields of the value, a
/// structure or nothing, or `{ok: false, error: …}`.
///
/// # Panics
///
/// As [`to_js`].
pub fn answer<T: Serialize, E: Serialize>(result: Result<T, E>) -> JsValue {
    #[derive(Serialize)]
    struct Refused<E> {
        error: E,
    }
    let is_accepted = result.is_ok();
    let answer = result.map_or_else(|error| to_js(&Refused { error }), |value| to_js(&value));
    let answer = if answer.is_object() { answer } else { Object::new().into() };
    Reflect::set(&answer, &"ok".into(), &is_accepted.into()).expect("an object takes any property");
    answer
}
