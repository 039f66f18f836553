//! Wall time by phase.

use std::time::{Duration, Instant};

/// Parts of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Mass, momentum and force to the nodes, where it is a loop of its own.
    PointsToGrid,
    /// Passes over the nodes.
    Grid,
    /// Velocities back to the particles, second mapping.
    GridToPoints,
    /// Velocity gradient, law, movement and P2G of the next step.
    Stress,
    /// Fixes.
    Fixes,
    /// Sorting.
    Sort,
    /// Log, dumps, pictures.
    Output,
}

/// Names of the phases, in order.
pub const PHASES: [&str; 7] = ["P2G", "grid", "G2P", "stress+P2G", "fixes", "sort", "output"];

/// A stopwatch with one hand per phase.
#[derive(Clone, Debug)]
pub struct Timing {
    spent: [Duration; PHASES.len()],
    last: Instant,
}

impl Default for Timing {
    fn default() -> Self {
        Self { spent: Default::default(), last: Instant::now() }
    }
}

impl Timing {
    /// Starts again from zero.
    pub fn restart(&mut self) {
        *self = Self::default();
    }

    /// Books the time since the last call on a phase.
    pub fn end(&mut self, phase: Phase) {
        let now = Instant::now();
        self.spent[phase as usize] += now - self.last;
        self.last = now;
    }

    /// Seconds by phase.
    pub fn seconds(&self) -> impl Iterator<Item = (&'static str, f64)> + '_ {
        PHASES.iter().zip(&self.spent).map(|(name, spent)| (*name, spent.as_secs_f64()))
    }
}
