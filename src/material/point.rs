//! One particle of a law along a path of deformation, without grid or script.

use super::{Chunk, Description, LANES, Lane, Law, NOTHING, State};
use crate::math::tensor::Tensor;
use crate::model::column::{Column, ColumnSet};

/// A particle that is driven by velocity gradients.
///
/// Seven copies of it are advanced together, so that both a full group of four and a rest are run.
pub struct Point<'a> {
    law: &'a dyn Law,
    description: Description,
    columns: ColumnSet,
    state: Box<State>,
    /// First copy that failed in the last step.
    pub failed: Option<usize>,
    /// Copies that the last step compressed beyond what the law can describe.
    pub clipped: usize,
    /// Cell size h \[L\], which artificial viscosity reads; 1 at first.
    pub cell: f64,
}

const COPIES: usize = 7;

impl<'a> Point<'a> {
    /// A particle at rest in its reference state.
    pub fn new(law: &'a dyn Law, dimension: usize, description: Description) -> Self {
        let columns = description.columns(law, dimension);
        let mut state = Box::<State>::default();
        state.load(dimension, COPIES, columns, |column| match column.info().initial {
            1.0 => &[1.0; LANES],
            _ => &[0.0; LANES],
        });
        let mut point =
            Self { law, description, columns, state, failed: None, clipped: 0, cell: 1.0 };
        point.set(Column::Temperature, law.initial_temperature());
        for (column, value) in law.initial_values() {
            point.set(column, value);
        }
        point
    }

    /// One step dt. `rate` is L = dv/dx, in total Lagrangian descriptions dF/dt = dv/dX.
    pub fn step(&mut self, rate: &Tensor, dt: f64) {
        self.step_each(&[*rate; COPIES], dt);
    }

    /// One step dt with a rate for each copy.
    pub fn step_each(&mut self, rates: &[Tensor; COPIES], dt: f64) {
        let mut gradient = [NOTHING; 9];
        for (entry, lane) in gradient.iter_mut().enumerate() {
            for (p, rate) in rates.iter().enumerate() {
                lane[p / 4][p % 4] = rate[(entry / 3, entry % 3)];
            }
        }
        let mut chunk = Chunk {
            state: &mut self.state,
            dt,
            gradient: &mut gradient,
            rotation: &mut [NOTHING; 9],
            before: &mut { NOTHING },
            cell: self.cell,
            failed: None,
            clipped: 0,
        };
        let has_deformation = self.columns.contains(Column::F11);
        self.description.advance(self.law, has_deformation, &mut chunk);
        self.law.update(&mut chunk);
        self.failed = chunk.failed;
        self.clipped = chunk.clipped;
    }

    /// Sets a column of all copies.
    pub fn set(&mut self, column: Column, value: f64) {
        for p in 0..COPIES {
            self.state.set_value(column, p, value);
        }
    }

    /// The state of the copies.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Cauchy stress in space axes \[P\].
    pub fn stress(&self) -> Tensor {
        self.description.stress(self.law, &self.state, COPIES - 1)
    }

    /// Elastic strain in space axes.
    pub fn elastic_strain(&self) -> Tensor {
        let mut lanes: [Lane; 6] = [NOTHING; 6];
        self.law.elastic_strain(&self.state, &mut lanes);
        let last = COPIES - 1;
        let stored =
            Tensor::from_fn(|i, j| lanes[super::state::SYMMETRIC[3 * i + j]][last / 4][last % 4]);
        self.description.in_space(self.law, &self.state, last, stored)
    }

    /// Stored energy per reference volume \[P\].
    pub fn stored_energy(&self) -> f64 {
        let mut lane = NOTHING;
        self.law.stored_energy(&self.state, &mut lane);
        lane[1][2]
    }

    /// Wave speed \[L/T\].
    pub fn wave_speed(&self) -> f64 {
        let mut lane = NOTHING;
        self.law.wave_speed(&self.state, &mut lane);
        lane[1][2]
    }

    /// Value of a column.
    pub fn value(&self, column: Column) -> f64 {
        self.state.value(column, COPIES - 1)
    }

    /// Do all copies hold the same bits?
    pub fn copies_agree(&self) -> bool {
        self.columns.iter().all(|column| {
            let values = self.state.values(column);
            values.iter().all(|value| value.to_bits() == values[0].to_bits())
        })
    }
}
