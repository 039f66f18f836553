//! The whole scene in the first process, for what it writes.

use crate::kernel::deal;
use crate::model::grid::{Grid, Node};
use crate::model::lattice::Window;
use crate::parallel::{Exchange, Ranks};
use crate::world::World;

/// All particles, and all nodes if asked for, in the first process; nothing in the others, whose
/// world is empty. `None` if there is one process, which has everything already.
pub fn gather(world: &mut World, nodes: bool) -> Option<World> {
    let ranks = world.ranks.clone();
    let exchange = ranks.exchange()?;
    let exist = deal::present_records(&mut world.particles, &ranks);
    let own: Vec<usize> = world.particles.counted().collect();
    let letters = exchange.gather(&deal::pack(&mut world.particles, &exist, &own));
    let grid = std::mem::take(&mut world.grid);
    let mut whole = World { ranks: Ranks::default(), ..world.clone() };
    world.grid = grid;
    let none = vec![false; whole.particles.len()];
    whole.particles.retain(&none);
    whole.particles.counted_elsewhere = false;
    for letter in &letters {
        deal::unpack(&mut whole.particles, &exist, letter);
    }
    if nodes {
        whole.grid = gather_nodes(exchange, &mut world.grid);
    }
    Some(whole)
}

/// An array of four numbers per node, and whether the scene has it.
type Array = fn(&mut Grid) -> (&mut Vec<[f64; 4]>, bool);

const ARRAYS: [Array; 4] = [
    |grid| (&mut grid.external, grid.keeps.external),
    |grid| (&mut grid.displaced, grid.keeps.displaced),
    |grid| (&mut grid.temperature, grid.keeps.temperature),
    |grid| (&mut grid.rigid, grid.keeps.rigid),
];

/// Words of a node in a letter: key, mass and momentum, force, arrays.
const WORDS: usize = 1 + 8 + 4 * ARRAYS.len();

/// Number of the lattice of a node and its number there.
fn key(grid: &Grid, place: usize) -> u64 {
    let number = grid.places().lattice(place);
    let lattice = &grid.lattices[number];
    (number as u64) << 48 | lattice.number(lattice.window.node(place))
}

fn gather_nodes(exchange: &dyn Exchange, grid: &mut Grid) -> Grid {
    let mut letter = Vec::new();
    let places: Vec<usize> =
        grid.runs.iter().cloned().flatten().filter(|place| grid.counts(*place)).collect();
    for place in places {
        let Node { motion, change } = grid.nodes[place];
        letter.extend_from_slice(&key(grid, place).to_le_bytes());
        let mut put = |numbers: [f64; 4]| {
            numbers.iter().for_each(|number| letter.extend_from_slice(&number.to_le_bytes()));
        };
        put(motion);
        put(change);
        for array in ARRAYS {
            put(array(grid).0.get(place).copied().unwrap_or_default());
        }
    }
    let letters = exchange.gather(&letter);
    let words = letters.iter().flat_map(|letter| letter.as_chunks::<8>().0);
    let words: Vec<u64> = words.map(|bytes| u64::from_le_bytes(*bytes)).collect();
    let records = words.as_chunks::<WORDS>().0;
    let mut whole = Grid::default();
    whole.lattices.clone_from(&grid.lattices);
    whole.keeps = grid.keeps;
    whole.mass_cutoff = grid.mass_cutoff;
    let count = fit(&mut whole, records);
    whole.nodes = vec![Node::default(); count];
    for array in ARRAYS {
        let (array, exists) = array(&mut whole);
        *array = vec![[0.0; 4]; if exists { count } else { 0 }];
    }
    for record in records {
        let (lattice, node) = find(&whole, record[0]);
        let Some(place) = whole.lattices[lattice].window.local(node) else { continue };
        let four = |from: usize| std::array::from_fn(|k| f64::from_bits(record[from + k]));
        whole.nodes[place] = Node { motion: four(1), change: four(5) };
        for (number, array) in ARRAYS.into_iter().enumerate() {
            if let Some(numbers) = array(&mut whole).0.get_mut(place) {
                *numbers = four(9 + 4 * number);
            }
        }
    }
    whole
}

/// The lattice of a key and the node there.
fn find(grid: &Grid, key: u64) -> (usize, [usize; 3]) {
    let (lattice, number) = ((key >> 48) as usize, (key & ((1 << 48) - 1)) as usize);
    let [_, ny, nz] = grid.lattices[lattice].nodes;
    (lattice, [number / (ny * nz), number / nz % ny, number % nz])
}

/// Fits the windows to the nodes of the records; gives the number of nodes in memory.
fn fit(grid: &mut Grid, records: &[[u64; WORDS]]) -> usize {
    let mut bounds = vec![[[usize::MAX; 3], [0; 3]]; grid.lattices.len()];
    for record in records {
        let (lattice, node) = find(grid, record[0]);
        let [low, high] = &mut bounds[lattice];
        for axis in 0..3 {
            low[axis] = low[axis].min(node[axis]);
            high[axis] = high[axis].max(node[axis] + 1);
        }
    }
    let mut start = 0;
    for (lattice, [low, high]) in grid.lattices.iter_mut().zip(bounds) {
        lattice.window = match low[0] < high[0] {
            true => Window { lower: low, size: std::array::from_fn(|a| high[a] - low[a]), start },
            false => Window { start, ..Window::default() },
        };
        start += lattice.window.len();
    }
    start
}
