//! A force per mass.

use super::components::{Components, of_particles};
use super::{BuildFix, Fix, GroupKind};
use crate::fault::Fault;
use crate::math::exact_sum::VectorSum;
use crate::model::checkpoint::Checkpoint;
use crate::model::column::Column;
use crate::model::group::GroupId;
use crate::plan::Plan;
use crate::script::formula::{Formula, Instant};
use crate::step::{Stage, Step};
use crate::style::Style;
use crate::world::World;

/// The row of the table.
pub const STYLE: Style<BuildFix> = Style {
    name: "body_force",
    usage: "fx, fy, fz",
    summary: "a force per mass [L/T^2], for example gravity",
    manual:
        "Nodes and `all`, at H2: mb_I += m_I f(x_I, t). Particles, at H1: mb_p += m_p f(x_p, t).
Publishes the total force in ID_x, ID_y, ID_z.",
    build: Some(|args, target| {
        let force = Components::read(args, target, ["fx", "fy", "fz"])?;
        let on_particles = target.kind == GroupKind::Particles;
        Ok(Box::new(BodyForce {
            group: target.group,
            on_particles,
            force,
            total: VectorSum::default(),
            members: Vec::new(),
        }))
    }),
};

/// mb_I += m_I f, or mb_p += m_p f on a group of particles.
pub struct BodyForce {
    /// Where it acts.
    pub group: GroupId,
    /// It acts on particles, not on nodes.
    pub on_particles: bool,
    /// f \[L/T^2\].
    pub force: Components,
    /// Sum of the forces of the last step.
    pub total: VectorSum,
    /// Memory for the particles of the group.
    pub members: Vec<usize>,
}

impl Fix for BodyForce {
    fn stages(&self) -> &'static [Stage] {
        if self.on_particles { &[Stage::InitialIntegrate] } else { &[Stage::PostParticlesToGrid] }
    }

    fn needs(&self, plan: &mut Plan, dimension: usize) {
        self.force.needs(plan, dimension);
        if self.on_particles {
            plan.columns.extend(&FORCE[..dimension]);
        }
    }

    fn formulas(&self) -> Vec<&Formula> {
        self.force.formulas()
    }

    fn apply(&mut self, _stage: Stage, step: &mut Step<'_>) -> Result<(), Fault> {
        let now = Instant::start(&step.clock);
        self.total.clear();
        match self.on_particles {
            true => self.push_particles(step, &now),
            false => self.push_nodes(step, &now),
        }
    }

    fn constant_acceleration(&self) -> Option<f64> {
        let parts = self.force.formulas().into_iter().map(Formula::as_constant);
        let squares = parts.map(|part| part.map(|f| f * f)).sum::<Option<f64>>()?;
        Some(squares.sqrt())
    }

    fn keep(&mut self, checkpoint: &mut Checkpoint) {
        checkpoint.vector("total", &mut self.total);
    }

    fn results(&self, world: &World) -> [f64; 4] {
        let [x, y, z] = world.ranks.vector(&self.total);
        [x, y, z, 0.0]
    }
}

impl BodyForce {
    fn push_nodes(&mut self, step: &mut Step<'_>, now: &Instant) -> Result<(), Fault> {
        let total = &mut self.total;
        let (members, mut nodal, places) = step.world.grid.split(self.group);
        let members = members.iter().map(|node| *node as usize);
        self.force.each(
            step.board,
            now,
            members,
            |node| places.of(node),
            |node, force| {
                let mass = nodal.mass(node);
                let force = force.map(|f| mass * f.unwrap_or(0.0));
                nodal.add_force(node, force);
                if nodal.counts(node) {
                    total.add(force);
                }
            },
        )
    }

    fn push_particles(&mut self, step: &mut Step<'_>, now: &Instant) -> Result<(), Fault> {
        let total = &mut self.total;
        let World { particles, groups, .. } = &mut *step.world;
        self.members.clear();
        self.members.extend(particles.of_group(groups, self.group));
        let (reference, others) = particles.columns.split_at_mut(REFERENCE);
        let places = &particles.position;
        let members = self.members.iter().copied();
        self.force.each(step.board, now, members, of_particles(places, reference), |p, force| {
            let force = force.map(|f| places[p][3] * f.unwrap_or(0.0));
            for (column, force) in FORCE.into_iter().zip(force) {
                if let Some(sum) = others[column as usize - REFERENCE].get_mut(p) {
                    *sum += force;
                }
            }
            total.add(force);
        })
    }
}

/// Number of columns of reference positions, the first ones of the table.
const REFERENCE: usize = Column::Z0 as usize + 1;

const FORCE: [Column; 3] = [Column::Bx, Column::By, Column::Bz];
