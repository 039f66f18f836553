//! Plastic flow: the trial deviator is brought back to the yield surface along itself.
//!
//! Groups of four particles in which nothing yields are left at once; each particle is solved for
//! itself, so that its result does not depend on its neighbours.

use crate::material::stages::{Stages, integrity, trial};
use crate::material::state::STRESS;
use crate::material::{Chunk, GROUPS, Lane, NOTHING, State};
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

    /// Y(ep + dep, dep/dt) and its first and second derivatives by dep > 0; `rest` is Y of ep at
    /// rest.
    fn moving<V: Wide>(&self, strain: V, rest: V, increment: V, dt: f64) -> [V; 3];

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
        let mut flowing = Groups::default();
        for group in state.groups() {
            let trial = V::load(&stages.equivalent[group]);
            let left = integrity::<V, DAMAGED>(state.lane(Column::Damage), group);
            zero.store(&mut stages.increment[group]);
            match (left * law.floor(state, group)).any_below(trial) {
                true => flowing.push(group),
                false => state.set_four(Column::PlasticStrainRate, group, zero),
            }
        }
        if flowing.count == 0 {
            return;
        }
        let mut search = Search::default();
        let stiffness = 3.0 * shear;
        search.begin::<V, F, DAMAGED>(&law, stiffness, dt, state, stages, &flowing);
        search.solve::<V, F, DAMAGED>(&law, stiffness, dt, state, stages, flowing);
        for group in flowing.iter() {
            let trial = V::load(&stages.equivalent[group]);
            let left = integrity::<V, DAMAGED>(state.lane(Column::Damage), group);
            let increment = V::load(&search.increment[group]);
            let stress = trial - left * V::splat(stiffness) * increment;
            // Without any strength nothing is left, not even round-off.
            let softening = V::load(&search.softening[group]);
            let stress = zero.below(softening, stress, zero.below(increment, zero, trial));
            let strain: V = state.four(Column::PlasticStrain, group);
            settle(state, stages, group, [trial, stress, strain, increment], dt);
        }
    }
}

/// s <- s q/q_trial, ep, epdot, and what the next stages read.
#[inline(always)]
pub(super) fn settle<V: Wide>(
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

/// A step is the last when the error it leaves in the stress is below this part of q.
const ACCURACY: f64 = 1e-13;

/// Residuals below this part of q are round-off.
const ROUND_OFF: f64 = 4e-15;

/// More steps than any bisection needs to bring the bracket below round-off.
const MOST_STEPS: usize = 60;

/// Groups of four that are not done.
#[derive(Clone, Copy, Default)]
struct Groups {
    list: [u8; GROUPS],
    count: usize,
}

impl Groups {
    #[inline(always)]
    fn push(&mut self, group: usize) {
        self.list[self.count] = group as u8;
        self.count += 1;
    }

    #[inline(always)]
    fn iter(&self) -> impl Iterator<Item = usize> + use<> {
        let Self { list, count } = *self;
        (0..count.min(GROUPS)).map(move |place| usize::from(list[place]) % GROUPS)
    }
}

/// The solution of q - 3 G (1 - D) dep = softening Y(ep + dep, dep/dt) for the groups of a chunk.
/// Every step is done for all of them before the next one: the chains of operations of several
/// groups then overlap in the processor.
struct Search {
    softening: Lane,
    /// Y at rest.
    rest: Lane,
    /// dep.
    increment: Lane,
    low: Lane,
    high: Lane,
    /// 1 where dep is not known well enough yet.
    open: Lane,
}

impl Default for Search {
    fn default() -> Self {
        let [softening, rest, increment, low, high, open] = [NOTHING; 6];
        Self { softening, rest, increment, low, high, open }
    }
}

impl Search {
    /// Brackets and first guesses; 0 where q <= Y.
    #[inline(always)]
    fn begin<V: Wide, F: Flow, const DAMAGED: bool>(
        &mut self,
        law: &F,
        stiffness: f64,
        dt: f64,
        state: &State,
        stages: &Stages,
        groups: &Groups,
    ) {
        let (zero, one) = (V::splat(0.0), V::splat(1.0));
        for group in groups.iter() {
            let left = integrity::<V, DAMAGED>(state.lane(Column::Damage), group);
            let softening = left * law.softening(state, group);
            let rest = law.at_rest(state.four::<V>(Column::PlasticStrain, group));
            let excess = V::load(&stages.equivalent[group]) - softening * rest;
            let high = zero.below(excess, excess / (left * V::splat(stiffness)), zero);
            // The rate of the last step is the best guess; at first none is as good as any.
            let guess: V = V::splat(dt) * state.four::<V>(Column::PlasticStrainRate, group);
            let guess = zero.below(guess, guess.smaller(high), high);
            softening.store(&mut self.softening[group]);
            rest.store(&mut self.rest[group]);
            guess.store(&mut self.increment[group]);
            high.store(&mut self.high[group]);
            zero.below(excess, one, zero).store(&mut self.open[group]);
        }
    }

    /// Halley's iteration, safeguarded by bisection, each particle for itself.
    #[inline(always)]
    fn solve<V: Wide, F: Flow, const DAMAGED: bool>(
        &mut self,
        law: &F,
        stiffness: f64,
        dt: f64,
        state: &State,
        stages: &Stages,
        mut groups: Groups,
    ) {
        let zero = V::splat(0.0);
        for _ in 0..MOST_STEPS {
            let mut left = Groups::default();
            for group in groups.iter() {
                let intact = integrity::<V, DAMAGED>(state.lane(Column::Damage), group);
                let problem = Problem {
                    trial: V::load(&stages.equivalent[group]),
                    stiffness: intact * V::splat(stiffness),
                    softening: V::load(&self.softening[group]),
                    strain: state.four(Column::PlasticStrain, group),
                    rest: V::load(&self.rest[group]),
                };
                let open = self.improve(law, group, &problem, dt);
                left.list[left.count % GROUPS] = group as u8;
                left.count += usize::from(zero.any_below(open));
            }
            groups = left;
            if groups.count == 0 {
                break;
            }
        }
    }

    /// One step for a group: x <- x + 2 r d/(2 d^2 + r s Y''), d = 3 G (1 - D) + s Y'.
    #[inline(always)]
    fn improve<V: Wide, F: Flow>(
        &mut self,
        law: &F,
        group: usize,
        problem: &Problem<V>,
        dt: f64,
    ) -> V {
        let Problem { trial, stiffness, softening, strain, rest } = *problem;
        let (zero, half) = (V::splat(0.0), V::splat(0.5));
        let (x, open) = (V::load(&self.increment[group]), V::load(&self.open[group]));
        let [y, slope, curvature] = law.moving(strain, rest, x, dt);
        let residual = trial - stiffness * x - softening * y;
        let low = zero.below(residual, x, V::load(&self.low[group]));
        let high = residual.below(zero, x, V::load(&self.high[group]));
        let d = softening.mul_add(slope, stiffness);
        let square = d * d;
        let bent = (square + square) + residual * softening * curvature;
        let next = x + (residual + residual) * d / bent.larger(square);
        let middle = half * (low + high);
        let next = next.below(low, middle, high.below(next, middle, next));
        let change = (next - x).absolute();
        // A particle that has settled stays, whatever its neighbours do.
        let x = zero.below(open, next, x);
        let smooth = law.smoothness(strain, x, dt).smaller(x);
        let error = remaining_error(softening * curvature.absolute(), d, change, smooth);
        let enough = error.below(V::splat(4.0 * ACCURACY) * trial * d * smooth, zero, open);
        let open = change.below(half * smooth, enough, open);
        let open = residual.absolute().below(V::splat(ROUND_OFF) * trial, zero, open);
        x.store(&mut self.increment[group]);
        low.store(&mut self.low[group]);
        high.store(&mut self.high[group]);
        open.store(&mut self.open[group]);
        open
    }
}

/// What a step e of Halley's iteration leaves of the residual, times 4 d smooth.
///
/// The root is missed by e^3 |b^2 - Y'''/(6 d)| with b = Y''/(2 d). Powers and logarithms have
/// Y''' below 3 Y''/smooth, smooth being the distance from the point where they are not smooth: the
/// bound is e^3 b (b + 1/smooth).
#[inline(always)]
fn remaining_error<V: Wide>(curvature: V, d: V, change: V, smooth: V) -> V {
    let cube = change * change * change;
    cube * curvature * curvature.mul_add(smooth, d + d)
}

/// What does not change during the search, of four particles.
#[derive(Clone, Copy)]
struct Problem<V> {
    trial: V,
    stiffness: V,
    softening: V,
    strain: V,
    rest: V,
}
