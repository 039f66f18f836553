//! Damage laws (language.md 6.5, 9.3).

pub mod damage_johnson_cook;

use crate::material::Chunk;
use crate::material::stages::Stages;
use crate::script::arguments::Args;
use crate::script::diagnostic::Diagnostic;
use crate::style::Style;
use std::sync::Arc;

/// Builds a damage law from its arguments.
pub type BuildDamage = fn(&mut Args<'_>) -> Result<Arc<dyn Damage>, Diagnostic>;

/// All damage styles.
pub const DAMAGE: &[Style<BuildDamage>] = &[damage_johnson_cook::STYLE];

/// A damage law.
pub trait Damage: Send + Sync {
    /// Does it depend on the temperature?
    fn reads_temperature(&self) -> bool;

    /// Lets the columns of the damage D and of its initiation grow with the plastic strain of the
    /// step. The equivalent stress of a particle that fails becomes 0.
    fn grow(&self, chunk: &mut Chunk<'_>, stages: &mut Stages);
}
