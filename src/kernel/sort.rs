//! Sorting particles by tile and fitting the windows of nodes around them.
//!
//! Particles are ordered by colour, lattice, tile, solid, cell and id. The order depends on their
//! places alone, never on threads, and it stays until some particle could have crossed a cell.

use super::deal::{Deal, Scene};
use super::ghosts::{Layout, OwnTile};
use super::stencil::Frame;
use super::surfaces::find_couples;
use super::survey::{self, Survey};
use super::tiles::{COLOURS, Order, Report, SMALLEST_PARALLEL, Tiles, side};
use crate::fault::Fault;
use crate::memory;
use crate::model::contact::Couple;
use crate::model::grid::{Grid, Keeps, Node};
use crate::model::lattice::{Lattice, Window};
use crate::model::particles::Particles;
use crate::parallel::Ranks;
use crate::shape::ShapeKind;
use crate::world::{Solid, World};
use rayon::prelude::*;
use std::ops::Range;

/// Memory of the sort, kept from one to the next.
#[derive(Default)]
pub struct Sorter {
    orders: Vec<Order>,
    keys: Vec<Key>,
    records: Vec<[f64; 4]>,
    numbers: Vec<f64>,
    words: Vec<u64>,
    ids: Vec<u32>,
    solids: Vec<u16>,
    bounds: Vec<Bounds>,
    marks: [Vec<u8>; 2],
    old: Grid,
    deal: Deal,
    /// Nodes that particles of this process reach, where others are in memory too.
    reached: Vec<bool>,
}

/// Where a particle goes: ordered by colour and lattice, tile and solid, then cell, then id.
#[derive(Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    group: u32,
    tile: u64,
    within: u32,
    id: u32,
    from: u32,
}

impl Key {
    fn same_tile(a: &Key, b: &Key) -> bool {
        a.group == b.group && a.tile >> 16 == b.tile >> 16
    }
}

/// Bytes that a node takes: its record, the second mapping, marks of two sorts.
pub const BYTES_EACH: f64 = (std::mem::size_of::<Node>() + 32 + 4) as f64;

/// Smallest and largest cell per axis.
type Bounds = [[usize; 3]; 2];

const NOTHING: Bounds = [[usize::MAX; 3], [0; 3]];

fn joined([low, high]: Bounds, [l, h]: Bounds) -> Bounds {
    [std::array::from_fn(|a| low[a].min(l[a])), std::array::from_fn(|a| high[a].max(h[a]))]
}

/// Places that the sort goes by.
struct Places<'a> {
    particles: &'a Particles,
    solids: &'a [Solid],
    total: bool,
    /// The cells of an earlier sort, which count in place of those of the places.
    cells: Option<&'a [[u32; 3]]>,
}

impl Places<'_> {
    fn lattice(&self, p: usize) -> usize {
        self.solids[self.particles.solid[p] as usize].lattice
    }

    /// The cell that a particle is sorted by.
    fn cell(&self, order: &Order, lattice: &Lattice, p: usize) -> [usize; 3] {
        order.sorted_cell(&lattice.cells, self.particles.places(self.total), self.cells, p)
    }
}

impl Sorter {
    /// Sorts the particles by their places (reference places in total Lagrangian methods) and fits
    /// the windows to them. All nodal values are zero then, but those that outlive a step: the external
    /// force and the place of a node.
    ///
    /// # Errors
    /// The nodes between particles that lie far apart would not fit in memory.
    pub fn sort(&mut self, world: &mut World, tiles: &mut Tiles) -> Result<(), Fault> {
        self.sort_by(world, tiles, None)
    }

    /// Brings back what the sort left that found these cells, whatever the places are now; corners
    /// of domains were allowed to lie `corners` cells away.
    ///
    /// # Errors
    /// As [`Sorter::sort`].
    pub fn restore(
        &mut self,
        world: &mut World,
        tiles: &mut Tiles,
        cells: &[[u32; 3]],
        corners: usize,
    ) -> Result<(), Fault> {
        self.sort_by(world, tiles, Some((cells, corners)))
    }

    /// The cell that each particle had in the last sort.
    pub fn cells(&self) -> Vec<[u32; 3]> {
        let cell = |key: &Key| {
            let order = &self.orders[(key.group & 0xffff) as usize];
            order.cell((key.tile >> 16) as usize, key.within as usize).map(|cell| cell as u32)
        };
        self.keys.iter().map(cell).collect()
    }

    /// What the last sort ordered a particle by.
    pub fn key(&self, p: usize) -> [u64; 3] {
        let Key { group, tile, within, id, .. } = self.keys[p];
        [u64::from(group), tile, u64::from(within) << 32 | u64::from(id)]
    }

    fn sort_by(
        &mut self,
        world: &mut World,
        tiles: &mut Tiles,
        restored: Option<(&[[u32; 3]], usize)>,
    ) -> Result<(), Fault> {
        let World { particles, solids, grid, method, ranks, .. } = &mut *world;
        let lattices = &grid.lattices;
        let (total, shape) = (method.total, method.shape);
        let mut orders = std::mem::take(&mut self.orders);
        tiles.corners = match (shape, restored) {
            (_, Some((_, corners))) => corners,
            (ShapeKind::Corners(_), None) => {
                let farthest = farthest_corner(particles, lattices, shape, solids);
                let [farthest] = ranks.largest([farthest]);
                corner_cells(farthest)
            }
            _ => 0,
        };
        let side = side(shape, tiles.corners);
        orders.clear();
        orders.extend(lattices.iter().map(|lattice| Order::new(&lattice.cells, side)));
        let cells = restored.map(|(cells, _)| cells);
        let scene = Scene { orders: &orders, lattices, solids, total, side, cells };
        self.deal.deal(particles, &scene, ranks);
        let cells = cells.map(|cells| self.deal.kept(cells));
        let cells = cells.as_deref();
        self.order(&orders, lattices, &Places { particles, solids, total, cells }, tiles);
        self.permute(particles, tiles.parallel);
        let cells: Option<Vec<[u32; 3]>> =
            cells.map(|cells| self.keys.iter().map(|key| cells[key.from as usize]).collect());
        let places = Places { particles, solids, total, cells: cells.as_deref() };
        self.find_bounds(&orders, lattices, &places, tiles.parallel);
        let movement = if total { 0 } else { 1 };
        let reach = Reach { shape, movement, corners: tiles.corners };
        let together = grid.keeps.contact && !ranks.is_alone();
        ranks.agree(self.check_room(&reach, grid, together).err(), &mut [])?;
        self.fit(&orders, &places, &reach, grid, together);
        // One process shares no node and need not know its tiles.
        let own = if ranks.is_alone() { Vec::new() } else { self.own_tiles(&orders) };
        let layout = Layout { orders: &orders, reach: &reach, deal: &self.deal };
        tiles.ghosts.find(ranks, grid, &own, &layout, &mut self.reached);
        self.orders = orders;
        self.hear_of_others(&mut world.grid, &world.ranks);
        if world.grid.keeps.contact {
            let pairs = &world.contacts.pairs;
            find_couples(&mut world.grid, &self.old.couples, pairs, &self.reached);
        } else {
            world.grid.couples.clear();
        }
        let walls = (!total).then_some(&world.domain);
        tiles.frames.clear();
        let reach = tiles.corners;
        tiles.frames.extend(world.grid.lattices.iter().map(|l| Frame::new(l, walls, reach)));
        world.grid.gather_groups(&world.groups);
        let World { particles, solids, rigid, .. } = world;
        if solids.iter().any(|solid| solid.rigid) {
            rigid.list(particles.len(), |p| solids[particles.solid[p] as usize].rigid);
        }
        Ok(())
    }

    /// Finds the order and the tiles.
    fn order(
        &mut self,
        orders: &[Order],
        lattices: &[Lattice],
        places: &Places<'_>,
        tiles: &mut Tiles,
    ) {
        let particles = places.particles;
        tiles.parallel = particles.len() >= SMALLEST_PARALLEL && rayon::current_num_threads() > 1;
        let key = |from: usize| {
            let lattice = places.lattice(from);
            let order = &orders[lattice];
            let cell = places.cell(order, &lattices[lattice], from);
            let (colour, tile) = order.tile(cell);
            Key {
                group: (colour as u32) << 16 | lattice as u32,
                tile: (tile as u64) << 16 | particles.solid[from] as u64,
                within: order.within(cell) as u32,
                id: particles.id[from],
                from: from as u32,
            }
        };
        self.keys.clear();
        if tiles.parallel {
            (0..particles.len()).into_par_iter().map(key).collect_into_vec(&mut self.keys);
            self.keys.par_sort_unstable();
        } else {
            self.keys.extend((0..particles.len()).map(key));
            self.keys.sort_unstable(); // in place; ids make every key unique
        }
        tiles.ranges.clear();
        tiles.lattices.clear();
        tiles.colours = [0; COLOURS + 1];
        let mut start = 0;
        for tile in self.keys.chunk_by(Key::same_tile) {
            tiles.ranges.push(start..start + tile.len());
            tiles.lattices.push(tile[0].group as u16);
            tiles.colours[(tile[0].group >> 16) as usize + 1] += 1;
            start += tile.len();
        }
        for colour in 0..COLOURS {
            tiles.colours[colour + 1] += tiles.colours[colour];
        }
        tiles.reports.clear();
        tiles.reports.resize(tiles.ranges.len(), Report::default());
        tiles.by_lattice.clear();
        tiles.by_lattice.resize(lattices.len(), Report::default());
    }

    /// Brings every column into the new order.
    fn permute(&mut self, particles: &mut Particles, parallel: bool) {
        let keys = &self.keys;
        if keys.iter().enumerate().all(|(place, key)| key.from as usize == place) {
            return;
        }
        for records in particles.records_mut() {
            permute(records, &mut self.records, keys, parallel);
        }
        for column in particles.columns.iter_mut().filter(|column| !column.is_empty()) {
            permute(column, &mut self.numbers, keys, parallel);
        }
        for words in &mut particles.masks {
            permute(words, &mut self.words, keys, parallel);
        }
        permute(&mut particles.id, &mut self.ids, keys, parallel);
        permute(&mut particles.solid, &mut self.solids, keys, parallel);
    }

    /// Cells that hold particles, by lattice.
    fn find_bounds(
        &mut self,
        orders: &[Order],
        lattices: &[Lattice],
        places: &Places<'_>,
        parallel: bool,
    ) {
        let count = places.particles.len();
        let of = |p: usize| {
            let lattice = places.lattice(p);
            let cell = places.cell(&orders[lattice], &lattices[lattice], p);
            (lattice, [cell, cell])
        };
        self.bounds.clear();
        self.bounds.resize(lattices.len(), NOTHING);
        if parallel && lattices.len() == 1 {
            let add = |bounds, p| joined(bounds, of(p).1);
            let all = (0..count).into_par_iter().fold(|| NOTHING, add).reduce(|| NOTHING, joined);
            self.bounds[0] = all;
        } else {
            for p in 0..count {
                let (lattice, bounds) = of(p);
                self.bounds[lattice] = joined(self.bounds[lattice], bounds);
            }
        }
    }

    /// Surveys the scene as it was sorted last on so many processes.
    pub fn survey(&self, world: &World, tiles: &Tiles, processes: usize) -> Survey {
        let movement = if world.method.total { 0 } else { 1 };
        let reach = Reach { shape: world.method.shape, movement, corners: tiles.corners };
        let counts: Vec<usize> = tiles.ranges.iter().map(Range::len).collect();
        let (own, orders) = (self.own_tiles(&self.orders), &self.orders[..]);
        let scene = survey::Scene { tiles: &own, counts: &counts, orders, reach: &reach };
        survey::survey(world, &scene, processes)
    }

    /// The tiles in the order of the sort.
    fn own_tiles(&self, orders: &[Order]) -> Vec<OwnTile> {
        let tile = |keys: &[Key]| {
            let (lattice, colour) = (keys[0].group as u16 as usize, (keys[0].group >> 16) as usize);
            let index = orders[lattice].index((keys[0].tile >> 16) as usize);
            OwnTile { lattice, index, colour }
        };
        self.keys.chunk_by(Key::same_tile).map(tile).collect()
    }

    /// What outlives a step on nodes that other processes counted.
    fn hear_of_others(&mut self, grid: &mut Grid, ranks: &Ranks) {
        if ranks.is_alone() {
            return;
        }
        if grid.keeps.external {
            let old = &self.old;
            let active = old.runs.iter().cloned().flatten();
            let counted =
                active.filter(|node| old.counts(*node) && old.external[*node] != [0.0; 4]);
            let record = |place: usize| {
                let number = old.places().lattice(place);
                let lattice = &old.lattices[number];
                let [x, y, z, _] = old.external[place];
                let node = lattice.window.node(place).map(|index| index as f64);
                [number as f64, node[0], node[1], node[2], x, y, z]
            };
            let all = ranks.share(&counted.flat_map(record).collect::<Vec<f64>>());
            for [number, i, j, k, x, y, z] in all.as_chunks::<7>().0.iter().copied() {
                let window = &grid.lattices[number as usize].window;
                if let Some(place) = window.local([i, j, k].map(|index| index as usize)) {
                    grid.external[place] = [x, y, z, 0.0];
                }
            }
        }
        if grid.keeps.contact {
            let old = &self.old;
            let counted = old
                .couples
                .iter()
                .filter(|couple| couple.drag != [0.0; 3] && old.counts(couple.nodes[0] as usize));
            let record = |couple: &Couple| {
                let ([a, b, c], [x, y, z]) = (couple.drag, couple.slip);
                [f64::from(couple.pair), couple.number as f64, a, b, c, x, y, z]
            };
            let all = ranks.share(&counted.flat_map(record).collect::<Vec<f64>>());
            let couple = |[pair, number, a, b, c, x, y, z]: &[f64; 8]| Couple {
                pair: *pair as u32,
                number: *number as u64,
                drag: [*a, *b, *c],
                slip: [*x, *y, *z],
                ..Couple::default()
            };
            self.old.couples = all.as_chunks::<8>().0.iter().map(couple).collect();
            self.old.couples.sort_unstable_by_key(|couple| (couple.pair, couple.number));
        }
    }

    /// Refuses windows that would not fit in memory, before they are made.
    fn check_room(&self, reach: &Reach, grid: &Grid, together: bool) -> Result<(), Fault> {
        let all = self.bounds.iter().copied().fold(NOTHING, joined);
        let of_window = |(lattice, bounds): (&Lattice, &Bounds)| {
            let window = reach.window(lattice, if together { &all } else { bounds }, 0);
            window.size.iter().map(|count| *count as f64).product::<f64>()
        };
        let nodes: f64 = grid.lattices.iter().zip(&self.bounds).map(of_window).sum();
        // Asking the system takes longer than a sort of few particles.
        if nodes < 1e6 {
            return Ok(());
        }
        let bytes = nodes * BYTES_EACH;
        let free = memory::available() + grid.len() as f64 * BYTES_EACH;
        if bytes <= free && nodes < f64::from(u32::MAX) {
            return Ok(());
        }
        let what = format!(
            "the grid between the particles would need {:.3e} nodes and {} of memory; {} are free",
            nodes,
            memory::text(bytes),
            memory::text(free)
        );
        Err(Fault::run(what).because(
            "some particle is far away from the others: `boundary(delete)` and a smaller box remove it, \
             a larger cell size needs fewer nodes",
        ))
    }

    /// Fits the windows and their active runs to the cells of the particles; `together`: the nodes
    /// that particles of one lattice reach are in memory on all of them.
    fn fit(
        &mut self,
        orders: &[Order],
        places: &Places<'_>,
        reach: &Reach,
        grid: &mut Grid,
        together: bool,
    ) {
        if together {
            let all = self.bounds.iter().copied().fold(NOTHING, joined);
            self.bounds.fill(all);
        }
        std::mem::swap(grid, &mut self.old);
        grid.keeps = self.old.keeps;
        grid.mass_cutoff = self.old.mass_cutoff;
        grid.lattices.clone_from(&self.old.lattices);
        let mut start = 0;
        for (lattice, bounds) in grid.lattices.iter_mut().zip(&self.bounds) {
            lattice.window = reach.window(lattice, bounds, start);
            start += lattice.window.len();
        }
        resize(grid, start);
        self.keep_values(grid);
        grid.runs.clear();
        self.reached.clear();
        for number in 0..grid.lattices.len() {
            let (lattice, bounds) = (&grid.lattices[number], self.bounds[number]);
            if lattice.window.is_empty() {
                continue;
            }
            let (low, size) = reach.cells(lattice, &bounds);
            mark_cells(&mut self.marks[0], &orders[number], lattice, places, number, low, size);
            dilate_all(&mut self.marks, lattice, reach, low, size);
            match together {
                true => self.reached.extend(self.marks[0].iter().map(|mark| *mark != 0)),
                false => add_runs(&mut grid.runs, &self.marks[0], lattice.window.start),
            }
        }
        if together {
            self.add_common_runs(grid);
        }
        index_runs(grid);
    }

    /// Makes active on every lattice what is reached on one; all windows are the same.
    fn add_common_runs(&mut self, grid: &mut Grid) {
        let count = grid.lattices.first().map_or(0, |lattice| lattice.window.len());
        let marks = &mut self.marks[0];
        marks.clear();
        marks.resize(count, 0);
        for reached in self.reached.chunks(count.max(1)) {
            for (mark, reached) in marks.iter_mut().zip(reached) {
                *mark |= u8::from(*reached);
            }
        }
        for lattice in &grid.lattices {
            add_runs(&mut grid.runs, marks, lattice.window.start);
        }
    }

    /// Moves the nodal values that outlive a step from the old windows into the new ones.
    fn keep_values(&self, grid: &mut Grid) {
        let old = &self.old;
        let mut active = old.runs.iter().cloned().flatten().peekable();
        for (before, after) in old.lattices.iter().zip(&grid.lattices) {
            while let Some(from) = active.next_if(|from| *from < before.window.places().end) {
                let Some(to) = after.window.local(before.window.node(from)) else { continue };
                copy(&mut grid.external, to, &old.external, from);
                copy(&mut grid.displaced, to, &old.displaced, from);
            }
        }
    }
}

fn copy(to: &mut [[f64; 4]], place: usize, from: &[[f64; 4]], old: usize) {
    if let (Some(to), Some(from)) = (to.get_mut(place), from.get(old)) {
        *to = *from;
    }
}

/// Arrays of so many nodes, all zero.
fn resize(grid: &mut Grid, count: usize) {
    fn zeros<T: Copy + Default>(array: &mut Vec<T>, count: usize) {
        array.clear();
        array.resize(count, T::default());
    }
    let Keeps { external, displaced, filtered, rigid, dilation, temperature, contact } = grid.keeps;
    zeros::<Node>(&mut grid.nodes, count);
    zeros(&mut grid.mapped, count);
    zeros(&mut grid.external, if external { count } else { 0 });
    zeros(&mut grid.displaced, if displaced { count } else { 0 });
    zeros(&mut grid.filtered, if filtered { count } else { 0 });
    zeros(&mut grid.rigid, if rigid { count } else { 0 });
    zeros(&mut grid.dilation, if dilation { count } else { 0 });
    zeros(&mut grid.temperature, if temperature { count } else { 0 });
    zeros(&mut grid.heating, if temperature { count } else { 0 });
    zeros(&mut grid.coupled, if contact { count } else { 0 });
    zeros(&mut grid.outward, if contact { count } else { 0 });
}

/// column[place] <- column[keys[place].from], through a spare column.
fn permute<T: Copy + Default + Send + Sync>(
    column: &mut Vec<T>,
    spare: &mut Vec<T>,
    keys: &[Key],
    parallel: bool,
) {
    if parallel {
        keys.par_iter().map(|key| column[key.from as usize]).collect_into_vec(spare);
    } else {
        spare.clear();
        spare.extend(keys.iter().map(|key| column[key.from as usize]));
    }
    std::mem::swap(column, spare);
}

/// Most cells that a corner of a domain may lie away from its particle: beyond, it is moved there.
pub const MOST_CORNER_CELLS: usize = 8;

/// Cells for corners that lie at most `farthest` cells away from their particles now: a domain grows
/// by 0.3 of its size in a step at most.
pub fn corner_cells(farthest: f64) -> usize {
    ((1.3 * farthest).ceil() as usize).clamp(1, MOST_CORNER_CELLS)
}

/// Largest distance of a corner from its particle on one axis, in cells.
fn farthest_corner(
    particles: &Particles,
    lattices: &[Lattice],
    shape: ShapeKind,
    solids: &[Solid],
) -> f64 {
    let mut farthest = 0.0f64;
    for p in 0..particles.len() {
        let lattice = &lattices[solids[particles.solid[p] as usize].lattice];
        for extent in super::domains::extent(&particles.domain, shape, p) {
            farthest = farthest.max(extent / lattice.cells.cell);
        }
    }
    farthest
}

/// Which nodes particles can reach before the next sort.
pub struct Reach {
    shape: ShapeKind,
    movement: usize,
    corners: usize,
}

impl Reach {
    /// First and last node that the particles of a range of cells can reach on an axis.
    pub fn nodes(&self, cells: [usize; 2], count: usize) -> [usize; 2] {
        let last = count * self.shape.nodes_per_cell();
        let low = cells[0].saturating_sub(self.movement);
        let high = (cells[1] + self.movement).min(count - 1);
        let reach = |cell| self.shape.reach(cell, last, self.corners);
        [reach(low)[0], reach(high)[1]]
    }

    /// The window of nodes that particles in these cells can reach.
    fn window(&self, lattice: &Lattice, [low, high]: &Bounds, start: usize) -> Window {
        let mut window = Window { start, ..Window::default() };
        if low[0] > high[0] {
            return window;
        }
        let counts = lattice.cells.cells();
        for axis in 0..3 {
            if axis < lattice.cells.dimension {
                let [first, last] = self.nodes([low[axis], high[axis]], counts[axis]);
                window.lower[axis] = first;
                window.size[axis] = last + 1 - first;
            } else {
                window.size[axis] = 1;
            }
        }
        window
    }

    /// First cell and number of cells per axis.
    fn cells(&self, lattice: &Lattice, [low, high]: &Bounds) -> ([usize; 3], [usize; 3]) {
        let dimension = lattice.cells.dimension;
        let size = |axis| if axis < dimension { high[axis] + 1 - low[axis] } else { 1 };
        let first = |axis| if axis < dimension { low[axis] } else { 0 };
        (std::array::from_fn(first), std::array::from_fn(size))
    }
}

fn index(size: [usize; 3], offset: [usize; 3]) -> usize {
    (offset[0] * size[1] + offset[1]) * size[2] + offset[2]
}

/// Marks the cells of a lattice that hold particles.
fn mark_cells(
    marks: &mut Vec<u8>,
    order: &Order,
    lattice: &Lattice,
    places: &Places<'_>,
    number: usize,
    low: [usize; 3],
    size: [usize; 3],
) {
    marks.clear();
    marks.resize(size.iter().product(), 0);
    let mut last = [usize::MAX; 3];
    for p in 0..places.particles.len() {
        if places.lattice(p) != number {
            continue;
        }
        let cell = places.cell(order, lattice, p);
        if cell != last {
            last = cell;
            marks[index(size, std::array::from_fn(|axis| cell[axis] - low[axis]))] = 1;
        }
    }
}

/// Turns marks of cells into marks of the nodes they reach, one axis after the other.
fn dilate_all(
    marks: &mut [Vec<u8>; 2],
    lattice: &Lattice,
    reach: &Reach,
    low: [usize; 3],
    mut size: [usize; 3],
) {
    let counts = lattice.cells.cells();
    for axis in 0..lattice.cells.dimension {
        let nodes = lattice.window.size[axis];
        let stride: usize = size[axis + 1..].iter().product();
        let [from, to] = marks;
        to.clear();
        to.resize(from.len() / size[axis] * nodes, 0);
        for (outer, line) in from.chunks(stride * size[axis]).enumerate() {
            for (place, _) in line.iter().enumerate().filter(|(_, mark)| **mark != 0) {
                let (along, inner) = (place / stride, place % stride);
                let cell = low[axis] + along;
                let [first, last] = reach.nodes([cell, cell], counts[axis]);
                for node in first..=last {
                    let local = node - lattice.window.lower[axis];
                    to[(outer * nodes + local) * stride + inner] = 1;
                }
            }
        }
        size[axis] = nodes;
        marks.swap(0, 1);
    }
}

/// Lists the runs of marked nodes of a window, cut at the borders of blocks.
fn add_runs(runs: &mut Vec<std::ops::Range<usize>>, marks: &[u8], window: usize) {
    use super::grid::BLOCK;
    let mut node = 0;
    while node < marks.len() {
        if marks[node] == 0 {
            node += 1;
            continue;
        }
        let start = node;
        let border = ((window + start) / BLOCK + 1) * BLOCK - window;
        while node < marks.len().min(border) && marks[node] != 0 {
            node += 1;
        }
        runs.push(window + start..window + node);
    }
}

/// Finds the first run of each block.
fn index_runs(grid: &mut Grid) {
    use super::grid::BLOCK;
    grid.first_run.clear();
    let mut run = 0;
    for block in (0..grid.nodes.len()).step_by(BLOCK) {
        grid.first_run.push(run);
        while grid.runs.get(run).is_some_and(|run| run.start < block + BLOCK) {
            run += 1;
        }
    }
    grid.first_run.push(run);
}
