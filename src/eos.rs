//! Equations of state: pressure from density and energy (language.md 6.5).

use crate::script::arguments::Args;
use crate::script::diagnostic::Diagnostic;
use crate::style::Style;
use std::convert::Infallible;

/// Builds a style of the family; all its names are reserved today.
pub type BuildEos = fn(&mut Args<'_>) -> Result<Infallible, Diagnostic>;

/// All eos styles.
pub const EOS: &[Style<BuildEos>] = &[
    reserved("linear", "rho0, K", "Pressure linear in the volume change"),
    reserved(
        "shock",
        "rho0, K, c0, S, Gamma, cv, Tr, Q1, Q2",
        "Mie-Grueneisen with a linear shock curve",
    ),
    reserved("fluid", "rho0, K, gamma", "Weakly compressible fluid"),
];

const fn reserved(
    name: &'static str,
    usage: &'static str,
    summary: &'static str,
) -> Style<BuildEos> {
    Style { name, usage, summary, manual: "", build: None }
}
