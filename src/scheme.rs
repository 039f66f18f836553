//! Schemes: the order of the parts of a step (language.md 7).

mod contact;
mod ledger;
pub mod musl;
pub mod usf;
pub mod usl;

use crate::compute::Compute;
use crate::fault::Fault;
use crate::fix::Fix;
use crate::kernel::contact::Velocities;
use crate::kernel::gather::{self, Gather};
use crate::kernel::points::{self, Points};
use crate::kernel::sort::{Sorter, corner_cells};
use crate::kernel::tiles::{Report, Tiles};
use crate::kernel::{conduction, dilation, filter, grid, rigid, scatter, walls};
use crate::measure::{self, Captured};
use crate::model::checkpoint::Checkpoint;
use crate::model::clock::Clock;
use crate::model::column::Column;
use crate::model::domain::Boundary;
use crate::parallel::Ranks;
use crate::plan::Plan;
use crate::script::formula::{Board, Quantity, Slot};
use crate::step::{Stage, Step};
use crate::style::Style;
use crate::timing::{Phase, Timing};
use crate::transfer::{Transfer, TransferKind};
use crate::watch;
use crate::world::World;
use std::time::Instant;

/// Which fixes act at which stage, and what their formulas read.
#[derive(Default)]
pub struct Hooks {
    /// Fixes of each stage, in order of definition.
    pub at: [Vec<usize>; Stage::COUNT],
    /// Results that the formulas of the fixes of each stage read.
    pub slots: [Vec<Slot>; Stage::COUNT],
}

impl Hooks {
    /// Does any fix act at one of the stages?
    pub fn any(&self, stages: &[Stage]) -> bool {
        stages.iter().any(|stage| !self.at[*stage as usize].is_empty())
    }
}

/// State of the loops between steps.
#[derive(Default)]
pub struct Loops {
    /// Particles by tile.
    pub tiles: Tiles,
    /// Memory of the sort.
    pub sorter: Sorter,
    /// Memory of the filter of XPIC.
    pub spare: Vec<[f64; 4]>,
    /// Kinetic energy of all particles after they have taken their velocities from the grid, if ledger or
    /// watch ask for it \[M L^2/T^2\].
    pub kinetic: f64,
    /// Largest distance, in cells, that a particle can have moved since the last sort.
    pub travelled: f64,
    /// The nodes hold what P2G brings for the coming step.
    pub scattered: bool,
    /// The nodes hold mass and momentum of the coming step: only forces are missing.
    pub carried: bool,
    /// What limits the time step, by lattice, as the last stress update found it.
    pub limits: Vec<Report>,
    /// Particle-steps of this run beyond what an equation of state can describe.
    pub clipped: u64,
    /// Corners of domains may lie farther from their particles than tiles allow for.
    pub outgrown: bool,
    /// Particles may leave their tile, or the box, in this step: they are sorted when they have moved.
    pub unsorted: bool,
    /// The first fault of this process in the step under way.
    pub fault: Option<Fault>,
    /// Memory for what processes agree on.
    pub numbers: Vec<f64>,
    /// The first particle (its id) of this run whose domain was cut, and when.
    pub cut: Option<(u32, f64)>,
    /// Particles of this run that left the box and were removed.
    pub removed: u64,
    /// Times in this run that a particle was reflected by the box.
    pub bounced: u64,
    /// Memory to choose particles with.
    keep: Vec<bool>,
    /// Number of sorts so far.
    pub sorts: u64,
    /// Time spent by phase.
    pub timing: Timing,
}

impl Loops {
    /// Puts into a checkpoint, or takes from it, what the next step reads beside the tiles.
    pub fn keep(&mut self, checkpoint: &mut Checkpoint) {
        checkpoint.number("travelled", &mut self.travelled);
        checkpoint.any("outgrown", &mut self.outgrown);
        checkpoint.flag("scattered", &mut self.scattered);
        checkpoint.flag("carried", &mut self.carried);
        checkpoint.count("clipped", &mut self.clipped);
        checkpoint.count("removed", &mut self.removed);
        checkpoint.count("bounced", &mut self.bounced);
        let first = self.first_cut(checkpoint.ranks());
        let (mut cut, mut time) = (first.map(|(id, _)| id), first.map(|(_, time)| time));
        checkpoint.option("cut", &mut cut);
        checkpoint.option("cut_at", &mut time);
        if checkpoint.is_loading() {
            self.cut = cut.zip(time);
        }
    }

    /// The first domain that was cut, of those that each process knows of: id and time.
    pub fn first_cut(&self, ranks: &Ranks) -> Option<(u32, f64)> {
        let numbers: Vec<f64> =
            self.cut.iter().flat_map(|(id, time)| [f64::from(*id), *time]).collect();
        let all = ranks.share(&numbers);
        let each = all.as_chunks::<2>().0.iter().map(|[id, time]| (*id as u32, *time));
        each.min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)))
    }
}

/// Cells a particle may move before the next sort, less what rounding can add.
const MOVEMENT: f64 = 0.99;

/// What P2G brings to the nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scatter {
    /// Mass and momentum.
    Motion,
    /// Mass, momentum and internal force.
    Everything,
}

/// Everything a scheme may touch during a step; outputs and the script are out of reach.
pub struct Parts<'a> {
    /// Step number, time at its start, dt.
    pub clock: Clock,
    /// Everything that has a place.
    pub world: &'a mut World,
    /// All fixes.
    pub fixes: &'a mut [(String, Box<dyn Fix>)],
    /// All computes.
    pub computes: &'a [(String, Box<dyn Compute>)],
    /// Values of results.
    pub board: &'a mut Board,
    /// What the board holds.
    pub quantities: &'a [Quantity],
    /// Sums of nodal forces that something reads.
    pub captured: &'a mut Captured,
    /// Which fixes act where.
    pub hooks: &'a Hooks,
    /// What the scene needs.
    pub plan: &'a Plan,
    /// How velocities pass between particles and grid.
    pub transfer: Transfer,
    /// The scheme.
    pub scheme: SchemeKind,
    /// Tiles, sort, timing.
    pub loops: &'a mut Loops,
}

impl Parts<'_> {
    /// A fault ends the step at once if there is one process. Of several none may leave the others
    /// waiting: the first fault is noted, and the step goes on until all agree.
    ///
    /// # Errors
    /// The fault.
    fn note(&mut self, result: Result<(), Fault>) -> Result<(), Fault> {
        match result {
            Err(fault) if !self.world.ranks.is_alone() => {
                self.loops.fault.get_or_insert(fault);
                Ok(())
            }
            result => result,
        }
    }

    /// The fixes of one stage act.
    ///
    /// # Errors
    /// The first fault of a fix.
    pub fn act(&mut self, stage: Stage) -> Result<(), Fault> {
        let result = self.fixes_at(stage);
        self.note(result)
    }

    fn fixes_at(&mut self, stage: Stage) -> Result<(), Fault> {
        if self.hooks.at[stage as usize].is_empty() {
            return Ok(());
        }
        let hooks = self.hooks;
        for slot in &hooks.slots[stage as usize] {
            let quantity = &self.quantities[slot.0];
            self.board.values[slot.0] =
                measure::value(quantity, self.world, self.fixes, self.computes, self.captured);
        }
        let mut result = Ok(());
        for fix in &hooks.at[stage as usize] {
            let start = Instant::now();
            let step = &mut Step { clock: self.clock, world: self.world, board: self.board };
            // Each fix acts, so that all processes make the same calls.
            result = result.and(self.fixes[*fix].1.apply(stage, step));
            self.loops.timing.aside_fix(*fix, start);
        }
        self.loops.timing.end(Phase::Fixes);
        result
    }

    /// Line 4: external forces of particles are cleared, then H1.
    ///
    /// # Errors
    /// The first fault of a fix.
    pub fn begin(&mut self) -> Result<(), Fault> {
        for column in [Column::Bx, Column::By, Column::Bz] {
            self.world.particles.column_mut(column).fill(0.0);
        }
        self.act(Stage::InitialIntegrate)
    }

    /// What a sweep over the particles needs to know besides what it does.
    fn points(&self) -> Points {
        Points {
            dt: self.clock.dt,
            affine: self.transfer.has_matrix(),
            moments: self.transfer.kind == TransferKind::Mls,
            ..Points::default()
        }
    }

    /// Lines 3 and 5 at the current places.
    pub fn points_to_grid(&mut self, scatter: Scatter) {
        let force = scatter == Scatter::Everything;
        let points = Points { motion: true, force, ..self.points() };
        let tiles = &mut self.loops.tiles;
        grid::clear(&mut self.world.grid, tiles.parallel);
        points::sweep(tiles, self.world, points);
        self.loops.scattered = true;
        self.loops.timing.end(Phase::PointsToGrid);
    }

    /// Fills the nodes as the last step has left them. Momenta that it has carried over are there
    /// already.
    pub fn refill(&mut self, scatter: Scatter) {
        if !self.loops.carried {
            return self.points_to_grid(scatter);
        }
        let points = Points { force: true, ..self.points() };
        points::sweep(&mut self.loops.tiles, self.world, points);
        self.loops.timing.end(Phase::PointsToGrid);
    }

    /// Bodies meet; external forces and heat of particles go to the nodes; H2; sums of nodal forces
    /// are taken.
    ///
    /// # Errors
    /// The first fault of a fix.
    pub fn nodal_forces(&mut self) -> Result<(), Fault> {
        self.captured.internal(self.world);
        self.note_start();
        self.find_surfaces();
        if self.world.grid.keeps.temperature {
            let start = Instant::now();
            conduction::collect(&mut self.loops.tiles, self.world);
            self.loops.timing.aside(Phase::Heat, start);
        }
        self.meet(Velocities::Momenta);
        self.world.grid.external.fill([0.0; 4]);
        if self.plan.columns.contains(Column::Bx) && self.hooks.any(&[Stage::InitialIntegrate]) {
            scatter::external_forces(&mut self.loops.tiles, self.world);
        }
        self.act(Stage::PostParticlesToGrid)?;
        self.captured.external(self.world);
        self.note_forces();
        Ok(())
    }

    /// Lines 7 and 8: v* and T*, bodies meet, then H3.
    ///
    /// # Errors
    /// The first fault of a fix.
    pub fn update_grid(&mut self) -> Result<(), Fault> {
        let tiles = &mut self.loops.tiles;
        grid::update(&mut self.world.grid, tiles.parallel, self.clock.dt);
        self.world.grid.held.clear();
        let rigid = self.world.has_rigid_nodes();
        if rigid {
            let start = Instant::now();
            if !self.world.rigid.flagged {
                rigid::flag(&mut self.loops.tiles, self.world);
            }
            let (axes, dt) = (self.world.domain.dimension, self.clock.dt);
            rigid::set(&mut self.world.grid, axes, dt, self.transfer.blend(dt));
            self.loops.timing.aside(Phase::Rigid, start);
        }
        self.meet(Velocities::Updated);
        if rigid {
            let start = Instant::now();
            rigid::react(&self.loops.tiles, self.world);
            self.loops.timing.aside(Phase::Rigid, start);
        }
        if self.world.grid.keeps.temperature {
            let start = Instant::now();
            conduction::conduct(&mut self.loops.tiles, self.world, self.clock.dt);
            self.loops.timing.aside(Phase::Heat, start);
        }
        self.loops.timing.end(Phase::Grid);
        self.act(Stage::PostUpdateGridState)?;
        self.hold_axis();
        self.note_changes();
        if let Some(terms) = self.transfer.filter_terms() {
            let start = Instant::now();
            filter::apply(&mut self.loops.tiles, self.world, &mut self.loops.spare, terms);
            self.loops.timing.aside(Phase::Filter, start);
        }
        Ok(())
    }

    /// Where x is a radius, the axis does not move along it.
    fn hold_axis(&mut self) {
        if self.world.method.axisymmetric {
            grid::hold_axis(&mut self.world.grid);
        }
    }

    /// Lines 9 to 12 and, if there is a `second_mapping`, the sum of line 13; particles are sorted
    /// again before they can leave their tile.
    ///
    /// # Errors
    /// A velocity or temperature that is not finite, or the first fault of a fix.
    pub fn grid_to_points(&mut self, second_mapping: bool) -> Result<(), Fault> {
        if self.world.grid.keeps.temperature
            && !conduction::gather(&mut self.loops.tiles, self.world)
        {
            let fault = watch::too_hot(self.world, &self.clock);
            self.note(Err(fault))?;
        }
        self.world.contacts.ready = false;
        let split = self.hooks.any(&[Stage::PostGridToPoint, Stage::PostAdvanceParticles]);
        let numbers = Gather::new(&self.transfer, self.clock.dt, second_mapping && !split);
        let rigid = !self.world.rigid.particles.is_empty();
        if rigid {
            rigid::keep(self.world);
        }
        let mut report = gather::sweep(&mut self.loops.tiles, self.world, numbers);
        self.world.rigid.flagged = false;
        if rigid {
            report.farthest = report.farthest.max(rigid::restore(self.world, self.clock.dt));
        }
        self.loops.timing.end(Phase::GridToPoints);
        if self.world.ledger.open || self.plan.trouble.is_some() {
            self.loops.kinetic = self.gathered_energy();
        }
        self.book_transfer(second_mapping && !split);
        if split {
            self.act(Stage::PostGridToPoint)?;
            self.act(Stage::PostAdvanceParticles)?;
            self.book_particles();
            if second_mapping {
                let affine = self.transfer.is_affine();
                gather::scatter_momentum(&mut self.loops.tiles, self.world, affine);
            }
            let dimension = self.world.domain.dimension;
            for dx in &self.world.particles.displacement {
                report.farthest =
                    dx[..dimension].iter().fold(report.farthest, |d, x| d.max(x.abs()));
            }
            self.loops.timing.end(Phase::GridToPoints);
        }
        if !report.kinetic.is_finite() {
            let fault = watch::not_finite(self.world, self.is_fragile(), &self.clock);
            self.note(Err(fault))?;
        }
        if !self.world.method.total {
            self.agree_on_sort(report.farthest)?;
        }
        Ok(())
    }

    /// All processes agree that none has failed, and whether particles are to be sorted when they
    /// have moved: one of them may leave its tile, or the box.
    ///
    /// # Errors
    /// The fault of a process.
    fn agree_on_sort(&mut self, farthest: f64) -> Result<(), Fault> {
        let leaving = self.mind_walls();
        let loops = &mut *self.loops;
        // What is not finite has been noted already.
        let farthest = if farthest.is_finite() { farthest } else { 0.0 };
        let travelled = loops.travelled + farthest / self.world.domain.cell;
        let mut numbers = [travelled, f64::from(loops.outgrown), f64::from(leaving)];
        self.world.ranks.agree(loops.fault.take(), &mut numbers)?;
        let [travelled, outgrown, leaving] = numbers;
        loops.travelled = travelled;
        loops.unsorted = travelled > MOVEMENT || outgrown > 0.0 || leaving > 0.0;
        Ok(())
    }

    /// Reflects particles about to leave the box, if asked to; tells whether any is to be removed. A
    /// reflected particle moves no farther than it would have.
    fn mind_walls(&mut self) -> bool {
        let boundary = self.world.boundary;
        if boundary == Boundary::Error || !walls::any_outside(self.world, self.loops.tiles.parallel)
        {
            return false;
        }
        if boundary == Boundary::Bounce {
            self.loops.bounced += walls::bounce(self.world);
        }
        boundary == Boundary::Delete
    }

    /// Sorts the particles where they have moved to, less those that have left the box.
    ///
    /// # Errors
    /// No particle is left, or the grid between them does not fit in memory.
    fn sort(&mut self) -> Result<(), Fault> {
        if self.world.boundary == Boundary::Delete {
            self.loops.removed += walls::remove(self.world, &mut self.loops.keep);
            let [left] = self.world.ranks.count([self.world.particles.len()]);
            if left == 0 {
                return Err(watch::all_gone(&self.clock));
            }
        }
        self.loops.sorter.sort(self.world, &mut self.loops.tiles)?;
        if self.world.ledger.open {
            self.world.ledger.fit_tiles(self.loops.tiles.ranges.len());
        }
        self.loops.travelled = 0.0;
        (self.loops.outgrown, self.loops.unsorted) = (false, false);
        self.loops.sorts += 1;
        self.loops.timing.end(Phase::Sort);
        Ok(())
    }

    /// Are masses and momenta of the next step those of the second mapping?
    fn carries_momentum(&self) -> bool {
        let changed = [Stage::InitialIntegrate, Stage::FinalIntegrate];
        self.world.method.total && !self.transfer.gradient_enhanced && !self.hooks.any(&changed)
    }

    /// Clears the nodes for the next P2G, unless they carry its momentum.
    fn clear_nodes(&mut self) {
        if !self.loops.carried {
            grid::clear(&mut self.world.grid, self.loops.tiles.parallel);
        }
    }

    /// Line 13, the division by m, then line 14: H6 and the places of nodes. The nodes are left
    /// ready for the next P2G.
    ///
    /// # Errors
    /// The first fault of a fix.
    pub fn second_mapping(&mut self) -> Result<(), Fault> {
        let parallel = self.loops.tiles.parallel;
        let later = self.hooks.any(&[Stage::PostVelocitiesToGrid])
            || self.world.method.averaged_dilation
            || self.has_contact();
        self.loops.carried = self.carries_momentum();
        let grid = &mut self.world.grid;
        match (self.loops.carried, later) {
            (true, _) => grid::divide_and_carry(grid, parallel),
            (false, true) => grid::divide(grid, parallel),
            (false, false) => grid::divide_and_clear(grid, parallel),
        }
        if self.world.has_rigid_nodes() {
            rigid::set_mapped(&mut self.world.grid);
        }
        self.meet_mapped();
        self.loops.timing.end(Phase::Grid);
        self.act(Stage::PostVelocitiesToGrid)?;
        if self.world.method.axisymmetric {
            grid::hold_mapped_axis(&mut self.world.grid);
        }
        self.average_dilation();
        if later {
            self.clear_nodes();
        }
        grid::displace(&mut self.world.grid, self.clock.dt);
        self.loops.timing.end(Phase::Grid);
        Ok(())
    }

    /// In place of [`Parts::second_mapping`]: strains follow from v* (usl).
    pub fn keep_updated(&mut self) {
        let parallel = self.loops.tiles.parallel;
        grid::take_updated(&mut self.world.grid, parallel);
        self.average_dilation();
        self.loops.carried = false;
        self.clear_nodes();
        grid::displace(&mut self.world.grid, self.clock.dt);
        self.loops.timing.end(Phase::Grid);
    }

    /// v = v* from mass and momentum, H3; strains follow from v (usf).
    ///
    /// # Errors
    /// The first fault of a fix.
    pub fn first_velocities(&mut self) -> Result<(), Fault> {
        let parallel = self.loops.tiles.parallel;
        grid::first_velocities(&mut self.world.grid, parallel);
        if self.world.has_rigid_nodes() {
            rigid::flag(&mut self.loops.tiles, self.world);
            rigid::set_first(&mut self.world.grid);
        }
        self.meet(Velocities::First);
        self.loops.timing.end(Phase::Grid);
        self.act(Stage::PostUpdateGridState)?;
        self.hold_axis();
        grid::velocities_for_strain(&mut self.world.grid, parallel);
        self.average_dilation();
        self.loops.timing.end(Phase::Grid);
        Ok(())
    }

    /// F-bar: the average of tr L over the particles around each node.
    fn average_dilation(&mut self) {
        if self.world.method.averaged_dilation {
            let start = Instant::now();
            self.world.grid.dilation.fill(0.0);
            dilation::sweep(&mut self.loops.tiles, self.world);
            grid::average_dilation(&mut self.world.grid);
            self.loops.timing.aside(Phase::Dilation, start);
        }
    }

    /// Line 15 and x += dx; P2G of the next step follows at once unless particles are to be sorted or
    /// a fix acts before it.
    ///
    /// # Errors
    /// A law that fails or a particle that leaves the box.
    pub fn stress(&mut self) -> Result<(), Fault> {
        let force = !self.hooks.any(&[Stage::InitialIntegrate]) && !self.loops.unsorted;
        let motion = force && !self.loops.carried;
        let matrix_is_gradient = self.transfer.kind == TransferKind::Mls;
        let stress = Points { matrix_is_gradient, ..self.points_of_stress() };
        self.sweep_points(Points { advance: true, motion, force, ..stress })?;
        self.book_stress();
        self.loops.limits.clone_from(&self.loops.tiles.by_lattice);
        self.loops.scattered = force;
        if self.loops.unsorted { self.sort() } else { Ok(()) }
    }

    /// Line 15 and the internal forces of this step (usf).
    ///
    /// # Errors
    /// A law that fails.
    pub fn stress_first(&mut self) -> Result<(), Fault> {
        self.sweep_points(Points { force: true, ..self.points_of_stress() })?;
        self.book_stress();
        self.loops.limits.clone_from(&self.loops.tiles.by_lattice);
        Ok(())
    }

    /// x += dx and P2G of mass and momentum of the next step (usf).
    ///
    /// # Errors
    /// A particle that leaves the box.
    pub fn advance(&mut self) -> Result<(), Fault> {
        let motion = !self.hooks.any(&[Stage::InitialIntegrate]) && !self.loops.unsorted;
        grid::displace_updated(&mut self.world.grid, self.clock.dt);
        grid::clear(&mut self.world.grid, self.loops.tiles.parallel);
        self.sweep_points(Points { advance: true, motion, ..self.points() })?;
        self.loops.scattered = motion;
        if self.loops.unsorted { self.sort() } else { Ok(()) }
    }

    /// Do strains follow from velocities that hardly any mass carries: those of `usl`, or those of
    /// affine transfers?
    fn is_fragile(&self) -> bool {
        self.scheme == SchemeKind::Usl || self.transfer.is_affine()
    }

    fn points_of_stress(&self) -> Points {
        Points {
            stress: true,
            time_step: self.plan.wave_speed,
            averaged_dilation: self.world.method.averaged_dilation,
            keep_gradient: self.transfer.gradient_enhanced,
            trouble: self.plan.trouble,
            ..self.points()
        }
    }

    fn sweep_points(&mut self, points: Points) -> Result<(), Fault> {
        let report = points::sweep(&mut self.loops.tiles, self.world, points);
        self.loops.clipped += report.clipped as u64;
        self.loops.outgrown =
            corner_cells(report.reach) > self.loops.tiles.corners && self.loops.tiles.corners > 0;
        if let (Some(particle), None) = (report.cut, self.loops.cut) {
            let id = self.world.particles.id[particle];
            self.loops.cut = Some((id, self.clock.time + self.clock.dt));
        }
        self.loops.timing.end(Phase::Stress);
        let failed = report
            .failed
            .map(|particle| watch::inverted(self.world, particle, self.is_fragile(), &self.clock));
        let failed = failed.or_else(|| {
            let trouble = self.plan.trouble?;
            Some(watch::troubled(self.world, report.troubled?, &trouble, &self.clock))
        });
        let deletes = self.world.boundary == Boundary::Delete;
        let escaped = report.escaped.filter(|_| !deletes);
        let escaped = escaped.map(|particle| watch::escaped(self.world, particle, &self.clock));
        self.note(failed.or(escaped).map_or(Ok(()), Err))
    }
}

/// One step of a scheme.
pub trait Scheme: Sync {
    /// The word in the script.
    fn kind(&self) -> SchemeKind;

    /// What P2G must have brought to the nodes before a step.
    fn scatter(&self) -> Scatter {
        Scatter::Everything
    }

    /// Advances everything by dt; the reports of the tiles then tell the next dt.
    ///
    /// # Errors
    /// The first fault.
    fn step(&self, parts: &mut Parts<'_>) -> Result<(), Fault>;
}

/// The schemes of the script language.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SchemeKind {
    /// Modified update stress last.
    Musl,
    /// Update stress last.
    Usl,
    /// Update stress first.
    Usf,
}

/// All schemes.
pub const SCHEMES: &[Style<&'static dyn Scheme>] = &[musl::STYLE, usl::STYLE, usf::STYLE];
