//! What each effect and each remedy costs: the block of `inputs/block.mpm` with 4096 particles, one change
//! at a time.
//!
//! ```text
//! cargo run --release --example costs
//! ```
//!
//! counts instructions per particle-step with valgrind (`-` without it) and takes CPU nanoseconds per
//! particle-step of one thread, the least of three; both are differences of a long and a short run, so
//! that the start of the program does not count. The program is `karamelo-rs` of the same folder, or the
//! first argument.

#[path = "../benches/table/callgrind.rs"]
mod callgrind;
#[path = "../benches/table/input.rs"]
mod input;

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use wait4::Wait4;

const CELLS: u32 = 8;
const PARTICLES: u64 = 8 * 512;
const METHOD: &str = "ulmpm, FLIP, linear, 1";
const LAW: &str = "material(elastic, linear, 1000, 1000, 0.3)";
const BODY: &str = "solid(block, region, body, 2, elastic, h)";
const OUTPUT: &str = "set_output(0)";

/// A row: what it is, the words of the script that change, and what stands there instead.
type Row = (&'static str, &'static [(&'static str, &'static str)]);

/// Equation of state and elastic strength with the moduli of the block.
const COMPOSITE: &str = "eos(p, linear, 1000, 833.3)
strength(s, linear, 384.6)
material(elastic, eos-strength, p, s)";

/// The same that flows from the second step on.
const FLOWS: &str = "eos(p, linear, 1000, 833.3)
strength(s, johnson_cook, 384.6, 0.5, 3, 0.31, 0.001, 0.025, 1.09, 298, 1356)
material(elastic, eos-strength, p, s)";

const FAILS: &str = "eos(p, linear, 1000, 833.3)
strength(s, johnson_cook, 384.6, 0.5, 3, 0.31, 0.001, 0.025, 1.09, 298, 1356)
damage(d, damage_johnson_cook, 0.54, 4.89, -3.03, 0.014, 1.12, 0.001, 298, 1356)
material(elastic, eos-strength, p, s, d)";

const HEATS: &str = "eos(p, linear, 1000, 833.3)
strength(s, johnson_cook, 384.6, 0.5, 3, 0.31, 0.001, 0.025, 1.09, 298, 1356)
temperature(t, plastic_work, 0.9, 383, 0, 0, 298, 1356)
material(elastic, eos-strength, p, s, t)";

const SHOCKS: &str = "eos(p, shock, 1000, 833.3, 0.91, 1.489, 2.02, 383, 298, 0, 0)
strength(s, linear, 384.6)
material(elastic, eos-strength, p, s)";

/// Two halves of the block on velocities of their own.
const HALVES: &str = "region(low, block, 0, 1, 0, 1, 0, 0.5)
region(high, block, 0, 1, 0, 1, 0.5, 1)
solid(block, region, low, 2, elastic, h)
solid(other, region, high, 2, elastic, h)
contact(touch, frictional, block, other, 0.3)";

const ROWS: &[Row] = &[
    ("hats, FLIP, MUSL, Jaumann rate", &[]),
    ("no second mapping (usf)", &[(OUTPUT, "scheme(usf)\nset_output(0)")]),
    ("tlmpm", &[(METHOD, "tlmpm, FLIP, linear, 1")]),
    ("quadratic-spline", &[(METHOD, "ulmpm, FLIP, quadratic-spline, 1")]),
    (
        "quadratic-spline, no second mapping (usl)",
        &[(METHOD, "ulmpm, FLIP, quadratic-spline, 1"), (OUTPUT, "scheme(usl)\nset_output(0)")],
    ),
    ("cubic-spline", &[(METHOD, "ulmpm, FLIP, cubic-spline, 1")]),
    ("gimp", &[(METHOD, "ulmpm, FLIP, gimp, 1")]),
    ("cpgimp", &[(METHOD, "ulmpm, FLIP, cpgimp, 1")]),
    ("CPDI R8", &[(METHOD, "ulcpdi, FLIP, linear, 1, R8")]),
    ("CPDI H8", &[(METHOD, "ulcpdi, FLIP, linear, 1, H8")]),
    ("F-bar", &[(OUTPUT, "anti_locking(fbar)\nset_output(0)")]),
    ("PIC", &[(METHOD, "ulmpm, PIC, linear")]),
    ("XPIC(2)", &[(METHOD, "ulmpm, XPIC, 2, linear")]),
    ("XPIC(3)", &[(METHOD, "ulmpm, XPIC, 3, linear")]),
    ("XPIC(5)", &[(METHOD, "ulmpm, XPIC, 5, linear")]),
    ("APIC", &[(METHOD, "ulmpm, APIC, linear")]),
    ("APIC, quadratic-spline", &[(METHOD, "ulmpm, APIC, quadratic-spline")]),
    ("MLS, quadratic-spline", &[(METHOD, "ulmpm, MLS, quadratic-spline")]),
    ("gradient-enhanced", &[(METHOD, "ulmpm, FLIP, linear, 1, gradient-enhanced")]),
    ("no objective rate", &[(OUTPUT, "stress_rate(none)\nset_output(0)")]),
    ("Green-Naghdi rate", &[(OUTPUT, "stress_rate(green_naghdi)\nset_output(0)")]),
    ("logarithmic rate", &[(OUTPUT, "stress_rate(logarithmic)\nset_output(0)")]),
    ("neo-Hookean law", &[(LAW, "material(elastic, neo-hookean, 1000, 1000, 0.3)")]),
    ("equation of state and strength", &[(LAW, COMPOSITE)]),
    ("shock curve", &[(LAW, SHOCKS)]),
    ("Johnson-Cook flow", &[(LAW, FLOWS)]),
    ("Johnson-Cook flow and damage", &[(LAW, FAILS)]),
    ("Johnson-Cook flow and heating", &[(LAW, HEATS)]),
    (
        "conduction of heat",
        &[
            (METHOD, "ulmpm, FLIP, linear, 1, thermo-mechanical"),
            (LAW, "material(elastic, linear, 1000, 1000, 0.3, 1, 1e-3)"),
        ],
    ),
    ("frictional contact of two halves", &[(BODY, HALVES)]),
    (
        "energy ledger in every step",
        &[
            ("log_modify(", "compute(W, energy_ledger, all)\nlog_modify(custom, W_error)\n#"),
            (OUTPUT, "set_output(1)"),
        ],
    ),
    ("a log row in every step", &[(OUTPUT, "set_output(1)")]),
    (
        "a text dump of 6 fields in every step",
        &[(OUTPUT, "dump(p, all, particle, 1, p.*.dump, x, y, z, vx, vy, vz)\nset_output(0)")],
    ),
    (
        "a gzip dump in every step",
        &[(OUTPUT, "dump(p, all, particle/gz, 1, p.*.gz, x, y, z, vx, vy, vz)\nset_output(0)")],
    ),
    (
        "a binary dump in every step",
        &[(OUTPUT, "dump(p, all, particle/bin, 1, p.*.bin, x, y, z, vx, vy, vz)\nset_output(0)")],
    ),
];

fn script(row: &Row, steps: u32) -> String {
    let mut text = input::text("block.mpm", CELLS, steps);
    for (old, new) in row.1 {
        assert!(text.contains(old), "`{old}` is not in the script");
        text = text.replacen(old, new, 1);
    }
    text
}

/// CPU seconds of a run; `None` if it stops itself, as hats with an affine transfer may.
fn seconds(program: &Path, script: &str) -> Option<f64> {
    let folder = tempfile::tempdir().expect("a folder for temporary files");
    std::fs::write(folder.path().join("in.mpm"), script).expect("a script");
    let mut command = Command::new(program);
    command.args(["in.mpm", "--threads", "1", "--quiet", "-log", "log"]);
    command.current_dir(folder.path()).stdout(Stdio::null()).stderr(Stdio::null());
    let ended = command.spawn().and_then(|mut child| child.wait4());
    let ended = ended.unwrap_or_else(|reason| panic!("{}: {reason}", program.display()));
    ended.status.success().then(|| (ended.rusage.utime + ended.rusage.stime).as_secs_f64())
}

/// CPU nanoseconds per particle-step.
fn nanoseconds(program: &Path, row: &Row) -> Option<f64> {
    let [short, long] = [10, 110];
    let least = |steps: u32| {
        let text = script(row, steps);
        let times = (0..3).map(|_| seconds(program, &text)).collect::<Option<Vec<f64>>>()?;
        Some(times.into_iter().fold(f64::INFINITY, f64::min))
    };
    Some(1e9 * (least(long)? - least(short)?) / (f64::from(long - short) * PARTICLES as f64))
}

fn program() -> PathBuf {
    let beside = || {
        let example = std::env::current_exe().expect("the place of this program");
        let folder = example.parent().and_then(Path::parent).expect("target/PROFILE");
        folder.join("karamelo-rs")
    };
    std::env::args_os().nth(1).map_or_else(beside, PathBuf::from)
}

fn main() {
    let program = std::path::absolute(program()).expect("a working directory");
    println!("| | instructions | more | CPU ns | more |\n| --- | --- | --- | --- | --- |");
    let mut base = None;
    for row in ROWS {
        let count = callgrind::per_particle_step(&program, PARTICLES, |steps| script(row, steps));
        let Some(time) = nanoseconds(&program, row) else {
            println!("| {} | - | - | stops itself | - |", row.0);
            continue;
        };
        let (first_count, first_time) = *base.get_or_insert((count, time));
        let (count, more) = match (count, first_count) {
            (Some(count), Some(first)) => {
                let more = 100.0 * (count as f64 / first as f64 - 1.0);
                (count.to_string(), format!("{more:+.0} %"))
            }
            _ => ("-".to_string(), "-".to_string()),
        };
        let slower = 100.0 * (time / first_time - 1.0);
        println!("| {} | {count} | {more} | {time:.0} | {slower:+.0} % |", row.0);
    }
}
