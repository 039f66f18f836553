//! Plays scripts in silence and reads the logs they write.

use karamelo::command::play::{perform, rehearse};
use karamelo::command::session::{Mode, Session, Stop};
use karamelo::output::{OutputOptions, Outputs};
use karamelo::script::diagnostic::{Diagnostic, Severity, render};
use karamelo::script::source::Source;
use std::path::Path;

/// A script that can be changed before it is played.
#[derive(Clone)]
pub struct Script {
    name: String,
    text: String,
}

/// Commands that run.
const RUNS: [&str; 4] = ["run", "run_time", "run_while", "run_until"];

/// Lines, those of a call that goes on over line ends as one.
fn statements(text: &str) -> Vec<String> {
    let (mut statements, mut open) = (Vec::<String>::new(), 0);
    for line in text.lines() {
        match (open, statements.last_mut()) {
            (1.., Some(last)) => {
                last.push('\n');
                last.push_str(line);
            }
            _ => statements.push(line.to_string()),
        }
        let mut quoted = false;
        for letter in line.chars() {
            match letter {
                '"' => quoted = !quoted,
                '#' if !quoted => break,
                '(' if !quoted => open += 1,
                ')' if !quoted => open -= 1,
                _ => {}
            }
        }
    }
    statements
}

/// The word before the parenthesis of a call.
fn command(statement: &str) -> &str {
    statement.split_once('(').map_or("", |(word, _)| word.trim())
}

/// What stands between the parentheses of a call.
fn argument(statement: &str) -> &str {
    let inside = statement.split_once('(').map_or("", |(_, rest)| rest);
    inside.rsplit_once(')').map_or(inside, |(argument, _)| argument)
}

/// The log of a script, and how the run ended.
pub struct Played {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
    /// The same rows as words, those with words among the numbers too.
    texts: Vec<Vec<String>>,
    /// What went wrong, in the words the user sees.
    pub end: Result<(), String>,
    /// The state at the end.
    pub session: Session,
}

impl Script {
    /// A script of its own.
    pub fn new(name: &str, text: &str) -> Self {
        Self { name: name.to_string(), text: text.to_string() }
    }

    /// A script of the folder `inputs`.
    pub fn input(name: &str) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs").join(name);
        Self { name: name.to_string(), text: std::fs::read_to_string(path).unwrap() }
    }

    /// Its file name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Puts something else in the place of words that stand in the script exactly once.
    pub fn replace(mut self, old: &str, new: &str) -> Self {
        let count = self.text.matches(old).count();
        assert_eq!(count, 1, "`{old}` stands {count} times in {}", self.name);
        self.text = self.text.replace(old, new);
        self
    }

    /// Puts another statement in the place of the only call that begins so.
    pub fn statement(self, beginning: &str, statement: &str) -> Self {
        let lines = self.text.lines().filter(|line| line.starts_with(beginning));
        let old: Vec<String> = lines.map(|line| format!("\n{line}\n")).collect();
        assert_eq!(old.len(), 1, "`{beginning}` begins {} lines of {}", old.len(), self.name);
        self.replace(&old[0], &format!("\n{statement}\n"))
    }

    /// Reads the energy ledger in every row of the log, in place of what it read before, and writes
    /// no dumps and no figures.
    pub fn with_ledger(&self) -> Self {
        let names = "kinetic stored plastic viscous damage friction damping heat external boundary \
                     numerical residual error";
        let columns: Vec<String> = names.split(' ').map(|name| format!("W_{name}")).collect();
        let mut wanted = format!("log_modify(custom, step, time, {})", columns.join(", "));
        if !self.text.contains("compute(W, energy_ledger,") {
            wanted = format!("compute(W, energy_ledger, all)\n{wanted}");
        }
        self.without_files().map(|statement| match command(statement) {
            "log_modify" => String::new(),
            word if RUNS.contains(&word) => std::mem::take(&mut wanted) + "\n" + statement,
            _ => statement.to_string(),
        })
    }

    /// Writes no dumps and no figures.
    pub fn without_files(&self) -> Self {
        self.map(|statement| match command(statement) {
            "dump" | "plot" | "save_plot" => String::new(),
            _ => statement.to_string(),
        })
    }

    /// Ends each run after so many steps, unless it ends before.
    pub fn at_most(&self, steps: u64) -> Self {
        let end = format!("value(timestep) + {steps}");
        self.map(|statement| {
            let (word, argument) = (command(statement), argument(statement));
            match word {
                "run" => format!("run(min({argument}, {steps}))"),
                "run_time" => {
                    format!("run_while(time < value(time) + ({argument}) && timestep < {end})")
                }
                "run_while" => format!("run_while(({argument}) && timestep < {end})"),
                "run_until" => format!("run_until(({argument}) || timestep >= {end})"),
                _ => statement.to_string(),
            }
        })
    }

    /// Number of runs.
    pub fn runs(&self) -> usize {
        statements(&self.text).iter().filter(|line| RUNS.contains(&command(line))).count()
    }

    /// Another statement in the place of each.
    fn map(&self, change: impl FnMut(&str) -> String) -> Self {
        let lines: Vec<String> =
            statements(&self.text).iter().map(String::as_str).map(change).collect();
        Self { name: self.name.clone(), text: lines.join("\n") + "\n" }
    }

    /// Plays the script without its dumps and plots; `variables` win over its assignments, as with
    /// `-var`.
    pub fn play(&self, variables: &[(&str, f64)]) -> Played {
        let text = self.without_files().text;
        let variables: Vec<(String, String)> =
            variables.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect();
        // Meshes lie beside the scripts of `inputs`.
        let place = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs").join(&self.name);
        let source = Source::new(place.display().to_string(), &text);
        let (script, found) = rehearse(source, &variables);
        let mistakes: Vec<Diagnostic> =
            found.into_iter().filter(|remark| remark.severity == Severity::Error).collect();
        assert!(mistakes.is_empty(), "{}", render(&mistakes, &script.source, false));
        let directory = tempfile::tempdir().unwrap();
        let log = directory.path().join("log.mpm");
        let title = self.name.clone();
        let options = OutputOptions { quiet: true, log: Some(log.clone()), title, mute: false };
        let mut session = Session::new(Outputs::new(options), Mode::Run);
        let end = perform(&script, &mut session).map_err(|stop| match stop {
            Stop::Fault(fault) => fault.to_string(),
            Stop::Script(mistakes) => render(&mistakes, &script.source, false),
            Stop::Interrupted => "interrupted".to_string(),
        });
        session.simulation.outputs.close().unwrap();
        let text = std::fs::read_to_string(log).unwrap();
        let names = text.lines().find(|line| line.trim_start().starts_with("Step "));
        let names: Vec<String> =
            names.unwrap_or("").split_whitespace().map(str::to_string).collect();
        let count = names.len();
        let numbers = |line: &str| {
            line.split_whitespace().map(|word| word.parse().ok()).collect::<Option<Vec<f64>>>()
        };
        // A word among the numbers, such as that of `dt_limit`, reads as not a number.
        let starts_with_number =
            |line: &&str| line.split_whitespace().next().is_some_and(|w| w.parse::<u64>().is_ok());
        let words = |line: &str| line.split_whitespace().map(str::to_string).collect();
        let texts = text.lines().filter(starts_with_number).map(words);
        let texts: Vec<Vec<String>> =
            texts.filter(|row: &Vec<String>| row.len() == count).collect();
        let mut rows: Vec<Vec<f64>> =
            text.lines().filter_map(numbers).filter(|row| !row.is_empty()).collect();
        if rows.is_empty() {
            let number = |word: &String| word.parse().unwrap_or(f64::NAN);
            rows = texts.iter().map(|row| row.iter().map(number).collect()).collect();
        }
        Played { names, rows, texts, end, session }
    }
}

impl Played {
    /// A column of the log in words.
    pub fn words(&self, name: &str) -> Vec<String> {
        let place = self.names.iter().position(|known| known == name).expect("the column is there");
        self.texts.iter().map(|row| row[place].clone()).collect()
    }

    /// A column of the log.
    pub fn column(&self, name: &str) -> Vec<f64> {
        let known = self.names.iter().position(|known| known == name);
        let place = known.unwrap_or_else(|| panic!("no column `{name}` in {:?}", self.names));
        self.rows.iter().map(|row| row[place]).collect()
    }
}
