//! Hypoelasticity with constant moduli.

use super::{
    Chunk, Elastic, Lane, Law, StressRate, Update, View, advance_deformation, first_not_positive,
    four_at_once, stress,
};
use crate::math::tensor::{Tensor, cayley, logarithmic_spin, rotation, skew};
use crate::math::v4::Wide;
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
`stress_rate` (language.md 9.2). rho [M/L^d], E [P], -1 < nu < 0.5.
Wave speed sqrt((K + 4 G/3)/rho). Stored energy V sigma : C^-1 sigma/2.
Source: de Vaucorbeil et al. 2020, eq. 2.5.",
    build: Some(|args| Ok(Arc::new(Linear(Elastic::read(args)?)))),
};

/// sigma <- Q sigma Q^T + dt (lambda tr D I + 2 G D), J <- J det(I + dt L).
///
/// Plane strain keeps sigma_33; 1-D is uniaxial strain, where rates do nothing.
///
/// # Source  de Vaucorbeil et al. 2020, eq. 2.5; language.md 9.2, 9.3
#[derive(Clone, Copy, Debug)]
pub struct Linear(pub Elastic);

impl Law for Linear {
    fn columns(&self, dimension: usize, rate: StressRate) -> ColumnSet {
        let mut columns = ColumnSet::default();
        columns.extend(Column::stress(dimension));
        columns.insert(Column::J);
        if dimension > 1 && matches!(rate, StressRate::GreenNaghdi | StressRate::Logarithmic) {
            columns.extend(Column::deformation(dimension));
        }
        columns
    }

    fn density(&self) -> f64 {
        self.0.density
    }

    fn reference_wave_speed(&self) -> f64 {
        self.0.wave_speed()
    }

    fn update(&self, chunk: &mut Chunk<'_>) {
        let elastic = self.0;
        let by_rate = self.columns(chunk.dimension, chunk.rate).contains(Column::F11);
        if !by_rate && !chunk.columns[Column::F11 as usize].is_empty() {
            advance_deformation(chunk); // an output reads F
        }
        use Column::*;
        let hooke = Hooke { elastic, dt: chunk.dt, rotate: chunk.rate == StressRate::Jaumann };
        match chunk.dimension {
            1 => four_at_once(chunk, [S11, S22, S33, J], [0], hooke),
            _ if by_rate => by_deformation(&elastic, chunk),
            2 => four_at_once(chunk, [S11, S22, S33, S12, J], [0, 1, 3, 4], hooke),
            _ => {
                let state = [S11, S22, S33, S12, S13, S23, J];
                four_at_once(chunk, state, [0, 1, 2, 3, 4, 5, 6, 7, 8], hooke);
            }
        }
        let [jacobian] = chunk.borrow([Column::J]);
        chunk.failed = first_not_positive(jacobian);
    }

    fn wave_speed(&self, view: &View<'_>, out: &mut Lane) {
        let Elastic { density, lambda, shear } = self.0;
        let modulus = (lambda + 2.0 * shear) / density;
        for (out, jacobian) in out.iter_mut().zip(view.column(Column::J)) {
            *out = (modulus * jacobian).sqrt();
        }
    }

    fn stored_energy(&self, view: &View<'_>, out: &mut Lane) {
        for (p, out) in out.iter_mut().enumerate().take(view.len) {
            let sigma = stress(view, p);
            let energy = 0.5 * sigma.dot(&self.strain(&sigma));
            *out = view.column(Column::J)[p] * energy;
        }
    }

    fn elastic_strain(&self, view: &View<'_>, out: &mut [Lane; 6]) {
        for p in 0..view.len {
            let e = self.strain(&stress(view, p));
            let components = [e[(0, 0)], e[(1, 1)], e[(2, 2)], e[(0, 1)], e[(0, 2)], e[(1, 2)]];
            for (lane, component) in out.iter_mut().zip(components) {
                lane[p] = component;
            }
        }
    }

    fn accepts_initial_stress(&self) -> bool {
        true
    }
}

impl Linear {
    /// C^-1 sigma = dev sigma/(2 G) + tr sigma/(9 K) I.
    fn strain(&self, sigma: &Tensor) -> Tensor {
        let mean = sigma.trace() / 3.0;
        let deviator = sigma - Tensor::identity() * mean;
        deviator / (2.0 * self.0.shear) + Tensor::identity() * (mean / (3.0 * self.0.bulk()))
    }
}

/// One step of four particles at once.
struct Hooke {
    elastic: Elastic,
    dt: f64,
    rotate: bool,
}

/// Uniaxial strain; state 11, 22, 33, J.
impl Update<4, 1> for Hooke {
    #[inline(always)]
    fn update<V: Wide>(&self, state: [V; 4], l: [V; 1]) -> [V; 4] {
        let Elastic { lambda, shear, .. } = self.elastic;
        let [s11, s22, s33, j] = state;
        let stretch = V::splat(self.dt) * l[0];
        let pressure = V::splat(lambda) * stretch;
        let axial = V::splat(2.0 * shear).mul_add(stretch, pressure);
        [s11 + axial, s22 + pressure, s33 + pressure, j.mul_add(stretch, j)]
    }
}

/// Plane strain; state 11, 22, 33, 12, J, gradient 11, 12, 21, 22.
impl Update<5, 4> for Hooke {
    #[inline(always)]
    fn update<V: Wide>(&self, state: [V; 5], l: [V; 4]) -> [V; 5] {
        let Elastic { lambda, shear, .. } = self.elastic;
        let [mut s11, mut s22, s33, mut s12, j] = state;
        let dt = V::splat(self.dt);
        let [g11, g12, g21, g22] = [dt * l[0], dt * l[1], dt * l[2], dt * l[3]];
        let one = V::splat(1.0);
        if self.rotate {
            let half = V::splat(0.25) * (g21 - g12);
            let square = half * half;
            let scale = one / (one + square);
            let (cos, sin) = ((one - square) * scale, (half + half) * scale);
            let (cc, ss, cs) = (cos * cos, sin * sin, cos * sin);
            let shift = (cs + cs) * s12;
            let turned = [cc * s11 + ss * s22 - shift, ss * s11 + cc * s22 + shift];
            s12 = cs * (s11 - s22) + (cc - ss) * s12;
            [s11, s22] = turned;
        }
        let pressure = V::splat(lambda) * (g11 + g22);
        let modulus = V::splat(2.0 * shear);
        let volume = (one + g11) * (one + g22) - g12 * g21;
        [
            s11 + modulus.mul_add(g11, pressure),
            s22 + modulus.mul_add(g22, pressure),
            s33 + pressure,
            V::splat(shear).mul_add(g12 + g21, s12),
            j * volume,
        ]
    }
}

/// Three dimensions; state 11, 22, 33, 12, 13, 23, J.
impl Update<7, 9> for Hooke {
    #[inline(always)]
    fn update<V: Wide>(&self, state: [V; 7], l: [V; 9]) -> [V; 7] {
        let Elastic { lambda, shear, .. } = self.elastic;
        let [s11, s22, s33, s12, s13, s23, j] = state;
        let dt = V::splat(self.dt);
        let [g11, g12, g13, g21, g22, g23, g31, g32, g33] = [
            dt * l[0],
            dt * l[1],
            dt * l[2],
            dt * l[3],
            dt * l[4],
            dt * l[5],
            dt * l[6],
            dt * l[7],
            dt * l[8],
        ];
        let mut s = [s11, s22, s33, s12, s13, s23];
        if self.rotate {
            let quarter = V::splat(0.25);
            s = turned(s, [quarter * (g32 - g23), quarter * (g13 - g31), quarter * (g21 - g12)]);
        }
        let pressure = V::splat(lambda) * (g11 + g22 + g33);
        let (modulus, shear) = (V::splat(2.0 * shear), V::splat(shear));
        let one = V::splat(1.0);
        let (a, b, c) = (one + g11, one + g22, one + g33);
        let volume =
            a * (b * c - g23 * g32) - g12 * (g21 * c - g23 * g31) + g13 * (g21 * g32 - b * g31);
        [
            s[0] + modulus.mul_add(g11, pressure),
            s[1] + modulus.mul_add(g22, pressure),
            s[2] + modulus.mul_add(g33, pressure),
            shear.mul_add(g12 + g21, s[3]),
            shear.mul_add(g13 + g31, s[4]),
            shear.mul_add(g23 + g32, s[5]),
            j * volume,
        ]
    }
}

/// Q sigma Q^T with Q = I + 2/(1 + w.w) (A + A^2), A the skew tensor of the axial vector w
/// (half the rotation of the step): sigma' = sigma + f (B + B^T) + ... written out through the
/// rotation matrix; stress as 11, 22, 33, 12, 13, 23.
#[inline(always)]
fn turned<V: Wide>(s: [V; 6], w: [V; 3]) -> [V; 6] {
    let [x, y, z] = w;
    let [s11, s22, s33, s12, s13, s23] = s;
    let one = V::splat(1.0);
    let (xx, yy, zz) = (x * x, y * y, z * z);
    let f = V::splat(2.0) / (one + (xx + yy + zz));
    let (xy, xz, yz) = (x * y, x * z, y * z);
    let (q11, q12, q13) = (one - f * (yy + zz), f * (xy - z), f * (xz + y));
    let (q21, q22, q23) = (f * (xy + z), one - f * (xx + zz), f * (yz - x));
    let (q31, q32, q33) = (f * (xz - y), f * (yz + x), one - f * (xx + yy));
    let (t11, t12, t13) = (
        q11 * s11 + q12 * s12 + q13 * s13,
        q11 * s12 + q12 * s22 + q13 * s23,
        q11 * s13 + q12 * s23 + q13 * s33,
    );
    let (t21, t22, t23) = (
        q21 * s11 + q22 * s12 + q23 * s13,
        q21 * s12 + q22 * s22 + q23 * s23,
        q21 * s13 + q22 * s23 + q23 * s33,
    );
    let (t31, t32, t33) = (
        q31 * s11 + q32 * s12 + q33 * s13,
        q31 * s12 + q32 * s22 + q33 * s23,
        q31 * s13 + q32 * s23 + q33 * s33,
    );
    [
        t11 * q11 + t12 * q12 + t13 * q13,
        t21 * q21 + t22 * q22 + t23 * q23,
        t31 * q31 + t32 * q32 + t33 * q33,
        t11 * q21 + t12 * q22 + t13 * q23,
        t11 * q31 + t12 * q32 + t13 * q33,
        t21 * q31 + t22 * q32 + t23 * q33,
    ]
}

/// Green-Naghdi and logarithmic rates: rotations that follow from F.
fn by_deformation(elastic: &Elastic, chunk: &mut Chunk<'_>) {
    for p in 0..chunk.len {
        let view = chunk.view();
        let (f, sigma) = (super::deformation(&view, p), stress(&view, p));
        let l = chunk.velocity_gradient(p);
        let step = l * chunk.dt;
        let new = (Tensor::identity() + step) * f;
        let q = match chunk.rate {
            StressRate::GreenNaghdi => rotation(&new) * rotation(&f).transpose(),
            _ => cayley(&(logarithmic_spin(&f, &l) * (0.5 * chunk.dt))),
        };
        let strain = step - skew(&step);
        let increment =
            Tensor::identity() * (elastic.lambda * step.trace()) + strain * (2.0 * elastic.shear);
        chunk.set_deformation(p, &new);
        chunk.set_stress(p, &(q * sigma * q.transpose() + increment));
        let determinant = (Tensor::identity() + step).determinant();
        chunk.borrow([Column::J])[0][p] *= determinant;
    }
}
