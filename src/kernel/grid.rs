//! Passes over the active nodes.

use crate::model::grid::{Grid, Node};
use crate::model::lattice::Lattice;
use rayon::prelude::*;
use std::ops::Range;

/// Nodes of one block: runs are cut at multiples of it, so that blocks are independent.
pub const BLOCK: usize = 2048;

/// Visits the active runs of nodes, in parallel blocks if asked to.
pub fn for_each_run(
    grid: &mut Grid,
    parallel: bool,
    visit: impl Fn(&mut [Node], &mut [[f64; 4]]) + Sync,
) {
    let (runs, first_run) = (&grid.runs, &grid.first_run);
    let block = |(number, (nodes, mapped)): (usize, (&mut [Node], &mut [[f64; 4]]))| {
        let runs = &runs[first_run[number]..first_run[number + 1]];
        for Range { start, end } in runs.iter().cloned() {
            let local = start - number * BLOCK..end - number * BLOCK;
            visit(&mut nodes[local.clone()], &mut mapped[local]);
        }
    };
    if parallel {
        let blocks = grid.nodes.par_chunks_mut(BLOCK).zip(grid.mapped.par_chunks_mut(BLOCK));
        blocks.enumerate().for_each(block);
    } else {
        let blocks = grid.nodes.chunks_mut(BLOCK).zip(grid.mapped.chunks_mut(BLOCK));
        blocks.enumerate().for_each(block);
    }
}

/// 1/m, or 0 for a node without mass.
#[inline(always)]
pub fn inverse_mass(node: &Node, cutoff: f64) -> f64 {
    let mass = node.motion[3];
    if mass > cutoff { 1.0 / mass } else { 0.0 }
}

/// v = momentum/m, v* = v + dt f/m (language.md 7.1 line 7); clears the second mapping.
/// Nodes without mass stay at rest.
pub fn update(grid: &mut Grid, parallel: bool, dt: f64) {
    let cutoff = grid.mass_cutoff;
    for_each_run(grid, parallel, |nodes, mapped| {
        for (node, mapped) in nodes.iter_mut().zip(mapped) {
            let inverse = inverse_mass(node, cutoff);
            for axis in 0..3 {
                let change = dt * inverse * node.change[axis];
                node.change[axis] = change;
                node.motion[axis] = node.motion[axis] * inverse + change;
            }
            node.change[3] = 0.0;
            *mapped = [0.0; 4];
        }
    });
}

/// v = momentum/m and v* = v, before any force is known (`usf`); the momentum waits in `mapped`.
pub fn first_velocities(grid: &mut Grid, parallel: bool) {
    let cutoff = grid.mass_cutoff;
    for_each_run(grid, parallel, |nodes, mapped| {
        for (node, mapped) in nodes.iter_mut().zip(mapped) {
            let inverse = inverse_mass(node, cutoff);
            *mapped = node.motion;
            for axis in 0..3 {
                node.motion[axis] *= inverse;
            }
            node.change = [0.0; 4];
        }
    });
}

/// mapped <- v, what `usf` takes strains from; the nodes are as after P2G of mass and momentum.
pub fn velocities_for_strain(grid: &mut Grid, parallel: bool) {
    for_each_run(grid, parallel, |nodes, mapped| {
        for (node, mapped) in nodes.iter_mut().zip(mapped) {
            let momentum = *mapped;
            for axis in 0..3 {
                mapped[axis] = node.motion[axis] - node.change[axis];
            }
            *node = Node { motion: momentum, change: [0.0; 4] };
        }
    });
}

/// v = momentum/m of the second mapping (line 13).
pub fn divide(grid: &mut Grid, parallel: bool) {
    let cutoff = grid.mass_cutoff;
    for_each_run(grid, parallel, |nodes, mapped| {
        for (node, mapped) in nodes.iter().zip(mapped) {
            let inverse = inverse_mass(node, cutoff);
            for value in mapped {
                *value *= inverse;
            }
        }
    });
}

/// Clears mass, momentum and force for the next P2G (line 3).
pub fn clear(grid: &mut Grid, parallel: bool) {
    for_each_run(grid, parallel, |nodes, _| nodes.fill(Node::default()));
}

/// Clears the second mapping.
pub fn clear_mapped(grid: &mut Grid, parallel: bool) {
    for_each_run(grid, parallel, |_, mapped| mapped.fill([0.0; 4]));
}

/// Like [`divide`], then [`clear`], in one pass: for steps in which no fix reads the mass after
/// the second mapping.
pub fn divide_and_clear(grid: &mut Grid, parallel: bool) {
    let cutoff = grid.mass_cutoff;
    for_each_run(grid, parallel, |nodes, mapped| {
        for (node, mapped) in nodes.iter_mut().zip(mapped) {
            let inverse = inverse_mass(node, cutoff);
            for value in mapped {
                *value *= inverse;
            }
            *node = Node::default();
        }
    });
}

/// Like [`divide`]; the momentum of the second mapping becomes that of the next step, whose
/// weights and masses are the same (total Lagrangian).
pub fn divide_and_carry(grid: &mut Grid, parallel: bool) {
    let cutoff = grid.mass_cutoff;
    for_each_run(grid, parallel, |nodes, mapped| {
        for (node, mapped) in nodes.iter_mut().zip(mapped) {
            let inverse = inverse_mass(node, cutoff);
            node.motion[..3].copy_from_slice(&mapped[..3]);
            *mapped = mapped.map(|momentum| inverse * momentum);
            node.change = [0.0; 4];
        }
    });
}

/// mapped <- v* for schemes without a second mapping.
pub fn take_updated(grid: &mut Grid, parallel: bool) {
    for_each_run(grid, parallel, |nodes, mapped| {
        for (node, mapped) in nodes.iter().zip(mapped) {
            *mapped = node.motion;
        }
    });
}

/// dilation <- dilation/m, the average of tr L over the particles around a node.
pub fn average_dilation(grid: &mut Grid) {
    let Grid { nodes, dilation, runs, mass_cutoff, .. } = grid;
    for node in runs.iter().cloned().flatten() {
        dilation[node] *= inverse_mass(&nodes[node], *mass_cutoff);
    }
}

/// The axis of bodies of revolution stays where it is: v_r = v*_r = 0 at its nodes, whatever fixes
/// say; otherwise the hoop strain v_r/r would have no bound.
pub fn hold_axis(grid: &mut Grid) {
    let Grid { lattices, nodes, held, filtered, .. } = grid;
    for node in lattices.iter().flat_map(Lattice::axis) {
        (nodes[node].motion[0], nodes[node].change[0]) = (0.0, 0.0);
        if !filtered.is_empty() {
            held.push((node, 0));
        }
    }
}

/// The same for the velocity of the second mapping.
pub fn hold_mapped_axis(grid: &mut Grid) {
    let Grid { lattices, mapped, .. } = grid;
    for node in lattices.iter().flat_map(Lattice::axis) {
        mapped[node][0] = 0.0;
    }
}

/// u += dt v of the nodes (line 14, total Lagrangian), where something reads it.
pub fn displace(grid: &mut Grid, dt: f64) {
    let Grid { mapped, displaced, runs, .. } = grid;
    displace_by(displaced, runs, dt, |node| mapped[node]);
}

/// u += dt v* for schemes that keep no velocities of the end of the step.
pub fn displace_updated(grid: &mut Grid, dt: f64) {
    let Grid { nodes, displaced, runs, .. } = grid;
    displace_by(displaced, runs, dt, |node| nodes[node].motion);
}

fn displace_by(
    displaced: &mut [[f64; 4]],
    runs: &[Range<usize>],
    dt: f64,
    velocity: impl Fn(usize) -> [f64; 4],
) {
    if displaced.is_empty() {
        return;
    }
    for node in runs.iter().cloned().flatten() {
        for (u, v) in displaced[node].iter_mut().zip(&velocity(node)[..3]) {
            *u += dt * v;
        }
    }
}
