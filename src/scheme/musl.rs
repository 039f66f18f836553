//! Modified update stress last: the paper's Algorithm 1.

use super::{Parts, Scheme};
use crate::fault::Fault;
use crate::kernel::tiles::Report;
use crate::step::Stage;

/// Stress from the velocities of a second mapping (language.md 7.1).
///
/// # Source  Sulsky, Zhou, Schreyer 1995; de Vaucorbeil et al. 2020, Algorithm 1
pub struct Musl;

impl Scheme for Musl {
    fn step(&self, parts: &mut Parts<'_>) -> Result<Report, Fault> {
        if !parts.loops.scattered {
            parts.begin()?; //                            4 H1
            parts.points_to_grid(); //                    5 m, v, f
        }
        parts.nodal_forces()?; //                         6 H2
        parts.update_grid(); //                           7 v*
        parts.act(Stage::PostUpdateGridState)?; //        8 H3
        parts.grid_to_points()?; //                    9-13 particles, H4, H5
        parts.second_mapping()?; //                   13-14 v, H6
        let report = parts.stress()?; //                 15 F, stress; 5 of the next step
        parts.act(Stage::FinalIntegrate)?; //            17 H7
        Ok(report)
    }
}
