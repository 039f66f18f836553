//! What this scene needs: the union over its styles, outputs and formulas.

use crate::model::column::ColumnSet;
use crate::step::Stage;

/// Effects that are on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Plan {
    /// Optional particle columns.
    pub columns: ColumnSet,
    /// Stages at which some fix acts.
    pub stages: [bool; Stage::COUNT],
    /// Nodal external forces are kept apart from internal ones.
    pub external_force: bool,
    /// Something reads places of nodes, which move in total Lagrangian methods.
    pub node_places: bool,
    /// Something reads the energy ledger.
    pub ledger: bool,
    /// A fix makes particles of two solids touch.
    pub contact: bool,
    /// The wave speed of each particle is needed (dt is adaptive).
    pub wave_speed: bool,
    /// x is a radius.
    pub axisymmetric: bool,
}
