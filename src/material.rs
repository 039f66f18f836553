//! Material laws: velocity gradient in, stress and wave speed out.
//!
//! A law is called once for every chunk of up to [`LANES`] particles, whose columns lie before it in
//! groups of four ([`state`]). F, J and the turning of stresses are no business of the law: they
//! are done before it is called ([`kinematics`]).

#[cfg(test)]
mod conformance;
pub mod drucker_prager;
pub mod eos_strength;
pub mod granular;
#[cfg(test)]
mod granular_paths;
pub mod kinematics;
pub mod linear;
pub mod mohr_coulomb;
pub mod neo_hookean;
#[cfg(test)]
mod plasticity;
pub mod point;
pub mod rigid;
pub mod stages;
pub mod state;
pub mod von_mises;

use crate::damage::Damage;
use crate::eos::Eos;
use crate::math::tensor::Tensor;
use crate::model::column::{Column, ColumnSet};
use crate::script::arguments::{Args, Name};
use crate::script::diagnostic::{Code, Diagnostic};
use crate::strength::Strength;
use crate::style::Style;
use crate::temperature::Temperature;
use std::sync::Arc;

pub use kinematics::Description;
pub use state::{Chunk, GROUPS, LANES, Lane, NOTHING, State};

/// Builds a law from its arguments and what they name.
pub type BuildMaterial = fn(&mut Args<'_>, &Families<'_>) -> Result<Arc<dyn Law>, Diagnostic>;

/// Finds an object by its ID.
pub type Find<'a, T> = &'a dyn Fn(&Name) -> Result<T, Diagnostic>;

/// The objects that a composite law may name.
pub struct Families<'a> {
    /// Equations of state.
    pub eos: Find<'a, Arc<dyn Eos>>,
    /// Strength laws.
    pub strength: Find<'a, Arc<dyn Strength>>,
    /// Damage and temperature laws.
    pub either: Find<'a, Family>,
}

/// One of the optional parts of a composite law.
pub enum Family {
    /// A damage law.
    Damage(Arc<dyn Damage>),
    /// A temperature law.
    Temperature(Arc<dyn Temperature>),
}

/// The mistake of two laws of one family in a material.
fn second_of_family(name: &Name) -> Diagnostic {
    let message = format!("`{}` is the second law of its family here", name.text);
    Diagnostic::error(Code::Duplicate, name.span, message)
        .label("a material has at most one damage and one temperature law")
}

/// All material styles.
pub const MATERIALS: &[Style<BuildMaterial>] = &[
    linear::STYLE,
    neo_hookean::STYLE,
    eos_strength::STYLE,
    von_mises::STYLE,
    rigid::STYLE,
    mohr_coulomb::STYLE,
    drucker_prager::STYLE,
];

/// Lame's constants of an isotropic material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elastic {
    /// Reference density \[M/L^d\].
    pub density: f64,
    /// lambda = E nu/((1 + nu)(1 - 2 nu)) \[P\].
    pub lambda: f64,
    /// G = E/(2 (1 + nu)) \[P\].
    pub shear: f64,
    /// Heat capacity and conductivity, if they are given.
    pub thermal: Thermal,
}

/// How a material stores and conducts heat (language.md 7.6).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Thermal {
    /// Heat capacity per mass cp \[L^2/(T^2 K)\]; 0: the material has no temperature of its own.
    pub capacity: f64,
    /// Conductivity kappa \[M L/(T^3 K)\]: the flux of heat is -kappa grad T.
    pub conductivity: f64,
}

impl Thermal {
    /// Reads `cp, kappa`.
    fn read(args: &mut Args<'_>) -> Result<Self, Diagnostic> {
        let capacity = args.positive("the heat capacity cp")?.value;
        let conductivity = args.within("the conductivity kappa", 0.0, f64::INFINITY)?.value;
        Ok(Self { capacity, conductivity })
    }

    /// Diffusivity kappa/(rho cp) \[L^2/T\]; 0 without a heat capacity.
    pub fn diffusivity(&self, density: f64) -> f64 {
        match self.capacity > 0.0 {
            true => self.conductivity / (density * self.capacity),
            false => 0.0,
        }
    }
}

impl Elastic {
    /// From density, Young's modulus and Poisson's ratio.
    pub fn new(density: f64, young: f64, poisson: f64) -> Self {
        let lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
        let shear = young / (2.0 * (1.0 + poisson));
        Self { density, lambda, shear, thermal: Thermal::default() }
    }

    /// Bulk modulus K = lambda + 2 G/3 \[P\].
    pub fn bulk(&self) -> f64 {
        self.lambda + 2.0 / 3.0 * self.shear
    }

    /// Wave speed of the undeformed material, sqrt((K + 4 G/3)/rho0) \[L/T\].
    pub fn wave_speed(&self) -> f64 {
        ((self.lambda + 2.0 * self.shear) / self.density).sqrt()
    }

    /// Reads `rho, E, nu`.
    fn read_moduli(args: &mut Args<'_>) -> Result<Self, Diagnostic> {
        let density = args.positive("the density rho")?;
        let young = args.positive("Young's modulus E")?;
        let poisson = args.number("Poisson's ratio nu")?;
        if poisson.known && !(poisson.value > -1.0 && poisson.value < 0.5) {
            return Err(args.out_of_range(&poisson, "Poisson's ratio must lie in -1 < nu < 0.5"));
        }
        Ok(Self::new(density.value, young.value, poisson.value))
    }

    /// Reads `rho, E, nu [, cp, kappa]`.
    fn read(args: &mut Args<'_>) -> Result<Self, Diagnostic> {
        let mut elastic = Self::read_moduli(args)?;
        if args.remaining() > 0 {
            elastic.thermal = Thermal::read(args)?;
        }
        Ok(elastic)
    }
}

/// Objective rate of hypoelastic laws in updated Lagrangian methods (language.md 9.2).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StressRate {
    /// No rotation of the stress (not objective; Karamelo's choice).
    None,
    /// Cayley transform of the spin (Hughes-Winget).
    #[default]
    Jaumann,
    /// Rotation of the polar decomposition.
    GreenNaghdi,
    /// Logarithmic spin.
    Logarithmic,
}

/// A material law.
pub trait Law: Send + Sync {
    /// The columns that hold the law's state, apart from F and J.
    fn columns(&self, dimension: usize) -> ColumnSet;

    /// Does the stress grow by increments, from the rate of deformation (hypoelasticity,
    /// plasticity)? Then an objective rate turns it; otherwise it follows from F.
    fn is_incremental(&self) -> bool;

    /// Reference density rho0 \[M/L^d\].
    fn density(&self) -> f64;

    /// Bulk and shear modulus K, G of the undeformed material \[P\]: the stiffness of contact.
    fn moduli(&self) -> [f64; 2];

    /// Values of a new particle, in columns where they are not those of the table.
    fn initial_values(&self) -> Vec<(Column, f64)> {
        Vec::new()
    }

    /// Does the law read J at the start of the step too?
    fn reads_volume_before(&self) -> bool {
        false
    }

    /// Does the body keep its shape and its velocity?
    fn is_rigid(&self) -> bool {
        false
    }

    /// Largest wave speed of the undeformed material \[L/T\].
    fn reference_wave_speed(&self) -> f64;

    /// Brings the stress to the end of the step: F and J are those of the end already, stored
    /// stresses have been turned.
    fn update(&self, chunk: &mut Chunk<'_>);

    /// Wave speed of each particle \[L/T\] (language.md 9.5).
    fn wave_speed(&self, state: &State, out: &mut Lane);

    /// Raises wave speeds by what the motion asks for: artificial viscosity.
    fn stiffen(&self, _chunk: &Chunk<'_>, _speed: &mut Lane) {}

    /// Viscosity mu \[P T\] of fluids.
    fn viscosity(&self) -> f64 {
        0.0
    }

    /// Stored energy per reference volume \[P\] (language.md 9.6).
    fn stored_energy(&self, state: &State, out: &mut Lane);

    /// Elastic strain 11, 22, 33, 12, 13, 23 in the axes of the stored stress (neo-hookean:
    /// Green-Lagrange).
    fn elastic_strain(&self, state: &State, out: &mut [Lane; 6]);

    /// Does the stress keep a given value, as `initial_stress` sets it? False if the law computes
    /// its stress from the deformation alone.
    fn accepts_initial_stress(&self) -> bool;

    /// Temperature \[K\] of a solid whose script gives none.
    fn initial_temperature(&self) -> f64 {
        0.0
    }

    /// Heat capacity and conductivity; with a capacity the temperature of particles is stored.
    fn thermal(&self) -> Thermal {
        Thermal::default()
    }

    /// Internal energy e \[P\] of particle `p`.
    fn internal_energy(&self, _state: &State, _p: usize) -> f64 {
        0.0
    }

    /// Is there artificial viscosity in compression?
    fn has_artificial_viscosity(&self) -> bool {
        false
    }

    /// Its part of the pressure \[P\] of particle `p` at the end of a step.
    fn viscous_pressure(&self, _chunk: &Chunk<'_>, _p: usize) -> f64 {
        0.0
    }

    /// Plastic work per volume in the step \[P\] of particle `p`, whose stress was `old`, in the
    /// axes of the new one, and whose equivalent plastic strain has grown by `flow`: q flow.
    fn plastic_work(&self, chunk: &Chunk<'_>, p: usize, _old: &Tensor, flow: f64) -> f64 {
        let sigma = chunk.state.stress(p);
        let deviator = sigma - Tensor::identity() * (sigma.trace() / 3.0);
        1.5f64.sqrt() * deviator.norm() * flow
    }

    /// Heating power per volume \[P/T\] of particle `p`.
    fn heating(&self, _state: &State, _p: usize) -> f64 {
        0.0
    }
}

/// Writes the elastic strain of every particle, tensor by tensor.
pub fn write_strain(state: &State, out: &mut [Lane; 6], strain: impl Fn(usize) -> Tensor) {
    for p in 0..state.len {
        let e = strain(p);
        for (lane, place) in out.iter_mut().zip(state::PLACES) {
            lane[p / 4][p % 4] = e[place];
        }
    }
}
