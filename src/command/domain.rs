//! `dimension` and settings of the whole scene.

use super::scene::Scene;
use super::{Action, action};
use crate::material::StressRate;
use crate::model::domain::{Boundary, Domain};
use crate::script::arguments::{Args, Name};
use crate::script::diagnostic::{Code, Diagnostic};
use crate::script::source::Span;
use crate::script::suggest;

/// Most cells along an axis: places in memory are found with 32 bits per axis.
const MOST_CELLS: f64 = 4e9;

/// Reads a word that must be one of `known`, of which only `available` can be used yet.
pub fn available(
    args: &mut Args<'_>,
    what: &str,
    known: &[&str],
    available: &[&str],
) -> Result<Name, Diagnostic> {
    let word = args.word(what)?;
    if available.contains(&word.text.as_str()) {
        return Ok(word);
    }
    if known.contains(&word.text.as_str()) {
        let message = format!("`{}` is known, but not available yet", word.text);
        return Err(Diagnostic::error(Code::NotAvailable, word.span, message)
            .label("not available yet")
            .help(format!("available: {}", available.join(", "))));
    }
    let otherwise = format!("one of {}", known.join(", "));
    Err(Diagnostic::error(Code::UnknownStyle, word.span, format!("unknown {what} `{}`", word.text))
        .label(format!("not a {what}"))
        .help(suggest::help(&word.text, known.iter().copied(), &otherwise)))
}

/// `dimension(d, xlo, xhi [, ylo, yhi [, zlo, zhi]], h)`
pub fn dimension(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    if scene.domain.is_some() {
        return Err(Diagnostic::error(Code::Duplicate, args.command.span, "a second `dimension`")
            .label("the box is given above"));
    }
    scene.tried.push("dimension");
    let dimension = args.count("the number of dimensions", 1)? as usize;
    if dimension > 3 {
        let message = format!("{dimension} dimensions: 1, 2 or 3 are possible");
        return Err(Diagnostic::error(Code::Range, args.span, message).label("too many dimensions"));
    }
    if args.remaining() == 0 {
        args.old_form("dimension(d, xlo, xhi, ..., h)");
        let mut nothing = Domain::nothing(dimension);
        nothing.cell = f64::NAN;
        scene.domain = Some(nothing);
        scene.box_follows_solids = true;
        return Ok(action(move |session| session.simulation.set_domain(nothing)));
    }
    let (lower, upper) = limits(args, dimension)?;
    if args.remaining() == 0 && dimension > 1 {
        // The old form: the first solid brings the cell size.
        args.old_form("dimension(d, xlo, xhi, ylo, yhi, h)");
        scene.domain = Some(Domain { dimension, lower, upper, cell: f64::NAN });
        return Ok(action(|_| ()));
    }
    let span = args.next_span();
    let cell = args.positive("the cell size h")?.value;
    let domain = Domain { dimension, lower, upper, cell };
    check_cells(&domain, span)?;
    scene.domain = Some(domain);
    Ok(action(move |session| session.simulation.set_domain(domain)))
}

/// Reads the limits of the box on each axis.
fn limits(args: &mut Args<'_>, dimension: usize) -> Result<([f64; 3], [f64; 3]), Diagnostic> {
    let (mut lower, mut upper) = ([0.0; 3], [0.0; 3]);
    for axis in 0..dimension {
        let name = ["x", "y", "z"][axis];
        let low = args.number(&format!("the lower {name} limit"))?;
        let high = args.number(&format!("the upper {name} limit"))?;
        if low.known && high.known && low.value >= high.value {
            return Err(args.out_of_range(
                &high,
                &format!("the upper {name} limit must lie above the lower one, {}", low.value),
            ));
        }
        (lower[axis], upper[axis]) = (low.value, high.value);
    }
    Ok((lower, upper))
}

/// `create_domain(xlo, xhi, ...[, h])`, an old form: the box of `dimension(d)`.
pub fn create_domain(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    let mut domain = scene.need_domain(args.command)?;
    if !scene.box_follows_solids || !scene.solids.is_empty() {
        let message = "`create_domain` gives the box of an old `dimension(d)`, above all solids";
        return Err(Diagnostic::error(Code::Order, args.command.span, message)
            .label("the box is known already"));
    }
    args.old_form("dimension(d, xlo, xhi, ..., h)");
    (domain.lower, domain.upper) = limits(args, domain.dimension)?;
    if scene.axisymmetric {
        check_radius(&domain, args.command.span)?;
    }
    // Old scripts give all three axes; the surplus ones do not count.
    let surplus = 2 * (3 - domain.dimension);
    if args.remaining() >= surplus {
        for _ in 0..surplus {
            args.number("a limit")?;
        }
    }
    let span = args.next_span();
    if args.remaining() > 0 {
        domain.cell = args.positive("the cell size h")?.value;
        check_cells(&domain, span)?;
    }
    scene.box_follows_solids = false;
    scene.domain = Some(domain);
    Ok(action(move |session| session.simulation.set_domain(domain)))
}

/// Refuses cells so small that the nodes of the box cannot be numbered.
pub fn check_cells(domain: &Domain, span: Span) -> Result<(), Diagnostic> {
    let cells = |axis: usize| (domain.upper[axis] - domain.lower[axis]) / domain.cell;
    let longest = (0..domain.dimension).map(cells).fold(0.0, f64::max);
    if longest < MOST_CELLS {
        return Ok(());
    }
    let message = format!("the box has {longest:.3e} cells along one axis");
    Err(Diagnostic::error(Code::TooLarge, span, message)
        .label("the cell size is too small for the box"))
}

/// The manual of `axisymmetric`.
pub const AXISYMMETRIC: &str = "\
Two dimensions: x is the radius r, y lies along the axis, 33 (tt) is the hoop. A particle of area A
has V0 = r0 A and m = rho0 V0, so masses, volumes, momenta, forces, energies and what sums of them
are (dumps, logs, results of fixes and computes) are those of one radian: 2 PI times as much goes all
round. `force_nodes` takes its total per radian, `xcm` weighs places with these masses.
  L_tt = sum v_r N/r, f_r -= V sigma_tt N/r    (tlmpm: r0 and P_tt; MLS: the v_r that moves r)
F33, J, tr L, every law and F-bar (d = 3) see the hoop.
The axis: nodes at x = 0 have v_r = 0, always and after all fixes; no fix is needed there, and none
can move it. Along the axis they are free. A box that begins at x > 0 has no axis: its first nodes
are free. Regions that reach beyond the axis are cut there. With ASFLIP particles follow velocities
of their own and may cross the axis, which stops a run of `ulmpm` unless `boundary` says otherwise.
Volumes of meshes, lists and rings are taken as areas; `translate_particles` makes V0 and m follow r.
Uniform sigma_rr = sigma_tt pulls no node inside a body whose particles lie on their lattice: with
hats exactly, with splines from the fourth node off the axis on.
The stable time step is that of plane strain within 2 %. Stands above the solids.
Source: Karamelo's rule; Nairn and Guilkey 2015 for the weight r.";

/// `axisymmetric(true|false)`
pub fn axisymmetric(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    scene.before_runs(args.command)?;
    let span = args.next_span();
    let axisymmetric = args.choice("truth value", &["false", "true"])? == 1;
    if axisymmetric != scene.axisymmetric && !scene.solids.is_empty() {
        let message = "`axisymmetric` stands below a solid";
        return Err(Diagnostic::error(Code::Order, args.command.span, message)
            .label("too late: the volumes of the particles are known"));
    }
    if axisymmetric {
        let domain = scene.need_domain(args.command)?;
        if domain.dimension != 2 {
            let message =
                format!("`axisymmetric` needs two dimensions; there are {}", domain.dimension);
            return Err(Diagnostic::error(Code::DimensionMismatch, span, message)
                .label("x is the radius and y lies along the axis"));
        }
        check_radius(&domain, args.command.span)?;
    }
    scene.axisymmetric = axisymmetric;
    Ok(action(move |session| session.simulation.world.method.axisymmetric = axisymmetric))
}

/// Refuses a box with negative radii.
fn check_radius(domain: &Domain, span: Span) -> Result<(), Diagnostic> {
    if domain.lower[0] >= 0.0 {
        return Ok(());
    }
    let message = format!("the box begins at the radius x = {}", domain.lower[0]);
    Err(Diagnostic::error(Code::Range, span, message)
        .label("needs a box whose lower x limit is not negative")
        .help("bodies round the axis begin at x = 0: `dimension(2, 0, xhi, ylo, yhi, h)`"))
}

/// `boundary(error|delete|bounce)`
pub fn boundary(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    let policies = [Boundary::Error, Boundary::Delete, Boundary::Bounce];
    let boundary = policies[args.choice("boundary policy", &["error", "delete", "bounce"])?];
    if boundary != Boundary::Error && scene.method.is_some_and(|choice| choice.method.total) {
        let message = "`boundary` has no effect in total Lagrangian methods";
        args.remarks.push(
            Diagnostic::warning(Code::NoEffect, args.command.span, message)
                .label("the box is for outputs only"),
        );
    }
    Ok(action(move |session| session.simulation.world.boundary = boundary))
}

/// `stress_rate(r)`
pub fn stress_rate(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    scene.before_runs(args.command)?;
    let words = ["none", "jaumann", "green_naghdi", "logarithmic"];
    let rates =
        [StressRate::None, StressRate::Jaumann, StressRate::GreenNaghdi, StressRate::Logarithmic];
    let rate = rates[args.choice("stress rate", &words)?];
    if scene.method.is_some_and(|choice| choice.method.total) {
        let message = "`stress_rate` has no effect in total Lagrangian methods";
        args.remarks.push(
            Diagnostic::warning(Code::NoEffect, args.command.span, message)
                .label("the rate is always that of Green and Naghdi"),
        );
    }
    Ok(action(move |session| session.simulation.set_rate(rate)))
}
