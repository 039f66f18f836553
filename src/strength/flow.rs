//! Plastic flow: the trial deviator is brought back to the yield surface along itself.
//!
//! Groups of four particles in which nothing yields are left at once; each particle is solved for
//! itself, so that its result does not depend on its neighbours.

use crate::material::stages::{Stages, integrity, trial};
use crate::material::state::STRESS;
use crate::material::{Chunk, State};
use crate::math::v4::{Sweep, Wide, dispatch};
use crate::model::column::Column;

/// A flow stress softening * Y(ep, depdot), never falling with either.
pub trait Flow: Copy {
    /// The part of the flow stress that heat has left.
    fn softening<V: Wide>(&self, state: &State, group: usize) -> V;

    /// Some number that softening * Y of the present state certainly reaches, quick to compute.
    fn floor<V: Wide>(&self, state: &State, group: usize) -> V;

    /// Y at rest.
    fn at_rest<V: Wide>(&self, strain: V) -> V;

    /// Y(ep + dep, dep/dt) and its derivative by dep > 0.
    fn moving<V: Wide>(&self, strain: V, increment: V, dt: f64) -> [V; 2];

    /// Distance of dep from the next point where Y is not smooth.
    fn smoothness<V: Wide>(&self, strain: V, increment: V, dt: f64) -> V;
}

/// Trial and return to the yield surface.
pub fn flow<F: Flow>(
    law: F,
    shear: f64,
    damaged: bool,
    chunk: &mut Chunk<'_>,
    stages: &mut Stages,
) {
    trial(shear, damaged, chunk, stages);
    match damaged {
        true => dispatch(Return::<F, true> { law, shear, chunk, stages }),
        false => dispatch(Return::<F, false> { law, shear, chunk, stages }),
    }
}

struct Return<'a, 'b, F, const DAMAGED: bool> {
    law: F,
    shear: f64,
    chunk: &'a mut Chunk<'b>,
    stages: &'a mut Stages,
}

impl<F: Flow, const DAMAGED: bool> Sweep for Return<'_, '_, F, DAMAGED> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let Self { law, shear, chunk, stages } = self;
        let dt = chunk.dt;
        let state = &mut *chunk.state;
        let zero = V::splat(0.0);
        for group in state.groups() {
            let trial = V::load(&stages.equivalent[group]);
            let left = integrity::<V, DAMAGED>(state.lane(Column::Damage), group);
            zero.store(&mut stages.increment[group]);
            if !(left * law.floor(state, group)).any_below(trial) {
                state.set_four(Column::PlasticStrainRate, group, zero);
                continue;
            }
            let strain: V = state.four(Column::PlasticStrain, group);
            let old_rate: V = state.four(Column::PlasticStrainRate, group);
            let softening = left * law.softening(state, group);
            let problem = Problem {
                trial,
                stiffness: left * V::splat(3.0 * shear),
                softening,
                strain,
                guess: old_rate * V::splat(dt),
            };
            let increment = problem.solve(&law, dt);
            let stress = trial - problem.stiffness * increment;
            // Without any strength nothing is left, not even round-off.
            let stress = zero.below(softening, stress, zero.below(increment, zero, trial));
            settle(state, stages, group, [trial, stress, strain, increment], dt);
        }
    }
}

/// s <- s q/q_trial, ep, epdot, and what the next stages read.
#[inline(always)]
fn settle<V: Wide>(
    state: &mut State,
    stages: &mut Stages,
    group: usize,
    [trial, stress, strain, increment]: [V; 4],
    dt: f64,
) {
    let (zero, one) = (V::splat(0.0), V::splat(1.0));
    // Particles that do not yield keep every bit.
    let scale = zero.below(increment, stress / trial, one);
    for column in STRESS {
        let s: V = state.four(column, group);
        state.set_four(column, group, scale * s);
    }
    state.set_four(Column::PlasticStrain, group, strain + increment);
    state.set_four(Column::PlasticStrainRate, group, increment / V::splat(dt));
    stress.store(&mut stages.equivalent[group]);
    increment.store(&mut stages.increment[group]);
}

/// A change below this part of the distance to the next rough point is the last: the one after it
/// would be its square.
const LAST_CHANGE: f64 = 1e-6;

/// Residuals below this part of q are round-off.
const ROUND_OFF: f64 = 4e-15;

/// More steps than any bisection needs to bring the bracket below round-off.
const MOST_STEPS: usize = 60;

/// q - 3 G (1 - D) dep = softening Y(ep + dep, dep/dt) of four particles.
struct Problem<V> {
    trial: V,
    stiffness: V,
    softening: V,
    strain: V,
    guess: V,
}

impl<V: Wide> Problem<V> {
    /// dep by Newton's iteration, safeguarded by bisection; 0 where q <= Y.
    #[inline(always)]
    fn solve<F: Flow>(&self, law: &F, dt: f64) -> V {
        let (zero, one, half) = (V::splat(0.0), V::splat(1.0), V::splat(0.5));
        let excess = self.trial - self.softening * law.at_rest(self.strain);
        let yields = zero.below(excess, one, zero);
        let (mut low, mut high) = (zero, zero.below(excess, excess / self.stiffness, zero));
        // The rate of the last step is the best guess; at first no hardening is as good as any.
        let mut x = zero.below(self.guess, self.guess.smaller(high), high);
        let mut open = yields;
        for _ in 0..MOST_STEPS {
            if !zero.any_below(open) {
                break;
            }
            let [y, slope] = law.moving(self.strain, x, dt);
            let residual = self.trial - self.stiffness * x - self.softening * y;
            low = zero.below(residual, x, low);
            high = residual.below(zero, x, high);
            let next = x + residual / self.softening.mul_add(slope, self.stiffness);
            let middle = half * (low + high);
            let next = next.below(low, middle, high.below(next, middle, next));
            let change = (next - x).absolute();
            // A particle that has settled stays, whatever its neighbours do.
            x = zero.below(open, next, x);
            let least = V::splat(LAST_CHANGE) * law.smoothness(self.strain, x, dt);
            open = change.below(least, zero, open);
            let noise = V::splat(ROUND_OFF) * self.trial;
            open = residual.absolute().below(noise, zero, open);
        }
        zero.below(yields, x, zero)
    }
}

/// Y = sigma_y + H ep.
#[derive(Clone, Copy, Debug)]
pub struct Linear {
    /// sigma_y \[P\].
    pub yield_stress: f64,
    /// H \[P\].
    pub hardening: f64,
}

/// Trial and return to the yield surface of a flow stress (1 - D) (sigma_y + H ep), in closed form.
pub fn flow_linearly(
    law: Linear,
    shear: f64,
    damaged: bool,
    chunk: &mut Chunk<'_>,
    stages: &mut Stages,
) {
    trial(shear, damaged, chunk, stages);
    match damaged {
        true => dispatch(LinearReturn::<true> { law, shear, chunk, stages }),
        false => dispatch(LinearReturn::<false> { law, shear, chunk, stages }),
    }
}

struct LinearReturn<'a, 'b, const DAMAGED: bool> {
    law: Linear,
    shear: f64,
    chunk: &'a mut Chunk<'b>,
    stages: &'a mut Stages,
}

impl<const DAMAGED: bool> Sweep for LinearReturn<'_, '_, DAMAGED> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let Self { law: Linear { yield_stress, hardening }, shear, chunk, stages } = self;
        let dt = chunk.dt;
        let state = &mut *chunk.state;
        let (zero, hardening) = (V::splat(0.0), V::splat(hardening));
        let stiffness = V::splat(3.0 * shear) + hardening;
        for group in state.groups() {
            let trial = V::load(&stages.equivalent[group]);
            let left = integrity::<V, DAMAGED>(state.lane(Column::Damage), group);
            let strain: V = state.four(Column::PlasticStrain, group);
            let strength = left * hardening.mul_add(strain, V::splat(yield_stress));
            zero.store(&mut stages.increment[group]);
            if !strength.any_below(trial) {
                state.set_four(Column::PlasticStrainRate, group, zero);
                continue;
            }
            let increment = (trial - strength) / (left * stiffness);
            let increment = strength.below(trial, increment, zero);
            let stress = strength + left * hardening * increment;
            let stress = strength.below(trial, stress, trial);
            settle(state, stages, group, [trial, stress, strain, increment], dt);
        }
    }
}
