//! Hypoelasticity with von Mises plasticity.

use super::linear::Linear;
use super::stages::{Stages, assemble, dilation};
use super::state::STRESS;
use super::{BuildMaterial, Chunk, Elastic, Lane, Law, State};
use crate::math::v4::{Sweep, Wide, dispatch};
use crate::model::column::{Column, ColumnSet};
use crate::strength::linear_flow::{LinearFlow, flow_linearly};
use crate::style::Style;
use std::sync::Arc;

/// The row of the table.
pub const STYLE: Style<BuildMaterial> = Style {
    name: "von-mises",
    usage: "rho, E, nu, sigma_y [, H]",
    summary: "hypoelastic, von Mises plasticity with linear hardening",
    manual: "\
Hooke's law for the rate of the stress (see `linear`); then s is brought back along itself to
q = sigma_y + H ep. rho [M/L^d], E [P], -1 < nu < 0.5, sigma_y >= 0 [P], H >= 0 [P] (default 0).
Wave speed sqrt((K + 4 G/3)/rho). Stored energy V sigma : C^-1 sigma/2.
Source: Wilkins 1964 (radial return); Simo and Hughes 1998, box 3.2.",
    build: Some(|args, _| {
        let elastic = Elastic::read_moduli(args)?;
        let limit = f64::INFINITY;
        let yield_stress = args.within("the yield stress sigma_y", 0.0, limit)?.value;
        let hardening = match args.remaining() {
            0 => 0.0,
            _ => args.within("the hardening modulus H", 0.0, limit)?.value,
        };
        Ok(Arc::new(VonMises { elastic, yield_stress, hardening }))
    }),
};

/// q <= sigma_y + H ep.
///
/// # Source  Simo and Hughes 1998, box 3.2
#[derive(Clone, Copy, Debug)]
pub struct VonMises {
    /// Moduli.
    pub elastic: Elastic,
    /// sigma_y \[P\].
    pub yield_stress: f64,
    /// H \[P\].
    pub hardening: f64,
}

impl Law for VonMises {
    fn columns(&self, dimension: usize) -> ColumnSet {
        let mut columns = Linear(self.elastic).columns(dimension);
        columns.extend(&[Column::PlasticStrain, Column::PlasticStrainRate]);
        columns
    }

    fn is_incremental(&self) -> bool {
        true
    }

    fn density(&self) -> f64 {
        self.elastic.density
    }

    fn moduli(&self) -> [f64; 2] {
        [self.elastic.bulk(), self.elastic.shear]
    }

    fn reference_wave_speed(&self) -> f64 {
        self.elastic.wave_speed()
    }

    fn update(&self, chunk: &mut Chunk<'_>) {
        let stages = &mut Stages::default();
        let bulk = self.elastic.bulk();
        match chunk.state.dimension {
            1 => dispatch(Pressure::<1> { bulk, chunk, stages }),
            2 => dispatch(Pressure::<2> { bulk, chunk, stages }),
            _ => dispatch(Pressure::<3> { bulk, chunk, stages }),
        }
        let law = LinearFlow { yield_stress: self.yield_stress, hardening: self.hardening };
        flow_linearly(law, self.elastic.shear, false, chunk, stages);
        assemble(false, chunk, stages);
    }

    fn wave_speed(&self, state: &State, out: &mut Lane) {
        Linear(self.elastic).wave_speed(state, out);
    }

    fn stored_energy(&self, state: &State, out: &mut Lane) {
        Linear(self.elastic).stored_energy(state, out);
    }

    fn elastic_strain(&self, state: &State, out: &mut [Lane; 6]) {
        Linear(self.elastic).elastic_strain(state, out);
    }

    fn accepts_initial_stress(&self) -> bool {
        true
    }
}

/// p = -tr(sigma)/3 - K dt tr D.
struct Pressure<'a, 'b, const D: usize> {
    bulk: f64,
    chunk: &'a Chunk<'b>,
    stages: &'a mut Stages,
}

impl<const D: usize> Sweep for Pressure<'_, '_, D> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let Chunk { state, gradient, dt, .. } = self.chunk;
        let (bulk, third) = (V::splat(-self.bulk * dt), V::splat(-1.0 / 3.0));
        for group in state.groups() {
            let [a, b, c]: [V; 3] = state.fours([STRESS[0], STRESS[1], STRESS[2]], group);
            let rate = dilation::<V, D>(gradient, group);
            bulk.mul_add(rate, third * (a + b + c)).store(&mut self.stages.pressure[group]);
        }
    }
}
