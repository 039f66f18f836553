//! Temperature laws: heating, conduction, expansion (language.md 6.5).

use crate::script::arguments::Args;
use crate::script::diagnostic::Diagnostic;
use crate::style::Style;
use std::convert::Infallible;

/// Builds a style of the family; all its names are reserved today.
pub type BuildTemperature = fn(&mut Args<'_>) -> Result<Infallible, Diagnostic>;

/// All temperature styles.
pub const TEMPERATURE: &[Style<BuildTemperature>] =
    &[reserved("plastic_work", "chi, cp, kappa, alpha, T0, Tm", "Heat from plastic work")];

const fn reserved(
    name: &'static str,
    usage: &'static str,
    summary: &'static str,
) -> Style<BuildTemperature> {
    Style { name, usage, summary, manual: "", build: None }
}
