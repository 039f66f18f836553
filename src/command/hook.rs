//! `fix`, `compute` and their removal.

use super::scene::Scene;
use super::{Action, action};
use crate::compute::COMPUTES;
use crate::fix::{self, FIXES, Fix, GroupKind, Target};
use crate::model::group::GroupId;
use crate::script::arguments::{Args, Name};
use crate::script::diagnostic::{Code, Diagnostic};
use crate::script::formula::Quantity;
use crate::style;

fn target(args: &mut Args<'_>, scene: &Scene, id: &str) -> Result<Target, Diagnostic> {
    let dimension = scene.need_domain(args.command)?.dimension;
    let group = args.word("a group ID")?;
    let (_, entry) = scene.groups.find(&group)?;
    Ok(Target {
        id: id.to_string(),
        group: entry.id,
        kind: entry.kind,
        span: group.span,
        dimension,
        conducts_heat: scene.conducts_heat(),
        solids: [0; 2],
    })
}

/// Reads `s1, s2`: the numbers of two solids, and where the second stands.
///
/// # Errors
/// A solid that is unknown, or one solid twice.
pub fn two_solids(args: &mut Args<'_>, scene: &Scene) -> Result<([usize; 2], Name), Diagnostic> {
    let names = [args.word("a solid ID")?, args.word("a second solid ID")?];
    let solids = [scene.solids.find(&names[0])?.0, scene.solids.find(&names[1])?.0];
    let [_, second] = names;
    if solids[0] == solids[1] {
        let message = format!("contact of the solid `{}` with itself", second.text);
        return Err(Diagnostic::error(Code::Duplicate, second.span, message)
            .label("the same solid again: contact needs two"));
    }
    Ok((solids, second))
}

fn pair(args: &mut Args<'_>, scene: &Scene, id: &str) -> Result<Target, Diagnostic> {
    let dimension = scene.need_domain(args.command)?.dimension;
    let (solids, second) = two_solids(args, scene)?;
    let (id, kind) = (id.to_string(), GroupKind::Particles);
    let conducts_heat = scene.conducts_heat();
    Ok(Target {
        id,
        group: GroupId::ALL,
        kind,
        span: second.span,
        dimension,
        conducts_heat,
        solids,
    })
}

/// A contact of the same ID publishes results of the same names.
fn refuse_name_of_contact(scene: &Scene, id: &Name) -> Result<(), Diagnostic> {
    if scene.contacts.position(&id.text).is_none() {
        return Ok(());
    }
    let message = format!("the contact `{}` publishes results of the same names", id.text);
    Err(Diagnostic::error(Code::Duplicate, id.span, message).label("taken above"))
}

/// `fix(ID, style, group, ...)`, `fix(ID, contact/..., s1, s2, ...)`
pub fn fix(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    let id = args.word("a fix ID")?;
    refuse_name_of_contact(scene, &id)?;
    let runs = scene.runs;
    Scene::replace(&mut scene.fixes, &id, runs)?;
    for (component, suffix) in ["x", "y", "z", "s"].into_iter().enumerate() {
        let name = format!("{}_{suffix}", id.text);
        args.scope.check_result(&name, id.span)?;
        args.scope.publish(&name, Quantity::Fix { id: id.text.clone(), component });
    }
    let word = args.word("a fix style")?;
    let (row, build) = style::find("fix", FIXES, &word)?;
    args.expect_usage(row.usage);
    let target = match fix::acts_on_solids(row.name) {
        true => pair(args, scene, &id.text)?,
        false => target(args, scene, &id.text)?,
    };
    let fix = build(args, &target)?;
    propose_reference(args, scene, &word, fix.as_ref());
    Ok(action(move |session| {
        if let Some(reason) = fix.passes_over(&session.simulation.world) {
            let message = format!("`{}` has no effect there: {reason}", word.text);
            session.warnings.push(
                Diagnostic::warning(Code::NoEffect, word.span, message)
                    .label("leaves these particles as they are"),
            );
        }
        session.simulation.add_fix(&id.text, fix);
    }))
}

/// Fixes whose formulas are mostly functions of the reference position, where it differs.
const OF_REFERENCE: [&str; 5] = [
    "body_force",
    "initial_stress",
    "initial_velocity_nodes",
    "initial_velocity_particles",
    "velocity_nodes",
];

/// Notes formulas of the current position where the reference position may be meant.
fn propose_reference(args: &mut Args<'_>, scene: &Scene, style: &Name, fix: &dyn Fix) {
    let total = scene.method.is_none_or(|choice| choice.method.total);
    let meant =
        style.text == "check_solution" || total && OF_REFERENCE.contains(&style.text.as_str());
    let current = fix.formulas().iter().any(|formula| formula.reads_current());
    if meant && current {
        let message = "a formula reads the current position";
        args.remarks.push(
            Diagnostic::note(Code::OldReference, style.span, message)
                .label("`x`, `y`, `z` move with the body")
                .help("write `x0`, `y0`, `z0` where the reference position is meant"),
        );
    }
}

/// `delete_fix(ID)`
pub fn delete_fix(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    let id = args.word("a fix ID")?;
    scene.fixes.remove(&id)?;
    let name = id.text.clone();
    args.scope.withdraw(|quantity| matches!(quantity, Quantity::Fix { id, .. } if *id == name));
    Ok(action(move |session| session.simulation.delete_fix(&id.text)))
}

/// `compute(ID, style, group)`
pub fn compute(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    let id = args.word("a compute ID")?;
    refuse_name_of_contact(scene, &id)?;
    scene.computes.declare(&id, super::scene::Declared { runs: scene.runs })?;
    let word = args.word("a compute style")?;
    let (row, build) = style::find("compute", COMPUTES, &word)?;
    args.expect_usage(row.usage);
    let target = target(args, scene, &id.text)?;
    let compute = build(args, &target)?;
    for (component, suffix) in compute.suffixes().iter().enumerate() {
        let name = format!("{}{suffix}", id.text);
        args.scope.check_result(&name, id.span)?;
        args.scope.publish(&name, Quantity::Compute { id: id.text.clone(), component });
    }
    Ok(action(move |session| session.simulation.add_compute(&id.text, compute)))
}

/// `delete_compute(ID)`
pub fn delete_compute(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    let id = args.word("a compute ID")?;
    scene.computes.remove(&id)?;
    let name = id.text.clone();
    args.scope.withdraw(|quantity| matches!(quantity, Quantity::Compute { id, .. } if *id == name));
    Ok(action(move |session| session.simulation.delete_compute(&id.text)))
}
