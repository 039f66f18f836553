//! `karamelo-rs study`: words of the command line, and what is printed.

use super::{DONE, FILES, RUN_FAILED, WRONG, install_signals, show};
use crate::command::setting::Setting;
use crate::fault::Fault;
use crate::interrupt;
use crate::output::file;
use crate::study::log::{self, Taken};
use crate::study::{self, Against, Cost, Request, Stop, Vary, figure, report};
use clap::{Args, ValueEnum};
use std::path::{Path, PathBuf};

const HELP: &str = "\
Runs a script over all combinations of values, each run a process of its own with its own folder (its
dumps and plots are not written unless `--set dumps=on`), and tells what each combination costs and
how wrong it is. NAME is a variable that the script assigns, `threads`, or a setting:
  method, transfer, alpha, shape   words of `method(...)`: --vary shape=linear,cubic-spline,R4
                                   --vary transfer=PIC,FLIP:0.99,XPIC:3
  cell, ppc                        of every solid: --vary cell=x1,x0.5 --vary ppc=1,2,3
  scheme, dt_factor, set_dt, stress_rate, anti_locking, thermal_blend, boundary, run, run_time
The script is not edited: `karamelo-rs SCRIPT --set shape=cubic-spline` shows one such run.

The error is that of the script's check_solution, or of --error EXPRESSION: its distance from --exact,
from a --reference, or from the value that three and more grids extrapolate to. Cells are compared by
their real size, whatever variable changes it. Seconds are CPU seconds of the whole process.

  karamelo-rs study inputs/manufactured-1d.mpm --vary shape=linear,cubic-spline --vary cells=8,16,32
  karamelo-rs study inputs/cantilever/cantilever.mpm --error tip_y --of lowest --exact -3.306 \\
      --vary shape=R4,gimp --vary cell=x1,x0.5";

/// Words of `study`.
#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub struct StudyWords {
    /// The script
    #[arg(value_name = "SCRIPT")]
    script: PathBuf,
    /// A variable, a setting or `threads` and the values it takes
    #[arg(long, value_name = "NAME=V1,V2,...", required = true, action = clap::ArgAction::Append, value_parser = vary)]
    vary: Vec<Vary>,
    /// Sets a variable for all runs
    #[arg(long = "var", num_args = 2, value_names = ["NAME", "VALUE"], action = clap::ArgAction::Append, allow_hyphen_values = true)]
    variables: Vec<String>,
    /// Sets words of the script for all runs
    #[arg(long = "set", value_name = "NAME=VALUE", action = clap::ArgAction::Append, value_parser = Setting::parse)]
    settings: Vec<Setting>,
    /// What is measured: an expression of the script's names
    #[arg(long, value_name = "EXPRESSION", allow_hyphen_values = true)]
    error: Option<String>,
    /// The exact value of it; errors are relative to it unless it is 0
    #[arg(long, value_name = "VALUE", allow_hyphen_values = true, conflicts_with = "reference")]
    exact: Option<f64>,
    /// A file of points `time value`, or settings NAME=VALUE[,NAME=VALUE...] of one more run
    #[arg(long, value_name = "FILE|SETTING")]
    reference: Option<String>,
    /// Which number stands for a run
    #[arg(long, value_name = "ROW", value_enum, default_value_t = Row::Last)]
    of: Row,
    /// So many runs of each combination: medians, and a mark where seconds vary by more than 10 %
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    repeat: u16,
    /// So many runs at a time; more than one disturbs the seconds
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    jobs: u16,
    /// Threads of each run
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    threads: u16,
    /// The error that is good enough: 1%, or 0.01
    #[arg(long, value_name = "ERROR", default_value = "1%", value_parser = part)]
    below: f64,
    /// Seconds of what
    #[arg(long, value_enum, default_value_t = Seconds::Cpu)]
    against: Seconds,
    /// Writes all numbers
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Draws error against seconds
    #[arg(long, value_name = "FILE.svg|png|pdf")]
    figure: Option<PathBuf>,
    /// Where finished runs are kept so that a study can go on; SCRIPT.study if not given
    #[arg(long, value_name = "FILE|none")]
    results: Option<PathBuf>,
    /// Runs all again, whatever is kept
    #[arg(long)]
    again: bool,
    /// Shows no progress
    #[arg(long)]
    quiet: bool,
}

/// Rows of a log that may stand for a run.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Row {
    /// The last one
    Last,
    /// The lowest value of all rows
    Lowest,
    /// The highest value of all rows
    Highest,
}

/// Kinds of seconds.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Seconds {
    /// Of all cores
    Cpu,
    /// By the clock
    Wall,
}

/// Reads `NAME=v1,v2,...`; commas in parentheses separate nothing.
fn vary(text: &str) -> Result<Vary, String> {
    let form = || format!("`{text}` is not NAME=VALUE,VALUE,...");
    let (name, list) = text.split_once('=').ok_or_else(form)?;
    let mut values = vec![String::new()];
    let mut open = 0;
    for letter in list.chars() {
        open += i32::from(letter == '(') - i32::from(letter == ')');
        match (letter, values.last_mut()) {
            (',', _) if open == 0 => values.push(String::new()),
            (letter, Some(last)) => last.push(letter),
            _ => {}
        }
    }
    let values: Vec<String> = values.iter().map(|value| value.trim().to_string()).collect();
    if name.trim().is_empty() || values.iter().any(String::is_empty) {
        return Err(form());
    }
    if let Some(twice) = (1..values.len()).find(|index| values[..*index].contains(&values[*index]))
    {
        return Err(format!("`{}` stands twice in `{text}`", values[twice]));
    }
    Ok(Vary { name: name.trim().to_string(), values })
}

/// Reads a part: `1%`, `1 %`, `0.01`.
fn part(text: &str) -> Result<f64, String> {
    let (number, unit) = match text.trim().strip_suffix('%') {
        Some(number) => (number, 0.01),
        None => (text, 1.0),
    };
    match number.trim().parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value * unit),
        _ => Err(format!("`{text}` is no positive number or percentage")),
    }
}

impl StudyWords {
    fn request(self) -> Result<Request, String> {
        let mut taken = match self.of {
            Row::Last => Taken::Last,
            Row::Lowest => Taken::Lowest,
            Row::Highest => Taken::Highest,
        };
        let mut against = self.exact.map(Against::Exact);
        if let Some(reference) = &self.reference {
            match reference.contains('=') && !Path::new(reference).exists() {
                true => against = Some(Against::Run(settings(reference)?)),
                false => {
                    taken = Taken::Curve(log::curve(Path::new(reference))?);
                    against = Some(Against::Nothing);
                }
            }
        }
        // Files cost seconds that are no part of the method.
        let mut all = self.settings;
        let varies = self.vary.iter().any(|vary| vary.name == "dumps");
        if !varies && !all.iter().any(|setting| setting.name == "dumps") {
            all.push(Setting { name: "dumps".to_string(), value: "off".to_string() });
        }
        let stem = self.script.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let results = self.results.unwrap_or_else(|| PathBuf::from(format!("{stem}.study")));
        Ok(Request {
            script: self.script,
            variables: self
                .variables
                .chunks_exact(2)
                .map(|p| (p[0].clone(), p[1].clone()))
                .collect(),
            settings: all,
            vary: self.vary,
            error: self.error,
            against,
            taken,
            repeat: usize::from(self.repeat),
            jobs: usize::from(self.jobs),
            threads: usize::from(self.threads),
            below: self.below,
            cost: match self.against {
                Seconds::Cpu => Cost::Cpu,
                Seconds::Wall => Cost::Wall,
            },
            csv: self.csv,
            figure: self.figure,
            results: (results.as_os_str() != "none").then_some(results),
            again: self.again,
            quiet: self.quiet,
        })
    }
}

/// Reads `NAME=VALUE,NAME=VALUE`.
fn settings(text: &str) -> Result<Vec<(String, String)>, String> {
    let pair = |word: &str| {
        let (name, value) = word.split_once('=')?;
        let both = [name, value].map(|half| half.trim().to_string());
        let [name, value] = both;
        (!name.is_empty() && !value.is_empty()).then_some((name, value))
    };
    text.split(',')
        .map(|word| pair(word).ok_or_else(|| format!("`{word}` is neither a file nor NAME=VALUE")))
        .collect()
}

/// Runs a study and prints its table.
pub fn run(words: StudyWords) -> u8 {
    let request = match words.request() {
        Ok(request) => request,
        Err(message) => {
            eprintln!("error: {message}");
            return WRONG;
        }
    };
    install_signals();
    match study::run(&request) {
        Ok(done) => finish(&done, &request),
        Err(Stop::Wrong(message)) => {
            eprintln!("{message}");
            WRONG
        }
        Err(Stop::Files(message)) => {
            eprintln!("{message}");
            FILES
        }
        Err(Stop::Failed(message)) => {
            eprintln!("{message}");
            RUN_FAILED
        }
        Err(Stop::Interrupted) => {
            match &request.results {
                Some(_) => eprintln!("stopped by the user; the same command goes on from here"),
                None => eprintln!("stopped by the user"),
            }
            interrupt::exit_code_now()
        }
    }
}

fn finish(done: &study::Study, request: &Request) -> u8 {
    let printed = show(Ok(report::text(done)));
    let title = request.script.file_name().unwrap_or_default().to_string_lossy();
    let csv = |path: &PathBuf| file::write_whole(path, report::csv(done).as_bytes());
    let draw = |path: &PathBuf| figure::save(path, done, &title);
    let written: [Result<Option<()>, Fault>; 2] =
        [request.csv.as_ref().map(csv).transpose(), request.figure.as_ref().map(draw).transpose()];
    for result in written {
        if let Err(fault) = result {
            eprintln!("error: {fault}");
            return FILES;
        }
    }
    if printed == DONE { DONE } else { printed }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_separated_by_commas_outside_of_parentheses() {
        let read = vary("dt = max(1, 2)*h,0.5").unwrap();
        assert_eq!(
            (read.name.as_str(), read.values.as_slice()),
            ("dt", ["max(1, 2)*h".to_string(), "0.5".to_string()].as_slice())
        );
        for wrong in ["shape", "=1,2", "n=1,,2", "n="] {
            assert!(vary(wrong).unwrap_err().contains("NAME=VALUE"), "{wrong}");
        }
        assert!(vary("n=1,2,1").unwrap_err().contains("twice"));
    }

    #[test]
    fn parts_are_numbers_or_percentages() {
        assert_eq!((part("1%"), part("0.5 %"), part("0.02")), (Ok(0.01), Ok(0.005), Ok(0.02)));
        assert!(part("-1%").is_err() && part("few").is_err());
    }

    #[test]
    fn a_reference_run_is_a_list_of_settings() {
        let pair = |a: &str, b: &str| (a.to_string(), b.to_string());
        assert_eq!(settings("n=64,shape=R4"), Ok(vec![pair("n", "64"), pair("shape", "R4")]));
        assert!(settings("n=64,shape").unwrap_err().contains("shape"));
    }
}
