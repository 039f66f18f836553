//! `karamelo-rs verify`: exact problems that prove the program on the machine where it runs.
//!
//! Each part of a problem is a study over grids ([`crate::study`]); its error on the finest grid and
//! its order must lie where theory or an independent program puts them. A [`Break`] spoils the
//! program on purpose: then the problems must fail.

pub mod breaks;
pub mod problems;

use crate::study::child::Scratch;
use crate::study::log::Taken;
use crate::study::{self, Against, Cost, Measured, Request, State, Stop, Vary};
use breaks::Break;
use std::time::Instant;

/// Where the error on the finest grid must lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Gate {
    /// At a value, within this part of it.
    Near(f64, f64),
    /// Below a value.
    Below(f64),
    /// Anywhere: the order tells.
    Any,
}

impl Gate {
    fn holds(self, error: f64) -> bool {
        match self {
            Gate::Near(value, part) => (error / value - 1.0).abs() <= part,
            Gate::Below(limit) => error < limit,
            Gate::Any => error.is_finite(),
        }
    }

    fn text(self) -> String {
        match self {
            Gate::Near(value, part) => format!("{value:.3e} +- {:.1}%", 100.0 * part),
            Gate::Below(limit) => format!("< {limit:.2e}"),
            Gate::Any => "-".to_string(),
        }
    }
}

/// Which number of a run the error is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    /// The last one.
    Last,
    /// The highest one.
    Highest,
}

/// One way to compute a problem.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// Variables and settings, `NAME=VALUE`.
    pub settings: &'static [&'static str],
    /// What makes the grids finer, and its values from coarse to fine.
    pub grids: (&'static str, &'static [&'static str]),
    /// The expression that is measured.
    pub measure: &'static str,
    /// Which number of it.
    pub of: Of,
    /// Its exact value; 0 if it is an error itself.
    pub exact: f64,
    /// Where the error on the finest grid lies.
    pub gate: Gate,
    /// Where the order between the two finest grids lies.
    pub order: Option<[f64; 2]>,
    /// Only with `--full`.
    pub full: bool,
}

/// A problem with an exact answer.
#[derive(Clone, Copy, Debug)]
pub struct Problem {
    /// Its name in a word or two.
    pub name: &'static str,
    /// The script.
    pub script: &'static str,
    /// Words that stand in the script once, and what stands there instead.
    pub edits: &'static [(&'static str, &'static str)],
    /// Ways to compute it.
    pub parts: &'static [Part],
}

/// What came of a part.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// The problem.
    pub problem: &'static str,
    /// The settings and the grids.
    pub part: String,
    /// Error on the finest grid.
    pub error: f64,
    /// Where it must lie.
    pub expected: String,
    /// Order between the two finest grids.
    pub order: f64,
    /// Where it must lie.
    pub expected_order: String,
    /// Seconds by the clock.
    pub seconds: f64,
    /// Both lie where they must.
    pub passed: bool,
    /// Why there are no numbers.
    pub trouble: Option<String>,
}

/// Runs a part, spoilt or not.
///
/// # Errors
/// The user stopped it, or no process could be started.
pub fn run(
    problem: &Problem,
    part: &Part,
    spoilt: Option<Break>,
    jobs: usize,
) -> Result<Verdict, Stop> {
    let files = |reason: std::io::Error| Stop::Files(format!("error: {reason}"));
    let clock = Instant::now();
    let scratch = Scratch::new().map_err(files)?;
    let path = scratch.path().join("problem.mpm");
    let mut text = problem.script.to_string();
    for (old, new) in problem.edits {
        text = text.replacen(old, new, 1);
    }
    let mut settings: Vec<&str> = part.settings.to_vec();
    if let Some(spoilt) = spoilt {
        text = spoilt.spoil(&text);
        settings.extend(spoilt.settings());
    }
    std::fs::write(&path, text).map_err(files)?;
    let vary = |name: &str, values: &[&str]| Vary {
        name: name.to_string(),
        values: values.iter().map(|value| value.to_string()).collect(),
    };
    let fixed = settings.iter().filter_map(|setting| setting.split_once('='));
    let mut all: Vec<Vary> = vec![vary("dumps", &["off"])];
    for (name, value) in fixed {
        // A spoilt setting wins over that of the part.
        all.retain(|known| known.name != name);
        all.push(vary(name, &[value]));
    }
    all.push(vary(part.grids.0, part.grids.1));
    let request = Request {
        script: path,
        variables: Vec::new(),
        settings: Vec::new(),
        vary: all,
        error: Some(part.measure.to_string()),
        against: Some(Against::Exact(part.exact)),
        taken: if part.of == Of::Last { Taken::Last } else { Taken::Highest },
        repeat: 1,
        jobs,
        threads: 1,
        below: 1.0,
        cost: Cost::Cpu,
        csv: None,
        figure: None,
        results: None,
        again: false,
        quiet: true,
    };
    let ended = study::run(&request);
    let finest = match ended {
        Ok(study) => match study.cases.into_iter().next_back().map(|case| case.state) {
            Some(State::Done(measured)) => Ok(measured),
            Some(State::Failed(reason) | State::Refused(reason)) => Err(reason),
            _ => Err("it has not run".to_string()),
        },
        Err(Stop::Failed(reason) | Stop::Wrong(reason)) => Err(reason),
        Err(other) => return Err(other),
    };
    Ok(verdict(problem, part, finest, clock.elapsed().as_secs_f64()))
}

fn verdict(
    problem: &Problem,
    part: &Part,
    finest: Result<Measured, String>,
    seconds: f64,
) -> Verdict {
    let (name, values) = part.grids;
    let grids = format!("{name}={}", values.join(","));
    let words = part.settings.iter().filter(|setting| !setting.starts_with("set_output"));
    let words: Vec<&str> = words.copied().chain([grids.as_str()]).collect();
    let (measured, trouble) = match finest {
        Ok(measured) => (measured, None),
        Err(reason) => {
            let nothing = Measured { error: f64::NAN, order: f64::NAN, ..Measured::default() };
            (nothing, Some(reason))
        }
    };
    let in_order = part.order.is_none_or(|[low, high]| (low..=high).contains(&measured.order));
    Verdict {
        problem: problem.name,
        part: words.join(" "),
        error: measured.error,
        expected: part.gate.text(),
        order: measured.order,
        expected_order: match part.order {
            Some([low, high]) if low.is_finite() => format!("{low:.1}..{high:.1}"),
            Some([_, high]) => format!("< {high:.1}"),
            None => "-".to_string(),
        },
        seconds,
        passed: part.gate.holds(measured.error) && in_order,
        trouble,
    }
}

/// The parts of all problems, quick or full.
pub fn parts(full: bool) -> Vec<(&'static Problem, &'static Part)> {
    let all = problems::PROBLEMS.iter();
    let each = all.flat_map(|problem| problem.parts.iter().map(move |part| (problem, part)));
    each.filter(|(_, part)| full || !part.full).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gates_hold_within_their_limits_and_never_for_what_is_no_number() {
        assert!(Gate::Near(0.1, 0.01).holds(0.1009) && !Gate::Near(0.1, 0.01).holds(0.102));
        assert!(Gate::Below(0.1).holds(0.0) && !Gate::Below(0.1).holds(0.1));
        for gate in [Gate::Near(0.1, 0.5), Gate::Below(1.0), Gate::Any] {
            assert!(!gate.holds(f64::NAN), "{gate:?}");
        }
    }

    #[test]
    fn edits_stand_once_and_every_problem_has_a_quick_part() {
        for problem in problems::PROBLEMS {
            for (old, _) in problem.edits {
                assert_eq!(problem.script.matches(old).count(), 1, "{}: {old}", problem.name);
            }
            assert!(problem.parts.iter().any(|part| !part.full), "{}", problem.name);
        }
        assert!(parts(true).len() > parts(false).len());
    }
}
