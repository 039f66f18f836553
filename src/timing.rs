//! Wall time by phase.

use std::time::{Duration, Instant};

/// Parts of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Mass, momentum and force to the nodes, where it is a loop of its own.
    PointsToGrid,
    /// Passes over the nodes.
    Grid,
    /// Velocities back to the particles, second mapping.
    GridToPoints,
    /// Velocity gradient, law, movement and P2G of the next step.
    Stress,
    /// Fixes.
    Fixes,
    /// Sorting.
    Sort,
    /// Bodies that meet with velocities of their own.
    Contact,
    /// Conduction of heat.
    Heat,
    /// Rigid bodies on the grid.
    Rigid,
    /// Averages of the dilation (F-bar).
    Dilation,
    /// Repeated mappings (XPIC).
    Filter,
    /// The energy ledger.
    Ledger,
    /// Log, dumps, pictures.
    Output,
}

/// Names of the phases, in order.
pub const PHASES: [&str; 13] = [
    "P2G",
    "grid",
    "G2P",
    "stress+P2G",
    "fixes",
    "sort",
    "contact",
    "conduction",
    "rigid",
    "F-bar",
    "XPIC",
    "ledger",
    "output",
];

/// A stopwatch with one hand per phase.
#[derive(Clone, Debug)]
pub struct Timing {
    spent: [Duration; PHASES.len()],
    /// Time of each fix, which is not in that of the phase.
    fixes: Vec<(String, Duration)>,
    last: Instant,
}

impl Default for Timing {
    fn default() -> Self {
        Self { spent: Default::default(), fixes: Vec::new(), last: Instant::now() }
    }
}

impl Timing {
    /// Starts again from zero, with these fixes.
    pub fn restart<'a>(&mut self, fixes: impl Iterator<Item = &'a str>) {
        let fixes = fixes.map(|id| (id.to_string(), Duration::default())).collect();
        *self = Self { fixes, ..Self::default() };
    }

    /// Books the time since the last call on a phase.
    pub fn end(&mut self, phase: Phase) {
        let now = Instant::now();
        self.spent[phase as usize] += now - self.last;
        self.last = now;
    }

    /// Books the time since `start` on an effect within a phase, which does not get it.
    pub fn aside(&mut self, effect: Phase, start: Instant) {
        let spent = start.elapsed();
        self.spent[effect as usize] += spent;
        self.last += spent;
    }

    /// The same for a fix, by its number.
    pub fn aside_fix(&mut self, fix: usize, start: Instant) {
        let spent = start.elapsed();
        if let Some((_, sum)) = self.fixes.get_mut(fix) {
            *sum += spent;
            self.last += spent;
        }
    }

    /// Seconds by phase, then by fix.
    pub fn seconds(&self) -> impl Iterator<Item = (String, f64)> + '_ {
        let phases = PHASES.iter().zip(&self.spent);
        let phases = phases.map(|(name, spent)| ((*name).to_string(), spent.as_secs_f64()));
        let fixes = self.fixes.iter();
        phases.chain(fixes.map(|(id, spent)| (format!("fix {id}"), spent.as_secs_f64())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_an_effect_takes_is_not_in_the_phase_around_it() {
        let mut timing = Timing::default();
        timing.restart(["gravity"].into_iter());
        let pause = Duration::from_millis(20);
        for effect in [true, false] {
            let start = Instant::now();
            std::thread::sleep(pause);
            match effect {
                true => timing.aside(Phase::Contact, start),
                false => timing.aside_fix(0, start),
            }
        }
        timing.end(Phase::Grid);
        let of = |name: &str| timing.seconds().find(|(known, _)| known == name).unwrap().1;
        assert!(of("contact") >= 0.02 && of("fix gravity") >= 0.02);
        assert!(of("grid") < 0.02, "{}", of("grid"));
    }
}
