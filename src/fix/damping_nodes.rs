//! Viscous damping of nodes.

use super::components::Components;
use super::{BuildFix, Fix, GroupKind};
use crate::fault::Fault;
use crate::math::exact_sum::{ExactSum, VectorSum};
use crate::model::checkpoint::Checkpoint;
use crate::model::group::GroupId;
use crate::parallel::Ranks;
use crate::plan::Plan;
use crate::script::arguments::Place;
use crate::script::diagnostic::{Code, Diagnostic};
use crate::script::formula::{Formula, Instant};
use crate::step::{Stage, Step};
use crate::style::Style;
use crate::world::World;

/// The row of the table.
pub const STYLE: Style<BuildFix> = Style {
    name: "damping_nodes",
    usage: "c",
    summary: "viscous damping of nodes: a force -c m v, c [1/T]",
    manual: "\
H2: mb_I -= c m_I v_I with c a formula of time and place, at least 0; v_I as the particles give it.
A vibration of circular frequency omega dies as exp(-c t/2); 2 omega is critical. Rigid motion dies
too, as exp(-c t). Stable for c dt < 2. Its losses stand in the energy ledger (`W_damping`).
Publishes the total force in ID_x, ID_y, ID_z, the energy taken so far in ID_s.",
    build: Some(|args, target| {
        target.require("damping_nodes", &[GroupKind::Nodes, GroupKind::All])?;
        let span = args.next_span();
        let coefficient = args.formula("the damping coefficient c", Place::Point)?;
        if let Some(value) = coefficient.as_constant().filter(|value| *value < 0.0) {
            let message = "the damping coefficient c must be at least 0";
            return Err(Diagnostic::error(Code::Range, span, message).label(format!("is {value}")));
        }
        let coefficient = Components::new(&target.id, [Some(coefficient), None, None]);
        Ok(Box::new(DampingNodes { group: target.group, coefficient, taken: Taken::default() }))
    }),
};

/// What damping has taken.
#[derive(Clone, Debug, Default)]
pub struct Taken {
    /// Sum of the forces of the last step \[M L/T^2\].
    force: VectorSum,
    /// Energy so far \[M L^2/T^2\].
    energy: ExactSum,
}

impl Taken {
    /// Puts it into a checkpoint, or takes it from there.
    pub fn keep(&mut self, checkpoint: &mut Checkpoint) {
        checkpoint.vector("force", &mut self.force);
        checkpoint.sum("energy", &mut self.energy);
    }

    /// Forgets the force of the last step.
    pub fn begin(&mut self) {
        self.force.clear();
    }

    /// Notes a force on a node of this velocity.
    pub fn add(&mut self, force: [f64; 3], velocity: [f64; 3], dt: f64) {
        self.force.add(force);
        for axis in 0..3 {
            self.energy.add(-dt * force[axis] * velocity[axis]);
        }
    }

    /// The results of a fix.
    pub fn results(&self, ranks: &Ranks) -> [f64; 4] {
        let [x, y, z] = self.force.0.each_ref();
        ranks.totals([x, y, z, &self.energy])
    }
}

/// mb_I -= c m_I v_I.
pub struct DampingNodes {
    group: GroupId,
    coefficient: Components,
    taken: Taken,
}

impl Fix for DampingNodes {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::PostParticlesToGrid]
    }

    fn needs(&self, plan: &mut Plan, dimension: usize) {
        self.coefficient.needs(plan, dimension);
    }

    fn formulas(&self) -> Vec<&Formula> {
        self.coefficient.formulas()
    }

    fn apply(&mut self, _stage: Stage, step: &mut Step<'_>) -> Result<(), Fault> {
        let World { grid, ledger, .. } = &mut *step.world;
        let (members, mut nodal, places) = grid.split(self.group);
        let (taken, dt) = (&mut self.taken, step.clock.dt);
        taken.begin();
        self.coefficient.each(
            step.board,
            &Instant::start(&step.clock),
            members.iter().map(|node| *node as usize),
            |node| places.of(node),
            |node, [c, ..]| {
                let (mass, velocity) = (nodal.mass(node), nodal.velocity(node));
                let force = velocity.map(|v| -c.unwrap_or(0.0) * mass * v);
                nodal.add_force(node, force);
                ledger.add_damping(node, force);
                if nodal.counts(node) {
                    taken.add(force, velocity, dt);
                }
            },
        )
    }

    fn keep(&mut self, checkpoint: &mut Checkpoint) {
        self.taken.keep(checkpoint);
    }

    fn results(&self, world: &World) -> [f64; 4] {
        self.taken.results(&world.ranks)
    }
}
