//! Parse, rehearse, perform.

use super::scene::Scene;
use super::session::{Session, Stop};
use super::setting::{self, Change, Setting};
use super::{Action, COMMANDS, files};
use crate::script::arguments::{Args, Name};
use crate::script::diagnostic::{Code, Diagnostic, Severity};
use crate::script::history::Part;
use crate::script::scope::{Measure, Scope};
use crate::script::source::Source;
use crate::script::suggest;
use crate::script::syntax::{self, Argument, Statement};

/// A script that has been parsed.
pub struct Script {
    /// Its text.
    pub source: Source,
    /// Its statements, up to `quit`.
    pub statements: Vec<Statement>,
    /// `-var` of the command line.
    pub variables: Vec<(String, String)>,
    /// What settings have changed in the statements.
    pub changes: Vec<Change>,
    /// The smallest cell size of the grid and the solids \[L\], where the rehearsal came to know one.
    pub cell: Option<f64>,
    /// Its first run is the rest of one that was stopped.
    pub finishes_run: bool,
}

/// What the command line wants otherwise than the script.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wishes<'a> {
    /// `-var`.
    pub variables: &'a [(String, String)],
    /// `--set`.
    pub settings: &'a [Setting],
    /// `--measure`.
    pub measure: Option<&'a str>,
}

/// Commands after which a run goes on as if it had never ended: they read, or act on outputs alone.
/// What a new output needs of particles and nodes is looked at when the run begins.
const QUIET: [&str; 23] = [
    "region",
    "eos",
    "strength",
    "damage",
    "temperature",
    "material",
    "compute",
    "delete_compute",
    "run",
    "run_time",
    "run_while",
    "run_until",
    "set_output",
    "log",
    "log_modify",
    "dump",
    "undump",
    "plot",
    "save_plot",
    "print",
    "restart",
    "write_restart",
    "read_restart",
];

/// Parses and rehearses a script: all its mistakes and remarks at once. Nothing is written.
pub fn rehearse(source: Source, variables: &[(String, String)]) -> (Script, Vec<Diagnostic>) {
    rehearse_with(source, &Wishes { variables, ..Wishes::default() })
}

/// The same with settings.
pub fn rehearse_with(source: Source, wishes: &Wishes<'_>) -> (Script, Vec<Diagnostic>) {
    let variables = wishes.variables;
    let (mut statements, mut found) = syntax::parse(&source);
    let mut changes = Vec::new();
    match setting::apply(&mut statements, wishes.settings, variables, &source) {
        Ok(made) => changes.extend(made),
        Err(mistake) => found.push(mistake),
    }
    if let Some(expression) = wishes.measure {
        match setting::measure(&mut statements, expression, &source) {
            Ok(made) => changes.extend(made),
            Err(mistake) => found.push(mistake),
        }
    }
    let variables_given = variables.to_vec();
    let mut script = Script {
        source,
        statements,
        variables: variables_given,
        changes,
        cell: None,
        finishes_run: false,
    };
    let mut scope = match Scope::new(variables) {
        Ok(scope) => scope,
        Err(mistake) => {
            found.push(mistake);
            return (script, found);
        }
    };
    let mut scene = Scene { folder: files::folder(&script.source), ..Scene::default() };
    let mut broken: Vec<String> = Vec::new();
    for statement in &script.statements {
        let result = match statement {
            Statement::Assign { name, value } => {
                scope.assign(name, value, None).map(|(_, remarks)| found.extend(remarks))
            }
            Statement::Call { name, arguments, span } => {
                let args = Args::new(name, *span, arguments, &mut scope, None);
                read(args, &mut scene).map(|(_, remarks)| found.extend(remarks))
            }
            Statement::Quit { .. } => break,
        };
        if let Err(mistake) = result {
            let silent = mistake.message.is_empty();
            if !silent && !follows(&mistake, &broken, &script.source) {
                found.push(mistake);
            }
            broken.extend(declared(statement));
            // Without the scene of the file nothing below it is known.
            if matches!(statement, Statement::Call { name, .. } if name.text == "read_restart") {
                break;
            }
        }
    }
    let cells = scene.solids.iter().map(|(_, solid)| solid.cells.cell);
    let cells = cells.chain(scene.domain.map(|domain| domain.cell));
    script.cell = cells.filter(|cell| *cell > 0.0).min_by(f64::total_cmp);
    (script, found)
}

/// The name that a statement would have declared.
fn declared(statement: &Statement) -> Option<String> {
    match statement {
        Statement::Assign { name, .. } => Some(name.text.clone()),
        Statement::Call { arguments, .. } => arguments.first().map(|id| id.text.clone()),
        Statement::Quit { .. } => None,
    }
}

/// Does a mistake only follow from a broken statement above, whose ID is unknown now?
fn follows(mistake: &Diagnostic, broken: &[String], source: &Source) -> bool {
    let culprit = source.text.get(mistake.span.start..mistake.span.end).unwrap_or("");
    mistake.code == Code::UnknownName
        && broken.iter().any(|id| {
            culprit == id || ["_x", "_y", "_z", "_s"].iter().any(|s| culprit == format!("{id}{s}"))
        })
}

/// Reads one call with the command's own function.
pub(super) fn read(
    mut args: Args<'_>,
    scene: &mut Scene,
) -> Result<(Action, Vec<Diagnostic>), Diagnostic> {
    let name = args.command;
    let Some(command) = COMMANDS.iter().find(|command| command.name == name.text) else {
        let known = COMMANDS.iter().map(|command| command.name);
        let otherwise = "`karamelo-rs styles command` lists all";
        let message = format!("unknown command `{}`", name.text);
        return Err(Diagnostic::error(Code::UnknownCommand, name.span, message)
            .label("not a command")
            .help(suggest::help(&name.text, known, otherwise)));
    };
    let Some(read) = command.build else {
        let message = format!("`{}` is known, but not available yet", name.text);
        return Err(
            Diagnostic::error(Code::NotAvailable, name.span, message).label("not available yet")
        );
    };
    args.expect_usage(command.usage);
    scene.calls += 1;
    let action = read(&mut args, scene)?;
    Ok((action, args.finish()?))
}

/// Performs a script that has been rehearsed without mistakes.
///
/// # Errors
/// A run that goes wrong, the user's wish to stop, or a mistake that only shows when a statement
/// is reached.
pub fn perform(script: &Script, session: &mut Session) -> Result<(), Stop> {
    let mut scope = Scope::new(&script.variables).map_err(|mistake| Stop::Script(vec![mistake]))?;
    let mut scene = Scene { folder: files::folder(&script.source), ..Scene::default() };
    session.simulation.history.begin(Part {
        name: script.source.name.clone(),
        text: script.source.text.clone(),
        variables: script.variables.clone(),
        ..Part::default()
    });
    session.finishes_run = script.finishes_run;
    for statement in &script.statements {
        if let Some(part) = session.simulation.history.current() {
            part.performed += 1;
        }
        match statement {
            Statement::Assign { name, value } => {
                let measure: &mut dyn Measure = session;
                let result = scope.assign(name, value, Some(measure));
                let (echo, _) = result.map_err(|mistake| Stop::Script(vec![mistake]))?;
                session.show(&echo);
            }
            Statement::Call { name, arguments, span } => {
                let action = reading(name, *span, arguments, &mut scope, session, &mut scene)?;
                session.quantities = scope.quantities().to_vec();
                if let Some(part) = session.simulation.history.current() {
                    part.files.clone_from(&scene.files.borrow());
                }
                action(session)?;
                if !QUIET.contains(&name.text.as_str()) {
                    session.simulation.disturb();
                }
            }
            Statement::Quit { .. } => break,
        }
    }
    Ok(())
}

fn reading(
    name: &Name,
    span: crate::script::source::Span,
    arguments: &[Argument],
    scope: &mut Scope,
    session: &mut Session,
    scene: &mut Scene,
) -> Result<Action, Stop> {
    let measure: &mut dyn Measure = session;
    let args = Args::new(name, span, arguments, scope, Some(measure));
    let (action, remarks) = read(args, scene).map_err(|mistake| Stop::Script(vec![mistake]))?;
    debug_assert!(remarks.iter().all(|remark| remark.severity != Severity::Error));
    Ok(action)
}
