//! Fixes, computes and group functions through scripts, against closed forms.

use super::script::Script;
use karamelo::command::play::{perform, rehearse};
use karamelo::command::session::{Mode, Session};
use karamelo::output::Outputs;
use karamelo::script::formula::{GroupFunction, Quantity};
use karamelo::script::source::Source;

/// A disk of 0.4 in a box, dyadic sizes; mass and volume as the particles have them.
const SCENE: &str = "
h = 1/16
method(ulmpm, FLIP, linear, 1)
dimension(2, 0, 1, 0, 1, h)
region(disk, sphere, 0.5, 0.5, 0.2)
region(everywhere, block, INF, INF, INF, INF)
material(rubber, linear, 1024, 1e4, 0.3)
solid(ball, region, disk, 2, rubber, h)
group(body, particles, region, disk)
group(nodes, nodes, region, everywhere)
set_dt(1/1024)
log_modify(custom, time)
set_output(0)
";

fn run(script: &str) -> Session {
    let (script, found) = rehearse(Source::new("test", &format!("{SCENE}{script}")), &[]);
    assert!(found.is_empty(), "{found:?}");
    let mut session = Session::new(Outputs::silent(), Mode::Run);
    perform(&script, &mut session).expect("the script runs");
    session
}

fn fix(session: &Session, id: &str, component: usize) -> f64 {
    session.simulation.measure(&Quantity::Fix { id: id.to_string(), component })
}

fn compute(session: &Session, id: &str, component: usize) -> f64 {
    session.simulation.measure(&Quantity::Compute { id: id.to_string(), component })
}

fn mass(session: &Session) -> f64 {
    session.simulation.world.particles.position.iter().map(|position| position[3]).sum()
}

/// Round-off of some hundred steps on sums of some hundred terms.
fn near(found: f64, exact: f64) {
    assert!((found - exact).abs() <= 1e-11 * exact.abs().max(1.0), "{found} for {exact}");
}

#[test]
fn gravity_on_nodes_and_on_particles_is_the_same_free_fall() {
    for target in ["all", "nodes", "body"] {
        let session = run(&format!(
            "fix(g, body_force, {target}, 2, -8)\ncompute(v, average_velocity, all)\nrun(64)"
        ));
        let time = 64.0 / 1024.0;
        near(compute(&session, "v", 0), 2.0 * time);
        near(compute(&session, "v", 1), -8.0 * time);
        near(fix(&session, "g", 1), -8.0 * mass(&session));
    }
}

#[test]
fn a_force_of_place_and_time_is_taken_at_each_node_at_the_start_of_the_step() {
    // f = 4 t in x: v = sum dt 4 t_n.
    let session = run(
        "fix(g, body_force, nodes, 4*time + 0*x, NULL)\ncompute(v, average_velocity, all)\nrun(8)",
    );
    let sum: f64 = (0..8).map(|n| 4.0 * f64::from(n) / 1024.0 / 1024.0).sum();
    near(compute(&session, "v", 0), sum);
    near(compute(&session, "v", 1), 0.0);
}

#[test]
fn a_nodal_force_acts_once_whatever_it_is_split_over() {
    let session =
        run("fix(push, force_nodes, nodes, 3, 0)\nrun(32)\na = external_force(nodes, x)\nrun(1)");
    near(fix(&session, "push", 0), 3.0);
    let momentum: f64 = {
        let particles = &session.simulation.world.particles;
        particles.position.iter().zip(&particles.velocity).map(|(x, v)| x[3] * v[0]).sum()
    };
    near(momentum, 3.0 * 33.0 / 1024.0);
    let external = Quantity::Group {
        function: GroupFunction::ExternalForce,
        group: "nodes".to_string(),
        axis: 0,
    };
    near(session.simulation.measure(&external), 3.0);
}

#[test]
fn prescribed_nodes_carry_the_body_and_report_the_force_it_takes() {
    let session = run(
        "fix(lift, velocity_nodes, nodes, 2*time, NULL)\ncompute(v, average_velocity, all)\nrun(64)",
    );
    near(compute(&session, "v", 0), 2.0 * 64.0 / 1024.0);
    near(fix(&session, "lift", 0), 2.0 * mass(&session));
    near(fix(&session, "lift", 1), 0.0);
}

#[test]
fn prescribed_particles_move_as_told_and_report_the_force_it_takes() {
    let session =
        run("fix(pull, velocity_particles, body, 4*time, 0)\nfix(g, body_force, all, 0, -1)
compute(top, max_position, body)\nstart = value(top_x)\nrun(32)");
    // x += dt v(t + dt), with v = 4 t.
    let path: f64 = (1..=32).map(|n| 4.0 * f64::from(n) / 1024.0 / 1024.0).sum();
    let before = run("compute(top, max_position, body)\nrun(0)");
    near(compute(&session, "top", 0) - compute(&before, "top", 0), path);
    near(compute(&session, "top", 1) - compute(&before, "top", 1), 0.0);
    // In y the weight is held; in x the grid has only v(t), the fix adds the rest.
    near(fix(&session, "pull", 1), mass(&session));
    near(fix(&session, "pull", 0), 4.0 * mass(&session));
}

#[test]
fn initial_velocities_of_nodes_and_particles_act_once() {
    for (target, style) in
        [("nodes", "initial_velocity_nodes"), ("body", "initial_velocity_particles")]
    {
        let session = run(&format!(
            "fix(v0, {style}, {target}, 0.5, NULL)\ncompute(v, average_velocity, all)\nrun(10)\nrun(10)"
        ));
        near(compute(&session, "v", 0), 0.5);
        near(compute(&session, "v", 1), 0.0);
    }
}

#[test]
fn an_exact_solution_has_no_error_and_a_wrong_one_has() {
    let script = |speed: &str| {
        format!(
            "fix(v, initial_velocity_particles, all, 0.25, 0)\nfix(e, check_solution, all, {speed}*time + 0*x0, 0)\nrun(64)"
        )
    };
    let exact = run(&script("0.25"));
    assert!(fix(&exact, "e", 3) < 1e-13 && fix(&exact, "e", 2) < 1e-12);
    let wrong = run(&script("0.5"));
    // At the end u = 0.25 t and the formula says 0.5 t.
    near(fix(&wrong, "e", 3), 0.25 * 64.0 / 1024.0);
    near(fix(&wrong, "e", 2), 0.5);
}

#[test]
fn an_initial_stress_is_there_before_the_first_step_and_stores_its_energy() {
    let session = run(
        "fix(s, initial_stress, all, 10, 20, 0, 0, 0, 5)\ncompute(Es, strain_energy, all)\nrun(0)",
    );
    let volume = mass(&session) / 1024.0;
    let (young, nu) = (1e4, 0.3);
    let energy = (10.0 * 10.0 + 20.0 * 20.0 - 2.0 * nu * 10.0 * 20.0) / (2.0 * young)
        + 5.0 * 5.0 * (1.0 + nu) / young;
    near(compute(&session, "Es", 0), volume * energy);
}

#[test]
fn momenta_and_means_of_a_turning_disk() {
    let session = run("fix(v, initial_velocity_particles, all, -(y-0.5), x-0.5)
compute(L, angular_momentum, all, 0.5, 0.5, 0)\ncompute(v, average_velocity, all)
compute(Ek, kinetic_energy, all)\na = xcm(body, x)\nrun(0)\nb = value(a)\nrun(0)");
    let particles = &session.simulation.world.particles;
    let inertia: f64 = particles
        .position
        .iter()
        .map(|x| x[3] * ((x[0] - 0.5).powi(2) + (x[1] - 0.5).powi(2)))
        .sum();
    near(compute(&session, "L", 2), inertia);
    near(compute(&session, "Ek", 0), 0.5 * inertia);
    near(compute(&session, "v", 0), 0.0);
    let centre =
        Quantity::Group { function: GroupFunction::Xcm, group: "body".to_string(), axis: 0 };
    near(session.simulation.measure(&centre), 0.5);
}

#[test]
fn runs_end_by_steps_time_and_condition() {
    let session =
        run("run(3)\nrun_time(10/1024)\nrun_while(time < 20/1024)\nrun_until(timestep >= 25)");
    assert_eq!(session.simulation.clock.step, 25);
    assert_eq!(session.simulation.clock.time, 25.0 / 1024.0);
}

#[test]
fn one_run_and_two_runs_give_the_same_bits() {
    let places = |script: &str| {
        let session = run(&format!("fix(g, body_force, all, 1, -8*x)\n{script}"));
        session.simulation.world.particles.position
    };
    assert_eq!(places("run(60)"), places("run(60)"));
}

/// All nodes of a total Lagrangian square turn about the corner by a quarter, each by where it is now.
const TURN: &str = "
method(tlmpm, FLIP, linear, 1)
dimension(2, -3, 3, -3, 3, 0.25)
region(square, block, 0, 1, 0, 1)
region(far, block, 0.75, 1, 0, 1)
material(m, neo-hookean, 1000, 1e5, 0.3)
solid(s, region, square, 2, m, 0.25)
group(edge, particles, region, far)
group(nodes, nodes, region, square)
omega = PI/2
fix(turn, velocity_nodes, nodes, -omega*y, omega*x)
X = xcm(edge, x)
Y = xcm(edge, y)
log_modify(custom, step, X, Y)
set_output(1000)
set_dt(1e-3)
run(1000)
";

#[test]
fn nodes_of_total_lagrangian_bodies_are_where_they_have_moved_in_every_scheme() {
    for scheme in ["musl", "usl", "usf"] {
        let script = Script::new("turn.mpm", TURN);
        let script = script.replace("omega =", &format!("scheme({scheme})\nomega ="));
        let played = script.play(&[]);
        played.end.as_ref().expect("the run is stable");
        let [x, y] = ["X", "Y"].map(|name| played.column(name));
        let (first, last) = ([x[0], y[0]], [x[x.len() - 1], y[y.len() - 1]]);
        // The middle (0.875, 0.5) goes to (-0.5, 0.875). Steps along the tangent: the radius grows by
        // (omega dt)^2/2 in each, 1.2e-3 in all; and each step lags by half of one.
        let off = (last[0] + first[1]).hypot(last[1] - first[0]) / first[0].hypot(first[1]);
        println!("{scheme}: off by {off:.2e} of the way from the centre");
        assert!(off < 3e-3, "{scheme}: {last:?} from {first:?}");
    }
}
