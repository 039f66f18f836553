//! What this scene needs: the union over its styles, outputs and formulas.

use crate::model::column::ColumnSet;
use crate::step::Stage;

/// What `watch` takes for trouble: bounds on particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trouble {
    /// J lies between one over this and this.
    pub volume: f64,
    /// |v| over the wave speed of the undeformed material.
    pub speed: f64,
    /// dt ||L||: the strain of one step.
    pub strain: f64,
}

impl Default for Trouble {
    fn default() -> Self {
        Self { volume: 1e3, speed: 50.0, strain: 0.7 }
    }
}

/// Bounds on the error of the energy ledger at the rows of the log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alarm {
    /// A larger one is warned about once.
    pub warn_above: f64,
    /// A larger one stops the run.
    pub stop_above: f64,
}

impl Default for Alarm {
    fn default() -> Self {
        Self { warn_above: f64::INFINITY, stop_above: f64::INFINITY }
    }
}

impl Alarm {
    /// The bound that is reached first.
    pub fn smaller(self) -> f64 {
        self.warn_above.min(self.stop_above)
    }

    /// The bounds of both.
    pub fn merged(self, other: Self) -> Self {
        Self {
            warn_above: self.warn_above.min(other.warn_above),
            stop_above: self.stop_above.min(other.stop_above),
        }
    }
}

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
    /// Particles are watched.
    pub trouble: Option<Trouble>,
    /// Bounds on the error of the energy ledger.
    pub alarm: Alarm,
    /// A fix makes particles of two solids touch.
    pub contact: bool,
    /// The wave speed of each particle is needed (dt is adaptive).
    pub wave_speed: bool,
    /// x is a radius.
    pub axisymmetric: bool,
}
