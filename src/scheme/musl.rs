//! Modified update stress last: the paper's Algorithm 1.

use super::{Parts, Scheme, SchemeKind};
use crate::fault::Fault;
use crate::step::Stage;
use crate::style::Style;

/// The row of the table.
pub const STYLE: Style<&'static dyn Scheme> = Style {
    name: "musl",
    usage: "",
    summary: "modified update stress last: strains from a second mapping (default)",
    manual: "\
The new particle velocities are mapped to the grid once more; strains follow from that smoother
field. Stable where particles barely touch a node; costs a scatter and a division.
Source: Sulsky, Zhou, Schreyer 1995.",
    build: Some(&Musl),
};

/// Stress from the velocities of a second mapping (language.md 7.1).
///
/// # Source  Sulsky, Zhou, Schreyer 1995; de Vaucorbeil et al. 2020, Algorithm 1
pub struct Musl;

impl Scheme for Musl {
    fn kind(&self) -> SchemeKind {
        SchemeKind::Musl
    }

    fn step(&self, parts: &mut Parts<'_>) -> Result<(), Fault> {
        if !parts.loops.scattered {
            parts.begin()?; //                           4 H1
            parts.points_to_grid(self.scatter()); //     5 m, v, f
        }
        parts.nodal_forces()?; //                        6 H2
        parts.update_grid()?; //                         7 v*, H3
        parts.grid_to_points(true)?; //                  9-13 particles, H4, H5
        parts.second_mapping()?; //                      13-14 v, H6
        parts.stress()?; //                              15 F, stress; 5 of the next step
        parts.act(Stage::FinalIntegrate) //              17 H7
    }
}
