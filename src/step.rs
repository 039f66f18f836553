//! One step, lent to the fixes in disjoint parts.

use crate::model::clock::Clock;
use crate::script::formula::Board;
use crate::world::World;

/// The seven places of a step where a fix may act (language.md 7).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Stage {
    /// H1, before anything else.
    InitialIntegrate,
    /// H2, nodal mass, momentum and force are known: forces are added.
    PostParticlesToGrid,
    /// H3, v* is known: velocities are prescribed.
    PostUpdateGridState,
    /// H4, the particles have gathered.
    PostGridToPoint,
    /// H5, the particles have new velocities and positions.
    PostAdvanceParticles,
    /// H6, the second mapping is done: velocities are prescribed.
    PostVelocitiesToGrid,
    /// H7, the step is complete.
    FinalIntegrate,
}

impl Stage {
    /// Number of stages.
    pub const COUNT: usize = 7;
}

/// What a fix sees of a step.
pub struct Step<'a> {
    /// Step number, time at its start, dt.
    pub clock: Clock,
    /// Everything that has a place.
    pub world: &'a mut World,
    /// Results of fixes, computes and group functions.
    pub board: &'a Board,
}
