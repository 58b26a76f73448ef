//! Allocation of registers to values: a register is free after the last use of its value.

/// The last use of a value that is a result of the program.
const NEVER: usize = usize::MAX;

/// Allocator of registers for the values of a straight-line program, whose steps are handled in their order.
pub(super) struct RegisterAllocator {
    /// Last step that uses each value, 0 for none.
    last_use: Vec<usize>,
    /// Register of each value.
    of: Vec<u32>,
    free: Vec<u32>,
    count: u32,
}

impl RegisterAllocator {
    /// No register yet for so many values. `uses` are the steps, in their order, with the values that each uses; `kept` are the values
    /// to be kept to the end.
    pub(super) fn new(
        values: usize,
        uses: impl Iterator<Item = (usize, u32)>,
        kept: impl Iterator<Item = u32>,
    ) -> Self {
        let mut last_use = vec![0; values];
        uses.for_each(|(step, value)| last_use[value as usize] = step);
        kept.for_each(|value| last_use[value as usize] = NEVER);
        Self { last_use, of: vec![0; values], free: Vec::new(), count: 0 }
    }

    /// Whether any step uses a value.
    pub(super) fn is_used(&self, value: u32) -> bool {
        self.last_use[value as usize] > 0
    }

    /// The register of a value.
    pub(super) fn of(&self, value: u32) -> u32 {
        self.of[value as usize]
    }

    /// Frees the registers of those `operands` that a step uses last.
    pub(super) fn free(&mut self, step: usize, operands: impl Iterator<Item = u32>) {
        for operand in operands.filter(|&operand| self.last_use[operand as usize] == step) {
            let register = self.of[operand as usize];
            if !self.free.contains(&register) {
                self.free.push(register);
            }
        }
    }

    /// Gives a value the lowest register that is free.
    pub(super) fn assign(&mut self, value: u32) -> u32 {
        let lowest = (0..self.free.len()).min_by_key(|&at| self.free[at]);
        let register = lowest.map(|at| self.free.swap_remove(at)).unwrap_or_else(|| {
            self.count += 1;
            self.count - 1
        });
        self.of[value as usize] = register;
        register
    }

    /// Number of registers that have been assigned.
    pub(super) fn count(&self) -> usize {
        self.count as usize
    }
}
