//! The energy ledger: every scene closes, what is left over falls with dt, and each term is what
//! a closed form says. Dropping a term is the broken variant that the same gates see.

use super::script::{Played, Script};
use karamelo::compute::energy::strain_energy;
use karamelo::model::group::GroupId;

/// Terms of the balance and their signs.
pub const TERMS: [(&str, f64); 10] = [
    ("kinetic", 1.0),
    ("stored", 1.0),
    ("plastic", 1.0),
    ("viscous", 1.0),
    ("damage", 1.0),
    ("friction", 1.0),
    ("damping", 1.0),
    ("numerical", 1.0),
    ("external", -1.0),
    ("boundary", -1.0),
];

fn column(played: &Played, name: &str) -> Vec<f64> {
    played.end.as_ref().expect("the run is stable");
    played.column(&format!("W_{name}"))
}

fn last(played: &Played, name: &str) -> f64 {
    *column(played, name).last().unwrap()
}

/// The balance of the last row less that of the first, without one term, over the largest term.
fn imbalance_without(played: &Played, dropped: &str) -> f64 {
    let (mut sum, mut largest) = (0.0, 0.0f64);
    for (name, sign) in TERMS {
        let values = column(played, name);
        largest = values.iter().fold(largest, |a, b| a.max(b.abs()));
        if name != dropped {
            sum += sign * (values[values.len() - 1] - values[0]);
        }
    }
    (sum / largest).abs()
}

fn worst(played: &Played) -> f64 {
    column(played, "error").iter().fold(0.0, |worst: f64, error| worst.max(error.abs()))
}

fn disks(dt: f64) -> Script {
    let statement = format!("set_dt({dt})");
    Script::input("two-disks/two-disks-modern.mpm").with_ledger().statement("set_dt", &statement)
}

#[test]
fn the_residual_of_two_disks_halves_with_dt() {
    let errors = [1e-3, 5e-4, 2.5e-4].map(|dt| last(&disks(dt).play(&[]), "error").abs());
    println!("V1 ledger {errors:?}");
    assert!(errors[0] < 0.003, "{errors:?}"); // 0.22 % in an independent model
    for pair in errors.windows(2) {
        assert!((pair[0] / pair[1] - 2.0).abs() < 0.2, "{errors:?}");
    }
}

#[test]
fn the_residual_of_a_smooth_motion_falls_by_four() {
    // No cell is crossed and nothing is lost: the central difference in time is of second order.
    let script = |part: f64| {
        Script::input("manufactured-1d.mpm")
            .with_ledger()
            .statement("set_dt", &format!("set_dt({part}*h/c)"))
    };
    let errors = [0.2, 0.1, 0.05].map(|part| worst(&script(part).play(&[])));
    println!("manufactured ledger {errors:?}");
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 2.0).abs() < 0.3, "{errors:?}");
    }
}

#[test]
fn what_the_stress_has_stored_is_the_strain_energy_but_for_the_square_of_dt() {
    // A neo-Hookean disk, spun and strained. The work of its stress is the trapezoid of P : dF: off by
    // (dt L)^2/12 and thirds of it, L about 5, from steps of 2 ms.
    let text = "
h = 1/8\nmethod(KIND, FLIP, cubic-spline, 1)\nscheme(ORDER)\ndimension(2, -1, 1, -1, 1, h)
region(disk, sphere, 0, 0, 0.5)\nmaterial(rubber, neo-hookean, 1000, 1e5, 0.3)
solid(disk, region, disk, 2, rubber, h)
fix(spin, initial_velocity_particles, all, 2*x0 - 4*y0, 3*x0 - 2*y0)
log_modify(custom, step)\nset_dt(step_size)\nrun_time(0.04)";
    for kind in ["ulmpm", "tlmpm"] {
        for scheme in ["musl", "usl", "usf"] {
            let script = Script::new("disk", text).replace("KIND", kind).replace("ORDER", scheme);
            let errors = [2e-3, 1e-3, 5e-4].map(|dt| {
                let played = script.with_ledger().play(&[("step_size", dt)]);
                let strain = strain_energy(&played.session.simulation.world, GroupId::ALL);
                assert!(strain > 0.1 * column(&played, "kinetic")[0]);
                (last(&played, "stored") / strain - 1.0).abs()
            });
            println!("{kind} {scheme}: stored energy off by {errors:?}");
            assert!(errors[0] < 1e-4, "{errors:?}");
            for pair in errors.windows(2) {
                let order = (pair[0] / pair[1]).log2();
                assert!((order - 2.0).abs() < 0.3, "{kind} {scheme}: order {order}");
            }
        }
    }
}

/// A disk in a box, and statements.
fn disk(method: &str, statements: &str) -> Played {
    let text = format!(
        "h = 1/16\nmethod({method})
dimension(2, 0, 1, 0, 1, h)\nregion(disk, sphere, 0.5, 0.5, 0.2)
region(everywhere, block, INF, INF, INF, INF)\nregion(left, block, INF, 0.45, INF, INF)
material(rubber, linear, 1024, 1e4, 0.3)\nsolid(ball, region, disk, 2, rubber, h)
group(body, particles, region, disk)\ngroup(some, particles, region, left)
group(nodes, nodes, region, everywhere)\nset_dt(1/1024)\nset_output(8)
log_modify(custom, step)\n{statements}"
    );
    Script::new("disk", &text).with_ledger().play(&[])
}

fn near(found: f64, exact: f64, tolerance: f64) {
    assert!((found - exact).abs() <= tolerance * exact.abs(), "{found} for {exact}");
}

/// Mass of the particles.
fn mass(played: &Played) -> f64 {
    played.session.simulation.world.particles.position.iter().map(|place| place[3]).sum()
}

#[test]
fn falling_takes_up_the_work_of_the_weight_to_the_last_digit() {
    for group in ["all", "nodes", "body"] {
        let fall = format!("fix(g, body_force, {group}, 0, -8)\nrun(64)");
        let played = disk("ulmpm, FLIP, linear, 1", &fall);
        let energy = 0.5 * mass(&played) * (8.0f64 * 64.0 / 1024.0).powi(2);
        near(last(&played, "external"), energy, 1e-12);
        near(last(&played, "kinetic"), energy, 1e-12);
        assert!(worst(&played) < 1e-12);
        assert!(imbalance_without(&played, "external") > 0.9);
    }
}

#[test]
fn what_prescribed_velocities_do_is_the_work_of_the_boundary() {
    for (method, lift) in [
        ("ulmpm, FLIP, linear, 1", "fix(lift, velocity_nodes, nodes, 2*time, NULL)\nrun(64)"),
        ("ulmpm, FLIP, linear, 1", "fix(lift, velocity_particles, body, 2*time, NULL)\nrun(64)"),
        ("ulmpm, APIC, linear", "fix(lift, velocity_nodes, nodes, 2*time, NULL)\nrun(64)"),
    ] {
        let played = disk(method, lift);
        let energy = 0.5 * mass(&played) * (2.0f64 * 64.0 / 1024.0).powi(2);
        near(last(&played, "boundary"), energy, 1e-11);
        assert!(worst(&played) < 1e-11, "{method} {lift}");
        assert!(imbalance_without(&played, "boundary") > 0.9);
    }
}

#[test]
fn a_wall_that_pushes_a_bar_does_its_work_and_one_that_stands_does_none() {
    let bar = |wall: &str| {
        let text = format!(
            "h = 1/16\nmethod(ulmpm, FLIP, cubic-spline, 1)\ndimension(1, -0.5, 1.5, h)
region(body, block, 0, 1)\nregion(left, block, INF, 3*h/2)
material(elastic, linear, 1, 100, 0)\nsolid(bar, region, body, 2, elastic, h)
group(wall, nodes, region, left)\nfix(push, velocity_nodes, wall, {wall})
fix(start, initial_velocity_particles, all, 0.01*x^2)
log_modify(custom, step)\nset_output(1)\nset_dt(0.001)\nrun(60)"
        );
        Script::new("bar", &text).with_ledger().play(&[])
    };
    let (standing, pushing) = (bar("0"), bar("0.2*sin(5*PI*time)^2"));
    let scale = last(&standing, "kinetic");
    assert!(column(&standing, "boundary").iter().all(|work| work.abs() < 1e-12 * scale));
    println!("wall: errors {:.1e} {:.1e}", worst(&standing), worst(&pushing));
    assert!(worst(&standing) < 0.01 && worst(&pushing) < 0.01);
    assert!(imbalance_without(&pushing, "boundary") > 0.9);
}

#[test]
fn damping_by_the_transfer_is_seen_in_every_scheme() {
    for scheme in ["musl", "usl", "usf"] {
        for transfer in [
            "FLIP, quadratic-spline, 1",
            "PIC, quadratic-spline",
            "FLIP, linear, 0.98",
            "APIC, quadratic-spline",
            "XPIC, 2, quadratic-spline",
            "ASFLIP, quadratic-spline, 0.99",
            "MLS, quadratic-spline",
        ] {
            let script = disks(5e-4)
                .statement("method", &format!("method(ulmpm, {transfer})\nscheme({scheme})"))
                .statement("run_time", "run_time(2.2)");
            let played = script.play(&[]);
            let numerical = last(&played, "numerical");
            println!("{scheme} {transfer}: {:.1e}, numerical {numerical:.2e}", worst(&played));
            // Strains from v* see nodes with hardly any mass: of first order in dt, but large.
            let updated = scheme == "usl" || transfer.starts_with("MLS") && scheme == "musl";
            let gate = if updated { 0.03 } else { 0.001 };
            assert!(worst(&played) < gate, "{scheme} {transfer}");
            if transfer.ends_with(" 1") && updated {
                assert!(numerical > 0.0 && numerical < 0.01, "{numerical}");
            } else if transfer.ends_with(" 1") {
                assert!(numerical.abs() < 1e-12, "{numerical}");
            } else {
                assert!(numerical > 0.1 && imbalance_without(&played, "numerical") > 0.03);
            }
        }
    }
}

#[test]
fn a_rod_that_hits_a_wall_turns_its_motion_into_plastic_work() {
    let played = Script::input("taylor-bar/taylor-bar.mpm").with_ledger().play(&[("h", 1.0)]);
    let start = column(&played, "kinetic")[0];
    let [plastic, numerical] = ["plastic", "numerical"].map(|name| last(&played, name) / start);
    println!("rod: plastic {plastic:.4}, numerical {numerical:.4}, error {:.2e}", worst(&played));
    assert!(worst(&played) < 0.01);
    assert!(plastic > 0.8 && numerical > 0.05, "{plastic} {numerical}");
    // What the ledger calls stored is the work less the losses; the laws know it from the stress.
    let strain = strain_energy(&played.session.simulation.world, GroupId::ALL);
    assert!((last(&played, "stored") - strain).abs() < 0.002 * start, "{strain}");
    for dropped in ["plastic", "numerical"] {
        assert!(imbalance_without(&played, dropped) > 0.05, "{dropped}");
    }
}

/// A copper cylinder round the axis that hits a smooth wall with 190 m/s; mm, ms, kg.
const ROUND_ROD: &str = "
h = 0.8
method(ulmpm, FLIP, quadratic-spline, 0.99)
dimension(2, 0, 9.6, 0, 14.4, h)
axisymmetric(true)
region(rod, block, 0, 3.2, 0, 12.8)
region(wall, block, INF, INF, INF, h/4)
material(copper, von-mises, 8.93e-6, 124, 0.34, 0.09, 0.3)
solid(rod, region, rod, 2, copper, h)
group(wall, nodes, region, wall)
fix(stop, velocity_nodes, wall, NULL, 0)
fix(launch, initial_velocity_particles, all, 0, -190)
log_modify(custom, step)
set_output(10)
dt_factor(0.5)
run_time(0.03)
";

#[test]
fn a_round_rod_that_hits_a_wall_loses_its_motion_to_plastic_work() {
    let played = Script::new("rod", ROUND_ROD).with_ledger().play(&[]);
    let kinetic = column(&played, "kinetic");
    // Per radian: rho R^2/2 times the height, times v^2/2.
    near(kinetic[0], 0.5 * 8.93e-6 * 0.5 * 3.2 * 3.2 * 12.8 * 190.0 * 190.0, 1e-12);
    let [plastic, error] = [last(&played, "plastic") / kinetic[0], worst(&played)];
    println!("round rod: plastic {plastic:.4}, error {error:.2e}");
    assert!(error < 0.01 && plastic > 0.8, "{error} {plastic}");
    assert!(imbalance_without(&played, "plastic") > 0.5);
}

/// A cylinder thrown outwards within smooth ends: it rings, and no particle changes its cell.
fn ringing(method: &str, part: f64) -> Played {
    let text = format!(
        "h = 1/16\nmethod({method}, FLIP, quadratic-spline, 1)
dimension(2, 0, 1.25, 0, 0.5, h)\naxisymmetric(true)
region(body, block, 0, 1, 0, 0.5)\nregion(low, block, INF, INF, INF, h/8)
region(high, block, INF, INF, 0.5 - h/8, INF)
material(rubber, neo-hookean, 1, 1, 0.3)\nsolid(body, region, body, 2, rubber, h)
group(low, nodes, region, low)\ngroup(high, nodes, region, high)
fix(low, velocity_nodes, low, NULL, 0)\nfix(high, velocity_nodes, high, NULL, 0)
fix(start, initial_velocity_particles, all, 1e-3*sin(PI*x0/2)*cos(4*PI*y0), -5e-4*sin(4*PI*y0))
log_modify(custom, step)\nset_output(4)\nset_dt({part}*h)\nrun_time(3)"
    );
    Script::new("ringing", &text).with_ledger().play(&[])
}

#[test]
fn the_residual_of_a_ringing_cylinder_falls_by_four() {
    for method in ["ulmpm", "tlmpm"] {
        let runs = [0.2, 0.1, 0.05].map(|part| ringing(method, part));
        let errors = runs.each_ref().map(worst);
        println!("{method} ringing cylinder: errors of the ledger {errors:?}");
        assert!(errors[0] < 0.01, "{errors:?}");
        for pair in errors.windows(2) {
            assert!(((pair[0] / pair[1]).log2() - 2.0).abs() < 0.3, "{errors:?}");
        }
        assert!(imbalance_without(&runs[0], "stored") > 0.1);
    }
}

/// Two copper plates of 10 mm that meet with 1000 m/s each, after 1 us.
fn plates(h: f64, viscosity: &str) -> Played {
    let text = format!(
        "h = {h}\nmethod(tlmpm, FLIP, linear, 1)\ndimension(1, -0.012, 0.012, h)
eos(curve, shock, 8960, 8960*3940^2, 3940, 1.489, 0, 0, 0, {viscosity})
strength(none, fluid, 0)\nmaterial(copper, eos-strength, curve, none)
region(left, block, -0.01, 0)\nregion(right, block, 0, 0.01)
region(both, block, -0.01, 0.01)\nsolid(plates, region, both, 2, copper, h)
fix(meet, initial_velocity_particles, all, if(x < 0, 1000, -1000))
log_modify(custom, step)\nset_output(10)\nset_dt(0.2*h/6429)\nrun_time(1e-6)"
    );
    Script::new("plates", &text).with_ledger().play(&[])
}

#[test]
fn a_shock_dissipates_what_the_hugoniot_says() {
    // Behind the shock a mass has gained u^2/2, of which the curve p = rho0 c^2 e/(1 - S e)^2 stores
    // c^2/S^2 (ln(1 - S e) + 1/(1 - S e) - 1), e = u/U; viscosity has taken the rest.
    let (c, s, u) = (3940.0f64, 1.489, 1000.0);
    let front = c + s * u;
    let left: f64 = 1.0 - s * u / front;
    let stored = (c / s).powi(2) * (left.ln() + 1.0 / left - 1.0);
    let shocked = 2.0 * 8960.0 * front * 1e-6;
    let exact = [stored * shocked, (0.5 * u * u - stored) * shocked];
    let errors = [1e-4, 5e-5].map(|h| {
        let played = plates(h, "2, 0.2");
        assert!(worst(&played) < 0.01);
        assert!(imbalance_without(&played, "viscous") > 0.05);
        [last(&played, "stored") / exact[0] - 1.0, last(&played, "viscous") / exact[1] - 1.0]
    });
    println!("plates: stored, viscous {errors:.4?}");
    // A few cells where the plates meet are heated too much, and the front is some cells wide: an
    // error of about 5 cells of the 54 that the shock has passed, which halves with h.
    assert!(errors[0][0].abs() < 0.02 && errors[0][1].abs() < 0.12, "{errors:?}");
    assert!((errors[0][1] / errors[1][1] - 2.0).abs() < 0.4, "{errors:?}");
    assert_eq!(last(&plates(1e-4, "0, 0"), "viscous"), 0.0);
}

#[test]
fn a_bar_torn_apart_loses_its_stored_energy_to_damage() {
    let text = "
h = 0.05\nmethod(tlmpm, FLIP, linear, 1)\ndimension(2, -1, 2, -1, 2, h)
eos(curve, linear, 8, 150)\nstrength(flow, johnson_cook, 80, 0.3, 0.3, 0.5, 1, 0, 0, 0, 1)
damage(crack, damage_johnson_cook, 0.05, 0, 0, 0, 0, 1, 0, 1)
temperature(heat, plastic_work, 0.9, 400, 0, 0, 0, 1e9)
material(metal, eos-strength, curve, flow, crack, heat)
region(body, block, 0, 1, 0, 0.2)\nregion(low, block, INF, h/4, INF, INF)
region(high, block, 1-h/4, INF, INF, INF)\nsolid(bar, region, body, 2, metal, h)
group(low, nodes, region, low)\ngroup(high, nodes, region, high)
fix(hold, velocity_nodes, low, 0, NULL)\nfix(pull, velocity_nodes, high, 0.05, NULL)
log_modify(custom, step)\nset_output(20)\nrun_time(2)";
    let played = Script::new("bar", text).with_ledger().play(&[]);
    for name in ["plastic", "damage", "boundary", "heat"] {
        println!("bar: {name} {:.3e}", last(&played, name));
    }
    let least = column(&played, "stored").into_iter().fold(0.0, f64::min);
    println!("bar: error {:.2e}, least stored {least:.2e}", worst(&played));
    assert!(worst(&played) < 0.01);
    assert!(imbalance_without(&played, "damage") > 0.02);
    // psi = V sigma : eps/2 is no exact potential of the pressure K (1 - J): off by half the strain.
    assert!(least > -0.01 * last(&played, "boundary"));
    near(last(&played, "heat"), 0.9 * last(&played, "plastic"), 1e-10);
}

#[test]
fn the_ledger_goes_on_in_a_later_run_and_ends_with_its_compute() {
    let one = disk("ulmpm, FLIP, linear, 1", "fix(g, body_force, all, 0, -8)\nrun(64)");
    let two = disk("ulmpm, FLIP, linear, 1", "fix(g, body_force, all, 0, -8)\nrun(30)\nrun(34)");
    assert_eq!(last(&one, "external"), last(&two, "external"));
    let pushed = disk(
        "ulmpm, FLIP, linear, 1",
        "run(8)\nfix(v, initial_velocity_particles, body, 0, -1)\nrun(8)",
    );
    near(last(&pushed, "external"), 0.5 * mass(&pushed), 1e-12);
    assert!(worst(&pushed) < 1e-12);
}

#[test]
fn a_scene_that_reads_the_ledger_moves_as_it_does_without() {
    for scheme in ["musl", "usl", "usf"] {
        let script = |ledger: bool| {
            let method = format!("method(ulmpm, APIC, quadratic-spline)\nscheme({scheme})");
            let script = Script::input("two-disks/two-disks-modern.mpm");
            let script = if ledger { script.with_ledger() } else { script };
            script.statement("method", &method).statement("run_time", "run(1500)")
        };
        let state = |played: Played| played.session.simulation.world.particles.velocity;
        let with = script(true).play(&[]);
        assert!(with.session.simulation.world.ledger.open);
        // Dumps and figures of the script as it is go nowhere.
        let plain = script(false).without_files().play(&[]);
        assert!(!plain.session.simulation.world.ledger.open);
        assert_eq!(state(with), state(plain), "{scheme}");
    }
}
