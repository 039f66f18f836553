//! What is written when.

use super::log::{Cell, Log};
use super::restart::Schedule;
use super::{Dump, LogColumn, Snapshot, number, plot};
use crate::fault::Fault;
use crate::model::checkpoint::Checkpoint;
use crate::plan::Plan;
use crate::script::formula::{Board, Formula, Instant, Slot};
use crate::timing::Timing;
use std::io::Write;
use std::path::PathBuf;
use std::time;

/// How much is shown and where the log goes.
pub struct OutputOptions {
    /// Nothing on the screen.
    pub quiet: bool,
    /// The log file.
    pub log: Option<PathBuf>,
    /// First line of the log: program, version, script.
    pub title: String,
    /// Another process writes all files.
    pub mute: bool,
}

struct DumpEntry {
    id: String,
    interval: u64,
    dump: Box<dyn Dump>,
    last: Option<u64>,
}

/// A curve of the figure.
struct Curve {
    id: String,
    interval: u64,
    x: (String, Formula),
    y: (String, Formula),
    points: Vec<[f64; 2]>,
    last: Option<u64>,
}

/// Files written of one pattern.
struct Written {
    name: String,
    count: u64,
}

/// All outputs of a simulation.
pub struct Outputs {
    log: Log,
    title: Option<String>,
    interval: u64,
    columns: Vec<LogColumn>,
    /// Step of the last row, unless the columns have changed since.
    last_row: Option<u64>,
    dumps: Vec<DumpEntry>,
    curves: Vec<Curve>,
    figure: Option<PathBuf>,
    /// When restart files are written.
    restart: Option<Schedule>,
    written: Vec<Written>,
    /// Start of the run and step number then.
    run: Option<(time::Instant, u64)>,
    whole: time::Instant,
    fault: Option<Fault>,
    /// Said in the middle of the run, for its end.
    warnings: Vec<String>,
    /// Another process writes all files.
    mute: bool,
}

impl Outputs {
    /// Outputs with a log and nothing else.
    pub fn new(options: OutputOptions) -> Self {
        Self {
            log: match options.mute {
                true => Log::new(None, false),
                false => Log::new(options.log, !options.quiet),
            },
            mute: options.mute,
            title: Some(options.title),
            interval: 1,
            columns: vec![LogColumn::Dt, LogColumn::Time],
            last_row: None,
            dumps: Vec::new(),
            curves: Vec::new(),
            figure: None,
            restart: None,
            written: Vec::new(),
            run: None,
            whole: time::Instant::now(),
            fault: None,
            warnings: Vec::new(),
        }
    }

    /// Outputs that write and show nothing, for runs from code.
    pub fn silent() -> Self {
        let title = String::new();
        let mut outputs = Self::new(OutputOptions { quiet: true, log: None, title, mute: false });
        outputs.interval = 0;
        outputs
    }

    /// A log row every so many steps; 0: first and last.
    pub fn set_log_interval(&mut self, interval: u64) {
        self.interval = interval;
    }

    /// The columns after `Step`.
    pub fn set_log_columns(&mut self, columns: Vec<LogColumn>) {
        self.columns = columns;
        self.last_row = None;
    }

    /// Adds a dump, or replaces the one of that ID in place.
    pub fn add_dump(&mut self, id: &str, interval: u64, dump: Box<dyn Dump>) {
        let entry = DumpEntry { id: id.to_string(), interval, dump, last: None };
        match self.dumps.iter_mut().find(|known| known.id == id) {
            Some(known) => *known = entry,
            None => self.dumps.push(entry),
        }
    }

    /// Ends a dump.
    pub fn delete_dump(&mut self, id: &str) {
        self.dumps.retain(|dump| dump.id != id);
    }

    /// Adds a curve to the figure.
    pub fn add_plot(
        &mut self,
        id: &str,
        interval: u64,
        x: (String, Formula),
        y: (String, Formula),
    ) {
        let (id, points) = (id.to_string(), Vec::new());
        self.curves.push(Curve { id, interval, x, y, points, last: None });
    }

    /// Names the file of the figure, which every end of a run writes anew.
    pub fn save_plot(&mut self, file: &str) {
        self.figure = Some(PathBuf::from(file));
    }

    /// Restart files every so many steps; 0: none.
    pub fn set_restart(&mut self, interval: u64, file: &str) {
        let schedule = Schedule { interval, file: file.to_string(), last: None };
        self.restart = (interval > 0).then_some(schedule);
    }

    /// The restart file that is due after a step.
    pub fn restart_due(&mut self, step: u64) -> Option<PathBuf> {
        let schedule = self.restart.as_mut().filter(|schedule| schedule.due(step))?;
        schedule.last = Some(step);
        Some(super::restart::path(&schedule.file, step))
    }

    /// The name of restart files, `*` for the step, if the script asks for some.
    pub fn restart_pattern(&self) -> Option<String> {
        self.restart.as_ref().map(|schedule| schedule.file.clone())
    }

    /// Notes a file among those written.
    pub fn note_file(&mut self, path: &std::path::Path, step: u64) {
        note(&mut self.written, pattern(path, step));
    }

    /// The log file, if there is one.
    pub fn log_path(&self) -> Option<&std::path::Path> {
        self.log.path().map(PathBuf::as_path)
    }

    /// The log goes on where the file ends.
    pub fn continue_log(&mut self) {
        self.log.continue_file();
    }

    /// Puts into a checkpoint, or takes from it, what has been written when.
    pub fn keep(&mut self, checkpoint: &mut Checkpoint) {
        checkpoint.option("last_row", &mut self.last_row);
        for entry in &mut self.dumps {
            checkpoint.within(&format!("dump/{}", entry.id), |inside| {
                inside.option("last", &mut entry.last);
                entry.dump.keep(inside);
            });
        }
        for curve in &mut self.curves {
            checkpoint.within(&format!("plot/{}", curve.id), |inside| {
                inside.option("last", &mut curve.last);
                inside.records("points", &mut curve.points);
            });
        }
        if let Some(schedule) = &mut self.restart {
            checkpoint.option("last_restart", &mut schedule.last);
        }
    }

    /// Does nobody see or keep the log?
    pub fn is_silent(&self) -> bool {
        self.log.is_silent() && !self.mute
    }

    /// A line on the screen and in the log.
    pub fn say(&mut self, line: &str) {
        let said = self.open().and_then(|()| self.log.line(line));
        // A statement that only talks cannot fail; the next row reports the file.
        self.fault = self.fault.take().or(said.err());
    }

    fn open(&mut self) -> Result<(), Fault> {
        match self.title.take() {
            Some(title) if !title.is_empty() => self.log.line(&title),
            _ => Ok(()),
        }
    }

    /// What the dumps need of the scene.
    pub fn needs(&self, plan: &mut Plan, dimension: usize) {
        self.dumps.iter().for_each(|entry| entry.dump.needs(plan, dimension));
    }

    /// Starts a run: summary, header.
    ///
    /// # Errors
    /// The log cannot be written.
    pub fn begin_run(
        &mut self,
        step: u64,
        summary: &[(&'static str, String)],
        steps: Option<u64>,
        megabytes: [f64; 3],
    ) -> Result<(), Fault> {
        if let Some(fault) = self.fault.take() {
            return Err(fault);
        }
        self.run = Some((time::Instant::now(), step));
        if self.log.is_silent() {
            return Ok(());
        }
        self.open()?;
        for (name, value) in summary {
            self.log.line(&format!("{name:<20}{value}"))?;
        }
        let [least, mean, most] = megabytes.map(number::brief);
        self.log.line(&format!(
            "Per MPI rank memory allocation (min/avg/max) = {least} | {mean} | {most} Mbytes"
        ))?;
        let name = |column: &LogColumn| match column {
            LogColumn::Dt => "dt".to_string(),
            LogColumn::Time => "Time".to_string(),
            LogColumn::DtLimit => "dt_limit".to_string(),
            LogColumn::Quantity { name, .. } => name.clone(),
        };
        let names: Vec<String> = self.columns.iter().map(name).collect();
        self.log.header(&names)?;
        self.log.start_progress(steps);
        Ok(())
    }

    /// Is a row of the log due after a step, whether the last of a run or not?
    pub fn row_is_due(&self, step: u64) -> bool {
        self.interval > 0 && step.is_multiple_of(self.interval)
    }

    /// Is anything due after this step?
    pub fn is_due(&self, step: u64, last: bool) -> bool {
        self.row_due(step, last)
            || self.dump_is_due(step)
            || self.curves.iter().any(|curve| curve.due(step, last))
            || self.restart.as_ref().is_some_and(|schedule| schedule.due(step))
    }

    /// Is a dump due after this step?
    pub fn dump_is_due(&self, step: u64) -> bool {
        self.dumps.iter().any(|entry| entry.due(step))
    }

    fn row_due(&self, step: u64, last: bool) -> bool {
        let first = self.run.is_some_and(|(_, start)| step == start);
        let regular = if self.interval == 0 { first } else { step.is_multiple_of(self.interval) };
        (regular || last) && self.last_row != Some(step)
    }

    /// Results that must be up to date before [`Outputs::write`].
    pub fn slots_due(&self, step: u64, last: bool) -> Vec<Slot> {
        let mut slots = Vec::new();
        if self.row_due(step, last) {
            for column in &self.columns {
                if let LogColumn::Quantity { formula, .. } = column {
                    slots.extend_from_slice(formula.slots());
                }
            }
        }
        for curve in self.curves.iter().filter(|curve| curve.due(step, last)) {
            slots.extend(curve.x.1.slots().iter().chain(curve.y.1.slots()));
        }
        slots.sort();
        slots.dedup();
        slots
    }

    /// Writes what is due.
    ///
    /// # Errors
    /// The first file that cannot be written.
    pub fn write(
        &mut self,
        snapshot: &Snapshot<'_>,
        board: &Board,
        now: &Instant,
        dt_limit: &str,
        last: bool,
    ) -> Result<(), Fault> {
        let step = snapshot.step;
        let mut result = Ok(());
        for entry in self.dumps.iter_mut().filter(|entry| entry.due(step)) {
            entry.last = Some(step);
            match entry.dump.write(snapshot) {
                Ok(names) => names.into_iter().for_each(|name| note(&mut self.written, name)),
                // The other processes know of no fault yet and go on.
                Err(fault) => result = result.and(Err(fault)),
            }
        }
        result?;
        for curve in self.curves.iter_mut().filter(|curve| curve.due(step, last)) {
            curve.points.push([curve.x.1.value(board, now), curve.y.1.value(board, now)]);
            curve.last = Some(step);
        }
        if self.row_due(step, last) {
            let cell = |column: &LogColumn| match column {
                LogColumn::Dt => Cell::Number(now.dt),
                LogColumn::Time => Cell::Number(now.time),
                LogColumn::DtLimit => Cell::Word(dt_limit.to_string()),
                LogColumn::Quantity { formula, .. } => Cell::Number(formula.value(board, now)),
            };
            let cells: Vec<Cell> =
                std::iter::once(Cell::Integer(step)).chain(self.columns.iter().map(cell)).collect();
            self.log.row(&cells)?;
            self.last_row = Some(step);
        }
        if let Some((_, start)) = self.run {
            self.log.progress(step - start);
        }
        Ok(())
    }

    /// A warning in the middle of a run: at once where errors go, and behind the run in the log.
    pub fn warn(&mut self, message: String) {
        self.log.end_progress();
        if !self.mute {
            // A reader that has gone away is no error of ours.
            let _ = writeln!(std::io::stderr(), "warning: {message}");
        }
        self.warnings.push(message);
    }

    /// Ends a run: loop time, speed, time by phase, warnings, figure. Between the rows of a table and its
    /// loop time stands nothing else, for readers of logs.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn end_run(
        &mut self,
        steps: u64,
        particles: usize,
        processes: usize,
        timing: &Timing,
        warnings: &[String],
    ) -> Result<(), Fault> {
        self.log.end_progress();
        let Some((start, _)) = self.run.take() else {
            return Ok(());
        };
        let seconds = start.elapsed().as_secs_f64();
        self.log.line(&format!(
            "Loop time of {} on {processes} procs for {steps} steps with {particles} particles",
            number::brief(seconds)
        ))?;
        if steps > 0 {
            let rate = steps as f64 / seconds;
            self.log.line(&format!(
                "Performance: {} steps/s, {} Mparticle-steps/s on {} threads",
                number::brief(rate),
                number::brief(1e-6 * rate * particles as f64),
                rayon::current_num_threads()
            ))?;
            self.log.line("Time by phase:")?;
            let all: f64 = timing.seconds().map(|(_, spent)| spent).sum();
            for (phase, spent) in timing.seconds().filter(|(_, spent)| *spent > 0.0) {
                self.log.line(&format!(
                    "  {phase:<16}{spent:>10.4} s {:>6.1} %",
                    100.0 * spent / all
                ))?;
            }
        }
        for warning in std::mem::take(&mut self.warnings).iter().chain(warnings) {
            self.log.line(&format!("warning: {warning}"))?;
        }
        self.write_figure()
    }

    /// The figure of all curves, anew at the end of every run.
    fn write_figure(&mut self) -> Result<(), Fault> {
        if self.curves.is_empty() || self.mute {
            return Ok(());
        }
        let path = self.figure.clone().unwrap_or_else(|| PathBuf::from("plot.pdf"));
        let curves: Vec<plot::Curve<'_>> = self
            .curves
            .iter()
            .map(|c| plot::Curve { name: &c.id, axes: [&c.x.0, &c.y.0], points: &c.points })
            .collect();
        plot::save(&path, &curves)?;
        note(&mut self.written, path.display().to_string());
        Ok(())
    }

    /// The end of the script: what was written, and the time it took.
    ///
    /// # Errors
    /// The log cannot be written.
    pub fn close(&mut self) -> Result<(), Fault> {
        self.log.end_progress();
        if let Some(fault) = self.fault.take() {
            return Err(fault);
        }
        for line in self.written() {
            self.log.line(&format!("wrote {line}"))?;
        }
        self.tell_how_to_open()?;
        let seconds = self.whole.elapsed().as_secs_f64();
        self.log.line(&format!("Total wall time: {} s", number::brief(seconds)))
    }

    /// Which program opens the series.
    fn tell_how_to_open(&mut self) -> Result<(), Fault> {
        let of_ovito = self.written.iter().any(|file| {
            let others = [".vtp", ".vti", ".png", ".svg", ".pdf", ".rst"];
            file.name.contains('*') && !others.iter().any(|suffix| file.name.ends_with(suffix))
        });
        if of_ovito {
            self.log.line("open the series of dumps in OVITO: Load File, any one of them")?;
        }
        let indices = self.written.iter().filter(|file| file.name.ends_with(".pvd"));
        let indices: Vec<String> = indices.map(|file| file.name.clone()).collect();
        if !indices.is_empty() {
            self.log.line(&format!("open in ParaView, with times: {}", indices.join(", ")))?;
        }
        Ok(())
    }

    /// Files written so far, by pattern, with their number.
    pub fn written(&self) -> Vec<String> {
        let log = self.log.path().map(|path| path.display().to_string());
        let files = self.written.iter().map(|file| match file.count {
            1 => file.name.clone(),
            count => format!("{} ({count} files)", file.name),
        });
        files.chain(log).collect()
    }
}

/// Counts a file under its name, in which `*` stands for the step.
fn note(written: &mut Vec<Written>, name: String) {
    match written.iter_mut().find(|known| known.name == name) {
        Some(known) => known.count += u64::from(name.contains('*')),
        None => written.push(Written { name, count: 1 }),
    }
}

/// The name of a file with `*` in the place of the step.
fn pattern(path: &std::path::Path, step: u64) -> String {
    let name = path.display().to_string();
    match name.rfind(&format!(".{step}.")) {
        Some(place) => {
            format!("{}.*{}", &name[..place], &name[place + 1 + step.to_string().len()..])
        }
        None => name,
    }
}

impl DumpEntry {
    fn due(&self, step: u64) -> bool {
        step.is_multiple_of(self.interval) && self.last != Some(step)
    }
}

impl Curve {
    fn due(&self, step: u64, last: bool) -> bool {
        (last || step.is_multiple_of(self.interval)) && self.last != Some(step)
    }
}
