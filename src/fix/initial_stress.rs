//! Stress that particles start with.

use super::{BuildFix, Fix, GroupKind};
use crate::fault::Fault;
use crate::model::column::Column;
use crate::model::group::GroupId;
use crate::script::arguments::Place;
use crate::script::formula::{Formula, Instant, Points};
use crate::step::{Stage, Step};
use crate::style::Style;
use crate::world::{Solid, World};

/// The row of the table.
pub const STYLE: Style<BuildFix> = Style {
    name: "initial_stress",
    usage: "s11, s22, s33, s23, s13, s12",
    summary: "sets the Cauchy stress of particles [P] once",
    manual: "At the start of the first run after the definition. NULL leaves a component alone.
Laws whose stress follows from the deformation alone (neo-hookean) are not changed.",
    build: Some(|args, target| {
        target.require("initial_stress", &[GroupKind::Particles, GroupKind::All])?;
        let mut components = [const { None }; 6];
        for (component, name) in
            components.iter_mut().zip(["s11", "s22", "s33", "s23", "s13", "s12"])
        {
            *component = args.component(name, Place::Point)?;
        }
        Ok(Box::new(InitialStress { id: target.id.clone(), group: target.group, components }))
    }),
};

const COLUMNS: [Column; 6] =
    [Column::S11, Column::S22, Column::S33, Column::S23, Column::S13, Column::S12];

/// sigma <- value, once.
pub struct InitialStress {
    /// ID of the fix.
    pub id: String,
    /// Which particles.
    pub group: GroupId,
    /// 11, 22, 33, 23, 13, 12 \[P\]; `None` leaves a component alone.
    pub components: [Option<Formula>; 6],
}

impl Fix for InitialStress {
    fn stages(&self) -> &'static [Stage] {
        &[]
    }

    fn formulas(&self) -> Vec<&Formula> {
        self.components.iter().flatten().collect()
    }

    fn passes_over(&self, world: &World) -> Option<String> {
        let World { particles, groups, solids, .. } = world;
        let solid = |p: usize| &solids[particles.solid[p] as usize];
        let mut members = particles.of_group(groups, self.group);
        let deaf = members.find(|p| !solid(*p).law.accepts_initial_stress())?;
        let Solid { name, material, .. } = solid(deaf);
        Some(format!(
            "in solid `{name}` the stress of material `{material}` follows from the deformation alone"
        ))
    }

    fn start(&mut self, step: &mut Step<'_>) -> Result<(), Fault> {
        let World { particles, groups, solids, .. } = &mut *step.world;
        let members: Vec<usize> = particles.of_group(groups, self.group).collect();
        let now = Instant::start(&step.clock);
        for p in members {
            if !solids[particles.solid[p] as usize].law.accepts_initial_stress() {
                continue;
            }
            let [x, y, z, _] = particles.position[p];
            let original = particles.reference_place(p);
            for (component, column) in self.components.iter().zip(COLUMNS) {
                let (Some(formula), Some(entry)) =
                    (component, particles.column_mut(column).get_mut(p))
                else {
                    continue;
                };
                let points = Points {
                    current: [&[x], &[y], &[z]],
                    reference: original.each_ref().map(std::slice::from_ref),
                };
                let mut value = [0.0];
                formula.fill(step.board, &now, &points, &mut value);
                if !value[0].is_finite() {
                    return Err(Fault::run(format!(
                        "fix `{}`: `{}` is {} at ({x}, {y}, {z})",
                        self.id,
                        formula.text(),
                        value[0]
                    )));
                }
                *entry = value[0];
            }
        }
        Ok(())
    }
}
