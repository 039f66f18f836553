//! V2: axial vibration of a bar, in one, two and three dimensions.

use super::convergence::{Gate, Problem, assert_all};
use super::scene::{linear, steps};
use super::way::{Way, reference, transfer_rows};
use karamelo::fix::components::Components;
use karamelo::fix::velocity_nodes::VelocityNodes;
use karamelo::model::domain::Domain;
use karamelo::model::group::GroupId;
use karamelo::output::Outputs;
use karamelo::region::Bounds;
use karamelo::region::block::Block;
use karamelo::script::formula::Formula;
use karamelo::simulation::Simulation;
use std::f64::consts::PI;
use std::ops::RangeInclusive;
use std::sync::Arc;

/// Both programs sum the same terms and print five digits; long runs amplify the round-off.
const SAME_SUMS: f64 = 1e-4;

/// The model of the table takes increments of strain at the middle of a step, ULMPM at its start,
/// TLMPM at its end: up to 3 % where particles cross cells, below 0.6 % elsewhere.
const TABLE: f64 = 0.03;

const SECOND: RangeInclusive<f64> = 1.8..=2.2;

const LENGTH: f64 = 25.0;
const OMEGA: f64 = 0.628318530718;

/// A block with the given limits on x, unbounded elsewhere.
fn between(lower: f64, upper: f64) -> Block {
    let mut bounds = Bounds::EVERYWHERE;
    (bounds.lower[0], bounds.upper[0]) = (lower, upper);
    Block(bounds)
}

/// A bar of `cells` cells, one cell wide with rollers at its sides, fixed at x = 0.
fn bar(dimension: usize, cells: usize, speed: f64) -> Simulation {
    let h = LENGTH / cells as f64;
    let upper = std::array::from_fn(|a| match a {
        0 => LENGTH + 3.0 * h,
        a if a < dimension => h,
        _ => 0.0,
    });
    let domain = Domain { dimension, lower: [0.0; 3], upper, cell: h };
    let mut simulation = Simulation::new(domain, Outputs::silent());
    simulation.fixed_dt = Some(0.1 * h / 10.0);
    simulation.add_solid("bar", "mat", linear(1.0, 100.0, 0.0), &between(0.0, LENGTH), 2);
    let everywhere = Arc::new(Block(Bounds::EVERYWHERE));
    simulation.add_node_group("sides", everywhere, None);
    simulation.add_node_group("wall", Arc::new(between(-1.0, 0.25 * h)), None);
    let zero = || Some(Formula::constant(0.0));
    let prescribe = |name: &str, axes| {
        let velocity = Components::new(name, axes);
        VelocityNodes::new(GroupId(if name == "sides" { 1 } else { 2 }), velocity)
    };
    simulation.add_fix("sides", Box::new(prescribe("sides", [None, zero(), zero()])));
    simulation.add_fix("wall", Box::new(prescribe("wall", [zero(), None, None])));
    let particles = &mut simulation.world.particles;
    for (velocity, position) in particles.velocity.iter_mut().zip(&particles.position) {
        velocity[0] = speed * (PI * position[0] / (2.0 * LENGTH)).sin();
    }
    simulation
}

/// Largest RMS error of the displacement over a period, relative to the RMS amplitude.
fn error(dimension: usize, cells: usize, speed: f64) -> f64 {
    let mut simulation = bar(dimension, cells, speed);
    let dt = simulation.fixed_dt.unwrap();
    let count = (10.0 / dt).round() as u64;
    let amplitude = speed / OMEGA / 2f64.sqrt();
    let mut worst: f64 = 0.0;
    for _ in 0..count / 5 {
        steps(&mut simulation, 5);
        worst = worst.max(deviation(&simulation, speed));
    }
    worst / amplitude
}

fn deviation(simulation: &Simulation, speed: f64) -> f64 {
    use karamelo::model::column::Column;
    let particles = &simulation.world.particles;
    let time = simulation.clock.time;
    let reference = particles.column(Column::X0);
    let square = |p: usize| {
        let exact =
            speed / OMEGA * (PI * reference[p] / (2.0 * LENGTH)).sin() * (OMEGA * time).sin();
        (particles.position[p][0] - reference[p] - exact).powi(2)
    };
    let sum: f64 = (0..particles.len()).map(square).sum();
    (sum / particles.len() as f64).sqrt()
}

#[test]
fn the_displacement_converges_with_order_two() {
    let errors = [25, 50, 100].map(|cells| error(1, cells, 0.001));
    // Independent model: 3.35e-3, 8.37e-4, 2.09e-4; sampling of a maximum and dt allow 10 %.
    for (error, reference) in errors.into_iter().zip([3.35e-3, 8.37e-4, 2.09e-4]) {
        assert!((error / reference - 1.0).abs() < 0.1, "{error:.3e} for {reference:.3e}");
    }
    let order = (errors[1] / errors[2]).log2();
    println!("V2 errors {errors:?}, order {order:.3}");
    assert!((order - 2.0).abs() < 0.2, "order {order}");
}

#[test]
fn one_two_and_three_dimensions_agree() {
    let [one, two, three] = [1, 2, 3].map(|dimension| error(dimension, 25, 0.001));
    // The same sums in another order: round-off of 2500 steps.
    assert!((one - two).abs() < 1e-9 && (one - three).abs() < 1e-9, "{one} {two} {three}");
}

#[test]
fn cell_crossing_ruins_linear_shapes_at_one_percent_strain() {
    // The independent model gives e = 0.095 at n = 50, v0 = 0.1: particles do cross cells.
    let error = error(1, 50, 0.1);
    println!("V2 at v0 = 0.1: {error:.4}");
    assert!(error > 0.03, "{error}");
}

#[test]
fn pic_damps_the_bar_and_is_seen_to_fail() {
    let mut simulation = bar(1, 50, 0.001);
    simulation.transfer.alpha = 0.0;
    let start = super::scene::energies(&simulation)[0];
    let count = (10.0 / simulation.fixed_dt.unwrap()).round() as u64;
    steps(&mut simulation, count);
    let [kinetic, stored] = super::scene::energies(&simulation);
    let lost = 1.0 - (kinetic + stored) / start;
    println!("V2 energy lost by PIC: {lost:.3}");
    // 31 % in the independent model.
    assert!((lost - 0.31).abs() < 0.02, "{lost}");
}

/// The bar of `inputs/bar.mpm` with the constant step of the tables.
fn script(speed: f64) -> Problem {
    let problem = Problem::input("bar.mpm", &[("v0", speed)]);
    problem.map(|script| script.statement("dt_factor(", "set_dt(0.1*h/sqrt(E/rho))"))
}

fn flip_ways() -> Vec<Way> {
    let shapes = ["linear", "quadratic-spline", "cubic-spline"];
    ["tlmpm", "ulmpm"].iter().flat_map(|m| shapes.map(|shape| Way::flip(m, shape))).collect()
}

/// The table has rows of TLMPM only: at this amplitude ULMPM agrees.
fn twin(way: &Way) -> Way {
    Way::flip("tlmpm", &way.shape)
}

#[test]
fn flip_converges_as_in_the_table_with_every_shape() {
    assert_all(flip_ways().iter().map(|way| {
        let cells = vec![25, 50, 100];
        let error = |n: &usize| reference("V2", 1, &twin(way), "v0=0.001", "u_relL2_max", *n);
        let expected = cells.iter().map(error).collect();
        Gate { cells, expected, tolerance: TABLE, order: SECOND }.check(&script(0.001), way)
    }));
}

#[test]
fn musl_has_the_errors_of_the_independent_model() {
    all_ways("musl");
}

#[test]
fn usl_has_the_errors_of_the_independent_model() {
    all_ways("usl");
}

#[test]
fn usf_has_the_errors_of_the_independent_model() {
    all_ways("usf");
}

/// Checks all ways with one scheme.
fn all_ways(scheme: &str) {
    let rows = transfer_rows("V2", "v0=0.001").into_iter().filter(|row| row.way.scheme == scheme);
    assert_all(rows.map(|row| {
        Gate::of(&row, SAME_SUMS, expected_order(&row.way)).check(&script(0.001), &row.way)
    }));
}

/// PIC smooths the velocity by (k h)^2 in each of 1/h steps: first order at best; 1 % of it, as
/// in FLIP 0.99, is 1 % of that error and shows on fine grids. With USF the strain lags the
/// positions by a step, an error of first order opposite to the others. ASFLIP moves each particle of ULMPM with its own
/// velocity, whose part that no node sees is never smoothed out. All else is of second order.
fn expected_order(way: &Way) -> RangeInclusive<f64> {
    match (way.transfer.as_str(), way.scheme.as_str(), way.method.as_str()) {
        ("PIC", ..) => 0.5..=1.0,
        (_, "usf", _) => 0.5..=2.2,
        ("FLIP 0.99", ..) => 1.3..=2.2,
        ("ASFLIP 1", _, "ulmpm") => 0.8..=2.2,
        _ => SECOND,
    }
}

#[test]
fn one_percent_of_strain_leaves_the_error_of_linear_theory_and_ruins_linear_shapes() {
    assert_all(flip_ways().iter().filter(|way| way.shape != "quadratic-spline").map(|way| {
        let crosses = way.method == "ulmpm" && way.shape == "linear";
        let order = if crosses { f64::NEG_INFINITY..=0.0 } else { 0.0..=1.0 };
        let cells = vec![25, 50, 100];
        let error = |n: &usize| reference("V2", 1, way, "v0=0.1", "u_relL2_max", *n);
        let expected = cells.iter().map(error).collect();
        Gate { cells, expected, tolerance: TABLE, order }.check(&script(0.1), way)
    }));
}

/// Twice the time between the zeros of the mean velocity.
fn period(way: &Way, cells: usize) -> f64 {
    let log = "log_modify(custom, step, dt, time, v_x)";
    let script = script(0.001).script.statement("log_modify(", log);
    let played = way.of(script).play(&[("cells", cells as f64)]);
    let (time, speed) = (played.column("Time"), played.column("v_x"));
    let zeros = (1..time.len()).filter(|n| speed[n - 1] * speed[*n] < 0.0).map(|n| {
        let part = speed[n - 1] / (speed[n - 1] - speed[n]);
        time[n - 1] + part * (time[n] - time[n - 1])
    });
    let zeros: Vec<f64> = zeros.collect();
    2.0 * (zeros[1] - zeros[0])
}

#[test]
fn periods_exceed_the_exact_one_as_in_the_table() {
    for way in flip_ways() {
        for cells in [25, 50] {
            let expected = reference("V2", 1, &twin(&way), "v0=0.001", "period_s", cells);
            let found = period(&way, cells);
            println!("V2 period on {cells} cells {found:.5}, table {expected:.4}: {way}");
            // 10 % of the excess as for the errors, and half a digit of the table.
            let tolerance = 0.1 * (expected - 10.0) + 5e-5;
            assert!((found - expected).abs() < tolerance, "{found} for {expected}: {way}");
        }
    }
}

/// Part of the energy lost in one period.
fn energy_lost(way: &Way, cells: usize) -> f64 {
    let columns = "compute(Es, strain_energy, all)\nlog_modify(custom, step, Ek, Es)";
    let script = script(0.001).script.statement("log_modify(", columns);
    let played = way.of(script).play(&[("cells", cells as f64), ("v0", 0.001)]);
    let (kinetic, stored) = (played.column("Ek"), played.column("Es"));
    let end = kinetic.len() - 1;
    1.0 - (kinetic[end] + stored[end]) / kinetic[0]
}

#[test]
fn flip_keeps_the_energy_and_its_blend_with_pic_does_not() {
    for way in flip_ways() {
        let drift = [25, 50].map(|cells| energy_lost(&way, cells).abs());
        println!("V2 energy drift {drift:?}: {way}");
        // The independent model drifts by less than 6e-5 at 25 cells, of third order.
        assert!(drift[0] < 6e-5, "{drift:?}: {way}");
    }
    // 0.37 % and 31 % in the independent model on 50 cells.
    let lost = |transfer| energy_lost(&Way::new("ulmpm", "linear", transfer, "musl"), 50);
    let (blend, pic) = (lost("FLIP 0.99"), lost("PIC"));
    println!("V2 energy lost: FLIP 0.99 {blend:.5}, PIC {pic:.4}");
    assert!((blend - 0.0037).abs() < 0.0002 && (pic - 0.31).abs() < 0.01, "{blend} {pic}");
}

#[test]
fn flip_with_gradients_of_the_step_before_is_unstable_with_usf() {
    // The independent model has errors of 2e7 and 3e7 on 40 cells.
    for shape in ["linear", "Bernstein-quadratic"] {
        let way = Way::new("tlmpm", shape, "FLIP 1 gradient-enhanced", "usf");
        let error = script(0.001).error(&way, 40);
        println!("V2 error {error:.2e}: {way}");
        assert!(error > 10.0, "{error}: {way}");
    }
}
