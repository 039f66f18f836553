//! The loops of the energy ledger: over nodes around the update, over the chunks of a law.

use super::grid::inverse_mass;
use crate::material::state::{DEFORMATION, STRESS, SYMMETRIC};
use crate::material::{Chunk, Description, Lane, Law, NOTHING};
use crate::math::exact_sum::ExactSum;
use crate::math::tensor::Tensor;
use crate::model::column::Column;
use crate::model::contact::{Pair, Rule};
use crate::model::grid::Grid;
use crate::model::ledger::{Ledger, Notes, Share};

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
pub fn note_changes(ledger: &mut Ledger, grid: &Grid, dt: f64) {
    for node in grid.runs.iter().cloned().flatten() {
        let (notes, node) = (&mut ledger.nodes[node], &grid.nodes[node]);
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
    }
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
pub fn book_forces(ledger: &mut Ledger, grid: &Grid, dt: f64, updated: bool) {
    let books = &mut ledger.books;
    for node in grid.runs.iter().cloned().flatten().filter(|node| grid.counts(*node)) {
        let (notes, mapped) = (&ledger.nodes[node], &grid.mapped[node]);
        let inverse = inverse_mass(&grid.nodes[node], grid.mass_cutoff);
        let [.., mass] = grid.nodes[node].motion;
        for axis in 0..3 {
            let mean = mean(notes, mapped, inverse, axis, updated);
            let internal = dt * notes.internal[axis] * mean;
            let external = dt * notes.external[axis] * mean;
            let damping = dt * notes.damping[axis] * mean;
            let contact = dt * notes.contact[axis] * mean;
            let total = mass * notes.change[axis] * mean;
            books.external.add(external);
            books.damping.add(-damping);
            if notes.prescribed[axis].is_some() {
                books.boundary.add(total - internal - external - damping - contact);
            }
            books.nodal.add(total);
        }
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

/// Kinematics and law of a chunk, with a note of what each particle does; `velocity`: the records
/// with V0.
///
/// Work: V0 (P + P') : (F' - F)/2, the trapezoid of P : dF, with P = J sigma F^-T before the step
/// and after it. With the weights of their own place the old and the new stress then do what
/// internal forces f = -sum V sigma grad N of theirs take from the nodes. Work against viscosity
/// is the part of the viscous stresses in it.
///
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
    description.turn(law, chunk);
    let old = Before::new(description, chunk);
    let (mut before, mut after) = (NOTHING, NOTHING);
    let damaged = chunk.state.has(Column::Damage);
    if damaged {
        law.stored_energy(chunk.state, &mut before);
    }
    description.advance(law, has_deformation, chunk);
    let turned = STRESS.map(|column| *chunk.state.lane(column));
    law.update(chunk);
    note_viscosity(law, chunk);
    if damaged {
        law.stored_energy(chunk.state, &mut after);
    }
    let fluid = law.viscosity() > 0.0;
    for (p, share) in shares.iter_mut().enumerate().take(chunk.state.len) {
        let state = &*chunk.state;
        let flow = state.value(Column::PlasticStrain, p) - at(&old.plastic_strain, p);
        let mut now = Stressed {
            jacobian: state.value(Column::J, p),
            sigma: state.stress(p),
            viscous: state.value(Column::ViscousPressure, p),
        };
        let stress = tensor(&turned, p);
        let mut then = old.stressed(p);
        let [from, to] = old.rates(chunk, p);
        if description.is_turned_back(law) {
            then.turn(&rotation(&old.rotation, p, state.dimension));
            now.turn(&rotation(chunk.rotation, p, state.dimension));
        }
        let [.., reference] = velocity[p];
        let (volume, half) = (now.jacobian * reference, 0.5 * reference * chunk.dt);
        *share = Share {
            work: half * (then.power(&from) + now.power(&to)),
            plastic: volume * law.plastic_work(chunk, p, &stress, flow),
            viscous: half * (then.viscous_power(&from, fluid) + now.viscous_power(&to, fluid)),
            damage: 0.0,
            heat: volume * law.heating(state, p) * chunk.dt,
        };
        if state.value(Column::Damage, p) > 0.0 {
            let stored = reference * (at(&after, p) - at(&before, p));
            share.damage = share.work - share.plastic - share.viscous - stored;
        }
    }
}

/// Writes the artificial part of the pressure into its column.
fn note_viscosity(law: &dyn Law, chunk: &mut Chunk<'_>) {
    if !law.has_artificial_viscosity() {
        return;
    }
    for p in 0..chunk.state.len {
        let alive = chunk.state.value(Column::Damage, p) < 1.0;
        let pressure = law.viscous_pressure(chunk, p);
        chunk.state.set_value(Column::ViscousPressure, p, if alive { pressure } else { 0.0 });
    }
}

/// What the step changes, as it was.
struct Before {
    description: Description,
    jacobian: Lane,
    plastic_strain: Lane,
    viscous: Lane,
    stress: [Lane; 6],
    deformation: [Lane; 9],
    rotation: [Lane; 9],
}

impl Before {
    fn new(description: Description, chunk: &Chunk<'_>) -> Self {
        let state = &*chunk.state;
        Self {
            description,
            rotation: *chunk.rotation,
            jacobian: *state.lane(Column::J),
            plastic_strain: *state.lane(Column::PlasticStrain),
            viscous: *state.lane(Column::ViscousPressure),
            stress: STRESS.map(|column| *state.lane(column)),
            deformation: DEFORMATION.map(|column| *state.lane(column)),
        }
    }

    fn stressed(&self, p: usize) -> Stressed {
        Stressed {
            jacobian: at(&self.jacobian, p),
            sigma: tensor(&self.stress, p),
            viscous: at(&self.viscous, p),
        }
    }

    fn deformation(&self, p: usize) -> Tensor {
        Tensor::from_fn(|i, j| at(&self.deformation[3 * i + j], p))
    }

    /// (F' - F)/dt F^-1 and (F' - F)/dt F'^-1; the first is L in updated Lagrangian methods.
    fn rates(&self, chunk: &Chunk<'_>, p: usize) -> [Tensor; 2] {
        let (change, start, end) = match self.description {
            Description::Total => {
                let (old, new) = (self.deformation(p), chunk.state.deformation(p));
                ((new - old) / chunk.dt, old, new)
            }
            Description::Updated(_) => {
                let rate = chunk.velocity_gradient(p);
                (rate, Tensor::identity(), Tensor::identity() + rate * chunk.dt)
            }
        };
        [start, end].map(|f| f.try_inverse().map_or(Tensor::zeros(), |inverse| change * inverse))
    }
}

/// R of a particle; directions beyond the dimension do not turn.
fn rotation(lanes: &[Lane; 9], p: usize, dimension: usize) -> Tensor {
    Tensor::from_fn(|i, j| match i.max(j) < dimension {
        true => at(&lanes[3 * i + j], p),
        false => f64::from(i == j),
    })
}

/// A particle under stress.
struct Stressed {
    jacobian: f64,
    sigma: Tensor,
    viscous: f64,
}

impl Stressed {
    /// Brings the stress from the axes that go with the body into those of space.
    fn turn(&mut self, rotation: &Tensor) {
        self.sigma = rotation * self.sigma * rotation.transpose();
    }

    /// J sigma : L.
    fn power(&self, rate: &Tensor) -> f64 {
        self.jacobian * self.sigma.dot(rate)
    }

    /// The part of the artificial pressure in it, and of the deviator in fluids.
    fn viscous_power(&self, rate: &Tensor, fluid: bool) -> f64 {
        let trace = rate.trace();
        let deviator = match fluid {
            true => self.sigma.dot(rate) - self.sigma.trace() / 3.0 * trace,
            false => 0.0,
        };
        self.jacobian * (deviator - self.viscous * trace)
    }
}

fn at(lane: &Lane, p: usize) -> f64 {
    lane[p / 4][p % 4]
}

/// The symmetric tensor of a particle.
fn tensor(six: &[Lane; 6], p: usize) -> Tensor {
    Tensor::from_fn(|i, j| at(&six[SYMMETRIC[3 * i + j]], p))
}
