//! Counts of the children that the particles of a front propose, by fate.

use crate::particles::SlotFate;

/// Number of children with each fate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct FateCounts {
    /// New particles, seeds not counted.
    pub added: u64,
    /// Slots where an existing particle sits.
    pub matched: u64,
    /// Children that met no surface on the circle.
    pub not_converged: u64,
    /// Children outside the clip box.
    pub outside: u64,
    /// Children at places where the field has no value or no gradient.
    pub undefined: u64,
    /// Children that were not placed because the limit on particles was reached.
    pub capped: u64,
}

impl FateCounts {
    pub(crate) fn count(&mut self, fate: SlotFate) {
        if let Some(count) = self.of(fate) {
            *count += 1;
        }
    }

    pub(crate) fn uncount(&mut self, fate: SlotFate) {
        if let Some(count) = self.of(fate) {
            *count -= 1;
        }
    }

    fn of(&mut self, fate: SlotFate) -> Option<&mut u64> {
        match fate {
            SlotFate::Added => Some(&mut self.added),
            SlotFate::Matched => Some(&mut self.matched),
            SlotFate::NotConverged => Some(&mut self.not_converged),
            SlotFate::Outside => Some(&mut self.outside),
            SlotFate::Undefined => Some(&mut self.undefined),
            SlotFate::Capped => Some(&mut self.capped),
            SlotFate::Open | SlotFate::Parent => None,
        }
    }
}
