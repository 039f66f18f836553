//! Other programs read our files.

use super::place::{Place, SCENE, stderr, stdout};
use std::path::Path;
use std::process::{Command, Output};

/// Runs a Python script with an interpreter that has these modules; `None` if there is none.
fn python(script: &str, modules: &str, arguments: &[&Path]) -> Option<Output> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let candidates = [root.join("target/readers/bin/python"), "python3".into()];
    let interpreter = candidates.into_iter().find(|candidate| {
        let test = ["-c", &format!("import {modules}")];
        Command::new(candidate).args(test).output().is_ok_and(|output| output.status.success())
    })?;
    let script = root.join("tests/python").join(script);
    Some(Command::new(interpreter).arg(script).args(arguments).output().unwrap())
}

/// Checks files with a Python script, where the modules that it needs are installed.
fn checked_by(script: &str, modules: &str, arguments: &[&Path]) {
    match python(script, modules, arguments) {
        Some(output) => {
            println!("{}", stdout(&output));
            assert!(output.status.success(), "{}{}", stdout(&output), stderr(&output));
        }
        None => println!("not tested: Python's {modules} are not installed"),
    }
}

#[test]
fn ovito_and_lammps_logfile_read_our_files() {
    let place = Place::new(
        "fix(v, initial_velocity_particles, all, 0.1 - 2*(y - 0.5), 0.2 + 4*(x - 0.5))
dump(a, all, particle, 10, p.*.dump, ovito)
dump(b, all, particle/gz, 10, p.*.dump.gz, x, y, z, vx, vy, vz)
dump(c, all, particle/bin, 10, p.*.bin, x, y, z, vx, vy, vz)
log_modify(custom, dt, time, Ek)
set_output(5)
run(10)
",
    );
    assert_eq!(place.run(&["in.mpm", "--quiet"]).status.code(), Some(0));
    checked_by("read_outputs.py", "ovito, lammps_logfile", &[place.0.path()]);
}

#[test]
fn vtk_reads_our_files_for_paraview() {
    let place = Place::new(
        "fix(v, initial_velocity_particles, all, 0.1 - 2*(y - 0.5), 0.2 + 4*(x - 0.5))
dump(a, all, particle, 10, p.*.dump, x, y, z, vx, vy, vz, s11, s22, s33, s12, s13, s23, seq)
dump(b, all, particle/vtk, 10, p.*.vtp, s11, s22, vx, vy, vz, s33, s12, s13, s23, seq, seq)
dump(c, all, grid, 10, g.*.dump, x, y, z, vx, vy, vz, mass)
dump(d, all, grid/vtk, 10, g.*.vti, vx, vy, vz, mass)
dump(e, all, grid/vtk, 10, g.*.vtp, vx, vy, vz, mass)
run(10)
",
    );
    let output = place.run(&["in.mpm"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let told = stdout(&output);
    assert!(
        told.contains("open in ParaView, with times: p.vtp.pvd, g.vti.pvd, g.vtp.pvd"),
        "{told}"
    );
    let total = SCENE.replace("ulmpm", "tlmpm");
    let lines = "region(other, block, 0.1, 0.2, 0.1, 0.3)\nsolid(second, region, other, 2, rubber, h/2)\n\
        dump(a, all, grid, 10, t.*.dump, mass)\ndump(b, all, grid/vtk, 10, t.*.vti, mass)\nrun(1)\n";
    place.write("total.mpm", &format!("{total}{lines}"));
    assert_eq!(place.run(&["total.mpm", "--quiet"]).status.code(), Some(0));
    checked_by("read_vtk.py", "vtk, numpy", &[place.0.path()]);
}

#[test]
fn paraview_plays_our_series() {
    let place = Place::new(
        "fix(v, initial_velocity_particles, all, 1, 0)
dump(a, all, particle/vtk, 10, p.*.vtp, s11, vx, vy, vz)
dump(b, all, grid/vtk, 10, g.*.vti, vx, vy, vz, mass)
set_dt(0.002)
run(20)
",
    );
    assert_eq!(place.run(&["in.mpm", "--quiet"]).status.code(), Some(0));
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/python/read_pvd.py");
    match Command::new("pvpython").arg(script).arg(place.0.path()).output() {
        Ok(output) => assert!(output.status.success(), "{}{}", stdout(&output), stderr(&output)),
        Err(_) => println!("not tested: ParaView (pvpython) is not installed"),
    }
}

#[test]
fn the_example_in_python_reads_dumps_logs_and_restarts() {
    let place = Place::new(
        "fix(v, initial_velocity_particles, all, 0.1, 0.2)
dump(a, all, particle, 10, p.*.dump, x, y, z, seq)
dump(b, all, particle/gz, 10, p.*.dump.gz, x, y, z, seq)
dump(c, all, particle/bin, 10, p.*.bin, x, y, z, seq)
dump(d, all, particle/bin, 10, all.bin, x)
log_modify(custom, dt, time, Ek, dt_limit)
set_output(5)
run(10)
dt_factor(0.5)
run(5)
write_restart(end.rst)
",
    );
    assert_eq!(place.run(&["in.mpm", "--quiet"]).status.code(), Some(0));
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let reader = root.join("examples/python/karamelo_files.py");
    checked_by("read_files.py", "json", &[place.0.path(), &reader, Path::new("without-numpy")]);
    checked_by("read_files.py", "numpy", &[place.0.path(), &reader]);
}
