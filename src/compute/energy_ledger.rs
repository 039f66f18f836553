//! Where the energy of a run goes.

use super::{BuildCompute, Compute};
use crate::fix::GroupKind;
use crate::plan::{Alarm, Plan};
use crate::style::Style;
use crate::world::World;

/// The row of the table.
pub const STYLE: Style<BuildCompute> = Style {
    name: "energy_ledger",
    usage: "[warn_above, error] [, stop_above, error]",
    summary: "where the energy goes: kinetic, stored, lost, work put in [M L^2/T^2]",
    manual: "\
Acts on `all`. Kept from the first run below it on; a scene without it pays nothing.
  ID_kinetic    sum m v^2/2 of the particles
  ID_stored     what the stress can give back: its work less its losses below
  ID_plastic    sum V q dep
  ID_viscous    work against artificial viscosity and the viscosity of fluids
  ID_damage     once D > 0: work less losses less what the law still stores
  ID_friction   work against friction in `contact`
  ID_damping    work against `damping_nodes` and `damping_local_nodes`
  ID_heat       the part of ID_plastic that became heat (not counted twice)
  ID_external   work done by forces: body forces, nodal forces, tools, particle contact
  ID_boundary   work done by prescribed velocities, and energy of particles that left
  ID_numerical  kinetic energy lost on the way from particles to nodes and back (PIC, FLIP < 1)
  ID_residual   kinetic + stored + losses + numerical - external - boundary, less its start
  ID_error      residual over the largest term so far
The stress works V0 (P + P') : (F' - F)/2 in a step, P = J sigma F^-T: of a law with a stored energy
it is the change of that energy but for dt^2. Of laws with damage the stored energy is known only
roughly, so that ID_stored and ID_damage share an error of theirs. Nodal forces work f . w dt with
the mean w = (p + p')/(2 m) of the momenta that the particles bring before and after (with `usl`,
and with MLS under `musl`, w = (v + v*)/2). FLIP with alpha = 1 then gains that work to the last
digit. So the residual is the error of the time integration alone: the work of the stress on the
particles less that of the internal forces on the nodes, taken in the middle of a step, to which
velocities belong. It falls with dt: it is energy that moving particles over a grid makes or
destroys, most with linear shapes. The columns of one row add up to it but for half the last step's work.
`stop_above, error` ends the run at the first row of the log where |ID_error| is larger, naming step and
residual (`watch(on)` then tries again with smaller steps); `warn_above, error` warns once in a run. In its
first steps a run that starts from nothing has no term to compare with: let rows of the log lie some steps
apart.",
    build: Some(|args, target| {
        target.require("energy_ledger", &[GroupKind::All])?;
        let mut alarm = Alarm::default();
        while args.remaining() > 0 {
            let word = args.choice("a bound", &["warn_above", "stop_above"])?;
            let bound = args.positive("the largest ID_error")?.value;
            match word {
                0 => alarm.warn_above = bound,
                _ => alarm.stop_above = bound,
            }
        }
        Ok(Box::new(EnergyLedger { alarm }))
    }),
};

/// Reads the ledger of the world.
#[derive(Default)]
pub struct EnergyLedger {
    /// Bounds on the error.
    pub alarm: Alarm,
}

impl Compute for EnergyLedger {
    fn suffixes(&self) -> &'static [&'static str] {
        &[
            "_kinetic",
            "_stored",
            "_plastic",
            "_viscous",
            "_damage",
            "_friction",
            "_damping",
            "_heat",
            "_external",
            "_boundary",
            "_numerical",
            "_residual",
            "_error",
        ]
    }

    fn needs(&self, plan: &mut Plan, _dimension: usize) {
        plan.ledger = true;
        plan.alarm = plan.alarm.merged(self.alarm);
    }

    fn evaluate(&self, world: &World, out: &mut [f64]) {
        let ledger = &world.ledger;
        let sums = &ledger.sums;
        out.copy_from_slice(&[
            sums.kinetic,
            sums.stored,
            sums.plastic,
            sums.viscous,
            sums.damage,
            sums.friction,
            sums.damping,
            sums.heat,
            sums.external,
            sums.boundary,
            sums.numerical,
            ledger.residual(),
            ledger.error(),
        ]);
    }
}
