//! What dumps and pictures show of particles: fields by name, their columns.

use super::lammps::Values;
use crate::material::state::{PLACES, STRESS, SYMMETRIC};
use crate::material::{Lane, NOTHING};
use crate::math::tensor::{Tensor, rotation};
use crate::model::column::Column;
use crate::plan::Plan;
use crate::script::arguments::Name;
use crate::script::diagnostic::{Code, Diagnostic};
use crate::script::suggest;
use crate::world::World;
use nalgebra::{Rotation3, UnitQuaternion};
use rayon::prelude::*;
use std::cell::OnceCell;

/// A quantity of each particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Field {
    /// Current position.
    Place(usize),
    /// Velocity.
    Velocity(usize),
    /// Length of the velocity.
    Speed,
    /// Mass.
    Mass,
    /// A column of the table of particles.
    Stored(Column),
    /// Elastic strain.
    Strain(usize),
    /// Von Mises stress.
    Equivalent,
    /// Current volume.
    Volume,
    /// Density.
    Density,
    /// Pressure.
    Pressure,
    /// Half the edge of a cube of that volume.
    Radius,
    /// Entry (x, y, z, w) of the quaternion of R in F = R U.
    Orientation(usize),
    /// Half the size of the domain along an axis of the particle, h/2 diag U.
    HalfSize(usize),
    /// Internal energy e of (2.10).
    InternalEnergy,
    /// Heating power.
    Heating,
}

const STRAIN: [&str; 6] = ["e11", "e22", "e33", "e12", "e13", "e23"];
const OTHERS: [(&str, Field); 9] = [
    ("speed", Field::Speed),
    ("mass", Field::Mass),
    ("seq", Field::Equivalent),
    ("volume", Field::Volume),
    ("rho", Field::Density),
    ("p", Field::Pressure),
    ("radius", Field::Radius),
    ("ienergy", Field::InternalEnergy),
    ("gamma", Field::Heating),
];

/// The set `ovito`: names that OVITO maps to its own properties.
const OVITO: [(&str, Field); 29] = [
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
    ("DeformationGradient.XX", Field::Stored(Column::F11)),
    ("DeformationGradient.XY", Field::Stored(Column::F12)),
    ("DeformationGradient.XZ", Field::Stored(Column::F13)),
    ("DeformationGradient.YX", Field::Stored(Column::F21)),
    ("DeformationGradient.YY", Field::Stored(Column::F22)),
    ("DeformationGradient.YZ", Field::Stored(Column::F23)),
    ("DeformationGradient.ZX", Field::Stored(Column::F31)),
    ("DeformationGradient.ZY", Field::Stored(Column::F32)),
    ("DeformationGradient.ZZ", Field::Stored(Column::F33)),
];

/// What the set `ovito` has besides, where a material of the scene has it.
const OVITO_IF_PRESENT: [Column; 3] = [Column::PlasticStrain, Column::Damage, Column::Temperature];

/// The word that stands for the set.
const SET: &str = "ovito";

/// Names and fields of a dump as the script lists them.
#[derive(Clone, Debug, Default)]
pub struct Fields {
    listed: Vec<(String, Field)>,
    /// The set `ovito` is among them.
    has_set: bool,
}

impl Fields {
    /// Adds a field or set.
    ///
    /// # Errors
    /// There is none of that name; the nearest one is named.
    pub fn add(&mut self, name: Name) -> Result<(), Diagnostic> {
        if name.text == SET {
            self.has_set = true;
            self.listed.extend(OVITO.iter().map(|(name, field)| (name.to_string(), *field)));
            self.listed.push(("seq".to_string(), Field::Equivalent));
            return Ok(());
        }
        let field = find(&name)?;
        self.listed.push((name.text, field));
        Ok(())
    }

    /// Columns that a scene must have for them.
    pub fn needs(&self, plan: &mut Plan, dimension: usize) {
        self.listed.iter().for_each(|(_, field)| field.needs(plan, dimension));
    }

    /// Names and fields that this scene has.
    pub fn of(&self, world: &World) -> (Vec<String>, Vec<Field>) {
        let (mut names, mut fields): (Vec<String>, Vec<Field>) =
            self.listed.iter().cloned().unzip();
        if self.has_set {
            let present = world.particles.present;
            let there = |column: &Column| {
                present.contains(*column) && !names.iter().any(|name| name == column.info().name)
            };
            let more: Vec<Column> = OVITO_IF_PRESENT.into_iter().filter(there).collect();
            names.extend(more.iter().map(|column| column.info().name.to_string()));
            fields.extend(more.into_iter().map(Field::Stored));
        }
        (names, fields)
    }
}

/// The field of a name.
///
/// # Errors
/// There is none; the nearest one is named.
pub fn find(name: &Name) -> Result<Field, Diagnostic> {
    named(&name.text).ok_or_else(|| {
        let message = format!("a dump of particles has no field `{}`", name.text);
        let otherwise = "`karamelo-rs styles dump particle` lists all";
        Diagnostic::error(Code::UnknownField, name.span, message)
            .label("not a field")
            .help(suggest::help(&name.text, known_names(), otherwise))
    })
}

fn named(name: &str) -> Option<Field> {
    let place = |names: &[&str]| names.iter().position(|known| *known == name);
    place(&["x", "y", "z"])
        .map(Field::Place)
        .or_else(|| place(&["vx", "vy", "vz"]).map(Field::Velocity))
        .or_else(|| place(&STRAIN).map(Field::Strain))
        .or_else(|| OTHERS.iter().find(|(known, _)| *known == name).map(|(_, field)| *field))
        .or_else(|| Column::named(name).map(Field::Stored))
}

fn known_names() -> impl Iterator<Item = &'static str> {
    ["x", "y", "z", "vx", "vy", "vz", SET]
        .into_iter()
        .chain(STRAIN)
        .chain(OTHERS.map(|(name, _)| name))
        .chain(Column::ALL.into_iter().map(|column| column.info().name))
}

impl Field {
    /// Columns that a scene must have for it.
    pub fn needs(self, plan: &mut Plan, dimension: usize) {
        let deformation = match plan.axisymmetric {
            true => Column::ROUND_DEFORMATION,
            false => Column::deformation(dimension),
        };
        match self {
            Field::Orientation(_) | Field::HalfSize(_) => plan.columns.extend(deformation),
            Field::Stored(column) if deformation.contains(&column) => {
                plan.columns.extend(deformation);
            }
            _ => {}
        }
    }
}

/// The columns of a snapshot; what several fields are made from is made once.
pub struct Columns<'a> {
    world: &'a World,
    stress: OnceCell<Vec<Tensor>>,
    boxes: OnceCell<Vec<[f64; 7]>>,
}

impl<'a> Columns<'a> {
    /// Of the particles of a world.
    pub fn new(world: &'a World) -> Self {
        Self { world, stress: OnceCell::new(), boxes: OnceCell::new() }
    }

    fn made(&self, each: impl Fn(usize) -> f64 + Sync + Send) -> Values<'a> {
        let count = self.world.particles.len();
        Values::Made((0..count).into_par_iter().map(each).collect())
    }

    /// Cauchy stresses in space axes \[P\].
    fn stress(&self) -> &[Tensor] {
        self.stress.get_or_init(|| {
            let all = 0..self.world.particles.len();
            all.into_par_iter().map(|p| self.world.stress(p)).collect()
        })
    }

    /// Quaternion of R and half sizes h/2 diag U \[L\] with F = R U.
    fn boxes(&self) -> &[[f64; 7]] {
        let world = self.world;
        self.boxes.get_or_init(|| {
            let each = |p: usize| {
                let f = world.deformation(p);
                let r = rotation(&f);
                let stretch = r.transpose() * f;
                let turn = Rotation3::from_matrix_unchecked(r);
                let q = UnitQuaternion::from_rotation_matrix(&turn).coords;
                let solid = &world.solids[world.particles.solid[p] as usize];
                let half = 0.5 * solid.cells.cell / solid.particles_per_cell;
                let size = |axis: usize| half * stretch[(axis, axis)];
                [q[0], q[1], q[2], q[3], size(0), size(1), size(2)]
            };
            (0..world.particles.len()).into_par_iter().map(each).collect()
        })
    }

    /// The column of a field, in the order of storage.
    pub fn values(&self, field: Field) -> Values<'a> {
        let world = self.world;
        let particles = &world.particles;
        let turned = world.method.total && world.solids.iter().any(|s| s.law.is_incremental());
        let jacobian = particles.column(Column::J);
        let volume = |p: usize| jacobian[p] * particles.velocity[p][3];
        match field {
            Field::Place(axis) => Values::Record(&particles.position, axis),
            Field::Velocity(axis) => Values::Record(&particles.velocity, axis),
            Field::Speed => self.made(|p| {
                let [x, y, z, _] = particles.velocity[p];
                (x * x + y * y + z * z).sqrt()
            }),
            Field::Mass => Values::Record(&particles.position, 3),
            Field::Stored(column) if turned && STRESS.contains(&column) => {
                let place = STRESS.iter().position(|known| *known == column).unwrap_or(0);
                let stress = self.stress();
                self.made(|p| stress[p][PLACES[place]])
            }
            Field::Stored(column) if particles.present.contains(column) => {
                Values::Slice(particles.column(column))
            }
            Field::Stored(column) => Values::Constant(column.info().initial),
            Field::InternalEnergy => {
                self.made(|p| world.of_particle(p, |solid, s| solid.law.internal_energy(s, 0)))
            }
            Field::Heating => {
                self.made(|p| world.of_particle(p, |solid, s| solid.law.heating(s, 0)))
            }
            Field::Volume => self.made(volume),
            Field::Density => self.made(|p| particles.position[p][3] / volume(p)),
            Field::Pressure => {
                let stress = self.stress();
                self.made(|p| -stress[p].trace() / 3.0)
            }
            Field::Equivalent => {
                let stress = self.stress();
                self.made(|p| equivalent(&stress[p]))
            }
            Field::Radius => self.made(|p| radius(world, p)),
            Field::Strain(component) => strain(world, component),
            Field::Orientation(entry) => {
                let boxes = self.boxes();
                self.made(|p| boxes[p][entry])
            }
            Field::HalfSize(axis) => {
                let boxes = self.boxes();
                self.made(|p| boxes[p][4 + axis])
            }
        }
    }
}

/// Von Mises stress \[P\].
fn equivalent(s: &Tensor) -> f64 {
    let (a, b, c) = (s[(0, 0)], s[(1, 1)], s[(2, 2)]);
    let shear = s[(0, 1)].powi(2) + s[(0, 2)].powi(2) + s[(1, 2)].powi(2);
    let normal = (a - b).powi(2) + (b - c).powi(2) + (c - a).powi(2);
    (0.5 * normal + 3.0 * shear).sqrt()
}

/// Half the edge \[L\] of a cube (square, line) of the volume of a particle.
pub fn radius(world: &World, particle: usize) -> f64 {
    let particles = &world.particles;
    let volume = particles.column(Column::J)[particle] * particles.velocity[particle][3];
    let girth = world.method.girth(world.place(particle));
    0.5 * (volume / girth).powf(1.0 / world.domain.dimension as f64)
}

fn strain(world: &World, component: usize) -> Values<'static> {
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
        for name in known_names().filter(|name| *name != SET) {
            assert!(named(name).is_some(), "{name}");
        }
        assert_eq!(named("sxx"), None);
    }

    #[test]
    fn the_equivalent_stress_of_tension_and_shear() {
        let tension = Tensor::from_diagonal(&nalgebra::Vector3::new(3.0, 0.0, 0.0));
        assert_eq!(equivalent(&tension), 3.0);
        let shear = Tensor::new(0.0, 2.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        assert!((equivalent(&shear) - 2.0 * 3f64.sqrt()).abs() < 1e-15);
    }
}
