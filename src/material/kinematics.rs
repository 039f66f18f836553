//! What happens to F, J and stored stresses before a law acts (language.md 9.1, 9.2).

use super::state::{
    Chunk, DEFORMATION, PLACES, STRESS, State, load_tensor, store_tensor, symmetric_tensor,
};
use super::{Law, StressRate};
use crate::math::tensor::{Tensor, cayley, logarithmic_spin, rotation};
use crate::math::v4::{Sweep, Wide, dispatch};
use crate::math::wide::{
    self, Four, cofactors, in_space, product, product_transposed, squared_stretches,
    transposed_product,
};
use crate::model::column::{Column, ColumnSet};

/// How the deformation of a body is described.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Description {
    /// Updated Lagrangian: L = dv/dx; stored stresses are turned with an objective rate.
    Updated(StressRate),
    /// Total Lagrangian: dF/dt = dv/dX; stresses are stored turned back by R of F = R U.
    Total,
}

impl Default for Description {
    fn default() -> Self {
        Description::Updated(StressRate::default())
    }
}

/// Calls a sweep for 1, 2 or 3 dimensions.
macro_rules! in_dimensions {
    ($dimension:expr, $sweep:ident { $($field:tt)* }) => {
        match $dimension {
            1 => dispatch($sweep::<1> { $($field)* }),
            2 => dispatch($sweep::<2> { $($field)* }),
            _ => dispatch($sweep::<3> { $($field)* }),
        }
    };
}

impl Description {
    /// Columns that a law and its kinematics need.
    pub fn columns(self, law: &dyn Law, dimension: usize) -> ColumnSet {
        let mut columns = law.columns(dimension);
        columns.insert(Column::J);
        if !law.is_incremental() || self.turns_with_deformation(dimension) {
            columns.extend(Column::deformation(dimension));
        }
        columns
    }

    /// Does the axes' turning follow from F?
    fn turns_with_deformation(self, dimension: usize) -> bool {
        use StressRate::*;
        match self {
            Description::Total => true,
            Description::Updated(rate) => {
                dimension > 1 && matches!(rate, GreenNaghdi | Logarithmic)
            }
        }
    }

    /// Advances F (where the scene has it) and J; brings stored tensors, and the gradient that the
    /// law will see, into the same axes.
    ///
    /// UL: F <- (I + dt L) F, J <- J det(I + dt L) (det F for laws of F), sigma <- Q sigma Q^T.
    /// TL: F <- F + dt dv/dX, J = det F; incremental laws see D^ = R^T sym(dF/dt F^-1) R.
    pub fn advance(self, law: &dyn Law, has_deformation: bool, chunk: &mut Chunk<'_>) {
        let dimension = chunk.state.dimension;
        let incremental = law.is_incremental();
        if chunk.state.has(Column::Damage) {
            chunk.hold_failed();
        }
        if law.reads_volume_before() {
            *chunk.before = *chunk.state.lane(Column::J);
        }
        let good = match self {
            Description::Total => in_dimensions!(dimension, Total { chunk, incremental }),
            Description::Updated(rate) => {
                if incremental && dimension > 1 {
                    turn_stresses(rate, chunk);
                }
                let volume_of_deformation = !incremental;
                match has_deformation {
                    true => in_dimensions!(dimension, Stretch { chunk, volume_of_deformation }),
                    false => in_dimensions!(dimension, Grow { chunk }),
                }
            }
        };
        if !good {
            chunk.find_failure();
        }
    }

    /// R of the present F, where forces need it: what [`Description::advance`] leaves in the chunk.
    pub fn turn(self, law: &dyn Law, chunk: &mut Chunk<'_>) {
        if self == Description::Total && law.is_incremental() {
            in_dimensions!(chunk.state.dimension, Turn { chunk });
        }
    }

    /// Is the stress of this law stored turned back by R?
    pub fn is_turned_back(self, law: &dyn Law) -> bool {
        self == Description::Total && law.is_incremental()
    }

    /// The Cauchy stress of particle `p` in space axes.
    pub fn stress(self, law: &dyn Law, state: &State, p: usize) -> Tensor {
        self.in_space(law, state, p, state.stress(p))
    }

    /// A tensor in the axes of the stored stress, brought into space axes.
    pub fn in_space(self, law: &dyn Law, state: &State, p: usize, stored: Tensor) -> Tensor {
        if !self.is_turned_back(law) {
            return stored;
        }
        let r = rotation(&state.deformation(p));
        r * stored * r.transpose()
    }
}

/// J <- J det(I + dt L).
struct Grow<'a, 'b, const D: usize> {
    chunk: &'a mut Chunk<'b>,
}

impl<const D: usize> Sweep for Grow<'_, '_, D> {
    type Output = bool;

    #[inline(always)]
    fn run<V: Wide>(self) -> bool {
        let Chunk { state, dt, gradient, .. } = self.chunk;
        let mut good = true;
        for group in state.groups() {
            let growth = growth::<V, D>(gradient, V::splat(*dt), group);
            let (_, volume) = cofactors::<V, D>(&growth);
            let j: V = state.four(Column::J, group);
            let j = j * volume;
            good &= j.all_positive();
            state.set_four(Column::J, group, j);
        }
        good
    }
}

/// I + dt L.
#[inline(always)]
fn growth<V: Wide, const D: usize>(gradient: &[super::Lane; 9], dt: V, group: usize) -> Four<V> {
    let mut growth = load_tensor::<V>(gradient, group);
    for entry in 0..9 {
        growth[entry] = match entry % 4 {
            0 => dt.mul_add(growth[entry], V::splat(1.0)),
            _ => dt * growth[entry],
        };
    }
    growth
}

/// F <- (I + dt L) F and J.
struct Stretch<'a, 'b, const D: usize> {
    chunk: &'a mut Chunk<'b>,
    volume_of_deformation: bool,
}

impl<const D: usize> Sweep for Stretch<'_, '_, D> {
    type Output = bool;

    #[inline(always)]
    fn run<V: Wide>(self) -> bool {
        let Chunk { state, dt, gradient, .. } = self.chunk;
        let mut good = true;
        for group in state.groups() {
            let growth = growth::<V, D>(gradient, V::splat(*dt), group);
            let f = product::<V, D>(&growth, &state.deformation_of_four(group));
            store_deformation::<V, D>(state, group, &f);
            let j = match self.volume_of_deformation {
                true => cofactors::<V, D>(&f).1,
                false => state.four::<V>(Column::J, group) * cofactors::<V, D>(&growth).1,
            };
            good &= j.all_positive();
            state.set_four(Column::J, group, j);
        }
        good
    }
}

#[inline(always)]
fn store_deformation<V: Wide, const D: usize>(state: &mut State, group: usize, f: &Four<V>) {
    for entry in 0..9 {
        if in_space::<D>(entry) {
            state.set_four(DEFORMATION[entry], group, f[entry]);
        }
    }
}

/// F <- F + dt dF/dt, J = det F; R and D^ for incremental laws.
struct Total<'a, 'b, const D: usize> {
    chunk: &'a mut Chunk<'b>,
    incremental: bool,
}

impl<const D: usize> Sweep for Total<'_, '_, D> {
    type Output = bool;

    #[inline(always)]
    fn run<V: Wide>(self) -> bool {
        let Chunk { state, dt, gradient, rotation, .. } = self.chunk;
        let mut good = true;
        for group in state.groups() {
            let rate: Four<V> = load_tensor(gradient, group);
            let mut f: Four<V> = state.deformation_of_four(group);
            for entry in 0..9 {
                f[entry] = V::splat(*dt).mul_add(rate[entry], f[entry]);
            }
            store_deformation::<V, D>(state, group, &f);
            let (cofactor, j) = cofactors::<V, D>(&f);
            good &= j.all_positive();
            state.set_four(Column::J, group, j);
            if self.incremental {
                let r = wide::rotation::<V, D>(&f);
                let d = turned_back::<V, D>(&product_transposed::<V, D>(&rate, &cofactor), &r, j);
                store_tensor::<V, D>(rotation, group, &r);
                store_tensor::<V, D>(gradient, group, &d);
            }
        }
        good
    }
}

/// R^T sym(a/j) R.
#[inline(always)]
fn turned_back<V: Wide, const D: usize>(a: &Four<V>, r: &Four<V>, j: V) -> Four<V> {
    let half = V::splat(0.5) / j;
    let mut symmetric = *a;
    for i in 0..D {
        for k in 0..D {
            symmetric[3 * i + k] = half * (a[3 * i + k] + a[3 * k + i]);
        }
    }
    product::<V, D>(&transposed_product::<V, D>(r, &symmetric), r)
}

/// R of F = R U.
struct Turn<'a, 'b, const D: usize> {
    chunk: &'a mut Chunk<'b>,
}

impl<const D: usize> Sweep for Turn<'_, '_, D> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        for group in self.chunk.state.groups() {
            let r = wide::rotation::<V, D>(&self.chunk.state.deformation_of_four(group));
            store_tensor::<V, D>(self.chunk.rotation, group, &r);
        }
    }
}

/// sigma <- Q sigma Q^T, and the same for a stored elastic strain.
fn turn_stresses(rate: StressRate, chunk: &mut Chunk<'_>) {
    match rate {
        StressRate::None => {}
        StressRate::Jaumann if chunk.state.dimension == 2 => dispatch(JaumannInPlane { chunk }),
        StressRate::Jaumann => dispatch(Jaumann { chunk }),
        StressRate::GreenNaghdi | StressRate::Logarithmic => turn_by_deformation(rate, chunk),
    }
}

/// Green-Naghdi and logarithmic rates: rotations that follow from F, before F changes.
fn turn_by_deformation(rate: StressRate, chunk: &mut Chunk<'_>) {
    for p in 0..chunk.state.len {
        let f = chunk.state.deformation(p);
        let l = chunk.velocity_gradient(p);
        let q = match rate {
            StressRate::GreenNaghdi => {
                let new = (Tensor::identity() + l * chunk.dt) * f;
                rotation(&new) * rotation(&f).transpose()
            }
            _ => cayley(&(logarithmic_spin(&f, &l) * (0.5 * chunk.dt))),
        };
        let sigma = chunk.state.stress(p);
        chunk.state.set_symmetric(STRESS, p, &(q * sigma * q.transpose()));
    }
}

/// Q = (I - dt W/2)^-1 (I + dt W/2) in the plane: cos = (1 - a^2)/(1 + a^2), sin = 2 a/(1 + a^2)
/// with a = dt (L21 - L12)/4.
struct JaumannInPlane<'a, 'b> {
    chunk: &'a mut Chunk<'b>,
}

impl Sweep for JaumannInPlane<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let Chunk { state, dt, gradient, .. } = self.chunk;
        let (one, quarter) = (V::splat(1.0), V::splat(0.25 * *dt));
        for group in state.groups() {
            let half = quarter * (V::load(&gradient[3][group]) - V::load(&gradient[1][group]));
            let square = half * half;
            let scale = one / (one + square);
            let (cos, sin) = ((one - square) * scale, (half + half) * scale);
            let (cc, ss, cs) = (cos * cos, sin * sin, cos * sin);
            let turn = [cc, ss, cs];
            turn_in_plane(state, group, turn);
        }
    }
}

/// The stress turned in the plane; cos^2, sin^2 and cos sin of the angle.
#[inline(always)]
fn turn_in_plane<V: Wide>(state: &mut State, group: usize, [cc, ss, cs]: [V; 3]) {
    let [c11, c22, _, c12, ..] = STRESS;
    let [a, b, c]: [V; 3] = state.fours([c11, c22, c12], group);
    let shift = (cs + cs) * c;
    let new = [cc * a + ss * b - shift, ss * a + cc * b + shift, cs * (a - b) + (cc - ss) * c];
    state.set_fours([c11, c22, c12], group, new);
}

/// Q = I + 2/(1 + w.w) (A + A^2), A the skew tensor of w, half the rotation of the step.
struct Jaumann<'a, 'b> {
    chunk: &'a mut Chunk<'b>,
}

impl Sweep for Jaumann<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        let Chunk { state, dt, gradient, .. } = self.chunk;
        let quarter = V::splat(0.25 * *dt);
        for group in state.groups() {
            let l: Four<V> = load_tensor(gradient, group);
            let spin = [quarter * (l[7] - l[5]), quarter * (l[2] - l[6]), quarter * (l[3] - l[1])];
            let q = cayley_of_four(spin);
            turn_four(state, group, &q);
        }
    }
}

#[inline(always)]
fn cayley_of_four<V: Wide>([x, y, z]: [V; 3]) -> Four<V> {
    let one = V::splat(1.0);
    let (xx, yy, zz) = (x * x, y * y, z * z);
    let f = V::splat(2.0) / (one + (xx + yy + zz));
    let (xy, xz, yz) = (x * y, x * z, y * z);
    [
        one - f * (yy + zz),
        f * (xy - z),
        f * (xz + y),
        f * (xy + z),
        one - f * (xx + zz),
        f * (yz - x),
        f * (xz - y),
        f * (yz + x),
        one - f * (xx + yy),
    ]
}

/// The stress sigma becomes Q sigma Q^T.
#[inline(always)]
fn turn_four<V: Wide>(state: &mut State, group: usize, q: &Four<V>) {
    let a: Four<V> = symmetric_tensor(state.fours(STRESS, group));
    let half = product::<V, 3>(q, &a);
    let mut new = [V::splat(0.0); 6];
    for n in 0..6 {
        let (i, j) = PLACES[n];
        let along = half[3 * i + 1].mul_add(q[3 * j + 1], half[3 * i] * q[3 * j]);
        new[n] = half[3 * i + 2].mul_add(q[3 * j + 2], along);
    }
    state.set_fours(STRESS, group, new);
}

/// Smallest squared singular value of F among the particles, at most 1.
pub fn thinnest(state: &State) -> f64 {
    match state.dimension {
        1 => dispatch(Thinnest::<1>(state)),
        2 => dispatch(Thinnest::<2>(state)),
        _ => dispatch(Thinnest::<3>(state)),
    }
}

struct Thinnest<'a, const D: usize>(&'a State);

impl<const D: usize> Sweep for Thinnest<'_, D> {
    type Output = f64;

    #[inline(always)]
    fn run<V: Wide>(self) -> f64 {
        let state = self.0;
        let mut least: f64 = 1.0;
        for group in state.groups() {
            let [low, _] = squared_stretches::<V, D>(&state.deformation_of_four(group));
            // Failed particles limit nothing.
            let (damage, one): (V, V) = (state.four(Column::Damage, group), V::splat(1.0));
            let low = damage.below(one, low, one).array();
            for lane in 0..(state.len - 4 * group).min(4) {
                least = least.min(low[lane]);
            }
        }
        least
    }
}
