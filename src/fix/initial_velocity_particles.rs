//! Velocities that particles start with.

use super::components::{Components, of_particles};
use super::{BuildFix, Fix, GroupKind};
use crate::fault::Fault;
use crate::model::group::GroupId;
use crate::model::particles::Particles;
use crate::plan::Plan;
use crate::script::formula::{Formula, Instant};
use crate::step::{Stage, Step};
use crate::style::Style;
use crate::world::World;

/// The row of the table.
pub const STYLE: Style<BuildFix> = Style {
    name: "initial_velocity_particles",
    usage: "vx, vy, vz",
    summary: "sets the velocity of particles [L/T] once; NULL leaves a component alone",
    manual: "At the start of the first run after the definition, before its first dt, log row and dump.",
    build: Some(|args, target| {
        target.require("initial_velocity_particles", &[GroupKind::Particles, GroupKind::All])?;
        let velocity = Components::read(args, target, ["vx", "vy", "vz"])?;
        Ok(Box::new(InitialVelocityParticles { group: target.group, velocity }))
    }),
};

/// v <- value, once.
pub struct InitialVelocityParticles {
    /// Which particles.
    pub group: GroupId,
    /// Their velocity \[L/T\].
    pub velocity: Components,
}

impl Fix for InitialVelocityParticles {
    fn stages(&self) -> &'static [Stage] {
        &[]
    }

    fn needs(&self, plan: &mut Plan, dimension: usize) {
        self.velocity.needs(plan, dimension);
    }

    fn formulas(&self) -> Vec<&Formula> {
        self.velocity.formulas()
    }

    fn start(&mut self, step: &mut Step<'_>) -> Result<(), Fault> {
        let World { particles, groups, .. } = &mut *step.world;
        let members: Vec<usize> = particles.of_group(groups, self.group).collect();
        let Particles { position, velocity, columns, .. } = particles;
        let place = of_particles(position, columns);
        let now = Instant::start(&step.clock);
        self.velocity.each(step.board, &now, members.into_iter(), place, |p, set| {
            for (velocity, set) in velocity[p].iter_mut().zip(set) {
                *velocity = set.unwrap_or(*velocity);
            }
        })
    }
}
