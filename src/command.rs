//! Commands: every word a script may call (language.md 5).
//!
//! A command is read by one function, which is used twice: in the rehearsal, before anything
//! happens, and when the script is performed. Reading declares names in the [`Scene`] and gives
//! an [`Action`], which only the performance applies.

mod compatibility;
pub mod contact;
mod domain;
mod files;
mod hook;
mod law;
mod manual;
mod matter;
mod method;
mod output;
mod particles;
pub mod play;
pub mod restart;
mod run;
pub mod scene;
pub mod session;
pub mod setting;
mod solid;
mod watch;

use crate::script::arguments::Args;
use crate::script::diagnostic::Diagnostic;
use crate::style::Style;
use scene::Scene;
use session::{Session, Stop};

/// What a statement does when it is performed.
pub type Action = Box<dyn FnOnce(&mut Session) -> Result<(), Stop>>;

/// Reads a command's arguments.
pub type Read = fn(&mut Args<'_>, &mut Scene) -> Result<Action, Diagnostic>;

/// An action that cannot fail.
fn action(act: impl FnOnce(&mut Session) + 'static) -> Action {
    Box::new(move |session| {
        act(session);
        Ok(())
    })
}

const fn row(
    name: &'static str,
    usage: &'static str,
    summary: &'static str,
    read: Read,
) -> Style<Read> {
    Style { name, usage, summary, manual: "", build: Some(read) }
}

const fn reserved(name: &'static str, usage: &'static str, summary: &'static str) -> Style<Read> {
    Style { name, usage, summary, manual: "", build: None }
}

const fn explained(row: Style<Read>, manual: &'static str) -> Style<Read> {
    Style { name: row.name, usage: row.usage, summary: row.summary, manual, build: row.build }
}

/// All commands.
pub const COMMANDS: &[Style<Read>] = &[
    explained(
        row(
            "method",
            "type, sub, shape [, alpha] [, option ...]",
            "the method, the transfer of velocities and the shape function",
            method::method,
        ),
        manual::METHOD,
    ),
    explained(
        row("scheme", "musl|usl|usf", "the order of the parts of a step", method::scheme),
        manual::SCHEME,
    ),
    explained(
        row(
            "dimension",
            "d, xlo, xhi [, ylo, yhi [, zlo, zhi]], h",
            "number of dimensions, box and cell size [L]",
            domain::dimension,
        ),
        manual::DIMENSION,
    ),
    explained(
        row(
            "axisymmetric",
            "true|false",
            "2-D with x as the radius: everything per radian",
            domain::axisymmetric,
        ),
        domain::AXISYMMETRIC,
    ),
    explained(
        row(
            "stress_rate",
            "none|jaumann|green_naghdi|logarithmic",
            "the objective rate of hypoelastic laws",
            domain::stress_rate,
        ),
        manual::STRESS_RATE,
    ),
    explained(
        row("anti_locking", "none|fbar", "a remedy for volumetric locking", method::anti_locking),
        manual::ANTI_LOCKING,
    ),
    row(
        "anti_volumetric_locking",
        "true|false",
        "another word for anti_locking",
        method::anti_volumetric_locking,
    ),
    explained(
        row(
            "thermal_blend",
            "a",
            "temperatures from increments (1) or interpolation (0), 0.99",
            method::thermal_blend,
        ),
        "T_p <- a (T_p + sum N (T* - T)) + (1 - a) sum N T*. Interpolation conducts by itself, like a
diffusivity of about (1 - a) h^2/dt: with the short steps of metals the default outweighs the
material. Where conduction counts write thermal_blend(1).",
    ),
    explained(
        row(
            "boundary",
            "error|delete|bounce",
            "particles that leave the box stop the run, are removed, or are reflected",
            domain::boundary,
        ),
        "For `ulmpm`. `error` (default): a particle whose centre leaves the box stops the run.
`delete`: it is removed; the end of the log tells how many were. `bounce`: x <- 2 w - x and v <- -v
on the axis of the wall w; meant for loose particles: hold a body with `velocity_nodes`. The wall of
`bounce` is no force on the nodes: what it does to a particle that neighbours push is in no balance,
and bodies lose energy or gain some (a block on hats: two and a half times what it came with).",
    ),
    explained(
        row("region", "ID, style, ...", "a set of points", matter::region),
        manual::REGION,
    ),
    row("eos", "ID, style, ...", "an equation of state", law::eos),
    row("strength", "ID, style, ...", "a strength law", law::strength),
    row("damage", "ID, style, ...", "a damage law", law::damage),
    row("temperature", "ID, style, ...", "a temperature law", law::temperature),
    explained(
        row("material", "ID, style, ...", "a material law", law::material),
        manual::MATERIAL,
    ),
    explained(
        row(
            "solid",
            "ID, region, regionID, ppc, matID, h [, T0] | ID, mesh|file, name, matID, h [, T0]",
            "a body: particles in a region, of the elements of a mesh, or as a file lists them",
            solid::solid,
        ),
        "region: ppc particles per cell and axis, of volume (h/ppc)^d, inside region and box.
mesh: Gmsh 2.2 or 4.1, ASCII; one particle per element of the problem's dimension, at its centroid
and with its volume between straight edges; lower dimensions are skipped.
file: lines `x [y [z]] volume`, `#` starts a comment.
Files are looked for in the working directory, then beside the script. h [L] is the cell size, T0
the temperature [K].",
    ),
    explained(
        row(
            "group",
            "ID, particles|nodes, region, regionID [, all | solid, s1, ...]",
            "particles or nodes that fixes and computes act on",
            matter::group,
        ),
        manual::GROUP,
    ),
    row(
        "create_domain",
        "xlo, xhi, ... [, h]",
        "old form: the box of `dimension(d)`",
        domain::create_domain,
    ),
    row(
        "delete_particles",
        "solid|all, region, ID",
        "removes the particles whose reference place is inside",
        particles::delete_particles,
    ),
    explained(
        row(
            "translate_particles",
            "solid|all, region, ID, dx, dy, dz",
            "moves the particles that are inside now [L]",
            particles::translate_particles,
        ),
        "Adds (dx, dy, dz), numbers or formulas of the place, to place and reference place. In
total Lagrangian methods only before the first run; the grid of a body that moves as a whole goes
with it.",
    ),
    explained(
        row(
            "populate_cylindrical_coordinates",
            "solid, region, [axis,] c1, c2, R, [lo, hi, Nx,] Nr, Ntheta, T0",
            "replaces the particles of a solid by rings around an axis",
            particles::populate,
        ),
        "Particles at r = (i+1/2) R/Nr, theta = 2 PI k/Ntheta and, in 3-D, lo + (j+1/2)(hi-lo)/Nx,
of volume r dr dtheta (dx), inside region and box; (c1, c2) as for the region style `cylinder`; T0
[K].",
    ),
    explained(
        row("fix", "ID, style, group, ...", "something that acts in every step", hook::fix),
        manual::FIX,
    ),
    row("delete_fix", "ID", "removes a fix", hook::delete_fix),
    explained(
        row("compute", "ID, style, group", "a number about particles", hook::compute),
        manual::COMPUTE,
    ),
    row("delete_compute", "ID", "removes a compute", hook::delete_compute),
    explained(
        row(
            "contact",
            "ID, stick|slip|frictional, s1, s2|all [, mu] [, on_nodes]",
            "bodies with velocities of their own on the grid stick or slide where they meet",
            contact::contact,
        ),
        contact::MANUAL,
    ),
    row("delete_contact", "ID", "removes a contact", contact::delete_contact),
    explained(
        row(
            "watch",
            "on|off [, option, X] ...",
            "looks for trouble before it is too late, goes back and tries smaller steps",
            watch::watch,
        ),
        watch::MANUAL,
    ),
    explained(
        row(
            "set_dt",
            "dt [, force] | auto",
            "a constant time step [T], or the adaptive one",
            run::set_dt,
        ),
        manual::SET_DT,
    ),
    explained(
        row("dt_factor", "f", "the part of the stable time step that is used, 0.9", run::dt_factor),
        manual::DT_FACTOR,
    ),
    row("run", "N", "runs N steps", run::run),
    explained(
        row("run_time", "T", "runs for a time [T]", run::run_time),
        manual::RUN_TIME,
    ),
    explained(
        row("run_while", "condition", "runs while the condition holds", run::run_while),
        manual::CONDITION,
    ),
    explained(
        row("run_until", "condition", "runs until the condition holds", run::run_until),
        manual::CONDITION,
    ),
    row("set_output", "N", "a log row every N steps; 0: first and last", output::set_output),
    row("log", "N", "old form of set_output", output::log),
    explained(
        row("log_modify", "default | custom, name, ...", "columns of the log", output::log_modify),
        manual::LOG_MODIFY,
    ),
    explained(
        row("dump", "ID, group, style, N, file, field, ...", "a series of files", output::dump),
        manual::DUMP,
    ),
    row("undump", "ID", "ends a dump", output::undump),
    explained(
        row("plot", "ID, N, xname, yname", "a curve", output::plot),
        manual::PLOT,
    ),
    explained(
        row("save_plot", "file", "one figure of all curves", output::save_plot),
        manual::SAVE_PLOT,
    ),
    explained(
        row("print", "expression | \"text\"", "prints a value or a text", output::print),
        manual::PRINT,
    ),
    row(
        "method_modify",
        "sub [, shape [, alpha]]",
        "old form: changes the transfer",
        compatibility::method_modify,
    ),
    explained(
        row("restart", "N, file", "a restart file every N steps; 0: no more", restart::restart),
        restart::MANUAL,
    ),
    explained(
        row("write_restart", "file", "a restart file now", restart::write_restart),
        restart::MANUAL,
    ),
    explained(
        row("read_restart", "file", "goes on from a restart file", restart::read_restart),
        restart::MANUAL,
    ),
    reserved("include", "file", "the text of another script"),
    reserved("partition_domain", "...", "cuts the box for ranks"),
    reserved("dump_modify", "...", "changes a dump"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_has_one_row_a_usage_and_a_summary() {
        for (index, command) in COMMANDS.iter().enumerate() {
            assert!(COMMANDS[..index].iter().all(|other| other.name != command.name));
            assert!(!command.summary.is_empty(), "{}", command.name);
        }
    }
}
