//! Every script of `inputs/`: the energy ledger closes within 1 %.

use super::ledger::TERMS;
use super::script::{Played, Script};
use std::path::Path;

/// The part of the largest energy that may be missing or too much.
const GATE: f64 = 0.01;

/// Particle-steps of a script in the quick test.
const BUDGET: usize = 2_000_000;

/// Scenes that the quick test plays in another size. All others it plays as they are. If the
/// budget does not suffice, their runs end early.
const SIZES: [(&str, &[(&str, f64)]); 8] = [
    ("block.mpm", &[("cells", 10.0), ("steps", 50.0)]),
    ("copper-block.mpm", &[("cells", 6.0)]),
    ("dam-break/dam-break.mpm", &[("cells", 40.0), ("ppc", 2.0)]),
    ("disk-impact/disk-impact.mpm", &[("h", 2.4)]),
    ("plate-penetration/plate-penetration.mpm", &[("width", 30.0), ("end", 0.01)]),
    ("square.mpm", &[("cells", 30.0)]),
    ("taylor-bar/taylor-bar.mpm", &[("h", 1.0)]),
    ("upsetting/upsetting-3d.mpm", &[("quarter", 1.0), ("h", 2.0)]),
];

/// Names of all scripts below a folder of `inputs/`.
fn scripts(folder: &Path, before: &str, found: &mut Vec<String>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let name = format!("{before}{}", entry.file_name().to_str().unwrap());
        match entry.file_type().unwrap().is_dir() {
            true => scripts(&entry.path(), &format!("{name}/"), found),
            false if name.ends_with(".mpm") => found.push(name),
            false => {}
        }
    }
}

fn all_scripts() -> Vec<String> {
    let mut found = Vec::new();
    scripts(&Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs"), "", &mut found);
    found.sort();
    for (name, _) in SIZES {
        assert!(found.iter().any(|found| found == name), "no {name}");
    }
    found
}

/// The largest energy of all rows.
fn largest(played: &Played) -> f64 {
    let all = TERMS.iter().flat_map(|(term, _)| played.column(&format!("W_{term}")));
    all.fold(0.0, |largest, energy| energy.abs().max(largest))
}

/// The largest residual of all rows over the largest energy.
fn worst(played: &Played) -> f64 {
    let residual = played.column("W_residual").into_iter().map(f64::abs).fold(0.0, f64::max);
    if residual > 0.0 { residual / largest(played) } else { residual }
}

/// The largest imbalance of a row without one term, over the largest energy.
fn imbalance_without(played: &Played, dropped: &str) -> f64 {
    let mut sums = vec![0.0; played.column("W_residual").len()];
    for (term, sign) in TERMS.iter().filter(|(term, _)| *term != dropped) {
        let values = played.column(&format!("W_{term}"));
        for (sum, value) in sums.iter_mut().zip(&values) {
            *sum += sign * (value - values[0]);
        }
    }
    let largest = largest(played);
    sums.iter().fold(0.0, |worst: f64, sum| worst.max((sum / largest).abs()))
}

/// Worst error of the ledger of a script. A ledger without the term that matters most must not close,
/// or the scene has shown nothing.
fn close(name: &str, script: &Script, variables: &[(&str, f64)]) -> f64 {
    let played = script.play(variables);
    assert!(played.end.is_ok(), "{name}: {:?}", played.end);
    let error = worst(&played);
    assert!(error.is_finite(), "{name}: {error}");
    let term = TERMS.map(|(term, _)| (imbalance_without(&played, term), term));
    let (seen, term) = term.into_iter().fold((0.0, ""), |a, b| if b.0 > a.0 { b } else { a });
    println!("{name}: worst error of the ledger {error:.1e}; {seen:.2} without {term}");
    // A scene of heat alone moves nothing.
    let still = played.column("W_kinetic").iter().all(|kinetic| *kinetic == 0.0);
    assert!(still || seen > GATE, "{name}: nothing happens");
    error
}

fn assert_closed(errors: &[(String, f64)]) {
    let open: Vec<_> =
        errors.iter().filter(|(_, error)| error.is_nan() || *error >= GATE).collect();
    assert!(errors.len() >= 14 && open.is_empty(), "{open:?}");
}

#[test]
fn the_ledger_of_every_input_closes_within_one_per_cent() {
    let errors: Vec<(String, f64)> = all_scripts()
        .into_iter()
        .map(|name| {
            let script = Script::input(&name).with_ledger();
            let size = SIZES.iter().find(|(known, _)| *known == name);
            let variables = size.map_or(&[][..], |(_, variables)| variables);
            let start = script.at_most(0).play(variables);
            let particles = start.session.simulation.world.particles.len().max(1);
            let steps = (BUDGET / particles / script.runs().max(1)).max(20);
            (name.clone(), close(&name, &script.at_most(steps as u64), variables))
        })
        .collect();
    assert_closed(&errors);
}

#[test]
#[ignore = "minutes: cargo test --release -- --ignored"]
fn the_ledger_of_every_input_as_it_stands_closes_within_one_per_cent() {
    let errors: Vec<(String, f64)> = all_scripts()
        .into_iter()
        .map(|name| (name.clone(), close(&name, &Script::input(&name).with_ledger(), &[])))
        .collect();
    assert_closed(&errors);
}
