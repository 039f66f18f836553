//! The loops of the energy ledger: over nodes around the update, over the chunks of a law.

use super::grid::inverse_mass;
use crate::material::state::{STRESS, SYMMETRIC};
use crate::material::{Chunk, Description, Lane, Law, NOTHING};
use crate::math::tensor::Tensor;
use crate::model::column::Column;
use crate::model::grid::Grid;
use crate::model::ledger::{Ledger, Share};

/// Takes momenta and internal forces: after P2G, before anything else acts on the nodes.
pub fn note_internal(ledger: &mut Ledger, grid: &Grid) {
    for node in grid.runs.iter().cloned().flatten() {
        let notes = &mut ledger.nodes[node];
        notes.momentum.copy_from_slice(&grid.nodes[node].motion[..3]);
        notes.internal.copy_from_slice(&grid.nodes[node].change[..3]);
    }
}

/// Takes what has been added to the internal forces, less the forces of damping fixes.
pub fn note_external(ledger: &mut Ledger, grid: &Grid) {
    for node in grid.runs.iter().cloned().flatten() {
        let (notes, total) = (&mut ledger.nodes[node], &grid.nodes[node].change);
        for axis in 0..3 {
            notes.external[axis] = total[axis] - notes.internal[axis] - notes.damping[axis];
        }
    }
}

/// Takes the changes of the velocities, after the update and the prescribed velocities. Where a
/// change is not that of the forces, velocities are prescribed.
pub fn note_changes(ledger: &mut Ledger, grid: &Grid, dt: f64) {
    for node in grid.runs.iter().cloned().flatten() {
        let (notes, node) = (&mut ledger.nodes[node], &grid.nodes[node]);
        let inverse = inverse_mass(node, grid.mass_cutoff);
        for axis in 0..3 {
            let (v, change) = (node.motion[axis], node.change[axis]);
            let force = notes.internal[axis] + notes.external[axis] + notes.damping[axis];
            let free = dt * inverse * force;
            // The sum of the parts may differ from the force in its last digits.
            let unlike = (change - free).abs() > SAME * (change.abs() + free.abs() + v.abs());
            notes.change[axis] = change;
            notes.prescribed[axis] = unlike.then_some(v - 0.5 * change);
        }
    }
}

/// Changes of a velocity that agree to this part of it come from the forces.
const SAME: f64 = 1e-10;

/// Books the work of the nodal forces; `mapped` holds the momenta p' = sum N m v of the new
/// velocities of the particles. Gives the work of all.
///
/// With w = (p + p')/(2 m), FLIP changes the kinetic energy of the particles by sum m (v* - v).w,
/// exactly, since it changes v_p by sum N (v* - v). Where velocities are prescribed, w is the
/// prescribed one: what holds a wall does no work. Where strains follow from the `updated` velocities
/// v*, w = (v + v*)/2 and the nodes gain sum m (v* - v).w. The impulse r = m (v* - v) - dt (f + mb) is that
/// of prescribed velocities.
pub fn book_forces(ledger: &mut Ledger, grid: &Grid, dt: f64, updated: bool) -> f64 {
    let mut all = 0.0;
    for node in grid.runs.iter().cloned().flatten() {
        let (notes, mapped) = (&ledger.nodes[node], &grid.mapped[node]);
        let inverse = inverse_mass(&grid.nodes[node], grid.mass_cutoff);
        let [.., mass] = grid.nodes[node].motion;
        for axis in 0..3 {
            let mean = match (notes.prescribed[axis], updated) {
                (Some(mean), _) => mean,
                (None, true) => inverse * notes.momentum[axis] + 0.5 * notes.change[axis],
                (None, false) => 0.5 * inverse * (notes.momentum[axis] + mapped[axis]),
            };
            let internal = dt * notes.internal[axis] * mean;
            let external = dt * notes.external[axis] * mean;
            let damping = dt * notes.damping[axis] * mean;
            let total = mass * notes.change[axis] * mean;
            ledger.sums.external += external;
            ledger.sums.damping -= damping;
            if notes.prescribed[axis].is_some() {
                ledger.sums.boundary += total - internal - external - damping;
            }
            all += total;
        }
    }
    all
}

/// Kinematics and law of a chunk, with a note of what each particle does; `velocity`: the records
/// with V0.
///
/// Work: V0 (J0 sigma0 + J sigma) : D dt/2, the old stress turned along; sigma : D J = P : dF/dt.
/// Once damage has begun, what is neither dissipated nor in the stored energy psi of the law is lost
/// to damage.
#[inline(never)]
pub fn advance_and_book(
    description: Description,
    law: &dyn Law,
    has_deformation: bool,
    chunk: &mut Chunk<'_>,
    velocity: &[[f64; 4]],
    shares: &mut [Share],
) {
    let [jacobian, strain] =
        [Column::J, Column::PlasticStrain].map(|column| *chunk.state.lane(column));
    let (mut before, mut after, mut viscous) = (NOTHING, NOTHING, NOTHING);
    let damaged = chunk.state.has(Column::Damage);
    if damaged {
        law.stored_energy(chunk.state, &mut before);
    }
    description.advance(law, has_deformation, chunk);
    let turned = STRESS.map(|column| *chunk.state.lane(column));
    law.update(chunk);
    law.viscous_power(chunk, &mut viscous);
    let state = &*chunk.state;
    if damaged {
        law.stored_energy(state, &mut after);
    }
    for (p, share) in shares.iter_mut().enumerate().take(state.len) {
        let [then, now] = rates(description, law, chunk, p);
        let old = Tensor::from_fn(|i, j| at(&turned[SYMMETRIC[3 * i + j]], p));
        let (sigma, j) = (state.stress(p), state.value(Column::J, p));
        let flow = state.value(Column::PlasticStrain, p) - at(&strain, p);
        let [.., reference] = velocity[p];
        let (volume, dt) = (j * reference, chunk.dt);
        let power = at(&jacobian, p) * old.dot(&then) + j * sigma.dot(&now);
        *share = Share {
            work: 0.5 * reference * dt * power,
            plastic: volume * law.plastic_work(chunk, p, &old, flow),
            viscous: volume * at(&viscous, p) * dt,
            damage: 0.0,
            heat: volume * law.heating(state, p) * dt,
        };
        if state.value(Column::Damage, p) > 0.0 {
            let stored = reference * (at(&after, p) - at(&before, p));
            share.damage = share.work - share.plastic - share.viscous - stored;
        }
    }
}

fn at(lane: &Lane, p: usize) -> f64 {
    lane[p / 4][p % 4]
}

/// What the old and the new stress do work on: L, or dF/dt F^-1 with F at the start and at the end.
fn rates(description: Description, law: &dyn Law, chunk: &Chunk<'_>, p: usize) -> [Tensor; 2] {
    let rate = chunk.velocity_gradient(p);
    if description != Description::Total || law.is_incremental() {
        return [rate; 2];
    }
    let new = chunk.state.deformation(p);
    let old = new - rate * chunk.dt;
    [old, new].map(|f| f.try_inverse().map_or(Tensor::zeros(), |inverse| rate * inverse))
}
