//! Which process owns which tiles: recursive bisection by numbers of particles.

use std::ops::Range;

/// Particles of each tile between two corners.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Census {
    /// First tile on each axis.
    pub lower: [usize; 2],
    /// Tiles on each axis.
    pub size: [usize; 2],
    /// Particles of each tile, the second axis fastest.
    pub counts: Vec<i64>,
}

impl Census {
    /// No particles in these tiles.
    pub fn of_none(lower: [usize; 2], size: [usize; 2]) -> Self {
        Self { lower, size, counts: vec![0; size[0] * size[1]] }
    }

    /// Place of a tile in `counts`.
    fn place(&self, tile: [usize; 2]) -> usize {
        (tile[0] - self.lower[0]) * self.size[1] + tile[1] - self.lower[1]
    }

    /// Counts particles of a tile.
    pub fn add(&mut self, tile: [usize; 2], count: i64) {
        let place = self.place(tile);
        self.counts[place] += count;
    }

    /// Particles in each row of tiles across an axis.
    fn rows(&self, tiles: &[Range<usize>; 2], axis: usize) -> Vec<i64> {
        let mut rows = vec![0; tiles[axis].len()];
        for x in tiles[0].clone() {
            for y in tiles[1].clone() {
                let row = [x, y][axis] - tiles[axis].start;
                rows[row] += self.counts[self.place([x, y])];
            }
        }
        rows
    }

    /// The smallest range of tiles that holds all particles of another.
    fn occupied(&self, tiles: &[Range<usize>; 2]) -> [Range<usize>; 2] {
        std::array::from_fn(|axis| {
            let rows = self.rows(tiles, axis);
            let first = rows.iter().position(|count| *count > 0).unwrap_or(0);
            let last = rows.iter().rposition(|count| *count > 0).map_or(0, |row| row + 1);
            tiles[axis].start + first..tiles[axis].start + last.max(first)
        })
    }
}

/// A tree of straight cuts between tiles.
#[derive(Clone, Debug, PartialEq)]
pub struct Partition {
    branches: Vec<Branch>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Branch {
    /// All tiles here belong to a process.
    Leaf(usize),
    /// Tiles before `at` on an axis belong to one branch, the others to another.
    Cut { axis: usize, at: usize, branches: [usize; 2] },
}

impl Partition {
    /// Deals the tiles of a census out to all processes, of which `loads` says how many particles
    /// each has already; adds those it gets. Ranges of ranks are halved, and the occupied tiles cut
    /// across their longer side so that both halves end up with their share.
    pub fn new(census: &Census, loads: &mut [i64]) -> Self {
        let mut tree = Self { branches: Vec::new() };
        let whole =
            std::array::from_fn(|axis| census.lower[axis]..census.lower[axis] + census.size[axis]);
        tree.grow(census, whole, 0..loads.len(), loads);
        tree
    }

    /// Adds the branch of some tiles and ranks; gives its number.
    fn grow(
        &mut self,
        census: &Census,
        tiles: [Range<usize>; 2],
        ranks: Range<usize>,
        loads: &mut [i64],
    ) -> usize {
        let number = self.branches.len();
        self.branches.push(Branch::Leaf(ranks.start));
        let tiles = census.occupied(&tiles);
        let weight: i64 = census.rows(&tiles, 0).iter().sum();
        if ranks.len() == 1 {
            loads[ranks.start] += weight;
            return number;
        }
        let middle = ranks.start + ranks.len() / 2;
        let load = |ranks: Range<usize>| loads[ranks].iter().sum::<i64>();
        let before = load(ranks.clone()) + weight;
        let share = (middle - ranks.start) as f64 / ranks.len() as f64;
        let wanted = share * before as f64 - load(ranks.start..middle) as f64;
        let axis = usize::from(tiles[1].len() > tiles[0].len());
        let at = tiles[axis].start + cut(&census.rows(&tiles, axis), wanted);
        let mut halves = [tiles.clone(), tiles];
        halves[0][axis].end = at;
        halves[1][axis].start = at;
        let [left, right] = halves;
        let branches = [
            self.grow(census, left, ranks.start..middle, loads),
            self.grow(census, right, middle..ranks.end, loads),
        ];
        self.branches[number] = Branch::Cut { axis, at, branches };
        number
    }

    /// The process that owns a tile.
    pub fn owner(&self, tile: [usize; 2]) -> usize {
        let mut branch = 0;
        loop {
            match self.branches[branch] {
                Branch::Leaf(rank) => return rank,
                Branch::Cut { axis, at, branches } => {
                    branch = branches[usize::from(tile[axis] >= at)];
                }
            }
        }
    }
}

/// Number of rows whose sum comes nearest to the one wanted.
fn cut(rows: &[i64], wanted: f64) -> usize {
    let (mut best, mut sum) = (0, 0);
    let mut distance = wanted.abs();
    for (row, count) in rows.iter().enumerate() {
        sum += count;
        let this = (sum as f64 - wanted).abs();
        if this < distance {
            (best, distance) = (row + 1, this);
        }
    }
    best
}

/// Largest number of particles of a process over the mean; 1 without particles.
pub fn imbalance(loads: &[i64]) -> f64 {
    let sum: i64 = loads.iter().sum();
    let most = loads.iter().copied().max().unwrap_or(0);
    if sum > 0 { most as f64 * loads.len() as f64 / sum as f64 } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn census(size: [usize; 2], count: impl Fn(usize, usize) -> i64) -> Census {
        let mut census = Census::of_none([3, 5], size);
        for x in 0..size[0] {
            for y in 0..size[1] {
                census.counts[x * size[1] + y] = count(x, y);
            }
        }
        census
    }

    fn loads_of(census: &Census, partition: &Partition, ranks: usize) -> Vec<i64> {
        let mut loads = vec![0; ranks];
        for x in 0..census.size[0] {
            for y in 0..census.size[1] {
                loads[partition.owner([3 + x, 5 + y])] += census.counts[x * census.size[1] + y];
            }
        }
        loads
    }

    #[test]
    fn every_tile_has_one_owner_and_the_loads_are_those_announced() {
        let census = census([17, 9], |x, y| ((x * y) % 7) as i64 * 10);
        for ranks in [1, 2, 3, 4, 7, 16] {
            let mut loads = vec![0; ranks];
            let partition = Partition::new(&census, &mut loads);
            assert_eq!(loads, loads_of(&census, &partition, ranks));
            assert_eq!(loads.iter().sum::<i64>(), census.counts.iter().sum::<i64>());
        }
    }

    #[test]
    fn equal_tiles_are_dealt_out_evenly() {
        let census = census([16, 16], |_, _| 64);
        for ranks in [2, 4, 8, 16, 64] {
            let mut loads = vec![0; ranks];
            Partition::new(&census, &mut loads);
            assert_eq!(imbalance(&loads), 1.0, "{ranks}");
        }
        // Five do not divide sixteen: 52 of 256 tiles at most while the mean is 51.2.
        let mut loads = vec![0; 5];
        Partition::new(&census, &mut loads);
        assert!(imbalance(&loads) < 1.2, "{loads:?}");
    }

    #[test]
    fn the_matter_counts_and_not_the_box() {
        // All particles in one corner of a wide box.
        let census = census([100, 100], |x, y| i64::from(x < 8 && y < 4));
        let mut loads = vec![0; 4];
        Partition::new(&census, &mut loads);
        assert_eq!(loads, [8; 4]);
    }

    #[test]
    fn more_processes_than_tiles_leave_some_without() {
        let census = census([2, 1], |_, _| 10);
        let mut loads = vec![0; 5];
        let partition = Partition::new(&census, &mut loads);
        assert_eq!(loads.iter().filter(|load| **load == 10).count(), 2);
        assert_eq!(loads, loads_of(&census, &partition, 5));
    }

    #[test]
    fn what_processes_have_already_is_taken_into_account() {
        let one = census([1, 1], |_, _| 10);
        let mut loads = vec![0; 4];
        for _ in 0..4 {
            Partition::new(&one, &mut loads);
        }
        assert_eq!(loads, [10; 4]);
    }
}
