//! Everything that leaves the program: log, dumps, pictures, figures.

pub mod canvas;
pub mod colours;
pub mod digest;
pub mod field;
pub mod file;
pub mod frame;
pub mod gzip;
pub mod joint;
pub mod lammps;
pub mod log;
pub mod mosaic;
pub mod nodes;
pub mod number;
pub mod particle;
pub mod picture;
pub mod plot;
pub mod pyplot;
pub mod raster;
pub mod restart;
pub mod schedule;
pub mod series;
pub mod share;
pub mod vtk;

use crate::fault::Fault;
use crate::fix::GroupKind;
use crate::model::checkpoint::Checkpoint;
use crate::model::group::GroupId;
use crate::plan::Plan;
use crate::script::arguments::Args;
use crate::script::diagnostic::{Code, Diagnostic};
use crate::script::formula::Formula;
use crate::script::source::Span;
use crate::style::Style;
use crate::world::World;

pub use schedule::{OutputOptions, Outputs};

/// What wrote a file, for formats that have room to say so.
pub const SOFTWARE: &str = concat!("karamelo-rs ", env!("CARGO_PKG_VERSION"));

/// The state to write: after a whole step, time at its end.
pub struct Snapshot<'a> {
    /// Steps done.
    pub step: u64,
    /// Time \[T\].
    pub time: f64,
    /// Everything that has a place.
    pub world: &'a World,
}

/// A series of files.
pub trait Dump: Send {
    /// What its fields need of the scene.
    fn needs(&self, plan: &mut Plan, dimension: usize);

    /// Writes one snapshot; gives the names of the files written, `*` for the step. All processes do
    /// so together, each with the particles and nodes it has; the first one has the file.
    ///
    /// # Errors
    /// In the first process, the path and the system's reason.
    fn write(&mut self, snapshot: &Snapshot<'_>) -> Result<Vec<String>, Fault>;

    /// Puts into a checkpoint, or takes from it, where a growing file ends.
    fn keep(&mut self, _checkpoint: &mut Checkpoint) {}
}

/// A column of the log.
#[derive(Clone)]
pub enum LogColumn {
    /// Size of the step.
    Dt,
    /// Time.
    Time,
    /// What limits the size of the step.
    DtLimit,
    /// A variable or result.
    Quantity {
        /// Its name.
        name: String,
        /// Its formula.
        formula: Formula,
    },
}

/// What a dump is about.
pub struct DumpTarget {
    /// The group.
    pub group: GroupId,
    /// Its kind.
    pub kind: GroupKind,
    /// Where its name stands in the script.
    pub group_span: Span,
    /// The file, `*` for the step.
    pub file: String,
    /// Where its name stands in the script.
    pub file_span: Span,
    /// 1, 2 or 3.
    pub dimension: usize,
}

impl DumpTarget {
    /// Refuses a file without one of these suffixes.
    ///
    /// # Errors
    /// It has another one.
    pub fn need_suffix(&self, what: &str, known: &[&str]) -> Result<(), Diagnostic> {
        if known.iter().any(|suffix| self.file.ends_with(suffix)) {
            return Ok(());
        }
        let message = format!("`{}` has no suffix of {what}", self.file);
        Err(Diagnostic::error(Code::UnknownField, self.file_span, message)
            .label("unknown suffix")
            .help(format!("one of {}", known.join(", "))))
    }
}

/// Builds a dump from its arguments.
pub type BuildDump = fn(&mut Args<'_>, &DumpTarget) -> Result<Box<dyn Dump>, Diagnostic>;

/// All dump styles.
pub const DUMPS: &[Style<BuildDump>] = &[
    particle::TEXT,
    particle::GZIP,
    particle::BINARY,
    particle::VTK,
    nodes::TEXT,
    nodes::GZIP,
    nodes::BINARY,
    nodes::VTK,
    picture::STYLE,
    pyplot::STYLE,
];
