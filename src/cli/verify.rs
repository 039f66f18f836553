//! `karamelo-rs verify`: the table of problems.

use super::{DONE, FILES, RUN_FAILED, WRONG, install_signals, show};
use crate::interrupt;
use crate::study::Stop;
use crate::verify::breaks::Break;
use crate::verify::{self, Verdict};
use clap::Args;
use std::time::Instant;

const HELP: &str = "\
Each line is a problem with a known answer: a closed form, energies that Karamelo printed with 17 digits,
or an independent model of the same equations. The error on the finest grid and the order between the
two finest must lie where they are expected. Ends with 1 if one does not.";

/// Words of `verify`.
#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub struct VerifyWords {
    /// The quick problems: less than a minute on two cores (default)
    #[arg(long, conflicts_with = "full")]
    quick: bool,
    /// All problems
    #[arg(long)]
    full: bool,
    /// Only problems whose names hold this text
    #[arg(long, value_name = "TEXT")]
    only: Option<String>,
    /// Runs at a time; as many as there are cores if not given
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// For tests of the tests: spoils the program on purpose (law, transfer, force, grid)
    #[arg(long = "break", value_name = "NAME", value_parser = spoilt, hide = true)]
    spoilt: Option<Break>,
}

fn spoilt(name: &str) -> Result<Break, String> {
    let known = Break::ALL.iter().find(|(known, _)| *known == name);
    let names = Break::ALL.map(|(name, _)| name).join(", ");
    known.map(|(_, spoilt)| *spoilt).ok_or_else(|| format!("one of {names}"))
}

/// Runs the problems and prints a line for each.
pub fn run(words: &VerifyWords) -> u8 {
    install_signals();
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let jobs = words.jobs.map_or(cores, usize::from);
    let wanted = |name: &str| words.only.as_deref().is_none_or(|text| name.contains(text));
    let parts: Vec<_> =
        verify::parts(words.full).into_iter().filter(|(p, _)| wanted(p.name)).collect();
    if parts.is_empty() {
        eprintln!("error: no problem has this text in its name");
        return WRONG;
    }
    let clock = Instant::now();
    let (count, mut failed) = (parts.len(), 0);
    let _ = show(Ok(head()));
    for (problem, part) in parts {
        match verify::run(problem, part, words.spoilt, jobs) {
            Ok(verdict) => {
                failed += usize::from(!verdict.passed);
                let _ = show(Ok(line(&verdict)));
            }
            Err(Stop::Interrupted) => return interrupt::exit_code_now(),
            Err(Stop::Files(reason) | Stop::Wrong(reason) | Stop::Failed(reason)) => {
                eprintln!("{reason}");
                return FILES;
            }
        }
    }
    let seconds = clock.elapsed().as_secs_f64();
    let _ = show(Ok(format!("{} of {count} pass in {seconds:.1} s\n", count - failed)));
    if failed == 0 { DONE } else { RUN_FAILED }
}

fn head() -> String {
    columns(&["", "error", "expected", "order", "expected", "s", "", "how"])
}

fn columns(words: &[&str; 8]) -> String {
    let [name, error, expected, order, expected_order, seconds, passed, how] = words;
    format!(
        "{name:<15}  {error:>9}  {expected:<19}  {order:>6}  {expected_order:<9}  {seconds:>5}  \
         {passed:<4}  {how}\n"
    )
}

fn line(verdict: &Verdict) -> String {
    let number = |value: f64, text: String| if value.is_finite() { text } else { "-".to_string() };
    let how = match &verdict.trouble {
        Some(reason) => format!("{}: {}", verdict.part, reason.replace('\n', " ")),
        None => verdict.part.clone(),
    };
    columns(&[
        verdict.problem,
        &number(verdict.error, format!("{:.3e}", verdict.error)),
        &verdict.expected,
        &number(verdict.order, format!("{:.2}", verdict.order)),
        &verdict.expected_order,
        &format!("{:.1}", verdict.seconds),
        if verdict.passed { "pass" } else { "FAIL" },
        &how,
    ])
}
