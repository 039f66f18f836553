//! The files of a dump: one per snapshot, or one that grows.

use super::file::Writer;
use super::joint::Joint;
use super::lammps::Table;
use super::{file, vtk};
use crate::fault::Fault;
use crate::model::checkpoint::Checkpoint;
use crate::parallel::Ranks;
use std::path::{Path, PathBuf};

/// How a snapshot is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Text.
    Text,
    /// Text in one gzip member.
    Gzip,
    /// LAMMPS's binary layout.
    Binary,
    /// XML with raw numbers, for ParaView.
    Vtk,
}

/// The files of a dump: `*` becomes the step. Without `*` one file grows; one for ParaView, which
/// cannot grow, is replaced.
pub struct Series {
    pattern: String,
    format: Format,
    /// Bytes that the growing file has.
    length: u64,
    /// Step and part of each file of ParaView's index.
    files: Vec<[u64; 2]>,
    /// Their times \[T\].
    times: Vec<f64>,
}

impl Series {
    /// Files of a pattern.
    pub fn new(pattern: &str, format: Format) -> Self {
        let (files, times) = (Vec::new(), Vec::new());
        Self { pattern: pattern.to_string(), format, length: 0, files, times }
    }

    /// Do its files have places apart from the columns?
    pub fn has_points(&self) -> bool {
        self.format == Format::Vtk
    }

    /// Writes a snapshot, each table in a file; gives the names of the files, `*` for the step. Only
    /// ParaView's may be several. All processes do so together, each with its rows.
    ///
    /// # Errors
    /// In the first process, the path and the system's reason of the first file that failed.
    pub fn write(&mut self, ranks: &Ranks, tables: &[Table<'_>]) -> Result<Vec<String>, Fault> {
        let mut names = Vec::new();
        let mut result = Ok(());
        for (number, table) in tables.iter().enumerate() {
            let part = if tables.len() > 1 { number as u64 + 1 } else { 0 };
            result = result.and(self.write_file(ranks, table, part));
            if self.format == Format::Vtk {
                self.files.push([table.step, part]);
                self.times.push(table.time);
            }
            names.push(self.name("*", part));
        }
        result?;
        if self.format == Format::Vtk && self.pattern.contains('*') {
            names.push(self.write_index(ranks)?);
        }
        Ok(names)
    }

    fn write_file(&mut self, ranks: &Ranks, table: &Table<'_>, part: u64) -> Result<(), Fault> {
        let path = PathBuf::from(self.name(&table.step.to_string(), part));
        let grows = !self.pattern.contains('*') && self.format != Format::Vtk;
        let mut file = Joint::new(ranks, || match grows {
            true => Writer::growing(&path, self.length),
            false => Writer::whole(&path),
        });
        match self.format {
            Format::Text => table.write_text(&mut file),
            Format::Gzip => table.write_gzip(&mut file),
            Format::Binary => table.write_binary(&mut file),
            Format::Vtk => vtk::write(table, &mut file),
        }
        let length = file.finish()?;
        if grows {
            self.length = length;
        }
        Ok(())
    }

    /// The name of a file; parts count from 1, 0 is the only one.
    fn name(&self, step: &str, part: u64) -> String {
        let name = self.pattern.replace('*', step);
        match (part, name.rsplit_once('.')) {
            (0, _) => name,
            (_, Some((stem, suffix))) => format!("{stem}.{part}.{suffix}"),
            (_, None) => format!("{name}.{part}"),
        }
    }

    /// The list of all files with their times: the pattern without `*`, then `.pvd`.
    fn write_index(&self, ranks: &Ranks) -> Result<String, Fault> {
        let index = self.pattern.replace(".*.", ".").replace('*', "") + ".pvd";
        let entry = |([step, part], time): (&[u64; 2], &f64)| {
            let name = PathBuf::from(self.name(&step.to_string(), *part));
            let name = name.file_name().unwrap_or_default().to_string_lossy().into_owned();
            (*time, part.saturating_sub(1), name)
        };
        let entries: Vec<_> = self.files.iter().zip(&self.times).map(entry).collect();
        if ranks.is_first() {
            file::write_whole(Path::new(&index), &vtk::index(&entries))?;
        }
        Ok(index)
    }

    /// Puts the end of a growing file and the files of the index into a checkpoint, or takes them
    /// from there: what was written beyond is written once more.
    pub fn keep(&mut self, checkpoint: &mut Checkpoint) {
        checkpoint.number("length", &mut self.length);
        if self.format == Format::Vtk {
            checkpoint.records("files", &mut self.files);
            checkpoint.column("times", &mut self.times);
            if self.files.len() != self.times.len() {
                checkpoint.refuse("the files of a dump and their times differ in number");
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::lammps::tests::{bytes, names, two_rows};
    use super::*;

    #[test]
    fn a_pattern_makes_a_file_per_step_and_a_name_a_growing_one() {
        let directory = tempfile::tempdir().unwrap();
        let names = names();
        let table = [two_rows(&names, &[1, 0])];
        let pattern = directory.path().join("d.*.txt");
        let ranks = Ranks::default();
        let mut series = Series::new(&pattern.to_string_lossy(), Format::Text);
        let names = series.write(&ranks, &table).unwrap();
        assert!(names.len() == 1 && names[0].ends_with("d.*.txt"));
        assert!(directory.path().join("d.50.txt").exists());
        let name = directory.path().join("all.txt");
        let mut series = Series::new(&name.to_string_lossy(), Format::Text);
        series.write(&ranks, &table).unwrap();
        series.write(&ranks, &table).unwrap();
        let once = bytes(|file| table[0].write_text(file));
        assert_eq!(std::fs::read(&name).unwrap(), [&once[..], &once].concat());
    }

    #[test]
    fn files_for_paraview_have_parts_and_an_index_with_times() {
        let directory = tempfile::tempdir().unwrap();
        let names = names();
        let pattern = directory.path().join("d&.*.vtp").to_string_lossy().into_owned();
        let mut series = Series::new(&pattern, Format::Vtk);
        let tables = [two_rows(&names, &[1, 0]), two_rows(&names, &[0])];
        let written = series.write(&Ranks::default(), &tables).unwrap();
        for (written, name) in written.iter().zip(["d&.*.1.vtp", "d&.*.2.vtp", "d&.vtp.pvd"]) {
            assert!(written.ends_with(name), "{written}");
        }
        assert!(directory.path().join("d&.50.2.vtp").exists());
        let index = std::fs::read_to_string(&written[2]).unwrap();
        assert!(index.contains("timestep=\"0.05\" part=\"1\" file=\"d&amp;.50.2.vtp\""), "{index}");
    }
}
