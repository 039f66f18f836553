//! The log, on the screen and in a file that LAMMPS tools read (language.md 8).

use super::file;
use super::number::{brief, text};
use crate::fault::Fault;
use indicatif::{ProgressBar, ProgressStyle};
use std::fs::File;
use std::io::{BufWriter, IsTerminal, Write};
use std::path::PathBuf;

/// One entry of a row.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// A whole number.
    Integer(u64),
    /// A number.
    Number(f64),
    /// A word.
    Word(String),
}

/// Width of a column in the file: the longest shortest f64 and a blank.
const FILE_WIDTH: usize = 25;

/// Width of a column on the screen.
const SCREEN_WIDTH: usize = 14;

/// Where the log goes.
pub struct Log {
    path: Option<PathBuf>,
    file: Option<BufWriter<File>>,
    /// The file is added to, not begun anew.
    goes_on: bool,
    screen: bool,
    progress: Option<ProgressBar>,
}

impl Log {
    /// A log in a file and, unless it is to be quiet, on the screen.
    pub fn new(path: Option<PathBuf>, screen: bool) -> Self {
        Self { path, file: None, goes_on: false, screen, progress: None }
    }

    /// The file is added to where it ends.
    pub fn continue_file(&mut self) {
        self.goes_on = true;
    }

    /// Does nobody see or keep the log?
    pub fn is_silent(&self) -> bool {
        !self.screen && self.path.is_none()
    }

    /// The file, if there is one.
    pub fn path(&self) -> Option<&PathBuf> {
        self.path.as_ref()
    }

    /// A line on the screen and in the file.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn line(&mut self, line: &str) -> Result<(), Fault> {
        self.show(line);
        self.store(line)
    }

    fn show(&mut self, line: &str) {
        if !self.screen {
            return;
        }
        match &self.progress {
            Some(bar) => bar.println(line),
            None => {
                // A reader that has gone away (`| head`) is no error of ours.
                let _ = writeln!(std::io::stdout(), "{line}");
            }
        }
    }

    fn store(&mut self, line: &str) -> Result<(), Fault> {
        let Some(path) = &self.path else {
            return Ok(());
        };
        if self.file.is_none() {
            file::append(path, b"", !self.goes_on)?;
            let opened = File::options().append(true).open(path);
            self.file = Some(BufWriter::new(opened.map_err(|reason| Fault::file(path, &reason))?));
        }
        let Some(file) = &mut self.file else {
            return Ok(());
        };
        let written = writeln!(file, "{line}").and_then(|()| file.flush());
        written.map_err(|reason| Fault::file(path, &reason))
    }

    /// The header of a run.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn header(&mut self, names: &[String]) -> Result<(), Fault> {
        let row = |width: usize| {
            let cells = names.iter().map(|name| format!("{name:>width$}"));
            let step = format!("{:>10}", "Step");
            std::iter::once(step).chain(cells).collect::<Vec<_>>().join(" ")
        };
        self.show(&row(SCREEN_WIDTH));
        // Readers look for `Step` as the first word of the line.
        self.store(&row(FILE_WIDTH))
    }

    /// A row, complete in the file when this returns.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn row(&mut self, cells: &[Cell]) -> Result<(), Fault> {
        let line = |number: &dyn Fn(f64) -> String, width: usize| {
            let cell = |(index, cell): (usize, &Cell)| {
                let words = match cell {
                    Cell::Integer(value) => value.to_string(),
                    Cell::Number(value) => number(*value),
                    Cell::Word(word) => word.clone(),
                };
                let width = if index == 0 { 10 } else { width };
                format!("{words:>width$}")
            };
            cells.iter().enumerate().map(cell).collect::<Vec<_>>().join(" ")
        };
        if self.screen {
            self.show(&line(&brief, SCREEN_WIDTH));
        }
        if self.path.is_some() { self.store(&line(&text, FILE_WIDTH)) } else { Ok(()) }
    }

    /// Starts the progress bar of a run, on a terminal only.
    pub fn start_progress(&mut self, steps: Option<u64>) {
        if !self.screen || !std::io::stderr().is_terminal() {
            return;
        }
        let style = "{wide_bar} {pos}/{len} steps, {elapsed} done, {eta} left";
        let bar = steps.map_or_else(ProgressBar::new_spinner, ProgressBar::new);
        if let Ok(style) = ProgressStyle::with_template(style) {
            bar.set_style(style);
        }
        self.progress = Some(bar);
    }

    /// Moves the progress bar.
    pub fn progress(&self, steps: u64) {
        if let Some(bar) = &self.progress {
            bar.set_position(steps);
        }
    }

    /// Takes the progress bar away.
    pub fn end_progress(&mut self) {
        if let Some(bar) = self.progress.take() {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_blank_separated_right_aligned_and_exact() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("log.mpm");
        let mut log = Log::new(Some(path.clone()), false);
        log.header(&["dt".to_string(), "dt_limit".to_string()]).unwrap();
        let third = 1.0 / 3.0;
        log.row(&[Cell::Integer(7), Cell::Number(third), Cell::Word("rate".to_string())]).unwrap();
        let text = std::fs::read_to_string(path).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        let words = |line: &str| line.split(' ').filter(|w| !w.is_empty()).count();
        assert_eq!(lines[0].len(), lines[1].len());
        assert!(lines[0].trim_start().starts_with("Step ") && words(lines[0]) == 3);
        let number = lines[1].split_whitespace().nth(1).unwrap();
        assert_eq!(number.parse::<f64>().unwrap(), third);
    }
}
