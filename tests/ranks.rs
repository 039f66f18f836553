//! Several processes (feature `mpi`, under `mpirun`): every input gives the bytes of one process, and
//! whatever fails somewhere stops all at once with one message.
#![cfg(feature = "mpi")]

use assert_cmd::cargo::cargo_bin;
use flate2::read::GzDecoder;
use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Steps of every run in the short test.
const STEPS: usize = 30;

/// Scenes that are played in another size.
const SIZES: [(&str, &[&str]); 8] = [
    ("block.mpm", &["cells", "10"]),
    ("copper-block.mpm", &["cells", "6"]),
    ("dam-break/dam-break.mpm", &["cells", "40", "ppc", "2"]),
    ("disk-impact/disk-impact.mpm", &["h", "2.4"]),
    ("plate-penetration/plate-penetration.mpm", &["width", "30"]),
    ("square.mpm", &["cells", "30"]),
    ("taylor-bar/taylor-bar.mpm", &["h", "1"]),
    ("upsetting/upsetting-3d.mpm", &["quarter", "1", "h", "2"]),
];

/// The program in so many processes of one thread; 0: without `mpirun`.
fn program(processes: usize) -> Command {
    let binary = cargo_bin!("karamelo-rs");
    let mut command = match processes {
        0 => Command::new(binary),
        _ => {
            let mut command = Command::new("mpirun");
            // Containers run as root.
            command.env("OMPI_ALLOW_RUN_AS_ROOT", "1");
            command.env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1");
            let count = processes.to_string();
            command.args(["--oversubscribe", "--bind-to", "none", "-np", &count]).arg(binary);
            command
        }
    };
    command.args(["--threads", "1"]);
    command
}

/// Every file below a folder; of the log its rows.
fn read(folder: &Path, before: &str, files: &mut BTreeMap<String, Vec<u8>>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = format!("{before}{}", path.file_name().unwrap().to_str().unwrap());
        if path.is_dir() {
            read(&path, &format!("{name}/"), files);
            continue;
        }
        let mut bytes = std::fs::read(&path).unwrap();
        if name == "log.mpm" {
            let text = String::from_utf8(bytes).unwrap();
            let row = |line: &&str| line.trim_start().starts_with(|c: char| c.is_ascii_digit());
            bytes = text.lines().filter(row).collect::<Vec<_>>().join("\n").into_bytes();
        }
        files.insert(name, bytes);
    }
}

/// What a script writes in so many processes.
fn play(script: &Path, variables: &[&str], processes: usize) -> BTreeMap<String, Vec<u8>> {
    let folder = tempfile::tempdir().unwrap();
    let mut command = program(processes);
    command.arg(script).arg("--quiet").current_dir(folder.path());
    for pair in variables.chunks(2) {
        command.arg("-var").args(pair);
    }
    let output = command.output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{} in {processes}: {said}", script.display());
    let mut files = BTreeMap::new();
    read(folder.path(), "", &mut files);
    files
}

fn copy(from: &Path, to: &Path, scripts: &mut Vec<PathBuf>) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let target = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy(&path, &target, scripts);
        } else {
            std::fs::copy(&path, &target).unwrap();
            if target.extension().is_some_and(|suffix| suffix == "mpm") {
                scripts.push(target);
            }
        }
    }
}

/// A script with short runs, more output and dumps of everything.
fn shortened(text: &str) -> String {
    let half = STEPS / 2;
    let dumps = format!(
        "dump(for_paraview, all, particle/vtk, {half}, zp.*.vtp, ovito, T)\n\
         dump(nodes_for_paraview, all, grid/vtk, {half}, zg.*.vti, mass, vx, vy, vz)\n\
         dump(picture_of_stress, all, picture, {STEPS}, zp.*.png, seq, size, 300, 200)\n\
         dump(all_particles, all, particle, {half}, zp.*.dump, x, y, z, vx, vy, vz, s11, s22, s33, \
         s12, volume, J, ep, T, damage)\n\
         dump(all_nodes, all, grid, {half}, zg.*.dump, x, y, z, vx, vy, vz, mass, bx, by, T)\n\
         restart({half}, state.*.rst)\n"
    );
    let mut dumps = Some(dumps);
    let mut lines = String::new();
    for line in text.lines() {
        let run = ["run(", "run_time(", "run_while(", "run_until("];
        if run.iter().any(|run| line.starts_with(run)) {
            lines.extend(dumps.take());
            lines.push_str(&format!("run({STEPS})\n"));
        } else if line.starts_with("set_output(") {
            lines.push_str("set_output(5)\n");
        } else {
            lines.push_str(&format!("{line}\n"));
        }
    }
    assert!(dumps.is_none(), "no run");
    lines
}

/// What goes on from a restart file in so many processes writes in its last step.
fn goes_on(file: &[u8], processes: usize) -> BTreeMap<String, Vec<u8>> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("half.rst");
    std::fs::write(&path, file).unwrap();
    let mut files = play(&path, &[], processes);
    files.retain(|name, _| name.ends_with(&format!(".{STEPS}.dump")));
    files
}

#[test]
fn every_input_gives_the_same_bytes_in_one_to_four_processes() {
    let folder = tempfile::tempdir().unwrap();
    let mut scripts = Vec::new();
    let inputs = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs");
    copy(&inputs, folder.path(), &mut scripts);
    scripts.sort();
    assert!(scripts.len() >= 25);
    let mut different = Vec::new();
    for script in &scripts {
        let text = std::fs::read_to_string(script).unwrap();
        std::fs::write(script, shortened(&text)).unwrap();
        let name = script.strip_prefix(folder.path()).unwrap().to_str().unwrap();
        let size = SIZES.iter().find(|(known, _)| *known == name);
        let variables = size.map_or(&[][..], |(_, variables)| variables);
        let one = play(script, variables, 0);
        assert!(one.len() > 5 && one["log.mpm"].len() > 50, "{name}: {:?}", one.keys());
        for processes in 2..5 {
            let other = play(script, variables, processes);
            let unlike = one.keys().find(|file| one.get(*file) != other.get(*file));
            different.extend(unlike.map(|file| format!("{name} in {processes}: {file}")));
        }
        let half = &one[&format!("state.{}.rst", STEPS / 2)];
        let rest = goes_on(half, 3);
        assert!(rest.len() >= 2, "{name}: {:?}", rest.keys());
        let unlike = rest.keys().find(|file| one.get(*file) != rest.get(*file));
        different.extend(unlike.map(|file| format!("{name} from a restart file: {file}")));
    }
    assert!(different.is_empty(), "{different:#?}");
}

/// A bar that flies across the box, with faces exactly on borders of cells and tiles.
const FLIGHT: &str = "
method(ulmpm, FLIP, linear, 1)
dimension(2, 0, 64, 0, 4, 1)
region(bar, block, 2, 10, 0, 4)
material(m, linear, 1, 1000, 0.3)
solid(bar, region, bar, 2, m, 1)
fix(fly, initial_velocity_particles, all, 10, 0)
compute(Ek, kinetic_energy, all)
compute(far, max_position, all)
log_modify(custom, step, time, Ek, far_x)
set_output(20)
dump(p, all, particle, 100, p.*.dump, x, y, vx, vy, s11)
run_time(5)
";

#[test]
fn a_body_crosses_all_processes_and_some_have_none_of_it() {
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("flight.mpm");
    std::fs::write(&script, FLIGHT).unwrap();
    let one = play(&script, &[], 0);
    let log = String::from_utf8(one["log.mpm"].clone()).unwrap();
    let last: Vec<f64> =
        log.lines().last().unwrap().split_whitespace().map(|n| n.parse().unwrap()).collect();
    // 32 cells, m v^2/2 = 1600, fifty cells on.
    assert!((last[2] / 1600.0 - 1.0).abs() < 1e-12 && (last[3] - 59.75).abs() < 1e-9, "{last:?}");
    for processes in [2, 3, 5, 8] {
        assert!(play(&script, &[], processes) == one, "{processes} processes");
    }
}

/// A thing that goes wrong for the particles of one process only, half way through the run.
fn fails(name: &str, script: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("in.mpm"), script).unwrap();
    std::fs::create_dir(folder.path().join("taken.100.dump")).unwrap();
    let mut command = program(3);
    command.args(["in.mpm", "--quiet"]).current_dir(folder.path());
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    let output = finished(command.spawn().unwrap(), Duration::from_secs(30));
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success(), "{name}: {said}");
    assert_eq!(said.matches("error: ").count(), 1, "{name}: {said}");
    said
}

/// Ends `mpirun` so that it ends its processes.
fn end(child: &mut Child) {
    let _ = Command::new("kill").args(["-TERM", &child.id().to_string()]).status();
    let _ = child.wait();
}

/// Waits for the end; a program that hangs is ended and a failure.
fn finished(mut child: Child, limit: Duration) -> Output {
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > limit {
            end(&mut child);
            panic!("still running after {limit:?}");
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    child.wait_with_output().unwrap()
}

#[test]
fn what_fails_in_one_process_stops_all_with_one_message() {
    let run = "run_time(5)\n";
    let with = |more: &str| FLIGHT.replace(run, &format!("{more}{run}"));
    let said = fails("NaN", &with("fix(nan, body_force, all, sqrt(40 - x), 0)\n"));
    assert!(said.contains("sqrt(40 - x)") && said.contains("(process "), "{said}");
    let said = fails("escape", &with("fix(push, body_force, all, 0, 200*(x > 30))\n"));
    assert!(said.contains("left the box") && said.contains("(process "), "{said}");
    // A folder stands where the first process wants to write its second dump; the others go on to the
    // next one.
    let another = with("dump(q, all, particle/gz, 100, q.*.gz, x)\n");
    let said = fails("folder", &another.replace("p.*.dump", "taken.*.dump"));
    assert!(said.contains("taken.100.dump"), "{said}");
    let said =
        fails("start", &with("fix(late, initial_velocity_particles, all, sqrt(6 - x), 0)\n"));
    assert!(said.contains("sqrt(6 - x)"), "{said}");
}

/// Bodies that are added, cut and moved between runs.
const CHANGES: &str = "
method(ulmpm, FLIP, quadratic-spline, 0.99)
dimension(2, 0, 40, 0, 40, 1)
region(a, block, 5, 15, 5, 15)
region(b, block, 20, 30, 5, 15)
region(c, block, 5, 12, 20, 34)
region(cut, block, 0, 8, 0, 40)
material(m, neo-hookean, 1, 100, 0.3)
solid(a, region, a, 2, m, 1)
solid(b, region, b, 2, m, 1)
group(thrown, particles, region, a, solid, a)
fix(throw, initial_velocity_particles, thrown, 2, 0.3)
compute(Ek, kinetic_energy, all)
compute(turn, angular_momentum, all)
compute(mean, average_velocity, all)
log_modify(custom, step, dt, time, Ek, turn_z, mean_x)
set_output(5)
dump(p, all, particle, 20, p.*.dump, x, y, vx, vy, s11)
dump(picture, all, pyplot, 20, p.*.svg)
run(30)
solid(c, region, c, 2, m, 1)
group(dropped, particles, region, c, solid, c)
fix(drop, initial_velocity_particles, dropped, 0, -3)
run(30)
delete_particles(a, region, cut)
run(30)
translate_particles(c, region, c, 0.5, 0.25)
group(late, particles, region, b, solid, all)
fix(pull, body_force, late, 0, 1)
run(40)
";

#[test]
fn bodies_may_be_added_cut_and_moved_between_runs() {
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("in.mpm");
    let total = CHANGES
        .replace("ulmpm, FLIP, quadratic-spline, 0.99", "tlmpm, FLIP, linear, 0.99")
        .replace("translate_particles(c, region, c, 0.5, 0.25)\n", "");
    for text in [CHANGES, &total] {
        std::fs::write(&script, text).unwrap();
        let one = play(&script, &[], 0);
        assert!(one.len() > 12, "{:?}", one.keys());
        for processes in [2, 3, 5] {
            assert!(play(&script, &[], processes) == one, "{processes} processes: {text}");
        }
    }
}

/// Bodies of which each process builds a part, moved and cut before the first run.
const PARTS: &str = "
method(METHOD)
dimension(2, 0, 40, 0, 40, 1)
region(a, block, 3, 15, 3, 15)
region(b, sphere, 27, 12, 7)
region(c, block, 5, 12, 20, 34)
region(hole, sphere, 8, 9, 3)
region(half, block, 0, 20, 0, 12)
region(ring, sphere, 20, 30, 40)
material(m, neo-hookean, 1, 100, 0.3)
solid(a, region, a, 2, m, 1)
solid(b, region, b, 3, m, 1, 20)
solid(c, region, c, 1, m, 1)
translate_particles(a, region, a, 1, 0.5)
translate_particles(b, region, half, -0.25, 0.125)
delete_particles(a, region, hole)
group(left, particles, region, half, solid, a, b)
fix(throw, initial_velocity_particles, left, 2, 0.3)
compute(Ek, kinetic_energy, all)
compute(mean, average_velocity, all)
log_modify(custom, step, dt, time, Ek, mean_x)
set_output(5)
dump(p, all, particle, 10, p.*.dump, x, y, x0, y0, vx, vy, s11, T, mass)
dump(g, all, grid, 10, g.*.dump, x, y, vx, mass)
run(20)
";

#[test]
fn parts_of_bodies_make_the_bodies_of_one_process() {
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("in.mpm");
    for method in
        ["ulmpm, FLIP, linear, 1", "tlmpm, FLIP, linear, 1", "ulcpdi, FLIP, linear, 1, R4"]
    {
        std::fs::write(&script, PARTS.replace("METHOD", method)).unwrap();
        let one = play(&script, &[], 0);
        assert!(one.len() > 6, "{:?}", one.keys());
        for processes in [2, 3, 5] {
            let other = play(&script, &[], processes);
            let unlike = one.keys().filter(|file| one.get(*file) != other.get(*file));
            assert_eq!(unlike.collect::<Vec<_>>(), Vec::<&String>::new(), "{method}, {processes}");
        }
    }
}

/// Dumps of all styles of a block of 17 thousand particles, 23 thousand nodes.
const DUMPS: &str = "
cells = 13
h = 1/cells
method(ulmpm, FLIP, linear, 1)
dimension(3, -0.5, 1.5, -0.5, 1.5, -0.5, 1.5, h)
region(body, block, 0, 1, 0, 1, 0, 1)
region(part, block, 0, 0.3, 0, 1, 0.2, 1)
region(bottom, block, INF, INF, INF, INF, INF, 0.1)
material(m, linear, 1000, 1000, 0.3)
solid(block, region, body, 2, m, h)
group(some, particles, region, part, solid, block)
group(low, nodes, region, bottom, solid, block)
fix(shake, initial_velocity_particles, all, 0.02*sin(3*y0), 0.02*sin(3*z0), 0.02*sin(3*x0))
dump(a, all, particle, 2, a.*.dump, x, y, z, vx, s11, seq)
dump(b, all, particle/gz, 2, b.*.gz, x, y, z, vx, s11, seq)
dump(c, some, particle/gz, 2, c.gz, x, seq)
dump(d, some, particle/bin, 2, d.bin, x, seq, p)
dump(e, all, particle/vtk, 2, e.*.vtp, ovito)
dump(f, some, particle/vtk, 2, f.vtp, vx)
dump(g, all, grid, 2, g.*.dump, x, vx, mass, bx, mask, ntypez)
dump(h, low, grid/gz, 2, h.*.gz, x, vx)
dump(i, all, grid/bin, 2, i.*.bin, z, vx, mass)
dump(j, all, grid/vtk, 2, j.*.vti, vx, mass)
dump(k, low, grid/vtk, 2, k.*.vtp, vx, mass)
dump(l, some, picture, 2, l.*.png, seq, size, 300, 200)
dump(m, all, pyplot, 2, m.*.png, 300, 200)
run(4)
";

#[test]
fn each_process_formats_its_part_of_every_dump() {
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("in.mpm");
    let total = DUMPS.replace("method(ulmpm", "method(tlmpm");
    for text in [DUMPS, &total] {
        std::fs::write(&script, text).unwrap();
        let one = play(&script, &[], 0);
        assert!(one.len() > 30, "{:?}", one.keys());
        let mut unzipped = Vec::new();
        GzDecoder::new(&one["b.4.gz"][..]).read_to_end(&mut unzipped).unwrap();
        assert!(unzipped == one["a.4.dump"], "the text is that of the dump without compression");
        for processes in [2, 3, 5] {
            let other = play(&script, &[], processes);
            let unlike = one.keys().filter(|file| one.get(*file) != other.get(*file));
            assert_eq!(unlike.collect::<Vec<_>>(), Vec::<&String>::new(), "in {processes}: {text}");
        }
    }
}

/// What a text says between two words.
fn between<'a>(text: &'a str, before: &str, after: &str) -> &'a str {
    let rest = text.split(before).nth(1).unwrap_or_else(|| panic!("no `{before}` in {text}"));
    rest.split(after).next().unwrap()
}

#[test]
fn check_counts_the_messages_that_are_sent() {
    let folder = tempfile::tempdir().unwrap();
    // Nothing is sorted in so few steps: what was surveyed at the start is what is sent.
    let script = FLIGHT.replace("run_time(5)", "set_dt(1e-6)\nrun(10)");
    std::fs::write(folder.path().join("in.mpm"), script).unwrap();
    let check = Command::new(cargo_bin!("karamelo-rs"))
        .args(["check", "in.mpm", "--processes", "2,3"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    let check = String::from_utf8(check.stdout).unwrap();
    for processes in [2, 3] {
        let mut command = program(processes);
        command.args(["in.mpm", "--quiet"]).current_dir(folder.path());
        assert!(command.status().unwrap().success());
        let log = std::fs::read_to_string(folder.path().join("log.mpm")).unwrap();
        let sent = between(&log, "a process sent ", " and ");
        let line = check.split(&format!("  {processes} processes: ")).nth(1).unwrap();
        assert_eq!(between(line, "a process sends ", " per sweep"), sent);
        assert!(!sent.starts_with("0.00"), "{sent}");
    }
}

/// Starts a long run in three processes and sends one of them a signal.
fn struck(folder: &Path, signal: &str) -> Output {
    let script = FLIGHT.replace("run_time(5)", "set_dt(1e-9)\nrun(100000000)");
    std::fs::write(folder.join("long.mpm"), script).unwrap();
    let mut command = program(3);
    command.args(["long.mpm", "--quiet"]).current_dir(folder);
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let own = child.id();
    let start = Instant::now();
    while !folder.join("log.mpm").exists() {
        if start.elapsed() > Duration::from_secs(30) {
            end(&mut child);
            panic!("never began");
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    let children = format!("/proc/{own}/task/{own}/children");
    let list = std::fs::read_to_string(children).unwrap();
    let victim = list.split_whitespace().last().unwrap();
    assert!(Command::new("kill").args([signal, victim]).status().unwrap().success());
    finished(child, Duration::from_secs(15))
}

#[test]
fn a_process_that_is_killed_takes_the_others_with_it() {
    let folder = tempfile::tempdir().unwrap();
    assert!(!struck(folder.path(), "-9").status.success());
}

#[test]
fn a_process_that_is_asked_to_stop_makes_all_write_a_restart_file() {
    let folder = tempfile::tempdir().unwrap();
    let output = struck(folder.path(), "-TERM");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success(), "{said}");
    assert!(said.contains("go on with: karamelo-rs long.interrupted.rst"), "{said}");
    let go = "read_restart(long.interrupted.rst)\nrun(3)\n";
    std::fs::write(folder.path().join("go.mpm"), go).unwrap();
    for processes in [0, 2] {
        let mut command = program(processes);
        let output = command.args(["go.mpm", "--quiet"]).current_dir(folder.path()).output();
        assert!(output.unwrap().status.success(), "{processes} processes");
    }
}
