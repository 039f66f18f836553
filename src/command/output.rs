//! Log, dumps, plots, prints.

use super::scene::{Declared, Scene};
use super::{Action, action};
use crate::output::{DUMPS, DumpTarget, LogColumn};
use crate::script::arguments::{Args, Place};
use crate::script::diagnostic::{Code, Diagnostic};
use crate::script::source::Span;
use crate::style;
use std::path::Path;

/// `set_output(N)`
pub fn set_output(args: &mut Args<'_>, _scene: &mut Scene) -> Result<Action, Diagnostic> {
    let interval = args.count("the number of steps", 0)?;
    Ok(action(move |session| session.simulation.outputs.set_log_interval(interval)))
}

/// `log(N)`, an old form of `set_output(N)`.
pub fn log(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    set_output(args, scene)
}

/// `log_modify(default)`, `log_modify(custom, name, ...)`
pub fn log_modify(args: &mut Args<'_>, _scene: &mut Scene) -> Result<Action, Diagnostic> {
    if args.choice("log style", &["default", "custom"])? == 0 {
        let columns = || vec![LogColumn::Dt, LogColumn::Time];
        return Ok(action(move |session| session.simulation.outputs.set_log_columns(columns())));
    }
    let mut columns = Vec::new();
    while args.remaining() > 0 {
        match args.peek() {
            Some("step" | "timestep") => {
                args.word("a column")?;
            }
            Some("dt") => {
                args.word("a column")?;
                columns.push(LogColumn::Dt);
            }
            Some("time") => {
                args.word("a column")?;
                columns.push(LogColumn::Time);
            }
            Some("dt_limit") => {
                args.word("a column")?;
                columns.push(LogColumn::DtLimit);
            }
            _ => {
                let (name, formula) = quantity(args, "a column of the log")?;
                columns.push(LogColumn::Quantity { name, formula });
            }
        }
    }
    Ok(action(move |session| session.simulation.outputs.set_log_columns(columns)))
}

/// A variable or result by name.
fn quantity(
    args: &mut Args<'_>,
    what: &str,
) -> Result<(String, crate::script::formula::Formula), Diagnostic> {
    let name = args.word(what)?;
    let formula = args.scope.formula(&name)?;
    if formula.reads_point() {
        let message = format!("`{}` depends on a place, and a log or plot has none", name.text);
        return Err(
            Diagnostic::error(Code::NotPlace, name.span, message).label("depends on a place")
        );
    }
    Ok((name.text, formula))
}

/// Refuses a file whose directory cannot take it.
pub(super) fn check_directory(file: &str, span: Span) -> Result<(), Diagnostic> {
    let directory = match Path::new(file).parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    };
    let refuse = |reason: String| {
        let message = format!("cannot write to the directory `{}`: {reason}", directory.display());
        Err(Diagnostic::error(Code::FileSystem, span, message).label("this file cannot be written"))
    };
    match std::fs::metadata(directory) {
        Ok(entry) if !entry.is_dir() => refuse("it is no directory".to_string()),
        Ok(entry) if entry.permissions().readonly() => refuse("it is read-only".to_string()),
        Ok(_) => Ok(()),
        Err(reason) => refuse(reason.to_string()),
    }
}

/// `dump(ID, group, style, N, file, field, ...)`
pub fn dump(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    let id = args.word("a dump ID")?;
    let runs = scene.runs;
    Scene::replace(&mut scene.dumps, &id, runs)?;
    let dimension = scene.need_domain(args.command)?.dimension;
    let group = args.word("a group ID")?;
    let entry = *scene.groups.find(&group)?.1;
    let word = args.word("a dump style")?;
    let (row, build) = style::find("dump", DUMPS, &word)?;
    args.expect_usage(row.usage);
    let interval = args.count("the number of steps between snapshots", 1)?;
    let file = args.word("a file name")?;
    check_directory(&file.text, file.span)?;
    let target = DumpTarget {
        group: entry.id,
        kind: entry.kind,
        group_span: group.span,
        file: file.text,
        file_span: file.span,
        dimension,
    };
    let dump = build(args, &target)?;
    Ok(action(move |session| session.simulation.outputs.add_dump(&id.text, interval, dump)))
}

/// `undump(ID)`
pub fn undump(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    let id = args.word("a dump ID")?;
    scene.dumps.remove(&id)?;
    Ok(action(move |session| session.simulation.outputs.delete_dump(&id.text)))
}

/// `plot(ID, N, xname, yname)`
pub fn plot(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    let id = args.word("a plot ID")?;
    scene.plots.declare(&id, Declared { runs: scene.runs })?;
    let interval = args.count("the number of steps between points", 1)?;
    let x = quantity(args, "the quantity on the x axis")?;
    let y = quantity(args, "the quantity on the y axis")?;
    Ok(action(move |session| session.simulation.outputs.add_plot(&id.text, interval, x, y)))
}

/// `save_plot(file)`
pub fn save_plot(args: &mut Args<'_>, _scene: &mut Scene) -> Result<Action, Diagnostic> {
    let file = args.word("a file name")?;
    check_directory(&file.text, file.span)?;
    let known = [".pdf", ".png", ".svg", ".csv"];
    if !known.iter().any(|suffix| file.text.ends_with(suffix)) {
        let message = format!("`{}` has no suffix of a figure", file.text);
        return Err(Diagnostic::error(Code::UnknownField, file.span, message)
            .label("unknown suffix")
            .help(format!("one of {}", known.join(", "))));
    }
    Ok(action(move |session| session.simulation.outputs.save_plot(&file.text)))
}

/// `print(e)`, `print("text")`
pub fn print(args: &mut Args<'_>, _scene: &mut Scene) -> Result<Action, Diagnostic> {
    if args.peek_quoted() {
        let text = args.word("a text")?.text;
        return Ok(action(move |session| session.simulation.outputs.say(&text)));
    }
    let words: Vec<&str> = args.peek().unwrap_or_default().split_whitespace().collect();
    let written = words.join(" ");
    let formula = args.formula("an expression", Place::Point)?;
    let value = if formula.reads_point() { None } else { args.current(&formula) };
    Ok(action(move |session| session.print(&written, value)))
}
