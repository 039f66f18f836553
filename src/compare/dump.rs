//! Snapshots out of dump files: text, gzip, LAMMPS's binary layout.

use super::{Cell, Table};
use flate2::read::GzDecoder;
use std::io::Read;

/// The snapshots of a file; `None` if it is no dump or a broken one.
pub fn read(bytes: &[u8]) -> Option<Vec<Table>> {
    match bytes {
        [0x1f, 0x8b, ..] => {
            let mut text = Vec::new();
            GzDecoder::new(bytes).read_to_end(&mut text).ok()?;
            text_snapshots(&text)
        }
        _ if bytes.starts_with(b"ITEM:") => text_snapshots(bytes),
        _ => binary_snapshots(bytes),
    }
}

fn text_snapshots(bytes: &[u8]) -> Option<Vec<Table>> {
    let mut lines = std::str::from_utf8(bytes).ok()?.lines();
    let mut tables = Vec::new();
    let (mut step, mut count) = (None, 0_usize);
    while let Some(line) = lines.next() {
        let item = line.strip_prefix("ITEM: ")?;
        if let Some(names) = item.strip_prefix("ATOMS ") {
            let names: Vec<&str> = names.split_whitespace().collect();
            let rows = lines.by_ref().take(count).flat_map(|row| row.split(' '));
            let numbers: Vec<f64> = rows.map(|word| word.parse().ok()).collect::<Option<_>>()?;
            tables.push(table(step?, &names, &numbers, count)?);
        } else {
            match item.split(' ').next()? {
                "TIMESTEP" => step = Some(lines.next()?.trim().parse().ok()?),
                "NUMBER" => count = lines.next()?.trim().parse().ok()?,
                "BOX" => {
                    lines.nth(2)?;
                }
                _ => {
                    lines.next()?;
                }
            }
        }
    }
    (!tables.is_empty()).then_some(tables)
}

/// Rows of numbers as a table with the ids as keys.
fn table(step: u64, names: &[&str], numbers: &[f64], count: usize) -> Option<Table> {
    if names.is_empty() || numbers.len() != count.checked_mul(names.len())? {
        return None;
    }
    let id = names.iter().position(|name| *name == "id");
    let key = |(row, numbers): (usize, &[f64])| id.map_or(row as u64, |id| numbers[id] as u64);
    Some(Table {
        step: Some(step),
        names: names.iter().map(|name| name.to_string()).collect(),
        keys: numbers.chunks(names.len()).enumerate().map(key).collect(),
        cells: numbers.iter().map(|number| Cell::Number(*number)).collect(),
    })
}

/// Bytes that are read from the front.
struct Front<'a>(&'a [u8]);

impl<'a> Front<'a> {
    fn bytes(&mut self, count: usize) -> Option<&'a [u8]> {
        let (front, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(front)
    }

    fn integer(&mut self) -> Option<i32> {
        Some(i32::from_le_bytes(self.bytes(4)?.try_into().ok()?))
    }

    fn long(&mut self) -> Option<i64> {
        Some(i64::from_le_bytes(self.bytes(8)?.try_into().ok()?))
    }
}

fn binary_snapshots(bytes: &[u8]) -> Option<Vec<Table>> {
    let mut front = Front(bytes);
    let mut tables = Vec::new();
    while !front.0.is_empty() {
        tables.push(binary_snapshot(&mut front)?);
    }
    (!tables.is_empty()).then_some(tables)
}

fn binary_snapshot(front: &mut Front<'_>) -> Option<Table> {
    let length = usize::try_from(front.long()?.checked_neg()?).ok()?;
    (front.bytes(length)? == b"DUMPCUSTOM").then_some(())?;
    front.bytes(8)?; // byte order, revision
    let step = u64::try_from(front.long()?).ok()?;
    let count = usize::try_from(front.long()?).ok()?;
    front.bytes(4 + 24 + 48)?; // triclinic, boundary, box
    let columns = usize::try_from(front.integer()?).ok()?;
    let units = usize::try_from(front.integer()?).ok()?;
    front.bytes(units)?;
    if front.bytes(1)? == [1] {
        front.bytes(8)?;
    }
    let length = usize::try_from(front.integer()?).ok()?;
    let names = std::str::from_utf8(front.bytes(length)?).ok()?;
    let names: Vec<&str> = names.split_whitespace().collect();
    (names.len() == columns).then_some(())?;
    let mut numbers = Vec::new();
    for _ in 0..front.integer()? {
        let size = usize::try_from(front.integer()?).ok()?;
        let doubles = front.bytes(size.checked_mul(8)?)?.as_chunks::<8>().0;
        numbers.extend(doubles.iter().map(|bytes| f64::from_le_bytes(*bytes)));
    }
    table(step, &names, &numbers, count)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "ITEM: TIME\n0.5\nITEM: TIMESTEP\n50\nITEM: NUMBER OF ATOMS\n2\n\
        ITEM: BOX BOUNDS ss ss ss\n0 1\n0 1\n0 1\nITEM: ATOMS id x\n1 0.25\n2 nan\n";

    #[test]
    fn a_growing_file_has_several_snapshots() {
        let twice = format!("{TEXT}{}", TEXT.replace("50", "60"));
        let tables = read(twice.as_bytes()).unwrap();
        assert_eq!(tables.iter().map(|table| table.step).collect::<Vec<_>>(), [Some(50), Some(60)]);
        assert_eq!(tables[0].keys, [1, 2]);
        assert_eq!(*tables[0].cell(0, 1), Cell::Number(0.25));
    }

    #[test]
    fn what_is_broken_is_no_dump() {
        for end in 0..TEXT.len() - 2 {
            assert_eq!(
                read(&TEXT.as_bytes()[..end]).filter(|tables| !tables.is_empty()),
                None,
                "{end}"
            );
        }
        assert_eq!(read(b"\x1f\x8b nonsense"), None);
        assert_eq!(read(b"\xf6\xff\xff\xff\xff\xff\xff\xffDUMPCUSTOM"), None);
    }
}
