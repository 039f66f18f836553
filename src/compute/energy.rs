//! Kinetic and stored energy.

use super::{BuildCompute, Compute};
use crate::fix::{GroupKind, Target};
use crate::material::NOTHING;
use crate::math::exact_sum::ExactSum;
use crate::model::group::GroupId;
use crate::script::diagnostic::Diagnostic;
use crate::style::Style;
use crate::world::World;

/// The row of `kinetic_energy`.
pub const KINETIC: Style<BuildCompute> = Style {
    name: "kinetic_energy",
    usage: "",
    summary: "sum m v^2/2 [M L^2/T^2]",
    manual: "Publishes ID. With `axisymmetric` per radian.",
    build: Some(|_, target| energy(target, "kinetic_energy", kinetic_energy)),
};

/// The row of `strain_energy`.
pub const STRAIN: Style<BuildCompute> = Style {
    name: "strain_energy",
    usage: "",
    summary: "stored energy, sum V sigma:eps_el/2 or sum V0 W [M L^2/T^2]",
    manual: "Publishes ID. eps_el = C^-1 sigma for hypoelastic laws.
With `axisymmetric` per radian.",
    build: Some(|_, target| energy(target, "strain_energy", strain_energy)),
};

type Sum = fn(&World, GroupId) -> f64;

fn energy(target: &Target, style: &str, sum: Sum) -> Result<Box<dyn Compute>, Diagnostic> {
    target.require(style, &[GroupKind::Particles, GroupKind::All])?;
    Ok(Box::new(Energy { group: target.group, sum }))
}

struct Energy {
    group: GroupId,
    sum: Sum,
}

impl Compute for Energy {
    fn suffixes(&self) -> &'static [&'static str] {
        &[""]
    }

    fn evaluate(&self, world: &World, out: &mut [f64]) {
        out[0] = (self.sum)(world, self.group);
    }
}

/// sum m v^2/2 over the particles of a group.
pub fn kinetic_energy(world: &World, group: GroupId) -> f64 {
    let particles = &world.particles;
    let each = |p: usize| {
        let [x, y, z, _] = particles.velocity[p];
        0.5 * particles.position[p][3] * (x * x + y * y + z * z)
    };
    world.ranks.total(&ExactSum::of(particles.of_group(&world.groups, group).map(each)))
}

/// sum V0 w over the particles of a group, w the stored energy per reference volume.
pub fn strain_energy(world: &World, group: GroupId) -> f64 {
    let members = &world.groups[group].members;
    let particles = &world.particles;
    let mut energy = NOTHING;
    let mut sum = ExactSum::default();
    world.each_chunk(|range, solid, state| {
        solid.law.stored_energy(state, &mut energy);
        for (p, energy) in range.zip(energy.as_flattened()) {
            if particles.belongs(p, members) {
                sum.add(particles.velocity[p][3] * energy);
            }
        }
    });
    world.ranks.total(&sum)
}
