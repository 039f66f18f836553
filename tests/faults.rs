//! What happens when the machine fails: signals, kills, disks.

use assert_cmd::cargo::cargo_bin;
use karamelo::output::restart;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A ball that bounces; 52 particles.
const SCENE: &str = "
method(ulmpm, APIC, quadratic-spline)
dimension(2, 0, 1, 0, 20, 0.1)
region(disk, sphere, 0.5, 0.5, 0.2)
region(ground, block, INF, INF, INF, 0.2)
material(rubber, neo-hookean, 1000, 1e5, 0.3)
solid(ball, region, disk, 2, rubber, 0.1)
group(floor, nodes, region, ground)
fix(fall, initial_velocity_particles, all, 0, -1)
fix(stop, velocity_nodes, floor, NULL, 0)
compute(Ek, kinetic_energy, all)
log_modify(custom, dt, time, Ek, stop_y)
dump(d, all, particle, 1, d.*.txt, x, y, vx, vy, s12)
dump(g, all, particle, 1, growing.txt, x, y)
";

fn place(rest: &str) -> TempDir {
    let place = tempfile::tempdir().unwrap();
    std::fs::write(place.path().join("in.mpm"), format!("{SCENE}{rest}")).unwrap();
    place
}

fn command(place: &Path) -> Command {
    let mut command = Command::new(cargo_bin!("karamelo-rs"));
    command.current_dir(place).arg("--quiet").stderr(Stdio::piped());
    command
}

fn run(place: &Path, file: &str) -> Output {
    command(place).arg(file).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn names(place: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(place).unwrap();
    entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect()
}

/// The largest step of the files `prefix.STEP.suffix`.
fn last_step(place: &Path, prefix: &str, suffix: &str) -> Option<u64> {
    let step = |name: &String| name.strip_prefix(prefix)?.strip_suffix(suffix)?.parse::<u64>().ok();
    names(place).iter().filter_map(step).max()
}

fn wait_for(mut done: impl FnMut() -> bool) {
    let begin = Instant::now();
    while !done() {
        assert!(begin.elapsed() < Duration::from_secs(120), "nothing happens");
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn send(signal: &str, child: &Child) {
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
}

/// The bytes of the files that a run leaves, but for logs and restart files.
fn dumps(place: &Path, from: u64) -> Vec<(String, Vec<u8>)> {
    let step = |name: &str| name.split('.').nth(1).and_then(|part| part.parse::<u64>().ok());
    let wanted = |name: &String| {
        name == "growing.txt" || name.ends_with(".txt") && step(name).is_some_and(|s| s > from)
    };
    let mut list: Vec<(String, Vec<u8>)> = names(place)
        .into_iter()
        .filter(wanted)
        .map(|name| (name.clone(), std::fs::read(place.join(name)).unwrap()))
        .collect();
    list.sort();
    list
}

#[test]
fn a_signal_ends_the_step_and_leaves_a_file_to_go_on_with() {
    let runs = "run(400)\nfix(calm, damping_nodes, all, 5)\nrun(50)\n";
    let whole = place(runs);
    assert_eq!(run(whole.path(), "in.mpm").status.code(), Some(0));
    for (signal, code) in [("-INT", 130), ("-TERM", 143)] {
        let part = place(runs);
        let child = command(part.path()).arg("in.mpm").spawn().unwrap();
        wait_for(|| last_step(part.path(), "d.", ".txt") >= Some(20));
        send(signal, &child);
        let output = child.wait_with_output().unwrap();
        let text = said(&output);
        if output.status.code() == Some(0) {
            println!("not tested: the run was faster than {signal}");
            continue;
        }
        assert_eq!(output.status.code(), Some(code), "{text}");
        assert!(text.contains("go on with: karamelo-rs in.interrupted.rst"), "{text}");
        let log = std::fs::read_to_string(part.path().join("log.mpm")).unwrap();
        assert!(log.contains("Loop time of"));
        let output = run(part.path(), "in.interrupted.rst");
        assert_eq!(output.status.code(), Some(0), "{}", said(&output));
        assert!(dumps(whole.path(), 0) == dumps(part.path(), 0), "{signal}");
        // The log goes on in the same file, every row is there.
        let rows = |place: &Path| {
            let log = std::fs::read_to_string(place.join("log.mpm")).unwrap();
            let is_row = |line: &&str| line.trim_start().starts_with(|c: char| c.is_ascii_digit());
            log.lines().filter(is_row).map(str::to_string).collect::<Vec<_>>()
        };
        assert_eq!(rows(whole.path()), rows(part.path()));
    }
}

#[test]
fn a_second_signal_stops_at_once() {
    // Nothing looks at the first one while particles are made.
    let scene = "method(ulmpm, FLIP, linear, 1)\ndimension(3, 0, 1, 0, 1, 0, 1, 1/80)\n\
        region(r, block, INF, INF, INF, INF, INF, INF)\nmaterial(m, linear, 1000, 1e5, 0.3)\n\
        solid(s, region, r, 3, m, 1/80)\nrun(100000)\n";
    let place = tempfile::tempdir().unwrap();
    std::fs::write(place.path().join("in.mpm"), scene).unwrap();
    let child = command(place.path()).arg("in.mpm").spawn().unwrap();
    wait_for(|| place.path().join("log.mpm").exists());
    send("-INT", &child);
    std::thread::sleep(Duration::from_millis(20));
    send("-INT", &child);
    let begin = Instant::now();
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(130));
    assert!(begin.elapsed() < Duration::from_secs(20));
}

#[test]
fn kills_at_any_moment_leave_whole_files_to_go_on_with() {
    const STEPS: u64 = 400;
    let rest = format!("restart(1, s.*.rst)\nrun({STEPS})\n");
    let (whole, part) = (place(&rest), place(&rest));
    assert_eq!(run(whole.path(), "in.mpm").status.code(), Some(0));
    let lines =
        |name: &str| std::fs::read_to_string(part.path().join(name)).unwrap().lines().count();
    let mut seed = 12345u64;
    let mut killed = 0;
    for _ in 0..20 {
        let from = last_step(part.path(), "s.", ".rst");
        let file = from.map_or("in.mpm".to_string(), |step| format!("s.{step}.rst"));
        let mut child = command(part.path()).arg(&file).spawn().unwrap();
        wait_for(|| {
            last_step(part.path(), "s.", ".rst") > from || child.try_wait().unwrap().is_some()
        });
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        std::thread::sleep(Duration::from_micros((seed >> 33) % 4000));
        child.kill().unwrap();
        killed += usize::from(child.wait().unwrap().code().is_none());
        for name in names(part.path()) {
            if name.starts_with('.') {
                continue;
            }
            if name.starts_with("d.") {
                assert_eq!(lines(&name), 11 + 52, "{name}");
            }
            if name.ends_with(".rst") {
                let bytes = std::fs::read(part.path().join(&name)).unwrap();
                assert!(restart::decode(&bytes).is_ok(), "{name}");
            }
        }
    }
    assert!(killed >= 10, "only {killed} of 20 runs were killed before their end");
    let last = last_step(part.path(), "s.", ".rst").unwrap();
    println!("{killed} of 20 runs killed, the last file is that of step {last} of {STEPS}");
    let output = run(part.path(), &format!("s.{last}.rst"));
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    assert!(dumps(whole.path(), 0) == dumps(part.path(), 0));
}

#[test]
fn every_cut_and_flip_of_a_restart_file_is_refused() {
    let place = place("run(3)\nwrite_restart(a.rst)\n");
    assert_eq!(run(place.path(), "in.mpm").status.code(), Some(0));
    let good = std::fs::read(place.path().join("a.rst")).unwrap();
    assert!(restart::decode(&good).is_ok());
    let step = good.len() / 400 + 1;
    for at in (0..good.len()).step_by(step) {
        assert!(restart::decode(&good[..at]).is_err(), "cut to {at}");
        let mut flipped = good.clone();
        flipped[at] ^= 1 << (at % 8);
        assert!(restart::decode(&flipped).is_err(), "byte {at}");
        flipped[at..(at + 512).min(good.len())].fill(0);
        assert!(flipped == good || restart::decode(&flipped).is_err(), "zeros from {at}");
    }
}

#[test]
fn a_disk_that_is_full_stops_the_run_with_3_and_leaves_whole_files() {
    // A file may have 64 blocks of 512 bytes: the growing file reaches that after some steps.
    let place = place("restart(7, s.*.rst)\nrun(400)\n");
    let line =
        format!("ulimit -f 64; exec '{}' --quiet in.mpm", cargo_bin!("karamelo-rs").display());
    let output = Command::new("sh").args(["-c", &line]).current_dir(place.path()).output().unwrap();
    assert_eq!(output.status.code(), Some(3), "{}", said(&output));
    let text = said(&output);
    assert!(
        text.contains("cannot write `growing.txt`") || text.contains("cannot write `s."),
        "{text}"
    );
    assert!(text.contains("kept: "), "{text}");
    // Whole snapshots only.
    let growing = std::fs::read_to_string(place.path().join("growing.txt")).unwrap();
    assert_eq!(growing.lines().count() % (11 + 52), 0);
    assert!(growing.ends_with('\n'));
    assert!(names(place.path()).iter().all(|name| !name.ends_with(".part")));
}

#[test]
fn what_cannot_be_written_ends_with_3_and_its_name() {
    let cases = [
        ("write_restart(nowhere/a.rst)\n", "cannot write to the directory `nowhere`"),
        ("restart(5, nowhere/a.*.rst)\nrun(1)\n", "cannot write to the directory `nowhere`"),
        ("run(1)\nwrite_restart(/dev/full)\n", "cannot write `/dev/full`"),
        ("dump(f, all, particle, 1, /dev/full, x)\nrun(1)\n", "cannot write `/dev/full`"),
    ];
    for (rest, words) in cases {
        if words.contains("/dev/full") && !Path::new("/dev/full").exists() {
            continue;
        }
        let place = place(rest);
        let output = run(place.path(), "in.mpm");
        assert_eq!(output.status.code(), Some(3), "{rest}: {}", said(&output));
        assert!(said(&output).contains(words), "{rest}: {}", said(&output));
    }
    // A log that takes nothing, and a script that is a directory.
    let place = place("run(1)\n");
    let output = command(place.path()).args(["in.mpm", "-log", "/dev/full"]).output().unwrap();
    assert_eq!(output.status.code(), Some(3), "{}", said(&output));
    assert!(said(&output).contains("cannot write `/dev/full`"));
    let output = run(place.path(), ".");
    assert_eq!(output.status.code(), Some(3), "{}", said(&output));
}
