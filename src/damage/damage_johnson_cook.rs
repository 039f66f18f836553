//! Johnson-Cook failure strain.

use super::{BuildDamage, Damage};
use crate::material::stages::Stages;
use crate::material::{Chunk, State};
use crate::math::transcendental::{exp, ln};
use crate::math::v4::{Sweep, Wide, dispatch};
use crate::model::column::Column;
use crate::script::arguments::Args;
use crate::script::diagnostic::Diagnostic;
use crate::style::Style;
use crate::temperature::homologous;
use std::sync::Arc;

/// The row of the table.
pub const STYLE: Style<BuildDamage> = Style {
    name: "damage_johnson_cook",
    usage: "d1, d2, d3, d4, d5, epsdot0, Tr, Tm",
    summary: "Johnson-Cook failure strain",
    manual: "\
ef = (d1 + d2 exp(d3 s*)) (1 + d4 ln max(epdot/epsdot0, 1)) (1 + d5 T*), s* = -p/q,
T* = (T - Tr)/(Tm - Tr) clamped to [0, 1]; D_init += dep/ef; D = min(10 (D_init - 1), 1) once
D_init >= 1; neither ever decreases. Particles with D = 1 carry no stress, keep their volume and heat
no more, from the step in which they fail.
epsdot0 [1/T] (> 0 needed only if d4 is not 0), Tm > Tr [K] (needed only if d5 is not 0).
Source: Johnson and Cook 1985; de Vaucorbeil et al. 2020, eqs 2.14 to 2.16.",
    build: Some(|args| Ok(Arc::new(read(args)?))),
};

/// From D_init = 1 on, D grows so much faster than D_init.
const GROWTH: f64 = 10.0;

/// Failure strains below this count as this: a particle fails at once, but 0/0 is no number.
const LEAST_STRAIN: f64 = 1e-12;

/// Triaxialities beyond these count as these: exp(d3 s*) stays finite.
const TRIAXIALITY: f64 = 1e3;

fn read(args: &mut Args<'_>) -> Result<DamageJohnsonCook, Diagnostic> {
    let old = args.remaining() == 5;
    if old {
        let given: Vec<&str> = (0..5).filter_map(|ahead| args.peek_at(ahead)).collect();
        let (first, rate) = (given[..4].join(", "), given[4]);
        args.old_form(&format!("damage(ID, damage_johnson_cook, {first}, 0, {rate}, 0, 1)"));
    }
    let names = ["d1", "d2", "d3", "d4", "d5"];
    let mut d = [0.0; 5];
    for (d, name) in d.iter_mut().zip(names).take(if old { 4 } else { 5 }) {
        *d = args.number(name)?.value;
    }
    let rate = args.number("the reference rate epsdot0")?;
    if d[3] != 0.0 && rate.known && rate.value <= 0.0 {
        let message = "the reference rate epsdot0 must be greater than 0 where d4 is not 0";
        return Err(args.out_of_range(&rate, message));
    }
    let (mut reference, mut melting) = (0.0, 1.0);
    if !old {
        reference = args.number("the reference temperature Tr")?.value;
        let number = args.number("the melting temperature Tm")?;
        if d[4] != 0.0 && number.known && number.value <= reference {
            return Err(args.out_of_range(&number, "Tm must be greater than Tr"));
        }
        melting = number.value;
    }
    Ok(DamageJohnsonCook { d, reference_rate: rate.value, reference, melting })
}

/// ef = (d1 + d2 exp(d3 s*)) (1 + d4 ln max(epdot/epsdot0, 1)) (1 + d5 T*), s* = -p/q.
///
/// # Source  Johnson and Cook 1985; de Vaucorbeil et al. 2020, eqs 2.14 to 2.16
#[derive(Clone, Copy, Debug)]
pub struct DamageJohnsonCook {
    /// d1 to d5.
    pub d: [f64; 5],
    /// epsdot0 \[1/T\].
    pub reference_rate: f64,
    /// Tr \[K\].
    pub reference: f64,
    /// Tm \[K\].
    pub melting: f64,
}

impl Damage for DamageJohnsonCook {
    fn reads_temperature(&self) -> bool {
        self.d[4] != 0.0
    }

    fn grow(&self, chunk: &mut Chunk<'_>, stages: &mut Stages) {
        let dt = chunk.dt;
        match (self.d[3] != 0.0, self.d[4] != 0.0) {
            (false, false) => dispatch(Grow::<false, false> { law: self, dt, chunk, stages }),
            (false, true) => dispatch(Grow::<false, true> { law: self, dt, chunk, stages }),
            (true, false) => dispatch(Grow::<true, false> { law: self, dt, chunk, stages }),
            (true, true) => dispatch(Grow::<true, true> { law: self, dt, chunk, stages }),
        }
    }
}

struct Grow<'a, 'b, const RATE: bool, const HEAT: bool> {
    law: &'a DamageJohnsonCook,
    dt: f64,
    chunk: &'a mut Chunk<'b>,
    stages: &'a mut Stages,
}

impl<const RATE: bool, const HEAT: bool> Sweep for Grow<'_, '_, RATE, HEAT> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let Stages { pressure, equivalent, increment } = self.stages;
        let state = &mut *self.chunk.state;
        let (zero, one) = (V::splat(0.0), V::splat(1.0));
        for group in state.groups() {
            let step = V::load(&increment[group]);
            if !zero.any_below(step) {
                continue;
            }
            let stress = [V::load(&pressure[group]), V::load(&equivalent[group])];
            let rate = step / V::splat(self.dt);
            let strain = self.law.failure_strain::<V, RATE, HEAT>(state, group, stress, rate);
            let growth = zero.below(step, step / strain, zero);
            let begun = state.four::<V>(Column::DamageInitiation, group) + growth;
            let damage: V = state.four(Column::Damage, group);
            let grown = (V::splat(GROWTH) * (begun - one)).smaller(one).larger(damage);
            state.set_four(Column::DamageInitiation, group, begun);
            state.set_four(Column::Damage, group, grown);
            // What fails has no stress left that could heat it.
            grown.below(one, stress[1], zero).store(&mut equivalent[group]);
        }
    }
}

impl DamageJohnsonCook {
    /// ef of four particles, from p and q and the rate of plastic strain.
    #[inline(always)]
    fn failure_strain<V: Wide, const RATE: bool, const HEAT: bool>(
        &self,
        state: &State,
        group: usize,
        [pressure, equivalent]: [V; 2],
        rate: V,
    ) -> V {
        let [d1, d2, d3, d4, d5] = self.d;
        let (zero, one, most) = (V::splat(0.0), V::splat(1.0), V::splat(TRIAXIALITY));
        let tension = zero - pressure;
        // Without any deviator the triaxiality is as large as can be, or nothing.
        let limit = tension.below(zero, zero - most, zero.below(tension, most, zero));
        let ratio = zero.below(equivalent, tension / equivalent, limit);
        let ratio = ratio.smaller(most).larger(zero - most);
        let mut strain = V::splat(d2).mul_add(exp(V::splat(d3) * ratio), V::splat(d1));
        if RATE {
            let relative = (rate * V::splat(1.0 / self.reference_rate)).larger(one);
            strain = strain * V::splat(d4).mul_add(ln(relative), one);
        }
        if HEAT {
            let t: V = state.four(Column::Temperature, group);
            let heat = homologous(t, self.reference, self.melting);
            strain = strain * V::splat(d5).mul_add(heat, one);
        }
        strain.larger(V::splat(LEAST_STRAIN))
    }
}
