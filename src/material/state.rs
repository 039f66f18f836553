//! The state of up to 64 particles of one law, in memory that fits the nearest cache.

use crate::math::tensor::Tensor;
use crate::math::v4::{Plain, Wide};
use crate::math::wide::in_space;
use crate::model::column::{COLUMNS, Column, ColumnSet};

/// Particles per call of a law.
pub const LANES: usize = 64;

/// Groups of four among them.
pub const GROUPS: usize = LANES / 4;

/// One number per particle of a chunk, in groups of four.
pub type Lane = [[f64; 4]; GROUPS];

/// Zero for every particle.
pub const NOTHING: Lane = [[0.0; 4]; GROUPS];

/// The columns F11, F12, ... of F, in the order of its entries 3 i + j.
pub const DEFORMATION: [Column; 9] = {
    use Column::*;
    [F11, F12, F13, F21, F22, F23, F31, F32, F33]
};

/// The columns of the stress, in the order 11, 22, 33, 12, 13, 23.
pub const STRESS: [Column; 6] = {
    use Column::*;
    [S11, S22, S33, S12, S13, S23]
};

/// Places in a tensor of the components 11, 22, 33, 12, 13, 23.
pub const PLACES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

/// Components that do not exist where x is a radius and only the hoop lies out of the plane.
const TWISTED: [Column; 6] = {
    use Column::*;
    [S13, S23, F13, F23, F31, F32]
};

/// Index into [`STRESS`] of entry 3 i + j of the symmetric tensor.
pub const SYMMETRIC: [usize; 9] = [0, 3, 4, 3, 1, 5, 4, 5, 2];

/// to <- from, four numbers at a time: a chunk is too short for a call of `memcpy`.
#[inline(always)]
pub fn copy<V: Wide>(from: &[f64], to: &mut [f64]) {
    let (from, from_rest) = from.as_chunks::<4>();
    let (to, to_rest) = to.as_chunks_mut::<4>();
    for (from, to) in from.iter().zip(to) {
        V::load(from).store(to);
    }
    for (from, to) in from_rest.iter().zip(to_rest) {
        *to = *from;
    }
}

/// Four particles' tensor.
#[inline(always)]
pub fn load_tensor<V: Wide>(lanes: &[Lane; 9], group: usize) -> [V; 9] {
    let mut tensor = [V::splat(0.0); 9];
    for entry in 0..9 {
        tensor[entry] = V::load(&lanes[entry][group]);
    }
    tensor
}

/// Stores the entries of four particles' tensor that lie in the `D` dimensions.
#[inline(always)]
pub fn store_tensor<V: Wide, const D: usize>(lanes: &mut [Lane; 9], group: usize, tensor: &[V; 9]) {
    for entry in 0..9 {
        if in_space::<D>(entry) {
            tensor[entry].store(&mut lanes[entry][group]);
        }
    }
}

/// The tensor of six entries 11, 22, 33, 12, 13, 23.
#[inline(always)]
pub fn symmetric_tensor<V: Wide>(six: [V; 6]) -> [V; 9] {
    let [a, b, c, d, e, f] = six;
    [a, d, e, d, b, f, e, f, c]
}

/// Columns of up to [`LANES`] particles. A column that the scene does not have reads as its initial
/// value.
pub struct State {
    /// 1, 2 (plane strain) or 3 (bodies of revolution too: 33 is the hoop).
    pub dimension: usize,
    /// Number of particles; lanes beyond hold numbers without meaning.
    pub len: usize,
    columns: [Lane; COLUMNS],
    loaded: ColumnSet,
}

impl Default for State {
    fn default() -> Self {
        let columns =
            std::array::from_fn(|column| [[Column::ALL[column].info().initial; 4]; GROUPS]);
        Self { dimension: 0, len: 0, columns, loaded: ColumnSet::default() }
    }
}

impl State {
    /// Reads `len` particles: the columns of `set` from their slices, initial values elsewhere.
    #[inline]
    pub fn load<'a>(
        &mut self,
        dimension: usize,
        len: usize,
        set: ColumnSet,
        slice: impl Fn(Column) -> &'a [f64],
    ) {
        self.load_wide::<Plain>(dimension, len, set, slice);
    }

    /// The same, four numbers at a time.
    #[inline(always)]
    pub fn load_wide<'a, V: Wide>(
        &mut self,
        dimension: usize,
        len: usize,
        set: ColumnSet,
        slice: impl Fn(Column) -> &'a [f64],
    ) {
        (self.dimension, self.len) = (dimension, len);
        for column in self.loaded.without(set).iter() {
            self.columns[column as usize] = [[column.info().initial; 4]; GROUPS];
        }
        self.loaded = set;
        if dimension == 3 && !set.contains(Column::S13) {
            // Laws write them, in lanes beyond the last particle with numbers without meaning.
            for column in TWISTED {
                self.columns[column as usize] = [[column.info().initial; 4]; GROUPS];
            }
        }
        for column in set.iter() {
            let lane = self.columns[column as usize].as_flattened_mut();
            copy::<V>(&slice(column)[..len], &mut lane[..len]);
        }
    }

    /// Does the scene have the column?
    #[inline]
    pub fn has(&self, column: Column) -> bool {
        self.loaded.contains(column)
    }

    /// The particles' values of a column.
    #[inline]
    pub fn values(&self, column: Column) -> &[f64] {
        &self.columns[column as usize].as_flattened()[..self.len]
    }

    /// Groups of four that hold particles.
    #[inline]
    pub fn groups(&self) -> std::ops::Range<usize> {
        0..self.len.div_ceil(4).min(GROUPS)
    }

    /// A column in groups of four.
    #[inline(always)]
    pub fn lane(&self, column: Column) -> &Lane {
        &self.columns[column as usize]
    }

    /// Four particles' values of a column.
    #[inline(always)]
    pub fn four<V: Wide>(&self, column: Column, group: usize) -> V {
        V::load(&self.columns[column as usize][group])
    }

    /// Sets four particles' values of a column.
    #[inline(always)]
    pub fn set_four<V: Wide>(&mut self, column: Column, group: usize, value: V) {
        value.store(&mut self.columns[column as usize][group]);
    }

    /// Four particles' F.
    #[inline(always)]
    pub fn deformation_of_four<V: Wide>(&self, group: usize) -> [V; 9] {
        self.fours(DEFORMATION, group)
    }

    /// Four particles' values of several columns.
    #[inline(always)]
    pub fn fours<V: Wide, const N: usize>(&self, columns: [Column; N], group: usize) -> [V; N] {
        let mut values = [V::splat(0.0); N];
        for n in 0..N {
            values[n] = self.four(columns[n], group);
        }
        values
    }

    /// Sets four particles' values of several columns.
    #[inline(always)]
    pub fn set_fours<V: Wide, const N: usize>(
        &mut self,
        columns: [Column; N],
        group: usize,
        values: [V; N],
    ) {
        for n in 0..N {
            self.set_four(columns[n], group, values[n]);
        }
    }

    /// Value of particle `p`.
    pub fn value(&self, column: Column, p: usize) -> f64 {
        self.columns[column as usize][p / 4][p % 4]
    }

    /// Sets a value of particle `p`.
    pub fn set_value(&mut self, column: Column, p: usize, value: f64) {
        self.columns[column as usize][p / 4][p % 4] = value;
    }

    /// F of particle `p`.
    pub fn deformation(&self, p: usize) -> Tensor {
        Tensor::from_fn(|i, j| self.value(DEFORMATION[3 * i + j], p))
    }

    /// The stress of particle `p`, in the axes in which it is kept.
    pub fn stress(&self, p: usize) -> Tensor {
        Tensor::from_fn(|i, j| self.value(STRESS[SYMMETRIC[3 * i + j]], p))
    }

    /// Sets six columns of particle `p` to a symmetric tensor.
    pub fn set_symmetric(&mut self, columns: [Column; 6], p: usize, value: &Tensor) {
        for (column, place) in columns.into_iter().zip(PLACES) {
            self.columns[column as usize][p / 4][p % 4] = value[place];
        }
    }
}

/// A chunk of particles of one law, to be advanced by dt.
pub struct Chunk<'a> {
    /// Their state.
    pub state: &'a mut State,
    /// Size of the step \[T\].
    pub dt: f64,
    /// Entry 3 i + j of the velocity gradient \[1/T\], in the axes in which the stress is kept;
    /// entries beyond the dimension are 0.
    pub gradient: &'a mut [Lane; 9],
    /// J at the start of the step, where the law reads it ([`super::Law::reads_volume_before`]).
    pub before: &'a mut Lane,
    /// Total Lagrangian: R of F = R U; what stands here otherwise has no meaning.
    pub rotation: &'a mut [Lane; 9],
    /// Cell size h \[L\].
    pub cell: f64,
    /// First particle with J <= 0 or a value that is not finite.
    pub failed: Option<usize>,
    /// Particles that an equation of state has compressed beyond what it can describe.
    pub clipped: usize,
}

impl Chunk<'_> {
    /// Velocity gradient of particle `p`.
    pub fn velocity_gradient(&self, p: usize) -> Tensor {
        Tensor::from_fn(|i, j| self.gradient[3 * i + j][p / 4][p % 4])
    }

    /// Counts the particles with J below a bound.
    #[cold]
    pub fn count_clipped(&mut self, bound: f64) {
        let below = self.state.values(Column::J).iter().filter(|j| **j < bound);
        self.clipped += below.count();
    }

    /// Particles with D = 1 deform no more: they keep F and J.
    pub fn hold_failed(&mut self) {
        for p in 0..self.state.len {
            if self.state.value(Column::Damage, p) >= 1.0 {
                for entry in self.gradient.iter_mut() {
                    entry[p / 4][p % 4] = 0.0;
                }
            }
        }
    }

    /// Notes the first particle whose J is not a positive finite number, if there is one.
    #[cold]
    pub fn find_failure(&mut self) {
        let bad = |value: &f64| !(*value > 0.0 && *value < f64::INFINITY);
        self.failed = self.failed.or(self.state.values(Column::J).iter().position(bad));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_that_are_not_there_read_as_new_particles_do() {
        let mut set = ColumnSet::default();
        set.extend(&[Column::F11, Column::J]);
        let mut state = State::default();
        state.load(3, 5, set, |_| &[2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!((state.value(Column::F11, 4), state.value(Column::F22, 4)), (6.0, 1.0));
        assert_eq!(state.groups(), 0..2);
        let mut other = ColumnSet::default();
        other.insert(Column::J);
        state.load(3, 1, other, |_| &[7.0]);
        assert_eq!((state.value(Column::F11, 0), state.value(Column::J, 0)), (1.0, 7.0));
        assert_eq!(state.values(Column::J), [7.0]);
    }
}
