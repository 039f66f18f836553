//! Rows 1 to 5 of the hard cases: the grid, transfers, the time step.

use super::play::play;
use super::table::{HATS, Row, Verdict, judge};
use super::ways::{SCHEMES, Way, all, way};

/// What all two-dimensional scenes begin with: cells of 0.1 in a box of 2 x 2.
fn begin(way: &Way) -> String {
    format!("h = 0.1\n{}dimension(2, 0, 2, 0, 2, h)\n", way.lines())
}

/// The energy, logged so many steps apart.
const ENERGY: &str = "compute(Ek, kinetic_energy, all)\ncompute(Es, strain_energy, all)\n\
    E = Ek + Es\nlog_modify(custom, step, dt, time, Ek, E)\n";

/// The energy may grow by so much.
fn at_most(growth: f64, limit: f64) -> Result<String, String> {
    let text = format!("E/E0 {growth:.4}");
    if growth <= limit { Ok(text) } else { Err(text) }
}

/// Row 1. The outermost particles lie 1e-6 h beyond a line of nodes, which have nearly no mass.
fn near_empty(way: &Way) -> Verdict {
    let text = begin(way)
        + "region(body, block, 0.5, 1.2, 0.5, 1.2)\nmaterial(m, linear, 1, 100, 0.3)\n\
           solid(s, region, body, 2, m, h)\n\
           translate_particles(s, region, body, 0.25*h + 1e-6*h, 0.25*h + 1e-6*h)\n\
           fix(v, initial_velocity_particles, all, 0.01*(x0 - 0.85), 0.01*(y0 - 0.85))\n"
        + ENERGY
        + "set_output(3)\nrun_time(10)\n";
    judge(&[], &play(&text), |played| at_most(played.trend("E"), 1.05))
}

/// Row 2. A bar that swings along itself flies over twenty cells in five periods.
fn crossing(way: &Way) -> Verdict {
    let text = format!("h = 0.1\n{}dimension(2, 0, 5, 0, 1, h)\n", way.lines())
        + "region(bar, block, 0.5, 2.5, 0.4, 0.6)\nmaterial(m, linear, 1, 100, 0)\n\
           solid(s, region, bar, 2, m, h)\n\
           fix(v, initial_velocity_particles, all, 1 + 0.05*cos(PI*(x0 - 0.5)/2), 0)\n\
           compute(Ek, kinetic_energy, all)\ncompute(Es, strain_energy, all)\n\
           compute(v, average_velocity, all)\nswing = Ek + Es - 0.2*v_x^2\n\
           log_modify(custom, step, dt, time, swing)\nset_output(1)\nrun_time(2)\n";
    judge(&[HATS], &play(&text), |played| {
        let [first, last] = played.ends("swing");
        let text = format!("kept {:.3}", last / first);
        if (0.93..=1.05).contains(&(last / first)) { Ok(text) } else { Err(text) }
    })
}

/// Row 3. Neighbours move against each other, which the grid hardly sees.
fn checkerboard(way: &Way) -> Verdict {
    let text = begin(way)
        + "region(body, block, 0.8, 1.2, 0.8, 1.2)\nmaterial(m, linear, 1, 100, 0.3)\n\
           solid(s, region, body, 2, m, h)\n\
           side = 0.01*cos(PI*(x0/(h/2) - 0.5))*cos(PI*(y0/(h/2) - 0.5))\n\
           fix(v, initial_velocity_particles, all, side, -side)\n"
        + ENERGY
        + "set_output(7)\nrun(5000)\n";
    judge(&[], &play(&text), |played| {
        let [first, last] = played.ends("E");
        let growth = played.trend("E");
        at_most(growth, 1.05)
            .map(|_| format!("E/E0 at most {growth:.3}, in the end {:.3}", last / first))
    })
}

/// The remedy of row 3 takes the noise away: what is left of it.
fn noise_left(way: &Way) -> f64 {
    let text = begin(way)
        + "region(body, block, 0.8, 1.2, 0.8, 1.2)\nmaterial(m, linear, 1, 100, 0.3)\n\
           solid(s, region, body, 2, m, h)\n\
           side = 0.01*cos(PI*(x0/(h/2) - 0.5))*cos(PI*(y0/(h/2) - 0.5))\n\
           fix(v, initial_velocity_particles, all, side, -side)\n"
        + ENERGY
        + "set_output(100)\nrun(500)\n";
    let [first, last] = play(&text).ends("E");
    last / first
}

/// Row 4. A disk flies, bounces off a wall and flies on.
fn bounce(way: &Way) -> Verdict {
    let text = begin(way)
        + "region(disk, sphere, 1, 0.75, 0.3)\nregion(ground, block, INF, INF, INF, 0.1)\n\
           material(m, neo-hookean, 1, 100, 0.3)\nsolid(s, region, disk, 2, m, h)\n\
           group(floor, nodes, region, ground)\nfix(stop, velocity_nodes, floor, NULL, 0)\n\
           fix(v, initial_velocity_particles, all, 0, -0.5)\n"
        + ENERGY
        + "dt_factor(0.3)\nset_output(1)\nrun_time(1.4)\n";
    judge(&[], &play(&text), |played| {
        // The ground is felt one cell and the reach of a shape away: not in the first steps.
        let flight = &played.column("E")[..3];
        let lost = flight.iter().fold(0.0f64, |most, e| most.max((e / flight[0] - 1.0).abs()));
        if lost > 1e-10 {
            return Err(format!("free flight is off by {lost:.1e}"));
        }
        at_most(played.growth("E"), 1.02)
    })
}

/// The same where the strain follows from an affine field that is a step too old: of a body that
/// turns and stretches, no switch of the program makes it so.
fn affine(way: &Way) -> bool {
    way.is_affine() && way.is_updated()
}

/// Row 5. A total Lagrangian disk turns once; a step from |Re eig F| = |cos theta| would come to rest.
fn turning(way: &Way) -> Verdict {
    let text = begin(way)
        + "region(disk, sphere, 1, 1, 0.3)\nmaterial(m, neo-hookean, 1, 1e4, 0.3)\n\
           solid(s, region, disk, 2, m, h)\n\
           fix(v, initial_velocity_particles, all, -2*PI*(y0 - 1), 2*PI*(x0 - 1))\n"
        + ENERGY
        + "set_output(1)\nrun_time(1)\n";
    judge(&[], &play(&text), |played| {
        let nominal = 1.0 / played.column("dt")[0];
        let ratio = played.steps() as f64 / nominal;
        let text = format!("{ratio:.3} of the nominal steps");
        if ratio < 1.1 { Ok(text) } else { Err(text) }
    })
}

/// Rows 1 to 5.
pub const ROWS: &[Row] = &[
    Row {
        number: 1,
        mode: "near-empty nodes at a free surface",
        criterion: "particles 1e-6 h past a line of nodes, 10 s: energy grows by 5 % at most",
        ways: all,
        run: near_empty,
        quick: &[
            ("ulmpm", "linear", "FLIP 1", "musl"),
            ("ulmpm", "quadratic-spline", "APIC", "usf"),
        ],
        without: Some(("`usl` with hats", || near_empty(&way("ulmpm", "linear", "FLIP 1", "usl")))),
    },
    Row {
        number: 2,
        mode: "cell-crossing noise",
        criterion: "a bar swings five periods on a flight over 20 cells and keeps 93 % of its energy",
        ways: || all().into_iter().filter(|way| way.transfer == "FLIP 1").collect(),
        run: crossing,
        quick: &[
            ("ulmpm", "quadratic-spline", "FLIP 1", "musl"),
            ("ulcpdi", "R4", "FLIP 1", "musl"),
        ],
        without: Some(("hats", || crossing(&way("ulmpm", "linear", "FLIP 1", "musl")))),
    },
    Row {
        number: 3,
        mode: "null space, ringing",
        criterion: "a checkerboard of velocities never grows by 5 % in 5000 steps",
        ways: all,
        run: checkerboard,
        quick: &[
            ("ulmpm", "linear", "FLIP 1", "musl"),
            ("ulmpm", "quadratic-spline", "XPIC 2", "musl"),
        ],
        without: Some(("FLIP instead of XPIC, APIC or a part of PIC", || {
            let left = |transfer| noise_left(&way("ulmpm", "quadratic-spline", transfer, "musl"));
            let [kept, damped] = [left("FLIP 1"), left("XPIC 2")];
            let words = format!("{kept:.3} of the noise stays, with XPIC 2 {damped:.1e}");
            if kept > 0.5 && damped < 0.1 { Verdict::Fail(words) } else { Verdict::Pass(words) }
        })),
    },
    Row {
        number: 4,
        mode: "affine matrix out of date",
        criterion: "free flight keeps the energy to 1e-10; a bouncing disk gains 2 % at most",
        ways: || all().into_iter().filter(affine).collect(),
        run: bounce,
        quick: &[
            ("ulmpm", "quadratic-spline", "APIC", "musl"),
            ("ulmpm", "cubic-spline", "MLS", "musl"),
        ],
        without: None,
    },
    Row {
        number: 5,
        mode: "collapse of the time step",
        criterion: "a disk turns once in 1.1 times the nominal number of steps",
        ways: || {
            let shapes =
                super::ways::SHAPES.into_iter().filter(|(method, _)| method.starts_with("tl"));
            let each = |(method, shape)| SCHEMES.map(|scheme| way(method, shape, "FLIP 1", scheme));
            shapes.flat_map(each).collect()
        },
        run: turning,
        quick: &[("tlmpm", "linear", "FLIP 1", "musl")],
        without: None,
    },
];
