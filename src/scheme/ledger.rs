//! Where in a step the energy ledger takes its notes.

use super::{Parts, SchemeKind};
use crate::kernel::tiles::Tiles;
use crate::kernel::work::kinetic_energy;
use crate::kernel::{gather, grid, ledger};
use crate::math::exact_sum::ExactSum;
use crate::model::domain::Boundary;
use crate::step::Stage;
use crate::timing::Phase;
use crate::transfer::TransferKind;
use std::time::Instant;

impl Parts<'_> {
    /// Books what has changed the particles since the last step: H1, particles that have left.
    /// Internal forces are noted.
    pub fn note_start(&mut self) {
        // Velocities change between two steps only where a fix acts or walls are minded.
        if self.hooks.any(&[Stage::InitialIntegrate, Stage::FinalIntegrate])
            || self.world.boundary != Boundary::Error
        {
            self.book_particles();
        }
        let free = self.nodes_are_free();
        let (world, tiles) = (&mut *self.world, &self.loops.tiles);
        if world.ledger.open {
            let start = Instant::now();
            world.ledger.fit(if free { 0 } else { world.grid.len() }, tiles.ranges.len());
            ledger::note_internal(&mut world.ledger, &world.grid, tiles.parallel);
            self.loops.timing.aside(Phase::Ledger, start);
        }
    }

    /// External forces are noted.
    pub fn note_forces(&mut self) {
        let world = &mut *self.world;
        if world.ledger.open {
            let start = Instant::now();
            ledger::note_external(&mut world.ledger, &world.grid, self.loops.tiles.parallel);
            self.loops.timing.aside(Phase::Ledger, start);
        }
    }

    /// Changes of the nodal velocities are noted.
    pub fn note_changes(&mut self) {
        let world = &mut *self.world;
        if world.ledger.open {
            let start = Instant::now();
            ledger::note_contact(&mut world.ledger, &mut world.grid, self.clock.dt);
            let parallel = self.loops.tiles.parallel;
            ledger::note_changes(&mut world.ledger, &world.grid, parallel, self.clock.dt);
            self.loops.timing.aside(Phase::Ledger, start);
        }
    }

    /// Kinetic energy of all particles after the gathering, before the next sweep.
    pub fn gathered_energy(&mut self) -> f64 {
        if self.world.solids.iter().any(|solid| solid.rigid) {
            // Rigid particles have not taken what the grid offered. All processes sum in one way.
            return kinetic_energy(&mut self.loops.tiles, self.world);
        }
        let Tiles { reports, ranges, .. } = &self.loops.tiles;
        let each = reports.iter().take(ranges.len()).map(|report| report.kinetic);
        self.world.ranks.total(&ExactSum::of(each))
    }

    /// Does nothing but internal forces change the velocities of nodes?
    fn nodes_are_free(&self) -> bool {
        let acting =
            [Stage::InitialIntegrate, Stage::PostParticlesToGrid, Stage::PostUpdateGridState];
        let world = &*self.world;
        let held = world.has_rigid_nodes() || world.method.axisymmetric || self.has_contact();
        !(held || self.hooks.any(&acting) || self.transfer.filter_terms().is_some())
    }

    /// Books the work of the nodal forces, and what the particles have not got of it; `mapped`: the
    /// second mapping has been done already.
    pub fn book_transfer(&mut self, mapped: bool) {
        if !self.world.ledger.open {
            return;
        }
        let start = Instant::now();
        // MLS takes strains from the velocities that it has gathered.
        let updated = self.scheme == SchemeKind::Usl
            || self.scheme == SchemeKind::Musl && self.transfer.kind == TransferKind::Mls;
        let mapped = mapped || updated;
        if !mapped {
            gather::scatter_momentum(&mut self.loops.tiles, self.world, self.transfer.is_affine());
        }
        let (kinetic, free) = (self.loops.kinetic, self.nodes_are_free());
        let (world, parallel) = (&mut *self.world, self.loops.tiles.parallel);
        if free {
            ledger::book_free(&mut world.ledger, &world.grid, parallel, updated);
        } else {
            ledger::book_forces(&mut world.ledger, &world.grid, parallel, self.clock.dt, updated);
            ledger::book_contact(&mut world.ledger, &world.grid, &world.contacts.pairs, updated);
        }
        let work = world.ledger.settle(&world.ranks);
        let sums = &mut world.ledger.sums;
        sums.numerical += work - (kinetic - sums.kinetic);
        sums.kinetic = kinetic;
        if !mapped {
            grid::clear_mapped(&mut world.grid, self.loops.tiles.parallel);
        }
        self.loops.timing.aside(Phase::Ledger, start);
    }

    /// Books what has been done to the particles since their kinetic energy was last taken: by fixes
    /// (H1, H4, H5), or by taking some away.
    pub fn book_particles(&mut self) {
        if self.world.ledger.open {
            let start = Instant::now();
            let kinetic = kinetic_energy(&mut self.loops.tiles, self.world);
            let sums = &mut self.world.ledger.sums;
            sums.boundary += kinetic - sums.kinetic;
            sums.kinetic = kinetic;
            self.loops.timing.aside(Phase::Ledger, start);
        }
    }

    /// Books what the stress has done.
    pub fn book_stress(&mut self) {
        if self.world.ledger.open {
            let start = Instant::now();
            self.world.ledger.collect(&self.world.ranks);
            self.loops.timing.aside(Phase::Ledger, start);
        }
    }
}
