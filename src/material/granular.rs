//! What the laws of soils share: Hooke's trial stress, then a return to a yield surface that
//! depends on the mean stress, whose strength may fall with the plastic strain (language.md 9.4).
//!
//! A law of soils is a [`Surface`]; [`Granular`] makes a material law of it.

use super::linear::Linear;
use super::state::{PLACES, STRESS};
use super::{Chunk, Elastic, Lane, Law, State};
use crate::math::principal::Principal;
use crate::math::tensor::{Tensor, symmetric};
use crate::math::v4::{Sweep, Wide, dispatch, splats};
use crate::model::column::{Column, ColumnSet};
use crate::script::arguments::{Args, Number};
use crate::script::diagnostic::{Code, Diagnostic};

/// Cohesion and angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strength {
    /// c \[P\].
    pub cohesion: f64,
    /// phi \[radians\].
    pub friction: f64,
    /// psi \[radians\].
    pub dilatancy: f64,
}

impl Strength {
    /// Mean stress c cot phi of the apex \[P\]: infinite without friction.
    pub fn apex(&self) -> f64 {
        match self.friction > 0.0 {
            true => self.cohesion / self.friction.tan(),
            false => f64::INFINITY,
        }
    }

    /// self + part (other - self).
    fn towards(&self, other: &Strength, part: f64) -> Strength {
        let between = |from: f64, to: f64| part.mul_add(to - from, from);
        Strength {
            cohesion: between(self.cohesion, other.cohesion),
            friction: between(self.friction, other.friction),
            dilatancy: between(self.dilatancy, other.dilatancy),
        }
    }
}

/// c, phi and psi go linearly to their residual values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Softening {
    /// Plastic strain (c - c_res)/H at which the residual strength is reached.
    pub span: f64,
    /// The residual strength.
    pub residual: Strength,
}

/// The numbers of a yield surface and its potential of given strength.
pub const CONSTANTS: usize = 5;

/// A yield surface f(sigma) <= 0 with a potential.
pub trait Surface: Copy + Send + Sync {
    /// The numbers of the surface; no principal stress (mohr-coulomb) or mean stress
    /// (drucker-prager) beyond `limit` is left.
    fn constants(&self, elastic: &Elastic, strength: &Strength, limit: f64) -> [f64; CONSTANTS];

    /// False only if all four stresses of the given mean and sqrt(J2) certainly lie inside.
    fn may_yield<V: Wide>(constants: &[V; CONSTANTS], mean: V, root: V) -> bool;

    /// The three numbers of a stress 11, 22, 33, 12, 13, 23 that the surface knows.
    fn resolve<V: Wide, const D: usize>(stress: &[V; 6], mean: V, root: V) -> Principal<V>;

    /// The same three numbers after the return; those of stresses inside keep every bit.
    fn bring_back<V: Wide>(elastic: &Elastic, constants: &[V; CONSTANTS], values: [V; 3])
    -> [V; 3];

    /// Increment of the equivalent plastic strain, sqrt(2/3) |dev dep|, between two values.
    fn flow<V: Wide>(elastic: &Elastic, from: [V; 3], to: [V; 3]) -> V;

    /// The stress of the new values; the old one, bit for bit, where they are the old values.
    fn assemble<V: Wide, const D: usize>(
        stress: &[V; 6],
        resolved: &Principal<V>,
        to: [V; 3],
    ) -> [V; 6];
}

/// Does component `n` of 11, 22, 33, 12, 13, 23 exist in `D` dimensions?
#[inline(always)]
pub const fn exists<const D: usize>(n: usize) -> bool {
    n < 3 || PLACES[n].1 < D
}

/// Hooke's law and a yield surface.
///
/// # Source  language.md 9.4
#[derive(Clone, Copy, Debug)]
pub struct Granular<S> {
    /// Moduli.
    pub elastic: Elastic,
    /// The shape of the yield surface.
    pub surface: S,
    /// Strength before any plastic strain.
    pub strength: Strength,
    /// Tension cut-off sigma_t \[P\]; infinite: the apex alone.
    pub tension: f64,
    /// How the strength falls.
    pub softening: Option<Softening>,
}

impl<S: Surface> Granular<S> {
    /// Reads `rho, E, nu, c, phi, psi [, sigma_t [, H, c_res, phi_res, psi_res]]` up to the word
    /// that ends the numbers.
    pub(super) fn read(
        args: &mut Args<'_>,
        is_last_word: fn(&str) -> bool,
        surface: impl FnOnce(&mut Args<'_>) -> Result<S, Diagnostic>,
    ) -> Result<Self, Diagnostic> {
        let elastic = Elastic::read_moduli(args)?;
        let strength = read_strength(args, ["c", "phi", "psi"])?;
        let more = |args: &Args<'_>| args.peek().is_some_and(|word| !is_last_word(word));
        let mut tension = f64::INFINITY;
        if more(args) {
            tension = args.within("the tension cut-off sigma_t", 0.0, f64::INFINITY)?.value;
        }
        let mut softening = None;
        if more(args) {
            let modulus = args.within("the softening modulus H", 0.0, f64::INFINITY)?;
            softening = read_softening(args, &strength, &modulus)?;
        }
        Ok(Self { elastic, surface: surface(args)?, strength, tension, softening })
    }

    /// The numbers of the surface of a strength.
    fn constants(&self, strength: &Strength) -> [f64; CONSTANTS] {
        let limit = strength.apex().min(self.tension);
        self.surface.constants(&self.elastic, strength, limit)
    }
}

/// Reads cohesion and two angles in degrees.
fn read_strength(args: &mut Args<'_>, names: [&str; 3]) -> Result<Strength, Diagnostic> {
    let [c, phi, psi] = names;
    let cohesion = args.within(&format!("the cohesion {c}"), 0.0, f64::INFINITY)?;
    let friction = read_angle(args, &format!("the angle of friction {phi}"))?;
    let dilatancy = read_angle(args, &format!("the angle of dilatancy {psi}"))?;
    if dilatancy.value > friction.value {
        let message = format!("{psi} is greater than {phi}: plastic flow makes energy");
        args.remarks.push(
            Diagnostic::warning(Code::NotPhysical, dilatancy.span, message)
                .label("the angle of dilatancy")
                .help(format!("materials have 0 <= {psi} <= {phi}")),
        );
    }
    Ok(Strength {
        cohesion: cohesion.value,
        friction: friction.value.to_radians(),
        dilatancy: dilatancy.value.to_radians(),
    })
}

/// Reads an angle in degrees, 0 <= angle < 90.
fn read_angle(args: &mut Args<'_>, what: &str) -> Result<Number, Diagnostic> {
    let angle = args.number(what)?;
    if angle.known && !(0.0..90.0).contains(&angle.value) {
        let message = format!("{what} must lie in 0 <= angle < 90 degrees");
        return Err(args.out_of_range(&angle, &message));
    }
    Ok(angle)
}

/// Reads the residual strength; `None` if it is never reached or no other one.
fn read_softening(
    args: &mut Args<'_>,
    strength: &Strength,
    modulus: &Number,
) -> Result<Option<Softening>, Diagnostic> {
    let span = args.next_span();
    let residual = read_strength(args, ["c_res", "phi_res", "psi_res"])?;
    let fall = strength.cohesion - residual.cohesion;
    if fall < 0.0 || fall == 0.0 && residual != *strength {
        let message = "the residual cohesion c_res must be less than c";
        return Err(Diagnostic::error(Code::Range, span, message)
            .label("is no less")
            .help("c, phi and psi fall together, by the part H ep/(c - c_res)"));
    }
    if modulus.value == 0.0 && residual != *strength {
        let message = "without a softening modulus H the residual strength is never reached";
        args.remarks.push(
            Diagnostic::warning(Code::NoEffect, modulus.span, message)
                .label("H = 0 softens nothing"),
        );
    }
    let softens = fall > 0.0 && modulus.value > 0.0;
    Ok(softens.then(|| Softening { span: fall / modulus.value, residual }))
}

impl<S: Surface> Law for Granular<S> {
    fn columns(&self, dimension: usize) -> ColumnSet {
        let mut columns = Linear(self.elastic).columns(dimension);
        columns.extend(&[Column::PlasticStrain, Column::PlasticStrainRate]);
        columns
    }

    fn is_incremental(&self) -> bool {
        true
    }

    fn density(&self) -> f64 {
        self.elastic.density
    }

    fn moduli(&self) -> [f64; 2] {
        [self.elastic.bulk(), self.elastic.shear]
    }

    fn reference_wave_speed(&self) -> f64 {
        self.elastic.wave_speed()
    }

    fn update(&self, chunk: &mut Chunk<'_>) {
        Linear(self.elastic).update(chunk);
        match chunk.state.dimension {
            1 => dispatch(Return::<S, 1> { law: self, chunk }),
            2 => dispatch(Return::<S, 2> { law: self, chunk }),
            _ => dispatch(Return::<S, 3> { law: self, chunk }),
        }
    }

    fn wave_speed(&self, state: &State, out: &mut Lane) {
        Linear(self.elastic).wave_speed(state, out);
    }

    fn stored_energy(&self, state: &State, out: &mut Lane) {
        Linear(self.elastic).stored_energy(state, out);
    }

    fn elastic_strain(&self, state: &State, out: &mut [Lane; 6]) {
        Linear(self.elastic).elastic_strain(state, out);
    }

    fn accepts_initial_stress(&self) -> bool {
        true
    }

    /// sigma : (dt D - C^-1 (sigma - sigma0)): the volume that dilatancy makes takes part.
    fn plastic_work(&self, chunk: &Chunk<'_>, p: usize, old: &Tensor, _flow: f64) -> f64 {
        let sigma = chunk.state.stress(p);
        let strain = symmetric(&chunk.velocity_gradient(p)) * chunk.dt;
        sigma.dot(&(strain - Linear(self.elastic).strain(&(sigma - old))))
    }
}

/// The return of a chunk's trial stresses in `D` dimensions.
struct Return<'a, 'b, S, const D: usize> {
    law: &'a Granular<S>,
    chunk: &'a mut Chunk<'b>,
}

impl<S: Surface, const D: usize> Sweep for Return<'_, '_, S, D> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let Self { law, chunk } = self;
        let (state, rate) = (&mut *chunk.state, V::splat(1.0 / chunk.dt));
        let softening = Strengths::new(law);
        let peak = splats(law.constants(&law.strength));
        for group in state.groups() {
            let stress: [V; 6] = state.fours(STRESS, group);
            let strain: V = state.four(Column::PlasticStrain, group);
            let (mean, root) = invariants::<V, D>(&stress);
            let constants = match &softening {
                Some(strengths) => strengths.at(strain),
                None => peak,
            };
            if !S::may_yield(&constants, mean, root) {
                state.set_four(Column::PlasticStrainRate, group, V::splat(0.0));
                continue;
            }
            let resolved = S::resolve::<V, D>(&stress, mean, root);
            let mut to = S::bring_back(&law.elastic, &constants, resolved.values);
            let mut flow = S::flow(&law.elastic, resolved.values, to);
            if let Some(strengths) = &softening {
                (to, flow) = strengths.soften(strain, resolved.values, to, flow);
            }
            let changed = S::assemble::<V, D>(&stress, &resolved, to);
            for n in 0..6 {
                if exists::<D>(n) {
                    state.set_four(STRESS[n], group, changed[n]);
                }
            }
            state.set_four(Column::PlasticStrain, group, strain + flow);
            state.set_four(Column::PlasticStrainRate, group, rate * flow);
        }
    }
}

/// sm = tr sigma/3 and sqrt(J2).
#[inline(always)]
fn invariants<V: Wide, const D: usize>(stress: &[V; 6]) -> (V, V) {
    let mean = V::splat(1.0 / 3.0) * (stress[0] + stress[1] + stress[2]);
    let (mut square, half) = (V::splat(0.0), V::splat(0.5));
    for axis in 0..3 {
        let s = stress[axis] - mean;
        square = (half * s).mul_add(s, square);
    }
    for n in 3..6 {
        if exists::<D>(n) {
            square = stress[n].mul_add(stress[n], square);
        }
    }
    (mean, square.sqrt())
}

/// The strengths of a softening law.
struct Strengths<'a, S> {
    law: &'a Granular<S>,
    softening: &'a Softening,
}

/// A plastic increment solves its equation when it is off by less than this part of itself.
const ACCURACY: f64 = 1e-13;

/// Strains below this part of the elastic strain are round-off.
const ROUND_OFF: f64 = 4e-16;

/// Steps of the search for a plastic increment: halving alone finds it to round-off.
const MOST_STEPS: usize = 60;

impl<'a, S: Surface> Strengths<'a, S> {
    fn new(law: &'a Granular<S>) -> Option<Self> {
        law.softening.as_ref().map(|softening| Self { law, softening })
    }

    /// The numbers of the surface at four plastic strains.
    #[inline(always)]
    fn at<V: Wide>(&self, strain: V) -> [V; CONSTANTS] {
        let Self { law, softening } = self;
        if !V::splat(0.0).any_below(strain) {
            return splats(law.constants(&law.strength));
        }
        if !strain.any_below(V::splat(softening.span)) {
            return splats(law.constants(&softening.residual));
        }
        let mut lanes = [[0.0; 4]; CONSTANTS];
        for (lane, strain) in strain.array().into_iter().enumerate() {
            let part = (strain / softening.span).min(1.0);
            let strength = law.strength.towards(&softening.residual, part);
            for (constant, value) in lanes.iter_mut().zip(law.constants(&strength)) {
                constant[lane] = value;
            }
        }
        let mut constants = [V::splat(0.0); CONSTANTS];
        for n in 0..CONSTANTS {
            constants[n] = V::load(&lanes[n]);
        }
        constants
    }

    /// Values and plastic increment d with d = g(ep + d), where g is the increment that the strength
    /// of a plastic strain gives; `to` and `flow` are those of the strength at the start of the
    /// step. A strength that falls faster than the elastic strain is released falls at once to the
    /// residual one.
    ///
    /// The root lies between 0, where the remainder g - d is `flow`, and the d that leaves the
    /// residual strength; regula falsi with Illinois' halving, each particle for itself.
    ///
    /// # Source  Dowell and Jarratt 1971
    #[inline(never)]
    fn soften<V: Wide>(&self, strain: V, values: [V; 3], to: [V; 3], flow: V) -> ([V; 3], V) {
        let elastic = &self.law.elastic;
        let (zero, half, one) = (V::splat(0.0), V::splat(0.5), V::splat(1.0));
        let (accuracy, least) = (V::splat(ACCURACY), V::splat(ROUND_OFF / elastic.shear));
        let size = values[0].absolute() + values[1].absolute() + values[2].absolute();
        let round_off = least * size;
        let left = (V::splat(self.softening.span) - strain).larger(zero);
        let last =
            S::bring_back(elastic, &splats(self.law.constants(&self.softening.residual)), values);
        let last_flow = S::flow(elastic, values, last);

        // The strength of the start where nothing flows, the residual one where all is lost.
        let mut found = (to, flow);
        let lost = last_flow.below(left, zero, zero.below(flow, one, zero));
        blend(&mut found, lost, (last, last_flow));
        let mut open = zero.below(flow, one - lost, zero);
        let (mut low, mut high) = (zero, left);
        let (mut above, mut below) = (flow, last_flow - left);
        // 1 where the last step has moved the lower end, -1 where it has moved the upper one.
        let mut moved = zero;
        for _ in 0..MOST_STEPS {
            if !half.any_below(open) {
                break;
            }
            let next = low + (high - low) * (above / (above - below));
            let stress = S::bring_back(elastic, &self.at(strain + next), values);
            let rest = S::flow(elastic, values, stress) - next;
            blend(&mut found, open, (stress, next));
            let bound = accuracy.mul_add(next, round_off);
            open = rest.absolute().below(bound, zero, open);
            // An end that stays twice counts half, so that both ends close in.
            let staying_above = moved.below(zero, half * above, above);
            let staying_below = zero.below(moved, half * below, below);
            above = rest.below(zero, staying_above, rest);
            below = rest.below(zero, rest, staying_below);
            moved = rest.below(zero, zero - one, one);
            low = rest.below(zero, low, next);
            high = rest.below(zero, next, high);
        }
        found
    }
}

/// found <- other where mask = 1.
#[inline(always)]
fn blend<V: Wide>(found: &mut ([V; 3], V), mask: V, other: ([V; 3], V)) {
    let half = V::splat(0.5);
    for n in 0..3 {
        found.0[n] = half.below(mask, other.0[n], found.0[n]);
    }
    found.1 = half.below(mask, other.1, found.1);
}
