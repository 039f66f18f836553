//! Instructions per particle-step, counted by valgrind: a measure of speed without noise.

use std::path::Path;
use std::process::Command;

/// The difference of runs of 30 and 10 steps on one thread, per particle and step; `None` without
/// valgrind. `script` gives the text of a run of so many steps.
pub fn per_particle_step(
    program: &Path,
    particles: u64,
    script: impl Fn(u32) -> String,
) -> Option<u64> {
    let [short, long] = [10, 30];
    let steps = u64::from(long - short);
    Some(
        (whole_run(program, &script(long))? - whole_run(program, &script(short))?)
            / (steps * particles),
    )
}

/// Instructions of a whole run.
fn whole_run(program: &Path, script: &str) -> Option<u64> {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("in.mpm"), script).unwrap();
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(program)
        .args(["in.mpm", "--threads", "1", "--quiet", "-log", "none"])
        .current_dir(directory.path())
        .output()
        .ok()?;
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    let line = text.lines().find(|line| line.contains("Collected"))?;
    line.rsplit(' ').next()?.parse().ok()
}
