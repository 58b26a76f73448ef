//! Solids that a program makes of several fields.

use super::Core;
use marching_particles::internal::session::{FaultKind, FieldRequest};
use marching_particles::{difference, intersection, offset, smooth_union, union};
use marching_particles_values::{answer, read};
use std::sync::Arc;
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

#[wasm_bindgen]
impl Core {
    /// Keeps the present field, for [`Core::combine`].
    pub fn keep(&mut self) {
        self.kept.push(self.session.field());
    }

    /// Replaces the `count` fields that were kept last by their combination. A smooth union has the
    /// width `by`, an offset that distance. A `difference` and a `smoothUnion` take two fields, an
    /// `offset` one.
    ///
    /// # Panics
    ///
    /// If there is no such combination of so many fields.
    pub fn combine(
        &mut self,
        #[wasm_bindgen(
            unchecked_param_type = "'union' | 'intersection' | 'difference' | 'smoothUnion' | 'offset'"
        )]
        how: &str,
        count: usize,
        by: f64,
    ) {
        let fields = self.kept.split_off(self.kept.len() - count);
        let combined = match (how, fields.as_slice()) {
            ("union", _) => union(fields),
            ("intersection", _) => intersection(fields),
            ("difference", [a, b]) => difference(Arc::clone(a), Arc::clone(b)),
            ("smoothUnion", [a, b]) => smooth_union(Arc::clone(a), Arc::clone(b), by),
            ("offset", [a]) => offset(Arc::clone(a), by),
            _ => panic!("`{how}` does not combine {count} fields"),
        };
        #[expect(clippy::arc_with_non_send_sync, reason = "a function of JavaScript is sent nowhere")]
        self.kept.push(Arc::new(combined));
    }

    /// Changes the field to the one that was kept last. Of the `FieldRequest` the box counts, and a
    /// formula with the field as an operand. Returns an `Answer` with `FieldAnswer`. After an error
    /// the last valid field stays.
    ///
    /// # Panics
    ///
    /// If no field was kept.
    #[wasm_bindgen(unchecked_return_type = "Answer<FieldAnswer, Fault>")]
    pub fn set_kept(
        &mut self,
        #[wasm_bindgen(unchecked_param_type = "Partial<FieldRequest>")] request: JsValue,
    ) -> JsValue {
        let field = self.kept.pop().expect("a field was kept");
        let request = read::<FieldRequest>(request, FaultKind::Request);
        answer(request.and_then(|request| self.session.set_model(field, &request)))
    }
}
