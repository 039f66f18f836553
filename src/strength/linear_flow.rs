//! Plastic flow with linear hardening, in closed form.

use super::flow::settle;
use crate::material::Chunk;
use crate::material::stages::{Stages, integrity, trial};
use crate::math::v4::{Sweep, Wide, dispatch};
use crate::model::column::Column;

/// Y = sigma_y + H ep.
#[derive(Clone, Copy, Debug)]
pub struct LinearFlow {
    /// sigma_y \[P\].
    pub yield_stress: f64,
    /// H \[P\].
    pub hardening: f64,
}

/// Trial and return to the yield surface of a flow stress (1 - D) (sigma_y + H ep), in closed form.
pub fn flow_linearly(
    law: LinearFlow,
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
    law: LinearFlow,
    shear: f64,
    chunk: &'a mut Chunk<'b>,
    stages: &'a mut Stages,
}

impl<const DAMAGED: bool> Sweep for LinearReturn<'_, '_, DAMAGED> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let Self { law: LinearFlow { yield_stress, hardening }, shear, chunk, stages } = self;
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
