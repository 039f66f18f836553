//! Multi-field contact (language.md 7.5): momentum, impedance, when bodies meet, what pairs that no
//! contact names do, groups, heat, the ledger.

use super::script::{Played, Script};

fn last(played: &Played, name: &str) -> f64 {
    played.end.as_ref().expect("the run is stable");
    *played.column(name).last().unwrap()
}

/// Two spinning disks that collide off centre, and how they meet.
fn disks(method: &str, contact: &str) -> Script {
    let text = format!(
        "h = 1/20
method({method})
dimension(2, -0.5, 0.5, -0.5, 0.5, h)
region(r1, cylinder, -0.21, -0.05, 0.2)
region(r2, cylinder, 0.21, 0.05, 0.2)
region(r3, block, 0.3, 0.4, -0.4, -0.3)
material(soft, neo-hookean, 1000, 1000, 0.3)
material(hard, neo-hookean, 2000, 1000, 0.3)
solid(s1, region, r1, 2, soft, h)
solid(s2, region, r2, 2, hard, h)
solid(s3, region, r3, 2, soft, h)
group(g1, particles, region, r1, solid, s1)
group(g2, particles, region, r2, solid, s2)
fix(v1, initial_velocity_particles, g1, 0.1 - (y+0.05), x+0.21)
fix(v2, initial_velocity_particles, g2, -0.1, 0)
{contact}
compute(p1, average_velocity, g1)
compute(p2, average_velocity, g2)
compute(Ek, kinetic_energy, all)
compute(Es, strain_energy, all)
log_modify(custom, time, p1_x, p1_y, p2_x, p2_y, Ek, Es)
set_output(40)
set_dt(2e-3)
run_time(0.8)
"
    );
    Script::new("disks", &text)
}

const METHODS: [&str; 6] = [
    "ulmpm, FLIP, linear, 1",
    "ulmpm, APIC, quadratic-spline",
    "ulmpm, FLIP, cubic-spline, 0.99)\nscheme(usl",
    "ulmpm, ASFLIP, quadratic-spline, 0.99)\nscheme(usf",
    "ulmpm, XPIC, 3, quadratic-spline",
    "ulmpm, MLS, quadratic-spline)\nanti_locking(fbar",
];

#[test]
fn momentum_stays_whatever_bodies_do() {
    for method in METHODS {
        for rule in ["stick, s1, s2", "slip, s1, s2", "frictional, s1, s2, 0.3", "slip, all"] {
            for place in ["", ", on_nodes"] {
                let script = disks(method, &format!("contact(c, {rule}{place})"));
                let played = script.play(&[]);
                // Particles of a disk weigh the same: mass times mean velocity is the momentum.
                for axis in ["x", "y"] {
                    let [p1, p2] = ["p1", "p2"].map(|p| played.column(&format!("{p}_{axis}")));
                    let sum = |row: usize| p1[row] + 2.0 * p2[row];
                    let rows = p1.len();
                    let met = (p1[rows - 1] - p1[0]).abs();
                    let change = sum(rows - 1) - sum(0);
                    // Round-off of 400 steps; the momentum exchanged is some hundred times 1e-3.
                    assert!(change.abs() < 1e-13, "{method}, {rule}: {change:e}");
                    assert!(axis == "y" || met > 0.05, "{method}, {rule}: {met}");
                }
            }
        }
    }
}

#[test]
fn bodies_that_no_contact_names_together_move_as_on_one_grid() {
    for method in METHODS {
        // The filter of XPIC and the averages of F-bar look around within a body only.
        if method.contains("XPIC") || method.contains("fbar") {
            continue;
        }
        let [alone, apart] =
            ["", "contact(c, slip, s3, s2)"].map(|contact| disks(method, contact).play(&[]));
        for name in ["Ek", "Es", "p1_x", "p1_y", "p2_x"] {
            let difference = (last(&alone, name) - last(&apart, name)).abs();
            // The order of sums differs: round-off, which 400 steps of elastic bodies keep small.
            assert!(
                difference < 1e-9 * last(&alone, name).abs(),
                "{method}: {name} {difference:e}"
            );
        }
        let free = disks(method, "contact(c, slip, s1, s2)").play(&[]);
        assert!((last(&free, "p1_y") - last(&alone, "p1_y")).abs() > 1e-4, "slip changes nothing");
    }
}

/// Two elastic bars that meet end to end with the velocities +-v in one dimension.
fn bars(method: &str, contact: &str, gap: f64, second: &str) -> Script {
    let text = format!(
        "h = 1/64
v = 0.01
gap = {gap}*h
method({method})
dimension(1, -2, 2, h)
region(r1, block, -1, 0)
region(r2, block, gap, 1)
material(m1, linear, 1, 1, 0)
material(m2, linear, {second}, 0)
solid(s1, region, r1, 2, m1, h)
solid(s2, region, r2, 2, m2, h)
group(g1, particles, region, r1, solid, s1)
group(g2, particles, region, r2, solid, s2)
fix(v1, initial_velocity_particles, g1, v)
fix(v2, initial_velocity_particles, g2, -v)
{contact}
compute(p1, average_velocity, g1)
compute(p2, average_velocity, g2)
log_modify(custom, time, c_x, p1_x, p2_x)
set_output(1)
dt_factor(0.4)
run_time(1)
"
    );
    Script::new("bars", &text)
}

#[test]
fn the_force_of_an_impact_is_that_of_the_impedances() {
    // F = 2 v Z1 Z2/(Z1 + Z2) with Z = sqrt(rho E) until the wave is back after 2 L/c.
    for (second, impedance) in [("1, 1", 1.0), ("4, 1", 2.0), ("1, 9", 3.0f64)] {
        let exact = 2.0 * 0.01 * impedance / (1.0 + impedance);
        for method in ["ulmpm, FLIP, linear, 1", "ulmpm, FLIP, quadratic-spline, 1)\nscheme(usl"] {
            for place in ["", ", on_nodes"] {
                let contact = format!("contact(c, slip, s1, s2{place})");
                let played = bars(method, &contact, 0.0, second).play(&[]);
                let (time, force) = (played.column("Time"), played.column("c_x"));
                // Impulse over time, from after the first ringing to before the wave is back.
                let of = |from: f64, to: f64| {
                    let rows = (1..time.len()).filter(|r| time[*r] > from && time[*r] <= to);
                    let pairs =
                        rows.map(|r| (force[r] * (time[r] - time[r - 1]), time[r] - time[r - 1]));
                    let (sum, span) = pairs.fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
                    sum / span
                };
                let mean = of(0.1, 0.6);
                println!("{second} {method} {place}: {mean:.6} of {:.6}", -exact);
                // v/c = 1 % of strain, and the ringing of one wave of a few cells over half a bar.
                assert!((mean / exact + 1.0).abs() < 0.02, "{method}: {mean} {exact}");
                assert!(force.iter().all(|force| *force <= 1e-15), "no tension");
            }
        }
    }
}

#[test]
fn touching_bodies_meet_when_their_gap_is_closed() {
    // Four cells apart, each with 0.01 c: surfaces meet at gap/(2 v).
    let gap = 4.0;
    let exact = gap / 64.0 / 0.02;
    for method in ["ulmpm, FLIP, linear, 1", "ulmpm, FLIP, cubic-spline, 1"] {
        let first = |place: &str| {
            let contact = format!("contact(c, slip, s1, s2{place})");
            let played =
                bars(method, &contact, gap, "1, 1").statement("run_time", "run_time(4)").play(&[]);
            let force = played.column("c_x");
            let row = force.iter().position(|force| *force < 0.0).expect("they meet");
            played.column("Time")[row]
        };
        let [touching, sharing] = ["", ", on_nodes"].map(first);
        println!("{method}: {touching:.3} touching, {sharing:.3} on nodes, exact {exact:.3}");
        // dt = 0.4 h/c, and a body has moved by v dt in it; rounding of the places.
        assert!((touching - exact).abs() < 0.4 / 64.0 + 1e-9, "{method}: {touching}");
        // Nodes are shared when the last particles, h/4 inside the surfaces, are nearer than two
        // cells less what a node needs: more than half a cell of closing early.
        assert!(exact - sharing > 0.5 / 64.0 / 0.02, "{method}: {sharing}");
    }
}

/// A block on a rigid floor, gravity turned by `angle`.
fn incline(method: &str, contact: &str, angle: f64, mu: f64) -> Script {
    let text = format!(
        "h = 0.05
mu = {mu}
angle = {angle}*PI/180
g = 9.81
method({method})
dimension(2, 0, 5, 0, 0.7, h)
region(low, block, INF, INF, 0, 0.1)
region(high, block, 0.2, 0.6, 0.1, 0.25)
material(soft, linear, 1000, 1e6, 0.3)
material(rock, rigid, 0)
solid(floor, region, low, 2, rock, h)
solid(block, region, high, 2, soft, h)
group(b, particles, region, high, solid, block)
group(f, particles, region, low, solid, floor)
contact(c, {contact})
ramp = min(1, time/0.05)
fix(gravity, body_force, all, g*sin(angle)*ramp, -g*cos(angle)*ramp)
fix(hold, velocity_particles, f, 0, 0)
compute(v, average_velocity, b)
compute(W, energy_ledger, all)
way = xcm(b, x)
height = xcm(b, y)
log_modify(custom, time, v_x, way, height, c_x, c_y, c_s, hold_x, hold_y, W_friction, W_residual, W_external)
set_output(1)
run_time(1)
"
    );
    Script::new("incline", &text)
}

/// Mean acceleration from the end of the ramp on.
fn acceleration(played: &Played) -> f64 {
    played.end.as_ref().expect("the run is stable");
    let rows = played.column("Time").into_iter().zip(played.column("v_x"));
    slope(&rows.filter(|(time, _)| *time >= 0.1).collect::<Vec<_>>())
}

#[test]
fn a_block_slides_down_an_incline_as_coulomb_says() {
    let methods = ["ulmpm, FLIP, quadratic-spline, 1", "ulmpm, APIC, quadratic-spline"];
    for (method, place) in methods.into_iter().flat_map(|m| [(m, ""), (m, ", on_nodes")]) {
        for (angle, mu, exact) in [(30.0, 0.3, 2.35628724), (45.0, 0.1, 6.24304577)] {
            let contact = format!("frictional, block, floor, mu{place}");
            let played = incline(method, &contact, angle, mu).play(&[]);
            let found = acceleration(&played);
            println!("{method}{place}, {angle} deg, mu {mu}: {found:.6} of {exact}");
            // V19: 1 %.
            assert!((found / exact - 1.0).abs() < 0.01, "{method}{place}: {found} {exact}");
            // Heat is mu N times the slip, from the start, where N follows the ramp: work of gravity
            // less kinetic energy.
            let weight = 0.4 * 0.15 * 1000.0 * 9.81;
            let slope = angle.to_radians();
            let (way, v) = (played.column("way"), last(&played, "v_x"));
            let slip = last(&played, "way") - way[0];
            let heat = mu * weight * slope.cos() * slip;
            let found = last(&played, "c_s");
            println!("  heat {found:.4} of {heat:.4}, ledger {:.4}", last(&played, "W_friction"));
            assert!((found / heat - 1.0).abs() < 0.01, "{found} {heat} at {v}");
            assert!((last(&played, "W_friction") / heat - 1.0).abs() < 0.01);
            // Over the largest energy: before the block moves there is hardly any.
            let residual = played.column("W_residual").iter().fold(0.0f64, |a, b| a.max(b.abs()));
            let worst = residual / last(&played, "W_external");
            println!("  worst error of the ledger {worst:.2e}");
            assert!(worst < 0.01, "{worst}");
        }
    }
}

#[test]
fn a_block_sticks_below_the_angle_of_friction() {
    // tan(30 deg) = 0.577 < 0.6. The block settles, then nothing damps it for a second.
    let rest = "fix(still, damping_nodes, all, 100)
run_time(0.3)
delete_fix(still)
run_time(1)";
    let moved = |method: &str, ppc: u32, mu: f64| {
        let contact = "frictional, block, floor, mu";
        let solid = format!("solid(block, region, high, {ppc}, soft, h)");
        let script = incline(method, contact, 30.0, mu).statement("run_time", rest);
        let played = script.statement("solid(block", &solid).play(&[]);
        let (way, time) = (played.column("way"), played.column("Time"));
        let begin = time.iter().position(|time| *time >= 0.3).unwrap();
        (way[way.len() - 1] - way[begin], last(&played, "c_s"))
    };
    // V19: 1e-6 m. Splines need 16 particles per cell for it: with four the rows of nodes beside the
    // floor share the load unevenly, and those above the limit of friction creep. FLIP keeps noise
    // that no node sees, which shakes the block.
    for (method, ppc, most) in [
        ("ulmpm, APIC, linear", 2, 1e-9),
        ("ulmpm, APIC, quadratic-spline", 4, 1e-6),
        ("ulmpm, APIC, quadratic-spline", 2, 2e-5),
        ("ulmpm, FLIP, quadratic-spline, 1", 2, 2e-4),
    ] {
        let (way, heat) = moved(method, ppc, 0.6);
        println!("{method}, {ppc}: {way:.2e} m in a second at rest, heat {heat:.2e}");
        assert!(way.abs() < most, "{method}: {way}");
    }
    // With mu = 0.5 the block slides 0.33 m.
    let (slides, _) = moved("ulmpm, APIC, quadratic-spline", 2, 0.5);
    assert!(slides > 0.3, "{slides}");
}

#[test]
fn a_rigid_floor_feels_what_it_gives() {
    // Hats that cross cells at metres per second shake a block of three cells off its floor.
    let method = "ulmpm, FLIP, quadratic-spline, 1";
    let played = incline(method, "slip, block, floor", 30.0, 0.0).play(&[]);
    let weight = 0.4 * 0.15 * 1000.0 * 9.81 * 30f64.to_radians().cos();
    let (time, force) = (played.column("Time"), played.column("c_y"));
    let impulse: f64 = (1..time.len()).map(|r| force[r] * (time[r] - time[r - 1])).sum();
    // The ramp of 0.05 holds half of its weight back; the block goes up and down by its own
    // elasticity, with velocities of some per cent of g t.
    let exact = weight * (time[time.len() - 1] - 0.025);
    println!("impulse {impulse:.4} of {exact:.4}");
    assert!((impulse / exact - 1.0).abs() < 0.01, "{impulse} {exact}");
    for (axis, contact) in [("x", "c_x"), ("y", "c_y")] {
        let hold = played.column(&format!("hold_{axis}"));
        let contact = played.column(contact);
        // Every share of the force comes from a sum over some hundred nodes and particles.
        let pairs = hold.iter().zip(&contact).skip(1);
        let worst = pairs.map(|(h, c)| (h - c).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-10 * weight, "{axis}: {worst}");
    }
}

/// A hot and a cold bar end to end.
fn hot_and_cold(contact: &str) -> Played {
    let text = format!(
        "h = 1/16
method(ulmpm, FLIP, linear, 1, thermo-mechanical)
thermal_blend(1)
dimension(1, 0, 2, h)
region(r1, block, 0, 1)
region(r2, block, 1, 2)
region(ends, block, INF, INF)
material(m1, linear, 1, 1, 0, 1, 1)
material(m2, linear, 2, 1, 0, 1, 2)
solid(s1, region, r1, 2, m1, h, 1)
solid(s2, region, r2, 2, m2, h, 0)
group(g1, particles, region, r1, solid, s1)
group(g2, particles, region, r2, solid, s2)
{contact}
compute(T1, average_temperature, g1)
compute(T2, average_temperature, g2)
log_modify(custom, time, T1, T2)
set_output(0)
set_dt(5e-4)
run_time(0.2)
"
    );
    Script::new("hot and cold", &text).play(&[])
}

#[test]
fn heat_passes_from_body_to_body() {
    let [one, two] = ["", "contact(c, slip, s1, s2)"].map(hot_and_cold);
    for name in ["T1", "T2"] {
        let (alone, apart) = (last(&one, name), last(&two, name));
        println!("{name}: {alone:.6} on one grid, {apart:.6} on two");
        // The same sums in another order.
        assert!((alone - apart).abs() < 1e-12);
    }
    // Heat is kept: m cp = 1 and 2.
    let total = last(&two, "T1") + 2.0 * last(&two, "T2");
    assert!((total - 1.0).abs() < 1e-12 && last(&two, "T2") > 0.1, "{total}");
}

#[test]
fn groups_of_nodes_can_be_those_of_one_body() {
    let held = |solids: &str| {
        let fixes = format!(
            "contact(c, slip, s1, s2)
region(middle, block, -0.2, 0.2, -0.2, 0.2)
group(n, nodes, region, middle, {solids})
fix(stop, velocity_nodes, n, 0, 0)"
        );
        disks("ulmpm, PIC, linear", &fixes).statement("run_time", "run(20)").play(&[])
    };
    let [both, first, second] = ["all", "solid, s1", "solid, s2"].map(held);
    let free = disks("ulmpm, PIC, linear", "contact(c, slip, s1, s2)")
        .statement("run_time", "run(20)")
        .play(&[]);
    let p = |played: &Played| [last(played, "p1_x"), last(played, "p2_x")];
    let ([b1, b2], [f1, f2], [s1, s2], [free1, free2]) =
        (p(&both), p(&first), p(&second), p(&free));
    assert!((b1 - free1).abs() > 1e-3 && (b2 - free2).abs() > 1e-3);
    assert!((f1 - b1).abs() < 1e-12 && (f2 - free2).abs() < 1e-12, "{f1} {b1} {f2} {free2}");
    assert!((s2 - b2).abs() < 1e-12 && (s1 - free1).abs() < 1e-12, "{s1} {s2}");
}

#[test]
fn a_total_force_on_nodes_counts_once_for_all_bodies() {
    let pushed = "contact(c, slip, s1, s2)
region(everywhere, block, INF, INF, INF, INF)
group(n, nodes, region, everywhere)
fix(push, force_nodes, n, 6, 0)";
    let played = disks("ulmpm, FLIP, linear, 1", pushed).statement("run_time", "run(10)").play(&[]);
    let particles = &played.session.simulation.world.particles;
    let momentum: f64 =
        particles.position.iter().zip(&particles.velocity).map(|(x, v)| x[3] * v[0]).sum();
    let mass = |solid: u16| -> f64 {
        let all = particles.position.iter().zip(&particles.solid);
        all.filter(|(_, s)| **s == solid).map(|(x, _)| x[3]).sum()
    };
    // s1 starts with the mean 0.1 (its particles lie evenly around -0.05), s2 with -0.1.
    let start = 0.1 * mass(0) - 0.1 * mass(1);
    let exact = 6.0 * 10.0 * 2e-3;
    assert!((momentum - start - exact).abs() < 1e-2 * exact, "{momentum} {start} {exact}");
}

#[test]
fn contacts_come_and_go_between_runs() {
    let script = disks("ulmpm, FLIP, linear, 1", "contact(c, slip, s1, s2)").statement(
        "run_time",
        "run(130)\ndelete_contact(c)\nrun(130)\ncontact(d, stick, all)\nrun(130)",
    );
    let played = script.play(&[]);
    let [p1, p2] = ["p1_x", "p2_x"].map(|p| played.column(p));
    let sum = |row: usize| p1[row] + 2.0 * p2[row];
    assert!((sum(p1.len() - 1) - sum(0)).abs() < 1e-13);
    assert_eq!(played.session.simulation.world.grid.lattices.len(), 3);
}

/// Slope of the least squares line through points.
fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / n;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let products: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    products / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

/// Nairn's block on a floor, pressed and pulled with the same force; per metre of thickness.
fn pulled_block(floor: &str, contact: &str) -> Script {
    let text = format!(
        "h = 2.5e-3
F = 35293
m = 3
mu = 0.5
ramp = 2e-4
method(ulmpm, APIC, quadratic-spline)
dimension(2, 0, 0.1, 0, 0.035, h)
region(low, block, INF, INF, 0, 4*h)
region(high, block, 0.02, 0.06, 4*h, 4*h + 0.015)
region(bottom, block, INF, INF, INF, h/4)
material(soft, linear, 5000, 1e9, 0.3)
material(rock, {floor})
solid(floor, region, low, 2, rock, h)
solid(block, region, high, 2, soft, h)
group(b, particles, region, high, solid, block)
group(base, nodes, region, bottom, solid, floor)
fix(hold, velocity_nodes, base, 0, 0)
contact(c, {contact})
press = min(1, time/ramp)*F/m
pull = if(time < ramp, 0, F/m)
fix(load, body_force, b, pull, -press)
compute(v, average_velocity, b)
compute(W, energy_ledger, all)
way = xcm(b, x)
log_modify(custom, time, v_x, way, c_x, c_y, c_s, W_external, W_kinetic, W_stored)
set_output(1)
run_time(1.2e-3)
"
    );
    Script::new("pulled block", &text)
}

#[test]
fn a_pulled_block_is_held_back_by_mu_times_its_load() {
    let exact = (35293.0 - 0.5 * 35293.0) / 3.0;
    let floor = "rigid, 0";
    let contact = "frictional, block, floor, mu";
    let played = pulled_block(floor, contact).play(&[]);
    played.end.as_ref().expect("the run is stable");
    let (time, v, way) = (played.column("Time"), played.column("v_x"), played.column("way"));
    let points: Vec<(f64, f64)> =
        time.iter().copied().zip(v.iter().copied()).filter(|(t, _)| *t > 3e-4).collect();
    let found = slope(&points);
    let heat = 0.5 * 35293.0 * (way[way.len() - 1] - way[0]);
    let warmed = last(&played, "c_s");
    println!("{floor}: {found:.2} of {exact:.2} m/s^2, heat {warmed:.4} of {heat:.4}");
    assert!((found / exact - 1.0).abs() < 0.01, "{floor}: {found} {exact}");
    // The block still bounces from the ramp, and N with it: mu N slip is met within 7 %, what the
    // work of the pull leaves within 1 %.
    assert!((warmed / heat - 1.0).abs() < 0.07, "{floor}: {warmed} {heat}");
    let [work, kinetic, stored] =
        ["external", "kinetic", "stored"].map(|term| last(&played, &format!("W_{term}")));
    let left = work - kinetic - stored;
    assert!((warmed / left - 1.0).abs() < 0.01, "{floor}: {warmed} {left}");
    // Without friction the same gate fails.
    let free = pulled_block(floor, "slip, block, floor").play(&[]);
    assert!((last(&free, "v_x") / (35293.0 / 3.0 * 1e-3) - 1.0).abs() < 0.02);
}

#[test]
fn a_deformable_floor_holds_a_block_back_as_a_rigid_one_does() {
    let impulses = |contact: &str| {
        let played = pulled_block("linear, 5000, 1e9, 0.3", contact).play(&[]);
        played.end.as_ref().expect("the run is stable");
        let time = played.column("Time");
        let sum = |name: &str| -> f64 {
            let force = played.column(name);
            let rows = (1..time.len()).filter(|row| time[*row] > 3e-4);
            rows.map(|row| force[row] * (time[row] - time[row - 1])).sum()
        };
        let points = time.iter().copied().zip(played.column("v_x"));
        let found = slope(&points.filter(|(t, _)| *t > 3e-4).collect::<Vec<_>>());
        (-sum("c_x") / sum("c_y"), found)
    };
    let (ratio, found) = impulses("frictional, block, floor, mu");
    let exact = 0.5 * 35293.0 / 3.0;
    println!("drag over load {ratio:.6} of 0.5, {found:.1} of {exact:.1} m/s^2");
    // All of the face slides: mu exactly, but for normals that turn with the dents of some 1e-3.
    assert!((ratio - 0.5).abs() < 1e-3, "{ratio}");
    // The block bounces on two bodies that give way, a little more than four times in the window: its
    // load is not met within 1 %.
    assert!((found / exact - 1.0).abs() < 0.02, "{found}");
    let (ratio, free) = impulses("slip, block, floor");
    println!("without friction {ratio:.1e}, {free:.1} of {:.1} m/s^2", 35293.0 / 3.0);
    assert!(ratio.abs() < 1e-3 && (free * 3.0 / 35293.0 - 1.0).abs() < 2e-3, "{ratio} {free}");
    // The form of the page takes its normals from the masses alone, tilted at the corners.
    let (tilted, _) = impulses("frictional, block, floor, mu, on_nodes");
    assert!(tilted > 0.6, "{tilted}");
}
