//! Johnson-Cook flow stress.

use super::flow::{Flow, flow};
use super::{BuildStrength, Strength};
use crate::material::stages::Stages;
use crate::material::{Chunk, State};
use crate::math::transcendental::{Growth, ln, power};
use crate::math::v4::Wide;
use crate::model::column::Column;
use crate::script::arguments::Args;
use crate::script::diagnostic::Diagnostic;
use crate::style::Style;
use crate::temperature::homologous;
use std::sync::Arc;

/// The row of the table.
pub const STYLE: Style<BuildStrength> = Style {
    name: "johnson_cook",
    usage: "G, A, B, n, epsdot0, C, m, Tr, Tm",
    summary: "Johnson-Cook flow stress: hardening, rate, heat",
    manual: "\
Y = (A + B ep^n) (1 + C ln max(epdot/epsdot0, 1)) (1 - T*^m) (1 - D), T* = (T - Tr)/(Tm - Tr)
clamped to [0, 1]. The plastic increment solves q - 3 G (1 - D) dep = Y(ep + dep, dep/dt, T) by a
safeguarded Newton iteration. G [P], A, B, n, C, m >= 0, A and B [P], epsdot0 [1/T] (> 0 needed
only if C > 0), Tm > Tr [K]. C = 0 or m = 0 switch their factor off.
Source: Johnson and Cook 1985; de Vaucorbeil et al. 2020, eqs 2.11, 2.12.",
    build: Some(|args| Ok(Arc::new(read(args)?))),
};

fn read(args: &mut Args<'_>) -> Result<JohnsonCook, Diagnostic> {
    let old = args.remaining() == 6;
    if old {
        let given: Vec<&str> = (0..6).filter_map(|ahead| args.peek_at(ahead)).collect();
        let modern = format!("strength(ID, johnson_cook, {}, 0, 0, 1)", given.join(", "));
        args.old_form(&modern);
    }
    let not_negative = |args: &mut Args<'_>, what: &str| {
        args.within(what, 0.0, f64::INFINITY).map(|number| number.value)
    };
    let shear = args.positive("the shear modulus G")?.value;
    let initial = not_negative(args, "the initial flow stress A")?;
    let hardening = not_negative(args, "the hardening B")?;
    let exponent = not_negative(args, "the exponent n")?;
    let rate = args.number("the reference rate epsdot0")?;
    let sensitivity = not_negative(args, "the rate sensitivity C")?;
    if sensitivity > 0.0 && rate.known && rate.value <= 0.0 {
        let message = "the reference rate epsdot0 must be greater than 0 where C is";
        return Err(args.out_of_range(&rate, message));
    }
    let reference_rate = rate.value;
    let mut law = JohnsonCook {
        shear,
        initial,
        hardening,
        exponent,
        reference_rate,
        sensitivity,
        softening: 0.0,
        reference: 0.0,
        melting: 1.0,
    };
    if !old {
        law.softening = not_negative(args, "the exponent m")?;
        law.reference = args.number("the reference temperature Tr")?.value;
        let melting = args.number("the melting temperature Tm")?;
        if melting.known && melting.value <= law.reference {
            return Err(args.out_of_range(&melting, "Tm must be greater than Tr"));
        }
        law.melting = melting.value;
    }
    Ok(law)
}

/// Y = (A + B ep^n) (1 + C ln max(epdot/epsdot0, 1)) (1 - T*^m) (1 - D).
///
/// # Source  Johnson and Cook 1985; de Vaucorbeil et al. 2020, eqs 2.11, 2.12
#[derive(Clone, Copy, Debug)]
pub struct JohnsonCook {
    /// G \[P\].
    pub shear: f64,
    /// A \[P\].
    pub initial: f64,
    /// B \[P\].
    pub hardening: f64,
    /// n.
    pub exponent: f64,
    /// epsdot0 \[1/T\].
    pub reference_rate: f64,
    /// C.
    pub sensitivity: f64,
    /// m.
    pub softening: f64,
    /// Tr \[K\].
    pub reference: f64,
    /// Tm \[K\].
    pub melting: f64,
}

impl Strength for JohnsonCook {
    fn shear(&self) -> f64 {
        self.shear
    }

    fn columns(&self) -> &'static [Column] {
        &[Column::PlasticStrain, Column::PlasticStrainRate]
    }

    fn reads_temperature(&self) -> bool {
        self.softening > 0.0
    }

    fn deviator(&self, damaged: bool, chunk: &mut Chunk<'_>, stages: &mut Stages) {
        match (self.softening > 0.0, self.sensitivity > 0.0) {
            (true, true) => self.flow::<true, true>(damaged, chunk, stages),
            (true, false) => self.flow::<true, false>(damaged, chunk, stages),
            (false, true) => self.flow::<false, true>(damaged, chunk, stages),
            (false, false) => self.flow::<false, false>(damaged, chunk, stages),
        }
    }
}

impl JohnsonCook {
    fn flow<const HEAT: bool, const RATE: bool>(
        &self,
        damaged: bool,
        chunk: &mut Chunk<'_>,
        stages: &mut Stages,
    ) {
        let law = Factors::<HEAT, RATE>(*self, Growth::new(self.exponent));
        flow(law, self.shear, damaged, chunk, stages);
    }
}

/// The law with those of the factors of heat and of rate that are switched on, and the growth of
/// its hardening B ep^n.
#[derive(Clone, Copy)]
struct Factors<const HEAT: bool, const RATE: bool>(JohnsonCook, Growth);

impl<const HEAT: bool, const RATE: bool> Factors<HEAT, RATE> {
    #[inline(always)]
    fn homologous<V: Wide>(&self, state: &State, group: usize) -> V {
        homologous(state.four(Column::Temperature, group), self.0.reference, self.0.melting)
    }
}

impl<const HEAT: bool, const RATE: bool> Flow for Factors<HEAT, RATE> {
    #[inline(always)]
    fn softening<V: Wide>(&self, state: &State, group: usize) -> V {
        match HEAT {
            true => V::splat(1.0) - power(self.homologous(state, group), self.0.softening),
            false => V::splat(1.0),
        }
    }

    /// A min(m, 1) (1 - T*): T*^m lies below T* for m > 1, below its tangent at 1 for m < 1.
    #[inline(always)]
    fn floor<V: Wide>(&self, state: &State, group: usize) -> V {
        let initial = V::splat(self.0.initial);
        match HEAT {
            true => {
                let part = V::splat(self.0.softening.min(1.0));
                initial * part * (V::splat(1.0) - self.homologous(state, group))
            }
            false => initial,
        }
    }

    #[inline(always)]
    fn at_rest<V: Wide>(&self, strain: V) -> V {
        let raised = power(strain, self.0.exponent);
        V::splat(self.0.hardening).mul_add(raised, V::splat(self.0.initial))
    }

    #[inline(always)]
    fn moving<V: Wide>(&self, strain: V, rest: V, increment: V, dt: f64) -> [V; 3] {
        let (zero, one, initial) = (V::splat(0.0), V::splat(1.0), V::splat(self.0.initial));
        let [factor, near] = self.1.factor(increment / strain);
        let strain = strain + increment;
        let inverse = one / strain;
        let mut hardened = (rest - initial) * factor;
        if near.any_below(one) {
            let raised = V::splat(self.0.hardening) * power(strain, self.0.exponent);
            hardened = zero.below(near, hardened, raised);
        }
        let stress = initial + hardened;
        let slope = V::splat(self.0.exponent) * hardened * inverse;
        let curvature = V::splat(self.0.exponent - 1.0) * slope * inverse;
        if !RATE {
            return [stress, slope, curvature];
        }
        let sensitivity = V::splat(self.0.sensitivity);
        let ratio = increment * V::splat(1.0 / (dt * self.0.reference_rate));
        let factor = sensitivity.mul_add(ln(ratio.larger(one)), one);
        let inverse = one / increment;
        let rise = one.below(ratio, sensitivity * inverse, zero);
        let bend = rise * (slope + slope - stress * inverse);
        [stress * factor, slope.mul_add(factor, stress * rise), curvature.mul_add(factor, bend)]
    }

    #[inline(always)]
    fn smoothness<V: Wide>(&self, strain: V, increment: V, dt: f64) -> V {
        match RATE {
            true => {
                let kink = V::splat(dt * self.0.reference_rate);
                increment.smaller((increment - kink).absolute())
            }
            false => strain + increment,
        }
    }
}
