//! The work of the stress on the particles, for the energy ledger.

use super::shared::Shared;
use super::tiles::Tiles;
use crate::material::state::{DEFORMATION, STRESS, SYMMETRIC, load_tensor, symmetric_tensor};
use crate::material::{Chunk, Description, GROUPS, Lane, Law, NOTHING};
use crate::math::exact_sum::ExactSum;
use crate::math::tensor::Tensor;
use crate::math::v4::{Sweep, Wide, dispatch};
use crate::math::wide::{Four, cofactors, in_space, product, product_transposed};
use crate::model::column::Column;
use crate::model::ledger::Share;
use crate::world::World;

/// sum m v^2/2, tile by tile, over all processes: sums of tiles are exact, since tiles are the same
/// for any number of threads and processes.
pub fn kinetic_energy(tiles: &mut Tiles, world: &mut World) -> f64 {
    let World { particles, ledger, ranks, .. } = world;
    let (velocity, position) = (&particles.velocity, &particles.position);
    ledger.kinetic.resize(tiles.ranges.len(), 0.0);
    let sums = Shared::new(&mut ledger.kinetic);
    tiles.sweep(|tile, _| {
        let sweep =
            Kinetic { velocity: &velocity[tile.range.clone()], place: &position[tile.range] };
        // SAFETY: each tile has one worker.
        unsafe { sums.part(tile.number..tile.number + 1)[0] = dispatch(sweep) };
    });
    ranks.total(&ExactSum::of(ledger.kinetic.iter().copied()))
}

struct Kinetic<'a> {
    velocity: &'a [[f64; 4]],
    place: &'a [[f64; 4]],
}

impl Sweep for Kinetic<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<V: Wide>(self) -> f64 {
        let mut sum = V::splat(0.0);
        for (velocity, place) in self.velocity.iter().zip(self.place) {
            let v = V::load(velocity);
            sum = V::splat(place[3]).mul_add(v * v, sum);
        }
        let [x, y, z, _] = sum.array();
        0.5 * (x + y + z)
    }
}

/// Kinematics and law of a chunk; what its particles do is added to the share of their tile.
/// `velocity`: the records with V0.
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
    share: &mut Share,
) {
    description.turn(law, chunk);
    let old = Before::new(description, law, chunk);
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
    let (mut work, mut viscous) = (NOTHING, NOTHING);
    let [flows, heats] = [Column::PlasticStrain, Column::Temperature].map(|c| chunk.state.has(c));
    let rubs = old.fluid || chunk.state.has(Column::ViscousPressure);
    match chunk.state.dimension {
        1 => {
            dispatch(Power::<1> { old: &old, chunk, rubs, work: &mut work, viscous: &mut viscous })
        }
        2 => {
            dispatch(Power::<2> { old: &old, chunk, rubs, work: &mut work, viscous: &mut viscous })
        }
        _ => {
            dispatch(Power::<3> { old: &old, chunk, rubs, work: &mut work, viscous: &mut viscous })
        }
    }
    let half = 0.5 * chunk.dt;
    for (p, [.., reference]) in velocity.iter().enumerate().take(chunk.state.len) {
        let state = &*chunk.state;
        let volume = state.value(Column::J, p) * reference;
        let mut done = Share { work: half * reference * at(&work, p), ..Share::default() };
        if rubs {
            done.viscous = half * reference * at(&viscous, p);
        }
        if flows {
            let flow = state.value(Column::PlasticStrain, p) - at(&old.plastic_strain, p);
            done.plastic = volume * law.plastic_work(chunk, p, &tensor(&turned, p), flow);
        }
        if heats {
            done.heat = volume * law.heating(state, p) * chunk.dt;
        }
        if damaged && state.value(Column::Damage, p) > 0.0 {
            let stored = reference * (at(&after, p) - at(&before, p));
            done.damage = done.work - done.plastic - done.viscous - stored;
        }
        share.add(&done);
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
    total: bool,
    turned_back: bool,
    fluid: bool,
    jacobian: Lane,
    plastic_strain: Lane,
    viscous: Lane,
    stress: [Lane; 6],
    deformation: [Lane; 9],
    rotation: [Lane; 9],
}

impl Before {
    fn new(description: Description, law: &dyn Law, chunk: &Chunk<'_>) -> Self {
        let state = &*chunk.state;
        let total = description == Description::Total;
        Self {
            total,
            turned_back: description.is_turned_back(law),
            fluid: law.viscosity() > 0.0,
            jacobian: *state.lane(Column::J),
            plastic_strain: *state.lane(Column::PlasticStrain),
            viscous: *state.lane(Column::ViscousPressure),
            stress: STRESS.map(|column| *state.lane(column)),
            deformation: match total {
                true => DEFORMATION.map(|column| *state.lane(column)),
                false => [NOTHING; 9],
            },
            rotation: if total { *chunk.rotation } else { [NOTHING; 9] },
        }
    }
}

/// work <- J sigma : L at the start and at the end of the step, added; the same of the viscous
/// stresses, if any. L = (F' - F)/dt F^-1 and (F' - F)/dt F'^-1, where updated Lagrangian methods have
/// F = I and F' = I + dt L.
struct Power<'a, 'b, const D: usize> {
    old: &'a Before,
    chunk: &'a Chunk<'b>,
    rubs: bool,
    work: &'a mut Lane,
    viscous: &'a mut Lane,
}

impl<const D: usize> Sweep for Power<'_, '_, D> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let Self { old, chunk, rubs, work, viscous } = self;
        let state = &*chunk.state;
        let (one, dt) = (V::splat(1.0), V::splat(chunk.dt));
        for group in 0..state.groups().end.min(GROUPS) {
            // J L^T and J' L'^T, transposed where they are contracted with symmetric tensors.
            let (from, to);
            let [then, now] =
                [V::load(&old.jacobian[group]), V::load(&state.lane(Column::J)[group])];
            if old.total {
                let (first, last) =
                    (load_tensor(&old.deformation, group), state.deformation_of_four(group));
                let mut change = last;
                for entry in 0..9 {
                    change[entry] = (last[entry] - first[entry]) / dt;
                }
                from = product_transposed::<V, D>(&change, &cofactors::<V, D>(&first).0);
                to = product_transposed::<V, D>(&change, &cofactors::<V, D>(&last).0);
            } else {
                let rate: Four<V> = load_tensor(chunk.gradient, group);
                let mut end = rate;
                for entry in 0..9 {
                    end[entry] = match entry % 4 {
                        0 => dt.mul_add(rate[entry], one),
                        _ => dt * rate[entry],
                    };
                }
                let (cofactor, growth) = cofactors::<V, D>(&end);
                let mut last = product_transposed::<V, D>(&rate, &cofactor);
                let mut first = rate;
                for entry in 0..9 {
                    first[entry] = then * first[entry];
                    last[entry] = now / growth * last[entry];
                }
                (from, to) = (first, last);
            }
            let mut before = [V::splat(0.0); 6];
            for n in 0..6 {
                before[n] = V::load(&old.stress[n][group]);
            }
            let mut stresses =
                [symmetric_tensor(before), symmetric_tensor(state.fours(STRESS, group))];
            if old.turned_back {
                stresses[0] = turned::<V, D>(&load_tensor(&old.rotation, group), &stresses[0]);
                stresses[1] = turned::<V, D>(&load_tensor(chunk.rotation, group), &stresses[1]);
            }
            let sum =
                double_dot::<V, D>(&stresses[0], &from) + double_dot::<V, D>(&stresses[1], &to);
            sum.store(&mut work[group]);
            if rubs {
                let artificial = [
                    V::load(&old.viscous[group]),
                    V::load(&state.lane(Column::ViscousPressure)[group]),
                ];
                let first = of_viscosity::<V, D>(&stresses[0], &from, artificial[0], old.fluid);
                let last = of_viscosity::<V, D>(&stresses[1], &to, artificial[1], old.fluid);
                (first + last).store(&mut viscous[group]);
            }
        }
    }
}

/// R sigma R^T; directions beyond the dimension do not turn.
#[inline(always)]
fn turned<V: Wide, const D: usize>(rotation: &Four<V>, sigma: &Four<V>) -> Four<V> {
    let mut new = product_transposed::<V, D>(&product::<V, D>(rotation, sigma), rotation);
    for entry in 0..9 {
        if !in_space::<D>(entry) {
            new[entry] = sigma[entry];
        }
    }
    new
}

/// a : b within the dimensions.
#[inline(always)]
fn double_dot<V: Wide, const D: usize>(a: &Four<V>, b: &Four<V>) -> V {
    let mut sum = V::splat(0.0);
    for entry in 0..9 {
        if in_space::<D>(entry) {
            sum = a[entry].mul_add(b[entry], sum);
        }
    }
    sum
}

/// The part of the artificial pressure in sigma : L, and of the deviator in fluids.
#[inline(always)]
fn of_viscosity<V: Wide, const D: usize>(
    sigma: &Four<V>,
    rate: &Four<V>,
    artificial: V,
    fluid: bool,
) -> V {
    let mut trace = rate[0];
    for axis in 1..D {
        trace = trace + rate[4 * axis];
    }
    let mut power = V::splat(0.0) - artificial * trace;
    if fluid {
        let mean = V::splat(1.0 / 3.0) * (sigma[0] + sigma[4] + sigma[8]);
        power = power + double_dot::<V, D>(sigma, rate) - mean * trace;
    }
    power
}

fn at(lane: &Lane, p: usize) -> f64 {
    lane[p / 4][p % 4]
}

/// The symmetric tensor of a particle.
fn tensor(six: &[Lane; 6], p: usize) -> Tensor {
    Tensor::from_fn(|i, j| at(&six[SYMMETRIC[3 * i + j]], p))
}
