//! What can go wrong while a run is under way.
//!
//! A phase that fails returns the first [`Fault`]; the run then stops itself, keeps its log and
//! its last good dump, and tells the user where, when and why.

/// Which exit code a fault leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultKind {
    /// The physics or the numbers went wrong (exit code 1).
    Run,
    /// The same, and a smaller time step may help.
    Step,
    /// A file could not be read or written (exit code 3).
    File,
}

/// A failure during a run, in words a user can act on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{what}")]
pub struct Fault {
    /// Decides the exit code.
    pub kind: FaultKind,
    /// What happened: names particle or node, its solid and its place where there is one.
    pub what: String,
    /// The likely cause and what to try, where known.
    pub cause: Option<String>,
}

impl Fault {
    /// A fault of the simulation itself.
    pub fn run(what: impl Into<String>) -> Self {
        Self { kind: FaultKind::Run, what: what.into(), cause: None }
    }

    /// A fault of the simulation that a smaller time step may help.
    pub fn step(what: impl Into<String>) -> Self {
        Self { kind: FaultKind::Step, ..Self::run(what) }
    }

    /// A fault of the file system: the path and the system's reason.
    pub fn file(path: &std::path::Path, reason: &std::io::Error) -> Self {
        let what = format!("cannot write `{}`: {reason}", path.display());
        Self { kind: FaultKind::File, what, cause: None }
    }

    /// A file that cannot be read: the path and the system's reason.
    pub fn unreadable(path: &std::path::Path, reason: &std::io::Error) -> Self {
        let what = format!("cannot read `{}`: {reason}", path.display());
        Self { kind: FaultKind::File, what, cause: None }
    }

    /// The same fault with its likely cause.
    pub fn because(mut self, cause: impl Into<String>) -> Self {
        self.cause = Some(cause.into());
        self
    }
}
