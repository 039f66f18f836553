//! Temperature laws: heating and expansion (language.md 6.5, 7.6, 9.3).

pub mod plastic_work;

use crate::material::stages::Stages;
use crate::material::{Chunk, Thermal};
use crate::math::v4::Wide;
use crate::script::arguments::Args;
use crate::script::diagnostic::Diagnostic;
use crate::style::Style;
use std::sync::Arc;

/// Builds a temperature law from its arguments.
pub type BuildTemperature = fn(&mut Args<'_>) -> Result<Arc<dyn Temperature>, Diagnostic>;

/// All temperature styles.
pub const TEMPERATURE: &[Style<BuildTemperature>] = &[plastic_work::STYLE];

/// A temperature law.
pub trait Temperature: Send + Sync {
    /// T0 \[K\], where a solid does not say otherwise.
    fn initial(&self) -> f64;

    /// Heat capacity and conductivity.
    fn thermal(&self) -> Thermal;

    /// Adds the thermal pressure, from the bulk modulus K \[P\].
    fn add_pressure(&self, bulk: f64, chunk: &Chunk<'_>, stages: &mut Stages);

    /// Heats the particles by what the step has done, from the reference density \[M/L^d\].
    fn heat(&self, density: f64, chunk: &mut Chunk<'_>, stages: &Stages);

    /// Heating power of a particle per volume \[P/T\], from q and the rate of plastic strain.
    fn power(&self, temperature: f64, equivalent: f64, rate: f64) -> f64;
}

/// T* = (T - Tr)/(Tm - Tr), clamped to [0, 1].
#[inline(always)]
pub fn homologous<V: Wide>(temperature: V, reference: f64, melting: f64) -> V {
    let scaled = (temperature - V::splat(reference)) * V::splat(1.0 / (melting - reference));
    // The melting temperature itself counts as molten, whatever the rounding.
    let clamped = scaled.larger(V::splat(0.0)).smaller(V::splat(1.0));
    temperature.below(V::splat(melting), clamped, V::splat(1.0))
}
