//! Prescribed velocities of nodes: walls, symmetry planes, moving grips.

use super::components::Components;
use super::{BuildFix, Fix, GroupKind};
use crate::fault::Fault;
use crate::math::exact_sum::VectorSum;
use crate::model::checkpoint::Checkpoint;
use crate::model::group::GroupId;
use crate::plan::Plan;
use crate::script::formula::{Formula, Instant};
use crate::step::{Stage, Step};
use crate::style::Style;
use crate::world::World;

/// The row of the table.
pub const STYLE: Style<BuildFix> = Style {
    name: "velocity_nodes",
    usage: "vx, vy, vz",
    summary: "prescribes the velocity of nodes [L/T]; NULL leaves a component free",
    manual: "H3: v <- v(t), v* <- v(t+dt). H6: v <- v(t+dt).
Publishes the reaction sum m (v_set - v*)/dt in ID_x, ID_y, ID_z: what it takes to stop the nodes.
With PIC and affine transfers the body gets it to the last digit. FLIP particles take differences of
nodal velocities alone, and keep what they carry towards a wall: as long as they do, they get less
than is published; at rest the two are the same.",
    build: Some(|args, target| {
        target.require("velocity_nodes", &[GroupKind::Nodes])?;
        let velocity = Components::read(args, target, ["vx", "vy", "vz"])?;
        Ok(Box::new(VelocityNodes::new(target.group, velocity)))
    }),
};

/// v <- v(t), v* <- v(t+dt) after the update; v <- v(t+dt) after the second mapping.
pub struct VelocityNodes {
    group: GroupId,
    velocity: Components,
    /// Velocities at the start of the step, in the order of the nodes.
    start: Vec<[f64; 3]>,
    reaction: VectorSum,
}

impl VelocityNodes {
    /// Prescribes a velocity to a group of nodes.
    pub fn new(group: GroupId, velocity: Components) -> Self {
        Self { group, velocity, start: Vec::new(), reaction: VectorSum::default() }
    }

    fn prescribe(&mut self, step: &mut Step<'_>) -> Result<(), Fault> {
        let (begin, end) = (Instant::start(&step.clock), Instant::end(&step.clock));
        let (members, mut nodal, places) = step.world.grid.split(self.group);
        let members = members.iter().map(|node| *node as usize);
        let start = &mut self.start;
        start.clear();
        self.velocity.each(
            step.board,
            &begin,
            members.clone(),
            |node| places.of(node),
            |_, velocity| {
                start.push(velocity.map(|v| v.unwrap_or(0.0)));
            },
        )?;
        let mut starts = start.iter();
        let reaction = &mut self.reaction;
        reaction.clear();
        let dt = step.clock.dt;
        self.velocity.each(
            step.board,
            &end,
            members,
            |node| places.of(node),
            |node, velocity| {
                let start = starts.next().copied().unwrap_or_default();
                let mass = nodal.mass(node);
                for axis in 0..3 {
                    if let (Some(set), true) = (velocity[axis], mass > 0.0) {
                        let free = nodal.prescribe(node, axis, start[axis], set);
                        if nodal.counts(node) {
                            reaction.0[axis].add(mass * (set - free) / dt);
                        }
                    }
                }
            },
        )
    }

    fn prescribe_mapped(&mut self, step: &mut Step<'_>) -> Result<(), Fault> {
        let end = Instant::end(&step.clock);
        let (members, mut nodal, places) = step.world.grid.split(self.group);
        let members = members.iter().map(|node| *node as usize);
        self.velocity.each(
            step.board,
            &end,
            members,
            |node| places.of(node),
            |node, velocity| {
                for (axis, velocity) in velocity.into_iter().enumerate() {
                    if let Some(velocity) = velocity {
                        nodal.prescribe_mapped(node, axis, velocity);
                    }
                }
            },
        )
    }
}

impl Fix for VelocityNodes {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::PostUpdateGridState, Stage::PostVelocitiesToGrid]
    }

    fn needs(&self, plan: &mut Plan, dimension: usize) {
        self.velocity.needs(plan, dimension);
    }

    fn formulas(&self) -> Vec<&Formula> {
        self.velocity.formulas()
    }

    fn apply(&mut self, stage: Stage, step: &mut Step<'_>) -> Result<(), Fault> {
        match stage {
            Stage::PostUpdateGridState => self.prescribe(step),
            _ => self.prescribe_mapped(step),
        }
    }

    fn keep(&mut self, checkpoint: &mut Checkpoint) {
        checkpoint.vector("reaction", &mut self.reaction);
    }

    fn results(&self, world: &World) -> [f64; 4] {
        let [x, y, z] = world.ranks.vector(&self.reaction);
        [x, y, z, 0.0]
    }
}
