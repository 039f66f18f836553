//! Instructions per particle-step: a measure of speed without noise.
//!
//! Counted by valgrind where it is installed, as the difference of two runs of different length.

use assert_cmd::cargo::cargo_bin;
use std::path::Path;
use std::process::Command;

/// Instructions of a whole run.
fn count(input: &str, cells: u32, steps: u32) -> Option<u64> {
    let inputs = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs");
    let directory = tempfile::tempdir().unwrap();
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(cargo_bin!("karamelo-rs"))
        .arg(inputs.join(input))
        .args(["--threads", "1", "--quiet", "-log", "none"])
        .args(["-var", "cells", &cells.to_string(), "-var", "steps", &steps.to_string()])
        .current_dir(directory.path())
        .output()
        .ok()?;
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    let line = text.lines().find(|line| line.contains("Collected"))?;
    line.rsplit(' ').next()?.parse().ok()
}

fn per_particle_step(input: &str, cells: u32, particles: u64) -> Option<u64> {
    let (short, long) = (count(input, cells, 10)?, count(input, cells, 30)?);
    Some((long - short) / (20 * particles))
}

#[test]
fn elastic_steps_stay_within_their_budget() {
    if cfg!(debug_assertions) {
        println!("not tested: instructions are counted in release builds");
        return;
    }
    for (input, cells, particles, budget) in
        [("block.mpm", 10, 20u64.pow(3), 750), ("square.mpm", 45, 90u64.pow(2), 420)]
    {
        match per_particle_step(input, cells, particles) {
            Some(found) => {
                println!("{input}: {found} instructions per particle-step, budget {budget}");
                assert!(found <= budget, "{input}: {found} > {budget}");
            }
            None => println!("not tested: valgrind is not installed"),
        }
    }
}
