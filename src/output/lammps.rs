//! Dump files as LAMMPS writes them and OVITO reads them (language.md 8).

use super::gzip::{self, Piece};
use super::joint::Joint;
use super::number;
use super::share::{BLOCK, Rows, Share};
use crate::model::lattice::Lattice;
use crate::parallel::Ranks;
use crate::world::World;
use rayon::prelude::*;

/// One column of a snapshot.
pub enum Values<'a> {
    /// One number for every row.
    Constant(f64),
    /// A column.
    Slice(&'a [f64]),
    /// One entry of each record.
    Record(&'a [[f64; 4]], usize),
    /// Numbers made for this snapshot.
    Made(Vec<f64>),
    /// A column of rows that were dealt out.
    Dealt(&'a Rows, usize),
}

impl Values<'_> {
    /// The number at a place in the columns.
    pub fn at(&self, place: usize) -> f64 {
        match self {
            Values::Constant(value) => *value,
            Values::Slice(column) => column[place],
            Values::Record(records, entry) => records[place][*entry],
            Values::Made(values) => values[place],
            Values::Dealt(rows, column) => rows.number(place, *column),
        }
    }
}

/// A snapshot to be written: all of it, or the rows of one process.
pub struct Table<'a> {
    /// Step number.
    pub step: u64,
    /// Time \[T\].
    pub time: f64,
    /// Corners of the box \[L\]; thick on every axis.
    pub corners: [[f64; 2]; 3],
    /// Names of the columns after `id type tag`.
    pub names: &'a [String],
    /// Place of each row in the columns, by ascending id.
    pub order: &'a [u32],
    /// Id of each place.
    pub id: Box<dyn Fn(usize) -> u64 + Sync + 'a>,
    /// Type of each place, from 1.
    pub kind: Box<dyn Fn(usize) -> u64 + Sync + 'a>,
    /// The columns.
    pub values: Vec<Values<'a>>,
    /// Where each place is \[L\].
    pub point: Box<dyn Fn(usize) -> [f64; 3] + Sync + 'a>,
    /// The rows are all nodes of this lattice, the first axis fastest.
    pub lattice: Option<&'a Lattice>,
    /// Rows of the processes before this one, and of all.
    pub part: Part,
}

/// Which rows of a snapshot a process has.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// Rows of the processes before this one.
    pub before: usize,
    /// Rows of all processes.
    pub all: usize,
}

impl Part {
    /// Of processes of which this one has so many rows.
    pub fn of(rows: usize, ranks: &Ranks) -> Self {
        let counts = ranks.share(&[rows as f64]);
        let sum = |counts: &[f64]| counts.iter().sum::<f64>() as usize;
        Self { before: sum(&counts[..ranks.rank()]), all: sum(&counts) }
    }
}

/// Corners of the box; axes beyond the dimension are one cell thick. In total Lagrangian methods
/// the box grows to hold the points of all processes.
pub fn corners(world: &World, points: impl Iterator<Item = [f64; 3]>) -> [[f64; 2]; 3] {
    let domain = &world.domain;
    let mut corners = std::array::from_fn(|axis| match axis < domain.dimension {
        true => [domain.lower[axis], domain.upper[axis]],
        false => [-0.5 * domain.cell, 0.5 * domain.cell],
    });
    if world.method.total {
        for point in points {
            for ([low, high], x) in corners.iter_mut().zip(point).take(domain.dimension) {
                (*low, *high) = (low.min(x), high.max(x));
            }
        }
        for [low, high] in &mut corners {
            let [lowest, highest] = world.ranks.largest([-*low, *high]);
            (*low, *high) = (-lowest, highest);
        }
    }
    corners
}

impl Table<'_> {
    /// Gives `write` the rows that this process formats, if there are several processes: rows are
    /// dealt out by id. `points`: with the places of the rows.
    pub fn dealt_out<T>(
        &self,
        ranks: &Ranks,
        points: bool,
        write: impl FnOnce(&Table<'_>) -> T,
    ) -> T {
        if ranks.is_alone() {
            return write(self);
        }
        // Columns of a row: type, values, place.
        let place = |row: usize| self.order[row] as usize;
        let count = self.values.len();
        let number = |row: usize, column: usize| match column {
            0 => (self.kind)(place(row)) as f64,
            _ if column <= count => self.values[column - 1].at(place(row)),
            _ => (self.point)(place(row))[column - 1 - count],
        };
        let keys: Vec<u64> = (0..self.order.len()).map(|row| (self.id)(place(row))).collect();
        let share = Share::of_keys(&keys, ranks);
        let width = 1 + count + if points { 3 } else { 0 };
        let rows = &Rows::deal(ranks, &share, &keys, width, number);
        write(&Table {
            step: self.step,
            time: self.time,
            corners: self.corners,
            names: self.names,
            order: &rows.order(),
            id: Box::new(|row| rows.key(row)),
            kind: Box::new(|row| rows.number(row, 0) as u64),
            values: (0..count).map(|column| Values::Dealt(rows, 1 + column)).collect(),
            point: Box::new(move |row| [1, 2, 3].map(|axis| rows.number(row, count + axis))),
            lattice: self.lattice,
            part: Part::of(rows.len(), ranks),
        })
    }

    /// The rows block by block of their ids.
    fn blocks(&self) -> Vec<&[u32]> {
        let block = |place: &u32| (self.id)(*place as usize) / BLOCK;
        self.order.chunk_by(|a, b| block(a) == block(b)).collect()
    }

    /// Rows as text.
    fn rows(&self, places: &[u32]) -> Vec<u8> {
        let mut text = Vec::with_capacity(places.len() * 20 * (self.values.len() + 2));
        for place in places {
            let place = *place as usize;
            let id = (self.id)(place);
            number::push_integer(&mut text, id);
            text.push(b' ');
            number::push_integer(&mut text, (self.kind)(place));
            text.push(b' ');
            number::push_integer(&mut text, id);
            for values in &self.values {
                text.push(b' ');
                number::push(&mut text, values.at(place));
            }
            text.push(b'\n');
        }
        text
    }

    /// Writes the snapshot as text.
    pub fn write_text(&self, file: &mut Joint<'_>) {
        file.put(&self.header());
        let parts: Vec<Vec<u8>> =
            self.blocks().into_par_iter().map(|places| self.rows(places)).collect();
        file.put_all(&parts);
    }

    /// The same text, compressed.
    pub fn write_gzip(&self, file: &mut Joint<'_>) {
        let piece = |places| Piece::of(&self.rows(places));
        let pieces: Vec<Piece> = self.blocks().into_par_iter().map(piece).collect();
        gzip::write(file, &self.header(), pieces);
    }

    fn header(&self) -> Vec<u8> {
        let mut text = b"ITEM: TIME\n".to_vec();
        number::push(&mut text, self.time);
        text.extend_from_slice(b"\nITEM: TIMESTEP\n");
        number::push_integer(&mut text, self.step);
        text.extend_from_slice(b"\nITEM: NUMBER OF ATOMS\n");
        number::push_integer(&mut text, self.part.all as u64);
        text.extend_from_slice(b"\nITEM: BOX BOUNDS ss ss ss\n");
        for [low, high] in self.corners {
            number::push(&mut text, low);
            text.push(b' ');
            number::push(&mut text, high);
            text.push(b'\n');
        }
        text.extend_from_slice(b"ITEM: ATOMS id type tag");
        for name in self.names {
            text.push(b' ');
            text.extend_from_slice(name.as_bytes());
        }
        text.push(b'\n');
        text
    }

    /// Writes the snapshot in LAMMPS's binary layout, little endian.
    pub fn write_binary(&self, file: &mut Joint<'_>) {
        const MAGIC: &[u8] = b"DUMPCUSTOM";
        /// Boundary that follows the particles: `s`.
        const SHRINK: i32 = 2;
        let Part { before, all } = self.part;
        let integer = |bytes: &mut Vec<u8>, value: i32| bytes.extend(value.to_le_bytes());
        let mut bytes = (-(MAGIC.len() as i64)).to_le_bytes().to_vec();
        bytes.extend_from_slice(MAGIC);
        integer(&mut bytes, 1); // byte order
        integer(&mut bytes, 2); // revision
        bytes.extend((self.step as i64).to_le_bytes());
        bytes.extend((all as i64).to_le_bytes());
        integer(&mut bytes, 0); // not triclinic
        (0..6).for_each(|_| integer(&mut bytes, SHRINK));
        self.corners.iter().flatten().for_each(|corner| bytes.extend(corner.to_le_bytes()));
        let columns = self.values.len() + 3;
        integer(&mut bytes, columns as i32);
        integer(&mut bytes, 0); // no units
        bytes.push(1); // time follows
        bytes.extend(self.time.to_le_bytes());
        let names = format!("id type tag {}", self.names.join(" "));
        let names = names.trim_end();
        integer(&mut bytes, names.len() as i32);
        bytes.extend_from_slice(names.as_bytes());
        let most = (i32::MAX as usize / columns).min(1 << 20);
        integer(&mut bytes, all.div_ceil(most) as i32);
        file.put(&bytes);
        let mut rows = Vec::with_capacity(8 * columns * self.order.len());
        for (number, place) in self.order.iter().enumerate() {
            let number = before + number;
            if number.is_multiple_of(most) {
                integer(&mut rows, ((all - number).min(most) * columns) as i32);
            }
            let place = *place as usize;
            let id = (self.id)(place) as f64;
            for value in [id, (self.kind)(place) as f64, id] {
                rows.extend(value.to_le_bytes());
            }
            for values in &self.values {
                rows.extend(values.at(place).to_le_bytes());
            }
        }
        file.put_all(&[rows]);
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::file::Writer;
    use super::*;

    pub(in crate::output) fn two_rows<'a>(names: &'a [String], order: &'a [u32]) -> Table<'a> {
        Table {
            step: 50,
            time: 0.05,
            corners: [[-0.5, 0.5], [-0.5, 0.5], [-0.025, 0.025]],
            names,
            order,
            id: Box::new(|place| 2 - place as u64),
            kind: Box::new(|_| 1),
            values: vec![
                Values::Made(vec![0.25, -0.4525]),
                Values::Slice(&[1e-300, -0.4025]),
                Values::Constant(0.0),
            ],
            point: Box::new(|place| [[0.25, 1e-300, 0.0], [-0.4525, -0.4025, 0.0]][place]),
            lattice: None,
            part: Part { before: 0, all: order.len() },
        }
    }

    /// What a way to write puts into a file.
    pub(in crate::output) fn bytes(write: impl FnOnce(&mut Joint<'_>)) -> Vec<u8> {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("file");
        let ranks = Ranks::default();
        let mut file = Joint::new(&ranks, || Writer::whole(&path));
        write(&mut file);
        file.finish().unwrap();
        std::fs::read(path).unwrap()
    }

    pub(in crate::output) fn names() -> Vec<String> {
        ["x", "y", "z"].map(str::to_string).to_vec()
    }

    #[test]
    fn the_text_is_that_of_the_manual() {
        let names = names();
        let text = bytes(|file| two_rows(&names, &[1, 0]).write_text(file));
        let text = String::from_utf8(text).unwrap();
        let expected = "ITEM: TIME\n0.05\nITEM: TIMESTEP\n50\nITEM: NUMBER OF ATOMS\n2\n\
            ITEM: BOX BOUNDS ss ss ss\n-0.5 0.5\n-0.5 0.5\n-0.025 0.025\n\
            ITEM: ATOMS id type tag x y z\n1 1 1 -0.4525 -0.4025 0\n2 1 2 0.25 1e-300 0\n";
        assert_eq!(text, expected);
    }

    #[test]
    fn the_binary_layout_has_its_numbers_where_readers_look() {
        let names = names();
        let bytes = bytes(|file| two_rows(&names, &[1, 0]).write_binary(file));
        assert_eq!(i64::from_le_bytes(bytes[..8].try_into().unwrap()), -10);
        assert_eq!(&bytes[8..18], b"DUMPCUSTOM");
        assert_eq!(i64::from_le_bytes(bytes[26..34].try_into().unwrap()), 50);
        let last = f64::from_le_bytes(bytes[bytes.len() - 16..bytes.len() - 8].try_into().unwrap());
        assert_eq!(last, 1e-300);
        let fixed = 8 + 10 + 8 + 16 + 4 + 24 + 48 + 8 + 9 + 4 + "id type tag x y z".len() + 4;
        assert_eq!(bytes.len(), fixed + 4 + 2 * 6 * 8);
    }
}
