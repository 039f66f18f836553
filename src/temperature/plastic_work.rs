//! Heat from plastic work.

use super::{BuildTemperature, Temperature};
use crate::material::stages::Stages;
use crate::material::{Chunk, Thermal};
use crate::math::v4::{Sweep, Wide, dispatch};
use crate::model::column::Column;
use crate::script::arguments::Args;
use crate::script::diagnostic::Diagnostic;
use crate::style::Style;
use std::sync::Arc;

/// The row of the table.
pub const STYLE: Style<BuildTemperature> = Style {
    name: "plastic_work",
    usage: "chi, cp, kappa, alpha, T0, Tm",
    summary: "heat from plastic work, thermal expansion",
    manual: "\
dT = chi sigma_f dep/(rho cp) while T < Tm, sigma_f the flow stress; p += 3 K alpha (T - T0).
0 <= chi <= 1, cp > 0 [L^2/(T^2 K)], kappa >= 0 [M L/(T^3 K)] (read by thermo-mechanical runs
only), alpha [1/K], T0 [K], the initial temperature unless a solid gives its own, Tm [K].
Source: de Vaucorbeil et al. 2020, eq. 2.13.",
    build: Some(|args| Ok(Arc::new(read(args)?))),
};

fn read(args: &mut Args<'_>) -> Result<PlasticWork, Diagnostic> {
    let part = args.within("the part chi of the work that becomes heat", 0.0, 1.0)?.value;
    let capacity = args.positive("the heat capacity cp")?.value;
    let conductivity = args.within("the conductivity kappa", 0.0, f64::INFINITY)?.value;
    let thermal = Thermal { capacity, conductivity };
    let expansion = args.number("the linear expansion alpha")?.value;
    let initial = args.number("the initial temperature T0")?.value;
    let melting = args.number("the melting temperature Tm")?.value;
    Ok(PlasticWork { part, thermal, expansion, initial, melting })
}

/// dT = chi sigma_f dep/(rho cp) while T < Tm; p += 3 K alpha (T - T0).
///
/// # Source  de Vaucorbeil et al. 2020, eq. 2.13; language.md 9.3
#[derive(Clone, Copy, Debug)]
pub struct PlasticWork {
    /// chi.
    pub part: f64,
    /// cp \[L^2/(T^2 K)\] and kappa \[M L/(T^3 K)\].
    pub thermal: Thermal,
    /// alpha \[1/K\].
    pub expansion: f64,
    /// T0 \[K\].
    pub initial: f64,
    /// Tm \[K\].
    pub melting: f64,
}

impl Temperature for PlasticWork {
    fn initial(&self) -> f64 {
        self.initial
    }

    fn thermal(&self) -> Thermal {
        self.thermal
    }

    fn add_pressure(&self, bulk: f64, chunk: &Chunk<'_>, stages: &mut Stages) {
        let factor = 3.0 * bulk * self.expansion;
        if factor != 0.0 {
            dispatch(Expand { factor, initial: self.initial, chunk, stages });
        }
    }

    fn heat(&self, density: f64, chunk: &mut Chunk<'_>, stages: &Stages) {
        let factor = self.part / (density * self.thermal.capacity);
        dispatch(Heat { factor, melting: self.melting, chunk, stages });
    }

    fn power(&self, temperature: f64, equivalent: f64, rate: f64) -> f64 {
        if temperature < self.melting { self.part * equivalent * rate } else { 0.0 }
    }
}

struct Expand<'a, 'b> {
    factor: f64,
    initial: f64,
    chunk: &'a Chunk<'b>,
    stages: &'a mut Stages,
}

impl Sweep for Expand<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let (factor, initial) = (V::splat(self.factor), V::splat(self.initial));
        for group in self.chunk.state.groups() {
            let t: V = self.chunk.state.four(Column::Temperature, group);
            let lane = &mut self.stages.pressure[group];
            factor.mul_add(t - initial, V::load(lane)).store(lane);
        }
    }
}

struct Heat<'a, 'b> {
    factor: f64,
    melting: f64,
    chunk: &'a mut Chunk<'b>,
    stages: &'a Stages,
}

impl Sweep for Heat<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let (factor, melting) = (V::splat(self.factor), V::splat(self.melting));
        let state = &mut *self.chunk.state;
        for group in state.groups() {
            let t: V = state.four(Column::Temperature, group);
            let j: V = state.four(Column::J, group);
            let work =
                V::load(&self.stages.equivalent[group]) * V::load(&self.stages.increment[group]);
            let heated = (factor * j).mul_add(work, t);
            state.set_four(Column::Temperature, group, t.below(melting, heated, t));
        }
    }
}
