//! The chunk of particles a thread is at, and its two layouts.
//!
//! Loops over nodes want one particle at a time, with the axes of a vector side by side; laws want
//! one quantity at a time, with four particles side by side. Here 4 x 4 blocks are turned over.

use crate::material::kinematics::Description;
use crate::material::state::{STRESS, load_tensor, symmetric_tensor};
use crate::material::{Chunk, GROUPS, LANES, Lane, Law, NOTHING, State};
use crate::math::v4::{Sweep, Wide, dispatch};
use crate::math::wide::{cofactors, product, product_transposed};
use crate::model::column::{Column, ColumnSet};
use crate::model::particles::Particles;
use std::cell::RefCell;
use std::ops::Range;

/// Columns 0, 1, 2 of a tensor of each particle.
pub type Records = [[[f64; 4]; LANES]; 3];

/// Memory for one chunk.
pub struct Scratch {
    /// The state of the particles.
    pub state: State,
    /// Velocity gradient, as the law reads it.
    pub gradient: [Lane; 9],
    /// R of F = R U.
    pub rotation: [Lane; 9],
    /// J at the start of the step, where a law reads it.
    before: Lane,
    /// Velocity gradient or stress, as the loops over nodes want it.
    pub records: Records,
    /// Some other number of each particle.
    pub numbers: Lane,
    /// Cell size h of the solid \[L\].
    pub cell: f64,
    /// Dimensions of the scene that wrote `gradient` last; entries beyond them are 0.
    spanned: usize,
}

impl Default for Scratch {
    fn default() -> Self {
        Self {
            state: State::default(),
            gradient: [NOTHING; 9],
            rotation: [NOTHING; 9],
            before: NOTHING,
            records: [[[0.0; 4]; LANES]; 3],
            numbers: NOTHING,
            cell: 0.0,
            spanned: 0,
        }
    }
}

thread_local! {
    /// The chunk of this thread.
    pub static SCRATCH: RefCell<Box<Scratch>> = RefCell::default();
}

impl Scratch {
    /// The part that kinematics and laws work on.
    #[inline(always)]
    pub fn chunk(&mut self, dt: f64) -> Chunk<'_> {
        Chunk {
            state: &mut self.state,
            dt,
            gradient: &mut self.gradient,
            rotation: &mut self.rotation,
            before: &mut self.before,
            cell: self.cell,
            failed: None,
            clipped: 0,
        }
    }

    /// Loads those of some columns that the particles have.
    pub fn load(
        &mut self,
        particles: &Particles,
        dimension: usize,
        set: ColumnSet,
        range: Range<usize>,
    ) {
        let set = set.common(particles.present);
        self.state
            .load(dimension, range.len(), set, |column| &particles.column(column)[range.clone()]);
    }

    /// gradient <- factor times records, entry by entry.
    #[inline(always)]
    pub fn spread<V: Wide, const D: usize>(&mut self, factor: f64, groups: usize) {
        if self.spanned != D {
            self.gradient = [NOTHING; 9];
            self.spanned = D;
        }
        let (factor, gradient) = (V::splat(factor), &mut self.gradient);
        for group in 0..groups.min(GROUPS) {
            for j in 0..D {
                let mut four = [V::splat(0.0); 4];
                for p in 0..4 {
                    four[p] = V::load(&self.records[j][4 * group + p]);
                }
                let rows = V::transpose(four);
                for i in 0..D {
                    (factor * rows[i]).store(&mut gradient[3 * i + j][group]);
                }
            }
        }
    }

    /// The hoop entry of L: gradient <- numbers, 0 in lanes without a particle.
    #[inline(always)]
    pub fn spread_hoop(&mut self, len: usize) {
        self.gradient[8] = self.numbers;
        self.gradient[8].as_flattened_mut()[len.min(LANES)..].fill(0.0);
        // Kinematics in three dimensions write the other entries too.
        self.spanned = 0;
    }
}

/// records <- factor times the columns of J sigma (updated Lagrangian) or of P = J sigma F^-T: with
/// a factor of -1/h, what times V0 dN/dr is the nodal force.
pub fn stresses(description: Description, law: &dyn Law, factor: f64, scratch: &mut Scratch) {
    let total = description == Description::Total;
    let turned_back = description.is_turned_back(law);
    match scratch.state.dimension {
        1 => dispatch(Stresses::<1> { scratch, total, turned_back, factor }),
        2 => dispatch(Stresses::<2> { scratch, total, turned_back, factor }),
        _ => dispatch(Stresses::<3> { scratch, total, turned_back, factor }),
    }
}

struct Stresses<'a, const D: usize> {
    scratch: &'a mut Scratch,
    total: bool,
    turned_back: bool,
    factor: f64,
}

impl<const D: usize> Sweep for Stresses<'_, D> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(self) {
        match (self.total, self.turned_back) {
            (false, _) => self.groups::<V, false, false>(),
            (true, false) => self.groups::<V, true, false>(),
            (true, true) => self.groups::<V, true, true>(),
        }
    }
}

impl<const D: usize> Stresses<'_, D> {
    #[inline(always)]
    fn groups<V: Wide, const TOTAL: bool, const TURNED: bool>(self) {
        let Scratch { state, rotation, records, .. } = self.scratch;
        let factor = V::splat(self.factor);
        for group in state.groups() {
            let mut six: [V; 6] = state.fours(STRESS, group);
            let scale = if TOTAL { factor } else { factor * state.four::<V>(Column::J, group) };
            for entry in &mut six {
                *entry = scale * *entry;
            }
            let tensor = if TOTAL {
                let sigma = symmetric_tensor(six);
                let (cofactor, _) = cofactors::<V, D>(&state.deformation_of_four(group));
                let sigma = if TURNED {
                    let r = load_tensor(rotation, group);
                    product_transposed::<V, D>(&product::<V, D>(&r, &sigma), &r)
                } else {
                    sigma
                };
                product::<V, D>(&sigma, &cofactor)
            } else {
                symmetric_tensor(six)
            };
            for j in 0..D {
                let mut column = [V::splat(0.0); 4];
                for i in 0..D {
                    column[i] = tensor[3 * i + j];
                }
                let four = V::transpose(column);
                for p in 0..4 {
                    four[p].store(&mut records[j][4 * group + p]);
                }
            }
        }
    }
}
