//! V20 round an axis: conduction of heat in a cylinder of radius 1 with k = rho cp = 1, against
//! Bessel functions.

use super::heat::{METHODS, with};
use super::script::{Played, Script};
use karamelo::model::column::Column;
use libm::{j0, j1};
use std::f64::consts::PI;

/// The second zero of J1 (the first is 0): J0(k r) has no slope at r = 1.
const FLAT: f64 = 3.831705970207512;

/// A cylinder whose height is 1, insulated; the tests give it T = 3 + J0(k r) cos(pi z).
const INSULATED: &str = "
h = 1/n
method(ulmpm, FLIP, linear, 1, thermo-mechanical)
dimension(2, 0, 1, 0, 1, h)
axisymmetric(true)
thermal_blend(1)
region(body, block, 0, 1, 0, 1)
material(m, linear, 1, 1e-6, 0, 1, 1)
solid(s, region, body, 2, m, h, 3)
set_dt(0.1*h^2)
set_output(0)
run_time(end)
";

/// A cylinder of four cells' height that starts at T = 1, its rim held at T = 0.
const HELD: &str = "
h = 1/n
method(ulmpm, FLIP, linear, 1, thermo-mechanical)
dimension(2, 0, 1, 0, 4*h, h)
axisymmetric(true)
thermal_blend(1)
region(body, block, 0, 1, 0, 4*h)
material(m, linear, 1, 1e-6, 0, 1, 1)
solid(s, region, body, 2, m, h, 1)
region(rim, block, 1 - h/8, INF, INF, INF)
group(rim, nodes, region, rim)
fix(cold, temperature_nodes, rim, 0)
log_modify(custom, time, cold_x)
set_dt(0.1*h^2)
set_output(0)
run_time(end)
";

/// The same body in plane strain: masses without r.
fn flat(script: Script) -> Script {
    script.replace("axisymmetric(true)", "axisymmetric(false)")
}

/// Place, mass and temperature of the particles.
fn states(played: &Played) -> Vec<([f64; 2], f64, f64)> {
    let particles = &played.session.simulation.world.particles;
    let temperature = particles.column(Column::Temperature);
    let state = |(x, t): (&[f64; 4], &f64)| ([x[0], x[1]], x[3], *t);
    particles.position.iter().zip(temperature).map(state).collect()
}

fn content(states: &[([f64; 2], f64, f64)]) -> f64 {
    states.iter().map(|(_, m, t)| m * t).sum()
}

fn mode([r, z]: [f64; 2]) -> f64 {
    j0(FLAT * r) * (PI * z).cos()
}

/// The amplitude of the mode after `end` over the exact one, less 1; the change of the heat content.
fn insulated(script: &Script, n: usize, end: f64) -> [f64; 2] {
    let mut played = script.play(&[("n", n as f64), ("end", 0.0)]);
    let simulation = &mut played.session.simulation;
    let places: Vec<_> = simulation.world.particles.position.iter().map(|x| [x[0], x[1]]).collect();
    let temperature = simulation.world.particles.column_mut(Column::Temperature);
    for (t, place) in temperature.iter_mut().zip(places) {
        *t = 3.0 + mode(place);
    }
    let before = content(&states(&played));
    played.session.simulation.run(karamelo::simulation::Until::Time(end)).unwrap();
    let states = states(&played);
    let (mut sum, mut norm) = (0.0, 0.0);
    for (place, m, t) in &states {
        sum += m * mode(*place) * (t - 3.0);
        norm += m * mode(*place).powi(2);
    }
    let decay = (-(FLAT * FLAT + PI * PI) * end).exp();
    [sum / norm / decay - 1.0, content(&states) / before - 1.0]
}

#[test]
fn an_insulated_cylinder_keeps_its_heat_and_loses_its_differences() {
    let end = 0.04;
    let square = FLAT * FLAT + PI * PI;
    let errors_of = |script: &Script| [8, 16, 32].map(|n| insulated(script, n, end));
    for method in METHODS {
        let found = errors_of(&with(INSULATED, method));
        let errors = found.map(|[error, _]| error.abs());
        let order = (errors[1] / errors[2]).log2();
        println!("{method:?}: errors {errors:?}, order {order:.2}");
        assert!((order - 2.0).abs() < 0.2, "order {order:.2}");
        // Hats and splines spread the mode: its rate errs by less than (k^2 + pi^2) h^2 of itself, and
        // (k^2 + pi^2) t = 1.
        assert!(errors[2] < square / 1024.0, "{errors:?}");
        // Round-off of some thousand sums.
        assert!(found.iter().all(|[_, heat]| heat.abs() < 1e-12), "{found:?}");
    }
    // Without the factor r in masses and volumes J0 is no mode.
    let errors = errors_of(&flat(with(INSULATED, METHODS[0]))).map(|[error, _]| error.abs());
    println!("without r: errors {errors:?}");
    assert!(errors[2] > square / 1024.0 && (errors[1] / errors[2]).log2() < 1.0, "{errors:?}");
}

/// The first zeros of J0, by Newton's method from McMahon's expansion.
fn zeros(count: usize) -> Vec<f64> {
    let zero = |n: usize| {
        let b = (n as f64 + 0.75) * PI;
        let mut k = b + 0.125 / b;
        for _ in 0..20 {
            k += j0(k) / j1(k);
        }
        k
    };
    (0..count).map(zero).collect()
}

/// T = sum 2/(k J1(k)) J0(k r) exp(-k^2 t) over the zeros of J0.
fn series(zeros: &[f64], r: f64, time: f64) -> f64 {
    zeros.iter().map(|k| 2.0 / (k * j1(*k)) * j0(k * r) * (-k * k * time).exp()).sum()
}

#[test]
fn the_series_starts_at_one_and_knows_the_first_zeros() {
    let zeros = zeros(40);
    // Abramowitz and Stegun, table 9.5.
    for (k, known) in zeros.iter().zip([2.404825557695773, 5.520078110286311, 8.653727912911012]) {
        assert!((k - known).abs() < 1e-12);
    }
    assert!((series(&zeros, 0.3, 3e-3) - 1.0).abs() < 1e-12);
}

/// Mean of T about a radius, weighted with hats of width h, less that of the series, over the
/// temperature of the axis; largest of 0 <= r <= 0.7.
fn interior_error(played: &Played, n: usize, exact: &dyn Fn(f64) -> f64) -> f64 {
    let h = 1.0 / n as f64;
    let states = states(played);
    let error = |node: usize| {
        let (mut sum, mut weights) = (0.0, 0.0);
        for ([r, _], m, t) in &states {
            let weight = m * (1.0 - (r - node as f64 * h).abs() / h).max(0.0);
            (sum, weights) = (sum + weight * (t - exact(*r)), weights + weight);
        }
        (sum / weights).abs()
    };
    (0..=n * 7 / 10).map(error).fold(0.0, f64::max) / exact(0.0)
}

#[test]
fn a_cylinder_whose_rim_is_held_cools_as_the_series_of_bessel() {
    let zeros = zeros(40);
    let run = |script: &Script, time: f64| {
        [10, 20, 40].map(|n| {
            let played = script.play(&[("n", n as f64), ("end", time)]);
            interior_error(&played, n, &|r| series(&zeros, r, time))
        })
    };
    for method in METHODS {
        let script = with(HELD, method);
        for time in [0.05, 0.1, 0.3] {
            let errors = run(&script, time);
            let order = (errors[1] / errors[2]).log2();
            println!("{method:?} t = {time}: errors {errors:?}, order {order:.2}");
            // As in the bar: splines lose the error next to the rim faster than order 2.
            assert!(order > 1.8, "order {order:.2}");
            // The rate of the first mode errs by less than (k h)^2 of itself, the place of the rim by
            // as much.
            let square = zeros[0].powi(2);
            let bound = square / 1600.0 * (square * time).max(1.0);
            assert!(errors[2] < bound, "{errors:?} {bound}");
        }
    }
    let errors = run(&flat(with(HELD, METHODS[0])), 0.1);
    println!("without r: errors {errors:?}");
    assert!(errors[2] > 0.1, "{errors:?}");
}

#[test]
fn what_the_rim_takes_is_what_the_cylinder_loses() {
    for method in METHODS {
        let played = with(HELD, method).play(&[("n", 20.0), ("end", 0.1)]);
        let taken = *played.column("cold_x").last().unwrap();
        // A radian of the cylinder: half of radius^2, four cells high.
        let lost = 0.5 * 0.2 - content(&states(&played));
        println!("{method:?}: the rim takes {taken}, the cylinder loses {lost}");
        // Some thousand steps of sums of some ten terms.
        assert!((taken + lost).abs() < 1e-12 && lost > 0.05);
    }
}
