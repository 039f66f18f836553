//! Material laws: velocity gradient in, stress and wave speed out.
//!
//! A law is called once for every chunk of up to [`LANES`] particles; its loops run over plain
//! slices of the particle columns, so that they vectorise.

#[cfg(test)]
mod conformance;
pub mod linear;
pub mod neo_hookean;

use crate::math::tensor::Tensor;
use crate::math::v4::{Sweep, Wide, dispatch};
use crate::model::column::{COLUMNS, Column, ColumnSet};
use crate::script::arguments::Args;
use crate::script::diagnostic::{Code, Diagnostic};
use crate::style::Style;
use std::sync::Arc;

/// Builds a law from its arguments.
pub type BuildMaterial = fn(&mut Args<'_>) -> Result<Arc<dyn Law>, Diagnostic>;

/// All material styles.
pub const MATERIALS: &[Style<BuildMaterial>] = &[
    linear::STYLE,
    neo_hookean::STYLE,
    reserved(
        "eos-strength",
        "eosID, strengthID [, damageID] [, temperatureID]",
        "pressure from an equation of state, deviator from a strength law",
    ),
    reserved("rigid", "[rho]", "prescribed motion"),
    reserved("von-mises", "rho, E, nu, sigma_y [, H]", "von Mises plasticity"),
    reserved(
        "mohr-coulomb",
        "rho, E, nu, c, phi, psi [, sigma_t [, H, c_res, phi_res, psi_res]]",
        "Mohr-Coulomb plasticity of soils",
    ),
    reserved(
        "drucker-prager",
        "rho, E, nu, c, phi, psi [, sigma_t [, H, c_res, phi_res, psi_res]] [, inner|plane-strain]",
        "Drucker-Prager plasticity of soils",
    ),
];

const fn reserved(
    name: &'static str,
    usage: &'static str,
    summary: &'static str,
) -> Style<BuildMaterial> {
    Style { name, usage, summary, manual: "", build: None }
}

/// Lame's constants of an isotropic material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elastic {
    /// Reference density \[M/L^d\].
    pub density: f64,
    /// lambda = E nu/((1 + nu)(1 - 2 nu)) \[P\].
    pub lambda: f64,
    /// G = E/(2 (1 + nu)) \[P\].
    pub shear: f64,
}

impl Elastic {
    /// From density, Young's modulus and Poisson's ratio.
    pub fn new(density: f64, young: f64, poisson: f64) -> Self {
        let lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
        Self { density, lambda, shear: young / (2.0 * (1.0 + poisson)) }
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
    fn read(args: &mut Args<'_>) -> Result<Self, Diagnostic> {
        let density = args.positive("the density rho")?;
        let young = args.positive("Young's modulus E")?;
        let poisson = args.number("Poisson's ratio nu")?;
        if poisson.known && !(poisson.value > -1.0 && poisson.value < 0.5) {
            return Err(args.out_of_range(&poisson, "Poisson's ratio must lie in -1 < nu < 0.5"));
        }
        if args.remaining() > 0 {
            return Err(Diagnostic::error(
                Code::NotAvailable,
                args.next_span(),
                "heat capacity and conductivity are known, but not available yet",
            )
            .label("not available yet"));
        }
        Ok(Self::new(density.value, young.value, poisson.value))
    }
}

/// Particles per call of a law.
pub const LANES: usize = 64;

/// One number per particle of a chunk.
pub type Lane = [f64; LANES];

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

/// A chunk of particles of one law, to be advanced by dt.
pub struct Chunk<'a> {
    /// 1, 2 (plane strain) or 3.
    pub dimension: usize,
    /// Size of the step \[T\].
    pub dt: f64,
    /// The objective rate of the run.
    pub rate: StressRate,
    /// Velocity gradient L_ij = dv_i/dx_j \[1/T\], entry 3 i + j; entries beyond the dimension are 0.
    pub gradient: [&'a Lane; 9],
    /// The particles' part of every column, in the order of [`Column`]; empty where absent.
    pub columns: [&'a mut [f64]; COLUMNS],
    /// Number of particles in the chunk.
    pub len: usize,
    /// First particle of the chunk with J <= 0 or a value that is not finite.
    pub failed: Option<usize>,
}

impl Chunk<'_> {
    /// Several columns to write at once.
    ///
    /// # Panics
    /// If a column is named twice: an error of the law.
    #[inline(always)]
    pub fn borrow<const N: usize>(&mut self, which: [Column; N]) -> [&mut [f64]; N] {
        let picked = self.columns.get_disjoint_mut(which.map(|column| column as usize));
        picked.expect("a law names each column once").map(|column| &mut **column)
    }
}

impl Chunk<'_> {
    /// The state, to be read.
    pub fn view(&self) -> View<'_> {
        let columns = self.columns.each_ref().map(|column| &**column);
        View { dimension: self.dimension, len: self.len, columns }
    }

    /// L of particle `p`.
    pub fn velocity_gradient(&self, p: usize) -> Tensor {
        Tensor::from_fn(|i, j| self.gradient[3 * i + j][p])
    }

    /// Stores F of particle `p` in the columns that exist.
    pub fn set_deformation(&mut self, p: usize, f: &Tensor) {
        use Column::*;
        let entries = [F11, F12, F13, F21, F22, F23, F31, F32, F33];
        for (entry, column) in entries.into_iter().enumerate() {
            if let Some(value) = self.columns[column as usize].get_mut(p) {
                *value = f[(entry / 3, entry % 3)];
            }
        }
    }

    /// Stores the stress of particle `p` in the columns that exist.
    pub fn set_stress(&mut self, p: usize, sigma: &Tensor) {
        use Column::*;
        let entries =
            [(S11, 0, 0), (S22, 1, 1), (S33, 2, 2), (S12, 0, 1), (S13, 0, 2), (S23, 1, 2)];
        for (column, i, j) in entries {
            if let Some(value) = self.columns[column as usize].get_mut(p) {
                *value = sigma[(i, j)];
            }
        }
    }
}

/// The state of a chunk of particles of one law, to be read.
pub struct View<'a> {
    /// 1, 2 or 3.
    pub dimension: usize,
    /// Number of particles.
    pub len: usize,
    /// The particles' part of every column; empty where absent.
    pub columns: [&'a [f64]; COLUMNS],
}

impl View<'_> {
    /// A column; empty where absent.
    #[inline(always)]
    pub fn column(&self, column: Column) -> &[f64] {
        self.columns[column as usize]
    }
}

/// A material law.
pub trait Law: Send + Sync {
    /// The columns that hold the law's state.
    fn columns(&self, dimension: usize, rate: StressRate) -> ColumnSet;

    /// Reference density rho0 \[M/L^d\].
    fn density(&self) -> f64;

    /// Largest wave speed of the undeformed material \[L/T\].
    fn reference_wave_speed(&self) -> f64;

    /// Advances F or J and the Cauchy stress by one step.
    fn update(&self, chunk: &mut Chunk<'_>);

    /// Wave speed of each particle \[L/T\] (language.md 9.5).
    fn wave_speed(&self, view: &View<'_>, out: &mut Lane);

    /// Stored energy per reference volume \[P\] (language.md 9.6).
    fn stored_energy(&self, view: &View<'_>, out: &mut Lane);

    /// Elastic strain 11, 22, 33, 12, 13, 23 in space axes (neo-hookean: Green-Lagrange).
    fn elastic_strain(&self, view: &View<'_>, out: &mut [Lane; 6]);

    /// Sets the stress to a given Cauchy stress (11, 22, 33, 12, 13, 23), as `initial_stress` does;
    /// false if the law computes its stress from the deformation alone.
    fn accepts_initial_stress(&self) -> bool;
}

/// The update of four particles at once: N state columns, M entries of the velocity gradient.
pub trait Update<const N: usize, const M: usize> {
    /// The new state; implementations are `#[inline(always)]`.
    fn update<V: Wide>(&self, state: [V; N], gradient: [V; M]) -> [V; N];
}

/// Advances the state columns of a chunk, four particles at a time; `entries` of the velocity
/// gradient go to the update.
pub fn four_at_once<const N: usize, const M: usize>(
    chunk: &mut Chunk<'_>,
    state: [Column; N],
    entries: [usize; M],
    update: impl Update<N, M>,
) {
    let len = chunk.len;
    let gradient = chunk.gradient;
    let columns = chunk.borrow(state);
    dispatch(FourAtOnce { len, columns, gradient: entries.map(|entry| gradient[entry]), update });
}

struct FourAtOnce<'a, U, const N: usize, const M: usize> {
    len: usize,
    columns: [&'a mut [f64]; N],
    gradient: [&'a Lane; M],
    update: U,
}

impl<U: Update<N, M>, const N: usize, const M: usize> Sweep for FourAtOnce<'_, U, N, M> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let Self { len, columns, gradient, update } = self;
        let mut start = 0;
        while start < len {
            let count = (len - start).min(4);
            let mut four = [[0.0; 4]; N];
            let mut rates = [V::splat(0.0); M];
            for m in 0..M {
                if let Some(values) = gradient[m].get(start..).and_then(<[f64]>::first_chunk) {
                    rates[m] = V::load(values);
                }
            }
            if count == 4 {
                let mut old = [V::splat(0.0); N];
                for n in 0..N {
                    if let Some(values) = columns[n].get(start..).and_then(<[f64]>::first_chunk) {
                        old[n] = V::load(values);
                    }
                }
                let new = update.update(old, rates);
                for n in 0..N {
                    if let Some(values) =
                        columns[n].get_mut(start..).and_then(<[f64]>::first_chunk_mut)
                    {
                        new[n].store(values);
                    }
                }
            } else {
                let mut old = [V::splat(0.0); N];
                for n in 0..N {
                    four[n][..count].copy_from_slice(&columns[n][start..]);
                    old[n] = V::load(&four[n]);
                }
                let new = update.update(old, rates);
                for n in 0..N {
                    columns[n][start..].copy_from_slice(&new[n].array()[..count]);
                }
            }
            start += 4;
        }
    }
}

/// The deformation gradient of particle `p` of a view; the identity where there is no column.
pub fn deformation(view: &View<'_>, p: usize) -> Tensor {
    use Column::*;
    let mut f = Tensor::identity();
    for (entry, column) in [F11, F12, F13, F21, F22, F23, F31, F32, F33].into_iter().enumerate() {
        if let Some(value) = view.column(column).get(p) {
            f[(entry / 3, entry % 3)] = *value;
        }
    }
    f
}

/// F <- (I + dt L) F.
pub fn advance_deformation(chunk: &mut Chunk<'_>) {
    for p in 0..chunk.len {
        let old = deformation(&chunk.view(), p);
        let step = chunk.velocity_gradient(p) * chunk.dt;
        chunk.set_deformation(p, &(old + step * old));
    }
}

/// The Cauchy stress of particle `p` of a view.
pub fn stress(view: &View<'_>, p: usize) -> Tensor {
    use Column::*;
    let s = |column: Column| view.column(column).get(p).copied().unwrap_or(0.0);
    let (s12, s13, s23) = (s(S12), s(S13), s(S23));
    Tensor::new(s(S11), s12, s13, s12, s(S22), s23, s13, s23, s(S33))
}

/// The first value that is not a positive finite number.
pub fn first_not_positive(values: &[f64]) -> Option<usize> {
    let good = |value: &f64| (*value > 0.0) & (*value < f64::INFINITY);
    // Without a branch per value, since all are good nearly always.
    if values.iter().fold(true, |all, value| all & good(value)) {
        return None;
    }
    values.iter().position(|value| !good(value))
}
