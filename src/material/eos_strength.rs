//! Pressure from an equation of state, deviator from a strength law.

use super::stages::{Stages, add_viscosity, assemble, weaken_tension};
use super::{BuildMaterial, Chunk, Family, Lane, Law, NOTHING, State, Thermal, write_strain};
use crate::damage::Damage;
use crate::eos::Eos;
use crate::math::tensor::Tensor;
use crate::math::v4::{Sweep, Wide, dispatch};
use crate::model::column::{Column, ColumnSet};
use crate::script::arguments::Name;
use crate::script::diagnostic::{Code, Diagnostic};
use crate::strength::Strength;
use crate::style::Style;
use crate::temperature::Temperature;
use std::sync::Arc;

/// The row of the table.
pub const STYLE: Style<BuildMaterial> = Style {
    name: "eos-strength",
    usage: "eosID, strengthID [, damageID] [, temperatureID]",
    summary: "pressure from an equation of state, deviator from a strength law",
    manual: "\
sigma = -p I + s: p from the `eos`, s from the `strength` (trial 2 G (1 - D) dt dev D on the turned
deviator, then back to the flow stress). With a `damage` law tension becomes (1 - D) p and
particles with D = 1 carry no stress; with a `temperature` law p += 3 K alpha (T - T0) and plastic
work heats. Wave speed sqrt((K_t + 4 G/3)/rho), K_t the tangent of the eos. Elastic strain
ln J/3 I + s/(2 G (1 - D)). An `ideal-gas` keeps its own energy and takes neither of the two laws.
Source: de Vaucorbeil et al. 2020, section 2.2.",
    build: Some(|args, families| {
        let eos = (families.eos)(&args.word("an eos ID")?)?;
        let strength = (families.strength)(&args.word("a strength ID")?)?;
        let mut law = EosStrength { eos, strength, damage: None, temperature: None };
        while args.remaining() > 0 {
            let name = args.word("a damage ID or a temperature ID")?;
            if law.eos.initial_energy().is_some() {
                return Err(keeps_its_energy(&name));
            }
            match (families.either)(&name)? {
                Family::Damage(damage) if law.damage.is_none() => law.damage = Some(damage),
                Family::Temperature(temperature) if law.temperature.is_none() => {
                    law.temperature = Some(temperature);
                }
                _ => return Err(super::second_of_family(&name)),
            }
        }
        Ok(Arc::new(law))
    }),
};

/// The mistake of a damage or temperature law beside an eos that advances its own energy.
fn keeps_its_energy(name: &Name) -> Diagnostic {
    let message =
        format!("`{}` cannot go with an eos that keeps its own internal energy", name.text);
    Diagnostic::error(Code::NotCombined, name.span, message)
        .label("a gas takes no damage and no temperature law")
}

/// sigma = -p I + s.
///
/// # Source  de Vaucorbeil et al. 2020, section 2.2; language.md 9.3
pub struct EosStrength {
    /// The pressure.
    pub eos: Arc<dyn Eos>,
    /// The deviator.
    pub strength: Arc<dyn Strength>,
    /// What weakens both.
    pub damage: Option<Arc<dyn Damage>>,
    /// What heats.
    pub temperature: Option<Arc<dyn Temperature>>,
}

impl Law for EosStrength {
    fn columns(&self, dimension: usize) -> ColumnSet {
        let mut columns = ColumnSet::default();
        columns.extend(Column::stress(dimension));
        columns.extend(self.strength.columns());
        if self.eos.initial_energy().is_some() {
            columns.insert(Column::InternalEnergy);
        }
        if self.damage.is_some() {
            columns.extend(&[Column::Damage, Column::DamageInitiation]);
        }
        let damage_reads = self.damage.as_ref().is_some_and(|law| law.reads_temperature());
        if self.temperature.is_some() || self.strength.reads_temperature() || damage_reads {
            columns.insert(Column::Temperature);
        }
        columns
    }

    fn initial_values(&self) -> Vec<(Column, f64)> {
        let Some(energy) = self.eos.initial_energy() else {
            return Vec::new();
        };
        let normal = [Column::S11, Column::S22, Column::S33];
        let stress = normal.map(|column| (column, -self.eos.initial_pressure()));
        stress.into_iter().chain([(Column::InternalEnergy, energy)]).collect()
    }

    fn reads_volume_before(&self) -> bool {
        self.eos.initial_energy().is_some()
    }

    fn is_incremental(&self) -> bool {
        true
    }

    fn density(&self) -> f64 {
        self.eos.density()
    }

    fn moduli(&self) -> [f64; 2] {
        [self.eos.bulk(), self.strength.shear()]
    }

    fn reference_wave_speed(&self) -> f64 {
        let mut state = State::default();
        (state.dimension, state.len) = (3, 1);
        for (column, value) in self.initial_values() {
            state.set_value(column, 0, value);
        }
        let mut speed = NOTHING;
        self.wave_speed(&state, &mut speed);
        speed[0][0]
    }

    fn update(&self, chunk: &mut Chunk<'_>) {
        let density = self.eos.density();
        let damaged = self.damage.is_some();
        let stages = &mut Stages::default();
        self.eos.pressure(chunk, self.temperature.is_some(), &mut stages.pressure);
        if damaged {
            weaken_tension(chunk, stages);
        }
        if let Some(viscosity) = self.eos.viscosity() {
            add_viscosity(viscosity, density, chunk, stages);
        }
        if let Some(temperature) = &self.temperature {
            temperature.add_pressure(self.eos.bulk(), chunk, stages);
        }
        self.strength.deviator(damaged, chunk, stages);
        if self.eos.initial_energy().is_some() {
            self.eos.absorb(self.strength.viscosity(), chunk, stages);
        }
        if let Some(damage) = &self.damage {
            damage.grow(chunk, stages);
        }
        if let Some(temperature) = &self.temperature {
            temperature.heat(density, chunk, stages);
        }
        assemble(damaged, chunk, stages);
    }

    fn wave_speed(&self, state: &State, out: &mut Lane) {
        self.eos.stiffness(state, out);
        let shear = 4.0 / 3.0 * self.strength.shear();
        dispatch(Speed { shear, inverse_density: 1.0 / self.density(), state, out });
    }

    fn stiffen(&self, chunk: &Chunk<'_>, speed: &mut Lane) {
        self.eos.stiffen(chunk, speed);
    }

    fn viscosity(&self) -> f64 {
        self.strength.viscosity()
    }

    fn stored_energy(&self, state: &State, out: &mut Lane) {
        for p in 0..state.len {
            let sigma = state.stress(p);
            let j = state.value(Column::J, p);
            out[p / 4][p % 4] = match self.eos.initial_energy() {
                None => 0.5 * j * sigma.dot(&self.strain(state, p, &sigma)),
                Some(_) => {
                    let shape = deviator(&sigma).dot(&self.strain(state, p, &sigma));
                    state.value(Column::InternalEnergy, p) + 0.5 * j * shape
                }
            };
        }
    }

    fn elastic_strain(&self, state: &State, out: &mut [Lane; 6]) {
        write_strain(state, out, |p| self.strain(state, p, &state.stress(p)));
    }

    fn accepts_initial_stress(&self) -> bool {
        true
    }

    fn initial_temperature(&self) -> f64 {
        self.temperature.as_ref().map_or(0.0, |law| law.initial())
    }

    fn thermal(&self) -> Thermal {
        self.temperature.as_ref().map_or_else(Thermal::default, |law| law.thermal())
    }

    fn internal_energy(&self, state: &State, p: usize) -> f64 {
        match (self.eos.initial_energy(), &self.temperature) {
            (Some(_), _) => state.value(Column::InternalEnergy, p),
            (None, Some(_)) => self.eos.energy(state.value(Column::Temperature, p)),
            (None, None) => 0.0,
        }
    }

    fn has_artificial_viscosity(&self) -> bool {
        self.eos.is_viscous()
    }

    fn viscous_pressure(&self, chunk: &Chunk<'_>, p: usize) -> f64 {
        self.eos.viscous_pressure(chunk, p)
    }

    fn heating(&self, state: &State, p: usize) -> f64 {
        let Some(law) = &self.temperature else {
            return 0.0;
        };
        let sigma = state.stress(p);
        let deviator = deviator(&sigma);
        let rate = state.value(Column::PlasticStrainRate, p);
        law.power(state.value(Column::Temperature, p), 1.5f64.sqrt() * deviator.norm(), rate)
    }
}

impl EosStrength {
    /// ln J/3 I + s/(2 G (1 - D)), the second term 0 where s = 0, in fluids too.
    fn strain(&self, state: &State, p: usize, sigma: &Tensor) -> Tensor {
        let deviator = deviator(sigma);
        let volume = Tensor::identity() * (state.value(Column::J, p).ln() / 3.0);
        let stiffness = 2.0 * self.strength.shear() * (1.0 - state.value(Column::Damage, p));
        if stiffness > 0.0 { volume + deviator / stiffness } else { volume }
    }
}

fn deviator(sigma: &Tensor) -> Tensor {
    sigma - Tensor::identity() * (sigma.trace() / 3.0)
}

/// sqrt((K_t + 4 G/3) J/rho0), from K_t in `out`; 0 where D = 1.
struct Speed<'a> {
    shear: f64,
    inverse_density: f64,
    state: &'a State,
    out: &'a mut Lane,
}

impl Sweep for Speed<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let (shear, inverse) = (V::splat(self.shear), V::splat(self.inverse_density));
        for group in self.state.groups() {
            let j: V = self.state.four(Column::J, group);
            let damage: V = self.state.four(Column::Damage, group);
            let lane = &mut self.out[group];
            let speed = ((V::load(lane) + shear) * j * inverse).sqrt();
            damage.below(V::splat(1.0), speed, V::splat(0.0)).store(lane);
        }
    }
}
