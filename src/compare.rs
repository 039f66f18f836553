//! Where two runs part: their logs and dumps, number by number (`karamelo-rs diff`).

mod dump;
mod log;

use crate::fault::Fault;
use crate::output::number;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// One entry of a table.
#[derive(Clone, Debug, PartialEq)]
enum Cell {
    Number(f64),
    Word(String),
}

/// The rows of a snapshot, or of a run in a log.
#[derive(Clone, Debug, Default, PartialEq)]
struct Table {
    /// Step of the snapshot; rows of a log have their own.
    step: Option<u64>,
    names: Vec<String>,
    /// Id of each row, in a log its step.
    keys: Vec<u64>,
    /// Row by row, as many as names.
    cells: Vec<Cell>,
}

/// Where and how much two files differ.
#[derive(Clone, Debug, PartialEq)]
struct Difference {
    step: u64,
    /// What stands at that place.
    what: String,
    /// Numbers that differ in the same snapshot or row.
    count: usize,
}

/// Two files side by side.
#[derive(Clone, Debug, PartialEq)]
enum Verdict {
    Same,
    Part(Difference),
    /// They cannot be compared, and why.
    Unlike(String),
}

/// What the comparison of two runs found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Lines for the reader.
    pub text: String,
    /// Are the runs alike?
    pub alike: bool,
}

/// Compares two files, or all logs and dumps of two folders by name. Numbers are alike if they are
/// equal or differ by at most `tolerance` times the largest one of their column and snapshot.
///
/// # Errors
/// A file or folder that cannot be read.
pub fn compare(first: &Path, second: &Path, tolerance: f64) -> Result<Report, Fault> {
    if !first.is_dir() && !second.is_dir() {
        let name = first.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let verdict = compare_files(first, second, tolerance)?;
        let nothing = Verdict::Unlike("is neither a log nor a dump".to_string());
        return Ok(report(vec![(name, verdict.unwrap_or(nothing))]));
    }
    let [names, others] = [first, second].map(files_below);
    let (names, others) = (names?, others?);
    let mut found = Vec::new();
    for name in names.union(&others) {
        let lacks = |set: &BTreeSet<PathBuf>, folder: &Path| {
            let reason = || Verdict::Unlike(format!("is not in `{}`", folder.display()));
            (!set.contains(name)).then(reason)
        };
        let verdict = match lacks(&names, first).or(lacks(&others, second)) {
            None => compare_files(&first.join(name), &second.join(name), tolerance)?,
            Some(missing) => {
                let there = if names.contains(name) { first } else { second };
                let known = tables(&read(&there.join(name))?).is_some();
                known.then_some(missing)
            }
        };
        found.extend(verdict.map(|verdict| (name.display().to_string(), verdict)));
    }
    Ok(report(found))
}

fn read(path: &Path) -> Result<Vec<u8>, Fault> {
    std::fs::read(path).map_err(|reason| Fault::unreadable(path, &reason))
}

/// Names of all files below a folder, relative to it.
fn files_below(folder: &Path) -> Result<BTreeSet<PathBuf>, Fault> {
    fn walk(folder: &Path, before: &Path, names: &mut BTreeSet<PathBuf>) -> std::io::Result<()> {
        for entry in std::fs::read_dir(folder)? {
            let entry = entry?;
            let name = before.join(entry.file_name());
            let kind = entry.file_type()?;
            if kind.is_dir() {
                walk(&entry.path(), &name, names)?;
            } else if kind.is_file() {
                names.insert(name);
            }
        }
        Ok(())
    }
    let mut names = BTreeSet::new();
    let walked = walk(folder, Path::new(""), &mut names);
    walked.map_err(|reason| Fault::unreadable(folder, &reason))?;
    Ok(names)
}

/// The tables of a log or dump; `None` if it is neither.
fn tables(bytes: &[u8]) -> Option<Vec<Table>> {
    dump::read(bytes).or_else(|| log::read(bytes))
}

/// `None` if neither file is a log or dump.
fn compare_files(first: &Path, second: &Path, tolerance: f64) -> Result<Option<Verdict>, Fault> {
    let (a, b) = (read(first)?, read(second)?);
    Ok(match (tables(&a), tables(&b)) {
        (None, None) => None,
        _ if a == b => Some(Verdict::Same),
        (Some(a), Some(b)) => Some(compare_tables(&a, &b, tolerance)),
        _ => Some(Verdict::Unlike("only one of the files is a log or dump".to_string())),
    })
}

fn compare_tables(a: &[Table], b: &[Table], tolerance: f64) -> Verdict {
    for (a, b) in a.iter().zip(b) {
        match compare_table(a, b, tolerance) {
            Verdict::Same => {}
            other => return other,
        }
    }
    if a.len() == b.len() {
        return Verdict::Same;
    }
    let next = if a.len() > b.len() { &a[b.len()] } else { &b[a.len()] };
    let step = next.step.or(next.keys.first().copied()).unwrap_or(0);
    let what = format!("only the {} has more", if a.len() > b.len() { "first" } else { "second" });
    Verdict::Part(Difference { step, what, count: 0 })
}

fn compare_table(a: &Table, b: &Table, tolerance: f64) -> Verdict {
    if let (Some(step), Some(other)) = (a.step, b.step)
        && step != other
    {
        let what = format!("the second has step {other} there");
        return Verdict::Part(Difference { step, what, count: 0 });
    }
    let column = |name: &String| b.names.iter().position(|other| other == name);
    let common: Vec<(usize, usize)> = match a.names == b.names {
        true => (0..a.names.len()).map(|index| (index, index)).collect(),
        false => a.names.iter().enumerate().filter_map(|(i, n)| Some((i, column(n)?))).collect(),
    };
    if common.is_empty() {
        return Verdict::Unlike("have no column in common".to_string());
    }
    let largest: Vec<f64> = common.iter().map(|(i, j)| a.largest(*i).max(b.largest(*j))).collect();
    let mut first: Option<Difference> = None;
    for (row, (key, other)) in a.keys.iter().zip(&b.keys).enumerate() {
        let step = a.step.unwrap_or(*key);
        if first.as_ref().is_some_and(|first| first.step != step) {
            break;
        }
        if key != other {
            let what = format!("{} {key} stands where the second has {other}", a.row_name());
            return Verdict::Part(first.unwrap_or(Difference { step, what, count: 0 }));
        }
        for ((i, j), largest) in common.iter().zip(&largest) {
            let (x, y) = (a.cell(row, *i), b.cell(row, *j));
            let Some(words) = unlike(x, y, *largest, tolerance) else { continue };
            let place = a.step.map_or(String::new(), |_| format!("{} {key}, ", a.row_name()));
            let what = format!("{place}column {}: {words}", a.names[*i]);
            first.get_or_insert(Difference { step, what, count: 0 }).count += 1;
        }
    }
    let (rows, others) = (a.keys.len(), b.keys.len());
    match first {
        Some(difference) => Verdict::Part(difference),
        None if rows == others => Verdict::Same,
        None => {
            let longer = if rows > others { a } else { b };
            let key = longer.keys[rows.min(others)];
            let step = a.step.unwrap_or(key);
            let what = format!("{rows} rows and {others}");
            Verdict::Part(Difference { step, what, count: 0 })
        }
    }
}

/// How two entries differ; `None` if they are alike.
fn unlike(a: &Cell, b: &Cell, largest: f64, tolerance: f64) -> Option<String> {
    match (a, b) {
        (Cell::Number(a), Cell::Number(b)) => {
            let size = (a - b).abs();
            let alike = a == b || (a.is_nan() && b.is_nan()) || size <= tolerance * largest;
            (!alike).then(|| {
                let part = if largest > 0.0 { size / largest } else { f64::NAN };
                format!(
                    "{} and {}, apart by {size:.3e}, {part:.1e} of the largest there",
                    number::text(*a),
                    number::text(*b)
                )
            })
        }
        (Cell::Word(a), Cell::Word(b)) if a == b => None,
        _ => Some(format!("{} and {}", a.text(), b.text())),
    }
}

impl Cell {
    fn text(&self) -> String {
        match self {
            Cell::Number(value) => number::text(*value),
            Cell::Word(word) => format!("`{word}`"),
        }
    }
}

impl Table {
    fn cell(&self, row: usize, column: usize) -> &Cell {
        &self.cells[row * self.names.len() + column]
    }

    /// The largest finite magnitude of a column.
    fn largest(&self, column: usize) -> f64 {
        let size = |row: usize| match self.cell(row, column) {
            Cell::Number(value) if value.is_finite() => value.abs(),
            _ => 0.0,
        };
        (0..self.keys.len()).map(size).fold(0.0, f64::max)
    }

    fn row_name(&self) -> &'static str {
        if self.step.is_some() { "id" } else { "step" }
    }
}

/// One line for each file that differs, the earliest step first; then the sum.
fn report(found: Vec<(String, Verdict)>) -> Report {
    let mut text = String::new();
    let same = found.iter().filter(|(_, verdict)| *verdict == Verdict::Same).count();
    let mut parts: Vec<(&String, &Difference)> = Vec::new();
    let mut unlike = 0;
    for (name, verdict) in &found {
        match verdict {
            Verdict::Same => {}
            Verdict::Part(difference) => parts.push((name, difference)),
            Verdict::Unlike(reason) => {
                unlike += 1;
                let _ = writeln!(text, "{name}: {reason}");
            }
        }
    }
    parts.sort_by_key(|(_, difference)| difference.step);
    for (name, Difference { step, what, count }) in &parts {
        let more =
            if *count > 1 { format!(" ({count} numbers differ then)") } else { String::new() };
        let _ = writeln!(text, "{name}: step {step}, {what}{more}");
    }
    let alike = parts.is_empty() && unlike == 0 && same > 0;
    let _ = match (alike, parts.first()) {
        (true, _) => writeln!(text, "alike: {same} logs and dumps"),
        (false, Some((name, first))) => {
            let of = found.len();
            writeln!(
                text,
                "the runs part at step {}, in {name}; {same} of {of} files alike",
                first.step
            )
        }
        (false, None) if found.is_empty() => writeln!(text, "there are no logs and dumps"),
        (false, None) => writeln!(text, "{same} of {} files alike", found.len()),
    };
    Report { text, alike }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(step: u64, rows: &[(u64, f64, f64)]) -> Table {
        Table {
            step: Some(step),
            names: vec!["x".to_string(), "T".to_string()],
            keys: rows.iter().map(|row| row.0).collect(),
            cells: rows.iter().flat_map(|row| [row.1, row.2].map(Cell::Number)).collect(),
        }
    }

    fn part(verdict: Verdict) -> Difference {
        match verdict {
            Verdict::Part(difference) => difference,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn the_first_number_that_differs_is_named_with_its_size() {
        let a =
            [table(0, &[(1, 0.0, 5.0), (2, 1.0, 5.0)]), table(10, &[(1, 0.0, 4.0), (2, 2.0, 5.0)])];
        let mut b = a.clone();
        assert_eq!(compare_tables(&a, &b, 0.0), Verdict::Same);
        b[1].cells[2] = Cell::Number(2.5);
        b[1].cells[3] = Cell::Number(f64::NAN);
        let found = part(compare_tables(&a, &b, 0.0));
        assert_eq!((found.step, found.count), (10, 2));
        assert!(
            found.what.starts_with("id 2, column x: 2 and 2.5, apart by 5.000e-1, 2.0e-1"),
            "{found:?}"
        );
    }

    #[test]
    fn the_tolerance_is_relative_to_the_largest_number_of_the_column() {
        let a = [table(0, &[(1, 1e-20, 0.0), (2, 1.0, 0.0)])];
        let b = [table(0, &[(1, 3e-13, 0.0), (2, 1.0, 0.0)])];
        assert!(part(compare_tables(&a, &b, 1e-13)).what.contains("id 1, column x"));
        assert_eq!(compare_tables(&a, &b, 1e-12), Verdict::Same);
        let nan = [table(0, &[(1, f64::NAN, 0.0), (2, 1.0, 0.0)])];
        assert_eq!(compare_tables(&nan, &nan.clone(), 0.0), Verdict::Same);
        assert_ne!(compare_tables(&a, &nan, 1.0), Verdict::Same);
    }

    #[test]
    fn rows_snapshots_and_columns_may_be_missing() {
        let a = [table(0, &[(1, 0.0, 0.0), (2, 0.0, 0.0)]), table(10, &[(1, 0.0, 0.0)])];
        assert_eq!(part(compare_tables(&a, &a[..1], 0.0)).step, 10);
        let lost = [table(0, &[(1, 0.0, 0.0)])];
        assert!(part(compare_tables(&a[..1], &lost, 0.0)).what.contains("2 rows and 1"));
        let other = [table(0, &[(1, 0.0, 0.0), (3, 0.0, 0.0)])];
        assert!(part(compare_tables(&a[..1], &other, 0.0)).what.contains("id 2 stands where"));
        let mut renamed = a[..1].to_vec();
        renamed[0].names = vec!["y".to_string(), "s".to_string()];
        assert!(matches!(compare_tables(&a[..1], &renamed, 0.0), Verdict::Unlike(_)));
        renamed[0].names = vec!["T".to_string(), "s".to_string()];
        assert_eq!(compare_tables(&a[..1], &renamed, 0.0), Verdict::Same);
    }
}
