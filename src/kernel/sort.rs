//! Sorting particles by tile and fitting the window of nodes around them.
//!
//! Particles are ordered by colour, tile, solid, cell and id. The order depends on their places
//! alone, never on threads, and it stays until some particle could have crossed a cell.

use super::tiles::{COLOURS, Order, Report, SMALLEST_PARALLEL, Tiles};
use crate::model::domain::Domain;
use crate::model::grid::{Grid, Node, Window};
use crate::model::particles::Particles;
use crate::world::World;
use rayon::prelude::*;

/// Nodes beyond the cell of a particle that its shape function reaches, below and above.
const REACH: [usize; 2] = [0, 1];

/// Cells that a particle may cross before the next sort.
const MOVEMENT: usize = 1;

/// Memory of the sort, kept from one to the next.
#[derive(Default)]
pub struct Sorter {
    keys: Vec<Key>,
    records: Vec<[f64; 4]>,
    numbers: Vec<f64>,
    words: Vec<u64>,
    ids: Vec<u32>,
    solids: Vec<u16>,
    marks: [Vec<u8>; 2],
    nodes: Vec<Node>,
    mapped: Vec<[f64; 4]>,
}

/// Where a particle goes: ordered by tile and solid, then cell, then id.
#[derive(Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    tile: u64,
    cell: u32,
    id: u32,
    from: u32,
}

/// Cell of a place, the last cell for places on the upper border.
fn cell_of(domain: &Domain, cells: [usize; 3], place: [f64; 4]) -> [usize; 3] {
    std::array::from_fn(|axis| {
        if axis >= domain.dimension {
            return 0;
        }
        let r = (place[axis] - domain.lower[axis]) * (1.0 / domain.cell);
        (r as usize).min(cells[axis] - 1)
    })
}

impl Sorter {
    /// Sorts the particles by the places they are about to have (x + dx) and fits the window to
    /// the old and the new places. Nodal values of the step under way are kept.
    pub fn sort(&mut self, world: &mut World, tiles: &mut Tiles) {
        let (domain, particles) = (&world.domain, &mut world.particles);
        self.order(domain, particles, tiles);
        self.permute(particles);
        self.fit(domain, particles, &mut world.grid, tiles.parallel);
        world.grid.gather_groups(domain, &world.groups);
    }

    /// Finds the order and the tiles.
    fn order(&mut self, domain: &Domain, particles: &Particles, tiles: &mut Tiles) {
        let order = Order::new(domain);
        let cells = domain.cells();
        tiles.parallel = particles.len() >= SMALLEST_PARALLEL && rayon::current_num_threads() > 1;
        let key = |from: usize| {
            let (x, dx) = (particles.position[from], particles.displacement[from]);
            let cell = cell_of(domain, cells, std::array::from_fn(|axis| x[axis] + dx[axis]));
            let (colour, tile) = order.tile(cell);
            Key {
                tile: (colour as u64) << 62 | (tile as u64) << 16 | particles.solid[from] as u64,
                cell: order.within(cell) as u32,
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
        tiles.colours = [0; COLOURS + 1];
        let mut start = 0;
        for tile in self.keys.chunk_by(|a, b| a.tile >> 16 == b.tile >> 16) {
            tiles.ranges.push(start..start + tile.len());
            tiles.colours[(tile[0].tile >> 62) as usize + 1] += 1;
            start += tile.len();
        }
        for colour in 0..COLOURS {
            tiles.colours[colour + 1] += tiles.colours[colour];
        }
        tiles.reports.clear();
        tiles.reports.resize(tiles.ranges.len(), Report::default());
    }

    /// Brings every column into the new order.
    fn permute(&mut self, particles: &mut Particles) {
        let keys = &self.keys;
        if keys.iter().enumerate().all(|(place, key)| key.from as usize == place) {
            return;
        }
        for records in
            [&mut particles.position, &mut particles.velocity, &mut particles.displacement]
        {
            permute(records, &mut self.records, keys);
        }
        for column in particles.columns.iter_mut().filter(|column| !column.is_empty()) {
            permute(column, &mut self.numbers, keys);
        }
        for words in &mut particles.masks {
            permute(words, &mut self.words, keys);
        }
        permute(&mut particles.id, &mut self.ids, keys);
        permute(&mut particles.solid, &mut self.solids, keys);
    }

    /// Fits the window and its active runs to the cells of x and x + dx.
    fn fit(&mut self, domain: &Domain, particles: &Particles, grid: &mut Grid, parallel: bool) {
        let cells = domain.cells();
        let both = |p: usize| {
            let (x, dx) = (particles.position[p], particles.displacement[p]);
            let new = std::array::from_fn(|axis| x[axis] + dx[axis]);
            [cell_of(domain, cells, x), cell_of(domain, cells, new)]
        };
        let bounds = bounds(particles.len(), parallel, both);
        let window = window(domain, bounds);
        let marks = &mut self.marks;
        marks[0].clear();
        marks[0].resize(window.len(), 0);
        let mut last = [[usize::MAX; 3]; 2];
        for p in 0..particles.len() {
            for (cell, last) in both(p).into_iter().zip(&mut last) {
                if cell != *last {
                    *last = cell;
                    let offset = std::array::from_fn(|axis| cell[axis] - window.lower[axis]);
                    marks[0][index(window.size, offset)] = 1;
                }
            }
        }
        for axis in 0..domain.dimension {
            let [from, to] = marks;
            to.clear();
            to.resize(window.len(), 0);
            dilate(window.size, axis, from, to);
            marks.swap(0, 1);
        }
        self.keep_values(grid, window);
        find_runs(grid, &self.marks[0]);
    }

    /// Moves the nodal values of the old window into the new one.
    fn keep_values(&mut self, grid: &mut Grid, window: Window) {
        self.nodes.clear();
        self.nodes.resize(window.len(), Node::default());
        self.mapped.clear();
        self.mapped.resize(window.len(), [0.0; 4]);
        for old in grid.runs.iter().cloned().flatten() {
            if let Some(new) = window.local(grid.window.node(old)) {
                self.nodes[new] = grid.nodes[old];
                self.mapped[new] = grid.mapped[old];
            }
        }
        std::mem::swap(&mut grid.nodes, &mut self.nodes);
        std::mem::swap(&mut grid.mapped, &mut self.mapped);
        if grid.separate_external {
            let mut external = vec![[0.0; 4]; window.len()];
            for old in grid.runs.iter().cloned().flatten() {
                if let (Some(new), Some(force)) =
                    (window.local(grid.window.node(old)), grid.external.get(old))
                {
                    external[new] = *force;
                }
            }
            grid.external = external;
        }
        grid.window = window;
    }
}

/// column[place] <- column[keys[place].from], through a spare column.
fn permute<T: Copy + Default + Send + Sync>(column: &mut Vec<T>, spare: &mut Vec<T>, keys: &[Key]) {
    spare.clear();
    spare.extend(keys.iter().map(|key| column[key.from as usize]));
    std::mem::swap(column, spare);
}

/// Smallest and largest cell per axis.
fn bounds(
    count: usize,
    parallel: bool,
    cells: impl Fn(usize) -> [[usize; 3]; 2] + Sync,
) -> [[usize; 3]; 2] {
    let start = || [[usize::MAX; 3], [0; 3]];
    let join = |[low, high]: [[usize; 3]; 2], [l, h]: [[usize; 3]; 2]| {
        [std::array::from_fn(|a| low[a].min(l[a])), std::array::from_fn(|a| high[a].max(h[a]))]
    };
    let add = |limits, p| cells(p).into_iter().fold(limits, |limits, c| join(limits, [c, c]));
    if parallel {
        (0..count).into_par_iter().fold(start, add).reduce(start, join)
    } else {
        (0..count).fold(start(), add)
    }
}

/// The window of nodes that particles in these cells can reach before the next sort.
fn window(domain: &Domain, [low, high]: [[usize; 3]; 2]) -> Window {
    let nodes = domain.nodes();
    let mut window = Window::default();
    for axis in 0..3 {
        if axis < domain.dimension {
            let lower = low[axis].min(high[axis]).saturating_sub(MOVEMENT + REACH[0]);
            let upper = (high[axis] + MOVEMENT + REACH[1]).min(nodes[axis] - 1);
            window.lower[axis] = lower;
            window.size[axis] = upper + 1 - lower;
        } else {
            window.size[axis] = 1;
        }
    }
    window
}

fn index(size: [usize; 3], offset: [usize; 3]) -> usize {
    (offset[0] * size[1] + offset[1]) * size[2] + offset[2]
}

/// Marks every node that a marked cell reaches along one axis.
fn dilate(size: [usize; 3], axis: usize, from: &[u8], to: &mut [u8]) {
    let stride: usize = size[axis + 1..].iter().product();
    let below = MOVEMENT + REACH[0];
    let above = MOVEMENT + REACH[1];
    for (outer, line) in from.chunks(stride * size[axis]).enumerate() {
        let start = outer * stride * size[axis];
        for (place, _) in line.iter().enumerate().filter(|(_, mark)| **mark != 0) {
            let (along, inner) = (place / stride, place % stride);
            let first = along.saturating_sub(below);
            let last = (along + above).min(size[axis] - 1);
            for node in first..=last {
                to[start + node * stride + inner] = 1;
            }
        }
    }
}

/// Lists the runs of marked nodes, cut at the borders of blocks.
fn find_runs(grid: &mut Grid, marks: &[u8]) {
    use super::grid::BLOCK;
    grid.runs.clear();
    grid.first_run.clear();
    let count = grid.nodes.len();
    for block in (0..count).step_by(BLOCK) {
        grid.first_run.push(grid.runs.len());
        let end = count.min(block + BLOCK);
        let mut node = block;
        while node < end {
            if marks[node] == 0 {
                node += 1;
                continue;
            }
            let start = node;
            while node < end && marks[node] != 0 {
                node += 1;
            }
            grid.runs.push(start..node);
        }
    }
    grid.first_run.push(grid.runs.len());
}
