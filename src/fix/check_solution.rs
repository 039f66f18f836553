//! Error against a known displacement.

use super::components::{Components, of_particles};
use super::{BuildFix, Fix, GroupKind};
use crate::fault::Fault;
use crate::math::exact_sum::ExactSum;
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
    name: "check_solution",
    usage: "ux, uy, uz",
    summary: "compares displacements with a formula [L]",
    manual: "H7 of every step: e2 = sum V0 |u - u_exact|^2, n2 = sum V0 |u_exact|^2.
ID_s = sqrt(e2/V), ID_x = sum dt e2, ID_y = sum dt n2, ID_z = sqrt(ID_x/ID_y). NULL is not compared.",
    build: Some(|args, target| {
        target.require("check_solution", &[GroupKind::Particles, GroupKind::All])?;
        let exact = Components::read(args, target, ["ux", "uy", "uz"])?;
        Ok(Box::new(CheckSolution::new(target.group, exact)))
    }),
};

/// Accumulates the error of the displacement.
pub struct CheckSolution {
    group: GroupId,
    exact: Components,
    members: Vec<usize>,
    /// sum V0 |u - u_exact|^2 and sum V0 at the last step.
    now: ExactSum,
    volume: ExactSum,
    /// sum dt e2 and sum dt n2 so far.
    error: ExactSum,
    norm: ExactSum,
}

impl CheckSolution {
    /// Compares the particles of a group with a displacement.
    pub fn new(group: GroupId, exact: Components) -> Self {
        let (now, volume, error, norm) = Default::default();
        Self { group, exact, members: Vec::new(), now, volume, error, norm }
    }
}

impl Fix for CheckSolution {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::FinalIntegrate]
    }

    fn needs(&self, plan: &mut Plan, dimension: usize) {
        plan.columns.extend(&[Column::X0, Column::Y0, Column::Z0][..dimension]);
    }

    fn formulas(&self) -> Vec<&Formula> {
        self.exact.formulas()
    }

    fn apply(&mut self, _stage: Stage, step: &mut Step<'_>) -> Result<(), Fault> {
        let World { particles, groups, .. } = &*step.world;
        self.members.clear();
        self.members.extend(particles.of_group(groups, self.group));
        let place = of_particles(&particles.position, &particles.columns);
        self.now.clear();
        self.volume.clear();
        let dt = step.clock.dt;
        let now = Instant::end(&step.clock);
        let members = self.members.iter().copied();
        self.exact.each(step.board, &now, members, &place, |p, exact| {
            let v0 = particles.velocity[p][3];
            let (current, reference) = place(p);
            self.volume.add(v0);
            for (axis, exact) in exact.into_iter().enumerate() {
                if let Some(exact) = exact {
                    let difference = current[axis] - reference[axis] - exact;
                    let error = v0 * difference * difference;
                    self.now.add(error);
                    self.error.add(dt * error);
                    self.norm.add(dt * v0 * exact * exact);
                }
            }
        })
    }

    fn keep(&mut self, checkpoint: &mut Checkpoint) {
        checkpoint.sum("now", &mut self.now);
        checkpoint.sum("volume", &mut self.volume);
        checkpoint.sum("error", &mut self.error);
        checkpoint.sum("norm", &mut self.norm);
    }

    fn results(&self, world: &World) -> [f64; 4] {
        let sums = [&self.error, &self.norm, &self.now, &self.volume];
        let [error, norm, now, volume] = world.ranks.totals(sums);
        let root = |part: f64, of: f64| if of > 0.0 { (part / of).sqrt() } else { 0.0 };
        [error, norm, root(error, norm), root(now, volume)]
    }
}
