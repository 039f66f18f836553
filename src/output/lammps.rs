//! Dump files as LAMMPS writes them and OVITO reads them (language.md 8).

use super::number;
use crate::model::lattice::Lattice;
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
}

impl Values<'_> {
    /// The number at a place in the columns.
    pub fn at(&self, place: usize) -> f64 {
        match self {
            Values::Constant(value) => *value,
            Values::Slice(column) => column[place],
            Values::Record(records, entry) => records[place][*entry],
            Values::Made(values) => values[place],
        }
    }
}

/// A snapshot to be written.
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
    pub id: &'a (dyn Fn(usize) -> u64 + Sync),
    /// Type of each place, from 1.
    pub kind: &'a (dyn Fn(usize) -> u64 + Sync),
    /// The columns.
    pub values: Vec<Values<'a>>,
    /// Where each place is \[L\].
    pub point: &'a (dyn Fn(usize) -> [f64; 3] + Sync),
    /// The rows are all nodes of this lattice, the first axis fastest.
    pub lattice: Option<&'a Lattice>,
}

/// Corners of the box; axes beyond the dimension are one cell thick. In total Lagrangian methods
/// the box grows to hold all points.
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
    }
    corners
}

/// Rows that one thread writes at a time.
const ROWS: usize = 4096;

impl Table<'_> {
    /// The snapshot as text.
    pub fn text(&self) -> Vec<u8> {
        let mut text = self.header();
        let rows = |rows: &[u32]| {
            let mut text = Vec::with_capacity(rows.len() * 20 * (self.values.len() + 2));
            for place in rows {
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
        };
        if self.order.len() <= ROWS {
            text.extend(rows(self.order));
        } else {
            let parts: Vec<Vec<u8>> = self.order.par_chunks(ROWS).map(rows).collect();
            text.reserve(parts.iter().map(Vec::len).sum());
            parts.iter().for_each(|part| text.extend_from_slice(part));
        }
        text
    }

    fn header(&self) -> Vec<u8> {
        let mut text = b"ITEM: TIME\n".to_vec();
        number::push(&mut text, self.time);
        text.extend_from_slice(b"\nITEM: TIMESTEP\n");
        number::push_integer(&mut text, self.step);
        text.extend_from_slice(b"\nITEM: NUMBER OF ATOMS\n");
        number::push_integer(&mut text, self.order.len() as u64);
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

    /// The snapshot in LAMMPS's binary layout, little endian.
    pub fn binary(&self) -> Vec<u8> {
        const MAGIC: &[u8] = b"DUMPCUSTOM";
        /// Boundary that follows the particles: `s`.
        const SHRINK: i32 = 2;
        let integer = |bytes: &mut Vec<u8>, value: i32| bytes.extend(value.to_le_bytes());
        let mut bytes = (-(MAGIC.len() as i64)).to_le_bytes().to_vec();
        bytes.extend_from_slice(MAGIC);
        integer(&mut bytes, 1); // byte order
        integer(&mut bytes, 2); // revision
        bytes.extend((self.step as i64).to_le_bytes());
        bytes.extend((self.order.len() as i64).to_le_bytes());
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
        integer(&mut bytes, self.order.len().div_ceil(most) as i32);
        for rows in self.order.chunks(most) {
            integer(&mut bytes, (rows.len() * columns) as i32);
            for place in rows {
                let place = *place as usize;
                let id = (self.id)(place) as f64;
                for value in [id, (self.kind)(place) as f64, id] {
                    bytes.extend(value.to_le_bytes());
                }
                for values in &self.values {
                    bytes.extend(values.at(place).to_le_bytes());
                }
            }
        }
        bytes
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(in crate::output) fn two_rows<'a>(names: &'a [String], order: &'a [u32]) -> Table<'a> {
        Table {
            step: 50,
            time: 0.05,
            corners: [[-0.5, 0.5], [-0.5, 0.5], [-0.025, 0.025]],
            names,
            order,
            id: &|place| 2 - place as u64,
            kind: &|_| 1,
            values: vec![
                Values::Made(vec![0.25, -0.4525]),
                Values::Slice(&[1e-300, -0.4025]),
                Values::Constant(0.0),
            ],
            point: &|place| [[0.25, 1e-300, 0.0], [-0.4525, -0.4025, 0.0]][place],
            lattice: None,
        }
    }

    pub(in crate::output) fn names() -> Vec<String> {
        ["x", "y", "z"].map(str::to_string).to_vec()
    }

    #[test]
    fn the_text_is_that_of_the_manual() {
        let names = names();
        let text = String::from_utf8(two_rows(&names, &[1, 0]).text()).unwrap();
        let expected = "ITEM: TIME\n0.05\nITEM: TIMESTEP\n50\nITEM: NUMBER OF ATOMS\n2\n\
            ITEM: BOX BOUNDS ss ss ss\n-0.5 0.5\n-0.5 0.5\n-0.025 0.025\n\
            ITEM: ATOMS id type tag x y z\n1 1 1 -0.4525 -0.4025 0\n2 1 2 0.25 1e-300 0\n";
        assert_eq!(text, expected);
    }

    #[test]
    fn the_binary_layout_has_its_numbers_where_readers_look() {
        let names = names();
        let bytes = two_rows(&names, &[1, 0]).binary();
        assert_eq!(i64::from_le_bytes(bytes[..8].try_into().unwrap()), -10);
        assert_eq!(&bytes[8..18], b"DUMPCUSTOM");
        assert_eq!(i64::from_le_bytes(bytes[26..34].try_into().unwrap()), 50);
        let last = f64::from_le_bytes(bytes[bytes.len() - 16..bytes.len() - 8].try_into().unwrap());
        assert_eq!(last, 1e-300);
        let fixed = 8 + 10 + 8 + 16 + 4 + 24 + 48 + 8 + 9 + 4 + "id type tag x y z".len() + 4;
        assert_eq!(bytes.len(), fixed + 4 + 2 * 6 * 8);
    }
}
