//! Damage laws (language.md 6.5).

use crate::script::arguments::Args;
use crate::script::diagnostic::Diagnostic;
use crate::style::Style;
use std::convert::Infallible;

/// Builds a style of the family; all its names are reserved today.
pub type BuildDamage = fn(&mut Args<'_>) -> Result<Infallible, Diagnostic>;

/// All damage styles.
pub const DAMAGE: &[Style<BuildDamage>] = &[reserved(
    "damage_johnson_cook",
    "d1, d2, d3, d4, d5, epsdot0, Tr, Tm",
    "Johnson-Cook failure strain",
)];

const fn reserved(
    name: &'static str,
    usage: &'static str,
    summary: &'static str,
) -> Style<BuildDamage> {
    Style { name, usage, summary, manual: "", build: None }
}
