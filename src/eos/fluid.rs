//! Weakly compressible fluids.

use super::{BuildEos, Eos};
use crate::material::{Chunk, Lane, State};
use crate::math::transcendental::{exp, ln};
use crate::math::v4::{Sweep, Wide, dispatch};
use crate::model::column::Column;
use crate::style::Style;
use std::sync::Arc;

/// The row of the table.
pub const STYLE: Style<BuildEos> = Style {
    name: "fluid",
    usage: "rho0, K, gamma",
    summary: "weakly compressible fluid",
    manual: "\
p = K ((rho/rho0)^gamma - 1). rho0 [M/L^d], K [P]. Stiffness in the wave speed:
gamma K (rho/rho0)^gamma.
Source: de Vaucorbeil et al. 2020, eq. 2.18.",
    build: Some(|args| {
        let density = args.positive("the density rho0")?.value;
        let bulk = args.positive("the modulus K")?.value;
        let exponent = args.positive("the exponent gamma")?.value;
        Ok(Arc::new(Fluid { density, bulk, exponent }))
    }),
};

/// p = K ((rho/rho0)^gamma - 1).
///
/// # Source  de Vaucorbeil et al. 2020, eq. 2.18
#[derive(Clone, Copy, Debug)]
pub struct Fluid {
    /// rho0 \[M/L^d\].
    pub density: f64,
    /// K \[P\].
    pub bulk: f64,
    /// gamma.
    pub exponent: f64,
}

impl Eos for Fluid {
    fn density(&self) -> f64 {
        self.density
    }

    fn bulk(&self) -> f64 {
        self.bulk
    }

    fn pressure(&self, chunk: &mut Chunk<'_>, _heated: bool, pressure: &mut Lane) {
        let Fluid { bulk, exponent, .. } = *self;
        dispatch(Compression {
            factor: bulk,
            offset: bulk,
            exponent,
            state: chunk.state,
            out: pressure,
        });
    }

    fn stiffness(&self, state: &State, stiffness: &mut Lane) {
        let Fluid { bulk, exponent, .. } = *self;
        let factor = exponent * bulk;
        dispatch(Compression { factor, offset: 0.0, exponent, state, out: stiffness });
    }
}

/// factor J^-gamma - offset.
struct Compression<'a> {
    factor: f64,
    offset: f64,
    exponent: f64,
    state: &'a State,
    out: &'a mut Lane,
}

impl Sweep for Compression<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let (factor, offset) = (V::splat(self.factor), V::splat(self.offset));
        let exponent = V::splat(-self.exponent);
        for group in self.state.groups() {
            let j: V = self.state.four(Column::J, group);
            let value = factor * exp(exponent * ln(j)) - offset;
            value.store(&mut self.out[group]);
        }
    }
}
