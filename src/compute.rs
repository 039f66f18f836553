//! Computes: numbers about particles, evaluated when read (language.md 6.7).

pub mod angular_momentum;
pub mod average_stress;
pub mod average_temperature;
pub mod average_velocity;
pub mod energy;
pub mod energy_ledger;
pub mod max_plastic_strain;
pub mod max_position;

use crate::fix::Target;
use crate::plan::Plan;
use crate::script::arguments::Args;
use crate::script::diagnostic::Diagnostic;
use crate::style::Style;
use crate::world::World;

/// A number or a few about the particles of a group.
pub trait Compute: Send {
    /// Suffixes of the published names: `""` publishes `ID` itself, `"_x"` publishes `ID_x`.
    fn suffixes(&self) -> &'static [&'static str];

    /// What it needs of the scene.
    fn needs(&self, _plan: &mut Plan, _dimension: usize) {}

    /// The values, in the order of the suffixes.
    fn evaluate(&self, world: &World, out: &mut [f64]);
}

/// Builds a compute from its arguments.
pub type BuildCompute = fn(&mut Args<'_>, &Target) -> Result<Box<dyn Compute>, Diagnostic>;

/// All compute styles.
pub const COMPUTES: &[Style<BuildCompute>] = &[
    energy::KINETIC,
    energy::STRAIN,
    average_velocity::STYLE,
    max_plastic_strain::STYLE,
    angular_momentum::STYLE,
    max_position::STYLE,
    average_stress::STYLE,
    average_temperature::STYLE,
    energy_ledger::STYLE,
];
