//! Fields with what was found out about their pieces.

use super::evaluator::EdgedEvaluator;
use super::table::EdgeTable;
use crate::field::{Evaluator, Facts, Field, FieldError, Frame, Jet, Piecewise};
use glam::DVec3;
use std::sync::Arc;

/// What was found out about the pieces of a field in a box.
#[derive(Clone)]
pub(crate) enum KnownPieces {
    /// The field with its own pieces.
    Own(Arc<dyn Piecewise>),
    /// Edges found in its values.
    Edges(Arc<EdgeTable>),
}

impl KnownPieces {
    /// A field, with what is known of it.
    pub(crate) fn of<'a>(known: Option<&'a Self>, field: &'a dyn Field) -> KnownField<'a> {
        match known {
            None => KnownField { field, table: None },
            Some(Self::Own(own)) => KnownField { field: &**own, table: None },
            Some(Self::Edges(table)) => KnownField { field, table: Some(table) },
        }
    }

    /// [`KnownPieces::of`] of a field that is shared.
    pub(crate) fn of_shared(&self, field: impl FnOnce() -> Arc<dyn Field>) -> Arc<dyn Field> {
        match self {
            Self::Own(own) => Arc::<dyn Piecewise>::clone(own),
            Self::Edges(table) => Arc::new(EdgedField { field: field(), table: Arc::clone(table) }),
        }
    }
}

/// A field with what is known of its pieces.
#[derive(Clone, Copy)]
pub(crate) struct KnownField<'a> {
    field: &'a dyn Field,
    table: Option<&'a EdgeTable>,
}

impl<'a> KnownField<'a> {
    /// [`Field::evaluator`].
    pub(crate) fn at_work(self, frame: Frame) -> Box<dyn Evaluator + 'a> {
        match self.table {
            None => self.field.evaluator(frame),
            Some(table) => Box::new(EdgedEvaluator::new(self.field, table, frame)),
        }
    }
}

impl Field for KnownField<'_> {
    fn value_and_gradient(&self, p: DVec3) -> (f64, DVec3) {
        self.field.value_and_gradient(p)
    }

    fn value(&self, p: DVec3) -> f64 {
        self.field.value(p)
    }

    fn values(&self, points: &[DVec3], f: &mut [f64]) {
        self.field.values(points, f);
    }

    fn jet(&self, p: DVec3) -> Jet {
        self.field.jet(p)
    }

    fn evaluator(&self, frame: Frame) -> Box<dyn Evaluator + '_> {
        self.at_work(frame)
    }

    fn facts(&self) -> Facts {
        self.field.facts()
    }

    fn calls(&self) -> Option<u64> {
        self.field.calls()
    }

    fn failure(&self) -> Option<FieldError> {
        self.field.failure()
    }
}

/// A field with edges that were found in its values.
struct EdgedField {
    field: Arc<dyn Field>,
    table: Arc<EdgeTable>,
}

impl EdgedField {
    fn known(&self) -> KnownField<'_> {
        KnownField { field: &*self.field, table: Some(&self.table) }
    }
}

impl Field for EdgedField {
    fn value_and_gradient(&self, p: DVec3) -> (f64, DVec3) {
        self.field.value_and_gradient(p)
    }

    fn value(&self, p: DVec3) -> f64 {
        self.field.value(p)
    }

    fn values(&self, points: &[DVec3], f: &mut [f64]) {
        self.field.values(points, f);
    }

    fn jet(&self, p: DVec3) -> Jet {
        self.field.jet(p)
    }

    fn evaluator(&self, frame: Frame) -> Box<dyn Evaluator + '_> {
        self.known().at_work(frame)
    }

    fn facts(&self) -> Facts {
        self.field.facts()
    }

    fn calls(&self) -> Option<u64> {
        self.field.calls()
    }

    fn failure(&self) -> Option<FieldError> {
        self.field.failure()
    }
}
