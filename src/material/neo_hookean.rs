//! Compressible neo-Hookean elasticity.

use super::{
    Chunk, Elastic, Lane, Law, StressRate, Update, View, deformation, first_not_positive,
    four_at_once,
};
use crate::math::tensor::{Tensor, eigenvalues};
use crate::math::v4::Wide;
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
Source: de Vaucorbeil et al. 2020; language.md 9.3, 9.5.",
    build: Some(|args| Ok(Arc::new(NeoHookean(Elastic::read(args)?)))),
};

/// F <- (I + dt L) F, sigma = (G (F F^T - I) + lambda ln J I)/J.
///
/// # Source  language.md 9.1, 9.3
#[derive(Clone, Copy, Debug)]
pub struct NeoHookean(pub Elastic);

impl Law for NeoHookean {
    fn columns(&self, dimension: usize, _rate: StressRate) -> ColumnSet {
        let mut columns = ColumnSet::default();
        columns.extend(Column::stress(dimension));
        columns.extend(Column::deformation(dimension));
        columns.insert(Column::J);
        columns
    }

    fn density(&self) -> f64 {
        self.0.density
    }

    fn reference_wave_speed(&self) -> f64 {
        self.0.wave_speed()
    }

    fn update(&self, chunk: &mut Chunk<'_>) {
        use Column::*;
        let step = Step { elastic: self.0, dt: chunk.dt };
        match chunk.dimension {
            1 => four_at_once(chunk, [F11, S11, S22, S33, J], [0], step),
            2 => {
                let state = [F11, F12, F21, F22, S11, S22, S33, S12, J];
                four_at_once(chunk, state, [0, 1, 3, 4], step);
            }
            _ => {
                let state =
                    [F11, F12, F13, F21, F22, F23, F31, F32, F33, S11, S22, S33, S12, S13, S23, J];
                four_at_once(chunk, state, [0, 1, 2, 3, 4, 5, 6, 7, 8], step);
            }
        }
        let [jacobian] = chunk.borrow([Column::J]);
        chunk.failed = first_not_positive(jacobian);
    }

    fn wave_speed(&self, view: &View<'_>, out: &mut Lane) {
        let Elastic { density, lambda, shear } = self.0;
        for (p, out) in out.iter_mut().enumerate().take(view.len) {
            let f = deformation(view, p);
            let j = view.column(Column::J)[p];
            let stretches = eigenvalues(&(f * f.transpose()));
            let largest = stretches.into_iter().fold(0.0, f64::max);
            let modulus = shear * (1.0 + largest) + lambda * (1.0 - j.ln());
            *out = (modulus.max(0.0) / density).sqrt();
        }
    }

    fn stored_energy(&self, view: &View<'_>, out: &mut Lane) {
        let Elastic { lambda, shear, .. } = self.0;
        for (p, out) in out.iter_mut().enumerate().take(view.len) {
            let log = view.column(Column::J)[p].ln();
            let square = deformation(view, p).norm_squared();
            *out = 0.5 * shear * (square - 3.0 - 2.0 * log) + 0.5 * lambda * log * log;
        }
    }

    fn elastic_strain(&self, view: &View<'_>, out: &mut [Lane; 6]) {
        for p in 0..view.len {
            let f = deformation(view, p);
            let e = (f.transpose() * f - Tensor::identity()) * 0.5;
            let components = [e[(0, 0)], e[(1, 1)], e[(2, 2)], e[(0, 1)], e[(0, 2)], e[(1, 2)]];
            for (lane, component) in out.iter_mut().zip(components) {
                lane[p] = component;
            }
        }
    }

    fn accepts_initial_stress(&self) -> bool {
        false
    }
}

/// One step of four particles at once.
struct Step {
    elastic: Elastic,
    dt: f64,
}

impl Step {
    /// G/J and lambda ln J/J.
    #[inline(always)]
    fn moduli<V: Wide>(&self, j: V) -> (V, V) {
        let log = V::load(&j.array().map(f64::ln));
        (V::splat(self.elastic.shear) / j, V::splat(self.elastic.lambda) * log / j)
    }
}

/// Uniaxial strain; state F11, stress 11, 22, 33, J.
impl Update<5, 1> for Step {
    #[inline(always)]
    fn update<V: Wide>(&self, state: [V; 5], l: [V; 1]) -> [V; 5] {
        let f = (V::splat(self.dt) * l[0]).mul_add(state[0], state[0]);
        let (modulus, pressure) = self.moduli(f);
        [f, modulus * (f * f - V::splat(1.0)) + pressure, pressure, pressure, f]
    }
}

/// Plane strain; state F11, F12, F21, F22, stress 11, 22, 33, 12, J; gradient 11, 12, 21, 22.
impl Update<9, 4> for Step {
    #[inline(always)]
    fn update<V: Wide>(&self, state: [V; 9], l: [V; 4]) -> [V; 9] {
        let (dt, one) = (V::splat(self.dt), V::splat(1.0));
        let [a, b, c, d, ..] = state;
        let [l11, l12, l21, l22] = l;
        let (f11, f12) = (a + dt * (l11 * a + l12 * c), b + dt * (l11 * b + l12 * d));
        let (f21, f22) = (c + dt * (l21 * a + l22 * c), d + dt * (l21 * b + l22 * d));
        let j = f11 * f22 - f12 * f21;
        let (modulus, pressure) = self.moduli(j);
        let s11 = modulus * (f11 * f11 + f12 * f12 - one) + pressure;
        let s22 = modulus * (f21 * f21 + f22 * f22 - one) + pressure;
        let s12 = modulus * (f11 * f21 + f12 * f22);
        [f11, f12, f21, f22, s11, s22, pressure, s12, j]
    }
}

/// Three dimensions; state F by rows, stress 11, 22, 33, 12, 13, 23, J.
impl Update<16, 9> for Step {
    #[inline(always)]
    fn update<V: Wide>(&self, state: [V; 16], l: [V; 9]) -> [V; 16] {
        let (dt, one) = (V::splat(self.dt), V::splat(1.0));
        let mut f = [V::splat(0.0); 9];
        for i in 0..3 {
            for k in 0..3 {
                let change =
                    l[3 * i] * state[k] + l[3 * i + 1] * state[3 + k] + l[3 * i + 2] * state[6 + k];
                f[3 * i + k] = dt.mul_add(change, state[3 * i + k]);
            }
        }
        let [a, b, c, d, e, g, h, i, k] = f;
        let j = a * (e * k - g * i) - b * (d * k - g * h) + c * (d * i - e * h);
        let (modulus, pressure) = self.moduli(j);
        let s11 = modulus * (a * a + b * b + c * c - one) + pressure;
        let s22 = modulus * (d * d + e * e + g * g - one) + pressure;
        let s33 = modulus * (h * h + i * i + k * k - one) + pressure;
        let s12 = modulus * (a * d + b * e + c * g);
        let s13 = modulus * (a * h + b * i + c * k);
        let s23 = modulus * (d * h + e * i + g * k);
        [a, b, c, d, e, g, h, i, k, s11, s22, s33, s12, s13, s23, j]
    }
}
