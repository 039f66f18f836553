//! Strength laws: the deviator of the stress (language.md 6.5).

use crate::script::arguments::Args;
use crate::script::diagnostic::Diagnostic;
use crate::style::Style;
use std::convert::Infallible;

/// Builds a style of the family; all its names are reserved today.
pub type BuildStrength = fn(&mut Args<'_>) -> Result<Infallible, Diagnostic>;

/// All strength styles.
pub const STRENGTH: &[Style<BuildStrength>] = &[
    reserved("linear", "G", "Elastic deviator"),
    reserved("plastic", "G, sigma_y", "Perfect plasticity"),
    reserved("fluid", "mu", "Newtonian viscosity"),
    reserved("johnson_cook", "G, A, B, n, epsdot0, C, m, Tr, Tm", "Johnson-Cook flow stress"),
    reserved("swift", "G, A, B, C, n", "Swift hardening"),
];

const fn reserved(
    name: &'static str,
    usage: &'static str,
    summary: &'static str,
) -> Style<BuildStrength> {
    Style { name, usage, summary, manual: "", build: None }
}
