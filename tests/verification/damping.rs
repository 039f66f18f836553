//! Damping of nodes (language.md 6.6): decay of an oscillation, a column at rest, the ledger.

use super::script::{Played, Script};

fn last(played: &Played, name: &str) -> f64 {
    played.end.as_ref().expect("the run is stable");
    *played.column(name).last().unwrap()
}

/// A bar held at x = 0, in its first mode (L = 1, c = 1, omega = PI/2), with viscous damping.
fn bar(cells: usize, damping: &str) -> Played {
    let text = format!(
        "h = 1/{cells}
c = 0.4
v0 = 1e-4
method(ulmpm, FLIP, linear, 1)
dimension(1, 0, 1 + 3*h, h)
region(bar, block, 0, 1)
region(left, block, INF, h/4)
material(m, linear, 1, 1, 0)
solid(s, region, bar, 2, m, h)
group(wall, nodes, region, left)
group(b, particles, region, bar)
fix(start, initial_velocity_particles, all, v0*sin(PI/2*x0))
{damping}
fix(hold, velocity_nodes, wall, 0)
compute(v, average_velocity, b)
compute(W, energy_ledger, all)
log_modify(custom, time, v_x, d_s, W_damping, W_kinetic, W_stored, W_error)
set_output(1)
set_dt(0.1*h)
run_time(8)
"
    );
    Script::new("damped bar", &text).play(&[])
}

/// Largest deviation of the mean velocity from that of u'' + c u' + omega^2 u = 0, relative.
fn deviation(played: &Played, c: f64) -> f64 {
    played.end.as_ref().expect("the run is stable");
    let omega = std::f64::consts::FRAC_PI_2;
    let (free, decay) = ((omega * omega - 0.25 * c * c).sqrt(), 0.5 * c);
    let pairs = played.column("Time").into_iter().zip(played.column("v_x"));
    let errors = pairs.map(|(t, v)| {
        let exact = (-decay * t).exp() * ((free * t).cos() - decay / free * (free * t).sin());
        (v / (1e-4 * std::f64::consts::FRAC_2_PI) - exact).abs()
    });
    errors.fold(0.0, f64::max)
}

#[test]
fn a_vibration_dies_with_half_the_coefficient() {
    let damping = "fix(d, damping_nodes, all, c)";
    let errors = [10, 20, 40].map(|cells| deviation(&bar(cells, damping), 0.4));
    println!("damped bar {errors:?}");
    for pair in errors.windows(2) {
        // Hats in space and the step in proportion: between the orders 1 of damping at the start of
        // the step and 2 of the grid.
        assert!((pair[0] / pair[1]).log2() > 0.9, "{errors:?}");
    }
    assert!(errors[2] < 0.01, "{errors:?}");
    // Twice the coefficient is seen.
    assert!(deviation(&bar(20, "fix(d, damping_nodes, all, 2*c)"), 0.4) > 0.1);
}

#[test]
fn a_coefficient_may_depend_on_time() {
    // Damping from t = 4 on: a full period without, one with.
    let played = bar(40, "fix(d, damping_nodes, all, if(time < 4, 0, c))");
    let (time, v) = (played.column("Time"), played.column("v_x"));
    let at = |t: f64| v[time.iter().position(|time| *time >= t - 1e-9).unwrap()];
    let decay = at(8.0) / at(4.0);
    println!("kept of the amplitude in one damped period: {decay}");
    assert!((at(4.0) / at(0.0) - 1.0).abs() < 0.01, "{}", at(4.0));
    // The period grows by (c/(2 omega))^2/2 = 0.8 %: cos of that phase is 1 within 0.2 %, the sine
    // term 0.13 * 0.05.
    assert!((decay / (-0.2f64 * 4.0).exp() - 1.0).abs() < 0.02, "{decay}");
}

#[test]
fn the_ledger_and_the_fix_agree_on_what_damping_takes() {
    let played = bar(40, "fix(d, damping_nodes, all, c)");
    let energy = 0.25e-8;
    let left = last(&played, "W_kinetic") + last(&played, "W_stored");
    for name in ["d_s", "W_damping"] {
        let taken = last(&played, name);
        println!("{name}: {taken:e} of {:e}", energy - left);
        // Velocities of the start in place of the middle of a step: c dt/2 = 5e-4 of a step's loss.
        assert!((taken / (energy - left) - 1.0).abs() < 0.01, "{taken}");
    }
    let worst = played.column("W_error").iter().fold(0.0f64, |a, b| a.max(b.abs()));
    assert!(worst < 0.005, "{worst}");
}

#[test]
fn local_damping_brings_a_column_to_its_static_state() {
    let column = |damping: &str| {
        let text = format!(
            "h = 1/20
method(ulmpm, FLIP, linear, 1)
dimension(1, 0, 1 + 3*h, h)
region(column, block, 0, 1)
region(low, block, INF, h/4)
region(high, block, 1 - h, INF)
material(m, linear, 1, 1, 0)
solid(s, region, column, 2, m, h)
group(base, nodes, region, low)
group(tip, particles, region, high)
fix(gravity, body_force, all, -1e-3)
{damping}
fix(hold, velocity_nodes, base, 0)
compute(Ek, kinetic_energy, all)
compute(W, energy_ledger, all)
tip = xcm(tip, x)
log_modify(custom, time, tip, hold_x, d_x, d_s, Ek, W_damping, W_stored, W_external, W_error)
set_output(10)
run_time(60)
"
        );
        Script::new("column", &text).play(&[])
    };
    let played = column("fix(d, damping_local_nodes, all, 0.3)");
    // u = -rho g/E (x - x^2/2) at the tip's particles, x = 1 - h/4 and 1 - 3h/4, in the mean.
    let settled = -1e-3
        * 0.5
        * [0.25, 0.75]
            .map(|a: f64| {
                let x: f64 = 1.0 - a / 20.0;
                x - 0.5 * x * x
            })
            .iter()
            .sum::<f64>();
    let tip = played.column("tip");
    let found = tip[tip.len() - 1] - tip[0];
    println!("tip {found:e} of {settled:e}, base {}", last(&played, "hold_x"));
    // Strains of 1e-3, and second order in h: (1/20)^2.
    assert!((found / settled - 1.0).abs() < 4e-3, "{found} {settled}");
    // At the base damping acts as well, before the fix that holds it.
    let base = last(&played, "hold_x") + last(&played, "d_x");
    // What still swings is below 1e-3 of the way (the next line); its force is not felt at 1e-5.
    assert!((base / 1e-3 - 1.0).abs() < 1e-5, "{base}");
    assert!(last(&played, "Ek") < 1e-6 * last(&played, "W_stored"));
    // Half of the work of gravity is lost, as for every load that comes at once.
    let lost = last(&played, "W_damping") / last(&played, "W_external");
    assert!((lost - 0.5).abs() < 0.01, "{lost}");
    // Without damping the column swings on.
    let swinging = column("fix(d, damping_local_nodes, all, 0)");
    assert!(last(&swinging, "Ek") + last(&swinging, "W_stored") > 0.0);
    let highest = swinging.column("Ek").iter().rev().take(200).fold(0.0f64, |a, b| a.max(*b));
    assert!(highest > 0.1 * last(&played, "W_stored"), "{highest}");
}
