//! `karamelo-rs study` as a user meets it: errors and orders from the command line alone, answers to
//! wrong words, studies that go on.

use assert_cmd::cargo::cargo_bin;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

fn input(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs").join(name)
}

struct Place(TempDir);

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn run(&self, arguments: &[&str]) -> Output {
        let mut command = Command::new(cargo_bin!("karamelo-rs"));
        command.current_dir(self.0.path()).args(arguments).output().unwrap()
    }

    /// A study of a script of `inputs` whose runs are kept in `a.study` and whose table is `a.csv`.
    fn study(&self, script: &str, arguments: &[&str]) -> Output {
        let script = input(script).display().to_string();
        let fixed = ["study", &script, "--csv", "a.csv", "--results", "a.study"];
        self.run(&[&fixed, arguments].concat())
    }

    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.0.path().join(name)).unwrap()
    }

    /// Rows of the table by their names.
    fn rows(&self) -> Vec<HashMap<String, String>> {
        let text = self.read("a.csv");
        let mut lines = text.lines().map(|line| line.split(','));
        let names: Vec<&str> = lines.next().unwrap().collect();
        let row = |fields: std::str::Split<'_, char>| {
            names.iter().zip(fields).map(|(n, f)| (n.to_string(), f.to_string())).collect()
        };
        lines.map(row).collect()
    }
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn number(row: &HashMap<String, String>, name: &str) -> f64 {
    row[name].parse().unwrap_or_else(|_| panic!("{name} of {row:?}"))
}

/// V3 over four shapes, three grids and two transfers. Without cell crossing every shape is of second
/// order (within 0.2: the next term on 8 cells is (pi/8)^2/10 of the error); where particles cross
/// cells hats have no order and their error grows.
#[test]
fn shapes_and_transfers_on_a_line_have_the_orders_of_the_theory() {
    let place = Place::new();
    let shapes = "shape=linear,quadratic-spline,cubic-spline,R4";
    let vary = ["--vary", shapes, "--vary", "transfer=FLIP,APIC", "--vary", "cells=8,16,32"];
    let smooth = place.study("manufactured-1d.mpm", &vary);
    assert_eq!(smooth.status.code(), Some(0), "{}", stderr(&smooth));
    let rows = place.rows();
    assert_eq!(rows.len(), 24);
    for row in rows.iter().filter(|row| row["cells"] != "8") {
        let order = number(row, "order");
        assert!((1.8..=2.2).contains(&order), "{row:?}");
    }
    let crossing =
        place.study("manufactured-1d.mpm", &[&vary[..], &["-var", "G", "0.05"]].concat());
    let said = stdout(&crossing);
    let finest = |shape: &str| {
        let row = |r: &&HashMap<String, String>| {
            r["shape"] == shape && r["transfer"] == "FLIP" && r["cells"] == "32"
        };
        place.rows().iter().find(row).cloned().unwrap()
    };
    assert!(number(&finest("linear"), "order") < 0.5, "{said}");
    assert!((1.8..=2.2).contains(&number(&finest("cubic-spline"), "order")), "{said}");
    assert!(said.contains("worse than on coarser cells and misses the limit"), "{said}");
    assert!(said.contains("the cheapest setting below 1.00 % is "), "{said}");
}

/// V4 in the plane, both methods: the numbers of the independent model are maxima over time, those of
/// `check_solution` are means, so orders are compared; TL hats 2.00, UL cubic 1.97.
#[test]
fn axes_that_are_coupled_keep_the_orders() {
    let place = Place::new();
    let done = place.study(
        "manufactured.mpm",
        &[
            "--vary",
            "method=tlmpm,ulmpm",
            "--vary",
            "shape=linear,cubic-spline",
            "--vary",
            "cells=8,16,32",
            "--jobs",
            "2",
            "--figure",
            "a.svg",
        ],
    );
    assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
    for row in place.rows().iter().filter(|row| row["cells"] == "32") {
        let order = number(row, "order");
        let crosses = row["method"] == "ulmpm" && row["shape"] == "linear";
        let expected = if crosses { -2.0..=1.0 } else { 1.8..=2.2 };
        assert!(expected.contains(&order), "{row:?}");
    }
    let figure = place.read("a.svg");
    assert!(
        figure.contains("Pareto front")
            && figure.contains("method shape")
            && figure.contains(">tlmpm linear<")
    );
}

/// Mean displacement of the bar at a time, relative to 2/PI v0/omega: sin(omega t) in linear theory. With
/// the strains of the bar the limit of fine grids lies 4e-5 below it (160 and 320 cells).
const MEAN: &str = "(xcm(all, x) - L/2)*omega/v0*PI/2";

/// The order is that of V2, 2 +- 0.2; the extrapolation leaves a part h^2 of the error of the finest grid.
#[test]
fn grids_find_the_value_at_zero_by_themselves_and_a_reference_run_agrees() {
    let place = Place::new();
    let mean = ["--vary", "cells=20,40,80", "--error", MEAN, "--set", "run_time=4"];
    let study = |more: &[&str]| {
        let done = place.study("bar.mpm", &[&mean[..], more].concat());
        assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
        let errors: Vec<f64> = place.rows().iter().map(|row| number(row, "error")).collect();
        (stdout(&done), errors, number(&place.rows()[1], "order"))
    };
    let value = (0.8 * std::f64::consts::PI).sin().to_string();
    let (_, exact, order) = study(&["--exact", &value]);
    assert!((1.8..=2.2).contains(&order), "{order} {exact:?}");
    let (said, grids, order) = study(&[]);
    assert!(said.contains("Richardson: ") && (1.8..=2.2).contains(&order), "{said}");
    let (said, run, _) = study(&["--reference", "cells=320"]);
    assert!(said.contains("reference run: "), "{said}");
    for (exact, found) in exact.iter().zip(&grids).chain(exact.iter().zip(&run)) {
        assert!((found - exact).abs() < 0.1 * exact + 5e-5, "{exact} {found}");
    }
    // An absolute error needs no division by what is exact.
    let (said, absolute, _) = study(&["--exact", "0", "--of", "highest"]);
    assert!(absolute.iter().all(|highest| (highest - 1.0).abs() < 0.01), "{said}");
    let words = ["--exact", "1/2"];
    assert_eq!(place.study("bar.mpm", &[&mean[..], &words].concat()).status.code(), Some(2));
}

#[test]
fn a_curve_from_a_file_is_a_reference() {
    let place = Place::new();
    let line = |step: u32| {
        let time = f64::from(step) * 0.01;
        format!("{time},{}\n", (0.2 * std::f64::consts::PI * time).sin())
    };
    let text: String = (0..=1000).map(line).collect();
    std::fs::write(place.0.path().join("mean.csv"), format!("time,mean\n{text}")).unwrap();
    let vary = ["--vary", "cells=20,40", "--error", MEAN, "--reference", "mean.csv"];
    let done = place.study("bar.mpm", &vary);
    assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
    let rows = place.rows();
    assert!(number(&rows[1], "order") >= 1.8, "{rows:?}");
}

#[test]
fn finished_runs_are_not_run_again_unless_something_changed() {
    let place = Place::new();
    let vary = ["--vary", "cells=8,16", "--repeat", "2"];
    place.study("manufactured-1d.mpm", &vary);
    let kept = place.read("a.study");
    assert_eq!(kept.lines().count(), 4);
    let table = place.read("a.csv");
    // A study that was stopped: the last run is missing and its line is torn.
    std::fs::write(place.0.path().join("a.study"), &kept[..kept.len() - 20]).unwrap();
    place.study("manufactured-1d.mpm", &vary);
    let again = place.read("a.study");
    let whole = |text: &str| text.lines().filter(|l| l.split('\t').count() == 9).count();
    assert_eq!((again.lines().count(), whole(&again)), (5, 4), "{again}");
    place.study("manufactured-1d.mpm", &vary);
    assert_eq!(place.read("a.study"), again, "nothing was left to do");
    let values = |text: &str| {
        let field = |line: &str| line.split(',').nth(3).map(str::to_string);
        text.lines().map(field).collect::<Vec<_>>()
    };
    assert_eq!(values(&place.read("a.csv")), values(&table));
    place.study("manufactured-1d.mpm", &["--vary", "cells=8,16", "-var", "G", "1e-3"]);
    assert_eq!(place.read("a.study").lines().count(), 7, "another variable is another run");
}

/// Words of the command line that must be refused, with what the answer must say.
const WRONG: &[(&[&str], &str)] = &[
    (&[], "--vary"),
    (&["--vary", "shape"], "NAME=VALUE"),
    (&["--vary", "shape=linear,linear"], "stands twice"),
    (&["--vary", "cells=8", "--vary", "cells=16"], "varies twice"),
    (&["--vary", "shapes=linear"], "did you mean `shape`"),
    (&["--vary", "cels=8"], "did you mean `cells`"),
    (&["--vary", "threads=0"], "number of threads"),
    (&["--vary", "dt_factor=0.5"], "`dt_factor` would change nothing"),
    (&["--vary", "transfer=XPIC"], "write the terms of XPIC"),
    (&["--vary", "cells=8", "--set", "shape=round"], "unknown shape style `round`"),
    (&["--vary", "cells=8", "--error", "nothing"], "unknown name `nothing`"),
    (&["--vary", "cells=8", "--error", "x0"], "depends on a place"),
    (&["--vary", "cells=8", "--below", "0%"], "positive number"),
    (&["--vary", "cells=8", "--reference", "missing.csv"], "missing.csv"),
    (&["--vary", "cells=8", "--reference", "missing=1"], "missing"),
    (&["--vary", "cells=8", "--exact", "1", "--reference", "cells=9"], "cannot be used with"),
];

#[test]
fn wrong_words_are_refused_with_the_reason() {
    let place = Place::new();
    for (words, expected) in WRONG {
        let refused = place.study("manufactured-1d.mpm", words);
        let said = stderr(&refused);
        assert_eq!(refused.status.code(), Some(2), "{words:?}: {said}");
        assert!(said.contains(expected), "{words:?}: {said}");
    }
    let none = place.study("two-disks.mpm", &["--vary", "hL=0.5"]);
    assert!(stderr(&none).contains("no `check_solution`"), "{}", stderr(&none));
    let absent = place.run(&["study", "absent.mpm", "--vary", "a=1"]);
    assert_eq!(absent.status.code(), Some(3), "{}", stderr(&absent));
}

#[test]
fn combinations_that_cannot_be_are_rows_of_the_table() {
    let place = Place::new();
    let vary = ["--vary", "transfer=FLIP,MLS", "--vary", "cells=8,-1"];
    let done = place.study("manufactured-1d.mpm", &vary);
    let said = stdout(&done);
    assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
    assert!(said.contains("refused: `MLS` needs `quadratic-spline`"), "{said}");
    assert!(said.contains("(line 18, column 21)"), "{said}");
    assert_eq!(said.matches("refused: ").count(), 3, "{said}");
}

#[test]
fn a_run_that_fails_is_a_row_of_the_table() {
    let place = Place::new();
    let vary = ["--vary", "set_dt=0.2*h/c,1.75*h/c", "-var", "cells", "64", "-var", "G", "0.05"];
    let done = place.study("manufactured-1d.mpm", &vary);
    let said = stdout(&done);
    assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
    assert!(said.contains("failed: "), "{said}");
}

#[test]
fn a_single_run_takes_the_same_settings_and_says_so() {
    let place = Place::new();
    let script = input("manufactured-1d.mpm").display().to_string();
    let settings = ["--set", "shape=cubic-spline", "--set", "transfer=APIC", "--set", "scheme=usl"];
    let done = place.run(&[&[script.as_str(), "-var", "cells", "8"], &settings[..]].concat());
    assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
    let log = place.read("log.mpm");
    assert!(log.contains("method(ulmpm, APIC, cubic-spline)"), "{log}");
    assert!(log.contains("scheme(usl)"), "{log}");
    let wrong = place.run(&[&script, "--set", "shape=MLS"]);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(stderr(&wrong).contains(":18:21"), "{}", stderr(&wrong));
    let unknown = place.run(&[&script, "--set", "form=linear"]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(stderr(&unknown).contains("no setting `form`"), "{}", stderr(&unknown));
}
