//! Tiles: columns of cells whose particles lie together in memory.
//!
//! Tiles are coloured 2 x 2. Between two sorts a particle moves by at most one cell, so with
//! [`SIDE`] cells per side, tiles of one colour never touch the same node: they run in parallel,
//! colours one after another.

use crate::model::domain::Domain;
use rayon::prelude::*;
use std::ops::Range;

/// Cells along a side of a tile. Nodes touched: `SIDE` cells, one cell of movement on either
/// side, one more node; the next tile of the same colour begins 2 `SIDE` cells further.
pub const SIDE: usize = 4;

const _: () = assert!(SIDE + 2 < 2 * SIDE - 1);

/// Number of colours.
pub const COLOURS: usize = 4;

/// Below so many particles one thread is faster than two.
pub const SMALLEST_PARALLEL: usize = 5000;

/// What a tile found out during a sweep.
#[derive(Clone, Copy, Debug, Default)]
pub struct Report {
    /// Largest component of dx \[L\].
    pub farthest: f64,
    /// Not finite as soon as one velocity of the tile is not.
    pub watch: f64,
    /// Largest c_p + max_i |v_i| \[L/T\].
    pub fastest: f64,
    /// Largest squared Frobenius norm of L \[1/T^2\].
    pub rate: f64,
    /// Place in the table of the first particle whose law failed.
    pub failed: Option<usize>,
    /// Place in the table of the first particle outside the box.
    pub escaped: Option<usize>,
}

impl Report {
    /// Both reports in one; the first failure stays.
    pub fn join(self, other: &Report) -> Report {
        Report {
            farthest: self.farthest.max(other.farthest),
            watch: self.watch + other.watch,
            fastest: self.fastest.max(other.fastest),
            rate: self.rate.max(other.rate),
            failed: self.failed.or(other.failed),
            escaped: self.escaped.or(other.escaped),
        }
    }
}

/// The tiles that hold particles.
#[derive(Clone, Debug, Default)]
pub struct Tiles {
    /// Particles of each tile, tiles by colour.
    pub ranges: Vec<Range<usize>>,
    /// First tile of each colour, and one past the last tile.
    pub colours: [usize; COLOURS + 1],
    /// What each tile found out during the last sweep.
    pub reports: Vec<Report>,
    /// Sweeps run on several threads.
    pub parallel: bool,
}

impl Tiles {
    /// Does the work for every tile; gives all reports in one.
    pub fn sweep(&mut self, work: impl Fn(Range<usize>, &mut Report) + Sync) -> Report {
        for colour in self.colours.windows(2) {
            let ranges = &self.ranges[colour[0]..colour[1]];
            let reports = &mut self.reports[colour[0]..colour[1]];
            let each = |(range, report): (&Range<usize>, &mut Report)| {
                *report = Report::default();
                work(range.clone(), report);
            };
            if self.parallel {
                ranges.par_iter().zip(reports).for_each(each);
            } else {
                ranges.iter().zip(reports).for_each(each);
            }
        }
        self.reports.iter().fold(Report::default(), Report::join)
    }
}

/// Order of a cell: by colour, tile, then cell with the last axis fastest.
#[derive(Clone, Copy, Debug)]
pub struct Order {
    tiles_across: usize,
    cells: [usize; 3],
}

impl Order {
    /// The order of the cells of a box.
    pub fn new(domain: &Domain) -> Self {
        let cells = domain.cells();
        Self { tiles_across: cells[1].div_ceil(SIDE), cells }
    }

    /// Colour and number of the tile of a cell.
    pub fn tile(&self, cell: [usize; 3]) -> (usize, usize) {
        let (x, y) = (cell[0] / SIDE, cell[1] / SIDE);
        (x % 2 * 2 + y % 2, x * self.tiles_across + y)
    }

    /// Number of the cell within its tile.
    pub fn within(&self, cell: [usize; 3]) -> usize {
        ((cell[0] % SIDE) * SIDE + cell[1] % SIDE) * self.cells[2] + cell[2]
    }
}
