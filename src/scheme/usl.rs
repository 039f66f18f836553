//! Update stress last.

use super::{Parts, Scheme, SchemeKind};
use crate::fault::Fault;
use crate::step::Stage;
use crate::style::Style;

/// The row of the table.
pub const STYLE: Style<&'static dyn Scheme> = Style {
    name: "usl",
    usage: "",
    summary: "update stress last: strains from v*, no second mapping",
    manual: "\
Dissipates a little, and is unstable where a particle barely touches a node: with hats no step is
small enough for every place of a particle in its cell (a warning says so). Splines end like hats in
the last cell before a wall of the box: there a particle that is alone, xi h from the wall, would need
a step below 2 h sqrt(xi)/c, and what approaches the wall goes wrong; bodies are held by their
neighbours. Affine transfers share this.
Source: Sulsky, Chen, Schreyer 1994.",
    build: Some(&Usl),
};

/// Stress from v*, after the particles have moved (language.md 7.1).
///
/// # Source  Sulsky, Chen, Schreyer 1994
pub struct Usl;

impl Scheme for Usl {
    fn kind(&self) -> SchemeKind {
        SchemeKind::Usl
    }

    fn step(&self, parts: &mut Parts<'_>) -> Result<(), Fault> {
        if !parts.loops.scattered {
            parts.begin()?; //                           4 H1
            parts.points_to_grid(self.scatter()); //     5 m, v, f
        }
        parts.nodal_forces()?; //                        6 H2
        parts.update_grid()?; //                         7 v*, H3
        parts.grid_to_points(false)?; //                 9-12 particles, H4, H5
        parts.keep_updated(); //                         L will follow from v*
        parts.stress()?; //                              15 F, stress; 5 of the next step
        parts.act(Stage::FinalIntegrate) //              17 H7
    }
}
