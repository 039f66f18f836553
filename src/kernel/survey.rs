//! What a scene would cost on many processes, without starting them: their loads, and the messages
//! and nodes that pass between them, counted by the rules of [`super::deal`] and [`super::ghosts`].

use super::ghosts::OwnTile;
use super::sort::Reach;
use super::tiles::{COLOURS, Order};
use crate::parallel::partition::{Census, Partition, imbalance};
use crate::world::World;
use std::collections::BTreeSet;

/// A scene on several processes.
#[derive(Clone, Debug, PartialEq)]
pub struct Survey {
    /// Number of processes.
    pub processes: usize,
    /// Most particles of a process over the mean.
    pub imbalance: f64,
    /// The same if the box were cut into equal boxes, one for each process.
    pub uniform_imbalance: f64,
    /// Messages that a process sends in a sweep: mean and most.
    pub messages: [f64; 2],
    /// Nodes that it sends in a sweep: mean and most.
    pub nodes: [f64; 2],
}

/// The sorted scene of one process.
pub struct Scene<'a> {
    /// Tiles with particles.
    pub tiles: &'a [OwnTile],
    /// Particles of each.
    pub counts: &'a [usize],
    /// The order of cells of each lattice.
    pub orders: &'a [Order],
    /// What the particles of a tile can reach.
    pub reach: &'a Reach,
}

/// Surveys a scene on so many processes.
pub fn survey(world: &World, scene: &Scene<'_>, processes: usize) -> Survey {
    let mut loads = vec![0; processes];
    let trees = if world.method.total { world.grid.lattices.len() } else { 1 };
    let partitions: Vec<Partition> = (0..trees)
        .map(|tree| {
            let own = |tile: &OwnTile| trees == 1 || tile.lattice == tree;
            Partition::new(&census(scene, own), &mut loads)
        })
        .collect();
    let owner = |tile: &OwnTile| partitions[tile.lattice.min(trees - 1)].owner(tile.index);
    let owners: Vec<usize> = scene.tiles.iter().map(owner).collect();
    let mut sent = vec![0usize; processes];
    let mut letters = BTreeSet::new();
    each_shared_node(world, scene, |tiles| {
        let reaching = tiles.iter().enumerate().filter_map(|(c, tile)| Some((c, owners[(*tile)?])));
        let sharers: BTreeSet<usize> = reaching.clone().map(|(_, owner)| owner).collect();
        for (colour, from) in reaching {
            sent[from] += sharers.len() - 1;
            let others = sharers.iter().filter(|to| **to != from);
            letters.extend(others.map(|to| (colour, from, *to)));
        }
    });
    let mut messages = vec![0usize; processes];
    letters.iter().for_each(|(_, from, _)| messages[*from] += 1);
    let summary = |numbers: &[usize]| {
        let sum: usize = numbers.iter().sum();
        [sum as f64 / processes as f64, numbers.iter().copied().max().unwrap_or(0) as f64]
    };
    Survey {
        processes,
        imbalance: imbalance(&loads),
        uniform_imbalance: imbalance(&uniform_loads(world, processes)),
        messages: summary(&messages),
        nodes: summary(&sent),
    }
}

fn census(scene: &Scene<'_>, own: impl Fn(&OwnTile) -> bool) -> Census {
    let tiles = || scene.tiles.iter().zip(scene.counts).filter(|(tile, _)| own(tile));
    let limit = |axis: usize, most: bool| {
        let indices = tiles().map(|(tile, _)| tile.index[axis]);
        if most { indices.max() } else { indices.min() }.unwrap_or(0)
    };
    let lower = [limit(0, false), limit(1, false)];
    let size = [0, 1].map(|axis| limit(axis, true) + 1 - lower[axis]);
    let mut census = Census::of_none(lower, size);
    tiles().for_each(|(tile, count)| census.add(tile.index, *count as i64));
    census
}

/// Calls `visit` for each active node with the tiles that reach it, by colour.
fn each_shared_node(
    world: &World,
    scene: &Scene<'_>,
    mut visit: impl FnMut([Option<usize>; COLOURS]),
) {
    let lattices = &world.grid.lattices;
    let size = |axis: usize, lattice: usize| lattices[lattice].window.size[axis];
    let mut columns: Vec<Vec<[Option<usize>; COLOURS]>> = (0..lattices.len())
        .map(|lattice| vec![[None; COLOURS]; size(0, lattice) * size(1, lattice)])
        .collect();
    for (number, tile) in scene.tiles.iter().enumerate() {
        let ranges =
            tile.columns(&lattices[tile.lattice], &scene.orders[tile.lattice], scene.reach);
        for i in ranges[0].clone() {
            for j in ranges[1].clone() {
                columns[tile.lattice][i * size(1, tile.lattice) + j][tile.colour] = Some(number);
            }
        }
    }
    let mut active = world.grid.runs.iter().cloned().flatten().peekable();
    for (number, lattice) in lattices.iter().enumerate() {
        while let Some(place) = active.next_if(|place| *place < lattice.window.places().end) {
            let node = lattice.window.node(place);
            let [i, j] = [0, 1].map(|axis| node[axis] - lattice.window.lower[axis]);
            visit(columns[number][i * lattice.window.size[1] + j]);
        }
    }
}

/// Particles of each process if the box were cut into equal boxes with the least surface.
fn uniform_loads(world: &World, processes: usize) -> Vec<i64> {
    let domain = &world.domain;
    let length = |axis: usize| domain.upper[axis] - domain.lower[axis];
    let counts = equal_boxes(std::array::from_fn(length), domain.dimension, processes);
    let mut loads = vec![0; processes];
    for place in &world.particles.position {
        let mut number = 0;
        for axis in 0..domain.dimension {
            let part = (place[axis] - domain.lower[axis]) / length(axis) * counts[axis] as f64;
            number = number * counts[axis] + (part.max(0.0) as usize).min(counts[axis] - 1);
        }
        loads[number] += 1;
    }
    loads
}

/// Numbers of boxes per axis, of which the product is given and the surface least.
fn equal_boxes(lengths: [f64; 3], dimension: usize, processes: usize) -> [usize; 3] {
    let divisors = || (1..=processes).filter(|n| processes.is_multiple_of(*n));
    let mut best = (f64::INFINITY, [processes, 1, 1]);
    for x in divisors() {
        for y in divisors().filter(|y| (processes / x).is_multiple_of(*y)) {
            let counts = [x, y, processes / x / y];
            if counts[dimension..].iter().any(|count| *count > 1) {
                continue;
            }
            let side: [f64; 3] = std::array::from_fn(|axis| lengths[axis] / counts[axis] as f64);
            let surface = match dimension {
                1 => 0.0,
                2 => side[0] + side[1],
                _ => side[0] * side[1] + side[1] * side[2] + side[2] * side[0],
            };
            if surface < best.0 {
                best = (surface, counts);
            }
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_are_as_cubic_as_they_can_be() {
        assert_eq!(equal_boxes([8.0, 1.0, 0.0], 2, 8), [8, 1, 1]);
        assert_eq!(equal_boxes([1.0, 1.0, 1.0], 3, 27), [3, 3, 3]);
        assert_eq!(equal_boxes([1.0, 2.0, 1.0], 3, 16), [2, 4, 2]);
        assert_eq!(equal_boxes([1.0, 0.0, 0.0], 1, 5), [5, 1, 1]);
    }
}
