//! Rows 6 to 11 of the hard cases: large strains and turns, locking.

use super::play::{Played, play};
use super::table::{HATS, Row, STEP, Verdict, judge};
use super::ways::{SCHEMES, SHAPES, Way, all, way};
use karamelo::model::column::Column;

/// Those of all ways that have one of these transfers.
fn with(transfers: &[&str]) -> Vec<Way> {
    all().into_iter().filter(|way| transfers.contains(&way.transfer)).collect()
}

fn smallest(list: &[f64]) -> f64 {
    list.iter().copied().fold(f64::INFINITY, f64::min)
}

fn mean(list: &[f64]) -> f64 {
    list.iter().sum::<f64>() / list.len() as f64
}

/// A block whose nodes press it to a tenth of its height 1 - t.
fn crush_script(way: &Way, step: &str) -> String {
    format!("h = 0.1\n{}dimension(2, 0, 1, 0, 1.2, h)\n", way.lines())
        + "region(body, block, 0, 1, 0, 1)\nregion(everywhere, block, INF, INF, INF, INF)\n\
           material(m, neo-hookean, 1, 100, 0.3)\nsolid(s, region, body, 2, m, h)\n\
           group(nodes, nodes, region, everywhere, all)\n\
           fix(v, initial_velocity_particles, all, 0, -y0)\n\
           fix(press, velocity_nodes, nodes, 0, -y/(1 - time))\n\
           log_modify(custom, step, dt, time)\nset_output(100)\n"
        + step
        + "run_time(0.9)\n"
}

fn crushed(played: &Played) -> Result<String, String> {
    let volumes = played.particles(Column::J);
    let (least, mean) = (smallest(&volumes), mean(&volumes));
    let text = format!("J at least {least:.3}, {mean:.3} on average");
    if least > 0.0 && (0.07..0.13).contains(&mean) { Ok(text) } else { Err(text) }
}

fn crush(way: &Way) -> Verdict {
    judge(&[], &play(&crush_script(way, "")), crushed)
}

/// A block meets a wall at nine tenths of the speed of its waves.
fn slam(way: &Way) -> Verdict {
    let text = format!("h = 0.1\n{}dimension(2, 0, 3, 0, 2, h)\n", way.lines())
        + "region(body, block, 1.2, 1.8, 0.4, 1)\nregion(ground, block, INF, INF, INF, 0.1)\n\
           material(m, neo-hookean, 1, 100, 0.3)\nsolid(s, region, body, 2, m, h)\n\
           group(floor, nodes, region, ground)\nfix(stop, velocity_nodes, floor, NULL, 0)\n\
           fix(v, initial_velocity_particles, all, 0, -0.9*11.6)\n\
           compute(Ek, kinetic_energy, all)\ncompute(Es, strain_energy, all)\nE = Ek + Es\n\
           log_modify(custom, step, dt, time, E)\ndt_factor(0.08)\nset_output(1)\nrun_time(0.08)\n";
    judge(&[HATS], &play(&text), |played| {
        let (least, growth) = (smallest(&played.particles(Column::J)), played.growth("E"));
        let text = format!("J at least {least:.3}, E/E0 {growth:.3}");
        if least > 0.0 && growth < 1.02 { Ok(text) } else { Err(text) }
    })
}

/// Row 6: both; the first one that does not pass.
fn inverting(way: &Way) -> Verdict {
    match (crush(way), if way.is_updated() { slam(way) } else { Verdict::Pass(String::new()) }) {
        (Verdict::Pass(crush), Verdict::Pass(slam)) => Verdict::Pass(format!("{crush}; {slam}")),
        (Verdict::Pass(_), other) | (other, _) => other,
    }
}

/// Row 7. A soft bar flies apart to four times its length; sigma = G (l - 1/l) in its middle, which no
/// wave from its ends reaches.
fn pull(way: &Way) -> Verdict {
    let text = format!("h = 0.1\n{}dimension(2, 0, 6, 0, 1, h)\n", way.lines())
        + "region(bar, block, 2.5, 3.5, 0.4, 0.6)\nregion(middle, block, 2.8, 3.2, INF, INF)\n\
           material(m, neo-hookean, 1, 0.01, 0)\nsolid(s, region, bar, 2, m, h)\n\
           group(middle, particles, region, middle, solid, s)\n\
           fix(go, initial_velocity_particles, all, x0 - 3, 0)\n\
           compute(stress, average_stress, middle)\nratio = stress_11/(0.005*(4 - 1/4))\n\
           log_modify(custom, step, dt, time, ratio)\nset_output(20)\nrun_time(3)\n";
    judge(&["numerical fracture"], &play(&text), |played| {
        let [_, ratio] = played.ends("ratio");
        let text = format!("mean stress {ratio:.3} of the exact one");
        if (ratio - 1.0).abs() < 0.1 { Ok(text) } else { Err(text) }
    })
}

/// Row 8. A soft disk next to two walls is sheared by its own motion to several times its height.
fn needles(way: &Way) -> Verdict {
    let text = format!("h = 0.1\n{}dimension(2, 0, 4, 0, 1, h)\n", way.lines())
        + "region(disk, sphere, 2, 0.5, 0.42)\nmaterial(m, neo-hookean, 1, 0.5, 0.3)\n\
           solid(s, region, disk, 2, m, h)\n\
           region(low, block, INF, INF, INF, h/4)\nregion(high, block, INF, INF, 1 - h/4, INF)\n\
           group(low, nodes, region, low)\ngroup(high, nodes, region, high)\n\
           fix(low, velocity_nodes, low, NULL, 0)\nfix(high, velocity_nodes, high, NULL, 0)\n\
           fix(v, initial_velocity_particles, all, 6*(y0 - 0.5), 0)\n\
           compute(Ek, kinetic_energy, all)\ncompute(Es, strain_energy, all)\nE = Ek + Es\n\
           log_modify(custom, step, dt, time, E)\ndt_factor(0.3)\nset_output(5)\nrun_time(1)\n";
    judge(&[], &play(&text), |played| {
        let shear = played.particles(Column::F12).iter().fold(0.0f64, |most, f| most.max(f.abs()));
        let growth = played.growth("E");
        let text = format!("shear {shear:.1}, E/E0 {growth:.3}");
        // PIC damps the motion before it has sheared the disk as far as the others.
        let least = if way.kind() == "PIC" { 0.5 } else { 1.0 };
        if growth <= 1.05 && shear > least { Ok(text) } else { Err(text) }
    })
}

/// Row 9. A prestressed disk is turned by a right angle; 1000 steps stretch it by 0.1 %.
fn turned_script(way: &Way, rate: &str) -> String {
    format!("h = 0.1\n{}{rate}dimension(2, 0, 2, 0, 2, h)\n", way.lines())
        + "region(disk, sphere, 1, 1, 0.4)\nregion(everywhere, block, INF, INF, INF, INF)\n\
           material(m, linear, 1, 1e-4, 0.3)\nsolid(s, region, disk, 2, m, h)\n\
           group(nodes, nodes, region, everywhere, all)\n\
           fix(pre, initial_stress, all, 1, 0, 0, 0, 0, 0)\n\
           fix(turn, velocity_nodes, nodes, -PI/2*(y - 1), PI/2*(x - 1))\n\
           fix(start, initial_velocity_particles, all, -PI/2*(y0 - 1), PI/2*(x0 - 1))\n\
           compute(stress, average_stress, all)\ndifference = stress_22 - stress_11\n\
           log_modify(custom, step, dt, time, difference)\nset_dt(0.001)\nset_output(50)\nrun_time(1)\n"
}

fn turned(way: &Way, rate: &str) -> Verdict {
    judge(&[], &play(&turned_script(way, rate)), |played| {
        let [_, last] = played.ends("difference");
        let text = format!("s22 - s11 {last:.4} of 1");
        if (last - 1.0).abs() < 0.01 { Ok(text) } else { Err(text) }
    })
}

/// With each objective rate, the one of total Lagrangian methods being their own.
fn objective(way: &Way) -> Verdict {
    if !way.is_updated() {
        return turned(way, "");
    }
    let rates = ["jaumann", "green_naghdi", "logarithmic"];
    let each = rates.map(|rate| turned(way, &format!("stress_rate({rate})\n")));
    each.into_iter().max_by_key(|verdict| verdict.word() != "pass").expect("three rates")
}

/// Row 10. What a turning bar loses in half a turn with steps of a size.
fn lost(way: &Way, dt: f64) -> Result<f64, Verdict> {
    let text = format!("h = 0.1\n{}dimension(2, 0, 2, 0, 2, h)\n", way.lines())
        + "region(bar, block, 0.5, 1.5, 0.85, 1.15)\nmaterial(m, linear, 1, 1e-6, 0.3)\n\
           solid(s, region, bar, 2, m, h)\n\
           fix(v, initial_velocity_particles, all, -(y0 - 1), x0 - 1)\n\
           compute(Ek, kinetic_energy, all)\nlog_modify(custom, step, dt, time, Ek)\n"
        + &format!("set_dt({dt})\nset_output(10)\nrun_time(0.5)\n");
    let played = play(&text);
    match judge(&[], &played, |_| Ok(String::new())) {
        Verdict::Pass(_) => {
            let [first, last] = played.ends("Ek");
            Ok(1.0 - last / first)
        }
        other => Err(other),
    }
}

fn damping(way: &Way) -> Verdict {
    match (lost(way, 0.01), lost(way, 0.005)) {
        (Ok(coarse), Ok(fine)) => {
            let text = format!("loses {coarse:.4}, with half the step {fine:.4}");
            // A transfer that loses nothing to speak of has nothing that could depend on dt.
            if (fine - coarse).abs() < f64::max(0.05 * coarse, 2e-3) {
                Verdict::Pass(text)
            } else {
                Verdict::Fail(text)
            }
        }
        (Err(other), _) | (_, Err(other)) => other,
    }
}

/// Row 11. A nearly incompressible cantilever; twice the static tip of beam theory.
fn beam(way: &Way, anti_locking: &str) -> Verdict {
    let text = format!("h = 0.25\n{}{anti_locking}dimension(2, 0, 5, -1, 1, h)\n", way.lines())
        + "region(beam, block, 0, 4, -0.5, 0.5)\nregion(root, block, -1, h/10, -1, 1)\n\
           region(end, block, 4 - h, 4, -0.5, 0.5)\nmaterial(rubber, linear, 1000, 1e6, 0.4999)\n\
           solid(bar, region, beam, 2, rubber, h)\ngroup(wall, nodes, region, root, all)\n\
           group(tip, particles, region, end, solid, bar)\nfix(hold, velocity_nodes, wall, 0, 0)\n\
           fix(gravity, body_force, all, 0, -0.01)\ntip = xcm(tip, y)\n\
           log_modify(custom, step, dt, time, tip)\nset_output(200)\nrun_time(1.8)\n";
    judge(&["hardly unlocks"], &play(&text), |played| {
        let lowest = smallest(&played.column("tip"));
        let modulus = 1e6 / (1.0 - 0.4999f64.powi(2));
        let theory = -2.0 * 12.0 * 1000.0 * 0.01 * 4f64.powi(4) / (8.0 * modulus);
        let text = format!("tip at {:.3} of beam theory", lowest / theory);
        if (lowest / theory - 1.0).abs() < 0.15 { Ok(text) } else { Err(text) }
    })
}

/// Rows 6 to 11.
pub const ROWS: &[Row] = &[
    Row {
        number: 6,
        mode: "det F <= 0",
        criterion: "crushed to a tenth of the height, and against a wall at 0.9 c: J > 0, energy grows by 2 % at most",
        ways: || with(&["FLIP 1", "APIC", "PIC"]),
        run: inverting,
        quick: &[
            ("ulmpm", "quadratic-spline", "APIC", "musl"),
            ("tlmpm", "linear", "FLIP 1", "musl"),
        ],
        without: Some(("`set_dt(0.13)`", || {
            let way = way("ulmpm", "quadratic-spline", "FLIP 1", "musl");
            judge(&[STEP], &play(&crush_script(&way, "set_dt(0.13)\n")), crushed)
        })),
    },
    Row {
        number: 7,
        mode: "numerical fracture",
        criterion: "apart to four times the length: mean stress within 10 %",
        ways: || with(&["FLIP 1"]),
        run: pull,
        quick: &[("tlmpm", "linear", "FLIP 1", "musl"), ("ulcpdi", "R4", "FLIP 1", "musl")],
        without: Some(("`ulmpm` with hats", || pull(&way("ulmpm", "linear", "FLIP 1", "musl")))),
    },
    Row {
        number: 8,
        mode: "domains of CPDI",
        criterion: "sheared by more than 1 (PIC: 0.5) beside walls: ends, energy grows by 5 % at most",
        ways: || {
            let domains = |way: &Way| way.has_domains() || way.shape == "cpgimp";
            with(&["FLIP 1", "PIC", "APIC", "XPIC 2"]).into_iter().filter(domains).collect()
        },
        run: needles,
        quick: &[("ulcpdi", "R4", "FLIP 1", "musl"), ("ulcpdi", "Q4", "FLIP 1", "musl")],
        without: None,
    },
    Row {
        number: 9,
        mode: "large rotation",
        criterion: "prestress turned by 90 degrees, each rate: s22 - s11 within 1 %",
        ways: || with(&["FLIP 1", "APIC", "MLS"]),
        run: objective,
        quick: &[
            ("ulmpm", "quadratic-spline", "FLIP 1", "musl"),
            ("tlmpm", "linear", "FLIP 1", "musl"),
        ],
        without: Some(("`stress_rate(none)`", || {
            turned(&way("ulmpm", "quadratic-spline", "FLIP 1", "musl"), "stress_rate(none)\n")
        })),
    },
    Row {
        number: 10,
        mode: "damping by alpha depends on dt",
        criterion: "loss of a turning bar the same within 5 % (or 0.002 of its energy) for half the step",
        ways: || {
            let transfers = [
                "FLIP time-constant, 0.5",
                "AFLIP time-constant, 0.5",
                "ASFLIP time-constant, 0.5",
            ];
            let each = |(method, shape)| {
                transfers.map(|transfer| SCHEMES.map(|scheme| way(method, shape, transfer, scheme)))
            };
            SHAPES.into_iter().flat_map(each).flatten().collect()
        },
        run: damping,
        quick: &[("ulmpm", "cubic-spline", "FLIP time-constant, 0.5", "musl")],
        without: Some(("alpha = 0.99", || {
            damping(&way("ulmpm", "cubic-spline", "FLIP 0.99", "musl"))
        })),
    },
    Row {
        number: 11,
        mode: "volumetric locking",
        criterion: "tip of a beam with nu = 0.4999 within 15 % of beam theory",
        ways: || with(&["FLIP 1"]),
        run: |way| beam(way, "anti_locking(fbar)\n"),
        quick: &[("tlmpm", "linear", "FLIP 1", "musl")],
        without: Some(("`anti_locking(none)`", || {
            beam(&way("tlmpm", "linear", "FLIP 1", "musl"), "anti_locking(none)\n")
        })),
    },
];
