//! Largest plastic strain and temperature.

use super::{BuildCompute, Compute};
use crate::fix::GroupKind;
use crate::model::column::Column;
use crate::model::group::GroupId;
use crate::style::Style;
use crate::world::World;

/// The row of the table.
pub const STYLE: Style<BuildCompute> = Style {
    name: "max_plastic_strain",
    usage: "",
    summary: "largest equivalent plastic strain and temperature of a group",
    manual: "Publishes ID_Epmax and ID_Tmax; 0 where no law of the scene has them.",
    build: Some(|_, target| {
        target.require("max_plastic_strain", &[GroupKind::Particles, GroupKind::All])?;
        Ok(Box::new(MaxPlasticStrain(target.group)))
    }),
};

/// max ep, max T.
pub struct MaxPlasticStrain(pub GroupId);

impl Compute for MaxPlasticStrain {
    fn suffixes(&self) -> &'static [&'static str] {
        &["_Epmax", "_Tmax"]
    }

    fn evaluate(&self, world: &World, out: &mut [f64]) {
        out.fill(0.0);
        for (out, column) in out.iter_mut().zip([Column::PlasticStrain, Column::Temperature]) {
            let values = world.particles.column(column);
            let members = world.particles.of_group(&world.groups, self.0);
            *out = members.filter_map(|p| values.get(p)).copied().reduce(f64::max).unwrap_or(0.0);
        }
    }
}
