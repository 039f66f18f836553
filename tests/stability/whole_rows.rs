//! Rows 18 to 24 of the hard cases: contact, the box, long runs, places, bookkeeping, restart.

use super::play::{Played, play};
use super::table::{Row, Verdict, judge};
use super::ways::{Way, all, way};
use karamelo::model::column::Column;

fn with(transfers: &[&str]) -> Vec<Way> {
    all().into_iter().filter(|way| transfers.contains(&way.transfer)).collect()
}

fn updated() -> Vec<Way> {
    all().into_iter().filter(Way::is_updated).collect()
}

/// The first verdict that is no pass, or all figures.
fn first_bad(each: impl IntoIterator<Item = (&'static str, Verdict)>) -> Verdict {
    let mut figures = Vec::new();
    for (what, verdict) in each {
        match verdict {
            Verdict::Pass(words) => figures.push(format!("{what}: {words}")),
            Verdict::Fail(words) => return Verdict::Fail(format!("{what}: {words}")),
            Verdict::Stopped(words) => return Verdict::Stopped(format!("{what}: {words}")),
            Verdict::Refused(words) => return Verdict::Refused(format!("{what}: {words}")),
            Verdict::Warned(words) => return Verdict::Warned(words),
        }
    }
    Verdict::Pass(figures.join("; "))
}

/// Row 18. A ball falls on a rigid plate that moves towards it, and leaves it again.
fn rebound_script(way: &Way, contact: &str) -> String {
    format!("h = 0.1\n{}dimension(2, 0, 2, 0, 2, h)\n", way.lines())
        + "region(disk, sphere, 1, 0.75, 0.3)\nregion(plate, block, 0.4, 1.6, 0.1, 0.3)\n\
           material(m, neo-hookean, 1, 100, 0.3)\nmaterial(steel, rigid, 1)\n\
           solid(ball, region, disk, 2, m, h)\nsolid(floor, region, plate, 2, steel, h)\n\
           group(ball, particles, region, disk, solid, ball)\n\
           group(floor, particles, region, plate, solid, floor)\n\
           fix(fall, initial_velocity_particles, ball, 0, -0.5)\n\
           fix(rise, initial_velocity_particles, floor, 0, 0.1)\n"
        + contact
        + "compute(v, average_velocity, ball)\nlog_modify(custom, step, dt, time, v_y)\n\
           dt_factor(0.5)\nset_output(20)\nrun_time(1)\n"
}

fn rebound(way: &Way) -> Verdict {
    let contact = match way.is_updated() {
        true => "",
        false => "fix(touch, contact/minimize_penetration, ball, floor, 0)\n",
    };
    // PIC spends the energy of the rebound in the contact: then the plate pushes the ball along.
    let least = if way.kind() == "PIC" { 0.0 } else { 0.1 };
    judge(&[], &play(&rebound_script(way, contact)), |played| rebounded(played, least))
}

fn rebounded(played: &Played, least: f64) -> Result<String, String> {
    let particles = &played.session.simulation.world.particles;
    let top = 0.3 + 0.1;
    let of_ball = (0..particles.len()).filter(|p| particles.solid[*p] == 0);
    let lowest = of_ball.map(|p| particles.position[p][1]).fold(f64::INFINITY, f64::min);
    let [_, speed] = played.ends("v_y");
    let depth = ((top - lowest) / 0.1).max(0.0);
    let text = format!("leaves with {speed:.3}, {depth:.2} h deep");
    // 0.7 without loss: twice 0.1 less -0.5.
    if speed > least && depth < 1.0 { Ok(text) } else { Err(text) }
}

/// Row 19. A ball flies out of its box.
fn leaving_script(way: &Way, policy: &str) -> String {
    format!("h = 0.1\n{}boundary({policy})\ndimension(2, 0, 1, 0, 2, h)\n", way.lines())
        + "region(disk, sphere, 0.6, 1, 0.25)\nmaterial(m, neo-hookean, 1, 100, 0.3)\n\
           solid(ball, region, disk, 2, m, h)\n\
           fix(fly, initial_velocity_particles, all, 1, 0)\ncompute(Ek, kinetic_energy, all)\n\
           log_modify(custom, step, dt, time, Ek)\nset_output(10)\nrun_time(0.4)\n"
}

fn leaving(way: &Way) -> Verdict {
    let played = play(&leaving_script(way, "error"));
    if let Some(reason) = played.refused.first() {
        return Verdict::Refused(reason.clone());
    }
    let named = ["left the box: particle ", "of solid `ball`", "velocity (", "step ", "time "];
    match &played.end {
        Ok(()) => return Verdict::Fail("it ends although a particle has left".to_string()),
        Err(words) if !named.iter().all(|part| words.contains(part)) => {
            return judge(&[], &played, |_| Err(words.clone()));
        }
        Err(_) => {}
    }
    let count = |played: &Played| played.session.simulation.world.particles.len();
    let delete = play(&leaving_script(way, "delete"));
    let deleted = judge(&[], &delete, |played| {
        let told =
            played.warnings.iter().any(|words| words.contains("left the box and were removed"));
        let text = format!("{} left", count(played));
        if told && count(played) < 80 { Ok(text) } else { Err(text) }
    });
    let warned = &["was reflected by the box"];
    let bounce = judge(warned, &play(&leaving_script(way, "bounce")), |played| {
        let inside = played.places().iter().all(|x| (0.0..=1.0).contains(&x[0]));
        let text = format!("Ek at most {:.3}", played.growth("Ek"));
        if inside && played.growth("Ek") < 1.05 { Ok(text) } else { Err(text) }
    });
    first_bad([("delete", deleted), ("bounce", bounce)])
}

/// Row 20. A block swings for 1e5 steps; a column that has come to rest stays where it is.
fn long(way: &Way) -> Verdict {
    first_bad([("swinging", swinging(way, 100_000)), ("at rest", resting(way, 100_000))])
}

fn swinging(way: &Way, steps: u64) -> Verdict {
    let text = format!("h = 0.1\n{}dimension(2, 0, 2, 0, 2, h)\n", way.lines())
        + "region(body, block, 0.8, 1.2, 0.8, 1.2)\nmaterial(m, linear, 1, 100, 0.3)\n\
           solid(s, region, body, 2, m, h)\n\
           fix(v, initial_velocity_particles, all, 0.01*sin(PI*(x0 - 1)/0.4), 0)\n\
           compute(Ek, kinetic_energy, all)\ncompute(Es, strain_energy, all)\nE = Ek + Es\n\
           log_modify(custom, step, dt, time, E)\ndt_factor(0.1)\nset_output(100)\n"
        + &format!("run({steps})\n");
    judge(&[], &play(&text), |played| {
        // Kinetic and stored energy are logged half a step apart: their sum swings about what is kept.
        let energies = played.column("E");
        let tenth = energies.len() / 10;
        let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
        let last = mean(&energies[energies.len() - tenth..]);
        let off = (last / mean(&energies[..tenth]) - 1.0).abs();
        let text = format!("energy within {:.2} %", 100.0 * off);
        if off < 0.05 { Ok(text) } else { Err(text) }
    })
}

fn resting(way: &Way, steps: u64) -> Verdict {
    // What particles do that hardly moves the nodes, which are what is damped, calms down slowly.
    let calm = 100_000;
    let text = format!("h = 0.1\n{}dimension(2, 0, 0.4, 0, 1, h)\n", way.lines())
        + "region(body, block, 0, 0.4, 0, 0.6)\nregion(everywhere, block, INF, INF, INF, INF)\n\
           region(ground, block, INF, INF, INF, h/4)\nregion(top, block, INF, INF, 0.6 - h/2, 0.6)\n\
           material(m, neo-hookean, 1, 100, 0.3)\nsolid(s, region, body, 2, m, h)\n\
           group(sides, nodes, region, everywhere, all)\ngroup(floor, nodes, region, ground, all)\n\
           group(top, particles, region, top, solid, s)\n\
           fix(sides, velocity_nodes, sides, 0, NULL)\nfix(floor, velocity_nodes, floor, NULL, 0)\n\
           fix(g, body_force, all, 0, -1)\nfix(calm, damping_nodes, all, 30)\n\
           height = xcm(top, y)\nlog_modify(custom, step, dt, time, height)\n\
           set_dt(0.004)\nset_output(1000)\n"
        + &format!("run({calm})\ndelete_fix(calm)\nrun({steps})\n");
    judge(&[], &play(&text), |played| {
        let heights = played.column("height");
        let still = &heights[calm / 1000..];
        let rest = still[0];
        let drift = still.iter().fold(0.0f64, |most, y| most.max((y - rest).abs()));
        let text = format!("drift {drift:.0e}");
        if drift < 1e-10 { Ok(text) } else { Err(text) }
    })
}

/// Row 21. The same flight at the origin and 1e9 cells away.
fn far_script(way: &Way, shift: f64) -> String {
    // Powers of two: the shift itself is exact.
    format!("h = 0.125\nS = {shift}\n{}dimension(2, S, S + 2, S, S + 2, h)\n", way.lines())
        + "region(disk, sphere, S + 0.75, S + 1, 0.4)\nmaterial(m, neo-hookean, 1, 100, 0.3)\n\
           solid(s, region, disk, 2, m, h)\n\
           fix(v, initial_velocity_particles, all, 0.5 + 0.5*(y0 - S - 1), 0.5*(x0 - S - 0.75))\n\
           log_modify(custom, step, dt, time)\nset_dt(0.005)\nset_output(100)\nrun(200)\n"
}

fn far(way: &Way) -> Verdict {
    let shift = 1.25e8;
    let (near, far) = (play(&far_script(way, 0.0)), play(&far_script(way, shift)));
    judge(&[], &far, |played| {
        let off = played.places().iter().zip(near.places()).fold(0.0f64, |most, (far, near)| {
            (0..2).fold(most, |most, axis| most.max((far[axis] - shift - near[axis]).abs()))
        });
        let text = format!("off by {off:.0e}");
        if off < 1e-6 { Ok(text) } else { Err(text) }
    })
}

/// Row 22. Scenes that are hardly there.
fn trivial(way: &Way) -> Verdict {
    first_bad([
        ("on a node", on_a_node(way)),
        ("one particle", one_particle(way)),
        ("nothing moves", nothing_moves(way)),
        ("two cells", two_cells(way)),
        ("dt far too large", far_too_large(way)),
        ("run_time(1e-7)", shortest(way)),
        ("zero yield", zero_yield(way)),
        ("nu = 0.5", incompressible(way)),
    ])
}

fn block(way: &Way, law: &str, rest: &str) -> String {
    format!("h = 0.1\n{}dimension(2, 0, 1, 0, 1, h)\n", way.lines())
        + "region(body, block, 0.3, 0.6, 0.3, 0.6)\n"
        + &format!("material(m, {law})\nsolid(s, region, body, 2, m, h)\n{rest}")
}

const ELASTIC: &str = "linear, 1, 100, 0.3";

/// All particles are as they were but for a flight along v.
fn unchanged(played: &Played, by: [f64; 2]) -> Result<String, String> {
    let [x0, y0] = [Column::X0, Column::Y0].map(|column| played.particles(column));
    let off = played.places().iter().enumerate().fold(0.0f64, |most, (n, x)| {
        most.max((x[0] - x0[n] - by[0]).abs()).max((x[1] - y0[n] - by[1]).abs())
    });
    let text = format!("off by {off:.0e}");
    if off < 1e-12 { Ok(text) } else { Err(text) }
}

fn on_a_node(way: &Way) -> Verdict {
    let rest = "translate_particles(s, region, body, h/4, h/4)\n\
        fix(v, initial_velocity_particles, all, 0.25, 0.25)\nset_dt(0.004)\nrun(100)\n";
    judge(&[], &play(&block(way, ELASTIC, rest)), |played| unchanged(played, [0.1; 2]))
}

fn one_particle(way: &Way) -> Verdict {
    let text = format!("h = 0.1\n{}dimension(2, 0, 1, 0, 1, h)\n", way.lines())
        + "region(body, block, 0.3, 0.7, 0.3, 0.7)\nregion(one, block, 0.5, 0.6, 0.5, 0.6)\n\
           region(others, difference, body, one)\nmaterial(m, linear, 1, 100, 0.3)\n\
           solid(s, region, body, 1, m, h)\ndelete_particles(s, region, others)\n\
           fix(v, initial_velocity_particles, all, 0.25, -0.25)\nset_dt(0.004)\nrun(100)\n";
    judge(&[], &play(&text), |played| match played.places().len() {
        1 => unchanged(played, [0.1, -0.1]),
        count => Err(format!("{count} particles")),
    })
}

fn nothing_moves(way: &Way) -> Verdict {
    judge(&[], &play(&block(way, ELASTIC, "run(100)\n")), |played| {
        let still =
            played.places().iter().zip(played.particles(Column::X0)).all(|(x, x0)| x[0] == x0);
        let silent = played.particles(Column::S11).iter().all(|stress| *stress == 0.0);
        if still && silent { Ok("exactly".to_string()) } else { Err("something moves".to_string()) }
    })
}

/// Splines need four nodes; on two cells they are refused with the reason.
fn two_cells(way: &Way) -> Verdict {
    let text = format!("h = 0.5\n{}dimension(2, 0, 1, 0, 1, h)\n", way.lines())
        + "region(body, block, 0, 1, 0, 1)\nmaterial(m, linear, 1, 100, 0.3)\n\
           solid(s, region, body, 2, m, h)\n\
           fix(v, initial_velocity_particles, all, 1e-3*(x0 - 0.5), 0)\n\
           compute(Ek, kinetic_energy, all)\ncompute(Es, strain_energy, all)\nE = Ek + Es\n\
           log_modify(custom, step, dt, time, E)\nset_output(1)\nrun(500)\n";
    let played = play(&text);
    match played.refused.first() {
        Some(reason) if reason.contains("splines need") && way.shape.ends_with("-spline") => {
            Verdict::Pass("refused".to_string())
        }
        Some(reason) => Verdict::Fail(reason.clone()),
        None => judge(&[], &played, |played| {
            let text = format!("E/E0 {:.3}", played.trend("E"));
            if played.trend("E") < 1.05 { Ok(text) } else { Err(text) }
        }),
    }
}

/// A step ten times too large: a warning, and no numbers that are none at exit 0.
fn far_too_large(way: &Way) -> Verdict {
    let rest = "fix(v, initial_velocity_particles, all, y0 - 0.45, 0.45 - x0)\nset_dt(0.1, force)\nrun(200)\n";
    let played = play(&block(way, ELASTIC, rest));
    match &played.end {
        Ok(()) if !played.is_finite() => Verdict::Fail("not finite".to_string()),
        Ok(()) => Verdict::Pass("finite".to_string()),
        Err(words) if words.contains("likely cause") => Verdict::Pass("stopped".to_string()),
        Err(words) => Verdict::Fail(words.clone()),
    }
}

fn shortest(way: &Way) -> Verdict {
    judge(&[], &play(&block(way, ELASTIC, "run_time(1e-7)\n")), |played| {
        let time = played.session.simulation.clock.time;
        let text = format!("ends at {time:e}");
        if time == 1e-7 && played.steps() == 1 { Ok(text) } else { Err(text) }
    })
}

fn zero_yield(way: &Way) -> Verdict {
    let law = "eos-strength, p, flow";
    let rest = "fix(v, initial_velocity_particles, all, 0.1*(y0 - 0.45), 0)\nrun(50)\n";
    let text = block(way, law, rest)
        .replace("material(", "eos(p, linear, 1, 100)\nstrength(flow, plastic, 50, 0)\nmaterial(");
    judge(&[], &play(&text), |played| {
        let shear = played.particles(Column::S12).iter().fold(0.0f64, |most, s| most.max(s.abs()));
        let text = format!("shear stress {shear:.0e}");
        if shear < 1e-12 { Ok(text) } else { Err(text) }
    })
}

fn incompressible(way: &Way) -> Verdict {
    let played = play(&block(way, "linear, 1, 100, 0.5", "run(1)\n"));
    match played.refused.first() {
        Some(reason) if reason.starts_with("E0208") => Verdict::Pass("refused".to_string()),
        other => Verdict::Fail(format!("{other:?}")),
    }
}

/// Row 23. A plastic ball bounces under gravity; every term of its energy is counted.
fn ledger_script(way: &Way) -> String {
    format!("h = 0.1\n{}dimension(2, 0, 2, 0, 2, h)\n", way.lines())
        + "region(disk, sphere, 1, 0.55, 0.35)\nregion(ground, block, INF, INF, INF, 0.1)\n\
           material(m, von-mises, 1, 100, 0.3, 1)\nsolid(s, region, disk, 2, m, h)\n\
           group(floor, nodes, region, ground)\nfix(stop, velocity_nodes, floor, NULL, 0)\n\
           fix(g, body_force, all, 0, -1)\nfix(v, initial_velocity_particles, all, 0.1*(y0 - 0.55), -0.5)\n\
           compute(W, energy_ledger, all)\n\
           log_modify(custom, step, dt, time, W_error, W_kinetic, W_stored, W_plastic)\n\
           dt_factor(0.3)\nset_output(5)\nrun_time(1)\n"
}

fn closes(way: &Way) -> Verdict {
    judge(&[], &play(&ledger_script(way)), |played| {
        let off = played.column("W_error").iter().fold(0.0f64, |most, e| most.max(e.abs()));
        let text = format!("closes within {:.2} %", 100.0 * off);
        if off < 0.01 { Ok(text) } else { Err(text) }
    })
}

/// The ledger without its plastic work does not close.
fn closes_without(way: &Way) -> Verdict {
    judge(&[], &play(&ledger_script(way)), |played| {
        let most = played.column("W_kinetic").iter().fold(0.0f64, |most, e| most.max(*e));
        let [_, plastic] = played.ends("W_plastic");
        let text = format!("plastic work is {:.1} % of the energy", 100.0 * plastic / most);
        if plastic < 0.01 * most { Ok(text) } else { Err(text) }
    })
}

/// Row 24. A run that was stopped after some steps and gone on with, against the whole one.
fn resumed(way: &Way) -> Verdict {
    let scene = format!("h = 0.1\n{}dimension(2, 0, 2, 0, 2, h)\n", way.lines())
        + "region(disk, sphere, 1, 0.55, 0.35)\nregion(ground, block, INF, INF, INF, 0.1)\n\
           material(m, von-mises, 1, 100, 0.3, 1)\nsolid(s, region, disk, 2, m, h)\n\
           group(floor, nodes, region, ground)\nfix(stop, velocity_nodes, floor, NULL, 0)\n\
           fix(g, body_force, all, 0, -1)\nfix(v, initial_velocity_particles, all, 0.1*(y0 - 0.55), -0.5)\n";
    let bits = |played: &Played| {
        let particles = &played.session.simulation.world.particles;
        let records = particles.position.iter().chain(&particles.velocity).flatten();
        let stress = particles.column(Column::S12).iter().chain(particles.column(Column::J));
        records.chain(stress).map(|x| x.to_bits()).collect::<Vec<u64>>()
    };
    let whole = play(&format!("{scene}run(60)\n"));
    judge(&[], &whole, |whole| {
        for step in [1, 7, 40] {
            let place = tempfile::tempdir().unwrap();
            let file = place.path().join("a.rst");
            let first =
                play(&format!("{scene}run({step})\nwrite_restart(\"{}\")\n", file.display()));
            let second =
                play(&format!("read_restart(\"{}\")\nrun({})\n", file.display(), 60 - step));
            first.end.and(second.end.clone())?;
            if bits(whole) != bits(&second) {
                return Err(format!("other bits after a stop at step {step}"));
            }
        }
        Ok("bit for bit".to_string())
    })
}

/// Rows 18 to 24.
pub const ROWS: &[Row] = &[
    Row {
        number: 18,
        mode: "rigid bodies and contact",
        criterion: "a ball leaves a rigid plate that moves towards it; less than a cell deep",
        ways: || with(&["FLIP 1", "FLIP 0.99", "PIC", "APIC"]),
        run: rebound,
        quick: &[("ulmpm", "linear", "FLIP 1", "musl"), ("tlmpm", "linear", "FLIP 1", "musl")],
        without: Some(("no contact fix", || {
            let way = way("tlmpm", "linear", "FLIP 1", "musl");
            judge(&[], &play(&rebound_script(&way, "")), |played| rebounded(played, 0.1))
        })),
    },
    Row {
        number: 19,
        mode: "particles leave the box",
        criterion: "`error` names particle, solid, step, time and velocity; `delete` counts; `bounce` keeps all inside",
        ways: updated,
        run: leaving,
        quick: &[("ulmpm", "linear", "FLIP 1", "musl"), ("ulcpdi", "R4", "FLIP 1", "musl")],
        without: None,
    },
    Row {
        number: 20,
        mode: "long runs",
        criterion: "1e5 steps: energy within 5 %; a column at rest drifts by less than 1e-10",
        ways: || with(&["FLIP 1"]).into_iter().filter(|way| way.scheme == "musl").collect(),
        run: long,
        quick: &[],
        without: Some(("`usl`", || {
            swinging(&way("ulmpm", "quadratic-spline", "FLIP 1", "usl"), 100_000)
        })),
    },
    Row {
        number: 21,
        mode: "far from the origin",
        criterion: "200 steps 1e9 cells away: the same places to 1e-6",
        ways: all,
        run: far,
        quick: &[("ulmpm", "linear", "FLIP 1", "musl"), ("tlmpm", "linear", "FLIP 1", "musl")],
        without: None,
    },
    Row {
        number: 22,
        mode: "trivial states",
        criterion: "on a node, one particle, nothing moves, two cells, dt far too large, run_time(1e-7), zero yield, nu = 0.5",
        ways: all,
        run: trivial,
        quick: &[
            ("ulmpm", "linear", "FLIP 1", "musl"),
            ("tlmpm", "quadratic-spline", "FLIP 1", "musl"),
        ],
        without: None,
    },
    Row {
        number: 23,
        mode: "bookkeeping of energy",
        criterion: "the ledger of a plastic ball that bounces closes within 1 %",
        ways: all,
        run: closes,
        quick: &[
            ("ulmpm", "quadratic-spline", "FLIP 1", "musl"),
            ("ulmpm", "quadratic-spline", "APIC", "musl"),
        ],
        without: Some(("plastic work not counted", || {
            closes_without(&way("ulmpm", "quadratic-spline", "FLIP 1", "musl"))
        })),
    },
    Row {
        number: 24,
        mode: "restart",
        criterion: "stopped after 1, 7 and 40 steps of 60: bit for bit the same",
        ways: all,
        run: resumed,
        quick: &[("ulmpm", "quadratic-spline", "APIC", "musl"), ("tlcpdi", "R4", "FLIP 1", "musl")],
        without: None,
    },
];
