//! Equations of state: pressure from density and energy (language.md 6.5, 9.3).

pub mod fluid;
pub mod linear;
pub mod shock;

use crate::material::{Chunk, Lane, State};
use crate::script::arguments::Args;
use crate::script::diagnostic::Diagnostic;
use crate::style::Style;
use std::sync::Arc;

/// Builds an equation of state from its arguments.
pub type BuildEos = fn(&mut Args<'_>) -> Result<Arc<dyn Eos>, Diagnostic>;

/// All eos styles.
pub const EOS: &[Style<BuildEos>] = &[linear::STYLE, shock::STYLE, fluid::STYLE];

/// An equation of state.
pub trait Eos: Send + Sync {
    /// Reference density rho0 \[M/L^d\].
    fn density(&self) -> f64;

    /// Bulk modulus K \[P\] of the undeformed material as the script gives it.
    fn bulk(&self) -> f64;

    /// Pressure p \[P\] of the volume ratio J, and of the temperature if the material is `heated`
    /// by a temperature law.
    fn pressure(&self, chunk: &mut Chunk<'_>, heated: bool, pressure: &mut Lane);

    /// Tangent bulk modulus K_t \[P\] for wave speeds.
    fn stiffness(&self, state: &State, stiffness: &mut Lane);

    /// Artificial viscosity in compression, if there is any.
    fn viscosity(&self) -> Option<Viscosity> {
        None
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
