//! Building the particles of a body: each process those of the tiles that it will own.
//!
//! Particles come in parcels, runs of ids within one tile of cells. Several processes first count the
//! particles of all parcels, each of some of them; so all know the first id of every parcel, and deal
//! out the tiles by the rule of a run (`kernel::deal`). Then each builds its parcels. What is built
//! does not depend on who builds it.

use super::fill::{Filling, offsets, touched, visit_cells, volume};
use crate::geometry::Points;
use crate::kernel::tiles::{Order, side};
use crate::model::domain::Domain;
use crate::parallel::Exchange;
use crate::parallel::partition::{Census, Partition};
use crate::region::Region;
use crate::shape::ShapeKind;
use std::ops::{ControlFlow, RangeInclusive};

/// How far corners of domains are taken to reach \[cells\]; the first sort knows better, and moves
/// particles if it must.
const CORNERS: usize = 1;

/// Where the particles of a body come from.
pub enum Source<'a> {
    /// Cells that a region fills.
    Cells {
        /// The region.
        region: &'a dyn Region,
        /// Offsets of the particles of a cell on one axis, in cell sizes.
        offsets: Vec<f64>,
        /// Volume of each particle \[L^d\].
        volume: f64,
    },
    /// A list.
    Points {
        /// The list.
        points: &'a Points,
        /// Those outside of the cells are left out.
        cut: bool,
    },
}

impl<'a> Source<'a> {
    /// What fills the cells.
    pub fn of(filling: &'a Filling, cells: &Domain) -> Self {
        match filling {
            Filling::Region { region, particles_per_cell, even } => {
                Self::of_region(region.as_ref(), cells, *particles_per_cell, *even)
            }
            Filling::Points(points) => Self::Points { points, cut: true },
        }
    }

    /// Cells that a region fills, with so many particles per cell and axis.
    pub fn of_region(
        region: &'a dyn Region,
        cells: &Domain,
        particles_per_cell: usize,
        even: bool,
    ) -> Self {
        let volume = volume(cells, particles_per_cell);
        Self::Cells { region, offsets: offsets(particles_per_cell, even), volume }
    }
}

/// Takes a particle: its place, its volume and the corners of its element, if it has one.
pub type Take<'a> = dyn FnMut([f64; 3], f64, &[[f64; 3]]) + 'a;

/// The particles of a body, in parcels.
pub struct Parcels<'a> {
    source: &'a Source<'a>,
    /// The cells that a region fills.
    cells: &'a Domain,
    /// Those of the lattice, which tiles belong to, and how many more they are at the lower end.
    wide: Domain,
    layers: usize,
    order: Order,
    side: usize,
    touched: [RangeInclusive<usize>; 3],
    /// The first strip of cells along the second axis, and how many there are.
    strips: [usize; 2],
}

impl<'a> Parcels<'a> {
    /// Of the particles that come from `source` into `cells`.
    pub fn new(source: &'a Source<'a>, cells: &'a Domain, shape: ShapeKind) -> Self {
        let (side, layers) = (side(shape, CORNERS), shape.layers());
        let wide = cells.widened(layers);
        let touched = match source {
            Source::Cells { region, .. } => touched(cells, &region.bounds(), 0),
            Source::Points { .. } => [0..=0, 0..=0, 0..=0],
        };
        let strip = |cell: usize| (cell + layers) / side;
        let [first, last] = [*touched[1].start(), *touched[1].end()].map(strip);
        let (order, strips) = (Order::new(&wide, side), [first, last + 1 - first]);
        Self { source, cells, wide, layers, order, side, touched, strips }
    }

    /// Their number.
    pub fn len(&self) -> usize {
        match self.source {
            Source::Cells { .. } => {
                let [across, ..] = &self.touched;
                (across.end() + 1 - across.start()) * self.strips[1]
            }
            Source::Points { points, .. } => points.list.len(),
        }
    }

    /// Cell on the first axis and strip of a parcel of cells.
    fn strip(&self, parcel: usize) -> [usize; 2] {
        let [first, count] = self.strips;
        [self.touched[0].start() + parcel / count, first + parcel % count]
    }

    /// The tile that a parcel lies in.
    fn tile(&self, parcel: usize) -> [usize; 2] {
        match self.source {
            Source::Cells { .. } => {
                let [cell, strip] = self.strip(parcel);
                [(cell + self.layers) / self.side, strip]
            }
            Source::Points { points, .. } => {
                let [x, y, z] = points.list[parcel].place;
                self.order.tile_of(self.order.cell_of(&self.wide, [x, y, z, 0.0]))
            }
        }
    }

    /// Visits the particles of a parcel in the order of their ids.
    pub fn visit(&self, parcel: usize, take: &mut Take<'_>) {
        match self.source {
            Source::Cells { region, offsets, volume } => {
                let [across, strip] = self.strip(parcel);
                let first = (strip * self.side).saturating_sub(self.layers);
                let last = (strip + 1) * self.side - 1 - self.layers;
                let [_, along, up] = &self.touched;
                let along = first.max(*along.start())..=last.min(*along.end());
                let mut each = |place| {
                    take(place, *volume, &[]);
                    ControlFlow::Continue(())
                };
                let strip = [across..=across, along, up.clone()];
                let _: ControlFlow<()> =
                    visit_cells(self.cells, *region, offsets, strip, &mut each);
            }
            Source::Points { points, cut } => {
                let point = &points.list[parcel];
                if !cut || self.cells.contains(point.place) {
                    take(point.place, point.volume, points.corners_of(parcel));
                }
            }
        }
    }

    /// The parcels that one of several processes builds, each with the number of particles before
    /// it. `held`: particles that it has of other bodies; `exists`: is there a particle of this place
    /// and volume?
    pub fn deal(
        &self,
        exchange: &dyn Exchange,
        held: usize,
        exists: impl Fn([f64; 3], f64) -> bool,
    ) -> Vec<(usize, usize)> {
        let mut numbers = vec![0; self.len()];
        for parcel in (exchange.rank()..self.len()).step_by(exchange.size()) {
            self.visit(parcel, &mut |place, volume, _| {
                numbers[parcel] += i64::from(exists(place, volume));
            });
        }
        exchange.sum(&mut numbers);
        let mut loads = vec![0; exchange.size()];
        loads[exchange.rank()] = held as i64;
        exchange.sum(&mut loads);
        self.own(&numbers, loads, exchange.rank())
    }

    /// The parcels of a process, from the numbers of particles of all parcels and of all processes.
    fn own(&self, numbers: &[i64], mut loads: Vec<i64>, rank: usize) -> Vec<(usize, usize)> {
        let partition = Partition::new(&self.census(numbers), &mut loads);
        let mut before = 0;
        let mut own = Vec::new();
        for (parcel, number) in numbers.iter().enumerate().filter(|(_, number)| **number > 0) {
            if partition.owner(self.tile(parcel)) == rank {
                own.push((parcel, before));
            }
            before += *number as usize;
        }
        own
    }

    /// The particles of each tile.
    fn census(&self, numbers: &[i64]) -> Census {
        let occupied = || (0..numbers.len()).filter(|parcel| numbers[*parcel] > 0);
        let mut bounds = [[usize::MAX; 2], [0; 2]];
        for tile in occupied().map(|parcel| self.tile(parcel)) {
            for axis in 0..2 {
                bounds[0][axis] = bounds[0][axis].min(tile[axis]);
                bounds[1][axis] = bounds[1][axis].max(tile[axis] + 1);
            }
        }
        let [lower, upper] = bounds;
        let lower = [0, 1].map(|axis| lower[axis].min(upper[axis]));
        let mut census = Census::of_none(lower, [0, 1].map(|axis| upper[axis] - lower[axis]));
        occupied().for_each(|parcel| census.add(self.tile(parcel), numbers[parcel]));
        census
    }
}

#[cfg(test)]
mod tests {
    use super::super::fill;
    use super::*;
    use crate::region::sphere::Sphere;

    /// A ball that several tiles cut, some of which are empty.
    fn each_ball(mut test: impl FnMut(&Parcels<'_>, Vec<[f64; 3]>)) {
        for dimension in 1..4 {
            let in_space =
                |limit: f64| std::array::from_fn(|axis| if axis < dimension { limit } else { 0.0 });
            let cells =
                Domain { dimension, lower: in_space(-1.3), upper: in_space(1.0), cell: 0.1 };
            let ball = Sphere { centre: in_space(0.1), radius: 0.77, dimension };
            for shape in [ShapeKind::Linear, ShapeKind::Gimp] {
                let source = Source::of_region(&ball, &cells, 2, false);
                let mut places = Vec::new();
                let _: ControlFlow<()> = fill::visit(&cells, &ball, &offsets(2, false), |place| {
                    places.push(place);
                    ControlFlow::Continue(())
                });
                assert!(places.len() > 20);
                test(&Parcels::new(&source, &cells, shape), places);
            }
        }
    }

    #[test]
    fn parcels_in_a_row_are_the_body_by_id_each_within_a_tile() {
        each_ball(|parcels, expected| {
            let mut found = Vec::new();
            for parcel in 0..parcels.len() {
                parcels.visit(parcel, &mut |place, _, _| {
                    let [x, y, z] = place;
                    let cell = parcels.order.cell_of(&parcels.wide, [x, y, z, 0.0]);
                    assert_eq!(parcels.order.tile_of(cell), parcels.tile(parcel));
                    found.push(place);
                });
            }
            assert_eq!(found, expected);
        });
    }

    #[test]
    fn every_parcel_has_one_builder_who_knows_its_first_id() {
        each_ball(|parcels, expected| {
            let mut numbers = vec![0; parcels.len()];
            for (parcel, number) in numbers.iter_mut().enumerate() {
                parcels.visit(parcel, &mut |_, _, _| *number += 1);
            }
            for processes in [1, 2, 3, 7] {
                let mut built = vec![None; expected.len()];
                for rank in 0..processes {
                    for (parcel, before) in parcels.own(&numbers, vec![0; processes], rank) {
                        let mut id = before;
                        parcels.visit(parcel, &mut |place, _, _| {
                            assert_eq!(built[id].replace(place), None);
                            id += 1;
                        });
                    }
                }
                let all: Vec<[f64; 3]> = built.into_iter().flatten().collect();
                assert_eq!(all, expected, "{processes} processes");
            }
        });
    }
}
