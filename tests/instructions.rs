//! Instructions per particle-step: a measure of speed without noise.
//!
//! Counted by valgrind where it is installed, as the difference of two runs of different length.

use assert_cmd::cargo::cargo_bin;
use std::path::Path;
use std::process::Command;

/// A scene, the line of its input that chooses the method, what stands there instead, cells along
/// an edge, particles, and the budget of instructions per particle-step.
struct Case(&'static str, &'static str, u32, u64, u64);

const CASES: [Case; 5] = [
    Case("block.mpm", "ulmpm, FLIP, linear, 1", 10, 8000, 550),
    Case("block.mpm", "ulmpm, FLIP, cubic-spline, 1", 8, 4096, 2300),
    Case("square.mpm", "ulmpm, FLIP, linear, 1", 45, 8100, 320),
    Case("square.mpm", "ulmpm, FLIP, cubic-spline, 1", 30, 3600, 800),
    Case("block.mpm", "tlmpm, FLIP, linear, 1", 10, 8000, 1150),
];

/// Instructions of a whole run.
fn count(case: &Case, steps: u32) -> Option<u64> {
    let Case(input, method, cells, ..) = case;
    let inputs = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs");
    let text = std::fs::read_to_string(inputs.join(input)).unwrap();
    let changed = text.replace("ulmpm, FLIP, linear, 1", method);
    let directory = tempfile::tempdir().unwrap();
    let script = directory.path().join(input);
    std::fs::write(&script, changed).unwrap();
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(cargo_bin!("karamelo-rs"))
        .arg(script)
        .args(["--threads", "1", "--quiet", "-log", "none"])
        .args(["-var", "cells", &cells.to_string(), "-var", "steps", &steps.to_string()])
        .current_dir(directory.path())
        .output()
        .ok()?;
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    let line = text.lines().find(|line| line.contains("Collected"))?;
    line.rsplit(' ').next()?.parse().ok()
}

fn per_particle_step(case: &Case) -> Option<u64> {
    let (short, long) = (count(case, 10)?, count(case, 30)?);
    Some((long - short) / (20 * case.3))
}

#[test]
fn elastic_steps_stay_within_their_budget() {
    if cfg!(debug_assertions) {
        println!("not tested: instructions are counted in release builds");
        return;
    }
    for case in &CASES {
        let Case(input, method, .., budget) = case;
        match per_particle_step(case) {
            Some(found) => {
                println!("{input}, {method}: {found} instructions per particle-step of {budget}");
                assert!(found <= *budget, "{input}, {method}: {found} > {budget}");
            }
            None => println!("not tested: valgrind is not installed"),
        }
    }
}
