//! Values that cross between Rust and JavaScript, as plain objects.
//!
//! Through JSON text the core would be larger by 61 kB (gzip) and not by 29: half of that would be
//! code and tables for decimal digits.
#![cfg(target_arch = "wasm32")]

use js_sys::Reflect;
use marching_particles::session::{Fault, FaultKind};
use serde::Serialize;
use serde_wasm_bindgen::Serializer;
use wasm_bindgen::JsValue;

/// The value that a plain object describes.
///
/// # Errors
///
/// The fault of this kind, if it describes none.
pub fn read<T: serde::de::DeserializeOwned>(value: JsValue, kind: FaultKind) -> Result<T, Fault> {
    serde_wasm_bindgen::from_value(value).map_err(|error| Fault::new(kind, &error))
}

/// The value as JSON would have it: structures and maps are objects, what is absent is null. A
/// number that is not finite stays what it is.
///
/// # Panics
///
/// If a map has keys that are no text: none that crosses has.
pub fn to_js(value: &impl Serialize) -> JsValue {
    value.serialize(&Serializer::json_compatible()).expect("every value of the core has a form in JavaScript")
}

/// The answer to a command that can be refused: `{ok: true, …}` with the fields of the value, a
/// structure, or `{ok: false, error: …}`.
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
    Reflect::set(&answer, &"ok".into(), &is_accepted.into()).expect("an object takes any property");
    answer
}
