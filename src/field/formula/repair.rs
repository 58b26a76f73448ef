//! The correction of all mistakes of one kind at once.

use super::error::{FormulaError, Mended};
use super::{MAX_FORMULA_BYTES, syntax};

/// The error, with the formula in which all mistakes of its kind are corrected, if there are
/// several: suggestions are applied until there is none, or an error of another kind.
pub(super) fn throughout(text: &str, declared: &[&str], error: FormulaError) -> FormulaError {
    let mut mended = text.to_owned();
    let mut places = 0;
    let mut next = Some(error.clone());
    while let Some(present) = next.take() {
        let Some(suggestion) = correction(&present).filter(|_| is_same_kind(&present, &error)) else { break };
        mended.replace_range(present.span.clone(), suggestion);
        places += 1;
        // A formula has no more mistakes than bytes: a suggestion that leads to itself corrects
        // nothing.
        if places > text.len() || mended.len() > MAX_FORMULA_BYTES {
            return error;
        }
        next = syntax(&mended, declared).err();
    }
    let mended = (places > 1).then(|| Box::new(Mended { text: mended, places }));
    FormulaError { mended, ..error }
}

/// The suggestion, unless there is something left to fill in.
fn correction(error: &FormulaError) -> Option<&str> {
    error.suggestion.as_deref().filter(|suggestion| !suggestion.contains('…'))
}

/// Whether two errors have the same kind and message, up to numbers and quoted text.
fn is_same_kind(a: &FormulaError, b: &FormulaError) -> bool {
    let words = |error: &FormulaError| -> String {
        let unquoted = error.message.split('`').step_by(2).flat_map(str::chars);
        unquoted.filter(|c| !c.is_ascii_digit()).collect()
    };
    a.kind == b.kind && words(a) == words(b)
}
