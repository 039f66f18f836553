//! Where in a step bodies with velocities of their own meet (language.md 7.5).

use super::{Parts, SchemeKind};
use crate::kernel::contact::{self, Velocities};
use crate::kernel::{ledger, rigid, surfaces};

impl Parts<'_> {
    /// Does any body have velocities of its own?
    pub(super) fn has_contact(&self) -> bool {
        self.world.grid.keeps.contact
    }

    /// Normals and gaps, once in a step.
    pub(super) fn find_surfaces(&mut self) {
        if !self.has_contact() || self.world.contacts.ready {
            return;
        }
        if self.world.has_rigid_nodes() && !self.world.rigid.flagged {
            rigid::flag(&mut self.loops.tiles, self.world);
        }
        surfaces::find(&mut self.loops.tiles, self.world);
    }

    /// Bodies exchange momentum where they meet.
    pub(super) fn meet(&mut self, which: Velocities) {
        if !self.has_contact() {
            return;
        }
        self.find_surfaces();
        contact::meet(self.world, which, self.clock.dt);
        let world = &mut *self.world;
        let strained = which == Velocities::Momenta && self.scheme == SchemeKind::Usf;
        if strained && world.ledger.open {
            // The particles have strained with velocities that they do not have.
            let power = ledger::power_of_impulses(&world.ledger, &world.grid);
            world.ledger.sums.numerical += self.clock.dt * power;
        }
    }

    /// The same for the velocities of the second mapping; normals are those of the step.
    pub(super) fn meet_mapped(&mut self) {
        if !self.has_contact() {
            return;
        }
        let before = self.contact_power();
        contact::meet(self.world, Velocities::Mapped, self.clock.dt);
        let change = self.contact_power() - before;
        // The particles will strain with velocities that they do not have.
        self.world.ledger.sums.numerical += self.clock.dt * change;
    }

    /// Power of the internal forces where bodies meet; 0 unless the ledger is open.
    fn contact_power(&self) -> f64 {
        if self.world.ledger.open { ledger::contact_power(&self.world.grid) } else { 0.0 }
    }
}
