//! A run that is watched goes back and tries again with a smaller step.
//!
//! `watch(on)` keeps a copy of the whole state in memory - what a restart file would hold - after every
//! output and every so many steps between. A fault that a smaller step can help
//! ([`FaultKind::Step`]) brings the last copy back; steps up to the time of the trouble are then at
//! most half as long as the one that failed. No output is written twice, since the copy is younger than the
//! last output. A run that cannot be helped ends with the last copy as a restart file, if `restart`
//! asked for such files.

use super::Simulation;
use super::progress::Progress;
use crate::fault::{Fault, FaultKind};
use crate::model::checkpoint::Checkpoint;
use crate::output::restart;
use crate::plan::Trouble;
use crate::script::history::History;
use crate::time_step::{Limit, TimeStep};
use crate::watch::{self, Growth};

/// What `watch` asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Watch {
    /// What counts as trouble.
    pub trouble: Trouble,
    /// Attempts from one copy.
    pub retries: u32,
    /// Steps from one copy to the next.
    pub interval: u64,
}

/// The last good state and what has become of it.
#[derive(Default)]
pub(super) struct Rescue {
    /// The state in memory and the step it was taken at.
    copy: Option<(Checkpoint, u64)>,
    /// Largest step size until `until` \[T\].
    cap: Option<f64>,
    /// When the step that failed would have ended \[T\].
    until: f64,
    /// Attempts since the last copy without a cap.
    tries: u32,
    /// Times in this run that a state was brought back.
    count: u64,
    growth: Growth,
}

impl Rescue {
    /// Puts it into a checkpoint, or takes it from there; copies stay where they are.
    pub fn keep(&mut self, checkpoint: &mut Checkpoint) {
        checkpoint.option("cap", &mut self.cap);
        checkpoint.number("until", &mut self.until);
        checkpoint.number("tries", &mut self.tries);
        checkpoint.number("count", &mut self.count);
        self.growth.keep(checkpoint);
    }

    /// A run begins to count.
    pub fn forget_count(&mut self) {
        self.count = 0;
    }
}

impl Simulation {
    /// The size of the coming step, if the last one was given up.
    pub(super) fn cap_step(&mut self, next: TimeStep) -> TimeStep {
        if self.clock.time >= self.rescue.until {
            self.rescue.cap = None;
        }
        match self.rescue.cap {
            Some(cap) if cap < next.dt => TimeStep { dt: cap, limit: Limit::Rescue },
            _ => next,
        }
    }

    /// Is the coming step shorter than `set_dt` says?
    pub(super) fn is_capped(&self) -> bool {
        self.rescue.cap.is_some()
    }

    /// Looks at the energy of all particles after a step.
    ///
    /// # Errors
    /// It grows without bound.
    pub(super) fn mind_energy(&mut self) -> Result<(), Fault> {
        if self.watch.is_none() {
            return Ok(());
        }
        let kinetic = self.loops.kinetic;
        match self.rescue.growth.runs_away(kinetic) {
            true => Err(watch::runs_away(&self.world, kinetic, &self.clock_of_last_step())),
            false => Ok(()),
        }
    }

    /// Keeps a copy of the state if one is due; `written`: an output has just been written.
    pub(super) fn keep_copy(&mut self, written: bool) {
        let Some(watch) = self.watch else {
            self.rescue.copy = None;
            return;
        };
        let age = self.rescue.copy.as_ref().map(|(_, step)| self.clock.step - step);
        if !written && age.is_some_and(|age| age < watch.interval) {
            return;
        }
        if self.rescue.cap.is_none() {
            self.rescue.tries = 0;
        }
        self.rescue.copy = Some((self.save_state(), self.clock.step));
    }

    /// Brings the last good state back after a fault.
    ///
    /// # Errors
    /// The fault, if a smaller step cannot help or has been tried often enough.
    pub(super) fn go_back(&mut self, fault: Fault) -> Result<Progress, Fault> {
        let Some(watch) = self.watch else { return Err(fault) };
        let helps = fault.kind == FaultKind::Step && self.rescue.tries < watch.retries;
        let failed = self.clock;
        let (tries, count) = (self.rescue.tries + 1, self.rescue.count + 1);
        let until = failed.end().max(self.rescue.until);
        let Some((copy, step)) = self.rescue.copy.take() else { return Err(fault) };
        self.forget_step();
        let back = self.for_all(&copy).and_then(|copy| self.restore(copy));
        if let Err(reason) = back {
            return Err(Fault::run(format!("the last good state does not come back: {reason}")));
        }
        if !helps {
            return Err(self.leave_copy(fault));
        }
        let cap = 0.5 * failed.dt;
        let (copy, growth) = (Some((copy, step)), Growth::default());
        self.rescue = Rescue { copy, cap: Some(cap), until, tries, count, growth };
        let message = format!(
            "{}: going on from step {step} with steps of at most {cap:.3e} until time {until:.6e} \
             (attempt {tries} of {})",
            fault.what, watch.retries
        );
        self.outputs.warn(message);
        self.progress.ok_or(fault)
    }

    /// A copy to load, in every process.
    fn for_all(&self, copy: &Checkpoint) -> Result<Checkpoint, String> {
        let ranks = &self.world.ranks;
        let Some(exchange) = ranks.exchange() else {
            return Checkpoint::loading(copy.entries().to_vec(), copy.data().to_vec());
        };
        let mut bytes = Vec::new();
        if ranks.is_first() {
            let summary = restart::Summary { step: 0, time: 0.0, solids: Vec::new() };
            bytes = restart::encode(&History::default(), &summary, copy);
        }
        exchange.broadcast(0, &mut bytes);
        restart::decode(&bytes).map(|saved| saved.checkpoint)
    }

    /// What the step under way has left beside the state.
    fn forget_step(&mut self) {
        self.loops.fault = None;
        self.world.contacts.ready = false;
        self.world.rigid.flagged = false;
        let grid = &mut self.world.grid;
        grid.external.fill([0.0; 4]);
        grid.displaced.fill([0.0; 4]);
        for couple in &mut grid.couples {
            (couple.drag, couple.slip) = ([0.0; 3], [0.0; 3]);
        }
    }

    /// Writes the last good state, which has just come back, where `restart` writes its files.
    fn leave_copy(&mut self, fault: Fault) -> Fault {
        let step = self.clock.step;
        let Some(pattern) = self.outputs.restart_pattern() else { return fault };
        let path = restart::path(&pattern, step);
        match self.write_restart(&path) {
            Ok(()) => {
                let name = path.display();
                let cause = fault.cause.clone().unwrap_or_default();
                fault.because(format!(
                    "{cause}; `{name}` holds the state of step {step}, the last good one"
                ))
            }
            Err(_) => fault,
        }
    }

    /// How often a state was brought back, for the end of the run.
    pub(super) fn rescues(&self) -> Option<String> {
        let count = self.rescue.count;
        (count > 0).then(|| {
            format!(
                "{count} times the run went back to an earlier state and took smaller steps (`watch`)"
            )
        })
    }
}
