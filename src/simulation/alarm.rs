//! The alarm of the energy ledger.

use super::Simulation;
use crate::fault::Fault;
use crate::model::clock::Clock;
use crate::watch;

impl Simulation {
    /// Looks at the error of the ledger at the rows of the log, if a compute has set a limit.
    ///
    /// # Errors
    /// It is larger than the run may go on with.
    pub(super) fn mind_ledger(&mut self) -> Result<(), Fault> {
        let (alarm, error) = (self.plan.alarm, self.world.ledger.error());
        if error.abs() <= alarm.smaller() || !self.outputs.row_is_due(self.clock.step) {
            return Ok(());
        }
        let residual = self.world.ledger.residual();
        let clock = self.clock_of_last_step();
        let unbalanced = |bound| watch::unbalanced(error, residual, bound, &clock);
        if error.is_nan() || error.abs() > alarm.stop_above {
            return Err(unbalanced(alarm.stop_above));
        }
        if std::mem::replace(&mut self.alarmed, true) {
            return Ok(());
        }
        let warning = unbalanced(alarm.warn_above).what;
        self.outputs.warn(warning);
        Ok(())
    }

    /// The clock as it was in the step just done.
    pub(super) fn clock_of_last_step(&self) -> Clock {
        Clock { time: self.clock.time - self.clock.dt, ..self.clock }
    }
}
