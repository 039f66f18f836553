//! Where in a step bodies with velocities of their own meet (language.md 7.5).

use super::{Parts, SchemeKind};
use crate::kernel::contact::{self, Velocities};
use crate::kernel::{ledger, rigid, surfaces};
use crate::timing::Phase;
use crate::world::World;
use std::time::Instant;

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
        let start = Instant::now();
        if self.world.has_rigid_nodes() && !self.world.rigid.flagged {
            rigid::flag(&mut self.loops.tiles, self.world);
        }
        surfaces::find(&mut self.loops.tiles, self.world);
        self.loops.timing.aside(Phase::Contact, start);
    }

    /// Bodies exchange momentum where they meet.
    pub(super) fn meet(&mut self, which: Velocities) {
        if !self.has_contact() {
            return;
        }
        self.find_surfaces();
        let start = Instant::now();
        contact::meet(self.world, which, self.clock.dt);
        self.loops.timing.aside(Phase::Contact, start);
        let world = &mut *self.world;
        let strained = which == Velocities::Momenta && self.scheme == SchemeKind::Usf;
        if strained && world.ledger.open {
            ledger::book_impulses(&mut world.ledger, &world.grid, self.clock.dt);
        }
    }

    /// The same for the velocities of the second mapping; normals are those of the step.
    pub(super) fn meet_mapped(&mut self) {
        if !self.has_contact() {
            return;
        }
        let (dt, start) = (self.clock.dt, Instant::now());
        self.note_contact_power(-dt);
        contact::meet(self.world, Velocities::Mapped, dt);
        // The particles will strain with velocities that they do not have.
        self.note_contact_power(dt);
        self.loops.timing.aside(Phase::Contact, start);
    }

    /// Notes dt times the power of the internal forces where bodies meet, if the ledger is open.
    fn note_contact_power(&mut self, dt: f64) {
        let World { ledger, grid, .. } = &mut *self.world;
        if ledger.open {
            ledger::add_contact_power(&mut ledger.books.numerical, grid, dt);
        }
    }
}
