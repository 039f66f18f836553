//! V18: two elastic cylinders pressed together, against Hertz.

use super::script::{Played, Script};
use karamelo::world::World;

const RADIUS: f64 = 8.0;
const YOUNG: f64 = 200.0;
const POISSON: f64 = 0.3;

/// 1/E* of two equal cylinders in plane strain is 2 (1 - nu^2)/E.
const MODULUS: f64 = YOUNG / (2.0 * (1.0 - POISSON * POISSON));

/// Half width under a load of 10.
const HALF_WIDTH: f64 = 0.680778374;

/// Half width and peak pressure of Hertz, with R* = R/2: a^2 = 4 P R*/(pi E*), p0 = 2 P/(pi a).
fn hertz(load: f64) -> [f64; 2] {
    let a = (4.0 * load * 0.5 * RADIUS / (std::f64::consts::PI * MODULUS)).sqrt();
    [a, 2.0 * load / (std::f64::consts::PI * a)]
}

/// Cell size with about so many cells to a half width under a load of 10.
fn cell(cells: u32) -> f64 {
    RADIUS / (RADIUS * f64::from(cells) / HALF_WIDTH).round()
}

/// The right halves of two half cylinders, pressed together by twice the `depth` and damped until they
/// rest. Particles lie on rings, so that the faces are round, and none on the plane x = 0.
///
/// APIC, because damping of nodes does not reach what nodes cannot see: FLIP with alpha = 1 keeps the
/// stress of the first touch in single particles at the axis (45 % too much there, 10 % too little around).
fn cylinders(cells: u32, contact: &str, depth: f64) -> Script {
    let text = format!(
        "R = {RADIUS}
h = {}
T = 3
method(ulmpm, APIC, quadratic-spline)
dimension(2, 0, R + 2*h, -R - h, R + h, h)
region(low, block, 0, INF, -R, 0)
region(high, block, 0, INF, 0, R)
material(m, linear, 1, {YOUNG}, {POISSON})
solid(s1, region, low, 1, m, h)
solid(s2, region, high, 1, m, h)
rings = ceil(2*R/h)
spokes = 4*ceil(PI*R/h) + 2
populate_cylindrical_coordinates(s1, low, 0, -R, R, rings, spokes, 0)
populate_cylindrical_coordinates(s2, high, 0, R, R, rings, spokes, 0)
contact(c, {contact})
region(axis, block, INF, h/4, INF, INF)
region(bottom, block, INF, INF, INF, -R + h/4)
region(top, block, INF, INF, R - h/4, INF)
group(axis, nodes, region, axis)
group(bottom, nodes, region, bottom)
group(top, nodes, region, top)
fix(slow, damping_nodes, all, 5)
fix(mirror, velocity_nodes, axis, 0, NULL)
speed = if(time < T, {depth}/T, 0)
fix(up, velocity_nodes, bottom, NULL, speed)
fix(down, velocity_nodes, top, NULL, -speed)
log_modify(custom, time, c_x, c_y, up_y, down_y)
set_output(1)
dt_factor(0.5)
run_time(2*T)
",
        cell(cells)
    );
    Script::new("cylinders", &text)
}

/// p0 and a of p^2 = p0^2 (1 - x^2/a^2), fitted to the pressure of the particles next to the surface
/// of the lower body within 0.8 of the width `a`.
fn fit(world: &World, a: f64, cell: f64) -> [f64; 2] {
    let (mut n, mut sx, mut sy, mut sxx, mut sxy) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for p in 0..world.particles.len() {
        let [x, y, _] = world.place(p);
        if world.particles.solid[p] != 0 || x > 0.8 * a || y < -0.02 * RADIUS {
            continue;
        }
        let [x0, y0, _] = world.particles.reference_place(p);
        let depth = RADIUS - (x0 * x0 + (y0 + RADIUS).powi(2)).sqrt();
        if depth > 0.75 * cell {
            continue;
        }
        let pressure = -world.stress(p)[(1, 1)];
        let (s, t) = (x * x, pressure * pressure);
        (n, sx, sy, sxx, sxy) = (n + 1.0, sx + s, sy + t, sxx + s * s, sxy + s * t);
    }
    let slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
    let level = (sy - slope * sx) / n;
    [level.max(0.0).sqrt(), (-level / slope).max(0.0).sqrt()]
}

/// Load of both halves at the end, and what it gives: peak pressure and half width over Hertz's, and
/// how many cells the half width is off.
fn compare(played: &Played, cells: u32) -> [f64; 4] {
    played.end.as_ref().expect("the run is stable");
    let column = |name: &str| played.column(name);
    let [up, down, pushed] = ["up_y", "down_y", "c_y"].map(column);
    // Both bodies are the mirror images of each other, to the round-off of 1e4 particles' forces.
    let load = 2.0 * pushed[pushed.len() - 1].abs();
    let largest = up.iter().fold(0.0f64, |a, b| a.max(b.abs()));
    for (up, down) in up.iter().zip(&down) {
        assert!((up + down).abs() < 1e-9 * largest, "{up} {down}");
    }
    // No tension: the force on the lower body never points up.
    assert!(pushed.iter().all(|force| *force <= 1e-12 * load));
    let [a, peak] = hertz(load);
    let [found, width] = fit(&played.session.simulation.world, a, cell(cells));
    [load, found / peak, width / a, (width - a).abs() / cell(cells)]
}

#[test]
fn the_formulas_are_those_of_the_list() {
    for (load, a, peak) in [(10.0, HALF_WIDTH, 9.35135129), (1.0, 0.215281024, 2.95715693)] {
        let [found, pressure] = hertz(load);
        assert!((found / a - 1.0).abs() < 1e-8 && (pressure / peak - 1.0).abs() < 1e-8);
    }
    assert!((MODULUS - 109.890110).abs() < 1e-6);
}

#[test]
fn cylinders_on_a_coarse_grid_touch_as_hertz_says() {
    let played = cylinders(4, "slip, s1, s2", 0.097).play(&[]);
    let [load, peak, width, cells] = compare(&played, 4);
    println!("load {load:.3}: peak {peak:.3}, width {width:.3} of Hertz, {cells:.2} cells off");
    // V18 asks for this with h = a/8.
    assert!((peak - 1.0).abs() < 0.05 && cells < 1.0, "{peak} {cells}");
}

#[test]
#[ignore = "minutes: two half cylinders at rest on a fine grid"]
fn cylinders_touch_as_hertz_says() {
    for contact in ["slip, s1, s2", "slip, s1, s2, on_nodes"] {
        let light = compare(&cylinders(8, contact, 0.013).play(&[]), 8);
        let heavy = compare(&cylinders(8, contact, 0.097).play(&[]), 8);
        for [load, peak, width, cells] in [light, heavy] {
            println!(
                "{contact}: load {load:.3}, peak {peak:.3}, width {width:.3}, {cells:.2} cells"
            );
        }
        let [_, peak, _, cells] = heavy;
        let good = (peak - 1.0).abs() < 0.05 && cells < 1.0;
        // V18; the form that acts a cell early must be seen to fail.
        assert_eq!(good, contact == "slip, s1, s2", "{contact}: {heavy:?}");
        if good {
            // p0 grows as the root of the load: both peaks are off Hertz's by the same part.
            assert!((heavy[1] / light[1] - 1.0).abs() < 0.05, "{light:?} {heavy:?}");
        }
    }
}
