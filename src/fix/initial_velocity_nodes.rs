//! Velocities that nodes have in the first step.

use super::components::Components;
use super::{BuildFix, Fix, GroupKind};
use crate::fault::Fault;
use crate::model::checkpoint::Checkpoint;
use crate::model::group::GroupId;
use crate::plan::Plan;
use crate::script::formula::{Formula, Instant};
use crate::step::{Stage, Step};
use crate::style::Style;

/// The row of the table.
pub const STYLE: Style<BuildFix> = Style {
    name: "initial_velocity_nodes",
    usage: "vx, vy, vz",
    summary: "sets the velocity of nodes [L/T] in one step; NULL leaves a component alone",
    manual: "In the first step after the definition. H3: v* <- value. H6: v <- value.",
    build: Some(|args, target| {
        target.require("initial_velocity_nodes", &[GroupKind::Nodes, GroupKind::All])?;
        let velocity = Components::read(args, target, ["vx", "vy", "vz"])?;
        Ok(Box::new(InitialVelocityNodes::new(target.group, velocity)))
    }),
};

/// v* <- value and v <- value, in one step.
pub struct InitialVelocityNodes {
    group: GroupId,
    velocity: Components,
    /// The one step in which it acts.
    acts_in: Option<u64>,
}

impl InitialVelocityNodes {
    /// Gives nodes a velocity in the coming step.
    pub fn new(group: GroupId, velocity: Components) -> Self {
        Self { group, velocity, acts_in: None }
    }
}

impl Fix for InitialVelocityNodes {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::PostUpdateGridState, Stage::PostVelocitiesToGrid]
    }

    fn needs(&self, plan: &mut Plan, dimension: usize) {
        self.velocity.needs(plan, dimension);
    }

    fn formulas(&self) -> Vec<&Formula> {
        self.velocity.formulas()
    }

    fn keep(&mut self, checkpoint: &mut Checkpoint) {
        checkpoint.option("acts_in", &mut self.acts_in);
    }

    fn apply(&mut self, stage: Stage, step: &mut Step<'_>) -> Result<(), Fault> {
        if *self.acts_in.get_or_insert(step.clock.step) != step.clock.step {
            return Ok(());
        }
        let updated = stage == Stage::PostUpdateGridState;
        let (members, mut nodal, places) = step.world.grid.split(self.group);
        let members = members.iter().map(|node| *node as usize);
        let now = Instant::start(&step.clock);
        self.velocity.each(
            step.board,
            &now,
            members,
            |node| places.of(node),
            |node, set| {
                for (axis, set) in set.into_iter().enumerate() {
                    match set {
                        Some(set) if updated && nodal.mass(node) > 0.0 => {
                            nodal.prescribe_updated(node, axis, set);
                        }
                        Some(set) if !updated => nodal.prescribe_mapped(node, axis, set),
                        _ => {}
                    }
                }
            },
        )
    }
}
