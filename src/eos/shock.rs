//! Mie-Grueneisen solids with a linear shock curve.

use super::{BuildEos, Eos, Viscosity};
use crate::material::{Chunk, Lane, State};
use crate::math::v4::{Sweep, Wide, dispatch};
use crate::model::column::Column;
use crate::script::arguments::Args;
use crate::script::diagnostic::Diagnostic;
use crate::style::Style;
use std::sync::Arc;

/// The row of the table.
pub const STYLE: Style<BuildEos> = Style {
    name: "shock",
    usage: "rho0, K, c0, S, Gamma, cv, Tr, Q1, Q2",
    summary: "Mie-Grueneisen with a linear shock curve and artificial viscosity",
    manual: "\
p = rho0 c0^2 x (eta - Gamma/2 x)/(eta - S x)^2 + Gamma e, eta = rho/rho0, x = eta - 1,
e = rho0 cv (T - Tr) if the material has a temperature law, else 0. Where tr D < 0 the artificial
viscosity rho h (Q1 h tr^2 D - Q2 c0 sqrt(J) tr D) is added. Beyond 98 % of the pole
eta = S/(S - 1) the curve goes on along its tangent; the run counts how often.
rho0 [M/L^d], K [P] (lower bound of the stiffness in dt), c0 [L/T], cv [L^2/(T^2 K)], Tr [K].
Stiffness in the wave speed: max(K, rho dp/drho).
Source: de Vaucorbeil et al. 2020, eqs 2.8 to 2.10.",
    build: Some(|args| Ok(Arc::new(read(args)?))),
};

/// Beyond this part of the pole the curve is its tangent.
const LAST: f64 = 0.98;

/// Above this slope, 98 % of the pole S/(S - 1) would lie in tension.
const STEEPEST: f64 = 49.0;

fn read(args: &mut Args<'_>) -> Result<Shock, Diagnostic> {
    let old = args.remaining() == 6;
    if old {
        let text = |ahead: usize| args.peek_at(ahead).unwrap_or("").to_string();
        let modern = format!(
            "eos(ID, shock, {}, {}, {}, {}, {}, 0, 0, 0, 0)",
            text(0),
            text(1),
            text(2),
            text(4),
            text(5)
        );
        args.old_form(&modern);
    }
    let density = args.positive("the density rho0")?.value;
    let bulk = args.positive("the bulk modulus K")?.value;
    let sound = args.positive("the sound speed c0")?.value;
    if old {
        let energy = args.number("the initial energy e0")?;
        if energy.known && energy.value != 0.0 {
            let message = "the initial energy e0 of the old form must be 0";
            return Err(args.out_of_range(&energy, message));
        }
    }
    let slope = args.within("the slope S of the shock curve", f64::NEG_INFINITY, STEEPEST)?.value;
    let gamma = args.number("Grueneisen's Gamma")?.value;
    let mut shock = Shock {
        density,
        bulk,
        sound,
        slope,
        gamma,
        heat_capacity: 0.0,
        reference: 0.0,
        quadratic: 0.0,
        linear: 0.0,
    };
    if !old {
        shock.heat_capacity = args.within("the heat capacity cv", 0.0, f64::INFINITY)?.value;
        shock.reference = args.number("the reference temperature Tr")?.value;
        shock.quadratic = args.within("the viscosity Q1", 0.0, f64::INFINITY)?.value;
        shock.linear = args.within("the viscosity Q2", 0.0, f64::INFINITY)?.value;
    }
    Ok(shock)
}

/// p = rho0 c0^2 x (eta - Gamma/2 x)/(eta - S x)^2 + Gamma e, eta = rho/rho0, x = eta - 1.
///
/// # Source  de Vaucorbeil et al. 2020, eqs 2.8 to 2.10
#[derive(Clone, Copy, Debug)]
pub struct Shock {
    /// rho0 \[M/L^d\].
    pub density: f64,
    /// K \[P\].
    pub bulk: f64,
    /// c0 \[L/T\].
    pub sound: f64,
    /// S.
    pub slope: f64,
    /// Gamma.
    pub gamma: f64,
    /// cv \[L^2/(T^2 K)\].
    pub heat_capacity: f64,
    /// Tr \[K\].
    pub reference: f64,
    /// Q1.
    pub quadratic: f64,
    /// Q2.
    pub linear: f64,
}

impl Eos for Shock {
    fn density(&self) -> f64 {
        self.density
    }

    fn bulk(&self) -> f64 {
        self.bulk
    }

    fn pressure(&self, chunk: &mut Chunk<'_>, heated: bool, pressure: &mut Lane) {
        let curve = self.curve();
        let most = dispatch(Pressure { curve, state: chunk.state, pressure });
        if most > curve.limit {
            chunk.count_clipped(1.0 / (1.0 + curve.limit));
        }
        let heating = self.gamma * self.density * self.heat_capacity;
        if heated && heating != 0.0 {
            let reference = self.reference;
            dispatch(Thermal { heating, reference, state: chunk.state, pressure });
        }
    }

    fn stiffness(&self, state: &State, stiffness: &mut Lane) {
        dispatch(Stiffness { curve: self.curve(), bulk: self.bulk, state, stiffness });
    }

    fn viscosity(&self) -> Option<Viscosity> {
        let Shock { quadratic, linear, sound, .. } = *self;
        (quadratic > 0.0 || linear > 0.0).then_some(Viscosity { quadratic, linear, sound })
    }

    fn energy(&self, temperature: f64) -> f64 {
        self.density * self.heat_capacity * (temperature - self.reference)
    }
}

impl Shock {
    fn curve(&self) -> Curve {
        let pole = self.slope / (self.slope - 1.0);
        Curve {
            modulus: self.density * self.sound * self.sound,
            quadratic: 1.0 - 0.5 * self.gamma,
            slope: self.slope - 1.0,
            limit: if self.slope > 1.0 { LAST * pole - 1.0 } else { f64::INFINITY },
        }
    }
}

/// The curve p(x) of the compression x = rho/rho0 - 1.
#[derive(Clone, Copy)]
struct Curve {
    /// rho0 c0^2.
    modulus: f64,
    /// 1 - Gamma/2: eta - Gamma/2 x = 1 + (1 - Gamma/2) x.
    quadratic: f64,
    /// S - 1: eta - S x = 1 - (S - 1) x.
    slope: f64,
    /// Beyond this x the curve is its tangent.
    limit: f64,
}

impl Curve {
    /// p and dp/dx.
    #[inline(always)]
    fn values<V: Wide>(&self, x: V) -> [V; 2] {
        let (one, two) = (V::splat(1.0), V::splat(2.0));
        let (quadratic, slope) = (V::splat(self.quadratic), V::splat(self.slope));
        let within = x.smaller(V::splat(self.limit));
        let inverse = one / (one - slope * within);
        let scale = V::splat(self.modulus) * inverse * inverse;
        let curved = quadratic * within;
        let shape = within * (one + curved);
        let tangent = scale * (one + two * curved + two * slope * shape * inverse);
        [tangent.mul_add(x - within, scale * shape), tangent]
    }
}

struct Pressure<'a> {
    curve: Curve,
    state: &'a State,
    pressure: &'a mut Lane,
}

impl Sweep for Pressure<'_> {
    /// The largest compression.
    type Output = f64;

    #[inline(always)]
    fn run<V: Wide>(self) -> f64 {
        let one = V::splat(1.0);
        let mut most = V::splat(f64::NEG_INFINITY);
        for group in self.state.groups() {
            let j: V = self.state.four(Column::J, group);
            let x = (one - j) / j;
            most = x.larger(most);
            let [pressure, _] = self.curve.values(x);
            pressure.store(&mut self.pressure[group]);
        }
        let most = most.array();
        most[0].max(most[1]).max(most[2]).max(most[3])
    }
}

/// p += Gamma rho0 cv (T - Tr).
struct Thermal<'a> {
    heating: f64,
    reference: f64,
    state: &'a State,
    pressure: &'a mut Lane,
}

impl Sweep for Thermal<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let (heating, reference) = (V::splat(self.heating), V::splat(self.reference));
        for group in self.state.groups() {
            let t: V = self.state.four(Column::Temperature, group);
            let lane = &mut self.pressure[group];
            heating.mul_add(t - reference, V::load(lane)).store(lane);
        }
    }
}

/// max(K, rho dp/drho).
struct Stiffness<'a> {
    curve: Curve,
    bulk: f64,
    state: &'a State,
    stiffness: &'a mut Lane,
}

impl Sweep for Stiffness<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let one = V::splat(1.0);
        for group in self.state.groups() {
            let j: V = self.state.four(Column::J, group);
            let [_, tangent] = self.curve.values((one - j) / j);
            (tangent / j).larger(V::splat(self.bulk)).store(&mut self.stiffness[group]);
        }
    }
}
