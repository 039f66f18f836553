//! The work of the stress on the particles, for the energy ledger.

use super::shared::Shared;
use super::tiles::Tiles;
use crate::material::state::{STRESS, SYMMETRIC, load_tensor, symmetric_tensor};
use crate::material::{Chunk, Description, Lane, Law, NOTHING};
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
    let [damaged, flows, heats] =
        [Column::Damage, Column::PlasticStrain, Column::Temperature].map(|c| chunk.state.has(c));
    let power = Power::new(description, law, chunk);
    let mut done = Powers { work: NOTHING, viscous: NOTHING };
    description.turn(law, chunk);
    if damaged {
        chunk.hold_failed();
    }
    power.add(false, chunk, &mut done);
    let mut before = Before { stored: NOTHING, plastic_strain: NOTHING, stress: [NOTHING; 6] };
    if damaged {
        law.stored_energy(chunk.state, &mut before.stored);
    }
    if flows {
        before.plastic_strain = *chunk.state.lane(Column::PlasticStrain);
    }
    description.advance(law, has_deformation, chunk);
    if flows {
        before.stress = STRESS.map(|column| *chunk.state.lane(column));
    }
    law.update(chunk);
    note_viscosity(law, chunk);
    power.add(true, chunk, &mut done);
    let half = 0.5 * chunk.dt;
    let total = |lane: &Lane| -> f64 {
        lane.as_flattened().iter().zip(velocity).map(|(power, [.., v0])| power * v0).sum()
    };
    share.work += half * total(&done.work);
    if power.rubs {
        share.viscous += half * total(&done.viscous);
    }
    if flows || heats || damaged {
        book_losses(law, chunk, velocity, &before, &done, share);
    }
}

/// What a law needs to know of the start of the step to tell its losses.
struct Before {
    stored: Lane,
    plastic_strain: Lane,
    /// Brought into the axes of the end.
    stress: [Lane; 6],
}

/// Plastic work, heat, and the energy lost with stiffness, particle by particle.
fn book_losses(
    law: &dyn Law,
    chunk: &Chunk<'_>,
    velocity: &[[f64; 4]],
    before: &Before,
    done: &Powers,
    share: &mut Share,
) {
    let state = &*chunk.state;
    let [damaged, flows, heats] =
        [Column::Damage, Column::PlasticStrain, Column::Temperature].map(|c| state.has(c));
    let mut after = NOTHING;
    if damaged {
        law.stored_energy(state, &mut after);
    }
    for (p, [.., reference]) in velocity.iter().enumerate().take(state.len) {
        let volume = state.value(Column::J, p) * reference;
        let mut plastic = 0.0;
        if flows {
            let flow = state.value(Column::PlasticStrain, p) - at(&before.plastic_strain, p);
            plastic = volume * law.plastic_work(chunk, p, &tensor(&before.stress, p), flow);
            share.plastic += plastic;
        }
        if heats {
            share.heat += volume * law.heating(state, p) * chunk.dt;
        }
        if damaged && state.value(Column::Damage, p) > 0.0 {
            let half = 0.5 * chunk.dt * reference;
            let spent = half * (at(&done.work, p) - at(&done.viscous, p));
            share.damage += spent - plastic - reference * (at(&after, p) - at(&before.stored, p));
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

/// J sigma : L of the particles at the start and at the end of the step, added, and the part of the
/// viscous stresses in it.
struct Powers {
    work: Lane,
    viscous: Lane,
}

/// How the power of the stress is found.
#[derive(Clone, Copy)]
struct Power {
    total: bool,
    /// Stresses are stored turned back by R.
    turned_back: bool,
    /// There are viscous stresses.
    rubs: bool,
    fluid: bool,
}

impl Power {
    fn new(description: Description, law: &dyn Law, chunk: &Chunk<'_>) -> Self {
        let fluid = law.viscosity() > 0.0;
        Self {
            total: description == Description::Total,
            turned_back: description.is_turned_back(law),
            rubs: fluid || chunk.state.has(Column::ViscousPressure),
            fluid,
        }
    }

    /// Adds what the stress does in the state before or after the step.
    fn add(self, after: bool, chunk: &Chunk<'_>, sums: &mut Powers) {
        match chunk.state.dimension {
            1 => dispatch(Adding::<1> { power: self, after, chunk, sums }),
            2 => dispatch(Adding::<2> { power: self, after, chunk, sums }),
            _ => dispatch(Adding::<3> { power: self, after, chunk, sums }),
        }
    }
}

/// sums <- sums + J sigma : L with L = (F' - F)/dt F^-1 before the step and (F' - F)/dt F'^-1 after it.
struct Adding<'a, 'b, const D: usize> {
    power: Power,
    after: bool,
    chunk: &'a Chunk<'b>,
    sums: &'a mut Powers,
}

impl<const D: usize> Sweep for Adding<'_, '_, D> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let Power { total, turned_back, .. } = self.power;
        match (total, turned_back, self.after) {
            (false, _, false) => self.groups::<V, UPDATED_BEFORE>(),
            (false, _, true) => self.groups::<V, UPDATED_AFTER>(),
            (true, true, false) => self.groups::<V, TURNED_BEFORE>(),
            (true, true, true) => self.groups::<V, TURNED_AFTER>(),
            (true, false, _) => self.groups::<V, TOTAL>(),
        }
    }
}

/// F = I: J L.
const UPDATED_BEFORE: u8 = 0;
/// F' = I + dt L: J' L F'^-1.
const UPDATED_AFTER: u8 = 1;
/// dF/dt cof F^T, with R sigma R^T.
const TURNED_BEFORE: u8 = 2;
/// J' D^, D^ = R^T sym(dF/dt F'^-1) R, which the kinematics have left in the axes of sigma.
const TURNED_AFTER: u8 = 3;
/// dF/dt cof F^T, with the F of the time.
const TOTAL: u8 = 4;

impl<const D: usize> Adding<'_, '_, D> {
    #[inline(always)]
    fn groups<V: Wide, const KIND: u8>(self) {
        let Self { power, chunk, sums, .. } = self;
        let state = &*chunk.state;
        for group in state.groups() {
            let mut sigma = symmetric_tensor(state.fours(STRESS, group));
            if KIND == TURNED_BEFORE {
                sigma = turned::<V, D>(&load_tensor(chunk.rotation, group), &sigma);
            }
            let gradient: Four<V> = load_tensor(chunk.gradient, group);
            let (rate, volume) = match KIND {
                TURNED_BEFORE | TOTAL => {
                    let (cofactor, _) = cofactors::<V, D>(&state.deformation_of_four(group));
                    (product_transposed::<V, D>(&gradient, &cofactor), V::splat(1.0))
                }
                UPDATED_AFTER => {
                    let (rate, growth) = at_the_end::<V, D>(&gradient, V::splat(chunk.dt));
                    (rate, state.four::<V>(Column::J, group) / growth)
                }
                _ => (gradient, state.four::<V>(Column::J, group)),
            };
            let work = double_dot::<V, D>(&sigma, &rate);
            volume.mul_add(work, V::load(&sums.work[group])).store(&mut sums.work[group]);
            if power.rubs {
                let artificial = state.four(Column::ViscousPressure, group);
                let rubbing = of_viscosity::<V, D>(&sigma, &rate, artificial, power.fluid);
                let sum = volume.mul_add(rubbing, V::load(&sums.viscous[group]));
                sum.store(&mut sums.viscous[group]);
            }
        }
    }
}

/// g L (I + dt L)^-1 and g = det(I + dt L), without the difference of near numbers:
/// g (I - (I + dt L)^-1) = dt L + det(dt L) I in the plane, and with cofactors C of L in space
/// dt L - dt^2 C^T + (dt^2 tr C + dt^3 det L) I.
#[inline(always)]
fn at_the_end<V: Wide, const D: usize>(gradient: &Four<V>, dt: V) -> (Four<V>, V) {
    let l = gradient;
    let one = V::splat(1.0);
    if D == 1 {
        return (*l, dt.mul_add(l[0], one));
    }
    let (c, volume) = cofactors::<V, D>(l);
    let mut rate = *l;
    if D == 2 {
        let second = dt * volume;
        (rate[0], rate[4]) = (l[0] + second, l[4] + second);
        return (rate, dt.mul_add(l[0] + l[4] + second, one));
    }
    let (first, second) = (l[0] + l[4] + l[8], c[0] + c[4] + c[8]);
    let isotropic = dt * dt.mul_add(volume, second);
    let minus = V::splat(0.0) - dt;
    for i in 0..3 {
        for j in 0..3 {
            rate[3 * i + j] = minus.mul_add(c[3 * j + i], l[3 * i + j]);
        }
        rate[4 * i] = rate[4 * i] + isotropic;
    }
    (rate, dt.mul_add(first + isotropic, one))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::v4::Plain;

    /// What [`at_the_end`] says, and g L (I + dt L)^-1 by inversion.
    fn both<const D: usize>(l: Tensor, dt: f64) -> [Tensor; 2] {
        let l = Tensor::from_fn(|i, j| if i.max(j) < D { l[(i, j)] } else { 0.0 });
        let end = Tensor::identity() + l * dt;
        let four: Four<Plain> =
            std::array::from_fn(|entry| Plain::splat(l[(entry / 3, entry % 3)]));
        let (rate, growth) = at_the_end::<Plain, D>(&four, Plain::splat(dt));
        assert!((growth.array()[0] - end.determinant()).abs() < 1e-15);
        let found = Tensor::from_fn(|i, j| match i.max(j) < D {
            true => rate[3 * i + j].array()[0],
            false => 0.0,
        });
        [found, l * end.try_inverse().unwrap() * end.determinant()]
    }

    #[test]
    fn the_gradient_at_the_end_of_a_step_is_that_of_the_moved_body() {
        let l = Tensor::new(0.3, -0.7, 0.2, 1.1, -0.4, 0.5, -0.6, 0.9, 0.8);
        for dt in [1e-9, 0.2] {
            for [found, exact] in [both::<1>(l, dt), both::<2>(l, dt), both::<3>(l, dt)] {
                assert!((found - exact).norm() < 1e-14, "{found} {exact}");
            }
        }
    }
}
