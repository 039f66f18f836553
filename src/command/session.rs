//! A script being performed.

use crate::fault::Fault;
use crate::model::domain::Domain;
use crate::output::Outputs;
use crate::script::diagnostic::{Code, Diagnostic, render};
use crate::script::formula::{Instant, Quantity};
use crate::script::scope::Measure;
use crate::script::source::{Source, Span};
use crate::simulation::Simulation;
use crate::time_step::TimeStep;
use std::io::IsTerminal;

/// Why a performance ends before its script does.
#[derive(Debug)]
pub enum Stop {
    /// A run or a file went wrong.
    Fault(Fault),
    /// Mistakes that only showed when a statement was reached.
    Script(Vec<Diagnostic>),
    /// The user asked for it.
    Interrupted,
}

impl From<Fault> for Stop {
    fn from(fault: Fault) -> Self {
        Stop::Fault(fault)
    }
}

/// What to do at `run`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Run.
    Run,
    /// Describe the run and go on without it.
    Check,
}

/// A set time step this much above the stable one is reported.
const TOLERATED: f64 = 1.0 + 1e-9;

/// A set time step this much above the stable one is refused.
const REFUSED: f64 = 2.0 + 1e-9;

/// The simulation a script builds and runs.
pub struct Session {
    /// The simulation; its box is empty until `dimension`.
    pub simulation: Simulation,
    /// What each slot of the board holds.
    pub quantities: Vec<Quantity>,
    /// Run or only check.
    pub mode: Mode,
    /// Warnings found while performing.
    pub warnings: Vec<Diagnostic>,
    /// The script, to show warnings in.
    pub source: Source,
    /// Show assignments.
    pub echo: bool,
    /// Numbers of processes that `check` is asked about.
    pub processes: Vec<usize>,
    /// Where `set_dt` stands.
    pub fixed_dt_span: Span,
    /// It stands there with `force`.
    pub fixed_dt_is_forced: bool,
    /// The next run is the rest of one that was stopped.
    pub finishes_run: bool,
}

impl Session {
    /// A session without a scene.
    pub fn new(outputs: Outputs, mode: Mode) -> Self {
        let nothing = Domain { dimension: 1, lower: [0.0; 3], upper: [0.0; 3], cell: 1.0 };
        Self {
            simulation: Simulation::new(nothing, outputs),
            quantities: Vec::new(),
            mode,
            warnings: Vec::new(),
            source: Source::default(),
            echo: false,
            processes: Vec::new(),
            fixed_dt_span: Span::default(),
            fixed_dt_is_forced: false,
            finishes_run: false,
        }
    }

    /// Compares a set time step with the stable one at the start of a run.
    ///
    /// # Errors
    /// It is more than twice as large, and was not forced.
    pub fn judge_fixed_step(&mut self, dt: f64, stable: TimeStep) -> Result<(), Stop> {
        let TimeStep { dt: limit, limit: binding } = stable;
        if dt <= TOLERATED * limit {
            return Ok(());
        }
        let (span, name) = (self.fixed_dt_span, binding.name());
        if dt > REFUSED * limit && !self.fixed_dt_is_forced {
            let message = format!(
                "the time step {dt} is above twice the stable one, {limit:.4e} ({name} limit)"
            );
            let refusal = Diagnostic::error(Code::Range, span, message)
                .label("the run would blow up")
                .help(format!("`set_dt(auto)` chooses; `set_dt({dt}, force)` runs all the same"));
            return Err(Stop::Script(vec![refusal]));
        }
        let message =
            format!("the time step {dt} is above the stable one, {limit:.4e} ({name} limit)");
        let warning = Diagnostic::warning(Code::UnstableStep, span, message);
        self.warnings.push(warning.label("the run may blow up"));
        Ok(())
    }

    /// Does this process speak to the user?
    pub fn speaks(&self) -> bool {
        self.simulation.world.ranks.is_first()
    }

    /// Shows an assignment, if asked to.
    pub fn show(&mut self, line: &str) {
        if self.echo {
            self.simulation.outputs.say(line);
        }
    }

    /// `print(e)`: the expression as written, and its value.
    pub fn print(&mut self, written: &str, value: Option<f64>) {
        let value = value.map_or_else(|| "a formula".to_string(), |value| format!("{value}"));
        self.simulation.outputs.say(&format!("{written} = {value}"));
    }

    /// Shows the warnings found since the last time.
    pub fn show_warnings(&mut self) {
        let warnings = std::mem::take(&mut self.warnings);
        if !warnings.is_empty() && self.speaks() {
            eprint!("{}", render(&warnings, &self.source, std::io::stderr().is_terminal()));
        }
    }
}

impl Measure for Session {
    fn measure(&mut self, quantity: &Quantity) -> f64 {
        let value = self.simulation.measure(quantity);
        self.simulation.history.note(value);
        value
    }

    fn now(&mut self) -> Instant {
        let clock = self.simulation.clock;
        for value in [clock.time, clock.dt, clock.step as f64] {
            self.simulation.history.note(value);
        }
        Instant { time: clock.time, dt: clock.dt, step: clock.step }
    }
}
