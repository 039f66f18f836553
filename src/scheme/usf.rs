//! Update stress first.

use super::{Parts, Scatter, Scheme, SchemeKind};
use crate::fault::Fault;
use crate::step::Stage;
use crate::style::Style;

/// The row of the table.
pub const STYLE: Style<&'static dyn Scheme> = Style {
    name: "usf",
    usage: "",
    summary: "update stress first: strains from the velocities at the start of the step",
    manual: "\
Conserves energy well without a second mapping. `velocity_nodes` acts before the strains and after
the forces; only the second time publishes. Source: Bardenhagen 2002.",
    build: Some(&Usf),
};

/// Stress from v, before the forces (language.md 7.1).
///
/// # Source  Bardenhagen 2002
pub struct Usf;

impl Scheme for Usf {
    fn kind(&self) -> SchemeKind {
        SchemeKind::Usf
    }

    fn scatter(&self) -> Scatter {
        Scatter::Motion
    }

    fn step(&self, parts: &mut Parts<'_>) -> Result<(), Fault> {
        if !parts.loops.scattered {
            parts.begin()?; //                           4 H1
            parts.points_to_grid(self.scatter()); //     5 m, v
        }
        parts.first_velocities()?; //                    v* = v, H3
        parts.stress_first()?; //                        15 F, stress; 5 f
        parts.nodal_forces()?; //                        6 H2
        parts.update_grid()?; //                         7 v*, H3
        parts.grid_to_points(false)?; //                 9-12 particles, H4, H5
        parts.advance()?; //                             x; 5 m, v of the next step
        parts.act(Stage::FinalIntegrate) //              17 H7
    }
}
