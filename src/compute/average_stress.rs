//! Mean stress.

use super::{BuildCompute, Compute};
use crate::fix::GroupKind;
use crate::material::state::PLACES;
use crate::math::exact_sum::ExactSum;
use crate::model::column::Column;
use crate::model::group::GroupId;
use crate::style::Style;
use crate::world::World;

/// The row of the table.
pub const STYLE: Style<BuildCompute> = Style {
    name: "average_stress",
    usage: "",
    summary: "mean Cauchy stress of a group by volume [P]",
    manual: "\
Publishes ID_11, ID_22, ID_33, ID_12, ID_13, ID_23: sum V sigma/sum V in space axes, V = J V0; 0 for
an empty group.",
    build: Some(|_, target| {
        target.require("average_stress", &[GroupKind::Particles, GroupKind::All])?;
        Ok(Box::new(AverageStress(target.group)))
    }),
};

/// sum V sigma/sum V.
pub struct AverageStress(pub GroupId);

impl Compute for AverageStress {
    fn suffixes(&self) -> &'static [&'static str] {
        &["_11", "_22", "_33", "_12", "_13", "_23"]
    }

    fn evaluate(&self, world: &World, out: &mut [f64]) {
        let mut sums: [ExactSum; 7] = Default::default();
        let (particles, description) = (&world.particles, world.description());
        let members = &world.groups[self.0].members;
        world.each_chunk(|range, solid, state| {
            for (lane, p) in range.enumerate().filter(|(_, p)| particles.belongs(*p, members)) {
                let volume = state.value(Column::J, lane) * particles.velocity[p][3];
                let stress = description.stress(&*solid.law, state, lane);
                for (sum, place) in sums.iter_mut().zip(PLACES) {
                    sum.add(volume * stress[place]);
                }
                sums[6].add(volume);
            }
        });
        let [stresses @ .., volume] = world.ranks.totals(sums.each_ref());
        let mean = |stress: f64| if volume > 0.0 { stress / volume } else { 0.0 };
        out.copy_from_slice(&stresses.map(mean));
    }
}
