//! Old forms that published scripts use (language.md 10).

use super::scene::Scene;
use super::{Action, action, domain};
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
    let given = args.remaining();
    let sub = domain::available(args, "sub-method", &["PIC", "FLIP", "APIC"], &["PIC", "FLIP"])?;
    if given > 1 {
        let shapes = ["linear", "quadratic-spline", "cubic-spline", "Bernstein-quadratic"];
        domain::available(args, "shape function", &shapes, &["linear"])?;
    }
    let alpha =
        if given > 2 { Some(args.within("the blend alpha", 0.0, 1.0)?.value) } else { None };
    let pic = sub.text == "PIC";
    Ok(action(move |session| {
        let transfer = &mut session.simulation.transfer;
        transfer.alpha = if pic { 0.0 } else { alpha.unwrap_or(transfer.alpha) };
    }))
}
