//! Rigid bodies (language.md 7.3): what they carry along, what they leave behind, what it takes.

use super::script::{Played, Script};

const YOUNG: f64 = 1e5;
const SPEED: f64 = 0.2;

/// A soft block under a rigid platen that comes down, in plane strain with free sides.
fn upsetting(method: &str, scheme: &str) -> Script {
    let text = format!(
        "h = 1/16
method(ulmpm, {method})
scheme({scheme})
dimension(2, -1, 1, 0, 1, h)
region(low, block, -0.5, 0.5, 0, 0.5)
region(high, block, -0.625, 0.625, 0.5, 0.625)
region(bottom, block, INF, INF, INF, h/4)
material(soft, linear, 1000, {YOUNG}, 0.3)
material(steel, rigid, 7800)
solid(body, region, low, 2, soft, h)
solid(platen, region, high, 2, steel, h)
group(floor, nodes, region, bottom)
group(top, particles, region, high, solid, platen)
group(all_soft, particles, region, low, solid, body)
fix(stand, velocity_nodes, floor, NULL, 0)
fix(press, velocity_particles, top, 0, -{SPEED})
fix(spread, initial_velocity_particles, all_soft, 0.3*{SPEED}*x/0.5/0.7, -{SPEED}*y/0.5)
compute(mean, average_velocity, all_soft)
height = xcm(top, y)
log_modify(custom, time, stand_y, press_y, mean_y, height)
set_output(20)
dt_factor(0.4)
run_time(0.04)
"
    );
    Script::new("upsetting", &text)
}

/// Force, velocity and place of the end of the run.
fn check(played: &Played, name: &str) {
    played.end.as_ref().unwrap_or_else(|end| panic!("{name}: {end}"));
    let [press, stand, mean, height, time] =
        ["press_y", "stand_y", "mean_y", "height", "Time"].map(|c| played.column(c));
    let last = press.len() - 1;
    // 2 % of compression: plane strain with free sides is E/(1 - nu^2) strain; its square and the
    // stair of the platen's lower edge (a platen touches nodes half a cell early: h/2 of 1/2 = 6 %
    // of the height) bound the deviation.
    let strain = SPEED * time[last] / 0.5;
    let exact = YOUNG / (1.0 - 0.09) * strain;
    println!("{name}: platen {:.2} floor {:.2} of {exact:.2}", press[last], stand[last]);
    assert!((-press[last] / exact - 1.0).abs() < 0.1, "{name}: {}", press[last]);
    assert!((stand[last] / exact - 1.0).abs() < 0.1, "{name}: {}", stand[last]);
    // Linear in y: the mean is half of the platen's velocity.
    assert!((mean[last] / (-0.5 * SPEED) - 1.0).abs() < 0.1, "{name}: {}", mean[last]);
    assert!((height[last] - (0.5625 - SPEED * time[last])).abs() < 1e-12, "{name}");
}

#[test]
fn a_platen_presses_a_block_with_the_force_of_its_strain() {
    // Splines feel the platen from a cell and a half away: their block is shorter still.
    for (method, scheme) in [("FLIP, linear, 0.99", "musl"), ("FLIP, linear, 0.99", "usl")] {
        check(&upsetting(method, scheme).play(&[]), &format!("{method} {scheme}"));
    }
}

/// A rigid body crosses the box from left to right; then a soft one comes from above where it was.
fn crossing(second: &str) -> Played {
    let text = format!(
        "h = 1/16
method(ulmpm, FLIP, linear, 1)
dimension(2, 0, 2, 0, 2, h)
region(one, block, 0.25, 0.5, 0.75, 1)
region(two, block, 0.75, 1, 1.5, 1.75)
material(soft, linear, 1000, 1e5, 0.3)
material(steel, rigid, 0)
solid(hammer, region, one, 2, steel, h)
solid(body, region, two, 2, soft, h)
group(g1, particles, region, one, solid, hammer)
group(g2, particles, region, two, solid, body)
fix(v1, initial_velocity_particles, g1, 1, 0)
fix(v2, initial_velocity_particles, g2, 0, -0.5)
{second}
compute(v, average_velocity, g2)
compute(a, average_velocity, g1)
height = xcm(g2, y)
compute(right, max_position, g1)
log_modify(custom, time, v_x, v_y, a_x, height, right_x)
set_output(0)
set_dt(1/512)
run_time(1.375)
"
    );
    Script::new("crossing", &text).play(&[])
}

#[test]
fn a_rigid_body_leaves_nothing_behind() {
    let played = crossing("");
    played.end.as_ref().unwrap();
    let last = |name| *played.column(name).last().unwrap();
    // Free flight: round-off of 704 steps.
    assert!((last("v_y") + 0.5).abs() < 1e-11 && last("v_x").abs() < 1e-11, "{}", last("v_y"));
    assert!((last("height") - 0.9375).abs() < 1e-11);
    assert!((last("a_x") - 1.0).abs() == 0.0 && (last("right_x") - 1.859375).abs() < 1e-12);
    let world = &played.session.simulation.world;
    // 4 x 4 cells hold the rigid body, which stands half a cell over at most: 6 x 6 nodes.
    let flagged = world.grid.rigid.iter().filter(|node| node[3] > 0.0).count();
    assert!(flagged <= 36, "{flagged}");
    // A trail of dead nodes, as held nodes would be, stops the body: the test can fail.
    let held = crossing(
        "region(trail, block, 0.5, 1.25, 0.75, 1)\ngroup(t, nodes, region, trail)
fix(dead, velocity_nodes, t, 0, 0)",
    );
    let speed = *held.column("v_y").last().unwrap();
    assert!((speed + 0.5).abs() > 0.1, "{speed}");
}

#[test]
fn a_rigid_body_turns_without_strain() {
    let text = "h = 1/16
method(ulmpm, PIC, linear)
dimension(2, -1, 1, -1, 1, h)
region(one, block, -0.5, 0.5, -0.25, 0.25)
material(steel, rigid, 1000)
solid(bar, region, one, 2, steel, h)
group(g, particles, region, one)
fix(start, initial_velocity_particles, g, -y, x)
fix(turn, velocity_particles, g, -y, x)
compute(Ek, kinetic_energy, all)
compute(Es, strain_energy, all)
log_modify(custom, time, Ek, Es)
set_output(0)
set_dt(1/256)
run_time(1)
";
    let played = Script::new("turning", text).play(&[]);
    played.end.as_ref().unwrap();
    let (energy, stored) = (played.column("Ek"), played.column("Es"));
    // x <- x + dt v(x) with |v| = r: the radius grows by sqrt(1 + dt^2) a step. The last velocity is
    // that of the place before the last step.
    let growth = energy[energy.len() - 1] / energy[0];
    assert!((growth - (1.0f64 + 1.0 / 65536.0).powi(255)).abs() < 1e-9, "{growth}");
    assert_eq!(stored[stored.len() - 1], 0.0);
    let particles = &played.session.simulation.world.particles;
    assert!(particles.column(karamelo::model::column::Column::J).iter().all(|j| *j == 1.0));
}

/// A rigid hammer that moves a free block; the impulse of its fix and the momentum of the block.
fn hammered(method: &str, scheme: &str) -> [f64; 2] {
    let text = format!(
        "h = 1/16
method(ulmpm, {method})
scheme({scheme})
dimension(2, -1, 1, 0, 2, h)
region(low, block, -0.25, 0.25, 0.5, 1)
region(high, block, -0.3125, 0.3125, 1, 1.125)
material(soft, linear, 1000, {YOUNG}, 0.3)
material(steel, rigid, 0)
solid(body, region, low, 2, soft, h)
solid(hammer, region, high, 2, steel, h)
group(block, particles, region, low, solid, body)
group(hammer, particles, region, high, solid, hammer)
fix(strike, velocity_particles, hammer, 0.05, -{SPEED})
compute(v, average_velocity, block)
log_modify(custom, dt, time, strike_y, v_y)
set_output(1)
dt_factor(0.4)
run_time(0.1)
"
    );
    let played = Script::new("hammer", &text).play(&[]);
    played.end.as_ref().unwrap_or_else(|end| panic!("{method} {scheme}: {end}"));
    let [dt, force, velocity] = ["dt", "strike_y", "v_y"].map(|name| played.column(name));
    let impulse = dt.iter().zip(&force).skip(1).map(|(dt, force)| dt * force).sum();
    [impulse, 1000.0 * 0.25 * velocity.last().unwrap()]
}

#[test]
fn the_impulse_of_a_rigid_body_is_the_momentum_it_gives() {
    for scheme in ["musl", "usl", "usf"] {
        for method in [
            "FLIP, linear, 1",
            "FLIP, quadratic-spline, 0.99",
            "PIC, quadratic-spline",
            "APIC, quadratic-spline",
            "AFLIP, cubic-spline, 0.9",
            "MLS, quadratic-spline",
        ] {
            let [impulse, momentum] = hammered(method, scheme);
            println!("{method} {scheme}: impulse {impulse:.6}, momentum {momentum:.6}");
            // Round-off of some hundred steps.
            assert!((impulse / momentum - 1.0).abs() < 1e-11, "{method} {scheme}");
            assert!(momentum < -0.5 * 250.0 * SPEED, "{method} {scheme}: {momentum}");
        }
    }
}

#[test]
fn a_rigid_body_without_density_has_a_centre() {
    let mean = |density: &str| {
        let script = upsetting("FLIP, linear, 0.99", "musl");
        let material = format!("material(steel, rigid, {density})");
        script.statement("material(steel", &material).play(&[]).column("height")
    };
    let (light, heavy) = (mean("0"), mean("7800"));
    assert_eq!(light[0], 0.5625);
    // Round-off of the weights.
    assert!(light.iter().zip(&heavy).all(|(a, b)| (a - b).abs() < 1e-13));
}
