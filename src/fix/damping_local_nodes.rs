//! Local damping of nodes, for static states.

use super::damping_nodes::Taken;
use super::{BuildFix, Fix, GroupKind};
use crate::fault::Fault;
use crate::model::checkpoint::Checkpoint;
use crate::model::group::GroupId;
use crate::step::{Stage, Step};
use crate::style::Style;
use crate::world::World;

/// The row of the table.
pub const STYLE: Style<BuildFix> = Style {
    name: "damping_local_nodes",
    usage: "beta",
    summary: "local damping of nodes: a force -beta |f + mb| sign(v) on each axis",
    manual: "\
H2: mb_I -= beta |f_I + mb_I| sign(v_I), axis by axis, 0 <= beta < 1, with the forces known so far:
define it below the fixes that bring the other forces. It vanishes where forces balance, so the
static state is exact (what a fix then holds a node with includes the damping there), and does not depend on mass or frequency: each vibration loses about
4 beta of its energy per period. Its losses stand in the energy ledger (`W_damping`).
Publishes the total force in ID_x, ID_y, ID_z, the energy taken so far in ID_s.
Source: Cundall 1987.",
    build: Some(|args, target| {
        target.require("damping_local_nodes", &[GroupKind::Nodes, GroupKind::All])?;
        let factor = args.within("the damping factor beta", 0.0, 1.0)?;
        if factor.value == 1.0 {
            return Err(args.out_of_range(&factor, "the damping factor beta must be less than 1"));
        }
        let (group, factor) = (target.group, factor.value);
        Ok(Box::new(DampingLocalNodes { group, factor, taken: Taken::default() }))
    }),
};

/// mb_I -= beta |f_I + mb_I| sign(v_I).
pub struct DampingLocalNodes {
    group: GroupId,
    /// beta.
    factor: f64,
    taken: Taken,
}

impl Fix for DampingLocalNodes {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::PostParticlesToGrid]
    }

    fn apply(&mut self, _stage: Stage, step: &mut Step<'_>) -> Result<(), Fault> {
        let World { grid, ledger, .. } = &mut *step.world;
        let (members, mut nodal, _) = grid.split(self.group);
        self.taken.begin();
        for node in members.iter().map(|node| *node as usize) {
            let (total, velocity) = (nodal.force(node), nodal.velocity(node));
            let force = std::array::from_fn(|axis| match velocity[axis] {
                v if v > 0.0 => -self.factor * total[axis].abs(),
                v if v < 0.0 => self.factor * total[axis].abs(),
                _ => 0.0,
            });
            nodal.add_force(node, force);
            ledger.add_damping(node, force);
            if nodal.counts(node) {
                self.taken.add(force, velocity, step.clock.dt);
            }
        }
        Ok(())
    }

    fn keep(&mut self, checkpoint: &mut Checkpoint) {
        self.taken.keep(checkpoint);
    }

    fn results(&self, world: &World) -> [f64; 4] {
        self.taken.results(&world.ranks)
    }
}
