//! The command line: `karamelo-rs SCRIPT`, `check`, `styles`, `explain`.

mod arguments;
mod launcher;
mod styles;

use crate::command::play;
use crate::command::session::{Mode, Session, Stop};
use crate::error;
use crate::fault::FaultKind;
use crate::interrupt;
use crate::output::{OutputOptions, Outputs};
use crate::script::diagnostic::{Code, Diagnostic, Severity, render};
use crate::script::source::Source;
use arguments::{Options, Task};
use std::ffi::OsString;
use std::io::{IsTerminal, Write};
use std::process::ExitCode;

/// All is done.
const DONE: u8 = 0;
/// The run went wrong.
const RUN_FAILED: u8 = 1;
/// The script or the command line is wrong.
const WRONG: u8 = 2;
/// The file system is wrong.
const FILES: u8 = 3;
/// Stopped by the user.
const INTERRUPTED: u8 = 130;

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
    if let Some(message) = launcher::several_processes() {
        eprintln!("{message}");
        return WRONG;
    }
    let task = match arguments::parse(arguments) {
        Ok(task) => task,
        Err(problem) => {
            let code = problem.exit_code();
            // A reader that has gone away (`| head`) is no error of ours.
            let _ = problem.print();
            return if code == 0 { DONE } else { WRONG };
        }
    };
    match task {
        Task::Run(options) => script(&options, Mode::Run),
        Task::Check(options) => script(&options, Mode::Check),
        Task::Styles { family, name } => show(styles::text(family.as_deref(), name.as_deref())),
        Task::Explain(code) => show(
            error::explain(&code)
                .ok_or_else(|| format!("there is no code `{code}`; codes look like E0203, W0201")),
        ),
        Task::Text(text) => show(Ok(text)),
    }
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

/// Runs or checks a script.
fn script(options: &Options, mode: Mode) -> u8 {
    let bytes = match std::fs::read(&options.script) {
        Ok(bytes) => bytes,
        Err(reason) => {
            eprintln!("error: cannot read `{}`: {reason}", options.script.display());
            return FILES;
        }
    };
    // This thread works too, so that a sweep does not begin with waking another. Refused only if
    // the pool exists already, which is then the one to use.
    let pool = rayon::ThreadPoolBuilder::new().use_current_thread();
    let _ = pool.num_threads(options.threads.unwrap_or(0)).build_global();
    let (source, encoding) = Source::from_bytes(options.script.display().to_string(), &bytes);
    let (script, mut found) = play::rehearse(source, &options.variables);
    found.extend(encoding);
    report(&found, &script.source);
    let errors = || found.iter().filter(|d| d.severity == Severity::Error);
    if errors().next().is_some() {
        let files = errors().all(|mistake| mistake.code == Code::FileSystem);
        return if files { FILES } else { WRONG };
    }
    install_signals();
    let outputs = Outputs::new(OutputOptions {
        quiet: options.quiet || mode == Mode::Check,
        log: if mode == Mode::Check { None } else { options.log.clone() },
        title: format!("karamelo-rs {} {}", env!("CARGO_PKG_VERSION"), script.source.name),
    });
    let mut session = Session::new(outputs, mode);
    session.source = script.source.clone();
    session.echo = options.echo;
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
        report(&warnings, &session.source);
    }
    DONE
}

/// The performance ended early: why, and where it stood.
fn stopped(stop: Stop, session: &mut Session) -> u8 {
    // What is written so far stays; a second failure would only hide the first one.
    let _ = session.simulation.outputs.close();
    match stop {
        Stop::Script(mistakes) => {
            report(&mistakes, &session.source);
            WRONG
        }
        Stop::Interrupted => {
            let clock = session.simulation.clock;
            eprintln!("stopped by the user at step {}, time {}", clock.step, clock.time);
            INTERRUPTED
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
            match fault.kind {
                FaultKind::Run => RUN_FAILED,
                FaultKind::File => FILES,
            }
        }
    }
}

fn report(found: &[Diagnostic], source: &Source) {
    if !found.is_empty() {
        eprint!("{}", render(found, source, std::io::stderr().is_terminal()));
    }
}

/// The first signal stops after the step under way, the second one at once.
fn install_signals() {
    let handler = || {
        if interrupt::request() {
            std::process::exit(i32::from(INTERRUPTED));
        }
    };
    // Without a handler the system's own default applies.
    let _ = ctrlc::set_handler(handler);
}
