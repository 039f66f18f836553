//! Schemes: the order of the parts of a step (language.md 7).

pub mod musl;

use crate::compute::Compute;
use crate::fault::Fault;
use crate::fix::Fix;
use crate::kernel::gather::{self, Gather};
use crate::kernel::sort::Sorter;
use crate::kernel::stencil::Frame;
use crate::kernel::stress::{self, Stress};
use crate::kernel::tiles::{Report, Tiles};
use crate::kernel::{grid, scatter};
use crate::measure::{self, Captured};
use crate::model::clock::Clock;
use crate::model::column::Column;
use crate::plan::Plan;
use crate::script::formula::{Board, Quantity, Slot};
use crate::step::{Stage, Step};
use crate::timing::{Phase, Timing};
use crate::transfer::Transfer;
use crate::watch;
use crate::world::World;

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
    /// Largest distance, in cells, that a particle can have moved since the last sort.
    pub travelled: f64,
    /// The nodes hold mass, momentum and force of the coming step.
    pub scattered: bool,
    /// Number of sorts so far.
    pub sorts: u64,
    /// Time spent by phase.
    pub timing: Timing,
}

/// Cells a particle may move before the next sort, less what rounding can add.
const MOVEMENT: f64 = 0.99;

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
    /// How particles take velocities from the grid.
    pub transfer: Transfer,
    /// Tiles, sort, timing.
    pub loops: &'a mut Loops,
}

impl Parts<'_> {
    fn frame(&self) -> Frame {
        Frame::new(&self.world.domain, &self.world.grid.window)
    }

    /// The fixes of one stage act.
    ///
    /// # Errors
    /// The first fault of a fix.
    pub fn act(&mut self, stage: Stage) -> Result<(), Fault> {
        if self.hooks.at[stage as usize].is_empty() {
            return Ok(());
        }
        let hooks = self.hooks;
        for slot in &hooks.slots[stage as usize] {
            let quantity = &self.quantities[slot.0];
            self.board.values[slot.0] =
                measure::value(quantity, self.world, self.fixes, self.computes, self.captured);
        }
        for fix in &hooks.at[stage as usize] {
            let step = &mut Step { clock: self.clock, world: self.world, board: self.board };
            self.fixes[*fix].1.apply(stage, step)?;
        }
        self.loops.timing.end(Phase::Fixes);
        Ok(())
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

    /// Line 5 at the current places.
    pub fn points_to_grid(&mut self) {
        let frame = self.frame();
        let dimension = self.world.domain.dimension;
        let World { particles, grid, .. } = &mut *self.world;
        let tiles = &mut self.loops.tiles;
        grid::clear(grid, tiles.parallel);
        scatter::sweep(tiles, particles, grid, dimension, &frame);
        self.loops.scattered = true;
        self.loops.timing.end(Phase::PointsToGrid);
    }

    /// External forces of particles go to the nodes; H2; sums of nodal forces are taken.
    ///
    /// # Errors
    /// The first fault of a fix.
    pub fn nodal_forces(&mut self) -> Result<(), Fault> {
        let frame = self.frame();
        let dimension = self.world.domain.dimension;
        self.captured.internal(self.world);
        let World { particles, grid, .. } = &mut *self.world;
        grid.external.fill([0.0; 4]);
        if self.plan.columns.contains(Column::Bx) && self.hooks.any(&[Stage::InitialIntegrate]) {
            scatter::external(&mut self.loops.tiles, particles, grid, dimension, &frame);
        }
        self.act(Stage::PostParticlesToGrid)?;
        self.captured.external(self.world);
        Ok(())
    }

    /// Line 7.
    pub fn update_grid(&mut self) {
        grid::update(&mut self.world.grid, self.loops.tiles.parallel, self.clock.dt);
        self.loops.timing.end(Phase::Grid);
    }

    /// Lines 9 to 13 up to the sum of m v; particles are sorted again before they can leave
    /// their tile.
    ///
    /// # Errors
    /// A velocity that is not finite, or the first fault of a fix.
    pub fn grid_to_points(&mut self) -> Result<(), Fault> {
        let frame = self.frame();
        let dimension = self.world.domain.dimension;
        let split = self.hooks.any(&[Stage::PostGridToPoint, Stage::PostAdvanceParticles]);
        let numbers = Gather { dt: self.clock.dt, alpha: self.transfer.alpha, scatter: !split };
        let World { particles, grid, .. } = &mut *self.world;
        let tiles = &mut self.loops.tiles;
        let mut report = gather::sweep(tiles, particles, grid, dimension, &frame, numbers);
        self.loops.timing.end(Phase::GridToPoints);
        if split {
            self.act(Stage::PostGridToPoint)?;
            self.act(Stage::PostAdvanceParticles)?;
            let World { particles, grid, .. } = &mut *self.world;
            gather::scatter_momentum(&mut self.loops.tiles, particles, grid, dimension, &frame);
            for dx in &particles.displacement {
                report.farthest =
                    dx[..dimension].iter().fold(report.farthest, |d, x| d.max(x.abs()));
            }
            self.loops.timing.end(Phase::GridToPoints);
        }
        if !report.watch.is_finite() {
            return Err(watch::not_finite(self.world, &self.clock));
        }
        self.loops.travelled += report.farthest / self.world.domain.cell;
        if self.loops.travelled > MOVEMENT {
            self.sort();
        }
        Ok(())
    }

    /// Sorts the particles by the places they are about to have.
    pub fn sort(&mut self) {
        self.loops.sorter.sort(self.world, &mut self.loops.tiles);
        self.loops.travelled = 0.0;
        self.loops.sorts += 1;
        self.loops.timing.end(Phase::Sort);
    }

    /// Line 13, the division by m, and H6; the nodes are cleared for the next step.
    ///
    /// # Errors
    /// The first fault of a fix.
    pub fn second_mapping(&mut self) -> Result<(), Fault> {
        let parallel = self.loops.tiles.parallel;
        if self.hooks.any(&[Stage::PostVelocitiesToGrid]) {
            grid::divide(&mut self.world.grid, parallel);
            self.loops.timing.end(Phase::Grid);
            self.act(Stage::PostVelocitiesToGrid)?;
            grid::clear(&mut self.world.grid, parallel);
        } else {
            grid::divide_and_clear(&mut self.world.grid, parallel);
        }
        self.loops.timing.end(Phase::Grid);
        Ok(())
    }

    /// Line 15 and x += dx; P2G of the next step follows at once unless a fix acts before it.
    ///
    /// # Errors
    /// A law that fails or a particle that leaves the box.
    pub fn stress(&mut self) -> Result<Report, Fault> {
        let frame = self.frame();
        let scatter = !self.hooks.any(&[Stage::InitialIntegrate]);
        let options = Stress { dt: self.clock.dt, time_step: self.plan.wave_speed, scatter };
        let report = stress::sweep(&mut self.loops.tiles, self.world, &frame, options);
        self.loops.scattered = scatter;
        self.loops.timing.end(Phase::Stress);
        if let Some(particle) = report.failed {
            return Err(watch::inverted(self.world, particle, &self.clock));
        }
        if let Some(particle) = report.escaped {
            return Err(watch::escaped(self.world, particle, &self.clock));
        }
        Ok(report)
    }
}

/// One step of a scheme.
pub trait Scheme: Sync {
    /// Advances everything by dt; gives what the next dt follows from.
    ///
    /// # Errors
    /// The first fault.
    fn step(&self, parts: &mut Parts<'_>) -> Result<Report, Fault>;
}
