//! Tiles: columns of cells whose particles lie together in memory.
//!
//! Tiles are coloured 2 x 2. Between two sorts a particle moves by at most one cell, so with
//! enough cells per side, tiles of one colour never touch the same node: they run in parallel,
//! colours one after another. Tiles of different lattices share no node at all. Where processes share
//! nodes, what a colour has added passes between them before the next one begins ([`super::ghosts`]).

use super::ghosts::{Ghosts, NodeArray};
use super::shared::Shared;
use super::stencil::Frame;
use crate::material::State;
use crate::model::column::Column;
use crate::model::domain::Domain;
use crate::shape::ShapeKind;
use crate::world::Spreading;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Cells along a side of a tile.
///
/// A tile of `side` cells touches nodes from `side + 2` cells (one cell of movement on either side)
/// and those that the shape reaches beyond them: one node above for hats; one below and two above
/// for splines, one more in the cells at the ends of the lattice. The next tile of the same colour
/// begins 2 `side` cells further, so hats need 4 cells and splines 6. Corners of domains that lie up
/// to `corners` cells away from their particle need 3 + 2 `corners`.
pub fn side(shape: ShapeKind, corners: usize) -> usize {
    match shape {
        ShapeKind::Linear | ShapeKind::Bernstein => 4,
        ShapeKind::Quadratic | ShapeKind::Cubic => 6,
        ShapeKind::Gimp | ShapeKind::StretchedGimp => 6,
        ShapeKind::Corners(_) => 3 + 2 * corners,
    }
}

/// Number of colours.
pub const COLOURS: usize = 4;

/// Below so many particles one thread is faster than two.
pub const SMALLEST_PARALLEL: usize = 5000;

/// What a tile found out during a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// Largest component of dx \[L\].
    pub farthest: f64,
    /// Kinetic energy that the particles have taken from the grid \[M L^2/T^2\]; not finite as soon as
    /// one velocity of the tile is not.
    pub kinetic: f64,
    /// Not finite as soon as one temperature of the tile is not.
    pub watch: f64,
    /// Largest c_p + max_i |v_i| \[L/T\].
    pub fastest: f64,
    /// Smallest squared singular value of F, at most 1 (total Lagrangian methods; otherwise 1).
    pub thinnest: f64,
    /// Largest squared Frobenius norm of L \[1/T^2\].
    pub rate: f64,
    /// Largest kinematic viscosity mu/rho \[L^2/T\].
    pub viscosity: f64,
    /// Largest thermal diffusivity kappa/(rho cp) \[L^2/T\].
    pub diffusivity: f64,
    /// Particles compressed beyond what their equation of state can describe.
    pub clipped: usize,
    /// Largest distance of a corner of a domain from its particle, on one axis, in cells.
    pub reach: f64,
    /// Place in the table of a particle with a corner that must be moved.
    pub cut: Option<usize>,
    /// Place in the table of the first particle whose law failed.
    pub failed: Option<usize>,
    /// Place in the table of the first particle outside the box.
    pub escaped: Option<usize>,
    /// Place in the table of the first particle that `watch` finds in trouble.
    pub troubled: Option<usize>,
}

impl Default for Report {
    fn default() -> Self {
        Self {
            farthest: 0.0,
            kinetic: 0.0,
            watch: 0.0,
            fastest: 0.0,
            thinnest: 1.0,
            rate: 0.0,
            viscosity: 0.0,
            diffusivity: 0.0,
            clipped: 0,
            reach: 0.0,
            cut: None,
            failed: None,
            escaped: None,
            troubled: None,
        }
    }
}

impl Report {
    /// Notes how fast momentum and heat spread, from the reference density: mu J/rho0 and
    /// kappa J/(rho0 cp).
    pub fn spread(&mut self, of_reference: Spreading, state: &State) {
        if of_reference.viscosity > 0.0 || of_reference.heat > 0.0 {
            let thinnest = state.values(Column::J).iter().fold(0.0f64, |a, j| a.max(*j));
            self.viscosity = self.viscosity.max(of_reference.viscosity * thinnest);
            self.diffusivity = self.diffusivity.max(of_reference.heat * thinnest);
        }
    }

    /// Both reports in one; the first failure stays.
    pub fn join(self, other: &Report) -> Report {
        Report {
            farthest: self.farthest.max(other.farthest),
            kinetic: self.kinetic + other.kinetic,
            watch: self.watch + other.watch,
            fastest: self.fastest.max(other.fastest),
            thinnest: self.thinnest.min(other.thinnest),
            rate: self.rate.max(other.rate),
            viscosity: self.viscosity.max(other.viscosity),
            diffusivity: self.diffusivity.max(other.diffusivity),
            clipped: self.clipped + other.clipped,
            reach: self.reach.max(other.reach),
            cut: self.cut.or(other.cut),
            failed: self.failed.or(other.failed),
            escaped: self.escaped.or(other.escaped),
            troubled: self.troubled.or(other.troubled),
        }
    }
}

/// The particles of one tile and the frame of their lattice.
pub struct Tile<'a> {
    /// Number of the tile.
    pub number: usize,
    /// Places in the table.
    pub range: Range<usize>,
    /// Where their nodes are.
    pub frame: &'a Frame,
}

/// The tiles that hold particles.
#[derive(Clone, Default)]
pub struct Tiles {
    /// Particles of each tile, tiles by colour.
    pub ranges: Vec<Range<usize>>,
    /// Number of the lattice of each tile.
    pub lattices: Vec<u16>,
    /// First tile of each colour, and one past the last tile.
    pub colours: [usize; COLOURS + 1],
    /// The frame of each lattice.
    pub frames: Vec<Frame>,
    /// What each tile found out during the last sweep.
    pub reports: Vec<Report>,
    /// The same, by lattice.
    pub by_lattice: Vec<Report>,
    /// How many cells away from its particle a corner of a domain may lie.
    pub corners: usize,
    /// Sweeps run on several threads.
    pub parallel: bool,
    /// Nodes shared with other processes.
    pub ghosts: Ghosts,
    /// Sweeps so far, and those of them that added to nodes.
    pub counts: [usize; 2],
}

impl Tiles {
    /// Does the work for every tile, which adds to no node; gives all reports in one.
    pub fn sweep(&mut self, work: impl Fn(Tile<'_>, &mut Report) + Sync) -> Report {
        self.sweep_with(&[], &work)
    }

    /// Does the work for every tile, which adds to these arrays over nodes; gives all reports of this
    /// process in one.
    pub fn sweep_into(
        &mut self,
        arrays: &[&dyn NodeArray],
        work: impl Fn(Tile<'_>, &mut Report) + Sync,
    ) -> Report {
        self.sweep_with(arrays, &work)
    }

    /// The same, compiled once for all kinds of work: one call a tile goes through the pointer.
    fn sweep_with(&mut self, arrays: &[&dyn NodeArray], work: &Work<'_>) -> Report {
        self.counts[0] += 1;
        self.counts[1] += usize::from(!arrays.is_empty());
        let Self { ranges, lattices, frames, colours, reports, parallel, ghosts, .. } = self;
        let reports = Shared::new(reports);
        let job = Job { ranges, lattices, frames, reports, work };
        let workers = if *parallel { rayon::current_num_threads() } else { 1 };
        if ghosts.is_alone() || arrays.is_empty() {
            let (next, done) = Default::default();
            let queue = Queue { next, done, job, colours };
            side_by_side(workers, &|| queue.serve());
        } else {
            let tiles = std::mem::take(&mut ghosts.tiles);
            for (colour, [border, inner]) in tiles.iter().enumerate() {
                job.share(border, workers);
                ghosts.pass(colour, arrays, &mut || job.share(inner, workers));
            }
            ghosts.tiles = tiles;
        }
        self.by_lattice.fill(Report::default());
        for (report, lattice) in self.reports.iter().zip(&self.lattices) {
            let sum = &mut self.by_lattice[*lattice as usize];
            *sum = sum.join(report);
        }
        self.by_lattice.iter().fold(Report::default(), Report::join)
    }
}

/// What is done for a tile.
type Work<'a> = dyn Fn(Tile<'_>, &mut Report) + Sync + 'a;

/// Calls `worker` so many times, side by side where threads are free.
fn side_by_side(count: usize, worker: &(dyn Fn() + Sync)) {
    if count <= 1 {
        return worker();
    }
    let half = count / 2;
    rayon::join(|| side_by_side(half, worker), || side_by_side(count - half, worker));
}

/// What is done in a sweep, and where.
struct Job<'a> {
    ranges: &'a [Range<usize>],
    lattices: &'a [u16],
    frames: &'a [Frame],
    reports: Shared<'a, Report>,
    work: &'a Work<'a>,
}

impl Job<'_> {
    /// Does the work for a tile.
    ///
    /// # Safety
    /// Each tile has one worker.
    unsafe fn tile(&self, tile: usize) {
        // SAFETY: the caller promises that nobody else uses the report of this tile.
        let report = unsafe { self.reports.part(tile..tile + 1) };
        report[0] = Report::default();
        let frame = &self.frames[self.lattices[tile] as usize];
        let range = self.ranges[tile].clone();
        (self.work)(Tile { number: tile, range, frame }, &mut report[0]);
    }

    /// Does the work for some tiles of one colour.
    fn share(&self, tiles: &[u32], workers: usize) {
        let next = AtomicUsize::new(0);
        side_by_side(workers.min(tiles.len()), &|| {
            while let Some(tile) = tiles.get(next.fetch_add(1, Ordering::Relaxed)) {
                // SAFETY: the counter gives each tile of the list to one worker, and no list holds
                // a tile twice.
                unsafe { self.tile(*tile as usize) };
            }
        });
    }
}

/// The tiles of one sweep, taken one after the other by whoever is free; those of a colour begin
/// when all of the colour before are done. One fork of threads then serves all colours.
struct Queue<'a> {
    /// The next tile to take.
    next: AtomicUsize,
    /// Tiles that are done.
    done: AtomicUsize,
    job: Job<'a>,
    colours: &'a [usize],
}

impl Queue<'_> {
    /// Takes tiles until none is left.
    fn serve(&self) {
        loop {
            let tile = self.next.fetch_add(1, Ordering::Relaxed);
            if tile >= self.job.ranges.len() {
                return;
            }
            let first_of_colour = self.colours.partition_point(|first| *first <= tile) - 1;
            self.wait_for(self.colours[first_of_colour]);
            // Counts the tile even if the work panics, so that nobody waits for ever.
            let _counted = Counted(&self.done);
            // SAFETY: the counter gives each tile to one worker.
            unsafe { self.job.tile(tile) };
        }
    }

    /// Waits until so many tiles are done: what their workers wrote can then be seen. Every tile
    /// that is waited for is with a worker that runs, since workers only wait for earlier colours.
    fn wait_for(&self, tiles: usize) {
        let mut rounds = 0;
        while self.done.load(Ordering::Acquire) < tiles {
            rounds += 1;
            if rounds < PATIENCE { std::hint::spin_loop() } else { std::thread::yield_now() }
        }
    }
}

/// Rounds of waiting before a worker lets others have its processor.
const PATIENCE: u32 = 2000;

struct Counted<'a>(&'a AtomicUsize);

impl Drop for Counted<'_> {
    fn drop(&mut self) {
        self.0.fetch_add(1, Ordering::Release);
    }
}

/// Order of a cell: by colour, tile, then cell with the last axis fastest.
#[derive(Clone, Copy, Debug)]
pub struct Order {
    side: usize,
    tiles_across: usize,
    cells: [usize; 3],
}

impl Order {
    /// The order of the cells of a box in tiles of so many cells along a side.
    pub fn new(domain: &Domain, side: usize) -> Self {
        let cells = domain.cells();
        Self { side, tiles_across: cells[1].div_ceil(side), cells }
    }

    /// The tile of a cell: its index on both axes.
    pub fn tile_of(&self, cell: [usize; 3]) -> [usize; 2] {
        [cell[0] / self.side, cell[1] / self.side]
    }

    /// Colour and number of the tile of a cell.
    pub fn tile(&self, cell: [usize; 3]) -> (usize, usize) {
        let [x, y] = self.tile_of(cell);
        (x % 2 * 2 + y % 2, x * self.tiles_across + y)
    }

    /// The index of a tile on both axes.
    pub fn index(&self, tile: usize) -> [usize; 2] {
        [tile / self.tiles_across, tile % self.tiles_across]
    }

    /// First and last cell of a tile on an axis.
    pub fn cells_of(&self, tile: [usize; 2], axis: usize) -> [usize; 2] {
        let first = tile[axis] * self.side;
        [first, (first + self.side).min(self.cells[axis]) - 1]
    }

    /// The cell of such numbers.
    pub fn cell(&self, tile: usize, within: usize) -> [usize; 3] {
        let [_, _, up] = self.cells;
        let corner = [tile / self.tiles_across, tile % self.tiles_across];
        let inside = [within / up / self.side, within / up % self.side];
        let [x, y] = std::array::from_fn(|axis| corner[axis] * self.side + inside[axis]);
        [x, y, within % up]
    }

    /// Number of the cell within its tile.
    pub fn within(&self, cell: [usize; 3]) -> usize {
        let side = self.side;
        ((cell[0] % side) * side + cell[1] % side) * self.cells[2] + cell[2]
    }

    /// The cell of a place, the last cell for places on the upper border.
    #[inline]
    pub fn cell_of(&self, domain: &Domain, place: [f64; 4]) -> [usize; 3] {
        std::array::from_fn(|axis| {
            if axis >= domain.dimension {
                return 0;
            }
            let r = (place[axis] - domain.lower[axis]) * (1.0 / domain.cell);
            (r as usize).min(self.cells[axis] - 1)
        })
    }

    /// The cell that a particle is sorted by: that of an earlier sort, if one is to be brought back.
    pub fn sorted_cell(
        &self,
        domain: &Domain,
        places: &[[f64; 4]],
        earlier: Option<&[[u32; 3]]>,
        p: usize,
    ) -> [usize; 3] {
        match earlier {
            Some(cells) => cells[p].map(|cell| cell as usize),
            None => self.cell_of(domain, places[p]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::{DomainKind, SHAPES};

    #[test]
    fn a_cell_follows_from_its_numbers() {
        let (lower, upper) = ([0.0; 3], [1.7, 0.9, 0.5]);
        let domain = Domain { dimension: 3, lower, upper, cell: 0.1 };
        let order = Order::new(&domain, 4);
        for cell in [[0, 0, 0], [16, 8, 4], [3, 4, 2], [4, 3, 1], [7, 8, 0]] {
            let (_, tile) = order.tile(cell);
            assert_eq!(order.cell(tile, order.within(cell)), cell);
        }
    }

    #[test]
    fn tiles_of_one_colour_share_no_node_after_a_cell_of_movement() {
        let products = SHAPES.iter().filter_map(|style| style.build);
        let domains = ShapeKind::Corners(DomainKind::Parallel);
        let all = products.map(|shape| (shape, 0)).chain((1..9).map(|corners| (domains, corners)));
        for (shape, corners) in all {
            let side = side(shape, corners);
            for cells in 1..6 * side {
                let last = cells * shape.nodes_per_cell();
                if last + 1 < shape.fewest_nodes() {
                    continue;
                }
                let touched = |tile: usize| {
                    let low = (tile * side).saturating_sub(1);
                    let high = ((tile + 1) * side).min(cells - 1);
                    [shape.reach(low, last, corners)[0], shape.reach(high, last, corners)[1]]
                };
                let tiles = cells.div_ceil(side);
                for tile in 2..tiles {
                    let (before, here) = (touched(tile - 2)[1], touched(tile)[0]);
                    assert!(before < here, "{shape:?}, {cells} cells: {before} and {here}");
                }
            }
        }
    }
}
