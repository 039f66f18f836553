//! What all processes of a run decide together.

use super::Simulation;
use crate::fault::Fault;
use crate::interrupt;
use crate::kernel::points;
use crate::kernel::tiles::Report;
use crate::scheme::SchemeKind;
use crate::time_step::{self, Limit, TimeStep};

/// Numbers of a report that limit the time step; of each the largest counts.
const NUMBERS: usize = 5;

fn numbers(report: &Report) -> [f64; NUMBERS] {
    let Report { fastest, thinnest, rate, viscosity, diffusivity, .. } = *report;
    // What is not a number allows no step.
    [fastest, -thinnest, rate, viscosity, diffusivity]
        .map(|number| if number.is_nan() { f64::INFINITY } else { number })
}

fn report(numbers: &[f64; NUMBERS]) -> Report {
    let [fastest, thinnest, rate, viscosity, diffusivity] = *numbers;
    Report { fastest, thinnest: -thinnest, rate, viscosity, diffusivity, ..Report::default() }
}

impl Simulation {
    /// All processes learn of the first fault of the step, of the user's wish to stop, and how large
    /// the next step may be.
    ///
    /// # Errors
    /// The fault of a process.
    pub(super) fn end_step(&mut self) -> Result<(), Fault> {
        let mut agreed = std::mem::take(&mut self.loops.numbers);
        agreed.clear();
        agreed.extend([f64::from(interrupt::requested()), self.stiffest()]);
        if self.fixed_dt.is_none() {
            agreed.extend(self.loops.limits.iter().flat_map(numbers));
        }
        let result = self.world.ranks.agree(self.loops.fault.take(), &mut agreed);
        self.interrupted = agreed[0] > 0.0;
        self.next = Some(match self.fixed_dt {
            Some(dt) => TimeStep { dt, limit: Limit::Fixed },
            None => self.stable(agreed[1], &agreed[2..]),
        });
        self.loops.numbers = agreed;
        result
    }

    /// The stable step of the present state: for the first step of a run, `check` and warnings.
    pub fn stable_now(&self) -> TimeStep {
        let mut agreed = vec![self.stiffest()];
        agreed.extend(points::at_rest(&self.world).iter().flat_map(numbers));
        if let Some(exchange) = self.world.ranks.exchange() {
            exchange.largest(&mut agreed);
        }
        self.stable(agreed[0], &agreed[1..])
    }

    /// -dt of the stiffest contact \[T\].
    fn stiffest(&self) -> f64 {
        self.fixes.iter().map(|(_, fix)| -fix.largest_step()).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The smallest of the stable steps of the lattices and of contacts.
    fn stable(&self, stiffest: f64, limits: &[f64]) -> TimeStep {
        let dimension = self.world.domain.dimension;
        let sizes = self.world.solids.iter().map(|solid| 0.5 / solid.particles_per_cell);
        let courant = time_step::courant(
            &self.transfer,
            self.scheme.kind() == SchemeKind::Usl,
            self.world.method.shape,
            sizes.fold(0.5, f64::min),
            dimension,
        );
        let cell = |lattice: usize| match self.world.method.total {
            true => self.world.solids[lattice].cells.cell,
            false => self.world.domain.cell,
        };
        let factor = self.dt_factor * courant;
        let reports = limits.as_chunks::<NUMBERS>().0.iter().map(report).enumerate();
        let steps = reports
            .map(|(lattice, report)| time_step::stable(&report, cell(lattice), dimension, factor));
        let contact = TimeStep { dt: -stiffest, limit: Limit::Contact };
        let none = TimeStep { dt: f64::INFINITY, limit: Limit::Acoustic };
        let all = steps.chain(std::iter::once(contact));
        all.fold(none, |least, step| if step.dt < least.dt { step } else { least })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_which_the_largest_counts_hold_a_report() {
        let one = Report { fastest: 3.0, thinnest: 0.5, rate: 2.0, ..Report::default() };
        assert_eq!(report(&numbers(&one)), one);
        assert_eq!(numbers(&Report { rate: f64::NAN, ..one })[2], f64::INFINITY);
    }
}
