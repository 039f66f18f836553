//! Which process formats which rows of a snapshot.
//!
//! A row has a key: its place among all rows, or the id that gives it that place. Each process owns a
//! range of keys and gets the rows in it, whoever has the particles or nodes they are about: what the
//! processes format then stands one after the other in the file. Ranges end where blocks of keys do,
//! so that bytes made block by block are the same for any number of processes.

use crate::parallel::Ranks;
use std::ops::Range;

/// Keys of a block: rows that one thread formats at a time.
pub const BLOCK: u64 = 4096;

/// Blocks of keys, dealt out evenly in the order of ranks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// The first block.
    first: u64,
    blocks: u64,
    processes: u64,
}

impl Share {
    /// Deals out the keys of a range.
    pub fn of_range(keys: Range<u64>, processes: usize) -> Self {
        let first = keys.start / BLOCK;
        let blocks = keys.end.div_ceil(BLOCK).saturating_sub(first).max(1);
        Self { first, blocks, processes: processes as u64 }
    }

    /// Deals out the keys between the smallest and the largest of all processes.
    pub fn of_keys(keys: &[u64], ranks: &Ranks) -> Self {
        let low = keys.iter().min().map_or(f64::NEG_INFINITY, |key| -(*key as f64));
        let high = keys.iter().max().map_or(f64::NEG_INFINITY, |key| *key as f64);
        let [low, high] = ranks.largest([low, high]);
        let range = if high < 0.0 { 0..0 } else { -low as u64..high as u64 + 1 };
        Self::of_range(range, ranks.size())
    }

    /// Everything belongs to the first process.
    pub fn to_first() -> Self {
        Self { first: 0, blocks: u64::MAX, processes: 1 }
    }

    /// The process that formats a row.
    pub fn owner(&self, key: u64) -> usize {
        let block = key / BLOCK - self.first;
        (u128::from(block) * u128::from(self.processes) / u128::from(self.blocks)) as usize
    }

    /// The keys of a process.
    pub fn range(&self, rank: usize) -> Range<u64> {
        let start = |rank: u64| {
            let block = u128::from(rank) * u128::from(self.blocks);
            (self.first + block.div_ceil(u128::from(self.processes)) as u64) * BLOCK
        };
        start(rank as u64)..start(rank as u64 + 1)
    }
}

/// Rows of numbers with their keys.
pub struct Rows {
    /// Of each row its key, then the bits of its numbers.
    words: Vec<u64>,
    width: usize,
}

impl Rows {
    /// The rows that this process formats: of `keys` and the keys of the other processes those in its
    /// share, with the `width` numbers that `number(row, column)` gives.
    pub fn deal(
        ranks: &Ranks,
        share: &Share,
        keys: &[u64],
        width: usize,
        number: impl Fn(usize, usize) -> f64,
    ) -> Self {
        // Column 0 is the key.
        let word = &|row: usize, column: usize| match column {
            0 => keys[row],
            _ => number(row, column - 1).to_bits(),
        };
        let words_of = |row: usize| (0..1 + width).map(move |column| word(row, column));
        let words = match ranks.exchange() {
            None => (0..keys.len()).flat_map(words_of).collect(),
            Some(exchange) => {
                let owners: Vec<usize> = keys.iter().map(|key| share.owner(*key)).collect();
                let mut counts = vec![0; exchange.size()];
                owners.iter().for_each(|owner| counts[*owner] += 1);
                let room = |count: usize| Vec::with_capacity(8 * (1 + width) * count);
                let mut letters: Vec<Vec<u8>> = counts.into_iter().map(room).collect();
                for (row, owner) in owners.into_iter().enumerate() {
                    let letter = &mut letters[owner];
                    words_of(row).for_each(|word| letter.extend(word.to_le_bytes()));
                }
                let letters = exchange.swap(letters);
                let words = letters.iter().flat_map(|letter| letter.as_chunks::<8>().0);
                words.map(|bytes| u64::from_le_bytes(*bytes)).collect()
            }
        };
        Self { words, width: 1 + width }
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.words.len() / self.width
    }

    /// Is there no row?
    pub fn is_empty(&self) -> bool {
        self.words.is_empty()
    }

    /// The key of a row.
    pub fn key(&self, row: usize) -> u64 {
        self.words[row * self.width]
    }

    /// A number of a row.
    pub fn number(&self, row: usize, column: usize) -> f64 {
        f64::from_bits(self.words[row * self.width + 1 + column])
    }

    /// The rows by ascending key.
    pub fn order(&self) -> Vec<u32> {
        let mut order: Vec<u32> = (0..self.len() as u32).collect();
        order.sort_unstable_by_key(|row| self.key(*row as usize));
        order
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_is_in_the_range_of_its_owner_and_ranges_follow_one_another() {
        for (keys, processes) in [(0..1, 3), (5000..90_000, 7), (0..1 << 40, 5), (7..7, 2)] {
            let share = Share::of_range(keys.clone(), processes);
            let mut next = keys.start / BLOCK * BLOCK;
            for rank in 0..processes {
                let range = share.range(rank);
                assert_eq!(range.start, next);
                assert_eq!(range.start % BLOCK, 0);
                next = range.end;
                if !range.is_empty() {
                    assert_eq!([range.start, range.end - 1].map(|key| share.owner(key)), [rank; 2]);
                }
            }
            assert!(keys.end <= next);
        }
        assert_eq!(Share::to_first().owner(u64::MAX), 0);
    }

    #[test]
    fn blocks_are_dealt_out_evenly() {
        let share = Share::of_range(1..100 * BLOCK, 8);
        let blocks =
            (0..8).map(|rank| share.range(rank)).map(|keys| (keys.end - keys.start) / BLOCK);
        let blocks: Vec<u64> = blocks.collect();
        assert!(blocks.iter().all(|count| [12, 13].contains(count)), "{blocks:?}");
    }

    #[test]
    fn rows_stand_by_key() {
        let keys = [9, 2, 5];
        let number = |row: usize, column: usize| (10 * row + column) as f64;
        let rows = Rows::deal(&Ranks::default(), &Share::to_first(), &keys, 2, number);
        assert_eq!((rows.len(), rows.order()), (3, vec![1, 2, 0]));
        assert_eq!((rows.key(1), rows.number(2, 1)), (2, 21.0));
    }
}
