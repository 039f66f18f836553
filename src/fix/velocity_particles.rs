//! Prescribed velocities of particles.

use super::components::{Components, of_particles};
use super::{BuildFix, Fix, GroupKind};
use crate::fault::Fault;
use crate::math::exact_sum::VectorSum;
use crate::model::checkpoint::Checkpoint;
use crate::model::group::GroupId;
use crate::model::particles::Particles;
use crate::plan::Plan;
use crate::script::formula::{Formula, Instant};
use crate::step::{Stage, Step};
use crate::style::Style;
use crate::world::World;

/// The row of the table.
pub const STYLE: Style<BuildFix> = Style {
    name: "velocity_particles",
    usage: "vx, vy, vz",
    summary: "prescribes the velocity of particles [L/T]; NULL leaves a component free",
    manual: "H1: v <- v(t). H5: v <- v(t+dt), x <- x_old + dt v.
Publishes the force needed, sum m (v_set - v)/dt, in ID_x, ID_y, ID_z; for particles of rigid bodies
less the force of the material on them.",
    build: Some(|args, target| {
        target.require("velocity_particles", &[GroupKind::Particles])?;
        let velocity = Components::read(args, target, ["vx", "vy", "vz"])?;
        Ok(Box::new(VelocityParticles::new(target.group, velocity)))
    }),
};

/// v <- v(t) at the start of a step; v <- v(t+dt), dx <- dt v at its end.
pub struct VelocityParticles {
    group: GroupId,
    velocity: Components,
    members: Vec<usize>,
    force: VectorSum,
}

impl VelocityParticles {
    /// Prescribes a velocity to a group of particles.
    pub fn new(group: GroupId, velocity: Components) -> Self {
        Self { group, velocity, members: Vec::new(), force: VectorSum::default() }
    }
}

impl Fix for VelocityParticles {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::InitialIntegrate, Stage::PostAdvanceParticles]
    }

    fn needs(&self, plan: &mut Plan, dimension: usize) {
        self.velocity.needs(plan, dimension);
    }

    fn formulas(&self) -> Vec<&Formula> {
        self.velocity.formulas()
    }

    fn apply(&mut self, stage: Stage, step: &mut Step<'_>) -> Result<(), Fault> {
        let World { particles, groups, rigid, .. } = &mut *step.world;
        self.members.clear();
        self.members.extend(particles.of_group(groups, self.group));
        let members = self.members.iter().copied();
        let dt = step.clock.dt;
        let Particles { position, velocity, displacement, columns, .. } = particles;
        let place = of_particles(position, columns);
        if stage == Stage::InitialIntegrate {
            let now = Instant::start(&step.clock);
            return self.velocity.each(step.board, &now, members, place, |p, set| {
                for (velocity, set) in velocity[p].iter_mut().zip(set) {
                    *velocity = set.unwrap_or(*velocity);
                }
            });
        }
        let now = Instant::end(&step.clock);
        let force = &mut self.force;
        force.clear();
        self.velocity.each(step.board, &now, members, place, |p, set| {
            let reaction = rigid.reaction(p);
            for (axis, set) in set.into_iter().enumerate() {
                if let Some(set) = set {
                    let change = set - velocity[p][axis];
                    force.0[axis].add(position[p][3] * change / dt - reaction[axis]);
                    velocity[p][axis] = set;
                    displacement[p][axis] = dt * set;
                }
            }
        })
    }

    fn keep(&mut self, checkpoint: &mut Checkpoint) {
        checkpoint.vector("force", &mut self.force);
    }

    fn results(&self, world: &World) -> [f64; 4] {
        let [x, y, z] = world.ranks.vector(&self.force);
        [x, y, z, 0.0]
    }
}
