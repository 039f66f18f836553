//! The command line: `karamelo-rs SCRIPT`, `check`, `new`, `diff`, `study`, `verify`, `styles`, `explain`.

mod arguments;
mod launcher;
mod new;
mod reference;
mod study;
mod styles;
mod verify;

use crate::command;
use crate::command::play::{self, Wishes};
use crate::command::session::{Mode, Session, Stop};
use crate::compare;
use crate::error;
use crate::fault::{Fault, FaultKind};
use crate::interrupt;
use crate::output::{OutputOptions, Outputs, SOFTWARE, digest, restart};
use crate::parallel::Ranks;
use crate::script::diagnostic::{Code, Diagnostic, Severity, render};
use crate::script::source::Source;
use arguments::{Options, Task};
use signal_hook::consts::{SIGINT, SIGTERM, SIGXFSZ};
use signal_hook::iterator::Signals;
use std::ffi::OsString;
use std::io::{IsTerminal, Write};
use std::path::Path;
use std::process::ExitCode;

/// All is done.
const DONE: u8 = 0;
/// The run went wrong.
const RUN_FAILED: u8 = 1;
/// The script or the command line is wrong.
const WRONG: u8 = 2;
/// The file system is wrong, or a file that the script names.
const FILES: u8 = 3;
const USAGE: &str = "\
usage: karamelo-rs SCRIPT            runs a script
       karamelo-rs --help            lists everything else
example: karamelo-rs inputs/two-disks.mpm
";

/// Runs the program.
pub fn main(arguments: Vec<OsString>) -> ExitCode {
    ExitCode::from(run(arguments))
}

fn run(arguments: Vec<OsString>) -> u8 {
    if arguments.len() < 2 {
        eprint!("{USAGE}");
        return WRONG;
    }
    let launched = match launcher::join() {
        Ok(launched) => launched,
        Err(message) => {
            eprintln!("{message}");
            return WRONG;
        }
    };
    let ranks = &launched.ranks;
    let task = match arguments::parse(arguments) {
        Ok(task) => task,
        Err(problem) => {
            let code = problem.exit_code();
            if ranks.is_first() {
                // A reader that has gone away (`| head`) is no error of ours.
                let _ = problem.print();
            }
            return if code == 0 { DONE } else { WRONG };
        }
    };
    match task {
        Task::Styles { .. }
        | Task::Reference(_)
        | Task::Explain(_)
        | Task::Text(_)
        | Task::Diff(_)
        | Task::New(_)
            if !ranks.is_first() =>
        {
            DONE
        }
        Task::Run(options) => script(&options, Mode::Run, ranks),
        Task::Check(options) => script(&options, Mode::Check, ranks),
        Task::Study(_) if !ranks.is_alone() => alone("study", ranks),
        Task::Study(words) => study::run(*words),
        Task::Verify(_) if !ranks.is_alone() => alone("verify", ranks),
        Task::Verify(words) => verify::run(&words),
        Task::Styles { family, name } => show(styles::text(family.as_deref(), name.as_deref())),
        Task::Reference(folder) => match reference::write(&folder) {
            Ok(text) => show(Ok(text)),
            Err(message) => {
                eprintln!("error: {message}");
                FILES
            }
        },
        Task::Explain(code) => show(
            error::explain(&code)
                .ok_or_else(|| format!("there is no code `{code}`; codes look like E0203, W0201")),
        ),
        Task::Text(text) => show(Ok(text)),
        Task::Diff(words) => diff(&words),
        Task::New(words) => new::run(&words),
    }
}

/// Compares two runs.
fn diff(words: &arguments::DiffWords) -> u8 {
    match compare::compare(&words.first, &words.second, words.tolerance) {
        Ok(report) => {
            let alike = report.alike;
            show(Ok(report.text));
            if alike { DONE } else { RUN_FAILED }
        }
        Err(fault) => {
            eprintln!("error: {fault}");
            FILES
        }
    }
}

/// Refuses a command that starts processes of its own under a launcher.
fn alone(command: &str, ranks: &Ranks) -> u8 {
    if ranks.is_first() {
        eprintln!("error: `{command}` starts processes of its own: call it without a launcher");
    }
    WRONG
}

/// Prints a text; a reader that has gone away is no error.
fn show(text: Result<String, String>) -> u8 {
    match text {
        Ok(text) => {
            let _ = std::io::stdout().write_all(text.as_bytes());
            DONE
        }
        Err(message) => {
            eprintln!("{message}");
            WRONG
        }
    }
}

/// The bytes of the script, which the first process reads for all.
fn read(script: &Path, ranks: &Ranks) -> Result<Vec<u8>, Fault> {
    let read = if ranks.is_first() { std::fs::read(script) } else { Ok(Vec::new()) };
    let (mut bytes, fault) = match read {
        Ok(bytes) => (bytes, None),
        Err(reason) => (Vec::new(), Some(Fault::unreadable(script, &reason))),
    };
    ranks.agree(fault, &mut [])?;
    if let Some(exchange) = ranks.exchange() {
        exchange.broadcast(0, &mut bytes);
    }
    Ok(bytes)
}

/// Runs or checks a script.
fn script(options: &Options, mode: Mode, ranks: &Ranks) -> u8 {
    let bytes = match read(&options.script, ranks) {
        Ok(bytes) => bytes,
        Err(fault) => {
            if ranks.is_first() {
                eprintln!("error: {fault}");
            }
            return FILES;
        }
    };
    // This thread works too, so that a sweep does not begin with waking another. Refused only if
    // the pool exists already, which is then the one to use.
    let pool = rayon::ThreadPoolBuilder::new().use_current_thread();
    let threads = options.threads.or(launcher::threads(ranks));
    let _ = pool.num_threads(threads.unwrap_or(0)).build_global();
    let name = options.script.display().to_string();
    let (source, encoding, finishes_run) = match restart::is_restart_file(&name, &bytes) {
        false => {
            let (source, encoding) = Source::from_bytes(name, &bytes);
            (source, encoding, false)
        }
        true => match command::restart::rest_of_script(&name, &bytes) {
            Ok((source, finishes_run)) => (source, None, finishes_run),
            Err(reason) => {
                eprintln!("error: cannot go on from `{name}`: {reason}");
                return FILES;
            }
        },
    };
    let digest = digest::sha256(&bytes);
    drop(bytes);
    let wishes = Wishes {
        variables: &options.variables,
        settings: &options.settings,
        measure: options.measure.as_deref(),
    };
    let (mut script, mut found) = play::rehearse_with(source, &wishes);
    script.finishes_run = finishes_run;
    found.extend(encoding);
    let wrong = found.iter().any(|mistake| mistake.severity == Severity::Error);
    let [first_is_wrong, any_is_wrong] =
        ranks.largest([wrong && ranks.is_first(), wrong].map(f64::from)).map(|wrong| wrong > 0.0);
    // Files that only another process cannot read are its own to report.
    if ranks.is_first() || (wrong && !first_is_wrong) {
        report(&found, &script.source);
    }
    if any_is_wrong {
        return code_of(&found);
    }
    install_signals();
    let outputs = Outputs::new(OutputOptions {
        quiet: options.quiet || mode == Mode::Check,
        log: if mode == Mode::Check { None } else { options.log.clone() },
        mute: !ranks.is_first(),
        title: format!(
            "{SOFTWARE} {}\n{:<20}{digest}\n{:<20}{}",
            script.source.name, "sha256", "called as", options.line
        ),
    });
    let mut session = Session::new(outputs, mode);
    session.simulation.set_ranks(ranks.clone());
    session.source = script.source.clone();
    session.echo = options.echo;
    session.processes.clone_from(&options.processes);
    for change in &script.changes {
        let (line, _) = script.source.position(change.span.start);
        let said =
            format!("{}    # instead of line {line} or above it: {}", change.line, change.setting);
        session.simulation.outputs.say(&said);
    }
    let result = play::perform(&script, &mut session);
    session.show_warnings();
    match result {
        Ok(()) => finish(session, &found),
        Err(stop) => stopped(stop, &mut session),
    }
}

/// All statements are done: what was written, and the warnings once more.
fn finish(mut session: Session, found: &[Diagnostic]) -> u8 {
    if let Err(fault) = session.simulation.outputs.close() {
        return stopped(Stop::Fault(fault), &mut session);
    }
    if session.mode == Mode::Run {
        let warning = |d: &&Diagnostic| d.severity == Severity::Warning;
        let warnings: Vec<Diagnostic> = found.iter().filter(warning).cloned().collect();
        if session.speaks() {
            report(&warnings, &session.source);
        }
    }
    DONE
}

/// The performance ended early: why, and where it stood.
fn stopped(stop: Stop, session: &mut Session) -> u8 {
    let kept = match stop {
        Stop::Interrupted => {
            let script = session.source.name.clone();
            Some(command::restart::write_interrupted(session, &script))
        }
        _ => None,
    };
    // What is written so far stays; a second failure would only hide the first one.
    let _ = session.simulation.outputs.close();
    if session.speaks() {
        tell(&stop, session);
        match kept {
            Some(Ok(file)) => eprintln!("   = go on with: karamelo-rs {file}"),
            Some(Err(fault)) => eprintln!("   = no restart file: {fault}"),
            None => {}
        }
    }
    match &stop {
        Stop::Script(mistakes) => code_of(mistakes),
        Stop::Interrupted => interrupt::exit_code_now(),
        Stop::Fault(Fault { kind: FaultKind::Run | FaultKind::Step, .. }) => RUN_FAILED,
        Stop::Fault(Fault { kind: FaultKind::File, .. }) => FILES,
    }
}

/// The exit code of mistakes in a script: are they only about files that are missing or damaged?
fn code_of(found: &[Diagnostic]) -> u8 {
    let mut errors = found.iter().filter(|mistake| mistake.severity == Severity::Error);
    let of_files = |mistake: &Diagnostic| matches!(mistake.code, Code::FileSystem | Code::BadFile);
    if errors.all(of_files) { FILES } else { WRONG }
}

/// Tells why the performance ended early.
fn tell(stop: &Stop, session: &Session) {
    match stop {
        Stop::Script(mistakes) => report(mistakes, &session.source),
        Stop::Interrupted => {
            let clock = session.simulation.clock;
            eprintln!("stopped by the user at step {}, time {}", clock.step, clock.time);
        }
        Stop::Fault(fault) => {
            eprintln!("error: {fault}");
            if let Some(cause) = &fault.cause {
                eprintln!("   = likely cause: {cause}");
            }
            let written = session.simulation.outputs.written();
            if !written.is_empty() {
                eprintln!("   = kept: {}", written.join(", "));
            }
        }
    }
}

fn report(found: &[Diagnostic], source: &Source) {
    if !found.is_empty() {
        eprint!("{}", render(found, source, std::io::stderr().is_terminal()));
    }
}

/// The first signal stops after the step under way, the second one at once. A file that grows beyond
/// what is allowed is a fault of the file system, not a signal.
fn install_signals() {
    // Without handlers the system's own defaults apply.
    let Ok(mut signals) = Signals::new([SIGINT, SIGTERM, SIGXFSZ]) else { return };
    std::thread::spawn(move || {
        for signal in signals.forever().filter(|signal| *signal != SIGXFSZ) {
            if interrupt::request(signal) {
                std::process::exit(i32::from(interrupt::exit_code(signal)));
            }
        }
    });
}
