//! The stages of a step of laws that treat pressure and deviator apart: each is one loop over the
//! particles of a chunk, and a law runs those that it contains.

use super::state::{STRESS, load_tensor};
use super::{Chunk, Lane, NOTHING};
use crate::eos::Viscosity;
use crate::math::v4::{Sweep, Wide, dispatch};
use crate::model::column::Column;

/// What the stages of a step hand on.
pub struct Stages {
    /// Pressure p \[P\].
    pub pressure: Lane,
    /// Equivalent stress q = sqrt(3/2) |s| \[P\], of the trial, then at the end of the step.
    pub equivalent: Lane,
    /// Increment dep of the equivalent plastic strain.
    pub increment: Lane,
}

impl Default for Stages {
    fn default() -> Self {
        Self { pressure: NOTHING, equivalent: NOTHING, increment: NOTHING }
    }
}

/// Calls a sweep for the dimension of a chunk.
macro_rules! in_dimensions {
    ($chunk:expr, $sweep:ident { $($field:tt)* }) => {
        match $chunk.state.dimension {
            1 => dispatch($sweep::<1> { $($field)* }),
            2 => dispatch($sweep::<2> { $($field)* }),
            _ => dispatch($sweep::<3> { $($field)* }),
        }
    };
}

/// tr D of four particles.
#[inline(always)]
pub fn dilation<V: Wide, const D: usize>(gradient: &[Lane; 9], group: usize) -> V {
    let mut trace = V::load(&gradient[0][group]);
    for axis in 1..D {
        trace = trace + V::load(&gradient[4 * axis][group]);
    }
    trace
}

/// Stress columns <- s, q: the trial deviator s = dev(sigma) + 2 G (1 - D) dt dev D.
pub fn trial(shear: f64, damaged: bool, chunk: &mut Chunk<'_>, stages: &mut Stages) {
    let factor = 2.0 * shear * chunk.dt;
    match damaged {
        true => in_dimensions!(chunk, WeakTrial { factor, chunk, stages }),
        false => in_dimensions!(chunk, Trial { factor, chunk, stages }),
    }
}

/// Stress columns <- s, q: the deviator s = 2 mu dev D of a Newtonian fluid.
pub fn viscous(viscosity: f64, chunk: &mut Chunk<'_>, stages: &mut Stages) {
    let factor = 2.0 * viscosity;
    in_dimensions!(chunk, Viscous { factor, chunk, stages });
}

/// The part 1 - D of the stiffness that damage has left.
#[inline(always)]
pub fn integrity<V: Wide, const DAMAGED: bool>(damage: &Lane, group: usize) -> V {
    match DAMAGED {
        true => V::splat(1.0) - V::load(&damage[group]),
        false => V::splat(1.0),
    }
}

macro_rules! deviator_sweep {
    ($name:ident, $keep:literal, $damaged:literal) => {
        struct $name<'a, 'b, const D: usize> {
            factor: f64,
            chunk: &'a mut Chunk<'b>,
            stages: &'a mut Stages,
        }

        impl<const D: usize> Sweep for $name<'_, '_, D> {
            type Output = ();

            #[inline(always)]
            fn run<V: Wide>(self) {
                deviator::<V, D, $keep, $damaged>(self.factor, self.chunk, self.stages);
            }
        }
    };
}

deviator_sweep!(Trial, true, false);
deviator_sweep!(WeakTrial, true, true);
deviator_sweep!(Viscous, false, false);

/// s = dev(sigma) (if `KEEP`) + factor (1 - D) dev D.
#[inline(always)]
fn deviator<V: Wide, const D: usize, const KEEP: bool, const DAMAGED: bool>(
    factor: f64,
    chunk: &mut Chunk<'_>,
    stages: &mut Stages,
) {
    let Chunk { state, gradient, .. } = chunk;
    let (zero, third) = (V::splat(0.0), V::splat(1.0 / 3.0));
    for group in state.groups() {
        let l: [V; 9] = load_tensor(gradient, group);
        let left = integrity::<V, DAMAGED>(state.lane(Column::Damage), group);
        let factor = left * V::splat(factor);
        let half = V::splat(0.5) * factor;
        let mean_rate = third * dilation::<V, D>(gradient, group);
        let old: [V; 6] = state.fours(STRESS, group);
        let mean = if KEEP { third * (old[0] + old[1] + old[2]) } else { zero };
        let mut square = zero;
        for axis in 0..3 {
            let rate = if axis < D { l[4 * axis] - mean_rate } else { zero - mean_rate };
            let base = if KEEP { old[axis] - mean } else { zero };
            let s = factor.mul_add(rate, base);
            square = s.mul_add(s, square);
            state.set_four(STRESS[axis], group, s);
        }
        for (n, i, j) in [(3, 0, 1), (4, 0, 2), (5, 1, 2)] {
            if j < D {
                let base = if KEEP { old[n] } else { zero };
                let s = half.mul_add(l[3 * i + j] + l[3 * j + i], base);
                square = (s + s).mul_add(s, square);
                state.set_four(STRESS[n], group, s);
            }
        }
        (V::splat(1.5) * square).sqrt().store(&mut stages.equivalent[group]);
    }
}

/// p <- (1 - D) p where p < 0.
pub fn weaken_tension(chunk: &mut Chunk<'_>, stages: &mut Stages) {
    dispatch(WeakenTension { chunk, stages });
}

struct WeakenTension<'a, 'b> {
    chunk: &'a mut Chunk<'b>,
    stages: &'a mut Stages,
}

impl Sweep for WeakenTension<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let state = &*self.chunk.state;
        for group in state.groups() {
            let left = integrity::<V, true>(state.lane(Column::Damage), group);
            let lane = &mut self.stages.pressure[group];
            let pressure = V::load(lane);
            pressure.below(V::splat(0.0), left * pressure, pressure).store(lane);
        }
    }
}

/// p += rho h (Q1 h tr^2 D - Q2 c0 sqrt(J) tr D) where tr D < 0.
pub fn add_viscosity(
    viscosity: Viscosity,
    density: f64,
    chunk: &mut Chunk<'_>,
    stages: &mut Stages,
) {
    in_dimensions!(chunk, Compress { viscosity, density, chunk, stages });
}

struct Compress<'a, 'b, const D: usize> {
    viscosity: Viscosity,
    density: f64,
    chunk: &'a mut Chunk<'b>,
    stages: &'a mut Stages,
}

impl<const D: usize> Sweep for Compress<'_, '_, D> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let (state, h) = (&*self.chunk.state, self.chunk.cell);
        let Viscosity { quadratic, linear, sound } = self.viscosity;
        let (quadratic, linear) = (V::splat(quadratic * h), V::splat(linear * sound));
        let scale = V::splat(self.density * h);
        for group in state.groups() {
            let j: V = state.four(Column::J, group);
            // Compression is positive, expansion nothing.
            let rate = V::splat(0.0) - dilation::<V, D>(self.chunk.gradient, group);
            let rate = rate.larger(V::splat(0.0));
            let speed = quadratic.mul_add(rate, linear * j.sqrt());
            let lane = &mut self.stages.pressure[group];
            (scale / j * rate).mul_add(speed, V::load(lane)).store(lane);
        }
    }
}

/// Raises wave speeds c to Q + sqrt(Q^2 + c^2) with Q = Q1 h |tr D| + Q2 c0 sqrt(J) where
/// tr D < 0: the step that artificial viscosity allows is h over this speed.
///
/// # Source  Landshoff 1955; Hallquist 2006, LS-DYNA theory manual, eq. 22.2
pub fn stiffen(viscosity: Viscosity, chunk: &Chunk<'_>, speed: &mut Lane) {
    in_dimensions!(chunk, Stiffen { viscosity, chunk, speed });
}

struct Stiffen<'a, 'b, const D: usize> {
    viscosity: Viscosity,
    chunk: &'a Chunk<'b>,
    speed: &'a mut Lane,
}

impl<const D: usize> Sweep for Stiffen<'_, '_, D> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let (state, zero) = (&*self.chunk.state, V::splat(0.0));
        let Viscosity { quadratic, linear, sound } = self.viscosity;
        let (quadratic, linear) = (V::splat(quadratic * self.chunk.cell), V::splat(linear * sound));
        for group in state.groups() {
            let j: V = state.four(Column::J, group);
            let rate = zero - dilation::<V, D>(self.chunk.gradient, group);
            let q = zero.below(rate, quadratic.mul_add(rate, linear * j.sqrt()), zero);
            let speed = V::load(&self.speed[group]);
            // A failed particle, of speed 0, has no viscosity either.
            let raised = q + q.mul_add(q, speed * speed).sqrt();
            zero.below(speed, raised, zero).store(&mut self.speed[group]);
        }
    }
}

/// sigma <- -p I + s; 0 where D = 1.
pub fn assemble(damaged: bool, chunk: &mut Chunk<'_>, stages: &Stages) {
    match damaged {
        true => dispatch(Assemble::<true> { chunk, stages }),
        false => dispatch(Assemble::<false> { chunk, stages }),
    }
}

struct Assemble<'a, 'b, const DAMAGED: bool> {
    chunk: &'a mut Chunk<'b>,
    stages: &'a Stages,
}

impl<const DAMAGED: bool> Sweep for Assemble<'_, '_, DAMAGED> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let state = &mut *self.chunk.state;
        let (zero, one) = (V::splat(0.0), V::splat(1.0));
        for group in state.groups() {
            let pressure = V::load(&self.stages.pressure[group]);
            for axis in 0..3 {
                let s: V = state.four(STRESS[axis], group);
                state.set_four(STRESS[axis], group, s - pressure);
            }
            if DAMAGED {
                let damage: V = state.four(Column::Damage, group);
                for column in STRESS {
                    let stress: V = state.four(column, group);
                    state.set_four(column, group, damage.below(one, stress, zero));
                }
            }
        }
    }
}
