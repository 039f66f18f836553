//! What a scene asks for, and nothing else: `check` shows columns, sweeps and effects.

use assert_cmd::cargo::cargo_bin;
use std::process::Command;

/// Two blocks that meet, with nothing else.
const SCENE: &str = "
method(ulmpm, FLIP, linear, 1)
dimension(2, 0, 2, 0, 1, 0.1)
region(left, block, 0.2, 0.9, 0.2, 0.8)
region(right, block, 1.1, 1.8, 0.2, 0.8)
material(rubber, linear, 1000, 1e5, 0.3)
solid(a, region, left, 2, rubber, 0.1)
solid(b, region, right, 2, rubber, 0.1)
fix(throw, initial_velocity_particles, all, 0.5*(1 - x0), 0)
set_dt(1e-3)
run(50)
";

/// What `check` says.
fn check(text: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("in.mpm"), text).unwrap();
    let mut command = Command::new(cargo_bin!("karamelo-rs"));
    let output = command.args(["check", "in.mpm"]).current_dir(folder.path()).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "something was written");
    String::from_utf8(output.stdout).unwrap()
}

/// What stands behind a name in the table.
fn row<'a>(text: &'a str, name: &str) -> &'a str {
    let line = text.lines().find_map(|line| line.trim_start().strip_prefix(name));
    line.unwrap_or_else(|| panic!("no `{name}` in {text}")).trim()
}

fn number(text: &str) -> f64 {
    text.split_whitespace().next().unwrap().parse().unwrap()
}

/// An effect: what is replaced in the scene by what, the row of `check` that turns from off to on,
/// columns that come, and sweeps over the particles that come with them.
type Effect = (&'static str, &'static str, &'static str, &'static [&'static str], f64);

const EFFECTS: [Effect; 8] = [
    ("set_dt(1e-3)\n", "", "adaptive time step", &[], 0.0),
    ("run(50)", "anti_locking(fbar)\nrun(50)", "F-bar", &[], 1.0),
    (
        "run(50)",
        "compute(W, energy_ledger, all)\nlog_modify(custom, W_stored)\nrun(50)",
        "energy ledger",
        &[],
        0.0,
    ),
    (
        "run(50)",
        "dump(f, all, particle, 10, f.*.txt, F11)\nrun(50)",
        "deformation gradient",
        &["F11", "F12", "F21", "F22"],
        0.0,
    ),
    ("FLIP, linear, 1", "APIC, quadratic-spline", "affine velocity field", &[], 0.0),
    ("solid(a", "contact(c, slip, a, b)\nsolid(a", "contact", &[], 2.0),
    ("run(50)", "fix(g, body_force, all, 0, -9.81)\nrun(50)", "fixes in every step", &[], 0.0),
    ("linear, 1)", "linear, 1, thermo-mechanical)", "conduction of heat", &["T"], 3.0),
];

#[test]
fn each_effect_brings_its_columns_and_sweeps_and_no_other() {
    let plain = check(SCENE);
    let columns = |text: &str| -> Vec<String> {
        row(text, "columns").split_whitespace().map(str::to_string).collect()
    };
    let sweeps = |text: &str| number(row(text, "sweeps"));
    assert_eq!(sweeps(&plain), 2.0);
    for (old, new, effect, more, loops) in EFFECTS {
        assert!(SCENE.contains(old), "{effect}: {old}");
        assert!(!row(&plain, effect).starts_with("on"), "{effect} is on already: {plain}");
        let text = SCENE.replace(old, new);
        // Heat needs a law that stores it; contacts stand behind the solids.
        let text = match effect {
            "conduction of heat" => text.replace("1e5, 0.3)", "1e5, 0.3, 500, 10)"),
            "contact" => {
                let (line, rest) = text.split_once("contact(c, slip, a, b)\n").unwrap();
                format!("{line}{rest}").replace("fix(throw", "contact(c, slip, a, b)\nfix(throw")
            }
            _ => text,
        };
        let with = check(&text);
        assert!(row(&with, effect).starts_with("on"), "{effect}: {with}");
        let before = columns(&plain);
        let gained: Vec<String> =
            columns(&with).into_iter().filter(|column| !before.contains(column)).collect();
        assert_eq!(gained, more, "{effect}");
        assert_eq!(sweeps(&with) - sweeps(&plain), loops, "{effect}: {with}");
    }
}

#[test]
fn check_tells_what_a_run_takes() {
    let text = check(SCENE);
    assert_eq!(row(&text, "steps"), "about 50");
    assert!(row(&text, "time").contains("s per step (the first"), "{text}");
    // Steps that fail are told; the script itself is right.
    let falls = "fix(fall, body_force, all, sqrt(5e-3 - time), 0)\nrun(50)";
    let text = check(&SCENE.replace("run(50)", falls));
    assert!(row(&text, "time").contains("the first steps end with"), "{text}");
}

#[test]
fn check_finds_solids_that_overlap_and_groups_without_members() {
    assert!(!check(SCENE).contains("overlap"));
    let text = check(&SCENE.replace("block, 1.1, 1.8", "block, 0.7, 1.8"));
    assert!(text.contains("solids a and b overlap: 12 cells"), "{text}");
    let empty = "region(far, block, 1.9, 2, 0.9, 1)\ngroup(none, particles, region, far)\nrun(50)";
    let text = check(&SCENE.replace("run(50)", empty));
    assert!(row(&text, "group none").ends_with("0 members now: nothing acts on it yet"), "{text}");
}

#[test]
fn a_larger_box_takes_no_memory() {
    let boxed = |size: &str| {
        let text = SCENE.replace("dimension(2, 0, 2, 0, 1, 0.1)", size);
        row(&check(&text), "memory").to_string()
    };
    let small = boxed("dimension(2, 0, 2, 0, 1, 0.1)");
    assert_eq!(small, boxed("dimension(2, -100, 100, -100, 100, 0.1)"));
}
