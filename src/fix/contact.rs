//! Contact of the particles of two solids (language.md 7.4).

pub mod hertz;
pub mod minimize_penetration;

use super::{Fix, Target};
use crate::fault::Fault;
use crate::kernel::pairs::{PairLaw, Pairs, Totals};
use crate::math::exact_sum::ExactSum;
use crate::model::checkpoint::Checkpoint;
use crate::model::column::Column;
use crate::plan::Plan;
use crate::step::{Stage, Step};
use crate::world::{Solid, World};

/// A dt of contact is this part of sqrt(m/k).
const PENALTY: f64 = 0.2;

/// Largest stable step \[T\] of a stiffness over mass `rate` = k/m: 0.2 sqrt(m/k).
pub fn largest_step(rate: f64) -> f64 {
    PENALTY / rate.sqrt()
}

/// What one kind of contact brings to the common fix.
pub trait ContactStyle: Send {
    /// Its law of a pair.
    type Law: PairLaw;

    /// The law for two solids in a step of size dt; `longest` is the longest step since they met.
    fn law(&self, solids: [&Solid; 2], dt: f64, longest: f64) -> Self::Law;
}

/// Forces of contact on the particles of two solids, at H1.
pub struct Contact<S> {
    solids: [usize; 2],
    style: S,
    pairs: Pairs,
    totals: Totals,
    /// The longest step since the solids met \[T\].
    longest: f64,
    /// Heat of friction so far \[M L^2/T^2\].
    heat: ExactSum,
}

impl<S: ContactStyle> Contact<S> {
    /// Contact of the two solids of a fix.
    pub fn new(target: &Target, style: S) -> Self {
        Self::of_solids(target.solids, style)
    }

    /// Contact of two solids, by number.
    pub fn of_solids(solids: [usize; 2], style: S) -> Self {
        let (pairs, totals) = (Pairs::default(), Totals::default());
        Self { solids, style, pairs, totals, longest: 0.0, heat: ExactSum::default() }
    }
}

impl<S: ContactStyle> Fix for Contact<S> {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::InitialIntegrate]
    }

    fn needs(&self, plan: &mut Plan, dimension: usize) {
        plan.columns.extend(&[Column::Bx, Column::By, Column::Bz][..dimension]);
        plan.contact = true;
    }

    fn apply(&mut self, _stage: Stage, step: &mut Step<'_>) -> Result<(), Fault> {
        let (world, dt) = (&mut *step.world, step.clock.dt);
        let solids = self.solids.map(|solid| &world.solids[solid]);
        if solids.iter().all(|solid| solid.rigid) {
            return Ok(());
        }
        self.longest = if self.totals.pushed > 0 { self.longest.max(dt) } else { dt };
        let law = self.style.law(solids, dt, self.longest);
        self.totals = self.pairs.sum(world, self.solids, &law);
        // Work dt P of each pair, so that the sum over steps does not depend on their order.
        for (_, response) in self.pairs.of_side(0) {
            self.heat.add(response.friction * dt);
        }
        let shares = heat_shares(solids);
        for side in 0..2 {
            self.push(world, side, shares[side] * dt);
        }
        Ok(())
    }

    fn largest_step(&self) -> f64 {
        largest_step(self.totals.rate)
    }

    fn keep(&mut self, checkpoint: &mut Checkpoint) {
        let Totals { force, rate, pushed } = &mut self.totals;
        checkpoint.vector("force", force);
        checkpoint.largest("rate", rate);
        let mut count = *pushed as u64;
        checkpoint.number("pushed", &mut count);
        *pushed = count as usize;
        checkpoint.number("longest", &mut self.longest);
        checkpoint.sum("heat", &mut self.heat);
    }

    fn results(&self, world: &World) -> [f64; 4] {
        let [x, y, z] = self.totals.force.0.each_ref();
        world.ranks.totals([x, y, z, &self.heat])
    }
}

/// Parts of the heat of friction that go to the two solids: kappa_i/(kappa_1 + kappa_2), halves
/// where neither conducts.
fn heat_shares(solids: [&Solid; 2]) -> [f64; 2] {
    let conductivity = solids.map(|solid| solid.law.thermal().conductivity);
    match conductivity[0] + conductivity[1] {
        sum if sum > 0.0 => conductivity.map(|kappa| kappa / sum),
        _ => [0.5; 2],
    }
}

impl<S> Contact<S> {
    /// mbp += f and, where a temperature is stored, T += heat/(m cp), `heat` per power of friction.
    fn push(&self, world: &mut World, side: usize, heat: f64) {
        let solid = &world.solids[self.solids[side]];
        if solid.rigid {
            return;
        }
        for (axis, column) in [Column::Bx, Column::By, Column::Bz].into_iter().enumerate() {
            let column = world.particles.column_mut(column);
            if column.is_empty() {
                continue;
            }
            for (p, response) in self.pairs.of_side(side) {
                column[p] += response.force[axis];
            }
        }
        let capacity = solid.law.thermal().capacity;
        if capacity > 0.0 {
            for (p, response) in self.pairs.of_side(side).filter(|(_, r)| r.friction > 0.0) {
                let mass = world.particles.position[p][3];
                if let Some(temperature) =
                    world.particles.column_mut(Column::Temperature).get_mut(p)
                {
                    *temperature += heat * response.friction / (mass * capacity);
                }
            }
        }
    }
}
