//! Equations of state: pressure from density and energy (language.md 6.5, 9.3).

pub mod fluid;
pub mod ideal_gas;
pub mod linear;
pub mod shock;

use crate::material::stages::{Stages, stiffen};
use crate::material::{Chunk, Lane, State};
use crate::model::column::Column;
use crate::script::arguments::Args;
use crate::script::diagnostic::Diagnostic;
use crate::style::Style;
use std::sync::Arc;

/// Builds an equation of state from its arguments.
pub type BuildEos = fn(&mut Args<'_>) -> Result<Arc<dyn Eos>, Diagnostic>;

/// All eos styles.
pub const EOS: &[Style<BuildEos>] = &[linear::STYLE, shock::STYLE, fluid::STYLE, ideal_gas::STYLE];

/// An equation of state.
pub trait Eos: Send + Sync {
    /// Reference density rho0 \[M/L^d\].
    fn density(&self) -> f64;

    /// Bulk modulus K \[P\] of the undeformed material as the script gives it.
    fn bulk(&self) -> f64;

    /// Internal energy E \[P\] per reference volume of a new particle, if the law advances it (column
    /// `ienergy`). Such a law takes up what the deviator dissipates, and adds its own viscosity.
    fn initial_energy(&self) -> Option<f64> {
        None
    }

    /// Pressure \[P\] of a new particle.
    fn initial_pressure(&self) -> f64 {
        0.0
    }

    /// Pressure p \[P\] of the volume ratio J, and of the temperature if the material is `heated`
    /// by a temperature law. A law that advances its energy does so here.
    fn pressure(&self, chunk: &mut Chunk<'_>, heated: bool, pressure: &mut Lane);

    /// Tangent bulk modulus K_t \[P\] for wave speeds.
    fn stiffness(&self, state: &State, stiffness: &mut Lane);

    /// Artificial viscosity in compression, if there is any.
    fn viscosity(&self) -> Option<Viscosity> {
        None
    }

    /// Does artificial viscosity act in compression?
    fn is_viscous(&self) -> bool {
        self.viscosity().is_some()
    }

    /// Adds to the internal energy, and to the pressure, what the deviator has dissipated in the
    /// step: plastic work and that of a viscosity \[P T\].
    fn absorb(&self, _viscosity: f64, _chunk: &mut Chunk<'_>, _stages: &mut Stages) {}

    /// Raises wave speeds \[L/T\] by what artificial viscosity asks for.
    fn stiffen(&self, chunk: &Chunk<'_>, speed: &mut Lane) {
        if let Some(viscosity) = self.viscosity() {
            stiffen(viscosity, chunk, speed);
        }
    }

    /// Artificial viscosity \[P\] of particle `p` at the end of a step.
    fn viscous_pressure(&self, chunk: &Chunk<'_>, p: usize) -> f64 {
        self.viscosity().map_or(0.0, |viscosity| {
            let trace = chunk.velocity_gradient(p).trace();
            viscosity.pressure(self.density(), chunk.cell, chunk.state.value(Column::J, p), trace)
        })
    }

    /// Internal energy e of the temperature \[P\].
    fn energy(&self, _temperature: f64) -> f64 {
        0.0
    }
}

/// Artificial viscosity: p += rho h (Q1 h tr^2 D - Q2 c0 sqrt(J) tr D) where tr D < 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viscosity {
    /// Q1.
    pub quadratic: f64,
    /// Q2.
    pub linear: f64,
    /// c0 \[L/T\].
    pub sound: f64,
}

impl Viscosity {
    /// The pressure \[P\] of one particle, from rho0, h, J and tr D.
    pub fn pressure(&self, density: f64, cell: f64, j: f64, trace: f64) -> f64 {
        let rate = (-trace).max(0.0);
        let speed = self.quadratic * cell * rate + self.linear * self.sound * j.sqrt();
        density / j * cell * rate * speed
    }
}
