//! The loop over time steps.

use super::progress::{JOINED, Progress};
use super::rescue::Rescue;
use super::{Simulation, Until, fill};
use crate::compute::energy::{kinetic_energy, strain_energy};
use crate::fault::Fault;
use crate::interrupt;
use crate::kernel::ghosts::Traffic;
use crate::kernel::sort::MOST_CORNER_CELLS;
use crate::kernel::{conduction, rigid};
use crate::memory;
use crate::model::column::{Column, ColumnSet};
use crate::model::grid::Keeps;
use crate::model::group::GroupId;
use crate::output::Snapshot;
use crate::plan::Plan;
use crate::scheme::{Hooks, Loops, Parts, Scatter};
use crate::script::formula::{Instant, Slot};
use crate::step::{Stage, Step};
use crate::time_step::{self, Limit, TimeStep};
use crate::timing::Phase;
use crate::world::{Solid, Spreading, World};

/// Nodes lighter than this part of the lightest particle are empty (only against 0/0). It lies
/// below the cube of the smallest weight: a node near which a particle has a gradient weight must
/// have a velocity, or free flight past a corner of a cell would make strain.
const EMPTY: f64 = 1e-40;

impl Simulation {
    /// Runs. Whatever the caller may have changed since the last run counts.
    ///
    /// # Errors
    /// The first fault; log and dumps written before it stay.
    pub fn run(&mut self, until: Until) -> Result<(), Fault> {
        self.disturb();
        self.go_on(&until)
    }

    /// Runs, going on with the last run unless something has changed since ([`Simulation::disturb`]).
    ///
    /// # Errors
    /// The first fault; log and dumps written before it stay.
    pub fn go_on(&mut self, until: &Until) -> Result<(), Fault> {
        let (now, dt) = (self.clock.time, self.clock.dt);
        let mut progress = match self.progress.filter(|_| self.goes_on_with_last_run()) {
            Some(last) => last,
            None => Progress::new(now),
        };
        progress.end = match until {
            Until::Time(length) => progress.end_after(now, *length, dt),
            _ => f64::INFINITY,
        };
        (progress.done, progress.finished) = (0, false);
        self.run_to_end(until, progress)
    }

    /// Runs the rest of a run that was stopped before its end.
    ///
    /// # Errors
    /// The first fault; log and dumps written before it stay.
    pub fn finish(&mut self, until: &Until) -> Result<(), Fault> {
        match self.progress {
            Some(progress) => self.run_to_end(until, progress),
            None => self.go_on(until),
        }
    }

    fn run_to_end(&mut self, until: &Until, progress: Progress) -> Result<(), Fault> {
        let hooks = match self.goes_on_with_last_run() {
            true => self.continued(),
            false => self.prepare()?,
        };
        let begun = progress.done;
        self.progress = Some(progress);
        let steps = self.expected_steps(until).map(|steps| steps.saturating_sub(begun));
        let megabytes = self.memory().map(|bytes| 1e-6 * bytes);
        let summary = if self.outputs.is_silent() { Vec::new() } else { self.summary() };
        let started = self.outputs.begin_run(self.clock.step, &summary, steps, megabytes);
        self.world.ranks.agree(started.err(), &mut [])?;
        self.output(false)?;
        let mut progress = progress;
        self.keep_copy(true);
        while self.goes_on(until, &progress)? {
            let begun = self.clock.time;
            let done = self.take_step(&hooks, &mut progress);
            let done = done.and_then(|()| self.mind_ledger()).and_then(|()| self.mind_energy());
            if let Err(fault) = done {
                self.clock.time = begun;
                progress = self.go_back(fault)?;
                continue;
            }
            let last = !self.goes_on(until, &progress)?;
            progress.finished = last && !self.interrupted;
            self.progress = Some(progress);
            let written = self.output(last)?;
            self.keep_copy(written);
        }
        progress.finished = !self.interrupted || progress.finished;
        self.progress = Some(progress);
        self.note_strain();
        self.end_run(progress.done - begun)
    }

    /// One step of a run, without what it writes.
    pub(super) fn take_step(
        &mut self,
        hooks: &Hooks,
        progress: &mut Progress,
    ) -> Result<(), Fault> {
        self.choose_step(progress)?;
        self.step(hooks)?;
        progress.previous = self.next.map(|next| next.dt);
        (progress.steps, progress.done) = (progress.steps + 1, progress.done + 1);
        self.advance_clock(progress);
        self.end_step()
    }

    /// Times, warnings and figures at the end of a run.
    fn end_run(&mut self, steps: u64) -> Result<(), Fault> {
        let warnings = self.warnings();
        if self.progress.is_some_and(|progress| progress.finished) {
            self.clear_counts();
        }
        let ranks = &self.world.ranks;
        let ([particles], processes) = (ranks.count([self.world.particles.len()]), ranks.size());
        self.outputs.end_run(steps, particles, processes, &self.loops.timing, &warnings)?;
        self.tell_traffic();
        Ok(())
    }

    /// What the user should know about the run that has ended.
    fn warnings(&self) -> Vec<String> {
        let Loops { clipped, removed, bounced, .. } = &self.loops;
        let counts = [*clipped, *removed, *bounced].map(|count| count as usize);
        let [clipped, removed, bounced] = self.world.ranks.count(counts);
        let counted = |count: usize, text: String| (count > 0).then_some(text);
        let of_clipped = counted(
            clipped,
            format!(
                "in {clipped} particle-steps the density was beyond 98 % of the pole of the shock curve; \
                 the pressure went on along its tangent"
            ),
        );
        let of_domains = self.loops.first_cut(&self.world.ranks).map(|(particle, time)| {
            format!(
                "the domain of particle {particle} reached beyond the grid at time {time:.6e}, or \
                 farther than {MOST_CORNER_CELLS} cells: such corners are moved to the nearest place"
            )
        });
        let of_stretch = self.torn().map(|torn| torn.to_string());
        let of_fluids = self.fluid_under_usl().map(|name| {
            format!(
                "`usl` strained the fluid `{name}` by what nodes with hardly any mass do at its free surface: \
                 it may have gained energy; `musl` does not see them"
            )
        });
        let of_hats = self.crossed().map(|cells| {
            format!(
                "particles have moved by up to {cells:.1} cells under hats, whose slope jumps at every node \
                 they cross: stresses are noisy and energy is not kept; splines, `ulcpdi` and `tlmpm` have \
                 no such noise"
            )
        });
        let of_removed =
            counted(removed, format!("{removed} particles left the box and were removed"));
        let of_bounced = counted(
            bounced,
            format!(
                "{bounced} times a particle was reflected by the box: right for particles that fly alone; \
                 hold bodies with `velocity_nodes`"
            ),
        );
        let of_matter = [of_clipped, of_domains, of_stretch, of_fluids, of_hats];
        let of_steps = [of_removed, of_bounced, self.rescues()];
        of_matter.into_iter().chain(of_steps).flatten().collect()
    }

    /// What processes have sent each other, if there are several.
    fn tell_traffic(&mut self) {
        let Traffic { sweeps, messages, nodes, bytes } = self.loops.tiles.ghosts.traffic;
        let ranks = &self.world.ranks;
        if ranks.is_alone() || sweeps == 0 {
            return;
        }
        let sums = ranks.count([messages, nodes, bytes]);
        let [messages, nodes, bytes] = sums.map(|sum| sum as f64 / (sweeps * ranks.size()) as f64);
        self.outputs.say(&format!(
            "Exchange: a process sent {messages:.2} messages with {nodes:.2} nodes and {} per sweep, \
             in {sweeps} sweeps",
            memory::text(bytes)
        ));
    }

    /// A run begins to count.
    fn clear_counts(&mut self) {
        (self.loops.clipped, self.loops.removed, self.loops.bounced) = (0, 0, 0);
        self.loops.cut = None;
        self.alarmed = false;
        self.rescue.forget_count();
    }

    /// What the scene needs, as far as it is known now.
    pub fn make_plan(&self) -> Plan {
        let dimension = self.world.domain.dimension;
        let axisymmetric = self.world.method.axisymmetric;
        let wave_speed = self.fixed_dt.is_none();
        let trouble = self.watch.map(|watch| watch.trouble);
        let mut plan = Plan { wave_speed, axisymmetric, trouble, ..Plan::default() };
        for solid in &self.world.solids {
            plan.columns = plan.columns.union(self.world.columns_of(&*solid.law));
            if solid.law.thermal().capacity > 0.0 {
                plan.columns.insert(Column::Temperature);
            }
        }
        for (_, fix) in &self.fixes {
            fix.needs(&mut plan, dimension);
            for stage in fix.stages() {
                plan.stages[*stage as usize] = true;
            }
        }
        for (_, compute) in &self.computes {
            compute.needs(&mut plan, dimension);
        }
        self.outputs.needs(&mut plan, dimension);
        if plan.columns.contains(Column::F11) {
            plan.columns.extend(self.world.deformation_columns());
        }
        let artificial = |solid: &Solid| solid.law.has_artificial_viscosity();
        if plan.ledger && self.world.solids.iter().any(artificial) {
            plan.columns.insert(Column::ViscousPressure);
        }
        plan
    }

    /// Start of a run (language.md 7.2): columns, fixes that act once, nodes, first dt.
    pub(super) fn prepare(&mut self) -> Result<Hooks, Fault> {
        self.loops.timing.restart(self.fixes.iter().map(|(id, _)| id.as_str()));
        self.loops.fault = None;
        self.loops.tiles.ghosts.traffic = Traffic::default();
        self.interrupted = self.world.ranks.any(interrupt::requested());
        self.clear_counts();
        self.rescue = Rescue::default();
        self.ready()?;
        let hooks = self.hooks();
        self.open_ledger();
        self.next = self.first_step();
        let mut parts = self.parts(&hooks);
        parts.points_to_grid(Scatter::Everything);
        parts.captured.internal(parts.world);
        parts.loops.scattered = !hooks.any(&[Stage::InitialIntegrate]);
        Ok(hooks)
    }

    /// Start of a run that goes on with the last one: all is as its last step left it.
    fn continued(&mut self) -> Hooks {
        self.loops.timing.restart(self.fixes.iter().map(|(id, _)| id.as_str()));
        self.loops.fault = None;
        self.interrupted = self.world.ranks.any(interrupt::requested());
        self.board.values.resize(self.quantities.len(), 0.0);
        self.hooks()
    }

    /// Opens, goes on with or closes the energy ledger.
    fn open_ledger(&mut self) {
        let world = &mut self.world;
        if !self.plan.ledger {
            world.ledger.close();
            return;
        }
        let [kinetic, strain] = [kinetic_energy, strain_energy].map(|sum| sum(world, GroupId::ALL));
        let tiles = self.loops.tiles.ranges.len();
        world.ledger.begin(kinetic, strain, world.grid.len(), tiles);
    }

    /// At the end of a run: what changes the stored energy before the next one comes from outside.
    fn note_strain(&mut self) {
        if self.world.ledger.open {
            self.world.ledger.strain = strain_energy(&self.world, GroupId::ALL);
        }
    }

    /// Columns, sort and fixes that act once: all that must be there before the first dt.
    pub(super) fn ready(&mut self) -> Result<(), Fault> {
        self.disturb();
        self.fit();
        for displacement in &mut self.world.particles.displacement {
            *displacement = [0.0; 4];
        }
        self.loops.sorter.sort(&mut self.world, &mut self.loops.tiles)?;
        self.loops.travelled = 0.0;
        self.world.contacts.ready = false;
        self.start_fixes()
    }

    /// The plan of the scene, and room for what it asks for.
    pub(super) fn fit(&mut self) {
        self.board.values.resize(self.quantities.len(), 0.0);
        self.captured.prepare(&self.quantities, &self.world);
        self.plan = self.make_plan();
        self.plan.external_force |= self.captured.reads_external();
        self.fit_world();
    }

    /// Columns, lattices and nodal arrays as the plan and the method ask for.
    fn fit_world(&mut self) {
        self.world.assign_lattices();
        let mut lattices = self.world.make_lattices();
        for (lattice, known) in lattices.iter_mut().zip(&self.world.grid.lattices) {
            if (known.cells, known.nodes) == (lattice.cells, lattice.nodes) {
                lattice.window = known.window;
            }
        }
        let deformation = self.world.deformation_columns();
        let of_laws: Vec<ColumnSet> =
            self.world.solids.iter().map(|solid| self.world.columns_of(&*solid.law)).collect();
        let rigid_nodes = self.world.has_rigid_nodes();
        let World { particles, grid, solids, method, domain, contacts, .. } = &mut self.world;
        particles.require(self.plan.columns);
        if method.total {
            particles.require_reference();
        }
        let shape = method.shape;
        particles.add_domains(shape.records(domain.dimension), |particles, p| {
            let (place, cell) =
                (particles.reference_place(p), solids[particles.solid[p] as usize].cells.cell);
            let area = particles.velocity[p][3] / method.girth(place);
            let half = 0.5 * fill::edge(area, domain.dimension);
            shape.domain_of(domain.dimension, place, &[], half, cell)
        });
        let moving = !method.total && shape.has_moving_domains();
        particles.require_carried(if moving { shape.records(domain.dimension) } else { 0 });
        let matrix = self.transfer.has_matrix();
        particles.require_matrix(if matrix { domain.dimension } else { 0 });
        let mut heated = false;
        for (solid, columns) in solids.iter_mut().zip(of_laws) {
            solid.spreading = Spreading::new(&*solid.law, method.conducts_heat);
            heated |= solid.law.thermal().capacity > 0.0;
            solid.columns = columns;
            if particles.present.contains(Column::F11) {
                solid.columns.extend(deformation);
            }
            if particles.present.contains(Column::ViscousPressure) {
                solid.columns.insert(Column::ViscousPressure);
            }
        }
        grid.lattices = lattices;
        grid.keeps = Keeps {
            external: self.plan.external_force,
            displaced: method.total && self.plan.node_places,
            filtered: self.transfer.filter_terms().is_some(),
            rigid: rigid_nodes,
            dilation: method.averaged_dilation,
            temperature: method.conducts_heat && heated,
            contact: !contacts.pairs.is_empty(),
        };
        let masses = particles.position.iter().map(|position| position[3]);
        let lightest = masses.filter(|m| *m > 0.0).fold(f64::INFINITY, f64::min);
        let [lightest] = self.world.ranks.largest([-lightest]);
        self.world.grid.mass_cutoff = -EMPTY * lightest;
    }

    /// Fixes that act once do so, in the order of their definition.
    fn start_fixes(&mut self) -> Result<(), Fault> {
        let mut result = Ok(());
        for index in 0..self.fixes.len() {
            if self.started.contains(&self.fixes[index].0) {
                continue;
            }
            let slots: Vec<Slot> =
                self.fixes[index].1.formulas().iter().flat_map(|f| f.slots().to_vec()).collect();
            self.refresh(&slots);
            let step = &mut Step { clock: self.clock, world: &mut self.world, board: &self.board };
            result = result.and(self.fixes[index].1.start(step));
            self.started.push(self.fixes[index].0.clone());
        }
        self.world.ranks.agree(result.err(), &mut [])
    }

    pub(super) fn hooks(&self) -> Hooks {
        let mut hooks = Hooks::default();
        for (index, (_, fix)) in self.fixes.iter().enumerate() {
            for stage in fix.stages() {
                hooks.at[*stage as usize].push(index);
                let slots = &mut hooks.slots[*stage as usize];
                slots.extend(fix.formulas().iter().flat_map(|formula| formula.slots()));
                slots.sort();
                slots.dedup();
            }
        }
        hooks
    }

    pub(super) fn parts<'a>(&'a mut self, hooks: &'a Hooks) -> Parts<'a> {
        Parts {
            clock: self.clock,
            world: &mut self.world,
            fixes: &mut self.fixes,
            computes: &self.computes,
            board: &mut self.board,
            quantities: &self.quantities,
            captured: &mut self.captured,
            hooks,
            plan: &self.plan,
            transfer: self.transfer,
            scheme: self.scheme.kind(),
            loops: &mut self.loops,
        }
    }

    /// Brings results up to date.
    pub(super) fn refresh(&mut self, slots: &[Slot]) {
        for slot in slots {
            self.board.values[slot.0] = self.measure(&self.quantities[slot.0]);
        }
    }

    /// Does the run go on with another step?
    fn goes_on(&mut self, until: &Until, progress: &Progress) -> Result<bool, Fault> {
        if self.interrupted {
            return Ok(false);
        }
        let (condition, wanted) = match until {
            Until::Steps(steps) => return Ok(progress.done < *steps),
            Until::Time(_) => return Ok(self.clock.time < progress.end),
            Until::While(condition) => (condition, true),
            Until::Condition(condition) => (condition, false),
        };
        self.refresh(condition.slots());
        let dt = self.next.map_or(self.clock.dt, |next| next.dt);
        let now = Instant { time: self.clock.time, dt, step: self.clock.step };
        let value = condition.value(&self.board, &now);
        if value.is_finite() {
            Ok((value != 0.0) == wanted)
        } else {
            Err(Fault::run(format!(
                "the condition `{}` of the run is not finite at step {}, time {:.6e}",
                condition.text(),
                now.step,
                now.time
            )))
        }
    }

    /// The stable step before the first one of a run.
    fn first_step(&mut self) -> Option<TimeStep> {
        match self.fixed_dt {
            Some(dt) => Some(TimeStep { dt, limit: Limit::Fixed }),
            None => Some(self.stable_now()),
        }
    }

    /// Chooses the size of the coming step.
    fn choose_step(&mut self, progress: &Progress) -> Result<(), Fault> {
        let mut next = self.next.unwrap_or_else(|| self.stable_now());
        next = self.cap_step(next);
        if self.fixed_dt.is_none() {
            if let Some(previous) = progress.previous {
                next = time_step::limit_growth(next, previous);
            }
            if !(next.dt > 0.0 && next.dt.is_finite()) {
                return Err(Fault::run(format!(
                    "no stable time step follows from the state at step {} ({} limit): dt = {}",
                    self.clock.step,
                    next.limit.name(),
                    next.dt
                )));
            }
            if self.floor.collapsed(next.dt) {
                return Err(Fault::run(format!(
                    "the time step has collapsed to {:.3e} at step {}, time {:.6e} ({} limit)",
                    next.dt, self.clock.step, self.clock.time, next.limit.name()
                ))
                .because("some particle is crushed or far too fast; `dt_limit` in the log names what binds"));
            }
        }
        self.next = Some(next);
        self.clock.dt = next.dt;
        let rest = progress.end - self.clock.time;
        if rest < next.dt * (1.0 - JOINED) {
            self.next = Some(TimeStep { dt: next.dt, limit: Limit::End });
            self.clock.dt = rest;
        }
        self.bound = self.next.map(|next| next.limit);
        Ok(())
    }

    /// One step of the scheme.
    fn step(&mut self, hooks: &Hooks) -> Result<(), Fault> {
        self.clock.step += 1;
        self.scheme.step(&mut self.parts(hooks))
    }

    /// t <- t + dt; with `set_dt` t = t_start + k dt; the last step lands on the end.
    fn advance_clock(&mut self, progress: &mut Progress) {
        let time = match self.fixed_dt.filter(|_| !self.is_capped()) {
            Some(dt) => progress.start + progress.steps as f64 * dt,
            None => self.clock.end(),
        };
        if self.is_capped() {
            (progress.start, progress.steps) = (time, 0);
        }
        let landed = time >= progress.end - JOINED * self.clock.dt;
        self.clock.time = if landed { progress.end } else { time };
        if landed {
            (progress.start, progress.steps) = (progress.end, 0);
        }
    }

    /// Log, dumps, plots, restart files that are due; the first process writes them.
    /// Tells whether any was.
    fn output(&mut self, last: bool) -> Result<bool, Fault> {
        if !self.outputs.is_due(self.clock.step, last) {
            return Ok(false);
        }
        let written = self.write(last);
        let written = self.world.ranks.agree(written.err(), &mut []);
        let saved = written.and_then(|()| match self.outputs.restart_due(self.clock.step) {
            Some(path) => self.write_restart(&path),
            None => Ok(()),
        });
        self.loops.timing.end(Phase::Output);
        saved.map(|()| true)
    }

    fn write(&mut self, last: bool) -> Result<(), Fault> {
        if !self.loops.scattered && self.outputs.dump_is_due(self.clock.step) {
            // A fix stands before the coming P2G: the nodes are filled for the dump alone.
            let hooks = Hooks::default();
            let mut parts = self.parts(&hooks);
            parts.points_to_grid(Scatter::Motion);
            parts.loops.scattered = false;
        }
        if self.world.grid.keeps.temperature && self.outputs.dump_is_due(self.clock.step) {
            conduction::collect(&mut self.loops.tiles, &mut self.world);
        }
        if self.outputs.dump_is_due(self.clock.step) && self.world.has_rigid_nodes() {
            rigid::flag(&mut self.loops.tiles, &mut self.world);
            // Fixes may yet change the velocities of the coming step.
            self.world.rigid.flagged = false;
        }
        let slots = self.outputs.slots_due(self.clock.step, last);
        self.refresh(&slots);
        let next = self.next.unwrap_or(TimeStep { dt: self.clock.dt, limit: Limit::Fixed });
        // Both belong to the step just done, at first to the one to come.
        let (dt, limit) = match self.clock.step {
            0 => (next.dt, next.limit),
            _ => (self.clock.dt, self.bound.unwrap_or(next.limit)),
        };
        let now = Instant { time: self.clock.time, dt, step: self.clock.step };
        let (step, time, world) = (self.clock.step, self.clock.time, &self.world);
        let snapshot = Snapshot { step, time, world };
        self.outputs.write(&snapshot, &self.board, &now, limit.name(), last)
    }
}
