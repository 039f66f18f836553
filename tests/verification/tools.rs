//! Tools that push particles (language.md 7.4): V12's point tests and the indenter.

use super::script::{Played, Script};
use karamelo::model::column::Column;

/// One particle at (0.1, 0.3) of shear modulus 2 and Poisson's ratio 0.3, and a fix.
fn particle(fix: &str) -> Played {
    let text = format!(
        "h = 0.2
method(tlmpm, FLIP, linear, 1)
dimension(2, -1, 1, -1, 1, h)
region(r, block, 0, h, h, 2*h)
material(m, linear, 1000, 2*2*1.3, 0.3)
solid(s, region, r, 1, m, h)
group(g, particles, region, r)
fix(tool, {fix})
compute(v, average_velocity, all)
log_modify(custom, time, tool_x, tool_y, tool_s, v_x, v_y, dt_limit)
set_dt(1e-3)
run(1)
"
    );
    let text = text.replace(", dt_limit", "");
    Script::new("tool", &text).play(&[])
}

fn last(played: &Played, name: &str) -> f64 {
    *played.column(name).last().unwrap()
}

#[test]
fn the_wedge_pushes_with_the_numbers_of_the_verification_list() {
    // p1 = 0.3, p2 = 0.1, pushed along -x; eq. 4.4 and the linear law with K = 1.
    let root = particle("cuttingtool, g, 0, 0, 1, 0, 0, 1");
    assert!((last(&root, "tool_x") + 0.141922690).abs() < 5e-10, "{}", last(&root, "tool_x"));
    assert_eq!(last(&root, "tool_y"), 0.0);
    let linear = particle("cuttingtool, all, 1, 0, 0, 0, 5, 5, 5, 1, 0, 0, 1");
    assert!((last(&linear, "tool_x") + 0.2).abs() < 1e-15);
    // The particle feels it: dt F/m.
    let mass = 1000.0 * 0.04;
    assert!((last(&linear, "v_x") + 1e-3 * 0.2 / mass).abs() < 1e-18);
    // Outside either half plane: nothing.
    for fix in [
        "cuttingtool, g, 0.2, 0, 1, 0, 0.2, 1",
        "cuttingtool, g, 0, 0.4, 1, 0.4, 0, 1",
        "cuttingtool, g, 1, 0.2, 0, 0, 0, 0, 0, 1, 0, 0.2, 1",
    ] {
        let outside = particle(fix);
        assert_eq!([last(&outside, "tool_x"), last(&outside, "tool_y")], [0.0, 0.0], "{fix}");
    }
    // As printed, without turning the lines to each other's ends, nothing is inside: the mutant of
    // the verification list has 0 in place of the numbers above.
}

#[test]
fn steel_under_the_tool_of_the_paper() {
    // (pi/2) G (1 + nu)/(1 - nu^2) p^1.5 for G = 79.323308, nu = 0.33, p = 1e-3.
    let text = "h = 0.2
method(tlmpm, FLIP, linear, 1)
dimension(2, -1, 1, -1, 1, h)
region(r, block, 0, h, h, 2*h)
material(m, linear, 1000, 2*79.323308*1.33, 0.33)
solid(s, region, r, 1, m, h)
fix(tool, cuttingtool, all, 0.099, 0, 1, 0, 0.099, 1)
log_modify(custom, time, tool_x)
set_dt(1e-6)
run(1)
";
    let found = last(&Script::new("steel", text).play(&[]), "tool_x");
    assert!((found + 5.880928e-3).abs() < 5e-10, "{found}");
}

#[test]
fn damage_weakens_the_linear_tool_alone() {
    let text = |fix: &str| {
        format!(
            "h = 0.2
method(tlmpm, FLIP, linear, 1)
dimension(2, -1, 1, -1, 1, h)
region(r, block, 0, h, h, 2*h)
eos(e, linear, 1000, 2*2*1.3/3/0.4)
strength(st, plastic, 2, 1e9)
damage(d, damage_johnson_cook, 1, 0, 0, 0, 0, 1, 298, 1356)
material(m, eos-strength, e, st, d)
solid(s, region, r, 1, m, h)
fix(tool, {fix})
log_modify(custom, time, tool_x)
set_dt(1e-6)
run(0)
"
        )
    };
    for (fix, factor) in [
        ("cuttingtool, all, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1", 0.2 * 0.75),
        ("cuttingtool, all, 0, 0, 1, 0, 0, 1", 0.141922690),
    ] {
        let mut played = Script::new("damage", &text(fix)).play(&[]);
        let simulation = &mut played.session.simulation;
        simulation.world.particles.column_mut(Column::Damage)[0] = 0.25;
        simulation.run(karamelo::simulation::Until::Steps(1)).unwrap();
        let found = simulation.fixes[0].1.results(&simulation.world)[0];
        assert!((found + factor).abs() < 5e-10, "{fix}: {found}");
    }
}

#[test]
fn the_indenter_pushes_outward_with_the_square_of_the_depth() {
    // Centre (0.1, 0), R = 0.5, r = 0.3: K 0.2^2 along +y; the old form is the same.
    for fix in ["indent, g, sphere, 3, 0.1, 0, 7, 0.5", "indent, all, 0.1, 0, 7, 0.5, 3"] {
        let pushed = particle(fix);
        assert!((last(&pushed, "tool_y") - 0.12).abs() < 1e-14, "{fix}");
        assert!(last(&pushed, "tool_x").abs() < 1e-16);
    }
    assert_eq!(last(&particle("indent, g, sphere, 3, 0.1, 0, 7, 0.3"), "tool_y"), 0.0);
}

#[test]
fn a_moving_tool_gives_its_impulse_and_its_work_to_the_body() {
    let text = "h = 0.05
method(tlmpm, FLIP, linear, 1)
dimension(2, -1, 2, -1, 1, h)
region(r, block, 0, 0.5, 0, 0.3)
material(m, linear, 1000, 1e6, 0.3)
solid(s, region, r, 2, m, h)
group(g, particles, region, r)
compute(v, average_velocity, all)
compute(Ek, kinetic_energy, all)
compute(Es, strain_energy, all)
compute(W, energy_ledger, all)
tip = -0.02 + 2*time
fix(tool, cuttingtool, g, 50, tip, 0.15, 0, 2, 0, 0, tip-0.2, 0.55, tip-0.2, -0.25)
log_modify(custom, dt, time, tool_x, tool_y, tool_s, v_x, Ek, Es, W_external, W_error)
dt_factor(0.5)
run_time(0.05)
";
    let played = Script::new("impulse", text).play(&[]);
    played.end.as_ref().unwrap();
    let [force, dt, speed] = ["tool_x", "dt", "v_x"].map(|name| played.column(name));
    let impulse: f64 = force.iter().zip(&dt).skip(1).map(|(f, dt)| f * dt).sum();
    let momentum = 1000.0 * 0.15 * speed.last().unwrap();
    println!("impulse {impulse} of {momentum}, steps {}", force.len());
    assert!(momentum > 1.0);
    // Both are sums of the same numbers: round-off.
    assert!((impulse / momentum - 1.0).abs() < 1e-11, "{impulse} {momentum}");
    let energy = last(&played, "Ek") + last(&played, "Es");
    let (work, given) = (last(&played, "tool_s"), last(&played, "W_external"));
    println!("work {work}, on the nodes {given}, energy {energy}");
    // The ledger books what the nodes take on and closes within 1 %.
    assert!((given / energy - 1.0).abs() < 0.01 && last(&played, "W_error") < 0.01);
    // The tool follows the ways of single particles, which swing about their nodes.
    assert!((work / given - 1.0).abs() < 0.05, "{work} {given}");
}
