//! What a run knows of the pieces of its field, and the field with that knowledge.

use super::evaluator::EdgedEvaluator;
use super::table::EdgeTable;
use crate::field::{Evaluator, Facts, Field, FieldError, Frame, Jet, MaybeSend, MaybeSync, Piecewise, Value};
use core::ops::Deref;
use glam::DVec3;
use std::sync::Arc;

/// The result of looking for the pieces of a field in a box.
#[derive(Clone)]
pub(crate) enum KnownPieces {
    /// The field tells its pieces itself. This copy of it has joined those that meet smoothly.
    Own(Arc<dyn Piecewise>),
    /// The edges were found in the values of the field.
    Edges(Arc<EdgeTable>),
}

impl KnownPieces {
    /// Returns the field to evaluate: `field`, or the copy of it that is known.
    pub(crate) fn of<'a>(
        known: Option<&'a Self>,
        field: &'a dyn Field,
    ) -> KnownField<&'a dyn Field, &'a EdgeTable> {
        match known {
            None => KnownField { field, table: None },
            Some(Self::Own(own)) => KnownField { field: &**own, table: None },
            Some(Self::Edges(table)) => KnownField { field, table: Some(table) },
        }
    }

    /// [`KnownPieces::of`], for a field that is shared.
    pub(crate) fn of_shared<'f>(known: Option<&Self>, field: &Arc<dyn Field + 'f>) -> Arc<dyn Field + 'f> {
        match known {
            None => Arc::clone(field),
            Some(Self::Own(own)) => Arc::<dyn Piecewise>::clone(own),
            Some(Self::Edges(table)) => {
                Arc::new(KnownField { field: Arc::clone(field), table: Some(Arc::clone(table)) })
            }
        }
    }
}

/// A field with the edges that were found in its values, if there are any.
#[derive(Clone, Copy)]
pub(crate) struct KnownField<F, T> {
    field: F,
    table: Option<T>,
}

impl<'a> KnownField<&'a dyn Field, &'a EdgeTable> {
    /// [`Field::evaluator`], for as long as the field and the table are borrowed.
    pub(crate) fn into_evaluator(self, frame: Frame) -> Box<dyn Evaluator + 'a> {
        match self.table {
            None => self.field.evaluator(frame),
            Some(table) => Box::new(EdgedEvaluator::new(self.field, table, frame)),
        }
    }
}

impl<F, T> Field for KnownField<F, T>
where
    F: Field,
    T: Deref<Target = EdgeTable> + MaybeSend + MaybeSync,
{
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
        let field: &dyn Field = &self.field;
        KnownField { field, table: self.table.as_deref() }.into_evaluator(frame)
    }

    fn facts(&self) -> Facts {
        let found = self.table.as_ref().map(|table| table.cells());
        let facts = self.field.facts();
        Facts { edge_cells: found.or(facts.edge_cells), ..facts }
    }

    fn calls(&self) -> Option<u64> {
        self.field.calls()
    }

    fn failure(&self) -> Option<FieldError> {
        self.field.failure()
    }

    fn columns(&self) -> Vec<(&'static str, Value)> {
        self.field.columns()
    }
}
