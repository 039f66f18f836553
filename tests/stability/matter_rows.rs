//! Rows 12 to 17 of the hard cases: fluids, shocks, yield, damage, heat.

use super::play::{Played, play};
use super::table::{HATS, Row, STEP, Verdict, judge};
use super::ways::{Way, all, way};
use karamelo::model::column::Column;

fn with(transfers: &[&str]) -> Vec<Way> {
    all().into_iter().filter(|way| transfers.contains(&way.transfer)).collect()
}

/// Updated Lagrangian ways: the matter flows.
fn flowing(transfers: &[&str]) -> Vec<Way> {
    with(transfers).into_iter().filter(|way| way.is_updated()).collect()
}

/// Row 12. Water breaks out of a column in a tank with walls that slip.
fn dam(way: &Way) -> Verdict {
    let text = format!("h = 0.05\n{}dimension(2, 0, 1.2, 0, 1, h)\n", way.lines())
        + "eos(pressure, fluid, 1000, 57143*7, 7)\nstrength(viscous, fluid, 0.5)\n\
           material(water, eos-strength, pressure, viscous)\n\
           region(column, block, 0, 0.4, 0, 0.6)\nsolid(water, region, column, 2, water, h)\n\
           region(left, block, INF, h/4, INF, INF)\nregion(right, block, 1.2 - h/4, INF, INF, INF)\n\
           region(floor, block, INF, INF, INF, h/4)\nregion(top, block, INF, INF, 1 - h/4, INF)\n\
           group(left, nodes, region, left)\ngroup(right, nodes, region, right)\n\
           group(floor, nodes, region, floor)\ngroup(top, nodes, region, top)\n\
           fix(left, velocity_nodes, left, 0, NULL)\nfix(right, velocity_nodes, right, 0, NULL)\n\
           fix(floor, velocity_nodes, floor, NULL, 0)\nfix(top, velocity_nodes, top, NULL, 0)\n\
           fix(gravity, body_force, all, 0, -9.81)\ncompute(Ek, kinetic_energy, all)\n\
           E = Ek + 240*9.81*xcm(all, y)\nlog_modify(custom, step, dt, time, E)\n\
           set_output(10)\nrun_time(1)\n";
    judge(&[HATS, "`usl` strained the fluid"], &play(&text), |played| {
        let text = format!("E/E0 {:.4}", played.growth("E"));
        if played.growth("E") <= 1.02 { Ok(text) } else { Err(text) }
    })
}

/// Row 13. A plate of copper flies against a wall at 500 m/s: p = rho (c0 + S u) u behind the shock.
fn shock_script(way: &Way, speed: f64, viscosity: &str, end: f64) -> String {
    format!("h = 1e-4\n{}dimension(2, 0, 0.012, 0, 4e-4, h)\n", way.lines())
        + "K = 8960*3940^2\n"
        + &format!("eos(p, shock, 8960, K, 3940, 1.489, 0, 0, 0, {viscosity})\n")
        + "strength(s, fluid, 0)\nmaterial(copper, eos-strength, p, s)\n\
           region(plate, block, 0, 0.01, 0, 4e-4)\nregion(wall, block, INF, h/4, INF, INF)\n\
           region(everywhere, block, INF, INF, INF, INF)\nsolid(plate, region, plate, 2, copper, h)\n\
           group(wall, nodes, region, wall, all)\ngroup(nodes, nodes, region, everywhere, all)\n\
           fix(flat, velocity_nodes, nodes, NULL, 0)\nfix(wall, velocity_nodes, wall, 0, NULL)\n"
        + &format!("fix(v, initial_velocity_particles, all, -{speed}, 0)\ndt_factor(0.4)\n")
        + &format!("log_modify(custom, step, dt, time)\nset_output(100)\nrun_time({end})\n")
}

/// Mean and scatter of the pressure between the wall and the front.
fn plateau(played: &Played) -> Result<String, String> {
    let (speed, end) = (500.0, 1e-6);
    let front = 3940.0 + 1.489 * speed;
    let exact = 8960.0 * front * speed;
    let far = (front - speed) * end;
    let places = played.places();
    let stress = played.particles(Column::S11);
    let behind: Vec<f64> = places
        .iter()
        .zip(&stress)
        .filter(|(x, _)| (0.2..0.8).contains(&(x[0] / far)))
        .map(|(_, stress)| -stress / exact)
        .collect();
    let count = behind.len() as f64;
    let mean = behind.iter().sum::<f64>() / count;
    let scatter = (behind.iter().map(|p| (p - mean).powi(2)).sum::<f64>() / count).sqrt();
    let text = format!("pressure {mean:.4} of Hugoniot's, scatter {scatter:.3}");
    if (mean - 1.0).abs() < 0.05 && scatter < 0.1 { Ok(text) } else { Err(text) }
}

fn shock(way: &Way) -> Verdict {
    judge(&[HATS], &play(&shock_script(way, 500.0, "2, 0.2", 1e-6)), plateau)
}

/// Row 14. The same at four times the speed of sound: behind a steady shock is 2.33 times the density, which
/// stays below the pole S/(S - 1) = 3.04 times; behind the first cells, which overshoot, it may not. Then the
/// warning has to count them.
fn pole(way: &Way) -> Verdict {
    let played = play(&shock_script(way, 4.0 * 3940.0, "0, 0", 8e-8));
    let counted = played.warnings.iter().any(|words| words.contains("98 % of the pole"));
    judge(&[], &played, |played| {
        let densest = 1.0 / played.particles(Column::J).into_iter().fold(f64::INFINITY, f64::min);
        let text = format!("{densest:.2} times the density, counted: {counted}");
        let known = counted || densest < 0.98 * 1.489 / 0.489;
        if densest > 0.0 && known { Ok(text) } else { Err(text) }
    })
}

const COPPER: &str = "G = 47.7e9\neos(p, linear, 8960, 1e11)\n\
    strength(flow, johnson_cook, G, 90e6, 292e6, 0.31, 1, 0.025, 1.09, 298, 1356)\n";

/// Row 15. A block hotter than its melting point flies unchanged; a turning one loses its shear stress.
fn molten(way: &Way) -> Verdict {
    let text = format!("h = 1e-3\n{}dimension(2, 0, 0.02, 0, 0.02, h)\n", way.lines())
        + COPPER
        + "temperature(heat, plastic_work, 0.9, 383, 0, 0, 298, 1356)\n\
           material(copper, eos-strength, p, flow, heat)\nregion(body, block, 4e-3, 8e-3, 4e-3, 8e-3)\n\
           solid(s, region, body, 2, copper, h, 1400)\n\
           fix(v, initial_velocity_particles, all, 100, 50)\ncompute(Ek, kinetic_energy, all)\n\
           log_modify(custom, step, dt, time, Ek)\nset_output(10)\nrun_time(4e-5)\n";
    judge(&[], &play(&text), |played| {
        let growth = (played.growth("Ek") - 1.0).abs();
        let off =
            played.particles(Column::J).iter().fold(0.0f64, |most, j| most.max((j - 1.0).abs()));
        let hot = played.particles(Column::Temperature).iter().fold(0.0f64, |most, t| most.max(*t));
        let text = format!("Ek off by {growth:.0e}, J by {off:.0e}, T {hot}");
        if growth < 1e-9 && off < 1e-9 && (hot - 1400.0).abs() < 1e-6 {
            Ok(text)
        } else {
            Err(text)
        }
    })
}

/// Row 16. A strip is torn apart: damage goes to 1 in the middle and the run goes on.
fn torn(way: &Way) -> Verdict {
    let text = format!("h = 1e-3\n{}dimension(2, 0, 0.03, 0, 0.01, h)\n", way.lines())
        + COPPER
        + "damage(failure, damage_johnson_cook, 0.1, 0, 0, 0, 0, 1, 298, 1356)\n\
           material(copper, eos-strength, p, flow, failure)\n\
           region(strip, block, 8e-3, 16e-3, 3e-3, 7e-3)\nregion(left, block, INF, 9e-3, INF, INF)\n\
           region(right, block, 15e-3, INF, INF, INF)\nsolid(s, region, strip, 2, copper, h)\n\
           group(left, particles, region, left, solid, s)\n\
           group(right, particles, region, right, solid, s)\n\
           fix(left, velocity_particles, left, -50, 0)\nfix(right, velocity_particles, right, 50, 0)\n\
           compute(Es, strain_energy, all)\nlog_modify(custom, step, dt, time, Es)\n\
           set_output(1)\nrun_time(6e-5)\n";
    judge(&[], &play(&text), |played| {
        let broken = played.particles(Column::Damage).iter().filter(|d| **d >= 1.0).count();
        let steps = played.column("dt");
        let least = steps[..steps.len() - 1].iter().fold(f64::INFINITY, |least, dt| least.min(*dt));
        let energy = played.column("Es").iter().fold(f64::INFINITY, |least, e| least.min(*e));
        let ratio = least / steps[0];
        let text =
            format!("{broken} failed, dt at least {ratio:.2} of the first, Es >= {energy:.0e}");
        if broken > 0 && ratio > 0.2 && energy >= 0.0 { Ok(text) } else { Err(text) }
    })
}

/// Row 17. A plate that is hot in its middle; no temperature may become larger than the first.
fn hot_script(way: &Way, step: &str) -> String {
    let lines = way.lines().replacen(")\n", ", thermo-mechanical)\n", 1);
    format!("h = 0.1\n{lines}thermal_blend(1)\ndimension(2, 0, 2, 0, 2, h)\n")
        + "region(body, block, 0.5, 1.5, 0.5, 1.5)\nregion(inside, block, 0.8, 1.2, 0.8, 1.2)\n\
           material(m, linear, 1, 1e-2, 0.3, 1, 0.5)\nsolid(s, region, body, 2, m, h, 0)\n\
           group(hot, particles, region, inside, solid, s)\n\
           fix(heat, temperature_particles, hot, 100)\nlog_modify(custom, step, dt, time)\n\
           set_dt(1e-9)\nrun(1)\ndelete_fix(heat)\n"
        + step
        + "set_output(10)\nrun(200)\n"
}

fn within(played: &Played) -> Result<String, String> {
    let all = played.particles(Column::Temperature);
    let low = all.iter().fold(f64::INFINITY, |a: f64, t| a.min(*t));
    let high = all.iter().fold(f64::NEG_INFINITY, |a: f64, t| a.max(*t));
    let text = format!("T from {low:.3} to {high:.3}");
    if low > -100.0 && high < 100.0 { Ok(text) } else { Err(text) }
}

fn hot(way: &Way) -> Verdict {
    judge(&[], &play(&hot_script(way, "set_dt(auto)\n")), within)
}

/// Rows 12 to 17.
pub const ROWS: &[Row] = &[
    Row {
        number: 12,
        mode: "weakly compressible fluids",
        criterion: "dam break in a tank, 1 s: kinetic and potential energy at most 1.02 of the start, nobody leaves",
        ways: || flowing(&["FLIP 1", "FLIP 0.99", "PIC", "APIC", "MLS"]),
        run: dam,
        quick: &[("ulmpm", "quadratic-spline", "FLIP 0.99", "musl")],
        without: None,
    },
    Row {
        number: 13,
        mode: "shocks",
        criterion: "plateau within 5 % of the Hugoniot, scatter below 10 %",
        ways: || with(&["FLIP 1", "PIC", "APIC", "MLS"]),
        run: shock,
        quick: &[("tlmpm", "linear", "FLIP 1", "musl")],
        without: Some(("Q1 = Q2 = 0", || {
            let way = way("tlmpm", "linear", "FLIP 1", "musl");
            judge(&[], &play(&shock_script(&way, 500.0, "0, 0", 1e-6)), plateau)
        })),
    },
    Row {
        number: 14,
        mode: "pole of the shock curve",
        criterion: "a plate at 4 c0 against a wall ends without NaN; particles beyond the pole are counted",
        ways: || with(&["FLIP 1", "APIC"]),
        run: pole,
        quick: &[("ulmpm", "quadratic-spline", "FLIP 1", "musl")],
        without: None,
    },
    Row {
        number: 15,
        mode: "edges of Johnson-Cook",
        criterion: "a molten block flies unchanged to 1e-9",
        ways: all,
        run: molten,
        quick: &[("ulmpm", "linear", "FLIP 1", "musl")],
        without: None,
    },
    Row {
        number: 16,
        mode: "damage near 1",
        criterion: "a strip is torn apart: no NaN, stored energy >= 0, dt at least a fifth of the first",
        ways: || with(&["FLIP 1", "PIC", "APIC"]),
        run: torn,
        quick: &[("ulmpm", "linear", "FLIP 1", "musl")],
        without: None,
    },
    Row {
        number: 17,
        mode: "heat conduction",
        criterion: "a hot core cools: no temperature, of either sign, above the largest at the start",
        ways: || with(&["FLIP 1", "PIC", "APIC"]),
        run: hot,
        quick: &[("ulmpm", "linear", "FLIP 1", "musl")],
        without: Some(("`set_dt` at twelve times the limit", || {
            let way = way("ulmpm", "linear", "FLIP 1", "musl");
            judge(&[STEP], &play(&hot_script(&way, "set_dt(0.06, force)\n")), within)
        })),
    },
];
