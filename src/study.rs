//! What accuracy costs in time: a script over many settings.
//!
//! Every run is a process of its own, so that seconds and memory are those of the run alone. The
//! number that stands for a run is read from its log ([`log`]); the error is its distance from a
//! known value, from a reference run, or from the value that the grids extrapolate to ([`order`]).

pub mod child;
mod evaluate;
pub mod figure;
pub mod log;
pub mod order;
mod pace;
pub mod plan;
pub mod report;
pub mod results;
mod runner;

use crate::command::setting::Setting;
use child::Job;
use log::Taken;
use std::path::PathBuf;

/// A name and the values it takes.
#[derive(Clone, Debug, PartialEq)]
pub struct Vary {
    /// A variable of the script, a setting, or `threads`.
    pub name: String,
    /// Its values.
    pub values: Vec<String>,
}

/// What a run is compared with.
#[derive(Clone, Debug, PartialEq)]
pub enum Against {
    /// The measured value is the error itself.
    Nothing,
    /// A known value.
    Exact(f64),
    /// The same script with other settings.
    Run(Vec<(String, String)>),
    /// The value at h = 0 that the grids extrapolate to.
    Grids,
}

/// What the time axis of figure and answer is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cost {
    /// Seconds of all cores.
    Cpu,
    /// Seconds by the clock.
    Wall,
}

/// A study as asked for.
#[derive(Clone, Debug)]
pub struct Request {
    /// The script.
    pub script: PathBuf,
    /// `-var`.
    pub variables: Vec<(String, String)>,
    /// `--set`.
    pub settings: Vec<Setting>,
    /// What varies.
    pub vary: Vec<Vary>,
    /// The expression that is measured; `None`: the script's `check_solution`.
    pub error: Option<String>,
    /// What it is compared with; `None`: nothing for an error, the grids for anything else.
    pub against: Option<Against>,
    /// Which number is taken from a run.
    pub taken: Taken,
    /// So many runs of each setting.
    pub repeat: usize,
    /// So many at a time.
    pub jobs: usize,
    /// Threads of each run.
    pub threads: usize,
    /// The error that is good enough.
    pub below: f64,
    /// Seconds of what.
    pub cost: Cost,
    /// A table for other programs.
    pub csv: Option<PathBuf>,
    /// Error against seconds.
    pub figure: Option<PathBuf>,
    /// Where finished runs are kept.
    pub results: Option<PathBuf>,
    /// Run all again.
    pub again: bool,
    /// Says nothing while it runs.
    pub quiet: bool,
}

/// One combination of values.
#[derive(Clone, Debug)]
pub struct Case {
    /// A value for each name that varies.
    pub values: Vec<String>,
    /// How it is run.
    pub job: Job,
    /// Cell size \[L\]; NaN if no rehearsal told it.
    pub cell: f64,
    /// Warnings about it.
    pub warnings: Vec<String>,
    /// What came of it.
    pub state: State,
}

/// What came of a case.
#[derive(Clone, Debug, PartialEq)]
pub enum State {
    /// Not run: the script refuses the combination.
    Refused(String),
    /// The run went wrong.
    Failed(String),
    /// It has run.
    Done(Measured),
    /// It has not run yet.
    Waiting,
}

/// Numbers of a case.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measured {
    /// The number taken from it.
    pub value: f64,
    /// Its error.
    pub error: f64,
    /// Order from the next coarser grid to this one; NaN on the coarsest.
    pub order: f64,
    /// Seconds of all cores, median of the repeats.
    pub cpu: f64,
    /// Seconds by the clock, median of the repeats.
    pub wall: f64,
    /// (largest - smallest)/median of the seconds that count; 0 for one run.
    pub spread: f64,
    /// Largest memory in bytes.
    pub memory: f64,
    /// Steps.
    pub steps: f64,
    /// Particle-steps per second of the loop over steps.
    pub speed: f64,
    /// The error is larger than on the next coarser grid.
    pub worse: bool,
    /// Nothing else is faster and more accurate.
    pub pareto: bool,
}

/// A finished study.
#[derive(Clone, Debug)]
pub struct Study {
    /// Names that vary.
    pub names: Vec<String>,
    /// Which of them change the cell size.
    pub grids: Vec<bool>,
    /// All combinations, the last name fastest.
    pub cases: Vec<Case>,
    /// What is measured, in words.
    pub measure: String,
    /// What it is compared with, in words.
    pub reference: String,
    /// Warnings about all combinations.
    pub warnings: Vec<String>,
    /// Is a value relative to the exact one?
    pub relative: bool,
    /// Seconds of what.
    pub cost: Cost,
    /// The error that is good enough.
    pub below: f64,
}

/// Why a study ends without a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Stop {
    /// The script or the command line is wrong.
    Wrong(String),
    /// Files cannot be read or written.
    Files(String),
    /// No run came to its end.
    Failed(String),
    /// The user asked for it.
    Interrupted,
}

impl Study {
    /// Seconds that count.
    pub fn seconds(&self, measured: &Measured) -> f64 {
        match self.cost {
            Cost::Cpu => measured.cpu,
            Cost::Wall => measured.wall,
        }
    }

    /// Cases that have run.
    pub fn done(&self) -> impl Iterator<Item = (&Case, &Measured)> {
        self.cases.iter().filter_map(|case| match &case.state {
            State::Done(measured) => Some((case, measured)),
            _ => None,
        })
    }

    /// Numbers of the cases of each curve: all but the grid is the same; from coarse to fine.
    pub fn curves(&self) -> Vec<Vec<usize>> {
        let mut curves: Vec<(Vec<&str>, Vec<usize>)> = Vec::new();
        for (index, case) in self.cases.iter().enumerate() {
            if !matches!(case.state, State::Done(_)) {
                continue;
            }
            let key: Vec<&str> = case
                .values
                .iter()
                .zip(&self.grids)
                .filter_map(|(value, grid)| (!grid).then_some(value.as_str()))
                .collect();
            match curves.iter_mut().find(|(known, _)| *known == key) {
                Some((_, list)) => list.push(index),
                None => curves.push((key, vec![index])),
            }
        }
        let cell = |index: &usize| self.cases[*index].cell;
        for (_, list) in &mut curves {
            list.sort_by(|a, b| cell(b).total_cmp(&cell(a)));
        }
        curves.into_iter().map(|(_, list)| list).collect()
    }

    /// The names of a case with their values; with or without those that change the grid.
    pub fn label(&self, case: &Case, with_grid: bool) -> String {
        let each = self.names.iter().zip(&case.values).zip(&self.grids);
        let chosen = each.filter(|(_, grid)| with_grid || !**grid);
        chosen.map(|((name, value), _)| format!("{name}={value}")).collect::<Vec<_>>().join(" ")
    }

    /// What varies beside the grid.
    pub fn varied(&self) -> impl Iterator<Item = &str> {
        let names = self.names.iter().zip(&self.grids);
        names.filter(|(_, grid)| !**grid).map(|(name, _)| name.as_str())
    }

    /// The values of a case, less those of the grid.
    pub fn setting(&self, case: &Case) -> String {
        let values = case.values.iter().zip(&self.grids).filter(|(_, grid)| !**grid);
        values.map(|(value, _)| value.as_str()).collect::<Vec<_>>().join(" ")
    }

    /// The fastest case with an error below the limit.
    pub fn cheapest(&self) -> Option<(&Case, &Measured)> {
        let good = self.done().filter(|(_, measured)| measured.error < self.below);
        good.min_by(|a, b| self.seconds(a.1).total_cmp(&self.seconds(b.1)))
    }
}

/// Runs a study.
///
/// # Errors
/// Nothing could be run or compared, or the user stopped it.
pub fn run(request: &Request) -> Result<Study, Stop> {
    let mut plan = plan::make(request)?;
    runner::play_all(&mut plan, request)?;
    plan.evaluate(request)
}
