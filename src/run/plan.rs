//! One progress figure for a whole call: a run, and what its caller does with it afterwards.

use super::Measured;
use crate::sampler::Method;

/// Cost of a run without its report, relative to measuring its particles once.
fn run_cost(method: Method) -> f64 {
    match method {
        Method::Front => 0.7,
        Method::Refined => 2.0,
    }
}

/// Cost of the mesh, relative to measuring the particles once. A refined run has made it already,
/// and measuring finds the neighbours that a front's mesh needs.
fn mesh_cost(method: Method, measured: Measured) -> f64 {
    match (method, measured) {
        (Method::Front, Measured::Nothing) => 0.3,
        _ => 0.1,
    }
}

/// Says whether the particles will be measured, and joined, once the run has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Plan {
    pub(super) measured: Measured,
    pub(super) is_joined: bool,
}

impl Default for Plan {
    fn default() -> Self {
        Self { measured: Measured::Nothing, is_joined: false }
    }
}

/// Shares of a call: the estimated time of each part, relative to the whole. Their sum is 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shares {
    pub(super) run: f64,
    pub(super) measuring: f64,
    pub(super) mesh: f64,
}

impl Plan {
    pub(super) fn shares(self, method: Method) -> Shares {
        let measuring = match self.measured {
            Measured::Nothing => 0.0,
            Measured::Particles => 1.0,
            Measured::FrontToo => 2.0,
        };
        let mesh = if self.is_joined { mesh_cost(method, self.measured) } else { 0.0 };
        let run = run_cost(method);
        let all = run + measuring + mesh;
        Shares { run: run / all, measuring: measuring / all, mesh: mesh / all }
    }
}
