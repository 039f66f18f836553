//! Pressure proportional to the change of volume.

use super::{BuildEos, Eos};
use crate::material::{Chunk, Lane, State};
use crate::math::v4::{Sweep, Wide, dispatch};
use crate::model::column::Column;
use crate::style::Style;
use std::sync::Arc;

/// The row of the table.
pub const STYLE: Style<BuildEos> = Style {
    name: "linear",
    usage: "rho0, K",
    summary: "pressure proportional to the change of volume",
    manual: "\
p = K (1 - J). rho0 [M/L^d], K [P]. Stiffness in the wave speed: K.
Source: de Vaucorbeil et al. 2020.",
    build: Some(|args| {
        let density = args.positive("the density rho0")?.value;
        let bulk = args.positive("the bulk modulus K")?.value;
        Ok(Arc::new(Linear { density, bulk }))
    }),
};

/// p = K (1 - J).
///
/// # Source  language.md 9.3
#[derive(Clone, Copy, Debug)]
pub struct Linear {
    /// rho0 \[M/L^d\].
    pub density: f64,
    /// K \[P\].
    pub bulk: f64,
}

impl Eos for Linear {
    fn density(&self) -> f64 {
        self.density
    }

    fn bulk(&self) -> f64 {
        self.bulk
    }

    fn pressure(&self, chunk: &mut Chunk<'_>, _heated: bool, pressure: &mut Lane) {
        dispatch(Pressure { bulk: self.bulk, state: chunk.state, pressure });
    }

    fn stiffness(&self, state: &State, stiffness: &mut Lane) {
        stiffness[state.groups()].fill([self.bulk; 4]);
    }
}

struct Pressure<'a> {
    bulk: f64,
    state: &'a State,
    pressure: &'a mut Lane,
}

impl Sweep for Pressure<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let bulk = V::splat(self.bulk);
        for group in self.state.groups() {
            let j: V = self.state.four(Column::J, group);
            (bulk * (V::splat(1.0) - j)).store(&mut self.pressure[group]);
        }
    }
}
