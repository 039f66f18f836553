//! Prescribed temperatures of particles.

use super::components::{Components, of_particles};
use super::{BuildFix, Fix, GroupKind};
use crate::fault::Fault;
use crate::math::exact_sum::ExactSum;
use crate::model::checkpoint::Checkpoint;
use crate::model::column::Column;
use crate::model::group::GroupId;
use crate::model::particles::Particles;
use crate::plan::Plan;
use crate::script::arguments::Place;
use crate::script::formula::{Formula, Instant};
use crate::step::{Stage, Step};
use crate::style::Style;
use crate::world::World;

/// The row of the table.
pub const STYLE: Style<BuildFix> = Style {
    name: "temperature_particles",
    usage: "T",
    summary: "prescribes the temperature of particles [K]",
    manual: "\
H1: T <- T(t). H5: T <- T(t+dt). Publishes in ID_s the heating power of the step, and in ID_x the
heat given so far: per step the sum of m cp (T_set - T) over both, with the cp of the materials that
have one.",
    build: Some(|args, target| {
        target.require("temperature_particles", &[GroupKind::Particles])?;
        let temperature = args.formula("the temperature T", Place::Point)?;
        let temperature = Components::new(&target.id, [Some(temperature), None, None]);
        Ok(Box::new(TemperatureParticles::new(target.group, temperature)))
    }),
};

/// T <- T(t) at the start of a step; T <- T(t+dt) at its end.
pub struct TemperatureParticles {
    group: GroupId,
    temperature: Components,
    members: Vec<usize>,
    /// Heat of the step \[M L^2/T^2\].
    given: ExactSum,
    /// Size of the step \[T\].
    dt: f64,
    /// Heat so far \[M L^2/T^2\].
    total: ExactSum,
}

impl TemperatureParticles {
    /// Prescribes a temperature to a group of particles.
    pub fn new(group: GroupId, temperature: Components) -> Self {
        let (given, total) = Default::default();
        Self { group, temperature, members: Vec::new(), given, dt: f64::INFINITY, total }
    }
}

impl Fix for TemperatureParticles {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::InitialIntegrate, Stage::PostAdvanceParticles]
    }

    fn needs(&self, plan: &mut Plan, dimension: usize) {
        plan.columns.insert(Column::Temperature);
        self.temperature.needs(plan, dimension);
    }

    fn formulas(&self) -> Vec<&Formula> {
        self.temperature.formulas()
    }

    fn apply(&mut self, stage: Stage, step: &mut Step<'_>) -> Result<(), Fault> {
        let World { particles, groups, solids, .. } = &mut *step.world;
        self.members.clear();
        self.members.extend(particles.of_group(groups, self.group));
        let now = match stage {
            Stage::InitialIntegrate => Instant::start(&step.clock),
            _ => Instant::end(&step.clock),
        };
        let mut temperature = std::mem::take(&mut particles.columns[Column::Temperature as usize]);
        let Particles { position, columns, solid, .. } = &*particles;
        if stage == Stage::InitialIntegrate {
            self.given.clear();
        }
        self.dt = step.clock.dt;
        let (given, total) = (&mut self.given, &mut self.total);
        let done = self.temperature.each(
            step.board,
            &now,
            self.members.iter().copied(),
            of_particles(position, columns),
            |p, set| {
                if let (Some(set), Some(value)) = (set[0], temperature.get_mut(p)) {
                    let capacity = solids[solid[p] as usize].law.thermal().capacity;
                    let heat = position[p][3] * capacity * (set - *value);
                    given.add(heat);
                    total.add(heat);
                    *value = set;
                }
            },
        );
        particles.columns[Column::Temperature as usize] = temperature;
        done
    }

    fn keep(&mut self, checkpoint: &mut Checkpoint) {
        checkpoint.sum("given", &mut self.given);
        checkpoint.number("dt", &mut self.dt);
        checkpoint.sum("total", &mut self.total);
    }

    fn results(&self, world: &World) -> [f64; 4] {
        let [total, given] = world.ranks.totals([&self.total, &self.given]);
        [total, 0.0, 0.0, given / self.dt]
    }
}
