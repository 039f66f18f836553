//! Old forms that published scripts use (language.md 10).

use super::scene::Scene;
use super::{Action, action, method};
use crate::script::arguments::Args;
use crate::script::diagnostic::Diagnostic;

/// `method_modify(sub [, shape [, alpha]])`
pub fn method_modify(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    scene.before_runs(args.command)?;
    args.old_form("method(type, sub, shape, alpha)");
    let mut choice = scene.need_method(args);
    let kind = method::transfer_kind(args)?;
    if args.remaining() > 0 {
        let (span, shape) = method::shape(args)?;
        choice.method.shape = shape;
        for (_, solid) in scene.solids.iter() {
            method::check_nodes(&solid.cells, shape, span)?;
        }
    }
    choice.transfer = method::blend(args, kind, Some(choice.transfer.alpha))?;
    scene.method = Some(choice);
    Ok(action(move |session| {
        session.simulation.world.method.shape = choice.method.shape;
        session.simulation.transfer = choice.transfer;
    }))
}
