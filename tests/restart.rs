//! A run that goes on from a restart file gives the bytes of the run that was never stopped.

mod processes;
mod project;

use assert_cmd::cargo::cargo_bin;
use processes::program;
use project::scripts_below;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// Steps of the whole run, and after which of them restart files are written.
const STEPS: u64 = 40;
const INTERVAL: u64 = 13;

/// What every scene shows at its end beside its own outputs: all that a particle can have.
const DUMP: &str = "dump(every_thing, all, particle, 10, every_thing.*.txt, x, y, z, x0, y0, vx, vy, \
    vz, s11, s22, s33, s12, s13, s23, seq, e11, e12, F11, F12, F21, F33, J, volume, mass, damage, \
    damage_init, ep, epdot, T, ienergy, bx, by, bz)\n\
    dump(every_node, all, grid, 10, every_node.*.txt, x, y, z, vx, vy, vz, bx, by, mass, T)\n\
    set_output(1)\n";

fn karamelo(place: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(cargo_bin!("karamelo-rs"));
    command.current_dir(place).args(arguments).arg("--quiet").output().unwrap()
}

fn run(place: &Path, arguments: &[&str]) {
    succeeds(Command::new(cargo_bin!("karamelo-rs")), place, arguments);
}

fn succeeds(mut program: Command, place: &Path, arguments: &[&str]) {
    let output = program.current_dir(place).args(arguments).arg("--quiet").output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {said}");
}

fn write(place: &Path, name: &str, text: &str) {
    std::fs::write(place.join(name), text).unwrap();
}

/// The columns of a restart file: name, numpy type and bytes.
fn columns(path: &Path) -> BTreeMap<String, Vec<u8>> {
    let bytes = std::fs::read(path).unwrap();
    let length = u64::from_le_bytes(bytes[16..24].try_into().unwrap()) as usize;
    let header: serde_json::Value = serde_json::from_slice(&bytes[24..24 + length]).unwrap();
    let data = &bytes[24 + length..];
    let count = |value: &serde_json::Value| value.as_u64().unwrap() as usize;
    let column = |(name, about): (&String, &serde_json::Value)| {
        let kind = about["type"].as_str().unwrap();
        let each = kind[2..].parse::<usize>().unwrap();
        let start = count(&about["offset"]);
        let size = count(&about["rows"]) * count(&about["width"]) * each;
        (format!("{name} {kind}"), data[start..start + size].to_vec())
    };
    header["columns"].as_object().unwrap().iter().map(column).collect()
}

/// The files that a run left: dumps and pictures as bytes, the rows of the log, the columns of the
/// last restart file.
fn left(place: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    for entry in std::fs::read_dir(place).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        match name.as_str() {
            "end.rst" => {
                for (column, bytes) in columns(&path) {
                    // How long the command has been at it is another matter in a run of its own.
                    if !["run/done <u8", "run/end <f8"].contains(&column.as_str()) {
                        files.insert(format!("end.rst: {column}"), bytes);
                    }
                }
            }
            _ if name.ends_with(".rst") || name.ends_with(".mpm") && name != "log.mpm" => {}
            _ => {
                files.insert(name, std::fs::read(&path).unwrap());
            }
        }
    }
    files
}

/// The rows of a log after a step.
fn rows_after(log: &[u8], step: u64) -> Vec<String> {
    let text = String::from_utf8_lossy(log);
    let rows = text.lines().filter_map(|line| {
        let first = line.split_whitespace().next()?.parse::<u64>().ok()?;
        (first > step).then(|| line.to_string())
    });
    rows.collect()
}

/// What differs between a whole run and one that went on after a step.
fn difference(whole: &Path, rest: &Path, step: u64) -> Option<String> {
    let (all, some) = (left(whole), left(rest));
    let name_of_step =
        |name: &str| name.split('.').find_map(|part| part.parse::<u64>().ok()).unwrap_or(u64::MAX);
    for (name, bytes) in &all {
        if name == "log.mpm" {
            let (all, some) =
                (rows_after(bytes, step), rows_after(some.get(name).unwrap_or(&vec![]), step));
            if all.is_empty() || all != some {
                return Some(format!("{name}: {:?} and {:?}", all.last(), some.last()));
            }
        } else if name_of_step(name) > step && some.get(name) != Some(bytes) {
            return Some(format!(
                "{name}: {}",
                if some.contains_key(name) { "differs" } else { "is not there" }
            ));
        }
    }
    let more = some.keys().find(|name| !all.contains_key(*name));
    more.map(|name| format!("{name} is new"))
}

/// A whole run of a scene with its restart files.
struct Whole {
    place: TempDir,
}

impl Whole {
    /// `scene` has no run in it.
    fn new(scene: &str, files: &[PathBuf]) -> Self {
        let whole = Self { place: tempfile::tempdir().unwrap() };
        for file in files {
            std::fs::copy(file, whole.place.path().join(file.file_name().unwrap())).unwrap();
        }
        let text = format!(
            "{scene}\n{DUMP}restart({INTERVAL}, s.*.rst)\nrun({STEPS})\nwrite_restart(end.rst)\n"
        );
        write(whole.path(), "in.mpm", &text);
        run(whole.path(), &["in.mpm", "--threads", "1"]);
        whole
    }

    fn path(&self) -> &Path {
        self.place.path()
    }

    /// Goes on after a step, by a script or with the file alone.
    fn rest(&self, step: u64, by_script: bool, how: &str) -> Option<String> {
        let place = tempfile::tempdir().unwrap();
        let name = format!("s.{step}.rst");
        for entry in std::fs::read_dir(self.path()).unwrap() {
            let path = entry.unwrap().path();
            let own = path.file_name().unwrap().to_string_lossy().into_owned();
            // Files that the script reads, and those that grow.
            if own == name
                || [".msh", ".stl", ".txt"].iter().any(|e| own.ends_with(e))
                    && !own.contains("every")
            {
                std::fs::copy(&path, place.path().join(own)).unwrap();
            }
        }
        match by_script {
            true => {
                go_on(place.path(), step);
                succeeds(program(how), place.path(), &["go.mpm"]);
            }
            false => succeeds(program(how), place.path(), &[&name]),
        }
        difference(self.path(), place.path(), step)
    }

    /// Goes on after a step with a file that has another column; `None` if it is refused.
    fn altered(&self, step: u64, name: &str) -> Option<String> {
        let place = tempfile::tempdir().unwrap();
        let file = format!("s.{step}.rst");
        let mut bytes = std::fs::read(self.path().join(&file)).unwrap();
        spoil(&mut bytes, name);
        std::fs::write(place.path().join(&file), bytes).unwrap();
        go_on(place.path(), step);
        match karamelo(place.path(), &["go.mpm"]).status.code() {
            Some(0) => difference(self.path(), place.path(), step),
            code => Some(format!("{code:?}")),
        }
    }
}

/// The script that goes on after a step.
fn go_on(place: &Path, step: u64) {
    let rest = STEPS - step;
    let text = format!("read_restart(s.{step}.rst)\nrun({rest})\nwrite_restart(end.rst)\n");
    write(place, "go.mpm", &text);
}

/// Turns all bytes of a column to zero, or to one where they are zero; the checksum is right again.
fn spoil(bytes: &mut [u8], name: &str) {
    let length = u64::from_le_bytes(bytes[16..24].try_into().unwrap()) as usize;
    let header: serde_json::Value = serde_json::from_slice(&bytes[24..24 + length]).unwrap();
    let about = &header["columns"][name];
    assert!(about.is_object(), "no column `{name}`");
    let count = |what: &str| about[what].as_u64().unwrap() as usize;
    let each = about["type"].as_str().unwrap()[2..].parse::<usize>().unwrap();
    let (start, size) = (24 + length + count("offset"), count("rows") * count("width") * each);
    let column = &mut bytes[start..start + size];
    match column.iter().all(|byte| *byte == 0) {
        true => column.iter_mut().step_by(each).for_each(|byte| *byte = 1),
        false => column.fill(0),
    }
    let checksum = crc32fast::hash(&bytes[16..]);
    bytes[12..16].copy_from_slice(&checksum.to_le_bytes());
}

/// Ways to go on: after which step, by a script or with the file alone, in how many threads or
/// processes.
#[cfg(not(feature = "mpi"))]
const WAYS: &[(u64, bool, &str)] = &[(13, true, "1"), (26, false, "2"), (39, true, "2")];
#[cfg(feature = "mpi")]
const WAYS: &[(u64, bool, &str)] = &[(26, false, "3 processes"), (39, true, "2 processes")];

/// Goes on in all these ways.
fn check(name: &str, scene: &str, files: &[PathBuf]) -> Vec<String> {
    let whole = Whole::new(scene, files);
    let found = WAYS.iter().filter_map(|(step, by_script, how)| {
        let difference = whole.rest(*step, *by_script, how)?;
        Some(format!("{name} after step {step} in {how}: {difference}"))
    });
    found.collect()
}

/// Two bodies of different laws that meet, with gravity and a floor.
const SCENE: &str = "
h = 1/8
method(ulmpm, FLIP, linear, 0.99)
dimension(3, -0.5, 1.5, -0.5, 1.5, 0, 2, h)
region(low, block, 0.1, 0.9, 0.1, 0.9, 0.1, 0.7)
region(ball, sphere, 0.5, 0.5, 1.0, 0.25)
region(ground, block, INF, INF, INF, INF, INF, 0.1 + h/4)
material(soft, neo-hookean, 1000, 1e5, 0.3, 500, 1e4)
eos(curve, shock, 2000, 5.6e5, 20, 1.5, 2, 383, 298, 1.5, 0.1)
strength(flow, johnson_cook, 4.2e5, 1e4, 2e4, 0.3, 1, 0.02, 1, 298, 1356)
damage(crack, damage_johnson_cook, 0.3, 0.1, -1, 0.01, 0.5, 1, 298, 1356)
temperature(heat, plastic_work, 0.9, 383, 2e4, 1e-5, 298, 1356)
material(hard, eos-strength, curve, flow, crack, heat)
solid(base, region, low, 2, soft, h, 298)
solid(body, region, ball, 2, hard, h)
group(particles, particles, region, ball, solid, body)
group(floor, nodes, region, ground)
fix(drop, initial_velocity_particles, particles, 0.3, 0.1*x, -9)
fix(gravity, body_force, all, 0, 0, -9.81)
fix(stand, velocity_nodes, floor, 0, 0, 0)
compute(Ek, kinetic_energy, all)
compute(Es, strain_energy, all)
start = value(xcm(particles, z))
fallen = start - xcm(particles, z)
lift = internal_force(floor, z)
log_modify(custom, step, dt, time, Ek, Es, stand_z, fallen, lift, dt_limit)
plot(fall, 3, time, fallen)
save_plot(fall.csv)
dump(growing, all, particle, 7, growing.txt, x, y, z)
";

const METHOD: &str = "method(ulmpm, FLIP, linear, 0.99)";

#[test]
fn every_method_goes_on_to_the_bit() {
    let methods = [
        METHOD,
        "method(ulmpm, AFLIP, cubic-spline, 0.99)\nscheme(usl)",
        "method(ulmpm, XPIC, 2, quadratic-spline)\nscheme(usf)\nanti_locking(fbar)",
        "method(ulmpm, MLS, quadratic-spline)",
        "method(ulmpm, FLIP, linear, 0.99, gradient-enhanced)",
        "method(tlmpm, FLIP, Bernstein-quadratic, 0.99)\nanti_locking(fbar)",
        "method(tlmpm, ASFLIP, cubic-spline, 0.99)",
        "method(tlmpm, APIC, linear)\nscheme(usf)",
        "method(ulmpm, FLIP, linear, 0.99, thermo-mechanical)",
        "method(tlmpm, FLIP, quadratic-spline, 0.99, thermo-mechanical)",
        "method(ulmpm, APIC, gimp)",
        "method(ulmpm, FLIP, cpgimp, 0.99)",
        "method(ulcpdi, FLIP, linear, 0.99, H8)\nscheme(usl)",
        "method(ulcpdi, AFLIP, linear, 0.99, thermo-mechanical)\nanti_locking(fbar)",
        "method(tlcpdi, FLIP, linear, 0.99)",
    ];
    let wrong: Vec<String> = methods
        .iter()
        .flat_map(|method| check(method, &SCENE.replace(METHOD, method), &[]))
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Scenes about laws and fixes: what stands in place of a line of [`SCENE`], and what follows.
const VARIANTS: [(&str, &str, &str, &str); 14] = [
    ("constant dt", "", "", "set_dt(1e-4)"),
    ("jaumann", "neo-hookean, 1000", "linear, 1000", "stress_rate(jaumann)"),
    ("logarithmic", "neo-hookean, 1000", "linear, 1000", "stress_rate(logarithmic)"),
    ("metal", "neo-hookean, 1000, 1e5, 0.3, 500, 1e4", "von-mises, 1000, 1e5, 0.3, 500, 1e3", ""),
    (
        "soil",
        "neo-hookean, 1000, 1e5, 0.3, 500, 1e4",
        "mohr-coulomb, 2000, 1e5, 0.3, 1e3, 30, 5, 5e2, 1e5, 2e2, 25, 0",
        "",
    ),
    (
        "cone",
        "neo-hookean, 1000, 1e5, 0.3, 500, 1e4",
        "drucker-prager, 2000, 1e5, 0.3, 1e3, 30, 5, inner",
        "",
    ),
    (
        "gas",
        "eos(curve, shock, 2000, 5.6e5, 20, 1.5, 2, 383, 298, 1.5, 0.1)",
        "eos(curve, ideal-gas, 2000, 5/3, 20, 2, 0.5)",
        "",
    ),
    (
        "rigid",
        "neo-hookean, 1000, 1e5, 0.3, 500, 1e4",
        "rigid, 1000",
        "group(plate, particles, region, low, solid, base)
         fix(lift, velocity_particles, plate, 0, 0, 0.1)",
    ),
    (
        "friction",
        "fix(gravity",
        "contact(c, frictional, base, body, 0.3)\nfix(gravity",
        "log_modify(custom, dt, Ek, c_x, c_z, c_s)",
    ),
    (
        "pairs",
        "fix(gravity",
        "fix(touch, contact/minimize_penetration, base, body, 0.2)\nfix(gravity",
        "log_modify(custom, dt, Ek, touch_z, touch_s)",
    ),
    (
        "ledger",
        "",
        "",
        "compute(W, energy_ledger, all)
        log_modify(custom, dt, Ek, W_stored, W_plastic, W_numerical, W_boundary, W_residual)",
    ),
    (
        "tools",
        "",
        "",
        "fix(ball, indent, all, sphere, 1e3, 0.5, 0.5, 0.9 - time, 0.2)
        fix(tool, cuttingtool, all, 0.001, 0.3,0.5,0, 0,0,0, 0.1,0.6, 0.1,0.2)
        fix(calm, damping_nodes, all, 3)
        fix(slow, damping_local_nodes, all, 0.1)
        log_modify(custom, dt, Ek, ball_z, ball_s, tool_x, tool_s, calm_s, slow_s)",
    ),
    (
        "fixes",
        "",
        "",
        "region(mid, block, 0.3, 0.7, 0.3, 0.7, 0.3, 0.5)
        group(core, nodes, region, mid)
        fix(push, force_nodes, core, 1, 2*time, 0)
        fix(error, check_solution, all, 0, 0, -4.5*time^2)
        fix(begin, initial_velocity_nodes, core, 0.1, NULL, NULL)
        fix(warm, temperature_particles, particles, 298 + 0.5*time)
        log_modify(custom, dt, error_s, error_x, error_z, push_x, warm_x, warm_s)",
    ),
    (
        "walls",
        "fix(stand, velocity_nodes, floor, 0, 0, 0)",
        "fix(fly, initial_velocity_particles, all, 4, 1, -5)\nboundary(delete)",
        "log_modify(custom, dt, Ek)",
    ),
];

#[test]
fn every_law_fix_and_contact_goes_on_to_the_bit() {
    let mut wrong = Vec::new();
    for (name, old, new, more) in VARIANTS {
        assert!(SCENE.contains(old), "{name}");
        let mut scene = SCENE.replace(old, new) + more;
        match name {
            "walls" => scene = scene.replace(", stand_z", ""),
            "gas" => scene = scene.replace("curve, flow, crack, heat", "curve, flow"),
            _ => {}
        }
        wrong.extend(check(name, &scene, &[]));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The scripts of `inputs`, without the runs and what follows them.
fn inputs() -> Vec<(PathBuf, String)> {
    let without_runs = |path: PathBuf| {
        let text = std::fs::read_to_string(&path).unwrap();
        let before = text.lines().take_while(|line| !line.trim_start().starts_with("run"));
        let before = before.collect::<Vec<_>>().join("\n");
        (path, before)
    };
    scripts_below("inputs").into_iter().map(without_runs).collect()
}

#[test]
#[ignore = "half a minute: every script of inputs"]
fn every_input_goes_on_to_the_bit() {
    let mut wrong = Vec::new();
    let scripts = inputs();
    assert!(scripts.len() > 20);
    for (path, text) in scripts {
        let files: Vec<PathBuf> = std::fs::read_dir(path.parent().unwrap())
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .filter(|file| file.extension().is_some_and(|e| e == "msh" || e == "stl"))
            .collect();
        wrong.extend(check(&path.display().to_string(), &text, &files));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Columns without which a run does not go on to the bit, and scenes that show it.
const NEEDED: [(&str, &str, &[&str]); 4] = [
    (
        METHOD,
        "",
        &[
            "clock/step",
            "clock/time",
            "clock/dt",
            "next/dt",
            "run/previous",
            "loop/travelled",
            "particle/id",
            "particle/solid",
            "particle/position",
            "particle/velocity",
            "particle/cell",
            "particle/F11",
            "particle/s12",
            "particle/J",
            "particle/ep",
            "particle/T",
            "particle/damage_init",
            "particle/groups0",
            "group/floor/internal_force/z",
            "output/plot/fall/points",
            "output/dump/growing/length",
            "output/last_row",
        ],
    ),
    (
        "method(tlmpm, APIC, linear)",
        "",
        &[
            "particle/matrix0",
            "particle/matrix2",
            "particle/reference",
            "node/motion",
            "node/displacement",
            "particle/velocity",
        ],
    ),
    (
        "method(ulcpdi, FLIP, linear, 0.99, H8)",
        "set_dt(1e-3)",
        &["particle/domain0", "particle/domain7", "node/corners", "run/steps", "run/start"],
    ),
    (
        METHOD,
        "contact(c, frictional, base, body, 0.3)
        compute(W, energy_ledger, all)
        fix(ball, indent, all, sphere, 1e3, 0.5, 0.5, 0.9 - time, 0.2)
        fix(error, check_solution, all, 0, 0, -4.5*time^2)
        log_modify(custom, dt, Ek, c_s, W_residual, ball_s, error_x)",
        &[
            "contact/c/heat",
            "couple/drag",
            "ledger/sums",
            "ledger/numbers",
            "particle/displacement",
            "fix/ball/work",
            "fix/ball/before",
            "fix/error/error",
            "fix/drop/started",
        ],
    ),
];

#[test]
fn no_column_can_be_left_out() {
    let mut missed = Vec::new();
    for (method, more, names) in NEEDED {
        let whole = Whole::new(&(SCENE.replace(METHOD, method) + more), &[]);
        for name in names {
            if whole.altered(26, name).is_none() {
                missed.push(format!("{method}: {name}"));
            }
        }
    }
    assert!(missed.is_empty(), "nothing changes without {missed:?}");
}

#[test]
fn several_runs_are_one() {
    let outputs = |runs: &str| {
        let place = tempfile::tempdir().unwrap();
        write(place.path(), "in.mpm", &format!("{SCENE}{DUMP}{runs}write_restart(end.rst)\n"));
        run(place.path(), &["in.mpm"]);
        (left(place.path()), place)
    };
    let (_, one) = outputs("run(30)\n");
    let (_, three) = outputs("run(7)\nprint(Ek)\nrun(0)\nrun(13)\nset_output(1)\nrun(10)\n");
    // The figure has a point more at the end of each run.
    std::fs::remove_file(three.path().join("fall.csv")).unwrap();
    std::fs::remove_file(one.path().join("fall.csv")).unwrap();
    let found = difference(one.path(), three.path(), 0);
    assert!(found.is_none_or(|found| found.contains("plot/fall")), "a run in three parts differs");
    // What changes the scene between two runs makes a new one.
    let (_, other) = outputs("run(7)\nfix(nothing, body_force, all, 0, 0, 0)\nrun(23)\n");
    assert!(difference(one.path(), other.path(), 7).is_some());
}

#[test]
fn a_run_for_a_time_ends_where_all_of_it_would_have() {
    let place = tempfile::tempdir().unwrap();
    write(
        place.path(),
        "in.mpm",
        &format!(
            "{SCENE}restart(10, s.*.rst)\nrun_time(0.1)\nend = time\n\
        print(value(time))\ndump(last, all, particle, 1, last.*.txt, x, vz)\nrun(1)\n"
        ),
    );
    run(place.path(), &["in.mpm"]);
    let rest = tempfile::tempdir().unwrap();
    for name in ["s.20.rst", "growing.txt"] {
        std::fs::copy(place.path().join(name), rest.path().join(name)).unwrap();
    }
    // The rest of the time, rounded to what the log shows.
    write(
        rest.path(),
        "go.mpm",
        "read_restart(s.20.rst)\nrun_time(0.1 - value(time))\n\
        dump(last, all, particle, 1, last.*.txt, x, vz)\nrun(1)\n",
    );
    run(rest.path(), &["go.mpm"]);
    assert_eq!(difference(place.path(), rest.path(), 20), None);
}

#[test]
fn a_script_may_change_the_scene_it_goes_on_with() {
    let whole = Whole::new(SCENE, &[]);
    let go = |more: &str| {
        let place = tempfile::tempdir().unwrap();
        std::fs::copy(whole.path().join("s.13.rst"), place.path().join("s.13.rst")).unwrap();
        write(place.path(), "go.mpm", &format!("n = 3\nread_restart(s.13.rst)\n{more}"));
        let output = karamelo(place.path(), &["go.mpm"]);
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned(), place)
    };
    let (code, said, place) = go("delete_fix(gravity)\nundump(growing)\nset_dt(1e-4)\n\
        compute(new, average_velocity, particles)\nlog_modify(custom, time, new_z, fallen)\n\
        group(more, particles, region, ball, solid, base)\nrun(n)\nwrite_restart(two.rst)\n");
    assert_eq!(code, Some(0), "{said}");
    // A restart file of a run that began with one.
    write(
        place.path(),
        "again.mpm",
        "read_restart(two.rst)\nlog_modify(custom, n, new_z)\nrun(n)\n",
    );
    run(place.path(), &["again.mpm"]);
    let log = std::fs::read_to_string(place.path().join("log.mpm")).unwrap();
    let last = log.lines().rfind(|line| line.trim_start().starts_with("19 ")).unwrap();
    assert_eq!(last.split_whitespace().nth(1), Some("3"), "{log}");
    for (more, words) in [
        ("region(low, sphere, 0, 0, 0, 1)\n", "region ID `low` is used twice"),
        ("scheme(usl)\n", "below a run"),
        ("a = Ex\n", "did you mean `Ek`"),
        ("Ek = 3\n", "is a result"),
    ] {
        let (code, said, _) = go(more);
        assert_eq!(code, Some(2), "{more}: {said}");
        assert!(said.contains(words), "{more}: {said}");
    }
}

#[test]
fn a_file_that_cannot_be_used_is_refused_with_the_reason() {
    let whole = Whole::new(SCENE, &[]);
    let place = tempfile::tempdir().unwrap();
    let good = std::fs::read(whole.path().join("s.13.rst")).unwrap();
    let mut flipped = good.clone();
    flipped[good.len() / 2] ^= 4;
    let mut newer = good.clone();
    newer[8] = 9;
    for (bytes, words) in [
        (&good[..good.len() - 1], "damaged or cut off"),
        (&good[..10], "cut off"),
        (&flipped[..], "damaged"),
        (&newer[..], "version 9"),
        (&b"method(ulmpm, FLIP, linear, 1)"[..], "no restart file"),
    ] {
        std::fs::write(place.path().join("s.13.rst"), bytes).unwrap();
        go_on(place.path(), 13);
        let output = karamelo(place.path(), &["go.mpm"]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(3), "{words}: {said}");
        assert!(said.contains(words) && said.contains("s.13.rst"), "{words}: {said}");
        assert_eq!(said.matches("error").count(), 1, "{said}");
    }
}

#[test]
fn a_file_that_the_script_reads_must_be_what_it_was() {
    let place = tempfile::tempdir().unwrap();
    let scene = "method(ulmpm, FLIP, linear, 1)\ndimension(2, 0, 1, 0, 1, 0.1)\n\
        material(m, linear, 1000, 1e5, 0.3)\nsolid(s, file, dots.txt, m, 0.1)\n\
        run(5)\nwrite_restart(a.rst)\n";
    write(place.path(), "dots.txt", "0.5 0.5 0.001\n0.55 0.5 0.001\n");
    write(place.path(), "in.mpm", scene);
    write(place.path(), "go.mpm", "read_restart(a.rst)\nrun(1)\n");
    run(place.path(), &["in.mpm"]);
    run(place.path(), &["go.mpm"]);
    write(place.path(), "dots.txt", "0.5 0.5 0.001\n0.56 0.5 0.001\n");
    let output = karamelo(place.path(), &["go.mpm"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(3));
    assert!(said.contains("the file `dots.txt` has changed since"), "{said}");
}

/// The code of the manual that reads a restart file.
#[test]
fn numpy_reads_a_restart_file() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/src/formats.md");
    let page = std::fs::read_to_string(page).unwrap();
    let after = page.split("```python file=read_restart.py\n").nth(1).unwrap();
    let code = after.split("```").next().unwrap();
    let readers = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/readers/bin/python");
    let python = [readers, PathBuf::from("python3")].into_iter().find(|python| {
        let numpy = Command::new(python).args(["-c", "import numpy"]).output();
        numpy.is_ok_and(|output| output.status.success())
    });
    let Some(python) = python else {
        println!("not tested: Python's numpy is not installed");
        return;
    };
    let whole = Whole::new(SCENE, &[]);
    std::fs::copy(whole.path().join("s.26.rst"), whole.path().join("state.rst")).unwrap();
    let check = "\nids = column('particle/id')[:, 0]\n\
        for row in numpy.argsort(ids): print(ids[row], *column('particle/position')[row, :3])\n";
    write(whole.path(), "read.py", &format!("{code}{check}"));
    let output = Command::new(python)
        .args(["read.py", "state.rst"])
        .current_dir(whole.path())
        .output()
        .unwrap();
    let (text, said) =
        (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{said}");
    let rows = text.lines().filter(|line| line.split(' ').count() == 4);
    let rows: Vec<Vec<f64>> =
        rows.map(|line| line.split(' ').map(|word| word.parse().unwrap()).collect()).collect();
    // The file stands between the dumps of steps 20 and 30.
    let dump = |step: u32| -> Vec<Vec<f64>> {
        let name = format!("every_thing.{step}.txt");
        let text = std::fs::read_to_string(whole.path().join(name)).unwrap();
        let row = |line: &str| line.split(' ').map(|word| word.parse().unwrap()).collect();
        text.lines().skip(11).map(row).collect()
    };
    let (before, after) = (dump(20), dump(30));
    assert_eq!(rows.len(), before.len());
    let moved = rows.iter().zip(before.iter().zip(&after)).filter(|(row, (before, after))| {
        let [low, high] = [before[5].min(after[5]), before[5].max(after[5])];
        row[0] == before[0] && (low..=high).contains(&row[3])
    });
    assert!(moved.count() > rows.len() / 2);
}
