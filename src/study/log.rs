//! The log of a measured run, and numbers taken from it.

use std::path::Path;

/// What the log of a run says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Logged {
    /// Time and measured value of each row.
    pub rows: Vec<[f64; 2]>,
    /// Steps of all runs.
    pub steps: f64,
    /// Steps times particles.
    pub particle_steps: f64,
    /// Seconds of the loops over steps.
    pub seconds: f64,
}

/// Reads a log with the columns step, time, measured; `None` if it has no row.
pub fn read(text: &str) -> Option<Logged> {
    let mut logged = Logged::default();
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        if let ["Loop", "time", "of", seconds, .., steps, "steps", "with", particles, _] = words[..]
        {
            let [seconds, steps, particles]: [f64; 3] =
                [seconds.parse().ok()?, steps.parse().ok()?, particles.parse().ok()?];
            logged.seconds += seconds;
            logged.steps += steps;
            logged.particle_steps += steps * particles;
        } else if let [step, time, value] = words[..]
            && step.parse::<u64>().is_ok()
            && let (Ok(time), Ok(value)) = (time.parse(), value.parse())
        {
            logged.rows.push([time, value]);
        }
    }
    (!logged.rows.is_empty()).then_some(logged)
}

/// Which number stands for a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Taken {
    /// The value at the end.
    Last,
    /// The lowest row.
    Lowest,
    /// The highest row.
    Highest,
    /// Root mean square of the distance from a curve of points (time, value), relative to that of
    /// the curve, over the rows within its times.
    Curve(Vec<[f64; 2]>),
}

impl Taken {
    /// The number of a run; NaN if nothing can be compared.
    pub fn of(&self, rows: &[[f64; 2]]) -> f64 {
        let values = rows.iter().map(|row| row[1]);
        match self {
            Taken::Last => rows.last().map_or(f64::NAN, |row| row[1]),
            Taken::Lowest => values.fold(f64::NAN, f64::min),
            Taken::Highest => values.fold(f64::NAN, f64::max),
            Taken::Curve(curve) => distance(rows, curve),
        }
    }
}

fn distance(rows: &[[f64; 2]], curve: &[[f64; 2]]) -> f64 {
    let (mut error, mut norm) = (0.0, 0.0);
    for [time, value] in rows {
        if let Some(exact) = between(curve, *time) {
            error += (value - exact) * (value - exact);
            norm += exact * exact;
        }
    }
    if norm > 0.0 { (error / norm).sqrt() } else { f64::NAN }
}

/// The value of a curve by linear interpolation; `None` outside of it.
fn between(curve: &[[f64; 2]], time: f64) -> Option<f64> {
    let pair = curve.windows(2).find(|pair| pair[0][0] <= time && time <= pair[1][0])?;
    let [[t0, v0], [t1, v1]] = [pair[0], pair[1]];
    let part = if t1 > t0 { (time - t0) / (t1 - t0) } else { 0.0 };
    Some(v0 + part * (v1 - v0))
}

/// Reads a curve: two numbers (time, value) per line, by commas or blanks; lines of words and
/// comments are skipped.
///
/// # Errors
/// The file cannot be read, holds fewer than two points, or its times do not rise.
pub fn curve(path: &Path) -> Result<Vec<[f64; 2]>, String> {
    let text = std::fs::read_to_string(path)
        .map_err(|reason| format!("cannot read `{}`: {reason}", path.display()))?;
    let mut points: Vec<[f64; 2]> = Vec::new();
    for line in text.lines() {
        let words = line.split(|c: char| c == ',' || c.is_whitespace()).filter(|w| !w.is_empty());
        let numbers: Vec<f64> = words.map_while(|word| word.parse().ok()).collect();
        if let [time, value, ..] = numbers[..] {
            points.push([time, value]);
        }
    }
    if points.len() < 2 || points.windows(2).any(|pair| pair[1][0] <= pair[0][0]) {
        let path = path.display();
        return Err(format!(
            "`{path}` is no curve: two points `time value` and more, times rising"
        ));
    }
    Ok(points)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOG: &str = "karamelo-rs\n      Step   Time  measured\n 0 0 1.5\n 10 0.1 -2e-3\n\
        Loop time of 0.5 on 1 procs for 10 steps with 100 particles\n Step Time measured\n\
        10 0.1 -2e-3\n 15 0.2 nan\nLoop time of 0.25 on 1 procs for 5 steps with 90 particles\n";

    #[test]
    fn rows_and_loops_of_all_runs_are_read() {
        let logged = read(LOG).unwrap();
        assert_eq!(logged.rows[..3], [[0.0, 1.5], [0.1, -2e-3], [0.1, -2e-3]]);
        assert!(logged.rows[3][1].is_nan());
        assert_eq!((logged.steps, logged.particle_steps, logged.seconds), (15.0, 1450.0, 0.75));
        assert_eq!(read("no rows\n"), None);
    }

    #[test]
    fn a_number_is_taken_from_the_rows() {
        let rows = [[0.0, 2.0], [1.0, -1.0], [2.0, 1.0]];
        assert_eq!(Taken::Last.of(&rows), 1.0);
        assert_eq!(Taken::Lowest.of(&rows), -1.0);
        assert_eq!(Taken::Highest.of(&rows), 2.0);
        let curve = Taken::Curve(vec![[-1.0, 0.0], [1.0, 2.0]]);
        // Exact 1 and 2 at times 0 and 1, nothing at time 2.
        assert!((curve.of(&rows) - (10.0f64 / 5.0).sqrt()).abs() < 1e-15);
    }
}
