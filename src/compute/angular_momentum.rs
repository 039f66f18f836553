//! Angular momentum.

use super::{BuildCompute, Compute};
use crate::fix::GroupKind;
use crate::math::exact_sum::VectorSum;
use crate::model::group::GroupId;
use crate::style::Style;
use crate::world::World;

/// The row of the table.
pub const STYLE: Style<BuildCompute> = Style {
    name: "angular_momentum",
    usage: "[x0, y0, z0]",
    summary: "sum m (x - x0) x v of a group [M L^2/T]",
    manual: "Publishes ID_x, ID_y, ID_z about the point (x0, y0, z0), by default the origin.",
    build: Some(|args, target| {
        target.require("angular_momentum", &[GroupKind::Particles, GroupKind::All])?;
        let mut centre = [0.0; 3];
        if args.remaining() > 0 {
            for (centre, name) in centre.iter_mut().zip(["x0", "y0", "z0"]) {
                *centre = args.number(name)?.value;
            }
        }
        Ok(Box::new(AngularMomentum { group: target.group, centre }))
    }),
};

/// sum m (x - c) x v.
pub struct AngularMomentum {
    /// Which particles.
    pub group: GroupId,
    /// The point c \[L\].
    pub centre: [f64; 3],
}

impl Compute for AngularMomentum {
    fn suffixes(&self) -> &'static [&'static str] {
        &["_x", "_y", "_z"]
    }

    fn evaluate(&self, world: &World, out: &mut [f64]) {
        let mut sums = VectorSum::default();
        for p in world.particles.of_group(&world.groups, self.group) {
            let [x, y, z, mass] = world.particles.position[p];
            let r = [x - self.centre[0], y - self.centre[1], z - self.centre[2]];
            let v = world.particles.velocity[p];
            sums.add(std::array::from_fn(|axis| {
                let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
                mass * (r[a] * v[b] - r[b] * v[a])
            }));
        }
        out.copy_from_slice(&world.ranks.vector(&sums));
    }
}
