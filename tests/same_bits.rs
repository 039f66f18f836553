//! The same bits for any number of threads, twice in a row, in one run or several, and (feature `mpi`)
//! for any number of processes.

mod processes;

use processes::program;
use std::collections::BTreeMap;
use std::path::Path;

/// Two bodies of different laws that meet, with gravity and walls: 3-D, above the size from
/// which several threads are used.
const SCRIPT: &str = "
h = 1/16
method(ulmpm, FLIP, linear, 0.99)
dimension(3, 0, 1, 0, 1, 0, 2, h)
region(low, block, 0.1, 0.9, 0.1, 0.9, 0.1, 0.7)
region(ball, sphere, 0.5, 0.5, 1.05, 0.25)
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
fix(drop, initial_velocity_particles, particles, 0.3, 0.1*x, -4)
fix(gravity, body_force, all, 0, 0, -9.81)
fix(stand, velocity_nodes, floor, 0, 0, 0)
compute(Ek, kinetic_energy, all)
compute(Es, strain_energy, all)
log_modify(custom, step, dt, time, Ek, Es, stand_z)
set_output(10)
dump(a, all, particle, 20, p.*.dump, x, y, z, vx, vy, vz, seq, s11, s23, volume, ep, T, damage)
dump(b, all, particle/gz, 60, p.*.gz, x, y, z, e11)
dump(c, all, particle/bin, 60, p.*.bin, x, y, z, e11)
dump(d, all, grid, 60, g.*.dump, x, y, z, vx, vy, vz, mass, T)
dump(e, all, particle/vtk, 60, p.*.vtp, ovito, T)
dump(f, all, grid/vtk, 60, g.*.vti, vx, vy, vz, mass, T)
dump(g, all, picture, 60, p.*.png, seq)
";

/// A ball of revolution that flies against a ring, on the axis.
const ROUND: &str = "
h = 1/64
method(ulmpm, FLIP, linear, 0.99)
dimension(2, 0, 1, 0, 2, h)
axisymmetric(true)
region(ball, cylinder, 0, 0.6, 0.45)
region(ring, block, 0.2, 0.8, 1.1, 1.3)
material(soft, neo-hookean, 1000, 1e5, 0.3)
material(hard, von-mises, 2000, 1e6, 0.3, 1e4)
solid(ball, region, ball, 2, soft, h)
solid(ring, region, ring, 2, hard, h)
group(thrown, particles, region, ball, solid, ball)
fix(throw, initial_velocity_particles, thrown, -2*x, 3)
compute(Ek, kinetic_energy, all)
compute(Es, strain_energy, all)
log_modify(custom, step, dt, time, Ek, Es)
set_output(10)
dump(a, all, particle, 20, p.*.dump, x, y, vx, vy, s11, s12, s33, volume, ep, F33)
dump(d, all, grid, 60, g.*.dump, x, y, vx, vy, mass)
";

/// Lines in place of `method(...)`: every sweep over particles and nodes is run by one of them.
const METHODS: [&str; 12] = [
    "method(ulmpm, FLIP, linear, 0.99)",
    "method(ulmpm, AFLIP, cubic-spline, 0.99)\nscheme(usl)",
    "method(ulmpm, XPIC, 2, quadratic-spline)\nscheme(usf)\nanti_locking(fbar)",
    "method(ulmpm, MLS, quadratic-spline)",
    "method(tlmpm, FLIP, Bernstein-quadratic, 0.99)\nanti_locking(fbar)",
    "method(tlmpm, ASFLIP, cubic-spline, 0.99)",
    "method(ulmpm, FLIP, linear, 0.99, thermo-mechanical)",
    "method(tlmpm, FLIP, quadratic-spline, 0.99, thermo-mechanical)",
    "method(ulmpm, APIC, gimp)",
    "method(ulmpm, FLIP, cpgimp, 0.99)",
    "method(ulcpdi, FLIP, linear, 0.99, H8)\nscheme(usl)",
    "method(ulcpdi, AFLIP, linear, 0.99, thermo-mechanical)\nanti_locking(fbar)",
];

/// How a scene is run beside one thread: threads, or processes of one thread each.
#[cfg(not(feature = "mpi"))]
const OTHERS: &[&str] = &["2", "3"];
#[cfg(feature = "mpi")]
const OTHERS: &[&str] = &["3 processes"];

/// Runs the script; gives the bytes of all dumps and restart files, and the rows of the log.
fn outputs(method: &str, how: &str, runs: &str) -> BTreeMap<String, Vec<u8>> {
    outputs_of(&SCRIPT.replace(METHODS[0], method), how, runs)
}

/// The same for a script of another kind.
fn outputs_of(text: &str, how: &str, runs: &str) -> BTreeMap<String, Vec<u8>> {
    let directory = tempfile::tempdir().unwrap();
    let script = directory.path().join("in.mpm");
    std::fs::write(&script, format!("{text}restart(20, state.*.rst)\n{runs}")).unwrap();
    let status =
        program(how).args(["in.mpm", "--quiet"]).current_dir(directory.path()).status().unwrap();
    assert!(status.success(), "{how}");
    read(directory.path())
}

fn read(directory: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    for entry in std::fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let bytes = std::fs::read(&path).unwrap();
        match name.as_str() {
            "in.mpm" => {}
            "log.mpm" => {
                let text = String::from_utf8(bytes).unwrap();
                let row = |line: &&str| line.trim_start().starts_with(|c: char| c.is_ascii_digit());
                let rows: Vec<&str> = text.lines().filter(row).collect();
                files.insert(name, rows.join("\n").into_bytes());
            }
            _ => {
                files.insert(name, bytes);
            }
        }
    }
    files
}

#[test]
fn neither_threads_nor_processes_change_a_byte() {
    for method in METHODS {
        let one = outputs(method, "1", "run(120)");
        assert!(one.len() > 7 + 3 + 3 + 3, "{:?}", one.keys());
        for how in ["1"].iter().chain(OTHERS) {
            let other = outputs(method, how, "run(120)");
            for (name, bytes) in &one {
                let same = other.get(name) == Some(bytes);
                assert!(same, "{method}: {name} differs with {how}");
            }
        }
    }
}

#[test]
fn neither_threads_nor_processes_change_a_byte_of_bodies_of_revolution() {
    let metal = "von-mises, 2000, 1e6, 0.3, 1e4";
    let soils = [
        "mohr-coulomb, 2000, 1e6, 0.3, 1e4, 30, 5, 5e3, 1e6, 2e3, 25, 0",
        "drucker-prager, 2000, 1e6, 0.3, 1e4, 30, 5, inner",
    ];
    let methods = METHODS.into_iter().filter(|method| !method.contains("cpdi"));
    let pairs = methods.map(|method| (method, metal));
    for (method, law) in pairs.chain(soils.map(|soil| (METHODS[0], soil))) {
        let text = ROUND.replace(METHODS[0], method).replace(metal, law);
        let one = outputs_of(&text, "1", "run(120)");
        assert!(one.len() > 7 + 3, "{:?}", one.keys());
        for how in OTHERS {
            let other = outputs_of(&text, how, "run(120)");
            assert!(one == other, "{method}, {law}: differs with {how}");
        }
    }
}

/// Two gases that meet: energies of their own, artificial viscosity, first steps without rates.
const GASES: &str = "
h = 1/64
method(ulmpm, FLIP, linear, 0.99)
dimension(2, 0, 1, 0, 2, h)
region(ball, cylinder, 0.5, 0.6, 0.45)
region(slab, block, 0.2, 0.8, 1.1, 1.3)
eos(cold, ideal-gas, 1, 5/3, 0, 2, 0.5)
eos(warm, ideal-gas, 3, 1.4, 0.5, 2, 0.5)
strength(viscous, fluid, 1e-4)
material(cold, eos-strength, cold, viscous)
material(warm, eos-strength, warm, viscous)
solid(ball, region, ball, 2, cold, h)
solid(slab, region, slab, 2, warm, h)
group(thrown, particles, region, ball, solid, ball)
fix(throw, initial_velocity_particles, thrown, -0.2*x, 3)
compute(Es, strain_energy, all)
compute(W, energy_ledger, all)
log_modify(custom, step, dt, time, Es, W_viscous, W_stored)
set_output(10)
dump(a, all, particle, 20, p.*.dump, x, y, vx, vy, s11, s12, s33, volume, ienergy)
dump(d, all, grid, 60, g.*.dump, x, y, vx, vy, mass)
";

#[test]
fn neither_threads_nor_processes_change_a_byte_of_gases() {
    for method in [METHODS[1], METHODS[3], METHODS[5]] {
        let text = GASES.replace(METHODS[0], method);
        let one = outputs_of(&text, "1", "run(60)");
        assert!(one.len() > 4, "{:?}", one.keys());
        for how in OTHERS {
            let other = outputs_of(&text, how, "run(60)");
            assert!(one == other, "{method}: differs with {how}");
        }
    }
}

#[test]
fn neither_threads_nor_processes_change_a_byte_of_what_rigid_bodies_do() {
    let soft = "material(soft, neo-hookean, 1000, 1e5, 0.3, 500, 1e4)";
    let rigid = SCRIPT.replace(soft, "material(soft, rigid, 1000)");
    for method in &METHODS[..6] {
        let (touch, force) = match method.contains("tlmpm") {
            true => ("fix(touch, contact/hertz, base, body)", "touch_z"),
            false => ("boundary(bounce)", "lift_z"),
        };
        let text = rigid.replace(METHODS[0], method);
        let text = format!(
            "{text}group(plate, particles, region, low, solid, base)\n{touch}
fix(lift, velocity_particles, plate, 0.1, -0.2, 2)
log_modify(custom, step, dt, Ek, Es, {force})\n"
        );
        let one = outputs_of(&text, "1", "run(120)");
        let log = String::from_utf8(one["log.mpm"].clone()).unwrap();
        let force = log.lines().last().unwrap().split_whitespace().last().unwrap();
        assert!(force.parse::<f64>().unwrap().abs() > 1.0, "{method}: nothing touched, {force}");
        for how in OTHERS {
            let other = outputs_of(&text, how, "run(120)");
            assert!(one == other, "{method}: differs with {how}");
        }
    }
}

#[test]
fn neither_threads_nor_processes_change_a_byte_of_bodies_in_contact() {
    let soft = "material(soft, neo-hookean, 1000, 1e5, 0.3, 500, 1e4)";
    let body = "solid(body, region, ball, 2, hard, h)";
    assert!(SCRIPT.contains(soft) && SCRIPT.contains(body));
    // Domains take shorter steps: the bodies would not meet in so few.
    let updated = METHODS.iter().filter(|m| m.contains("ulmpm") && !m.contains("gimp"));
    for (method, base) in updated.flat_map(|m| [(m, soft), (m, "material(soft, rigid, 1000)")]) {
        let contact = format!("{body}\ncontact(c, frictional, base, body, 0.3)");
        let text = SCRIPT.replace(METHODS[0], method).replace(soft, base).replace(body, &contact);
        let text = text.replace(", stand_z", ", stand_z, c_x, c_y, c_z, c_s");
        let one = outputs_of(&text, "1", "run(45)");
        for how in OTHERS {
            let same = one == outputs_of(&text, how, "run(45)");
            assert!(same, "{method}, {base}: differs with {how}");
        }
        // They meet: without the contact the last row is another one.
        let other = outputs_of(
            &text.replace("frictional, base, body, 0.3", "slip, base, body"),
            "1",
            "run(45)",
        );
        assert!(one["log.mpm"] != other["log.mpm"], "{method}, {base}");
    }
}

#[test]
fn neither_threads_nor_processes_change_the_energy_ledger() {
    let runs = "compute(W, energy_ledger, all)
log_modify(custom, step, W_stored, W_plastic, W_viscous, W_damage, W_heat, W_numerical, W_residual)
run(60)";
    let one = outputs(METHODS[0], "1", runs);
    for how in OTHERS {
        assert!(outputs(METHODS[0], how, runs)["log.mpm"] == one["log.mpm"]);
    }
}

#[test]
fn a_force_in_the_twelfth_digit_is_seen() {
    // The test above can fail.
    let one = outputs(METHODS[0], "1", "run(20)");
    let moved = outputs(METHODS[0], "1", "fix(nudge, body_force, all, 1e-12, 0, 0)\nrun(20)");
    assert!(one["p.20.dump"] != moved["p.20.dump"]);
}

#[test]
fn neither_threads_nor_processes_change_what_the_box_reflects_or_removes() {
    for policy in ["bounce", "delete"] {
        // Without the floor, and fast enough to leave through two walls.
        let text = SCRIPT.replace("fix(stand, velocity_nodes, floor, 0, 0, 0)", "");
        let text = text.replace(", stand_z", "").replace("0.3, 0.1*x, -4", "9, 0.1*x, -14");
        let text = format!(
            "{text}boundary({policy})\nfix(all_down, initial_velocity_particles, all, 6, 0, -9)\n"
        );
        let one = outputs_of(&text, "1", "run(60)");
        for how in OTHERS {
            assert!(one == outputs_of(&text, how, "run(60)"), "{policy}, {how}");
        }
        let particles = |step: u32| {
            let name = format!("p.{step}.dump");
            String::from_utf8_lossy(&one[&name]).lines().nth(5).map(str::to_string)
        };
        assert_eq!(particles(0) == particles(60), policy == "bounce", "{:?}", particles(60));
    }
}

/// A block whose side starts at once at 1.5 times its wave speed: the run goes back and takes smaller
/// steps.
const RESCUED: &str = "
h = 1/40
method(ulmpm, FLIP, linear, 1)
dimension(2, 0, 4, 0, 1, h)
region(bar, block, 1, 3, 0, 1)
region(left, block, INF, 1 + h/4, INF, INF)
material(m, neo-hookean, 1, 1, 0)
solid(s, region, bar, 2, m, h)
group(piston, nodes, region, left)
fix(push, velocity_nodes, piston, if(time > 0.5, 1.5, 0), NULL)
compute(W, energy_ledger, all)
log_modify(custom, dt, time, push_x, W_kinetic, W_stored, W_residual, dt_limit)
set_output(3)
dump(d, all, particle, 7, d.*.txt, x, y, vx, vy, s11, J)
watch(on)
";

#[test]
fn a_run_that_went_back_has_the_same_bytes() {
    let one = outputs_of(RESCUED, "1", "run_time(0.6)");
    let log = String::from_utf8_lossy(&one["log.mpm"]).into_owned();
    assert!(log.contains("rescue"), "{log}");
    for how in OTHERS {
        assert!(outputs_of(RESCUED, how, "run_time(0.6)") == one, "{how}");
    }
}
