//! Old forms that published scripts use (language.md 10).

use super::scene::Scene;
use super::{Action, action, method};
use crate::script::arguments::Args;
use crate::script::diagnostic::{Code, Diagnostic};

/// A warning that shows the modern line.
pub fn old_form(args: &mut Args<'_>, modern: &str) {
    let message = format!("an old form of `{}`", args.command.text);
    args.remarks.push(
        Diagnostic::warning(Code::Compatibility, args.span, message)
            .label("accepted")
            .help(format!("the modern line is `{modern}`")),
    );
}

/// `method_modify(sub [, shape [, alpha]])`
pub fn method_modify(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    scene.before_runs(args.command)?;
    old_form(args, "method(type, sub, shape, alpha)");
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
