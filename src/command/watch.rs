//! `watch`: copies of the state, and smaller steps where a step fails.

use super::scene::Scene;
use super::{Action, action};
use crate::plan::Trouble;
use crate::script::arguments::Args;
use crate::script::diagnostic::Diagnostic;
use crate::simulation::Watch;

/// The manual entry.
pub const MANUAL: &str = "\
Without it a run stops where a particle is turned inside out (det F <= 0) or a velocity is not finite. With
it trouble is seen before: a particle whose J leaves 1/X..X (`volume, X`, default 1000), that is faster
than X waves of its undeformed material (`speed, X`, default 50), that one step strains by more
than X (`strain, X`, dt ||L||, default 0.7), whose stress is not finite; or kinetic energy that grows by half
in each of 8 steps. A copy of the state is kept in memory, taken after each output and every X steps
between (`interval, X`, default 25). The run goes back to it and tries again, with steps at most half as long
as the one that failed until the time of the trouble, at most X times (`retries, X`, default 8); each
attempt is a line of the log, `dt_limit` then says `rescue`, and the end of the run counts them. What
cannot be helped ends the run as before; if `restart` asked for files, the last copy is written as one. The
result has the same bits for any number of threads. A copy costs as much memory as the particles.";

/// `watch(on [, option, X] ...)`, `watch(off)`
pub fn watch(args: &mut Args<'_>, _scene: &mut Scene) -> Result<Action, Diagnostic> {
    if args.choice("a word for `watch`", &["on", "off"])? == 1 {
        return Ok(action(|session| session.simulation.watch = None));
    }
    let mut watch = Watch { trouble: Trouble::default(), retries: 8, interval: 25 };
    while args.remaining() > 0 {
        let options = ["volume", "speed", "strain", "retries", "interval"];
        match args.choice("an option of `watch`", &options)? {
            0 => watch.trouble.volume = args.within("the largest J", 1.0, f64::INFINITY)?.value,
            1 => watch.trouble.speed = args.positive("the largest speed")?.value,
            2 => watch.trouble.strain = args.positive("the largest strain of a step")?.value,
            3 => watch.retries = args.count("the number of attempts", 0)?.min(1000) as u32,
            _ => watch.interval = args.count("the steps between copies", 1)?,
        }
    }
    Ok(action(move |session| session.simulation.watch = Some(watch)))
}
