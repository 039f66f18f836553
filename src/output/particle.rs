//! Dumps of particles.

use super::lammps::{Format, Series, Table, Values, corners};
use super::{BuildDump, Dump, DumpTarget, Snapshot};
use crate::fault::Fault;
use crate::fix::GroupKind;
use crate::material::state::{PLACES, STRESS, SYMMETRIC};
use crate::material::{Lane, NOTHING};
use crate::math::tensor::{Tensor, rotation};
use crate::model::checkpoint::Checkpoint;
use crate::model::column::Column;
use crate::model::group::GroupId;
use crate::plan::Plan;
use crate::script::arguments::Args;
use crate::script::diagnostic::{Code, Diagnostic};
use crate::script::suggest;
use crate::style::Style;
use crate::world::World;
use nalgebra::{Rotation3, UnitQuaternion};
use std::path::PathBuf;

const USAGE: &str = "field, ...";

const MANUAL: &str = "\
Fields: x y z x0 y0 z0 vx vy vz s11 s22 s33 s12 s13 s23 seq e11 e22 e33 e12 e13 e23 volume mass
damage damage_init bx by bz ep epdot T ienergy gamma F11 .. F33 J rho p, and the set `ovito`:
places, velocities, radius, oriented boxes, stress. Quantities the run does not have are 0.
With `axisymmetric` the index 1 is the radius, 2 the axis, 3 the hoop; mass and volume are per
radian, radius is sqrt(V/x)/2.
One file per snapshot if the name has a `*` (the step), otherwise one growing file.";

const fn row(name: &'static str, summary: &'static str, build: BuildDump) -> Style<BuildDump> {
    Style { name, usage: USAGE, summary, manual: MANUAL, build: Some(build) }
}

/// The row of `particle`.
pub const TEXT: Style<BuildDump> =
    row("particle", "particles as LAMMPS text", |args, target| build(args, target, Format::Text));

/// The row of `particle/gz`.
pub const GZIP: Style<BuildDump> =
    row("particle/gz", "the same, compressed", |args, target| build(args, target, Format::Gzip));

/// The row of `particle/bin`.
pub const BINARY: Style<BuildDump> =
    row("particle/bin", "particles in LAMMPS's binary layout", |args, target| {
        build(args, target, Format::Binary)
    });

/// What a column of the dump shows.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Field {
    Place(usize),
    Velocity(usize),
    Mass,
    Stored(Column),
    Strain(usize),
    Equivalent,
    Volume,
    Density,
    Pressure,
    Radius,
    Orientation(usize),
    HalfSize(usize),
    InternalEnergy,
    Heating,
}

const STRAIN: [&str; 6] = ["e11", "e22", "e33", "e12", "e13", "e23"];
const HEAT: [(&str, Field); 2] = [("ienergy", Field::InternalEnergy), ("gamma", Field::Heating)];

const OVITO: [(&str, Field); 20] = [
    ("x", Field::Place(0)),
    ("y", Field::Place(1)),
    ("z", Field::Place(2)),
    ("vx", Field::Velocity(0)),
    ("vy", Field::Velocity(1)),
    ("vz", Field::Velocity(2)),
    ("radius", Field::Radius),
    ("Orientation.X", Field::Orientation(0)),
    ("Orientation.Y", Field::Orientation(1)),
    ("Orientation.Z", Field::Orientation(2)),
    ("Orientation.W", Field::Orientation(3)),
    ("AsphericalShape.X", Field::HalfSize(0)),
    ("AsphericalShape.Y", Field::HalfSize(1)),
    ("AsphericalShape.Z", Field::HalfSize(2)),
    ("StressTensor.XX", Field::Stored(Column::S11)),
    ("StressTensor.YY", Field::Stored(Column::S22)),
    ("StressTensor.ZZ", Field::Stored(Column::S33)),
    ("StressTensor.XY", Field::Stored(Column::S12)),
    ("StressTensor.XZ", Field::Stored(Column::S13)),
    ("StressTensor.YZ", Field::Stored(Column::S23)),
];

fn field(name: &str) -> Option<Field> {
    let axis = |names: [&str; 3]| names.iter().position(|known| *known == name);
    let strain = STRAIN.iter().position(|known| *known == name);
    axis(["x", "y", "z"])
        .map(Field::Place)
        .or_else(|| axis(["vx", "vy", "vz"]).map(Field::Velocity))
        .or_else(|| strain.map(Field::Strain))
        .or_else(|| HEAT.iter().find(|(known, _)| *known == name).map(|(_, field)| *field))
        .or_else(|| Column::named(name).map(Field::Stored))
        .or(match name {
            "mass" => Some(Field::Mass),
            "seq" => Some(Field::Equivalent),
            "volume" => Some(Field::Volume),
            "rho" => Some(Field::Density),
            "p" => Some(Field::Pressure),
            "radius" => Some(Field::Radius),
            _ => None,
        })
}

fn known_names() -> impl Iterator<Item = &'static str> {
    ["x", "y", "z", "vx", "vy", "vz", "mass", "seq", "volume", "rho", "p", "radius", "ovito"]
        .into_iter()
        .chain(STRAIN)
        .chain(HEAT.map(|(name, _)| name))
        .chain(Column::ALL.into_iter().map(|column| column.info().name))
}

fn build(
    args: &mut Args<'_>,
    target: &DumpTarget,
    format: Format,
) -> Result<Box<dyn Dump>, Diagnostic> {
    if target.kind == GroupKind::Nodes {
        let message = "a dump of particles needs `all` or a group of particles";
        return Err(Diagnostic::error(Code::GroupKind, target.group_span, message)
            .label("this is a group of nodes"));
    }
    let (mut names, mut fields) = (Vec::new(), Vec::new());
    loop {
        let name = args.word("a field")?;
        if name.text == "ovito" {
            names.extend(OVITO.iter().map(|(name, _)| name.to_string()));
            fields.extend(OVITO.iter().map(|(_, field)| *field));
        } else {
            let found = field(&name.text).ok_or_else(|| {
                let message = format!("a dump of particles has no field `{}`", name.text);
                let otherwise = "`karamelo-rs styles dump particle` lists all";
                Diagnostic::error(Code::UnknownField, name.span, message)
                    .label("not a field")
                    .help(suggest::help(&name.text, known_names(), otherwise))
            })?;
            names.push(name.text);
            fields.push(found);
        }
        if args.remaining() == 0 {
            break;
        }
    }
    let series = Series::new(&target.file, format);
    Ok(Box::new(ParticleDump { group: target.group, names, fields, series }))
}

struct ParticleDump {
    group: GroupId,
    names: Vec<String>,
    fields: Vec<Field>,
    series: Series,
}

impl Dump for ParticleDump {
    fn needs(&self, plan: &mut Plan, dimension: usize) {
        let deformation = match plan.axisymmetric {
            true => Column::ROUND_DEFORMATION,
            false => Column::deformation(dimension),
        };
        for field in &self.fields {
            match field {
                Field::Orientation(_) | Field::HalfSize(_) => plan.columns.extend(deformation),
                Field::Stored(column) if deformation.contains(column) => {
                    plan.columns.extend(deformation);
                }
                _ => {}
            }
        }
    }

    fn keep(&mut self, checkpoint: &mut Checkpoint) {
        self.series.keep(checkpoint);
    }

    fn write(&mut self, snapshot: &Snapshot<'_>) -> Result<PathBuf, Fault> {
        let world = snapshot.world;
        let particles = &world.particles;
        let mut order: Vec<u32> =
            particles.of_group(&world.groups, self.group).map(|p| p as u32).collect();
        order.sort_unstable_by_key(|p| particles.id[*p as usize]);
        let values = self.fields.iter().map(|field| values(*field, world)).collect();
        self.series.write(&Table {
            step: snapshot.step,
            time: snapshot.time,
            corners: corners(world, particles.position.iter().map(|x| [x[0], x[1], x[2]])),
            names: &self.names,
            order: &order,
            id: &|p| u64::from(particles.id[p]),
            kind: &|p| u64::from(particles.solid[p]) + 1,
            values,
        })
    }
}

/// The column of a field, in the order of storage.
fn values(field: Field, world: &World) -> Values<'_> {
    let particles = &world.particles;
    let dimension = world.domain.dimension;
    let made = |each: &dyn Fn(usize) -> f64| Values::Made((0..particles.len()).map(each).collect());
    let turned = world.method.total && world.solids.iter().any(|solid| solid.law.is_incremental());
    let jacobian = particles.column(Column::J);
    match field {
        Field::Place(axis) => Values::Record(&particles.position, axis),
        Field::Velocity(axis) => Values::Record(&particles.velocity, axis),
        Field::Mass => Values::Record(&particles.position, 3),
        Field::Stored(column) if turned && STRESS.contains(&column) => {
            let place = STRESS.iter().position(|known| *known == column).unwrap_or(0);
            made(&|p| world.stress(p)[PLACES[place]])
        }
        Field::Stored(column) if particles.present.contains(column) => {
            Values::Slice(particles.column(column))
        }
        Field::Stored(column) => Values::Constant(column.info().initial),
        Field::InternalEnergy => {
            made(&|p| world.of_particle(p, |solid, state| solid.law.internal_energy(state, 0)))
        }
        Field::Heating => {
            made(&|p| world.of_particle(p, |solid, state| solid.law.heating(state, 0)))
        }
        Field::Volume => made(&|p| jacobian[p] * particles.velocity[p][3]),
        Field::Density => {
            made(&|p| particles.position[p][3] / (jacobian[p] * particles.velocity[p][3]))
        }
        Field::Pressure => made(&|p| -world.stress(p).trace() / 3.0),
        Field::Equivalent => made(&|p| {
            let s = world.stress(p);
            let (a, b, c) = (s[(0, 0)], s[(1, 1)], s[(2, 2)]);
            let shear = s[(0, 1)].powi(2) + s[(0, 2)].powi(2) + s[(1, 2)].powi(2);
            let normal = (a - b).powi(2) + (b - c).powi(2) + (c - a).powi(2);
            (0.5 * normal + 3.0 * shear).sqrt()
        }),
        Field::Radius => made(&|p| {
            let girth = world.method.girth(world.place(p));
            0.5 * (jacobian[p] * particles.velocity[p][3] / girth).powf(1.0 / dimension as f64)
        }),
        Field::Strain(component) => strain(world, component),
        Field::Orientation(entry) => made(&|p| {
            let turn = Rotation3::from_matrix_unchecked(rotation(&world.deformation(p)));
            UnitQuaternion::from_rotation_matrix(&turn).coords[entry]
        }),
        Field::HalfSize(axis) => made(&|p| {
            let f = world.deformation(p);
            let stretch = rotation(&f).transpose() * f;
            let solid = &world.solids[particles.solid[p] as usize];
            0.5 * solid.cells.cell / solid.particles_per_cell * stretch[(axis, axis)]
        }),
    }
}

fn strain(world: &World, component: usize) -> Values<'_> {
    let mut lanes: [Lane; 6] = [NOTHING; 6];
    let mut values = Vec::with_capacity(world.particles.len());
    let description = world.description();
    world.each_chunk(|_, solid, state| {
        let law = &*solid.law;
        law.elastic_strain(state, &mut lanes);
        for p in 0..state.len {
            let value = match description.is_turned_back(law) {
                false => lanes[component][p / 4][p % 4],
                true => {
                    let entry = |index: usize| lanes[SYMMETRIC[index]][p / 4][p % 4];
                    let stored = Tensor::from_fn(|i, j| entry(3 * i + j));
                    description.in_space(law, state, p, stored)[PLACES[component]]
                }
            };
            values.push(value);
        }
    });
    Values::Made(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_known_name_is_a_field() {
        for name in known_names().filter(|name| *name != "ovito") {
            assert!(field(name).is_some(), "{name}");
        }
        assert_eq!(field("sxx"), None);
    }
}
