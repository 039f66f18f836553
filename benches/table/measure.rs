//! Measures a row of the table.

use crate::callgrind;
use crate::program::Program;
use crate::rows::{Goal, Row};
use crate::sample::Sample;
use crate::scene::{Dialect, Size};

/// How the table is measured.
pub struct Settings {
    /// Size of the scenes.
    pub size: Size,
    /// Steps are divided by this.
    pub shorten: u32,
    /// Measurements of each row.
    pub rounds: usize,
    /// Count instructions?
    pub count: bool,
    /// The program to compare with.
    pub karamelo: Option<Program>,
}

/// What has been measured of a row.
#[derive(Default)]
pub struct Measured {
    /// This program, in the unit of the goal.
    pub ours: Sample,
    /// Karamelo, in the same unit.
    pub karamelo: Sample,
    /// How many times faster than Karamelo, pair by pair.
    pub ratio: Sample,
    /// Relative difference of the last kinetic energies.
    pub difference: Option<f64>,
    /// Bytes per particle.
    pub bytes: Option<u64>,
    /// Instructions per particle-step.
    pub instructions: Option<u64>,
}

/// A value in the unit of the goal, and the last kinetic energy.
type Value = (f64, f64);

impl Settings {
    /// Steps that are timed.
    fn steps(&self, row: &Row) -> u32 {
        (row.steps / self.shorten).max(5)
    }

    /// One more measurement of a row: this program, then Karamelo.
    ///
    /// # Errors
    /// A run that fails.
    pub fn once(&self, row: &Row, measured: &mut Measured) -> Result<(), String> {
        let Some((ours, kinetic)) = self.value(row, &Program::ours())? else { return Ok(()) };
        measured.ours.0.push(ours);
        let Some(karamelo) = &self.karamelo else { return Ok(()) };
        let Some((theirs, expected)) = self.value(row, karamelo)? else { return Ok(()) };
        measured.karamelo.0.push(theirs);
        let faster = match row.goal {
            Goal::Whole(_) => theirs / ours,
            Goal::Speed(_) | Goal::SpeedUp(_) => ours / theirs,
        };
        measured.ratio.0.push(faster);
        measured.difference = Some((kinetic / expected - 1.0).abs());
        Ok(())
    }

    /// Runs a row; `None` if the program has no words for it.
    fn value(&self, row: &Row, program: &Program) -> Result<Option<Value>, String> {
        let steps = self.steps(row);
        let script = |steps| row.scene.script(self.size, steps, program.dialect);
        let Some(text) = script(steps) else { return Ok(None) };
        match row.goal {
            Goal::Speed(_) => {
                // The difference of two runs leaves the set-up out, whichever program it is.
                let before = steps.div_ceil(5);
                let (Some(short), Some(long)) = (script(before), script(before + steps)) else {
                    return Ok(None);
                };
                let short = program.play(&short, 1)?;
                let long = program.play(&long, 1)?;
                let work = row.scene.particles(self.size) as f64 * f64::from(steps);
                Ok(Some((work / (long.cpu - short.cpu) / 1e6, long.kinetic)))
            }
            Goal::SpeedUp(_) => {
                let one = program.play(&text, 1)?;
                let two = program.play(&text, 2)?;
                let ratio = one.steps.zip(two.steps).map(|(one, two)| one / two);
                Ok(ratio.map(|ratio| (ratio, two.kinetic)))
            }
            Goal::Whole(_) => {
                let play = program.play(&text, 1)?;
                Ok(Some((1e3 * play.cpu, play.kinetic)))
            }
        }
    }

    /// What does not depend on the moment: bytes and instructions.
    pub fn fixed(&self, row: &Row, measured: &mut Measured) {
        let program = Program::ours();
        let script = |size, steps| row.scene.script(size, steps, Dialect::Ours).unwrap_or_default();
        measured.bytes = program.bytes_per_particle(&script(self.size, self.steps(row)));
        if self.count && matches!(row.goal, Goal::Speed(_)) {
            let particles = row.scene.particles(Size::Small);
            let script = |steps| script(Size::Small, steps);
            measured.instructions = callgrind::per_particle_step(&program.path, particles, script);
        }
    }
}
