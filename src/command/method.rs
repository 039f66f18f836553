//! `method`, `scheme` and what goes with them.

use super::domain::available;
use super::scene::Scene;
use super::{Action, action};
use crate::method::{METHODS, Method, MethodKind};
use crate::model::domain::Domain;
use crate::scheme::{SCHEMES, SchemeKind};
use crate::script::arguments::{Args, Name};
use crate::script::diagnostic::{Code, Diagnostic};
use crate::script::source::Span;
use crate::shape::corners::{self, DOMAINS};
use crate::shape::{DomainKind, SHAPES, ShapeKind};
use crate::simulation::Simulation;
use crate::style;
use crate::time_step;
use crate::transfer::{TRANSFERS, Transfer, TransferKind};

/// Most terms of the filter of XPIC: binomial coefficients stay exact.
const MOST_TERMS: u64 = 40;

/// Method and transfer as the script chose them.
#[derive(Clone, Copy)]
pub struct Choice {
    /// The method.
    pub method: Method,
    /// The transfer.
    pub transfer: Transfer,
    /// The domain of CPDI, where it was given.
    pub domain: Option<ChosenDomain>,
}

/// A domain of CPDI that the script chose.
#[derive(Clone, Copy)]
pub struct ChosenDomain {
    span: Span,
    dimensions: &'static [usize],
    /// Corners that the elements of every body must have.
    pub corners: Option<usize>,
}

impl Choice {
    /// Sets method and transfer; what other commands say of the method stays.
    pub fn take_effect(self, simulation: &mut Simulation) {
        let Method { averaged_dilation, axisymmetric, .. } = simulation.world.method;
        simulation.set_method(Method { averaged_dilation, axisymmetric, ..self.method });
        simulation.transfer = self.transfer;
    }
}

impl Default for Choice {
    /// What old scripts without `method` mean: `method(tlmpm, FLIP, linear, 0.99)`.
    fn default() -> Self {
        let method = Method { total: true, ..Method::default() };
        Self { method, transfer: Transfer::new(TransferKind::Flip, 0.99), domain: None }
    }
}

/// `method(type, sub, shape [, alpha] [, option ...])`
pub fn method(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    if scene.method.is_some() {
        let message = "a second `method`";
        let label = match scene.solids.is_empty() {
            true => "the method is given above",
            false => "the method is given, or taken as the default by the first solid, above",
        };
        return Err(Diagnostic::error(Code::Duplicate, args.command.span, message).label(label));
    }
    if scene.domain.is_some() {
        let message = "`method` stands below `dimension`";
        args.remarks.push(
            Diagnostic::warning(Code::Compatibility, args.command.span, message)
                .label("accepted")
                .help("today `method` comes first, then `dimension`"),
        );
    }
    scene.method = Some(Choice::default());
    let word = args.word("a method type")?;
    let (_, MethodKind { total, corners }) = style::find("method", METHODS, &word)?;
    let kind = transfer_kind(args)?;
    let shape = shape(args)?;
    let mut transfer = blend(args, kind, None)?;
    let mut options = Options::default();
    while args.remaining() > 0 {
        options.read(args, &mut transfer)?;
    }
    let Options { conducts_heat, domain } = options;
    let kind = kind_of_shape(corners, shape, &domain, &word)?;
    let method = Method { total, shape: kind, conducts_heat, ..Method::default() };
    check_combination(&method, &transfer, &word, shape.0)?;
    let domain = domain.map(|(name, _)| ChosenDomain {
        span: name.span,
        dimensions: corners::dimensions_of(&name.text),
        corners: corners::corners_of(&name.text),
    });
    let choice = Choice { method, transfer, domain };
    scene.method = Some(choice);
    warn_if_fragile(args, scene);
    warn_if_locked(args, scene);
    Ok(action(move |session| choice.take_effect(&mut session.simulation)))
}

/// Reads the sub-method, with the number of terms of `XPIC`.
pub fn transfer_kind(args: &mut Args<'_>) -> Result<TransferKind, Diagnostic> {
    let word = args.word("a sub-method")?;
    let (_, kind) = style::find("transfer", TRANSFERS, &word)?;
    if !matches!(kind, TransferKind::Xpic(_)) {
        return Ok(kind);
    }
    let span = args.next_span();
    let terms = args.count("the number of terms m", 1)?;
    if terms > MOST_TERMS {
        let message = format!("at most {MOST_TERMS} terms are possible");
        return Err(Diagnostic::error(Code::Range, span, message).label("too many"));
    }
    Ok(TransferKind::Xpic(terms as u32))
}

/// Reads the shape function and where it stands.
pub fn shape(args: &mut Args<'_>) -> Result<(Span, ShapeKind), Diagnostic> {
    let word = args.word("a shape function")?;
    let (_, kind) = style::find("shape", SHAPES, &word)?;
    Ok((word.span, kind))
}

/// Reads alpha, or `time-constant, tau`, where the transfer takes one; `otherwise` where it may be
/// missing.
pub fn blend(
    args: &mut Args<'_>,
    kind: TransferKind,
    otherwise: Option<f64>,
) -> Result<Transfer, Diagnostic> {
    let mut transfer = Transfer::new(kind, 0.0);
    if !kind.takes_blend() {
        return Ok(transfer);
    }
    if let (0, Some(alpha)) = (args.remaining(), otherwise) {
        transfer.alpha = alpha;
    } else if args.keyword("time-constant") {
        transfer.time_constant = Some(args.positive("the time constant tau")?.value);
    } else {
        transfer.alpha = args.within("the blend alpha", 0.0, 1.0)?.value;
    }
    Ok(transfer)
}

/// The options of `method`.
#[derive(Default)]
struct Options {
    conducts_heat: bool,
    domain: Option<(Name, ShapeKind)>,
}

impl Options {
    /// Reads one of them.
    fn read(&mut self, args: &mut Args<'_>, transfer: &mut Transfer) -> Result<(), Diagnostic> {
        let number = args.peek().is_some_and(|word| word.parse::<f64>().is_ok());
        if number && !transfer.kind.takes_blend() {
            let message = "this sub-method has no blend alpha";
            return Err(Diagnostic::error(Code::Unread, args.next_span(), message)
                .label("an argument too many"));
        }
        let mut all = vec!["mechanical", "gradient-enhanced", "thermo-mechanical"];
        all.extend(DOMAINS.iter().map(|row| row.name));
        let word = available(args, "method option", &all, &all)?;
        match word.text.as_str() {
            "mechanical" => {}
            "thermo-mechanical" => self.conducts_heat = true,
            "gradient-enhanced" => {
                use TransferKind::{Flip, Pic, Xpic};
                if !matches!(transfer.kind, Pic | Flip | Xpic(_)) {
                    let message = "`gradient-enhanced` goes with PIC, FLIP and XPIC";
                    return Err(Diagnostic::error(Code::NotCombined, word.span, message)
                        .label("this sub-method carries an affine field already"));
                }
                transfer.gradient_enhanced = true;
            }
            _ => {
                let (_, kind) = style::find("domain", DOMAINS, &word)?;
                self.domain = Some((word, kind));
            }
        }
        Ok(())
    }
}

/// The shape function of a method; CPDI sees hats through the corners of a domain.
fn kind_of_shape(
    corners: bool,
    (span, shape): (Span, ShapeKind),
    domain: &Option<(Name, ShapeKind)>,
    method: &Name,
) -> Result<ShapeKind, Diagnostic> {
    match (corners, domain) {
        (false, None) => Ok(shape),
        (false, Some((word, _))) => {
            let message = format!("`{}` is a domain of `ulcpdi` and `tlcpdi`", word.text);
            Err(Diagnostic::error(Code::NotCombined, word.span, message)
                .label(format!("`{}` has no domains of particles", method.text)))
        }
        (true, _) if shape != ShapeKind::Linear => {
            let message = format!("`{}` goes with `linear` only", method.text);
            Err(Diagnostic::error(Code::NotCombined, span, message)
                .label("corners of domains see the nodes through hats"))
        }
        (true, Some((_, kind))) => Ok(*kind),
        (true, None) => Ok(ShapeKind::Corners(DomainKind::Parallel)),
    }
}

/// Refuses a domain of another dimension than the problem's, and CPDI where x is a radius.
pub fn check_domain(
    choice: &Choice,
    solid: Span,
    axisymmetric: bool,
    dimension: usize,
) -> Result<(), Diagnostic> {
    if axisymmetric && matches!(choice.method.shape, ShapeKind::Corners(_)) {
        let message = "`axisymmetric` does not go with `ulcpdi` and `tlcpdi`";
        return Err(Diagnostic::error(Code::NotCombined, solid, message)
            .label("means over its domains know no radius")
            .help("use `ulmpm` or `tlmpm`, for example with `gimp`"));
    }
    match choice.domain {
        Some(ChosenDomain { span, dimensions, .. }) if !dimensions.contains(&dimension) => {
            let known =
                DOMAINS.iter().filter(|row| corners::dimensions_of(row.name).contains(&dimension));
            let names: Vec<&str> = known.map(|row| row.name).collect();
            let message = format!("this domain is not for {dimension} dimensions");
            Err(Diagnostic::error(Code::DimensionMismatch, span, message)
                .label("another number of dimensions")
                .help(format!("in {dimension} dimensions: {}", names.join(", "))))
        }
        _ => Ok(()),
    }
}

/// Refuses what language.md 6.2 refuses.
fn check_combination(
    method: &Method,
    transfer: &Transfer,
    word: &Name,
    shape: Span,
) -> Result<(), Diagnostic> {
    if method.shape == ShapeKind::Bernstein && !method.total {
        let message = format!("`Bernstein-quadratic` does not go with `{}`", word.text);
        return Err(Diagnostic::error(Code::NotCombined, shape, message)
            .label("its slope jumps where particles cross cells")
            .help("use `tlmpm`, or a spline"));
    }
    if method.shape == ShapeKind::StretchedGimp && method.total {
        let message = format!("`cpgimp` with `{}` would be the same as `gimp`", word.text);
        return Err(Diagnostic::error(Code::NotCombined, shape, message)
            .label("weights belong to the reference places")
            .help("use `gimp`"));
    }
    if transfer.kind == TransferKind::Mls && !method.shape.is_spline() {
        let message = "`MLS` needs `quadratic-spline` or `cubic-spline`";
        return Err(Diagnostic::error(Code::NotCombined, shape, message)
            .label("has no moment matrix that can be inverted everywhere"));
    }
    Ok(())
}

/// Refuses lattices with too few nodes for the shape.
pub fn check_nodes(cells: &Domain, shape: ShapeKind, span: Span) -> Result<(), Diagnostic> {
    let counts = cells.cells();
    for axis in 0..cells.dimension {
        let nodes = counts[axis] * shape.nodes_per_cell() + 1;
        if nodes < shape.fewest_nodes() {
            let (name, least) = (["x", "y", "z"][axis], shape.fewest_nodes());
            let message =
                format!("splines need {least} nodes per axis; along {name} there are {nodes}");
            return Err(Diagnostic::error(Code::NotCombined, span, message)
                .label("too few cells")
                .help("take smaller cells, or `linear`"));
        }
    }
    Ok(())
}

/// Warns where no time step is stable for every place of a particle.
fn warn_if_fragile(args: &mut Args<'_>, scene: &Scene) {
    let Some(Choice { method, transfer, .. }) = scene.method else { return };
    let usl = scene.scheme == SchemeKind::Usl;
    let pushed = scene.scheme == SchemeKind::Usf && transfer.gradient_enhanced;
    if pushed && transfer.kind == TransferKind::Flip {
        let message = "`usf` with FLIP and `gradient-enhanced` is unstable";
        args.remarks.push(
            Diagnostic::warning(Code::UnstableStep, args.command.span, message)
                .label("gains energy at any time step")
                .help("`musl` and `usl` are stable, and so is PIC"),
        );
    }
    if time_step::is_fragile(&transfer, usl, method.shape) {
        let message = "no time step is stable for every place of a particle in its cell";
        let reason = match usl {
            true => "strains from v* see nodes with hardly any mass",
            false => "affine fields see nodes with hardly any mass",
        };
        args.remarks.push(
            Diagnostic::warning(Code::UnstableStep, args.command.span, message)
                .label(reason)
                .help("splines are stable, and so is `FLIP` with `musl`"),
        );
    }
}

/// `scheme(musl|usl|usf)`
pub fn scheme(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    scene.before_runs(args.command)?;
    let word = args.word("a scheme")?;
    let (_, scheme) = style::find("scheme", SCHEMES, &word)?;
    scene.scheme = scheme.kind();
    warn_if_fragile(args, scene);
    Ok(action(move |session| session.simulation.set_scheme(scheme)))
}

/// `thermal_blend(a)`
pub fn thermal_blend(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    let blend = args.within("the blend of temperatures", 0.0, 1.0)?.value;
    if scene.method.is_some_and(|choice| !choice.method.conducts_heat) {
        let message = "`thermal_blend` has no effect in a `mechanical` run";
        args.remarks.push(
            Diagnostic::warning(Code::NoEffect, args.command.span, message)
                .label("heat is conducted with the option `thermo-mechanical` of `method`"),
        );
    }
    Ok(action(move |session| session.simulation.world.thermal_blend = blend))
}

/// `anti_locking(none|fbar)`
pub fn anti_locking(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    averaged_dilation(args, scene, "a remedy for locking", ["none", "fbar"])
}

/// `anti_volumetric_locking(true|false)`, another word for `anti_locking`.
pub fn anti_volumetric_locking(
    args: &mut Args<'_>,
    scene: &mut Scene,
) -> Result<Action, Diagnostic> {
    averaged_dilation(args, scene, "truth value", ["false", "true"])
}

/// Warns where F-bar hardly helps: nodes of Bernstein polynomials stand half a cell apart, so that there are
/// as many averages as particles.
fn warn_if_locked(args: &mut Args<'_>, scene: &Scene) {
    let bernstein = scene.method.is_some_and(|c| c.method.shape == ShapeKind::Bernstein);
    if scene.averaged_dilation && bernstein {
        let message = "F-bar hardly unlocks Bernstein polynomials";
        args.remarks.push(
            Diagnostic::warning(Code::NoEffect, args.command.span, message)
                .label("their nodes average over half a cell")
                .help("it does with `linear` and with splines"),
        );
    }
}

/// Reads the word for off or on.
fn averaged_dilation(
    args: &mut Args<'_>,
    scene: &mut Scene,
    what: &str,
    words: [&str; 2],
) -> Result<Action, Diagnostic> {
    scene.before_runs(args.command)?;
    let averaged = args.choice(what, &words)? == 1;
    scene.averaged_dilation = averaged;
    warn_if_locked(args, scene);
    Ok(action(move |session| session.simulation.world.method.averaged_dilation = averaged))
}
