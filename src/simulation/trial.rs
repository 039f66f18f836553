//! A few steps of a scene, played and taken back: what a step costs on this machine.

use super::Simulation;
use super::progress::Progress;
use crate::fault::Fault;
use std::time::Instant;

/// Most steps of a trial, and the seconds after which no other one begins.
const STEPS: usize = 40;
const SECONDS: f64 = 0.3;

/// What a step costs.
#[derive(Clone, Copy, Debug)]
pub struct Trial {
    /// Steps that were timed.
    pub steps: usize,
    /// Wall seconds of one, without outputs.
    pub seconds: f64,
    /// Loops over all particles in a step.
    pub sweeps: f64,
    /// Those of them that add to nodes.
    pub scatters: f64,
}

impl Simulation {
    /// Plays some steps without output and brings the state back. Not for several processes.
    ///
    /// # Errors
    /// Why a step failed.
    pub fn trial(&mut self) -> Result<Trial, Fault> {
        let checkpoint = self.remember();
        let trial = self.play_some_steps();
        let back = checkpoint.to_load().and_then(|saved| self.restore(saved));
        back.map_err(|reason| Fault::run(format!("the state does not come back: {reason}")))?;
        trial
    }

    fn play_some_steps(&mut self) -> Result<Trial, Fault> {
        let hooks = self.prepare()?;
        let mut progress = Progress::new(self.clock.time);
        let mut start = Instant::now();
        let mut counts = self.loops.tiles.counts;
        let mut steps = 0;
        for step in 0..=STEPS {
            self.take_step(&hooks, &mut progress)?;
            if step == 0 {
                // The first one finds cold caches.
                (start, counts) = (Instant::now(), self.loops.tiles.counts);
                continue;
            }
            steps = step;
            if start.elapsed().as_secs_f64() > SECONDS {
                break;
            }
        }
        let each = |count: usize| count as f64 / steps as f64;
        Ok(Trial {
            steps,
            seconds: start.elapsed().as_secs_f64() / steps as f64,
            sweeps: each(self.loops.tiles.counts[0] - counts[0]),
            scatters: each(self.loops.tiles.counts[1] - counts[1]),
        })
    }
}

/// Seconds in words: `13.4 us`, `350.0 ms`, `3.50 s`, `4 min 20 s`, `3 h 05 min`, `2 d 7 h`.
pub fn duration(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match whole {
        _ if seconds < 1e-3 => format!("{:.1} us", 1e6 * seconds),
        _ if seconds < 1.0 => format!("{:.1} ms", 1e3 * seconds),
        0..10 => format!("{seconds:.2} s"),
        10..60 => format!("{whole} s"),
        60..3600 => format!("{} min {:02} s", whole / 60, whole % 60),
        3600..86400 => format!("{} h {:02} min", whole / 3600, whole / 60 % 60),
        _ => format!("{} d {} h", whole / 86400, whole / 3600 % 24),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_are_put_in_words() {
        let words = [1.34e-5, 0.35, 3.5, 59.7, 260.0, 11_100.0, 198_000.0].map(duration);
        assert_eq!(words[..3], ["13.4 us", "350.0 ms", "3.50 s"]);
        assert_eq!(words[3..], ["1 min 00 s", "4 min 20 s", "3 h 05 min", "2 d 7 h"]);
    }
}
