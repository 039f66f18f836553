//! Newtonian viscosity.

use super::{BuildStrength, Strength};
use crate::material::Chunk;
use crate::material::stages::{Stages, viscous};
use crate::model::column::Column;
use crate::style::Style;
use std::sync::Arc;

/// The row of the table.
pub const STYLE: Style<BuildStrength> = Style {
    name: "fluid",
    usage: "mu",
    summary: "Newtonian viscosity",
    manual: "\
s = 2 mu dev D. mu >= 0 [P T]. The time step stays below 3 rho h^2/(8 d mu), d the dimension.
Source: de Vaucorbeil et al. 2020, eq. 2.17.",
    build: Some(|args| {
        let viscosity = args.within("the viscosity mu", 0.0, f64::INFINITY)?.value;
        Ok(Arc::new(Fluid { viscosity }))
    }),
};

/// s = 2 mu dev D.
///
/// # Source  de Vaucorbeil et al. 2020, eq. 2.17
#[derive(Clone, Copy, Debug)]
pub struct Fluid {
    /// mu \[P T\].
    pub viscosity: f64,
}

impl Strength for Fluid {
    fn shear(&self) -> f64 {
        0.0
    }

    fn viscosity(&self) -> f64 {
        self.viscosity
    }

    fn columns(&self) -> &'static [Column] {
        &[]
    }

    fn deviator(&self, _damaged: bool, chunk: &mut Chunk<'_>, stages: &mut Stages) {
        viscous(self.viscosity, chunk, stages);
    }
}
