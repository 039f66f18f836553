//! Restart files, and going on from them.
//!
//! A restart file holds the scripts that have led to it, as far as they were performed, and the state
//! ([`crate::simulation::Simulation::restore`]). Reading one performs the same statements with the
//! same command table, only without running and without output; numbers that they took from the
//! simulation then are taken from the file. Then the state follows.

use super::output::check_directory;
use super::scene::Scene;
use super::session::{Mode, Session, Stop};
use super::{Action, action, files, play};
use crate::fault::{Fault, FaultKind};
use crate::output::restart::{self, Saved};
use crate::script::arguments::Args;
use crate::script::diagnostic::{Code, Diagnostic, Severity};
use crate::script::formula::{Instant, Quantity};
use crate::script::history::{History, Part};
use crate::script::scope::{Measure, Scope};
use crate::script::source::Source;
use crate::script::syntax::{self, Statement};
use crate::simulation::Simulation;

/// The manual of all three.
pub const MANUAL: &str = "\
restart(N, file): after every N-th step, `*` in the name is the step; without `*` each file replaces
the one before. write_restart(file): now. read_restart(file): before everything but assignments, which
win over those in the file; then the scene is there as it was, with fixes, outputs and variables, and
the script may change it. A run that goes on with nothing changed gives the bytes of the run that was
never stopped: `run(N)` counts from here, the rest of a `run_time(T)` ends where all of it would have.
`karamelo-rs FILE` instead finishes the run under way and the script after it.
Any number of threads and processes (`mpirun`) writes the same file and goes on from it.
The file holds the script and the CRC-32 of the files that it reads; these must be where they were.
Not in it: the log, which is added to, and pictures and dumps with `*`, which are written anew.";

/// `restart(N, file)`
pub fn restart(args: &mut Args<'_>, _scene: &mut Scene) -> Result<Action, Diagnostic> {
    let interval = args.count("the number of steps between restart files", 0)?;
    let file = args.word("a file name")?;
    check_directory(&file.text, file.span)?;
    Ok(action(move |session| session.simulation.outputs.set_restart(interval, &file.text)))
}

/// `write_restart(file)`
pub fn write_restart(args: &mut Args<'_>, _scene: &mut Scene) -> Result<Action, Diagnostic> {
    let file = args.word("a file name")?;
    check_directory(&file.text, file.span)?;
    Ok(Box::new(move |session| {
        session.simulation.quantities.clone_from(&session.quantities);
        if session.mode == Mode::Run {
            let path = restart::path(&file.text, session.simulation.clock.step);
            session.simulation.write_restart(&path)?;
        }
        Ok(())
    }))
}

/// `read_restart(file)`
pub fn read_restart(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    let file = args.word("a restart file")?;
    if scene.calls > 1 {
        let message = "`read_restart` stands below another command";
        return Err(Diagnostic::error(Code::Order, args.command.span, message)
            .label("too late: only assignments may stand above it"));
    }
    let refuse = |reason: String| {
        let message = format!("cannot go on from `{}`: {reason}", file.text);
        Diagnostic::error(Code::FileSystem, file.span, message).label("this file cannot be used")
    };
    let bytes = files::read(&file, &scene.folder)?;
    let Saved { history, checkpoint } = restart::decode(&bytes).map_err(refuse)?;
    drop(bytes);
    let mut rebuilt = Rebuilt::of(&history.parts).map_err(refuse)?;
    args.scope.continue_from(rebuilt.scope).map_err(refuse)?;
    rebuilt.scene.folder = std::mem::take(&mut scene.folder);
    rebuilt.scene.calls = scene.calls;
    *scene = rebuilt.scene;
    scene.files.borrow_mut().clear();
    let (actions, span, name) = (rebuilt.actions, file.span, file.text);
    Ok(Box::new(move |session| {
        let fault = |reason: String| Fault {
            kind: FaultKind::File,
            what: format!("cannot go on from `{name}`: {reason}"),
            cause: None,
        };
        let told = session.warnings.len();
        session.simulation.quantities.clone_from(&session.quantities);
        for action in actions {
            action(session).map_err(|stop| match stop {
                Stop::Script(mistakes) => fault(words(&mistakes)).into(),
                other => other,
            })?;
        }
        // They have been told when the file was written.
        session.warnings.truncate(told);
        session.fixed_dt_span = span;
        session.simulation.restore(checkpoint).map_err(fault)?;
        session.simulation.outputs.continue_log();
        session.simulation.history.parts.splice(0..0, history.parts);
        Ok(())
    }))
}

fn words(mistakes: &[Diagnostic]) -> String {
    mistakes.first().map_or_else(String::new, |mistake| mistake.message.clone())
}

/// Statements that run.
const RUNS: [&str; 4] = ["run", "run_time", "run_while", "run_until"];

/// Statements that only show or write something.
const OF_OUTPUT: [&str; 2] = ["print", "write_restart"];

/// Statements that act on particles where they are, which is in the file.
const OF_PLACES: [&str; 2] = ["translate_particles", "delete_particles"];

/// What scripts come to as far as they have been performed.
struct Rebuilt {
    scope: Scope,
    scene: Scene,
    actions: Vec<Action>,
}

impl Rebuilt {
    /// Reads the statements again.
    ///
    /// # Errors
    /// What has changed since: a file that they read, or the language.
    fn of(parts: &[Part]) -> Result<Self, String> {
        let (scope, scene) = (Scope::default(), Scene::default());
        let mut all = Self { scope, scene, actions: Vec::new() };
        for part in parts {
            all.read_part(part)?;
        }
        Ok(all)
    }

    fn read_part(&mut self, part: &Part) -> Result<(), String> {
        let source = Source::new(part.name.clone(), &part.text);
        let (statements, mistakes) = syntax::parse(&source);
        let place = |mistake: &Diagnostic| {
            let (line, _) = source.position(mistake.span.start);
            format!("{}:{line}: {}", source.name, mistake.message)
        };
        if let Some(mistake) = mistakes.iter().find(|m| m.severity == Severity::Error) {
            return Err(place(mistake));
        }
        let mut scope = Scope::new(&part.variables).map_err(|mistake| mistake.message)?;
        let mut scene = Scene { folder: files::folder(&source), ..Scene::default() };
        let mut replay = Replay { values: &part.measured, next: 0 };
        for statement in statements.iter().take(part.performed) {
            let measure: &mut dyn Measure = &mut replay;
            match statement {
                Statement::Assign { name, value } => {
                    scope.assign(name, value, Some(measure)).map_err(|m| place(&m))?;
                }
                Statement::Call { name, .. } if name.text == "read_restart" => {
                    scope.continue_from(std::mem::take(&mut self.scope))?;
                    let calls = scene.calls + 1;
                    let folder = std::mem::take(&mut scene.folder);
                    scene = Scene { folder, calls, ..std::mem::take(&mut self.scene) };
                    scene.files.borrow_mut().clear();
                }
                Statement::Call { name, arguments, span } => {
                    let args = Args::new(name, *span, arguments, &mut scope, Some(measure));
                    let (action, _) = play::read(args, &mut scene).map_err(|m| place(&m))?;
                    let word = name.text.as_str();
                    let moved = scene.runs > 0 && OF_PLACES.contains(&word);
                    if !(moved || RUNS.contains(&word) || OF_OUTPUT.contains(&word)) {
                        self.actions.push(action);
                    }
                }
                Statement::Quit { .. } => break,
            }
        }
        if replay.next != replay.values.len() {
            return Err("its script takes other numbers than it did".to_string());
        }
        compare(&scene.files.borrow(), &part.files)?;
        (self.scope, self.scene) = (scope, scene);
        Ok(())
    }
}

/// Refuses files that have changed.
fn compare(now: &[(String, u32)], then: &[(String, u32)]) -> Result<(), String> {
    match now.iter().zip(then).find(|(now, then)| now != then) {
        Some(((name, _), _)) => Err(format!("the file `{name}` has changed since")),
        None if now.len() != then.len() => {
            Err("its script reads other files than it did".to_string())
        }
        None => Ok(()),
    }
}

/// The numbers that a script took from its simulation, once more.
struct Replay<'a> {
    values: &'a [f64],
    next: usize,
}

impl Replay<'_> {
    fn value(&mut self) -> f64 {
        let value = self.values.get(self.next).copied().unwrap_or(f64::NAN);
        self.next += 1;
        value
    }
}

impl Measure for Replay<'_> {
    fn measure(&mut self, _quantity: &Quantity) -> f64 {
        self.value()
    }

    fn now(&mut self) -> Instant {
        let [time, dt, step] = std::array::from_fn(|_| self.value());
        Instant { time, dt, step: step as u64 }
    }
}

/// The script that goes on where a restart file was written: it reads the file, finishes the run
/// under way, and has the rest of the script, each statement on its old line.
///
/// # Errors
/// Why the file cannot be used.
pub fn rest_of_script(file: &str, bytes: &[u8]) -> Result<(Source, bool), String> {
    let Saved { history, mut checkpoint } = restart::decode(bytes)?;
    let History { parts } = history;
    let part = parts.last().ok_or("it has no script")?;
    let (statements, _) = syntax::parse(&Source::new(part.name.clone(), &part.text));
    let last = part.performed.checked_sub(1).and_then(|last| statements.get(last));
    let in_run = last.is_some_and(|statement| match statement {
        Statement::Call { name, .. } => RUNS.contains(&name.text.as_str()),
        _ => false,
    });
    let unfinished = in_run && Simulation::was_unfinished(&mut checkpoint);
    let first = part.performed - usize::from(unfinished);
    let start = statements.get(first).map_or(part.text.len(), |statement| match statement {
        Statement::Assign { name, .. } | Statement::Call { name, .. } => name.span.start,
        Statement::Quit { span } => span.start,
    });
    if file.contains(['"', '\n']) {
        return Err("its name has a quote or a line end in it".to_string());
    }
    let (done, rest) = part.text.split_at(start);
    let lines = done.matches('\n').count().max(1);
    let text = format!("read_restart(\"{file}\"){}{rest}", "\n".repeat(lines));
    Ok((Source::new(part.name.clone(), &text), unfinished))
}

/// Writes the restart file of a session that is being stopped; gives its name.
///
/// # Errors
/// The file cannot be written.
pub fn write_interrupted(session: &mut Session, script: &str) -> Result<String, Fault> {
    let path = restart::interrupted(script, session.simulation.outputs.log_path());
    session.simulation.write_restart(&path)?;
    Ok(path.display().to_string())
}
