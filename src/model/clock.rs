//! Time of a run.

use crate::script::formula::Instant;

/// Where a run stands.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Clock {
    /// Number of the step: 0 before the first one.
    pub step: u64,
    /// Time \[T\] at the start of the step.
    pub time: f64,
    /// Size of the step \[T\].
    pub dt: f64,
}

impl Clock {
    /// Time \[T\] at the end of the step.
    pub fn end(&self) -> f64 {
        self.time + self.dt
    }
}

impl Instant {
    /// The start of the current step.
    pub fn start(clock: &Clock) -> Self {
        Self { time: clock.time, dt: clock.dt, step: clock.step }
    }

    /// The end of the current step.
    pub fn end(clock: &Clock) -> Self {
        Self { time: clock.end(), dt: clock.dt, step: clock.step }
    }
}
