//! Hypoelasticity with constant moduli.

use super::state::{STRESS, load_tensor};
use super::{Chunk, Elastic, Lane, Law, State, Thermal, write_strain};
use crate::math::tensor::Tensor;
use crate::math::v4::{Sweep, Wide, dispatch};
use crate::model::column::{Column, ColumnSet};
use crate::style::Style;
use std::sync::Arc;

/// The row of the table.
pub const STYLE: Style<super::BuildMaterial> = Style {
    name: "linear",
    usage: "rho, E, nu [, cp, kappa]",
    summary: "hypoelastic: Hooke's law for the rate of the stress",
    manual: "\
sigma <- Q sigma Q^T + dt (lambda tr D I + 2 G D), with D = sym L and the rotation Q of
`stress_rate`. rho [M/L^d], E [P], -1 < nu < 0.5.
Wave speed sqrt((K + 4 G/3)/rho). Stored energy V sigma : C^-1 sigma/2.
cp [L^2/(T^2 K)] and kappa [M L/(T^3 K)] go together: particles then store a temperature, which
`thermo-mechanical` runs conduct.
Source: de Vaucorbeil et al. 2020, eq. 2.5.",
    build: Some(|args, _| Ok(Arc::new(Linear(Elastic::read(args)?)))),
};

/// sigma <- sigma + dt (lambda tr D I + 2 G D), once it has been turned.
///
/// Plane strain keeps sigma_33; 1-D is uniaxial strain.
///
/// # Source  de Vaucorbeil et al. 2020, eq. 2.5; language.md 9.3
#[derive(Clone, Copy, Debug)]
pub struct Linear(pub Elastic);

impl Law for Linear {
    fn columns(&self, dimension: usize) -> ColumnSet {
        let mut columns = ColumnSet::default();
        columns.extend(Column::stress(dimension));
        columns
    }

    fn is_incremental(&self) -> bool {
        true
    }

    fn density(&self) -> f64 {
        self.0.density
    }

    fn moduli(&self) -> [f64; 2] {
        [self.0.bulk(), self.0.shear]
    }

    fn reference_wave_speed(&self) -> f64 {
        self.0.wave_speed()
    }

    fn update(&self, chunk: &mut Chunk<'_>) {
        let elastic = self.0;
        match chunk.state.dimension {
            1 => dispatch(Hooke::<1> { elastic, chunk }),
            2 => dispatch(Hooke::<2> { elastic, chunk }),
            _ => dispatch(Hooke::<3> { elastic, chunk }),
        }
    }

    fn wave_speed(&self, state: &State, out: &mut Lane) {
        let Elastic { density, lambda, shear, .. } = self.0;
        let modulus = (lambda + 2.0 * shear) / density;
        for group in state.groups() {
            out[group] = state.lane(Column::J)[group].map(|jacobian| (modulus * jacobian).sqrt());
        }
    }

    fn stored_energy(&self, state: &State, out: &mut Lane) {
        for p in 0..state.len {
            let sigma = state.stress(p);
            let energy = 0.5 * sigma.dot(&self.strain(&sigma));
            out[p / 4][p % 4] = state.value(Column::J, p) * energy;
        }
    }

    fn elastic_strain(&self, state: &State, out: &mut [Lane; 6]) {
        write_strain(state, out, |p| self.strain(&state.stress(p)));
    }

    fn thermal(&self) -> Thermal {
        self.0.thermal
    }

    fn accepts_initial_stress(&self) -> bool {
        true
    }
}

impl Linear {
    /// C^-1 sigma = dev sigma/(2 G) + tr sigma/(9 K) I.
    pub(super) fn strain(&self, sigma: &Tensor) -> Tensor {
        let mean = sigma.trace() / 3.0;
        let deviator = sigma - Tensor::identity() * mean;
        deviator / (2.0 * self.0.shear) + Tensor::identity() * (mean / (3.0 * self.0.bulk()))
    }
}

/// One step of a chunk in `D` dimensions.
struct Hooke<'a, 'b, const D: usize> {
    elastic: Elastic,
    chunk: &'a mut Chunk<'b>,
}

impl<const D: usize> Sweep for Hooke<'_, '_, D> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let Chunk { state, dt, gradient, .. } = self.chunk;
        let lambda = V::splat(*dt * self.elastic.lambda);
        let (shear, twice) =
            (V::splat(*dt * self.elastic.shear), V::splat(*dt * 2.0 * self.elastic.shear));
        for group in state.groups() {
            let l: [V; 9] = load_tensor(gradient, group);
            let trace = match D {
                1 => l[0],
                2 => l[0] + l[4],
                _ => l[0] + l[4] + l[8],
            };
            let pressure = lambda * trace;
            for axis in 0..3 {
                let old: V = state.four(STRESS[axis], group);
                let increment = match axis < D {
                    true => twice.mul_add(l[4 * axis], pressure),
                    false => pressure,
                };
                state.set_four(STRESS[axis], group, old + increment);
            }
            for (column, i, j) in [(STRESS[3], 0, 1), (STRESS[4], 0, 2), (STRESS[5], 1, 2)] {
                if j < D {
                    let old: V = state.four(column, group);
                    state.set_four(column, group, shear.mul_add(l[3 * i + j] + l[3 * j + i], old));
                }
            }
        }
    }
}
