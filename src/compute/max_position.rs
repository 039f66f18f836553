//! The farthest place a group reaches.

use super::{BuildCompute, Compute};
use crate::fix::GroupKind;
use crate::model::group::GroupId;
use crate::style::Style;
use crate::world::World;

/// The row of the table.
pub const STYLE: Style<BuildCompute> = Style {
    name: "max_position",
    usage: "",
    summary: "largest coordinate of the particles of a group on each axis [L]",
    manual: "Publishes ID_x, ID_y, ID_z; -inf for an empty group.",
    build: Some(|_, target| {
        target.require("max_position", &[GroupKind::Particles, GroupKind::All])?;
        Ok(Box::new(MaxPosition(target.group)))
    }),
};

/// max x on each axis.
pub struct MaxPosition(pub GroupId);

impl Compute for MaxPosition {
    fn suffixes(&self) -> &'static [&'static str] {
        &["_x", "_y", "_z"]
    }

    fn evaluate(&self, world: &World, out: &mut [f64]) {
        let mut most = [f64::NEG_INFINITY; 3];
        for p in world.particles.of_group(&world.groups, self.0) {
            for (largest, x) in most.iter_mut().zip(world.particles.position[p]) {
                *largest = largest.max(x);
            }
        }
        out.copy_from_slice(&world.ranks.largest(most));
    }
}
