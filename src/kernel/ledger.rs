//! The loops of the energy ledger over nodes, around their update.

use super::grid::{BLOCK, inverse_mass};
use crate::math::exact_sum::ExactSum;
use crate::model::contact::{Pair, Rule};
use crate::model::grid::{Grid, Node};
use crate::model::ledger::{Ledger, Notes};
use rayon::prelude::*;

/// Visits the notes of the active nodes, in parallel blocks if asked to.
fn for_each_note(
    notes: &mut [Notes],
    grid: &Grid,
    parallel: bool,
    visit: impl Fn(usize, &mut Notes) + Sync,
) {
    let block = |(number, notes): (usize, &mut [Notes])| {
        for run in &grid.runs[grid.first_run[number]..grid.first_run[number + 1]] {
            for node in run.clone() {
                visit(node, &mut notes[node - number * BLOCK]);
            }
        }
    };
    match parallel {
        true => notes.par_chunks_mut(BLOCK).enumerate().for_each(block),
        false => notes.chunks_mut(BLOCK).enumerate().for_each(block),
    }
}

/// Takes momenta and internal forces: after P2G, before anything else acts on the nodes.
pub fn note_internal(ledger: &mut Ledger, grid: &Grid, parallel: bool) {
    for_each_note(&mut ledger.nodes, grid, parallel, |node, notes| {
        let node = &grid.nodes[node];
        *notes = Notes::default();
        notes.momentum.copy_from_slice(&node.motion[..3]);
        notes.internal.copy_from_slice(&node.change[..3]);
    });
}

/// Takes what has been added to the internal forces, less the forces of damping fixes.
pub fn note_external(ledger: &mut Ledger, grid: &Grid, parallel: bool) {
    for_each_note(&mut ledger.nodes, grid, parallel, |node, notes| {
        let total = &grid.nodes[node].change;
        for axis in 0..3 {
            notes.external[axis] = total[axis] - notes.internal[axis] - notes.damping[axis];
        }
    });
}

/// Takes the forces J/dt of bodies in contact, after they have met.
pub fn note_contact(ledger: &mut Ledger, grid: &mut Grid, dt: f64) {
    for couple in &mut grid.couples {
        for (side, sign) in [-1.0, 1.0].into_iter().enumerate() {
            let notes = &mut ledger.nodes[couple.nodes[side] as usize];
            couple.internal[side] = notes.internal;
            for (force, impulse) in notes.contact.iter_mut().zip(couple.impulse) {
                *force += sign * impulse / dt;
            }
        }
    }
}

/// Takes the changes of the velocities, after the update and the prescribed velocities. Where a
/// change is not that of the forces, velocities are prescribed.
pub fn note_changes(ledger: &mut Ledger, grid: &Grid, parallel: bool, dt: f64) {
    for_each_note(&mut ledger.nodes, grid, parallel, |node, notes| {
        let node = &grid.nodes[node];
        let inverse = inverse_mass(node, grid.mass_cutoff);
        for axis in 0..3 {
            let (v, change) = (node.motion[axis], node.change[axis]);
            let force = notes.internal[axis] + notes.external[axis] + notes.damping[axis];
            let force = force + notes.contact[axis];
            let free = dt * inverse * force;
            // The sum of the parts may differ from the force in its last digits.
            let unlike = (change - free).abs() > SAME * (change.abs() + free.abs() + v.abs());
            notes.change[axis] = change;
            notes.prescribed[axis] = unlike.then_some(v - 0.5 * change);
        }
    });
}

/// Changes of a velocity that agree to this part of it come from the forces.
const SAME: f64 = 1e-10;

/// Books the work of the nodal forces; `mapped` holds the momenta p' = sum N m v of the new
/// velocities of the particles.
///
/// With w = (p + p')/(2 m), FLIP changes the kinetic energy of the particles by sum m (v* - v).w,
/// exactly, since it changes v_p by sum N (v* - v). Where velocities are prescribed, w is the
/// prescribed one: what holds a wall does no work. Where strains follow from the `updated` velocities
/// v*, w = (v + v*)/2 and the nodes gain sum m (v* - v).w. The impulse r = m (v* - v) - dt (f + mb) is that
/// of prescribed velocities.
pub fn book_forces(ledger: &mut Ledger, grid: &Grid, parallel: bool, dt: f64, updated: bool) {
    let notes = &ledger.nodes;
    let sums = sum_over_nodes(grid, parallel, |sums, node| {
        sums.add(grid, node, &notes[node], dt, updated);
    });
    let books = &mut ledger.books;
    books.external.merge(&sums.external);
    books.damping.merge(&sums.damping);
    books.boundary.merge(&sums.boundary);
    books.nodal.merge(&sums.nodal);
}

/// The same where only internal forces change velocities: sum m (v* - v).w, of which no notes are needed.
pub fn book_free(ledger: &mut Ledger, grid: &Grid, parallel: bool, updated: bool) {
    let sums = sum_over_nodes(grid, parallel, |sums, node| {
        let (Node { motion, change }, mapped) = (&grid.nodes[node], &grid.mapped[node]);
        let mass = motion[3];
        let mut twice = 0.0;
        for axis in 0..3 {
            let before = mass * (motion[axis] - change[axis]);
            let after = if updated { mass * motion[axis] } else { mapped[axis] };
            twice += change[axis] * (before + after);
        }
        sums.nodal.add(0.5 * twice);
    });
    ledger.books.nodal.merge(&sums.nodal);
}

/// Lets all nodes that this process counts add to sums, in parallel blocks if asked to.
fn sum_over_nodes(grid: &Grid, parallel: bool, add: impl Fn(&mut Forces, usize) + Sync) -> Forces {
    let block = |number: usize| {
        let mut sums = Forces::default();
        for run in &grid.runs[grid.first_run[number]..grid.first_run[number + 1]] {
            for node in run.clone().filter(|node| grid.counts(*node)) {
                add(&mut sums, node);
            }
        }
        sums
    };
    let blocks = 0..grid.first_run.len().saturating_sub(1);
    match parallel {
        true => blocks.into_par_iter().map(block).reduce(Forces::default, Forces::merged),
        false => blocks.map(block).fold(Forces::default(), Forces::merged),
    }
}

/// What nodal forces have done: exact sums, so that the order of the blocks does not matter.
#[derive(Default)]
struct Forces {
    external: ExactSum,
    damping: ExactSum,
    boundary: ExactSum,
    nodal: ExactSum,
}

impl Forces {
    /// Adds what the forces on a node do.
    fn add(&mut self, grid: &Grid, node: usize, notes: &Notes, dt: f64, updated: bool) {
        let mapped = &grid.mapped[node];
        let inverse = inverse_mass(&grid.nodes[node], grid.mass_cutoff);
        let [.., mass] = grid.nodes[node].motion;
        let (mut external, mut damping, mut boundary, mut nodal) = (0.0, 0.0, 0.0, 0.0);
        for axis in 0..3 {
            let mean = mean(notes, mapped, inverse, axis, updated);
            let [inner, outer, damped, contact] =
                [notes.internal, notes.external, notes.damping, notes.contact]
                    .map(|force| dt * force[axis] * mean);
            let total = mass * notes.change[axis] * mean;
            external += outer;
            damping -= damped;
            if notes.prescribed[axis].is_some() {
                boundary += total - inner - outer - damped - contact;
            }
            nodal += total;
        }
        self.external.add(external);
        self.damping.add(damping);
        self.boundary.add(boundary);
        self.nodal.add(nodal);
    }

    fn merged(mut self, other: Self) -> Self {
        self.external.merge(&other.external);
        self.damping.merge(&other.damping);
        self.boundary.merge(&other.boundary);
        self.nodal.merge(&other.nodal);
        self
    }
}

/// sum += factor times the power of the internal forces of the step with the velocities of the second
/// mapping, at the nodes where bodies meet; places of nodes may have changed since the forces were noted.
pub fn add_contact_power(sum: &mut ExactSum, grid: &Grid, factor: f64) {
    for (number, couple) in grid.couples.iter().enumerate() {
        for (node, force) in couple.nodes.into_iter().zip(couple.internal) {
            // A node of several couples counts once.
            if grid.coupled[node as usize] as usize == number + 1 && grid.counts(node as usize) {
                let v = &grid.mapped[node as usize];
                sum.add(factor * (force[0] * v[0] + force[1] * v[1] + force[2] * v[2]));
            }
        }
    }
}

/// Books the work of the internal forces with the changes J/m of the velocities where bodies have met:
/// the particles have strained with velocities that they do not have.
pub fn book_impulses(ledger: &mut Ledger, grid: &Grid, dt: f64) {
    for couple in &grid.couples {
        for (node, sign) in couple.nodes.into_iter().zip([-1.0, 1.0]) {
            let inverse = inverse_mass(&grid.nodes[node as usize], grid.mass_cutoff);
            let force = &ledger.nodes[node as usize].internal;
            let along: f64 = force.iter().zip(couple.impulse).map(|(f, j)| f * j).sum();
            if grid.counts(node as usize) {
                ledger.books.numerical.add(dt * sign * inverse * along);
            }
        }
    }
}

/// The w of [`book_forces`].
fn mean(notes: &Notes, mapped: &[f64; 4], inverse: f64, axis: usize, updated: bool) -> f64 {
    match (notes.prescribed[axis], updated) {
        (Some(mean), _) => mean,
        (None, true) => inverse * notes.momentum[axis] + 0.5 * notes.change[axis],
        (None, false) => 0.5 * inverse * (notes.momentum[axis] + mapped[axis]),
    }
}

/// Books the work J.(w2 - w1) of bodies in contact, w as in [`book_forces`]: that of sliding with
/// friction as friction, the rest as lost by the grid. What a rigid body does is work from outside.
pub fn book_contact(ledger: &mut Ledger, grid: &Grid, pairs: &[Pair], updated: bool) {
    for couple in grid.couples.iter().filter(|couple| grid.counts(couple.nodes[0] as usize)) {
        let bodies = couple.nodes.map(|node| {
            let node = node as usize;
            let rigid = grid.rigid.get(node).filter(|rigid| rigid[3] > 0.0);
            let inverse = inverse_mass(&grid.nodes[node], grid.mass_cutoff);
            let (notes, mapped) = (&ledger.nodes[node], &grid.mapped[node]);
            let w = |axis| match rigid {
                Some(velocity) => velocity[axis],
                None => mean(notes, mapped, inverse, axis, updated),
            };
            ([w(0), w(1), w(2)], rigid.is_some())
        });
        let [(first, first_rigid), (second, second_rigid)] = bodies;
        let (mut work, mut pushed, mut normal) = (0.0, 0.0, [0.0; 2]);
        for axis in 0..3 {
            let (j, n) = (couple.impulse[axis], couple.normal[axis]);
            work += j * (second[axis] - first[axis]);
            pushed += if first_rigid { j * first[axis] } else { 0.0 };
            pushed -= if second_rigid { j * second[axis] } else { 0.0 };
            normal[0] += j * n;
            normal[1] += (second[axis] - first[axis]) * n;
        }
        let sliding = match pairs[couple.pair as usize].rule {
            Rule::Frictional(_) => work - normal[0] * normal[1],
            _ => 0.0,
        };
        ledger.books.boundary.add(pushed);
        ledger.books.friction.add(-sliding);
        ledger.books.numerical.add(sliding - work);
    }
}
