//! The adaptive time step (language.md 9.5) and what limits it.

use crate::kernel::tiles::Report;
use crate::model::checkpoint::Checkpoint;
use crate::shape::ShapeKind;
use crate::transfer::Transfer;

/// What binds the time step: log column `dt_limit`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// `set_dt`.
    Fixed,
    /// A wave and the particles may not cross more than a cell: h/(c + |v|).
    Acoustic,
    /// Viscous momentum may not cross more than a cell: 3 rho h^2/(8 d mu).
    Viscous,
    /// Heat may not cross more than a cell: rho cp h^2/(2 d kappa).
    Thermal,
    /// det(I + dt L) stays positive: 0.3/||L||.
    Rate,
    /// Contact and tools are springs: 0.2 sqrt(m/k).
    Contact,
    /// A step is at most 1.1 times the one before.
    Growth,
    /// `run_time` lands on its end.
    End,
    /// A step was given up and is tried again with a smaller one (`watch`).
    Rescue,
}

impl Limit {
    /// All, in the order of definition.
    pub const ALL: [Limit; 9] = [
        Limit::Fixed,
        Limit::Acoustic,
        Limit::Viscous,
        Limit::Thermal,
        Limit::Rate,
        Limit::Contact,
        Limit::Growth,
        Limit::End,
        Limit::Rescue,
    ];

    /// The word in the log.
    pub fn name(self) -> &'static str {
        match self {
            Limit::Fixed => "fixed",
            Limit::Acoustic => "acoustic",
            Limit::Viscous => "viscous",
            Limit::Thermal => "thermal",
            Limit::Rate => "rate",
            Limit::Contact => "contact",
            Limit::Growth => "growth",
            Limit::End => "end",
            Limit::Rescue => "rescue",
        }
    }
}

impl Limit {
    /// Puts a limit into a checkpoint, or takes it from there.
    pub fn keep(limit: &mut Option<Limit>, checkpoint: &mut Checkpoint) {
        let mut number = limit.map(|limit| limit as u16);
        checkpoint.option("limit", &mut number);
        *limit = number.and_then(|number| Limit::ALL.get(usize::from(number)).copied());
        if limit.is_none() && number.is_some() {
            checkpoint.refuse("a time step has an unknown limit");
        }
    }
}

/// A step size \[T\] and what limits it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeStep {
    /// The size \[T\].
    pub dt: f64,
    /// What binds it.
    pub limit: Limit,
}

impl TimeStep {
    /// Puts a step into a checkpoint, or takes it from there.
    pub fn keep(step: &mut Option<TimeStep>, checkpoint: &mut Checkpoint) {
        let mut dt = step.map(|step| step.dt);
        let mut limit = step.map(|step| step.limit);
        checkpoint.option("dt", &mut dt);
        Limit::keep(&mut limit, checkpoint);
        *step = match (dt, limit) {
            (Some(dt), Some(limit)) => Some(TimeStep { dt, limit }),
            (None, None) => None,
            _ => return checkpoint.refuse("the next time step has no known limit"),
        };
    }
}

/// Largest growth from one step to the next.
const GROWTH: f64 = 1.1;

/// Largest ||L|| dt: keeps det(I + dt L) > 0.
const RATE: f64 = 0.3;

/// Largest stable Courant number below 1 for any place of a particle in its cell, from a spectral
/// analysis of a bar; 1 where it is larger, or where no step is stable ([`is_fragile`]).
///
/// An isolated particle bounds it too: 2/sqrt(d S), S = h^2 sum |grad N|^2/N at the worst place. With
/// domains S <= 2 + 2/l (GIMP), 2 + 1/l (CPDI), l = `half` their smallest half size in cells.
pub fn courant(
    transfer: &Transfer,
    usl: bool,
    shape: ShapeKind,
    half: f64,
    dimension: usize,
) -> f64 {
    let affine = transfer.is_affine();
    let of_domains = if affine { 0.70 } else { 0.53 };
    let (analysis, worst) = match shape {
        ShapeKind::Gimp | ShapeKind::StretchedGimp if affine || usl => {
            (of_domains, 2.0 + 2.0 / half)
        }
        ShapeKind::Corners(_) if affine || usl => (of_domains, 2.0 + 1.0 / half),
        ShapeKind::Quadratic if affine && usl => (1.0, 6.0),
        ShapeKind::Quadratic if affine => (1.0, 6.0),
        ShapeKind::Quadratic if usl => (0.62, 6.0),
        ShapeKind::Cubic if affine || usl => (1.0, 3.15),
        _ => return 1.0,
    };
    let isolated = 2.0 / (dimension as f64 * worst).sqrt();
    f64::min(analysis, isolated)
}

/// Is no step stable for every place of a particle? Hats with strains from v*, and hats or
/// Bernstein polynomials with affine fields.
pub fn is_fragile(transfer: &Transfer, usl: bool, shape: ShapeKind) -> bool {
    let products = matches!(shape, ShapeKind::Linear | ShapeKind::Bernstein);
    products && (usl || transfer.is_affine())
}

/// The stable step for what the last sweep found: f h s/(c + |v|), f 3 rho h^2/(8 d mu),
/// f rho cp h^2/(2 d kappa) and 0.3/||L||.
pub fn stable(report: &Report, cell: f64, dimension: usize, factor: f64) -> TimeStep {
    let cell = cell * report.thinnest.sqrt();
    let acoustic = factor * cell / report.fastest;
    let viscous = factor * 3.0 * cell * cell / (8.0 * dimension as f64 * report.viscosity);
    let thermal = factor * cell * cell / (2.0 * dimension as f64 * report.diffusivity);
    let rate = RATE / report.rate.sqrt();
    let mut least = TimeStep { dt: acoustic, limit: Limit::Acoustic };
    let others = [(viscous, Limit::Viscous), (thermal, Limit::Thermal), (rate, Limit::Rate)];
    for (dt, limit) in others {
        if dt < least.dt {
            least = TimeStep { dt, limit };
        }
    }
    least
}

/// Keeps the step from growing too fast.
pub fn limit_growth(next: TimeStep, before: f64) -> TimeStep {
    if next.dt > GROWTH * before {
        TimeStep { dt: GROWTH * before, limit: Limit::Growth }
    } else {
        next
    }
}

/// Watches for a step that collapses.
#[derive(Clone, Copy, Debug, Default)]
pub struct Floor {
    first: Option<f64>,
    below: u32,
}

impl Floor {
    /// Puts it into a checkpoint, or takes it from there.
    pub fn keep(&mut self, checkpoint: &mut Checkpoint) {
        checkpoint.option("first", &mut self.first);
        checkpoint.number("below", &mut self.below);
    }

    /// True if the step has been below 1e-6 of the first one for 100 steps.
    pub fn collapsed(&mut self, dt: f64) -> bool {
        let first = *self.first.get_or_insert(dt);
        self.below = if dt < 1e-6 * first { self.below + 1 } else { 0 };
        self.below >= 100
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smaller_limit_binds() {
        let slow = Report { fastest: 10.0, rate: 1.0, ..Report::default() };
        assert_eq!(stable(&slow, 0.5, 2, 0.9), TimeStep { dt: 0.045, limit: Limit::Acoustic });
        let sheared = Report { fastest: 10.0, rate: 1e4, ..Report::default() };
        assert_eq!(stable(&sheared, 0.5, 2, 0.9), TimeStep { dt: 0.003, limit: Limit::Rate });
    }

    #[test]
    fn viscosity_bounds_the_step() {
        let report = Report { fastest: 1.0, viscosity: 6.0, ..Report::default() };
        let exact = 0.9 * 3.0 * 0.25 / (8.0 * 2.0 * 6.0);
        let found = stable(&report, 0.5, 2, 0.9);
        assert_eq!(found.limit, Limit::Viscous);
        assert!((found.dt - exact).abs() < 1e-15);
    }

    #[test]
    fn conduction_bounds_the_step() {
        let report = Report { fastest: 1.0, diffusivity: 6.0, ..Report::default() };
        let exact = 0.9 * 0.25 / (2.0 * 3.0 * 6.0);
        let found = stable(&report, 0.5, 3, 0.9);
        assert_eq!(found.limit, Limit::Thermal);
        assert!((found.dt - exact).abs() < 1e-15);
    }

    #[test]
    fn growth_is_limited_and_shrinking_is_not() {
        let next = TimeStep { dt: 2.0, limit: Limit::Acoustic };
        assert_eq!(limit_growth(next, 1.0), TimeStep { dt: 1.1, limit: Limit::Growth });
        assert_eq!(limit_growth(next, 4.0), next);
    }

    #[test]
    fn a_hundred_tiny_steps_are_a_collapse_but_ninety_nine_are_not() {
        let mut floor = Floor::default();
        assert!(!floor.collapsed(1.0));
        assert!((0..99).all(|_| !floor.collapsed(1e-7)));
        assert!(floor.collapsed(1e-7));
        assert!(!floor.collapsed(1e-5));
    }
}
