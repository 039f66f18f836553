//! Mean velocity.

use super::{BuildCompute, Compute};
use crate::fix::GroupKind;
use crate::math::exact_sum::VectorSum;
use crate::model::group::GroupId;
use crate::style::Style;
use crate::world::World;

/// The row of the table.
pub const STYLE: Style<BuildCompute> = Style {
    name: "average_velocity",
    usage: "",
    summary: "plain mean of the velocities of a group [L/T]",
    manual: "Publishes ID_x, ID_y, ID_z; 0 for an empty group.",
    build: Some(|_, target| {
        target.require("average_velocity", &[GroupKind::Particles, GroupKind::All])?;
        Ok(Box::new(AverageVelocity(target.group)))
    }),
};

/// sum v/n.
pub struct AverageVelocity(pub GroupId);

impl Compute for AverageVelocity {
    fn suffixes(&self) -> &'static [&'static str] {
        &["_x", "_y", "_z"]
    }

    fn evaluate(&self, world: &World, out: &mut [f64]) {
        let (mut count, mut sums) = (0, VectorSum::default());
        for p in world.particles.of_group(&world.groups, self.0) {
            count += 1;
            let [x, y, z, _] = world.particles.velocity[p];
            sums.add([x, y, z]);
        }
        let [count] = world.ranks.count([count]);
        let sums = world.ranks.vector(&sums);
        out.copy_from_slice(&sums.map(|sum| if count > 0 { sum / count as f64 } else { 0.0 }));
    }
}
