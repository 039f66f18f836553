//! How far a study is, on a terminal.

use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::time::Instant;

/// Progress of a list of runs of unequal length.
pub struct Pace {
    weights: Vec<f64>,
    done: f64,
    count: usize,
    known: usize,
    total: usize,
    clock: Instant,
    bar: Option<ProgressBar>,
}

impl Pace {
    /// Runs of these weights; `total` counts those that are known already.
    pub fn new(weights: Vec<f64>, total: usize, quiet: bool) -> Self {
        let shown = !quiet && std::io::stderr().is_terminal() && !weights.is_empty();
        let bar = shown.then(|| {
            let bar = ProgressBar::new(total as u64);
            if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos}/{len} runs, {msg}") {
                bar.set_style(style);
            }
            bar
        });
        let known = total - weights.len();
        let mut pace =
            Self { weights, done: 0.0, count: 0, known, total, clock: Instant::now(), bar };
        pace.show();
        pace
    }

    /// A run has ended.
    pub fn done(&mut self, number: usize) {
        self.done += self.weights[number];
        self.count += 1;
        self.show();
    }

    /// Draws the bar.
    pub fn show(&mut self) {
        let Some(bar) = &self.bar else { return };
        bar.set_position((self.known + self.count) as u64);
        bar.set_message(match self.left() {
            Some(seconds) => format!("about {} left", words(seconds)),
            None => "the first one is under way".to_string(),
        });
    }

    /// Seconds left, as the finished runs let expect; `None` before the first one.
    fn left(&self) -> Option<f64> {
        let elapsed = self.clock.elapsed().as_secs_f64();
        let all: f64 = self.weights.iter().sum();
        (self.done > 0.0).then(|| elapsed * (all - self.done) / self.done)
    }

    /// Takes the bar away.
    pub fn finish(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
        debug_assert!(self.known + self.count <= self.total);
    }
}

fn words(seconds: f64) -> String {
    match seconds {
        s if s < 100.0 => format!("{s:.0} s"),
        s if s < 6000.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_follows_from_the_weights() {
        let mut pace = Pace::new(vec![1.0, 3.0], 5, true);
        assert_eq!(pace.left(), None);
        pace.done(0);
        let elapsed = pace.clock.elapsed().as_secs_f64();
        assert!(pace.left().unwrap() >= 2.9 * elapsed);
        pace.done(1);
        assert_eq!(pace.left(), Some(0.0));
        assert_eq!([5.0, 120.0, 7200.0].map(words), ["5 s", "2 min", "2.0 h"]);
    }
}
