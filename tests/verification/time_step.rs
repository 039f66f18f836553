//! The time step: each limit holds its scene, which goes wrong with the step that the others would
//! allow. Scenes have h = 1 and c = 1 where nothing else is said.

use super::script::{Played, Script};

/// Plays a scene with a line about the time step in the place of STEP.
fn play(text: &str, step: &str) -> Played {
    Script::new("step", text).replace("STEP", step).play(&[])
}

/// Did the run end well, and with less than `bound` of the quantity?
fn holds(played: &Played, name: &str, bound: f64) -> bool {
    let largest = played.column(name).iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    println!("  {name} {largest:.4e} of {bound:.4e}, {:?}", played.end);
    played.end.is_ok() && largest <= bound
}

/// The scene holds with the step that it chooses, most often by the limit named, and fails with a
/// step that would be right without that limit.
fn needs(limit: &str, text: &str, without: &str, name: &str, bound: f64) {
    println!("{limit}");
    let chosen = play(text, "");
    assert!(holds(&chosen, name, bound), "{limit}: {:?}", chosen.end);
    let words = chosen.words("dt_limit");
    let bound_by = words.iter().filter(|word| *word == limit).count();
    assert!(2 * bound_by > words.len(), "{limit}: {words:?}");
    let forced = play(text, without);
    assert!(!holds(&forced, name, bound), "{limit} is not needed");
}

#[test]
fn lone_particles_under_usl_are_held_by_the_isolated_limit() {
    // 2/sqrt(d S) = 0.577 in two dimensions, where the table for bars says 0.62 and waves 1.
    let text = "
method(ulmpm, FLIP, quadratic-spline, 1)\nscheme(usl)\ndimension(2, 0, 16, 0, 16, 1)
region(r, block, 5, 6, 5, 6)\nmaterial(m, linear, 1, 1, 0)\nsolid(s, region, r, 1, m, 1)
fix(p, initial_stress, all, 0.001, 0.002, 0, 0, 0, 0.001)
fix(v, initial_velocity_particles, all, 0.01, 0.013)\ncompute(Es, strain_energy, all)
log_modify(custom, time, Es, dt_limit)\nSTEP\nrun(300)";
    // Es = sigma : C^-1 sigma/2 of the given stress.
    needs("acoustic", text, "set_dt(0.8, force)", "Es", 1.01 * 3.5e-6);
}

#[test]
fn a_drifting_bar_under_usl_is_held_by_the_table() {
    // C = 0.62 for quadratic splines. An unstable place is passed in part of the time only, so that it
    // takes many steps; the rest is the energy of waves, which usl drains.
    let text = "
method(ulmpm, FLIP, quadratic-spline, 1)\nscheme(usl)\ndimension(1, 0, 40, 1)
region(r, block, 4, 12)\nmaterial(m, linear, 1, 1, 0)\nsolid(s, region, r, 2, m, 1)
fix(v, initial_velocity_particles, all, 0.02 + 0.0001*sin(3*x))
compute(Es, strain_energy, all)\nlog_modify(custom, time, Es, dt_limit)\nset_output(10)
STEP\nrun(1400)";
    needs("acoustic", text, "set_dt(0.97, force)", "Es", 8.0 * 0.5 * 1e-8);
}

#[test]
fn a_compressed_fluid_is_held_by_the_tangent() {
    // Water hammer: c^2 = gamma K/rho J^(1 - gamma), sqrt(7) at rest and three times that at the bottom.
    let text = "
method(ulmpm, FLIP, linear, 1)\ndimension(1, 0, 16, 1)\nregion(r, block, 0, 8)
region(b, block, INF, 0.25)\neos(e, fluid, 1, 1, 7)\nstrength(f, fluid, 0)
material(m, eos-strength, e, f)\nsolid(s, region, r, 2, m, 1)\ngroup(base, nodes, region, b)
fix(hold, velocity_nodes, base, 0)\nfix(weight, body_force, all, -1.4)\nfix(d, damping_nodes, all, 0.3)
compute(Ek, kinetic_energy, all)\nlog_modify(custom, time, Ek, dt_limit)
STEP\nrun_time(60)";
    // It cannot have more than the weight gives it over its height: m g L/2.
    needs("acoustic", text, "set_dt(0.9/sqrt(7), force)", "Ek", 8.0 * 1.4 * 4.0);
}

#[test]
fn a_viscous_fluid_is_held_by_its_viscosity() {
    // 0.9 * 3/(8 d nu) = 0.169; the waves of K = 1e-4 would allow 90.
    let text = "
method(ulmpm, FLIP, linear, 1)\ndimension(2, 0, 10, 0, 10, 1)\nregion(r, block, 2, 8, 2, 8)
eos(e, fluid, 1, 1e-4, 1)\nstrength(f, fluid, 1)\nmaterial(m, eos-strength, e, f)
solid(s, region, r, 2, m, 1)
fix(v, initial_velocity_particles, all, 0.001*sin(3*y), 0.001*sin(2*x))
compute(Ek, kinetic_energy, all)\nlog_modify(custom, time, Ek, dt_limit)
STEP\nrun(200)";
    needs("viscous", text, "set_dt(1, force)", "Ek", 36.0 * 1e-6);
}

#[test]
fn heat_is_held_by_its_diffusivity() {
    // Particles on the nodes: T spreads by the five-point stencil, for which 1/(2 d) is sharp. A hot corner
    // excites modes along both axes.
    let text = "
method(ulmpm, FLIP, linear, 1, thermo-mechanical)\ndimension(2, 0, 10, 0, 10, 1)
region(r, block, 2, 8, 2, 8)\nregion(q, block, 2, 3, 2, 3)\nmaterial(m, linear, 1, 1e-4, 0, 1, 1)
solid(s, region, r, 1, m, 1, 300)\ntranslate_particles(all, region, r, 0.5, 0.5)
group(hot, particles, region, q)\nthermal_blend(1)\nfix(t, temperature_particles, hot, 400)
compute(M, max_plastic_strain, all)\nlog_modify(custom, time, M_Tmax, dt_limit)
STEP\nrun(100)";
    needs("thermal", text, "set_dt(0.3, force)", "M_Tmax", 400.0 + 1e-9);
}

#[test]
fn a_shaken_cell_is_held_by_the_rate() {
    // Nodes that move against each other around a particle at rest, ever faster: its waves become
    // slower while it is crushed, and dt L of steps of 0.9 passes 1 at the third.
    let text = "
method(ulmpm, FLIP, linear, 1)\ndimension(1, 0, 16, 1)\nregion(cell, block, 8, 9)
region(everywhere, block, INF, INF)\nmaterial(m, linear, 1, 1, 0)\nsolid(s, region, cell, 1, m, 1)
group(n, nodes, region, everywhere)
fix(shake, velocity_nodes, n, 0.3*time*if(mod(x, 2) == 0, 1, -1))
compute(Es, strain_energy, all)\nlog_modify(custom, time, Es, dt_limit)
STEP\nrun_time(5)";
    // (E/2) (ln J)^2 J with ln J = -0.3 t^2, largest at ln J = -2.
    needs("rate", text, "set_dt(0.9, force)", "Es", 2.0 * (-2.0f64).exp());
}

#[test]
fn tools_are_held_by_their_stiffness() {
    // A sphere that presses on a block: 0.2 sqrt(m/k), k about K times its depth.
    let text = "
method(ulmpm, FLIP, linear, 1)\ndimension(2, 0, 8, 0, 8, 1)\nregion(r, block, 2, 6, 0, 4)
region(low, block, INF, INF, INF, 0.25)\nmaterial(m, linear, 1, 1, 0)\nsolid(s, region, r, 2, m, 1)
group(base, nodes, region, low)\nfix(hold, velocity_nodes, base, 0, 0)
fix(tool, indent, all, sphere, 300, 4, 5.3 - 0.02*min(time, 5), 0, 1.5)
compute(Ek, kinetic_energy, all)\nlog_modify(custom, time, Ek, dt_limit)
STEP\nrun_time(6)";
    let played = play(text, "");
    let words = played.words("dt_limit");
    println!("{:?} {words:?}", played.end);
    assert!(played.end.is_ok() && words.iter().any(|word| word == "contact"), "{words:?}");
}

#[test]
fn steps_grow_by_a_tenth_at_most() {
    // A body that flies fast stops at once: waves would allow five times the step.
    let text = "
method(ulmpm, FLIP, linear, 1)\ndimension(1, 0, 40, 1)\nregion(r, block, 2, 10)
material(m, linear, 1, 1, 0)\nsolid(s, region, r, 2, m, 1)\ngroup(p, particles, region, r)
fix(v, velocity_particles, p, if(time < 2, 4, 0))
log_modify(custom, dt, time, dt_limit)\nSTEP\nrun(40)";
    let played = play(text, "");
    let dt = played.column("dt");
    let grown = dt.windows(2).map(|pair| pair[1] / pair[0]).fold(0.0, f64::max);
    assert!((grown - 1.1).abs() < 1e-9, "{grown}");
    let words = played.words("dt_limit");
    for (pair, word) in dt.windows(2).zip(&words[1..]) {
        assert_eq!(word == "growth", pair[1] > (1.1 - 1e-9) * pair[0], "{pair:?} {word}");
    }
    assert!(words.iter().filter(|word| *word == "growth").count() > 10, "{words:?}");
}

#[test]
fn a_step_that_collapses_ends_the_run_with_its_cause() {
    // Particles that are thrown to and fro ever faster, up to 1e8 times as fast as waves.
    let text = "
method(ulmpm, FLIP, linear, 1)\ndimension(2, 0, 8, 0, 8, 1)\nregion(r, block, 3, 5, 3, 5)
material(m, linear, 1, 1, 0)\nsolid(s, region, r, 2, m, 1)\ngroup(p, particles, region, r)
fix(v, velocity_particles, p, 10^(min(timestep, 40)/5)*if(mod(timestep, 2) == 0, 1, -1), 0)
log_modify(custom, dt, time, dt_limit)\nSTEP\nrun(400)";
    let played = play(text, "");
    let told = played.end.as_ref().unwrap_err();
    assert!(told.contains("the time step has collapsed to 9.0"), "{told}");
    assert!(told.contains("acoustic limit"), "{told}");
    // 1e-6 of the first step is passed after 30 steps; 100 more are too many.
    let steps = played.column("dt").len();
    assert!((125..135).contains(&steps), "{steps}");
    // Slower by half a power of ten than that, nothing collapses.
    assert_eq!(play(&text.replace("timestep, 40", "timestep, 29"), "").end, Ok(()));
}
