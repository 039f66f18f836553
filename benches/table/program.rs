//! Programs that run scenes, and what a run tells.

use crate::scene::Dialect;
use std::path::{Path, PathBuf};
use std::process::Command;
use wait4::Wait4;

/// An executable and its script language.
pub struct Program {
    pub path: PathBuf,
    pub dialect: Dialect,
}

/// A run that is over.
pub struct Play {
    /// CPU time of the process \[s\].
    pub cpu: f64,
    /// Time of the steps by the clock \[s\], as this program reports it.
    pub steps: Option<f64>,
    /// Kinetic energy of the last row of the log.
    pub kinetic: f64,
}

impl Program {
    /// This program.
    pub fn ours() -> Self {
        Self { path: env!("CARGO_BIN_EXE_karamelo-rs").into(), dialect: Dialect::Ours }
    }

    /// Karamelo.
    ///
    /// # Errors
    /// There is no such file.
    pub fn karamelo(path: &Path) -> Result<Self, String> {
        let path = path.canonicalize().map_err(|reason| format!("{}: {reason}", path.display()))?;
        Ok(Self { path, dialect: Dialect::Karamelo })
    }

    /// Runs a script in a folder of its own.
    ///
    /// # Errors
    /// The program cannot be started, fails, or shows no row of the last step.
    pub fn play(&self, script: &str, threads: u32) -> Result<Play, String> {
        let directory = tempfile::tempdir().map_err(|reason| reason.to_string())?;
        let inside = |name: &str| directory.path().join(name);
        let file = |name| std::fs::File::create(inside(name)).map_err(|reason| reason.to_string());
        let read = |name| std::fs::read_to_string(inside(name)).unwrap_or_default();
        std::fs::write(inside("in.mpm"), script).map_err(|reason| reason.to_string())?;
        let mut command = Command::new(&self.path);
        match self.dialect {
            Dialect::Ours => {
                command.args(["in.mpm", "--quiet", "--threads", &threads.to_string()]);
            }
            Dialect::Karamelo => {
                command.args(["-i", "in.mpm"]);
            }
        }
        command.current_dir(directory.path()).stdout(file("screen")?).stderr(file("errors")?);
        let ended = command.spawn().and_then(|mut child| child.wait4());
        let ended = ended.map_err(|reason| format!("{}: {reason}", self.path.display()))?;
        // This program's screen has fewer digits than its log.
        let log = if self.dialect == Dialect::Ours { "log.mpm" } else { "screen" };
        let text = read(log);
        let kinetic = last_energy(&text).filter(|_| ended.status.success());
        Ok(Play {
            cpu: (ended.rusage.utime + ended.rusage.stime).as_secs_f64(),
            steps: number_after(&text, "Loop time of "),
            kinetic: kinetic.ok_or_else(|| {
                format!("{} failed: {}\n{script}", self.path.display(), read("errors"))
            })?,
        })
    }

    /// Bytes per particle, as `karamelo-rs check` tells them.
    pub fn bytes_per_particle(&self, script: &str) -> Option<u64> {
        let directory = tempfile::tempdir().ok()?;
        std::fs::write(directory.path().join("in.mpm"), script).ok()?;
        let output = Command::new(&self.path)
            .args(["check", "in.mpm"])
            .current_dir(directory.path())
            .output()
            .ok()?;
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        number_after(&text, "bytes per particle").map(|bytes| bytes as u64)
    }
}

/// Ek of the last row `step dt time Ek ...`.
fn last_energy(text: &str) -> Option<f64> {
    let row = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        let whole = words.first()?.parse::<u64>().is_ok() && words.len() >= 5;
        if whole { words[3].parse().ok() } else { None }
    };
    text.lines().rev().find_map(row)
}

/// The number behind some words.
fn number_after(text: &str, words: &str) -> Option<f64> {
    let rest = text.lines().find_map(|line| line.strip_prefix(words))?;
    rest.split_whitespace().next()?.parse().ok()
}
