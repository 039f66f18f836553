//! Prescribed temperatures of nodes: hot and cold walls.

use super::components::Components;
use super::{BuildFix, Fix, GroupKind};
use crate::fault::Fault;
use crate::math::exact_sum::ExactSum;
use crate::model::checkpoint::Checkpoint;
use crate::model::group::GroupId;
use crate::plan::Plan;
use crate::script::arguments::Place;
use crate::script::diagnostic::{Code, Diagnostic};
use crate::script::formula::{Formula, Instant};
use crate::step::{Stage, Step};
use crate::style::Style;
use crate::world::World;

/// The row of the table.
pub const STYLE: Style<BuildFix> = Style {
    name: "temperature_nodes",
    usage: "T",
    summary: "prescribes the temperature of nodes [K] in thermo-mechanical runs",
    manual: "\
T_I <- T(t) before the heat flux is formed, T*_I <- T(t+dt) after the update (H3).
Publishes in ID_s the heating power of the step, and in ID_x the heat given so far:
per step sum C (T(t+dt) - T*) + (1-a) C (T(t) - T_I), C = sum N m cp, T_I and T* as they were
without the fix, a of `thermal_blend`: what the particles gain beyond conduction and plastic work.
Particles follow the change of T_I, and to the part 1-a per step its value: next to a wall that
differs from the initial temperature they need about 1/(1-a) steps to take it on, while the heat
flux knows it at once.",
    build: Some(|args, target| {
        target.require("temperature_nodes", &[GroupKind::Nodes])?;
        let temperature = args.formula("the temperature T", Place::Point)?;
        if !target.conducts_heat {
            let message = "`temperature_nodes` has no effect in a `mechanical` run";
            args.remarks.push(
                Diagnostic::warning(Code::NoEffect, target.span, message)
                    .label("nodes have a temperature with `thermo-mechanical` in `method`"),
            );
        }
        let temperature = Components::new(&target.id, [Some(temperature), None, None]);
        Ok(Box::new(TemperatureNodes::new(target.group, temperature)))
    }),
};

/// T_I <- T(t) before conduction, T*_I <- T(t+dt) after it.
pub struct TemperatureNodes {
    group: GroupId,
    temperature: Components,
    /// Temperatures at the start of the step, in the order of the nodes; empty until H2.
    start: Vec<f64>,
    /// Heat of the step \[M L^2/T^2\].
    given: ExactSum,
    /// Size of the step \[T\].
    dt: f64,
    /// Heat so far \[M L^2/T^2\].
    total: ExactSum,
}

impl TemperatureNodes {
    /// Prescribes a temperature to a group of nodes.
    pub fn new(group: GroupId, temperature: Components) -> Self {
        let (given, total) = Default::default();
        Self { group, temperature, start: Vec::new(), given, dt: f64::INFINITY, total }
    }

    /// T_I <- T(t).
    fn begin(&mut self, step: &mut Step<'_>) -> Result<(), Fault> {
        let now = Instant::start(&step.clock);
        let interpolated = 1.0 - step.world.thermal_blend;
        let (members, mut nodal, places) = step.world.grid.split(self.group);
        self.given.clear();
        self.dt = step.clock.dt;
        let (start, given, total) = (&mut self.start, &mut self.given, &mut self.total);
        start.clear();
        self.temperature.each(
            step.board,
            &now,
            members.iter().map(|node| *node as usize),
            |node| places.of(node),
            |node, set| {
                let set = set[0].unwrap_or(0.0);
                let [before, capacity] = nodal.temperature(node);
                if nodal.counts(node) {
                    let heat = interpolated * capacity * (set - before);
                    given.add(heat);
                    total.add(heat);
                }
                nodal.prescribe_temperature(node, set);
                start.push(set);
            },
        )
    }

    /// T*_I <- T(t+dt).
    fn end(&mut self, step: &mut Step<'_>) -> Result<(), Fault> {
        let now = Instant::end(&step.clock);
        let (members, mut nodal, places) = step.world.grid.split(self.group);
        let (given, total) = (&mut self.given, &mut self.total);
        let mut starts = self.start.drain(..);
        self.temperature.each(
            step.board,
            &now,
            members.iter().map(|node| *node as usize),
            |node| places.of(node),
            |node, set| {
                let (Some(set), Some(start)) = (set[0], starts.next()) else { return };
                let [free, capacity] = nodal.temperature(node);
                if nodal.counts(node) {
                    let heat = capacity * (set - free);
                    given.add(heat);
                    total.add(heat);
                }
                nodal.prescribe_updated_temperature(node, start, set);
            },
        )
    }
}

impl Fix for TemperatureNodes {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::PostParticlesToGrid, Stage::PostUpdateGridState]
    }

    fn needs(&self, plan: &mut Plan, dimension: usize) {
        self.temperature.needs(plan, dimension);
    }

    fn formulas(&self) -> Vec<&Formula> {
        self.temperature.formulas()
    }

    fn apply(&mut self, stage: Stage, step: &mut Step<'_>) -> Result<(), Fault> {
        match stage {
            Stage::PostParticlesToGrid => self.begin(step),
            // With `usf` H3 comes once before the heat of the step is known.
            _ if self.start.is_empty() => Ok(()),
            _ => self.end(step),
        }
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
