//! Mean temperature.

use super::{BuildCompute, Compute};
use crate::fix::GroupKind;
use crate::math::exact_sum::ExactSum;
use crate::model::column::Column;
use crate::model::group::GroupId;
use crate::style::Style;
use crate::world::World;

/// The row of the table.
pub const STYLE: Style<BuildCompute> = Style {
    name: "average_temperature",
    usage: "",
    summary: "mean temperature of a group by mass [K]",
    manual: "Publishes ID, sum m T/sum m; 0 for an empty group.",
    build: Some(|_, target| {
        target.require("average_temperature", &[GroupKind::Particles, GroupKind::All])?;
        Ok(Box::new(AverageTemperature(target.group)))
    }),
};

/// sum m T/sum m.
pub struct AverageTemperature(pub GroupId);

impl Compute for AverageTemperature {
    fn suffixes(&self) -> &'static [&'static str] {
        &[""]
    }

    fn evaluate(&self, world: &World, out: &mut [f64]) {
        let values = world.particles.column(Column::Temperature);
        let (mut heat, mut mass) = (ExactSum::default(), ExactSum::default());
        for p in world.particles.of_group(&world.groups, self.0) {
            let m = world.particles.position[p][3];
            heat.add(m * values.get(p).copied().unwrap_or(0.0));
            mass.add(m);
        }
        let [heat, mass] = world.ranks.totals([&heat, &mass]);
        out[0] = if mass > 0.0 { heat / mass } else { 0.0 };
    }
}
