//! Swift hardening.

use super::flow::{Flow, flow};
use super::{BuildStrength, Strength};
use crate::material::stages::Stages;
use crate::material::{Chunk, State};
use crate::math::transcendental::power;
use crate::math::v4::Wide;
use crate::model::column::Column;
use crate::style::Style;
use std::sync::Arc;

/// The row of the table.
pub const STYLE: Style<BuildStrength> = Style {
    name: "swift",
    usage: "G, A, B, C, n",
    summary: "Swift hardening: a plateau, then a power of the plastic strain",
    manual: "\
Y = (1 - D) (A + B (ep - C)^n) for ep > C, else (1 - D) A. G [P], A >= 0 [P], B >= 0 [P],
C >= 0, n >= 0. The plastic increment solves q - 3 G (1 - D) dep = Y(ep + dep).
Source: Swift 1952.",
    build: Some(|args| {
        let positive = |args: &mut crate::script::arguments::Args<'_>, what: &str| {
            args.within(what, 0.0, f64::INFINITY).map(|number| number.value)
        };
        let shear = args.positive("the shear modulus G")?.value;
        let initial = positive(args, "the initial flow stress A")?;
        let hardening = positive(args, "the hardening B")?;
        let plateau = positive(args, "the strain C at the end of the plateau")?;
        let exponent = positive(args, "the exponent n")?;
        Ok(Arc::new(Swift { shear, initial, hardening, plateau, exponent }))
    }),
};

/// Y = (1 - D) (A + B (ep - C)^n) for ep > C, else (1 - D) A.
///
/// # Source  Swift 1952; language.md 9.3
#[derive(Clone, Copy, Debug)]
pub struct Swift {
    /// G \[P\].
    pub shear: f64,
    /// A \[P\].
    pub initial: f64,
    /// B \[P\].
    pub hardening: f64,
    /// C.
    pub plateau: f64,
    /// n.
    pub exponent: f64,
}

impl Strength for Swift {
    fn shear(&self) -> f64 {
        self.shear
    }

    fn columns(&self) -> &'static [Column] {
        &[Column::PlasticStrain, Column::PlasticStrainRate]
    }

    fn deviator(&self, damaged: bool, chunk: &mut Chunk<'_>, stages: &mut Stages) {
        flow(*self, self.shear, damaged, chunk, stages);
    }
}

impl Swift {
    /// ep - C, if that is positive.
    #[inline(always)]
    fn beyond<V: Wide>(&self, strain: V) -> V {
        (strain - V::splat(self.plateau)).larger(V::splat(0.0))
    }
}

impl Flow for Swift {
    #[inline(always)]
    fn softening<V: Wide>(&self, _state: &State, _group: usize) -> V {
        V::splat(1.0)
    }

    #[inline(always)]
    fn floor<V: Wide>(&self, _state: &State, _group: usize) -> V {
        V::splat(self.initial)
    }

    #[inline(always)]
    fn at_rest<V: Wide>(&self, strain: V) -> V {
        let raised = power(self.beyond(strain), self.exponent);
        V::splat(self.hardening).mul_add(raised, V::splat(self.initial))
    }

    #[inline(always)]
    fn moving<V: Wide>(&self, strain: V, _rest: V, increment: V, _dt: f64) -> [V; 3] {
        let beyond = self.beyond(strain + increment);
        let inverse = V::splat(1.0) / beyond.larger(V::splat(1e-150));
        let hardened = V::splat(self.hardening) * power(beyond, self.exponent);
        let slope = V::splat(self.exponent) * hardened * inverse;
        let curvature = V::splat(self.exponent - 1.0) * slope * inverse;
        [V::splat(self.initial) + hardened, slope, curvature]
    }

    #[inline(always)]
    fn smoothness<V: Wide>(&self, strain: V, increment: V, _dt: f64) -> V {
        (strain + increment - V::splat(self.plateau)).absolute()
    }
}
