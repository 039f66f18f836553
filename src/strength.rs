//! Strength laws: the deviator of the stress (language.md 6.5, 9.3).

pub mod flow;
pub mod fluid;
pub mod johnson_cook;
pub mod linear;
pub mod linear_flow;
pub mod plastic;
pub mod swift;

use crate::material::Chunk;
use crate::material::stages::Stages;
use crate::model::column::Column;
use crate::script::arguments::Args;
use crate::script::diagnostic::Diagnostic;
use crate::style::Style;
use std::sync::Arc;

/// Builds a strength law from its arguments.
pub type BuildStrength = fn(&mut Args<'_>) -> Result<Arc<dyn Strength>, Diagnostic>;

/// All strength styles.
pub const STRENGTH: &[Style<BuildStrength>] =
    &[linear::STYLE, plastic::STYLE, fluid::STYLE, johnson_cook::STYLE, swift::STYLE];

/// A strength law.
pub trait Strength: Send + Sync {
    /// Shear modulus G \[P\]; 0 for fluids.
    fn shear(&self) -> f64;

    /// Viscosity mu \[P T\].
    fn viscosity(&self) -> f64 {
        0.0
    }

    /// Columns of the law's own state.
    fn columns(&self) -> &'static [Column];

    /// Does the flow stress depend on the temperature?
    fn reads_temperature(&self) -> bool {
        false
    }

    /// Stress columns <- the deviator s at the end of the step; q and dep into the stages. With a
    /// damage law all stiffness and strength is that of the intact part 1 - D.
    fn deviator(&self, damaged: bool, chunk: &mut Chunk<'_>, stages: &mut Stages);
}
