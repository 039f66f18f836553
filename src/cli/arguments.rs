//! Words of the command line.

use super::study::StudyWords;
use super::verify::VerifyWords;
use crate::command::setting::Setting;
use clap::{Args, CommandFactory, Parser, Subcommand};
use std::ffi::OsString;
use std::path::PathBuf;

/// What to do.
#[derive(Debug)]
pub enum Task {
    /// Run a script.
    Run(Options),
    /// Check a script.
    Check(Options),
    /// Study what accuracy costs.
    Study(Box<StudyWords>),
    /// Prove the program.
    Verify(VerifyWords),
    /// Describe styles.
    Styles { family: Option<String>, name: Option<String> },
    /// Write the reference of the manual into a folder.
    Reference(PathBuf),
    /// Explain a code.
    Explain(String),
    /// Print a text.
    Text(String),
    /// Compare two runs.
    Diff(DiffWords),
    /// Write a script to start from.
    New(NewWords),
}

/// Two runs to compare.
#[derive(Debug, Args)]
pub struct DiffWords {
    /// A log, a dump, or the folder of a run
    #[arg(value_name = "RUN1")]
    pub first: PathBuf,
    /// The other one
    #[arg(value_name = "RUN2")]
    pub second: PathBuf,
    /// Numbers may differ by this part of the largest one of their column and snapshot
    #[arg(long, value_name = "PART", default_value_t = 0.0, value_parser = part)]
    pub tolerance: f64,
}

/// A part, 0 or more.
fn part(text: &str) -> Result<f64, String> {
    let part: f64 = text.parse().map_err(|_| "not a number".to_string())?;
    if part >= 0.0 { Ok(part) } else { Err("must be 0 or more".to_string()) }
}

/// A script to start from.
#[derive(Debug, Args)]
pub struct NewWords {
    /// Name of the script; `.mpm` is added
    pub name: PathBuf,
    /// What it shows
    #[arg(long, value_enum, default_value_t)]
    pub template: Template,
}

/// What a new script shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Template {
    /// An elastic block falls on a floor, in the plane, SI units
    #[default]
    Drop,
    /// A metal rod hits a wall and yields, in space, kg-mm-ms units
    Impact,
    /// A body in tension between clamps: stress against strain, total Lagrangian
    Tension,
}

/// How to run.
#[derive(Debug)]
pub struct Options {
    /// The whole command line.
    pub line: String,
    /// The script's file.
    pub script: PathBuf,
    /// `-var NAME VALUE`.
    pub variables: Vec<(String, String)>,
    /// `--set NAME=VALUE`.
    pub settings: Vec<Setting>,
    /// `--measure EXPRESSION`.
    pub measure: Option<String>,
    /// The log file; `None` for none.
    pub log: Option<PathBuf>,
    /// Show assignments.
    pub echo: bool,
    /// Number of threads.
    pub threads: Option<usize>,
    /// Nothing on the screen but errors.
    pub quiet: bool,
    /// Numbers of processes that a check is asked about.
    pub processes: Vec<usize>,
}

#[derive(Debug, Parser)]
#[command(
    name = "karamelo-rs",
    version,
    about = "Material point method simulator driven by Karamelo-style scripts",
    args_conflicts_with_subcommands = true,
    after_help = "Switches may be written with one dash: -in, -var, -log, -echo."
)]
struct CommandLine {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    run: Run,
}

#[derive(Debug, Args)]
struct Run {
    /// The script
    #[arg(value_name = "SCRIPT")]
    script: Option<PathBuf>,
    /// The script, as LAMMPS users write it
    #[arg(long = "in", value_name = "SCRIPT", conflicts_with = "script")]
    input: Option<PathBuf>,
    /// Sets a variable; assignments of the script are skipped
    #[arg(long = "var", num_args = 2, value_names = ["NAME", "VALUE"], action = clap::ArgAction::Append, allow_hyphen_values = true)]
    variables: Vec<String>,
    /// Puts other words in the place of those of the script: shape, transfer, scheme, cell, ...
    #[arg(long = "set", value_name = "NAME=VALUE", action = clap::ArgAction::Append, value_parser = Setting::parse)]
    settings: Vec<Setting>,
    /// Makes the log hold the time and this expression alone
    #[arg(long, value_name = "EXPRESSION")]
    measure: Option<String>,
    /// The log file, or none
    #[arg(long, value_name = "FILE|none", default_value = "log.mpm")]
    log: PathBuf,
    /// Shows assignments with their values
    #[arg(long)]
    echo: bool,
    /// Number of threads
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Shows errors and warnings only
    #[arg(long)]
    quiet: bool,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Checks a script and says what would run
    Check {
        #[command(flatten)]
        run: Run,
        /// Also tells what so many processes would get and send each other
        #[arg(long, value_name = "N,...", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..))]
        processes: Vec<u32>,
    },
    /// Runs a script over many settings: error against time
    Study(Box<StudyWords>),
    /// Prove the program.
    Verify(VerifyWords),
    /// Writes a commented script to start from; never over a file that is there
    New(NewWords),
    /// Tells where two runs part, in logs and dumps: exit code 0 if they are alike, 1 if not
    Diff(DiffWords),
    /// Describes the styles of the script language
    Styles {
        /// command, region, material, fix, compute, dump, ...
        family: Option<String>,
        /// A style of the family
        name: Option<String>,
        /// Writes all of them as pages of the manual into a folder
        #[arg(long, value_name = "FOLDER", conflicts_with = "family")]
        markdown: Option<PathBuf>,
    },
    /// Explains a code such as E0203
    Explain { code: String },
    /// Prints completions for a shell
    Completions { shell: clap_complete::Shell },
    /// Prints the man page
    Man,
}

/// Reads the command line; long switches may have one dash.
///
/// # Errors
/// What is wrong with it, or the help that was asked for.
pub fn parse(arguments: Vec<OsString>) -> Result<Task, clap::Error> {
    let words: Vec<String> =
        arguments.iter().map(|word| word.to_string_lossy().into_owned()).collect();
    let called = words.join(" ");
    let line = CommandLine::try_parse_from(arguments.into_iter().map(two_dashes))?;
    match line.command {
        None => Ok(Task::Run(options(line.run, called)?)),
        Some(Command::Check { run, processes }) => {
            let processes = processes.into_iter().map(|count| count as usize).collect();
            Ok(Task::Check(Options { processes, ..options(run, called)? }))
        }
        Some(Command::Study(words)) => Ok(Task::Study(words)),
        Some(Command::Verify(words)) => Ok(Task::Verify(words)),
        Some(Command::New(words)) => Ok(Task::New(words)),
        Some(Command::Diff(words)) => Ok(Task::Diff(words)),
        Some(Command::Styles { markdown: Some(folder), .. }) => Ok(Task::Reference(folder)),
        Some(Command::Styles { family, name, .. }) => Ok(Task::Styles { family, name }),
        Some(Command::Explain { code }) => Ok(Task::Explain(code)),
        Some(Command::Completions { shell }) => {
            let mut text = Vec::new();
            clap_complete::generate(shell, &mut CommandLine::command(), "karamelo-rs", &mut text);
            Ok(Task::Text(String::from_utf8_lossy(&text).into_owned()))
        }
        Some(Command::Man) => {
            let mut text = Vec::new();
            clap_mangen::Man::new(CommandLine::command()).render(&mut text)?;
            Ok(Task::Text(String::from_utf8_lossy(&text).into_owned()))
        }
    }
}

/// The help of the program and of each of its commands.
pub fn help() -> Vec<(String, String)> {
    let mut program = CommandLine::command();
    program.build();
    let mut texts = vec![("karamelo-rs".to_string(), program.render_long_help().to_string())];
    for command in program.get_subcommands_mut().filter(|command| command.get_name() != "help") {
        let name = format!("karamelo-rs {}", command.get_name());
        texts.push((name, command.render_long_help().to_string()));
    }
    texts
}

/// `-var` becomes `--var`; everything else stays.
fn two_dashes(argument: OsString) -> OsString {
    const LONG: [&str; 6] = ["-in", "-var", "-log", "-echo", "-threads", "-quiet"];
    match argument.to_str() {
        Some(word) if LONG.contains(&word) => format!("-{word}").into(),
        _ => argument,
    }
}

fn options(run: Run, line: String) -> Result<Options, clap::Error> {
    let Some(script) = run.script.or(run.input) else {
        let kind = clap::error::ErrorKind::MissingRequiredArgument;
        return Err(CommandLine::command().error(kind, "no script is given"));
    };
    let pairs = run.variables.chunks_exact(2);
    Ok(Options {
        line,
        script,
        variables: pairs.map(|pair| (pair[0].clone(), pair[1].clone())).collect(),
        settings: run.settings,
        measure: run.measure,
        log: (run.log.as_os_str() != "none").then_some(run.log),
        echo: run.echo,
        threads: run.threads.map(usize::from),
        quiet: run.quiet,
        processes: Vec::new(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(words: &[&str]) -> Task {
        let all = std::iter::once("karamelo-rs").chain(words.iter().copied());
        parse(all.map(OsString::from).collect()).unwrap()
    }

    #[test]
    fn lammps_switches_are_understood() {
        let Task::Run(options) =
            read(&["-in", "a.mpm", "-var", "N", "-3", "-var", "h", "2*L", "-log", "none"])
        else {
            panic!("not a run")
        };
        assert_eq!(options.script, PathBuf::from("a.mpm"));
        let expected = [("N", "-3"), ("h", "2*L")].map(|(n, v)| (n.to_string(), v.to_string()));
        assert_eq!(options.variables, expected);
        assert_eq!(options.log, None);
    }

    #[test]
    fn a_script_may_stand_first_or_after_check() {
        assert!(matches!(read(&["a.mpm", "--threads", "2"]), Task::Run(o) if o.threads == Some(2)));
        assert!(matches!(read(&["check", "a.mpm"]), Task::Check(_)));
    }

    #[test]
    fn the_definition_of_the_command_line_is_sound() {
        CommandLine::command().debug_assert();
    }
}
