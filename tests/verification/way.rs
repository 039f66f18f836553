//! Ways to compute: method, shape, transfer and scheme, and the errors an independent model has.

use super::script::Script;
use std::fmt;

/// A transfer: its name, the words of `method` before and after the shape, a further statement.
struct Transfer {
    name: &'static str,
    before: &'static str,
    after: &'static str,
    statement: &'static str,
}

const fn transfer(name: &'static str, before: &'static str, after: &'static str) -> Transfer {
    Transfer { name, before, after, statement: "" }
}

/// All transfers under test.
const TRANSFERS: [Transfer; 12] = [
    transfer("FLIP 1", "FLIP", ", 1"),
    transfer("FLIP 0.99", "FLIP", ", 0.99"),
    transfer("PIC", "PIC", ""),
    transfer("APIC", "APIC", ""),
    transfer("AFLIP 1", "AFLIP", ", 1"),
    transfer("ASFLIP 1", "ASFLIP", ", 1"),
    transfer("MLS", "MLS", ""),
    transfer("XPIC 2", "XPIC, 2", ""),
    transfer("XPIC 5", "XPIC, 5", ""),
    transfer("FLIP 1 gradient-enhanced", "FLIP", ", 1, gradient-enhanced"),
    transfer("PIC gradient-enhanced", "PIC", ", gradient-enhanced"),
    Transfer {
        name: "FLIP 1 fbar",
        before: "FLIP",
        after: ", 1",
        statement: "\nanti_locking(fbar)",
    },
];

/// Methods and their shapes.
const SHAPES: [(&str, &str); 7] = [
    ("tlmpm", "linear"),
    ("tlmpm", "quadratic-spline"),
    ("tlmpm", "cubic-spline"),
    ("tlmpm", "Bernstein-quadratic"),
    ("ulmpm", "linear"),
    ("ulmpm", "quadratic-spline"),
    ("ulmpm", "cubic-spline"),
];

const SCHEMES: [&str; 3] = ["musl", "usl", "usf"];

/// A way to compute.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Way {
    /// Type of `method`.
    pub method: String,
    /// Shape functions.
    pub shape: String,
    /// Name of the transfer.
    pub transfer: String,
    /// Argument of `scheme`.
    pub scheme: String,
}

impl Way {
    /// A way to compute.
    pub fn new(method: &str, shape: &str, transfer: &str, scheme: &str) -> Self {
        let [method, shape, transfer, scheme] =
            [method, shape, transfer, scheme].map(str::to_string);
        Self { method, shape, transfer, scheme }
    }

    /// FLIP 1 with the MUSL scheme.
    pub fn flip(method: &str, shape: &str) -> Self {
        Self::new(method, shape, "FLIP 1", "musl")
    }

    /// All that the language allows: MLS is for splines only.
    pub fn all() -> Vec<Self> {
        let mut all = Vec::new();
        for (method, shape) in SHAPES {
            for transfer in &TRANSFERS {
                if transfer.name != "MLS" || shape.ends_with("spline") {
                    all.extend(SCHEMES.map(|s| Self::new(method, shape, transfer.name, s)));
                }
            }
        }
        all
    }

    /// The script, told to compute this way.
    pub fn of(&self, script: Script) -> Script {
        script.statement("method(", &self.to_string())
    }

    /// With USF the strain follows from velocities that carry the gradient of the step before:
    /// nothing damps the gradient a node does not see, and FLIP keeps feeding it.
    pub fn is_unstable(&self) -> bool {
        self.transfer == "FLIP 1 gradient-enhanced" && self.scheme == "usf"
    }

    /// Does the particle take the grid's velocity as it is, smoothed in every step?
    pub fn is_pic(&self) -> bool {
        self.transfer == "PIC"
    }
}

impl fmt::Display for Way {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { method, shape, scheme, .. } = self;
        let transfer = TRANSFERS.iter().find(|transfer| transfer.name == self.transfer);
        let Transfer { before, after, statement, .. } = transfer.expect("a transfer under test");
        write!(formatter, "method({method}, {before}, {shape}{after})\nscheme({scheme}){statement}")
    }
}

/// Errors of the independent model for one way on several grids.
pub struct Row {
    /// The way to compute.
    pub way: Way,
    /// Cells of each grid.
    pub cells: Vec<usize>,
    /// Error on each grid.
    pub errors: Vec<f64>,
}

/// The rows of a problem for all ways that are stable, in the table of all transfers and schemes.
pub fn transfer_rows(problem: &str, parameter: &str) -> Vec<Row> {
    let mut rows = all_rows(problem, parameter);
    rows.retain(|row| !row.way.is_unstable());
    rows
}

fn all_rows(problem: &str, parameter: &str) -> Vec<Row> {
    let numbers = |words: &str| words.split(' ').map(|n| n.parse().unwrap()).collect::<Vec<f64>>();
    let rows = include_str!("data/transfer_errors.csv").lines().filter_map(|line| {
        let cells: Vec<&str> = line.split(',').collect();
        let [of, with, method, shape, transfer, scheme, grids, errors] = cells[..] else {
            return None;
        };
        (of == problem && with == parameter).then(|| Row {
            way: Way::new(method, shape, transfer, scheme),
            cells: numbers(grids).into_iter().map(|n| n as usize).collect(),
            errors: numbers(errors),
        })
    });
    rows.collect()
}

/// A measure of FLIP 1 with the MUSL scheme in the table of reference.
pub fn reference(
    problem: &str,
    dimension: usize,
    way: &Way,
    parameter: &str,
    measure: &str,
    cells: usize,
) -> f64 {
    let formulation = &way.method[..2].to_uppercase();
    let kernel = match way.shape.as_str() {
        "quadratic-spline" => "quad",
        "cubic-spline" => "cubic",
        other => other,
    };
    let key =
        format!("{problem},{dimension},{formulation},{kernel},{parameter},{measure},{cells},");
    let table = include_str!("data/reference_errors.csv");
    let row = table.lines().find_map(|line| line.strip_prefix(&key));
    row.unwrap_or_else(|| panic!("no row {key}")).parse().unwrap()
}

#[test]
fn the_table_of_transfers_has_every_legal_way_for_every_problem() {
    let problems =
        [("V2", "v0=0.001"), ("V3", "G=1e-4"), ("V3", "G=0.05"), ("V4", "A=0.05"), ("V5", "G=0.1")];
    for (problem, parameter) in problems {
        let rows = all_rows(problem, parameter);
        let ways: Vec<Way> = rows.into_iter().map(|row| row.way).collect();
        assert_eq!(ways, Way::all(), "{problem} {parameter}");
    }
}
