//! A given total force, shared by nodes.

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
    name: "force_nodes",
    usage: "fx, fy, fz",
    summary: "a total force [M L/T^2], split equally over the nodes of a group that have mass",
    manual: "H2: mb_I += f(x_I, t)/n over the n nodes of the group with mass.
Publishes the total force in ID_x, ID_y, ID_z.",
    build: Some(|args, target| {
        target.require("force_nodes", &[GroupKind::Nodes])?;
        let force = Components::read(args, target, ["fx", "fy", "fz"])?;
        Ok(Box::new(ForceNodes { group: target.group, force, total: VectorSum::default() }))
    }),
};

/// mb_I += f/n over the n nodes with mass.
pub struct ForceNodes {
    /// Where it acts.
    pub group: GroupId,
    /// The total force \[M L/T^2\].
    pub force: Components,
    /// Sum of the forces of the last step.
    pub total: VectorSum,
}

impl Fix for ForceNodes {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::PostParticlesToGrid]
    }

    fn needs(&self, plan: &mut Plan, dimension: usize) {
        self.force.needs(plan, dimension);
    }

    fn formulas(&self) -> Vec<&Formula> {
        self.force.formulas()
    }

    fn apply(&mut self, _stage: Stage, step: &mut Step<'_>) -> Result<(), Fault> {
        let World { grid, ranks, .. } = &mut *step.world;
        let (members, mut nodal, places) = grid.split(self.group);
        let is_heavy = |node: usize| nodal.mass(node) > 0.0 && nodal.counts(node);
        let heavy = members.iter().filter(|node| is_heavy(**node as usize)).count();
        let [heavy] = ranks.count([heavy]);
        let share = if heavy > 0 { 1.0 / heavy as f64 } else { 0.0 };
        let total = &mut self.total;
        total.clear();
        let members = members.iter().map(|node| *node as usize);
        self.force.each(
            step.board,
            &Instant::start(&step.clock),
            members,
            |node| places.of(node),
            |node, force| {
                if nodal.mass(node) > 0.0 {
                    let force = force.map(|f| share * f.unwrap_or(0.0));
                    nodal.add_force(node, force);
                    if nodal.counts(node) {
                        total.add(force);
                    }
                }
            },
        )
    }

    fn keep(&mut self, checkpoint: &mut Checkpoint) {
        checkpoint.vector("total", &mut self.total);
    }

    fn results(&self, world: &World) -> [f64; 4] {
        let [x, y, z] = world.ranks.vector(&self.total);
        [x, y, z, 0.0]
    }
}
