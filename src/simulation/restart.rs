//! The whole state of a simulation, into a restart file and back.
//!
//! The scene itself - laws, regions, fixes, outputs - is not in it: it comes about by performing the
//! script once more (`command/restart.rs`). What steps have changed is listed here once, in
//! [`Simulation::keep`]. Particles keep the order and the tiles of their last sort, from which they
//! may have moved: the next step then adds everything up in the same order. Several processes write
//! the file that one would, and any number of them reads it.

use super::Simulation;
use super::progress::Progress;
use crate::fault::Fault;
use crate::model::checkpoint::{Checkpoint, Row};
use crate::model::grid::Grid;
use crate::output::{file, restart};
use crate::time_step::{Limit, TimeStep};
use crate::world::World;
use std::path::Path;

/// Values of nodes that outlive a step.
#[derive(Default)]
struct Nodes {
    /// Number of the lattice of each node.
    lattice: Vec<u16>,
    /// Its index along each axis.
    index: Vec<[u32; 3]>,
    /// Momentum and mass that the last step has carried over (total Lagrangian).
    motion: Vec<[f64; 4]>,
    /// Displacement \[L\].
    displaced: Vec<[f64; 4]>,
    /// External force of the last step \[M L/T^2\].
    external: Vec<[f64; 4]>,
}

impl Nodes {
    /// Those of the grid that are not zero; `carried`: momenta too.
    fn of(grid: &Grid, carried: bool) -> Self {
        let mut nodes = Self::default();
        let zero = |values: &[[f64; 4]], node: usize| {
            values.get(node).is_none_or(|record| record.iter().all(|x| x.to_bits() == 0))
        };
        for node in grid.runs.iter().cloned().flatten().filter(|node| grid.counts(*node)) {
            let motion = grid.nodes[node].motion;
            let at_rest = !carried || motion == [0.0; 4];
            if at_rest && zero(&grid.displaced, node) && zero(&grid.external, node) {
                continue;
            }
            let number = grid.places().lattice(node);
            nodes.lattice.push(number as u16);
            nodes.index.push(grid.lattices[number].window.node(node).map(|index| index as u32));
            if carried {
                nodes.motion.push(motion);
            }
            nodes.displaced.extend(grid.displaced.get(node));
            nodes.external.extend(grid.external.get(node));
        }
        nodes
    }

    fn keep(&mut self, checkpoint: &mut Checkpoint) {
        let rows = self.index.iter().zip(&self.lattice).enumerate();
        let rows = rows.map(|(place, ([i, j, k], lattice))| {
            let [i, j, k] = [i, j, k].map(|index| u64::from(*index));
            Row { place, key: [u64::from(*lattice) << 32 | i, j, k] }
        });
        checkpoint.rows(&rows.collect::<Vec<_>>(), |inside| {
            inside.column("lattice", &mut self.lattice);
            inside.records("index", &mut self.index);
            inside.records("motion", &mut self.motion);
            inside.records("displacement", &mut self.displaced);
            inside.records("external", &mut self.external);
        });
        let count = self.lattice.len();
        let all = [self.motion.len(), self.displaced.len(), self.external.len()];
        if self.index.len() != count || all.iter().any(|length| *length != 0 && *length != count) {
            checkpoint.refuse("the columns of the nodes differ in length");
        }
    }

    /// Puts the values where they were; gives the number of nodes that this process counts.
    fn give_back(&self, grid: &mut Grid) -> usize {
        let mut active = vec![false; grid.len()];
        grid.runs.iter().cloned().for_each(|run| active[run].fill(true));
        let mut count = 0;
        for (row, (lattice, index)) in self.lattice.iter().zip(&self.index).enumerate() {
            let lattice = grid.lattices.get(usize::from(*lattice));
            let index = index.map(|index| index as usize);
            let node = lattice.and_then(|lattice| lattice.window.local(index));
            let Some(node) = node.filter(|node| active[*node]) else { continue };
            count += usize::from(grid.counts(node));
            if let Some(motion) = self.motion.get(row) {
                grid.nodes[node].motion = *motion;
            }
            for (to, from) in
                [(&mut grid.displaced, &self.displaced), (&mut grid.external, &self.external)]
            {
                if let (Some(to), Some(from)) = (to.get_mut(node), from.get(row)) {
                    *to = *from;
                }
            }
        }
        count
    }
}

/// What friction has done where two bodies meet: its heat is booked in the next step.
#[derive(Default)]
struct Rubbed {
    /// Number of the pair of lattices of each couple of nodes.
    pair: Vec<u32>,
    /// Number of the node in its lattice.
    number: Vec<u64>,
    /// Momentum that friction has given \[M L/T\].
    drag: Vec<[f64; 3]>,
    /// Difference of the velocities \[L/T\].
    slip: Vec<[f64; 3]>,
}

impl Rubbed {
    fn of(grid: &Grid) -> Self {
        let mut rubbed = Self::default();
        for couple in grid.couples.iter().filter(|couple| grid.counts(couple.nodes[0] as usize)) {
            // Without a drag the slip makes no heat.
            if couple.drag != [0.0; 3] {
                rubbed.pair.push(couple.pair);
                rubbed.number.push(couple.number);
                rubbed.drag.push(couple.drag);
                rubbed.slip.push(couple.slip);
            }
        }
        rubbed
    }

    fn keep(&mut self, checkpoint: &mut Checkpoint) {
        let rows = self.pair.iter().zip(&self.number).enumerate();
        let rows =
            rows.map(|(place, (pair, number))| Row { place, key: [u64::from(*pair), *number, 0] });
        checkpoint.rows(&rows.collect::<Vec<_>>(), |inside| {
            inside.column("pair", &mut self.pair);
            inside.column("number", &mut self.number);
            inside.records("drag", &mut self.drag);
            inside.records("slip", &mut self.slip);
        });
        let all = [self.number.len(), self.drag.len(), self.slip.len()];
        if all.iter().any(|length| *length != self.pair.len()) {
            checkpoint.refuse("the columns of bodies in contact differ in length");
        }
    }

    /// Gives the couples back what they had; gives the number of those that this process counts.
    /// Couples stand pair by pair, by number.
    fn give_back(&self, grid: &mut Grid) -> usize {
        let mut count = 0;
        for (row, pair) in self.pair.iter().enumerate() {
            let key = (*pair, self.number[row]);
            let place = grid.couples.binary_search_by_key(&key, |one| (one.pair, one.number));
            let Ok(place) = place else { continue };
            count += usize::from(grid.counts(grid.couples[place].nodes[0] as usize));
            let couple = &mut grid.couples[place];
            (couple.drag, couple.slip) = (self.drag[row], self.slip[row]);
        }
        count
    }
}

/// What the last sort left.
#[derive(Default)]
struct Sorted {
    /// The cell of each particle then.
    cells: Vec<[u32; 3]>,
    /// How many cells away the corners of a domain may lie.
    corners: u64,
    nodes: Nodes,
    rubbed: Rubbed,
}

impl Simulation {
    /// Writes a restart file; all processes do so together.
    ///
    /// # Errors
    /// The path and the system's reason.
    pub fn write_restart(&mut self, path: &Path) -> Result<(), Fault> {
        let checkpoint = self.save_state();
        let summary = restart::Summary {
            step: self.clock.step,
            time: self.clock.time,
            solids: self.world.solids.iter().map(|solid| solid.name.as_str()).collect(),
        };
        let written = match self.world.ranks.is_first() {
            true => file::write_whole(path, &restart::encode(&self.history, &summary, &checkpoint)),
            false => Ok(()),
        };
        self.world.ranks.agree(written.err(), &mut [])?;
        self.outputs.note_file(path, self.clock.step);
        Ok(())
    }

    /// The whole state; of several processes the first one has it.
    pub(super) fn save_state(&mut self) -> Checkpoint {
        let mut checkpoint = Checkpoint::saving(&self.world.ranks);
        self.captured.prepare(&self.quantities, &self.world);
        let mut sorted = match self.progress {
            Some(_) => Sorted {
                cells: self.loops.sorter.cells(),
                corners: self.loops.tiles.corners as u64,
                nodes: Nodes::of(&self.world.grid, self.loops.carried),
                rubbed: Rubbed::of(&self.world.grid),
            },
            None => Sorted::default(),
        };
        self.keep(&mut checkpoint, &mut sorted);
        checkpoint
    }

    /// Takes the state from a restart file; the scene must be the one it was written with.
    ///
    /// # Errors
    /// What does not fit.
    pub fn restore(&mut self, checkpoint: Checkpoint) -> Result<(), String> {
        let mut checkpoint = checkpoint.of_ranks(&self.world.ranks);
        self.board.values.resize(self.quantities.len(), 0.0);
        self.captured.prepare(&self.quantities, &self.world);
        let mut sorted = Sorted::default();
        self.keep(&mut checkpoint, &mut sorted);
        self.check_loaded(&mut checkpoint, &sorted);
        let progress = self.progress;
        checkpoint.finish()?;
        if progress.is_some() {
            let cutoff = self.world.grid.mass_cutoff;
            self.fit();
            self.world.grid.mass_cutoff = cutoff;
            self.restore_order(&sorted)?;
        }
        Ok(())
    }

    /// The state between runs, without a file.
    pub(super) fn remember(&mut self) -> Checkpoint {
        self.disturb();
        let mut checkpoint = Checkpoint::saving(&self.world.ranks);
        self.captured.prepare(&self.quantities, &self.world);
        self.keep(&mut checkpoint, &mut Sorted::default());
        checkpoint
    }

    /// Tiles, windows and nodes as they were.
    fn restore_order(&mut self, sorted: &Sorted) -> Result<(), String> {
        let outside = || "a particle or node lies outside of the grid".to_string();
        let lattices = &self.world.grid.lattices;
        let World { particles, method, domain, .. } = &self.world;
        let places = particles.places(method.total);
        // A particle is in its cell of the last sort, or in one beside it.
        let inside = |p: usize| {
            let solid = &self.world.solids[usize::from(particles.solid[p])];
            let Some(lattice) = lattices.get(solid.lattice) else { return false };
            let (cells, counts) = (&lattice.cells, lattice.cells.cells());
            (0..3).all(|axis| {
                let cell = sorted.cells[p][axis];
                let from = (places[p][axis] - cells.lower[axis]) / cells.cell - f64::from(cell);
                let near = axis >= domain.dimension || (-1.01..=2.01).contains(&from);
                near && (cell as usize) < counts[axis].max(1)
            })
        };
        if !(0..sorted.cells.len()).all(inside) {
            return Err(outside());
        }
        let corners = sorted.corners as usize;
        let world = &mut self.world;
        let tiles = &mut self.loops.tiles;
        let restored = self.loops.sorter.restore(world, tiles, &sorted.cells, corners);
        restored.map_err(|fault| fault.what)?;
        let grid = &mut world.grid;
        let given = [sorted.nodes.give_back(grid), sorted.rubbed.give_back(grid)];
        if world.ranks.count(given) != [sorted.nodes.index.len(), sorted.rubbed.pair.len()] {
            return Err(outside());
        }
        if world.ledger.open {
            world.ledger.fit(world.grid.len(), self.loops.tiles.ranges.len());
        }
        if self.loops.scattered {
            let (hooks, scatter) = (self.hooks(), self.scheme.scatter());
            self.parts(&hooks).refill(scatter);
        }
        Ok(())
    }

    /// Refuses numbers that the arrays here cannot take.
    fn check_loaded(&self, checkpoint: &mut Checkpoint, sorted: &Sorted) {
        let particles = &self.world.particles;
        let solids = self.world.solids.len();
        if particles.solid.iter().any(|solid| usize::from(*solid) >= solids) {
            checkpoint.refuse("a particle belongs to a solid that is not there");
        }
        let cells = if self.progress.is_some() { particles.len() } else { 0 };
        if sorted.cells.len() != cells || sorted.corners > u64::from(u8::MAX) {
            checkpoint.refuse("the order of the particles is not complete");
        }
    }

    /// Everything that steps have changed, and the order of the particles.
    fn keep(&mut self, checkpoint: &mut Checkpoint, sorted: &mut Sorted) {
        checkpoint.within("clock", |inside| {
            inside.number("step", &mut self.clock.step);
            inside.number("time", &mut self.clock.time);
            inside.number("dt", &mut self.clock.dt);
        });
        checkpoint.within("run", |inside| Progress::keep(&mut self.progress, inside));
        checkpoint.within("next", |inside| TimeStep::keep(&mut self.next, inside));
        checkpoint.within("done", |inside| Limit::keep(&mut self.bound, inside));
        checkpoint.within("floor", |inside| self.floor.keep(inside));
        checkpoint.within("rescue", |inside| self.rescue.keep(inside));
        checkpoint.within("loop", |inside| self.loops.keep(inside));
        let rows = if checkpoint.is_loading() { Vec::new() } else { self.rows() };
        checkpoint.within("particle", |inside| {
            inside.rows(&rows, |inside| {
                self.world.particles.keep(inside);
                inside.records("cell", &mut sorted.cells);
            });
        });
        checkpoint.within("node", |inside| {
            sorted.nodes.keep(inside);
            inside.number("corners", &mut sorted.corners);
            inside.number("mass_cutoff", &mut self.world.grid.mass_cutoff);
        });
        checkpoint.within("couple", |inside| sorted.rubbed.keep(inside));
        checkpoint.within("solid", |inside| self.keep_solids(inside));
        checkpoint.within("ledger", |inside| self.world.ledger.keep(inside));
        checkpoint.flag("alarmed", &mut self.alarmed);
        checkpoint.within("contact", |inside| self.world.contacts.keep(inside));
        checkpoint.within("group", |inside| self.captured.keep(inside));
        checkpoint.within("fix", |inside| self.keep_fixes(inside));
        checkpoint.within("output", |inside| self.outputs.keep(inside));
    }

    /// The particles of this process, in the order of the last sort; by id if none counts.
    fn rows(&self) -> Vec<Row> {
        let particles = &self.world.particles;
        let row = |place| match self.progress {
            Some(_) => Row { place, key: self.loops.sorter.key(place) },
            None => Row { place, key: [u64::from(particles.id[place]), 0, 0] },
        };
        particles.counted().map(row).collect()
    }

    fn keep_solids(&mut self, checkpoint: &mut Checkpoint) {
        for solid in &mut self.world.solids {
            checkpoint.within(&solid.name, |inside| {
                inside.numbers("lower", &mut solid.cells.lower);
                inside.numbers("upper", &mut solid.cells.upper);
                inside.number("cell", &mut solid.cells.cell);
                inside.number("particles_per_cell", &mut solid.particles_per_cell);
            });
        }
    }

    fn keep_fixes(&mut self, checkpoint: &mut Checkpoint) {
        for (id, fix) in &mut self.fixes {
            checkpoint.within(id, |inside| {
                let mut started = self.started.contains(id);
                inside.flag("started", &mut started);
                if inside.is_loading() {
                    self.started.retain(|name| name != id);
                    self.started.extend(started.then(|| id.clone()));
                }
                fix.keep(inside);
            });
        }
    }
}
