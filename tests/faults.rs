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

/// A small file system in memory, unmounted in the end; `None` where nothing may be mounted.
struct SmallDisk(TempDir);

impl SmallDisk {
    fn new(size: &str) -> Option<Self> {
        let place = tempfile::tempdir().unwrap();
        let options = format!("size={size}");
        let mount = Command::new("mount")
            .args(["-t", "tmpfs", "-o", &options, "small"])
            .arg(place.path())
            .stderr(Stdio::null())
            .status();
        mount.is_ok_and(|status| status.success()).then_some(Self(place))
    }

    fn path(&self) -> &Path {
        self.0.path()
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg("-l").arg(self.0.path()).status();
    }
}

#[test]
fn a_small_file_system_that_is_full_stops_the_run_with_3_and_can_be_gone_on_from() {
    let Some(disk) = SmallDisk::new("200k") else {
        println!("not tested: no file system may be mounted here");
        return;
    };
    std::fs::write(disk.path().join("in.mpm"), format!("{SCENE}restart(5, s.*.rst)\nrun(400)\n"))
        .unwrap();
    let output = run(disk.path(), "in.mpm");
    let text = said(&output);
    assert_eq!(output.status.code(), Some(3), "{text}");
    assert!(text.contains("cannot write `") && text.contains("No space left on device"), "{text}");
    assert!(names(disk.path()).iter().all(|name| !name.ends_with(".part")), "{text}");
    // What has its name is whole.
    for name in names(disk.path()) {
        let bytes = std::fs::read(disk.path().join(&name)).unwrap();
        if name.starts_with("d.") {
            assert_eq!(bytes.iter().filter(|byte| **byte == b'\n').count(), 11 + 52, "{name}");
        }
        assert!(!name.ends_with(".rst") || restart::decode(&bytes).is_ok(), "{name}");
    }
    // With room again the run goes on from the last file.
    let last = last_step(disk.path(), "s.", ".rst").unwrap();
    let elsewhere = place("run(400)\n");
    let file = format!("s.{last}.rst");
    std::fs::copy(disk.path().join(&file), elsewhere.path().join(&file)).unwrap();
    std::fs::write(elsewhere.path().join("on.mpm"), format!("read_restart({file})\nrun(3)\n"))
        .unwrap();
    let output = run(elsewhere.path(), "on.mpm");
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
}

#[test]
fn a_directory_that_vanishes_is_named_whoever_writes_into_it() {
    for (writer, name) in [
        ("dump(o, all, grid, 1, out/g.*.txt, mass)", "out/g."),
        ("dump(o, all, particle/gz, 1, out/p.*.gz, x)", "out/p."),
        ("dump(o, all, pyplot, 1, out/i.*.svg, 100, 100)", "out/i."),
        ("restart(1, out/s.*.rst)", "out/s."),
    ] {
        let place = place(&format!("{writer}\nrun(1000000)\n"));
        let folder = place.path().join("out");
        std::fs::create_dir(&folder).unwrap();
        let child = command(place.path()).arg("in.mpm").spawn().unwrap();
        wait_for(|| names(&folder).iter().any(|name| !name.starts_with('.')));
        std::fs::rename(&folder, place.path().join("gone")).unwrap();
        let output = child.wait_with_output().unwrap();
        let text = said(&output);
        assert_eq!(output.status.code(), Some(3), "{writer}: {text}");
        let wanted = format!("cannot write `{name}");
        assert!(text.contains(&wanted) && text.contains("No such file"), "{writer}: {text}");
        assert!(text.contains("kept: "), "{writer}: {text}");
    }
}

/// Runs the program as a user who may not read or write everything; `None` if that cannot be.
fn run_as_nobody(place: &Path, arguments: &str) -> Option<Output> {
    use std::os::unix::fs::PermissionsExt;
    let folder = |mode| std::fs::set_permissions(place, std::fs::Permissions::from_mode(mode));
    folder(0o777).unwrap();
    let program = place.join("program");
    std::fs::copy(cargo_bin!("karamelo-rs"), &program).unwrap();
    let line = format!("exec ./program --quiet {arguments}");
    let root = std::fs::metadata("/proc/self").is_ok_and(|of| {
        use std::os::unix::fs::MetadataExt;
        of.uid() == 0
    });
    let mut command = match root {
        true => {
            let mut command = Command::new("setpriv");
            command.args(["--reuid=65534", "--clear-groups", "sh", "-c", &line]);
            command
        }
        false => {
            let mut command = Command::new("sh");
            command.args(["-c", &line]);
            command
        }
    };
    let output = command.current_dir(place).output().ok()?;
    // 126, 127: setpriv is not allowed to, or the folder cannot be reached.
    let started = output.status.code().is_some_and(|code| code < 126);
    (started && !said(&output).starts_with("setpriv")).then_some(output)
}

#[test]
fn scripts_and_logs_without_permission_end_with_3_and_their_names() {
    use std::os::unix::fs::PermissionsExt;
    let allow = |path: &Path, mode| {
        std::fs::set_permissions(path, std::fs::Permissions::from_mode(mode)).unwrap();
    };
    let place = place("run(1)\n");
    let log = place.path().join("old.log");
    std::fs::write(&log, "old\n").unwrap();
    let Some(output) = run_as_nobody(place.path(), "in.mpm -log none") else {
        println!("not tested: the program cannot be run as another user");
        return;
    };
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    // A log that may only be read, and one in a folder that may only be read.
    allow(&log, 0o444);
    let sealed = place.path().join("sealed");
    std::fs::create_dir(&sealed).unwrap();
    allow(&sealed, 0o555);
    for name in ["old.log", "sealed/new.log"] {
        let output = run_as_nobody(place.path(), &format!("in.mpm -log {name}")).unwrap();
        let text = said(&output);
        assert_eq!(output.status.code(), Some(3), "{name}: {text}");
        assert!(text.contains(&format!("cannot write `{name}`")), "{text}");
        assert!(text.contains("Permission denied"), "{text}");
    }
    assert_eq!(std::fs::read_to_string(&log).unwrap(), "old\n");
    // A script that may not be read, and one that reads a list which may not be read.
    let script = place.path().join("in.mpm");
    let list = place.path().join("list.txt");
    std::fs::write(&list, "0.5 5 0.0025\n").unwrap();
    let more = std::fs::read_to_string(&script)
        .unwrap()
        .replace("group(floor", "solid(more, file, list.txt, rubber, 0.1)\ngroup(floor");
    std::fs::write(&script, more).unwrap();
    allow(&list, 0o000);
    for (file, name) in [(&list, "list.txt"), (&script, "in.mpm")] {
        allow(file, 0o000);
        let output = run_as_nobody(place.path(), "in.mpm -log none").unwrap();
        let text = said(&output);
        assert_eq!(output.status.code(), Some(3), "{name}: {text}");
        assert!(text.contains(&format!("cannot read `{name}`")), "{text}");
    }
}

#[test]
fn damaged_files_of_a_script_end_with_3_and_mistakes_beside_them_with_2() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mesh = std::fs::read(root.join("tests/meshes/triangle3-41.msh")).unwrap();
    let surface = std::fs::read(root.join("tests/script/files/cube.stl")).unwrap();
    let binary = std::fs::read(root.join("tests/script/files/cube-binary.stl")).unwrap();
    let solid = "method(ulmpm, FLIP, linear, 1)\ndimension(2, -9, 9, -9, 9, 1)\n\
        material(m, linear, 1, 1, 0.3)\nsolid(s, mesh, a.msh, m, 1)\n";
    let region = "method(ulmpm, FLIP, linear, 1)\ndimension(3, 0, 1, 0, 1, 0, 1, 0.1)\n\
        region(r, stl, a.stl)\n";
    let list = "method(ulmpm, FLIP, linear, 1)\ndimension(2, 0, 1, 0, 1, 0.1)\n\
        material(m, linear, 1, 1, 0.3)\nsolid(s, file, a.txt, m, 0.1)\n";
    for (script, name, bytes) in [
        (solid, "a.msh", &mesh[..]),
        (region, "a.stl", &surface[..]),
        (region, "a.stl", &binary[..]),
        (list, "a.txt", b"0.1 0.2 0.01\n0.3 0.2 0.01\n"),
    ] {
        let place = tempfile::tempdir().unwrap();
        for (text, code) in [(script.to_string(), 3), (format!("{script}no_such(1)\n"), 2)] {
            std::fs::write(place.path().join(name), &bytes[..bytes.len() * 2 / 3]).unwrap();
            std::fs::write(place.path().join("in.mpm"), text).unwrap();
            let output = run(place.path(), "in.mpm");
            assert_eq!(output.status.code(), Some(code), "{name}: {}", said(&output));
            assert!(said(&output).contains("error[E0307]"), "{name}: {}", said(&output));
        }
    }
    // Restart files, named by a script or alone, cut at their very beginning too.
    let place = place("run(3)\nwrite_restart(a.rst)\n");
    assert_eq!(run(place.path(), "in.mpm").status.code(), Some(0));
    let whole = std::fs::read(place.path().join("a.rst")).unwrap();
    std::fs::write(place.path().join("on.mpm"), "read_restart(a.rst)\nrun(1)\n").unwrap();
    for length in [whole.len() - 1, whole.len() / 2, 20, 5, 0] {
        std::fs::write(place.path().join("a.rst"), &whole[..length]).unwrap();
        for file in ["on.mpm", "a.rst"] {
            let output = run(place.path(), file);
            let text = said(&output);
            assert_eq!(output.status.code(), Some(3), "{file} {length}: {text}");
            assert!(text.contains("cannot go on from `a.rst`"), "{file} {length}: {text}");
        }
    }
}
