//! Errors of displacements, their orders, and the gates they must pass.

use super::script::{Played, Script};
use super::way::{Row, Way};
use std::ops::RangeInclusive;

/// A problem: a script of `inputs`, to be played with these variables.
#[derive(Clone)]
pub struct Problem {
    /// The script; its fix `error` compares with the exact displacement.
    pub script: Script,
    /// Variables set as with `-var`.
    pub variables: Vec<(&'static str, f64)>,
}

impl Problem {
    /// A script of `inputs`, told to log every step.
    pub fn input(name: &str, variables: &[(&'static str, f64)]) -> Self {
        let script = Script::input(name)
            .statement("log_modify(", "log_modify(custom, step, dt, error_x, error_y)")
            .statement("set_output(", "set_output(1)");
        Self { script, variables: variables.to_vec() }
    }

    /// The same problem with another script.
    pub fn map(&self, change: impl Fn(Script) -> Script) -> Self {
        Self { script: change(self.script.clone()), ..self.clone() }
    }

    /// Error of one way to compute on a grid.
    pub fn error(&self, way: &Way, cells: usize) -> f64 {
        let mut variables = self.variables.clone();
        variables.push(("cells", cells as f64));
        error(&way.of(self.script.clone()).play(&variables))
    }

    /// Errors of one way to compute on several grids.
    pub fn errors(&self, way: &Way, cells: &[usize]) -> Vec<f64> {
        cells.iter().map(|cells| self.error(way, *cells)).collect()
    }
}

/// Largest RMS error of the displacement over all steps, relative to the largest RMS of the exact
/// displacement; infinite for a run that breaks off.
///
/// The fix `error` publishes sum dt e2 and sum dt n2: the increments of every step are e2 and n2.
fn error(played: &Played) -> f64 {
    if played.end.is_err() {
        return f64::INFINITY;
    }
    let dt = played.column("dt");
    let largest = |name: &str| {
        let sums = played.column(name);
        let rates = (1..sums.len()).map(|row| (sums[row] - sums[row - 1]) / dt[row]);
        rates.fold(0.0, f64::max)
    };
    (largest("error_x") / largest("error_y")).sqrt()
}

/// Observed order between two grids.
fn order(cells: [usize; 2], errors: [f64; 2]) -> f64 {
    (errors[0] / errors[1]).ln() / (cells[1] as f64 / cells[0] as f64).ln()
}

/// Order between the last two of several grids; 0 for a single one.
fn last_order(cells: &[usize], errors: &[f64]) -> f64 {
    match (cells, errors) {
        ([.., coarse, fine], [.., before, after]) => order([*coarse, *fine], [*before, *after]),
        _ => 0.0,
    }
}

/// What the errors on several grids must be.
pub struct Gate {
    /// Cells of each grid, coarse to fine.
    pub cells: Vec<usize>,
    /// Error expected on each grid.
    pub expected: Vec<f64>,
    /// Deviation allowed, relative to the error expected.
    pub tolerance: f64,
    /// Order allowed between the last two grids.
    pub order: RangeInclusive<f64>,
}

impl Gate {
    /// The gate of a row of the table of transfers.
    pub fn of(row: &Row, tolerance: f64, order: RangeInclusive<f64>) -> Self {
        Self { cells: row.cells.clone(), expected: row.errors.clone(), tolerance, order }
    }

    /// Runs a problem and tells what fails, in words that repeat the run.
    pub fn check(&self, problem: &Problem, way: &Way) -> Result<(), String> {
        let errors = problem.errors(way, &self.cells);
        let order = last_order(&self.cells, &errors);
        let near =
            |(found, expected): (&f64, &f64)| (found / expected - 1.0).abs() <= self.tolerance;
        if errors.iter().zip(&self.expected).all(near) && self.order.contains(&order) {
            return Ok(());
        }
        let list = |numbers: &[f64]| {
            numbers.iter().map(|number| format!("{number:.4e}")).collect::<Vec<_>>().join(", ")
        };
        Err(format!(
            "inputs/{} with -var {:?}, -var cells {:?} and\n{way}\n  error    {}\n  \
             expected {} within {:e}\n  order    {order:.3}, allowed {:?}\n",
            problem.script.name(),
            problem.variables,
            self.cells,
            list(&errors),
            list(&self.expected),
            self.tolerance,
            self.order,
        ))
    }
}

/// Fails with all reports at once.
pub fn assert_all(checks: impl IntoIterator<Item = Result<(), String>>) {
    let mut count = 0;
    let failures: Vec<String> =
        checks.into_iter().inspect(|_| count += 1).filter_map(Result::err).collect();
    assert!(count > 0, "nothing was checked");
    assert!(failures.is_empty(), "{} of {count} fail:\n{}", failures.len(), failures.join("\n"));
}

/// A gate that lets the problem pass must stop each of its broken variants.
pub fn assert_fails(
    gate: &Gate,
    problem: &Problem,
    way: &Way,
    broken: impl Fn(&Problem) -> Vec<Problem>,
) {
    gate.check(problem, way).expect("the problem itself passes");
    for (variant, broken) in broken(problem).iter().enumerate() {
        let report = gate.check(broken, way);
        assert!(report.is_err(), "variant {variant} passes");
        println!("variant {variant}: {}", report.unwrap_err());
    }
}
