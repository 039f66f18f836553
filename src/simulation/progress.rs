//! Where a run stands, so that the next one can go on with it.
//!
//! A run that begins where the last one ended, with nothing changed in between, is the same run: no
//! sort, no first time step, no start of time. So a restart file written between two runs is worth
//! as much as one written within a run.

use super::Simulation;
use crate::model::checkpoint::Checkpoint;

/// A rest of the run shorter than this part of dt joins the step before it.
pub(super) const JOINED: f64 = 1e-9;

/// Where a run stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Progress {
    /// With a constant dt, time is `start` + `steps` dt.
    pub start: f64,
    /// Steps since `start`.
    pub steps: u64,
    /// Size of the last step before it was shortened; it bounds the growth of the next one.
    pub previous: Option<f64>,
    /// Where the run ends \[T\], if it is one for a time.
    pub end: f64,
    /// Steps that the command has done.
    pub done: u64,
    /// The command has come to its end.
    pub finished: bool,
}

impl Progress {
    /// A run that begins.
    pub fn new(time: f64) -> Self {
        Self { start: time, steps: 0, previous: None, end: f64::INFINITY, done: 0, finished: false }
    }

    /// Where a run for so much more time ends. One that was cut short for a restart ends where it
    /// would have, to the bit, if the rest of its time is given.
    pub fn end_after(&self, now: f64, length: f64, dt: f64) -> f64 {
        let end = now + length;
        let rest_of_run = !self.finished && (end - self.end).abs() <= JOINED * dt;
        if rest_of_run { self.end } else { end }
    }

    /// Puts it into a checkpoint, or takes it from there.
    pub fn keep(progress: &mut Option<Self>, checkpoint: &mut Checkpoint) {
        let mut there = progress.is_some();
        checkpoint.flag("there", &mut there);
        if !there {
            *progress = None;
            return;
        }
        let one = progress.get_or_insert_with(|| Self::new(0.0));
        checkpoint.number("start", &mut one.start);
        checkpoint.number("steps", &mut one.steps);
        checkpoint.option("previous", &mut one.previous);
        checkpoint.number("end", &mut one.end);
        checkpoint.number("done", &mut one.done);
        checkpoint.flag("finished", &mut one.finished);
    }
}

impl Simulation {
    /// Something has changed: the next run starts anew, with a sort and a first time step.
    pub fn disturb(&mut self) {
        self.progress = None;
    }

    /// Does the next run go on with the last one? Not if something has been defined since that needs
    /// more of particles or nodes than they have.
    pub fn goes_on_with_last_run(&self) -> bool {
        let mut plan = self.make_plan();
        plan.external_force |= self.captured.reads_external();
        self.progress.is_some() && plan == self.plan && self.captured.covers(&self.quantities)
    }

    /// Was the state in a checkpoint written before the end of a run?
    pub fn was_unfinished(checkpoint: &mut Checkpoint) -> bool {
        let mut progress = None;
        checkpoint.within("run", |inside| Progress::keep(&mut progress, inside));
        progress.is_some_and(|progress| !progress.finished)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rest_of_a_run_ends_where_the_run_would_have() {
        let end = 0.1 + 0.2;
        let cut = Progress { end, ..Progress::new(0.0) };
        // 0.3 is another number than 0.1 + 0.2.
        assert_eq!(cut.end_after(0.0, 0.3, 1e-3), end);
        assert_eq!(cut.end_after(0.0, 0.4, 1e-3), 0.4);
        assert_eq!(Progress { finished: true, ..cut }.end_after(0.0, 0.3, 1e-3), 0.3);
    }
}
