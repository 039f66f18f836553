//! Kinetic and strain energy, as fixes (an old form that published scripts use).

use super::{BuildFix, Fix, GroupKind, Target};
use crate::compute::energy::{kinetic_energy, strain_energy};
use crate::model::group::GroupId;
use crate::script::diagnostic::Diagnostic;
use crate::step::Stage;
use crate::style::Style;
use crate::world::World;

/// The row of `kinetic_energy`.
pub const KINETIC: Style<BuildFix> = Style {
    name: "kinetic_energy",
    usage: "",
    summary: "publishes sum m v^2/2 of a group in ID_s",
    manual: "Evaluated when read. The compute of the same name publishes it as ID.",
    build: Some(|_, target| energy(target, "kinetic_energy", kinetic_energy)),
};

/// The row of `strain_energy`.
pub const STRAIN: Style<BuildFix> = Style {
    name: "strain_energy",
    usage: "",
    summary: "publishes the stored energy of a group in ID_s",
    manual: "Evaluated when read: sum V sigma:eps_el/2, neo-hookean sum V0 W.",
    build: Some(|_, target| energy(target, "strain_energy", strain_energy)),
};

type Sum = fn(&World, GroupId) -> f64;

fn energy(target: &Target, style: &str, sum: Sum) -> Result<Box<dyn Fix>, Diagnostic> {
    target.require(style, &[GroupKind::Particles, GroupKind::All])?;
    Ok(Box::new(Energy { group: target.group, sum }))
}

struct Energy {
    group: GroupId,
    sum: Sum,
}

impl Fix for Energy {
    fn stages(&self) -> &'static [Stage] {
        &[]
    }

    fn results(&self, world: &World) -> [f64; 4] {
        [0.0, 0.0, 0.0, (self.sum)(world, self.group)]
    }
}
