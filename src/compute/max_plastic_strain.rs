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
        let here = [Column::PlasticStrain, Column::Temperature].map(|column| {
            let values = world.particles.column(column);
            let members = world.particles.of_group(&world.groups, self.0);
            members.filter_map(|p| values.get(p)).copied().fold(f64::NEG_INFINITY, f64::max)
        });
        let most = world.ranks.largest(here);
        out.copy_from_slice(&most.map(|most| if most.is_finite() { most } else { 0.0 }));
    }
}
