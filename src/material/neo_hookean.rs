//! Compressible neo-Hookean elasticity.

use super::state::STRESS;
use super::{Chunk, Elastic, Lane, Law, State, Thermal, write_strain};
use crate::math::tensor::Tensor;
use crate::math::v4::{Sweep, Wide, dispatch};
use crate::math::wide::{Four, product_transposed, squared_stretches};
use crate::model::column::{Column, ColumnSet};
use crate::style::Style;
use std::sync::Arc;

/// The row of the table.
pub const STYLE: Style<super::BuildMaterial> = Style {
    name: "neo-hookean",
    usage: "rho, E, nu [, cp, kappa]",
    summary: "hyperelastic: stress from the deformation gradient, with a stored energy",
    manual: "\
P = G (F - F^-T) + lambda ln J F^-T, sigma = P F^T/J = (G (F F^T - I) + lambda ln J I)/J.
Stored energy per reference volume W = G/2 (tr F^T F - 3 - 2 ln J) + lambda/2 ln^2 J.
rho [M/L^d], E [P], -1 < nu < 0.5. Wave speed
sqrt((G (1 + s^2) + lambda (1 - ln J))/(J rho)), s the largest singular value of F.
cp [L^2/(T^2 K)] and kappa [M L/(T^3 K)] go together: particles then store a temperature, which
`thermo-mechanical` runs conduct.
Source: de Vaucorbeil et al. 2020.",
    build: Some(|args, _| Ok(Arc::new(NeoHookean(Elastic::read(args)?)))),
};

/// sigma = (G (F F^T - I) + lambda ln J I)/J.
///
/// # Source  language.md 9.3
#[derive(Clone, Copy, Debug)]
pub struct NeoHookean(pub Elastic);

impl Law for NeoHookean {
    fn columns(&self, dimension: usize) -> ColumnSet {
        let mut columns = ColumnSet::default();
        columns.extend(Column::stress(dimension));
        columns
    }

    fn is_incremental(&self) -> bool {
        false
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
            1 => dispatch(Stress::<1> { elastic, chunk }),
            2 => dispatch(Stress::<2> { elastic, chunk }),
            _ => dispatch(Stress::<3> { elastic, chunk }),
        }
    }

    fn wave_speed(&self, state: &State, out: &mut Lane) {
        let elastic = self.0;
        match state.dimension {
            1 => dispatch(Speed::<1> { elastic, state, out }),
            2 => dispatch(Speed::<2> { elastic, state, out }),
            _ => dispatch(Speed::<3> { elastic, state, out }),
        }
    }

    fn stored_energy(&self, state: &State, out: &mut Lane) {
        let Elastic { lambda, shear, .. } = self.0;
        for p in 0..state.len {
            let log = state.value(Column::J, p).ln();
            let square = state.deformation(p).norm_squared();
            out[p / 4][p % 4] = 0.5 * shear * (square - 3.0 - 2.0 * log) + 0.5 * lambda * log * log;
        }
    }

    fn elastic_strain(&self, state: &State, out: &mut [Lane; 6]) {
        write_strain(state, out, |p| {
            let f = state.deformation(p);
            (f.transpose() * f - Tensor::identity()) * 0.5
        });
    }

    fn thermal(&self) -> Thermal {
        self.0.thermal
    }

    fn accepts_initial_stress(&self) -> bool {
        false
    }
}

/// The stress of a chunk in `D` dimensions.
struct Stress<'a, 'b, const D: usize> {
    elastic: Elastic,
    chunk: &'a mut Chunk<'b>,
}

impl<const D: usize> Sweep for Stress<'_, '_, D> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let state = &mut *self.chunk.state;
        let one = V::splat(1.0);
        for group in state.groups() {
            let f: Four<V> = state.deformation_of_four(group);
            let j: V = state.four(Column::J, group);
            let log = V::load(&j.array().map(f64::ln));
            let modulus = V::splat(self.elastic.shear) / j;
            let pressure = V::splat(self.elastic.lambda) * log / j;
            let b = product_transposed::<V, D>(&f, &f);
            for axis in 0..3 {
                let stress = match axis < D {
                    true => modulus.mul_add(b[4 * axis] - one, pressure),
                    false => pressure,
                };
                state.set_four(STRESS[axis], group, stress);
            }
            for (column, i, k) in [(STRESS[3], 0, 1), (STRESS[4], 0, 2), (STRESS[5], 1, 2)] {
                if k < D {
                    state.set_four(column, group, modulus * b[3 * i + k]);
                }
            }
        }
    }
}

/// sqrt((G (1 + s^2) + lambda (1 - ln J))/rho0), s the largest singular value of F.
struct Speed<'a, const D: usize> {
    elastic: Elastic,
    state: &'a State,
    out: &'a mut Lane,
}

impl<const D: usize> Sweep for Speed<'_, D> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let Elastic { density, lambda, shear, .. } = self.elastic;
        let one = V::splat(1.0);
        for group in self.state.groups() {
            let f: Four<V> = self.state.deformation_of_four(group);
            let [_, largest] = squared_stretches::<V, D>(&f);
            // Out of the plane nothing stretches: that singular value is 1.
            let largest = if D < 3 { largest.larger(one) } else { largest };
            let log = V::load(&self.state.lane(Column::J)[group].map(f64::ln));
            let modulus = V::splat(shear) * (one + largest) + V::splat(lambda) * (one - log);
            let speed = (modulus.larger(V::splat(0.0)) / V::splat(density)).sqrt();
            speed.store(&mut self.out[group]);
        }
    }
}
