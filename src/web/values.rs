//! Values that cross between Rust and JavaScript, as plain objects.
//!
//! Through JSON text the core would be larger by 61 kB (gzip) and not by 29: half of that would be
//! code and tables for decimal digits.

#[cfg(any(feature = "page-core", feature = "page-lesson"))]
use crate::session::{Fault, FaultKind};
use js_sys::Reflect;
use serde::Serialize;
use serde_wasm_bindgen::Serializer;
use wasm_bindgen::JsValue;

/// The value that a plain object describes, or the fault of this kind that it does not.
#[cfg(any(feature = "page-core", feature = "page-lesson"))]
pub(super) fn read<T: serde::de::DeserializeOwned>(value: JsValue, kind: FaultKind) -> Result<T, Fault> {
    serde_wasm_bindgen::from_value(value).map_err(|error| Fault::new(kind, &error))
}

/// The value as JSON would have it: structures and maps are objects, what is absent is null. A
/// number that is not finite stays what it is.
pub(super) fn to_js(value: &impl Serialize) -> JsValue {
    value.serialize(&Serializer::json_compatible()).expect("every value of the core has a form in JavaScript")
}

/// The answer to a command that can be refused: `{ok: true, …}` with the fields of the value, a
/// structure, or `{ok: false, error: …}`.
pub(super) fn answer<T: Serialize, E: Serialize>(result: Result<T, E>) -> JsValue {
    #[derive(Serialize)]
    struct Refused<E> {
        error: E,
    }
    let is_accepted = result.is_ok();
    let answer = result.map_or_else(|error| to_js(&Refused { error }), |value| to_js(&value));
    Reflect::set(&answer, &"ok".into(), &is_accepted.into()).expect("an object takes any property");
    answer
}
