//! Time steps and runs.

use super::scene::Scene;
use super::session::{Mode, Session, Stop};
use super::{Action, action};
use crate::script::arguments::{Args, Place};
use crate::script::diagnostic::{Code, Diagnostic};
use crate::script::formula::Formula;
use crate::script::source::Span;
use crate::simulation::Until;
use std::io::Write;

/// `set_dt(dt)`, `set_dt(dt, force)`, `set_dt(auto)`
pub fn set_dt(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    scene.fixed_dt = args.peek() != Some("auto");
    if args.keyword("auto") {
        return Ok(action(|session| session.simulation.fixed_dt = None));
    }
    let span = args.next_span();
    let dt = args.positive("the time step")?.value;
    let forced = args.keyword("force");
    Ok(action(move |session| {
        session.simulation.fixed_dt = Some(dt);
        (session.fixed_dt_span, session.fixed_dt_is_forced) = (span, forced);
    }))
}

/// `dt_factor(f)`
pub fn dt_factor(args: &mut Args<'_>, _scene: &mut Scene) -> Result<Action, Diagnostic> {
    let factor = args.positive("the factor")?;
    if factor.value > 1.0 {
        args.remarks.push(
            Diagnostic::warning(Code::UnstableStep, factor.span, "a factor above 1 is not stable")
                .label("larger than the stable step"),
        );
    }
    Ok(action(move |session| session.simulation.dt_factor = factor.value))
}

/// What a run cannot do without.
fn need_scene(args: &Args<'_>, scene: &mut Scene) -> Result<(), Diagnostic> {
    let mut missing = Vec::new();
    if scene.method.is_none() && scene.solids.is_empty() {
        missing.push("`method(ulmpm, FLIP, linear, 1)`");
    }
    if scene.domain.is_none() && !scene.tried.contains(&"dimension") {
        missing.push("`dimension(...)`");
    }
    if scene.solids.is_empty() && !scene.tried.contains(&"solid") {
        missing.push("a `solid(...)`");
    }
    scene.runs += 1;
    let tried = scene.tried.iter().filter(|command| **command == "solid").count();
    let only_rigid = scene.solids.iter().all(|(_, solid)| solid.rigid);
    let all_made = tried > 0 && scene.solids.iter().count() == tried;
    if missing.is_empty() && all_made && only_rigid && !scene.fixed_dt {
        let message = "all solids are rigid: no time step follows from them";
        return Err(Diagnostic::error(Code::Missing, args.command.span, message)
            .label("needs `set_dt(dt)` above it"));
    }
    if missing.is_empty() {
        return Ok(());
    }
    let message = format!("the run needs {} above it", missing.join(" and "));
    Err(Diagnostic::error(Code::Missing, args.command.span, message).label("cannot run yet"))
}

/// `run(N)`
pub fn run(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    let steps = args.count("the number of steps", 0)?;
    need_scene(args, scene)?;
    Ok(perform(Until::Steps(steps)))
}

/// `run_time(T)`
pub fn run_time(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    let time = args.within("the time", 0.0, f64::INFINITY)?.value;
    need_scene(args, scene)?;
    Ok(perform(Until::Time(time)))
}

/// `run_while(condition)`
pub fn run_while(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    let condition = condition(args)?;
    need_scene(args, scene)?;
    Ok(perform(Until::While(condition)))
}

/// `run_until(condition)`
pub fn run_until(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    let condition = condition(args)?;
    need_scene(args, scene)?;
    Ok(perform(Until::Condition(condition)))
}

fn condition(args: &mut Args<'_>) -> Result<Formula, Diagnostic> {
    let span: Span = args.next_span();
    let condition = args.formula("the condition", Place::Nowhere)?;
    match condition.as_constant() {
        Some(value) if condition.is_known() => {
            let message = format!("the condition is always {value}");
            Err(Diagnostic::error(Code::Constant, span, message)
                .label("never changes")
                .help("compare `time` or a result of a fix or compute"))
        }
        _ => Ok(condition),
    }
}

fn perform(until: Until) -> Action {
    Box::new(move |session: &mut Session| -> Result<(), Stop> {
        session.simulation.quantities.clone_from(&session.quantities);
        let simulation = &mut session.simulation;
        // A run that goes on with the last one has had its warning.
        let limit = match simulation.goes_on_with_last_run() {
            true => None,
            false => simulation.stable_limit()?,
        };
        let fixed = simulation.fixed_dt;
        if let (Some(dt), Some(limit)) = (fixed, limit) {
            session.judge_fixed_step(dt, limit)?;
        }
        session.show_warnings();
        if session.mode == Mode::Check {
            let text = session.simulation.describe(&until, &session.processes)?;
            if session.speaks() {
                // A reader that has gone away (`| head`) is no error of ours.
                let _ = writeln!(std::io::stdout(), "{text}");
            }
            return Ok(());
        }
        match std::mem::take(&mut session.finishes_run) {
            true => session.simulation.finish(&until)?,
            false => session.simulation.go_on(&until)?,
        }
        if session.simulation.interrupted { Err(Stop::Interrupted) } else { Ok(()) }
    })
}
