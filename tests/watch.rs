//! `watch`: trouble is seen before numbers fail, the run goes back and takes smaller steps, and what it
//! cannot help leaves a state to go on with.

use assert_cmd::cargo::cargo_bin;
use karamelo::output::restart;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

/// A bar with a piston that starts at once at 1.5 times the wave speed: a step that waves allow turns
/// the first cells inside out. E = 1, rho = 1, nu = 0: c = 1.
const PISTON: &str = "
h = 1/8
method(ulmpm, FLIP, linear, 1)
dimension(2, 0, 4, 0, 1, h)
region(bar, block, 1, 3, 0, 1)
region(left, block, INF, 1 + h/4, INF, INF)
region(floor, block, INF, INF, INF, h/4)
region(roof, block, INF, INF, 1 - h/4, INF)
material(m, neo-hookean, 1, 1, 0)
solid(s, region, bar, 2, m, h)
group(piston, nodes, region, left)
group(low, nodes, region, floor)
group(high, nodes, region, roof)
fix(f, velocity_nodes, low, NULL, 0)
fix(g, velocity_nodes, high, NULL, 0)
speed = 1.5
fix(push, velocity_nodes, piston, if(time > 0.5, speed, 0), NULL)
compute(Ek, kinetic_energy, all)
log_modify(custom, dt, time, Ek, push_x, dt_limit)
set_output(10)
";

const RUN: &str = "run_time(0.7)\n";

fn place(text: &str) -> TempDir {
    let place = tempfile::tempdir().unwrap();
    std::fs::write(place.path().join("in.mpm"), text).unwrap();
    place
}

fn run(place: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(cargo_bin!("karamelo-rs"));
    command.current_dir(place).arg("--quiet").args(arguments).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn log(place: &Path) -> String {
    std::fs::read_to_string(place.join("log.mpm")).unwrap()
}

/// The rows of the log as words.
fn rows(place: &Path) -> Vec<Vec<String>> {
    let log = log(place);
    let rows =
        log.lines().filter(|line| line.trim_start().starts_with(|c: char| c.is_ascii_digit()));
    rows.map(|row| row.split_whitespace().map(str::to_string).collect()).collect()
}

fn last_number(place: &Path, column: usize) -> f64 {
    rows(place).last().unwrap()[column].parse().unwrap()
}

/// How often the log says that the run went back.
fn rescues(place: &Path) -> usize {
    log(place).matches("going on from step").count()
}

#[test]
fn a_sudden_piston_is_rescued_and_gives_what_small_steps_give() {
    let plain = place(&format!("{PISTON}{RUN}"));
    let output = run(plain.path(), &["in.mpm"]);
    assert_eq!(output.status.code(), Some(1), "{}", log(plain.path()));
    for words in ["inside out", "material `m`", "in a cell with", "J = -", "step ", "likely cause"]
    {
        assert!(said(&output).contains(words), "{words}: {}", said(&output));
    }
    let watched = place(&format!("{PISTON}watch(on)\n{RUN}"));
    let output = run(watched.path(), &["in.mpm"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let count = rescues(watched.path());
    assert!((1..10).contains(&count), "{}", log(watched.path()));
    assert!(log(watched.path()).contains(&format!("{count} times the run went back")));
    // Far smaller steps need no rescue.
    let small = place(&format!("{PISTON}watch(on)\ndt_factor(0.1)\n{RUN}"));
    assert_eq!(run(small.path(), &["in.mpm"]).status.code(), Some(0));
    assert_eq!(rescues(small.path()), 0, "{}", log(small.path()));
    for (column, name) in [(3, "Ek"), (2, "time")] {
        let [found, exact] = [&watched, &small].map(|place| last_number(place.path(), column));
        println!("{name}: {found} and {exact} with small steps, {count} rescues");
        assert!((found / exact - 1.0).abs() < 0.1, "{name}: {found} {exact}");
    }
    // Steps grow back to what waves allow.
    let dt = |place: &TempDir| rows(place.path()).iter().rev().nth(1).unwrap()[1].parse::<f64>();
    assert!(dt(&watched).unwrap() > 3.0 * dt(&small).unwrap());
}

#[test]
fn a_watch_with_nothing_to_see_changes_no_byte() {
    let quiet = PISTON.replace("speed = 1.5", "speed = 0.1");
    let dump = "dump(d, all, particle, 2, d.*.txt, x, y, vx, vy, s11, J)\nrestart(13, s.*.rst)\n";
    let [plain, watched] = ["", "watch(on, interval, 3)\n"].map(|watch| {
        let place = place(&format!("{quiet}{dump}{watch}{RUN}"));
        let output = run(place.path(), &["in.mpm"]);
        assert_eq!(output.status.code(), Some(0), "{}", said(&output));
        place
    });
    assert_eq!(rows(plain.path()), rows(watched.path()));
    let mut compared = 0;
    for entry in std::fs::read_dir(plain.path()).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if name.starts_with("d.") {
            let [a, b] =
                [&plain, &watched].map(|place| std::fs::read(place.path().join(&name)).unwrap());
            assert!(a == b, "{name}");
            compared += 1;
        }
    }
    assert!(compared > 2);
}

#[test]
fn what_cannot_be_helped_leaves_the_last_good_state() {
    let hopeless = PISTON.replace("speed = 1.5", "speed = 1e6");
    let rest = "watch(on, retries, 2, interval, 4)\nrestart(1000, s.*.rst)\n\
                dump(d, all, particle, 5, d.*.txt, x, y)\n";
    let place = place(&format!("{hopeless}{rest}{RUN}"));
    let output = run(place.path(), &["in.mpm"]);
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    assert_eq!(said(&output).matches("going on from step").count(), 2, "{}", said(&output));
    let names: Vec<String> = std::fs::read_dir(place.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    // One is due at step 0; the other one is the last copy.
    let saved: Vec<&String> =
        names.iter().filter(|name| name.ends_with(".rst") && *name != "s.0.rst").collect();
    assert_eq!(saved.len(), 1, "{names:?}");
    assert!(
        said(&output).contains(&format!("`{}` holds the state", saved[0])),
        "{}",
        said(&output)
    );
    let bytes = std::fs::read(place.path().join(saved[0])).unwrap();
    assert!(restart::decode(&bytes).is_ok());
    // It is the state before the piston moves: without the piston the run goes on from it.
    let calm = format!(
        "read_restart({})\ndelete_fix(push)\nlog_modify(default)\nwatch(off)\nrun(20)\n",
        saved[0]
    );
    std::fs::write(place.path().join("calm.mpm"), calm).unwrap();
    let output = run(place.path(), &["calm.mpm"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
}

#[test]
fn an_instability_is_seen_before_numbers_fail() {
    let unstable = PISTON.replace("speed = 1.5", "speed = 0.01");
    let fails_at = |watch: &str| {
        let place =
            place(&format!("{unstable}set_dt(2*h, force)\nset_output(1)\n{watch}run(2000)\n"));
        let output = run(place.path(), &["in.mpm"]);
        assert_eq!(output.status.code(), Some(1), "{}", said(&output));
        (rows(place.path()).len(), said(&output))
    };
    let (plain, _) = fails_at("");
    let (watched, text) = fails_at("watch(on, retries, 0)\n");
    println!("without watch {plain} rows, with it {watched}");
    assert!(watched < plain, "{watched} {plain}");
    assert!(
        text.contains("of solid `s` (material `m`)") && text.contains("in a cell with"),
        "{text}"
    );
    assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
}
