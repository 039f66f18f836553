//! Ideal gases, whose internal energy is advanced with them.

use super::{BuildEos, Eos};
use crate::material::stages::{Stages, dilation};
use crate::material::{Chunk, Lane, State};
use crate::math::v4::{Sweep, Wide, dispatch};
use crate::model::column::Column;
use crate::script::arguments::Args;
use crate::script::diagnostic::Diagnostic;
use crate::style::Style;
use std::sync::Arc;

/// The row of the table.
pub const STYLE: Style<BuildEos> = Style {
    name: "ideal-gas",
    usage: "rho0, gamma, p0 [, Q1, Q2]",
    summary: "ideal gas that keeps its internal energy, with artificial viscosity",
    manual: "\
p = (gamma - 1) rho e. rho0 [M/L^d], 1 < gamma <= 3 (1 + 2/degrees of freedom), p0 >= 0 [P] the
pressure at rho0. The internal energy per reference volume E = rho0 e [P] (dump field `ienergy`)
starts at p0/(gamma - 1) and follows dE = -(p + q) dJ with p in the middle of the step, so that
smooth motion keeps p J^gamma; what viscosity (`fluid`) and plastic flow dissipate goes into it.
Where tr D < 0 the artificial viscosity q = rho h (Q1 h tr^2 D - Q2 c tr D) is added, with the sound
speed c = sqrt(gamma p/rho) of the moment; both are 0 if they are not given. Shocks need them: Q1 = 2,
Q2 = 0.2. Stiffness in the wave speed: gamma p.
`strain_energy` is the internal energy; of the ledger it is ID_stored + ID_viscous + ID_plastic, up to
the error of the time integration. No damage and no temperature law goes with it.
A gas of p0 = 0 at rest has no wave speed: the step must come from motion or `set_dt`.
Source: von Neumann and Richtmyer 1950; Landshoff 1955; Wilkins 1980 (centred pressure).",
    build: Some(|args| Ok(Arc::new(read(args)?))),
};

/// gamma of one degree of freedom. Beyond it no gas lies, and a step of the time step's rate limit
/// could ask for more energy than there is.
const STIFFEST: f64 = 3.0;

fn read(args: &mut Args<'_>) -> Result<IdealGas, Diagnostic> {
    let density = args.positive("the density rho0")?.value;
    let exponent = args.number("the exponent gamma")?;
    if exponent.known && !(exponent.value > 1.0 && exponent.value <= STIFFEST) {
        let message = "the exponent gamma of a gas must lie in 1 < gamma <= 3";
        return Err(args.out_of_range(&exponent, message));
    }
    let pressure = args.within("the initial pressure p0", 0.0, f64::INFINITY)?.value;
    let mut gas =
        IdealGas { density, exponent: exponent.value, pressure, quadratic: 0.0, linear: 0.0 };
    if args.remaining() > 0 {
        gas.quadratic = args.within("the viscosity Q1", 0.0, f64::INFINITY)?.value;
        gas.linear = args.within("the viscosity Q2", 0.0, f64::INFINITY)?.value;
    }
    Ok(gas)
}

/// p = (gamma - 1) E/J, E the internal energy per reference volume.
///
/// # Source  von Neumann and Richtmyer 1950; Landshoff 1955
#[derive(Clone, Copy, Debug)]
pub struct IdealGas {
    /// rho0 \[M/L^d\].
    pub density: f64,
    /// gamma.
    pub exponent: f64,
    /// p0 \[P\] at rho0.
    pub pressure: f64,
    /// Q1.
    pub quadratic: f64,
    /// Q2.
    pub linear: f64,
}

impl Eos for IdealGas {
    fn density(&self) -> f64 {
        self.density
    }

    fn bulk(&self) -> f64 {
        self.exponent * self.pressure
    }

    fn initial_energy(&self) -> Option<f64> {
        Some(self.pressure / (self.exponent - 1.0))
    }

    fn initial_pressure(&self) -> f64 {
        self.pressure
    }

    fn pressure(&self, chunk: &mut Chunk<'_>, _heated: bool, pressure: &mut Lane) {
        let gas = *self;
        let good = match chunk.state.dimension {
            1 => dispatch(Advance::<1> { gas, chunk, pressure }),
            2 => dispatch(Advance::<2> { gas, chunk, pressure }),
            _ => dispatch(Advance::<3> { gas, chunk, pressure }),
        };
        if !good {
            let energies = chunk.state.values(Column::InternalEnergy);
            chunk.failed = chunk.failed.or(energies.iter().position(|energy| *energy < 0.0));
        }
    }

    fn absorb(&self, viscosity: f64, chunk: &mut Chunk<'_>, stages: &mut Stages) {
        dispatch(Absorb { factor: self.exponent - 1.0, viscosity, chunk, stages });
    }

    fn stiffness(&self, state: &State, stiffness: &mut Lane) {
        let factor = self.exponent * (self.exponent - 1.0);
        dispatch(Stiffness { factor, state, stiffness });
    }

    fn is_viscous(&self) -> bool {
        self.quadratic > 0.0 || self.linear > 0.0
    }

    fn stiffen(&self, chunk: &Chunk<'_>, speed: &mut Lane) {
        if self.is_viscous() {
            let gas = *self;
            match chunk.state.dimension {
                1 => dispatch(Stiffen::<1> { gas, chunk, speed }),
                2 => dispatch(Stiffen::<2> { gas, chunk, speed }),
                _ => dispatch(Stiffen::<3> { gas, chunk, speed }),
            }
        }
    }

    fn viscous_pressure(&self, chunk: &Chunk<'_>, p: usize) -> f64 {
        let (energy, j) =
            (chunk.state.value(Column::InternalEnergy, p), chunk.state.value(Column::J, p));
        -chunk.state.stress(p).trace() / 3.0 - (self.exponent - 1.0) * energy / j
    }
}

/// E and p + q at the end of the step, from dE = -((p + p')/2 + q) dJ with p' = (gamma - 1) E'/J':
///
/// E' = (E (1 - (gamma - 1)/2 dJ/J) - q dJ)/(1 + (gamma - 1)/2 dJ/J').
///
/// q is that of the end alone: it is never negative, so E' is not either, and where a shock has
/// passed what it leaves out by not being centred has summed up to nothing.
struct Advance<'a, 'b, const D: usize> {
    gas: IdealGas,
    chunk: &'a mut Chunk<'b>,
    pressure: &'a mut Lane,
}

impl<const D: usize> Sweep for Advance<'_, '_, D> {
    /// Is no energy negative?
    type Output = bool;

    #[inline(always)]
    fn run<V: Wide>(self) -> bool {
        let IdealGas { density, exponent, quadratic, linear, .. } = self.gas;
        let Chunk { state, gradient, before, cell, .. } = self.chunk;
        let (zero, one) = (V::splat(0.0), V::splat(1.0));
        let (factor, half) = (V::splat(exponent - 1.0), V::splat(0.5 * (exponent - 1.0)));
        let (mass, square) = (V::splat(density * *cell), V::splat(quadratic * *cell));
        let linear = V::splat(linear);
        // c^2 = gamma (gamma - 1) E/rho0.
        let speed = V::splat(exponent * (exponent - 1.0) / density);
        let mut good = true;
        for group in state.groups() {
            let energy: V = state.four(Column::InternalEnergy, group);
            let (old, new): (V, V) = (V::load(&before[group]), state.four(Column::J, group));
            let inverse = one / new;
            let rate = (zero - dilation::<V, D>(gradient, group)).larger(zero);
            let sound = (speed * energy).sqrt();
            let q = mass * inverse * rate * square.mul_add(rate, linear * sound);
            let change = new - old;
            let kept = energy * (one - half * change / old) - q * change;
            let energy = kept / half.mul_add(change * inverse, one);
            good &= !energy.any_below(zero);
            state.set_four(Column::InternalEnergy, group, energy);
            (factor * energy * inverse + q).store(&mut self.pressure[group]);
        }
        good
    }
}

/// E += J (q dep + q^2 dt/(3 mu)), the work of the deviator that is lost, and p with it.
struct Absorb<'a, 'b> {
    /// gamma - 1.
    factor: f64,
    viscosity: f64,
    chunk: &'a mut Chunk<'b>,
    stages: &'a mut Stages,
}

impl Sweep for Absorb<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let Chunk { state, dt, .. } = self.chunk;
        let Stages { pressure, equivalent, increment } = self.stages;
        let fluid = if self.viscosity > 0.0 { *dt / (3.0 * self.viscosity) } else { 0.0 };
        let (factor, fluid) = (V::splat(self.factor), V::splat(fluid));
        for group in state.groups() {
            let equivalent = V::load(&equivalent[group]);
            let strain = fluid.mul_add(equivalent, V::load(&increment[group]));
            let work = equivalent * strain;
            let j: V = state.four(Column::J, group);
            let energy: V = state.four(Column::InternalEnergy, group);
            state.set_four(Column::InternalEnergy, group, j.mul_add(work, energy));
            let lane = &mut pressure[group];
            factor.mul_add(work, V::load(lane)).store(lane);
        }
    }
}

/// gamma p = gamma (gamma - 1) E/J.
struct Stiffness<'a> {
    factor: f64,
    state: &'a State,
    stiffness: &'a mut Lane,
}

impl Sweep for Stiffness<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let factor = V::splat(self.factor);
        for group in self.state.groups() {
            let energy: V = self.state.four(Column::InternalEnergy, group);
            let j: V = self.state.four(Column::J, group);
            (factor * energy / j).store(&mut self.stiffness[group]);
        }
    }
}

/// Wave speeds c <- Q + sqrt(Q^2 + c^2) with Q = Q1 h |tr D| + Q2 c where tr D < 0.
///
/// # Source  Landshoff 1955; Hallquist 2006, LS-DYNA theory manual, eq. 22.2
struct Stiffen<'a, 'b, const D: usize> {
    gas: IdealGas,
    chunk: &'a Chunk<'b>,
    speed: &'a mut Lane,
}

impl<const D: usize> Sweep for Stiffen<'_, '_, D> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let IdealGas { quadratic, linear, .. } = self.gas;
        let Chunk { state, gradient, cell, .. } = self.chunk;
        let (zero, square) = (V::splat(0.0), V::splat(quadratic * *cell));
        let linear = V::splat(linear);
        for group in state.groups() {
            let rate = zero - dilation::<V, D>(gradient, group);
            let lane = &mut self.speed[group];
            let speed = V::load(lane);
            let q = zero.below(rate, square.mul_add(rate, linear * speed), zero);
            (q + q.mul_add(q, speed * speed).sqrt()).store(lane);
        }
    }
}

#[cfg(test)]
mod tests;
